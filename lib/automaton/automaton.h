/* Automaton: a file, with everything it uses, whose names are resolved.
 *
 * It holds definitions (states of cells as the file writes them, with arguments and parameters still free),
 * parameters and figures. Numbers come in when a definition is elaborated (cell.h) for given parameters and
 * arguments. After binding an automaton never changes, so any number of threads may read it. */
#ifndef AUTOMATON_AUTOMATON_H
#define AUTOMATON_AUTOMATON_H

#include "language/report.h"
#include "language/syntax.h"
#include "language/expression.h"

enum {
    AUTOMATON_MOST_MODULES = 64,
    AUTOMATON_MOST_DEFINITIONS = 4096, /* products of products included */
    AUTOMATON_MOST_ITEMS = 1 << 16
};

/* One file: the main one, or one brought in by `use`. */
struct module {
    const struct source *source;
    struct syntax_file *syntax;
    const char *name;     /* "" for the main file, otherwise what its definitions are prefixed with */
    struct module *owner; /* whose `use` brought it in; NULL for the main file */
    struct scope *scope;  /* its params and lets */
};

struct parameter {
    const char *name; /* qualified: "bezier.w" */
    struct module *module;
    struct syntax_parameter *syntax;
    struct value value; /* for which numbers are computed: the file's or the one that was set */
    bool has_range;
    double low, high;
    bool is_set;     /* fixed by the caller: equations are checked for this value only */
    bool structural; /* counts, indices or ranges depend on it: never replaced by a random residue */
};

enum definition_form {
    DEFINITION_WRITTEN, /* a cell of the file */
    DEFINITION_PRODUCT, /* factors[0] * factors[1], [IM] 6.1 */
    DEFINITION_JOINT    /* the vertex state that `refine` and `mask` imply, [IM] (9) */
};

/* A state of cells, as written. */
struct definition {
    enum definition_form form;
    enum cell_kind kind;
    const char *name; /* qualified */
    struct module *module;
    struct syntax_cell *syntax;     /* WRITTEN; JOINT: the edge it belongs to */
    size_t argument_count;
    bool structural[2 * SYNTAX_MOST_ARGUMENTS]; /* per argument, as for a parameter */
    struct definition *factors[2];              /* PRODUCT */
    struct reference *factor_references[2];     /* a written product's own references, or NULL: arguments pass */
    struct definition *joint;                   /* the generated joint of an edge with `refine` or `mask`, or NULL */
    struct definition *edge;                    /* JOINT: whose */
};

/* A reference to a state, resolved. */
struct reference {
    struct definition *definition;
    struct expression **arguments; /* definition->argument_count expressions, or NULL when none were written */
    source_place place;
};

struct figure_definition {
    const char *name;
    struct module *module;
    struct syntax_figure *syntax;
};

struct bcifs_automaton {
    struct arena arena;
    struct module **modules; /* [0] is the main file */
    size_t module_count, module_capacity;
    struct definition **definitions; /* in order of the files; generated ones after them */
    size_t definition_count, definition_capacity;
    struct parameter *parameters;
    size_t parameter_count, parameter_capacity;
    const struct value *values; /* of the parameters, as expressions want them */
    struct figure_definition *figures; /* of the main file */
    size_t figure_count, figure_capacity;
    bool is_full;    /* there were more definitions than the limit */
    size_t unknowns; /* entries `?` */
};

/* The definition of the product a * b, made on first request during binding; products of the states that bound a
 * product are made along with it. NULL when there is none. */
struct definition *automaton_product(const bcifs_automaton *automaton, const struct definition *a,
                                     const struct definition *b);

#endif
