/* Glyphs: the letters of pixel pictures, drawn for this purpose on a grid of 5 × 9: seven rows above the base
 * line, two below. ASCII letters and digits, what numbers, names and equations need; a box for everything
 * else. */
#ifndef OUTPUT_GLYPHS_H
#define OUTPUT_GLYPHS_H

#include "output/raster.h"

enum { GLYPH_ASCENT = 7, GLYPH_DESCENT = 2 };

/* The width of a text (UTF-8) in grid units; letters are as wide as they are, with one unit between them. */
unsigned glyphs_width(const char *text);
/* Covers a text whose base line begins at pixel (x, y), at `scale` pixels to the unit. */
void glyphs_cover(struct canvas *canvas, long x, long y, unsigned scale, const char *text);

#endif
