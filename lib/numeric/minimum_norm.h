/* Minimum norm: the shortest vector that satisfies a few linear equations, when they agree. */
#ifndef NUMERIC_MINIMUM_NORM_H
#define NUMERIC_MINIMUM_NORM_H

#include <stdbool.h>
#include <stddef.h>

/* x = argmin ‖x‖, G x = b; G is rows × unknowns, b rows × 1, both destroyed. The rows are made orthonormal one after
 * the other, b along with them; a row within the span of those before it up to TOLERANCE_RANK must agree with them.
 * False when the equations contradict each other. */
bool minimum_norm_solve(double *g, double *b, size_t rows, size_t unknowns, double *x);

#endif
