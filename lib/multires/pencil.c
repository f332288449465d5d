#include "pencil.h"

#include "numeric/skew.h"

/* ---- Reduced ------------------------------------------------------------------------------------------- */

static enum sparse_outcome reduced_factor(void *context, double theta)
{
    struct pencil_reduced *reduced = context;
    bool definite = skew_factor(reduced->side, reduced->size, theta, reduced->below, reduced->inverse);
    return definite ? SPARSE_DONE : SPARSE_INDEFINITE;
}

static void reduced_solve(void *context, double *x)
{
    struct pencil_reduced *reduced = context;
    skew_solve(reduced->below, reduced->inverse, reduced->size, x);
}

static void reduced_apply(void *context, const double *x, double *y)
{
    struct pencil_reduced *reduced = context;
    skew_apply(reduced->side, reduced->size, x, y);
}

struct pencil pencil_of_reduced(struct pencil_reduced *reduced)
{
    return (struct pencil){reduced->size, reduced, reduced_factor, reduced_solve, reduced_apply};
}

/* ---- Sparse -------------------------------------------------------------------------------------------- */

void pencil_apply_skew(const struct sparse *m, const double *x, double *y)
{
    sparse_apply(m, x, 2, false, y);
    for (size_t i = 0; i < m->rows; i++) {
        double real = y[2 * i];
        y[2 * i] = y[2 * i + 1];
        y[2 * i + 1] = -real;
    }
}

/* Row 2i + part of the doubled matrix from rows i of K and M, merged: entries to the arrays from `count` on.
 * Each column holds K_ij at its own part, and θM_ij, negative in imaginary rows, at the other. */
static size_t double_row(const struct sparse *k, const struct sparse *m, size_t row,
                         struct pencil_sparse *sparse, uint32_t *columns, size_t count)
{
    size_t i = row / 2, part = row % 2, p = k->starts[i], q = m->starts[i];
    while (p < k->starts[i + 1] || q < m->starts[i + 1]) {
        size_t left = p < k->starts[i + 1] ? k->columns[p] : SIZE_MAX;
        size_t right = q < m->starts[i + 1] ? m->columns[q] : SIZE_MAX, column = left < right ? left : right;
        for (size_t other = 0; other < 2; other++) {
            if (other == part ? left != column : right != column)
                continue;
            columns[count] = (uint32_t)(2 * column + other);
            sparse->fixed[count] = other == part ? k->values[p] : 0;
            sparse->moving[count++] = other == part ? 0 : part == 0 ? m->values[q] : -m->values[q];
        }
        p += left == column;
        q += right == column;
    }
    return count;
}

bool pencil_sparse_make(struct pencil_sparse *sparse, const struct sparse *k, const struct sparse *m,
                        const size_t *order, struct arena *arena)
{
    size_t size = k->rows, most = 2 * (k->starts[size] + m->starts[size]), count = 0;
    size_t *starts = arena_new(arena, 2 * size + 1, sizeof *starts);
    uint32_t *columns = arena_new(arena, most, sizeof *columns);
    *sparse = (struct pencil_sparse){.skew = NULL};
    sparse->fixed = arena_new(arena, most, sizeof *sparse->fixed);
    sparse->moving = arena_new(arena, most, sizeof *sparse->moving);
    sparse->values = arena_new(arena, most, sizeof *sparse->values);
    sparse->order = arena_new(arena, 2 * size, sizeof *sparse->order);
    sparse->workspace = arena_new(arena, 2 * size, sizeof *sparse->workspace);
    if (!starts || !columns || !sparse->fixed || !sparse->moving || !sparse->values || !sparse->order ||
        !sparse->workspace)
        return false;
    for (size_t row = 0; row < 2 * size; row++) {
        starts[row + 1] = count = double_row(k, m, row, sparse, columns, count);
        sparse->order[row] = 2 * order[row / 2] + row % 2;
    }
    sparse->skew = m;
    sparse->pattern = (struct sparse){2 * size, 2 * size, starts, columns, sparse->values};
    return true;
}

static enum sparse_outcome sparse_factor(void *context, double theta)
{
    struct pencil_sparse *sparse = context;
    arena_free(&sparse->arena);
    for (size_t k = 0; k < sparse->pattern.starts[sparse->pattern.rows]; k++)
        sparse->values[k] = sparse->fixed[k] + theta * sparse->moving[k];
    return sparse_cholesky_factor(&sparse->pattern, sparse->order, &sparse->arena, &sparse->factor);
}

static void sparse_solve(void *context, double *x)
{
    struct pencil_sparse *sparse = context;
    sparse_cholesky_solve(&sparse->factor, x, 1, sparse->workspace);
}

static void sparse_image(void *context, const double *x, double *y)
{
    struct pencil_sparse *sparse = context;
    pencil_apply_skew(sparse->skew, x, y);
}

struct pencil pencil_of_sparse(struct pencil_sparse *sparse)
{
    return (struct pencil){sparse->skew->rows, sparse, sparse_factor, sparse_solve, sparse_image};
}

void pencil_sparse_free(struct pencil_sparse *sparse)
{
    arena_free(&sparse->arena);
}
