#include "fit.h"

#include <math.h>
#include <string.h>

#include "language/outline.h"
#include "multires/feet.h"
#include "multires/least_squares.h"
#include "numeric/tolerance.h"

enum {
    LEAST_ROWS = 1024,      /* limit points that distances are measured to: at least so many, */
    ROWS_PER_FUNCTION = 32, /* and so many for each control point */
    LEAST_POINTS = 1024,    /* the same of points of the target */
    POINTS_PER_FUNCTION = 16,
    DENSE = 8, /* with so many for each control point listed they are what is meant, not the lines between */
    POINTS_WHEN_DENSE = 2, /* them, except for long ones */
    MOST_WANTED = 1 << 20,
    WINDOW = 128, /* segments that a parameter may move by in one step */
    MOST_ITERATIONS = 100,
    MOST_CALM = 3, /* steps of small effect before the end */
    SHIFTS = 8,    /* places of the start within a piece, */
    MOST_SHIFTS = 64
};

/* Points may slide this freely at most (μ of least_squares.h). */
static const double LEAST_SLACK = 1e-6;

/* Control points, where on their curve the target's points are, and how far from it. */
struct state_of_fit {
    double *x;         /* functions × dimension */
    double *positions; /* target.count */
    double rms, maximum;
};

struct fitting {
    struct arena arena;
    struct report *report;
    bcifs_figure *figure;
    struct blending blending;
    struct target target;
    double *polyline, *directions;
    struct feet feet;
    struct state_of_fit best, trial;
    unsigned iterations;
};

/* ---- Preparation --------------------------------------------------------------------------------------- */

static size_t wanted_points(size_t least, size_t factor, size_t functions)
{
    size_t wanted = functions > MOST_WANTED / factor ? MOST_WANTED : factor * functions;
    return wanted < least ? least : wanted;
}

/* The figure with the number of pieces asked for; it must be one curve. */
static bcifs_status figure_make(struct fitting *fitting, const bcifs_automaton *automaton,
                                const bcifs_fit_options *options)
{
    bcifs_error error;
    const bcifs_figure_options choice = {.figure = options->figure,
                                         .state = options->state,
                                         .pieces = options->pieces,
                                         .unplaced = options->state != NULL};
    if (options->pieces > BASIS_MOST_FUNCTIONS)
        return report_failure(fitting->report, BCIFS_INPUT, NULL,
                              "%zu pieces have more blending functions than the limit, %d", options->pieces,
                              BASIS_MOST_FUNCTIONS);
    bcifs_status status = bcifs_figure_create(automaton, &choice, &fitting->figure, &error);
    if (status) {
        fitting->report->first = error;
        fitting->report->errors++;
        return status;
    }
    const bcifs_figure *figure = fitting->figure;
    if (figure->shape != FIGURE_CURVE || figure->chain_count != 1)
        return report_failure(fitting->report, BCIFS_INPUT, NULL,
                              "'%s' is not one curve; only that can be fitted", figure->name);
    return BCIFS_OK;
}

/* The depth with a little more than `wanted` limit points, unless the table would be too large. */
static unsigned depth_choose(const bcifs_figure *figure, size_t wanted)
{
    size_t width = 1;
    for (size_t i = 0; i < figure->piece_count; i++) {
        size_t points = figure->states.states[figure->pieces[i].state].points;
        width = points > width ? points : width;
    }
    unsigned depth = bcifs_figure_depth(figure, wanted) + 1;
    unsigned most = bcifs_figure_depth(figure, BLENDING_MOST_NUMBERS / width);
    return depth < most ? depth : most;
}

static bool state_new(struct fitting *fitting, struct state_of_fit *state)
{
    state->x =
        arena_new(&fitting->arena, fitting->blending.functions * fitting->target.dimension, sizeof *state->x);
    state->positions = arena_new(&fitting->arena, fitting->target.count, sizeof *state->positions);
    state->rms = INFINITY;
    return state->x && state->positions;
}

static bcifs_status workspace_make(struct fitting *fitting)
{
    struct arena *arena = &fitting->arena;
    const struct blending *blending = &fitting->blending;
    size_t count = fitting->target.count, dimension = fitting->target.dimension;
    fitting->polyline = arena_new(arena, blending->rows * dimension, sizeof *fitting->polyline);
    fitting->directions = arena_new(arena, count * dimension, sizeof *fitting->directions);
    fitting->feet = (struct feet){.blending = blending,
                                  .target = &fitting->target,
                                  .polyline = fitting->polyline,
                                  .window = WINDOW,
                                  .means = arena_new(arena, count, sizeof *fitting->feet.means),
                                  .before = arena_new(arena, count, sizeof *fitting->feet.before),
                                  .counts = arena_new(arena, count, sizeof *fitting->feet.counts)};
    bool good = fitting->polyline && fitting->directions && fitting->feet.means && fitting->feet.before &&
                fitting->feet.counts && state_new(fitting, &fitting->best) &&
                state_new(fitting, &fitting->trial);
    return good ? BCIFS_OK : report_memory(fitting->report);
}

static bcifs_status prepare(struct fitting *fitting, const bcifs_automaton *automaton,
                            const bcifs_curve *curve, const bcifs_fit_options *options)
{
    bcifs_status status = figure_make(fitting, automaton, options);
    if (status)
        return status;
    size_t functions = fitting->figure->point_count;
    bool closed = fitting->figure->chains[0].closed;
    size_t wanted = wanted_points(LEAST_POINTS, POINTS_PER_FUNCTION, functions);
    if (!bcifs_curve_is_cubic(curve) && curve->count / DENSE >= functions)
        wanted = wanted_points(0, POINTS_WHEN_DENSE, functions);
    status = target_create(&fitting->target, curve, closed, wanted, &fitting->arena, fitting->report);
    if (status)
        return status;
    size_t rows = wanted_points(LEAST_ROWS, ROWS_PER_FUNCTION, functions);
    rows = rows < fitting->target.count ? fitting->target.count : rows;
    unsigned depth = options->depth ? options->depth : depth_choose(fitting->figure, rows);
    status = blending_create(&fitting->blending, fitting->figure, depth, &fitting->arena, fitting->report);
    return status ? status : workspace_make(fitting);
}

/* ---- Measuring ----------------------------------------------------------------------------------------- */

/* Distances at the state's positions from the polyline that was drawn last. */
static void measure(const struct fitting *fitting, struct state_of_fit *state)
{
    state->rms = feet_distance(&fitting->feet, state->positions);
    state->maximum = 0;
    for (size_t j = 0; j < fitting->target.count; j++)
        state->maximum = fmax(state->maximum, foot_distance(&fitting->feet, j, state->positions[j]));
}

static void draw(struct fitting *fitting, const struct state_of_fit *state)
{
    blending_polyline(&fitting->blending, state->x, fitting->target.dimension, fitting->polyline);
}

static void state_keep(struct fitting *fitting)
{
    struct state_of_fit before = fitting->best;
    fitting->best = fitting->trial;
    fitting->trial = before;
}

static void state_copy(const struct fitting *fitting, const struct state_of_fit *from,
                       struct state_of_fit *to)
{
    memcpy(to->x, from->x, fitting->blending.functions * fitting->target.dimension * sizeof *to->x);
    memcpy(to->positions, from->positions, fitting->target.count * sizeof *to->positions);
}

/* ---- The start ----------------------------------------------------------------------------------------- */

/* How many places of a closed curve's start are tried, and how far they are apart. Curves all of whose pieces
 * are in one state look the same from each of them. */
static size_t shifts_choose(const struct fitting *fitting, double *step)
{
    const bcifs_figure *figure = fitting->figure;
    bool alike = true;
    for (size_t i = 1; i < figure->piece_count; i++)
        alike = alike && figure->pieces[i].state == figure->pieces[0].state;
    if (!fitting->blending.closed)
        return 1;
    if (alike) {
        *step = 1 / ((double)figure->piece_count * SHIFTS);
        return SHIFTS;
    }
    size_t count = figure->piece_count > MOST_SHIFTS / SHIFTS ? MOST_SHIFTS : figure->piece_count * SHIFTS;
    *step = 1 / (double)count;
    return count;
}

/* Fits at given parameters (0..1, one for each point of the target) shifted by `shift`; keeps it if it is
 * better by more than rounding. */
static bcifs_status start_try(struct fitting *fitting, const double *parameters, double shift)
{
    struct state_of_fit *trial = &fitting->trial;
    size_t numbers = fitting->blending.functions * fitting->target.dimension;
    double whole = (double)fitting->blending.segments;
    for (size_t j = 0; j < fitting->target.count; j++) {
        double t = parameters[j] + shift, turns = fitting->blending.closed ? floor(t) : 0;
        trial->positions[j] = blending_position(&fitting->blending, t - turns) + turns * whole;
    }
    memset(trial->x, 0, numbers * sizeof *trial->x);
    const struct least_squares problem = {&fitting->blending, &fitting->target, trial->positions, NULL, 1};
    bcifs_status status = least_squares_solve(&problem, trial->x, fitting->report);
    if (status)
        return status;
    draw(fitting, trial);
    measure(fitting, trial);
    if (trial->rms < fitting->best.rms - TOLERANCE_RADIUS * trial->rms)
        state_keep(fitting);
    return BCIFS_OK;
}

static bcifs_status start(struct fitting *fitting)
{
    const struct target *target = &fitting->target;
    double step = 0, difference = 0;
    size_t shifts = shifts_choose(fitting, &step);
    bcifs_status status = BCIFS_OK;
    for (size_t j = 0; j < target->count; j++)
        difference = fmax(difference, fabs(target->shares[j] - target->lengths[j]));
    for (size_t i = 0; i < shifts && status == BCIFS_OK; i++) {
        double shift = i > shifts / 2 ? -(double)(shifts - i) * step : (double)i * step; /* small ones */
        status = start_try(fitting, target->lengths, shift);
        if (status == BCIFS_OK && difference > TOLERANCE_EQUATION)
            status = start_try(fitting, target->shares, shift);
    }
    return status;
}

/* ---- The alternation ----------------------------------------------------------------------------------- */

/* The directions in which points may slide: along the curve, but not at the ends of an open one. */
static void directions_find(struct fitting *fitting, const struct state_of_fit *state)
{
    unsigned dimension = fitting->target.dimension;
    double whole = (double)fitting->blending.segments;
    for (size_t j = 0; j < fitting->target.count; j++) {
        double *direction = fitting->directions + j * dimension, position = state->positions[j];
        if (!fitting->blending.closed && (position <= 0 || position >= whole))
            memset(direction, 0, dimension * sizeof *direction);
        else
            foot_direction(&fitting->feet, position, direction);
    }
}

/* One step from the best state: control points at its positions, then new positions. */
static bcifs_status step_try(struct fitting *fitting, double slack)
{
    struct state_of_fit *trial = &fitting->trial;
    draw(fitting, &fitting->best);
    directions_find(fitting, &fitting->best);
    state_copy(fitting, &fitting->best, trial);
    const struct least_squares problem = {&fitting->blending, &fitting->target, fitting->best.positions,
                                          slack < 1 ? fitting->directions : NULL, slack};
    bcifs_status status = least_squares_solve(&problem, trial->x, fitting->report);
    if (status)
        return status;
    draw(fitting, trial);
    feet_find(&fitting->feet, trial->positions);
    measure(fitting, trial);
    return BCIFS_OK;
}

/* Points slide the more freely the better that goes, as in Levenberg and Marquardt's method. A step that does
 * not lower the error is taken back. */
static bcifs_status improve(struct fitting *fitting, unsigned most)
{
    double slack = 1;
    int calm = 0;
    draw(fitting, &fitting->best);
    feet_find(&fitting->feet, fitting->best.positions);
    measure(fitting, &fitting->best);
    while (fitting->iterations < most && calm < MOST_CALM && fitting->best.rms > TOLERANCE_FITTED) {
        double before = fitting->best.rms;
        bcifs_status status = step_try(fitting, slack);
        if (status)
            return status;
        fitting->iterations++;
        if (fitting->trial.rms < before) {
            state_keep(fitting);
            calm = before - fitting->best.rms < TOLERANCE_FALL * before ? calm + 1 : 0;
            slack = fmax(slack / 10, LEAST_SLACK);
        } else if (slack == 1) {
            break;
        } else {
            slack = fmin(1, 20 * slack);
        }
    }
    return BCIFS_OK;
}

/* ---- The handle ---------------------------------------------------------------------------------------- */

/* Back to the target's coordinates. */
static bcifs_status result_fill(const struct fitting *fitting, const bcifs_automaton *automaton,
                                bcifs_fit *fit)
{
    const struct target *target = &fitting->target;
    unsigned dimension = target->dimension;
    *fit = (bcifs_fit){.automaton = automaton,
                       .figure = fitting->figure->name,
                       .count = fitting->blending.functions,
                       .pieces = fitting->figure->piece_count,
                       .dimension = dimension,
                       .iterations = fitting->iterations,
                       .rms = fitting->best.rms * target->scale,
                       .maximum = fitting->best.maximum * target->scale,
                       .closed = fitting->blending.closed};
    fit->points = memory_new(fit->count, dimension * sizeof *fit->points);
    if (!fit->points)
        return report_memory(fitting->report);
    for (size_t i = 0; i < fit->count * dimension; i++) {
        fit->points[i] = target->center[i % dimension] + target->scale * fitting->best.x[i];
        if (!isfinite(fit->points[i]))
            return report_failure(
                fitting->report, BCIFS_INPUT, NULL,
                "the control points do not fit into the range of numbers; scale the target");
    }
    return BCIFS_OK;
}

bcifs_status bcifs_fit_create(const bcifs_automaton *automaton, const bcifs_curve *target,
                              const bcifs_fit_options *options, bcifs_fit **fit, bcifs_error *error)
{
    static const bcifs_fit_options defaults = {0};
    struct report report = report_new(NULL);
    struct fitting fitting = {.report = &report};
    options = options ? options : &defaults;
    bcifs_fit *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? BCIFS_OK : report_memory(&report);
    if (status == BCIFS_OK)
        status = prepare(&fitting, automaton, target, options);
    if (status == BCIFS_OK)
        status = start(&fitting);
    if (status == BCIFS_OK && fitting.target.dimension > 1)
        status = improve(&fitting, options->iterations ? options->iterations : MOST_ITERATIONS);
    if (status == BCIFS_OK)
        status = result_fill(&fitting, automaton, fresh);
    bcifs_figure_free(fitting.figure);
    arena_free(&fitting.arena);
    if (status) {
        bcifs_fit_free(fresh);
        report_close(&report, error);
        return status;
    }
    *fit = fresh;
    return BCIFS_OK;
}

void bcifs_fit_free(bcifs_fit *fit)
{
    if (!fit)
        return;
    memory_free(fit->points);
    memory_free(fit);
}

const double *bcifs_fit_points(const bcifs_fit *fit, size_t *count)
{
    *count = fit->count;
    return fit->points;
}

unsigned bcifs_fit_dimension(const bcifs_fit *fit)
{
    return fit->dimension;
}

size_t bcifs_fit_pieces(const bcifs_fit *fit)
{
    return fit->pieces;
}

double bcifs_fit_rms(const bcifs_fit *fit)
{
    return fit->rms;
}

double bcifs_fit_maximum(const bcifs_fit *fit)
{
    return fit->maximum;
}

unsigned bcifs_fit_iterations(const bcifs_fit *fit)
{
    return fit->iterations;
}
