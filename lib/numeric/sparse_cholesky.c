#include "sparse_cholesky.h"

#include <math.h>
#include <string.h>

#include "numeric/tolerance.h"

/* The matrix in the order of elimination, of each row what is left of the diagonal, unsorted, and the
 * diagonal. */
struct ordered {
    size_t size;
    size_t *starts; /* size + 1 */
    uint32_t *columns;
    double *values;
    double *diagonal;
    uint32_t *parents; /* of the elimination tree; NONE: a root */
    uint32_t *marks;   /* workspace: size */
    uint32_t *stack;   /* workspace: size */
};

static const uint32_t NONE = UINT32_MAX;

/* place[order[i]] = i. */
static bool order_invert(const size_t *order, size_t size, struct arena *arena, uint32_t **places)
{
    *places = arena_new(arena, size, sizeof **places);
    for (size_t i = 0; *places && i < size; i++)
        (*places)[order ? order[i] : i] = (uint32_t)i;
    return *places != NULL;
}

static bool ordered_make(struct ordered *lower, const struct sparse *a, const size_t *order,
                         struct arena *arena)
{
    size_t size = a->rows, most = a->starts[size], count = 0;
    uint32_t *places;
    *lower = (struct ordered){.size = size};
    lower->starts = arena_new(arena, size + 1, sizeof *lower->starts);
    lower->columns = arena_new(arena, most, sizeof *lower->columns);
    lower->values = arena_new(arena, most, sizeof *lower->values);
    lower->diagonal = arena_new(arena, size, sizeof *lower->diagonal);
    lower->parents = arena_new(arena, size, sizeof *lower->parents);
    lower->marks = arena_new(arena, size, sizeof *lower->marks);
    lower->stack = arena_new(arena, size, sizeof *lower->stack);
    if (!lower->starts || !lower->columns || !lower->values || !lower->diagonal || !lower->parents ||
        !lower->marks || !lower->stack || !order_invert(order, size, arena, &places))
        return false;
    for (size_t i = 0; i < size; i++) {
        size_t row = order ? order[i] : i;
        for (size_t k = a->starts[row]; k < a->starts[row + 1]; k++) {
            uint32_t column = places[a->columns[k]];
            if (column == i)
                lower->diagonal[i] = a->values[k];
            if (column >= i)
                continue;
            lower->columns[count] = column;
            lower->values[count++] = a->values[k];
        }
        lower->starts[i + 1] = count;
    }
    return true;
}

/* parent(j) = the first i > j with L_ij ≠ 0: of each entry (i, j) the root above j gets i as its parent;
 * ancestors found on the way are shortcut to i (Liu 1986). */
static void find_parents(struct ordered *lower)
{
    uint32_t *ancestors = lower->marks;
    for (size_t i = 0; i < lower->size; i++) {
        lower->parents[i] = ancestors[i] = NONE;
        for (size_t k = lower->starts[i]; k < lower->starts[i + 1]; k++) {
            uint32_t next;
            for (uint32_t j = lower->columns[k]; j != NONE && j < i; j = next) {
                next = ancestors[j];
                ancestors[j] = (uint32_t)i;
                if (next == NONE)
                    lower->parents[j] = (uint32_t)i;
            }
        }
    }
    for (size_t i = 0; i < lower->size; i++)
        lower->marks[i] = NONE;
}

/* The columns of row i of L left of the diagonal, each before its ancestors: stack[result … size - 1]. They
 * are the paths of the tree from the entries of row i of A up to i. */
static size_t row_pattern(struct ordered *lower, size_t i)
{
    size_t top = lower->size;
    lower->marks[i] = (uint32_t)i;
    for (size_t k = lower->starts[i]; k < lower->starts[i + 1]; k++) {
        size_t length = 0;
        for (uint32_t j = lower->columns[k]; lower->marks[j] != i; j = lower->parents[j]) {
            lower->stack[length++] = j;
            lower->marks[j] = (uint32_t)i;
        }
        while (length > 0)
            lower->stack[--top] = lower->stack[--length];
    }
    return top;
}

/* Room for the columns of L, the diagonal first; `ends`: where column j is filled up to, at first its
 * diagonal. */
static bool factor_make(struct ordered *lower, struct arena *arena, struct sparse_cholesky *factor,
                        size_t *ends, uint32_t **rows, double **values)
{
    size_t *starts = arena_new(arena, lower->size + 1, sizeof *starts);
    if (!starts)
        return false;
    for (size_t i = 0; i < lower->size; i++) {
        starts[i + 1]++;
        for (size_t top = row_pattern(lower, i); top < lower->size; top++)
            starts[lower->stack[top] + 1]++;
    }
    for (size_t i = 0; i < lower->size; i++) {
        lower->marks[i] = NONE;
        starts[i + 1] += starts[i];
        ends[i] = starts[i];
    }
    *rows = arena_new(arena, starts[lower->size], sizeof **rows);
    *values = arena_new(arena, starts[lower->size], sizeof **values);
    factor->starts = starts;
    factor->rows = *rows;
    factor->values = *values;
    return *rows && *values;
}

/* Row i of L: solve L x = a_i with the rows above, L_ii = sqrt(a_ii - x·x). `x` (size) is zero before and
 * after. */
static bool row_factor(struct ordered *lower, size_t i, size_t *ends, uint32_t *rows, double *values,
                       const size_t *starts, double *x)
{
    double pivot = lower->diagonal[i];
    size_t top = row_pattern(lower, i);
    for (size_t k = lower->starts[i]; k < lower->starts[i + 1]; k++)
        x[lower->columns[k]] += lower->values[k];
    for (; top < lower->size; top++) {
        uint32_t j = lower->stack[top];
        double entry = x[j] / values[starts[j]];
        x[j] = 0;
        for (size_t k = starts[j] + 1; k < ends[j]; k++)
            x[rows[k]] -= values[k] * entry;
        pivot -= entry * entry;
        rows[ends[j]] = (uint32_t)i;
        values[ends[j]++] = entry;
    }
    if (!(pivot > TOLERANCE_SINGULAR * lower->diagonal[i]) || !isfinite(pivot))
        return false;
    rows[ends[i]] = (uint32_t)i;
    values[ends[i]++] = sqrt(pivot);
    return true;
}

static enum sparse_outcome factor_ordered(struct ordered *lower, struct arena *arena, struct arena *scratch,
                                          struct sparse_cholesky *factor)
{
    uint32_t *rows;
    double *values, *x = arena_new(scratch, lower->size, sizeof *x);
    size_t *ends = arena_new(scratch, lower->size, sizeof *ends);
    if (!x || !ends)
        return SPARSE_MEMORY;
    find_parents(lower);
    if (!factor_make(lower, arena, factor, ends, &rows, &values))
        return SPARSE_MEMORY;
    for (size_t i = 0; i < lower->size; i++)
        if (!row_factor(lower, i, ends, rows, values, factor->starts, x))
            return SPARSE_INDEFINITE;
    double *inverses = arena_new(arena, lower->size, sizeof *inverses);
    factor->inverses = inverses;
    for (size_t j = 0; inverses && j < lower->size; j++)
        inverses[j] = 1 / values[factor->starts[j]];
    return inverses ? SPARSE_DONE : SPARSE_MEMORY;
}

enum sparse_outcome sparse_cholesky_factor(const struct sparse *a, const size_t *order, struct arena *arena,
                                           struct sparse_cholesky *factor)
{
    struct arena scratch = {0};
    struct ordered lower;
    *factor = (struct sparse_cholesky){.size = a->rows, .order = order};
    enum sparse_outcome outcome = ordered_make(&lower, a, order, &scratch)
                                      ? factor_ordered(&lower, arena, &scratch, factor)
                                      : SPARSE_MEMORY;
    arena_free(&scratch);
    return outcome;
}

/* ---- Solution ------------------------------------------------------------------------------------------ */

/* L x = b, column after column, for components adjacent. */
static void solve_lower(const struct sparse_cholesky *factor, double *x, size_t components)
{
    for (size_t j = 0; j < factor->size; j++) {
        size_t k = factor->starts[j], end = factor->starts[j + 1];
        double *solved = x + j * components;
        for (size_t c = 0; c < components; c++)
            solved[c] *= factor->inverses[j];
        while (++k < end) {
            double *below = x + factor->rows[k] * components;
            for (size_t c = 0; c < components; c++)
                below[c] -= factor->values[k] * solved[c];
        }
    }
}

/* L^T x = b. */
static void solve_upper(const struct sparse_cholesky *factor, double *x, size_t components)
{
    for (size_t j = factor->size; j-- > 0;) {
        double *solved = x + j * components;
        for (size_t k = factor->starts[j] + 1; k < factor->starts[j + 1]; k++) {
            const double *below = x + factor->rows[k] * components;
            for (size_t c = 0; c < components; c++)
                solved[c] -= factor->values[k] * below[c];
        }
        for (size_t c = 0; c < components; c++)
            solved[c] *= factor->inverses[j];
    }
}

/* The same for planar points, whose sums stay in registers. */
static void solve_lower_planar(const struct sparse_cholesky *factor, double *x)
{
    for (size_t j = 0; j < factor->size; j++) {
        double u = x[2 * j] *= factor->inverses[j], v = x[2 * j + 1] *= factor->inverses[j];
        for (size_t k = factor->starts[j] + 1; k < factor->starts[j + 1]; k++) {
            double *below = x + 2 * (size_t)factor->rows[k];
            below[0] -= factor->values[k] * u;
            below[1] -= factor->values[k] * v;
        }
    }
}

static void solve_upper_planar(const struct sparse_cholesky *factor, double *x)
{
    for (size_t j = factor->size; j-- > 0;) {
        double u = x[2 * j], v = x[2 * j + 1];
        for (size_t k = factor->starts[j] + 1; k < factor->starts[j + 1]; k++) {
            const double *below = x + 2 * (size_t)factor->rows[k];
            u -= factor->values[k] * below[0];
            v -= factor->values[k] * below[1];
        }
        x[2 * j] = u * factor->inverses[j];
        x[2 * j + 1] = v * factor->inverses[j];
    }
}

void sparse_cholesky_lower(const struct sparse_cholesky *factor, double *x, size_t components,
                           double *workspace)
{
    size_t size = factor->size * components;
    for (size_t i = 0; factor->order && i < factor->size; i++)
        for (size_t c = 0; c < components; c++)
            workspace[i * components + c] = x[factor->order[i] * components + c];
    if (factor->order && size > 0)
        memcpy(x, workspace, size * sizeof *x);
    if (components == 2)
        solve_lower_planar(factor, x);
    else
        solve_lower(factor, x, components);
}

void sparse_cholesky_upper(const struct sparse_cholesky *factor, double *x, size_t components,
                           double *workspace)
{
    size_t size = factor->size * components;
    if (components == 2)
        solve_upper_planar(factor, x);
    else
        solve_upper(factor, x, components);
    if (factor->order && size > 0)
        memcpy(workspace, x, size * sizeof *x);
    for (size_t i = 0; factor->order && i < factor->size; i++)
        for (size_t c = 0; c < components; c++)
            x[factor->order[i] * components + c] = workspace[i * components + c];
}

void sparse_cholesky_solve(const struct sparse_cholesky *factor, double *x, size_t components,
                           double *workspace)
{
    sparse_cholesky_lower(factor, x, components, workspace);
    sparse_cholesky_upper(factor, x, components, workspace);
}
