/* Sparse matrices against dense ones that are made from the same triples, and Cholesky factors against A =
 * L·L^T, residuals, and the fill-in that is known for bands with corners and for trees. */
#include <math.h>
#include <string.h>

#include "numeric/sparse.h"
#include "numeric/sparse_cholesky.h"
#include "tap.h"

enum { MOST = 40 };

static uint64_t seed = 1;

static size_t below(size_t limit)
{
    return (size_t)(random_bits(&seed) % limit);
}

static double number(void)
{
    return (double)(random_bits(&seed) >> 11) / 4503599627370496.0 - 1;
}

/* A random matrix and the same dense, rows × width, summed in the order of the triples. */
static struct sparse random_sparse(size_t rows, size_t width, size_t count, double *dense,
                                   struct arena *arena)
{
    struct triple triples[4 * MOST];
    struct sparse a = {0};
    memset(dense, 0, rows * width * sizeof *dense);
    for (size_t k = 0; k < count; k++) {
        triples[k] = (struct triple){below(rows), below(width), (double)below(9) - 4};
        dense[triples[k].row * width + triples[k].column] += triples[k].value;
    }
    sparse_from_triples(&a, rows, width, triples, count, arena);
    return a;
}

/* Columns rise, no zero is held, and every entry is that of the dense matrix: integers, so exactly. */
static bool is_equal(const struct sparse *a, const double *dense)
{
    size_t held = 0;
    for (size_t i = 0; i < a->rows; i++)
        for (size_t k = a->starts[i]; k < a->starts[i + 1]; k++)
            if (a->values[k] == 0 || (k > a->starts[i] && a->columns[k] <= a->columns[k - 1]))
                return false;
    for (size_t i = 0; i < a->rows * a->width; i++) {
        held += dense[i] != 0;
        if (sparse_entry(a, i / a->width, i % a->width) != dense[i])
            return false;
    }
    return held == a->starts[a->rows];
}

static bool product_holds(const struct sparse *a, const double *x, const struct sparse *b, const double *y,
                          struct arena *arena)
{
    static double z[MOST * MOST];
    struct sparse c;
    for (size_t i = 0; i < a->rows; i++)
        for (size_t j = 0; j < b->width; j++) {
            z[i * b->width + j] = 0;
            for (size_t k = 0; k < a->width; k++)
                z[i * b->width + j] += x[i * a->width + k] * y[k * b->width + j];
        }
    return sparse_multiply(a, b, &c, arena) && is_equal(&c, z);
}

static bool transpose_holds(const struct sparse *a, const double *x, struct arena *arena)
{
    static double z[MOST * MOST];
    struct sparse b;
    for (size_t i = 0; i < a->rows * a->width; i++)
        z[i % a->width * a->rows + i / a->width] = x[i];
    return sparse_transpose(a, &b, arena) && is_equal(&b, z);
}

static bool select_holds(const struct sparse *a, const double *x, struct arena *arena)
{
    static double z[MOST * MOST];
    size_t rows[MOST], columns[MOST], row_count = 0, column_count = 0, one_in = 1 + below(12);
    struct sparse b;
    for (size_t i = 0; i < a->rows; i++)
        if (below(2) == 0)
            rows[row_count++] = i;
    for (size_t j = 0; j < a->width; j++)
        if (below(one_in) == 0)
            columns[column_count++] = j;
    for (size_t i = 0; i < row_count; i++)
        for (size_t j = 0; j < column_count; j++)
            z[i * column_count + j] = x[rows[i] * a->width + columns[j]];
    return sparse_select(a, rows, row_count, columns, column_count, &b, arena) && is_equal(&b, z);
}

static bool apply_holds(const struct sparse *a, const double *x, size_t components)
{
    double in[MOST * 3], out[MOST * 3], expected[MOST * 3];
    for (size_t i = 0; i < a->width * components; i++)
        in[i] = (double)below(9) - 4;
    for (size_t i = 0; i < a->rows * components; i++) {
        out[i] = 100;
        expected[i] = 0;
        for (size_t k = 0; k < a->width; k++)
            expected[i] += x[i / components * a->width + k] * in[k * components + i % components];
    }
    sparse_apply(a, in, components, false, out);
    bool holds = memcmp(out, expected, a->rows * components * sizeof *out) == 0;
    sparse_apply(a, in, components, true, out);
    for (size_t i = 0; i < a->rows * components; i++)
        holds = holds && out[i] == 2 * expected[i];
    return holds;
}

static void test_algebra(void)
{
    static double x[MOST * MOST], y[MOST * MOST];
    int failures = 0;
    for (long round = 0; round < test_effort(1500); round++) {
        struct arena arena = {0};
        size_t rows = 1 + below(MOST), inner = 1 + below(MOST), columns = 1 + below(MOST);
        struct sparse a = random_sparse(rows, inner, below(4 * MOST), x, &arena);
        struct sparse b = random_sparse(inner, columns, below(4 * MOST), y, &arena);
        bool holds = is_equal(&a, x) && product_holds(&a, x, &b, y, &arena) &&
                     transpose_holds(&a, x, &arena) && select_holds(&a, x, &arena);
        for (size_t components = 1; components <= 3; components++)
            holds = holds && apply_holds(&a, x, components);
        if (!holds && ++failures < 5)
            note("round %ld: %zu × %zu × %zu", round, rows, inner, columns);
        arena_free(&arena);
    }
    ok(failures == 0, "sums, products, transposes, parts and images are those of dense matrices");
}

/* ---- Cholesky ------------------------------------------------------------------------------------------ */

/* Symmetric and dominated by its diagonal, in units that differ from row to row: size × size. */
static struct sparse random_definite(size_t size, size_t count, struct arena *arena)
{
    struct triple *triples = arena_new(arena, 4 * count + size, sizeof *triples);
    double *units = arena_new(arena, size, sizeof *units);
    struct sparse a = {0};
    for (size_t i = 0; i < size; i++) {
        units[i] = exp(8 * number());
        triples[4 * count + i] = (struct triple){i, i, 0.01 * units[i] * units[i]};
    }
    for (size_t k = 0; k < count; k++) {
        size_t i = below(size), j = below(size);
        double value = number();
        triples[4 * k] = (struct triple){i, i, fabs(value) * units[i] * units[i]};
        triples[4 * k + 1] = (struct triple){j, j, fabs(value) * units[j] * units[j]};
        triples[4 * k + 2] = (struct triple){i, j, i == j ? 0 : value * units[i] * units[j]};
        triples[4 * k + 3] = (struct triple){j, i, i == j ? 0 : value * units[i] * units[j]};
    }
    sparse_from_triples(&a, size, size, triples, 4 * count + size, arena);
    return a;
}

static bool is_permutation(const size_t *order, size_t size)
{
    bool met[4 * MOST] = {false};
    for (size_t i = 0; i < size; i++) {
        if (order[i] >= size || met[order[i]])
            return false;
        met[order[i]] = true;
    }
    return true;
}

/* |A - L·L^T| and |A x - b|, both relative to what their terms are made of. */
static double factor_error(const struct sparse *a, const struct sparse_cholesky *factor, struct arena *arena)
{
    size_t size = a->rows;
    double *l = arena_new(arena, size * size, sizeof *l), worst = 0;
    for (size_t j = 0; j < size; j++)
        for (size_t k = factor->starts[j]; k < factor->starts[j + 1]; k++)
            l[factor->rows[k] * size + j] = factor->values[k];
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < size; j++) {
            size_t row = factor->order ? factor->order[i] : i, column = factor->order ? factor->order[j] : j;
            double difference = -sparse_entry(a, row, column);
            for (size_t k = 0; k < size; k++)
                difference += l[i * size + k] * l[j * size + k];
            worst = fmax(worst, fabs(difference) /
                                    sqrt(sparse_entry(a, row, row) * sparse_entry(a, column, column)));
        }
    return worst;
}

static double solution_error(const struct sparse *a, const struct sparse_cholesky *factor,
                             struct arena *arena)
{
    enum { COMPONENTS = 3 };
    size_t count = a->rows * COMPONENTS;
    double *x = arena_new(arena, count, sizeof *x), *b = arena_new(arena, count, sizeof *b);
    double *sizes = arena_new(arena, count, sizeof *sizes), *workspace = arena_new(arena, count, sizeof *x);
    double worst = 0;
    for (size_t i = 0; i < count; i++)
        x[i] = b[i] = number();
    sparse_cholesky_solve(factor, x, COMPONENTS, workspace);
    for (size_t i = 0; i < a->rows; i++)
        for (size_t c = 0; c < COMPONENTS; c++) {
            double difference = -b[i * COMPONENTS + c], terms = fabs(b[i * COMPONENTS + c]);
            for (size_t k = a->starts[i]; k < a->starts[i + 1]; k++) {
                difference += a->values[k] * x[a->columns[k] * COMPONENTS + c];
                terms += sqrt(sparse_entry(a, i, i) * sparse_entry(a, a->columns[k], a->columns[k])) *
                         fabs(x[a->columns[k] * COMPONENTS + c]);
            }
            worst = fmax(worst, fabs(difference) / terms);
        }
    return worst;
}

static void test_cholesky(void)
{
    int failures = 0;
    for (long round = 0; round < test_effort(400); round++) {
        struct arena arena = {0};
        struct sparse_cholesky factor;
        size_t size = 1 + below(2 * MOST), order[2 * MOST];
        struct sparse a = random_definite(size, below(2 * size) + below(size * size / 8 + 1), &arena);
        bool ordered = below(4) > 0;
        bool holds = sparse_order(&a, order) && is_permutation(order, size) &&
                     sparse_cholesky_factor(&a, ordered ? order : NULL, &arena, &factor) == SPARSE_DONE &&
                     factor_error(&a, &factor, &arena) < 1e-13 && solution_error(&a, &factor, &arena) < 1e-13;
        if (!holds && ++failures < 5)
            note("round %ld: size %zu, ordered %d", round, size, ordered);
        arena_free(&arena);
    }
    ok(failures == 0, "L·L^T is A, and A x = b is solved, whatever the units of rows");
}

/* diag(1, …, 1) - c c^T is definite exactly while |c| < 1. */
static void test_indefinite(void)
{
    int failures = 0;
    for (long round = 0; round < test_effort(300); round++) {
        struct arena arena = {0};
        struct sparse_cholesky factor;
        struct sparse a;
        struct triple triples[144];
        double c[12], square = 0, goal = below(2) ? 1.001 : 0.999;
        size_t size = 1 + below(12);
        for (size_t i = 0; i < size; i++) {
            c[i] = number();
            square += c[i] * c[i];
        }
        for (size_t i = 0; i < size * size; i++)
            triples[i] = (struct triple){i / size, i % size,
                                         (i / size == i % size) - goal * c[i / size] * c[i % size] / square};
        sparse_from_triples(&a, size, size, triples, size * size, &arena);
        enum sparse_outcome outcome = sparse_cholesky_factor(&a, NULL, &arena, &factor);
        if (outcome != (goal < 1 ? SPARSE_DONE : SPARSE_INDEFINITE) && ++failures < 5)
            note("size %zu, |c|^2 = %g: %d", size, goal, outcome);
        arena_free(&arena);
    }
    ok(failures == 0, "a matrix is definite or not");
}

/* ---- Fill-in ------------------------------------------------------------------------------------------- */

/* The band |i - j| <= reach, closed, in a random numbering or as it comes. */
static struct sparse band(size_t size, size_t reach, bool shuffled, struct arena *arena)
{
    size_t *names = arena_new(arena, size, sizeof *names), count = 0;
    struct triple *triples = arena_new(arena, size * (2 * reach + 1), sizeof *triples);
    struct sparse a = {0};
    for (size_t i = 0; i < size; i++) {
        size_t other = shuffled ? below(i + 1) : i;
        names[i] = names[other];
        names[other] = i;
    }
    for (size_t i = 0; i < size; i++)
        for (size_t k = 0; k <= 2 * reach; k++) {
            size_t j = (i + size + k - reach) % size;
            triples[count++] = (struct triple){names[i], names[j], i == j ? 4.0 * (double)reach : 1};
        }
    sparse_from_triples(&a, size, size, triples, count, arena);
    return a;
}

/* The five-point star on side × side nodes. */
static struct sparse grid(size_t side, struct arena *arena)
{
    size_t size = side * side, count = 0;
    struct triple *triples = arena_new(arena, 5 * size, sizeof *triples);
    struct sparse a = {0};
    for (size_t i = 0; i < size; i++) {
        triples[count++] = (struct triple){i, i, 5};
        if (i % side + 1 < side) {
            triples[count++] = (struct triple){i, i + 1, -1};
            triples[count++] = (struct triple){i + 1, i, -1};
        }
        if (i + side < size) {
            triples[count++] = (struct triple){i, i + side, -1};
            triples[count++] = (struct triple){i + side, i, -1};
        }
    }
    sparse_from_triples(&a, size, size, triples, count, arena);
    return a;
}

/* A dyadic hierarchy, coarse first: a detail of level k is coupled with those around it on all levels above.
 */
static struct sparse hierarchy(size_t levels, struct arena *arena)
{
    size_t size = (size_t)1 << levels, count = 0;
    struct triple *triples = arena_new(arena, 4 * size * (levels + 1), sizeof *triples);
    struct sparse a = {0};
    for (size_t i = 0; i < size; i++) {
        triples[count++] = (struct triple){i, i, 1};
        for (size_t above = i / 2; i > 0; above /= 2) {
            triples[count++] = (struct triple){i, above, -1};
            triples[count++] = (struct triple){above, i, -1};
            triples[count++] = (struct triple){i, i, 1};
            triples[count++] = (struct triple){above, above, 1};
            if (above == 0)
                break;
        }
    }
    sparse_from_triples(&a, size, size, triples, count, arena);
    return a;
}

/* Entries of L below the diagonal for each in the lower half of A. */
static double fill(const struct sparse *a, struct arena *arena)
{
    size_t *order = arena_new(arena, a->rows, sizeof *order);
    struct sparse_cholesky factor;
    if (!sparse_order(a, order) || sparse_cholesky_factor(a, order, arena, &factor) != SPARSE_DONE)
        return INFINITY;
    return (double)(factor.starts[a->rows] - a->rows) / ((double)(a->starts[a->rows] - a->rows) / 2);
}

static void test_fill(void)
{
    struct arena arena = {0};
    struct sparse a = band(20000, 2, false, &arena), b = band(20000, 2, true, &arena);
    struct sparse c = hierarchy(13, &arena), e = grid(60, &arena);
    double plain = fill(&a, &arena), shuffled = fill(&b, &arena), fine = fill(&c, &arena);
    ok(plain <= 2, "a closed band fills at most twice (%.3f)", plain);
    ok(shuffled <= 3, "so does one whose rows are shuffled, nearly (%.3f)", shuffled);
    ok(fine <= 1, "a hierarchy does not fill at all (%.3f)", fine);
    /* Bands fill side/2 times, 30, or two thirds of that along diagonals; minimum degree does much better. */
    double planar = fill(&e, &arena);
    ok(planar < 10, "a grid fills little (%.3f)", planar);
    arena_free(&arena);
}

int main(void)
{
    test_algebra();
    test_cholesky();
    test_indefinite();
    test_fill();
    return done_testing();
}
