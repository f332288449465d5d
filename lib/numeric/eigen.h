/* Eigen: eigenvalues of a real matrix, by balancing, Hessenberg form and the shifted QR iteration.
 *
 * The classical algorithms of the Handbook (Wilkinson and Reinsch, 1971: balance, elmhes, hqr). */
#ifndef NUMERIC_EIGEN_H
#define NUMERIC_EIGEN_H

#include <stdbool.h>
#include <stddef.h>

/* The eigenvalues of A (size × size, destroyed) to real[size], imaginary[size], by falling modulus. False when the
 * iteration does not converge (in practice: entries that are not finite). */
bool eigenvalues(double *a, size_t size, double *real, double *imaginary);

/* The largest modulus of an eigenvalue; A is destroyed, `workspace` holds 2 size numbers. NaN without
 * convergence. */
double spectral_radius(double *a, size_t size, double *workspace);

#endif
