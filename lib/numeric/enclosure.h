/* Enclosure: bounds that hold in exact arithmetic although they are computed in doubles.
 *
 * Every matrix here stands for all matrices within `error` of it in the norm |A| = largest absolute row sum.
 * That norm does not see signs, so the rounding of a product is bounded by the norms of its factors alone:
 * |fl(A·B) - A·B| <= γ_n |A| |B|, γ_n = n u / (1 - n u), u = 2^-53 (Higham, Accuracy and Stability of
 * Numerical Algorithms, 2002, 3.5). Every result is rounded outward; no rounding mode is changed. */
#ifndef NUMERIC_ENCLOSURE_H
#define NUMERIC_ENCLOSURE_H

#include <complex.h>
#include <stddef.h>

#include "base/memory.h"

/* A number not below (not above) the exact result of which x is a rounded version with at most `operations`
 * rounding errors, all of them of positive terms. */
double round_up(double x, size_t operations);
double round_down(double x, size_t operations);

/* Not below the largest absolute row sum of A, rows × columns. */
double row_norm(const double *a, size_t rows, size_t columns);

/* C = A·B as matrix_multiply; returns a bound of the error of C when A and B have the errors `error_a`,
 * `error_b` and norms at most `norm_a`, `norm_b`. */
double multiply_enclosed(const double *a, double norm_a, double error_a, const double *b, double norm_b,
                         double error_b, size_t rows, size_t inner, size_t columns, double *c);

/* Elimination with partial pivoting: B <- A^-1 B, A size × size (destroyed), B size × columns. A pivot
 * smaller than `tiny` is replaced by it: inverse iteration wants the blow-up. Nothing is certified. */
void complex_solve(double complex *a, double complex *b, size_t size, size_t columns, double tiny);

/* lower <= ρ(A) <= upper for all A within `error` of the size × size matrix. By Gershgorin's discs after a
 * similarity to (nearly) diagonal form, and by traces, which need no eigenvectors. False: no memory. */
int spectral_radius_enclose(const double *a, size_t size, double error, struct arena *arena, double *lower,
                            double *upper);

#endif
