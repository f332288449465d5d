/* Products of states, [IM] 6.1: T^f_{i,j} = T^a_i ⊗ T^b_j, boundaries Π^a ⊗ I and I ⊗ Π^b. */
#include "cell.h"

#include <string.h>

static bcifs_status out_of_memory(const struct setting *setting)
{
    return setting->report ? report_memory(setting->report) : BCIFS_MEMORY;
}

/* A ⊗ B: row (i, k), column (j, l) is A[i][j] B[k][l]; the first factor's index runs slowest. */
static const struct value_matrix *kronecker(struct arena *arena, const struct value_matrix *a,
                                            const struct value_matrix *b)
{
    struct value_matrix *c = value_matrix_new(arena, a->rows * b->rows, a->columns * b->columns);
    if (!c)
        return NULL;
    for (size_t i = 0; i < a->rows; i++)
        for (size_t k = 0; k < b->rows; k++)
            for (size_t j = 0; j < a->columns; j++)
                for (size_t l = 0; l < b->columns; l++)
                    c->values[((i * b->rows + k) * a->columns + j) * b->columns + l] =
                        value_multiply(a->values[i * a->columns + j], b->values[k * b->columns + l]);
    value_matrix_finish(c);
    return c;
}

static struct value_matrix *identity(struct arena *arena, size_t size)
{
    struct value_matrix *matrix = value_matrix_new(arena, size, size);
    for (size_t i = 0; matrix && i < size; i++)
        matrix->values[i * size + i] = value_from_integer(1);
    return matrix;
}

/* The state a * b: its definition was made when the automaton was bound. */
static bcifs_status product_key(const struct setting *setting, struct arena *arena, struct state_key a,
                                struct state_key b, struct state_key *key)
{
    size_t count_a = a.definition->argument_count, count_b = b.definition->argument_count;
    struct value *arguments = arena_new(arena, count_a + count_b, sizeof *arguments);
    if (!arguments)
        return out_of_memory(setting);
    if (count_a)
        memcpy(arguments, a.arguments, count_a * sizeof *arguments);
    if (count_b)
        memcpy(arguments + count_a, b.arguments, count_b * sizeof *arguments);
    *key = (struct state_key){automaton_product(setting->automaton, a.definition, b.definition), arguments};
    return key->definition ? BCIFS_OK : BCIFS_INPUT;
}

static size_t entries_of(const struct cell *a, const struct cell *b)
{
    size_t entries[2] = {0, 0};
    const struct cell *cells[2] = {a, b};
    for (int i = 0; i < 2; i++)
        for (size_t j = 0; j < cells[i]->child_count; j++)
            entries[i] += cells[i]->children[j].map->rows * cells[i]->children[j].map->columns;
    return entries[0] > CELL_MOST_ENTRIES || entries[1] > CELL_MOST_ENTRIES ? SIZE_MAX : entries[0] * entries[1];
}

static bcifs_status children_multiply(const struct setting *setting, struct arena *arena, const struct cell *a,
                                      const struct cell *b, struct cell *cell)
{
    cell->children = arena_new(arena, a->child_count * b->child_count, sizeof *cell->children);
    if (!cell->children)
        return out_of_memory(setting);
    for (size_t i = 0; i < a->child_count; i++)
        for (size_t j = 0; j < b->child_count; j++) {
            struct cell_child *child = &cell->children[cell->child_count++];
            *child = a->children[i];
            child->map = kronecker(arena, a->children[i].map, b->children[j].map);
            if (!child->map)
                return out_of_memory(setting);
            bcifs_status status =
                product_key(setting, arena, a->children[i].state, b->children[j].state, &child->state);
            if (status)
                return status;
        }
    return BCIFS_OK;
}

/* The name of a factor's boundary in the product; a vertex factor has none, so the other's names stay. */
static const char *boundary_name(struct arena *arena, const char *prefix, const char *name)
{
    size_t length = strlen(prefix);
    char *joined = arena_new(arena, length + strlen(name) + 1, 1);
    if (!joined)
        return NULL;
    memcpy(joined, prefix, length);
    memcpy(joined + length, name, strlen(name));
    return joined;
}

/* Adds the boundaries of factor `side` (0: Π ⊗ I, 1: I ⊗ Π) to the product. */
static bcifs_status boundaries_multiply(const struct setting *setting, struct arena *arena,
                                        const struct cell *const factors[2], int side, struct cell *cell)
{
    const struct cell *own = factors[side], *other = factors[1 - side];
    const char *prefix = other->boundary_count == 0 ? "" : side ? "second_" : "first_";
    const struct value_matrix *unit = identity(arena, other->points);
    struct state_key other_key = {other->definition, other->arguments};
    for (size_t i = 0; i < own->boundary_count; i++) {
        struct cell_boundary *boundary = &cell->boundaries[cell->boundary_count++];
        *boundary = own->boundaries[i];
        boundary->indices = NULL;
        boundary->name = boundary_name(arena, prefix, own->boundaries[i].name);
        if (!unit || !boundary->name)
            return out_of_memory(setting);
        boundary->operator = side ? kronecker(arena, unit, own->boundaries[i].operator)
                                  : kronecker(arena, own->boundaries[i].operator, unit);
        if (!boundary->operator)
            return out_of_memory(setting);
        struct state_key a = side ? other_key : own->boundaries[i].state;
        struct state_key b = side ? own->boundaries[i].state : other_key;
        bcifs_status status = product_key(setting, arena, a, b, &boundary->state);
        if (status)
            return status;
    }
    return BCIFS_OK;
}

bcifs_status product_elaborate(const struct setting *setting, struct arena *arena, const struct state_key *factors,
                               struct cell *cell)
{
    struct cell *a, *b;
    bcifs_status status = cell_elaborate(setting, arena, factors[0], &a);
    if (status == BCIFS_OK)
        status = cell_elaborate(setting, arena, factors[1], &b);
    if (status)
        return status;
    cell->points = a->points * b->points;
    cell->unknowns = a->unknowns + b->unknowns;
    if (cell->points > CELL_MOST_POINTS || entries_of(a, b) > CELL_MOST_ENTRIES) {
        if (!setting->report)
            return BCIFS_INPUT;
        return report_failure(setting->report, BCIFS_INPUT, cell->definition->module->source->name,
                              "the product '%s' is too large: more than %d control points or %d entries",
                              cell->definition->name, CELL_MOST_POINTS, CELL_MOST_ENTRIES);
    }
    cell->boundaries = arena_new(arena, a->boundary_count + b->boundary_count, sizeof *cell->boundaries);
    if (!cell->boundaries)
        return out_of_memory(setting);
    const struct cell *const cells[2] = {a, b};
    status = children_multiply(setting, arena, a, b, cell);
    if (status == BCIFS_OK)
        status = boundaries_multiply(setting, arena, cells, 0, cell);
    return status ? status : boundaries_multiply(setting, arena, cells, 1, cell);
}
