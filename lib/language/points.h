/* Points: control points as comma-separated text, one a row. */
#ifndef LANGUAGE_POINTS_H
#define LANGUAGE_POINTS_H

#include "language/report.h"
#include "language/source.h"

/* As bcifs_points_read, of a source that was read. `points` is to be freed with memory_free. */
bcifs_status points_from_source(const struct source *source, struct report *report, double **points,
                                size_t *count, unsigned *dimension);

#endif
