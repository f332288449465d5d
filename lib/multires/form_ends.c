/* The limit points at the ends of an arc, exactly: states_limit in values (docs/mathematics.md, "Limit
 * points"). */
#include "multires/form.h"

#include "numeric/value_equations.h"

enum { LONGEST_WALK = 256 /* vertices that follow each other; what takes longer is left to states_limit */ };

/* The vertices that follow each other under their first map, and that map of each. */
struct vertex_walk {
    size_t visited[LONGEST_WALK + 1];
    size_t length;
    size_t cycle; /* visited[length] is visited[cycle]; LONGEST_WALK + 1: it did not come back */
    bool exact;
};

static const struct value_matrix *first_map(const struct states *states, size_t index)
{
    return states->states[index].cell->children[0].map;
}

static bcifs_status vertices_follow(struct states *states, size_t index, struct vertex_walk *walk)
{
    *walk = (struct vertex_walk){.cycle = LONGEST_WALK + 1, .exact = true};
    walk->visited[0] = index;
    while (walk->length < LONGEST_WALK && walk->exact) {
        bcifs_status status = states_expand(states, index);
        if (status)
            return status;
        walk->exact = first_map(states, index)->exact;
        index = states->states[index].children[0];
        walk->visited[++walk->length] = index;
        for (size_t i = 0; i < walk->length; i++)
            if (walk->visited[i] == index) {
                walk->cycle = i;
                return BCIFS_OK;
            }
    }
    return BCIFS_OK;
}

/* T c = c, 1·c = 1, T size × size. `free` receives 1 when there is exactly one such c. */
static bcifs_status fixed_point_solve(const struct value_matrix *t, struct arena *arena, struct value *point,
                                      size_t *free)
{
    size_t size = t->rows, unknowns = size + 1;
    struct value *equations = arena_new(arena, (size + 1) * unknowns, sizeof *equations);
    struct value *solution = arena_new(arena, unknowns, sizeof *solution);
    if (!equations || !solution)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < size; i++) {
        for (size_t j = 0; j < size; j++)
            equations[i * unknowns + j] = i == j
                                              ? value_subtract(t->values[i * size + j], value_from_integer(1))
                                              : t->values[i * size + j];
        equations[i * unknowns + size] = value_from_integer(0);
        equations[size * unknowns + i] = value_from_integer(1);
    }
    equations[size * unknowns + size] = value_from_integer(-1);
    bcifs_status status = equations_solve(equations, size + 1, unknowns, true, arena, solution, free);
    for (size_t i = 0; i < size; i++)
        point[i] = solution[i];
    return status;
}

/* c = T(x_0) … T(x_p-1) c', with c' the fixed point of the cycle that begins at x_p. */
static bcifs_status cycle_limit(struct states *states, const struct vertex_walk *walk, struct arena *arena,
                                struct value *point)
{
    const struct value_matrix *product = first_map(states, walk->visited[walk->cycle]);
    for (size_t i = walk->cycle + 1; i < walk->length && product; i++)
        product = value_matrix_multiply(arena, product, first_map(states, walk->visited[i]));
    struct value_matrix *limit = product ? value_matrix_new(arena, product->rows, 1) : NULL;
    size_t free;
    if (!limit)
        return BCIFS_MEMORY;
    bcifs_status status = fixed_point_solve(product, arena, limit->values, &free);
    if (status)
        return status;
    if (free != 1)
        return states_limit_refuse(states, walk->visited[walk->cycle],
                                   free ? "its map fixes more than one point" : "its map fixes no point");
    for (size_t i = walk->cycle; i-- > 0;) {
        limit = value_matrix_multiply(arena, first_map(states, walk->visited[i]), limit);
        if (!limit)
            return BCIFS_MEMORY;
    }
    for (size_t i = 0; i < limit->rows; i++)
        point[i] = limit->values[i];
    return BCIFS_OK;
}

/* Numbers that are rounded anyway, and arguments that change for ever, are for doubles. */
static bcifs_status limit_in_doubles(struct states *states, size_t index, struct arena *arena,
                                     struct value *point)
{
    size_t count = states->states[index].points;
    double *numbers = arena_new(arena, count, sizeof *numbers);
    if (!numbers)
        return BCIFS_MEMORY;
    bcifs_status status = states_limit(states, index, numbers);
    for (size_t i = 0; i < count; i++)
        point[i] = value_from_real(numbers[i]);
    return status;
}

/* Π c, with c the limit point of the boundary's vertex. */
static bcifs_status end_find(struct states *states, size_t state, int side, struct arena *arena,
                             const struct value **end)
{
    struct vertex_walk walk;
    size_t vertex = states->states[state].boundaries[side];
    struct value_matrix *limit = value_matrix_new(arena, states->states[vertex].points, 1);
    if (!limit)
        return BCIFS_MEMORY;
    bcifs_status status = vertices_follow(states, vertex, &walk);
    if (status)
        return status;
    if (walk.exact && walk.cycle <= LONGEST_WALK)
        status = cycle_limit(states, &walk, arena, limit->values);
    else
        status = limit_in_doubles(states, vertex, arena, limit->values);
    if (status)
        return status;
    const struct value_matrix *column =
        value_matrix_multiply(arena, states->states[state].cell->boundaries[side].operator, limit);
    *end = column ? column->values : NULL;
    return column ? BCIFS_OK : BCIFS_MEMORY;
}

bcifs_status form_ends_find(struct states *states, size_t state, struct arena *arena, struct form_ends *ends)
{
    bcifs_status status = states_expand(states, state);
    if (status == BCIFS_OK)
        status = end_find(states, state, 0, arena, &ends->start);
    return status ? status : end_find(states, state, 1, arena, &ends->end);
}
