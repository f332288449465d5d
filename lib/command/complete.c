/* bcifs complete: the entries `?` of an automaton, from its equations. */
#include <stdio.h>
#include <string.h>

#include "command.h"

/* The conflict in words, on standard error: standard output is for automata. */
static int print_conflict(const bcifs_complete *complete)
{
    char *text = bcifs_complete_text(complete);
    if (!text) {
        fputs("bcifs: error: no memory\n", stderr);
        return EXIT_SYSTEM;
    }
    fputs(text, stderr);
    bcifs_text_free(text);
    return EXIT_YES;
}

static int write_automaton(const struct arguments *arguments, const char *automaton)
{
    bcifs_error error;
    const char *path = arguments->output ? arguments->output : "-";
    bcifs_status status = bcifs_write_text(path, automaton, strlen(automaton), &error);
    return status ? fail(status, &error) : EXIT_YES;
}

/* Without '?' the question is that of `bcifs check`; warnings were given already. */
static int write_check(const struct arguments *arguments, const bcifs_automaton *automaton)
{
    bcifs_check *check;
    bcifs_error error;
    bcifs_status status = bcifs_check_create(automaton, NULL, &check, &error);
    if (status)
        return fail(status, &error);
    int written = text_output(arguments, bcifs_check_text(check));
    bcifs_check_free(check);
    return written;
}

static int answer(const struct arguments *arguments, const bcifs_automaton *automaton,
                  const bcifs_complete *complete)
{
    bool is_check = bcifs_complete_unknowns(complete) == 0;
    bool consistent = bcifs_complete_consistent(complete);
    int written = EXIT_YES;
    if (arguments->json)
        written = text_output(arguments, bcifs_complete_json(complete));
    else if (is_check && (arguments->output || !arguments->quiet))
        written = write_check(arguments, automaton);
    else if (!consistent && !arguments->quiet)
        written = print_conflict(complete);
    else if (consistent && (arguments->output || !arguments->quiet))
        written = write_automaton(arguments, bcifs_complete_automaton(complete));
    return written ? written : consistent ? EXIT_YES : EXIT_NO;
}

static int run(const struct arguments *arguments)
{
    bcifs_automaton *automaton;
    bcifs_complete *complete;
    bcifs_error error;
    bcifs_load_options options = load_options(arguments);
    int status = automaton_load(arguments, &automaton);
    if (status)
        return status;
    status = exit_of(bcifs_complete_create(automaton, &options, &complete, &error));
    if (status == EXIT_YES) {
        status = answer(arguments, automaton, complete);
        bcifs_complete_free(complete);
    }
    bcifs_automaton_free(automaton);
    return status;
}

static const struct option options_list[] = {
    {"--set", "NAME=EXPR", "give a param a value: it is fixed in the answer"},
    {"--json", NULL, "print one JSON object"},
    {"-o", "FILE", "write there instead of to standard output"},
    {"--quiet", NULL, "print no warnings and, without -o, no automaton; the exit status tells"},
    {NULL, NULL, NULL},
};

const struct command command_complete = {
    .name = "complete",
    .usage = "FILE [options]",
    .summary = "solves the equations for the entries written '?' and prints the completed automaton",
    .text =
        "What the equations leave free becomes params of the answer. Equations that contradict each other\n"
        "are named, exit status 1. A file without '?' is checked, as by bcifs check.\n",
    .options = options_list,
    .run = run,
};
