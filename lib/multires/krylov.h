/* Krylov: an orthonormal basis of the space that a few vectors and an antisymmetric operator span.
 *
 * The operator is A = L^-1 M L^-T for M antisymmetric and K = L·L^T: in the coordinates L^T x, in which K is
 * the identity. Vectors are taken one by one from the basis, sent through A, made orthogonal to all, and
 * added: the block Lanczos method with full orthogonalization, which drops what depends on the rest. */
#ifndef MULTIRES_KRYLOV_H
#define MULTIRES_KRYLOV_H

#include "numeric/sparse_cholesky.h"

struct krylov {
    const struct sparse_cholesky *factor; /* of K */
    const struct sparse *skew;            /* M */
    size_t size, most;                    /* of vectors; how many there may be */
    size_t count, expanded;               /* vectors; those whose image lies in the space */
    double *basis;                        /* most × size: vectors one after the other */
    double *images;                       /* most × most: entry (i, j) is u_i·A u_j, j < expanded */
    double *vector, *workspace;           /* size numbers each */
    double largest;                       /* |A u| so far */
};

/* Made in `arena`; false when memory is out. */
bool krylov_make(struct krylov *space, const struct sparse_cholesky *factor, const struct sparse *skew,
                 size_t most, struct arena *arena);
/* Everything: the unit vectors. Needs most >= size. */
void krylov_fill(struct krylov *space);
/* Adds the part of `vector` (size numbers; destroyed) that the space lacks, if any and if there is room. */
void krylov_add(struct krylov *space, double *vector);
/* Grows to `count` vectors, or fewer when the space is closed under A. */
void krylov_grow(struct krylov *space, size_t count);
/* C = U^T A U for the basis U, antisymmetric: count × count. */
void krylov_project(struct krylov *space, double *c);

#endif
