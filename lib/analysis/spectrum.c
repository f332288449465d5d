#include "spectrum.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "numeric/eigen.h"
#include "numeric/subspace.h"
#include "numeric/tolerance.h"

struct work {
    const double *matrix;
    size_t size;
    struct arena *arena;
    double *re, *im, **vectors;
    double scale; /* the largest modulus */
};

/* Replaces groups of eigenvalues that are one by their mean; they are neighbors, being sorted by modulus. */
static void merge(struct work *work)
{
    for (size_t first = 0, last; first < work->size; first = last) {
        double sum = work->re[first];
        for (last = first + 1;
             last < work->size && fabs(work->re[last] - work->re[first]) <= TOLERANCE_DOUBLE * work->scale &&
             fabs(work->im[last]) <= TOLERANCE_DOUBLE * work->scale &&
             fabs(work->im[first]) <= TOLERANCE_DOUBLE * work->scale;
             last++)
            sum += work->re[last];
        for (size_t k = first; k < last; k++) {
            if (fabs(work->im[k]) <= TOLERANCE_DOUBLE * work->scale) {
                work->re[k] = sum / (double)(last - first);
                work->im[k] = 0;
            }
        }
    }
}

/* (A - re) x + im y = 0, (A - re) y - im x = 0 for the eigenvector x + i y; `null` receives an orthonormal
 * basis of the solutions (x, y), or of those with y = 0 when the eigenvalue is real. Returns their number. */
static size_t eigenspace(const struct work *work, double re, double im, double *null)
{
    size_t m = work->size, n = im == 0 ? m : 2 * m;
    double *a = arena_new(work->arena, n * n, sizeof *a);
    double *workspace = arena_new(work->arena, n, sizeof *workspace);
    size_t *order = arena_new(work->arena, n, sizeof *order);
    if (!a || !workspace || !order)
        return SIZE_MAX;
    for (size_t block = 0; block < n / m; block++)
        for (size_t i = 0; i < m; i++) {
            for (size_t j = 0; j < m; j++)
                a[(block * m + i) * n + block * m + j] = work->matrix[i * m + j] - (i == j ? re : 0);
            if (im != 0)
                a[(block * m + i) * n + (1 - block) * m + i] = block ? -im : im;
        }
    return null_space(a, n, n, TOLERANCE_NULL * fmax(1, work->scale), null, order, workspace);
}

/* Whether A v = λ v, up to the tolerance. */
static bool residual_is_small(const struct work *work, double re, double im, const double *vector)
{
    size_t m = work->size;
    double largest = 0;
    for (size_t i = 0; i < m; i++) {
        double x = im * vector[m + i] - re * vector[i], y = -im * vector[i] - re * vector[m + i];
        for (size_t j = 0; j < m; j++) {
            x += work->matrix[i * m + j] * vector[j];
            y += work->matrix[i * m + j] * vector[m + j];
        }
        largest = fmax(largest, hypot(x, y));
    }
    return largest <= TOLERANCE_DIRECTION * fmax(1, work->scale);
}

/* The fixed point of a barycentric map sums to 1; other vectors keep their length 1, with a sign that is
 * always the same: the largest coordinate is positive. */
static void normalize(double *vector, size_t size, double re, double im)
{
    double sum = 0, factor = 1, largest = 0;
    for (size_t i = 0; i < size; i++) {
        sum += vector[i];
        if (fabs(vector[i]) > fabs(largest) * (1 + 1e-9))
            largest = vector[i];
    }
    bool fixed = im == 0 && fabs(re - 1) <= TOLERANCE_DOUBLE && fabs(sum) > TOLERANCE_NULL;
    factor = fixed ? 1 / sum : largest < 0 ? -1 : 1;
    for (size_t i = 0; i < 2 * size; i++)
        vector[i] = vector[i] * factor + 0; /* -0 becomes 0 */
}

/* The vectors of the eigenvalues first … last - 1, which are equal. */
static bcifs_status vectors_find(struct work *work, size_t first, size_t last)
{
    size_t m = work->size, n = work->im[first] == 0 ? m : 2 * m;
    double *null = arena_new(work->arena, n * n, sizeof *null);
    if (!null)
        return BCIFS_MEMORY;
    size_t found = eigenspace(work, work->re[first], work->im[first], null);
    if (found == SIZE_MAX)
        return BCIFS_MEMORY;
    for (size_t k = first; k < last && k - first < found; k++) {
        double *vector = arena_new(work->arena, 2 * m, sizeof *vector);
        if (!vector)
            return BCIFS_MEMORY;
        memcpy(vector, null + (k - first) * n, n * sizeof *vector);
        if (!residual_is_small(work, work->re[k], work->im[k], vector))
            continue;
        normalize(vector, m, work->re[k], work->im[k]);
        work->vectors[k] = vector;
    }
    return BCIFS_OK;
}

bcifs_status spectrum_find(const double *matrix, size_t size, struct arena *arena, struct spectrum *spectrum)
{
    struct work work = {.matrix = matrix, .size = size, .arena = arena};
    double *copy = arena_grow(arena, matrix, size * size, size * size, sizeof *copy);
    work.re = arena_new(arena, size, sizeof *work.re);
    work.im = arena_new(arena, size, sizeof *work.im);
    work.vectors = arena_new(arena, size, sizeof *work.vectors);
    *spectrum = (struct spectrum){0};
    if (!copy || !work.re || !work.im || !work.vectors)
        return BCIFS_MEMORY;
    if (size == 0 || !eigenvalues(copy, size, work.re, work.im))
        return BCIFS_OK;
    work.scale = hypot(work.re[0], work.im[0]);
    merge(&work);
    for (size_t first = 0, last; first < size; first = last) {
        last = first + 1;
        while (last < size && work.re[last] == work.re[first] && work.im[last] == work.im[first])
            last++;
        bcifs_status status = vectors_find(&work, first, last);
        if (status)
            return status;
    }
    *spectrum = (struct spectrum){work.re, work.im, work.vectors, size};
    return BCIFS_OK;
}
