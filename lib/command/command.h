/* Command: what the subcommands of `bcifs` share: the table of them, options, loading, diagnostics.
 *
 * The command is a program like any other that links the library: it uses include/bcifs.h only. */
#ifndef COMMAND_COMMAND_H
#define COMMAND_COMMAND_H

#include <stdbool.h>
#include <stddef.h>

#include "bcifs.h"

/* Exit status, design section 5. */
enum { EXIT_YES = 0, EXIT_NO = 1, EXIT_INPUT = 2, EXIT_SYSTEM = 3 };

struct option {
    const char *name;     /* "--depth" */
    const char *argument; /* "n", or NULL for a flag */
    const char *text;     /* one line of help */
};

enum { MOST_SETTINGS = 256, MOST_POSITIONS = 256, MOST_LAYERS = 64, MOST_AXES = 2, MOST_MOVES = 1024 };

/* What was said on the command line. A command looks at what its options may set. */
struct arguments {
    const char *file;
    const char *settings[MOST_SETTINGS]; /* --set */
    size_t setting_count;
    const char *axes[MOST_AXES]; /* --over */
    size_t axis_count;
    const char *moves[MOST_MOVES]; /* --move */
    size_t move_count;
    const char *figure, *state, *points, *curve, *to, *pieces, *output, *format, *depth, *show, *range, *levels,
        *width, *effort, *threads, *level, *as, *coarsen, *refine, *alpha, *free, *keep, *area, *energy, *pins;
    const char *positions[MOST_POSITIONS]; /* --at and --address, in their order */
    bool is_address[MOST_POSITIONS];
    size_t position_count;
    bool json, quiet, strict, polygon, check;
    bool fix_params; /* what is computed is for the params' values only */
    bool unplaced;   /* a state may do without control points */
    int argument_count; /* of the whole command line, for pictures */
    char **words;
};

struct command {
    const char *name;
    const char *usage;   /* "FILE [options]" */
    const char *summary; /* one line */
    const char *text;    /* what more there is to say, or NULL */
    const struct option *options; /* ends with a NULL name */
    int (*run)(const struct arguments *arguments);
};

extern const struct command command_analyze, command_area, command_basis, command_check, command_complete,
    command_describe, command_edit, command_eval, command_fit, command_fmt, command_map;

/* NULL past the last. */
const struct command *command_at(size_t index);

/* Fills `arguments` from the words after the command's name. Exits are the caller's: EXIT_YES to go on, EXIT_INPUT
 * after a complaint, -1 when help was asked for and printed. */
int arguments_read(const struct command *command, int count, char **words, struct arguments *arguments);
void command_help(const struct command *command);

/* "bcifs: " and a message on standard error; returns EXIT_INPUT. */
int complain(const char *format, ...);
/* Prints an error that no reporter has seen and returns the exit status that goes with it. */
int fail(bcifs_status status, const bcifs_error *error);
int exit_of(bcifs_status status);

/* Loads the automaton; its diagnostics go to standard error. `quiet` leaves out warnings. */
int automaton_load(const struct arguments *arguments, bcifs_automaton **automaton);
/* Points shared by neighbors are written once, so what is drawn must be proved to meet: EXIT_NO, having said which
 * equation fails first. */
int equations_check(const struct arguments *arguments, const bcifs_automaton *automaton);
/* The figure that --figure, --state, --points and --curve ask for. */
int figure_create(const struct arguments *arguments, const bcifs_automaton *automaton, bcifs_figure **figure);
/* Options for library calls that report: `context` must be `arguments`. */
bcifs_load_options load_options(const struct arguments *arguments);

/* A number written as an expression, 1/3: `length` bytes of `text`, given for `option`. */
int number_read(const char *option, const char *text, size_t length, double *number);
/* A whole number from 0 to 1000000. */
int unsigned_read(const char *option, const char *text, unsigned *number);
/* The format asked for, by --format, --json or the ending of -o; "csv" without any. */
const char *output_format(const struct arguments *arguments);
bool output_is_picture(const struct arguments *arguments);
/* The command line as one could type it again, to be freed; NULL: no memory. */
char *command_line(const struct arguments *arguments);

/* Writes text to the output (standard output without -o) and frees it; NULL text: no memory. */
int text_output(const struct arguments *arguments, char *text);

#endif
