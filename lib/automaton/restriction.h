/* Restriction: the maps of a set of states on a chain of common invariant subspaces, with values.
 *
 * It begins with the linear parts on V_0 = { λ : Σλ = 0 }, in the basis of differences of consecutive control
 * points. Row vectors q^x with q^x A = c q^y for every map A : x ← y of the set cut the next space, V ∩ ker
 * q, out of it, in the basis of differences of consecutive basis vectors (weighted, where q is not constant).
 * Both polynomial reproduction and joint spectral radii want this basis: entries stay small, and rational. */
#ifndef AUTOMATON_RESTRICTION_H
#define AUTOMATON_RESTRICTION_H

#include "automaton/states.h"
#include "numeric/joint_radius.h"

enum { RESTRICTION_MOST_UNKNOWNS = 192 /* the equations take its cube in steps of arithmetic */ };

/* A number, exact in the field where `value` is, and how far value.real may be from it. */
struct bounded_value {
    struct value value;
    double error;
};

struct restricted_map {
    size_t from, to;                   /* places in the set */
    size_t child;                      /* which map of its state */
    size_t subdivisions;               /* N of its state */
    struct bounded_value *entries;     /* dimension(from) × dimension(to) */
    const struct bounded_value *whole; /* the map as it is, points(from) × points(to) */
};

struct restriction {
    size_t count;
    const size_t *states; /* in the table */
    size_t *dimensions;
    struct restricted_map *maps;
    size_t map_count;
    bool exact;           /* all entries are */
    const size_t *points; /* of the states */
    double **basis;       /* of the spaces, points × dimension; kept up only when `exact` is not set */
};

/* The set of `count` expanded states; maps that leave it are left out. */
bcifs_status restriction_begin(struct restriction *restriction, const struct states *states,
                               const size_t *list, size_t count, struct arena *arena);
/* Looks for q with q^x A = N^-k q^y for every map A : x ← y, N the number of maps of x. q[x] is NULL where
 * the dimension is 0; `found` receives how many of the q^x are not 0. Nothing is found with more than
 * RESTRICTION_MOST_UNKNOWNS coordinates. */
bcifs_status restriction_functional(const struct restriction *restriction, int k, struct arena *arena,
                                    struct value **q, size_t *found);
/* Passes on to the kernel of q. */
bcifs_status restriction_reduce(struct restriction *restriction, const struct value *const *q,
                                struct arena *arena);
/* The maps in doubles with their errors, as a constrained family; edge e is map e. */
bcifs_status restriction_family(const struct restriction *restriction, struct arena *arena,
                                struct joint_family *family);


#endif
