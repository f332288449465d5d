/* bcifs describe: the class of every state, its levels of description, and the automaton drawn. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command.h"

/* What -o and --format ask for: "mtx", "dot", "svg", or "" for the report. */
static const char *output_kind(const struct arguments *arguments)
{
    static const char *const kinds[] = {"mtx", "dot", "svg"};
    const char *format = output_format(arguments);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(format, kinds[i]) == 0)
            return kinds[i];
    return "";
}

static int level_read(const char *name, bcifs_level *level)
{
    static const char *const names[] = {
        [BCIFS_MAPS] = "maps", [BCIFS_REFINEMENT] = "refinement", [BCIFS_MASK] = "mask"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], name) == 0) {
            *level = (bcifs_level)i;
            return EXIT_YES;
        }
    return complain("--as: expected maps, refinement or mask, found '%s'", name);
}

static int rewrite(const struct arguments *arguments, const bcifs_automaton *automaton)
{
    bcifs_level level = BCIFS_MAPS;
    bcifs_error error;
    char *text;
    int status = level_read(arguments->as, &level);
    if (status)
        return status;
    bcifs_status written = bcifs_rewrite(automaton, level, &text, &error);
    return written ? fail(written, &error) : text_output(arguments, text);
}

static int report(const struct arguments *arguments, const bcifs_automaton *automaton, unsigned depth)
{
    bcifs_description *description;
    bcifs_error error;
    const bcifs_describe_options options = {.state = arguments->state, .depth = depth};
    bcifs_status made = bcifs_describe(automaton, &options, &description, &error);
    if (made)
        return fail(made, &error);
    bool json = strcmp(output_format(arguments), "json") == 0;
    int status = text_output(arguments, json ? bcifs_description_json(description)
                                             : bcifs_description_text(description));
    bcifs_description_free(description);
    return status;
}

/* -o x.mtx, x.dot, x.svg */
static int write(const struct arguments *arguments, const bcifs_automaton *automaton, const char *kind,
                 unsigned depth)
{
    bcifs_figure *figure = NULL;
    bcifs_error error;
    const char *path = arguments->output ? arguments->output : "-";
    char *line = command_line(arguments);
    const bcifs_write_options options = {.format = kind, .command = line};
    bcifs_status status;
    if (strcmp(kind, "mtx") == 0) {
        const bcifs_figure_options chosen = {
            .figure = arguments->figure, .state = arguments->state, .unplaced = arguments->state != NULL};
        status = bcifs_figure_create(automaton, &chosen, &figure, &error);
        if (status == BCIFS_OK)
            status = bcifs_write_refinement(figure, depth, path, &options, &error);
        bcifs_figure_free(figure);
    } else {
        status = bcifs_write_graph(automaton, path, &options, &error);
    }
    free(line);
    return status ? fail(status, &error) : EXIT_YES;
}

static int options_check(const struct arguments *arguments, const char *kind)
{
    if (arguments->figure && strcmp(kind, "mtx") != 0)
        return complain("--figure is for the refinement matrix of a figure: -o x.mtx");
    if (arguments->figure && arguments->state)
        return complain("--figure and --state exclude each other");
    if (arguments->as && (kind[0] || arguments->json || arguments->depth || arguments->state))
        return complain("--as prints the whole file; it goes with --set and -o FILE.bcifs only");
    if (arguments->format && !kind[0] && strcmp(arguments->format, "json") != 0 &&
        strcmp(arguments->format, "text") != 0)
        return complain("--format: expected text, json, mtx, dot or svg, found '%s'", arguments->format);
    return EXIT_YES;
}

static int run(const struct arguments *arguments)
{
    bcifs_automaton *automaton;
    const char *kind = output_kind(arguments);
    unsigned depth = 1;
    int status = options_check(arguments, kind);
    if (status == EXIT_YES && arguments->depth)
        status = unsigned_read("--depth", arguments->depth, &depth);
    if (status == EXIT_YES)
        status = automaton_load(arguments, &automaton);
    if (status)
        return status;
    if (arguments->as)
        status = rewrite(arguments, automaton);
    else if (kind[0])
        status = write(arguments, automaton, kind, depth);
    else
        status = report(arguments, automaton, depth);
    bcifs_automaton_free(automaton);
    return status;
}

static const struct option options_list[] = {
    {"--depth", "n", "refinement matrices of level n (default 1)"},
    {"--as", "LEVEL", "print the automaton with its edges as maps, refinement or mask"},
    {"--state", "NAME", "this state only"},
    {"--figure", "NAME", "with -o x.mtx: which figure of the file (default: the first)"},
    {"--set", "NAME=EXPR", "give a param a value; may be repeated"},
    {"-o", "FILE",
     "where to write: .mtx a refinement matrix, .dot and .svg the automaton drawn, .json, text"},
    {"--format", "NAME", "text, json, mtx, dot or svg"},
    {"--json", NULL, "print one JSON object"},
    {"--quiet", NULL, "no warnings"},
    {NULL, NULL, NULL},
};

const struct command command_describe = {
    .name = "describe",
    .usage = "FILE [options]",
    .summary = "classifies every state; maps, refinement matrix and masks, each from the others",
    .text = "A refinement matrix is the maps written over each other; where its columns repeat it is given "
            "by masks.\n"
            "An edge that cannot be written at the level of --as says why (exit status 1).\n"
            "-o x.mtx writes the sparse matrix from a figure's control points to those of level n "
            "(MatrixMarket).\n",
    .options = options_list,
    .run = run,
};
