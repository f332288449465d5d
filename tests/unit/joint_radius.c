/* The joint spectral radius: families whose radius is known, invariances, and products by brute force. */
#include "numeric/joint_radius.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "numeric/eigen.h"
#include "numeric/enclosure.h"
#include "numeric/matrix.h"
#include "tap.h"

enum { MOST = 8 };

static uint64_t seed = 7;
static struct joint_bounds bounds;
static size_t product[64];

/* One node with `count` size × size matrices, one after the other; `errors` alike, or NULL. */
static bool find_of(size_t size, size_t count, const double *matrices, const double *errors, double effort)
{
    struct arena arena = {0};
    struct joint_edge edges[MOST];
    for (size_t i = 0; i < count; i++)
        edges[i] =
            (struct joint_edge){0, 0, matrices + i * size * size, errors ? errors + i * size * size : NULL};
    struct joint_family family = {&size, 1, edges, count};
    bcifs_status status = joint_radius_find(&family, effort, &arena, &bounds);
    for (size_t k = 0; k < bounds.length && k < 64; k++)
        product[k] = bounds.product[k];
    arena_free(&arena);
    return status == BCIFS_OK && bounds.lower <= bounds.upper;
}

static bool find(size_t size, size_t count, const double *matrices)
{
    return find_of(size, count, matrices, NULL, 1);
}

static bool brackets(double radius, double gap)
{
    bool good = bounds.lower <= radius * (1 + 1e-15) && radius * (1 - 1e-15) <= bounds.upper &&
                bounds.upper - bounds.lower <= gap;
    if (!good)
        note("%.17g is not in %.17g to %.17g, or the gap exceeds %g", radius, bounds.lower, bounds.upper,
             gap);
    return good;
}

static double random_entry(void)
{
    return (double)(int64_t)(random_bits(&seed) % 2001) / 1000 - 1;
}

/* ---- Known radii --------------------------------------------------------------------------------------- */

static void test_closed_forms(void)
{
    ok(find(1, 3, (double[]){0.25, -0.75, 0.5}) && bounds.lower == 0.75 && bounds.upper == 0.75 &&
           bounds.exact,
       "numbers: the largest in modulus, exactly");
    ok(bounds.length == 1 && product[0] == 1, "... and which one it is");
    ok(find(2, 1, (double[]){3, 1, 0, 2}) && brackets(3, 1e-13), "one matrix: its spectral radius");
    ok(find(2, 2, (double[]){0.5, 100, 0, 0.25, 0.125, -7, 0, -0.75}) && bounds.lower == 0.75 &&
           bounds.upper == 0.75,
       "triangular: the largest diagonal entry");
    ok(find(3, 2, (double[]){0, 1, 5, 0, 0, 2, 0, 0, 0, 0, -1, 2, 0, 0, 9, 0, 0, 0}) && bounds.lower == 0 &&
           bounds.upper == 0 && bounds.length == 0,
       "nilpotent together: 0, without any product");
    ok(find(0, 2, (double[]){0}) && bounds.upper == 0, "dimension 0: 0");
    ok(find(2, 0, NULL) && bounds.upper == 0 && bounds.exact, "no matrix: 0");
    ok(find(3, 1, (double[]){0.5, 1, 0, 0, 0.5, 1, 0, 0, 0.5}) && bounds.lower == 0.5 && bounds.upper == 0.5,
       "one Jordan block: its eigenvalue");
}

static void test_families(void)
{
    const double golden = (1 + sqrt(5)) / 2;
    ok(find(2, 2, (double[]){1, 1, 0, 1, 1, 0, 1, 1}) && brackets(golden, 1e-9) && bounds.exact,
       "[1 1; 0 1] and [1 0; 1 1]: the golden ratio");
    ok(bounds.length == 2 && product[0] != product[1], "... attained by the product of both");
    ok(find(2, 2, (double[]){1, 1, 0, 0, 0, 0, 1, 1}) && brackets(1, 1e-9),
       "idempotents with a product of radius 1");
    /* diag(2,1/2) and a commuting one: simultaneously diagonal, turned by a shear */
    ok(find(2, 2, (double[]){2, -1.5, 0, 0.5, -1, -2, 0, -3}) && brackets(3, 1e-9),
       "commuting: the largest radius");
    double c = cos(1), s = sin(1);
    ok(find(2, 2, (double[]){0.9 * c, -0.9 * s, 0.9 * s, 0.9 * c, 0.9, 0, 0, -0.9}) && brackets(0.9, 1e-9) &&
           bounds.exact,
       "rotation and reflection, scaled: the scale");
    /* a b^T and c d^T: the largest of |b·a|, |d·c|, sqrt |b·c d·a| */
    ok(find(2, 2, (double[]){1, 2, 1, 2, 3, -1, -3, 1}) && brackets(4, 1e-9), "rank one: |d·c| = 4 wins");
    ok(find(2, 2, (double[]){0, 1, 0, 0, 0, 0, 1, 0}) && brackets(1, 1e-9) && bounds.length == 2,
       "rank one: sqrt |b·c d·a| = 1 wins");
    ok(find(2, 2, (double[]){2, 1, 1, 2, 1, -1, -1, 1}) && brackets(3, 1e-9),
       "symmetric: the largest spectral norm");
    ok(find(2, 2, (double[]){3. / 5, 3. / 5, 0, 3. / 5, 3. / 5, 0, -3. / 5, 3. / 5}) && bounds.lower > 0.6 &&
           bounds.upper - bounds.lower < 1e-6,
       "the pair of Blondel and Megretski's kind, with the sign that makes eigenvalues complex");
}

/* ---- Invariances --------------------------------------------------------------------------------------- */

/* M <- S M S^-1 for elementary S with small integers: exact in doubles. */
static void conjugate(double *m, size_t n, size_t i, size_t j, double factor)
{
    for (size_t k = 0; k < n; k++)
        m[i * n + k] += factor * m[j * n + k];
    for (size_t k = 0; k < n; k++)
        m[k * n + j] -= factor * m[k * n + i];
}

/* A random entry k/64, so that the changes of basis below are exact. */
static double dyadic_entry(void)
{
    return (double)(int64_t)(random_bits(&seed) % 129) / 64 - 1;
}

static void test_invariance(void)
{
    bool similar = true, scaled = true;
    for (long run = 0; run < test_effort(12); run++) {
        size_t n = 2 + (size_t)run % 3;
        double m[2 * 16], turned[2 * 16];
        for (size_t i = 0; i < 2 * n * n; i++)
            m[i] = dyadic_entry();
        memcpy(turned, m, sizeof m);
        for (size_t k = 0; k < 2; k++) {
            conjugate(turned + k * n * n, n, 0, n - 1, 2);
            conjugate(turned + k * n * n, n, 1, 0, -1);
        }
        if (!find(n, 2, m))
            similar = false;
        struct joint_bounds first = bounds;
        similar = similar && find(n, 2, turned) && bounds.lower <= first.upper &&
                  first.lower <= bounds.upper && bounds.upper - first.lower <= 1e-2;
        for (size_t i = 0; i < 2 * n * n; i++)
            m[i] = ldexp(m[i], -300);
        scaled = scaled && find(n, 2, m) && bounds.lower == ldexp(first.lower, -300) &&
                 bounds.upper == ldexp(first.upper, -300);
        if (!similar || !scaled)
            note("run %ld, n = %zu: %.12g to %.12g", run, n, first.lower, first.upper);
    }
    ok(similar, "a change of basis: the brackets meet");
    ok(scaled, "a scale of 2^-300: the same bits, scaled");
}

/* ---- Brute force --------------------------------------------------------------------------------------- */

/* Over all words of `length`: the largest spectral radius and the largest norm, to the power 1/length. */
static void brute_force(const double *m, size_t n, size_t count, size_t length, double *lower, double *upper)
{
    size_t words = 1;
    for (size_t k = 0; k < length; k++)
        words *= count;
    for (size_t w = 0; w < words; w++) {
        double p[16], q[16], workspace[8];
        memcpy(p, m + w % count * n * n, n * n * sizeof *p);
        for (size_t k = 1, rest = w / count; k < length; k++, rest /= count) {
            matrix_multiply(p, m + rest % count * n * n, n, n, n, q);
            memcpy(p, q, n * n * sizeof *p);
        }
        *upper = fmax(*upper, pow(row_norm(p, n, n), 1 / (double)length));
        *lower = fmax(*lower, pow(spectral_radius(p, n, workspace), 1 / (double)length));
    }
}

static void test_brute_force(void)
{
    bool inside = true, tight = true, attained = true;
    double widest = 0;
    for (long run = 0; run < test_effort(20); run++) {
        size_t n = 2 + (size_t)run % 3;
        double m[2 * 16], best = 0, p[16], q[16], workspace[8];
        for (size_t i = 0; i < 2 * n * n; i++)
            m[i] = random_entry();
        inside = inside && find(n, 2, m);
        for (size_t length = 1; length <= 12; length++) {
            double lower = 0, upper = 0;
            brute_force(m, n, 2, length, &lower, &upper);
            best = fmax(best, lower);
            inside = inside && lower <= bounds.upper * (1 + 1e-9) && upper >= bounds.lower * (1 - 1e-9);
        }
        tight = tight && bounds.lower >= best * (1 - 1e-6);
        widest = fmax(widest, bounds.upper - bounds.lower);
        memcpy(p, m + product[0] * n * n, n * n * sizeof *p);
        for (size_t k = 1; k < bounds.length; k++) {
            matrix_multiply(p, m + product[k] * n * n, n, n, n, q);
            memcpy(p, q, n * n * sizeof *p);
        }
        double radius = pow(spectral_radius(p, n, workspace), 1 / (double)bounds.length);
        attained = attained && fabs(radius - bounds.lower) <= 1e-6 * radius;
        if (!inside || !tight || !attained)
            note("run %ld, n = %zu: %.12g to %.12g, best product %.12g", run, n, bounds.lower, bounds.upper,
                 best);
    }
    ok(inside, "no product of up to 12 maps contradicts the bracket");
    ok(tight, "the lower bound is not below what such products show");
    ok(attained, "the lower bound is attained by the product that is named");
    ok(widest <= 1e-3, "no bracket is wider than 1e-3 (%.1e)", widest);
}

/* ---- Constrained families ------------------------------------------------------------------------------ */

static void test_graphs(void)
{
    /* No two [1 1; 0 1] in a row, and after it two maps at least: node 0 may take A or B, node 1 only B. */
    double a[] = {1, 1, 0, 1}, b[] = {1, 0, 1, 1};
    size_t dimensions[] = {2, 2};
    struct joint_edge edges[] = {{0, 1, a, NULL}, {1, 0, b, NULL}};
    struct joint_family family = {dimensions, 2, edges, 2};
    struct arena arena = {0};
    ok(joint_radius_find(&family, 1, &arena, &bounds) == BCIFS_OK && brackets((1 + sqrt(5)) / 2, 1e-12) &&
           bounds.exact && bounds.length == 2,
       "two nodes in a cycle: the root of the product's radius");
    struct joint_edge one_way[] = {{0, 1, a, NULL}, {0, 1, b, NULL}};
    family = (struct joint_family){dimensions, 2, one_way, 2};
    ok(joint_radius_find(&family, 1, &arena, &bounds) == BCIFS_OK && bounds.upper == 0 && bounds.length == 0,
       "a graph without a cycle: 0");
    arena_free(&arena);
}

/* A graph of nodes of dimensions 2, 1, 3 with random matrices has the radius of the family of block matrices
 * with one block each: a product of those is 0 unless its blocks follow each other. */
static void test_lifted(void)
{
    static const size_t dimensions[] = {2, 1, 3}, base[] = {0, 2, 3};
    static const size_t ends[6][2] = {{0, 0}, {0, 1}, {1, 2}, {2, 0}, {2, 2}, {1, 0}};
    bool meet = true, closed = true;
    for (long run = 0; run < test_effort(6); run++) {
        struct arena arena = {0};
        double blocks[6][9], lifted[6][36];
        struct joint_edge edges[6], big[6];
        size_t six = 6;
        memset(lifted, 0, sizeof lifted);
        for (size_t e = 0; e < 6; e++) {
            size_t rows = dimensions[ends[e][0]], columns = dimensions[ends[e][1]];
            for (size_t i = 0; i < rows; i++)
                for (size_t j = 0; j < columns; j++)
                    blocks[e][i * columns + j] =
                        lifted[e][(base[ends[e][0]] + i) * 6 + base[ends[e][1]] + j] = random_entry();
            edges[e] = (struct joint_edge){ends[e][0], ends[e][1], blocks[e], NULL};
            big[e] = (struct joint_edge){0, 0, lifted[e], NULL};
        }
        struct joint_family family = {dimensions, 3, edges, 6}, one = {&six, 1, big, 6};
        struct joint_bounds graph, whole;
        meet = meet && joint_radius_find(&family, 1, &arena, &graph) == BCIFS_OK &&
               joint_radius_find(&one, 1, &arena, &whole) == BCIFS_OK && graph.lower <= whole.upper &&
               whole.lower <= graph.upper;
        closed = closed && graph.upper - graph.lower <= 1e-3;
        if (!meet || !closed)
            note("run %ld: %.12g to %.12g and %.12g to %.12g", run, graph.lower, graph.upper, whole.lower,
                 whole.upper);
        arena_free(&arena);
    }
    ok(meet, "graphs and their lifted families: the brackets meet");
    ok(closed, "... and those of the graphs are narrow");
}

/* ---- Errors -------------------------------------------------------------------------------------------- */

/* Bounds for entries that may be off by e hold for every family that is. */
static void test_errors(void)
{
    double golden[] = {1, 1, 0, 1, 1, 0, 1, 1}, off[8], errors[8];
    bool inside = true;
    for (size_t i = 0; i < 8; i++)
        errors[i] = 1e-5;
    bool done = find_of(2, 2, golden, errors, 1);
    struct joint_bounds wide = bounds;
    ok(done && wide.upper - wide.lower < 1e-3 && wide.lower < (1 + sqrt(5)) / 2,
       "errors of 1e-5 widen the bracket");
    for (long run = 0; run < test_effort(10); run++) {
        for (size_t i = 0; i < 8; i++)
            off[i] = golden[i] + 1e-5 * (double)((int)(random_bits(&seed) % 3) - 1);
        inside = inside && find(2, 2, off) && wide.lower <= bounds.upper && bounds.lower <= wide.upper;
        inside = inside && bounds.upper <= wide.upper * (1 + 1e-9) && bounds.lower >= wide.lower * (1 - 1e-9);
    }
    ok(inside, "every family within the errors has its bracket inside");
}

/* Enclosures of one spectral radius: known eigenvalues, simple, multiple, complex, in Jordan blocks. */
static void test_enclosure(void)
{
    static const struct {
        const char *name;
        size_t size;
        double matrix[16], radius, gap;
    } cases[] = {
        {"diagonal", 3, {1, 0, 0, 0, -3, 0, 0, 0, 2}, 3, 1e-10},
        {"companion of (x-1)(x-2)(x-3)", 3, {6, -11, 6, 1, 0, 0, 0, 1, 0}, 3, 1e-10},
        {"cyclic permutation", 4, {0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0}, 1, 1e-12},
        {"rotation by 60 degrees and 1/2", 3, {1, -1, 0, 1, 0, 0, 0, 0, 0.5}, 1, 1e-12},
        {"leading 2, Jordan block of 1", 3, {2, 0, 0, 5, 1, 1, 7, 0, 1}, 2, 1e-6},
        {"Jordan block of 2", 3, {2, 1, 0, 0, 2, 0, 3, 4, 1}, 2, 1e-3},
        {"badly scaled", 2, {1, 1e8, 1e-8, 1}, 2, 1e-7},
        {"zero", 2, {0, 0, 0, 0}, 0, 1e-140},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct arena arena = {0};
        double lower, upper;
        int done = spectral_radius_enclose(cases[i].matrix, cases[i].size, 0, &arena, &lower, &upper);
        ok(done && lower <= cases[i].radius && cases[i].radius <= upper && upper - lower <= cases[i].gap,
           "enclosure, %s: %.17g to %.17g", cases[i].name, lower, upper);
        arena_free(&arena);
    }
}

int main(void)
{
    test_enclosure();
    test_closed_forms();
    test_families();
    test_invariance();
    test_brute_force();
    test_graphs();
    test_lifted();
    test_errors();
    return done_testing();
}
