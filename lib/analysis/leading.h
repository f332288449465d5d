/* Leading: what the powers of a matrix do to vectors in the long run.
 *
 * M^n u ~ C(n, q-1) Σ λ^(n-q+1) K u over the eigenvalues of largest modulus with the largest Jordan block, size q;
 * K = (M - λ)^(q-1) P with the spectral projector P. The direction of M^n u settles exactly when one such
 * eigenvalue remains, it is positive, and K has rank 1, K = v ℓ: then it is that of (ℓ·u) v ([SI], "Rappel sur les
 * tangentes", where the eigenvalue is simple). */
#ifndef ANALYSIS_LEADING_H
#define ANALYSIS_LEADING_H

#include "base/memory.h"
#include "bcifs.h"

enum leading_kind {
    LEADING_SETTLES,  /* one positive eigenvalue, one direction */
    LEADING_FANS,     /* one positive eigenvalue with several directions */
    LEADING_NEGATIVE, /* the direction turns to its opposite each time */
    LEADING_SPIRALS,  /* a complex pair */
    LEADING_TIED,     /* several eigenvalues of the same modulus */
    LEADING_VANISHES, /* nilpotent: the powers become 0 */
    LEADING_UNKNOWN   /* the eigenvalues were not found */
};

struct leading {
    enum leading_kind kind;
    double re, im;       /* the eigenvalue (the one of positive imaginary part of a pair) */
    size_t multiplicity; /* algebraic, of that eigenvalue */
    size_t block;        /* q */
    double *direction;   /* v, `size` numbers of length 1 (LEADING_SETTLES) */
    double *functional;  /* ℓ, `size` numbers */
};

/* M is size × size. The vectors are allocated in `arena`. */
bcifs_status leading_find(const double *m, size_t size, struct arena *arena, struct leading *leading);

#endif
