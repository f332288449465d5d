/* Outline: one line of straight and cubic pieces, as it is drawn or listed, open or closed.
 *
 * If a piece is cubic, all are held so: a straight one has its inner control points at the thirds, where a
 * cubic runs along it at even speed. So the points are one control polygon: the ends of lines; or 3K + 1
 * (closed: 3K) Bézier points of K cubics. On a closed outline the first point is not repeated. */
#ifndef LANGUAGE_OUTLINE_H
#define LANGUAGE_OUTLINE_H

#include <stdbool.h>
#include <stddef.h>

#include "language/report.h"

enum { OUTLINE_MOST_POINTS = 1 << 24 };

struct bcifs_curve {
    unsigned dimension;
    bool cubic, closed;
    double *points; /* count × dimension, a block of its own */
    size_t count, capacity;
};

/* Adds `count` points (of the outline's dimension). BCIFS_INPUT beyond OUTLINE_MOST_POINTS, with no report.
 */
bcifs_status outline_add(struct bcifs_curve *outline, const double *points, size_t count);

/* ---- Along the outline --------------------------------------------------------------------------------- */

/* The number of pieces; `close`: an open outline gets one more, straight, back to its start. */
size_t outline_pieces(const struct bcifs_curve *outline, bool close);

/* A piece: a line or a cubic, with the points of the outline that it has. */
struct outline_piece {
    unsigned dimension;
    bool cubic;
    const double *points[4]; /* its ends first and last: [0], [1] of a line */
};
struct outline_piece outline_piece(const struct bcifs_curve *outline, size_t index);
/* Its point at parameter t, 0..1. */
void outline_piece_point(const struct outline_piece *piece, double t, double *point);
/* Its length between two parameters. */
double outline_piece_length(const struct outline_piece *piece, double from, double to);

#endif
