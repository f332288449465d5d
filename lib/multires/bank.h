/* Bank: decomposition of a curve into a coarse curve and details, and its exact inverse ([MR] section 2, figure 1).
 *
 * Between two levels x^j = P x^{j-1} + Q d^{j-1}. Closed uniform curves use short filters A, B where there are some
 * (filters.h): x^{j-1} = A x^j, d^{j-1} = B x^j. All others the semi-orthogonal ones: scale coefficients by least
 * squares, (P^T P) x^{j-1} = P^T x^j, and details in the local basis Q of what is orthogonal to P (complement.h),
 * (Q^T Q) d^{j-1} = Q^T (x^j - P x^{j-1}). Both systems are banded, so that everything is linear in the number of
 * points.
 *
 * Coefficients stand as in [MR] (12): (x^L, d^L, d^{L+1}, …, d^{n-1}), each level with its chains one after the other. */
#ifndef MULTIRES_BANK_H
#define MULTIRES_BANK_H

#include "multires/complement.h"
#include "multires/filters.h"
#include "multires/ladder.h"
#include "numeric/sparse_cholesky.h"

enum { BANK_WORKSPACE = 6 };

/* A chain between a coarser rung and the next finer one. */
struct bank_step {
    size_t coarse, details, fine; /* points, details, points */
    struct stencil refinement;    /* P */
    struct stencil wavelet;       /* Q^T */
    bool refined;                 /* decomposed twice, against rounding */
    bool filtered;                /* by: */
    struct stencil smooth, detail, synthesis; /* A, B, Q; otherwise by: */
    struct sparse_cholesky coarse_gram, detail_gram; /* P^T P, Q^T Q */
};

struct bank {
    struct arena *arena;
    const struct ladder *ladder;
    unsigned bottom, top;     /* rungs: steps lead from each to the next */
    struct bank_step **steps; /* steps[rung - bottom][chain] */
    size_t count;             /* coefficients: points of the top rung */
    size_t scale;             /* those of x^L: points of the bottom rung */
    size_t widest;            /* coarse points or details of any step */
};

/* The bank of a ladder between two of its rungs. BCIFS_INPUT with the reason where a level has no bank. */
bcifs_status bank_create(struct bank *bank, const struct ladder *ladder, unsigned bottom, unsigned top,
                         struct arena *arena, struct report *report);
/* Where the details of a rung begin among the coefficients; x^L is before them. */
size_t bank_details_at(const struct bank *bank, unsigned rung);
/* Points of the top rung to coefficients and back: count × components numbers each, distinct. `workspace` holds
 * BANK_WORKSPACE × count × components numbers. */
void bank_decompose(const struct bank *bank, const double *points, size_t components, double *coefficients,
                    double *workspace);
void bank_reconstruct(const struct bank *bank, const double *coefficients, size_t components, double *points,
                      double *workspace);

#endif
