#include "enclosure.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "numeric/eigen.h"
#include "numeric/matrix.h"
#include "numeric/tolerance.h"

static const double UNIT = DBL_EPSILON / 2;
enum { MOST_DIAGONAL = 48 };               /* eigenvectors take the fourth power of the order */
static const double MOST_TRACE_WORK = 2e7; /* multiplications */
static const double CLUSTER = 1e-3; /* share of the largest eigenvalue within which others are called close */
static const double UNDERFLOW = 1e-290; /* more than all underflows of one product can amount to */

double round_up(double x, size_t operations)
{
    return x * (1 + 2 * ((double)operations + 2) * UNIT);
}

double round_down(double x, size_t operations)
{
    return x * (1 - 2 * ((double)operations + 2) * UNIT);
}

/* γ_n of a real product; four times that covers a complex one. */
static double gamma_of(size_t n)
{
    return 1.01 * ((double)n + 1) * UNIT;
}

double row_norm(const double *a, size_t rows, size_t columns)
{
    double largest = 0;
    for (size_t i = 0; i < rows; i++) {
        double sum = 0;
        for (size_t j = 0; j < columns; j++)
            sum += fabs(a[i * columns + j]);
        largest = fmax(largest, sum);
    }
    return round_up(largest, columns);
}

double multiply_enclosed(const double *a, double norm_a, double error_a, const double *b, double norm_b,
                         double error_b, size_t rows, size_t inner, size_t columns, double *c)
{
    matrix_multiply(a, b, rows, inner, columns, c);
    double error = error_a * (norm_b + error_b) + norm_a * error_b + gamma_of(inner) * norm_a * norm_b;
    return round_up(error, 8) + UNDERFLOW;
}

/* ---- Gershgorin ---------------------------------------------------------------------------------------- */

void complex_solve(double complex *a, double complex *b, size_t size, size_t columns, double tiny)
{
    for (size_t k = 0; k < size; k++) {
        size_t best = k;
        for (size_t i = k + 1; i < size; i++)
            if (cabs(a[i * size + k]) > cabs(a[best * size + k]))
                best = i;
        for (size_t j = 0; j < size && best != k; j++) {
            double complex keep = a[k * size + j];
            a[k * size + j] = a[best * size + j];
            a[best * size + j] = keep;
        }
        for (size_t j = 0; j < columns && best != k; j++) {
            double complex keep = b[k * columns + j];
            b[k * columns + j] = b[best * columns + j];
            b[best * columns + j] = keep;
        }
        if (cabs(a[k * size + k]) < tiny)
            a[k * size + k] = tiny;
        for (size_t i = 0; i < size; i++) {
            double complex factor = i == k ? 0 : a[i * size + k] / a[k * size + k];
            if (factor == 0)
                continue;
            for (size_t j = k; j < size; j++)
                a[i * size + j] -= factor * a[k * size + j];
            for (size_t j = 0; j < columns; j++)
                b[i * columns + j] -= factor * b[k * columns + j];
        }
    }
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < columns; j++)
            b[i * columns + j] /= a[i * size + i];
}

struct diagonalization {
    size_t size;
    double complex *x, *inverse, *product, *workspace; /* size × size each */
    double *real, *imaginary;                          /* eigenvalues */
    double complex *vector;
};

static bool are_close(const struct diagonalization *d, size_t j, size_t k)
{
    double distance = hypot(d->real[j] - d->real[k], d->imaginary[j] - d->imaginary[k]);
    return distance <= CLUSTER * hypot(d->real[0], d->imaginary[0]);
}

/* v <- v less its projections on the columns of X before k whose eigenvalues are close to the k-th: where
 * eigenvectors run together (a Jordan block), the columns then span the same invariant subspace, and stay
 * independent. */
static void cluster_leave(struct diagonalization *d, size_t k)
{
    size_t n = d->size;
    for (size_t j = 0; j < k; j++) {
        double complex sum = 0;
        double square = 0;
        if (!are_close(d, j, k))
            continue;
        for (size_t i = 0; i < n; i++) {
            sum += conj(d->x[i * n + j]) * d->vector[i];
            square += creal(d->x[i * n + j] * conj(d->x[i * n + j]));
        }
        for (size_t i = 0; i < n; i++)
            d->vector[i] -= sum / square * d->x[i * n + j];
    }
}

/* In a cluster of q close eigenvalues A is nearly triangular; dividing column p by s^p divides what stands
 * above the diagonal by s, and multiplies rounding below it: s = 10^(14/q) leaves both small. */
static double cluster_scale(const struct diagonalization *d, size_t k)
{
    double before = 0, all = 0;
    for (size_t j = 0; j < d->size; j++) {
        before += j < k && are_close(d, j, k);
        all += are_close(d, j, k);
    }
    return pow(10, -14 / all * before);
}

/* Column k of X: an eigenvector by inverse iteration from a start that differs with k, so that a multiple
 * eigenvalue with several eigenvectors gets independent ones; with `clusters`, as above. */
static void eigenvector_find(struct diagonalization *d, const double *a, double norm, size_t k, bool clusters)
{
    size_t n = d->size;
    double complex lambda = d->real[k] + I * d->imaginary[k];
    for (size_t i = 0; i < n; i++)
        d->vector[i] = 1 + 0.37 * sin(1.0 + (double)(i * (2 * k + 3)) + 0.7 * (double)k);
    for (int step = 0; step < 3; step++) {
        double largest = 0;
        for (size_t i = 0; i < n * n; i++)
            d->workspace[i] = a[i];
        for (size_t i = 0; i < n; i++)
            d->workspace[i * n + i] -= lambda;
        complex_solve(d->workspace, d->vector, n, 1, norm * UNIT);
        if (clusters)
            cluster_leave(d, k);
        for (size_t i = 0; i < n; i++)
            largest = fmax(largest, cabs(d->vector[i]));
        for (size_t i = 0; i < n; i++)
            d->vector[i] /= largest;
    }
    for (size_t i = 0; i < n; i++)
        d->x[i * n + k] = d->vector[i];
}

static double complex_row_norm(const double complex *row, size_t size)
{
    double sum = 0;
    for (size_t j = 0; j < size; j++)
        sum += cabs(row[j]);
    return round_up(sum, 4 * size);
}

static double complex_norm(const double complex *a, size_t size)
{
    double largest = 0;
    for (size_t i = 0; i < size; i++)
        largest = fmax(largest, complex_row_norm(a + i * size, size));
    return largest;
}

static void complex_multiply(const double complex *a, const double complex *b, size_t size, double complex *c)
{
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < size; j++) {
            double complex sum = 0;
            for (size_t k = 0; k < size; k++)
                sum += a[i * size + k] * b[k * size + j];
            c[i * size + j] = sum;
        }
}

/* The discs of X^-1 A X: centers on the diagonal of Z = Y A X, Y nearly X^-1. With Y X = I - G, |G| <= η < 1,
 * X^-1 A X = (I - G)^-1 Y A X = Z + (I - G)^-1 G Z, and row i of the last term is at most |G_i| / (1 - η)
 * |Z|. `radius` receives what rounding and this term add to every row sum. False: X is too ill conditioned.
 */
static bool discs_find(struct diagonalization *d, const double *a, double norm, double error, double *radius)
{
    size_t n = d->size;
    double gamma = 4 * gamma_of(n + 2), eta = 0;
    memcpy(d->workspace, d->x, n * n * sizeof *d->x);
    memset(d->inverse, 0, n * n * sizeof *d->inverse);
    for (size_t i = 0; i < n; i++)
        d->inverse[i * n + i] = 1;
    complex_solve(d->workspace, d->inverse, n, n, DBL_MIN);
    double norm_x = complex_norm(d->x, n), norm_y = complex_norm(d->inverse, n);
    if (!isfinite(norm_y) || norm_x * norm_y > 1e14)
        return false;
    complex_multiply(d->inverse, d->x, n, d->workspace);
    for (size_t i = 0; i < n; i++) {
        double row = complex_row_norm(d->inverse + i * n, n);
        d->workspace[i * n + i] -= 1;
        radius[i] = complex_row_norm(d->workspace + i * n, n) + 2 * gamma * (row * norm_x + 1);
        eta = fmax(eta, radius[i]);
    }
    if (!(eta < 0.5))
        return false;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            double complex sum = 0;
            for (size_t k = 0; k < n; k++)
                sum += a[i * n + k] * d->x[k * n + j];
            d->workspace[i * n + j] = sum;
        }
    complex_multiply(d->inverse, d->workspace, n, d->product);
    double rounding = norm_x * (2 * gamma * norm + error) * 1.01; /* times the norm of a row of Y */
    double norm_z = complex_norm(d->product, n) + norm_y * rounding;
    for (size_t i = 0; i < n; i++) {
        double row = complex_row_norm(d->inverse + i * n, n);
        radius[i] = 1.01 * (row * rounding + 1.01 * radius[i] / (1 - eta) * norm_z) + UNDERFLOW;
    }
    return true;
}

/* A connected union of discs holds as many eigenvalues as discs. The union around the outermost center gives
 * the lower bound, the union of all the upper one. */
static void discs_bound(const struct diagonalization *d, double *radius, bool *joined, double *lower,
                        double *upper)
{
    size_t n = d->size, outermost = 0;
    const double complex *z = d->product;
    for (size_t i = 0; i < n; i++) {
        double sum = 0;
        for (size_t j = 0; j < n; j++)
            sum += j == i ? 0 : cabs(z[i * n + j]);
        radius[i] = round_up(round_up(sum, 4 * n) + radius[i], 1);
        joined[i] = false;
        *upper = fmax(*upper, round_up(cabs(z[i * n + i]) + radius[i], 4));
        if (cabs(z[i * n + i]) > cabs(z[outermost * n + outermost]))
            outermost = i;
    }
    joined[outermost] = true;
    for (bool grows = true; grows;) {
        grows = false;
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < n && joined[i]; j++)
                if (!joined[j] && cabs(z[i * n + i] - z[j * n + j]) <= round_up(radius[i] + radius[j], 8)) {
                    joined[j] = grows = true;
                }
    }
    double low = INFINITY;
    for (size_t i = 0; i < n; i++)
        if (joined[i])
            low = fmin(low, round_down(cabs(z[i * n + i]), 4) - radius[i]);
    *lower = fmax(*lower, round_down(low, 2));
}

/* ---- Traces -------------------------------------------------------------------------------------------- */

/* ρ(A)^p >= |tr A^p| / n for p = 1, 2, 4, …: also where eigenvectors run together. */
static bool traces_bound(const double *a, size_t n, double error, struct arena *arena, double *lower)
{
    double *power = arena_grow(arena, a, n * n, n * n, sizeof *power);
    double *next = arena_new(arena, n * n, sizeof *next);
    if (!power || !next)
        return false;
    double exponent = 1, scale = 0; /* A^p = power · 2^scale */
    double work = 0, cost = (double)n * (double)n * (double)n;
    for (int step = 0; step < 40; step++, work += cost) {
        double trace = 0, sum = 0, norm = row_norm(power, n, n);
        for (size_t i = 0; i < n; i++) {
            trace += power[i * n + i];
            sum += fabs(power[i * n + i]);
        }
        double certain = fabs(trace) - gamma_of(n) * sum - (double)n * error * 1.01;
        if (certain > 0) {
            double logarithm = (log2(certain / (double)n) + scale) / exponent; /* good to a few u of itself */
            *lower = fmax(*lower, exp2(logarithm) * (1 - 8 * UNIT * (4 + fabs(logarithm))));
        }
        if (!(error < norm) || !isfinite(norm) || work + cost > MOST_TRACE_WORK)
            break;
        error = multiply_enclosed(power, norm, error, power, norm, error, n, n, n, next);
        int shift = 0;
        frexp(row_norm(next, n, n), &shift);
        for (size_t i = 0; i < n * n; i++)
            power[i] = ldexp(next[i], -shift);
        error = ldexp(error, -shift) + UNDERFLOW;
        exponent *= 2;
        scale = 2 * scale + shift;
    }
    return true;
}

/* Order 2: the roots of x² - t x + d. ρ >= |t|/2 and ρ >= sqrt |d| hold always, so a double root costs
 * nothing. */
static void quadratic_bound(const double *a, double error, double *lower, double *upper)
{
    double t = a[0] + a[3], sum = fabs(a[0]) + fabs(a[1]) + fabs(a[2]) + fabs(a[3]);
    double d = a[0] * a[3] - a[1] * a[2];
    double off_t = 2 * error + 2 * UNIT * (fabs(a[0]) + fabs(a[3]));
    double off_d = error * (sum + 2 * error) + 4 * UNIT * (fabs(a[0] * a[3]) + fabs(a[1] * a[2])) + UNDERFLOW;
    double low_t = fmax(fabs(t) - off_t, 0), high_t = fabs(t) + off_t;
    double low_d = fmax(fabs(d) - off_d, 0);
    double low_q = low_t * low_t - 4 * (d + off_d) - 8 * UNIT * (t * t + 4 * fabs(d));
    double high_q = high_t * high_t - 4 * (d - off_d) + 8 * UNIT * (t * t + 4 * fabs(d));
    *lower = fmax(*lower, round_down(fmax(low_t / 2, sqrt(low_d)), 4));
    if (low_q > 0)
        *lower = fmax(*lower, round_down((low_t + sqrt(low_q)) / 2, 8));
    double real = (high_t + sqrt(fmax(high_q, 0))) / 2, modulus = sqrt(fmax(d + off_d, 0));
    *upper = fmin(*upper, round_up(low_q > 0 ? real : high_q < 0 ? modulus : fmax(real, modulus), 8));
}

/* ---- The whole ----------------------------------------------------------------------------------------- */

int spectral_radius_enclose(const double *a, size_t size, double error, struct arena *arena, double *lower,
                            double *upper)
{
    double norm = row_norm(a, size, size);
    *lower = 0;
    *upper = size == 0 ? 0 : round_up(norm + error, 2);
    if (size == 0)
        return 1;
    if (size == 1) {
        *lower = error == 0 ? fabs(a[0]) : fmax(0, round_down(fabs(a[0]) - error, 2));
        *upper = error == 0 ? fabs(a[0]) : *upper;
        return 1;
    }
    if (size == 2)
        quadratic_bound(a, error, lower, upper);
    if (!traces_bound(a, size, error, arena, lower))
        return 0;
    if (size > MOST_DIAGONAL)
        return 1;
    struct diagonalization d = {.size = size};
    double *copy = arena_grow(arena, a, size * size, size * size, sizeof *copy);
    double *numbers = arena_new(arena, 3 * size, sizeof *numbers);
    double complex *matrices = arena_new(arena, 4 * size * size + size, sizeof *matrices);
    bool *joined = arena_new(arena, size, sizeof *joined);
    if (!copy || !numbers || !matrices || !joined)
        return 0;
    d.real = numbers;
    d.imaginary = numbers + size;
    d.x = matrices;
    d.inverse = d.x + size * size;
    d.product = d.inverse + size * size;
    d.workspace = d.product + size * size;
    d.vector = d.workspace + size * size;
    if (!isfinite(norm) || !eigenvalues(copy, size, d.real, d.imaginary))
        return 1;
    for (int clusters = 0; clusters < 2 && *upper > *lower * (1 + TOLERANCE_EXACT); clusters++) {
        double low = 0, high = 0;
        for (size_t k = 0; k < size; k++)
            eigenvector_find(&d, a, norm, k, clusters);
        for (size_t k = 0; k < size && clusters; k++)
            for (size_t i = 0; i < size; i++)
                d.x[i * size + k] *= cluster_scale(&d, k);
        if (!discs_find(&d, a, norm, error, numbers + 2 * size))
            continue;
        discs_bound(&d, numbers + 2 * size, joined, &low, &high);
        *lower = fmax(*lower, low);
        *upper = fmin(*upper, high);
    }
    return 1;
}
