/* Raster: an anti-aliased canvas. Shapes are laid into a coverage mask, which is then painted with one color,
 * so that what overlaps within a layer is not darker than its parts. */
#ifndef OUTPUT_RASTER_H
#define OUTPUT_RASTER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "output/picture.h"

/* The center of pixel (column, row) is at (column + 1/2, row + 1/2). */
struct canvas {
    unsigned width, height;
    unsigned char *pixels;   /* height × width × 3: red, green, blue, row by row from the top */
    unsigned char *coverage; /* height × width: how much of a pixel the mask covers, 255 all */
};

/* A white canvas; false when there is no memory. */
bool canvas_new(struct canvas *canvas, unsigned width, unsigned height);
void canvas_free(struct canvas *canvas);
/* Covers what is within width/2 of the segment. With equal ends that is a disk of diameter `width`. */
void canvas_segment(struct canvas *canvas, double x0, double y0, double x1, double y1, double width);
/* Where a horizontal line crosses a polygon. */
struct crossing {
    double x;
    int turn; /* 1 upward, -1 downward */
};
/* Covers the inside (non-zero winding) of a closed polygon. xy: count × 2; crossings: workspace, count
 * elements. */
void canvas_polygon(struct canvas *canvas, const double *xy, size_t count, struct crossing *crossings);
/* Blends the color through the mask and clears the mask. */
void canvas_paint(struct canvas *canvas, struct color color, double opacity);

/* How many points fell on each pixel, in 256ths: a point is shared by the four pixels around it. */
struct density {
    unsigned width, height;
    uint32_t *counts; /* height × width; stops at the largest number */
};

bool density_new(struct density *density, unsigned width, unsigned height);
void density_free(struct density *density);
void density_add(struct density *density, double x, double y);
/* Blends the color with a logarithmic tone: a single point shows, the densest pixel has all of the color. */
void density_paint(const struct density *density, struct canvas *canvas, struct color color);

#endif
