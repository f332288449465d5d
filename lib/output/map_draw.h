/* Map drawing: a parameter map as a picture: fields of color over one or two axes, what the colors mean, and
 * the exact conditions where they are known. Vectors and pixels show the same; letters differ. */
#ifndef OUTPUT_MAP_DRAW_H
#define OUTPUT_MAP_DRAW_H

#include "analysis/parameter_map.h"
#include "output/file.h"
#include "output/job.h"

bcifs_status map_svg_write(const bcifs_map *map, const struct job *job, struct file *file);
bcifs_status map_png_write(const bcifs_map *map, const struct job *job, struct file *file);

#endif
