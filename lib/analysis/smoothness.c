#include "smoothness.h"

#include <float.h>
#include <math.h>

#include "automaton/restriction.h"
#include "base/decimal.h"
#include "numeric/tolerance.h"
#include "numeric/value_equations.h"

enum {
    MOST_STATES = 256,   /* that an arc's descendants may be in */
    MOST_UNKNOWNS = 192, /* of the equations for derivatives at joints */
    MOST_DEGREE = 64
};

/* The descendants of one edge, and what has been found of them. */
struct inquiry {
    struct states *states;
    struct arena *arena; /* for all that is not reported */
    size_t *list, count;
    bool complete;            /* every descendant is in the list */
    size_t fewest, most;      /* N, over the states */
    struct restriction space; /* V_0 ∩ ker q_1 ∩ … ∩ ker q_order */
    int reproduces, order;
    struct joint_bounds bounds;
    int joints; /* derivatives of order 0 … joints agree at every joint of two children; -1: not even values
                 */
};

/* ---- The descendants ----------------------------------------------------------------------------------- */

static bcifs_status descendants_collect(struct inquiry *inquiry, size_t index)
{
    struct states *states = inquiry->states;
    inquiry->list = arena_new(inquiry->arena, MOST_STATES, sizeof *inquiry->list);
    if (!inquiry->list)
        return BCIFS_MEMORY;
    inquiry->list[inquiry->count++] = index;
    inquiry->complete = true;
    inquiry->fewest = SIZE_MAX;
    for (size_t i = 0; i < inquiry->count; i++) {
        bcifs_status status = states_expand(states, inquiry->list[i]);
        if (status)
            return status;
        const struct state *state = &states->states[inquiry->list[i]];
        size_t n = state->cell->child_count;
        inquiry->fewest = n < inquiry->fewest ? n : inquiry->fewest;
        inquiry->most = n > inquiry->most ? n : inquiry->most;
        for (size_t k = 0; k < n; k++) {
            size_t j = 0;
            while (j < inquiry->count && inquiry->list[j] != state->children[k])
                j++;
            if (j == inquiry->count && j == MOST_STATES)
                inquiry->complete = false;
            else if (j == inquiry->count)
                inquiry->list[inquiry->count++] = state->children[k];
        }
    }
    return BCIFS_OK;
}

/* ---- Polynomial reproduction --------------------------------------------------------------------------- */

/* Degree by degree, down to the last space that is not zero. A map with N = 1 has no powers to tell. */
static bcifs_status reproduction_find(struct inquiry *inquiry)
{
    struct arena *arena = inquiry->arena;
    struct value **q = arena_new(arena, inquiry->count, sizeof *q);
    if (!q)
        return BCIFS_MEMORY;
    for (int k = 1; k <= MOST_DEGREE && inquiry->fewest > 1 && inquiry->complete; k++) {
        size_t found, spaces = 0;
        bool nonzero = false;
        bcifs_status status = restriction_functional(&inquiry->space, k, arena, q, &found);
        for (size_t x = 0; x < inquiry->count; x++)
            spaces += inquiry->space.dimensions[x] > 0;
        if (status || found == 0 || found < spaces)
            return status;
        inquiry->reproduces = k;
        for (size_t x = 0; x < inquiry->count; x++)
            nonzero = nonzero || inquiry->space.dimensions[x] > 1;
        if (!nonzero)
            return BCIFS_OK;
        status = restriction_reduce(&inquiry->space, (const struct value *const *)q, arena);
        if (status)
            return status;
        inquiry->order = k;
    }
    return BCIFS_OK;
}

/* ---- Joints -------------------------------------------------------------------------------------------- */

/* One-sided derivatives: with q_l f(t) = t^l, f(t) = Σ D_l t^l near its start and f(1-s) = Σ E_l s^l near its
 * end, where N^l T_0 D^y_l = D^x_l, N^l T_N-1 E^y_l = E^x_l, q_j D_l = δ_jl and q_j E_l = (-1)^l C(j,l). */
struct jets {
    size_t *base, total; /* first coordinate of each state; of all together */
    size_t count;        /* states */
    struct value **q;    /* by degree: total coordinates, or NULL when the equations have no solution */
};

static struct value binomial(int n, int k)
{
    struct value result = value_from_integer(1);
    for (int i = 1; i <= k; i++)
        result = value_divide(value_multiply(result, value_from_integer(n - k + i)), value_from_integer(i));
    return k < 0 || k > n ? value_from_integer(0) : result;
}

static void add_to(struct value *sum, struct value term)
{
    *sum = value_add(*sum, term);
}

static struct value *zeros(struct arena *arena, size_t count)
{
    struct value *values = arena_new(arena, count, sizeof *values);
    for (size_t i = 0; values && i < count; i++)
        values[i] = value_from_integer(0);
    return values;
}

/* Where a state is in the list of descendants. */
static size_t place_of(const struct inquiry *inquiry, size_t state)
{
    size_t place = 0;
    while (inquiry->list[place] != state)
        place++;
    return place;
}

/* q_l with N^l q_l T_i = Σ_j<=l C(l,j) i^(l-j) q_j, so that q_l f(t) = t^l for the arc's uniform parameter.
 */
static bcifs_status moment_find(const struct inquiry *inquiry, struct jets *jets, int l)
{
    size_t unknowns = jets->total + 1, rows = 0, row = 0, free;
    for (size_t x = 0; x < jets->count; x++) {
        const struct state *state = &inquiry->states->states[inquiry->list[x]];
        for (size_t i = 0; i < state->cell->child_count; i++)
            rows += state->cell->children[i].map->columns;
    }
    struct value *equations = zeros(inquiry->arena, rows * unknowns),
                 *solution = zeros(inquiry->arena, unknowns);
    if (!equations || !solution)
        return BCIFS_MEMORY;
    for (size_t x = 0; x < jets->count; x++) {
        const struct state *state = &inquiry->states->states[inquiry->list[x]];
        struct value scale = value_power((int64_t)state->cell->child_count, l);
        for (size_t i = 0; i < state->cell->child_count; i++) {
            const struct value_matrix *map = state->cell->children[i].map;
            size_t y = place_of(inquiry, state->children[i]);
            for (size_t column = 0; column < map->columns; column++, row++) {
                struct value *equation = &equations[row * unknowns];
                for (size_t k = 0; k < map->rows; k++)
                    equation[jets->base[x] + k] =
                        value_multiply(scale, map->values[k * map->columns + column]);
                add_to(&equation[jets->base[y] + column], value_from_integer(-1));
                for (int j = 0; j < l; j++)
                    add_to(&equation[jets->total],
                           value_negate(
                               value_multiply(value_multiply(binomial(l, j), value_power((int64_t)i, l - j)),
                                              jets->q[j][jets->base[y] + column])));
            }
        }
    }
    bcifs_status status = equations_solve(equations, rows, unknowns, true, inquiry->arena, solution, &free);
    jets->q[l] = free > 0 ? solution : NULL;
    return status;
}

/* D_l (end false) or E_l (end true), or NULL when the equations do not determine it. */
static bcifs_status derivative_find(const struct inquiry *inquiry, const struct jets *jets, int l, bool end,
                                    struct value **derivative)
{
    size_t unknowns = jets->total + 1, row = 0, free;
    size_t rows = jets->total + jets->count * (size_t)(l + 1);
    struct value *equations = zeros(inquiry->arena, rows * unknowns),
                 *solution = zeros(inquiry->arena, unknowns);
    if (!equations || !solution)
        return BCIFS_MEMORY;
    for (size_t x = 0; x < jets->count; x++) {
        const struct state *state = &inquiry->states->states[inquiry->list[x]];
        size_t child = end ? state->cell->child_count - 1 : 0, y = place_of(inquiry, state->children[child]);
        const struct value_matrix *map = state->cell->children[child].map;
        struct value scale = value_power((int64_t)state->cell->child_count, l);
        for (size_t i = 0; i < map->rows; i++, row++) {
            for (size_t j = 0; j < map->columns; j++)
                equations[row * unknowns + jets->base[y] + j] =
                    value_multiply(scale, map->values[i * map->columns + j]);
            add_to(&equations[row * unknowns + jets->base[x] + i], value_from_integer(-1));
        }
        for (int j = 0; j <= l; j++, row++) {
            for (size_t i = 0; i < state->points; i++)
                equations[row * unknowns + jets->base[x] + i] = jets->q[j][jets->base[x] + i];
            struct value moment = end ? binomial(j, l) : value_from_integer(j == l);
            equations[row * unknowns + jets->total] = end && l % 2 == 1 ? moment : value_negate(moment);
        }
    }
    bcifs_status status = equations_solve(equations, rows, unknowns, true, inquiry->arena, solution, &free);
    *derivative = free == 1 ? solution : NULL;
    return status;
}

/* Whether T_i E_l (-1)^l = T_i+1 D_l at every joint of two children of every state. */
static bool derivatives_agree(const struct inquiry *inquiry, const struct jets *jets, int l,
                              const struct value *start, const struct value *end)
{
    for (size_t x = 0; x < jets->count; x++) {
        const struct state *state = &inquiry->states->states[inquiry->list[x]];
        for (size_t i = 0; i + 1 < state->cell->child_count; i++) {
            const struct value_matrix *left = state->cell->children[i].map,
                                      *right = state->cell->children[i + 1].map;
            const struct value *e = end + jets->base[place_of(inquiry, state->children[i])];
            const struct value *d = start + jets->base[place_of(inquiry, state->children[i + 1])];
            for (size_t row = 0; row < state->points; row++) {
                struct value sum = value_from_integer(0);
                double size = 0;
                for (size_t j = 0; j < left->columns; j++) {
                    struct value term = value_multiply(left->values[row * left->columns + j], e[j]);
                    add_to(&sum, l % 2 ? value_negate(term) : term);
                    size += fabs(term.real);
                }
                for (size_t j = 0; j < right->columns; j++)
                    add_to(&sum, value_negate(value_multiply(right->values[row * right->columns + j], d[j])));
                if (sum.exact ? sum.residue != 0 : fabs(sum.real) > TOLERANCE_REPRODUCTION * (1 + size))
                    return false;
            }
        }
    }
    return true;
}

/* Up to which order the one-sided derivatives agree, at most `most`. */
static bcifs_status joints_examine(struct inquiry *inquiry, int most)
{
    struct jets jets = {.count = inquiry->count};
    bcifs_status status = BCIFS_OK;
    inquiry->joints = -1;
    jets.base = arena_new(inquiry->arena, inquiry->count + 1, sizeof *jets.base);
    jets.q = arena_new(inquiry->arena, MOST_DEGREE + 1, sizeof *jets.q);
    if (!jets.base || !jets.q)
        return BCIFS_MEMORY;
    for (size_t x = 0; x < inquiry->count; x++)
        jets.base[x + 1] = jets.base[x] + inquiry->states->states[inquiry->list[x]].points;
    jets.total = jets.base[inquiry->count];
    if (jets.total > MOST_UNKNOWNS || !inquiry->complete)
        return BCIFS_OK;
    for (int l = 0; l <= most && l <= inquiry->order; l++) {
        status = l > 0 ? moment_find(inquiry, &jets, l) : BCIFS_OK;
        if (l == 0) {
            jets.q[0] = arena_new(inquiry->arena, jets.total, sizeof **jets.q);
            for (size_t i = 0; jets.q[0] && i < jets.total; i++)
                jets.q[0][i] = value_from_integer(1);
        }
        if (status || (l == 0 && !jets.q[0]))
            return status ? status : BCIFS_MEMORY;
        if (!jets.q[l])
            return BCIFS_OK;
    }
    for (int l = 0; l <= most && l <= inquiry->order; l++) {
        struct value *start = NULL, *end = NULL;
        status = derivative_find(inquiry, &jets, l, false, &start);
        if (status == BCIFS_OK)
            status = derivative_find(inquiry, &jets, l, true, &end);
        if (status || !start || !end || !derivatives_agree(inquiry, &jets, l, start, end))
            return status;
        inquiry->joints = l;
    }
    return BCIFS_OK;
}

/* ---- The exponent -------------------------------------------------------------------------------------- */

/* -log_N ρ, rounded up or down; the logarithm of a power of N is exact. */
static double exponent(double radius, size_t n, bool upward)
{
    if (radius == 0 || (n < 2 && upward))
        return INFINITY;
    if (n < 2)
        return 0;
    double value = -log(radius) / log((double)n), nearest = nearbyint(value), product = 1;
    for (int k = 0; k < nearest && k < 1000; k++)
        product /= (double)n;
    bool dyadic = (n & (n - 1)) == 0; /* then the quotients are exact */
    if (dyadic && nearest >= 0 && nearest < 1000 && product == radius)
        return nearest;
    double margin = 8 * DBL_EPSILON * (1 + fabs(value));
    return upward ? value + margin : value - margin;
}

/* Without a common N the parameter's length after n subdivisions lies between most^-n and fewest^-n; both
 * bounds hold for ρ on either side of 1. */
static void exponents_find(const struct inquiry *inquiry, struct smoothness *smoothness)
{
    const struct joint_bounds *bounds = &inquiry->bounds;
    size_t few = inquiry->fewest, most = inquiry->most;
    smoothness->exact = bounds->exact && few == most;
    smoothness->holder_upper = exponent(bounds->lower, bounds->lower < 1 ? few : most, true);
    smoothness->holder_lower = fmin(0, smoothness->holder_upper); /* nothing is known */
    if (isfinite(bounds->upper))
        smoothness->holder_lower = exponent(bounds->upper, bounds->upper < 1 ? most : few, false);
}

static void append_short(struct text *text, double number)
{
    char digits[DECIMAL_LONGEST + 1];
    digits[decimal_print_digits(digits, number, 8)] = '\0';
    text_append(text, digits);
}

/* "radius 0.25 (arc: 0) on the kernel of q_0 … q_1: closed formula; …". */
static const char *certificate_text(const struct inquiry *inquiry, struct arena *arena)
{
    struct text text = {0};
    const struct joint_bounds *bounds = &inquiry->bounds;
    const char *method = joint_bounds_text(bounds, inquiry->arena);
    text_append(&text, "joint spectral radius ");
    append_short(&text, bounds->lower);
    if (!bounds->exact) {
        text_append(&text, " to ");
        append_short(&text, bounds->upper);
    }
    if (bounds->length > 0) {
        const struct restricted_map *first = &inquiry->space.maps[bounds->product[0]];
        text_append(&text, " (");
        state_name(&inquiry->states->states[inquiry->list[first->from]].key, &text);
        text_append(&text, ":");
        for (size_t k = 0; k < bounds->length; k++)
            text_format(&text, " %lu", (unsigned long)inquiry->space.maps[bounds->product[k]].child);
        text_append(&text, ")");
    }
    text_format(&text, " on the kernel of q_0%s", inquiry->order > 0 ? " … q_" : "");
    if (inquiry->order > 0)
        text_format(&text, "%d", inquiry->order);
    text_append(&text, inquiry->space.exact ? " (exact)" : " (numerical)");
    text_format(&text, ": %s", method ? method : "");
    if (inquiry->fewest != inquiry->most)
        text_append(&text, "; the states subdivide differently, so the exponents are bounds only");
    if (!inquiry->complete)
        text_append(&text, "; too many states are reached to bound them all");
    const char *copy = text.failed || !method ? NULL : arena_text(arena, text.data, text.length);
    text_free(&text);
    return copy;
}

/* C^k needs an exponent above k on both sides of every joint, and equal derivatives there up to order k. */
static bcifs_status continuity_find(struct inquiry *inquiry, struct smoothness *smoothness)
{
    int most = inquiry->order;
    while (most >= 0 && !(smoothness->holder_lower > most))
        most--;
    bcifs_status status = joints_examine(inquiry, most);
    smoothness->continuity = inquiry->joints;
    return status;
}

static bcifs_status find(struct inquiry *inquiry, size_t index, double effort, struct arena *arena,
                         struct smoothness *smoothness)
{
    struct joint_family family;
    bcifs_status status = descendants_collect(inquiry, index);
    if (status == BCIFS_OK)
        status = restriction_begin(&inquiry->space, inquiry->states, inquiry->list, inquiry->count,
                                   inquiry->arena);
    if (status == BCIFS_OK)
        status = reproduction_find(inquiry);
    if (status == BCIFS_OK)
        status = restriction_family(&inquiry->space, inquiry->arena, &family);
    if (status == BCIFS_OK)
        status = joint_radius_find(&family, effort, inquiry->arena, &inquiry->bounds);
    if (status)
        return status;
    if (!inquiry->complete) {
        inquiry->bounds.upper = INFINITY;
        inquiry->bounds.exact = false;
    }
    smoothness->reproduces = inquiry->reproduces;
    exponents_find(inquiry, smoothness);
    status = continuity_find(inquiry, smoothness);
    if (status)
        return status;
    smoothness->certificate = certificate_text(inquiry, arena);
    return smoothness->certificate ? BCIFS_OK : BCIFS_MEMORY;
}

bcifs_status smoothness_find(struct states *states, size_t index, double effort, struct arena *arena,
                             struct smoothness *smoothness)
{
    struct arena own = {0};
    struct inquiry inquiry = {.states = states, .arena = &own};
    *smoothness = (struct smoothness){.continuity = -1, .certificate = ""};
    bcifs_status status = find(&inquiry, index, effort, arena, smoothness);
    arena_free(&own);
    return status;
}
