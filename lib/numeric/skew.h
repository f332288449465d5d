/* Skew: real antisymmetric matrices, C = Q S Q^T with Q orthogonal and S tridiagonal: zeros on the diagonal,
 * S_{k,k+1} = side_k = -S_{k+1,k}.
 *
 * The Hermitian matrices 1 - iθS are real ones in disguise: with D = diag(i^k), D*(1 - iθS)D = 1 + θT, where
 * T is symmetric, zero on the diagonal and side_k beside it. So equations with them cost no complex
 * arithmetic. T and -T have the same eigenvalues (turn the sign of every second coordinate), hence 1 + θT is
 * positive definite exactly for |θ| < 1/|T|. */
#ifndef NUMERIC_SKEW_H
#define NUMERIC_SKEW_H

#include <stdbool.h>
#include <stddef.h>

/* C = Q S Q^T by reflections (Householder). C is size × size, antisymmetric, destroyed; q: size × size, out;
 * side: size numbers, out, the last one 0; workspace: 2 size. */
void skew_reduce(double *c, size_t size, double *q, double *side, double *workspace);

/* x_k <- i^k x_k, or i^-k x_k (`back`): D x and D* x. x: size complex numbers. */
void skew_turn(double *x, size_t size, bool back);

/* 1 + θT = L P L^T, L_{k+1,k} = below_k, P = 1/inverse_k; both: size numbers, out. False when a pivot is not
 * above 0: the matrix is not positive definite. */
bool skew_factor(const double *side, size_t size, double theta, double *below, double *inverse);
/* x <- (1 + θT)^-1 x, with the factors above; x: size complex numbers. */
void skew_solve(const double *below, const double *inverse, size_t size, double *x);
/* y = T x; both: size complex numbers. */
void skew_apply(const double *side, size_t size, const double *x, double *y);
/* The largest θ for which skew_factor() finds 1 + θT positive definite, to rounding; infinite when T = 0.
 * workspace: 2 size. */
double skew_bound(const double *side, size_t size, double *workspace);

#endif
