/* Eigenvectors: A v = λ v for random matrices, one vector for each simple eigenvalue, fewer for defective ones. */
#include <math.h>

#include "analysis/spectrum.h"
#include "tap.h"

enum { MOST = 7 };

static double uniform(uint64_t *state)
{
    return (double)(random_bits(state) >> 11) / 9007199254740992.0 * 2 - 1;
}

static double residual(const double *a, size_t n, const struct spectrum *spectrum, size_t k)
{
    const double *v = spectrum->vectors[k];
    double largest = 0, re = spectrum->re[k], im = spectrum->im[k];
    for (size_t i = 0; i < n; i++) {
        double x = 0, y = 0;
        for (size_t j = 0; j < n; j++) {
            x += a[i * n + j] * v[j];
            y += a[i * n + j] * v[n + j];
        }
        largest = fmax(largest, hypot(x - (re * v[i] - im * v[n + i]), y - (re * v[n + i] + im * v[i])));
    }
    return largest;
}

int main(void)
{
    uint64_t state = 11;
    size_t missing = 0;
    double worst = 0;
    for (long trial = 0; trial < test_effort(300); trial++) {
        size_t n = 1 + random_bits(&state) % MOST;
        double a[MOST * MOST];
        struct arena arena = {0};
        struct spectrum spectrum;
        for (size_t i = 0; i < n * n; i++)
            a[i] = uniform(&state);
        bcifs_status status = spectrum_find(a, n, &arena, &spectrum);
        for (size_t k = 0; k < n && status == BCIFS_OK; k++) {
            missing += spectrum.vectors[k] == NULL;
            if (spectrum.vectors[k])
                worst = fmax(worst, residual(a, n, &spectrum, k));
        }
        missing += status != BCIFS_OK;
        arena_free(&arena);
    }
    ok(missing == 0, "random matrices have an eigenvector for each eigenvalue (%zu missing)", missing);
    ok(worst < 1e-7, "A v = λ v (off by %g)", worst);

    static const struct {
        const char *name;
        double matrix[9];
        size_t vectors;
    } cases[] = {{"a Jordan block of size 3", {2, 1, 0, 0, 2, 1, 0, 0, 2}, 1},
                 {"a block of size 2 and a simple eigenvalue", {2, 1, 0, 0, 2, 0, 0, 0, 1}, 2},
                 {"a multiple of the identity", {2, 0, 0, 0, 2, 0, 0, 0, 2}, 3},
                 {"a rotation about an axis", {0, -1, 0, 1, 0, 0, 0, 0, 1}, 3}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        struct arena arena = {0};
        struct spectrum spectrum;
        size_t found = 0;
        if (spectrum_find(cases[c].matrix, 3, &arena, &spectrum) == BCIFS_OK)
            for (size_t k = 0; k < spectrum.count; k++)
                found += spectrum.vectors[k] != NULL;
        ok(found == cases[c].vectors, "%s: %zu eigenvectors, found %zu", cases[c].name, cases[c].vectors, found);
        arena_free(&arena);
    }
    return done_testing();
}
