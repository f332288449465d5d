/* What powers of a matrix do: matrices S J S^-1 with a chosen Jordan form J and a random S of known inverse. */
#include <math.h>
#include <string.h>

#include "analysis/leading.h"
#include "numeric/matrix.h"
#include "tap.h"

enum { MOST = 6 };

static double uniform(uint64_t *state)
{
    return (double)(random_bits(state) >> 11) / 9007199254740992.0 * 2 - 1;
}

/* S is a product of elementary shears, its inverse the product of their inverses in reverse. */
static void random_similarity(size_t n, uint64_t *state, double *s, double *inverse)
{
    memset(s, 0, n * n * sizeof *s);
    memset(inverse, 0, n * n * sizeof *inverse);
    for (size_t i = 0; i < n; i++)
        s[i * n + i] = inverse[i * n + i] = 1;
    for (int k = 0; k < 12 && n > 1; k++) {
        size_t i = random_bits(state) % n, j = (i + 1 + random_bits(state) % (n - 1)) % n;
        double f = 0.7 * uniform(state);
        for (size_t c = 0; c < n; c++)
            s[i * n + c] += f * s[j * n + c];
        for (size_t r = 0; r < n; r++)
            inverse[r * n + j] -= f * inverse[r * n + i];
    }
}

struct jordan {
    const char *name;
    size_t size;
    double form[MOST * MOST];
    enum leading_kind kind;
    double re, im;
    size_t multiplicity, block;
};

static const struct jordan cases[] = {
    {"simple", 3, {0.5, 0, 0, 0, 0.25, 0, 0, 0, -0.3}, LEADING_SETTLES, 0.5, 0, 1, 1},
    {"a block of size 2", 3, {0.5, 1, 0, 0, 0.5, 0, 0, 0, 0.1}, LEADING_SETTLES, 0.5, 0, 2, 2},
    {"a block of size 3", 3, {0.5, 1, 0, 0, 0.5, 1, 0, 0, 0.5}, LEADING_SETTLES, 0.5, 0, 3, 3},
    {"a block of size 2 beside one of size 1", 3, {0.5, 1, 0, 0, 0.5, 0, 0, 0, 0.5}, LEADING_SETTLES, 0.5, 0, 3, 2},
    {"two eigenvectors", 3, {0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.1}, LEADING_FANS, 0.5, 0, 2, 1},
    {"two blocks of size 2", 4, {0.5, 1, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 1, 0, 0, 0, 0.5}, LEADING_FANS, 0.5, 0, 4, 2},
    {"negative", 2, {-0.5, 0, 0, 0.25}, LEADING_NEGATIVE, -0.5, 0, 1, 1},
    {"opposite signs", 2, {-0.5, 0, 0, 0.5}, LEADING_TIED, 0, 0, 0, 1},
    {"a longer block beats the opposite sign", 3, {0.5, 1, 0, 0, 0.5, 0, 0, 0, -0.5}, LEADING_SETTLES, 0.5, 0, 2, 2},
    {"complex", 3, {0.3, -0.4, 0, 0.4, 0.3, 0, 0, 0, 0.2}, LEADING_SPIRALS, 0.3, 0.4, 1, 1},
    {"complex beside a real one of the same modulus",
     3,
     {0.3, -0.4, 0, 0.4, 0.3, 0, 0, 0, 0.5},
     LEADING_TIED,
     0,
     0,
     0,
     1},
    {"nilpotent", 3, {0, 1, 0, 0, 0, 1, 0, 0, 0}, LEADING_VANISHES, 0, 0, 0, 0},
};

/* M^n u for large n points along v times the sign of ℓ·u: the definition, by repeated multiplication. */
static double direction_error(const double *m, size_t n, const struct leading *leading, uint64_t *state)
{
    double u[MOST], next[MOST], sign = 0, length, error = 0;
    for (size_t i = 0; i < n; i++)
        u[i] = uniform(state);
    for (size_t i = 0; i < n; i++)
        sign += leading->functional[i] * u[i];
    for (int k = 0; k < 20000; k++) {
        matrix_multiply(m, u, n, n, 1, next);
        length = 0;
        for (size_t i = 0; i < n; i++)
            length += next[i] * next[i];
        for (size_t i = 0; i < n; i++)
            u[i] = next[i] / sqrt(length);
    }
    for (size_t i = 0; i < n; i++)
        error = fmax(error, fabs(u[i] - copysign(leading->direction[i], leading->direction[i] * sign)));
    return fabs(sign) < 1e-3 ? 0 : error;
}

int main(void)
{
    uint64_t state = 7;
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        const struct jordan *jordan = &cases[c];
        size_t n = jordan->size, wrong = 0;
        double worst = 0, worst_direction = 0;
        for (int trial = 0; trial < 20; trial++) {
            double s[MOST * MOST], inverse[MOST * MOST], half[MOST * MOST], m[MOST * MOST];
            struct arena arena = {0};
            struct leading leading;
            random_similarity(n, &state, s, inverse);
            matrix_multiply(s, jordan->form, n, n, n, half);
            matrix_multiply(half, inverse, n, n, n, m);
            if (leading_find(m, n, &arena, &leading) != BCIFS_OK || leading.kind != jordan->kind)
                wrong++;
            else if (jordan->multiplicity > 0) {
                worst = fmax(worst, hypot(leading.re - jordan->re, leading.im - jordan->im));
                wrong += leading.multiplicity != jordan->multiplicity || leading.block != jordan->block;
                if (leading.kind == LEADING_SETTLES)
                    worst_direction = fmax(worst_direction, direction_error(m, n, &leading, &state));
            }
            arena_free(&arena);
        }
        ok(wrong == 0, "%s: kind, multiplicity and block (%zu of 20 wrong)", jordan->name, wrong);
        ok(worst < 1e-10, "%s: the eigenvalue (off by %g)", jordan->name, worst);
        /* Jordan blocks converge like 1/n: 20000 steps leave about 1e-3. */
        ok(worst_direction < (jordan->block > 1 ? 5e-3 : 1e-9), "%s: the direction of M^n u (off by %g)", jordan->name,
           worst_direction);
    }
    return done_testing();
}
