/* Pencil: what constraint.h needs of the Hermitian matrices K - iθM, in two shapes: reduced, where K = 1 and
 * -iM = T is a real tridiagonal matrix (numeric/skew.h), and sparse, where they are factored as the real
 * symmetric matrix of twice the size that maps (x, y) to (K x + θM y, K y - θM x). */
#ifndef MULTIRES_PENCIL_H
#define MULTIRES_PENCIL_H

#include "multires/constraint.h"

struct pencil_reduced {
    size_t size;
    double *side;            /* of T: size numbers */
    double *below, *inverse; /* the factors: size numbers each */
};

struct pencil_sparse {
    const struct sparse *skew; /* M; NULL: not made */
    struct sparse pattern;     /* 2 size × 2 size: the coordinates of a complex number adjacent */
    double *fixed, *moving;    /* its values are fixed + θ moving */
    double *values;
    size_t *order;
    struct sparse_cholesky factor;
    struct arena arena; /* of the factor */
    double *workspace;  /* size complex numbers */
};

struct pencil pencil_of_reduced(struct pencil_reduced *reduced);
/* `order`: of elimination for the pattern of K and M, size indices. Made in `arena`; false when memory is
 * out. */
bool pencil_sparse_make(struct pencil_sparse *sparse, const struct sparse *k, const struct sparse *m,
                        const size_t *order, struct arena *arena);
struct pencil pencil_of_sparse(struct pencil_sparse *sparse);
/* The factor does not live in the arena that the pencil was made in. */
void pencil_sparse_free(struct pencil_sparse *sparse);
/* y = -iM x, for complex x and y. */
void pencil_apply_skew(const struct sparse *m, const double *x, double *y);

#endif
