/* Equations: the barycentric, incidence and adjacency equations of an automaton with open entries `?`, as
 * linear equations between these (design, section 3; [SI] "Résolution des contraintes").
 *
 * Every entry of every matrix equation is one equation Σ factor·unknown + known = 0: boundaries are known,
 * and a map occurs once in each product. Its known part may depend on the file's params, linearly; a param
 * that enters otherwise is fixed at its value ("pinned"). What depends on what is found by elaborating the
 * states for several values of the params and arguments, not by looking at formulas. */
#ifndef AUTOMATON_EQUATIONS_H
#define AUTOMATON_EQUATIONS_H

#include "automaton/proof.h"
#include "numeric/elimination.h"

enum { EQUATIONS_MOST = 1 << 16, EQUATIONS_MOST_UNKNOWNS = 4096, EQUATIONS_MOST_TERMS = 1 << 21 };

/* One entry `?` of the main file. */
struct open_entry {
    const struct expression *expression;
    const struct syntax_cell *cell;
    bool diagonal; /* it stands on the diagonal of a map */
};

/* One entry of a matrix equation. */
struct entry_equation {
    const char *state;
    bcifs_equation_kind kind;
    const char *text; /* of the matrix equation, "T0·end = T1·start" */
    size_t row, column;
    const struct source *source;
    source_place place;
    const char *reason; /* not NULL: it fails for another cause than numbers, in words */
    /* Columns: unknowns, then the automaton's parameters, then the number 1. */
    const struct linear_term *terms;
    size_t count;
};

struct equations {
    struct arena *arena;
    const bcifs_automaton *automaton;
    struct report *report;
    struct open_entry *unknowns;      /* automaton->unknowns */
    bool *pinned;                     /* per parameter: taken at its value */
    bool *used;                       /* per parameter: some equation between unknowns has it */
    struct entry_equation *equations; /* those with unknowns, and those without that fail */
    size_t count, capacity;
    size_t posed; /* all entries of all matrix equations */
    size_t terms;
};

/* Poses all equations of the states that are written in files; those of products follow from their factors'.
 * Refuses, in words, what is not linear, not rational, or not the same for all arguments of a state. */
bcifs_status equations_pose(const bcifs_automaton *automaton, struct arena *arena, struct report *report,
                            struct equations *equations);

#endif
