/* Sparse Cholesky: A = L·L^T of a sparse symmetric positive definite matrix, its rows taken in a given order.
 *
 * Up-looking factorization along the elimination tree (Davis, Direct Methods for Sparse Linear Systems, 2006,
 * chapter 4): cost and storage follow the entries of L. For a band with corners, as closed curves have, they
 * are linear in the size. */
#ifndef NUMERIC_SPARSE_CHOLESKY_H
#define NUMERIC_SPARSE_CHOLESKY_H

#include "numeric/sparse.h"

struct sparse_cholesky {
    size_t size;
    const size_t *order;  /* row i of L stands for row order[i] of A; NULL: i */
    const size_t *starts; /* L^T by rows, that is L by columns; the diagonal first */
    const uint32_t *rows;
    const double *values;
    const double *inverses; /* 1/L_jj: solutions multiply where a division would make them wait */
};

enum sparse_outcome { SPARSE_DONE, SPARSE_INDEFINITE, SPARSE_MEMORY };

/* Factors A (size × size, symmetric; both halves are held). `order` (may be NULL) is a permutation and must
 * outlive the factor. SPARSE_INDEFINITE: a pivot is not above TOLERANCE_SINGULAR times the diagonal entry it
 * comes from, so that the units of single rows do not matter. */
enum sparse_outcome sparse_cholesky_factor(const struct sparse *a, const size_t *order, struct arena *arena,
                                           struct sparse_cholesky *factor);
/* x <- A^-1 x; x is size × components. `workspace` holds size × components numbers. */
void sparse_cholesky_solve(const struct sparse_cholesky *factor, double *x, size_t components,
                           double *workspace);
/* The halves of that, with A = P^T L·L^T P: x <- L^-1 P x and x <- P^T L^-T x. */
void sparse_cholesky_lower(const struct sparse_cholesky *factor, double *x, size_t components,
                           double *workspace);
void sparse_cholesky_upper(const struct sparse_cholesky *factor, double *x, size_t components,
                           double *workspace);
/* An order with little fill-in, size indices to `order`: that of the matrix, its reverse (which eliminates
 * fine details before coarse ones), reverse Cuthill-McKee, or minimum degree, whichever makes the fewest
 * entries of L. What does not promise to beat the best is given up early, so that the cost stays near that of
 * the best factorization. False when memory is out. */
bool sparse_order(const struct sparse *a, size_t *order);

#endif
