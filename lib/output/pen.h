/* Pen: what a diagram needs of a picture: lines, rectangles and a few words, as vectors or as pixels. */
#ifndef OUTPUT_PEN_H
#define OUTPUT_PEN_H

#include "output/file.h"
#include "output/job.h"
#include "output/picture.h"

struct pen;

/* How a word lies at its place. */
enum pen_anchor { PEN_LEFT, PEN_MIDDLE, PEN_RIGHT };

/* Pixels that a word takes, with what stands around it. */
double pen_width(const struct pen *pen, const char *text);
double pen_height(const struct pen *pen);

/* xy: count × 2, pixels from the upper left corner. */
void pen_line(struct pen *pen, const double *xy, size_t count, struct color color, double width);
/* Fills rectangles between whole pixels, sharp-edged: count × 4, left, top, right and bottom of each. */
void pen_boxes(struct pen *pen, const unsigned *boxes, size_t count, struct color color);
/* `x`, `y` is the left, middle or right of the base line. */
void pen_words(struct pen *pen, double x, double y, enum pen_anchor anchor, const char *text,
               struct color color);

/* Draws a diagram. */
typedef void pen_drawing(struct pen *pen, const void *context);

/* The diagram as a file of width × height pixels; the job gives title, command and sources. */
bcifs_status pen_write_svg(const struct job *job, unsigned width, unsigned height, pen_drawing *draw,
                           const void *context, struct file *file);
bcifs_status pen_write_png(const struct job *job, unsigned width, unsigned height, pen_drawing *draw,
                           const void *context, struct file *file);

#endif
