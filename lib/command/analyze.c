/* bcifs analyze: eigenvalues, half-tangents, junctions and certified smoothness of every edge state. */
#include <stdio.h>
#include <stdlib.h>

#include "command.h"

static int effort_read(const struct arguments *arguments, double *effort)
{
    bcifs_error error;
    *effort = 1;
    if (!arguments->effort)
        return EXIT_YES;
    if (bcifs_number_read(arguments->effort, effort, &error) != BCIFS_OK || !(*effort > 0 && *effort <= 1e6))
        return complain("--effort: expected a number above 0 and at most 1e6, found '%s'", arguments->effort);
    return EXIT_YES;
}

/* The curve with half-tangents at the junctions of --level. */
static int picture_write(const struct arguments *arguments, const bcifs_automaton *automaton,
                         const bcifs_analysis *analysis)
{
    bcifs_figure_options choice = {.figure = arguments->figure};
    bcifs_view view = {.to = 1};
    bcifs_figure *figure = NULL;
    bcifs_plan *plan = NULL;
    bcifs_error error;
    double *segments = NULL;
    size_t count = 0;
    unsigned level = 1, width = 0;
    char *line = command_line(arguments);
    int status = arguments->level ? unsigned_read("--level", arguments->level, &level) : EXIT_YES;
    if (status == EXIT_YES && arguments->width)
        status = unsigned_read("--width", arguments->width, &width);
    bcifs_status made = status ? BCIFS_INPUT : bcifs_figure_create(automaton, &choice, &figure, &error);
    if (made == BCIFS_OK && arguments->depth)
        status = unsigned_read("--depth", arguments->depth, &view.depth);
    else if (made == BCIFS_OK)
        view.depth = bcifs_figure_depth(figure, 4096);
    if (status == EXIT_YES && made == BCIFS_OK)
        made = bcifs_analysis_segments(analysis, figure, level, &segments, &count, &error);
    if (status == EXIT_YES && made == BCIFS_OK)
        made = bcifs_plan_create(figure, &view, &plan, &error);
    if (status == EXIT_YES && made == BCIFS_OK) {
        bcifs_layer layers[] = {{.plan = plan, .role = BCIFS_CURVE},
                                {.role = BCIFS_TANGENT, .segments = segments, .segment_count = count}};
        bcifs_write_options options = {.format = arguments->format, .command = line, .width = width};
        made = bcifs_write(figure, layers, 2, arguments->output, &options, &error);
    }
    if (status == EXIT_YES && made)
        status = fail(made, &error);
    bcifs_points_free(segments);
    bcifs_plan_free(plan);
    bcifs_figure_free(figure);
    free(line);
    return status;
}

static int run(const struct arguments *arguments)
{
    struct arguments fixed = *arguments;
    bcifs_automaton *automaton;
    bcifs_analysis *analysis;
    bcifs_error error;
    double effort;
    bool picture = arguments->output && !arguments->json && output_is_picture(arguments);
    fixed.fix_params = true; /* eigenvalues are numbers: all is for the params' values */
    bcifs_load_options options = load_options(&fixed);
    int status = effort_read(arguments, &effort);
    if (status == EXIT_YES)
        status = automaton_load(&fixed, &automaton);
    if (status)
        return status;
    bcifs_status made = bcifs_analysis_create(automaton, effort, &options, &analysis, &error);
    if (made == BCIFS_OK && picture)
        status = picture_write(arguments, automaton, analysis);
    else if (made == BCIFS_OK)
        status = text_output(arguments,
                             arguments->json ? bcifs_analysis_json(analysis) : bcifs_analysis_text(analysis));
    if (made == BCIFS_OK)
        bcifs_analysis_free(analysis);
    bcifs_automaton_free(automaton);
    return made ? exit_of(made) : status;
}

static const struct option options_list[] = {
    {"--set", "NAME=EXPR", "give a param a value; may be repeated"},
    {"--effort", "x", "search x times as long for the smoothness (default 1)"},
    {"--json", NULL, "print one JSON object"},
    {"-o", "FILE", "write there; with the ending .svg or .png: a picture with half-tangents"},
    {"--figure", "NAME", "pictures: which figure (default: the first)"},
    {"--level", "k", "pictures: half-tangents at the junctions of level k (default 1)"},
    {"--depth", "n", "pictures: depth of the curve (default: about 4096 points)"},
    {"--width", "PIXELS", "pictures: their width (default 1000)"},
    {"--quiet", NULL, "no warnings"},
    {NULL, NULL, NULL},
};

const struct command command_analyze = {
    .name = "analyze",
    .usage = "FILE [options]",
    .summary = "finds half-tangents, junctions and the certified smoothness of every edge",
    .text = "Tangents are directions in barycentric coordinates, so they hold for all control points. An automaton\n"
            "whose equations fail is refused: exit status 1.\n",
    .options = options_list,
    .run = run,
};
