#include "parameter_map.h"

#include <math.h>
#include <pthread.h>
#include <string.h>
#include <unistd.h>

#include "analysis/smoothness.h"
#include "analysis/tangent.h"
#include "automaton/figure.h"
#include "automaton/proof.h"
#include "automaton/restriction.h"
#include "base/decimal.h"
#include "numeric/field.h"
#include "numeric/matrix.h"
#include "numeric/tolerance.h"

enum {
    MOST_STARTS = 256, /* states whose class is asked for */
    MOST_STATES = 512, /* reached from them */
    MOST_COUNT_DIGITS = 8,
    CHUNK = 16,             /* grid points that a thread takes at a time */
    STACK = 8 * 1024 * 1024 /* of a thread: trees of expressions are walked by recursion */
};

/* What a search may spend at one grid point, as shares of what it may spend on one automaton alone. Most
 * points are far from where their class changes, and the least of searches tells. */
static const double EFFORTS[] = {1.0 / 1024, 1.0 / 32};
enum { EFFORT_COUNT = sizeof EFFORTS / sizeof EFFORTS[0] };

/* ---- Axes ---------------------------------------------------------------------------------------------- */

static bcifs_status axis_refuse(struct report *report, const char *axis)
{
    return report_failure(
        report, BCIFS_INPUT, NULL,
        "--over %s: expected NAME=LOW..HIGH:COUNT with numbers LOW < HIGH and 2 <= COUNT <= %d", axis,
        MAP_MOST_POINTS);
}

/* A number expression without names, `length` bytes of text. */
static bcifs_status number_evaluate(struct arena *arena, const char *name, const char *text, size_t length,
                                    struct report *report, struct value *value)
{
    struct source *source;
    struct expression *expression;
    const struct scope none = {0};
    bcifs_status status = source_from_text(arena, name, text, length, report, &source);
    if (status == BCIFS_OK)
        status = syntax_parse_expression(arena, source, report, &expression);
    if (status == BCIFS_OK)
        status = expression_resolve(expression, &none, NULL, 0, NULL, 0, source, report);
    if (status)
        return status;
    struct environment environment = {.steps = EVALUATION_MOST_STEPS, .source = source, .report = report};
    return expression_evaluate(expression, &environment, value);
}

/* The param that an axis is over; `length` bytes of name. */
static bcifs_status axis_parameter(const bcifs_map *map, const char *text, size_t length,
                                   struct report *report, size_t *found)
{
    const bcifs_automaton *automaton = map->automaton;
    const char *candidates[64];
    size_t count = 0;
    for (size_t i = 0; i < automaton->parameter_count; i++) {
        const struct parameter *parameter = &automaton->parameters[i];
        if (count < 64)
            candidates[count++] = parameter->name;
        if (strlen(parameter->name) != length || memcmp(parameter->name, text, length) != 0)
            continue;
        if (parameter->is_set)
            return report_failure(report, BCIFS_INPUT, NULL, "--over %s: '%s' was given one value", text,
                                  parameter->name);
        if (parameter->structural)
            return report_failure(
                report, BCIFS_INPUT, NULL,
                "--over %s: sizes or indices depend on '%s', so it takes no values in between", text,
                parameter->name);
        *found = i;
        return BCIFS_OK;
    }
    char name[SYNTAX_LONGEST_NAME + 1] = "";
    if (length < sizeof name)
        memcpy(name, text, length);
    const char *nearest = nearest_word(name, candidates, count);
    return report_failure(report, BCIFS_INPUT, NULL, "--over %s: the file has no param '%s'%s%s%s%s", text,
                          name, nearest ? "; did you mean '" : "", nearest ? nearest : "",
                          nearest ? "'?" : "", count ? "" : " (it has none at all)");
}

/* Digits to the end of the text; 0 when that is not a count. */
static size_t count_read(const char *text)
{
    size_t length = strspn(text, "0123456789"), count = 0;
    if (length == 0 || length > MOST_COUNT_DIGITS || text[length] != '\0')
        return 0;
    for (size_t i = 0; i < length; i++)
        count = 10 * count + (size_t)(text[i] - '0');
    return count >= 2 && count <= MAP_MOST_POINTS ? count : 0;
}

/* node k = low + (high - low) k / (count - 1). */
static bcifs_status axis_nodes(struct map_axis *axis, struct value low, struct value high,
                               struct arena *arena, struct report *report)
{
    struct value *nodes = arena_new(arena, axis->count, sizeof *nodes), span = value_subtract(high, low);
    if (!nodes)
        return report_memory(report);
    for (size_t k = 0; k < axis->count; k++) {
        struct value share =
            value_divide(value_from_integer((int64_t)k), value_from_integer((int64_t)axis->count - 1));
        nodes[k] = value_add(low, value_multiply(span, share));
        value_pin(&nodes[k], 0);
        if (k > 0 && !(nodes[k].real > nodes[k - 1].real))
            return report_failure(report, BCIFS_INPUT, NULL,
                                  "--over %s: the range is too small for %zu values", axis->name,
                                  axis->count);
    }
    axis->nodes = nodes;
    return BCIFS_OK;
}

static bcifs_status axis_range(const bcifs_map *map, const struct map_axis *axis, const char *text,
                               double low, double high, struct report *report)
{
    const struct parameter *parameter = &map->automaton->parameters[axis->parameter];
    if (!(low < high))
        return axis_refuse(report, text);
    if (!parameter->has_range || (low >= parameter->low && high <= parameter->high))
        return BCIFS_OK;
    char words[2][DECIMAL_LONGEST + 1];
    words[0][decimal_print(words[0], parameter->low)] = '\0';
    words[1][decimal_print(words[1], parameter->high)] = '\0';
    return report_failure(report, BCIFS_INPUT, NULL, "--over %s: the range of '%s' is %s..%s", text,
                          axis->name, words[0], words[1]);
}

/* NAME=LOW..HIGH:COUNT */
static bcifs_status axis_read(bcifs_map *map, const char *text, struct report *report)
{
    struct map_axis *axis = &map->axes[map->axis_count];
    const char *equals = strchr(text, '='), *dots = equals ? strstr(equals, "..") : NULL;
    const char *colon = dots ? strrchr(dots, ':') : NULL;
    struct value low, high;
    if (!colon || (axis->count = count_read(colon + 1)) == 0)
        return axis_refuse(report, text);
    bcifs_status status = axis_parameter(map, text, (size_t)(equals - text), report, &axis->parameter);
    if (status)
        return status;
    axis->name = map->automaton->parameters[axis->parameter].name;
    for (size_t i = 0; i < map->axis_count; i++)
        if (map->axes[i].parameter == axis->parameter)
            return report_failure(report, BCIFS_INPUT, NULL, "--over %s: '%s' has an axis already", text,
                                  axis->name);
    status = number_evaluate(&map->arena, axis->name, equals + 1, (size_t)(dots - equals - 1), report, &low);
    if (status == BCIFS_OK)
        status =
            number_evaluate(&map->arena, axis->name, dots + 2, (size_t)(colon - dots - 2), report, &high);
    if (status == BCIFS_OK)
        status = axis_range(map, axis, text, low.real, high.real, report);
    if (status == BCIFS_OK)
        status = axis_nodes(axis, low, high, &map->arena, report);
    map->axis_count++;
    return status;
}

static bcifs_status axes_read(bcifs_map *map, const char *const *axes, size_t count, struct report *report)
{
    if (count < 1 || count > MAP_MOST_AXES)
        return report_failure(report, BCIFS_INPUT, NULL,
                              "a map is over one or two params, each given as --over NAME=LOW..HIGH:COUNT");
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < count && status == BCIFS_OK; i++)
        status = axis_read(map, axes[i], report);
    if (status)
        return status;
    map->columns = map->axes[0].count;
    map->rows = count > 1 ? map->axes[1].count : 1;
    if (map->rows > MAP_MOST_POINTS / map->columns)
        return report_failure(report, BCIFS_INPUT, NULL,
                              "--over: %zu x %zu grid points; a map has at most %d", map->columns, map->rows,
                              MAP_MOST_POINTS);
    map->classes = arena_new(&map->arena, map->columns * map->rows, 1);
    return map->classes ? BCIFS_OK : report_memory(report);
}

/* ---- Values -------------------------------------------------------------------------------------------- */

/* What the grid points have in common. */
struct survey {
    bcifs_map *map;
    bool *follows; /* per parameter: its default depends on an axis, so it is evaluated for every point */
    const struct definition
        *starts[MOST_STARTS]; /* without arguments; none: the pieces of the first figure */
    size_t start_count;
    double effort;
    bcifs_progress *progress;
    void *context;
    pthread_mutex_t lock;
    /* Guarded by the lock: */
    size_t next;
    bcifs_status status;
};

static bool is_axis(const bcifs_map *map, size_t parameter)
{
    for (size_t i = 0; i < map->axis_count; i++)
        if (map->axes[i].parameter == parameter)
            return true;
    return false;
}

/* `param b = 1-a` follows a, unless it was set. Only earlier params occur in a default. */
static bcifs_status followers_find(struct survey *survey, struct report *report)
{
    const bcifs_automaton *automaton = survey->map->automaton;
    struct arena *arena = &survey->map->arena;
    survey->follows = arena_new(arena, automaton->parameter_count, sizeof *survey->follows);
    bool *occurs = arena_new(arena, automaton->parameter_count, sizeof *occurs);
    if (!survey->follows || !occurs)
        return report_memory(report);
    for (size_t i = 0; i < automaton->parameter_count; i++) {
        const struct parameter *parameter = &automaton->parameters[i];
        bool arguments[SYNTAX_MOST_ARGUMENTS] = {false};
        if (parameter->is_set || is_axis(survey->map, i))
            continue;
        memset(occurs, 0, automaton->parameter_count * sizeof *occurs);
        expression_mark(parameter->syntax->value, occurs, arguments);
        for (size_t j = 0; j < i; j++)
            if (occurs[j] && (is_axis(survey->map, j) || survey->follows[j]))
                survey->follows[i] = true;
    }
    return BCIFS_OK;
}

/* The params at grid point `point`. */
static bcifs_status values_at(const struct survey *survey, size_t point, struct value *values)
{
    const bcifs_map *map = survey->map;
    const bcifs_automaton *automaton = map->automaton;
    const size_t places[MAP_MOST_AXES] = {point % map->columns, point / map->columns};
    for (size_t i = 0; i < map->axis_count; i++)
        values[map->axes[i].parameter] = map->axes[i].nodes[places[i]];
    for (size_t i = 0; i < automaton->parameter_count; i++) {
        if (!survey->follows[i])
            continue;
        const struct parameter *parameter = &automaton->parameters[i];
        struct environment environment = {.parameters = values,
                                          .known = i,
                                          .steps = EVALUATION_MOST_STEPS,
                                          .source = parameter->module->source};
        bcifs_status status = expression_evaluate(parameter->syntax->value, &environment, &values[i]);
        if (status)
            return status;
    }
    return BCIFS_OK;
}

/* ---- Equations ----------------------------------------------------------------------------------------- */

static bcifs_status verdict(const bcifs_map *map, const bcifs_check *check, struct report *report)
{
    const char *also = map->axis_count > 1 ? " and " : "",
               *other = map->axis_count > 1 ? map->axes[1].name : "";
    for (size_t i = 0; !bcifs_check_valid(check) && i < bcifs_check_equation_count(check); i++) {
        const bcifs_equation *equation = bcifs_check_equation(check, i);
        if (!equation->holds)
            return report_failure(report, BCIFS_NO, equation->file,
                                  "'%s' does not satisfy %s for all %s%s%s; 'bcifs check' shows why",
                                  equation->state, equation->text, map->axes[0].name, also, other);
    }
    return BCIFS_OK;
}

/* The equations hold identically in the params of the axes and those that follow them; others have their
 * values. */
static bcifs_status equations_prove(const struct survey *survey, struct report *report)
{
    const bcifs_map *map = survey->map;
    bcifs_automaton fixed = *map->automaton;
    struct arena arena = {0};
    bcifs_check *check;
    bcifs_error error;
    fixed.parameters = arena_grow(&arena, fixed.parameters, fixed.parameter_count, fixed.parameter_count,
                                  sizeof *fixed.parameters);
    bcifs_status status = fixed.parameters ? BCIFS_OK : report_memory(report);
    for (size_t i = 0; i < fixed.parameter_count && status == BCIFS_OK; i++)
        fixed.parameters[i].is_set = !is_axis(map, i) && !survey->follows[i];
    if (status == BCIFS_OK) {
        status = bcifs_check_create(&fixed, NULL, &check, &error);
        if (status)
            report_failure(report, status, error.file, "%s", error.message);
    }
    if (status == BCIFS_OK) {
        status = verdict(map, check, report);
        bcifs_check_free(check);
    }
    arena_free(&arena);
    return status;
}

/* ---- The states that are asked for --------------------------------------------------------------------- */

static bcifs_status start_named(struct survey *survey, const char *name, struct report *report)
{
    const bcifs_automaton *automaton = survey->map->automaton;
    const char *candidates[256], *file = automaton->modules[0]->source->name;
    size_t count = 0;
    for (size_t i = 0; i < automaton->definition_count; i++) {
        const struct definition *definition = automaton->definitions[i];
        if (count < 256)
            candidates[count++] = definition->name;
        if (strcmp(definition->name, name) != 0)
            continue;
        if (definition->argument_count > 0)
            return report_failure(
                report, BCIFS_INPUT, file,
                "the state '%s' takes arguments; without --state a map is of the first figure's pieces",
                name);
        survey->starts[survey->start_count++] = definition;
        return BCIFS_OK;
    }
    const char *nearest = nearest_word(name, candidates, count);
    return report_failure(report, BCIFS_INPUT, file, "there is no state '%s'%s%s%s", name,
                          nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}

/* The edge states of the main file that take no arguments, all of them; without any, the first figure's
 * pieces. */
static bcifs_status starts_find(struct survey *survey, const char *name, struct report *report)
{
    const bcifs_automaton *automaton = survey->map->automaton;
    const char *file = automaton->modules[0]->source->name;
    if (name)
        return start_named(survey, name, report);
    for (size_t i = 0; i < automaton->definition_count; i++) {
        const struct definition *definition = automaton->definitions[i];
        if (definition->kind != CELL_EDGE || definition->argument_count > 0 ||
            definition->module != automaton->modules[0])
            continue;
        if (survey->start_count == MOST_STARTS)
            return report_failure(report, BCIFS_INPUT, file,
                                  "a map is of at most %d states; choose one with --state", MOST_STARTS);
        survey->starts[survey->start_count++] = definition;
    }
    if (survey->start_count == 0 && automaton->figure_count == 0)
        return report_failure(report, BCIFS_INPUT, file,
                              "there is nothing to map: no edge state without arguments, and no figure; "
                              "choose a state with --state");
    return BCIFS_OK;
}

/* ---- One grid point ------------------------------------------------------------------------------------ */

/* One automaton with numbers in. */
struct trial {
    const struct survey *survey;
    struct arena *arena;
    struct states *states;
    size_t starts[MOST_STARTS], start_count; /* in the table */
};

static bool trial_has(const struct trial *trial, size_t state)
{
    for (size_t i = 0; i < trial->start_count; i++)
        if (trial->starts[i] == state)
            return true;
    return false;
}

/* Expands what is reached. BCIFS_INPUT when that is too much. */
static bcifs_status reached_expand(struct trial *trial)
{
    for (size_t i = 0; i < trial->states->count; i++) {
        bcifs_status status = i < MOST_STATES ? states_expand(trial->states, i) : BCIFS_INPUT;
        if (status)
            return status;
    }
    return BCIFS_OK;
}

enum tangency { TANGENTS_AGREE, TANGENTS_MISSING, TANGENTS_DIFFER };

/* Where two children meet: the half-tangent at the end of the one and that at the start of the next. */
static enum tangency junction_tangency(const struct trial *trial, const struct tangents *tangents,
                                       size_t index, size_t child)
{
    const struct state *state = &trial->states->states[index];
    double sides[2][TANGENT_MOST_POINTS];
    for (size_t k = 0; k < 2; k++) {
        size_t at = state->children[child + k], points = trial->states->states[at].points;
        const struct arc_tangents *arc = tangents_of(tangents, at);
        const double *direction = arc ? arc->ends[k == 0].direction : NULL;
        if (!direction || !direction_map(state->maps[child + k], direction, state->points, points, sides[k]))
            return TANGENTS_MISSING;
    }
    return direction_equal(sides[0], sides[1], state->points) ? TANGENTS_AGREE : TANGENTS_DIFFER;
}

/* The worst of all junctions of all arcs that are reached: what is true of them is true at every depth. */
static bcifs_status tangency_find(struct trial *trial, enum tangency *worst)
{
    struct tangents tangents;
    *worst = TANGENTS_DIFFER;
    for (size_t i = 0; i < trial->start_count; i++)
        if (trial->states->states[trial->starts[i]].key.definition->kind != CELL_EDGE)
            return BCIFS_OK; /* it has no one parameter to have a tangent along */
    bcifs_status status = tangents_find(trial->states, trial->arena, &tangents);
    if (status || tangents.count == 0)
        return status;
    *worst = TANGENTS_AGREE;
    for (size_t i = 0; i < tangents.count; i++) {
        size_t index = tangents.arcs[i].state;
        const struct cell *cell = trial->states->states[index].cell;
        for (size_t child = 0; child + 1 < cell->child_count; child++) {
            enum tangency here = junction_tangency(trial, &tangents, index, child);
            *worst = here > *worst ? here : *worst;
        }
    }
    return BCIFS_OK;
}

/* C^1 is certified; the search ends as soon as its bounds leave 1 on one side. */
static bcifs_status state_is_smooth(struct trial *trial, size_t state, bool *is)
{
    *is = false;
    for (size_t k = 0; k < EFFORT_COUNT; k++) {
        struct smoothness smoothness;
        bcifs_status status = smoothness_find(trial->states, state, EFFORTS[k] * trial->survey->effort,
                                              trial->arena, &smoothness);
        if (status)
            return status;
        *is = smoothness.continuity >= 1 && smoothness.holder_lower > 1 && smoothness.reproduces >= 1;
        if (smoothness.holder_lower > 1 || smoothness.holder_upper <= 1)
            break;
    }
    return BCIFS_OK;
}

static bcifs_status is_smooth(struct trial *trial, bool *is)
{
    bcifs_status status = BCIFS_OK;
    *is = true;
    for (size_t i = 0; i < trial->start_count && *is && status == BCIFS_OK; i++)
        status = state_is_smooth(trial, trial->starts[i], is);
    return status;
}

/* The linear part of T, rows × columns, in the basis of differences of consecutive control points: row i of
 * the result sums the rows of T beyond i, Σ_{r>i} (T[r][j+1] - T[r][j]). `error` bounds what rounding did to
 * its entries, those of T being as good as equations ask for. */
static void linear_part(const double *t, size_t rows, size_t columns, double *linear, double *error)
{
    double largest = 1;
    for (size_t i = 0; i < rows * columns; i++)
        largest = fmax(largest, fabs(t[i]));
    for (size_t j = 0; j + 1 < columns; j++) {
        double sum = 0;
        for (size_t r = rows - 1; r > 0; r--) {
            sum += t[r * columns + j + 1] - t[r * columns + j];
            linear[(r - 1) * (columns - 1) + j] = sum;
            error[(r - 1) * (columns - 1) + j] = 2 * TOLERANCE_EQUATION * largest * (double)rows;
        }
    }
}

/* The maps of all states that are reached, on differences of points, as one family of matrices, from doubles.
 */
static bcifs_status family_quick(const struct trial *trial, struct joint_family *family)
{
    const struct states *states = trial->states;
    size_t *dimensions = arena_new(trial->arena, states->count, sizeof *dimensions), count = 0;
    for (size_t x = 0; x < states->count; x++)
        count += states->states[x].cell->child_count;
    struct joint_edge *edges = arena_new(trial->arena, count, sizeof *edges);
    if (!dimensions || !edges)
        return BCIFS_MEMORY;
    *family = (struct joint_family){dimensions, states->count, edges, count};
    for (size_t x = 0; x < states->count; x++) {
        const struct state *state = &states->states[x];
        dimensions[x] = state->points - 1;
        for (size_t i = 0; i < state->cell->child_count; i++) {
            size_t to = state->children[i], columns = states->states[to].points;
            size_t entries = (state->points - 1) * (columns - 1);
            double *linear = arena_new(trial->arena, entries, sizeof *linear);
            double *error = arena_new(trial->arena, entries, sizeof *error);
            if (!linear || !error)
                return BCIFS_MEMORY;
            linear_part(state->maps[i], state->points, columns, linear, error);
            *edges++ = (struct joint_edge){x, to, linear, error};
        }
    }
    return BCIFS_OK;
}

/* The same from exact entries where they are, which keeps zeros: needed only where the quick one does not
 * tell. */
static bcifs_status family_exact(const struct trial *trial, struct joint_family *family)
{
    struct restriction restriction;
    size_t *list = arena_new(trial->arena, trial->states->count, sizeof *list);
    if (!list)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < trial->states->count; i++)
        list[i] = i;
    bcifs_status status =
        restriction_begin(&restriction, trial->states, list, trial->states->count, trial->arena);
    return status ? status : restriction_family(&restriction, trial->arena, family);
}

static bcifs_status side_find(const struct trial *trial, const struct joint_family *family, double effort,
                              bcifs_map_class *class)
{
    struct joint_bounds bounds;
    bcifs_status status = joint_radius_find(family, effort * trial->survey->effort, trial->arena, &bounds);
    if (status == BCIFS_OK && bounds.lower >= 1 - TOLERANCE_RADIUS)
        *class = BCIFS_NOT_CONTRACTIVE;
    else if (status == BCIFS_OK && bounds.upper < 1)
        *class = BCIFS_CONTRACTIVE;
    return status;
}

/* On which side of 1 the joint spectral radius lies, not what it is. */
static bcifs_status contraction_find(const struct trial *trial, bcifs_map_class *class)
{
    struct joint_family family;
    *class = BCIFS_UNDECIDED;
    bcifs_status status = family_quick(trial, &family);
    if (status == BCIFS_OK)
        status = side_find(trial, &family, EFFORTS[0], class);
    if (status || *class != BCIFS_UNDECIDED)
        return status;
    status = family_exact(trial, &family);
    for (size_t k = 0; k < EFFORT_COUNT && status == BCIFS_OK && *class == BCIFS_UNDECIDED; k++)
        status = side_find(trial, &family, EFFORTS[k], class);
    return status;
}

/* One class needs the one before, so that the first "no" ends the search: with q_1 H(t) = t the derivative of
 * a C^1 arc is nowhere 0, and its direction is the half-tangent on both sides. Where half-tangents differ
 * there is nothing to certify; where they were not found at all (eigenvalues that are nearly equal) a
 * certificate still may be. */
static bcifs_status trial_classify(struct trial *trial, bcifs_map_class *class)
{
    enum tangency tangency = TANGENTS_DIFFER;
    bool is = false;
    bcifs_status status = contraction_find(trial, class);
    if (status == BCIFS_OK && *class == BCIFS_CONTRACTIVE)
        status = tangency_find(trial, &tangency);
    if (status || tangency == TANGENTS_DIFFER)
        return status;
    if (tangency == TANGENTS_AGREE)
        *class = BCIFS_TANGENT_CONTINUOUS;
    status = is_smooth(trial, &is);
    if (status == BCIFS_OK && is)
        *class = BCIFS_C1;
    return status;
}

static bcifs_status starts_classify(const struct survey *survey, struct arena *arena,
                                    const struct value *values, bcifs_map_class *class)
{
    struct setting setting = {.automaton = survey->map->automaton, .parameters = values};
    struct states states;
    struct trial trial = {.survey = survey, .arena = arena, .states = &states};
    bcifs_status status = states_create(&states, arena, &setting);
    for (size_t i = 0; i < survey->start_count && status == BCIFS_OK; i++)
        status = states_intern(&states, (struct state_key){survey->starts[i], NULL},
                               &trial.starts[trial.start_count++]);
    if (status == BCIFS_OK)
        status = reached_expand(&trial);
    return status ? status : trial_classify(&trial, class);
}

/* The figure's intervals may depend on the params, so it is bound anew. */
static bcifs_status figure_classify(const struct survey *survey, struct arena *arena,
                                    const struct value *values, bcifs_map_class *class)
{
    bcifs_automaton here = *survey->map->automaton;
    bcifs_figure figure = {0};
    struct report silent = report_new(NULL);
    struct trial trial = {.survey = survey, .arena = arena, .states = &figure.states};
    here.values = values;
    bcifs_status status = figure_bind(&figure, &here, &here.figures[0], NULL, &silent);
    for (size_t i = 0; i < figure.piece_count && status == BCIFS_OK; i++) {
        if (trial_has(&trial, figure.pieces[i].state))
            continue;
        if (trial.start_count == MOST_STARTS)
            status = BCIFS_INPUT;
        else
            trial.starts[trial.start_count++] = figure.pieces[i].state;
    }
    figure.states.setting.report = NULL;
    if (status == BCIFS_OK)
        status = reached_expand(&trial);
    if (status == BCIFS_OK)
        status = trial_classify(&trial, class);
    arena_free(&figure.arena);
    return status;
}

/* A point at which the automaton has no numbers (a division by zero) or too many states is undecided. */
static bcifs_status point_classify(const struct survey *survey, size_t point, struct value *values)
{
    struct arena arena = {0};
    bcifs_map_class class = BCIFS_UNDECIDED;
    bcifs_status status = values_at(survey, point, values);
    if (status == BCIFS_OK)
        status = survey->start_count ? starts_classify(survey, &arena, values, &class)
                                     : figure_classify(survey, &arena, values, &class);
    arena_free(&arena);
    survey->map->classes[point] = (unsigned char)(status ? BCIFS_UNDECIDED : class);
    return status == BCIFS_MEMORY ? status : BCIFS_OK;
}

/* ---- All grid points ----------------------------------------------------------------------------------- */

/* The next points to do, CHUNK at most; 0 when there are none or something failed. */
static size_t chunk_take(struct survey *survey, bcifs_status status, size_t *first)
{
    size_t total = survey->map->columns * survey->map->rows, count = 0;
    pthread_mutex_lock(&survey->lock);
    survey->status = survey->status ? survey->status : status;
    *first = survey->next;
    if (survey->status == BCIFS_OK)
        count = total - survey->next < CHUNK ? total - survey->next : CHUNK;
    survey->next += count;
    pthread_mutex_unlock(&survey->lock);
    return count;
}

static void points_classify(struct survey *survey, bcifs_progress *progress)
{
    const bcifs_automaton *automaton = survey->map->automaton;
    size_t parameters = automaton->parameter_count, first, count;
    struct arena arena = {0};
    struct value *values = arena_grow(&arena, automaton->values, parameters, parameters, sizeof *values);
    bcifs_status status = values ? BCIFS_OK : BCIFS_MEMORY;
    while ((count = chunk_take(survey, status, &first)) > 0) {
        for (size_t i = 0; i < count && status == BCIFS_OK; i++)
            status = point_classify(survey, first + i, values);
        if (progress)
            progress(survey->context, (double)first / (double)(survey->map->columns * survey->map->rows));
    }
    arena_free(&arena);
}

static void *thread_run(void *survey)
{
    points_classify(survey, NULL);
    return NULL;
}

static unsigned thread_count(unsigned wanted, size_t points)
{
    long online = wanted ? (long)wanted : sysconf(_SC_NPROCESSORS_ONLN);
    long most = (long)((points + CHUNK - 1) / CHUNK);
    online = online < 1 ? 1 : online > MAP_MOST_THREADS ? MAP_MOST_THREADS : online;
    return (unsigned)(online < most ? online : most);
}

/* This thread works too; one that cannot be had is done without. */
static bcifs_status threads_run(struct survey *survey, unsigned wanted, struct report *report)
{
    pthread_t threads[MAP_MOST_THREADS];
    pthread_attr_t attributes;
    unsigned count = thread_count(wanted, survey->map->columns * survey->map->rows), running = 0;
    if (pthread_mutex_init(&survey->lock, NULL) != 0)
        return report_memory(report);
    if (pthread_attr_init(&attributes) == 0) {
        if (pthread_attr_setstacksize(&attributes, STACK) == 0)
            while (running + 1 < count &&
                   pthread_create(&threads[running], &attributes, thread_run, survey) == 0)
                running++;
        pthread_attr_destroy(&attributes);
    }
    points_classify(survey, survey->progress);
    while (running > 0)
        pthread_join(threads[--running], NULL);
    pthread_mutex_destroy(&survey->lock);
    return survey->status ? report_memory(report) : BCIFS_OK;
}

/* ---- Corner cutting ------------------------------------------------------------------------------------ */

static bool map_is(const struct cell_child *child, const struct value *wanted)
{
    if (child->map->rows != 3 || child->map->columns != 3)
        return false;
    for (size_t i = 0; i < 9; i++)
        if (!child->map->values[i].exact || child->map->values[i].residue != wanted[i].residue)
            return false;
    return true;
}

/* Whether the cell has the maps of corner cutting for these ratios. */
static bool cell_cuts(const struct cell *cell, struct value a, struct value b)
{
    struct value zero = value_from_integer(0), one = value_from_integer(1);
    struct value c = value_subtract(one, a), d = value_subtract(one, b);
    const struct value first[9] = {c, b, zero, a, d, c, zero, zero, a};
    const struct value second[9] = {b, zero, zero, d, c, b, zero, a, d};
    if (cell->child_count != 2 || cell->points != 3)
        return false;
    return cell->children[0].state.definition == cell->definition &&
           cell->children[1].state.definition == cell->definition && map_is(&cell->children[0], first) &&
           map_is(&cell->children[1], second);
}

/* Compares at random residues of the two params: the maps are equal identically, or differ almost surely. */
static bcifs_status corners_recognize(const struct survey *survey, struct report *report)
{
    bcifs_map *map = survey->map;
    struct arena arena = {0};
    size_t count = map->automaton->parameter_count;
    struct value *values = arena_grow(&arena, map->automaton->values, count, count, sizeof *values);
    struct setting setting = {.automaton = map->automaton, .parameters = values, .proving = true};
    uint64_t random = UINT64_C(0x9e3779b97f4a7c15);
    struct cell *cell;
    if (!values)
        return report_memory(report);
    for (size_t i = 0; i < map->axis_count; i++) {
        struct value *value = &values[map->axes[i].parameter];
        *value = (struct value){value->real, field_random(&random), true, false};
    }
    bcifs_status status =
        cell_elaborate(&setting, &arena, (struct state_key){survey->starts[0], NULL}, &cell);
    for (size_t first = 0; first < 2 && status == BCIFS_OK && !map->cuts_corners; first++) {
        map->cut_axes[0] = first;
        map->cut_axes[1] = 1 - first;
        map->cuts_corners =
            cell_cuts(cell, values[map->axes[first].parameter], values[map->axes[1 - first].parameter]);
    }
    arena_free(&arena);
    return status == BCIFS_MEMORY ? report_memory(report) : BCIFS_OK;
}

/* ---- The handle ---------------------------------------------------------------------------------------- */

static bcifs_status map_make(bcifs_map *map, const char *const *axes, size_t axis_count,
                             const bcifs_map_options *options, struct report *report)
{
    struct survey survey = {
        .map = map, .effort = options->effort, .progress = options->progress, .context = options->context};
    if (!(survey.effort >= 0 && survey.effort <= 1e6))
        return report_failure(report, BCIFS_INPUT, NULL, "the effort of a map is a number from 0 to 1000000");
    survey.effort = survey.effort > 0 ? survey.effort : 1;
    if (map->automaton->unknowns > 0)
        return report_failure(report, BCIFS_INPUT, map->automaton->modules[0]->source->name,
                              "entries written '?' are open; 'bcifs complete' solves for them");
    bcifs_status status = axes_read(map, axes, axis_count, report);
    if (status == BCIFS_OK)
        status = starts_find(&survey, options->state, report);
    if (status == BCIFS_OK)
        status = followers_find(&survey, report);
    if (status == BCIFS_OK)
        status = equations_prove(&survey, report);
    if (status == BCIFS_OK && map->axis_count == 2 && survey.start_count == 1)
        status = corners_recognize(&survey, report);
    return status ? status : threads_run(&survey, options->threads, report);
}

bcifs_status bcifs_map_create(const bcifs_automaton *automaton, const char *const *axes, size_t axis_count,
                              const bcifs_map_options *options, bcifs_map **map, bcifs_error *error)
{
    static const bcifs_map_options defaults = {0};
    struct report report = report_new(NULL);
    bcifs_map *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? BCIFS_OK : report_memory(&report);
    if (status == BCIFS_OK) {
        fresh->automaton = automaton;
        status = map_make(fresh, axes, axis_count, options ? options : &defaults, &report);
    }
    if (status) {
        bcifs_map_free(fresh);
        report_close(&report, error);
        return status;
    }
    *map = fresh;
    return BCIFS_OK;
}

void bcifs_map_free(bcifs_map *map)
{
    if (!map)
        return;
    arena_free(&map->arena);
    memory_free(map);
}

size_t bcifs_map_axis_count(const bcifs_map *map)
{
    return map->axis_count;
}

const char *bcifs_map_parameter(const bcifs_map *map, size_t axis)
{
    return axis < map->axis_count ? map->axes[axis].name : NULL;
}

size_t bcifs_map_count(const bcifs_map *map, size_t axis)
{
    return axis < map->axis_count ? map->axes[axis].count : 1;
}

double bcifs_map_value(const bcifs_map *map, size_t axis, size_t index)
{
    return map->axes[axis].nodes[index].real;
}

bcifs_map_class bcifs_map_at(const bcifs_map *map, size_t i, size_t j)
{
    return (bcifs_map_class)map->classes[j * map->columns + i];
}

const char *bcifs_map_class_name(bcifs_map_class class)
{
    static const char *const names[] = {[BCIFS_UNDECIDED] = "undecided",
                                        [BCIFS_NOT_CONTRACTIVE] = "not-contractive",
                                        [BCIFS_CONTRACTIVE] = "contractive",
                                        [BCIFS_TANGENT_CONTINUOUS] = "tangent-continuous",
                                        [BCIFS_C1] = "C1"};
    return (unsigned)class < sizeof names / sizeof *names ? names[class] : NULL;
}
