/* SVG transform: the attribute `transform`, a product of affine maps of the plane (SVG 1.1, 7.6). */
#ifndef LANGUAGE_SVG_TRANSFORM_H
#define LANGUAGE_SVG_TRANSFORM_H

#include "language/svg_numbers.h"

/* (x, y) ↦ (a x + c y + e, b x + d y + f). */
struct svg_transform {
    double a, b, c, d, e, f;
};

#define SVG_IDENTITY ((struct svg_transform){.a = 1, .d = 1})

/* transform <- transform · (the attribute's value). */
bcifs_status svg_transform_read(struct svg_cursor *cursor, struct svg_transform *transform);
void svg_transform_apply(const struct svg_transform *transform, const double point[2], double image[2]);

#endif
