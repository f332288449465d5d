/* bcifs area: the signed area of a figure's limit curve, and its form in the coefficients of any level. */
#include <stdlib.h>

#include "command.h"

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

/* ---- --coarsen ----------------------------------------------------------------------------------------- */

/* What is asked of the matrix. */
struct wish {
    unsigned coarsen, refine, width;
};

static int wish_read(const struct arguments *arguments, struct wish *wish)
{
    int status = unsigned_read("--coarsen", arguments->coarsen, &wish->coarsen);
    if (status == EXIT_YES && arguments->refine)
        status = unsigned_read("--refine", arguments->refine, &wish->refine);
    if (status == EXIT_YES && arguments->width)
        status = unsigned_read("--width", arguments->width, &wish->width);
    return status;
}

static int matrix_write(const struct arguments *arguments, const struct wish *wish, const bcifs_figure *figure)
{
    bcifs_area_matrix *matrix;
    bcifs_error error;
    bcifs_status status = bcifs_area_matrix_create(figure, wish->refine, wish->coarsen, &matrix, &error);
    if (status)
        return fail(status, &error);
    char *line = command_line(arguments);
    const bcifs_write_options options = {.format = arguments->output || arguments->format || arguments->json
                                                       ? output_format(arguments)
                                                       : "txt",
                                         .command = line,
                                         .width = wish->width};
    status = bcifs_area_matrix_write(matrix, arguments->output ? arguments->output : "-", &options, &error);
    free(line);
    bcifs_area_matrix_free(matrix);
    return status ? fail(status, &error) : EXIT_YES;
}

static int options_check(const struct arguments *arguments, struct wish *wish)
{
    const struct {
        const char *name, *given;
    } others[] = {{"--refine", arguments->refine}, {"--format", arguments->format}, {"--width", arguments->width}};
    if (arguments->coarsen)
        return wish_read(arguments, wish);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (others[i].given)
            return complain("%s is for the matrix of --coarsen J", others[i].name);
    return EXIT_YES;
}

/* ---- The command --------------------------------------------------------------------------------------- */

static int run(const struct arguments *arguments)
{
    /* An area is a number: it is that of the params' values. */
    struct arguments fixed = *arguments;
    bcifs_automaton *automaton;
    bcifs_figure *figure = NULL;
    struct wish wish = {0};
    fixed.fix_params = true;
    fixed.unplaced = true;
    if (arguments->figure && arguments->state)
        return complain("--figure and --state exclude each other");
    int status = options_check(&fixed, &wish);
    if (status == EXIT_YES)
        status = automaton_load(&fixed, &automaton);
    if (status)
        return status;
    status = equations_check(&fixed, automaton);
    if (status == EXIT_YES)
        status = figure_create(&fixed, automaton, &figure);
    if (status == EXIT_YES)
        status = fixed.coarsen ? matrix_write(&fixed, &wish, figure) : area_print(&fixed, figure);
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
    return status;
}

static const struct option options_list[] = {
    {"--figure", "NAME", "which figure of the file (default: the first)"},
    {"--state", "NAME", "one state on its own: its form, and with --points its area"},
    {"--points", "FILE", "control points from CSV, one a row, instead of the figure's"},
    {"--curve", "FILE", "control points from the first path of an SVG file"},
    {"--coarsen", "J", "the area matrix of the curve decomposed J times"},
    {"--refine", "n", "matrix: first subdivide the figure n times"},
    {"--set", "NAME=EXPR", "give a param a value; may be repeated"},
    {"--json", NULL, "print one JSON object"},
    {"-o", "FILE", "where to write; a matrix: .txt, .json, .csv, .mtx, .svg or .png"},
    {"--format", "NAME", "matrix: txt, json, csv, mtx, svg or png, whatever the ending"},
    {"--width", "PIXELS", "pictures of a matrix: their width (default 1000)"},
    {"--quiet", NULL, "no warnings"},
    {NULL, NULL, NULL},
};

const struct command command_area = {
    .name = "area",
    .usage = "FILE [options]",
    .summary = "computes the exact signed area of a figure's limit curve, fractal or not",
    .text = "An open curve is closed by its chord. An arc on the control points P0, P1, … has the area\n"
            "Σ ½ m_jk (x_j y_k - y_j x_k) over all j, k, and m is printed, too. Where the areas of finer and finer\n"
            "polygons do not converge, or equations fail, the exit status is 1. --coarsen J prints the matrix that\n"
            "does the same for the coarse control points and the details of the curve decomposed J times.\n",
    .options = options_list,
    .run = run,
};
