/* bcifs basis: the blending functions of a figure or of a state. */
#include <stdlib.h>

#include "command.h"

enum { DEFAULT_ROWS = 1024 /* parameters when no depth is given: a pixel each */ };

/* --state, --figure, otherwise the file's first figure. */
static int figure_make(const struct arguments *arguments, const bcifs_automaton *automaton,
                       bcifs_figure **figure)
{
    bcifs_error error;
    const bcifs_figure_options options = {
        .figure = arguments->figure, .state = arguments->state, .unplaced = arguments->state != NULL};
    bcifs_status status = bcifs_figure_create(automaton, &options, figure, &error);
    return status ? fail(status, &error) : EXIT_YES;
}

static int write(const struct arguments *arguments, const bcifs_figure *figure)
{
    bcifs_basis_view view = {0, 0};
    unsigned width = 0;
    bcifs_error error;
    int status = arguments->level ? unsigned_read("--level", arguments->level, &view.level) : EXIT_YES;
    if (status == EXIT_YES && arguments->depth)
        status = unsigned_read("--depth", arguments->depth, &view.depth);
    if (status == EXIT_YES && arguments->width)
        status = unsigned_read("--width", arguments->width, &width);
    if (status)
        return status;
    if (!arguments->depth)
        view.depth = bcifs_figure_depth(figure, DEFAULT_ROWS);
    if (!arguments->depth && view.depth < view.level)
        view.depth = view.level;
    char *line = command_line(arguments);
    const bcifs_write_options options = {.format = output_format(arguments), .command = line, .width = width};
    bcifs_status written =
        bcifs_write_basis(figure, &view, arguments->output ? arguments->output : "-", &options, &error);
    free(line);
    return written ? fail(written, &error) : EXIT_YES;
}

static int run(const struct arguments *arguments)
{
    /* They are those of the params' values. */
    struct arguments fixed = *arguments;
    bcifs_automaton *automaton;
    bcifs_figure *figure = NULL;
    fixed.fix_params = true;
    if (arguments->figure && arguments->state)
        return complain("--figure and --state exclude each other");
    int status = automaton_load(&fixed, &automaton);
    if (status)
        return status;
    status = equations_check(&fixed, automaton);
    if (status == EXIT_YES)
        status = figure_make(&fixed, automaton, &figure);
    if (status == EXIT_YES)
        status = write(&fixed, figure);
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
    return status;
}

static const struct option options_list[] = {
    {"--depth", "n", "at the parameters of depth n (default: about 1000 of them)"},
    {"--level", "k", "of the curve refined k times (default 0); n must be at least k"},
    {"--figure", "NAME", "which figure of the file (default: the first)"},
    {"--state", "NAME", "of one arc instead of a figure"},
    {"--set", "NAME=EXPR", "give a param a value; may be repeated"},
    {"-o", "FILE", "where to write: .csv, .svg or .png"},
    {"--format", "NAME", "csv, svg or png"},
    {"--width", "PIXELS", "pictures: their width (default 1000)"},
    {"--quiet", NULL, "no warnings"},
    {NULL, NULL, NULL},
};

const struct command command_basis = {
    .name = "basis",
    .usage = "FILE [options]",
    .summary = "blending functions of a curve at any level, as a table or drawn",
    .text = "The table has the columns t,h0,h1,…: one function for every control point of the level, with "
            "values\n"
            "that sum to 1 at every parameter t from 0 to 1.\n",
    .options = options_list,
    .run = run,
};
