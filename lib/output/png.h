/* PNG: a canvas as a file, with the words of its job. */
#ifndef OUTPUT_PNG_H
#define OUTPUT_PNG_H

#include "output/file.h"
#include "output/job.h"
#include "output/raster.h"

bcifs_status png_canvas_write(const struct job *job, const struct canvas *canvas, struct file *file);

#endif
