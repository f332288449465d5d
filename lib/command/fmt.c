/* bcifs fmt: the file in canonical layout. */
#include <stdio.h>
#include <string.h>

#include "command.h"

static int run(const struct arguments *arguments)
{
    char *original, *formatted;
    bcifs_error error;
    bcifs_load_options options = load_options(arguments);
    bcifs_status status = bcifs_format_file(arguments->file, &options, &original, &formatted, &error);
    if (status)
        return exit_of(status);
    bool same = strcmp(original, formatted) == 0;
    bcifs_text_free(original);
    if (!arguments->check)
        return text_output(arguments, formatted);
    bcifs_text_free(formatted);
    if (!same && !arguments->quiet)
        fprintf(stderr, "%s: not in canonical layout; 'bcifs fmt' prints it\n", arguments->file);
    return same ? EXIT_YES : EXIT_NO;
}

static const struct option options_list[] = {
    {"--check", NULL, "only say whether the file is in canonical layout (exit status 0 or 1)"},
    {"-o", "FILE", "write there (it may be the same file) instead of to standard output"},
    {"--quiet", NULL, "say nothing"},
    {NULL, NULL, NULL},
};

const struct command command_fmt = {
    .name = "fmt",
    .usage = "FILE [options]",
    .summary = "prints the file in canonical layout",
    .text = "Comments stay where they are; formatting a formatted file changes nothing.\n",
    .options = options_list,
    .run = run,
};
