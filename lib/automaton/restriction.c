#include "restriction.h"

#include <complex.h>
#include <float.h>
#include <math.h>

#include "numeric/enclosure.h"
#include "numeric/field.h"
#include "numeric/matrix.h"
#include "numeric/rational.h"
#include "numeric/tolerance.h"
#include "numeric/value_equations.h"

/* ---- Values -------------------------------------------------------------------------------------------- */

/* a + factor·b. */
static struct bounded_value add_multiple(struct bounded_value a, struct value factor, struct bounded_value b)
{
    struct bounded_value sum;
    sum.value = value_add(a.value, value_multiply(factor, b.value));
    double size = fabs(factor.real);
    sum.error =
        (a.error + size * b.error + DBL_EPSILON * (fabs(a.value.real) + 2 * size * fabs(b.value.real))) *
        (1 + 4 * DBL_EPSILON);
    sum.error = value_pin(&sum.value, sum.error);
    return sum;
}

/* ---- Kernels ------------------------------------------------------------------------------------------- */

/* Basis vectors of ker q, by pairs of places where q is not 0 (second > first), or one place where it is. */
struct kernel {
    size_t size;          /* of q */
    const size_t *places; /* size: those with q != 0, rising, then the others, rising */
    size_t support;
    const struct value
        *ratios; /* ratios[a] = q[places[a]] / q[places[a+1]]: basis vector e_a - ratio e_a+1 */
};

/* A ratio of entries known in doubles that is nearly an integer is that integer: q is constant for masks. */
static struct value ratio_make(struct value a, struct value b)
{
    struct value ratio = value_divide(a, b);
    double nearest = nearbyint(ratio.real);
    if (!ratio.exact && fabs(nearest) < 1e6 &&
        fabs(ratio.real - nearest) <= TOLERANCE_REPRODUCTION * fabs(nearest))
        ratio = value_from_integer((int64_t)nearest);
    value_pin(&ratio, 0);
    return ratio;
}

static bcifs_status kernel_make(const struct value *q, size_t size, struct arena *arena,
                                struct kernel *kernel)
{
    size_t *places = arena_new(arena, size, sizeof *places), count = 0;
    struct value *ratios = arena_new(arena, size, sizeof *ratios);
    double scale = 0;
    if (!places || !ratios)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < size; i++)
        scale = fmax(scale, fabs(q[i].real));
    for (size_t i = 0; i < size; i++)
        if (!value_is_negligible(q[i], scale))
            places[count++] = i;
    *kernel = (struct kernel){size, places, count, ratios};
    for (size_t i = 0; i < size; i++)
        if (value_is_negligible(q[i], scale))
            places[count++] = i;
    for (size_t a = 0; a + 1 < kernel->support; a++)
        ratios[a] = ratio_make(q[places[a]], q[places[a + 1]]);
    return BCIFS_OK;
}

/* Dimension of the kernel, and basis vector k as entries at one or two places. */
static size_t kernel_dimension(const struct kernel *kernel)
{
    return kernel->support > 0 ? kernel->size - 1 : kernel->size;
}

/* A column w in coordinates of the old basis to its coordinates c in the new one: c_a = w_a + ratio_a-1 c_a-1
 * from the front. What is left over at the last place is 0 for a column in the kernel; `defect` receives its
 * size beyond what errors explain. The same from the back is c_a-1 = (c_a - w_a) / ratio_a-1: of numbers that
 * are not exact the one with the smaller error is taken, because errors grow like binomial coefficients along
 * the way. */
static void kernel_coordinates(const struct kernel *kernel, const struct bounded_value *column,
                               struct bounded_value *result, size_t stride, double *defect)
{
    static const struct bounded_value zero = {{0, 0, true, true}, 0};
    const struct value *ratios = kernel->ratios;
    struct bounded_value carry = zero;
    size_t last = kernel->support - 1, k = 0; /* of the support, when there is one */
    for (size_t a = 0; a < kernel->support; a++) {
        carry = add_multiple(column[kernel->places[a]], a > 0 ? ratios[a - 1] : zero.value, carry);
        if (a < last)
            result[k++ * stride] = carry;
        else
            *defect = fmax(*defect, fabs(carry.value.real) - carry.error);
    }
    if (!carry.value.exact)
        carry = zero;
    for (size_t a = kernel->support; a-- > 1 && !column[kernel->places[a]].value.exact;) {
        struct value inverse = value_divide(value_from_integer(1), ratios[a - 1]);
        carry = add_multiple(carry, value_from_integer(-1), column[kernel->places[a]]);
        carry = add_multiple(zero, inverse, carry);
        carry.error *= 1 + 2 * DBL_EPSILON; /* the inverse is rounded, too */
        if (carry.error < result[(a - 1) * stride].error)
            result[(a - 1) * stride] = carry;
    }
    for (size_t a = kernel->support; a < kernel->size; a++)
        result[k++ * stride] = column[kernel->places[a]];
}

/* R with A D = D' R, the columns of D and D' being the bases of the kernels. Where numbers are not exact,
 * what their errors leave unexplained of the difference is added to them. */
static bcifs_status map_reduce(struct restricted_map *map, const struct kernel *from, const struct kernel *to,
                               struct arena *arena)
{
    size_t rows = from->size, columns = to->size;
    size_t new_rows = kernel_dimension(from), new_columns = kernel_dimension(to);
    struct bounded_value *column = arena_new(arena, rows, sizeof *column);
    struct bounded_value *entries = arena_new(arena, new_rows * new_columns, sizeof *entries);
    double defect = 0;
    bool exact = true;
    if (!column || !entries)
        return BCIFS_MEMORY;
    for (size_t k = 0; k < new_columns; k++) {
        bool pair = k + 1 < to->support;
        size_t first = to->places[pair || to->support == 0 ? k : k + 1];
        for (size_t i = 0; i < rows; i++) {
            column[i] = map->entries[i * columns + first];
            if (pair)
                column[i] = add_multiple(column[i], value_negate(to->ratios[k]),
                                         map->entries[i * columns + to->places[k + 1]]);
            exact = exact && column[i].value.exact;
        }
        kernel_coordinates(from, column, entries + k, new_columns, &defect);
    }
    for (size_t i = 0; i < new_rows * new_columns && !exact; i++)
        entries[i].error += defect;
    map->entries = entries;
    return BCIFS_OK;
}

/* ---- Numbers that are not exact ------------------------------------------------------------------------ */

/* B <- B D, the columns of D being the basis of the kernel. */
static double *basis_reduce(const double *basis, size_t points, const struct kernel *kernel,
                            struct arena *arena)
{
    size_t columns = kernel_dimension(kernel);
    double *result = arena_new(arena, points * columns, sizeof *result);
    for (size_t k = 0; result && k < columns; k++) {
        bool pair = k + 1 < kernel->support;
        size_t first = kernel->places[pair || kernel->support == 0 ? k : k + 1];
        for (size_t i = 0; i < points; i++) {
            result[i * columns + k] = basis[i * kernel->size + first];
            if (pair)
                result[i * columns + k] -=
                    kernel->ratios[k].real * basis[i * kernel->size + kernel->places[k + 1]];
        }
    }
    return result;
}

/* L with L B = I + G, B rows × columns of full rank, L = (B^T B)^-1 B^T with two steps L <- (2 I - L B) L,
 * and a bound of each |G_ij|. */
static bcifs_status left_inverse(const double *basis, size_t rows, size_t columns, struct arena *arena,
                                 double **inverse, double **excess)
{
    double complex *gram = arena_new(arena, columns * columns, sizeof *gram);
    double complex *right = arena_new(arena, columns * rows, sizeof *right);
    double *l = *inverse = arena_new(arena, columns * rows, sizeof *l);
    double *g = *excess = arena_new(arena, columns * columns, sizeof *g);
    double *next = arena_new(arena, columns * rows, sizeof *next);
    if (!gram || !right || !l || !g || !next)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < columns; i++) {
        for (size_t k = 0; k < rows; k++)
            right[i * rows + k] = basis[k * columns + i];
        for (size_t j = 0; j < columns; j++)
            for (size_t k = 0; k < rows; k++)
                gram[i * columns + j] += basis[k * columns + i] * basis[k * columns + j];
    }
    complex_solve(gram, right, columns, rows, DBL_MIN);
    for (size_t i = 0; i < columns * rows; i++)
        l[i] = creal(right[i]);
    for (int step = 0; step < 3; step++) {
        matrix_multiply(l, basis, columns, rows, columns, g);
        for (size_t i = 0; i < columns; i++)
            g[i * columns + i] -= 1;
        if (step == 2)
            break;
        matrix_multiply(g, l, columns, columns, rows, next);
        for (size_t i = 0; i < columns * rows; i++)
            l[i] -= next[i];
    }
    for (size_t i = 0; i < columns; i++)
        for (size_t j = 0; j < columns; j++) {
            double size = 1;
            for (size_t k = 0; k < rows; k++)
                size += fabs(l[i * rows + k] * basis[k * columns + j]);
            g[i * columns + j] = fabs(g[i * columns + j]) + (double)(rows + 2) * DBL_EPSILON * size;
        }
    return BCIFS_OK;
}

/* R = L T B for T B = B' R, L B' = I: a far better answer than differences of differences, because L is
 * small. Every entry whose error is smaller is taken. Bounds of errors go along entry by entry; what they
 * leave unexplained of T B - B' R is added. */
static bcifs_status map_refine(const struct restriction *restriction, struct restricted_map *map,
                               const double *inverse, const double *excess, struct arena *arena)
{
    size_t rows = restriction->points[map->from], inner = restriction->points[map->to];
    size_t size = restriction->dimensions[map->from], columns = restriction->dimensions[map->to];
    const double *from = restriction->basis[map->from], *to = restriction->basis[map->to];
    double *numbers = arena_new(arena, 2 * (rows + size) * columns, sizeof *numbers), unexplained = 0,
           reach = 0;
    if (!numbers)
        return BCIFS_MEMORY;
    double *w = numbers, *off_w = w + rows * columns, *r = off_w + rows * columns,
           *off_r = r + size * columns;
    double unit = (double)(inner + rows + size + 4) * DBL_EPSILON;
    for (size_t i = 0; i < rows; i++)
        for (size_t j = 0; j < columns; j++)
            for (size_t k = 0; k < inner; k++) {
                const struct bounded_value *entry = &map->whole[i * inner + k];
                w[i * columns + j] += entry->value.real * to[k * columns + j];
                off_w[i * columns + j] +=
                    (entry->error + unit * fabs(entry->value.real)) * fabs(to[k * columns + j]);
            }
    for (size_t i = 0; i < size; i++)
        for (size_t k = 0; k < rows; k++) {
            double factor = inverse[i * rows + k];
            reach = fmax(reach, fabs(factor));
            for (size_t j = 0; j < columns; j++) {
                r[i * columns + j] += factor * w[k * columns + j];
                off_r[i * columns + j] +=
                    fabs(factor) * (off_w[k * columns + j] + unit * fabs(w[k * columns + j]));
            }
        }
    for (size_t i = 0; i < rows; i++)
        for (size_t j = 0; j < columns; j++) {
            double rest = w[i * columns + j], allowed = off_w[i * columns + j];
            for (size_t k = 0; k < size; k++) {
                rest -= from[i * size + k] * r[k * columns + j];
                allowed +=
                    fabs(from[i * size + k]) * (off_r[k * columns + j] + unit * fabs(r[k * columns + j]));
            }
            unexplained = fmax(unexplained, fabs(rest) - allowed);
        }
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < columns; j++) {
            double error = off_r[i * columns + j] + (double)rows * reach * unexplained;
            struct bounded_value *entry = &map->entries[i * columns + j];
            for (size_t k = 0; k < size; k++)
                error += 1.1 * excess[i * size + k] * (fabs(r[k * columns + j]) + off_r[k * columns + j]);
            error *= 1 + unit;
            if (!entry->value.exact && error < entry->error)
                *entry = (struct bounded_value){value_from_real(r[i * columns + j]), error};
        }
    return BCIFS_OK;
}

static bcifs_status restriction_refine(struct restriction *restriction, const struct kernel *kernels,
                                       struct arena *arena)
{
    double **inverse = arena_new(arena, restriction->count, sizeof *inverse);
    double **excess = arena_new(arena, restriction->count, sizeof *excess);
    bcifs_status status = inverse && excess ? BCIFS_OK : BCIFS_MEMORY;
    for (size_t x = 0; x < restriction->count; x++)
        if (restriction->points[x] > RESTRICTION_MOST_UNKNOWNS)
            return status; /* nor are functionals looked for */
    for (size_t x = 0; x < restriction->count && status == BCIFS_OK; x++) {
        restriction->basis[x] =
            basis_reduce(restriction->basis[x], restriction->points[x], &kernels[x], arena);
        status = restriction->basis[x]
                     ? left_inverse(restriction->basis[x], restriction->points[x], restriction->dimensions[x],
                                    arena, &inverse[x], &excess[x])
                     : BCIFS_MEMORY;
    }
    for (size_t e = 0; e < restriction->map_count && status == BCIFS_OK; e++) {
        size_t from = restriction->maps[e].from;
        status = map_refine(restriction, &restriction->maps[e], inverse[from], excess[from], arena);
    }
    return status;
}

/* ---- The chain of spaces ------------------------------------------------------------------------------- */

bcifs_status restriction_reduce(struct restriction *restriction, const struct value *const *q,
                                struct arena *arena)
{
    struct kernel *kernels = arena_new(arena, restriction->count, sizeof *kernels);
    size_t *dimensions = arena_new(arena, restriction->count, sizeof *dimensions);
    bcifs_status status = kernels && dimensions ? BCIFS_OK : BCIFS_MEMORY;
    for (size_t x = 0; x < restriction->count && status == BCIFS_OK; x++) {
        status = kernel_make(q[x], restriction->dimensions[x], arena, &kernels[x]);
        if (status == BCIFS_OK)
            dimensions[x] = kernel_dimension(&kernels[x]);
    }
    for (size_t e = 0; e < restriction->map_count && status == BCIFS_OK; e++) {
        struct restricted_map *map = &restriction->maps[e];
        status = map_reduce(map, &kernels[map->from], &kernels[map->to], arena);
    }
    restriction->dimensions = dimensions;
    if (status == BCIFS_OK && !restriction->exact)
        status = restriction_refine(restriction, kernels, arena);
    return status;
}

/* The equations q^x A - N^-k q^y = 0, one for each column of each map. */
static void functional_equations(const struct restriction *restriction, int k, const size_t *base,
                                 struct value *equations, size_t unknowns)
{
    struct value *equation = equations;
    for (size_t e = 0; e < restriction->map_count; e++) {
        const struct restricted_map *map = &restriction->maps[e];
        size_t columns = restriction->dimensions[map->to];
        struct value factor = value_divide(value_from_integer(1), value_power((int64_t)map->subdivisions, k));
        for (size_t j = 0; j < columns; j++, equation += unknowns) {
            for (size_t i = 0; i < unknowns; i++)
                equation[i] = value_from_integer(0);
            for (size_t i = 0; i < restriction->dimensions[map->from]; i++)
                equation[base[map->from] + i] = map->entries[i * columns + j].value;
            struct value *own = &equation[base[map->to] + j];
            *own = value_subtract(*own, factor);
        }
    }
}

bcifs_status restriction_functional(const struct restriction *restriction, int k, struct arena *arena,
                                    struct value **q, size_t *found)
{
    size_t *base = arena_new(arena, restriction->count + 1, sizeof *base), rows = 0, free = 0;
    *found = 0;
    if (!base)
        return BCIFS_MEMORY;
    for (size_t x = 0; x < restriction->count; x++)
        base[x + 1] = base[x] + restriction->dimensions[x];
    for (size_t e = 0; e < restriction->map_count; e++)
        rows += restriction->dimensions[restriction->maps[e].to];
    size_t unknowns = base[restriction->count];
    if (unknowns == 0 || unknowns > RESTRICTION_MOST_UNKNOWNS)
        return BCIFS_OK;
    struct value *equations = arena_new(arena, rows * unknowns, sizeof *equations);
    struct value *solution = arena_new(arena, unknowns, sizeof *solution);
    if (!equations || !solution)
        return BCIFS_MEMORY;
    functional_equations(restriction, k, base, equations, unknowns);
    bcifs_status status = equations_solve(equations, rows, unknowns, false, arena, solution, &free);
    for (size_t x = 0; x < restriction->count && status == BCIFS_OK; x++) {
        bool is_zero = true;
        q[x] = restriction->dimensions[x] > 0 ? solution + base[x] : NULL;
        for (size_t i = base[x]; i < base[x + 1] && free > 0; i++)
            is_zero = is_zero && value_is_negligible(solution[i], 1);
        *found += !is_zero;
    }
    return status;
}

bcifs_status restriction_begin(struct restriction *restriction, const struct states *states,
                               const size_t *list, size_t count, struct arena *arena)
{
    size_t *place = arena_new(arena, states->count, sizeof *place); /* in the list, from 1 */
    const struct value **ones = arena_new(arena, count, sizeof *ones);
    *restriction = (struct restriction){.count = count, .states = list, .exact = true};
    restriction->dimensions = arena_new(arena, count, sizeof *restriction->dimensions);
    restriction->basis = arena_new(arena, count, sizeof *restriction->basis);
    if (!place || !ones || !restriction->dimensions || !restriction->basis)
        return BCIFS_MEMORY;
    size_t map_count = 0;
    for (size_t x = 0; x < count; x++) {
        const struct state *state = &states->states[list[x]];
        place[list[x]] = x + 1;
        map_count += state->cell->child_count;
        struct value *q = arena_new(arena, state->points, sizeof *q);
        if (!q)
            return BCIFS_MEMORY;
        for (size_t i = 0; i < state->points; i++)
            q[i] = value_from_integer(1);
        ones[x] = q;
        restriction->dimensions[x] = state->points;
    }
    restriction->maps = arena_new(arena, map_count, sizeof *restriction->maps);
    if (!restriction->maps)
        return BCIFS_MEMORY;
    for (size_t x = 0; x < count; x++) {
        const struct state *state = &states->states[list[x]];
        for (size_t k = 0; k < state->cell->child_count; k++) {
            const struct value_matrix *matrix = state->cell->children[k].map;
            size_t entries = matrix->rows * matrix->columns;
            if (!place[state->children[k]])
                continue;
            struct restricted_map map = {
                x, place[state->children[k]] - 1, k, state->cell->child_count, NULL, NULL};
            map.whole = map.entries = arena_new(arena, entries, sizeof *map.entries);
            if (!map.entries)
                return BCIFS_MEMORY;
            for (size_t i = 0; i < entries; i++) {
                struct value value = matrix->values[i];
                double error = value_pin(&value, DBL_EPSILON * fabs(value.real));
                map.entries[i] = (struct bounded_value){value, error};
                restriction->exact = restriction->exact && value.exact;
            }
            restriction->maps[restriction->map_count++] = map;
        }
    }
    restriction->points = restriction->dimensions;
    for (size_t x = 0; x < count && !restriction->exact; x++) {
        size_t points = restriction->points[x];
        double *basis = restriction->basis[x] = arena_new(arena, points * points, sizeof *basis);
        for (size_t i = 0; basis && i < points; i++)
            basis[i * points + i] = 1;
        if (!basis)
            return BCIFS_MEMORY;
    }
    return restriction_reduce(restriction, ones, arena);
}

bcifs_status restriction_family(const struct restriction *restriction, struct arena *arena,
                                struct joint_family *family)
{
    struct joint_edge *edges = arena_new(arena, restriction->map_count, sizeof *edges);
    if (!edges)
        return BCIFS_MEMORY;
    *family =
        (struct joint_family){restriction->dimensions, restriction->count, edges, restriction->map_count};
    for (size_t e = 0; e < restriction->map_count; e++) {
        const struct restricted_map *map = &restriction->maps[e];
        size_t count = restriction->dimensions[map->from] * restriction->dimensions[map->to];
        double *matrix = arena_new(arena, count, sizeof *matrix),
               *error = arena_new(arena, count, sizeof *error);
        if (!matrix || !error)
            return BCIFS_MEMORY;
        for (size_t i = 0; i < count; i++) {
            matrix[i] = map->entries[i].value.real;
            error[i] = map->entries[i].error;
        }
        edges[e] = (struct joint_edge){map->from, map->to, matrix, error};
    }
    return BCIFS_OK;
}
