/* Similar: forms of a component of states that are reproduced by its maps, C_x = N^k Σ_i T_i C_y T_i^T.
 *
 * A form lives on a space of columns of its state, those on which some functionals vanish, C = B c B^T with
 * the basis B of that space. The operator that takes forms of all states of the component to the sums on the
 * right decides whether they exist: its spectral radius is enclosed. */
#ifndef MULTIRES_SIMILAR_H
#define MULTIRES_SIMILAR_H

#include "automaton/reach.h"

enum { SIMILAR_MOST_UNKNOWNS = 300 /* entries of a component's forms; the equations take the cube */ };

/* A space of columns. Its basis is made of differences of consecutive control points, of differences of
 * these, and so on, because the maps of subdivision schemes are small there. */
struct frame {
    size_t points, dimension;
    const struct value *basis;       /* points × dimension */
    const struct value *coordinates; /* dimension × points: takes a column of the space to its coordinates */
};

/* All columns. */
bcifs_status frame_begin(struct frame *frame, size_t points, struct arena *arena);
/* Those of them on which a functional, one number for each point, vanishes. */
bcifs_status frame_cut(struct frame *frame, const struct value *functional, struct arena *arena);

struct similar {
    const struct states *states;
    const struct reach *reach;
    size_t component;
    const struct frame *frames; /* by place, of members */
    int sign;                   /* -1: antisymmetric forms, 1: symmetric ones */
    int power;                  /* k */
};

/* Entries of all forms of the component. */
size_t similar_unknowns(const struct similar *similar);
/* Bounds of the operator's spectral radius; rounding is accounted for, numbers that are known in doubles only
 * count as good to TOLERANCE_EQUATION. Where 1 lies between them it is said whether 1 is an eigenvalue: then
 * `lower` is 1. */
bcifs_status similar_radius(const struct similar *similar, struct arena *arena, double *lower, double *upper);
/* What a solution is made of; arrays are by place, forms points × points. */
struct similar_data {
    const struct value *const *known; /* forms of children outside the component */
    const struct value *const
        *parts; /* given parts of the members' forms, which are then part + B c B^T; or NULL */
    const struct value *const *functionals; /* q with q C q^T = 4; or NULL */
};
/* The members' forms, in `arena`. `solved` is false when the equations do not have exactly one solution. */
bcifs_status similar_solve(const struct similar *similar, const struct similar_data *data,
                           struct arena *arena, const struct value **forms, bool *solved);

#endif
