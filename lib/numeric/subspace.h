/* Subspace: spans and null spaces of small dense matrices, with rank decided by a stated tolerance. */
#ifndef NUMERIC_SUBSPACE_H
#define NUMERIC_SUBSPACE_H

#include <stdbool.h>
#include <stddef.h>

/* Adds `vector` (size numbers, destroyed) to an orthonormal basis of `*count` vectors of `size` numbers each, one
 * after the other, unless it lies in their span up to TOLERANCE_RANK times its length. Returns whether it was
 * added; `basis` must have room. */
bool subspace_add(double *basis, size_t *count, size_t size, double *vector);

/* An orthonormal basis of { x : A x = 0 }; A is rows × columns (destroyed), a pivot counts as zero below
 * `tolerance`. `null` receives up to `columns` vectors of `columns` numbers each; `order` is workspace for `columns`
 * indices, `workspace` for `columns` numbers. Returns their number. */
size_t null_space(double *a, size_t rows, size_t columns, double tolerance, double *null, size_t *order,
                  double *workspace);

#endif
