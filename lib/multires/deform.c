#include "deform.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "multires/krylov.h"
#include "multires/pencil.h"
#include "numeric/skew.h"
#include "numeric/tolerance.h"

enum {
    COMPLETE = 48,      /* up to here the space is everything: reducing it costs less than to grow another */
    FIRST_COLUMNS = 24, /* of a Krylov space */
    MOST_COLUMNS = 160, /* beyond, factoring for each λ costs less */
    LEAST_COLUMNS = 12, /* two for each start, however many coefficients there are */
    MOST_NUMBERS = 1 << 24 /* of a basis */
};

/* All vectors are of the free coefficients, n of them. The unknown is δ, what is added to c0 there. With
 * h = (H c0)_F and b = (B c0)_F
 *
 *     objective = ½ δ*Kδ + Re δ*h + constant,    A(c0 + δ) = A(c0) + ½ Re δ*b + ¼ δ*Bδ,
 *
 * which has no differences of large numbers when the curve lies far from the origin. c0 = base + direction·d,
 * for the complex displacement d, so h and b are affine in d. */
struct deform {
    struct arena arena;
    size_t count;       /* n */
    const size_t *free; /* the problem's: F, base and direction */
    const double *points, *weights;
    /* A power of 2 near the largest coordinate. All below is in units of it: products of coordinates then
     * neither overflow nor vanish, and nothing is rounded. */
    double unit;
    double reach, along_reach;  /* the largest |x| + |y| of base, and the largest direction */
    const size_t *order;        /* of elimination */
    struct sparse energy, area; /* K_FF, M_FF */
    struct sparse_cholesky factor;
    double *diagonal; /* of K_FF */

    /* H and M times base (complex) and direction (real), on F. */
    double *energy_base, *energy_direction, *area_base, *area_direction;
    /* A(c0) = constant + dx·along[0] + dy·along[1]; what rounding leaves of b is a share of base and
     * direction. */
    double constant, along[2], terms_base, terms_direction;
    bool linear; /* M_FF = 0 */

    /* The reduced problem: the space's columns V, r × n, and V^T of the vectors above, turned by D*. */
    struct krylov space;
    struct pencil_reduced reduced;
    double *columns, *projections; /* most × n; 6 × most: energy and area of base (complex) and direction */
    double bound;                  /* of |λ| */
    double verified;               /* K - iλ/2 M is positive definite for |λ| up to here */
    bool augmented;                /* the space has a random vector, which sees all directions */
    struct pencil_sparse sparse;   /* the fallback, made when it is needed */

    /* Of one drag. */
    double *h, *b, *image, *delta;            /* n complex numbers each */
    double *h_reduced, *b_reduced, *x, *work; /* most complex numbers; work: 3 × most */
    double lambda;                            /* of the last drag, where the next one starts */
};

/* ---- Preparation: K, M and their images ---------------------------------------------------------------- */

/* Rows F of A times base (complex) and direction (real). `a` may be NULL: 0. */
static void rows_apply(const struct sparse *a, const struct deform_problem *problem, double *base,
                       double *direction)
{
    for (size_t i = 0; a && i < problem->free_count; i++) {
        size_t row = problem->free[i];
        for (size_t k = a->starts[row]; k < a->starts[row + 1]; k++) {
            double value = a->values[k];
            base[2 * i] += value * problem->base[2 * (size_t)a->columns[k]];
            base[2 * i + 1] += value * problem->base[2 * (size_t)a->columns[k] + 1];
            if (problem->direction)
                direction[i] += value * problem->direction[a->columns[k]];
        }
    }
}

static double row_sum(const struct sparse *a, size_t row)
{
    double sum = 0;
    for (size_t k = a->starts[row]; k < a->starts[row + 1]; k++)
        sum += fabs(a->values[k]);
    return sum;
}

/* The largest that b could be if nothing cancelled. Coefficients that are rounding themselves, as the details
 * of a subdivided curve, count like the others: what they alone give is no sensitivity. */
static void terms_bound(struct deform *deform, const struct deform_problem *problem)
{
    double sum = 0;
    for (size_t i = 0; i < problem->free_count; i++)
        sum = fmax(sum, row_sum(problem->area, problem->free[i]));
    for (size_t i = 0; i < problem->count; i++) {
        deform->reach = fmax(deform->reach, fabs(problem->base[2 * i]) + fabs(problem->base[2 * i + 1]));
        deform->along_reach = fmax(deform->along_reach, problem->direction ? fabs(problem->direction[i]) : 0);
    }
    deform->terms_base = sum * deform->reach;
    deform->terms_direction = sum * deform->along_reach;
}

/* A(base) = ½ x·M y: each pair of coefficients once, as M is antisymmetric. */
static double area_of(const struct deform_problem *problem)
{
    const struct sparse *m = problem->area;
    const double *base = problem->base;
    double sum = 0;
    for (size_t i = 0; i < problem->count; i++) {
        double x = 0, y = 0;
        for (size_t k = m->starts[i + 1]; k > m->starts[i] && m->columns[k - 1] > i; k--) {
            size_t j = m->columns[k - 1];
            x += m->values[k - 1] * base[2 * j];
            y += m->values[k - 1] * base[2 * j + 1];
        }
        sum += base[2 * i] * y - base[2 * i + 1] * x;
    }
    return sum / 2;
}

/* With x + dx w, y + dy w in place of x, y: A = ½ x·M y + ½ dx w·M y - ½ dy w·M x, as w·M w = 0. */
static void areas_prepare(struct deform *deform, const struct deform_problem *problem)
{
    const struct sparse *m = problem->area;
    double along[2] = {0};
    for (size_t i = 0; problem->direction && i < problem->count; i++) {
        double weight = problem->direction[i];
        for (size_t k = m->starts[i]; weight != 0 && k < m->starts[i + 1]; k++) {
            along[0] += weight * m->values[k] * problem->base[2 * (size_t)m->columns[k] + 1];
            along[1] -= weight * m->values[k] * problem->base[2 * (size_t)m->columns[k]];
        }
    }
    deform->constant = area_of(problem);
    deform->along[0] = along[0] / 2;
    deform->along[1] = along[1] / 2;
}

/* What K has more than H on the diagonal, to `diagonal`: 2α, but no less than the share `unseen` of what H
 * has there. h: H_FF, n × n, or NULL: 0. */
static void diagonal_make(const struct sparse *h, size_t n, double alpha, double unseen, double *diagonal)
{
    double largest = 0;
    for (size_t i = 0; h && i < n; i++) {
        diagonal[i] = sparse_entry(h, i, i);
        largest = fmax(largest, diagonal[i]);
    }
    if (alpha == 0 && largest == 0)
        alpha = 1;
    for (size_t i = 0; i < n; i++)
        diagonal[i] = fmax(2 * alpha, unseen * (diagonal[i] > 0 ? diagonal[i] : largest));
}

/* K_FF = H_FF + that. */
static bool energy_make(struct deform *deform, const struct deform_problem *problem, double unseen)
{
    size_t n = problem->free_count, count = 0;
    struct sparse h = {.rows = 0};
    if (problem->energy &&
        !sparse_select(problem->energy, problem->free, n, problem->free, n, &h, &deform->arena))
        return false;
    struct triple *triples = memory_new((h.rows ? h.starts[n] : 0) + n, sizeof *triples);
    if (!triples)
        return false;
    diagonal_make(h.rows ? &h : NULL, n, problem->alpha, unseen, deform->diagonal);
    for (size_t i = 0; i < n; i++)
        triples[count++] = (struct triple){i, i, deform->diagonal[i]};
    for (size_t i = 0; i < h.rows; i++)
        for (size_t k = h.starts[i]; k < h.starts[i + 1]; k++)
            triples[count++] = (struct triple){i, h.columns[k], h.values[k]};
    bool made = sparse_from_triples(&deform->energy, n, n, triples, count, &deform->arena);
    memory_free(triples);
    for (size_t i = 0; made && i < n; i++)
        deform->diagonal[i] = sparse_entry(&deform->energy, i, i);
    return made;
}

/* |M| <= max_i Σ_j |M_ij| d_j / d_i for any d > 0 (Collatz); the best d is an eigenvector of the absolute
 * values, which a few steps of the power method approach. d, image: n numbers. */
static double norm_bound(const struct sparse *m, double *d, double *image)
{
    enum { STEPS = 12 };
    double bound = INFINITY;
    for (size_t i = 0; i < m->rows; i++)
        d[i] = 1;
    for (int step = 0; step < STEPS; step++) {
        double worst = 0, largest = 0;
        for (size_t i = 0; i < m->rows; i++) {
            image[i] = 0;
            for (size_t k = m->starts[i]; k < m->starts[i + 1]; k++)
                image[i] += fabs(m->values[k]) * d[m->columns[k]];
            worst = fmax(worst, image[i] / d[i]);
            largest = fmax(largest, image[i]);
        }
        bound = fmin(bound, worst);
        /* The mean with d before keeps d positive and the steps from going to and fro. */
        for (size_t i = 0; i < m->rows; i++)
            d[i] += image[i] / largest;
    }
    return bound;
}

/* M_FF, 0 when it is only what products of filters left of zeros. As K >= 2α, the matrix is positive definite
 * for |λ| < 4α/|M|. */
static bool area_make(struct deform *deform, const struct deform_problem *problem)
{
    size_t n = problem->free_count;
    double inside = 0, all = 0;
    if (!sparse_select(problem->area, problem->free, n, problem->free, n, &deform->area, &deform->arena))
        return false;
    for (size_t i = 0; i < n; i++) {
        inside = fmax(inside, row_sum(&deform->area, i));
        all = fmax(all, row_sum(problem->area, problem->free[i]));
    }
    deform->linear = inside <= TOLERANCE_CANCELLED * all;
    if (deform->linear) {
        size_t *starts = arena_new(&deform->arena, n + 1, sizeof *starts);
        deform->area.starts = starts;
        deform->verified = INFINITY;
        return starts != NULL;
    }
    if (n > COMPLETE)
        deform->verified = 4 * problem->alpha / norm_bound(&deform->area, deform->image, deform->image + n);
    return true;
}

/* An order for the pattern of K. */
static bool order_make(struct deform *deform)
{
    size_t *order = arena_new(&deform->arena, deform->count, sizeof *order);
    deform->order = order;
    return order && sparse_order(&deform->energy, order);
}

/* An order for the patterns of K and M together: n indices. */
static bool order_both(const struct deform *deform, size_t *order)
{
    size_t n = deform->count, count = 0;
    size_t total = deform->energy.starts[n] + deform->area.starts[n];
    struct triple *triples = memory_new(total, sizeof *triples);
    struct arena scratch = {0};
    struct sparse both;
    bool made = triples != NULL;
    for (size_t i = 0; made && i < n; i++) {
        for (size_t k = deform->energy.starts[i]; k < deform->energy.starts[i + 1]; k++)
            triples[count++] = (struct triple){i, deform->energy.columns[k], 1};
        for (size_t k = deform->area.starts[i]; k < deform->area.starts[i + 1]; k++)
            triples[count++] = (struct triple){i, deform->area.columns[k], 1};
    }
    made = made && sparse_from_triples(&both, n, n, triples, count, &scratch) && sparse_order(&both, order);
    memory_free(triples);
    arena_free(&scratch);
    return made;
}

/* ---- Preparation: the space ---------------------------------------------------------------------------- */

static double dot(const double *a, const double *b, size_t size, size_t stride)
{
    double sum = 0;
    for (size_t i = 0; i < size; i++)
        sum += a[i] * b[i * stride];
    return sum;
}

/* V = L^-T U Q, a column after the other: `columns` of the handle. q: r × r. */
static void columns_make(struct deform *deform, const double *q)
{
    size_t n = deform->count, r = deform->space.count;
    for (size_t j = 0; j < r; j++) {
        double *column = deform->columns + j * n;
        memset(column, 0, n * sizeof *column);
        for (size_t k = 0; k < r; k++) {
            const double *u = deform->space.basis + k * n;
            double factor = q[k * r + j];
            for (size_t i = 0; factor != 0 && i < n; i++)
                column[i] += factor * u[i];
        }
        sparse_cholesky_upper(&deform->factor, column, 1, deform->image);
    }
}

/* V^T of the images of base and direction, column by column six numbers. */
static void project(struct deform *deform)
{
    size_t n = deform->count;
    for (size_t j = 0; j < deform->space.count; j++) {
        const double *column = deform->columns + j * n;
        double *six = deform->projections + 6 * j;
        six[0] = dot(column, deform->energy_base, n, 2);
        six[1] = dot(column, deform->energy_base + 1, n, 2);
        six[2] = dot(column, deform->energy_direction, n, 1);
        six[3] = dot(column, deform->area_base, n, 2);
        six[4] = dot(column, deform->area_base + 1, n, 2);
        six[5] = dot(column, deform->area_direction, n, 1);
    }
}

/* The reduced problem of the space as it is. */
static bool reduce(struct deform *deform)
{
    size_t r = deform->space.count;
    double *c = memory_new(r, r * sizeof *c), *q = memory_new(r, r * sizeof *q);
    double *workspace = memory_new(r, 2 * sizeof *workspace);
    bool made = c && q && workspace;
    if (made) {
        krylov_project(&deform->space, c);
        skew_reduce(c, r, q, deform->reduced.side, workspace);
        columns_make(deform, q);
        project(deform);
        deform->reduced.size = r;
        deform->bound = 2 * skew_bound(deform->reduced.side, r, workspace);
    }
    memory_free(c);
    memory_free(q);
    memory_free(workspace);
    return made;
}

/* L^-1 of one vector to the space: every `stride`-th number of n. */
static void space_add(struct deform *deform, const double *vector, size_t stride)
{
    double *v = deform->space.vector;
    for (size_t i = 0; i < deform->count; i++)
        v[i] = vector[i * stride];
    sparse_cholesky_lower(&deform->factor, v, 1, deform->image);
    krylov_add(&deform->space, v);
}

/* A vector that is special in no way sees every direction, also those that the data do not. */
static void space_augment(struct deform *deform)
{
    uint32_t random = 12345;
    for (size_t i = 0; i < deform->count; i++) {
        random = random * 1664525 + 1013904223; /* Numerical Recipes' generator */
        deform->space.vector[i] = (double)(random >> 8) / 8388608.0 - 1;
    }
    krylov_add(&deform->space, deform->space.vector);
    deform->augmented = true;
}

static bool space_make(struct deform *deform)
{
    size_t n = deform->count, most = n < MOST_COLUMNS ? n : MOST_COLUMNS;
    if (most > LEAST_COLUMNS && most > MOST_NUMBERS / n)
        most = MOST_NUMBERS / n > LEAST_COLUMNS ? MOST_NUMBERS / n : LEAST_COLUMNS;
    struct arena *arena = &deform->arena;
    deform->reduced = (struct pencil_reduced){0, arena_new(arena, most, sizeof(double)),
                                              arena_new(arena, most, sizeof(double)),
                                              arena_new(arena, most, sizeof(double))};
    deform->columns = arena_new(arena, most, n * sizeof *deform->columns);
    deform->projections = arena_new(arena, most, 6 * sizeof *deform->projections);
    deform->h_reduced = arena_new(arena, most, 2 * sizeof *deform->h_reduced);
    deform->b_reduced = arena_new(arena, most, 2 * sizeof *deform->b_reduced);
    deform->x = arena_new(arena, most, 2 * sizeof *deform->x);
    deform->work = arena_new(arena, most, 6 * sizeof *deform->work);
    if (!deform->reduced.side || !deform->reduced.below || !deform->reduced.inverse || !deform->columns ||
        !deform->projections || !deform->h_reduced || !deform->b_reduced || !deform->x || !deform->work ||
        !krylov_make(&deform->space, &deform->factor, &deform->area, most, arena))
        return false;
    if (n <= COMPLETE) {
        krylov_fill(&deform->space);
    } else {
        space_add(deform, deform->energy_base, 2);
        space_add(deform, deform->energy_base + 1, 2);
        space_add(deform, deform->area_base, 2);
        space_add(deform, deform->area_base + 1, 2);
        space_add(deform, deform->energy_direction, 1);
        space_add(deform, deform->area_direction, 1);
        krylov_grow(&deform->space, FIRST_COLUMNS);
    }
    return reduce(deform);
}

static bool is_complete(const struct deform *deform)
{
    return deform->reduced.size == deform->count;
}

/* ---- One drag ------------------------------------------------------------------------------------------ */

/* h = (H c0)_F and b = -i(M c0)_F for c0 = base + direction·d. */
static void drag_full(struct deform *deform, const double d[2])
{
    for (size_t i = 0; i < deform->count; i++) {
        double energy = deform->energy_direction[i], area = deform->area_direction[i];
        deform->h[2 * i] = deform->energy_base[2 * i] + energy * d[0];
        deform->h[2 * i + 1] = deform->energy_base[2 * i + 1] + energy * d[1];
        deform->b[2 * i] = deform->area_base[2 * i + 1] + area * d[1];
        deform->b[2 * i + 1] = -(deform->area_base[2 * i] + area * d[0]);
    }
}

/* The same in the space, turned. */
static void drag_reduced(struct deform *deform, const double d[2])
{
    size_t r = deform->reduced.size;
    double *h = deform->h_reduced, *b = deform->b_reduced;
    for (size_t k = 0; k < r; k++) {
        const double *six = deform->projections + 6 * k;
        h[2 * k] = six[0] + six[2] * d[0];
        h[2 * k + 1] = six[1] + six[2] * d[1];
        b[2 * k] = six[4] + six[5] * d[1];
        b[2 * k + 1] = -(six[3] + six[5] * d[0]);
    }
    skew_turn(h, r, true);
    skew_turn(b, r, true);
}

/* δ = V D x; two columns at a time, so that δ is passed over half as often. */
static void expand(struct deform *deform, double *delta)
{
    size_t n = deform->count, r = deform->reduced.size, k = 0;
    double *x = deform->work;
    memcpy(x, deform->x, 2 * r * sizeof *x);
    skew_turn(x, r, false);
    memset(delta, 0, 2 * n * sizeof *delta);
    for (; k + 2 <= r; k += 2) {
        const double *first = deform->columns + k * n, *second = first + n;
        double a = x[2 * k], b = x[2 * k + 1], c = x[2 * k + 2], d = x[2 * k + 3];
        for (size_t i = 0; i < n; i++) {
            delta[2 * i] += first[i] * a + second[i] * c;
            delta[2 * i + 1] += first[i] * b + second[i] * d;
        }
    }
    for (; k < r; k++)
        for (size_t i = 0; i < n; i++) {
            delta[2 * i] += deform->columns[k * n + i] * x[2 * k];
            delta[2 * i + 1] += deform->columns[k * n + i] * x[2 * k + 1];
        }
}

/* ½ Re δ*b + ¼ δ*Bδ; Bδ stays in `image`. */
static double area_change(struct deform *deform, const double *delta)
{
    double sum = 0;
    pencil_apply_skew(&deform->area, delta, deform->image);
    for (size_t i = 0; i < 2 * deform->count; i++)
        sum += delta[i] * (2 * deform->b[i] + deform->image[i]);
    return sum / 4;
}

/* Meets the goal, as the sparse matrices say: what the space's rounding leaves is aimed at once more. */
static enum constraint_outcome meet(struct deform *deform, struct constraint *constraint, double goal,
                                    double tolerance, double *delta, double *change)
{
    double aim = goal;
    enum constraint_outcome outcome = CONSTRAINT_BEYOND;
    for (int round = 0; round < 3; round++) {
        enum constraint_outcome now = constraint_meet(constraint, aim, tolerance);
        if (now == CONSTRAINT_MEMORY || (round > 0 && now == CONSTRAINT_BEYOND))
            return now == CONSTRAINT_MEMORY ? now : outcome;
        outcome = now;
        if (constraint->x != delta)
            expand(deform, delta);
        *change = area_change(deform, delta);
        if (outcome == CONSTRAINT_BEYOND || !(fabs(*change - goal) > 2 * tolerance))
            return outcome;
        aim += goal - *change;
    }
    return outcome;
}

/* |Kδ + λ/2 Bδ + h + λ/2 b| is rounding, each row in units of its diagonal entry. */
static bool equation_holds(struct deform *deform, const double *delta, double lambda, bool completed)
{
    double residual = 0, right = 0, energy = 0;
    for (size_t i = 0; i < deform->count; i++) {
        double x = 0, y = 0, scale = 1 / deform->diagonal[i];
        for (size_t k = deform->energy.starts[i]; k < deform->energy.starts[i + 1]; k++) {
            x += deform->energy.values[k] * delta[2 * (size_t)deform->energy.columns[k]];
            y += deform->energy.values[k] * delta[2 * (size_t)deform->energy.columns[k] + 1];
        }
        double first = deform->h[2 * i] + lambda / 2 * deform->b[2 * i];
        double second = deform->h[2 * i + 1] + lambda / 2 * deform->b[2 * i + 1];
        x += first + lambda / 2 * deform->image[2 * i];
        y += second + lambda / 2 * deform->image[2 * i + 1];
        residual += (x * x + y * y) * scale;
        right += (first * first + second * second) * scale;
        energy += (delta[2 * i] * delta[2 * i] + delta[2 * i + 1] * delta[2 * i + 1]) * deform->diagonal[i];
    }
    /* Rounding in Kδ is a share of its terms; a null vector is found to the same share. */
    double share = completed ? TOLERANCE_RESIDUAL : TOLERANCE_RESIDUAL / 100;
    return sqrt(residual) <= TOLERANCE_RESIDUAL * sqrt(right) + share * sqrt(energy);
}

static bool sparse_ready(struct deform *deform)
{
    if (deform->sparse.skew)
        return true;
    size_t *order = memory_new(deform->count, sizeof *order);
    bool made = order && order_both(deform, order) &&
                pencil_sparse_make(&deform->sparse, &deform->energy, &deform->area, order, &deform->arena);
    memory_free(order);
    return made;
}

/* Whether K - iλ/2 M is positive definite; a bit further out is tried first, so that the next drag need not
 * ask. */
static enum sparse_outcome verify(struct deform *deform, double lambda)
{
    double further = fmin(1.5 * fabs(lambda), (fabs(lambda) + deform->bound) / 2);
    if (fabs(lambda) <= deform->verified)
        return SPARSE_DONE;
    if (!sparse_ready(deform))
        return SPARSE_MEMORY;
    struct pencil pencil = pencil_of_sparse(&deform->sparse);
    enum sparse_outcome outcome = pencil.factor(pencil.context, further / 2);
    if (outcome == SPARSE_INDEFINITE)
        outcome = pencil.factor(pencil.context, (further = fabs(lambda)) / 2);
    if (outcome == SPARSE_DONE)
        deform->verified = further;
    return outcome;
}

/* Makes the space larger; false when it cannot be. */
static bool space_enlarge(struct deform *deform, bool blind)
{
    size_t before = deform->space.count;
    if (before == deform->space.most)
        return false;
    if (!deform->augmented && (blind || deform->space.expanded == before))
        space_augment(deform);
    krylov_grow(&deform->space, before + (before < 16 ? 16 : before / 2));
    return deform->space.count > before;
}

/* What is asked of one drag, and what came of it. */
struct drag {
    double goal, tolerance, change; /* of the area by δ: wanted, how closely, got */
    double lambda;
    unsigned iterations;
    enum constraint_outcome outcome;
};

/* λ by λ with the sparse matrices, where no space of bounded size holds the solution. */
static bool drag_sparse(struct deform *deform, double *delta, struct drag *drag)
{
    double *workspace = memory_new(deform->count, 6 * sizeof *workspace);
    bool made = workspace && sparse_ready(deform);
    if (made) {
        struct constraint constraint = {.pencil = pencil_of_sparse(&deform->sparse),
                                        .h = deform->h,
                                        .b = deform->b,
                                        .bound = deform->bound,
                                        .x = delta,
                                        .workspace = workspace,
                                        .lambda = drag->lambda,
                                        .iterations = drag->iterations};
        drag->outcome = meet(deform, &constraint, drag->goal, drag->tolerance, delta, &drag->change);
        drag->lambda = constraint.lambda;
        drag->iterations = constraint.iterations;
    }
    memory_free(workspace);
    return made && drag->outcome != CONSTRAINT_MEMORY;
}

/* In the space, which grows until the equation holds and the matrix is known to be positive definite. */
static bool drag_solve(struct deform *deform, const double displacement[2], double *delta, struct drag *drag)
{
    for (;;) {
        drag_reduced(deform, displacement);
        struct constraint constraint = {.pencil = pencil_of_reduced(&deform->reduced),
                                        .h = deform->h_reduced,
                                        .b = deform->b_reduced,
                                        .bound = deform->bound,
                                        .x = deform->x,
                                        .workspace = deform->work,
                                        .lambda = drag->lambda,
                                        .iterations = drag->iterations};
        drag->outcome = meet(deform, &constraint, drag->goal, drag->tolerance, delta, &drag->change);
        drag->lambda = constraint.lambda;
        drag->iterations = constraint.iterations;
        if (is_complete(deform) || drag->outcome == CONSTRAINT_MEMORY)
            return drag->outcome != CONSTRAINT_MEMORY;
        bool completed = drag->outcome == CONSTRAINT_COMPLETED, blind = drag->outcome == CONSTRAINT_BEYOND;
        if (!blind && equation_holds(deform, delta, drag->lambda, completed)) {
            /* At the singular end itself rounding decides: just inside it the matrix must be definite. */
            enum sparse_outcome outcome =
                verify(deform, drag->lambda * (completed ? 1 - TOLERANCE_RADIUS : 1));
            if (outcome != SPARSE_INDEFINITE)
                return outcome == SPARSE_DONE;
            blind = true;
        }
        if (!space_enlarge(deform, blind))
            return drag_sparse(deform, delta, drag);
        if (!reduce(deform))
            return false;
    }
}

/* b is rounding: the area does not depend on the free coefficients. */
static bool is_insensitive(const struct deform *deform, const double d[2])
{
    double largest = 0, terms = deform->terms_base + deform->terms_direction * (fabs(d[0]) + fabs(d[1]));
    for (size_t i = 0; deform->linear && i < 2 * deform->count; i++)
        largest = fmax(largest, fabs(deform->b[i]));
    return deform->linear && largest <= TOLERANCE_CANCELLED * terms;
}

/* δ = -K^-1 h: the minimizer without a constraint. */
static void relax(struct deform *deform, double *delta)
{
    for (size_t i = 0; i < 2 * deform->count; i++)
        delta[i] = -deform->h[i];
    sparse_cholesky_solve(&deform->factor, delta, 2, deform->image);
}

static void result_of(const struct deform *deform, const double d[2], const double *delta, double *result)
{
    for (size_t i = 0; i < deform->count; i++) {
        double weight = deform->weights ? deform->weights[deform->free[i]] : 0;
        result[2 * i] = deform->points[2 * deform->free[i]] + weight * d[0] + deform->unit * delta[2 * i];
        result[2 * i + 1] =
            deform->points[2 * deform->free[i] + 1] + weight * d[1] + deform->unit * delta[2 * i + 1];
    }
}

/* The area is what it should be, as far as it is known of coordinates that large. */
static bool is_near(const struct deform *deform, const double d[2], double start, double target)
{
    double reach = deform->reach + deform->along_reach * (fabs(d[0]) + fabs(d[1]));
    return fabs(target - start) <=
           fmax(TOLERANCE_EQUATION * fmax(fabs(target), fabs(start)), TOLERANCE_CANCELLED * reach * reach);
}

/* In units: δ, and what is known of it. False when memory is out. */
static bool answer_find(struct deform *deform, const double d[2], double target,
                        struct deform_outcome *outcome)
{
    double start = deform->constant + d[0] * deform->along[0] + d[1] * deform->along[1];
    double size = fmax(fabs(target), fabs(start));
    struct drag drag = {.goal = target - start,
                        .tolerance = fmax(TOLERANCE_CONSTRAINT * fabs(target), DBL_EPSILON * size),
                        .lambda = deform->lambda};
    bool near = is_near(deform, d, start, target);
    *outcome = (struct deform_outcome){.reason = DEFORM_REACHED, .area = start, .global = true};
    drag_full(deform, d);
    if (deform->count == 0) {
        outcome->reason = near ? DEFORM_REACHED : DEFORM_NONE_FREE;
    } else if (is_insensitive(deform, d)) {
        outcome->reason = near ? DEFORM_REACHED : DEFORM_INSENSITIVE;
        relax(deform, deform->delta);
    } else {
        if (!drag_solve(deform, d, deform->delta, &drag))
            return false;
        /* Areas that need coordinates beyond all range are missed without a word. */
        bool reached = drag.outcome != CONSTRAINT_BEYOND &&
                       fabs(drag.change - drag.goal) <= TOLERANCE_MISSED * fmax(size, fabs(drag.goal));
        deform->lambda = reached ? drag.lambda : 0;
        *outcome = (struct deform_outcome){.reason = reached ? DEFORM_REACHED : DEFORM_BEYOND,
                                           .area = start + drag.change,
                                           .multiplier = drag.lambda,
                                           .iterations = drag.iterations,
                                           .global = reached};
    }
    return true;
}

bcifs_status deform_solve(struct deform *deform, const double displacement[2], double target, double *result,
                          struct deform_outcome *outcome)
{
    double unit = deform->unit, d[2] = {displacement[0] / unit, displacement[1] / unit};
    if (!answer_find(deform, d, target / unit / unit, outcome))
        return BCIFS_MEMORY;
    outcome->area = outcome->area * unit * unit;
    result_of(deform, displacement, deform->delta, result);
    return BCIFS_OK;
}

/* ---- The handle ---------------------------------------------------------------------------------------- */

static bool vectors_make(struct deform *deform, const struct deform_problem *problem)
{
    struct arena *arena = &deform->arena;
    size_t n = deform->count;
    deform->diagonal = arena_new(arena, n, sizeof(double));
    deform->energy_base = arena_new(arena, n, 2 * sizeof(double));
    deform->energy_direction = arena_new(arena, n, sizeof(double));
    deform->area_base = arena_new(arena, n, 2 * sizeof(double));
    deform->area_direction = arena_new(arena, n, sizeof(double));
    deform->h = arena_new(arena, n, 2 * sizeof(double));
    deform->b = arena_new(arena, n, 2 * sizeof(double));
    deform->image = arena_new(arena, n, 2 * sizeof(double));
    deform->delta = arena_new(arena, n, 2 * sizeof(double));
    if (!deform->diagonal || !deform->energy_base || !deform->energy_direction || !deform->area_base ||
        !deform->area_direction || !deform->h || !deform->b || !deform->image || !deform->delta)
        return false;
    rows_apply(problem->energy, problem, deform->energy_base, deform->energy_direction);
    rows_apply(problem->area, problem, deform->area_base, deform->area_direction);
    terms_bound(deform, problem);
    areas_prepare(deform, problem);
    return true;
}

/* A drag as users make them, by a quarter of the curve's size, for the space to be large enough from the
 * start. */
static bcifs_status rehearse(struct deform *deform, const struct deform_problem *problem)
{
    double least = INFINITY, most = -INFINITY;
    struct deform_outcome outcome;
    for (size_t i = 0; i < 2 * problem->count; i++) {
        least = fmin(least, problem->base[i]);
        most = fmax(most, problem->base[i]);
    }
    double step = problem->direction ? (most - least) / 4 : 0;
    bool made = answer_find(deform, (double[2]){step, step / 2}, deform->constant, &outcome);
    deform->lambda = 0;
    return made ? BCIFS_OK : BCIFS_MEMORY;
}

/* K and its factor. The rounding of many levels can leave H with eigenvalues below 0 that outweigh the least
 * share: a larger one is taken then. */
static enum sparse_outcome energy_factor(struct deform *deform, const struct deform_problem *problem)
{
    enum sparse_outcome outcome = SPARSE_INDEFINITE;
    for (double unseen = TOLERANCE_UNSEEN; outcome == SPARSE_INDEFINITE && unseen <= TOLERANCE_UNSEEN_MOST;
         unseen *= 10) {
        if (!energy_make(deform, problem, unseen) ||
            (deform->count > COMPLETE && !deform->order && !order_make(deform)))
            return SPARSE_MEMORY;
        outcome = sparse_cholesky_factor(&deform->energy, deform->order, &deform->arena, &deform->factor);
    }
    return outcome;
}

static bcifs_status prepare(struct deform *deform, const struct deform_problem *problem)
{
    if (!vectors_make(deform, problem))
        return BCIFS_MEMORY;
    if (deform->count == 0)
        return BCIFS_OK;
    if (!area_make(deform, problem))
        return BCIFS_MEMORY;
    enum sparse_outcome outcome = energy_factor(deform, problem);
    if (outcome != SPARSE_DONE)
        return outcome == SPARSE_MEMORY ? BCIFS_MEMORY : BCIFS_INPUT;
    if (!space_make(deform))
        return BCIFS_MEMORY;
    return is_complete(deform) ? BCIFS_OK : rehearse(deform, problem);
}

/* The problem in units of a power of 2. */
static bool unit_choose(struct deform *deform, struct deform_problem *problem)
{
    enum { MOST = 1000 };
    double largest = 0;
    int exponent = 0;
    for (size_t i = 0; i < 2 * problem->count; i++)
        largest = fmax(largest, fabs(problem->base[i]));
    if (largest > 0)
        frexp(largest, &exponent);
    deform->unit = ldexp(1, exponent > MOST ? MOST : exponent < -MOST ? -MOST : exponent);
    double *base = arena_new(&deform->arena, problem->count, 2 * sizeof *base);
    for (size_t i = 0; base && i < 2 * problem->count; i++)
        base[i] = problem->base[i] / deform->unit;
    problem->base = base;
    return base != NULL;
}

bcifs_status deform_create(const struct deform_problem *problem, struct deform **deform)
{
    struct deform_problem scaled = *problem;
    struct deform *made = memory_new(1, sizeof *made);
    if (!made)
        return BCIFS_MEMORY;
    made->count = problem->free_count;
    made->free = problem->free;
    made->points = problem->base;
    made->weights = problem->direction;
    bcifs_status status = unit_choose(made, &scaled) ? prepare(made, &scaled) : BCIFS_MEMORY;
    if (status == BCIFS_OK)
        *deform = made;
    else
        deform_free(made);
    return status;
}

void deform_free(struct deform *deform)
{
    if (!deform)
        return;
    pencil_sparse_free(&deform->sparse);
    arena_free(&deform->arena);
    memory_free(deform);
}
