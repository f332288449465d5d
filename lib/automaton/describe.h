/* Describe: one representative of every state of an automaton, with its class and its levels of description.
 *
 * A definition with arguments stands for many states. The one that is told about is the first that a figure
 * of the file reaches; without any, all its arguments are 1. */
#ifndef AUTOMATON_DESCRIBE_H
#define AUTOMATON_DESCRIBE_H

#include "automaton/levels.h"

struct described {
    const struct definition *definition;
    bool known;   /* a representative was found; otherwise `reason` says why not */
    size_t state; /* in the table of states */
    const char *reason;
    /* Of an edge: */
    struct level_class class;
    const struct value_matrix *fused; /* T_÷, or NULL */
    const double *refinement; /* of the level asked for: points × columns; NULL: refinement_reason says why */
    size_t columns;
    const char *refinement_reason;
    struct level_masks masks;
    int interpolating; /* -1: not known, interpolating_reason says why */
    const char *interpolating_reason;
};

struct bcifs_description {
    struct arena arena;
    const bcifs_automaton *automaton;
    struct states states;
    unsigned depth; /* level of the refinement matrices */
    struct described *states_told;
    size_t count;
};

/* The index of a state of this definition in a table that states_of_figures made: the first there, otherwise
 * one with all arguments 1. `known` is false when its sizes depend on arguments that no figure gives. */
bcifs_status representative_find(struct states *states, const struct definition *definition, size_t *index,
                                 bool *known);

#endif
