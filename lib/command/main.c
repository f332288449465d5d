/* bcifs COMMAND FILE [options]: chooses the command and turns its outcome into an exit status. */
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "command.h"

static const struct command *const commands[] = {
    &command_analyze, &command_area, &command_basis, &command_check, &command_complete, &command_describe,
    &command_edit,    &command_eval, &command_fit,   &command_fmt,   &command_map};

const struct command *command_at(size_t index)
{
    return index < sizeof commands / sizeof *commands ? commands[index] : NULL;
}

static const struct command *command_named(const char *name)
{
    for (size_t i = 0; command_at(i); i++)
        if (strcmp(command_at(i)->name, name) == 0)
            return command_at(i);
    return NULL;
}

static void help(FILE *out)
{
    fputs("Usage: bcifs COMMAND FILE [options]\n\n"
          "Reads an automaton of subdivision cells from a text file, proves its incidence and\n"
          "adjacency equations, and draws its curves and attractors.\n\nCommands:\n",
          out);
    for (size_t i = 0; command_at(i); i++)
        fprintf(out, "  %-9s %s\n", command_at(i)->name, command_at(i)->summary);
    fputs("  help      says more about a command: bcifs help eval\n\n"
          "FILE may be - for standard input. Exit status: 0 done and the answer is yes, 1 the answer\n"
          "is no, 2 bad input or usage, 3 the system failed.\n",
          out);
}

static int run_help(int count, char **words)
{
    const struct command *command = count > 0 ? command_named(words[0]) : NULL;
    if (count > 0 && !command)
        return complain("there is no command '%s'; 'bcifs help' lists them", words[0]);
    if (command)
        command_help(command);
    else
        help(stdout);
    return EXIT_YES;
}

static int run(int count, char **words)
{
    if (count < 2) {
        help(stderr);
        return EXIT_INPUT;
    }
    const char *name = words[1];
    if (strcmp(name, "--version") == 0) {
        printf("bcifs %s\n", bcifs_version());
        return EXIT_YES;
    }
    if (strcmp(name, "help") == 0 || strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0)
        return run_help(count - 2, words + 2);
    const struct command *command = command_named(name);
    if (!command)
        return complain("there is no command '%s'; 'bcifs help' lists them", name);
    struct arguments arguments = {.argument_count = count, .words = words};
    int status = arguments_read(command, count - 2, words + 2, &arguments);
    if (status)
        return status < 0 ? EXIT_YES : status;
    return command->run(&arguments);
}

int main(int count, char **words)
{
    /* A closed pipe is a write that fails, like a full disk. */
    signal(SIGPIPE, SIG_IGN);
    int status = run(count, words);
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fputs("bcifs: error: cannot write to standard output\n", stderr);
        return EXIT_SYSTEM;
    }
    return status;
}
