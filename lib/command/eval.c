/* bcifs eval: points of a figure, as data or as a picture. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "command.h"

enum {
    DEFAULT_POINTS = 4096,        /* depth is chosen for about so many when none is given */
    DEFAULT_DENSITY = 1 << 20,    /* in a density picture */
    MOST_SEED = 1024
};

/* Everything that one evaluation owns. */
struct evaluation {
    const struct arguments *arguments;
    bcifs_automaton *automaton;
    bcifs_figure *figure;
    bcifs_plan *plans[MOST_LAYERS];
    bcifs_layer layers[MOST_LAYERS];
    size_t layer_count;
    double seed[MOST_SEED];
    time_t began;
    bool progress_shown;
};

/* ---- Options ------------------------------------------------------------------------------------------- */

/* limit | control | seed:b0,b1,… */
static int show_read(struct evaluation *evaluation, bcifs_view *view)
{
    const char *show = evaluation->arguments->show;
    if (!show || strcmp(show, "limit") == 0)
        return EXIT_YES;
    if (strcmp(show, "control") == 0) {
        view->show = BCIFS_CONTROL;
        return EXIT_YES;
    }
    if (strncmp(show, "seed:", 5) != 0)
        return complain("--show: expected limit, control or seed:b0,b1,…, found '%s'", show);
    view->show = BCIFS_SEED;
    view->seed = evaluation->seed;
    for (const char *field = show + 5;;) {
        size_t length = strcspn(field, ",");
        if (view->seed_count == MOST_SEED)
            return complain("--show: a seed has at most %d coordinates", MOST_SEED);
        int status = number_read("--show seed", field, length, &evaluation->seed[view->seed_count++]);
        if (status || field[length] == '\0')
            return status;
        field += length + 1;
    }
}

/* t0..t1 */
static int range_read(const char *range, bcifs_view *view)
{
    const char *dots = range ? strstr(range, "..") : NULL;
    if (!range)
        return EXIT_YES;
    if (!dots)
        return complain("--range: expected t0..t1, found '%s'", range);
    int status = number_read("--range", range, (size_t)(dots - range), &view->from);
    if (status == EXIT_YES)
        status = number_read("--range", dots + 2, strlen(dots + 2), &view->to);
    if (status == EXIT_YES && !(view->from >= 0 && view->from <= view->to && view->to <= 1 && view->to > 0))
        return complain("--range: expected 0 <= t0 <= t1 <= 1 and t1 > 0, found '%s'", range);
    return status;
}

/* ---- Layers -------------------------------------------------------------------------------------------- */

static int layer_add(struct evaluation *evaluation, const bcifs_view *view, bcifs_role role)
{
    bcifs_error error;
    if (evaluation->layer_count == MOST_LAYERS)
        return complain("a picture has at most %d layers", MOST_LAYERS);
    bcifs_plan **plan = &evaluation->plans[evaluation->layer_count];
    bcifs_status status = bcifs_plan_create(evaluation->figure, view, plan, &error);
    if (status)
        return fail(status, &error);
    evaluation->layers[evaluation->layer_count++] = (bcifs_layer){.plan = *plan, .role = role};
    return EXIT_YES;
}

/* --levels a,b,c: coarser levels over the curve. */
static int levels_add(struct evaluation *evaluation, bcifs_view view)
{
    const char *field = evaluation->arguments->levels;
    while (field) {
        size_t length = strcspn(field, ",");
        char word[16];
        if (length == 0 || length >= sizeof word)
            return complain("--levels: expected depths such as 0,1,2, found '%s'", evaluation->arguments->levels);
        memcpy(word, field, length);
        word[length] = '\0';
        int status = unsigned_read("--levels", word, &view.depth);
        if (status == EXIT_YES)
            status = layer_add(evaluation, &view, BCIFS_LEVEL);
        if (status)
            return status;
        field = field[length] ? field + length + 1 : NULL;
    }
    return EXIT_YES;
}

static int layers_make(struct evaluation *evaluation)
{
    const struct arguments *arguments = evaluation->arguments;
    bool picture = output_is_picture(arguments);
    bcifs_view view = {.from = 0, .to = 1};
    int status = show_read(evaluation, &view);
    if (status == EXIT_YES)
        status = range_read(arguments->range, &view);
    bool density = picture && bcifs_figure_is_attractor(evaluation->figure) && view.show != BCIFS_CONTROL;
    if (status == EXIT_YES && arguments->depth)
        status = unsigned_read("--depth", arguments->depth, &view.depth);
    else
        view.depth = bcifs_figure_depth(evaluation->figure, density ? DEFAULT_DENSITY : DEFAULT_POINTS);
    if (status == EXIT_YES && !picture && (arguments->polygon || arguments->levels))
        return complain("--polygon and --levels are for pictures: -o x.svg or -o x.png");
    if (status == EXIT_YES)
        status = layer_add(evaluation, &view, BCIFS_CURVE);
    if (status == EXIT_YES)
        status = levels_add(evaluation, view);
    bcifs_view polygon = {.show = BCIFS_CONTROL, .to = 1};
    if (status == EXIT_YES && arguments->polygon)
        status = layer_add(evaluation, &polygon, BCIFS_POLYGON);
    return status;
}

/* ---- Output -------------------------------------------------------------------------------------------- */

/* After the first second, and then once a second. */
static void progress(void *context, double done)
{
    struct evaluation *evaluation = context;
    time_t now = time(NULL);
    if (now - evaluation->began < 2)
        return;
    evaluation->began = now - 1;
    evaluation->progress_shown = true;
    fprintf(stderr, "\r%3d %%", (int)(100 * done));
    fflush(stderr);
}

static int layers_write(struct evaluation *evaluation)
{
    const struct arguments *arguments = evaluation->arguments;
    bcifs_error error;
    unsigned width = 0;
    char *line = command_line(arguments);
    int status = arguments->width ? unsigned_read("--width", arguments->width, &width) : EXIT_YES;
    if (status == EXIT_YES) {
        bcifs_write_options options = {
            .format = arguments->json && !arguments->format ? "json" : arguments->format, .command = line, .width = width, .context = evaluation};
        if (!arguments->quiet && isatty(STDERR_FILENO))
            options.progress = progress;
        evaluation->began = time(NULL);
        bcifs_status written = bcifs_write(evaluation->figure, evaluation->layers, evaluation->layer_count,
                                           arguments->output ? arguments->output : "-", &options, &error);
        if (evaluation->progress_shown)
            fputs("\r     \r", stderr);
        status = written ? fail(written, &error) : EXIT_YES;
    }
    free(line);
    return status;
}

/* ---- Single points ------------------------------------------------------------------------------------- */

static int position_evaluate(const struct evaluation *evaluation, size_t index, double *point)
{
    const char *position = evaluation->arguments->positions[index];
    bcifs_error error;
    bcifs_status found;
    if (evaluation->arguments->is_address[index]) {
        found = bcifs_point_at_address(evaluation->figure, position, point, &error);
    } else {
        double t;
        int status = number_read("--at", position, strlen(position), &t);
        if (status)
            return status;
        if (!(t >= 0 && t <= 1))
            return complain("--at: the parameter lies in 0..1, found '%s'", position);
        found = bcifs_point_at(evaluation->figure, t, point, &error);
    }
    return found ? fail(found, &error) : EXIT_YES;
}

enum { ROW = 16 * 42 + 8 /* bytes of a point, written */ };

static size_t header_print(char *out, unsigned dimension)
{
    static const char *const names[] = {"x", "y", "z"};
    size_t length = 0;
    for (unsigned i = 0; i < dimension; i++)
        length += (size_t)(dimension <= 3 ? sprintf(out + length, "%s%s", i ? "," : "", names[i])
                                          : sprintf(out + length, "%sx%u", i ? "," : "", i));
    out[length++] = '\n';
    out[length] = '\0';
    return length;
}

static size_t row_print(char *out, const double *point, unsigned dimension, bool json, bool last)
{
    size_t length = 0;
    if (json)
        out[length++] = '[';
    for (unsigned i = 0; i < dimension; i++) {
        if (i > 0)
            out[length++] = ',';
        length += bcifs_number_text(out + length, point[i]);
    }
    if (json)
        out[length++] = ']';
    if (json && !last)
        out[length++] = ',';
    out[length++] = '\n';
    out[length] = '\0';
    return length;
}

static int positions_write(struct evaluation *evaluation)
{
    const struct arguments *arguments = evaluation->arguments;
    unsigned dimension = bcifs_figure_dimension(evaluation->figure);
    size_t count = arguments->position_count, length = 0;
    bool json = strcmp(output_format(arguments), "json") == 0;
    if (!json && strcmp(output_format(arguments), "csv") != 0)
        return complain("single points are written as csv or json, not as '%s'", output_format(arguments));
    if (arguments->depth || arguments->show || arguments->range || arguments->levels || arguments->polygon)
        return complain("--at and --address give single limit points; --depth, --show, --range, --levels and "
                        "--polygon do not go with them");
    char *text = malloc((count + 2) * ROW);
    double point[16];
    bcifs_error error;
    int status = text ? EXIT_YES : EXIT_SYSTEM;
    if (text)
        length = json ? (size_t)sprintf(text, "{\"points\": [\n") : header_print(text, dimension);
    for (size_t i = 0; i < count && status == EXIT_YES; i++) {
        status = position_evaluate(evaluation, i, point);
        if (status == EXIT_YES)
            length += row_print(text + length, point, dimension, json, i + 1 == count);
    }
    if (status == EXIT_YES && json)
        length += (size_t)sprintf(text + length, "]}\n");
    if (status == EXIT_YES) {
        bcifs_status written = bcifs_write_text(arguments->output ? arguments->output : "-", text, length, &error);
        status = written ? fail(written, &error) : EXIT_YES;
    }
    free(text);
    return status;
}

/* ---- The command --------------------------------------------------------------------------------------- */

static int evaluate(struct evaluation *evaluation)
{
    int status = equations_check(evaluation->arguments, evaluation->automaton);
    if (status == EXIT_YES)
        status = figure_create(evaluation->arguments, evaluation->automaton, &evaluation->figure);
    if (status)
        return status;
    if (evaluation->arguments->position_count > 0)
        return positions_write(evaluation);
    status = layers_make(evaluation);
    return status ? status : layers_write(evaluation);
}

static int run(const struct arguments *arguments)
{
    /* A picture is of the params' values, so the equations need hold for those only. */
    struct arguments fixed = *arguments;
    struct evaluation evaluation = {.arguments = &fixed};
    fixed.fix_params = true;
    if (arguments->figure && arguments->state)
        return complain("--figure and --state exclude each other");
    int status = automaton_load(&fixed, &evaluation.automaton);
    if (status)
        return status;
    status = evaluate(&evaluation);
    for (size_t i = 0; i < evaluation.layer_count; i++)
        bcifs_plan_free(evaluation.plans[i]);
    bcifs_figure_free(evaluation.figure);
    bcifs_automaton_free(evaluation.automaton);
    return status;
}

static const struct option options_list[] = {
    {"--depth", "n", "subdivide n times (default: about 4096 points)"},
    {"--show", "WHAT", "limit (points of the curve), control, or seed:b0,b1,… of the joint"},
    {"--at", "t", "the point at parameter t, 0..1; may be repeated"},
    {"--address", "p.WORD", "the point at an address: piece, then map indices; may be repeated"},
    {"--range", "t0..t1", "only the points of the depth with parameters in the range"},
    {"--figure", "NAME", "which figure of the file (default: the first)"},
    {"--state", "NAME", "draw one state on its own, on the points of --points"},
    {"--points", "FILE", "control points from CSV, one a row, instead of the figure's"},
    {"--curve", "FILE", "control points from the first path of an SVG file, or through those of a CSV"},
    {"--set", "NAME=EXPR", "give a param a value; may be repeated"},
    {"-o", "FILE", "where to write; the ending names the format; - is standard output"},
    {"--format", "NAME", "csv, json, f64, npy, svg or png"},
    {"--json", NULL, "the same as --format json"},
    {"--polygon", NULL, "pictures: draw the control polygon too"},
    {"--levels", "a,b,…", "pictures: lay these depths over the curve"},
    {"--width", "PIXELS", "pictures: their width (default 1000)"},
    {"--quiet", NULL, "no warnings, no progress"},
    {NULL, NULL, NULL},
};

const struct command command_eval = {
    .name = "eval",
    .usage = "FILE [options]",
    .summary = "evaluates a figure: points as data, curves and attractors as pictures",
    .text = "For a curve, limit points are those of the curve itself; control points are the control polygon of\n"
            "the depth. For cells, --show control draws the control frame under all words of the depth.\n",
    .options = options_list,
    .run = run,
};
