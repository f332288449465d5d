/* Moments: the row vectors that read powers of the parameter off an arc, q_l·H(t) = t^l, and the one-sided
 * derivatives at its ends.
 *
 * Every child of a state takes an equal share of the parameter, so N^l q_l^x T_i = Σ_j<=l C(l,j) i^(l-j)
 * q_j^y (docs/mathematics.md, "Smoothness"). q_0 is 1, q_1 is called ℓ and q_2 is called q below
 * (design, 6.2). */
#ifndef MULTIRES_MOMENTS_H
#define MULTIRES_MOMENTS_H

#include "automaton/reach.h"

enum {
    MOMENTS_MOST_UNKNOWNS = 300 /* of one component's equations, which take its cube in steps of arithmetic */
};

/* Rows by place in the reach, one number for each control point; NULL where there is none. */
struct moments {
    const struct value **unit, **parameter, **square; /* q_0, ℓ, q */
};

/* Those of degree 0 to `degree`, at most 2. */
bcifs_status moments_find(const struct states *states, const struct reach *reach, int degree,
                          struct arena *arena, struct moments *moments);
/* Whether, for component `c`, the derivatives D = H'(0) and E = H'(1) are determined (N T_0 D^y = D^x,
 * N T_N-1 E^y = E^x, ℓD = ℓE = 1) and agree at all joints of children, T_i E = T_i+1 D. `starts` and `ends`,
 * by place, hold those of children's components and receive the component's own. */
bcifs_status derivatives_join(const struct states *states, const struct reach *reach,
                              const struct moments *moments, size_t c, struct arena *arena,
                              const struct value **starts, const struct value **ends, bool *determined,
                              bool *agree);

#endif
