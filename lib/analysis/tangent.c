#include "tangent.h"

#include <math.h>
#include <string.h>

#include "base/decimal.h"
#include "base/text.h"
#include "numeric/matrix.h"
#include "numeric/subspace.h"
#include "numeric/tolerance.h"

enum { MOST_SAMPLES = 512 /* points of an arc at which the leading component is looked at */ };

/* What is known of an edge state on the way. */
struct arc {
    size_t state, points;
    double *ends[2]; /* limit points */
    double *space;   /* an orthonormal basis of the differences of its points: `dimension` vectors */
    size_t dimension;
    double *samples; /* points × sample_count */
    size_t sample_count;
};

struct finder {
    struct states *states;
    struct arena *arena;
    struct arc *arcs;
    size_t count;
    size_t *arc_of; /* per state: its arc, SIZE_MAX for other states */
};

static bcifs_status refuse(const struct finder *finder, const struct state_key *key, const char *what,
                           int limit)
{
    struct report *report = finder->states->setting.report;
    if (!report)
        return BCIFS_INPUT;
    return report_failure(report, BCIFS_INPUT, key->definition->module->source->name,
                          "'%s': tangents are found for at most %d %s", key->definition->name, limit, what);
}

/* ---- The arcs and their spaces ------------------------------------------------------------------------- */

static bcifs_status arc_add(struct finder *finder, size_t state)
{
    struct states *states = finder->states;
    const struct state_key *key = &states->states[state].key;
    size_t points = states->states[state].points;
    if (finder->count == TANGENT_MOST_STATES)
        return refuse(finder, key, "states", TANGENT_MOST_STATES);
    if (points > TANGENT_MOST_POINTS)
        return refuse(finder, key, "control points", TANGENT_MOST_POINTS);
    struct arc *arc = &finder->arcs[finder->count++];
    *arc = (struct arc){.state = state, .points = points};
    arc->space = arena_new(finder->arena, points * points, sizeof(double));
    for (int end = 0; end < 2; end++) {
        arc->ends[end] = arena_new(finder->arena, points, sizeof(double));
        if (!arc->ends[end] || !arc->space)
            return BCIFS_MEMORY;
        bcifs_status status = states_end_limit(states, state, end, arc->ends[end]);
        if (status)
            return status;
    }
    return BCIFS_OK;
}

/* Every edge state that is reached; the table grows while they are expanded. */
static bcifs_status arcs_collect(struct finder *finder)
{
    finder->arcs = arena_new(finder->arena, TANGENT_MOST_STATES, sizeof *finder->arcs);
    if (!finder->arcs)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < finder->states->count; i++) {
        const struct definition *definition = finder->states->states[i].key.definition;
        if (definition->kind != CELL_EDGE || definition->form == DEFINITION_PRODUCT)
            continue;
        bcifs_status status = states_expand(finder->states, i);
        if (status == BCIFS_OK)
            status = arc_add(finder, i);
        if (status)
            return status;
    }
    finder->arc_of = arena_new(finder->arena, finder->states->count, sizeof *finder->arc_of);
    if (!finder->arc_of)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < finder->states->count; i++)
        finder->arc_of[i] = SIZE_MAX;
    for (size_t i = 0; i < finder->count; i++)
        finder->arc_of[finder->arcs[i].state] = i;
    return BCIFS_OK;
}

static struct arc *child_arc(const struct finder *finder, const struct arc *arc, size_t child)
{
    return &finder->arcs[finder->arc_of[finder->states->states[arc->state].children[child]]];
}

/* Adds a difference of points of the arc (destroyed), unless it is rounding only: coordinates are of order 1.
 */
static void space_add(struct arc *arc, double *difference)
{
    double largest = 0, mean = 0;
    for (size_t j = 0; j < arc->points; j++)
        mean += difference[j] / (double)arc->points;
    for (size_t j = 0; j < arc->points; j++) {
        difference[j] -= mean; /* rounding: its coordinates sum to 0 */
        largest = fmax(largest, fabs(difference[j]));
    }
    if (largest > TOLERANCE_RANK)
        subspace_add(arc->space, &arc->dimension, arc->points, difference);
}

/* Adds what the children contribute: T_i (differences of child i) and T_i H_i(0) - H(0). */
static bool space_grow(const struct finder *finder, struct arc *arc)
{
    const struct state *state = &finder->states->states[arc->state];
    size_t before = arc->dimension;
    double vector[TANGENT_MOST_POINTS];
    for (size_t i = 0; i < state->cell->child_count; i++) {
        const struct arc *child = child_arc(finder, arc, i);
        matrix_multiply(state->maps[i], child->ends[0], arc->points, child->points, 1, vector);
        for (size_t j = 0; j < arc->points; j++)
            vector[j] -= arc->ends[0][j];
        space_add(arc, vector);
        for (size_t k = 0; k < child->dimension; k++) {
            matrix_multiply(state->maps[i], child->space + k * child->points, arc->points, child->points, 1,
                            vector);
            space_add(arc, vector);
        }
    }
    return arc->dimension > before;
}

static void spaces_find(struct finder *finder)
{
    for (size_t i = 0; i < finder->count; i++) {
        struct arc *arc = &finder->arcs[i];
        double chord[TANGENT_MOST_POINTS];
        for (size_t j = 0; j < arc->points; j++)
            chord[j] = arc->ends[1][j] - arc->ends[0][j];
        space_add(arc, chord);
    }
    for (bool grown = true; grown;) {
        grown = false;
        for (size_t i = 0; i < finder->count; i++)
            grown = space_grow(finder, &finder->arcs[i]) || grown;
    }
}

/* ---- Samples ------------------------------------------------------------------------------------------- */

/* The starts of all cells one level deeper: [T_0 S_0 | T_1 S_1 | …]. */
static bcifs_status samples_refine(struct finder *finder, const struct arc *below, struct arc *arc)
{
    const struct state *state = &finder->states->states[arc->state];
    size_t count = 0, column = 0;
    for (size_t i = 0; i < state->cell->child_count; i++)
        count += below[finder->arc_of[state->children[i]]].sample_count;
    double *samples = arena_new(finder->arena, arc->points * count, sizeof *samples);
    if (!samples)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < state->cell->child_count; i++) {
        const struct arc *child = &below[finder->arc_of[state->children[i]]];
        for (size_t r = 0; r < arc->points; r++)
            for (size_t k = 0; k < child->points; k++)
                for (size_t c = 0; c < child->sample_count; c++)
                    samples[r * count + column + c] +=
                        state->maps[i][r * child->points + k] * child->samples[k * child->sample_count + c];
        column += child->sample_count;
    }
    arc->samples = samples;
    arc->sample_count = count;
    return BCIFS_OK;
}

/* Limit points of every arc, as deep as MOST_SAMPLES allows for the one that has most. */
static bcifs_status samples_find(struct finder *finder)
{
    for (size_t i = 0; i < finder->count; i++) {
        finder->arcs[i].samples = finder->arcs[i].ends[0];
        finder->arcs[i].sample_count = 1;
    }
    struct arc *below = arena_new(finder->arena, finder->count, sizeof *below);
    if (!below)
        return BCIFS_MEMORY;
    for (int level = 0; level < 9; level++) {
        size_t most = 0, children = 0;
        for (size_t i = 0; i < finder->count; i++) {
            size_t own = finder->states->states[finder->arcs[i].state].cell->child_count;
            most = finder->arcs[i].sample_count > most ? finder->arcs[i].sample_count : most;
            children = own > children ? own : children;
        }
        if (most * children > MOST_SAMPLES && level > 0)
            break;
        memcpy(below, finder->arcs, finder->count * sizeof *below);
        for (size_t i = 0; i < finder->count; i++) {
            bcifs_status status = samples_refine(finder, below, &finder->arcs[i]);
            if (status)
                return status;
        }
    }
    return BCIFS_OK;
}

/* ---- One end of an arc --------------------------------------------------------------------------------- */

/* The arcs at one end, each inside the one before, until they repeat: walk[first] = walk[length]. */
struct end_walk {
    const struct arc *walk[TANGENT_MOST_STATES + 1];
    size_t first, length;
    int side;
};

static size_t end_child(const struct finder *finder, const struct arc *arc, int side)
{
    return side ? finder->states->states[arc->state].cell->child_count - 1 : 0;
}

static void walk_end(const struct finder *finder, const struct arc *arc, int side, struct end_walk *walk)
{
    walk->side = side;
    walk->length = 0;
    walk->walk[0] = arc;
    for (;;) {
        arc = child_arc(finder, arc, end_child(finder, arc, side));
        walk->walk[++walk->length] = arc;
        for (walk->first = 0; walk->first < walk->length; walk->first++)
            if (walk->walk[walk->first] == arc)
                return;
    }
}

/* The map of the end child of a walk's k-th arc. */
static const double *end_map(const struct finder *finder, const struct end_walk *walk, size_t k)
{
    const struct arc *arc = walk->walk[k];
    return finder->states->states[arc->state].maps[end_child(finder, arc, walk->side)];
}

/* L = T … T around the cycle (points × points), and M = WᵀLW, its action on the differences of the arc's
 * points. */
static bcifs_status cycle_matrix(struct finder *finder, const struct end_walk *walk, double **matrix)
{
    const struct arc *arc = walk->walk[walk->first];
    size_t m = arc->points, d = arc->dimension;
    *matrix = arena_new(finder->arena, d * d, sizeof **matrix);
    if (!*matrix)
        return BCIFS_MEMORY;
    for (size_t j = 0; j < d; j++) {
        double vector[TANGENT_MOST_POINTS], image[TANGENT_MOST_POINTS];
        memcpy(vector, arc->space + j * m, m * sizeof *vector);
        for (size_t k = walk->length; k-- > walk->first;) {
            matrix_multiply(end_map(finder, walk, k), vector, walk->walk[k]->points,
                            walk->walk[k + 1]->points, 1, image);
            memcpy(vector, image, walk->walk[k]->points * sizeof *vector);
        }
        for (size_t i = 0; i < d; i++)
            for (size_t r = 0; r < m; r++)
                (*matrix)[i * d + j] += arc->space[i * m + r] * vector[r];
    }
    return BCIFS_OK;
}

/* Smallest and largest of ℓ·(difference to the end) along the travel, over the arc without its own end cells.
 */
struct swing {
    double low, high;
};

/* row: the functional on the cycle's first arc, carried to walk[k]; samples of all children but the end one.
 */
static void swing_children(const struct finder *finder, const struct end_walk *walk, size_t k,
                           const double *row, double base, struct swing *swing)
{
    const struct arc *arc = walk->walk[k];
    const struct state *state = &finder->states->states[arc->state];
    double carried[TANGENT_MOST_POINTS];
    for (size_t i = 0; i < state->cell->child_count; i++) {
        if (i == end_child(finder, arc, walk->side))
            continue;
        const struct arc *child = child_arc(finder, arc, i);
        matrix_multiply(row, state->maps[i], 1, arc->points, child->points, carried);
        for (size_t c = 0; c <= child->sample_count; c++) {
            double value = -base;
            for (size_t r = 0; r < child->points; r++)
                value += carried[r] * (c < child->sample_count ? child->samples[r * child->sample_count + c]
                                                               : child->ends[1][r]);
            /* The sample where the child meets the end cell belongs to it; at a start that is harmless. */
            value = walk->side ? -value : value;
            swing->low = fmin(swing->low, value);
            swing->high = fmax(swing->high, value);
        }
    }
}

static struct swing swing_find(const struct finder *finder, const struct end_walk *walk,
                               const double *functional)
{
    const struct arc *arc = walk->walk[walk->first];
    double row[TANGENT_MOST_POINTS] = {0}, next[TANGENT_MOST_POINTS], base = 0;
    struct swing swing = {INFINITY, -INFINITY};
    for (size_t i = 0; i < arc->dimension; i++)
        for (size_t r = 0; r < arc->points; r++)
            row[r] += functional[i] * arc->space[i * arc->points + r];
    for (size_t r = 0; r < arc->points; r++)
        base += row[r] * arc->ends[walk->side][r];
    for (size_t k = walk->first; k < walk->length; k++) {
        swing_children(finder, walk, k, row, base, &swing);
        matrix_multiply(row, end_map(finder, walk, k), 1, walk->walk[k]->points, walk->walk[k + 1]->points,
                        next);
        memcpy(row, next, walk->walk[k + 1]->points * sizeof *row);
    }
    return swing;
}

/* ---- Words --------------------------------------------------------------------------------------------- */

static void append_eigenvalue(struct text *text, const struct leading *leading)
{
    char digits[DECIMAL_LONGEST];
    text_append_bytes(text, digits, decimal_print_digits(digits, leading->re, 6));
}

static void append_decision(struct text *text, const struct leading *leading)
{
    static const char *const times[] = {"", "", "double", "triple"};
    text_append(text, "the subdominant eigenvalue ");
    append_eigenvalue(text, leading);
    if (leading->multiplicity == 1)
        text_append(text, " is simple");
    else if (leading->multiplicity <= 3)
        text_format(text, " is %s", times[leading->multiplicity]);
    else
        text_format(text, " has multiplicity %zu", leading->multiplicity);
    if (leading->multiplicity > 1 && leading->block > 1)
        text_append(text, " and its map shears: directions settle, but slowly");
}

static void append_spiral(struct text *text, const struct leading *leading)
{
    char digits[DECIMAL_LONGEST];
    double degrees = atan2(leading->im, leading->re) * (180 / 3.14159265358979323846);
    text_append(text, "the subdominant eigenvalues are complex: the arc spirals, turning by ");
    text_append_bytes(text, digits, decimal_print_digits(digits, degrees, 6));
    text_append(text, " degrees at each subdivision while it shrinks by ");
    text_append_bytes(text, digits, decimal_print_digits(digits, hypot(leading->re, leading->im), 6));
}

static void append_kind(struct text *text, const struct leading *leading)
{
    switch (leading->kind) {
    case LEADING_SETTLES:
        append_decision(text, leading);
        break;
    case LEADING_FANS:
        append_decision(text, leading);
        text_append(
            text, " with several eigenvectors: the arc looks alike at every scale and has no one direction");
        break;
    case LEADING_NEGATIVE:
        text_append(text, "the subdominant eigenvalue ");
        append_eigenvalue(text, leading);
        text_append(text, " is negative: the arc comes from opposite sides in turn");
        break;
    case LEADING_SPIRALS:
        append_spiral(text, leading);
        break;
    case LEADING_TIED:
        text_append(text,
                    "several subdominant eigenvalues have the same modulus: the direction never settles");
        break;
    case LEADING_VANISHES:
        text_append(text, "the arc stands still at this end");
        break;
    case LEADING_UNKNOWN:
        text_append(text, "the eigenvalues could not be separated numerically");
        break;
    }
}

/* ---- The half-tangent ---------------------------------------------------------------------------------- */

bool direction_map(const double *a, const double *v, size_t rows, size_t columns, double *result)
{
    double length = 0, size = 0;
    matrix_multiply(a, v, rows, columns, 1, result);
    for (size_t i = 0; i < rows; i++)
        length += result[i] * result[i];
    for (size_t i = 0; i < columns; i++)
        size += v[i] * v[i];
    length = sqrt(length);
    if (!(length > TOLERANCE_RANK * sqrt(size)))
        return false;
    for (size_t i = 0; i < rows; i++)
        result[i] /= length;
    return true;
}

bool direction_equal(const double *a, const double *b, size_t size)
{
    for (size_t i = 0; i < size; i++)
        if (fabs(a[i] - b[i]) > TOLERANCE_DIRECTION)
            return false;
    return true;
}

/* From the cycle back to the arc itself: T … T v. */
static bcifs_status direction_carry(struct finder *finder, const struct end_walk *walk,
                                    const double *direction, struct half_tangent *half, struct text *reason)
{
    double vector[TANGENT_MOST_POINTS], image[TANGENT_MOST_POINTS];
    memcpy(vector, direction, walk->walk[walk->first]->points * sizeof *vector);
    for (size_t k = walk->first; k-- > 0;) {
        if (!direction_map(end_map(finder, walk, k), vector, walk->walk[k]->points, walk->walk[k + 1]->points,
                           image)) {
            text_append(reason, ", but the maps before it collapse that direction");
            return BCIFS_OK;
        }
        memcpy(vector, image, walk->walk[k]->points * sizeof *vector);
    }
    double *copy =
        arena_grow(finder->arena, vector, walk->walk[0]->points, walk->walk[0]->points, sizeof *copy);
    half->direction = copy;
    return copy ? BCIFS_OK : BCIFS_MEMORY;
}

/* The direction settles; whether to one side only depends on where the arc lies. */
static bcifs_status direction_decide(struct finder *finder, const struct end_walk *walk,
                                     const struct leading *leading, struct half_tangent *half,
                                     struct text *reason)
{
    const struct arc *arc = walk->walk[walk->first];
    struct swing swing = swing_find(finder, walk, leading->functional);
    double scale = fmax(fabs(swing.low), fabs(swing.high)), unit[1] = {1}, row[TANGENT_MOST_POINTS] = {0};
    bool forward = swing.low > TOLERANCE_RANK * scale, backward = swing.high < -TOLERANCE_RANK * scale;
    if (!forward && !backward) {
        text_append(reason, swing.low < -TOLERANCE_RANK * scale && swing.high > TOLERANCE_RANK * scale
                                ? ", but the arc crosses over and comes along it from both sides"
                                : ", but parts of the arc near the end leave its direction");
        return BCIFS_OK;
    }
    for (size_t i = 0; i < arc->dimension; i++)
        for (size_t r = 0; r < arc->points; r++)
            row[r] += (forward ? 1 : -1) * leading->direction[i] * arc->space[i * arc->points + r];
    double direction[TANGENT_MOST_POINTS];
    direction_map(row, unit, arc->points, 1, direction);
    return direction_carry(finder, walk, direction, half, reason);
}

static bcifs_status half_tangent_find(struct finder *finder, const struct arc *arc, int side,
                                      struct half_tangent *half)
{
    struct end_walk *walk = arena_new(finder->arena, 1, sizeof *walk);
    double *matrix;
    struct leading leading;
    struct text reason = {0};
    if (!walk)
        return BCIFS_MEMORY;
    walk_end(finder, arc, side, walk);
    bcifs_status status = cycle_matrix(finder, walk, &matrix);
    if (status == BCIFS_OK)
        status = leading_find(matrix, walk->walk[walk->first]->dimension, finder->arena, &leading);
    if (status)
        return status;
    *half = (struct half_tangent){
        .point = arc->ends[side], .re = leading.re, .im = leading.im, .period = walk->length - walk->first};
    append_kind(&reason, &leading);
    if (leading.kind == LEADING_SETTLES)
        status = direction_decide(finder, walk, &leading, half, &reason);
    half->reason = reason.failed ? NULL : arena_text(finder->arena, reason.data, reason.length);
    text_free(&reason);
    return status ? status : half->reason ? BCIFS_OK : BCIFS_MEMORY;
}

bcifs_status tangents_find(struct states *states, struct arena *arena, struct tangents *tangents)
{
    struct finder finder = {.states = states, .arena = arena};
    bcifs_status status = arcs_collect(&finder);
    if (status)
        return status;
    spaces_find(&finder);
    status = samples_find(&finder);
    tangents->arcs = arena_new(arena, finder.count, sizeof *tangents->arcs);
    tangents->count = finder.count;
    if (status || !tangents->arcs)
        return status ? status : BCIFS_MEMORY;
    for (size_t i = 0; i < finder.count && status == BCIFS_OK; i++) {
        tangents->arcs[i].state = finder.arcs[i].state;
        for (int side = 0; side < 2 && status == BCIFS_OK; side++)
            status = half_tangent_find(&finder, &finder.arcs[i], side, &tangents->arcs[i].ends[side]);
    }
    return status;
}

const struct arc_tangents *tangents_of(const struct tangents *tangents, size_t state)
{
    for (size_t i = 0; i < tangents->count; i++)
        if (tangents->arcs[i].state == state)
            return &tangents->arcs[i];
    return NULL;
}
