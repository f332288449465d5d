/* The constrained deformation against an independent solution (dense, by bisection on λ with Gaussian
 * elimination of the real system of twice the size, from the formulas of the header), the first-order
 * conditions in the original coordinates, and neighbors that meet the constraint too. */
#include <math.h>
#include <string.h>

#include "tap.h"

/* Requests until one fails (0: never), and blocks that are alive. */
static long fail_after;
static long alive;

static bool fails(void)
{
    return fail_after > 0 && --fail_after == 0;
}

static void *counted_calloc(size_t count, size_t size)
{
    void *block = fails() ? NULL : calloc(count, size);
    alive += block != NULL;
    return block;
}

static void *counted_realloc(void *old, size_t size)
{
    void *block = fails() ? NULL : realloc(old, size);
    alive += block != NULL && old == NULL;
    return block;
}

static void counted_free(void *block)
{
    alive -= block != NULL;
    free(block);
}

/* The library's one place of allocation, compiled here on top of these. */
#define calloc counted_calloc
#define realloc counted_realloc
#define free counted_free
#include "base/memory.c"
#undef calloc
#undef realloc
#undef free

#include "multires/deform.h"

enum { MOST = 240 };

static uint64_t seed = 3;

static size_t below(size_t limit)
{
    return (size_t)(random_bits(&seed) % limit);
}

static double number(void)
{
    return (double)(random_bits(&seed) >> 11) / 4503599627370496.0 - 1;
}

/* ---- Problems ------------------------------------------------------------------------------------------ */

struct sample {
    size_t count;
    double h[MOST * MOST], m[MOST * MOST]; /* count × count, dense */
    double base[2 * MOST], direction[MOST];
    size_t list[MOST];
    struct sparse energy, area;
    struct deform_problem problem;
    struct arena arena;
};

static struct sample sample;

static struct sparse sparse_from(const double *dense, size_t count, struct arena *arena)
{
    struct triple *triples = arena_new(arena, count * count, sizeof *triples);
    struct sparse a = {0};
    for (size_t i = 0; i < count * count; i++)
        triples[i] = (struct triple){i / count, i % count, dense[i]};
    sparse_from_triples(&a, count, count, triples, count * count, arena);
    return a;
}

/* Squares of second differences with random weights; without the corners when open. */
static void energy_fill(size_t n, bool closed)
{
    for (size_t i = 0; i < n; i++) {
        static const double difference[] = {1, -2, 1};
        double weight = exp(number());
        for (size_t k = 0; k < 9 && (closed || i + 2 < n); k++)
            sample.h[(i + k / 3) % n * n + (i + k % 3) % n] += weight * difference[k / 3] * difference[k % 3];
    }
}

/* The polygon's area, or Chaikin's (design, 6.1: 5/12 and 1/12), or any antisymmetric matrix. */
static void area_fill(size_t n, bool closed, size_t kind)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 1; k <= (kind == 0 ? 1 : 2) && k < n; k++) {
            size_t j = (i + k) % n;
            double value = kind == 0 ? 1 : k == 1 ? 10.0 / 12 : 1.0 / 12;
            if (!closed && i + k >= n)
                continue;
            sample.m[i * n + j] += value;
            sample.m[j * n + i] -= value;
        }
    for (size_t i = 0; kind == 2 && i < n; i++)
        for (size_t j = 0; j < i; j++) {
            double value = number() / 3;
            sample.m[i * n + j] += value;
            sample.m[j * n + i] -= value;
        }
}

/* Coefficients in units of their own, as wavelets have them. */
static void units_fill(size_t n)
{
    for (size_t i = 0; i < n; i++) {
        double unit = exp(2 * number());
        for (size_t j = 0; j < n; j++) {
            sample.h[i * n + j] *= unit;
            sample.h[j * n + i] *= unit;
            sample.m[i * n + j] *= unit;
            sample.m[j * n + i] *= unit;
        }
    }
}

/* A wavy circle, a direction with a few entries, and `free_count` free coefficients. */
static void sample_make(size_t n, size_t kind, size_t free_count, double alpha)
{
    bool closed = below(3) > 0;
    double turn = 2 * acos(-1) / (double)n, wave = number() / 2, noise = below(2) ? 0.2 : 0;
    size_t first = below(n), moved = 1 + below(3);
    memset(&sample, 0, sizeof sample);
    sample.count = n;
    energy_fill(n, closed);
    area_fill(n, closed, kind);
    if (below(3) == 0)
        units_fill(n);
    for (size_t i = 0; i < n; i++) {
        double angle = turn * (double)i, radius = 1 + wave * cos(3 * angle) + noise * number();
        sample.base[2 * i] = 0.3 + radius * cos(angle);
        sample.base[2 * i + 1] = -0.2 + radius * sin(angle);
    }
    for (size_t k = 0; k < moved && k < n; k++)
        sample.direction[(first + k) % n] = 1 - 0.3 * (double)k;
    size_t count = 0;
    for (size_t i = 0; i < n; i++)
        if (below(n - i) < free_count - count)
            sample.list[count++] = i;
    sample.energy = sparse_from(sample.h, n, &sample.arena);
    sample.area = sparse_from(sample.m, n, &sample.arena);
    sample.problem = (struct deform_problem){n,           &sample.energy, &sample.area, alpha,
                                             sample.list, count,          sample.base,  sample.direction};
}

static void sample_free(void)
{
    arena_free(&sample.arena);
}

/* c0 = base + direction·d: n × 2. */
static void start_of(const double d[2], double *c0)
{
    for (size_t i = 0; i < sample.count; i++) {
        double weight = sample.problem.direction ? sample.direction[i] : 0;
        c0[2 * i] = sample.base[2 * i] + weight * d[0];
        c0[2 * i + 1] = sample.base[2 * i + 1] + weight * d[1];
    }
}

static void insert(const double *result, double *z)
{
    for (size_t i = 0; i < sample.problem.free_count; i++)
        memcpy(z + 2 * sample.list[i], result + 2 * i, 2 * sizeof *z);
}

/* ½ X M Y^T; `terms`: the sum of absolute values. */
static double area_of(const double *z, double *terms)
{
    double sum = 0, absolute = 0;
    for (size_t i = 0; i < sample.count; i++)
        for (size_t j = 0; j < sample.count; j++) {
            double term = z[2 * i] * sample.m[i * sample.count + j] * z[2 * j + 1] / 2;
            sum += term;
            absolute += fabs(term);
        }
    if (terms)
        *terms = absolute;
    return sum;
}

static double objective_of(const double *z, const double *c0)
{
    size_t n = sample.count;
    double sum = 0;
    for (size_t i = 0; i < n && sample.problem.energy; i++)
        for (size_t j = 0; j < n; j++)
            sum += sample.h[i * n + j] * (z[2 * i] * z[2 * j] + z[2 * i + 1] * z[2 * j + 1]) / 2;
    for (size_t i = 0; i < 2 * n; i++)
        sum += sample.problem.alpha * (z[i] - c0[i]) * (z[i] - c0[i]);
    return sum;
}

/* ---- The independent solution -------------------------------------------------------------------------- */

/* The real system of the stationary point for λ, 2f × 2f and its right side: (K + λ/2 B)_FF z_F = 2α c0_F -
 * (H + λ/2 B)_FX z_X, x of the free ones first, then y. */
static void system_fill(double lambda, const double *c0, double *a, double *right)
{
    size_t n = sample.count, f = sample.problem.free_count, size = 2 * f;
    bool is_free[MOST] = {false};
    for (size_t p = 0; p < f; p++)
        is_free[sample.list[p]] = true;
    for (size_t p = 0; p < f; p++) {
        size_t i = sample.list[p];
        right[p] = 2 * sample.problem.alpha * c0[2 * i];
        right[f + p] = 2 * sample.problem.alpha * c0[2 * i + 1];
        for (size_t j = 0; j < n; j++) {
            double h = sample.problem.energy ? sample.h[i * n + j] : 0, m = lambda / 2 * sample.m[i * n + j];
            if (is_free[j])
                continue;
            right[p] -= h * c0[2 * j] + m * c0[2 * j + 1];
            right[f + p] -= h * c0[2 * j + 1] - m * c0[2 * j];
        }
        for (size_t q = 0; q < f; q++) {
            size_t j = sample.list[q];
            double k =
                (sample.problem.energy ? sample.h[i * n + j] : 0) + (p == q ? 2 * sample.problem.alpha : 0);
            a[p * size + q] = a[(f + p) * size + f + q] = k;
            a[p * size + f + q] = lambda / 2 * sample.m[i * n + j];
            a[(f + p) * size + q] = -lambda / 2 * sample.m[i * n + j];
        }
    }
}

/* Elimination without exchanges, which tells whether the symmetric matrix is positive definite. */
static bool dense_solve(double *a, double *right, size_t size)
{
    for (size_t k = 0; k < size; k++) {
        if (!(a[k * size + k] > 0))
            return false;
        for (size_t i = k + 1; i < size; i++) {
            double factor = a[i * size + k] / a[k * size + k];
            for (size_t j = k; j < size && factor != 0; j++)
                a[i * size + j] -= factor * a[k * size + j];
            right[i] -= factor * right[k];
        }
    }
    for (size_t k = size; k-- > 0;) {
        for (size_t j = k + 1; j < size; j++)
            right[k] -= a[k * size + j] * right[j];
        right[k] /= a[k * size + k];
    }
    return true;
}

/* z(λ); false when the matrix is not positive definite. */
static bool point_at(double lambda, const double *c0, double *z)
{
    static double a[4 * MOST * MOST], right[2 * MOST];
    size_t f = sample.problem.free_count;
    system_fill(lambda, c0, a, right);
    if (!dense_solve(a, right, 2 * f))
        return false;
    memcpy(z, c0, 2 * sample.count * sizeof *z);
    for (size_t p = 0; p < f; p++) {
        z[2 * sample.list[p]] = right[p];
        z[2 * sample.list[p] + 1] = right[f + p];
    }
    return true;
}

/* Bisection: what is outside the interval lies beyond the solution on its side. */
static double bisect(const double *c0, double target, double *z)
{
    double low = -1e-3, high = 1e-3;
    while (point_at(low, c0, z) && area_of(z, NULL) < target)
        low *= 2;
    while (point_at(high, c0, z) && area_of(z, NULL) > target)
        high *= 2;
    for (int round = 0; round < 200; round++) {
        double middle = low + (high - low) / 2;
        if (middle <= low || middle >= high)
            break;
        bool inside = point_at(middle, c0, z);
        if (inside ? area_of(z, NULL) > target : middle < 0)
            low = middle;
        else
            high = middle;
    }
    point_at(low + (high - low) / 2, c0, z);
    return low + (high - low) / 2;
}

/* ---- Checks -------------------------------------------------------------------------------------------- */

/* The largest row of the stationary equation against the sum of its terms. */
static double stationary_error(const double *z, const double *c0, double lambda)
{
    static double a[4 * MOST * MOST], right[2 * MOST];
    size_t f = sample.problem.free_count;
    double worst = 0, largest = 0;
    system_fill(lambda, c0, a, right);
    for (size_t row = 0; row < 2 * f; row++) {
        double sum = -right[row], terms = fabs(right[row]);
        for (size_t p = 0; p < f; p++)
            for (size_t part = 0; part < 2; part++) {
                double term = a[row * 2 * f + part * f + p] * z[2 * sample.list[p] + part];
                sum += term;
                terms += fabs(term);
            }
        worst = fmax(worst, fabs(sum) / sqrt(a[row * 2 * f + row]));
        largest = fmax(largest, terms / sqrt(a[row * 2 * f + row]));
    }
    return worst > 0 ? worst / largest : 0;
}

/* Relative to the target, but for what rounding leaves uncertain in this area and that of the start: up to 2
 * units in the last place are accepted there, and each sum is good to several more. */
static double area_error(const double *z, const double *c0, double target)
{
    double terms, terms_start, difference = fabs(area_of(z, &terms) - target);
    area_of(c0, &terms_start);
    return difference < 4e-15 * (terms + terms_start) ? 0 : difference / fabs(target);
}

static double distance(const double *a, const double *b, size_t count)
{
    double worst = 0;
    for (size_t i = 0; i < count; i++)
        worst = fmax(worst, fabs(a[i] - b[i]));
    return worst;
}

static bool solve(const double d[2], double target, double *z, struct deform_outcome *outcome)
{
    double result[2 * MOST];
    struct deform *deform;
    start_of(d, z);
    if (deform_create(&sample.problem, &deform) != BCIFS_OK)
        return false;
    bool solved = deform_solve(deform, d, target, result, outcome) == BCIFS_OK;
    deform_free(deform);
    insert(result, z);
    return solved;
}

/* Up to 48 free coefficients the space is complete; beyond, the equation holds to TOLERANCE_RESIDUAL. */
static void test_reference(void)
{
    int failures = 0;
    double worst = 0;
    for (long round = 0; round < test_effort(150); round++) {
        double z[2 * MOST], reference[2 * MOST], c0[2 * MOST], d[2] = {number(), number()};
        struct deform_outcome outcome;
        size_t n = round % 20 == 19 ? 50 + below(30) : 3 + below(20);
        size_t free_count = below(3) == 0 ? n : n > 49 && below(2) ? 49 : 1 + below(n);
        sample_make(n, below(3), free_count, exp(5 * number()));
        start_of(d, c0);
        double target = area_of(c0, NULL) * (1 + number()) + (below(4) == 0 ? number() : 0);
        bool solved = solve(d, target, z, &outcome);
        double lambda = bisect(c0, target, reference), area = area_error(z, c0, target);
        double error = distance(z, reference, 2 * n);
        worst = fmax(worst, error);
        if (!(solved && outcome.reason == DEFORM_REACHED && outcome.global && area < 1e-13 && error < 1e-9 &&
              fabs(outcome.area - area_of(z, NULL)) < 1e-13 * (fabs(target) + 1) &&
              stationary_error(z, c0, outcome.multiplier) < (free_count > 48 ? 1e-11 : 1e-12)) &&
            ++failures < 5)
            note("round %ld: %zu free of %zu, alpha %g, target %g of %g: reason %d, area %g, error %g, "
                 "lambda %g for %g, "
                 "stationary %g, %u steps",
                 round, free_count, n, sample.problem.alpha, target, area_of(c0, NULL), outcome.reason, area,
                 error, outcome.multiplier, lambda, stationary_error(z, c0, outcome.multiplier),
                 outcome.iterations);
        sample_free();
    }
    ok(failures == 0, "minimizers are those of dense bisection (%.1e)", worst);
}

static void test_large(void)
{
    int failures = 0;
    unsigned most = 0;
    for (long round = 0; round < test_effort(40); round++) {
        double z[2 * MOST], c0[2 * MOST], d[2] = {number(), number()};
        struct deform_outcome outcome = {0};
        size_t n = 50 + below(MOST - 49), free_count = below(2) ? n : 30 + below(n - 30);
        sample_make(n, below(3), free_count, pow(10, 3 * number()));
        start_of(d, c0);
        double target = area_of(c0, NULL) * (1 + 0.5 * number());
        bool solved = solve(d, target, z, &outcome);
        double area = area_error(z, c0, target), equation = stationary_error(z, c0, outcome.multiplier);
        most = outcome.iterations > most ? outcome.iterations : most;
        if (!(solved && outcome.reason == DEFORM_REACHED && outcome.global && area < 1e-13 &&
              equation < 1e-11) &&
            ++failures < 5)
            note("round %ld: %zu free of %zu, alpha %g, target %g of %g: reason %d, area %g, stationary %g, "
                 "%u steps",
                 round, free_count, n, sample.problem.alpha, target, area_of(c0, NULL), outcome.reason, area,
                 equation, outcome.iterations);
        sample_free();
    }
    ok(failures == 0, "large problems: area and first-order conditions hold (at most %u steps)", most);
}

/* z + p, moved along the gradient of the area until that is met: false when it cannot be. */
static bool neighbor_of(const double *z, double size, double target, double *neighbor)
{
    size_t n = sample.count;
    double gradient[2 * MOST] = {0}, probe[2 * MOST], areas[3], square = 0;
    memcpy(neighbor, z, 2 * n * sizeof *z);
    for (size_t p = 0; p < sample.problem.free_count; p++) {
        size_t i = sample.list[p];
        neighbor[2 * i] += size * number();
        neighbor[2 * i + 1] += size * number();
        for (size_t j = 0; j < n; j++) {
            gradient[2 * i] += sample.m[i * n + j] * z[2 * j + 1];
            gradient[2 * i + 1] -= sample.m[i * n + j] * z[2 * j];
        }
        square += gradient[2 * i] * gradient[2 * i] + gradient[2 * i + 1] * gradient[2 * i + 1];
    }
    /* The area along the line is a parabola: through three points. */
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; i < 2 * n; i++)
            probe[i] = neighbor[i] + (k - 1) / square * gradient[i];
        areas[k] = area_of(probe, NULL);
    }
    double c = areas[1] - target, b = (areas[2] - areas[0]) / 2, a = (areas[2] + areas[0]) / 2 - areas[1];
    double discriminant = b * b - 4 * a * c;
    if (!(discriminant >= 0))
        return false;
    double t = -2 * c / (b + copysign(sqrt(discriminant), b)) / square;
    for (size_t i = 0; i < 2 * n; i++)
        neighbor[i] += t * gradient[i];
    return true;
}

static void test_neighbors(void)
{
    int failures = 0;
    long tried = 0;
    for (long round = 0; round < test_effort(100); round++) {
        double z[2 * MOST], c0[2 * MOST], neighbor[2 * MOST], d[2] = {number(), number()};
        struct deform_outcome outcome;
        size_t n = 3 + below(20);
        sample_make(n, below(3), 1 + below(n), exp(5 * number()));
        start_of(d, c0);
        double target = area_of(c0, NULL) * (1 + number());
        bool solved = solve(d, target, z, &outcome);
        double least = objective_of(z, c0);
        for (double size = 1; size > 1e-4; size /= 3)
            if (neighbor_of(z, size, target, neighbor)) {
                tried++;
                double other = objective_of(neighbor, c0);
                if ((!solved || !(other >= least - 1e-11 * fabs(least))) && ++failures < 5)
                    note("round %ld, size %g: %.17g < %.17g", round, size, other, least);
            }
        sample_free();
    }
    ok(failures == 0 && tried > 100, "no neighbor of the right area has less (%ld tried)", tried);
}

/* A drag by d from base is one by 0 from base + direction·d; one handle serves many drags. */
static void test_drags(void)
{
    int failures = 0;
    double worst = 0;
    for (long round = 0; round < test_effort(20); round++) {
        double z[2 * MOST], moved[2 * MOST], result[2 * MOST];
        struct deform_outcome outcome, again;
        size_t n = round % 4 ? 4 + below(20) : 60 + below(100), free_count = below(2) ? n : 1 + below(n);
        struct deform *deform;
        sample_make(n, below(3), free_count, exp(3 * number()));
        struct deform_problem problem = sample.problem;
        double target = area_of(sample.base, NULL);
        bool made = deform_create(&problem, &deform) == BCIFS_OK;
        for (int k = 0; made && k < 8; k++) {
            double d[2] = {0.1 * k + 0.3 * number(), 0.5 * number()};
            bool solved = deform_solve(deform, d, target, result, &outcome) == BCIFS_OK;
            start_of(d, z);
            insert(result, z);
            double kept[2 * MOST];
            memcpy(kept, sample.base, sizeof kept);
            start_of(d, moved);
            memcpy(sample.base, moved, sizeof moved);
            sample.problem.direction = NULL;
            solved = solved && solve((double[2]){0, 0}, target, moved, &again);
            memcpy(sample.base, kept, sizeof kept);
            sample.problem.direction = sample.direction;
            double error = distance(z, moved, 2 * n);
            worst = fmax(worst, error);
            if ((!solved || again.reason != outcome.reason || !(error < 1e-9)) && ++failures < 5)
                note("round %ld, drag %d: %zu free of %zu, alpha %g: reasons %d %d, error %g", round, k,
                     free_count, n, problem.alpha, outcome.reason, again.reason, error);
        }
        deform_free(deform);
        sample_free();
    }
    ok(failures == 0, "a drag is a new start (%.1e)", worst);
}

/* c0 = 0: the objective is homogeneous, so its least value for the area 1 is |λ*|, the end of the interval:
 * that of z itself, which is an eigenvector. */
static void test_hard(void)
{
    int failures = 0;
    for (long round = 0; round < test_effort(60); round++) {
        double z[2 * MOST], c0[2 * MOST] = {0}, copy[2 * MOST], none[2] = {0, 0}, sign = below(2) ? 1 : -1;
        struct deform_outcome outcome;
        size_t n = round % 12 == 6 ? 200 : round % 6 == 0 ? 50 + below(100) : 3 + below(30);
        sample_make(n, round % 12 == 6 ? 0 : below(3), n < 50 && below(2) ? 2 + below(n - 1) : n,
                    exp(2 * number()));
        memset(sample.base, 0, sizeof sample.base);
        if (below(2))
            sample.problem.direction = NULL;
        /* Without an energy the eigenvalues of a polygon's area crowd at the critical one: no small space has
         * it. */
        if (round % 12 == 6) {
            sample.problem.energy = NULL;
            sample.problem.direction = NULL;
        }
        bool linear = true;
        for (size_t p = 0; p < sample.problem.free_count; p++)
            for (size_t q = 0; q < sample.problem.free_count; q++)
                linear = linear && sample.m[sample.list[p] * n + sample.list[q]] == 0;
        if (linear) {
            sample_free();
            continue;
        }
        double target = sign * exp(3 * number());
        bool solved = solve(none, target, z, &outcome);
        double area = area_error(z, c0, target), equation = stationary_error(z, c0, outcome.multiplier);
        bool inside = point_at(outcome.multiplier * (1 - 1e-8), c0, copy);
        bool outside = point_at(outcome.multiplier * (1 + 1e-8), c0, copy);
        double least = fabs(outcome.multiplier * target);
        if (!(solved && outcome.reason == DEFORM_REACHED && outcome.global && area < 1e-13 &&
              equation < 1e-10 && inside && !outside && fabs(objective_of(z, c0) / least - 1) < 1e-8) &&
            ++failures < 5)
            note("round %ld: %zu free of %zu, target %g: reason %d, area %g, stationary %g, inside %d %d, "
                 "objective %g %g",
                 round, sample.problem.free_count, n, target, outcome.reason, area, equation, inside, outside,
                 objective_of(z, c0), least);
        sample_free();
    }
    ok(failures == 0, "from nothing, an area is made by the critical eigenvector");
}

/* A regular polygon is blind to all but one of its modes: other modes are better for large areas. */
static void test_symmetric(void)
{
    int failures = 0;
    for (long round = 0; round < test_effort(20); round++) {
        size_t n = round % 2 ? 5 + below(30) : 50 + below(60);
        double z[2 * MOST], c0[2 * MOST], copy[2 * MOST], none[2] = {0, 0};
        struct deform_outcome outcome;
        sample_make(n, 0, n, 1);
        memset(sample.h, 0, sizeof sample.h);
        memset(sample.m, 0, sizeof sample.m);
        area_fill(n, true, 0);
        sample.area = sparse_from(sample.m, n, &sample.arena);
        sample.problem.energy = NULL;
        sample.problem.direction = NULL;
        for (size_t i = 0; i < n; i++) {
            sample.base[2 * i] = cos(2 * acos(-1) * (double)i / (double)n);
            sample.base[2 * i + 1] = sin(2 * acos(-1) * (double)i / (double)n);
        }
        double target = area_of(sample.base, NULL) * (2 + 40 * (number() + 1));
        bool solved = solve(none, target, z, &outcome);
        start_of(none, c0);
        double area = area_error(z, c0, target), equation = stationary_error(z, c0, outcome.multiplier);
        bool inside = point_at(outcome.multiplier * (1 - 1e-8), c0, copy);
        if (!(solved && outcome.reason == DEFORM_REACHED && area < 1e-13 && equation < 1e-10 && inside &&
              outcome.global) &&
            ++failures < 5)
            note("round %ld: n %zu, target %g: reason %d, area %g, stationary %g, inside %d, %u steps", round,
                 n, target, outcome.reason, area, equation, inside, outcome.iterations);
        sample_free();
    }
    ok(failures == 0, "modes that the data do not see are found");
}

static void test_reasons(void)
{
    double z[2 * MOST], c0[2 * MOST], none[2] = {0, 0};
    struct deform_outcome outcome;
    sample_make(12, 0, 12, 1);
    double area = area_of(sample.base, NULL);
    sample.problem.free_count = 0;
    ok(solve(none, 2 * area, z, &outcome) && outcome.reason == DEFORM_NONE_FREE &&
           fabs(outcome.area / area - 1) < 1e-14,
       "nothing is free: the area stays");
    ok(solve(none, area, z, &outcome) && outcome.reason == DEFORM_REACHED,
       "nothing is free and nothing to do");
    sample_free();

    /* Coefficient 5 does not occur in the area. */
    sample_make(12, 1, 12, 1);
    for (size_t i = 0; i < 12; i++)
        sample.m[5 * 12 + i] = sample.m[i * 12 + 5] = 0;
    sample.area = sparse_from(sample.m, 12, &sample.arena);
    sample.list[0] = 5;
    sample.problem.free_count = 1;
    area = area_of(sample.base, NULL);
    ok(solve(none, 2 * area, z, &outcome) && outcome.reason == DEFORM_INSENSITIVE &&
           fabs(outcome.area / area - 1) < 1e-14,
       "the area does not depend on what is free");
    start_of(none, c0);
    ok(stationary_error(z, c0, 0) < 1e-14, "then the energy alone decides");
    ok(solve(none, area, z, &outcome) && outcome.reason == DEFORM_REACHED, "which may be all that is wanted");
    sample_free();

    /* One free coefficient: the area is linear in it. */
    sample_make(12, 1, 1, 1);
    start_of(none, c0);
    ok(solve(none, -3 * area, z, &outcome) && outcome.reason == DEFORM_REACHED && outcome.global &&
           area_error(z, c0, -3 * area) < 1e-14 && stationary_error(z, c0, outcome.multiplier) < 1e-14,
       "one free coefficient reaches any area");
    sample_free();
}

/* z s, A s²; H, α and M in other units: the same z. */
static void test_scale(void)
{
    int failures = 0;
    for (long round = 0; round < test_effort(40); round++) {
        double z[2 * MOST], scaled[2 * MOST], d[2] = {number(), number()}, expected[2 * MOST];
        struct deform_outcome outcome, other;
        size_t n = round % 4 ? 4 + below(20) : 60 + below(60);
        int power = (int)below(300) - 150;
        double s = ldexp(1, power), unit = ldexp(1, (int)below(300) - 150),
               weight = ldexp(1, (int)below(200) - 100);
        sample_make(n, below(3), 1 + below(n), exp(3 * number()));
        double target = area_of(sample.base, NULL) * (1 + 0.5 * number());
        bool solved = solve(d, target, z, &outcome);
        for (size_t i = 0; i < 2 * n; i++) {
            sample.base[i] *= s;
            expected[i] = z[i] * s;
        }
        for (size_t i = 0; i < n * n; i++) {
            sample.m[i] *= weight;
            sample.h[i] *= unit;
        }
        sample.energy = sparse_from(sample.h, n, &sample.arena);
        sample.area = sparse_from(sample.m, n, &sample.arena);
        sample.problem.alpha *= unit;
        solved = solved && solve((double[2]){d[0] * s, d[1] * s}, target * s * s * weight, scaled, &other);
        double error = distance(scaled, expected, 2 * n) / s;
        if ((!solved || outcome.reason != other.reason || !(error < 1e-10) ||
             !(fabs(other.multiplier / unit * weight - outcome.multiplier) <=
               1e-9 * fabs(outcome.multiplier))) &&
            ++failures < 5)
            note("round %ld: n %zu, scales %g %g %g: reasons %d %d, error %g", round, n, s, unit, weight,
                 outcome.reason, other.reason, error);
        sample_free();
    }
    ok(failures == 0, "scale changes nothing but the result's scale");
}

/* α large: z stays near c0; α small or 0: the limit, where the energy and the fixed points determine it. */
static void test_alpha(void)
{
    int failures = 0;
    for (long round = 0; round < test_effort(40); round++) {
        static const double alphas[] = {0, 1e-30, 1e-9, 1e9, 1e30};
        double z[2 * MOST], c0[2 * MOST], d[2] = {0.3 * number(), 0.3 * number()};
        struct deform_outcome outcome;
        size_t n = round % 4 ? 8 + below(20) : 60 + below(60);
        double alpha = alphas[round % 5];
        sample_make(n, below(2), n < 30 ? 2 + below(n / 2) : n / 2, alpha);
        start_of(d, c0);
        double target = area_of(c0, NULL) * (1 + 0.3 * number());
        bool solved = solve(d, target, z, &outcome);
        double area = area_error(z, c0, target), equation = stationary_error(z, c0, outcome.multiplier);
        if (!(solved && outcome.reason == DEFORM_REACHED && outcome.global && area < 1e-13 &&
              equation < 1e-10) &&
            ++failures < 5)
            note("round %ld: n %zu, %zu free, alpha %g: reason %d, area %g, stationary %g", round, n,
                 sample.problem.free_count, alpha, outcome.reason, area, equation);
        sample_free();
    }
    ok(failures == 0, "alpha may be anything");
    sample_make(20, 0, 20, 0);
    sample.problem.energy = NULL;
    double z[2 * MOST], other[2 * MOST], none[2] = {0, 0}, target = 1.2 * area_of(sample.base, NULL);
    struct deform_outcome outcome;
    bool solved = solve(none, target, z, &outcome);
    sample.problem.alpha = 1;
    solved = solved && solve(none, target, other, &outcome);
    ok(solved && distance(z, other, 40) == 0, "without energy and alpha the distance alone counts");
    sample_free();
}

static void test_memory(void)
{
    int failures = 0;
    for (int large = 0; large < 2; large++) {
        long attempts = 0;
        size_t n = large ? 70 : 12;
        sample_make(n, 0, n, 1e-3);
        double result[2 * MOST], target = 3 * area_of(sample.base, NULL);
        long before = alive;
        for (bool done = false; !done && attempts < 10000;) {
            struct deform *deform = NULL;
            struct deform_outcome outcome;
            fail_after = ++attempts;
            bcifs_status status = deform_create(&sample.problem, &deform);
            if (status == BCIFS_OK)
                status = deform_solve(deform, (double[2]){2, 1}, target, result, &outcome);
            done = fail_after > 0;
            fail_after = 0;
            failures += status != (done ? BCIFS_OK : BCIFS_MEMORY);
            if (!done && deform)
                failures += deform_solve(deform, (double[2]){2, 1}, target, result, &outcome) != BCIFS_OK;
            deform_free(deform);
            failures += alive != before;
        }
        note("%ld requests", attempts);
        sample_free();
    }
    ok(failures == 0, "every failure of memory is told, and a handle works on after it");
}

int main(void)
{
    test_reference();
    test_large();
    test_neighbors();
    test_drags();
    test_hard();
    test_symmetric();
    test_reasons();
    test_scale();
    test_alpha();
    test_memory();
    ok(alive == 0, "all memory is given back");
    return done_testing();
}
