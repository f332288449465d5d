#include "expression.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/decimal.h"
#include "numeric/field.h"

/* ---- Built-in names ------------------------------------------------------------------------------------ */

enum builtin { PI, SQRT, SIN, COS, TAN, EXP, LOG, ABS, MIN, MAX, BUILTIN_COUNT };

static const struct {
    const char *name;
    size_t arguments;
} builtins[BUILTIN_COUNT] = {
    [PI] = {"pi", 0},   [SQRT] = {"sqrt", 1}, [SIN] = {"sin", 1}, [COS] = {"cos", 1}, [TAN] = {"tan", 1},
    [EXP] = {"exp", 1}, [LOG] = {"log", 1},   [ABS] = {"abs", 1}, [MIN] = {"min", 2}, [MAX] = {"max", 2},
};

static int builtin_find(const char *name)
{
    for (int i = 0; i < BUILTIN_COUNT; i++)
        if (strcmp(name, builtins[i].name) == 0)
            return i;
    return -1;
}

bool name_is_builtin(const char *name)
{
    return builtin_find(name) >= 0;
}

/* ---- Resolving names ----------------------------------------------------------------------------------- */

struct resolver {
    const struct scope *scope;
    const char *const *arguments;
    size_t argument_count;
    const char *locals[EVALUATION_MOST_LOCALS];
    size_t local_count;
    unsigned let_depth;
    uint32_t depth, deepest; /* levels above the node that is being resolved, and of the deepest one so far */
    const struct source *source;
    struct report *report;
};

static bcifs_status resolve(struct resolver *resolver, struct expression *expression);

static bcifs_status unknown_name(const struct resolver *resolver, const struct expression *expression)
{
    enum { MOST = 256 };
    const char *candidates[MOST];
    size_t count = 0;
    for (size_t i = 0; i < resolver->local_count; i++)
        candidates[count++] = resolver->locals[i];
    for (size_t i = 0; i < resolver->argument_count && count < MOST; i++)
        candidates[count++] = resolver->arguments[i];
    for (size_t i = 0; i < BUILTIN_COUNT && count < MOST; i++)
        candidates[count++] = builtins[i].name;
    for (size_t i = 0; i < resolver->scope->parameter_count && count < MOST; i++)
        candidates[count++] = resolver->scope->parameters[i]->name;
    for (size_t i = 0; i < resolver->scope->let_count && count < MOST; i++)
        candidates[count++] = resolver->scope->lets[i]->name;
    const char *nearest = nearest_word(expression->name, candidates, count);
    const char *what = expression->kind == EXPRESSION_CALL ? "function" : "name";
    if (nearest)
        return report_error(resolver->report, resolver->source, expression->place,
                            "unknown %s '%s'; did you mean '%s'?", what, expression->name, nearest);
    return report_error(resolver->report, resolver->source, expression->place, "unknown %s '%s'", what,
                        expression->name);
}

static struct syntax_let *let_find(const struct scope *scope, const char *name)
{
    for (size_t i = 0; i < scope->let_count; i++)
        if (strcmp(scope->lets[i]->name, name) == 0)
            return scope->lets[i];
    return NULL;
}

/* Counts the levels below a node; every walk over a resolved tree, lets included, is as deep at most. */
static bcifs_status deepen(struct resolver *resolver, const struct expression *expression, uint32_t levels)
{
    if (levels > EVALUATION_DEEPEST - resolver->depth)
        return report_error(resolver->report, resolver->source, expression->place,
                            "expressions go more than %d levels deep", EVALUATION_DEEPEST);
    if (resolver->depth + levels > resolver->deepest)
        resolver->deepest = resolver->depth + levels;
    return BCIFS_OK;
}

static bcifs_status resolve_body(const struct resolver *resolver, struct syntax_let *let)
{
    struct resolver inner = {.scope = resolver->scope,
                             .arguments = let->arguments,
                             .argument_count = let->argument_count,
                             .let_depth = resolver->let_depth + 1,
                             .depth = resolver->depth,
                             .source = resolver->source,
                             .report = resolver->report};
    let->resolving = 1;
    bcifs_status status = resolve(&inner, let->value);
    let->resolving = status ? 3 : 2;
    let->height = inner.deepest > resolver->depth ? inner.deepest - resolver->depth : 0;
    return status;
}

/* Resolves the body of a let once; one that needs itself, or a chain too long to evaluate, is an error. */
static bcifs_status resolve_let(struct resolver *resolver, const struct expression *use, struct syntax_let *let)
{
    if (let->resolving == 2)
        return deepen(resolver, use, let->height);
    if (let->resolving == 3) /* its mistake has been reported */
        return BCIFS_INPUT;
    if (let->resolving == 1)
        return report_error(resolver->report, resolver->source, use->place, "'%s' is defined by itself",
                            let->name);
    if (resolver->let_depth >= EVALUATION_DEEPEST_LET)
        return report_error(resolver->report, resolver->source, use->place,
                            "more than %d lets that call each other", EVALUATION_DEEPEST_LET);
    bcifs_status status = resolve_body(resolver, let);
    return status ? status : deepen(resolver, use, let->height);
}

bcifs_status let_resolve(struct syntax_let *let, const struct scope *scope, const struct source *source,
                         struct report *report)
{
    struct resolver resolver = {.scope = scope, .source = source, .report = report};
    return let->resolving ? BCIFS_OK : resolve_body(&resolver, let);
}

static bcifs_status check_count(const struct resolver *resolver, const struct expression *expression,
                                size_t wanted)
{
    if (expression->count == wanted)
        return BCIFS_OK;
    return report_error(resolver->report, resolver->source, expression->place,
                        "'%s' takes %zu argument%s, found %zu", expression->name, wanted,
                        wanted == 1 ? "" : "s", expression->count);
}

/* Binds to a value that has no arguments of its own: a local, an argument or a param. */
static bool resolve_value(const struct resolver *resolver, struct expression *expression)
{
    for (size_t i = resolver->local_count; i-- > 0;)
        if (strcmp(resolver->locals[i], expression->name) == 0) {
            expression->binding = BINDING_LOCAL;
            expression->index = (uint32_t)i;
            return true;
        }
    for (size_t i = 0; i < resolver->argument_count; i++)
        if (strcmp(resolver->arguments[i], expression->name) == 0) {
            expression->binding = BINDING_ARGUMENT;
            expression->index = (uint32_t)i;
            return true;
        }
    for (size_t i = 0; i < resolver->scope->parameter_count; i++)
        if (strcmp(resolver->scope->parameters[i]->name, expression->name) == 0) {
            expression->binding = BINDING_PARAMETER;
            expression->index = resolver->scope->parameters[i]->index;
            return true;
        }
    return false;
}

static bcifs_status resolve_name(struct resolver *resolver, struct expression *expression)
{
    if (resolve_value(resolver, expression)) {
        if (expression->kind == EXPRESSION_CALL)
            return report_error(resolver->report, resolver->source, expression->place,
                                "'%s' is a number, not a function", expression->name);
        return BCIFS_OK;
    }
    struct syntax_let *let = let_find(resolver->scope, expression->name);
    if (let) {
        expression->binding = BINDING_LET;
        expression->let = let;
        bcifs_status status = resolve_let(resolver, expression, let);
        return status ? status : check_count(resolver, expression, let->argument_count);
    }
    int builtin = builtin_find(expression->name);
    if (builtin >= 0) {
        expression->binding = BINDING_BUILTIN;
        expression->index = (uint32_t)builtin;
        return check_count(resolver, expression, builtins[builtin].arguments);
    }
    return unknown_name(resolver, expression);
}

static bcifs_status resolve_sum(struct resolver *resolver, struct expression *expression)
{
    bcifs_status status = resolve(resolver, expression->operands[0]);
    bcifs_status other = resolve(resolver, expression->operands[1]);
    if (status || other)
        return status ? status : other;
    if (resolver->local_count == EVALUATION_MOST_LOCALS)
        return report_error(resolver->report, resolver->source, expression->place,
                            "more than %d loops inside each other", EVALUATION_MOST_LOCALS);
    resolver->locals[resolver->local_count++] = expression->name;
    status = resolve(resolver, expression->operands[2]);
    resolver->local_count--;
    return status;
}

static bcifs_status resolve_operands(struct resolver *resolver, struct expression *expression)
{
    if (expression->kind == EXPRESSION_SUM)
        return resolve_sum(resolver, expression);
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < expression->count; i++) {
        bcifs_status operand = resolve(resolver, expression->operands[i]);
        status = status ? status : operand;
    }
    if (expression->kind == EXPRESSION_NAME || expression->kind == EXPRESSION_CALL) {
        bcifs_status name = resolve_name(resolver, expression);
        status = status ? status : name;
    }
    return status;
}

static bcifs_status resolve(struct resolver *resolver, struct expression *expression)
{
    bcifs_status status = deepen(resolver, expression, 1);
    if (status)
        return status;
    resolver->depth++;
    status = resolve_operands(resolver, expression);
    resolver->depth--;
    return status;
}

bcifs_status expression_resolve(struct expression *expression, const struct scope *scope,
                                const char *const *arguments, size_t argument_count,
                                const char *const *locals, size_t local_count, const struct source *source,
                                struct report *report)
{
    struct resolver resolver = {.scope = scope,
                                .arguments = arguments,
                                .argument_count = argument_count,
                                .local_count = local_count,
                                .source = source,
                                .report = report};
    if (local_count >= EVALUATION_MOST_LOCALS)
        return report_error(report, source, expression->place, "more than %d loops inside each other",
                            EVALUATION_MOST_LOCALS);
    for (size_t i = 0; i < local_count; i++)
        resolver.locals[i] = locals[i];
    return resolve(&resolver, expression);
}

void expression_mark(const struct expression *expression, bool *parameters, bool *arguments)
{
    for (size_t i = 0; i < expression->count; i++)
        expression_mark(expression->operands[i], parameters, arguments);
    if (expression->binding == BINDING_PARAMETER)
        parameters[expression->index] = true;
    if (expression->binding == BINDING_ARGUMENT && arguments)
        arguments[expression->index] = true;
    /* The flag keeps chains of lets from being walked once for every path through them. */
    if (expression->binding == BINDING_LET && !expression->let->structural) {
        expression->let->structural = true;
        expression_mark(expression->let->value, parameters, NULL);
    }
}

/* ---- Evaluation ---------------------------------------------------------------------------------------- */

static bcifs_status complain(const struct environment *environment, source_place place, const char *format,
                             ...) TEXT_FORMAT(3, 4);

static bcifs_status complain(const struct environment *environment, source_place place, const char *format,
                             ...)
{
    char message[512];
    if (!environment->report)
        return BCIFS_INPUT;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return report_error(environment->report, environment->source, place, "%s", message);
}

/* Refuses a result that is not finite; while proving, an exact one has its residue to go on with. */
static bcifs_status check_finite(const struct expression *expression, const struct environment *environment,
                                 const struct value *value)
{
    if (isfinite(value->real) || (environment->proving && value->exact))
        return BCIFS_OK;
    return complain(environment, expression->place, "the result is not a finite number");
}

static bcifs_status evaluate_divide(const struct expression *expression, struct environment *environment,
                                    struct value a, struct value b, struct value *value)
{
    /* An exact divisor is zero when its residue is: 0.1 + 0.2 - 0.3 too. */
    if (value_is_zero(b) || (b.real == 0 && !environment->proving))
        return complain(environment, expression->place, "division by zero");
    *value = value_divide(a, b);
    return check_finite(expression, environment, value);
}

static bool is_integer(struct value value)
{
    return fabs(value.real) < 9007199254740992.0 && value.real == floor(value.real);
}

/* a - b floor(a/b), the sign of b. */
static bcifs_status evaluate_remainder(const struct expression *expression, struct environment *environment,
                                       struct value a, struct value b, struct value *value)
{
    if (b.real == 0)
        return complain(environment, expression->place, "division by zero");
    double remainder = a.real - b.real * floor(a.real / b.real);
    if (a.fixed && b.fixed && is_integer(a) && is_integer(b))
        *value = value_from_integer((int64_t)remainder);
    else
        *value = value_from_real(remainder);
    return check_finite(expression, environment, value);
}

static bcifs_status evaluate_power(const struct expression *expression, struct environment *environment,
                                   struct value a, struct value b, struct value *value)
{
    *value = value_from_real(pow(a.real, b.real));
    if (a.exact && b.fixed && is_integer(b) && fabs(b.real) <= 1 << 20) {
        bool negative = b.real < 0;
        if (negative && value_is_zero(a))
            return complain(environment, expression->place, "division by zero");
        uint64_t residue = field_power(a.residue, (uint64_t)fabs(b.real));
        value->residue = negative ? field_invert(residue) : residue;
        value->exact = true;
        value->fixed = a.fixed;
    }
    return check_finite(expression, environment, value);
}

static bcifs_status evaluate_binary(const struct expression *expression, struct environment *environment,
                                    struct value a, struct value b, struct value *value)
{
    switch (expression->kind) {
    case EXPRESSION_ADD:
        *value = value_add(a, b);
        break;
    case EXPRESSION_SUBTRACT:
        *value = value_subtract(a, b);
        break;
    case EXPRESSION_MULTIPLY:
        *value = value_multiply(a, b);
        break;
    case EXPRESSION_DIVIDE:
        return evaluate_divide(expression, environment, a, b, value);
    case EXPRESSION_REMAINDER:
        return evaluate_remainder(expression, environment, a, b, value);
    default:
        return evaluate_power(expression, environment, a, b, value);
    }
    return check_finite(expression, environment, value);
}

/* abs, min and max choose one of their operands, by the doubles; that is exact while both are what they seem.
 */
static struct value choose(struct value a, struct value b, bool first)
{
    struct value chosen = first ? a : b;
    return a.fixed && b.fixed ? chosen : value_from_real(chosen.real);
}

static bcifs_status evaluate_builtin(const struct expression *expression, struct environment *environment,
                                     struct value *value)
{
    struct value a = {0}, b = {0};
    if (expression->count > 0) {
        bcifs_status status = expression_evaluate(expression->operands[0], environment, &a);
        if (status == BCIFS_OK && expression->count > 1)
            status = expression_evaluate(expression->operands[1], environment, &b);
        if (status)
            return status;
    }
    switch ((enum builtin)expression->index) {
    case PI:
        *value = value_from_real(3.14159265358979323846);
        break;
    case SQRT:
        *value = value_from_real(sqrt(a.real));
        break;
    case SIN:
        *value = value_from_real(sin(a.real));
        break;
    case COS:
        *value = value_from_real(cos(a.real));
        break;
    case TAN:
        *value = value_from_real(tan(a.real));
        break;
    case EXP:
        *value = value_from_real(exp(a.real));
        break;
    case LOG:
        *value = value_from_real(log(a.real));
        break;
    case ABS:
        *value = choose(a, value_negate(a), a.real >= 0);
        break;
    case MIN:
        *value = choose(a, b, a.real <= b.real);
        break;
    case MAX:
    case BUILTIN_COUNT:
        *value = choose(a, b, a.real >= b.real);
        break;
    }
    return check_finite(expression, environment, value);
}

/* Kept out of evaluate_node, whose recursion is deep, because of the room for arguments. */
#if defined(__GNUC__)
__attribute__((noinline))
#endif
static bcifs_status evaluate_let(const struct expression *expression, struct environment *environment,
                                 struct value *value)
{
    struct value arguments[SYNTAX_MOST_ARGUMENTS];
    for (size_t i = 0; i < expression->count; i++) {
        bcifs_status status = expression_evaluate(expression->operands[i], environment, &arguments[i]);
        if (status)
            return status;
    }
    if (environment->let_depth >= EVALUATION_DEEPEST_LET)
        return complain(environment, expression->place, "more than %d lets that call each other",
                        EVALUATION_DEEPEST_LET);
    const struct value *outer = environment->arguments;
    environment->arguments = arguments;
    environment->let_depth++;
    bcifs_status status = expression_evaluate(expression->let->value, environment, value);
    environment->let_depth--;
    environment->arguments = outer;
    return status;
}

static bcifs_status evaluate_name(const struct expression *expression, struct environment *environment,
                                  struct value *value)
{
    switch (expression->binding) {
    case BINDING_PARAMETER:
        if (expression->index >= environment->known)
            return complain(environment, expression->place,
                            "'%s' has no value yet: a param may use those above it", expression->name);
        *value = environment->parameters[expression->index];
        return BCIFS_OK;
    case BINDING_ARGUMENT:
        *value = environment->arguments[expression->index];
        return BCIFS_OK;
    case BINDING_LOCAL:
        *value = environment->locals[expression->index];
        return BCIFS_OK;
    case BINDING_LET:
        return evaluate_let(expression, environment, value);
    case BINDING_BUILTIN:
        return evaluate_builtin(expression, environment, value);
    case BINDING_NONE:
        break;
    }
    return complain(environment, expression->place, "'%s' has no value here", expression->name);
}

/* Enters a loop from operands[0] to operands[1] (or from, to): its variable becomes the innermost local. */
static bcifs_status loop_bounds(const struct expression *from, const struct expression *to,
                                struct environment *environment, int64_t *low, int64_t *high)
{
    bcifs_status status = expression_integer(from, environment, "start of the range", -1000000, 1000000, low);
    if (status == BCIFS_OK)
        status = expression_integer(to, environment, "end of the range", -1000000, 1000000, high);
    return status;
}

static bcifs_status evaluate_sum(const struct expression *expression, struct environment *environment,
                                 struct value *value)
{
    int64_t low, high;
    bcifs_status status =
        loop_bounds(expression->operands[0], expression->operands[1], environment, &low, &high);
    *value = value_from_integer(0);
    size_t local = environment->local_count++;
    for (int64_t i = low; status == BCIFS_OK && i <= high; i++) {
        struct value term;
        environment->locals[local] = value_from_integer(i);
        status = expression_evaluate(expression->operands[2], environment, &term);
        if (status == BCIFS_OK)
            *value = value_add(*value, term);
    }
    environment->local_count = local;
    return status ? status : check_finite(expression, environment, value);
}

static bcifs_status evaluate_node(const struct expression *expression, struct environment *environment,
                                  struct value *value)
{
    struct value a, b;
    bcifs_status status;
    switch (expression->kind) {
    case EXPRESSION_NUMBER:
        *value = (struct value){expression->number, expression->exact ? expression->residue : 0,
                                expression->exact, expression->exact};
        return BCIFS_OK;
    case EXPRESSION_NAME:
    case EXPRESSION_CALL:
        return evaluate_name(expression, environment, value);
    case EXPRESSION_NEGATE:
        status = expression_evaluate(expression->operands[0], environment, &a);
        *value = value_negate(a);
        return status;
    case EXPRESSION_POINT:
        return complain(environment, expression->place, "a control point p[…] cannot stand here");
    case EXPRESSION_SUM:
        return evaluate_sum(expression, environment, value);
    case EXPRESSION_UNKNOWN:
        return complain(environment, expression->place, "an entry '?' has no value");
    default:
        status = expression_evaluate(expression->operands[0], environment, &a);
        if (status == BCIFS_OK)
            status = expression_evaluate(expression->operands[1], environment, &b);
        return status ? status : evaluate_binary(expression, environment, a, b, value);
    }
}

/* Counts a step and a level; both are given back to the input that asked for too many. */
static bcifs_status enter(const struct expression *expression, struct environment *environment)
{
    if (environment->steps == 0)
        return complain(environment, expression->place, "this takes more than %d steps to evaluate",
                        EVALUATION_MOST_STEPS);
    environment->steps--;
    if (environment->depth >= EVALUATION_DEEPEST)
        return complain(environment, expression->place, "expressions go more than %d levels deep",
                        EVALUATION_DEEPEST);
    environment->depth++;
    return BCIFS_OK;
}

bcifs_status expression_evaluate(const struct expression *expression, struct environment *environment,
                                 struct value *value)
{
    *value = value_from_integer(0);
    bcifs_status status = enter(expression, environment);
    if (status)
        return status;
    status = evaluate_node(expression, environment, value);
    environment->depth--;
    return status;
}

bcifs_status expression_integer(const struct expression *expression, struct environment *environment,
                                const char *what, int64_t low, int64_t high, int64_t *integer)
{
    struct value value;
    bcifs_status status = expression_evaluate(expression, environment, &value);
    if (status)
        return status;
    char digits[DECIMAL_LONGEST + 1] = "";
    if (isfinite(value.real))
        digits[decimal_print(digits, value.real)] = '\0';
    double nearest = round(value.real);
    if (!(fabs(value.real - nearest) <= 1e-9))
        return complain(environment, expression->place, "the %s must be an integer, found %s", what, digits);
    if (nearest < (double)low || nearest > (double)high)
        return complain(environment, expression->place, "the %s must lie in %lld..%lld, found %s", what,
                        (long long)low, (long long)high, digits);
    *integer = (int64_t)nearest;
    return BCIFS_OK;
}

/* ---- Linear expressions -------------------------------------------------------------------------------- */

/* Whether p[…] occurs; counted as steps, because it is asked again at every level. */
static bool has_point(const struct expression *expression, struct environment *environment)
{
    if (environment->steps > 0)
        environment->steps--;
    if (expression->kind == EXPRESSION_POINT)
        return true;
    for (size_t i = 0; i < expression->count; i++)
        if (has_point(expression->operands[i], environment))
            return true;
    return false;
}

static bcifs_status linear(const struct expression *expression, struct environment *environment,
                           struct value scale, struct value *column, size_t count);

static bcifs_status linear_point(const struct expression *expression, struct environment *environment,
                                 struct value scale, struct value *column, size_t count)
{
    int64_t index;
    bcifs_status status =
        expression_integer(expression->operands[0], environment, "index of p", 0, (int64_t)count - 1, &index);
    if (status == BCIFS_OK)
        column[index] = value_add(column[index], scale);
    return status;
}

/* A product with one factor linear in p, or a quotient with a linear numerator. */
static bcifs_status linear_scaled(const struct expression *expression, struct environment *environment,
                                  struct value scale, struct value *column, size_t count)
{
    const struct expression *left = expression->operands[0], *right = expression->operands[1];
    bool left_linear = has_point(left, environment), right_linear = has_point(right, environment);
    if (left_linear && right_linear)
        return complain(environment, expression->place, "a product of control points is not linear");
    const struct expression *inner = left_linear ? left : right, *factor = left_linear ? right : left;
    struct value value;
    bcifs_status status = expression_evaluate(factor, environment, &value);
    if (status)
        return status;
    if (expression->kind == EXPRESSION_MULTIPLY)
        return linear(inner, environment, value_multiply(scale, value), column, count);
    if (right_linear)
        return complain(environment, expression->place, "a quotient by control points is not linear");
    struct value quotient;
    status = evaluate_divide(expression, environment, scale, value, &quotient);
    return status ? status : linear(inner, environment, quotient, column, count);
}

static bcifs_status linear_sum(const struct expression *expression, struct environment *environment,
                               struct value scale, struct value *column, size_t count)
{
    int64_t low, high;
    bcifs_status status =
        loop_bounds(expression->operands[0], expression->operands[1], environment, &low, &high);
    size_t local = environment->local_count++;
    for (int64_t i = low; status == BCIFS_OK && i <= high; i++) {
        environment->locals[local] = value_from_integer(i);
        status = linear(expression->operands[2], environment, scale, column, count);
    }
    environment->local_count = local;
    return status;
}

/* A part without control points adds nothing only when it is zero. */
static bcifs_status linear_constant(const struct expression *expression, struct environment *environment)
{
    struct value value;
    bcifs_status status = expression_evaluate(expression, environment, &value);
    if (status == BCIFS_OK && !value_is_zero(value))
        status = complain(environment, expression->place,
                          "a new point is a sum of multiples of p[…]; this term has none");
    return status;
}

static bcifs_status linear(const struct expression *expression, struct environment *environment,
                           struct value scale, struct value *column, size_t count)
{
    bcifs_status status = enter(expression, environment);
    if (status)
        return status;
    if (!has_point(expression, environment)) {
        environment->depth--;
        return linear_constant(expression, environment);
    }
    switch (expression->kind) {
    case EXPRESSION_POINT:
        status = linear_point(expression, environment, scale, column, count);
        break;
    case EXPRESSION_NEGATE:
        status = linear(expression->operands[0], environment, value_negate(scale), column, count);
        break;
    case EXPRESSION_ADD:
    case EXPRESSION_SUBTRACT:
        status = linear(expression->operands[0], environment, scale, column, count);
        if (status == BCIFS_OK && expression->kind == EXPRESSION_SUBTRACT)
            scale = value_negate(scale);
        if (status == BCIFS_OK)
            status = linear(expression->operands[1], environment, scale, column, count);
        break;
    case EXPRESSION_MULTIPLY:
    case EXPRESSION_DIVIDE:
        status = linear_scaled(expression, environment, scale, column, count);
        break;
    case EXPRESSION_SUM:
        status = linear_sum(expression, environment, scale, column, count);
        break;
    default:
        status = complain(environment, expression->place, "this is not linear in the control points p[…]");
        break;
    }
    environment->depth--;
    return status;
}

bcifs_status expression_linear(const struct expression *expression, struct environment *environment,
                               struct value scale, struct value *column, size_t count)
{
    return linear(expression, environment, scale, column, count);
}
