/* Constraint: a quadratic objective under one quadratic equation, in complex vectors, solved for the
 * multiplier.
 *
 *     minimize ½ x*Kx + Re x*h   subject to   ½ Re x*b + ¼ x*Bx = goal,   K positive definite, B Hermitian.
 *
 * Stationary is x(λ) = -(K + λ/2 B)^-1 (h + λ/2 b). While K + λ/2 B is positive definite x(λ) is the only
 * global minimizer for the value it has, and the value falls with λ: d/dλ = -¼ q*(K + λ/2 B)^-1 q, q = Bx +
 * b. Steps of third order (Halley's, the second derivative is ⅜ p*Bp, p = (K + λ/2 B)^-1 q) in a bracket find
 * λ. Where the goal is not reached before the matrix becomes singular, x is completed by its null vector,
 * which changes the value and not the equation. */
#ifndef MULTIRES_CONSTRAINT_H
#define MULTIRES_CONSTRAINT_H

#include "numeric/sparse_cholesky.h"

/* The matrices, whatever they are made of. Vectors are `size` complex numbers. */
struct pencil {
    size_t size;
    void *context;
    /* Factors K + θB; the two functions below need that for solve only. */
    enum sparse_outcome (*factor)(void *context, double theta);
    void (*solve)(void *context, double *x);                  /* x <- (K + θB)^-1 x */
    void (*apply)(void *context, const double *x, double *y); /* y = B x */
};

struct constraint {
    struct pencil pencil;
    const double *h, *b; /* size complex numbers each */
    double bound;        /* K + λ/2 B is singular or indefinite for |λ| beyond; infinite when it never is */
    double *x;           /* out: size complex numbers */
    double *workspace;   /* 3 × size complex numbers */
    double lambda;       /* in: where to start; out: the multiplier */
    double value;        /* out: ½ Re x*b + ¼ x*Bx */
    unsigned iterations; /* equations factored are added here */
};

enum constraint_outcome {
    CONSTRAINT_MET,
    CONSTRAINT_COMPLETED, /* met, with a share of the null vector at the end of the interval */
    CONSTRAINT_BEYOND,    /* not met: x is what came nearest */
    CONSTRAINT_MEMORY
};

/* `tolerance`: absolute, for the value. */
enum constraint_outcome constraint_meet(struct constraint *constraint, double goal, double tolerance);

#endif
