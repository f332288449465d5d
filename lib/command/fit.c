/* bcifs fit: control points whose curve comes nearest to a drawn one. */
#include <stdlib.h>
#include <string.h>

#include "command.h"

enum { DEFAULT_POINTS = 4096 /* of the fitted curve in a picture */ };

/* Everything that one fit owns. */
struct fitting {
    const struct arguments *arguments;
    bcifs_automaton *automaton;
    bcifs_curve *target;
    bcifs_fit *fit;
};

static int options_read(const struct arguments *arguments, bcifs_fit_options *options)
{
    unsigned pieces = 0;
    int status = arguments->pieces ? unsigned_read("--pieces", arguments->pieces, &pieces) : EXIT_YES;
    if (status == EXIT_YES && arguments->pieces && pieces == 0)
        return complain("--pieces: a curve has at least 1 piece");
    if (status == EXIT_YES && arguments->depth)
        status = unsigned_read("--depth", arguments->depth, &options->depth);
    options->figure = arguments->figure;
    options->state = arguments->state;
    options->pieces = pieces;
    return status;
}

/* ---- The picture --------------------------------------------------------------------------------------- */

/* The target in gray, the curve and its control polygon over it. */
static int layers_write(const struct fitting *fitting, const bcifs_figure *figure, bcifs_plan *plans[2])
{
    const struct arguments *arguments = fitting->arguments;
    bcifs_view view = {.depth = bcifs_figure_depth(figure, DEFAULT_POINTS), .to = 1};
    const bcifs_view polygon = {.show = BCIFS_CONTROL, .to = 1};
    bcifs_error error;
    unsigned width = 0;
    int status = arguments->width ? unsigned_read("--width", arguments->width, &width) : EXIT_YES;
    if (status)
        return status;
    bcifs_status made = bcifs_plan_create(figure, &view, &plans[0], &error);
    if (made == BCIFS_OK)
        made = bcifs_plan_create(figure, &polygon, &plans[1], &error);
    if (made)
        return fail(made, &error);
    const bcifs_layer layers[] = {{.plan = plans[0], .role = BCIFS_CURVE},
                                  {.plan = plans[1], .role = BCIFS_POLYGON},
                                  {.curve = fitting->target, .role = BCIFS_TARGET}};
    char *line = command_line(arguments);
    const bcifs_write_options options = {.format = output_format(arguments), .command = line, .width = width};
    made = bcifs_write(figure, layers, sizeof layers / sizeof *layers,
                       arguments->output ? arguments->output : "-", &options, &error);
    free(line);
    return made ? fail(made, &error) : EXIT_YES;
}

static int picture_write(const struct fitting *fitting)
{
    bcifs_figure_options options = {.figure = fitting->arguments->figure,
                                    .state = fitting->arguments->state,
                                    .dimension = bcifs_fit_dimension(fitting->fit)};
    bcifs_figure *figure;
    bcifs_plan *plans[2] = {NULL, NULL};
    bcifs_error error;
    options.points = bcifs_fit_points(fitting->fit, &options.point_count);
    bcifs_status made = bcifs_figure_create(fitting->automaton, &options, &figure, &error);
    if (made)
        return fail(made, &error);
    int status = layers_write(fitting, figure, plans);
    bcifs_plan_free(plans[0]);
    bcifs_plan_free(plans[1]);
    bcifs_figure_free(figure);
    return status;
}

/* ---- The command --------------------------------------------------------------------------------------- */

static int fit(struct fitting *fitting)
{
    const struct arguments *arguments = fitting->arguments;
    bcifs_load_options reading = load_options(arguments);
    bcifs_fit_options options = {0};
    bcifs_error error;
    const char *format = output_format(arguments);
    bool json = strcmp(format, "json") == 0;
    if (!json && strcmp(format, "csv") != 0 && !output_is_picture(arguments))
        return complain("a fit is written as csv, json, svg or png, not as '%s'", format);
    int status = options_read(arguments, &options);
    if (status == EXIT_YES)
        status = exit_of(bcifs_curve_read(arguments->to, &reading, &fitting->target, &error));
    if (status == EXIT_YES)
        status = equations_check(arguments, fitting->automaton);
    if (status)
        return status;
    bcifs_status made =
        bcifs_fit_create(fitting->automaton, fitting->target, &options, &fitting->fit, &error);
    if (made)
        return fail(made, &error);
    if (output_is_picture(arguments))
        return picture_write(fitting);
    return text_output(arguments, json ? bcifs_fit_json(fitting->fit) : bcifs_fit_csv(fitting->fit));
}

static int run(const struct arguments *arguments)
{
    /* The curve is fitted for the params' values. */
    struct arguments fixed = *arguments;
    struct fitting fitting = {.arguments = &fixed};
    fixed.fix_params = true;
    if (arguments->figure && arguments->state)
        return complain("--figure and --state exclude each other");
    if (!arguments->to)
        return complain("fit: say what to fit the curve to: --to FILE");
    int status = automaton_load(&fixed, &fitting.automaton);
    if (status)
        return status;
    status = fit(&fitting);
    bcifs_fit_free(fitting.fit);
    bcifs_curve_free(fitting.target);
    bcifs_automaton_free(fitting.automaton);
    return status;
}

static const struct option options_list[] = {
    {"--to", "FILE", "the target: the first path of an SVG file, or the polyline through points from CSV"},
    {"--pieces", "K", "with so many arcs (default: as many as the figure has)"},
    {"--depth", "n", "measure distances at depth n (default: 1024 points or more)"},
    {"--figure", "NAME", "which figure of the file (default: the first)"},
    {"--state", "NAME", "fit one arc in this state instead of a figure"},
    {"--set", "NAME=EXPR", "give a param a value; may be repeated"},
    {"-o", "FILE", "where to write; the ending names the format; - is standard output"},
    {"--format", "NAME", "csv, json, svg or png"},
    {"--json", NULL, "control points, pieces, rms, maximum, iterations as JSON"},
    {"--width", "PIXELS", "pictures: their width (default 1000)"},
    {"--quiet", NULL, "no warnings"},
    {NULL, NULL, NULL},
};

const struct command command_fit = {
    .name = "fit",
    .usage = "FILE --to CURVE [options]",
    .summary = "finds control points whose curve is nearest to a drawn one",
    .text = "The control points are written as CSV, for eval --points. Pictures show the target in gray, the "
            "curve\n"
            "and its control polygon.\n",
    .options = options_list,
    .run = run,
};
