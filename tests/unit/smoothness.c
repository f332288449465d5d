/* Certified smoothness against exponents known from the literature and from closed formulas. */
#include "analysis/smoothness.h"

#include <complex.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "automaton/figure.h"
#include "base/decimal.h"
#include "tap.h"

enum { MOST_POWER = 12 };

static struct smoothness found;
static double seconds;

/* The smoothness of the edge `name` of an automaton in text; false when there is none. */
static bool find(const char *text, const char *setting, const char *name)
{
    bcifs_automaton *automaton;
    bcifs_error error;
    bcifs_load_options options = {.settings = &setting, .setting_count = setting != NULL};
    struct arena arena = {0};
    struct states states;
    bool done = false;
    if (bcifs_load_text("test", text, strlen(text), &options, &automaton, &error)) {
        note("%s", error.message);
        return false;
    }
    if (states_of_figures(automaton, &states, &arena))
        return false;
    for (size_t i = 0, count = states.count; i < count && !done; i++) {
        struct text state = {0};
        state_name(&states.states[i].key, &state);
        if (state.data && strcmp(state.data, name) == 0) {
            struct timespec begin, end;
            clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
            done = smoothness_find(&states, i, 1, &arena, &found) == BCIFS_OK;
            clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
            seconds = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
        }
        text_free(&state);
    }
    if (done)
        note("%s: %.12g to %.12g, degree %d, C^%d, %s (%.3f s)", name, found.holder_lower, found.holder_upper,
             found.reproduces, found.continuity, found.certificate, seconds);
    arena_free(&arena);
    bcifs_automaton_free(automaton);
    return done;
}

static bool brackets(double exponent, double gap)
{
    return found.holder_lower <= exponent && exponent <= found.holder_upper &&
           found.holder_upper - found.holder_lower <= gap;
}

/* ---- Curves with known exponents ----------------------------------------------------------------------- */

static const char chaikin[] = "automaton t\nedge arc { mask 2 [ 1/4 3/4 3/4 1/4 ] }\n";
static const char cubic[] = "automaton t\nedge arc { mask 2 [ 1/8 1/2 3/4 1/2 1/8 ] }\n";
static const char four_point[] =
    "automaton t\nparam w = 1/16\nedge arc { mask 2 [ -w 0 1/2+w 1 1/2+w 0 -w ] }\n";
static const char takagi[] =
    "automaton t\nparam w = 1/2\nvertex end 1 { }\nedge arc 3 {\n start end at 0\n end end at 2\n"
    "sub arc [ 1 5/8-w/2 1/4; 0 1/4+w 1/2; 0 1/8-w/2 1/4 ]\n"
    "sub arc [ 1/4 1/8-w/2 0; 1/2 1/4+w 0; 1/4 5/8-w/2 1 ]\n}\n";
static const char bezier[] = "automaton t\nvertex end 1 { }\nedge arc 4 {\n start end at 0\n end end at 3\n"
                             "sub arc [ 1 1/2 1/4 1/8; 0 1/2 1/2 3/8; 0 0 1/4 3/8; 0 0 0 1/8 ]\n"
                             "sub arc [ 1/8 0 0 0; 3/8 1/4 0 0; 3/8 1/2 1/2 0; 1/8 1/4 1/2 1 ]\n}\n";
static const char koch[] =
    "automaton t\nvertex end 1 { }\nedge arc 3 {\n start end at 0\n end end at 2\n"
    "sub arc [ 1 2/3 2/3; 0 1/3 0; 0 0 1/3 ]\n sub arc [ 2/3 1/3 0; 0 2/3 1; 1/3 0 0 ]\n"
    "sub arc [ 0 0 1/3; 1 2/3 0; 0 1/3 2/3 ]\n sub arc [ 1/3 0 0; 0 1/3 0; 2/3 2/3 1 ]\n}\n";
static const char dragon[] =
    "automaton t\nvertex end 1 { }\nedge forward 3 {\n start end at 0\n end end at 2\n"
    "sub forward [ 1 1/2 0; 0 1 1; 0 -1/2 0 ]\n sub backward [ 0 1/2 0; 1 0 0; 0 1/2 1 ]\n}\n"
    "edge backward 3 {\n start end at 0\n end end at 2\n"
    "sub forward [ 1 1/2 0; 0 0 1; 0 1/2 0 ]\n sub backward [ 0 -1/2 0; 1 1 0; 0 1/2 1 ]\n}\n";

static void test_splines(void)
{
    ok(find(chaikin, NULL, "arc") && brackets(2, 0) && found.exact, "Chaikin: 2, exactly");
    ok(found.reproduces == 2 && found.continuity == 1,
       "... C^1 with Lipschitz derivative, reproduces degree 2");
    ok(find(cubic, NULL, "arc") && brackets(3, 0) && found.exact && found.continuity == 2 &&
           found.reproduces == 3,
       "cubic B-spline: 3, C^2");
    ok(find(bezier, NULL, "arc") && brackets(3, 0) && found.reproduces == 3, "cubic Bézier arc: 3");
    ok(find("automaton t\nedge arc { mask 2 [ 1/2 1 1/2 ] }\n", NULL, "arc") && brackets(1, 0) &&
           found.continuity == 0 && found.reproduces == 1,
       "the control polygon itself: 1, C^0");
    ok(find("automaton t\nedge arc { mask 3 [ 1/9 1/3 2/3 7/9 2/3 1/3 1/9 ] }\n", NULL, "arc") &&
           brackets(2, 1e-12) && found.exact && found.continuity == 1,
       "quadratic B-spline by thirds: 2");
}

/* The four-point scheme's exponent is 2 at w = 1/16 (Dubuc 1986; Dyn, Levin and Gregory 1987). Its local
 * matrix has the eigenvalues 1, 1/2 and (1 ± sqrt(1-16w))/4; for 0 < w < 1/16 the larger of these leads all
 * products. */
static void test_four_point(void)
{
    ok(find(four_point, NULL, "arc") && brackets(2, 1e-6) && found.reproduces == 3 && found.continuity == 1,
       "four-point, w = 1/16: 2, reproduces cubics, C^1 but not C^2");
    ok(find(four_point, "w=1/32", "arc") && brackets(-log2((1 + sqrt(0.5)) / 4), 1e-6) &&
           found.continuity == 1,
       "four-point, w = 1/32: -log2 (1 + sqrt(1/2))/4");
}

/* The middle of the arc at w: f = Σ w^n s(2^n t) has the exponent -log2 w away from its joints. The corners
 * that it has at all joints when w < 1/2, w ≠ 1/4, are seen by the continuity alone. */
static void test_takagi(void)
{
    static const struct {
        const char *setting;
        double w;
        int continuity;
    } cases[] = {{"w=3/10", 0.3, 0}, {"w=2/5", 0.4, 0},  {"w=9/20", 0.45, 0}, {"w=1/2", 0.5, 0},
                 {"w=3/5", 0.6, 0},  {"w=7/10", 0.7, 0}, {"w=9/10", 0.9, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        ok(find(takagi, cases[i].setting, "arc") && brackets(-log2(cases[i].w), 1e-6) && found.exact &&
               found.continuity == cases[i].continuity && found.reproduces == 1,
           "Takagi's family, %s: -log2 w, C^0", cases[i].setting);
    ok(find(takagi, "w=1/4", "arc") && brackets(2, 0) && found.reproduces == 2 && found.continuity == 1,
       "Takagi's family, w = 1/4: a parabola, 2");
    ok(find(takagi, "w=3/2", "arc") && found.holder_upper < 0 && found.continuity == -1,
       "Takagi's family, w = 3/2: not even continuous, and an answer");
}

static void test_similarities(void)
{
    ok(find(koch, NULL, "arc") && brackets(log(3) / log(4), 1e-6) && found.exact && found.continuity == 0,
       "von Koch: log 3 / log 4");
    ok(find(dragon, NULL, "forward") && brackets(0.5, 1e-6) && found.exact && found.continuity == 0,
       "the dragon, two states: 1/2");
    ok(find(dragon, NULL, "backward") && brackets(0.5, 1e-6), "... run backwards");
}

/* Knots travel, then all is uniform: C^{1,1} for any intervals. */
static void test_states(void)
{
    static const char text[] = "automaton t\nlet a(u,v) = u/(2*(u+v))\nlet b(u,v) = v/(2*(u+v))\n"
                               "vertex k(u,v) 2 { sub k(u,v) [ 1-a(u,v) b(u,v); a(u,v) 1-b(u,v) ] }\n"
                               "edge p(u,v,w) 3 {\n start k(u,v) at 0 1\n end k(v,w) at 1 2\n"
                               "sub p(u,v,v) [ 1-a(u,v) b(u,v) 0; a(u,v) 1-b(u,v) 1-a(v,w); 0 0 a(v,w) ]\n"
                               "sub p(v,v,w) [ b(u,v) 0 0; 1-b(u,v) 1-a(v,w) b(v,w); 0 a(v,w) 1-b(v,w) ]\n}\n"
                               "figure f { open p\n intervals [ 1 2 7 ]\n points [ 0 0; 1 1; 2 0 ] }\n";
    ok(find(text, NULL, "p(1,2,7)") && brackets(2, 1e-9) && found.reproduces == 2 && found.continuity == 1,
       "a non-uniform quadratic spline: 2, reproduces degree 2");
    static const char mixed[] = "automaton t\nvertex end 1 { }\n"
                                "edge halves 2 {\n start end at 0\n end end at 1\n"
                                "sub thirds [ 1 1/2; 0 1/2 ]\n sub thirds [ 1/2 0; 1/2 1 ]\n}\n"
                                "edge thirds 2 {\n start end at 0\n end end at 1\n"
                                "sub halves [ 1 2/3; 0 1/3 ]\n sub halves [ 2/3 1/3; 1/3 2/3 ]\n"
                                "sub halves [ 1/3 0; 2/3 1 ]\n}\n";
    ok(find(mixed, NULL, "halves") && found.holder_lower <= 1 && found.holder_upper >= 1 &&
           found.reproduces == 1,
       "states that halve and states that cut in three: bounds around the segment's 1");
}

/* ---- Daubechies' scaling functions --------------------------------------------------------------------- */

/* Roots of Σ_{k<n} C(n-1+k,k) y^k by simultaneous iteration (Weierstrass, Durand, Kerner). */
static void half_band_roots(int n, long double complex *roots)
{
    long double coefficients[MOST_POWER] = {1};
    for (int k = 1; k < n; k++)
        coefficients[k] = coefficients[k - 1] * (long double)(n - 1 + k) / (long double)k;
    for (int k = 0; k + 1 < n; k++)
        roots[k] = 0.3L * cpowl(0.4L + 0.9L * I, k);
    for (int step = 0; step < 2000; step++)
        for (int k = 0; k + 1 < n; k++) {
            long double complex value = 0, product = coefficients[n - 1];
            for (int j = n; j-- > 0;)
                value = value * roots[k] + coefficients[j];
            for (int j = 0; j + 1 < n; j++)
                product *= j == k ? 1 : roots[k] - roots[j];
            roots[k] -= value / product;
        }
}

/* The filter of 2n coefficients, sum 2: ((1+z)/2)^n times the factor of the half-band polynomial whose roots
 * are inside the unit circle (I. Daubechies, Orthonormal bases of compactly supported wavelets, 1988). */
static void daubechies(int n, double *filter)
{
    long double complex roots[MOST_POWER], polynomial[2 * MOST_POWER] = {1};
    int degree = 0;
    half_band_roots(n, roots);
    for (int k = 0; k + (n > 0) < n + n; k++) {
        long double complex root = -1;
        if (k < n - 1) {
            long double complex b = 1 - 2 * roots[k], s = csqrtl(b * b - 1);
            root = cabsl(b + s) < 1 ? b + s : b - s;
        }
        for (int j = ++degree; j > 0; j--)
            polynomial[j] = polynomial[j - 1] - root * (j < degree ? polynomial[j] : 0);
        polynomial[0] *= -root;
    }
    long double sum = 0;
    for (int j = 0; j <= degree; j++)
        sum += creall(polynomial[j]);
    for (int j = 0; j <= degree; j++)
        filter[j] = (double)(2 * creall(polynomial[j]) / sum);
}

/* How far Σ h_k h_k+2m = 2 δ_m and Σ (-1)^k k^p h_k = 0 (p < n, over the terms' size) fail. */
static double equations_failure(int n, const double *h)
{
    double worst = 0;
    for (int m = 0; m < n; m++) {
        double sum = m == 0 ? -2 : 0;
        for (int k = 0; k + 2 * m < 2 * n; k++)
            sum += h[k] * h[k + 2 * m];
        worst = fmax(worst, fabs(sum));
    }
    for (int p = 0; p < n; p++) {
        double sum = 0, size = 0;
        for (int k = 0; k < 2 * n; k++) {
            double term = (k % 2 ? -1 : 1) * pow((double)k / (2 * n), p) * h[k];
            sum += term;
            size += fabs(term);
        }
        worst = fmax(worst, fabs(sum) / size);
    }
    return worst;
}

/* D_n: exponents of Daubechies and Lagarias (1992) for n = 2, 3, 4, to the digits printed there. */
static void test_daubechies(void)
{
    static const double known[] = {0, 0, 0.5500, 1.0878, 1.6179};
    for (int n = 2; n <= 10; n++) {
        double h[2 * MOST_POWER];
        struct text text = {0};
        daubechies(n, h);
        double failure = equations_failure(n, h);
        ok(failure < 1e-14, "D%d: the filter satisfies its defining equations (to %.1e)", n, failure);
        text_append(&text, "automaton t\nedge arc { mask 2 [");
        for (int k = 0; k < 2 * n; k++) {
            char digits[40];
            snprintf(digits, sizeof digits, " %.17g", h[k]);
            text_append(&text, digits);
        }
        text_append(&text, " ] }\n");
        bool done = find(text.data, NULL, "arc");
        ok(done && found.holder_upper - found.holder_lower <= 1e-3 && found.reproduces == n - 1,
           "D%d: gap of at most 1e-3, reproduces degree %d", n, n - 1);
        ok(done && found.continuity == (int)floor(found.holder_lower), "D%d is C^%d", n, found.continuity);
        if (n <= 4)
            ok(done && fabs(found.holder_lower - known[n]) <= 1e-4 &&
                   fabs(found.holder_upper - known[n]) <= 1e-4,
               "D%d: %.4f", n, known[n]);
        text_free(&text);
    }
}

int main(void)
{
    test_splines();
    test_four_point();
    test_takagi();
    test_similarities();
    test_states();
    test_daubechies();
    return done_testing();
}
