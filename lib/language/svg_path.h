/* SVG path: path data (SVG 1.1, 8.3) as an outline: the commands M L H V C S Z, absolute and relative.
 *
 * SVG's y axis points down, that of bcifs up; y is negated, so that the outline stands upright in its
 * pictures. */
#ifndef LANGUAGE_SVG_PATH_H
#define LANGUAGE_SVG_PATH_H

#include "language/outline.h"
#include "language/svg_transform.h"

/* Reads the value of `d` under `transform`. `outline` is empty and of dimension 2; on failure its points may
 * have been allocated. */
bcifs_status svg_path_read(struct svg_cursor *cursor, const struct svg_transform *transform,
                           struct bcifs_curve *outline);

#endif
