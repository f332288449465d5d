/* Area matrix drawing: the blocks of an area matrix as figure 3 of [MR] shows them, the entries that are not zero dark. */
#ifndef OUTPUT_AREA_MATRIX_DRAW_H
#define OUTPUT_AREA_MATRIX_DRAW_H

#include "multires/area_matrix.h"
#include "output/file.h"
#include "output/job.h"

bcifs_status area_matrix_svg_write(const bcifs_area_matrix *matrix, const struct job *job, struct file *file);
bcifs_status area_matrix_png_write(const bcifs_area_matrix *matrix, const struct job *job, struct file *file);

#endif
