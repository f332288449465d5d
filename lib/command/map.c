/* bcifs map: the class of an automaton over one or two of its params. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "command.h"

enum { MOST_THREADS = 256 };

/* When the line of progress was last written, and whether it ever was. */
struct progress_state {
    time_t last;
    bool shown;
};

/* After the first second, and then once a second. */
static void progress(void *context, double done)
{
    struct progress_state *state = context;
    time_t now = time(NULL);
    if (now - state->last < 2)
        return;
    state->last = now - 1;
    state->shown = true;
    fprintf(stderr, "\r%3d %%", (int)(100 * done));
    fflush(stderr);
}

static int options_read(const struct arguments *arguments, bcifs_map_options *options, unsigned *width)
{
    int status = EXIT_YES;
    *options = (bcifs_map_options){.state = arguments->state, .effort = 1};
    if (arguments->axis_count == 0)
        return complain("map needs a param to vary: --over NAME=LOW..HIGH:COUNT");
    if (arguments->effort)
        status = number_read("--effort", arguments->effort, strlen(arguments->effort), &options->effort);
    if (status == EXIT_YES && !(options->effort > 0 && options->effort <= 1000))
        return complain("--effort: expected a number above 0, at most 1000, found '%s'", arguments->effort);
    if (status == EXIT_YES && arguments->threads)
        status = unsigned_read("--threads", arguments->threads, &options->threads);
    if (status == EXIT_YES && arguments->threads &&
        (options->threads == 0 || options->threads > MOST_THREADS))
        return complain("--threads: expected a whole number from 1 to %d, found '%s'", MOST_THREADS,
                        arguments->threads);
    if (status == EXIT_YES && arguments->width)
        status = unsigned_read("--width", arguments->width, width);
    return status;
}

static int map_write(const struct arguments *arguments, const bcifs_map *map, unsigned width)
{
    bcifs_error error;
    char *line = command_line(arguments);
    const bcifs_write_options options = {.format = arguments->format, .command = line, .width = width};
    bcifs_status status = bcifs_map_write(map, arguments->output ? arguments->output : "-", &options, &error);
    free(line);
    return status ? fail(status, &error) : EXIT_YES;
}

/* Before the work, which may be long, not after it. */
static int format_check(const struct arguments *arguments)
{
    static const char *const formats[] = {"csv", "svg", "png"};
    const char *format = output_format(arguments);
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        if (strcmp(format, formats[i]) == 0)
            return EXIT_YES;
    return complain("a map is written as csv, svg or png, not '%s'", format);
}

static int run(const struct arguments *arguments)
{
    bcifs_automaton *automaton;
    bcifs_map *map;
    bcifs_map_options options;
    bcifs_error error;
    unsigned width = 0;
    struct progress_state state = {.last = time(NULL)};
    int status = options_read(arguments, &options, &width);
    if (status == EXIT_YES)
        status = format_check(arguments);
    if (status == EXIT_YES)
        status = automaton_load(arguments, &automaton);
    if (status)
        return status;
    options.context = &state;
    if (!arguments->quiet && isatty(STDERR_FILENO))
        options.progress = progress;
    bcifs_status made =
        bcifs_map_create(automaton, arguments->axes, arguments->axis_count, &options, &map, &error);
    if (state.shown)
        fputs("\r     \r", stderr);
    if (made) {
        status = fail(made, &error);
    } else {
        status = map_write(arguments, map, width);
        bcifs_map_free(map);
    }
    bcifs_automaton_free(automaton);
    return status;
}

static const struct option options_list[] = {
    {"--over", "AXIS", "a param to vary, NAME=LOW..HIGH:COUNT; once or twice"},
    {"--set", "NAME=EXPR", "give another param a value; may be repeated"},
    {"--state", "NAME", "of one state (default: all edge states without arguments)"},
    {"-o", "FILE", "where to write: .csv, .svg or .png; - is standard output"},
    {"--format", "NAME", "csv, svg or png"},
    {"--width", "PIXELS", "pictures: their width (default 1000)"},
    {"--effort", "x", "how long to search at each grid point (default 1)"},
    {"--threads", "N", "how many work at once (default: the processors there are)"},
    {"--quiet", NULL, "no warnings, no progress"},
    {NULL, NULL, NULL},
};

const struct command command_map = {
    .name = "map",
    .usage = "FILE --over NAME=LOW..HIGH:COUNT [options]",
    .summary = "where in the plane of its params a scheme is contractive, tangent continuous, C^1",
    .text = "COUNT values from LOW to HIGH, both included; at most 2^22 grid points. The equations must hold "
            "for all\n"
            "values of these params (exit status 1 otherwise). A class includes those before it: "
            "not-contractive,\n"
            "contractive, tangent-continuous, C1 (certified); or else undecided.\n",
    .options = options_list,
    .run = run,
};
