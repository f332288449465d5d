/* Form: the exact area and bending energy of an arc as quadratic forms in its control points
 * (design, 6.1, 6.2).
 *
 * With H the arc in barycentric coordinates, m = ∫ H dH^T - dH H^T is antisymmetric and self-similar: of a
 * state x with maps T_i into states y_i, m_x = Σ T_i m_{y_i} T_i^T, and m_x·1 = -(H(1) - H(0)). That is one
 * linear system over the states that are reached; it needs no parametrization and holds for fractal arcs as
 * long as areas converge. A piece whose control points have the coordinates X, Y contributes ½ X m Y^T to the
 * area.
 *
 * The energy ∫|c''|² of a piece of unit parameter length is X h X^T + Y h Y^T: h_x = N³ Σ T_i h_{y_i} T_i^T,
 * zero on constants and on the parameter, normalized on t².
 *
 * Both exist where a spectral radius is certified to be below 1, and the energy where, besides, t² is
 * reproduced and derivatives agree at the joints of children (docs/mathematics.md, "Area and energy"). */
#ifndef MULTIRES_FORM_H
#define MULTIRES_FORM_H

#include "automaton/states.h"

/* Per state of a table: its form, or why it has none. */
struct form {
    const struct value *values; /* points × points, row after row; NULL: there is none, see `reason` */
    const double *numbers; /* the same in doubles, the nearest where a fraction is recovered from the value */
    bool exact;            /* every entry is known in the prime field */
    const char *reason; /* in words: "the areas of its parts do not converge: …"; NULL when there is a form */
};

/* The limit points at start and end, exactly where the joints are rational: points numbers each. */
struct form_ends {
    const struct value *start, *end;
};

/* The forms of the `count` states listed and of all that they reach, which are expanded: forms[s] for every
 * state s of the table then (states->count entries in `arena`). Fails with BCIFS_INPUT only where states
 * cannot be expanded or have no limit points. A state without a form is no failure: it has a reason. */
bcifs_status forms_area(struct states *states, const size_t *list, size_t count, struct arena *arena,
                        const struct form **forms);
bcifs_status forms_energy(struct states *states, const size_t *list, size_t count, struct arena *arena,
                          const struct form **forms);
/* H(0) and H(1) of an edge state; BCIFS_INPUT, reported, where a vertex has no single limit point. */
bcifs_status form_ends_find(struct states *states, size_t state, struct arena *arena, struct form_ends *ends);

#endif
