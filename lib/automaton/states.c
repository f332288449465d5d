#include "states.h"

#include <math.h>
#include <string.h>

#include "numeric/matrix.h"
#include "numeric/tolerance.h"

enum { LONGEST_CHAIN = 4096 /* vertices that follow each other before their product must have converged */ };

static bcifs_status out_of_memory(const struct states *states)
{
    return states->setting.report ? report_memory(states->setting.report) : BCIFS_MEMORY;
}

bcifs_status states_create(struct states *states, struct arena *arena, const struct setting *setting)
{
    *states = (struct states){.arena = arena, .setting = *setting, .bucket_count = 64};
    states->buckets = arena_new(arena, states->bucket_count, sizeof *states->buckets);
    return states->buckets ? BCIFS_OK : out_of_memory(states);
}

bcifs_status states_copy(struct states *copy, const struct states *states, struct arena *arena,
                         struct report *report)
{
    *copy = *states;
    copy->arena = arena;
    copy->setting.report = report;
    copy->capacity = states->count + 8;
    copy->states = arena_grow(arena, states->states, states->count, copy->capacity, sizeof *copy->states);
    copy->buckets = arena_grow(arena, states->buckets, states->bucket_count, states->bucket_count,
                               sizeof *copy->buckets);
    return copy->states && copy->buckets ? BCIFS_OK : out_of_memory(copy);
}

/* Arguments that are known in doubles only are compared with a tolerance, so they cannot take part. */
static size_t hash(struct state_key key)
{
    uint64_t sum = (uint64_t)(uintptr_t)key.definition;
    for (size_t i = 0; i < key.definition->argument_count; i++) {
        sum = (sum ^ (sum >> 29)) * UINT64_C(0x9e3779b97f4a7c15);
        sum += key.arguments[i].exact ? key.arguments[i].residue : 0;
    }
    sum = (sum ^ (sum >> 32)) * UINT64_C(0xd6e8feb86659fd93);
    return (size_t)(sum >> 16);
}

/* The bucket that holds the state, or the empty one where it belongs. */
static size_t *bucket_find(const struct states *states, struct state_key key)
{
    size_t mask = states->bucket_count - 1, i = hash(key) & mask;
    while (states->buckets[i] && !state_key_equal(states->states[states->buckets[i] - 1].key, key))
        i = (i + 1) & mask;
    return &states->buckets[i];
}

static bcifs_status buckets_double(struct states *states)
{
    size_t *old = states->buckets, old_count = states->bucket_count;
    states->buckets = arena_new(states->arena, 2 * old_count, sizeof *states->buckets);
    if (!states->buckets) {
        states->buckets = old;
        return out_of_memory(states);
    }
    states->bucket_count = 2 * old_count;
    for (size_t i = 0; i < states->count; i++)
        *bucket_find(states, states->states[i].key) = i + 1;
    return BCIFS_OK;
}

bcifs_status states_intern(struct states *states, struct state_key key, size_t *index)
{
    size_t *bucket = bucket_find(states, key);
    if (*bucket) {
        *index = *bucket - 1;
        return BCIFS_OK;
    }
    if (states->count >= STATES_MOST) {
        if (!states->setting.report)
            return BCIFS_INPUT;
        return report_failure(states->setting.report, BCIFS_INPUT, key.definition->module->source->name,
                              "more than %d states are reached: the arguments of '%s' keep changing; "
                              "a smaller depth may do",
                              STATES_MOST, key.definition->name);
    }
    if (2 * (states->count + 1) > states->bucket_count) {
        bcifs_status status = buckets_double(states);
        if (status)
            return status;
        bucket = bucket_find(states, key);
    }
    if (!ARENA_RESERVE(states->arena, states->states, states->count, states->capacity))
        return out_of_memory(states);
    struct state fresh = {.key = key};
    bcifs_status status = cell_points(&states->setting, states->arena, key, &fresh.points);
    if (status)
        return status;
    *index = states->count;
    states->states[states->count++] = fresh;
    *bucket = *index + 1;
    return BCIFS_OK;
}

/* The doubles of a value matrix. */
static const double *reals(struct arena *arena, const struct value_matrix *matrix)
{
    size_t count = matrix->rows * matrix->columns;
    double *numbers = arena_new(arena, count, sizeof *numbers);
    for (size_t i = 0; numbers && i < count; i++)
        numbers[i] = matrix->values[i].real;
    return numbers;
}

bcifs_status states_expand(struct states *states, size_t index)
{
    if (states->states[index].expanded)
        return BCIFS_OK;
    struct cell *cell;
    bcifs_status status =
        cell_elaborate(&states->setting, states->arena, states->states[index].key, &cell);
    if (status)
        return status;
    size_t *children = arena_new(states->arena, cell->child_count, sizeof *children);
    size_t *boundaries = arena_new(states->arena, cell->boundary_count, sizeof *boundaries);
    const double **maps = arena_new(states->arena, cell->child_count, sizeof *maps);
    const double **operators = arena_new(states->arena, cell->boundary_count, sizeof *operators);
    if (!children || !boundaries || !maps || !operators)
        return out_of_memory(states);
    for (size_t i = 0; i < cell->child_count && status == BCIFS_OK; i++) {
        status = states_intern(states, cell->children[i].state, &children[i]);
        maps[i] = reals(states->arena, cell->children[i].map);
        if (!maps[i])
            return out_of_memory(states);
    }
    for (size_t i = 0; i < cell->boundary_count && status == BCIFS_OK; i++) {
        status = states_intern(states, cell->boundaries[i].state, &boundaries[i]);
        operators[i] = reals(states->arena, cell->boundaries[i].operator);
        if (!operators[i])
            return out_of_memory(states);
    }
    if (status)
        return status;
    struct state *state = &states->states[index];
    state->cell = cell;
    state->children = children;
    state->boundaries = boundaries;
    state->maps = maps;
    state->operators = operators;
    state->expanded = true;
    return BCIFS_OK;
}

void state_name(const struct state_key *key, struct text *text)
{
    text_append(text, key->definition->name);
    for (size_t i = 0; i < key->definition->argument_count; i++) {
        text_append(text, i == 0 ? "(" : ",");
        text_append_number(text, key->arguments[i].real);
    }
    if (key->definition->argument_count > 0)
        text_append(text, ")");
}

/* ---- Limit points -------------------------------------------------------------------------------------- */

/* The states x_0, x_1, … that follow each other under the first map; `product` is T(x_0) … T(x_k-1). */
struct chain_walk {
    size_t visited[LONGEST_CHAIN + 1];
    size_t length;
    double *product, *next;
};

/* Whether all columns of rows × columns M agree to rounding: every start leads to the same point. */
static bool has_converged(const double *m, size_t rows, size_t columns)
{
    double spread = 0, largest = 0;
    for (size_t i = 0; i < rows; i++)
        for (size_t j = 0; j < columns; j++) {
            spread = fmax(spread, fabs(m[i * columns + j] - m[i * columns]));
            largest = fmax(largest, fabs(m[i * columns + j]));
        }
    return spread <= TOLERANCE_LIMIT * largest;
}

bcifs_status states_limit_refuse(const struct states *states, size_t index, const char *reason)
{
    if (!states->setting.report)
        return BCIFS_INPUT;
    const struct state_key *key = &states->states[index].key;
    struct text name = {0};
    state_name(key, &name);
    bcifs_status status =
        report_failure(states->setting.report, BCIFS_INPUT, key->definition->module->source->name,
                       "the state '%s' has no single limit point: %s", name.failed ? "" : name.data, reason);
    text_free(&name);
    return status;
}

/* M <- M · T(x), where M has `rows` rows. */
static bcifs_status chain_step(struct states *states, struct chain_walk *walk, size_t rows, size_t *index)
{
    bcifs_status status = states_expand(states, *index);
    if (status)
        return status;
    const struct state *state = &states->states[*index];
    size_t next = state->children[0], columns = states->states[next].points;
    walk->next = arena_new(states->arena, rows * columns, sizeof *walk->next);
    if (!walk->next)
        return out_of_memory(states);
    matrix_multiply(walk->product, state->maps[0], rows, state->points, columns, walk->next);
    walk->product = walk->next;
    walk->visited[++walk->length] = *index = next;
    return BCIFS_OK;
}

static bcifs_status identity(struct states *states, size_t size, double **matrix)
{
    *matrix = arena_new(states->arena, size * size, sizeof **matrix);
    if (!*matrix)
        return out_of_memory(states);
    for (size_t i = 0; i < size; i++)
        (*matrix)[i * size + i] = 1;
    return BCIFS_OK;
}

/* The fixed point of the cycle visited[first … length]. */
static bcifs_status cycle_limit(struct states *states, const struct chain_walk *walk, size_t first,
                                double *point)
{
    size_t index = walk->visited[first], size = states->states[index].points;
    struct chain_walk cycle = {.length = 0};
    bcifs_status status = identity(states, size, &cycle.product);
    for (size_t i = first; i < walk->length && status == BCIFS_OK; i++) {
        size_t next = walk->visited[i];
        status = chain_step(states, &cycle, size, &next);
    }
    double *workspace = arena_new(states->arena, size * size + 2 * size, sizeof *workspace);
    size_t *order = arena_new(states->arena, size, sizeof *order);
    if (status || !workspace || !order)
        return status ? status : out_of_memory(states);
    if (!matrix_fixed_point(cycle.product, size, point, workspace, order))
        return states_limit_refuse(states, index, "its map fixes more than one point");
    return BCIFS_OK;
}

/* c = T(x_0) … T(x_p-1) c', with c' the fixed point of the cycle that begins at x_p. */
static bcifs_status limit_through_cycle(struct states *states, const struct chain_walk *walk, size_t first,
                                        double *point)
{
    size_t length = states->states[walk->visited[first]].points;
    double *current = arena_new(states->arena, length, sizeof *current);
    if (!current)
        return out_of_memory(states);
    bcifs_status status = cycle_limit(states, walk, first, current);
    for (size_t i = first; i-- > 0 && status == BCIFS_OK;) {
        const struct state *state = &states->states[walk->visited[i]];
        double *mapped = arena_new(states->arena, state->points, sizeof *mapped);
        if (!mapped)
            return out_of_memory(states);
        matrix_multiply(state->maps[0], current, state->points, length, 1, mapped);
        current = mapped;
        length = state->points;
    }
    if (status == BCIFS_OK)
        memcpy(point, current, length * sizeof *point);
    return status;
}

bcifs_status states_limit(struct states *states, size_t index, double *point)
{
    size_t rows = states->states[index].points;
    struct chain_walk *walk = arena_new(states->arena, 1, sizeof *walk);
    if (!walk)
        return out_of_memory(states);
    walk->visited[0] = index;
    bcifs_status status = identity(states, rows, &walk->product);
    while (status == BCIFS_OK && walk->length < LONGEST_CHAIN) {
        status = chain_step(states, walk, rows, &index);
        for (size_t i = 0; i < walk->length && status == BCIFS_OK; i++)
            if (walk->visited[i] == index)
                return limit_through_cycle(states, walk, i, point);
        size_t columns = states->states[index].points;
        if (status == BCIFS_OK && walk->length > 1 && has_converged(walk->product, rows, columns)) {
            for (size_t i = 0; i < rows; i++)
                point[i] = walk->product[i * columns];
            return BCIFS_OK;
        }
    }
    return status ? status : states_limit_refuse(states, walk->visited[0], "its maps do not converge");
}

bcifs_status states_boundary_point(struct states *states, size_t index, int boundary, const double *point,
                                    double *column)
{
    bcifs_status status = states_expand(states, index);
    if (status)
        return status;
    const struct state *state = &states->states[index];
    size_t joint = states->states[state->boundaries[boundary]].points;
    matrix_multiply(state->operators[boundary], point, state->points, joint, 1, column);
    return BCIFS_OK;
}

bcifs_status states_end_limit(struct states *states, size_t index, bool at_end, double *column)
{
    if (states->states[index].key.definition->kind != CELL_EDGE)
        return states_limit(states, index, column);
    bcifs_status status = states_expand(states, index);
    if (status)
        return status;
    size_t vertex = states->states[index].boundaries[at_end];
    double *point = arena_new(states->arena, states->states[vertex].points, sizeof *point);
    if (!point)
        return out_of_memory(states);
    status = states_limit(states, vertex, point);
    return status ? status : states_boundary_point(states, index, at_end, point, column);
}
