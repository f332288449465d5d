#include "multires/similar.h"

#include <float.h>
#include <math.h>

#include "numeric/enclosure.h"
#include "numeric/joint_radius.h"
#include "numeric/tolerance.h"
#include "numeric/value_equations.h"

enum { MOST_SQUARINGS = 12 };
static const double LARGEST_POWER = 1e100; /* squares of what is larger might overflow */
static const double LARGEST_RATIO = 1e6;

/* ---- Frames -------------------------------------------------------------------------------------------- */

static struct value *zeros_new(struct arena *arena, size_t count)
{
    struct value *zeros = arena_new(arena, count, sizeof *zeros);
    for (size_t i = 0; zeros && i < count; i++)
        zeros[i] = value_from_integer(0);
    return zeros;
}

/* Doubles as near as can be, so that those computed from them keep the digits that tell a fraction. */
static void values_pin(struct value *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        value_pin(&values[i], 0);
}

bcifs_status frame_begin(struct frame *frame, size_t points, struct arena *arena)
{
    struct value *unit = zeros_new(arena, points * points);
    if (!unit)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < points; i++)
        unit[i * points + i] = value_from_integer(1);
    *frame = (struct frame){points, points, unit, unit};
    return BCIFS_OK;
}

/* φ = f B. */
static bcifs_status functional_restrict(const struct frame *frame, const struct value *functional,
                                        struct arena *arena, struct value **restricted)
{
    *restricted = zeros_new(arena, frame->dimension);
    for (size_t i = 0; *restricted && i < frame->points; i++)
        for (size_t k = 0; k < frame->dimension; k++)
            (*restricted)[k] = value_add(
                (*restricted)[k], value_multiply(functional[i], frame->basis[i * frame->dimension + k]));
    return *restricted ? BCIFS_OK : BCIFS_MEMORY;
}

/* Where φ is not 0, rising, then where it is; returns how many there are of the former. */
static size_t support_find(const struct value *phi, size_t count, size_t *places)
{
    double scale = 0;
    size_t support = 0, next = 0;
    for (size_t k = 0; k < count; k++)
        scale = fmax(scale, fabs(phi[k].real));
    for (size_t k = 0; k < count; k++)
        if (!value_is_negligible(phi[k], scale))
            places[support++] = k;
    next = support;
    for (size_t k = 0; k < count; k++)
        if (value_is_negligible(phi[k], scale))
            places[next++] = k;
    return support;
}

/* A ratio of numbers known in doubles that is nearly an integer is that integer: functionals are constant on
 * the differences of subdivision masks. */
static struct value ratio_make(struct value a, struct value b)
{
    struct value ratio = value_divide(a, b);
    double nearest = nearbyint(ratio.real);
    if (!ratio.exact && fabs(nearest) < LARGEST_RATIO &&
        fabs(ratio.real - nearest) <= TOLERANCE_REPRODUCTION * fabs(nearest))
        ratio = value_from_integer((int64_t)nearest);
    value_pin(&ratio, 0);
    return ratio;
}

/* b_k - (φ_k/φ_l) b_l for consecutive places k, l of the support, and all b_k with φ_k = 0. A column with
 * coordinates w has the coordinates c_a = w_a + ratio_a-1 c_a-1 along the support. */
bcifs_status frame_cut(struct frame *frame, const struct value *functional, struct arena *arena)
{
    struct value *phi;
    size_t count = frame->dimension, points = frame->points;
    size_t *places = arena_new(arena, count, sizeof *places);
    bcifs_status status = places ? functional_restrict(frame, functional, arena, &phi) : BCIFS_MEMORY;
    size_t support = status ? 0 : support_find(phi, count, places);
    if (status || support == 0)
        return status;
    struct value *basis = zeros_new(arena, points * (count - 1));
    struct value *coordinates = zeros_new(arena, (count - 1) * points);
    if (!basis || !coordinates)
        return BCIFS_MEMORY;
    struct value ratio = value_from_integer(0);
    for (size_t a = 0, k = 0; a < count; a++) {
        size_t place = places[a], follower = a + 1 < support ? places[a + 1] : place;
        struct value last = ratio;
        if (a + 1 == support)
            continue;
        ratio = a < support ? ratio_make(phi[place], phi[follower]) : value_from_integer(0);
        for (size_t i = 0; i < points; i++) {
            const struct value *row = &frame->basis[i * count];
            struct value coordinate = frame->coordinates[place * points + i];
            if (a < support && k > 0)
                coordinate = value_add(coordinate, value_multiply(last, coordinates[(k - 1) * points + i]));
            basis[i * (count - 1) + k] =
                a < support ? value_subtract(row[place], value_multiply(ratio, row[follower])) : row[place];
            coordinates[k * points + i] = coordinate;
        }
        k++;
    }
    values_pin(basis, points * (count - 1));
    values_pin(coordinates, (count - 1) * points);
    *frame = (struct frame){points, count - 1, basis, coordinates};
    return BCIFS_OK;
}

/* ---- The operator -------------------------------------------------------------------------------------- */

/* A map between frames; errors[i] bounds how far values[i].real may be off. */
struct restricted {
    size_t rows, columns;
    struct value *values;
    double *errors;
};

/* C = A·B with bounds of errors; A is rows × inner, B inner × columns. The errors of A and B, too, may be
 * NULL: entries are then what they are, up to their rounding when they are not exact. */
static void product_bounded(const struct value *a, const double *error_a, const struct value *b,
                            const double *error_b, size_t inner, struct restricted *c)
{
    double unit = (double)(inner + 4) * DBL_EPSILON;
    for (size_t i = 0; i < c->rows; i++)
        for (size_t j = 0; j < c->columns; j++) {
            struct value sum = value_from_integer(0);
            double error = 0;
            for (size_t k = 0; k < inner; k++) {
                struct value x = a[i * inner + k], y = b[k * c->columns + j], term = value_multiply(x, y);
                double off_x = error_a ? error_a[i * inner + k] : 0,
                       off_y = error_b ? error_b[k * c->columns + j] : 0;
                sum = value_add(sum, term);
                error += off_x * (fabs(y.real) + off_y) + fabs(x.real) * off_y + unit * fabs(term.real);
            }
            c->values[i * c->columns + j] = sum;
            c->errors[i * c->columns + j] = value_pin(&c->values[i * c->columns + j], error);
        }
}

/* What the entries of a frame may be off: those that were solved for in doubles are good to
 * TOLERANCE_EQUATION. */
static double *frame_errors(const struct value *values, size_t count, struct arena *arena)
{
    double *errors = arena_new(arena, count, sizeof *errors);
    for (size_t i = 0; errors && i < count; i++)
        errors[i] = values[i].exact ? 0 : TOLERANCE_EQUATION * fabs(values[i].real);
    return errors;
}

static bcifs_status restricted_new(size_t rows, size_t columns, struct arena *arena, struct restricted *r)
{
    *r = (struct restricted){rows, columns, arena_new(arena, rows * columns, sizeof *r->values),
                             arena_new(arena, rows * columns, sizeof *r->errors)};
    return r->values && r->errors ? BCIFS_OK : BCIFS_MEMORY;
}

/* R = L_x T B_y, so that T B_y = B_x R. */
static bcifs_status map_restrict(const struct value_matrix *map, const struct frame *from,
                                 const struct frame *to, struct arena *arena, struct restricted *r)
{
    struct restricted image;
    bcifs_status status = restricted_new(map->rows, to->dimension, arena, &image);
    if (status == BCIFS_OK)
        status = restricted_new(from->dimension, to->dimension, arena, r);
    double *error_b = frame_errors(to->basis, map->columns * to->dimension, arena);
    double *error_l = frame_errors(from->coordinates, from->dimension * map->rows, arena);
    if (status || !error_b || !error_l)
        return status ? status : BCIFS_MEMORY;
    product_bounded(map->values, NULL, to->basis, error_b, map->columns, &image);
    product_bounded(from->coordinates, error_l, image.values, image.errors, map->rows, r);
    return BCIFS_OK;
}

/* The matrix of the operator on the entries of all forms, with bounds of its errors. */
struct action {
    size_t count;
    size_t *base; /* first entry of each place; of members only */
    struct value *values;
    double *errors;
};

/* Entries c_ab with a < b, and a = b of symmetric forms. */
static size_t entry_count(size_t dimension, int sign)
{
    return sign < 0 ? dimension * (dimension - (dimension > 0)) / 2 : dimension * (dimension + 1) / 2;
}

static const struct state *state_at(const struct similar *similar, size_t place)
{
    return &similar->states->states[similar->reach->list[place]];
}

size_t similar_unknowns(const struct similar *similar)
{
    const struct reach *reach = similar->reach;
    size_t count = 0;
    for (size_t k = reach->first[similar->component]; k < reach->first[similar->component + 1]; k++)
        count += entry_count(similar->frames[reach->members[k]].dimension, similar->sign);
    return count;
}

/* The product of two entries of R, and how far off it is. */
static struct value entries_multiply(const struct restricted *r, size_t i, size_t j, double *error)
{
    double x = fabs(r->values[i].real), y = fabs(r->values[j].real);
    *error += r->errors[i] * (y + r->errors[j]) + x * r->errors[j] + 4 * DBL_EPSILON * x * y;
    return value_multiply(r->values[i], r->values[j]);
}

/* What c_cd of the child adds to entry (a, b): R_ac R_bd ± R_ad R_bc. */
static void entry_add(struct action *action, size_t row, size_t column, struct value factor,
                      const struct restricted *r, const size_t ab[2], const size_t cd[2], int sign)
{
    size_t n = r->columns, index = row * action->count + column;
    double error = 0;
    struct value sum = entries_multiply(r, ab[0] * n + cd[0], ab[1] * n + cd[1], &error);
    if (cd[0] != cd[1]) {
        struct value other = entries_multiply(r, ab[0] * n + cd[1], ab[1] * n + cd[0], &error);
        sum = sign < 0 ? value_subtract(sum, other) : value_add(sum, other);
    }
    sum = value_add(action->values[index], value_multiply(factor, sum));
    action->values[index] = sum;
    action->errors[index] += factor.real * error + 4 * DBL_EPSILON * fabs(sum.real);
}

static void map_add(struct action *action, const struct similar *similar, size_t x, size_t y,
                    const struct restricted *r, struct value factor)
{
    bool strict = similar->sign < 0;
    size_t row = action->base[x];
    for (size_t a = 0; a < r->rows; a++)
        for (size_t b = a + strict; b < r->rows; b++, row++) {
            size_t column = action->base[y];
            for (size_t c = 0; c < r->columns; c++)
                for (size_t d = c + strict; d < r->columns; d++, column++)
                    entry_add(action, row, column, factor, r, (size_t[]){a, b}, (size_t[]){c, d},
                              similar->sign);
        }
}

static bcifs_status action_make(const struct similar *similar, struct arena *arena, struct action *action)
{
    const struct reach *reach = similar->reach;
    size_t count = similar_unknowns(similar), next = 0;
    *action =
        (struct action){count, arena_new(arena, reach->count, sizeof(size_t)),
                        zeros_new(arena, count * count), arena_new(arena, count * count, sizeof(double))};
    if (!action->base || !action->values || !action->errors)
        return BCIFS_MEMORY;
    for (size_t k = reach->first[similar->component]; k < reach->first[similar->component + 1]; k++) {
        action->base[reach->members[k]] = next;
        next += entry_count(similar->frames[reach->members[k]].dimension, similar->sign);
    }
    for (size_t k = reach->first[similar->component]; k < reach->first[similar->component + 1]; k++) {
        size_t x = reach->members[k];
        const struct state *state = state_at(similar, x);
        struct value factor = value_power((int64_t)state->cell->child_count, similar->power);
        for (size_t i = 0; i < state->cell->child_count; i++) {
            size_t y = reach->place[state->children[i]];
            struct restricted r;
            if (reach->component[y] != similar->component)
                continue;
            bcifs_status status = map_restrict(state->cell->children[i].map, &similar->frames[x],
                                               &similar->frames[y], arena, &r);
            if (status)
                return status;
            map_add(action, similar, x, y, &r, factor);
        }
    }
    for (size_t i = 0; i < count * count; i++)
        action->errors[i] = value_pin(&action->values[i], action->errors[i]);
    return BCIFS_OK;
}

/* ---- Its spectral radius ------------------------------------------------------------------------------- */

/* Whether 1 is an eigenvalue, decided in exact arithmetic; false when numbers are not exact. */
static bcifs_status one_is_eigenvalue(const struct action *action, struct arena *arena, bool *found)
{
    size_t count = action->count, free = 0;
    struct value *equations = arena_new(arena, count * count, sizeof *equations);
    struct value *solution = arena_new(arena, count, sizeof *solution);
    bool exact = true;
    if (!equations || !solution)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < count * count; i++) {
        bool diagonal = i % (count + 1) == 0;
        equations[i] =
            diagonal ? value_subtract(action->values[i], value_from_integer(1)) : action->values[i];
        exact = exact && equations[i].exact;
    }
    bcifs_status status =
        exact ? equations_solve(equations, count, count, false, arena, solution, &free) : BCIFS_OK;
    *found = free > 0;
    return status;
}

/* ρ(K) <= |K^m|^(1/m), m = 2, 4, 8, …: for orders for which no eigenvectors are computed. */
static bcifs_status radius_by_powers(double *power, size_t count, double error, struct arena *arena,
                                     double *upper)
{
    double *square = arena_new(arena, count * count, sizeof *square);
    if (!square)
        return BCIFS_MEMORY;
    double norm = row_norm(power, count, count), exponent = 1;
    for (int k = 0; k < MOST_SQUARINGS && *upper >= 1 && norm < LARGEST_POWER; k++) {
        error = multiply_enclosed(power, norm, error, power, norm, error, count, count, count, square);
        double *swap = power;
        power = square;
        square = swap;
        norm = row_norm(power, count, count);
        exponent /= 2;
        if (norm + error < 1 - TOLERANCE_EXACT)
            *upper =
                fmin(pow(norm + error, exponent) * (1 + TOLERANCE_EXACT), 1 - TOLERANCE_EXACT * exponent);
    }
    return BCIFS_OK;
}

bcifs_status similar_radius(const struct similar *similar, struct arena *arena, double *lower, double *upper)
{
    struct action action;
    struct joint_bounds bounds;
    bcifs_status status = action_make(similar, arena, &action);
    if (status)
        return status;
    size_t count = action.count;
    double *matrix = arena_new(arena, count * count, sizeof *matrix), *error = action.errors;
    bool finite = true;
    if (!matrix)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < count * count; i++) {
        matrix[i] = action.values[i].real;
        finite = finite && isfinite(matrix[i]) && isfinite(error[i]);
    }
    *lower = 0;
    *upper = INFINITY;
    if (!finite)
        return BCIFS_OK;
    /* A family of one matrix: what is said of it is its spectral radius, block by block. */
    const struct joint_edge edge = {0, 0, matrix, error};
    const struct joint_family family = {&count, 1, &edge, 1};
    status = joint_radius_find(&family, 1, arena, &bounds);
    if (status)
        return status;
    *lower = bounds.lower;
    *upper = bounds.upper;
    double off = row_norm(error, count, count);
    if (*lower < 1 && *upper >= 1)
        status = radius_by_powers(matrix, count, off, arena, upper);
    bool found = false;
    if (status == BCIFS_OK && *lower < 1 && *upper >= 1)
        status = one_is_eigenvalue(&action, arena, &found);
    if (found)
        *lower = 1;
    return status;
}

/* ---- The forms ----------------------------------------------------------------------------------------- */

/* G += factor·T M T^T, T rows × columns. */
static bcifs_status congruence_add(const struct value_matrix *map, const struct value *form,
                                   struct value factor, struct value *sum, struct arena *arena)
{
    size_t rows = map->rows, columns = map->columns;
    struct value *left = zeros_new(arena, rows * columns);
    if (!left)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < rows; i++)
        for (size_t k = 0; k < columns; k++) {
            if (value_is_zero(map->values[i * columns + k]))
                continue;
            struct value entry = value_multiply(factor, map->values[i * columns + k]);
            for (size_t j = 0; j < columns; j++)
                left[i * columns + j] =
                    value_add(left[i * columns + j], value_multiply(entry, form[k * columns + j]));
        }
    values_pin(left, rows * columns);
    for (size_t i = 0; i < rows; i++)
        for (size_t j = 0; j < rows; j++)
            for (size_t k = 0; k < columns; k++)
                if (!value_is_zero(map->values[j * columns + k]))
                    sum[i * rows + j] =
                        value_add(sum[i * rows + j],
                                  value_multiply(left[i * columns + k], map->values[j * columns + k]));
    return BCIFS_OK;
}

/* What the given parts and the children outside bring: N^k Σ T_i part_y T_i^T - part_x. */
static bcifs_status given_sum(const struct similar *similar, const struct similar_data *data, size_t x,
                              struct arena *arena, struct value **sum)
{
    const struct reach *reach = similar->reach;
    const struct state *state = state_at(similar, x);
    struct value factor = value_power((int64_t)state->cell->child_count, similar->power);
    *sum = zeros_new(arena, state->points * state->points);
    bcifs_status status = *sum ? BCIFS_OK : BCIFS_MEMORY;
    for (size_t i = 0; i < state->points * state->points && !status && data->parts; i++)
        (*sum)[i] = value_negate(data->parts[x][i]);
    for (size_t i = 0; i < state->cell->child_count && status == BCIFS_OK; i++) {
        size_t y = reach->place[state->children[i]];
        bool inside = reach->component[y] == similar->component;
        const struct value *form = !inside ? data->known[y] : data->parts ? data->parts[y] : NULL;
        if (form)
            status = congruence_add(state->cell->children[i].map, form, factor, *sum, arena);
    }
    return status;
}

/* Σ c_ab φ_a φ_b (twice where a < b) - 4 = 0. */
static bcifs_status norm_equation(const struct similar *similar, const struct action *action,
                                  const struct value *functional, size_t x, struct value *equation,
                                  struct arena *arena)
{
    const struct frame *frame = &similar->frames[x];
    struct value *phi;
    bcifs_status status = functional_restrict(frame, functional, arena, &phi);
    if (status)
        return status;
    size_t entry = action->base[x];
    for (size_t a = 0; a < frame->dimension; a++)
        for (size_t b = a; b < frame->dimension; b++)
            equation[entry++] =
                value_multiply(value_multiply(phi[a], phi[b]), value_from_integer(a == b ? 1 : 2));
    equation[action->count] = value_from_integer(-4);
    return BCIFS_OK;
}

/* c - K c = what is given, entry by entry. */
static bcifs_status equations_make(const struct similar *similar, const struct similar_data *data,
                                   const struct action *action, struct value *equations, struct arena *arena)
{
    const struct reach *reach = similar->reach;
    size_t unknowns = action->count + 1, row = 0;
    for (size_t k = reach->first[similar->component]; k < reach->first[similar->component + 1]; k++) {
        size_t x = reach->members[k];
        const struct frame *frame = &similar->frames[x];
        struct value *sum;
        bcifs_status status = given_sum(similar, data, x, arena, &sum);
        if (status)
            return status;
        struct value *given = zeros_new(arena, frame->dimension * frame->dimension);
        const struct value_matrix coordinates = {
            .rows = frame->dimension, .columns = frame->points, .values = (struct value *)frame->coordinates};
        if (!given)
            return BCIFS_MEMORY;
        status = congruence_add(&coordinates, sum, value_from_integer(1), given, arena);
        if (status)
            return status;
        values_pin(given, frame->dimension * frame->dimension);
        for (size_t a = 0; a < frame->dimension; a++)
            for (size_t b = a + (similar->sign < 0); b < frame->dimension; b++, row++) {
                struct value *equation = &equations[row * unknowns];
                for (size_t j = 0; j < action->count; j++)
                    equation[j] = value_negate(action->values[row * action->count + j]);
                equation[row] = value_add(equation[row], value_from_integer(1));
                equation[action->count] = value_negate(given[a * frame->dimension + b]);
            }
    }
    for (size_t k = reach->first[similar->component];
         k < reach->first[similar->component + 1] && data->functionals; k++, row++) {
        size_t x = reach->members[k];
        bcifs_status status =
            norm_equation(similar, action, data->functionals[x], x, &equations[row * unknowns], arena);
        if (status)
            return status;
    }
    return BCIFS_OK;
}

/* part + B c B^T; `entries` are those of c. */
static bcifs_status form_compose(const struct frame *frame, const struct value *part,
                                 const struct value *entries, int sign, struct arena *arena,
                                 const struct value **form)
{
    size_t points = frame->points, n = frame->dimension;
    struct value_matrix *c = value_matrix_new(arena, n, n);
    struct value *result = arena_new(arena, points * points, sizeof *result);
    if (!c || !result)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < points * points; i++)
        result[i] = part ? part[i] : value_from_integer(0);
    for (size_t i = 0; i < n * n; i++)
        c->values[i] = value_from_integer(0);
    for (size_t a = 0; a < n; a++)
        for (size_t b = a + (sign < 0); b < n; b++) {
            c->values[a * n + b] = *entries;
            c->values[b * n + a] = sign < 0 ? value_negate(*entries) : *entries;
            entries++;
        }
    const struct value_matrix basis = {.rows = points, .columns = n, .values = (struct value *)frame->basis};
    bcifs_status status = congruence_add(&basis, c->values, value_from_integer(1), result, arena);
    /* Both halves are rounded alike. */
    for (size_t i = 0; i < points; i++)
        for (size_t j = i; j < points; j++) {
            value_pin(&result[i * points + j], 0);
            result[j * points + i] = sign < 0 ? value_negate(result[i * points + j]) : result[i * points + j];
        }
    for (size_t i = 0; i < points && sign < 0; i++)
        result[i * points + i] = value_from_integer(0);
    *form = result;
    return status;
}

bcifs_status similar_solve(const struct similar *similar, const struct similar_data *data,
                           struct arena *arena, const struct value **forms, bool *solved)
{
    const struct reach *reach = similar->reach;
    struct arena own = {0};
    struct action action;
    size_t members = reach->first[similar->component + 1] - reach->first[similar->component], free = 0;
    bcifs_status status = action_make(similar, &own, &action);
    size_t rows = status ? 0 : action.count + (data->functionals ? members : 0);
    size_t unknowns = status ? 0 : action.count + 1;
    struct value *equations = status ? NULL : zeros_new(&own, rows * unknowns);
    struct value *solution = status ? NULL : arena_new(&own, unknowns, sizeof *solution);
    if (status == BCIFS_OK && (!equations || !solution))
        status = BCIFS_MEMORY;
    if (status == BCIFS_OK)
        status = equations_make(similar, data, &action, equations, &own);
    if (status == BCIFS_OK)
        status = equations_solve(equations, rows, unknowns, true, &own, solution, &free);
    *solved = free == 1;
    if (status == BCIFS_OK)
        values_pin(solution, action.count);
    for (size_t k = 0; k < members && status == BCIFS_OK && *solved; k++) {
        size_t x = reach->members[reach->first[similar->component] + k];
        status = form_compose(&similar->frames[x], data->parts ? data->parts[x] : NULL,
                              solution + action.base[x], similar->sign, arena, &forms[x]);
    }
    arena_free(&own);
    return status;
}
