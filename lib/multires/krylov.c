#include "krylov.h"

#include <math.h>
#include <string.h>

#include "numeric/tolerance.h"

bool krylov_make(struct krylov *space, const struct sparse_cholesky *factor, const struct sparse *skew,
                 size_t most, struct arena *arena)
{
    *space = (struct krylov){.factor = factor, .skew = skew, .size = skew->rows, .most = most};
    space->basis = arena_new(arena, most, space->size * sizeof *space->basis);
    space->images = arena_new(arena, most, most * sizeof *space->images);
    space->vector = arena_new(arena, space->size, sizeof *space->vector);
    space->workspace = arena_new(arena, space->size, sizeof *space->workspace);
    return space->basis && space->images && space->vector && space->workspace;
}

void krylov_fill(struct krylov *space)
{
    space->count = space->size;
    for (size_t i = 0; i < space->size; i++)
        space->basis[i * space->size + i] = 1;
}

/* Four sums, or the additions would wait for each other. */
static double dot(const double *a, const double *b, size_t size)
{
    double sums[4] = {0};
    size_t i = 0;
    for (; i + 4 <= size; i += 4) {
        sums[0] += a[i] * b[i];
        sums[1] += a[i + 1] * b[i + 1];
        sums[2] += a[i + 2] * b[i + 2];
        sums[3] += a[i + 3] * b[i + 3];
    }
    for (; i < size; i++)
        sums[0] += a[i] * b[i];
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/* v <- v - U (U^T v), twice where the first time left little (Kahan, Parlett); the shares are added to
 * `shares`, `stride` apart (NULL: not wanted). Returns |v|. */
static double orthogonalize(const struct krylov *space, double *v, double *shares, size_t stride)
{
    size_t size = space->size;
    double before = sqrt(dot(v, v, size)), after = before;
    for (int round = 0; round < 2; round++) {
        for (size_t k = 0; k < space->count; k++) {
            const double *u = space->basis + k * size;
            double share = dot(u, v, size);
            for (size_t i = 0; i < size; i++)
                v[i] -= share * u[i];
            if (shares)
                shares[k * stride] += share;
        }
        after = sqrt(dot(v, v, size));
        if (after > 0.7 * before)
            break;
    }
    return after;
}

static void append(struct krylov *space, const double *v, double norm)
{
    double *u = space->basis + space->count++ * space->size;
    for (size_t i = 0; i < space->size; i++)
        u[i] = v[i] / norm;
}

void krylov_add(struct krylov *space, double *vector)
{
    double before = sqrt(dot(vector, vector, space->size)), after = orthogonalize(space, vector, NULL, 0);
    if (space->count < space->most && after > TOLERANCE_KRYLOV * before)
        append(space, vector, after);
}

/* w = A u_j */
static void image_of(struct krylov *space, size_t j, double *w)
{
    double *u = space->workspace;
    memcpy(w, space->basis + j * space->size, space->size * sizeof *w);
    sparse_cholesky_upper(space->factor, w, 1, u);
    sparse_apply(space->skew, w, 1, false, u);
    memcpy(w, u, space->size * sizeof *w);
    sparse_cholesky_lower(space->factor, w, 1, u);
}

void krylov_grow(struct krylov *space, size_t count)
{
    double *w = space->vector;
    count = count < space->most ? count : space->most;
    while (space->count < count && space->expanded < space->count) {
        size_t j = space->expanded++;
        double *shares = space->images + j;
        image_of(space, j, w);
        for (size_t i = 0; i < space->most; i++)
            shares[i * space->most] = 0;
        space->largest = fmax(space->largest, sqrt(dot(w, w, space->size)));
        double rest = orthogonalize(space, w, shares, space->most);
        if (rest > TOLERANCE_KRYLOV * space->largest) {
            shares[space->count * space->most] = rest;
            append(space, w, rest);
        }
    }
}

void krylov_project(struct krylov *space, double *c)
{
    size_t count = space->count, most = space->most;
    for (size_t j = space->expanded; j < count; j++) {
        image_of(space, j, space->vector);
        for (size_t i = 0; i < count; i++)
            space->images[i * most + j] = dot(space->basis + i * space->size, space->vector, space->size);
    }
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < count; j++)
            c[i * count + j] = (space->images[i * most + j] - space->images[j * most + i]) / 2;
}
