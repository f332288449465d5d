/* Feet: the places on a polyline of limit points that are nearest to given points, in their order. */
#ifndef MULTIRES_FEET_H
#define MULTIRES_FEET_H

#include "multires/blending.h"
#include "multires/target.h"

struct feet {
    const struct blending *blending;
    const struct target *target;
    const double *polyline; /* blending->rows × dimension */
    size_t window;          /* segments to look at on either side */
    double *means, *before; /* target->count each: workspace */
    size_t *counts;         /* the same */
};

/* positions[j] <- that of the point of the polyline nearest to point j, looked for around where it was. They
 * rise then (those that would not get their mean); on an open curve first and last stay at the ends, on a
 * closed one positions run around it at most once, from any number on. */
void feet_find(const struct feet *feet, double *positions);
/* The distance of point j from position u; the root of the weighted mean of the squares of all. */
double foot_distance(const struct feet *feet, size_t j, double position);
double feet_distance(const struct feet *feet, const double *positions);
/* The direction of the polyline there, of length 1, or 0 where two limit points coincide: dimension numbers.
 */
void foot_direction(const struct feet *feet, double position, double *direction);

#endif
