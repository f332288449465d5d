/* bcifs area: the signed area of a figure's limit curve. */
#include "command.h"

/* --state NAME without --points: the form only. */
static int figure_make(const struct arguments *arguments, const bcifs_automaton *automaton, double **points,
                       bcifs_figure **figure)
{
    bcifs_figure_options options = {.figure = arguments->figure,
                                    .state = arguments->state,
                                    .unplaced = arguments->state && !arguments->points};
    bcifs_load_options reading = load_options(arguments);
    bcifs_error error;
    if (arguments->points) {
        bcifs_status read = bcifs_points_read(arguments->points, &reading, points, &options.point_count,
                                              &options.dimension, &error);
        if (read)
            return exit_of(read);
        options.points = *points;
    }
    bcifs_status status = bcifs_figure_create(automaton, &options, figure, &error);
    return status ? fail(status, &error) : EXIT_YES;
}

static int area_print(const struct arguments *arguments, const bcifs_figure *figure)
{
    bcifs_area *area;
    bcifs_error error;
    bcifs_status status = bcifs_area_create(figure, &area, &error);
    if (status)
        return fail(status, &error);
    int written = text_output(arguments, arguments->json ? bcifs_area_json(area) : bcifs_area_text(area));
    bcifs_area_free(area);
    return written;
}

static int run(const struct arguments *arguments)
{
    /* An area is a number: it is that of the params' values. */
    struct arguments fixed = *arguments;
    bcifs_automaton *automaton;
    bcifs_figure *figure = NULL;
    double *points = NULL;
    fixed.fix_params = true;
    if (arguments->figure && arguments->state)
        return complain("--figure and --state exclude each other");
    int status = automaton_load(&fixed, &automaton);
    if (status)
        return status;
    status = equations_check(&fixed, automaton);
    if (status == EXIT_YES)
        status = figure_make(&fixed, automaton, &points, &figure);
    if (status == EXIT_YES)
        status = area_print(&fixed, figure);
    bcifs_figure_free(figure);
    bcifs_points_free(points);
    bcifs_automaton_free(automaton);
    return status;
}

static const struct option options_list[] = {
    {"--figure", "NAME", "which figure of the file (default: the first)"},
    {"--state", "NAME", "one state on its own: its form, and with --points its area"},
    {"--points", "FILE", "control points from CSV, one a row, instead of the figure's"},
    {"--set", "NAME=EXPR", "give a param a value; may be repeated"},
    {"--json", NULL, "print one JSON object"},
    {"-o", "FILE", "where to write; - is standard output"},
    {"--quiet", NULL, "no warnings"},
    {NULL, NULL, NULL},
};

const struct command command_area = {
    .name = "area",
    .usage = "FILE [options]",
    .summary = "computes the exact signed area of a figure's limit curve, fractal or not",
    .text = "An open curve is closed by its chord. An arc on the control points P0, P1, … has the area\n"
            "Σ ½ m_jk (x_j y_k - y_j x_k) over all j, k, and m is printed, too. Where the areas of finer and "
            "finer\n"
            "polygons do not converge, or equations fail, the exit status is 1.\n",
    .options = options_list,
    .run = run,
};
