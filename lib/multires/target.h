/* Target: the points of a drawn curve that another is fitted to, in coordinates of size 1 about the origin.
 *
 * They are the ends of its pieces and points between them, so many that they are evenly dense. Each stands
 * for the part of the curve that is nearest to it: its weight is half the lengths to its neighbors, the sum
 * of all being 1. */
#ifndef MULTIRES_TARGET_H
#define MULTIRES_TARGET_H

#include "language/outline.h"
#include "base/memory.h"

enum { TARGET_MOST_POINTS = 1 << 22, TARGET_MOST_DIMENSION = 3 };

struct target {
    unsigned dimension;
    size_t count;
    double center[TARGET_MOST_DIMENSION], scale; /* a point is center + scale · its coordinates here */
    double *points;                              /* count × dimension */
    double *weights;                             /* count */
    double *lengths,
        *shares; /* count: where it is on the curve, 0..1, by length; by pieces, each an equal share */
};

/* `closed`: the target is a closed curve, an open outline being closed by a straight line; its start is not
 * repeated at the end. Otherwise it runs from the first point to the last, once around a closed outline. */
bcifs_status target_create(struct target *target, const struct bcifs_curve *outline, bool closed,
                           size_t wanted, struct arena *arena, struct report *report);

#endif
