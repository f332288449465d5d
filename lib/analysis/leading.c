#include "leading.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "numeric/eigen.h"
#include "numeric/matrix.h"
#include "numeric/subspace.h"
#include "numeric/tolerance.h"

/* Eigenvalues that count as one: their mean, which rounding moves far less than each of them. */
struct cluster {
    double re, im;
    size_t count;
};

struct work {
    const double *m;
    size_t size;
    struct arena *arena;
    double *re, *im;
    struct cluster *clusters;
    size_t cluster_count;
    double scale; /* the largest modulus */
};

static double modulus(const struct cluster *cluster)
{
    return hypot(cluster->re, cluster->im);
}

/* The distance below which q eigenvalues may be one whose Jordan block has size q, split by rounding. */
static double cluster_radius(const struct work *work, size_t q)
{
    return TOLERANCE_CLUSTER * pow(1e-16, 1 / (double)q) * work->scale;
}

/* Makes a cluster of eigenvalue `first` and those near it when there are at least q. */
static void cluster_try(struct work *work, size_t first, size_t q, bool *taken)
{
    struct cluster cluster = {0, 0, 0};
    double radius = cluster_radius(work, q);
    for (size_t i = 0; i < work->size; i++)
        if (!taken[i] && hypot(work->re[i] - work->re[first], work->im[i] - work->im[first]) <= radius) {
            double share = 1 / (double)++cluster.count;
            cluster.re += share * (work->re[i] - cluster.re);
            cluster.im += share * (work->im[i] - cluster.im);
        }
    if (cluster.count < q)
        return;
    for (size_t i = 0; i < work->size; i++)
        taken[i] = taken[i] || hypot(work->re[i] - work->re[first], work->im[i] - work->im[first]) <= radius;
    if (fabs(cluster.im) <= TOLERANCE_TIED * work->scale)
        cluster.im = 0;
    /* A pair is represented by its upper half. */
    if (cluster.im >= 0)
        work->clusters[work->cluster_count++] = cluster;
}

/* Groups the eigenvalues: large groups first, because what splits a large block splits it further. */
static bcifs_status cluster_eigenvalues(struct work *work)
{
    bool *taken = arena_new(work->arena, work->size, sizeof *taken);
    if (!taken)
        return BCIFS_MEMORY;
    for (size_t q = work->size; q > 0; q--)
        for (size_t i = 0; i < work->size; i++)
            if (!taken[i])
                cluster_try(work, i, q, taken);
    return BCIFS_OK;
}

/* (M - λ)^power for real λ, or ((M - re)² + im²)^power for a pair. */
static double *shifted_power(const struct work *work, const struct cluster *cluster, size_t power)
{
    size_t size = work->size, count = size * size;
    double *shifted = arena_grow(work->arena, work->m, count, count, sizeof *shifted);
    double *result = arena_new(work->arena, count, sizeof *result);
    double *next = arena_new(work->arena, count, sizeof *next);
    if (!shifted || !result || !next)
        return NULL;
    for (size_t i = 0; i < size; i++) {
        shifted[i * size + i] -= cluster->re;
        result[i * size + i] = 1;
    }
    if (cluster->im != 0) {
        matrix_multiply(shifted, shifted, size, size, size, next);
        memcpy(shifted, next, count * sizeof *next);
        for (size_t i = 0; i < size; i++)
            shifted[i * size + i] += cluster->im * cluster->im;
    }
    for (size_t k = 0; k < power; k++) {
        matrix_multiply(result, shifted, size, size, size, next);
        memcpy(result, next, count * sizeof *next);
    }
    return result;
}

static double largest_entry(const double *m, size_t count)
{
    double largest = 0;
    for (size_t i = 0; i < count; i++)
        largest = fmax(largest, fabs(m[i]));
    return largest;
}

/* An orthonormal basis of the null space of (M - λ)^power, or of its transpose; its dimension in `count`. */
static double *power_null(const struct work *work, const struct cluster *cluster, size_t power,
                          bool transposed, size_t *count)
{
    size_t size = work->size;
    double *a = shifted_power(work, cluster, power);
    double *null = arena_new(work->arena, size * size, sizeof *null);
    double *workspace = arena_new(work->arena, size, sizeof *workspace);
    size_t *order = arena_new(work->arena, size, sizeof *order);
    if (!a || !null || !workspace || !order)
        return NULL;
    for (size_t i = 0; i < size && transposed; i++)
        for (size_t j = 0; j < i; j++) {
            double keep = a[i * size + j];
            a[i * size + j] = a[j * size + i];
            a[j * size + i] = keep;
        }
    double unit = pow(work->scale, (double)(power * (cluster->im != 0 ? 2 : 1)));
    double tolerance = TOLERANCE_NULL * fmax(unit, largest_entry(a, size * size));
    *count = null_space(a, size, size, tolerance, null, order, workspace);
    return null;
}

/* The size q of the largest Jordan block: null spaces of powers grow until then. */
static bcifs_status largest_block(const struct work *work, const struct cluster *cluster, size_t *block)
{
    size_t wanted = cluster->count * (cluster->im != 0 ? 2 : 1), count = 0;
    *block = 0;
    while (count < wanted && *block < cluster->count) {
        ++*block;
        if (!power_null(work, cluster, *block, false, &count))
            return BCIFS_MEMORY;
    }
    return BCIFS_OK;
}

/* P = R (SᵀR)⁻¹ Sᵀ with R, S bases of the right and left generalized eigenspaces (rows of `right`, `left`).
 */
static bcifs_status projector(const struct work *work, const double *right, const double *left, size_t count,
                              double *p)
{
    size_t size = work->size;
    double *gram = arena_new(work->arena, count * count, sizeof *gram);
    double *column = arena_new(work->arena, count, sizeof *column);
    size_t *order = arena_new(work->arena, count, sizeof *order);
    if (!gram || !column || !order)
        return BCIFS_MEMORY;
    for (size_t j = 0; j < size; j++) {
        for (size_t a = 0; a < count; a++) {
            column[a] = left[a * size + j];
            for (size_t b = 0; b < count; b++) {
                gram[a * count + b] = 0;
                for (size_t i = 0; i < size; i++)
                    gram[a * count + b] += left[a * size + i] * right[b * size + i];
            }
        }
        if (!matrix_solve(gram, column, count, order))
            return BCIFS_INPUT;
        for (size_t i = 0; i < size; i++) {
            p[i * size + j] = 0;
            for (size_t b = 0; b < count; b++)
                p[i * size + j] += right[b * size + i] * column[b];
        }
    }
    return BCIFS_OK;
}

/* K = (M - λ)^(q-1) P. */
static bcifs_status leading_matrix(const struct work *work, const struct cluster *cluster, size_t block,
                                   double **k)
{
    size_t size = work->size, right_count, left_count;
    double *right = power_null(work, cluster, block, false, &right_count);
    double *left = power_null(work, cluster, block, true, &left_count);
    double *p = arena_new(work->arena, size * size, sizeof *p);
    double *power = shifted_power(work, cluster, block - 1);
    *k = arena_new(work->arena, size * size, sizeof **k);
    if (!right || !left || !p || !power || !*k)
        return BCIFS_MEMORY;
    if (right_count != left_count || right_count == 0)
        return BCIFS_INPUT;
    bcifs_status status = projector(work, right, left, right_count, p);
    if (status == BCIFS_OK)
        matrix_multiply(power, p, size, size, size, *k);
    return status;
}

/* K = v ℓ when its rank is 1: v is its largest column, ℓ the row of coefficients. */
static bcifs_status split_rank_one(const struct work *work, const double *k, struct leading *leading)
{
    size_t size = work->size, best = 0;
    double longest = 0;
    leading->direction = arena_new(work->arena, size, sizeof(double));
    leading->functional = arena_new(work->arena, size, sizeof(double));
    if (!leading->direction || !leading->functional)
        return BCIFS_MEMORY;
    for (size_t j = 0; j < size; j++) {
        double sum = 0;
        for (size_t i = 0; i < size; i++)
            sum += k[i * size + j] * k[i * size + j];
        if (sum > longest) {
            longest = sum;
            best = j;
        }
    }
    for (size_t i = 0; i < size; i++)
        leading->direction[i] = k[i * size + best] / sqrt(longest);
    double remainder = 0;
    for (size_t j = 0; j < size; j++) {
        for (size_t i = 0; i < size; i++)
            leading->functional[j] += leading->direction[i] * k[i * size + j];
        for (size_t i = 0; i < size; i++)
            remainder =
                fmax(remainder, fabs(k[i * size + j] - leading->direction[i] * leading->functional[j]));
    }
    leading->kind = remainder <= TOLERANCE_DIRECTION * sqrt(longest) ? LEADING_SETTLES : LEADING_FANS;
    return BCIFS_OK;
}

/* Among the clusters of largest modulus, those with the largest block decide. */
static bcifs_status choose(struct work *work, struct leading *leading)
{
    const struct cluster *chosen = NULL;
    double top = 0;
    for (size_t k = 0; k < work->cluster_count; k++)
        top = fmax(top, modulus(&work->clusters[k]));
    leading->kind = LEADING_UNKNOWN;
    for (size_t k = 0; k < work->cluster_count; k++) {
        const struct cluster *cluster = &work->clusters[k];
        size_t block;
        if (modulus(cluster) < top * (1 - TOLERANCE_TIED))
            continue;
        bcifs_status status = largest_block(work, cluster, &block);
        if (status)
            return status;
        if (chosen && block == leading->block)
            leading->kind = LEADING_TIED;
        if (chosen && block <= leading->block)
            continue;
        chosen = cluster;
        *leading = (struct leading){.kind = cluster->im != 0  ? LEADING_SPIRALS
                                            : cluster->re < 0 ? LEADING_NEGATIVE
                                                              : LEADING_SETTLES,
                                    .re = cluster->re,
                                    .im = cluster->im,
                                    .multiplicity = cluster->count,
                                    .block = block};
    }
    if (leading->kind != LEADING_SETTLES)
        return BCIFS_OK;
    double *k;
    bcifs_status status = leading_matrix(work, chosen, leading->block, &k);
    if (status == BCIFS_INPUT) {
        leading->kind = LEADING_UNKNOWN;
        return BCIFS_OK;
    }
    return status ? status : split_rank_one(work, k, leading);
}

bcifs_status leading_find(const double *m, size_t size, struct arena *arena, struct leading *leading)
{
    struct work work = {.m = m, .size = size, .arena = arena};
    double *copy = arena_grow(arena, m, size * size, size * size, sizeof *copy);
    work.re = arena_new(arena, size, sizeof *work.re);
    work.im = arena_new(arena, size, sizeof *work.im);
    work.clusters = arena_new(arena, size, sizeof *work.clusters);
    *leading = (struct leading){.kind = LEADING_UNKNOWN};
    if (!copy || !work.re || !work.im || !work.clusters)
        return BCIFS_MEMORY;
    if (size == 0) {
        leading->kind = LEADING_VANISHES;
        return BCIFS_OK;
    }
    double entries = largest_entry(m, size * size);
    if (!eigenvalues(copy, size, work.re, work.im))
        return BCIFS_OK;
    work.scale = hypot(work.re[0], work.im[0]);
    /* A nilpotent matrix has eigenvalues that are rounding only, spread by its block size. */
    if (work.scale <= pow(TOLERANCE_NILPOTENT, 1 / (double)size) * entries) {
        double *power = shifted_power(&work, &(struct cluster){0, 0, 0}, size);
        if (!power)
            return BCIFS_MEMORY;
        if (largest_entry(power, size * size) <= TOLERANCE_NILPOTENT * pow(entries, (double)size)) {
            leading->kind = LEADING_VANISHES;
            return BCIFS_OK;
        }
    }
    bcifs_status status = cluster_eigenvalues(&work);
    return status ? status : choose(&work, leading);
}
