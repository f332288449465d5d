/* Blending: the blending functions of a curve figure as a table, and the polyline that they make of control
 * points.
 *
 * The rows stand at the parameters of a depth (evaluate/basis.h). Between two of them functions are taken to
 * be linear, so a position u on the polyline of limit points, 0 … segments, has one row too: (1 - f) row_i +
 * f row_{i+1}, i + f = u. On a closed curve positions wrap. */
#ifndef MULTIRES_BLENDING_H
#define MULTIRES_BLENDING_H

#include "evaluate/basis.h"

enum { BLENDING_MOST_NUMBERS = 1 << 24 /* of the table */ };

struct blending {
    size_t functions; /* control points */
    size_t width;     /* functions of a row */
    size_t rows, segments;
    bool closed;
    const double *t;         /* per row: its parameter, 0..1 */
    const uint32_t *indices; /* rows × width: which functions; those that a row lacks have the value 0 */
    const double *values;    /* rows × width */
};

/* One entry of a row at a position. */
struct blending_entry {
    size_t function;
    double value;
};

/* The figure must be a curve of one chain. Everything is allocated in `arena`. */
bcifs_status blending_create(struct blending *blending, const bcifs_figure *figure, unsigned depth,
                             struct arena *arena, struct report *report);
/* The position of a parameter, 0..1. */
double blending_position(const struct blending *blending, double t);
/* The row at a position: functions rising, none twice. `row` holds 2 width entries; returns how many there
 * are. */
size_t blending_row(const struct blending *blending, double position, struct blending_entry *row);
/* polyline = B x: the limit points (rows × dimension) of control points x (functions × dimension). */
void blending_polyline(const struct blending *blending, const double *x, unsigned dimension,
                       double *polyline);
/* The two rows that a position lies between, and how far. */
void blending_segment(const struct blending *blending, double position, size_t *from, size_t *to,
                      double *share);

#endif
