/* Filters: short analysis and synthesis filters for a closed uniform curve, [MR] (4): P A + Q B = I with all four of
 * compact support.
 *
 * The refinement matrix of such a curve repeats one block. Where its step is 1 there are, as a rule, filters that repeat
 * too. A file may declare them (`wavelet`); otherwise they are derived: B from the complement of P; A the shortest
 * solution of A·P = I, centered on the column of P it belongs to, and of all those of its length the one of least norm,
 * so that a mirrored scheme has mirrored filters; Q from A·Q = 0, B·Q = I over growing supports. Filters of a repeating
 * P serve closed curves of every size, for P, A, B and Q wrap alike. */
#ifndef MULTIRES_FILTERS_H
#define MULTIRES_FILTERS_H

#include "automaton/automaton.h"
#include "bcifs.h"
#include "numeric/stencil.h"

/* The filters of one level. */
struct filters {
    struct stencil smooth;  /* A: coarse points × fine points */
    struct stencil detail;  /* B: details × fine points */
    struct stencil wavelet;   /* Q^T: details × fine points */
    struct stencil synthesis; /* Q: fine points × details */
};

/* Derives filters for P. `found` is false when P does not repeat a block of step 1, or has no short filters. The only
 * failure is BCIFS_MEMORY. */
bcifs_status filters_derive(const struct stencil *refinement, struct arena *arena, struct filters *filters,
                            bool *found);

/* The filters that a file declares for a state, with their values for the params. */
struct declared_filters {
    const struct module *module;
    const struct syntax_wavelet *syntax;
    const double *smooth, *detail; /* coefficients, from the offsets that the declaration gives */
    size_t smooth_count, detail_count;
    const double *wavelet; /* column 0 of Q */
    ptrdiff_t wavelet_first;
    size_t wavelet_count;
};

/* NULL without a declaration. With `fine` = (x_2i, x_2i+1) the filters are a 2 × 2 matrix of polynomials in the shift; it
 * has the inverse (P, Q) with short filters when A·P = I, B·P = 0 and its determinant is one power of the shift. All
 * three are decided exactly where the entries are rational; a declaration that fails is an error that shows the product. */
bcifs_status filters_declared(const bcifs_automaton *automaton, const struct definition *definition,
                              struct arena *arena, struct report *report, const struct declared_filters **declared);
/* The same filters for P, whose blocks are of two rows and step 1. */
bcifs_status filters_apply_declared(const struct stencil *refinement, const struct declared_filters *declared,
                                    struct arena *arena, struct filters *filters, bool *found);

#endif
