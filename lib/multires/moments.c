#include "multires/moments.h"

#include <math.h>

#include "numeric/tolerance.h"
#include "numeric/value_equations.h"

/* The linear system of one component: the coordinates of its states, one after the other, and a last unknown
 * for what is known. */
struct system {
    const struct states *states;
    const struct reach *reach;
    size_t component;
    const size_t *base; /* first coordinate of each place; of members only */
    size_t unknowns;
    struct value *equations, *equation; /* all, and the next to be written */
    size_t rows;
};

static const struct state *state_at(const struct system *system, size_t place)
{
    return &system->states->states[system->reach->list[place]];
}

static size_t child_place(const struct system *system, const struct state *state, size_t child)
{
    return system->reach->place[state->children[child]];
}

static bool is_member(const struct system *system, size_t place)
{
    return system->reach->component[place] == system->component;
}

static bcifs_status zeros_new(struct arena *arena, size_t count, struct value **zeros)
{
    *zeros = arena_new(arena, count, sizeof **zeros);
    for (size_t i = 0; *zeros && i < count; i++)
        (*zeros)[i] = value_from_integer(0);
    return *zeros ? BCIFS_OK : BCIFS_MEMORY;
}

static void add_to(struct value *sum, struct value term)
{
    *sum = value_add(*sum, term);
}

/* Adds `term` to what is known on the equation's left side. */
static void constant_add(struct system *system, struct value term)
{
    add_to(&system->equation[system->unknowns - 1], term);
}

/* `rows` is set; false when there are more unknowns than the limit. */
static bcifs_status system_begin(struct system *system, struct arena *arena, bool *small)
{
    const struct reach *reach = system->reach;
    size_t *base = arena_new(arena, reach->count, sizeof *base);
    if (!base)
        return BCIFS_MEMORY;
    system->unknowns = 0;
    for (size_t k = reach->first[system->component]; k < reach->first[system->component + 1]; k++) {
        base[reach->members[k]] = system->unknowns;
        system->unknowns += state_at(system, reach->members[k])->points;
    }
    system->base = base;
    *small = system->unknowns <= MOMENTS_MOST_UNKNOWNS;
    if (!*small)
        return BCIFS_OK;
    system->unknowns++;
    bcifs_status status = zeros_new(arena, system->rows * system->unknowns, &system->equations);
    system->equation = system->equations;
    return status;
}

/* Solves, and hands out the solution by place; `free` is as of equations_solve. */
static bcifs_status system_solve(struct system *system, struct arena *own, struct arena *arena,
                                 const struct value **solutions, size_t *free)
{
    const struct reach *reach = system->reach;
    struct value *solution = arena_new(own, system->unknowns, sizeof *solution);
    if (!solution)
        return BCIFS_MEMORY;
    bcifs_status status =
        equations_solve(system->equations, system->rows, system->unknowns, true, own, solution, free);
    if (status || *free == 0)
        return status;
    for (size_t i = 0; i < system->unknowns; i++)
        value_pin(&solution[i], 0);
    for (size_t k = reach->first[system->component]; k < reach->first[system->component + 1]; k++) {
        size_t place = reach->members[k], points = state_at(system, place)->points;
        solutions[place] =
            arena_grow(arena, solution + system->base[place], points, points, sizeof *solution);
        if (!solutions[place])
            return BCIFS_MEMORY;
    }
    return BCIFS_OK;
}

/* ---- Moments ------------------------------------------------------------------------------------------- */

/* N^l q_l^x T_i - q_l^y = the terms of lower degree, column by column: i for ℓ, 2i ℓ^y + i² for q. */
static void moment_equations(struct system *system, size_t x, size_t i, int l, const struct moments *moments)
{
    const struct state *state = state_at(system, x);
    const struct value_matrix *map = state->cell->children[i].map;
    size_t y = child_place(system, state, i);
    struct value scale = value_power((int64_t)state->cell->child_count, l);
    struct value twice = value_from_integer(2 * (int64_t)i), power = value_power((int64_t)i, l);
    const struct value *known = l == 1 ? moments->parameter[y] : moments->square[y];
    for (size_t j = 0; j < map->columns; j++, system->equation += system->unknowns) {
        for (size_t k = 0; k < map->rows; k++)
            system->equation[system->base[x] + k] = value_multiply(scale, map->values[k * map->columns + j]);
        if (is_member(system, y))
            add_to(&system->equation[system->base[y] + j], value_from_integer(-1));
        else
            constant_add(system, value_negate(known[j]));
        if (l == 2)
            constant_add(system, value_negate(value_multiply(twice, moments->parameter[y][j])));
        constant_add(system, value_negate(power));
    }
}

/* Whether all that the component's equations refer to is there. */
static bool moment_is_possible(const struct system *system, int l, const struct moments *moments)
{
    const struct reach *reach = system->reach;
    for (size_t k = reach->first[system->component]; k < reach->first[system->component + 1]; k++) {
        size_t x = reach->members[k];
        const struct state *state = state_at(system, x);
        if (l == 2 && !moments->parameter[x])
            return false;
        for (size_t i = 0; i < state->cell->child_count; i++) {
            size_t y = child_place(system, state, i);
            bool known = l == 1 ? moments->parameter[y] != NULL : moments->square[y] && moments->parameter[y];
            if (!is_member(system, y) && !known)
                return false;
        }
    }
    return true;
}

static bcifs_status moment_find(struct system *system, int l, struct moments *moments, struct arena *own,
                                struct arena *arena)
{
    const struct reach *reach = system->reach;
    bool small;
    size_t free;
    if (!moment_is_possible(system, l, moments))
        return BCIFS_OK;
    system->rows = 0;
    for (size_t k = reach->first[system->component]; k < reach->first[system->component + 1]; k++) {
        const struct state *state = state_at(system, reach->members[k]);
        for (size_t i = 0; i < state->cell->child_count; i++)
            system->rows += state->cell->children[i].map->columns;
    }
    bcifs_status status = system_begin(system, own, &small);
    if (status || !small)
        return status;
    for (size_t k = reach->first[system->component]; k < reach->first[system->component + 1]; k++)
        for (size_t i = 0; i < state_at(system, reach->members[k])->cell->child_count; i++)
            moment_equations(system, reach->members[k], i, l, moments);
    return system_solve(system, own, arena, l == 1 ? moments->parameter : moments->square, &free);
}

static bcifs_status units_make(const struct states *states, const struct reach *reach, struct arena *arena,
                               struct moments *moments)
{
    for (size_t x = 0; x < reach->count; x++) {
        size_t points = states->states[reach->list[x]].points;
        struct value *ones = arena_new(arena, points, sizeof *ones);
        if (!ones)
            return BCIFS_MEMORY;
        for (size_t i = 0; i < points; i++)
            ones[i] = value_from_integer(1);
        moments->unit[x] = ones;
    }
    return BCIFS_OK;
}

bcifs_status moments_find(const struct states *states, const struct reach *reach, int degree,
                          struct arena *arena, struct moments *moments)
{
    const struct value **rows = arena_new(arena, reach->count, 3 * sizeof *rows);
    if (!rows)
        return BCIFS_MEMORY;
    *moments = (struct moments){rows, rows + reach->count, rows + 2 * reach->count};
    bcifs_status status = units_make(states, reach, arena, moments);
    for (size_t c = 0; c < reach->component_count && status == BCIFS_OK; c++)
        for (int l = 1; l <= degree && status == BCIFS_OK; l++) {
            struct arena own = {0};
            struct system system = {.states = states, .reach = reach, .component = c};
            status = moment_find(&system, l, moments, &own, arena);
            arena_free(&own);
        }
    return status;
}

/* ---- Derivatives --------------------------------------------------------------------------------------- */

/* N T D^y - D^x = 0 with the first or last map, 1·D = 0, ℓ·D = 1, for all states of the component. */
static void derivative_equations(struct system *system, size_t x, bool at_end, const struct moments *moments,
                                 const struct value *const *known)
{
    const struct state *state = state_at(system, x);
    size_t child = at_end ? state->cell->child_count - 1 : 0, y = child_place(system, state, child);
    const struct value_matrix *map = state->cell->children[child].map;
    struct value scale = value_from_integer((int64_t)state->cell->child_count);
    for (size_t i = 0; i < map->rows; i++, system->equation += system->unknowns) {
        for (size_t j = 0; j < map->columns; j++) {
            struct value entry = value_multiply(scale, map->values[i * map->columns + j]);
            if (is_member(system, y))
                add_to(&system->equation[system->base[y] + j], entry);
            else
                constant_add(system, value_multiply(entry, known[y][j]));
        }
        add_to(&system->equation[system->base[x] + i], value_from_integer(-1));
    }
    for (int l = 0; l < 2; l++, system->equation += system->unknowns) {
        const struct value *row = l == 0 ? moments->unit[x] : moments->parameter[x];
        for (size_t i = 0; i < state->points; i++)
            system->equation[system->base[x] + i] = row[i];
        constant_add(system, value_from_integer(-l));
    }
}

static bcifs_status derivative_find(struct system *system, bool at_end, const struct moments *moments,
                                    struct arena *arena, const struct value **derivatives, bool *found)
{
    const struct reach *reach = system->reach;
    struct arena own = {0};
    size_t free = 0;
    bool small;
    system->rows = 0;
    for (size_t k = reach->first[system->component]; k < reach->first[system->component + 1]; k++)
        system->rows += state_at(system, reach->members[k])->points + 2;
    bcifs_status status = system_begin(system, &own, &small);
    for (size_t k = reach->first[system->component];
         status == BCIFS_OK && small && k < reach->first[system->component + 1]; k++)
        derivative_equations(system, reach->members[k], at_end, moments, derivatives);
    if (status == BCIFS_OK && small)
        status = system_solve(system, &own, arena, derivatives, &free);
    *found = free == 1;
    arena_free(&own);
    return status;
}

/* Entry `row` of T v, and the size of the sums that it is the difference of. */
static struct value image_entry(const struct value_matrix *map, const struct value *vector, size_t row,
                                double *size)
{
    struct value sum = value_from_integer(0);
    double terms = 0;
    for (size_t j = 0; j < map->columns; j++) {
        struct value term = value_multiply(map->values[row * map->columns + j], vector[j]);
        sum = value_add(sum, term);
        terms += fabs(term.real);
    }
    *size = fmax(*size, terms);
    return sum;
}

/* T_i E^y = T_i+1 D^z, the derivatives by the child's parameter on both sides. */
static bool joint_agrees(const struct state *state, size_t i, const struct value *end,
                         const struct value *start)
{
    const struct value_matrix *left = state->cell->children[i].map, *right = state->cell->children[i + 1].map;
    double size = 0;
    bool agree = true;
    for (size_t row = 0; row < state->points; row++) /* for the size of the vectors as a whole */
        image_entry(left, end, row, &size);
    for (size_t row = 0; row < state->points && agree; row++) {
        struct value difference =
            value_subtract(image_entry(left, end, row, &size), image_entry(right, start, row, &size));
        agree = value_is_negligible(difference, size);
    }
    return agree;
}

bcifs_status derivatives_join(const struct states *states, const struct reach *reach,
                              const struct moments *moments, size_t c, struct arena *arena,
                              const struct value **starts, const struct value **ends, bool *determined,
                              bool *agree)
{
    struct system system = {.states = states, .reach = reach, .component = c};
    bool start_found = false, end_found = false;
    bcifs_status status = derivative_find(&system, false, moments, arena, starts, &start_found);
    if (status == BCIFS_OK)
        status = derivative_find(&system, true, moments, arena, ends, &end_found);
    *determined = *agree = start_found && end_found;
    for (size_t k = reach->first[c]; k < reach->first[c + 1] && status == BCIFS_OK && *agree; k++) {
        const struct state *state = state_at(&system, reach->members[k]);
        for (size_t i = 0; i + 1 < state->cell->child_count && *agree; i++)
            *agree = joint_agrees(state, i, ends[child_place(&system, state, i)],
                                  starts[child_place(&system, state, i + 1)]);
    }
    return status;
}
