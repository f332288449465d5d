#include "eigen.h"

#include <float.h>
#include <math.h>

enum { MOST_ITERATIONS = 120 }; /* of QR for one eigenvalue; 3 or 4 are usual, Jordan blocks take tens */

static void swap(double *a, double *b)
{
    double keep = *a;
    *a = *b;
    *b = keep;
}

/* Exchanges two rows and the two columns of the same numbers. */
static void exchange(double *a, size_t size, size_t p, size_t q)
{
    for (size_t j = 0; j < size && p != q; j++)
        swap(&a[p * size + j], &a[q * size + j]);
    for (size_t i = 0; i < size && p != q; i++)
        swap(&a[i * size + p], &a[i * size + q]);
}

/* Whether row (or column) i has only zeros beside the diagonal, within low … high - 1. */
static bool is_isolated(const double *a, size_t size, size_t low, size_t high, size_t i, bool row)
{
    for (size_t j = low; j < high; j++)
        if (j != i && a[row ? i * size + j : j * size + i] != 0)
            return false;
    return true;
}

/* Brings isolated rows to the end and isolated columns to the front: their diagonal entries are eigenvalues, and
 * low … high - 1 is what remains. Large entries beside them would spoil the scaling of the rest. */
static void isolate(double *a, size_t size, size_t *low, size_t *high)
{
    *low = 0;
    *high = size;
    for (bool found = true; found;) {
        found = false;
        for (size_t i = *low; i < *high && !found; i++)
            if (is_isolated(a, size, *low, *high, i, true)) {
                exchange(a, size, i, --*high);
                found = true;
            } else if (is_isolated(a, size, *low, *high, i, false)) {
                exchange(a, size, i, (*low)++);
                found = true;
            }
    }
}

/* Scales rows and columns by powers of 2 until they have comparable norms: D^-1 A D, D diagonal. */
static void balance(double *a, size_t size)
{
    size_t low, high;
    isolate(a, size, &low, &high);
    for (bool done = false; !done;) {
        done = true;
        for (size_t i = low; i < high; i++) {
            double row = 0, column = 0;
            for (size_t j = low; j < high; j++)
                if (j != i) {
                    column += fabs(a[j * size + i]);
                    row += fabs(a[i * size + j]);
                }
            if (column == 0 || row == 0 || !isfinite(column) || !isfinite(row))
                continue;
            double factor = 1, sum = column + row;
            for (; column < row / 2; column *= 4)
                factor *= 2;
            for (; column > row * 2; column /= 4)
                factor /= 2;
            if ((column + row) / factor >= 0.95 * sum)
                continue;
            done = false;
            for (size_t j = 0; j < size; j++)
                a[i * size + j] /= factor;
            for (size_t j = 0; j < size; j++)
                a[j * size + i] *= factor;
        }
    }
}

/* To upper Hessenberg form by elimination with pivoting; what is eliminated is set to 0. */
static void hessenberg(double *a, size_t size)
{
    for (size_t m = 1; m + 1 < size; m++) {
        size_t best = m;
        for (size_t j = m; j < size; j++)
            if (fabs(a[j * size + m - 1]) > fabs(a[best * size + m - 1]))
                best = j;
        double x = a[best * size + m - 1];
        if (best != m) {
            for (size_t j = m - 1; j < size; j++)
                swap(&a[best * size + j], &a[m * size + j]);
            for (size_t j = 0; j < size; j++)
                swap(&a[j * size + best], &a[j * size + m]);
        }
        for (size_t i = m + 1; i < size && x != 0; i++) {
            double y = a[i * size + m - 1] / x;
            if (y == 0)
                continue;
            for (size_t j = m - 1; j < size; j++)
                a[i * size + j] -= y * a[m * size + j];
            a[i * size + m - 1] = 0;
            for (size_t j = 0; j < size; j++)
                a[j * size + m] += y * a[j * size + i];
        }
    }
}

/* The eigenvalues of the trailing 2 × 2 block at rows n-1, n, with the shift added back. */
static void block_eigenvalues(const double *h, size_t size, size_t n, double shift, double *real,
                              double *imaginary)
{
    double x = h[n * size + n], y = h[(n - 1) * size + n - 1];
    double w = h[n * size + n - 1] * h[(n - 1) * size + n];
    double p = (y - x) / 2, q = p * p + w, z = sqrt(fabs(q));
    x += shift;
    if (q >= 0) {
        z = p + copysign(z, p);
        real[n - 1] = real[n] = x + z;
        if (z != 0)
            real[n] = x - w / z;
        imaginary[n - 1] = imaginary[n] = 0;
    } else {
        real[n - 1] = real[n] = x + p;
        imaginary[n - 1] = z;
        imaginary[n] = -z;
    }
}

struct reflection {
    double p, q, r;
};

/* One double step of the implicitly shifted QR iteration on rows and columns low..n. */
static void double_step(double *h, size_t size, size_t low, size_t n, double x, double y, double w)
{
    struct reflection v = {0, 0, 0};
    size_t m = n - 2;
    /* Start where two consecutive subdiagonal entries are small enough. */
    for (;; m--) {
        double z = h[m * size + m], r = x - z, s = y - z;
        v.p = (r * s - w) / h[(m + 1) * size + m] + h[m * size + m + 1];
        v.q = h[(m + 1) * size + m + 1] - z - r - s;
        v.r = h[(m + 2) * size + m + 1];
        double scale = fabs(v.p) + fabs(v.q) + fabs(v.r);
        v.p /= scale;
        v.q /= scale;
        v.r /= scale;
        if (m == low)
            break;
        double u = fabs(h[m * size + m - 1]) * (fabs(v.q) + fabs(v.r));
        double t = fabs(v.p) * (fabs(h[(m - 1) * size + m - 1]) + fabs(z) + fabs(h[(m + 1) * size + m + 1]));
        if (u <= DBL_EPSILON * t)
            break;
    }
    for (size_t i = m + 2; i <= n; i++) {
        h[i * size + i - 2] = 0;
        if (i > m + 2)
            h[i * size + i - 3] = 0;
    }
    for (size_t k = m; k < n; k++) {
        bool last = k == n - 1;
        double scale = 1;
        if (k != m) {
            v = (struct reflection){h[k * size + k - 1], h[(k + 1) * size + k - 1],
                                    last ? 0 : h[(k + 2) * size + k - 1]};
            scale = fabs(v.p) + fabs(v.q) + fabs(v.r);
            if (scale == 0)
                continue;
            v.p /= scale;
            v.q /= scale;
            v.r /= scale;
        }
        double s = copysign(sqrt(v.p * v.p + v.q * v.q + v.r * v.r), v.p);
        if (s == 0)
            continue;
        if (k != m)
            h[k * size + k - 1] = -s * scale;
        else if (low != m)
            h[k * size + k - 1] = -h[k * size + k - 1];
        v.p += s;
        double a = v.p / s, b = v.q / s, c = v.r / s, q = v.q / v.p, r = v.r / v.p;
        for (size_t j = k; j < size; j++) {
            double t = h[k * size + j] + q * h[(k + 1) * size + j];
            if (!last) {
                t += r * h[(k + 2) * size + j];
                h[(k + 2) * size + j] -= t * c;
            }
            h[(k + 1) * size + j] -= t * b;
            h[k * size + j] -= t * a;
        }
        size_t end = n < k + 3 ? n : k + 3;
        for (size_t i = 0; i <= end; i++) {
            double t = a * h[i * size + k] + b * h[i * size + k + 1];
            if (!last) {
                t += c * h[i * size + k + 2];
                h[i * size + k + 2] -= t * r;
            }
            h[i * size + k + 1] -= t * q;
            h[i * size + k] -= t;
        }
    }
}

/* The start of the unreduced block that ends at row n. */
static size_t block_start(const double *h, size_t size, size_t n, double norm)
{
    size_t low = n;
    for (; low > 0; low--) {
        double s = fabs(h[(low - 1) * size + low - 1]) + fabs(h[low * size + low]);
        if (s == 0)
            s = norm;
        if (fabs(h[low * size + low - 1]) <= DBL_EPSILON * s)
            break;
    }
    return low;
}

/* Finds the eigenvalues of a Hessenberg matrix from the bottom up. */
static bool hessenberg_eigenvalues(double *h, size_t size, double *real, double *imaginary)
{
    double norm = 0, shift = 0;
    for (size_t i = 0; i < size * size; i++)
        norm += fabs(h[i]);
    if (!isfinite(norm))
        return false;
    int iteration = 0;
    for (size_t left = size; left > 0;) {
        size_t n = left - 1, low = block_start(h, size, n, norm);
        double x = h[n * size + n];
        if (low == n) {
            real[n] = x + shift;
            imaginary[n] = 0;
            left -= 1;
            iteration = 0;
            continue;
        }
        if (low == n - 1) {
            block_eigenvalues(h, size, n, shift, real, imaginary);
            left -= 2;
            iteration = 0;
            continue;
        }
        double y = h[(n - 1) * size + n - 1], w = h[n * size + n - 1] * h[(n - 1) * size + n];
        if (iteration == MOST_ITERATIONS)
            return false;
        /* An exceptional shift breaks cycles. */
        if (iteration % 10 == 0 && iteration > 0) {
            shift += x;
            for (size_t i = 0; i <= n; i++)
                h[i * size + i] -= x;
            double s = fabs(h[n * size + n - 1]) + fabs(h[(n - 1) * size + n - 2]);
            x = y = 0.75 * s;
            w = -0.4375 * s * s;
        }
        iteration++;
        double_step(h, size, low, n, x, y, w);
    }
    return true;
}

bool eigenvalues(double *a, size_t size, double *real, double *imaginary)
{
    balance(a, size);
    hessenberg(a, size);
    if (!hessenberg_eigenvalues(a, size, real, imaginary))
        return false;
    /* Insertion sort by falling modulus; conjugates stay together, the positive imaginary part first. */
    for (size_t i = 1; i < size; i++) {
        double re = real[i], im = imaginary[i], modulus = hypot(re, im);
        size_t j = i;
        for (; j > 0 && hypot(real[j - 1], imaginary[j - 1]) < modulus; j--) {
            real[j] = real[j - 1];
            imaginary[j] = imaginary[j - 1];
        }
        real[j] = re;
        imaginary[j] = im;
    }
    return true;
}

double spectral_radius(double *a, size_t size, double *workspace)
{
    if (size == 0)
        return 0;
    if (!eigenvalues(a, size, workspace, workspace + size))
        return NAN;
    return hypot(workspace[0], workspace[size]);
}
