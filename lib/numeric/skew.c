#include "skew.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- Reduction ----------------------------------------------------------------------------------------- */

/* v with (1 - v v^T) x = (result, 0, …): `x` (count numbers) becomes v, |v|² = 2; or v = 0 when x is so
 * already. */
static double reflection_make(double *x, size_t count)
{
    double largest = 0, square = 0;
    for (size_t i = 1; i < count; i++)
        largest = fmax(largest, fabs(x[i]));
    if (largest == 0) {
        double kept = x[0];
        x[0] = 0;
        return kept;
    }
    largest = fmax(largest, fabs(x[0]));
    for (size_t i = 0; i < count; i++) {
        x[i] /= largest;
        square += x[i] * x[i];
    }
    double norm = sqrt(square), scale = sqrt(1 / (norm * (norm + fabs(x[0])))), sign = x[0] > 0 ? -1 : 1;
    x[0] -= sign * norm;
    for (size_t i = 0; i < count; i++)
        x[i] *= scale;
    return sign * norm * largest;
}

/* With w = C v: (1 - v v^T) C (1 - v v^T) = C + v w^T - w v^T, for v^T C v = 0. C: count × count in rows of
 * `size`. */
static void reflect_both(double *c, size_t count, size_t size, const double *v, double *w)
{
    for (size_t i = 0; i < count; i++) {
        w[i] = 0;
        for (size_t j = 0; j < count; j++)
            w[i] += c[i * size + j] * v[j];
    }
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            c[i * size + j] += v[i] * w[j] - w[i] * v[j];
}

/* Q <- (1 - v v^T) Q on count × count numbers in rows of `size`. */
static void reflect_left(double *q, size_t count, size_t size, const double *v, double *w)
{
    memset(w, 0, count * sizeof *w);
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; v[i] != 0 && j < count; j++)
            w[j] += v[i] * q[i * size + j];
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; v[i] != 0 && j < count; j++)
            q[i * size + j] -= v[i] * w[j];
}

void skew_reduce(double *c, size_t size, double *q, double *side, double *workspace)
{
    /* Row k, right of the diagonal, is no longer needed once it is reduced: it keeps the vector v. */
    for (size_t k = 0; k + 1 < size; k++) {
        double *v = c + k * size + k + 1;
        size_t count = size - k - 1;
        side[k] = reflection_make(v, count);
        reflect_both(c + (k + 1) * size + k + 1, count, size, v, workspace);
    }
    if (size > 0)
        side[size - 1] = 0;
    /* Q = P_0 P_1 … from the last one on, so that each works on a block only. */
    memset(q, 0, size * size * sizeof *q);
    for (size_t i = 0; i < size; i++)
        q[i * size + i] = 1;
    for (size_t k = size; k-- > 0;)
        if (k + 1 < size)
            reflect_left(q + (k + 1) * size + k + 1, size - k - 1, size, c + k * size + k + 1, workspace);
}

/* ---- The tridiagonal matrix ---------------------------------------------------------------------------- */

void skew_turn(double *x, size_t size, bool back)
{
    for (size_t k = 0; k < size; k++) {
        double real = x[2 * k], imaginary = x[2 * k + 1], sign = k & 2 ? -1 : 1;
        if (k & 1) {
            double turn = back ? -sign : sign;
            x[2 * k] = -turn * imaginary;
            x[2 * k + 1] = turn * real;
        } else {
            x[2 * k] = sign * real;
            x[2 * k + 1] = sign * imaginary;
        }
    }
}

/* p_0 = 1, p_{k+1} = 1 - (θ side_k)²/p_k. */
bool skew_factor(const double *side, size_t size, double theta, double *below, double *inverse)
{
    double pivot = 1;
    for (size_t k = 0; k < size; k++) {
        if (!(pivot > 0))
            return false;
        double beside = theta * side[k];
        inverse[k] = 1 / pivot;
        below[k] = beside * inverse[k];
        pivot = 1 - beside * below[k];
    }
    return true;
}

void skew_solve(const double *below, const double *inverse, size_t size, double *x)
{
    double real = 0, imaginary = 0, factor = 0;
    for (size_t k = 0; k < size; k++) {
        x[2 * k] = real = x[2 * k] - factor * real;
        x[2 * k + 1] = imaginary = x[2 * k + 1] - factor * imaginary;
        factor = below[k];
    }
    real = imaginary = 0;
    for (size_t k = size; k-- > 0;) {
        x[2 * k] = real = x[2 * k] * inverse[k] - below[k] * real;
        x[2 * k + 1] = imaginary = x[2 * k + 1] * inverse[k] - below[k] * imaginary;
    }
}

void skew_apply(const double *side, size_t size, const double *x, double *y)
{
    double before = 0;
    for (size_t k = 0; k < size; k++) {
        y[2 * k] = y[2 * k + 1] = 0;
        if (k > 0) {
            y[2 * k] = before * x[2 * k - 2];
            y[2 * k + 1] = before * x[2 * k - 1];
        }
        if (k + 1 < size) {
            y[2 * k] += side[k] * x[2 * k + 2];
            y[2 * k + 1] += side[k] * x[2 * k + 3];
        }
        before = side[k];
    }
}

double skew_bound(const double *side, size_t size, double *workspace)
{
    /* max side_k <= |T| <= max (side_{k-1} + side_k) */
    double least = 0, most = 0, before = 0;
    for (size_t k = 0; k + 1 < size; k++) {
        least = fmax(least, fabs(side[k]));
        most = fmax(most, fabs(side[k]) + before);
        before = fabs(side[k]);
    }
    double low = 1 / most, high = 1 / least;
    if (!isfinite(high))
        return INFINITY;
    low *= 1 - 4 * DBL_EPSILON;
    high *= 1 + 4 * DBL_EPSILON;
    while (high - low > DBL_EPSILON * low) {
        double middle = low + (high - low) / 2;
        if (middle <= low || middle >= high)
            break;
        if (skew_factor(side, size, middle, workspace, workspace + size))
            low = middle;
        else
            high = middle;
    }
    return low;
}
