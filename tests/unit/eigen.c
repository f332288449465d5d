/* Eigenvalues of matrices whose spectrum is known: by construction from the roots, by similarity with integer
 * matrices that are exactly invertible, by Fourier, and through identities for trace and determinant. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "numeric/eigen.h"
#include "tap.h"

enum { MOST = 16 };

struct spectrum {
    double real[MOST], imaginary[MOST];
};

static uint64_t seed = 1;

static int integer_between(int low, int high)
{
    return low + (int)(random_bits(&seed) % (uint64_t)(high - low + 1));
}

static double number_between(double low, double high)
{
    return low + (high - low) * (double)(random_bits(&seed) >> 11) / 9007199254740992.0;
}

/* The largest distance in a matching of the two spectra, nearest first; greedy is right while the roots are
 * farther from each other than the errors. Also checks what is promised of the order. */
static double spectrum_distance(const struct spectrum *found, const struct spectrum *expected, size_t size)
{
    bool used[MOST] = {false};
    double worst = 0;
    for (size_t i = 0; i < size; i++) {
        size_t best = size;
        double nearest = INFINITY;
        for (size_t j = 0; j < size; j++) {
            double distance = hypot(found->real[j] - expected->real[i], found->imaginary[j] - expected->imaginary[i]);
            if (!used[j] && distance < nearest) {
                nearest = distance;
                best = j;
            }
        }
        if (best < size)
            used[best] = true;
        worst = fmax(worst, nearest);
    }
    return worst;
}

/* Falling moduli; complex ones in pairs, the positive imaginary part first. */
static bool spectrum_is_ordered(const struct spectrum *found, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        double modulus = hypot(found->real[i], found->imaginary[i]);
        if (i > 0 && modulus > hypot(found->real[i - 1], found->imaginary[i - 1]))
            return false;
        if (found->imaginary[i] > 0 && (i + 1 == size || found->real[i + 1] != found->real[i] ||
                                        found->imaginary[i + 1] != -found->imaginary[i]))
            return false;
        if (found->imaginary[i] < 0 && (i == 0 || found->imaginary[i - 1] != -found->imaginary[i]))
            return false;
    }
    return true;
}

/* Whether the eigenvalues of A are those expected, to `tolerance`; prints A if not. */
static bool spectrum_is(const double *a, size_t size, const struct spectrum *expected, double tolerance,
                        const char *what)
{
    double copy[MOST * MOST], workspace[2 * MOST];
    struct spectrum found = {{0}, {0}};
    memcpy(copy, a, size * size * sizeof *a);
    bool converged = eigenvalues(copy, size, found.real, found.imaginary);
    double distance = converged ? spectrum_distance(&found, expected, size) : INFINITY, radius = 0;
    for (size_t i = 0; i < size; i++)
        radius = fmax(radius, hypot(expected->real[i], expected->imaginary[i]));
    memcpy(copy, a, size * size * sizeof *a);
    double computed = spectral_radius(copy, size, workspace);
    if (distance <= tolerance && spectrum_is_ordered(&found, size) && fabs(computed - radius) <= tolerance)
        return true;
    note("%s: distance %g, tolerance %g; radius %.17g, expected %.17g", what, distance, tolerance, computed, radius);
    for (size_t i = 0; i < size; i++)
        note("found %.17g %+.17gi, expected %.17g %+.17gi", found.real[i], found.imaginary[i], expected->real[i],
             expected->imaginary[i]);
    for (size_t i = 0; i < size; i++) {
        printf("#");
        for (size_t j = 0; j < size; j++)
            printf(" %.17g", a[i * size + j]);
        putchar('\n');
    }
    return false;
}

/* A <- S A S^-1, S a product of integer shears: rows gain multiples of rows, columns lose them. Exact while the
 * entries stay below 2^53. */
static void shear(double *a, size_t size, int steps)
{
    for (int step = 0; step < steps && size > 1; step++) {
        size_t i = random_bits(&seed) % size, k = (i + 1 + random_bits(&seed) % (size - 1)) % size;
        double factor = integer_between(0, 1) ? 1 : -1;
        for (size_t j = 0; j < size; j++)
            a[i * size + j] += factor * a[k * size + j];
        for (size_t j = 0; j < size; j++)
            a[j * size + k] -= factor * a[j * size + i];
    }
}

static double norm(const double *a, size_t size)
{
    double sum = 0;
    for (size_t i = 0; i < size * size; i++)
        sum += a[i] * a[i];
    return sqrt(sum);
}

/* The companion matrix of Π (λ - r_i), r_i distinct multiples of 1/4. */
static void test_companion(void)
{
    bool good = true;
    for (long round = 0; round < test_effort(300); round++) {
        size_t size = 2 + random_bits(&seed) % 6;
        double a[MOST * MOST] = {0}, polynomial[MOST + 1] = {1};
        struct spectrum roots = {{0}, {0}};
        for (size_t i = 0; i < size; i++) {
            for (bool fresh = false; !fresh;) {
                roots.real[i] = integer_between(-8, 8) / 4.0;
                fresh = true;
                for (size_t j = 0; j < i; j++)
                    fresh = fresh && roots.real[j] != roots.real[i];
            }
            for (size_t k = i + 2; k-- > 1;)
                polynomial[k] -= roots.real[i] * polynomial[k - 1];
        }
        for (size_t i = 0; i < size; i++)
            a[i * size + size - 1] = -polynomial[size - i];
        for (size_t i = 1; i < size; i++)
            a[i * size + i - 1] = 1;
        /* Seven roots 1/4 apart: dr = eps |a_k| |r|^k / Π |r - r_j|, at most about 1e5 eps. */
        good = spectrum_is(a, size, &roots, 1e-9, "companion") && good;
    }
    ok(good, "companion matrices have the roots for eigenvalues");
}

/* Distinct integers and integer pairs a ± bi on the diagonal, hidden by shears. */
static void test_similar(void)
{
    bool good = true;
    for (long round = 0; round < test_effort(500); round++) {
        size_t size = 1 + random_bits(&seed) % 8;
        double a[MOST * MOST] = {0};
        struct spectrum roots = {{0}, {0}};
        for (size_t i = 0; i < size; i++) {
            roots.real[i] = 3.0 * (double)i - integer_between(5, 7);
            a[i * size + i] = roots.real[i];
            if (i + 1 < size && integer_between(0, 1)) {
                double b = integer_between(1, 4);
                a[(i + 1) * size + i + 1] = roots.real[i + 1] = roots.real[i];
                a[i * size + i + 1] = -b;
                a[(i + 1) * size + i] = b;
                roots.imaginary[i] = b;
                roots.imaginary[++i] = -b;
            }
        }
        shear(a, size, 3 * (int)size);
        /* The condition of an eigenvalue grows with the entries that the shears made: norm² covers it. */
        good = spectrum_is(a, size, &roots, 1e3 * DBL_EPSILON * (1 + norm(a, size) * norm(a, size)), "similar") && good;
    }
    ok(good, "eigenvalues, real and complex, behind similar transformations");
}

/* A Jordan block of size k moves by the k-th root of a relative error. */
static void test_defective(void)
{
    bool good = true;
    for (long round = 0; round < test_effort(300); round++) {
        size_t block = 2 + random_bits(&seed) % 3, size = block + random_bits(&seed) % 3;
        double a[MOST * MOST] = {0};
        struct spectrum roots = {{0}, {0}};
        for (size_t i = 0; i < size; i++) {
            roots.real[i] = i < block ? 1 : 4 + (double)i;
            a[i * size + i] = roots.real[i];
            if (i + 1 < block)
                a[i * size + i + 1] = 1;
        }
        shear(a, size, (int)size);
        double entries = norm(a, size), tolerance = 4 * entries * pow(10 * DBL_EPSILON * entries, 1.0 / (double)block);
        good = spectrum_is(a, size, &roots, tolerance, "Jordan block") && good;
    }
    ok(good, "defective matrices, to the root of the precision that is theirs");
}

/* A Jordan block of size 4 (λ = 1) behind a similarity; the shifted iteration takes 62 steps for its first pair,
 * 41 without exceptional shifts, 45 with one in every ten. */
static void test_slow(void)
{
    static const double block[] = {1, -1, 2, 0, 2, 0, 1, -2, 1, -1, 2, -1, 0, -1, 2, 1};
    double copy[16];
    struct spectrum found;
    memcpy(copy, block, sizeof copy);
    bool good = eigenvalues(copy, 4, found.real, found.imaginary);
    for (int i = 0; i < 4 && good; i++)
        good = hypot(found.real[i] - 1, found.imaginary[i]) < 1e-2;
    ok(good, "a Jordan block that takes many steps");
    /* Triangular after exchanging rows and columns, so 3, 2, 1 stand on its diagonal. Scaling alone cannot bring
     * its entries together; balancing as in the Handbook first moves such rows to the border. */
    double hidden[] = {3, 0, 0, 1e8, 1, 1e8, 1e8, 0, 2};
    good = eigenvalues(hidden, 3, found.real, found.imaginary);
    for (int i = 0; i < 3 && good; i++)
        good = hypot(found.real[i] - (3 - i), found.imaginary[i]) < 1e-6;
    ok(good, "a triangular matrix in disguise");
}

/* Whether no entry is zero, so that balancing can bring all of them to comparable sizes. */
static bool is_full(const double *a, size_t size)
{
    for (size_t i = 0; i < size * size; i++)
        if (a[i] == 0)
            return false;
    return true;
}

/* Rows and columns scaled by powers of two up to 2^±40, which is exact: balancing undoes it. */
static void test_scaled(void)
{
    bool good = true;
    for (long round = 0; round < test_effort(300); round++) {
        size_t size = 2 + random_bits(&seed) % 4;
        double a[MOST * MOST] = {0};
        int scale[MOST];
        struct spectrum roots = {{0}, {0}};
        for (size_t i = 0; i < size; i++) {
            roots.real[i] = a[i * size + i] = 1 + (double)i;
            scale[i] = integer_between(-40, 40);
        }
        while (!is_full(a, size))
            shear(a, size, 1);
        double tolerance = 1e3 * DBL_EPSILON * (1 + norm(a, size) * norm(a, size));
        for (size_t i = 0; i < size; i++)
            for (size_t j = 0; j < size; j++)
                a[i * size + j] = ldexp(a[i * size + j], scale[i] - scale[j]);
        good = spectrum_is(a, size, &roots, tolerance, "badly scaled") && good;
    }
    ok(good, "badly scaled matrices");
}

static void test_rotations(void)
{
    bool plane = true, space = true;
    for (long round = 0; round < test_effort(300); round++) {
        double angle = number_between(0.01, 3.13), r = number_between(0.1, 3), s = r * sin(angle), c = r * cos(angle);
        double flat[] = {c, -s, s, c};
        struct spectrum roots = {{c, c}, {s, -s}};
        plane = spectrum_is(flat, 2, &roots, 1e-14 * r, "rotation") && plane;
        /* About a random axis u: cos I + sin [u]x + (1 - cos) uu^T (Rodrigues). */
        double u[3] = {number_between(-1, 1), number_between(-1, 1), number_between(-1, 1)};
        double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]), solid[9];
        if (length < 0.1)
            continue;
        for (int i = 0; i < 3; i++)
            u[i] /= length;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                solid[3 * i + j] = (i == j ? cos(angle) : 0) + (1 - cos(angle)) * u[i] * u[j] +
                                   (i == j ? 0 : (j == (i + 1) % 3 ? -1 : 1) * sin(angle) * u[3 - i - j]);
        roots = (struct spectrum){{1, cos(angle), cos(angle)}, {0, sin(angle), -sin(angle)}};
        space = spectrum_is(solid, 3, &roots, 1e-13, "rotation in space") && space;
    }
    ok(plane, "rotations of the plane");
    ok(space, "rotations of space");
}

/* Circulant matrices: Σ c_k ω^jk. The cyclic shift alone stalls the QR iteration without exceptional shifts. */
static void test_circulant(void)
{
    const double turn = 2 * acos(-1);
    bool shifts = true, others = true;
    for (size_t size = 1; size <= MOST; size++) {
        for (long round = 0; round < test_effort(10); round++) {
            double c[MOST] = {0}, a[MOST * MOST], sum = 0;
            struct spectrum roots = {{0}, {0}};
            for (size_t k = 0; k < size; k++)
                c[k] = round == 0 ? k == 1 % size : number_between(-1, 1);
            for (size_t i = 0; i < size; i++)
                for (size_t j = 0; j < size; j++)
                    a[i * size + j] = c[(j + size - i) % size];
            for (size_t j = 0; j < size; j++)
                for (size_t k = 0; k < size; k++) {
                    double angle = turn * (double)(j * k % size) / (double)size;
                    roots.real[j] += c[k] * cos(angle);
                    roots.imaginary[j] += c[k] * sin(angle);
                }
            for (size_t k = 0; k < size; k++)
                sum += fabs(c[k]);
            bool good = spectrum_is(a, size, &roots, 1e-13 * sum * (double)size, "circulant");
            if (round == 0)
                shifts = good && shifts;
            else
                others = good && others;
        }
    }
    ok(shifts, "cyclic shifts have the roots of unity");
    ok(others, "circulant matrices have their Fourier transform");
}

/* Tridiagonal Toeplitz matrices: a + 2 sqrt(bc) cos(kπ/(n + 1)). */
static void test_toeplitz(void)
{
    bool good = true;
    for (size_t size = 1; size <= MOST; size++) {
        double diagonal = number_between(-1, 1), above = number_between(0.5, 2), below = number_between(0.5, 2);
        double a[MOST * MOST] = {0};
        struct spectrum roots = {{0}, {0}};
        for (size_t i = 0; i < size; i++) {
            a[i * size + i] = diagonal;
            if (i > 0)
                a[i * size + i - 1] = below, a[(i - 1) * size + i] = above;
            roots.real[i] = diagonal + 2 * sqrt(above * below) * cos(acos(-1) * (double)(i + 1) / (double)(size + 1));
        }
        /* Without balancing the condition would be (above/below)^(size/2). */
        good = spectrum_is(a, size, &roots, 1e-12, "Toeplitz") && good;
    }
    ok(good, "tridiagonal Toeplitz matrices");
}

/* Σ λ = tr A, Σ λ² = tr A², Π λ = det A by elimination without pivots on a dominant diagonal. */
static void test_identities(void)
{
    bool good = true;
    for (long round = 0; round < test_effort(500); round++) {
        size_t size = 1 + random_bits(&seed) % MOST;
        double a[MOST * MOST], lower[MOST * MOST], trace = 0, square = 0, determinant = 1;
        struct spectrum found;
        for (size_t i = 0; i < size * size; i++)
            a[i] = number_between(-1, 1);
        for (size_t i = 0; i < size; i++)
            a[i * size + i] += copysign((double)size, a[i * size + i]);
        memcpy(lower, a, sizeof a);
        for (size_t i = 0; i < size; i++) {
            trace += a[i * size + i];
            for (size_t j = 0; j < size; j++)
                square += a[i * size + j] * a[j * size + i];
            determinant *= lower[i * size + i];
            for (size_t k = i + 1; k < size; k++)
                for (size_t j = size; j-- > i;)
                    lower[k * size + j] -= lower[k * size + i] / lower[i * size + i] * lower[i * size + j];
        }
        double sum = 0, squares = 0, re = 1, im = 0, scale = norm(a, size);
        bool converged = eigenvalues(a, size, found.real, found.imaginary);
        for (size_t i = 0; i < size && converged; i++) {
            double x = found.real[i], y = found.imaginary[i], keep = re;
            sum += x;
            squares += x * x - y * y;
            re = keep * x - im * y;
            im = keep * y + im * x;
        }
        if (!converged || fabs(sum - trace) > 1e-13 * scale * (double)size ||
            fabs(squares - square) > 1e-12 * scale * scale || fabs(re - determinant) > 1e-11 * fabs(determinant) ||
            fabs(im) > 1e-11 * fabs(determinant)) {
            note("size %zu, round %ld: trace %g off, squares %g off, determinant %g relative", size, round,
                 fabs(sum - trace), fabs(squares - square), fabs(re / determinant - 1));
            good = false;
        }
    }
    ok(good, "trace, squares and determinant of random matrices");
}

static void test_edges(void)
{
    double zero[MOST * MOST] = {0}, real[MOST], imaginary[MOST], workspace[2 * MOST];
    bool good = eigenvalues(zero, 5, real, imaginary);
    for (int i = 0; i < 5; i++)
        good = good && real[i] == 0 && imaginary[i] == 0;
    ok(good, "the zero matrix");
    double one[] = {-2.5};
    ok(eigenvalues(one, 1, real, imaginary) && real[0] == -2.5 && imaginary[0] == 0, "one by one");
    ok(spectral_radius(one, 0, workspace) == 0, "nothing at all has radius 0");
    /* A nilpotent matrix of size n: 0 to the n-th root of the precision; triangular, so it is exact. */
    double nilpotent[] = {0, 1, 2, 0, 0, 3, 0, 0, 0};
    ok(spectral_radius(nilpotent, 3, workspace) == 0, "a nilpotent one has radius 0");
    double infinite[] = {1, INFINITY, 0, 1}, nan[] = {1, NAN, 2, 1};
    ok(!eigenvalues(infinite, 2, real, imaginary) && !eigenvalues(nan, 2, real, imaginary),
       "entries that are not finite are refused");
    double again[] = {1, INFINITY, 0, 1};
    ok(isnan(spectral_radius(again, 2, workspace)), "and have no radius");
    /* Chaikin's first map and its joint: 1, 1/2, 1/4 ([SI]: 1, 1 - a - b, a). The cubic B-spline's: 1/2^k. */
    double chaikin[] = {0.75, 0.25, 0, 0.25, 0.75, 0.75, 0, 0, 0.25};
    struct spectrum halves = {{1, 0.5, 0.25}, {0}};
    ok(spectrum_is(chaikin, 3, &halves, 4e-16, "Chaikin"), "Chaikin's map: 1, 1/2, 1/4");
    double cubic[] = {0.5, 0.125, 0, 0, 0.5, 0.75, 0.5, 0.125, 0, 0.125, 0.5, 0.75, 0, 0, 0, 0.125};
    struct spectrum eighths = {{1, 0.5, 0.25, 0.125}, {0}};
    ok(spectrum_is(cubic, 4, &eighths, 1e-15, "cubic"), "the cubic B-spline's: 1, 1/2, 1/4, 1/8");
    /* Sizes 1e±150 do not overflow on the way. */
    for (int exponent = -150; exponent <= 150; exponent += 300) {
        double scaled[4] = {0, -1, 1, 0}, factor = pow(10, exponent);
        for (int i = 0; i < 4; i++)
            scaled[i] *= factor;
        ok(fabs(spectral_radius(scaled, 2, workspace) / factor - 1) < 1e-14, "entries of size 1e%d", exponent);
    }
}

int main(void)
{
    test_companion();
    test_similar();
    test_defective();
    test_slow();
    test_scaled();
    test_rotations();
    test_circulant();
    test_toeplitz();
    test_identities();
    test_edges();
    return done_testing();
}
