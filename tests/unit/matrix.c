/* Matrices: products and solutions with integers, where everything is exact; fixed points against cofactors. */
#include <math.h>
#include <string.h>

#include "numeric/matrix.h"
#include "tap.h"

enum { MOST = 12 };

static uint64_t seed = 1;

static double integer_between(int low, int high)
{
    return low + (double)(random_bits(&seed) % (uint64_t)(high - low + 1));
}

static void integers_fill(double *a, size_t count, int most)
{
    for (size_t i = 0; i < count; i++)
        a[i] = integer_between(-most, most);
}

static void print(const char *name, const double *a, size_t rows, size_t columns)
{
    for (size_t i = 0; i < rows; i++) {
        printf("# %s", name);
        for (size_t j = 0; j < columns; j++)
            printf(" %.17g", a[i * columns + j]);
        putchar('\n');
    }
}

/* (A·B)·C = A·(B·C), and entries of A·B one by one; integers below 2^53 are exact in any order. */
static void test_multiply(void)
{
    bool entries = true, associative = true;
    for (long round = 0; round < test_effort(300); round++) {
        size_t n[4];
        double a[MOST * MOST], b[MOST * MOST], c[MOST * MOST], ab[MOST * MOST], bc[MOST * MOST], left[MOST * MOST],
            right[MOST * MOST];
        for (int i = 0; i < 4; i++)
            n[i] = 1 + random_bits(&seed) % MOST;
        integers_fill(a, n[0] * n[1], 1000);
        integers_fill(b, n[1] * n[2], 1000);
        integers_fill(c, n[2] * n[3], 1000);
        memset(ab, 0xff, sizeof ab); /* what was there must not count */
        matrix_multiply(a, b, n[0], n[1], n[2], ab);
        matrix_multiply(b, c, n[1], n[2], n[3], bc);
        matrix_multiply(ab, c, n[0], n[2], n[3], left);
        matrix_multiply(a, bc, n[0], n[1], n[3], right);
        for (size_t i = 0; i < n[0]; i++)
            for (size_t j = 0; j < n[2]; j++) {
                int64_t sum = 0;
                for (size_t k = 0; k < n[1]; k++)
                    sum += (int64_t)a[i * n[1] + k] * (int64_t)b[k * n[2] + j];
                entries = entries && ab[i * n[2] + j] == (double)sum;
            }
        associative = associative && memcmp(left, right, n[0] * n[3] * sizeof *left) == 0;
    }
    ok(entries, "entries of products");
    ok(associative, "(AB)C = A(BC)");
}

/* A x = b for integer A and x, b = A x exactly. A with a heavy diagonal, its rows then shuffled, is well
 * conditioned: (|A| times the inverse's norm) stays below about 100. */
static void test_solve(void)
{
    bool good = true;
    for (long round = 0; round < test_effort(500); round++) {
        size_t size = 1 + random_bits(&seed) % MOST, order[MOST];
        double a[MOST * MOST], copy[MOST * MOST], x[MOST], b[MOST];
        double scale = ldexp(1, (int)(random_bits(&seed) % 1200) - 600);
        integers_fill(a, size * size, 9);
        integers_fill(x, size, 1000);
        for (size_t i = 0; i < size; i++)
            a[i * size + i] = copysign(10.0 * (double)size, integer_between(-1, 0));
        for (size_t i = size; i-- > 1;) {
            size_t k = random_bits(&seed) % (i + 1);
            for (size_t j = 0; j < size; j++) {
                double keep = a[i * size + j];
                a[i * size + j] = a[k * size + j];
                a[k * size + j] = keep;
            }
        }
        memcpy(copy, a, sizeof a);
        matrix_multiply(a, x, size, size, 1, b);
        /* Powers of two change no bit of the solution. */
        for (size_t i = 0; i < size * size; i++)
            a[i] *= scale;
        for (size_t i = 0; i < size; i++)
            b[i] *= scale;
        bool solved = matrix_solve(a, b, size, order);
        double error = 0;
        for (size_t i = 0; i < size; i++)
            error = fmax(error, fabs(b[i] - x[i]));
        if (!solved || !(error <= 1e-11)) {
            note("error %g, scale %g", error, scale);
            print("A", copy, size, size);
            good = false;
        }
    }
    ok(good, "linear systems with integer solutions, at any scale");
}

/* Products of thinner matrices have no full rank. */
static void test_singular(void)
{
    bool good = true;
    for (long round = 0; round < test_effort(300); round++) {
        size_t size = 2 + random_bits(&seed) % (MOST - 1), rank = random_bits(&seed) % size, order[MOST];
        double u[MOST * MOST], v[MOST * MOST], a[MOST * MOST] = {0}, b[MOST];
        integers_fill(u, size * rank, 9);
        integers_fill(v, rank * size, 9);
        if (rank > 0)
            matrix_multiply(u, v, size, rank, size, a);
        integers_fill(b, size, 9);
        if (matrix_solve(a, b, size, order)) {
            note("size %zu, rank %zu", size, rank);
            good = false;
        }
    }
    ok(good, "singular matrices are found out");
}

/* ---- Fixed points -------------------------------------------------------------------------------------- */

/* The determinant of an integer matrix by expansion along its first row; all products fit 53 bits here. */
static int64_t determinant(const int64_t *a, size_t size)
{
    int64_t minor[25], sum = 0;
    if (size == 0)
        return 1;
    for (size_t column = 0; column < size; column++) {
        for (size_t i = 1; i < size; i++)
            for (size_t j = 0, k = 0; j < size; j++)
                if (j != column)
                    minor[(i - 1) * (size - 1) + k++] = a[i * size + j];
        sum += (column % 2 ? -1 : 1) * a[column] * determinant(minor, size - 1);
    }
    return sum;
}

/* T = A/d with columns of A summing to d. All columns of adj(A - dI) are multiples of the fixed point, so its
 * coordinates are the cofactors of the first row divided by their sum. */
static bool fixed_point_check(const int64_t *a, int64_t d, size_t size, double tolerance, double *worst)
{
    double t[36], point[6], workspace[6 * 6 + 2 * 6], expected[6];
    int64_t minor[25], cofactors[6], sum = 0, largest = 0;
    size_t order[6];
    for (size_t column = 0; column < size; column++) {
        for (size_t i = 1; i < size; i++)
            for (size_t j = 0, k = 0; j < size; j++)
                if (j != column)
                    minor[(i - 1) * (size - 1) + k++] = a[i * size + j] - (i == j ? d : 0);
        cofactors[column] = (column % 2 ? -1 : 1) * determinant(minor, size - 1);
        sum += cofactors[column];
        largest = llabs(cofactors[column]) > largest ? llabs(cofactors[column]) : largest;
    }
    /* A sum near zero is a matrix near one without a single fixed point, where no digits can be promised. */
    if (sum == 0 || 100 * llabs(sum) < largest)
        return true;
    for (size_t i = 0; i < size * size; i++)
        t[i] = (double)a[i] / (double)d;
    double error = 0, norm = 0;
    bool found = matrix_fixed_point(t, size, point, workspace, order);
    for (size_t i = 0; i < size; i++) {
        expected[i] = (double)cofactors[i] / (double)sum;
        error = fmax(error, fabs(point[i] - expected[i]));
        norm = fmax(norm, fabs(expected[i]));
    }
    *worst = fmax(*worst, error / norm);
    if (found && error <= tolerance * norm)
        return true;
    note("error %g of %g", error, norm);
    print("T", t, size, size);
    print("expected", expected, 1, size);
    print("found", point, 1, size);
    return false;
}

/* Stationary distributions are well conditioned and come out to a few units in the last place. With negative
 * entries I - T may be nearly singular otherwise, too: up to a factor of 100, says fixed_point_check. */
static void test_fixed_points(void)
{
    bool stochastic = true, general = true;
    double worst = 0, worst_general = 0;
    for (long round = 0; round < test_effort(2000); round++) {
        size_t size = 1 + random_bits(&seed) % 6;
        int64_t a[36], d = 16 * (int64_t)size;
        for (size_t j = 0; j < size; j++) {
            int64_t rest = d;
            for (size_t i = 0; i + 1 < size; i++) {
                a[i * size + j] = (int64_t)(random_bits(&seed) % 16) + 1;
                rest -= a[i * size + j];
            }
            a[(size - 1) * size + j] = rest;
        }
        stochastic = fixed_point_check(a, d, size, 1e-15, &worst) && stochastic;
        /* Negative entries too, as interpolating schemes have them. */
        d = 8;
        for (size_t j = 0; j < size; j++) {
            int64_t rest = d;
            for (size_t i = 0; i + 1 < size; i++) {
                a[i * size + j] = (int64_t)(random_bits(&seed) % 13) - 6;
                rest -= a[i * size + j];
            }
            a[(size - 1) * size + j] = rest;
        }
        general = fixed_point_check(a, d, size, 1e-12, &worst_general) && general;
    }
    ok(stochastic, "stationary distributions are the cofactors, %g", worst);
    ok(general, "fixed points of matrices with negative entries, %g", worst_general);
}

static void test_no_fixed_point(void)
{
    /* The identity, two blocks, a map of [SI] with a + b = 0, and a shear whose only direction is fixed. */
    static const double cases[][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                                      {1, 0, 0, 0, 0.5, 0.5, 0, 0.5, 0.5},
                                      {0.75, 0.25, 0, 0.25, 0.75, 0, 0, 0, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double point[3], workspace[15];
        size_t order[3];
        ok(!matrix_fixed_point(cases[i], 3, point, workspace, order), "a matrix that fixes more than a point (%zu)", i);
    }
    /* [SI], "Etude des valeurs et vecteurs propres": (b, a)/(a + b) for the joint of corner cutting. */
    bool good = true;
    for (int i = 1; i < 20; i++)
        for (int j = 1; j < 20; j++) {
            double a = i / 40.0, b = j / 40.0, t[] = {1 - a, b, a, 1 - b}, point[2], workspace[8];
            size_t order[2];
            good = good && matrix_fixed_point(t, 2, point, workspace, order) && fabs(point[0] - b / (a + b)) <= 4e-16 &&
                   fabs(point[1] - a / (a + b)) <= 4e-16;
        }
    ok(good, "the joints of corner cutting, to a few units in the last place");
}

int main(void)
{
    test_multiply();
    test_solve();
    test_singular();
    test_fixed_points();
    test_no_fixed_point();
    return done_testing();
}
