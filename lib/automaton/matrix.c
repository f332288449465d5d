/* value_matrix: see cell.h. */
#include "cell.h"
#include "numeric/field.h"

struct value_matrix *value_matrix_new(struct arena *arena, size_t rows, size_t columns)
{
    struct value_matrix *matrix = arena_new(arena, 1, sizeof *matrix);
    if (!matrix)
        return NULL;
    *matrix = (struct value_matrix){.rows = rows, .columns = columns, .exact = true};
    matrix->values = arena_new(arena, rows * columns, sizeof *matrix->values);
    if (!matrix->values)
        return NULL;
    for (size_t i = 0; i < rows * columns; i++)
        matrix->values[i] = value_from_integer(0);
    return matrix;
}

void value_matrix_finish(struct value_matrix *matrix)
{
    matrix->exact = true;
    for (size_t i = 0; i < matrix->rows * matrix->columns; i++)
        matrix->exact = matrix->exact && matrix->values[i].exact;
}

struct value_matrix *value_matrix_multiply(struct arena *arena, const struct value_matrix *a,
                                           const struct value_matrix *b)
{
    struct value_matrix *c = value_matrix_new(arena, a->rows, b->columns);
    if (!c)
        return NULL;
    for (size_t i = 0; i < a->rows; i++)
        for (size_t k = 0; k < a->columns; k++) {
            const struct value factor = a->values[i * a->columns + k];
            if (factor.exact && factor.residue == 0)
                continue;
            for (size_t j = 0; j < b->columns; j++) {
                struct value *sum = &c->values[i * c->columns + j];
                *sum = value_add(*sum, value_multiply(factor, b->values[k * b->columns + j]));
            }
        }
    c->exact = a->exact && b->exact;
    return c;
}
