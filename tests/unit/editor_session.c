/* Sessions of the area-true editor: many drags are one, release, undo and redo, other levels in between,
 * edits that cannot reach their area, wrong calls, and every request for memory that fails. The allocator
 * below the library is replaced here by one that can be told to fail. */
#include <math.h>
#include <string.h>

#include "tap.h"

/* Requests until one fails (0: never), and blocks that are alive. */
static long fail_after;
static long alive;

static bool fails(void)
{
    return fail_after > 0 && --fail_after == 0;
}

static void *counted_calloc(size_t count, size_t size)
{
    void *block = fails() ? NULL : calloc(count, size);
    alive += block != NULL;
    return block;
}

static void *counted_realloc(void *old, size_t size)
{
    void *block = fails() ? NULL : realloc(old, size);
    alive += block != NULL && old == NULL;
    return block;
}

static void counted_free(void *block)
{
    alive -= block != NULL;
    free(block);
}

/* The library's one place of allocation, compiled here on top of these. */
#define calloc counted_calloc
#define realloc counted_realloc
#define free counted_free
#include "base/memory.c"
#undef calloc
#undef realloc
#undef free

#include "curves.h"

enum { MOST = 256 };

static uint64_t seed = 5;

/* ---- Curves and what is read of them ------------------------------------------------------------------- */

static double distance(const double *a, const double *b, size_t count)
{
    double largest = 0;
    for (size_t i = 0; i < 2 * count; i++)
        largest = isfinite(a[i] - b[i]) ? fmax(largest, fabs(a[i] - b[i])) : INFINITY;
    return largest;
}

/* How far a stage is from points read before. */
static double apart(const bcifs_editor *editor, bcifs_stage stage, const double *points)
{
    double now[2 * MOST];
    bcifs_editor_read(editor, stage, now);
    return distance(now, points, bcifs_editor_points(editor));
}

static double area_now(const bcifs_editor *editor)
{
    bcifs_edit_report report;
    bcifs_editor_report(editor, &report);
    return report.after;
}

/* Wavy closed outlines of 8 points on Chaikin's scheme, and an open one of 9 on Bézier arcs. */
struct desk {
    bcifs_automaton *automaton;
    bcifs_figure *figure;
    bcifs_editor *editor;
};

static bool desk_open(struct desk *desk, bool closed, unsigned refine, unsigned coarsen)
{
    double points[18];
    size_t count = closed ? 8 : 9;
    *desk = (struct desk){NULL, NULL, NULL};
    for (size_t i = 0; i < count; i++) {
        double angle = 0.7 * (double)i, radius = 4 + random_number(&seed);
        points[2 * i] = radius * cos(angle) + 1;
        points[2 * i + 1] = radius * sin(angle) - 2;
    }
    const bcifs_figure_options options = {
        .figure = closed ? "square" : "parabola", .points = points, .point_count = count, .dimension = 2};
    const bcifs_editor_options levels = {refine, coarsen, BCIFS_BENDING};
    bcifs_status status = bcifs_load(closed ? "automata/chaikin.bcifs" : "automata/bezier-quadratic.bcifs",
                                     NULL, &desk->automaton, NULL);
    if (status == BCIFS_OK)
        status = bcifs_figure_create(desk->automaton, &options, &desk->figure, NULL);
    if (status == BCIFS_OK)
        status = bcifs_editor_create(desk->figure, &levels, &desk->editor, NULL);
    return status == BCIFS_OK;
}

static void desk_close(struct desk *desk)
{
    bcifs_editor_free(desk->editor);
    bcifs_figure_free(desk->figure);
    bcifs_automaton_free(desk->automaton);
}

static bcifs_constraint constraint_of(bcifs_free set, double alpha)
{
    return (bcifs_constraint){.keep_area = 1, .alpha = alpha, .free = set, .neighbors = 2};
}

static const size_t grabbed[] = {1, 2};

/* ---- Drags --------------------------------------------------------------------------------------------- */

/* A way of fifty drags ends where one does, and so does a move by the same vector. */
static void test_drags(void)
{
    static const bcifs_free sets[] = {BCIFS_FREE_SCALE, BCIFS_FREE_ALL, BCIFS_FREE_NEAR};
    int wrong = 0;
    double worst = 0;
    for (int round = 0; round < 24; round++) {
        struct desk desk;
        double once[2 * MOST], moved[2 * MOST], before[2 * MOST];
        const bcifs_constraint constraint = constraint_of(sets[round % 3], pow(10, 2 * random_number(&seed)));
        double dx = 2 * random_number(&seed), dy = 2 * random_number(&seed);
        const bcifs_move moves[] = {{1, dx, dy}, {2, dx, dy}};
        bool good =
            desk_open(&desk, round % 2, 3, 2) && !bcifs_editor_constrain(desk.editor, &constraint, NULL);
        bcifs_editor_read(desk.editor, BCIFS_RESULT, before);
        good = good && !bcifs_editor_grab(desk.editor, grabbed, 2, NULL) &&
               !bcifs_editor_drag(desk.editor, dx, dy, NULL) && !bcifs_editor_release(desk.editor, NULL);
        bcifs_editor_read(desk.editor, BCIFS_RESULT, once);
        good = good && bcifs_editor_undo(desk.editor) && apart(desk.editor, BCIFS_RESULT, before) == 0;
        good = good && !bcifs_editor_move(desk.editor, moves, 2, NULL);
        bcifs_editor_read(desk.editor, BCIFS_RESULT, moved);
        good = good && bcifs_editor_undo(desk.editor) && !bcifs_editor_grab(desk.editor, grabbed, 2, NULL);
        for (int step = 0; step < 50; step++)
            good = good &&
                   !bcifs_editor_drag(desk.editor, 2 * random_number(&seed), 2 * random_number(&seed), NULL);
        good = good && !bcifs_editor_drag(desk.editor, dx, dy, NULL) &&
               apart(desk.editor, BCIFS_INITIAL, before) == 0 && !bcifs_editor_release(desk.editor, NULL);
        double error = fmax(apart(desk.editor, BCIFS_RESULT, once),
                            distance(once, moved, bcifs_editor_points(desk.editor)));
        worst = fmax(worst, error);
        if ((!good || !(error < 1e-10)) && ++wrong)
            note("round %d, alpha %g: %g apart, good %d", round, constraint.alpha, error, good);
        desk_close(&desk);
    }
    ok(wrong == 0, "many drags, one, and a move come to the same (%.1e)", worst);
}

/* A random walk through edits, undo and redo, against a list of the curves that were. */
static void test_history(void)
{
    enum { STEPS = 300, KEPT = 100 };
    static double list[KEPT][2 * MOST];
    struct desk desk;
    size_t count = 1, at = 0;
    bool good = desk_open(&desk, true, 2, 1);
    double area = area_now(desk.editor), worst = 0;
    bcifs_editor_read(desk.editor, BCIFS_RESULT, list[0]);
    for (int step = 0; step < STEPS && good; step++) {
        uint64_t choice = random_bits(&seed) % 5;
        if (choice < 2 && at + 1 < KEPT) {
            const bcifs_move move = {(size_t)(random_bits(&seed) % bcifs_editor_scale_points(desk.editor)),
                                     random_number(&seed), random_number(&seed)};
            good = bcifs_editor_move(desk.editor, &move, 1, NULL) == BCIFS_OK &&
                   apart(desk.editor, BCIFS_INITIAL, list[at]) < 1e-13;
            bcifs_editor_read(desk.editor, BCIFS_RESULT, list[++at]);
            count = at + 1;
        } else if (choice == 2) {
            good = bcifs_editor_undo(desk.editor) == (at > 0);
            at -= at > 0;
        } else if (choice == 3) {
            good = bcifs_editor_redo(desk.editor) == (at + 1 < count);
            at += at + 1 < count;
        } else {
            good = bcifs_editor_coarsen(desk.editor, (unsigned)(random_bits(&seed) % 4), NULL) == BCIFS_OK;
        }
        good = good && apart(desk.editor, BCIFS_RESULT, list[at]) == 0;
        worst = fmax(worst, fabs(area_now(desk.editor) / area - 1));
        if (!good)
            note("step %d, choice %d: %g apart", step, (int)choice,
                 apart(desk.editor, BCIFS_RESULT, list[at]));
    }
    ok(good, "undo and redo bring every curve back, from any level");
    ok(worst < 1e-12, "and the area stays through all edits (%.1e)", worst);
    for (int step = 0; step < 400 && good; step++)
        good = bcifs_editor_move(desk.editor, &(bcifs_move){0, 0.01, 0}, 1, NULL) == BCIFS_OK;
    int undone = 0;
    while (bcifs_editor_undo(desk.editor))
        undone++;
    ok(good && undone >= 100 && undone < 400, "the history forgets its oldest curves (%d kept)", undone);
    desk_close(&desk);
}

/* Where nothing answers, each drag that changes the area fails. The points 0 and 3 of an open curve are its
 * ends: along the chord's direction the area does not change, so such drags succeed. */
static void test_failing_drags(void)
{
    struct desk desk;
    bcifs_error error;
    double before[2 * MOST], good[2 * MOST], chord[4];
    bool opened = desk_open(&desk, true, 2, 2);
    bcifs_constraint constraint = constraint_of(BCIFS_FREE_LIST, 1); /* an empty list */
    bcifs_editor_constrain(desk.editor, &constraint, NULL);
    bcifs_editor_read(desk.editor, BCIFS_RESULT, before);
    ok(opened && !bcifs_editor_grab(desk.editor, (size_t[]){3}, 1, NULL), "a point is grabbed, none answers");
    ok(bcifs_editor_drag(desk.editor, 1, 1, &error) == BCIFS_NO &&
           strstr(error.message, "no control point is free") &&
           strstr(error.message, "nearest area within reach is "),
       "the drag says why it fails: %s", error.message);
    bcifs_edit_report report;
    bcifs_editor_report(desk.editor, &report);
    char number[40];
    bcifs_number_text(number, report.after);
    double told = atof(strstr(error.message, "reach is ") + 9);
    ok(fabs(told - report.after) <= 1e-12 * fabs(told), "and the nearest area, %s", number);
    ok(bcifs_editor_release(desk.editor, NULL) == BCIFS_OK && apart(desk.editor, BCIFS_RESULT, before) == 0,
       "the release leaves the curve as it was");
    ok(!bcifs_editor_undo(desk.editor), "that was no edit");
    /* Along the line through the neighbors of point 3 the area stays, for Chaikin's curve is between the
     * polygon's corners: A is linear in one point, and constant in one direction, here found from two
     * failures. */
    bcifs_editor_grab(desk.editor, (size_t[]){3}, 1, NULL);
    double base = report.before, gradient[2];
    for (int c = 0; c < 2; c++) {
        bcifs_editor_drag(desk.editor, c == 0, c == 1, NULL);
        bcifs_editor_report(desk.editor, &report);
        gradient[c] = report.after - base;
    }
    chord[0] = -gradient[1];
    chord[1] = gradient[0];
    ok(bcifs_editor_drag(desk.editor, chord[0] / 8, chord[1] / 8, &error) == BCIFS_OK,
       "a drag that keeps the area succeeds");
    bcifs_editor_read(desk.editor, BCIFS_RESULT, good);
    ok(bcifs_editor_drag(desk.editor, gradient[0], gradient[1], NULL) == BCIFS_NO, "the next one fails");
    ok(bcifs_editor_release(desk.editor, NULL) == BCIFS_OK && apart(desk.editor, BCIFS_RESULT, good) < 1e-13,
       "the release keeps the last that reached the area");
    ok(bcifs_editor_undo(desk.editor) && apart(desk.editor, BCIFS_RESULT, before) == 0,
       "which can be undone");
    ok(bcifs_editor_move(desk.editor, &(bcifs_move){3, gradient[0], gradient[1]}, 1, &error) == BCIFS_NO,
       "a move fails likewise");
    ok(apart(desk.editor, BCIFS_RESULT, before) > 1e-3, "its nearest curve can be read");
    ok(bcifs_editor_undo(desk.editor) && apart(desk.editor, BCIFS_RESULT, before) == 0 &&
           !bcifs_editor_undo(desk.editor),
       "and is taken back");
    desk_close(&desk);
}

/* Drags that were not released are no edits, whatever is called next. */
static void test_unreleased(void)
{
    const bcifs_constraint constraint = constraint_of(BCIFS_FREE_ALL, 3);
    for (int way = 0; way < 6; way++) {
        struct desk desk;
        double before[2 * MOST];
        bool good = desk_open(&desk, true, 2, 1);
        bcifs_editor_move(desk.editor, &(bcifs_move){0, 1, 0}, 1, NULL);
        bcifs_editor_read(desk.editor, BCIFS_RESULT, before);
        good = good && !bcifs_editor_grab(desk.editor, grabbed, 2, NULL) &&
               !bcifs_editor_drag(desk.editor, 1, 2, NULL) && apart(desk.editor, BCIFS_RESULT, before) > 1e-3;
        int done = way == 0   ? bcifs_editor_undo(desk.editor)
                   : way == 1 ? !bcifs_editor_redo(desk.editor)
                   : way == 2 ? !bcifs_editor_coarsen(desk.editor, 2, NULL)
                   : way == 3 ? !bcifs_editor_constrain(desk.editor, &constraint, NULL)
                   : way == 4 ? !bcifs_editor_grab(desk.editor, grabbed, 1, NULL)
                              : bcifs_editor_grab(desk.editor, (size_t[]){99}, 1, NULL) == BCIFS_INPUT;
        good = good && done && apart(desk.editor, BCIFS_RESULT, before) == 0;
        good = good && (way == 4 || bcifs_editor_drag(desk.editor, 1, 1, NULL) == BCIFS_INPUT);
        good = good && bcifs_editor_undo(desk.editor) && !bcifs_editor_undo(desk.editor);
        ok(good, "a drag without release is dropped, way %d", way);
        desk_close(&desk);
    }
}

/* ---- Areas wanted -------------------------------------------------------------------------------------- */

static void test_targets(void)
{
    struct desk desk;
    bcifs_constraint constraint = constraint_of(BCIFS_FREE_SCALE, 1);
    bool good = desk_open(&desk, true, 2, 2);
    double area = area_now(desk.editor);
    for (int k = -2; k <= 2; k++) {
        constraint.has_target = 1;
        constraint.target = (double)k * area;
        good = good && !bcifs_editor_constrain(desk.editor, &constraint, NULL) &&
               !bcifs_editor_move(desk.editor, NULL, 0, NULL) &&
               fabs(area_now(desk.editor) - constraint.target) < 1e-12 * fabs(area);
    }
    ok(good, "any area can be had, also 0 and the other orientation");
    for (int exponent = 6; exponent <= 306; exponent += 20) {
        bcifs_error error = {.message = ""};
        bcifs_edit_report report;
        constraint.target = pow(10, exponent);
        bcifs_editor_constrain(desk.editor, &constraint, NULL);
        bcifs_status status = bcifs_editor_move(desk.editor, NULL, 0, &error);
        bcifs_editor_report(desk.editor, &report);
        bool reached = fabs(report.after / constraint.target - 1) < 1e-12;
        if (!(status == BCIFS_OK ? reached : status == BCIFS_NO && exponent > 150) && !(good = false))
            note("1e%d: status %d, %g %s", exponent, status, report.after, error.message);
        bcifs_editor_undo(desk.editor);
    }
    ok(good, "an area is reached, or is said to be beyond reach");
    constraint.target = 3 * area; /* unlike what an undo has just brought back */
    bcifs_editor_constrain(desk.editor, &constraint, NULL);
    bcifs_editor_move(desk.editor, NULL, 0, NULL);
    constraint.has_target = 0;
    good = !bcifs_editor_constrain(desk.editor, &constraint, NULL) &&
           !bcifs_editor_move(desk.editor, &(bcifs_move){0, 1, 1}, 1, NULL);
    ok(good && fabs(area_now(desk.editor) - 3 * area) < 1e-12 * fabs(area), "and is kept from then on");
    constraint.keep_area = 0;
    good = !bcifs_editor_constrain(desk.editor, &constraint, NULL) &&
           !bcifs_editor_move(desk.editor, &(bcifs_move){0, 1, 1}, 1, NULL);
    double free_area = area_now(desk.editor);
    double deformed[2 * MOST];
    bcifs_editor_read(desk.editor, BCIFS_DEFORMED, deformed);
    ok(good && fabs(free_area - 3 * area) > 1e-3 && apart(desk.editor, BCIFS_RESULT, deformed) == 0,
       "without keeping it the deformed curve is the answer");
    constraint.keep_area = 1;
    good = !bcifs_editor_constrain(desk.editor, &constraint, NULL) &&
           !bcifs_editor_move(desk.editor, &(bcifs_move){1, 1, -1}, 1, NULL);
    ok(good && fabs(area_now(desk.editor) - free_area) < 1e-12 * fabs(area), "whose area is kept next");
    good = bcifs_editor_undo(desk.editor) && bcifs_editor_undo(desk.editor) &&
           !bcifs_editor_move(desk.editor, &(bcifs_move){1, 1, -1}, 1, NULL);
    ok(good && fabs(area_now(desk.editor) - 3 * area) < 1e-12 * fabs(area), "undo brings back the area too");
    desk_close(&desk);
}

/* Of an open curve the area between it and its chord is kept: by the shoelace formula on a thousand of its
 * points, whose error falls with the square of their number. */
static void test_chord(void)
{
    struct desk desk;
    bool good =
        desk_open(&desk, false, 2, 1) && !bcifs_editor_move(desk.editor, &(bcifs_move){0, 1, -2}, 1, NULL);
    double areas[2][2];
    for (int stage = 0; stage < 2; stage++)
        for (unsigned fine = 0; fine < 2; fine++) {
            bcifs_figure *figure = NULL;
            bcifs_plan *plan = NULL;
            bcifs_walker *walker = NULL;
            static double p[2 * 4096];
            good =
                good &&
                !bcifs_editor_figure(desk.editor, stage ? BCIFS_RESULT : BCIFS_INITIAL, 0, &figure, NULL) &&
                !bcifs_plan_create(figure, &(bcifs_view){.depth = 6 + fine, .to = 1}, &plan, NULL) &&
                !bcifs_walker_create(plan, &walker, NULL);
            size_t count = good ? bcifs_walker_next(walker, p, 4096) : 0;
            areas[stage][fine] = 0;
            for (size_t i = 0; i < count; i++) {
                size_t j = (i + 1) % count;
                areas[stage][fine] += (p[2 * i] * p[2 * j + 1] - p[2 * j] * p[2 * i + 1]) / 2;
            }
            bcifs_walker_free(walker);
            bcifs_plan_free(plan);
            bcifs_figure_free(figure);
        }
    double first = (4 * areas[0][1] - areas[0][0]) / 3, second = (4 * areas[1][1] - areas[1][0]) / 3;
    ok(good && fabs(first - second) < 1e-10 * fabs(first),
       "an open curve keeps the area above its chord: %.12g, %.12g", first, second);
    desk_close(&desk);
}

/* ---- Wrong calls --------------------------------------------------------------------------------------- */

static void test_refusals(void)
{
    struct desk desk;
    bcifs_error error;
    double before[2 * MOST];
    const double bad[] = {NAN, INFINITY, -INFINITY};
    if (!ok(desk_open(&desk, true, 1, 1), "an editor"))
        return;
    bcifs_editor_read(desk.editor, BCIFS_RESULT, before);
    ok(bcifs_editor_drag(desk.editor, 1, 1, &error) == BCIFS_INPUT && strstr(error.message, "grabbed"),
       "a drag of nothing");
    ok(bcifs_editor_release(desk.editor, &error) == BCIFS_INPUT && strstr(error.message, "grabbed"),
       "a release of nothing");
    ok(bcifs_editor_grab(desk.editor, (size_t[]){0, 8}, 2, &error) == BCIFS_INPUT &&
           strstr(error.message, "no control point 8 at this level; it has 8"),
       "a point that there is not: %s", error.message);
    ok(bcifs_editor_move(desk.editor, &(bcifs_move){SIZE_MAX, 1, 1}, 1, &error) == BCIFS_INPUT,
       "nor the last of all");
    for (int k = 0; k < 3; k++) {
        bool good = bcifs_editor_move(desk.editor, &(bcifs_move){0, bad[k], 1}, 1, &error) == BCIFS_INPUT &&
                    bcifs_editor_move(desk.editor, &(bcifs_move){0, 1, bad[k]}, 1, &error) == BCIFS_INPUT;
        good = good && !bcifs_editor_grab(desk.editor, grabbed, 2, NULL) &&
               !bcifs_editor_drag(desk.editor, 1, 0, NULL) &&
               bcifs_editor_drag(desk.editor, bad[k], 0, &error) == BCIFS_INPUT &&
               bcifs_editor_drag(desk.editor, 0, bad[k], &error) == BCIFS_INPUT &&
               strstr(error.message, "finite") && !bcifs_editor_release(desk.editor, NULL) &&
               bcifs_editor_undo(desk.editor);
        ok(good, "a displacement of %g", bad[k]);
    }
    bcifs_constraint constraint = constraint_of(BCIFS_FREE_SCALE, -1);
    ok(bcifs_editor_constrain(desk.editor, &constraint, &error) == BCIFS_INPUT &&
           strstr(error.message, "alpha"),
       "alpha below 0");
    constraint.alpha = NAN;
    ok(bcifs_editor_constrain(desk.editor, &constraint, &error) == BCIFS_INPUT, "alpha that is none");
    constraint.alpha = 1e308;
    ok(bcifs_editor_constrain(desk.editor, &constraint, &error) == BCIFS_INPUT &&
           strstr(error.message, "alpha"),
       "alpha beyond all range");
    constraint = constraint_of(BCIFS_FREE_LIST, 1);
    constraint.list = (size_t[]){3, 9};
    constraint.list_count = 2;
    ok(bcifs_editor_constrain(desk.editor, &constraint, &error) == BCIFS_INPUT &&
           strstr(error.message, "point 9"),
       "a list with a point that there is not");
    constraint.list_count = 1;
    constraint.pins = (size_t[]){8};
    constraint.pin_count = 1;
    ok(bcifs_editor_constrain(desk.editor, &constraint, &error) == BCIFS_INPUT &&
           strstr(error.message, "point 8"),
       "a pin that there is not");
    constraint = constraint_of(BCIFS_FREE_SCALE, 1);
    constraint.has_target = 1;
    constraint.target = NAN;
    ok(bcifs_editor_constrain(desk.editor, &constraint, &error) == BCIFS_INPUT, "an area that is none");
    ok(bcifs_editor_coarsen(desk.editor, 5, &error) == BCIFS_INPUT &&
           strstr(error.message, "can be coarsened 3 times only; 4 need a multiple of 16 pieces"),
       "too many levels: %s", error.message);
    ok(bcifs_editor_level(desk.editor) == 1 && bcifs_editor_scale_points(desk.editor) == 8,
       "the level stays");
    ok(!bcifs_editor_undo(desk.editor) && apart(desk.editor, BCIFS_RESULT, before) == 0,
       "and so does the curve");
    ok(bcifs_editor_grab(desk.editor, NULL, 0, NULL) == BCIFS_OK &&
           bcifs_editor_drag(desk.editor, 1, 1, NULL) == BCIFS_OK &&
           bcifs_editor_release(desk.editor, NULL) == BCIFS_OK,
       "grabbing no point is no error");
    bcifs_editor *none = NULL;
    ok(bcifs_editor_create(desk.figure, &(bcifs_editor_options){.refine = 100}, &none, &error) ==
               BCIFS_INPUT &&
           !none,
       "too fine: %s", error.message);
    bcifs_editor_free(NULL);
    desk_close(&desk);
}

/* Zero-area curves on which nothing is free are no failure, far from the origin either. */
static void test_nothing_to_do(void)
{
    struct desk desk;
    bcifs_constraint constraint = constraint_of(BCIFS_FREE_LIST, 1);
    bcifs_editor *editor = NULL;
    bcifs_figure *figure = NULL;
    double line[16];
    for (size_t i = 0; i < 8; i++) {
        line[2 * i] = 1e6 + (double)(i * i % 5) / 3;
        line[2 * i + 1] = 1 - line[2 * i] / 7;
    }
    bool good = desk_open(&desk, true, 0, 0);
    const bcifs_figure_options options = {
        .figure = "square", .points = line, .point_count = 8, .dimension = 2};
    good = good && !bcifs_figure_create(desk.automaton, &options, &figure, NULL) &&
           !bcifs_editor_create(figure, &(bcifs_editor_options){2, 2, BCIFS_BENDING}, &editor, NULL) &&
           !bcifs_editor_constrain(editor, &constraint, NULL) && !bcifs_editor_move(editor, NULL, 0, NULL) &&
           !bcifs_editor_move(editor, &(bcifs_move){0, 0, 0}, 1, NULL);
    ok(good, "nothing is free and nothing is to be done");
    ok(bcifs_editor_move(editor, &(bcifs_move){0, 0, 1}, 1, NULL) == BCIFS_NO,
       "unless a point moves off the line");
    bcifs_editor_free(editor);
    bcifs_figure_free(figure);
    desk_close(&desk);
}

/* ---- What rounding must not decide --------------------------------------------------------------------- */

/* A segment closed by its chord has no area wherever its ends are, however often it is subdivided: rounding
 * is no sensitivity. Of the figure `chains` the second chain is one. */
static void test_insensitive(void)
{
    bcifs_automaton *automaton = NULL;
    bcifs_figure *figure = NULL;
    int wrong = 0;
    bool good = !bcifs_load_text("extra", curves_extra, strlen(curves_extra), NULL, &automaton, NULL) &&
                !bcifs_figure_create(automaton, &(bcifs_figure_options){.figure = "chains"}, &figure, NULL);
    for (unsigned levels = 0; levels <= 3 && good; levels++)
        for (int energy = 0; energy < 3; energy++) {
            bcifs_editor *editor = NULL;
            bcifs_error error = {.message = ""};
            bcifs_constraint constraint = constraint_of(BCIFS_FREE_NEAR, pow(10, 3 * random_number(&seed)));
            const bcifs_move move = {3, random_number(&seed), random_number(&seed)};
            good = !bcifs_editor_create(figure, &(bcifs_editor_options){levels, levels, (bcifs_energy)energy},
                                        &editor, NULL) &&
                   !bcifs_editor_constrain(editor, &constraint, NULL) &&
                   bcifs_editor_move(editor, &move, 1, &error) == BCIFS_OK;
            constraint.has_target = 1;
            constraint.target = 7;
            good = good && !bcifs_editor_constrain(editor, &constraint, NULL) &&
                   bcifs_editor_move(editor, &move, 1, &error) == BCIFS_NO &&
                   strstr(error.message, "does not depend");
            if (!good && ++wrong)
                note("%u levels, energy %d: %s", levels, energy, error.message);
            bcifs_editor_free(editor);
        }
    ok(good && wrong == 0, "the area of a segment depends on nothing");
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
}

/* The energy of a coarse level is a small remainder of large sums: without α rounding can leave it below 0.
 */
static void test_semidefinite(void)
{
    static const char *const names[] = {"ternary", "open_ternary", "quintic", "open_quintic", "dense"};
    bcifs_automaton *automaton = NULL;
    int wrong = 0, tried = 0;
    bcifs_load_text("extra", curves_extra, strlen(curves_extra), NULL, &automaton, NULL);
    for (unsigned levels = 0; levels <= 5; levels++)
        for (size_t k = 0; k < 5; k++) {
            bcifs_figure *figure = NULL;
            bcifs_editor *editor = NULL;
            bcifs_error error = {.message = ""};
            bcifs_edit_report report = {0};
            const bcifs_editor_options options = {levels, levels, BCIFS_BENDING};
            const bcifs_constraint constraint =
                constraint_of(levels % 2 ? BCIFS_FREE_ALL : BCIFS_FREE_SCALE, 0);
            bool good =
                !bcifs_figure_create(automaton, &(bcifs_figure_options){.figure = names[k]}, &figure, NULL) &&
                !bcifs_editor_create(figure, &options, &editor, &error) &&
                !bcifs_editor_constrain(editor, &constraint, &error) &&
                !bcifs_editor_move(editor, &(bcifs_move){1, 1, 0.5}, 1, &error);
            if (good)
                bcifs_editor_report(editor, &report);
            tried++;
            if ((!good || !(report.relative_error < 1e-10)) && ++wrong)
                note("%s, %u levels: error %g %s", names[k], levels, report.relative_error, error.message);
            bcifs_editor_free(editor);
            bcifs_figure_free(figure);
        }
    ok(wrong == 0, "alpha may be 0 over many levels (%d curves)", tried);
    bcifs_automaton_free(automaton);
}

/* ---- Memory -------------------------------------------------------------------------------------------- */

enum { JOBS = 7 };

/* One call of each kind; what went before has succeeded. */
static bcifs_status job_run(struct desk *desk, int job, bcifs_error *error)
{
    size_t list[] = {1, 3}, pins[] = {0};
    bcifs_constraint constraint = constraint_of(BCIFS_FREE_ALL, 1);
    bcifs_editor *second = NULL;
    bcifs_figure *figure = NULL;
    bcifs_status status = BCIFS_OK;
    constraint.list = list;
    constraint.list_count = 2;
    constraint.pins = pins;
    constraint.pin_count = 1;
    switch (job) {
    case 0:
        status =
            bcifs_editor_create(desk->figure, &(bcifs_editor_options){3, 2, BCIFS_BENDING}, &second, error);
        bcifs_editor_free(second);
        return status;
    case 1:
        return bcifs_editor_constrain(desk->editor, &constraint, error);
    case 2:
        return bcifs_editor_grab(desk->editor, grabbed, 2, error);
    case 3:
        return bcifs_editor_move(desk->editor, &(bcifs_move){2, 1, 1}, 1, error);
    case 4:
        return bcifs_editor_coarsen(desk->editor, 1, error);
    case 5:
        status = bcifs_editor_figure(desk->editor, BCIFS_RESULT, 1, &figure, error);
        bcifs_figure_free(figure);
        return status;
    default: /* a whole drag; undo and redo ask for nothing */
        status = bcifs_editor_grab(desk->editor, grabbed, 2, error);
        for (int k = 0; k < 3 && status == BCIFS_OK; k++)
            status = bcifs_editor_drag(desk->editor, 3 * k, k, error);
        if (status == BCIFS_OK)
            status = bcifs_editor_release(desk->editor, error);
        return status;
    }
}

/* A failure is BCIFS_MEMORY, leaves the curve as it was once the attempt is dropped, and loses no block. */
static void test_memory(void)
{
    static const char *const names[JOBS] = {"create",  "constrain", "grab", "move",
                                            "coarsen", "figure",    "drag"};
    for (int job = 0; job < JOBS; job++) {
        struct desk desk;
        double before[2 * MOST], after[2 * MOST];
        bcifs_error error;
        long at_start = alive, requests = 0;
        const bcifs_constraint all = constraint_of(BCIFS_FREE_ALL, 1);
        bool good = desk_open(&desk, true, 4, 2) && !bcifs_editor_constrain(desk.editor, &all, NULL);
        bcifs_editor_read(desk.editor, BCIFS_RESULT, before);
        for (bool done = false; !done && good; requests++) {
            fail_after = requests + 1;
            bcifs_status status = job_run(&desk, job, &error);
            done = fail_after > 0;
            fail_after = 0;
            good = done ? status == BCIFS_OK : status == BCIFS_MEMORY && error.message[0];
            if (!done) {
                if (job == 3)
                    good = good && apart(desk.editor, BCIFS_RESULT, before) == 0;
                while (bcifs_editor_undo(desk.editor)) {
                }
                good =
                    good && apart(desk.editor, BCIFS_RESULT, before) == 0 && isfinite(area_now(desk.editor));
            }
            if (!good)
                note("%s, request %ld: status %d, %s", names[job], requests, status, error.message);
        }
        /* The session goes on as if nothing had happened. */
        bcifs_editor_read(desk.editor, BCIFS_RESULT, after);
        good = good && !bcifs_editor_move(desk.editor, &(bcifs_move){1, 0.5, 0}, 1, NULL) &&
               bcifs_editor_undo(desk.editor) &&
               apart(desk.editor, BCIFS_RESULT, job == 2 ? before : after) == 0;
        desk_close(&desk);
        ok(good && alive == at_start && requests > 1, "%s: each of %ld requests may fail", names[job],
           requests - 1);
    }
    ok(alive == 0, "all blocks are back");
}

int main(void)
{
    test_drags();
    test_history();
    test_failing_drags();
    test_unreleased();
    test_targets();
    test_chord();
    test_refusals();
    test_nothing_to_do();
    test_insensitive();
    test_semidefinite();
    test_memory();
    return done_testing();
}
