/* Spectrum: the eigenvalues and eigenvectors of one map, as they are reported. */
#ifndef ANALYSIS_SPECTRUM_H
#define ANALYSIS_SPECTRUM_H

#include <stddef.h>

#include "base/memory.h"
#include "bcifs.h"

/* By falling modulus; `count` 0 when the map leads to a state of another size. Eigenvector k is re + i im of
 * vectors[k], 2 count numbers: the real parts, then the imaginary ones. The one for 1 is the fixed point, its
 * coordinates sum to 1 where they can; the others have length 1. A defective eigenvalue has fewer vectors than its
 * multiplicity: the rest are NULL, as is one whose residual is not small. */
struct spectrum {
    const double *re, *im;
    double *const *vectors;
    size_t count;
};

/* Of the size × size matrix. */
bcifs_status spectrum_find(const double *matrix, size_t size, struct arena *arena, struct spectrum *spectrum);

#endif
