/* Antisymmetric matrices: the reduction against C = Q S Q^T, equations against their residuals, and the
 * interval of positive definiteness against eigenvalues known from Chebyshev's polynomials. */
#include <math.h>
#include <string.h>

#include "numeric/skew.h"
#include "tap.h"

enum { MOST = 40 };

static uint64_t seed = 7;

static size_t below(size_t limit)
{
    return (size_t)(random_bits(&seed) % limit);
}

static double number(void)
{
    return (double)(random_bits(&seed) >> 11) / 4503599627370496.0 - 1;
}

/* size × size, with zeros, and of any scale. */
static void random_skew(double *c, size_t size, double scale)
{
    size_t holes = below(4);
    for (size_t i = 0; i < size; i++) {
        c[i * size + i] = 0;
        for (size_t j = 0; j < i; j++) {
            c[i * size + j] = below(4) < holes ? 0 : scale * number();
            c[j * size + i] = -c[i * size + j];
        }
    }
}

static double entry(const double *side, size_t i, size_t j)
{
    return j == i + 1 ? side[i] : i == j + 1 ? -side[j] : 0;
}

/* max |Q S Q^T - C| and max |Q^T Q - 1|, C relative to `scale`. */
static double reduction_error(const double *c, const double *q, const double *side, size_t size, double scale)
{
    double worst = 0;
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < size; j++) {
            double difference = -c[i * size + j], product = i == j ? -1 : 0;
            for (size_t k = 0; k < size; k++) {
                product += q[k * size + i] * q[k * size + j];
                for (size_t l = k > 0 ? k - 1 : 0; l < size && l <= k + 1; l++)
                    difference += q[i * size + k] * entry(side, k, l) * q[j * size + l];
            }
            worst = fmax(worst, fmax(fabs(difference) / scale, fabs(product)));
        }
    return worst;
}

static void test_reduction(void)
{
    static double c[MOST * MOST], kept[MOST * MOST], q[MOST * MOST], side[MOST], workspace[2 * MOST];
    int failures = 0;
    for (long round = 0; round < test_effort(300); round++) {
        size_t size = below(MOST + 1);
        double scale = exp(200 * number());
        random_skew(c, size, scale);
        memcpy(kept, c, sizeof c);
        skew_reduce(c, size, q, side, workspace);
        double error = reduction_error(kept, q, side, size, scale);
        if (!(error < 1e-14 * (double)(size + 1)) && ++failures < 5)
            note("size %zu, scale %g: error %g", size, scale, error);
    }
    ok(failures == 0, "C = Q S Q^T with Q orthogonal");
}

/* (1 - iθS) y = g through D (1 + θT) D*: the residual with S itself, complex. */
static double equation_residual(const double *side, size_t size, double theta, const double *g,
                                const double *y)
{
    double worst = 0;
    for (size_t i = 0; i < size; i++) {
        double real = y[2 * i] - g[2 * i], imaginary = y[2 * i + 1] - g[2 * i + 1];
        for (size_t j = 0; j < size; j++) {
            real += theta * entry(side, i, j) * y[2 * j + 1];
            imaginary -= theta * entry(side, i, j) * y[2 * j];
        }
        worst = fmax(worst, hypot(real, imaginary));
    }
    return worst;
}

static void test_equations(void)
{
    int failures = 0;
    for (long round = 0; round < test_effort(1000); round++) {
        double side[MOST], factors[2 * MOST], g[2 * MOST], y[2 * MOST], z[2 * MOST], t[2 * MOST], largest = 0;
        size_t size = 1 + below(MOST);
        for (size_t k = 0; k < size; k++)
            side[k] = below(8) == 0 ? 0 : number();
        double bound = skew_bound(side, size, factors), theta = 0.99 * number() * (isinf(bound) ? 1 : bound);
        for (size_t k = 0; k < 2 * size; k++)
            g[k] = y[k] = number();
        skew_turn(y, size, true);
        bool definite = skew_factor(side, size, theta, factors, factors + MOST);
        skew_solve(factors, factors + MOST, size, y);
        skew_apply(side, size, y, t);
        memcpy(z, y, sizeof z);
        skew_turn(y, size, false);
        for (size_t k = 0; k < 2 * size; k++)
            largest = fmax(largest, fabs(y[k]));
        double residual = equation_residual(side, size, theta, g, y);
        /* z + θ T z is the turned right side. */
        for (size_t k = 0; k < 2 * size; k++)
            t[k] = z[k] + theta * t[k];
        skew_turn(t, size, false);
        for (size_t k = 0; k < 2 * size; k++)
            residual = fmax(residual, fabs(t[k] - g[k]));
        if ((!definite || !(residual < 1e-14 * (1 + largest))) && ++failures < 5)
            note("size %zu, theta %g: %d, residual %g", size, theta, definite, residual);
    }
    ok(failures == 0, "(1 - iθS) y = g is solved in real arithmetic");
}

/* Sides 1: |T| = 2 cos(π/(size + 1)). */
static void test_bound_known(void)
{
    double side[MOST], workspace[2 * MOST], worst = 0;
    for (size_t size = 2; size <= MOST; size++)
        for (double scale = 1e-100; scale < 1e101; scale *= 1e100) {
            for (size_t k = 0; k < size; k++)
                side[k] = k % 3 ? scale : -scale;
            double expected = 0.5 / cos(acos(-1) / (double)(size + 1)) / scale;
            worst = fmax(worst, fabs(skew_bound(side, size, workspace) / expected - 1));
        }
    ok(worst < 1e-14, "the bound is that of Chebyshev's polynomials (%g)", worst);
    side[0] = 0;
    ok(isinf(skew_bound(side, 1, workspace)) && isinf(skew_bound(side, 0, workspace)), "0 has no bound");
}

/* Just inside the bound the matrix is definite, just outside it is not, whatever the sign. */
static void test_bound_random(void)
{
    int failures = 0;
    for (long round = 0; round < test_effort(500); round++) {
        double side[MOST], workspace[2 * MOST], largest = 0;
        size_t size = 2 + below(MOST - 1);
        for (size_t k = 0; k < size; k++) {
            side[k] = exp(5 * number());
            largest = fmax(largest, side[k]);
        }
        double bound = skew_bound(side, size, workspace);
        bool holds = skew_factor(side, size, bound, workspace, workspace + MOST) &&
                     skew_factor(side, size, -bound, workspace, workspace + MOST) &&
                     !skew_factor(side, size, bound * (1 + 1e-14), workspace, workspace + MOST) &&
                     !skew_factor(side, size, -bound * (1 + 1e-14), workspace, workspace + MOST);
        if (!holds && ++failures < 5)
            note("size %zu: bound %g", size, bound);
    }
    ok(failures == 0, "1 + θT is positive definite up to the bound and not beyond");
}

int main(void)
{
    test_reduction();
    test_equations();
    test_bound_known();
    test_bound_random();
    return done_testing();
}
