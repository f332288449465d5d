/* Picture: what the vector and the pixel picture share: how the points are fitted to the paper, in what order
 * the layers are drawn, in what colors.
 *
 * A picture is drawn in two passes over the points: the first finds their bounds. One-dimensional points are
 * drawn as the graph of the value over the parameter, two-dimensional ones as they are, three-dimensional
 * ones in isometric axonometry, seen from (1, -1, 1), z up. Scaling or translating the data changes nothing
 * in a picture but rounding. */
#ifndef OUTPUT_PICTURE_H
#define OUTPUT_PICTURE_H

#include <stdbool.h>
#include <stddef.h>

#include "output/job.h"

enum {
    PICTURE_LEAST_WIDTH = 16,
    PICTURE_MOST_WIDTH = 16384, /* bounds the memory of a pixel picture; its height obeys the same limit */
    PICTURE_DEFAULT_WIDTH = 1000
};

struct color {
    unsigned char red, green, blue;
};

/* How a layer is drawn. Lengths are in pixels. */
struct style {
    struct color line, marker;
    double line_width;
    double marker_size; /* diameter; 0: no markers */
    double dot_size;    /* diameter of a loose point, smaller the more there are */
    double fill;        /* opacity of the inside of polygons */
};

/* A picture's x runs to the right, its y down, in pixels from the upper left corner. */
struct picture {
    struct job *job;
    unsigned dimension; /* of the points, 1 to 3 */
    unsigned width, height;
    double low[3], high[3]; /* bounds of the points of the first layer */
    /* The points are projected to (u, v), which is drawn at x = left + scale_u·(u − u0), y = bottom −
     * scale_v·(v − v0). */
    double u0, v0, scale_u, scale_v, left, bottom;
    size_t *order;        /* layer indices, the one to be drawn first in front */
    struct style *styles; /* per layer, by its index */
};

/* Checks that the job can be drawn, and makes the first pass. */
bcifs_status picture_open(struct picture *picture, struct job *job);
void picture_close(struct picture *picture);

/* A point as it is drawn. */
struct mark {
    double x, y;
    bool starts, ends; /* first and last of its group */
    bool closes;       /* a line leads from here back to the first point of the group */
};

/* Runs over the points of one layer in the picture's coordinates. */
struct trace {
    const struct picture *picture;
    struct reader reader;
    struct group group;
    size_t next;         /* in the reader's tile */
    bool closing;        /* the graph of a closed curve still lacks its last point, */
    double start;        /* which has the value of its first */
    bcifs_status status; /* why trace_next returned false: BCIFS_OK at the end */
};

bcifs_status trace_open(struct trace *trace, const struct picture *picture, size_t layer);
bool trace_next(struct trace *trace, struct mark *mark);
/* Returns the status. */
bcifs_status trace_close(struct trace *trace);

#endif
