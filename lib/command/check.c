/* bcifs check: every equation of every state, with its verdict. */
#include <stdio.h>

#include "command.h"

static int check_answer(const struct arguments *arguments, const bcifs_check *check)
{
    double lower, upper;
    const char *product;
    bcifs_check_contraction(check, &lower, &upper, &product);
    if (!bcifs_check_valid(check))
        return EXIT_NO;
    return arguments->strict && !(upper < 1) ? EXIT_NO : EXIT_YES;
}

static int run(const struct arguments *arguments)
{
    bcifs_automaton *automaton;
    bcifs_check *check;
    bcifs_error error;
    bcifs_load_options options = load_options(arguments);
    int status = automaton_load(arguments, &automaton);
    if (status)
        return status;
    bcifs_status made = bcifs_check_create(automaton, &options, &check, &error);
    if (made) {
        bcifs_automaton_free(automaton);
        return exit_of(made);
    }
    status = check_answer(arguments, check);
    int written = EXIT_YES;
    if (arguments->json || !arguments->quiet || arguments->output)
        written = text_output(arguments, arguments->json ? bcifs_check_json(check) : bcifs_check_text(check));
    if (bcifs_check_valid(check) && written == EXIT_YES)
        written = exit_of(bcifs_check_filters(automaton, &options, &error));
    bcifs_check_free(check);
    bcifs_automaton_free(automaton);
    return written ? written : status;
}

static const struct option options_list[] = {
    {"--set", "NAME=EXPR", "give a param a value: it is checked for that value only"},
    {"--strict", NULL, "refuse an automaton that is not shown to be contractive, too"},
    {"--json", NULL, "print one JSON object"},
    {"-o", "FILE", "write there instead of to standard output"},
    {"--quiet", NULL, "print no warnings and no report; the exit status tells"},
    {NULL, NULL, NULL},
};

const struct command command_check = {
    .name = "check",
    .usage = "FILE [options]",
    .summary = "proves the barycentric, incidence and adjacency equations of every state",
    .text = "An equation whose entries are rational in params and arguments is proved or refuted exactly, for\n"
            "all their values at once. A refuted one is shown: both sides and the values where they differ.\n"
            "Filters that the file declares are verified, too; wrong ones are an error.\n",
    .options = options_list,
    .run = run,
};
