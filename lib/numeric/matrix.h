/* Matrix: dense matrices of doubles, row after row, small enough that nothing is blocked. */
#ifndef NUMERIC_MATRIX_H
#define NUMERIC_MATRIX_H

#include <stdbool.h>
#include <stddef.h>

/* C = A·B; A is rows × inner, B inner × columns, C rows × columns and distinct from both. */
void matrix_multiply(const double *a, const double *b, size_t rows, size_t inner, size_t columns, double *c);

/* Solves A x = b in place by elimination with full pivoting. A is size × size (destroyed), b size × 1 (in: b,
 * out: x), `order` workspace of `size` indices. False when A is singular: a pivot is below TOLERANCE_SINGULAR
 * times the largest entry. */
bool matrix_solve(double *a, double *b, size_t size, size_t *order);

/* The fixed point of T with coordinates that sum to 1: T c = c, 1·c = 1. T is size × size with columns that sum
 * to 1. `workspace` holds size × size + 2 size numbers, `order` size indices. False when there is not exactly
 * one. The result is refined once, so that it is accurate to a few units in the last place. */
bool matrix_fixed_point(const double *t, size_t size, double *point, double *workspace, size_t *order);

#endif
