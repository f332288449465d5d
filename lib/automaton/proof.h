/* Proof: the equations of every state, decided in exact arithmetic (design, sections 3 and 4).
 *
 * Each state is elaborated several times, its free params and arguments replaced by independent random elements of
 * the prime field. Both sides of an equation are multiplied out there. If they agree every time the equation is an
 * identity, up to a probability of (degree / 2^61)^rounds < 2^-100; if they ever differ it is refuted, and doubles
 * are searched for values at which one can see it. Entries that are not rational are compared in doubles. */
#ifndef AUTOMATON_PROOF_H
#define AUTOMATON_PROOF_H

#include "automaton/cell.h"
#include "automaton/radius.h"

enum { PROOF_ROUNDS = 3 };

/* How the free quantities of a sample are chosen. */
enum sample_kind {
    SAMPLE_ACTUAL,  /* parameters at their values, arguments 1: numbers */
    SAMPLE_PROVING, /* random residues; in doubles, parameters at their values and arguments small fractions */
    SAMPLE_WITNESS  /* numbers again, parameters and arguments at random places of their ranges */
};

/* One choice of parameters and arguments for a state. */
struct sample {
    struct setting setting;
    struct state_key key;
    struct value *parameters, *arguments;
};

/* Whether sizes of the state depend on its arguments, so that it cannot be elaborated for free ones. */
bool definition_is_structural(const struct definition *definition);
/* Makes a sample; `seed` tells samples of one kind apart. `fixed`, when not NULL, holds arguments of which the
 * structural ones are kept. */
bcifs_status sample_take(const bcifs_automaton *automaton, const struct definition *definition,
                         const struct value *fixed, enum sample_kind kind, uint64_t seed, struct arena *arena,
                         struct report *report, struct sample *sample);

/* A state as it is told in reports. */
struct state_summary {
    const char *name;
    enum cell_kind kind;
    size_t points;
    size_t child_count, boundary_count;
    const char **children;       /* state names */
    const char **boundaries;     /* names, and the names of their states */
    const char **boundary_states;
};

/* Where an equation's map or boundary stands. */
struct equation_place {
    const struct source *source;
    source_place place;
};

struct bcifs_check {
    struct arena arena;
    const bcifs_automaton *automaton;
    bcifs_equation *equations;
    struct equation_place *places; /* one for each equation */
    size_t count, capacity, place_capacity;
    struct state_summary *states;
    size_t state_count, state_capacity;
    bool valid;
    struct radius radius; /* of the linear parts */
};

#endif
