/* Expression: names to what they stand for, and syntax trees to values.
 *
 * Doubles and the prime field are computed in one pass over one tree, so they cannot disagree about what a
 * formula means. Everything an input can drive is bounded: the height of trees by the parser, the depth of calls
 * and the number of steps here. */
#ifndef LANGUAGE_EXPRESSION_H
#define LANGUAGE_EXPRESSION_H

#include "language/report.h"
#include "language/syntax.h"
#include "numeric/value.h"

/* ---- Names --------------------------------------------------------------------------------------------- */

/* The params and lets of one file, for resolving names. */
struct scope {
    struct syntax_parameter **parameters;
    size_t parameter_count;
    struct syntax_let **lets;
    size_t let_count;
};

/* Resolves every name in `expression`: locals (of `for` and `sum`), then `arguments` of the state or let, then
 * params, lets, builtins. Lets reached on the way are resolved too; one that needs itself is an error.
 * `locals` holds the enclosing loop variables, innermost last. */
bcifs_status expression_resolve(struct expression *expression, const struct scope *scope,
                                const char *const *arguments, size_t argument_count, const char *const *locals,
                                size_t local_count, const struct source *source, struct report *report);
/* Resolves the value of a let, unless it has been: mistakes in lets that nothing uses are found too. */
bcifs_status let_resolve(struct syntax_let *let, const struct scope *scope, const struct source *source,
                         struct report *report);
/* Whether `name` is a built-in constant or function. */
bool name_is_builtin(const char *name);

/* ---- Evaluation ---------------------------------------------------------------------------------------- */

enum {
    EVALUATION_MOST_LOCALS = 64,       /* nested `for` and `sum` */
    EVALUATION_DEEPEST_LET = 64,       /* lets that call lets */
    EVALUATION_DEEPEST = 1500,         /* levels of trees below each other, through the lets that are called */
    EVALUATION_MOST_STEPS = 20 * 1000 * 1000 /* nodes visited in elaborating one state */
};

/* What names mean at the moment. `source` and `report` say where to complain; `report` NULL: be silent. */
struct environment {
    const struct value *parameters;
    size_t known; /* parameters with an index below this have a value */
    const struct value *arguments;
    struct value locals[EVALUATION_MOST_LOCALS];
    size_t local_count;
    unsigned let_depth, depth;
    uint64_t steps; /* left */
    const struct source *source;
    struct report *report;
    bool proving; /* a failure of `real` (a pole at the sample values, say) does not matter while `exact` lasts */
};

/* Fails with BCIFS_INPUT on division by zero, a result that is not finite, or an unknown `?`. */
bcifs_status expression_evaluate(const struct expression *expression, struct environment *environment,
                                 struct value *value);
/* The same where an integer in low..high is needed; `what` names it in the message ("number of control points"). */
bcifs_status expression_integer(const struct expression *expression, struct environment *environment,
                                const char *what, int64_t low, int64_t high, int64_t *integer);
/* An expression that is linear in p[0..count-1]: adds `scale` times its coefficients to column[0..count-1]. */
bcifs_status expression_linear(const struct expression *expression, struct environment *environment,
                               struct value scale, struct value *column, size_t count);

/* Marks every parameter and argument that occurs in `expression`, lets included; arrays by index. */
void expression_mark(const struct expression *expression, bool *parameters, bool *arguments);

#endif
