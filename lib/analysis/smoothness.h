/* Smoothness: what can be certified of the regularity of an arc's blending functions (design 6.6).
 *
 * Row vectors q_0, q_1, … with q_k T_i = N^-k q_k + lower ones say which polynomials are reproduced. On the common
 * kernel of q_0 … q_k, the largest k with a kernel that is not zero, the joint spectral radius ρ of the restricted
 * maps gives the Hölder exponent -log_N ρ: that of the arc away from its joints. What happens at the joints of its
 * children is examined apart, and only the continuity speaks of the whole arc (docs/mathematics.md, "Smoothness").
 * Certificates of numbers that are known in doubles only rest on the equations for q_k, which hold to
 * TOLERANCE_REPRODUCTION. */
#ifndef ANALYSIS_SMOOTHNESS_H
#define ANALYSIS_SMOOTHNESS_H

#include "automaton/states.h"

struct smoothness {
    int reproduces;                    /* degree of the polynomials that are reproduced, at least 0 */
    double holder_lower, holder_upper; /* certified: rounding is accounted for; the upper one may be infinite */
    bool exact;                        /* both are the same number up to rounding: the product's exponent */
    int continuity;                    /* largest k with C^k certified, -1 if none */
    const char *certificate;           /* its kind and size, in words */
};

/* For the edge state `index` of the table, which may grow. `effort` scales the search, 1 is usual. */
bcifs_status smoothness_find(struct states *states, size_t index, double effort, struct arena *arena,
                             struct smoothness *smoothness);

#endif
