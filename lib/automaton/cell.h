/* Cell: a state with numbers in: its maps T_i and boundaries Π_β for given parameters and arguments.
 *
 * Elaborating a definition evaluates its expressions, spreads masks, refinement matrices, rules and affine maps
 * into barycentric subdivision matrices (design, section 3), and multiplies out products ([IM] 6.1). All forms
 * end in the same cell, so that nothing after this floor knows how a state was written. */
#ifndef AUTOMATON_CELL_H
#define AUTOMATON_CELL_H

#include "automaton/automaton.h"

enum {
    CELL_MOST_POINTS = 1024,     /* control points of one state */
    CELL_MOST_CHILDREN = 4096,   /* maps of one state */
    CELL_MOST_ENTRIES = 1 << 22, /* of all its matrices together */
    CELL_MOST_BOUNDARIES = 64
};

/* A sum Σ factor · `?`: what the open entries of the file contribute to an entry of a matrix. The terms of an entry
 * as written are one, with the factor 1; affine maps add them up. */
struct unknown_term {
    size_t unknown; /* its number in the automaton, below automaton->unknowns */
    int factor;
    const struct unknown_term *next;
};

/* rows × columns values, row after row. */
struct value_matrix {
    size_t rows, columns;
    struct value *values;
    bool exact; /* every entry is */
    /* Per entry what is unknown in it, or NULL; as a whole NULL when nothing is. Products do not keep them. */
    const struct unknown_term **unknowns;
};

/* A state that a child or boundary is in: a definition and the values of its arguments. */
struct state_key {
    const struct definition *definition;
    const struct value *arguments;
};

struct cell_child {
    struct state_key state;
    const struct value_matrix *map; /* m_x × m_child */
    const struct source *source;
    source_place place;
};

struct cell_boundary {
    const char *name; /* "start", "end" of an edge; a face's own; "first.start", … of a product */
    struct state_key state;
    const struct value_matrix *operator; /* m_x × m_y */
    const size_t *indices; /* m_y control points of x when the operator selects points, otherwise NULL */
    const struct source *source;
    source_place place;
};

/* `join i.β = j.γ`: asserted, in the order of the file. */
struct cell_join {
    size_t child[2];
    const char *boundary[2];
    bool reversed;
    source_place place;
};

struct cell {
    const struct definition *definition;
    const struct value *arguments;
    size_t points; /* m_x */
    struct cell_child *children;
    size_t child_count;
    struct cell_boundary *boundaries;
    size_t boundary_count;
    struct cell_join *joins;
    size_t join_count;
    bool affine;      /* written as affine maps of R^D, D = points - 1 */
    size_t unknowns;  /* entries `?`, taken for 0 */
};

/* A form of definition elaborates in its own file; these are for cell_elaborate only. */
struct setting;
bcifs_status product_elaborate(const struct setting *setting, struct arena *arena, const struct state_key *factors,
                               struct cell *cell);

/* What parameters mean: their values (real and residue), for all elaborations of one job. */
struct setting {
    const bcifs_automaton *automaton;
    const struct value *parameters;
    struct report *report; /* NULL: fail silently */
    bool proving;
};

/* Elaborates `key` in `arena`. */
bcifs_status cell_elaborate(const struct setting *setting, struct arena *arena, struct state_key key,
                            struct cell **cell);
/* Its number of control points only. */
bcifs_status cell_points(const struct setting *setting, struct arena *arena, struct state_key key, size_t *points);
/* The values of a reference's arguments, written in a scope whose own arguments are `arguments`. */
bcifs_status reference_evaluate(const struct setting *setting, struct arena *arena,
                                const struct reference *reference, const struct module *module,
                                const struct value *arguments, struct state_key *key);
/* Whether two states are the same: definition and arguments (value_equal). */
bool state_key_equal(struct state_key a, struct state_key b);
/* The boundary called `name`, or NULL. */
const struct cell_boundary *cell_boundary_named(const struct cell *cell, const char *name);

/* Room for a matrix, all zeros, or NULL. */
struct value_matrix *value_matrix_new(struct arena *arena, size_t rows, size_t columns);
/* Whether some entry is known in doubles only; sets `exact`. */
void value_matrix_finish(struct value_matrix *matrix);
/* C = A·B in both numbers; A is rows × inner, B inner × columns. NULL when memory is out. */
struct value_matrix *value_matrix_multiply(struct arena *arena, const struct value_matrix *a,
                                           const struct value_matrix *b);

#endif
