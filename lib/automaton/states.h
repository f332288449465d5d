/* States: the finite table of states that are reached from given ones, with their matrices in doubles.
 *
 * A state is a definition with argument values; the same definition with equal arguments is the same state
 * (design, section 3, "Parameters"). Equality is decided in the prime field where the values are rational, so that
 * rounding does not make two states of one. Cells are elaborated when a state is first expanded. */
#ifndef AUTOMATON_STATES_H
#define AUTOMATON_STATES_H

#include "automaton/cell.h"

enum { STATES_MOST = 1 << 16 };

struct state {
    struct state_key key;
    size_t points;
    bool expanded;
    /* Once expanded: */
    const struct cell *cell;
    const size_t *children;     /* states of the maps */
    const double *const *maps;  /* points × points of the child */
    const size_t *boundaries;   /* states of the boundaries */
    const double *const *operators; /* points × points of the boundary's state */
};

struct states {
    struct arena *arena;
    struct setting setting;
    struct state *states;
    size_t count, capacity;
    size_t *buckets; /* open addressing: index + 1 */
    size_t bucket_count;
};

bcifs_status states_create(struct states *states, struct arena *arena, const struct setting *setting);
/* A table that starts with the same states and may grow on its own, in `arena`. */
bcifs_status states_copy(struct states *copy, const struct states *states, struct arena *arena,
                         struct report *report);
/* The index of a state, added if it is new; BCIFS_INPUT beyond STATES_MOST. */
bcifs_status states_intern(struct states *states, struct state_key key, size_t *index);
/* Elaborates the state and interns its children and boundaries. */
bcifs_status states_expand(struct states *states, size_t index);
/* The limit point of a state under its first map again and again, in its barycentric coordinates (`point`: as many
 * numbers as the state has points). For the vertex state of a joint it is c^s, [IM] (3). */
bcifs_status states_limit(struct states *states, size_t index, double *point);
/* Reports that a state has no single limit point, and why; returns BCIFS_INPUT. */
bcifs_status states_limit_refuse(const struct states *states, size_t index, const char *reason);
/* column = Π_β v: a point of boundary `boundary`, carried into the state's own coordinates. */
bcifs_status states_boundary_point(struct states *states, size_t index, int boundary, const double *point,
                                   double *column);
/* The limit point at the start (or end) of an edge state; for a cell that of its first map. */
bcifs_status states_end_limit(struct states *states, size_t index, bool at_end, double *column);
/* "p(1,2,1)": a state's name with its arguments, for messages. */
void state_name(const struct state_key *key, struct text *text);

#endif
