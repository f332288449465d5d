/* Fitting: curves of known control points are found again; circles by cubic splines have the error that Fourier series
 * give; scale and place make no difference; what cannot be fitted is refused. */
#include <math.h>
#include <string.h>

#include "bcifs.h"
#include "language/outline.h"
#include "tap.h"

static bcifs_error error;

static const char schemes[] =
    "automaton schemes\n"
    "edge spline { mask 2 [ 1/8 1/2 3/4 1/2 1/8 ] }\n"
    "edge cut { mask 2 [ 1/4 3/4 3/4 1/4 ] }\n"
    "edge four { mask 2 [ -1/16 0 9/16 1 9/16 0 -1/16 ] }\n"
    "vertex end 1 { }\n"
    "edge bezier 3 { start end at 0 end end at 2\n"
    "  sub bezier [ 1 1/2 1/4; 0 1/2 1/2; 0 0 1/4 ] sub bezier [ 1/4 0 0; 1/2 1/2 0; 1/4 1/2 1 ] }\n"
    "edge takagi 3 { start end at 0 end end at 2\n"
    "  sub takagi [ 1 3/8 1/4; 0 3/4 1/2; 0 -1/8 1/4 ] sub takagi [ 1/4 -1/8 0; 1/2 3/4 0; 1/4 3/8 1 ] }\n"
    "edge p(u, v) 3 { start k(u) at 0 1 end k(v) at 1 2 sub p(u, u) [ 3/4 1/4 0; 1/4 3/4 3/4; 0 0 1/4 ]\n"
    "  sub p(v, v) [ 1/4 0 0; 3/4 3/4 1/4; 0 1/4 3/4 ] }\n"
    "vertex k(u) 2 { sub k(u) [ 3/4 1/4; 1/4 3/4 ] }\n"
    "cell dust 2 { sub dust [ 1 2/3; 0 1/3 ] sub dust [ 1/3 0; 2/3 1 ] }\n"
    "figure spline_ring { closed spline points [ 0 0; 1 0; 1 1 ] }\n"
    "figure spline_line { open spline points [ 0 0; 1 0; 1 1; 0 1 ] }\n"
    "figure cut_ring { closed cut points [ 0 0; 1 0; 1 1 ] }\n"
    "figure cut_line { open cut points [ 0 0; 1 0; 1 1 ] }\n"
    "figure four_ring { closed four points [ 0 0; 1 0; 1 1 ] }\n"
    "figure bezier_ring { closed bezier points [ 0 0; 1 0; 1 1; 0 1 ] }\n"
    "figure bezier_line { open bezier points [ 0 0; 1 0; 1 1 ] }\n"
    "figure takagi_line { open takagi points [ 0 0; 1 0; 1 1 ] }\n"
    "figure uneven { closed p intervals [ 1 1 1 ] points [ 0 0; 1 0; 1 1 ] }\n"
    "figure dust { piece dust at 0 1 points [ 0 0; 1 1 ] }\n"
    "figure two { piece bezier at 0 1 2 piece bezier at 3 4 5 points [ 0 0; 1 0; 1 1; 5 0; 6 0; 7 1 ] }\n";

static bcifs_automaton *automaton;

/* ---- Curves with known control points ------------------------------------------------------------------ */

static double random_between(uint64_t *seed, double low, double high)
{
    return low + (high - low) * (double)(random_bits(seed) >> 11) * 0x1p-53;
}

/* Points on a wavy circle, so that no part of the curve comes near another. */
static void wavy_circle(uint64_t *seed, bool closed, size_t count, double *points)
{
    for (size_t i = 0; i < count; i++) {
        double angle = 6 * (double)i / (double)count + (closed ? random_between(seed, 0, 0.2) : 0);
        double radius = random_between(seed, 0.85, 1.15);
        points[2 * i] = 3 + radius * cos(angle);
        points[2 * i + 1] = radius * sin(angle) - 7;
    }
}

/* The limit points of a figure on given control points: outline->points is to be freed. */
static bool curve_make(const char *name, const double *points, size_t count, unsigned depth,
                       struct bcifs_curve *outline)
{
    const bcifs_figure_options options = {.figure = name, .points = points, .point_count = count, .dimension = 2};
    const bcifs_view view = {.depth = depth, .to = 1};
    bcifs_figure *figure = NULL;
    bcifs_plan *plan = NULL;
    bcifs_walker *walker = NULL;
    *outline = (struct bcifs_curve){.dimension = 2};
    bool good = bcifs_figure_create(automaton, &options, &figure, &error) == BCIFS_OK &&
                bcifs_plan_create(figure, &view, &plan, &error) == BCIFS_OK &&
                bcifs_walker_create(plan, &walker, &error) == BCIFS_OK;
    outline->count = good ? (size_t)bcifs_plan_points(plan) : 0;
    outline->closed = good && bcifs_plan_path(plan, 0).closed;
    outline->points = malloc((outline->count + 1) * 2 * sizeof *outline->points);
    for (size_t done = 0; good && done < outline->count;)
        done += bcifs_walker_next(walker, outline->points + 2 * done, outline->count - done);
    bcifs_walker_free(walker);
    bcifs_plan_free(plan);
    bcifs_figure_free(figure);
    return good && outline->points;
}

/* Leaves out points at random, but not the ends, nor neighbors. */
static void curve_thin(uint64_t *seed, struct bcifs_curve *outline)
{
    size_t kept = 1;
    for (size_t i = 1; i < outline->count; i++) {
        if (i + 1 < outline->count && random_bits(seed) % 3 == 0)
            i++;
        memmove(outline->points + 2 * kept++, outline->points + 2 * i, 2 * sizeof *outline->points);
    }
    outline->count = kept;
}

static const struct scheme {
    const char *figure;
    bool closed;
    size_t step, joint;
    double found_again; /* tolerance after parameters were moved */
} cases[] = {
    /* What is left of a few steps that converge quadratically, by the condition of the equations; a ring of Bézier
     * arcs may move its joints along the curve almost freely, so that of all control points only the curve is sharp. */
    {"spline_ring", true, 1, 3, 1e-6}, {"spline_line", false, 1, 3, 1e-6}, {"cut_ring", true, 1, 2, 1e-6},
    {"cut_line", false, 1, 2, 1e-6},   {"four_ring", true, 1, 5, 1e-6},    {"takagi_line", false, 2, 1, 1e-6},
    {"bezier_ring", true, 2, 1, 1},    {"bezier_line", false, 2, 1, 1e-6},
};

/* The largest difference of control points, of size 1 about their place. */
static double points_differ(const bcifs_fit *fit, const double *points, size_t count)
{
    size_t found;
    const double *fitted = bcifs_fit_points(fit, &found);
    double largest = found == count ? 0 : INFINITY;
    for (size_t i = 0; i < 2 * count && found == count; i++)
        largest = fmax(largest, fabs(fitted[i] - points[i]));
    return largest;
}

/* Limit points at even parameters are found at once: the least-squares problem has the answer with no error, whose
 * coordinates rounding makes uncertain by 1e-16 times its condition. */
static void test_even(const struct scheme *scheme)
{
    bool good = true;
    double worst = 0, rms = 0;
    for (uint64_t seed = 1; seed <= 2 && good; seed++) {
        double points[2 * 64];
        uint64_t random = seed;
        size_t pieces = scheme->closed ? 8 : 5, count = pieces * scheme->step + (scheme->closed ? 0 : scheme->joint);
        struct bcifs_curve outline;
        bcifs_fit *fit = NULL;
        wavy_circle(&random, scheme->closed, count, points);
        const bcifs_fit_options options = {.figure = scheme->figure, .pieces = pieces};
        good = curve_make(scheme->figure, points, count, 5, &outline) &&
               bcifs_fit_create(automaton, &outline, &options, &fit, &error) == BCIFS_OK;
        if (good) {
            worst = fmax(worst, points_differ(fit, points, count));
            rms = fmax(rms, bcifs_fit_rms(fit));
            good = bcifs_fit_pieces(fit) == pieces && bcifs_fit_dimension(fit) == 2;
        }
        bcifs_fit_free(fit);
        free(outline.points);
    }
    ok(good && worst < 1e-10 && rms < 1e-13, "%s: even parameters give the control points back (%g, rms %g) %s",
       scheme->figure, worst, rms, good ? "" : error.message);
}

/* Without a third of the points neither arc length nor order tells the parameters. */
static void test_uneven(const struct scheme *scheme)
{
    bool good = true;
    double worst = 0, rms = 0;
    for (uint64_t seed = 1; seed <= 2 && good; seed++) {
        double points[2 * 64];
        uint64_t random = seed;
        size_t pieces = scheme->closed ? 8 : 5, count = pieces * scheme->step + (scheme->closed ? 0 : scheme->joint);
        struct bcifs_curve outline;
        bcifs_fit *fit = NULL;
        wavy_circle(&random, scheme->closed, count, points);
        const bcifs_fit_options options = {.figure = scheme->figure, .pieces = pieces, .depth = 7};
        good = curve_make(scheme->figure, points, count, 7, &outline);
        curve_thin(&random, &outline);
        good = good && bcifs_fit_create(automaton, &outline, &options, &fit, &error) == BCIFS_OK;
        if (good) {
            worst = fmax(worst, points_differ(fit, points, count));
            rms = fmax(rms, bcifs_fit_rms(fit));
        }
        bcifs_fit_free(fit);
        free(outline.points);
    }
    ok(good && worst < scheme->found_again && rms < 1e-6, "%s: moved parameters do, too (%g, rms %g) %s",
       scheme->figure, worst, rms, good ? "" : error.message);
}

/* ---- Circles ------------------------------------------------------------------------------------------- */

/* The cubic spline of a regular n-gon has the Fourier coefficients (sin πk/n / πk/n)^4 at k = 1 + jn: beside the circle
 * k = 1 mainly k = 1 - n and 1 + n, smaller by 1/(n-1)^4 and 1/(n+1)^4. Both move the radius by a cosine of n turns, so
 * the error's root mean square is their sum by √2; the next two are 16 times smaller and add 0.4 % at most (1 % where
 * n = 4). The polygon of 4096 sides that the circle is, and that which stands for the spline, leave 3e-7. */
static void test_circle(void)
{
    enum { SIDES = 4096 };
    static double points[2 * SIDES];
    struct bcifs_curve circle = {.dimension = 2, .closed = true, .points = points, .count = SIDES};
    for (int i = 0; i < SIDES; i++) {
        points[2 * i] = cos(6.283185307179586 * i / SIDES);
        points[2 * i + 1] = sin(6.283185307179586 * i / SIDES);
    }
    for (size_t n = 4; n <= 16; n *= 2) {
        bcifs_fit *fit = NULL;
        const bcifs_fit_options options = {.figure = "spline_ring", .pieces = n};
        double expected = (pow((double)n - 1, -4) + pow((double)n + 1, -4)) / sqrt(2);
        bool good = bcifs_fit_create(automaton, &circle, &options, &fit, &error) == BCIFS_OK;
        double rms = good ? bcifs_fit_rms(fit) : NAN;
        ok(fabs(rms - expected) < 0.02 * expected + 3e-7, "a circle by %zu arcs: rms %g, expected %g", n, rms, expected);
        bcifs_fit_free(fit);
    }
}

/* ---- Scale and place ----------------------------------------------------------------------------------- */

static void test_covariance(void)
{
    static const double square[] = {0, 0, 4, 0, 5, 3, 2, 5, 0, 3}; /* some pentagon */
    static const double maps[][3] = {{1, 0, 0}, {3e7, 0, 0}, {1e-200, 0, 0}, {1e300, 0, 0}, {2, 5e4, -1e5}};
    double reference[2 * 7] = {0}, rms = 0;
    for (size_t i = 0; i < sizeof maps / sizeof *maps; i++) {
        double moved[10], worst = 0;
        for (size_t k = 0; k < 10; k++)
            moved[k] = square[k] * maps[i][0] + maps[i][1 + k % 2];
        struct bcifs_curve outline = {.dimension = 2, .closed = true, .points = moved, .count = 5};
        const bcifs_fit_options options = {.figure = "spline_ring", .pieces = 7};
        bcifs_fit *fit = NULL;
        size_t count = 0;
        bool good = bcifs_fit_create(automaton, &outline, &options, &fit, &error) == BCIFS_OK;
        const double *points = good ? bcifs_fit_points(fit, &count) : NULL;
        for (size_t k = 0; k < 14 && good && i > 0; k++)
            worst = fmax(worst, fabs((points[k] - maps[i][1 + k % 2]) / maps[i][0] - reference[k]));
        if (good && i == 0)
            memcpy(reference, points, sizeof reference);
        rms = i == 0 && good ? bcifs_fit_rms(fit) : rms;
        /* 1e5 in front of coordinates of size 1 leaves them 11 digits, and sums of them less. */
        ok(good && worst < 1e-6 && fabs(bcifs_fit_rms(fit) / maps[i][0] - rms) < 1e-6 * rms,
           "a pentagon times %g, moved by %g: %g", maps[i][0], maps[i][1], worst);
        bcifs_fit_free(fit);
    }
}

/* ---- What the points do not decide --------------------------------------------------------------------- */

/* More control points than limit points at depth 0: still finite, and on a line. */
static void test_deficient(void)
{
    double ends[] = {1, 2, 9, 2};
    struct bcifs_curve line = {.dimension = 2, .points = ends, .count = 2};
    for (unsigned depth = 0; depth <= 1; depth++) {
        bcifs_fit *fit = NULL;
        const bcifs_fit_options options = {.figure = "bezier_line", .pieces = 200, .depth = depth};
        bool good = bcifs_fit_create(automaton, &line, &options, &fit, &error) == BCIFS_OK;
        size_t count = 0;
        const double *points = good ? bcifs_fit_points(fit, &count) : NULL;
        for (size_t i = 0; i < count && good; i++)
            good = points[2 * i] > 0.9 && points[2 * i] < 9.1 && fabs(points[2 * i + 1] - 2) < 1e-8;
        ok(good && count == 401 && bcifs_fit_rms(fit) < 1e-8, "a line by 200 arcs, %s", depth ? "few rows" : "many");
        bcifs_fit_free(fit);
    }
}

/* One coordinate: a function of the parameter. A quadratic spline of 4 arcs holds x² exactly. */
static void test_function(void)
{
    enum { COUNT = 257 };
    double values[COUNT];
    for (int i = 0; i < COUNT; i++)
        values[i] = (double)i * i / (COUNT - 1) / (COUNT - 1);
    struct bcifs_curve graph = {.dimension = 1, .points = values, .count = COUNT};
    const bcifs_fit_options options = {.figure = "cut_line", .pieces = 4};
    bcifs_fit *fit = NULL;
    size_t count = 0;
    bool good = bcifs_fit_create(automaton, &graph, &options, &fit, &error) == BCIFS_OK;
    const double *points = good ? bcifs_fit_points(fit, &count) : NULL;
    /* The polar form of x² at the knots around each control point: (i - 1)i/16. */
    for (int i = 0; i < 6 && good; i++)
        good = fabs(points[i] - (double)((i - 1) * i) / 16) < 1e-11;
    ok(good && count == 6, "a parabola as the graph of a quadratic spline");
    bcifs_fit_free(fit);
}

/* Three coordinates, and a target that is open under a closed figure. */
static void test_space(void)
{
    double corners[] = {0, 0, 0, 1, 0, 0, 1, 1, 1, 0, 1, 0};
    struct bcifs_curve outline = {.dimension = 3, .points = corners, .count = 4};
    const bcifs_fit_options options = {.figure = "bezier_ring", .pieces = 4};
    bcifs_fit *fit = NULL;
    bool good = bcifs_fit_create(automaton, &outline, &options, &fit, &error) == BCIFS_OK;
    ok(good && bcifs_fit_dimension(fit) == 3 && bcifs_fit_rms(fit) < 1e-9,
       "four lines in space, the last one drawn to close them: rms %g", good ? bcifs_fit_rms(fit) : NAN);
    bcifs_fit_free(fit);
}

/* ---- Refusals ------------------------------------------------------------------------------------------ */

static void test_refusals(void)
{
    double points[] = {0, 0, 1, 0, 1, 1, 0, 1}, same[] = {2, 2, 2, 2, 2, 2};
    struct bcifs_curve square = {.dimension = 2, .closed = true, .points = points, .count = 4};
    struct bcifs_curve point = {.dimension = 2, .closed = true, .points = same, .count = 3};
    struct bcifs_curve four = {.dimension = 4, .points = points, .count = 2};
    const struct {
        const struct bcifs_curve *target;
        bcifs_fit_options options;
        const char *message;
    } refused[] = {
        {&square, {.figure = "uneven", .pieces = 5}, "need 5 intervals, found 3"},
        {&square, {.figure = "dust"}, "not one curve"},
        {&square, {.figure = "dust", .pieces = 3}, "has its own pieces"},
        {&square, {.figure = "two"}, "not one curve"},
        {&square, {.figure = "none"}, "there is no figure 'none'"},
        {&square, {.state = "bezier", .pieces = 2}, "one piece, not 2"},
        {&square, {.figure = "spline_ring", .pieces = (size_t)1 << 40}, "the limit, 65536"},
        {&square, {.figure = "bezier_ring", .pieces = 40000}, "the limit is 65536"},
        {&square, {.figure = "spline_ring", .pieces = 1}, "at least 2"},
        {&square, {.figure = "spline_ring", .depth = 40}, "the greatest depth"},
        {&point, {.figure = "spline_ring"}, "no length"},
        {&four, {.figure = "spline_ring"}, "at most 3 coordinates"},
    };
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        bcifs_fit *fit = NULL;
        bcifs_status status = bcifs_fit_create(automaton, refused[i].target, &refused[i].options, &fit, &error);
        bool good = status == BCIFS_INPUT && !fit && strstr(error.message, refused[i].message);
        ok(good, "refused: %s", refused[i].message);
        if (!good)
            note("status %d: %s", (int)status, error.message);
        bcifs_fit_free(fit);
    }
    bcifs_fit *fit = NULL;
    const bcifs_fit_options fitting = {.figure = "uneven", .pieces = 3}, one = {.state = "bezier", .pieces = 1};
    ok(bcifs_fit_create(automaton, &square, &fitting, &fit, &error) == BCIFS_OK, "as many pieces as intervals");
    bcifs_fit_free(fit);
    fit = NULL;
    ok(bcifs_fit_create(automaton, &square, &one, &fit, &error) == BCIFS_OK && bcifs_fit_pieces(fit) == 1,
       "one piece in a state");
    bcifs_fit_free(fit);
}

int main(void)
{
    if (bcifs_load_text("schemes.bcifs", schemes, strlen(schemes), NULL, &automaton, &error)) {
        note("%u:%u: %s", error.line, error.column, error.message);
        return 1;
    }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        test_even(&cases[i]);
        test_uneven(&cases[i]);
    }
    test_circle();
    test_covariance();
    test_deficient();
    test_function();
    test_space();
    test_refusals();
    bcifs_automaton_free(automaton);
    return done_testing();
}
