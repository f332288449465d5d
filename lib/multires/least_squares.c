#include "least_squares.h"

#include <math.h>
#include <string.h>

#include "numeric/sparse_cholesky.h"
#include "numeric/tolerance.h"

enum { REFINEMENTS = 4 /* each lowers the influence of the smoothing by its share */ };

/* The rows of M_j B(u_j), then those that smooth: J. With directions the coordinates hang together, and an
 * unknown is one of `block` = dimension coordinates of a control point; otherwise they are `components`
 * right-hand sides. */
struct equations {
    const struct least_squares *problem;
    size_t block, components;
    size_t data; /* rows for points; those that smooth follow */
    struct sparse matrix, transposed;
    double *residual; /* rows × components */
    struct arena arena;
};

/* √w_j M_j, block × block. */
static void weight_matrix(const struct equations *equations, size_t j, double *matrix)
{
    const struct least_squares *problem = equations->problem;
    double root = sqrt(problem->target->weights[j]), loss = 1 - sqrt(problem->slack);
    size_t block = equations->block;
    const double *direction = block > 1 ? problem->directions + j * block : NULL;
    for (size_t a = 0; a < block; a++)
        for (size_t c = 0; c < block; c++)
            matrix[a * block + c] = root * ((a == c) - (direction ? loss * direction[a] * direction[c] : 0));
}

/* Rows of point j and what they miss. */
static size_t point_fill(struct equations *equations, const double *x, size_t j, struct blending_entry *row,
                         uint32_t *columns, double *values, size_t *starts)
{
    const struct target *target = equations->problem->target;
    size_t block = equations->block, dimension = target->dimension, used = 0;
    double matrix[TARGET_MOST_DIMENSION * TARGET_MOST_DIMENSION], miss[TARGET_MOST_DIMENSION];
    size_t count = blending_row(equations->problem->blending, equations->problem->positions[j], row);
    weight_matrix(equations, j, matrix);
    memcpy(miss, target->points + j * dimension, dimension * sizeof *miss);
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < dimension; k++)
            miss[k] -= row[i].value * x[row[i].function * dimension + k];
    for (size_t a = 0; a < block; a++) {
        for (size_t i = 0; i < count; i++)
            for (size_t c = 0; c < block; c++, used++) {
                columns[used] = (uint32_t)(row[i].function * block + c);
                values[used] = row[i].value * matrix[a * block + c];
            }
        starts[a + 1] = starts[0] + used;
        if (block > 1)
            for (size_t c = 0; c < block; c++)
                equations->residual[j * block + a] += matrix[a * block + c] * miss[c];
    }
    for (size_t k = 0; k < dimension && block == 1; k++)
        equations->residual[j * dimension + k] = matrix[0] * miss[k];
    return used;
}

/* √ρ (x_{k+1} - x_k) for consecutive control points, around a closed curve; ρ is relative to the mean
 * diagonal entry of J^T J. */
static void smoothing_fill(const struct equations *equations, size_t used, uint32_t *columns, double *values,
                           size_t *starts)
{
    size_t functions = equations->problem->blending->functions, block = equations->block;
    double trace = 0;
    for (size_t i = 0; i < used; i++)
        trace += values[i] * values[i];
    double root = sqrt(TOLERANCE_SMOOTHING * trace / (double)(functions * block));
    size_t row = equations->data;
    for (size_t i = 0; i < functions; i++)
        for (size_t c = 0; c < block; c++, row++) {
            size_t next = i + 1 == functions ? 0 : i + 1;
            bool none = next == 0 && !equations->problem->blending->closed;
            columns[used] = (uint32_t)((next < i ? next : i) * block + c);
            columns[used + 1] = (uint32_t)((next < i ? i : next) * block + c);
            values[used] = none ? 0 : -root;
            values[used + 1] = none ? 0 : root;
            used += 2;
            starts[row + 1] = used;
        }
}

static bool equations_make(struct equations *equations, const double *x)
{
    const struct blending *blending = equations->problem->blending;
    size_t points = equations->problem->target->count, block = equations->block;
    size_t smoothing = blending->functions * block, rows = equations->data + smoothing, used = 0;
    size_t most = points * block * 2 * blending->width * block + 2 * smoothing;
    size_t *starts = arena_new(&equations->arena, rows + 1, sizeof *starts);
    uint32_t *columns = arena_new(&equations->arena, most, sizeof *columns);
    double *values = arena_new(&equations->arena, most, sizeof *values);
    struct blending_entry *row = arena_new(&equations->arena, 2 * blending->width, sizeof *row);
    equations->residual =
        arena_new(&equations->arena, rows * equations->components, sizeof *equations->residual);
    if (!starts || !columns || !values || !row || !equations->residual)
        return false;
    for (size_t j = 0; j < points; j++)
        used += point_fill(equations, x, j, row, columns + used, values + used, starts + j * block);
    smoothing_fill(equations, used, columns, values, starts);
    equations->matrix = (struct sparse){rows, smoothing, starts, columns, values};
    return sparse_transpose(&equations->matrix, &equations->transposed, &equations->arena);
}

/* x += (J^T J)^-1 J^T r, r -= J (the step), again and again; r of the rows that smooth stays 0. */
static bool refine(struct equations *equations, const struct sparse_cholesky *factor, double *x)
{
    size_t size = equations->matrix.width, components = equations->components, rows = equations->matrix.rows;
    double *step = arena_new(&equations->arena, size * components, sizeof *step);
    double *workspace = arena_new(&equations->arena, size * components, sizeof *workspace);
    double *change = arena_new(&equations->arena, rows * components, sizeof *change);
    if (!step || !workspace || !change)
        return false;
    for (int i = 0; i < REFINEMENTS; i++) {
        sparse_apply(&equations->transposed, equations->residual, components, false, step);
        sparse_cholesky_solve(factor, step, components, workspace);
        for (size_t k = 0; k < size * components; k++)
            x[k] += step[k];
        sparse_apply(&equations->matrix, step, components, false, change);
        for (size_t k = 0; k < equations->data * components; k++)
            equations->residual[k] -= change[k];
    }
    return true;
}

bcifs_status least_squares_solve(const struct least_squares *problem, double *x, struct report *report)
{
    unsigned dimension = problem->target->dimension;
    size_t block = problem->directions ? dimension : 1;
    struct equations equations = {.problem = problem,
                                  .block = block,
                                  .components = dimension / block,
                                  .data = problem->target->count * block};
    struct sparse normal;
    struct sparse_cholesky factor;
    enum sparse_outcome outcome = SPARSE_MEMORY;
    if (equations_make(&equations, x) &&
        sparse_multiply(&equations.transposed, &equations.matrix, &normal, &equations.arena))
        outcome = sparse_cholesky_factor(&normal, NULL, &equations.arena, &factor);
    if (outcome == SPARSE_DONE && !refine(&equations, &factor, x))
        outcome = SPARSE_MEMORY;
    arena_free(&equations.arena);
    if (outcome == SPARSE_INDEFINITE)
        return report_failure(report, BCIFS_INPUT, NULL,
                              "the blending functions depend on each other too much to be fitted");
    return outcome == SPARSE_MEMORY ? report_memory(report) : BCIFS_OK;
}
