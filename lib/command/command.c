#include "command.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int complain(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    fputs("bcifs: ", stderr);
    vfprintf(stderr, format, list);
    fputc('\n', stderr);
    va_end(list);
    return EXIT_INPUT;
}

int exit_of(bcifs_status status)
{
    switch (status) {
    case BCIFS_OK:
        return EXIT_YES;
    case BCIFS_NO:
        return EXIT_NO;
    case BCIFS_INPUT:
        return EXIT_INPUT;
    case BCIFS_SYSTEM:
    case BCIFS_MEMORY:
        break;
    }
    return EXIT_SYSTEM;
}

/* file:line:column: error: message */
static void print_place(const char *file, unsigned line, unsigned column)
{
    if (!file || !file[0])
        fputs("bcifs: ", stderr);
    else if (line == 0)
        fprintf(stderr, "%s: ", file);
    else
        fprintf(stderr, "%s:%u:%u: ", file, line, column);
}

int fail(bcifs_status status, const bcifs_error *error)
{
    print_place(error->file, error->line, error->column);
    fprintf(stderr, "error: %s\n", error->message);
    return exit_of(status);
}

static void print_diagnostic(void *context, const bcifs_diagnostic *diagnostic)
{
    const struct arguments *arguments = context;
    if (diagnostic->is_warning && arguments->quiet)
        return;
    print_place(diagnostic->file, diagnostic->line, diagnostic->column);
    fprintf(stderr, "%s: %s\n", diagnostic->is_warning ? "warning" : "error", diagnostic->message);
    if (diagnostic->excerpt)
        fprintf(stderr, "%s\n", diagnostic->excerpt);
}

bcifs_load_options load_options(const struct arguments *arguments)
{
    return (bcifs_load_options){.settings = arguments->settings,
                                .setting_count = arguments->setting_count,
                                .fix_params = arguments->fix_params,
                                .report = print_diagnostic,
                                .context = (void *)arguments};
}

int automaton_load(const struct arguments *arguments, bcifs_automaton **automaton)
{
    bcifs_load_options options = load_options(arguments);
    bcifs_error error;
    return exit_of(bcifs_load(arguments->file, &options, automaton, &error));
}

int equations_check(const struct arguments *arguments, const bcifs_automaton *automaton)
{
    bcifs_check *check;
    bcifs_error error;
    bcifs_load_options options = load_options(arguments);
    bcifs_status status = bcifs_check_create(automaton, &options, &check, &error);
    if (status)
        return exit_of(status);
    status = bcifs_check_require(check, &options, &error);
    bcifs_check_free(check);
    return exit_of(status);
}

int figure_create(const struct arguments *arguments, const bcifs_automaton *automaton, bcifs_figure **figure)
{
    bcifs_figure_options options = {.figure = arguments->figure,
                                    .state = arguments->state,
                                    .unplaced = arguments->unplaced && arguments->state && !arguments->points &&
                                                !arguments->curve};
    bcifs_load_options reading = load_options(arguments);
    bcifs_error error;
    double *points = NULL;
    bcifs_curve *curve = NULL;
    bcifs_status status = BCIFS_OK;
    if (arguments->figure && arguments->state)
        return complain("--figure and --state exclude each other");
    if (arguments->points && arguments->curve)
        return complain("--points and --curve exclude each other");
    if (arguments->points)
        status = bcifs_points_read(arguments->points, &reading, &points, &options.point_count, &options.dimension,
                                   &error);
    else if (arguments->curve)
        status = bcifs_curve_read(arguments->curve, &reading, &curve, &error);
    if (status)
        return exit_of(status);
    options.points = points;
    options.curve = curve;
    status = bcifs_figure_create(automaton, &options, figure, &error);
    bcifs_points_free(points);
    bcifs_curve_free(curve);
    return status ? fail(status, &error) : EXIT_YES;
}

int text_output(const struct arguments *arguments, char *text)
{
    bcifs_error error;
    if (!text) {
        fputs("bcifs: error: no memory\n", stderr);
        return EXIT_SYSTEM;
    }
    const char *path = arguments->output ? arguments->output : "-";
    bcifs_status status = bcifs_write_text(path, text, strlen(text), &error);
    bcifs_text_free(text);
    return status ? fail(status, &error) : EXIT_YES;
}

/* ---- Numbers, formats, the command line ---------------------------------------------------------------- */

/* A number written as an expression: 1/3. `length` bytes of `text`. */
int number_read(const char *option, const char *text, size_t length, double *number)
{
    char copy[256];
    bcifs_error error;
    if (length == 0 || length >= sizeof copy)
        return complain("%s: expected a number, found '%.40s'", option, text);
    memcpy(copy, text, length);
    copy[length] = '\0';
    bcifs_status status = bcifs_number_read(copy, number, &error);
    if (status == BCIFS_MEMORY)
        return fail(status, &error);
    if (status)
        return complain("%s: expected a number, found '%s': %s", option, copy, error.message);
    return EXIT_YES;
}

int unsigned_read(const char *option, const char *text, unsigned *number)
{
    double value;
    int status = number_read(option, text, strlen(text), &value);
    if (status)
        return status;
    if (!(value >= 0 && value <= 1e6 && value == floor(value)))
        return complain("%s: expected a whole number from 0 to 1000000, found '%s'", option, text);
    *number = (unsigned)value;
    return EXIT_YES;
}

/* Capital letters are alike to small ones in endings. */
static bool word_equal(const char *a, const char *b)
{
    while (*a && tolower((unsigned char)*a) == tolower((unsigned char)*b)) {
        a++;
        b++;
    }
    return *a == *b;
}

const char *output_format(const struct arguments *arguments)
{
    const char *name = arguments->output ? strrchr(arguments->output, '/') : NULL;
    const char *ending = arguments->output ? strrchr(name ? name : arguments->output, '.') : NULL;
    const char *wanted = arguments->format ? arguments->format : arguments->json ? "json" : ending ? ending + 1 : "csv";
    for (size_t i = 0; bcifs_format_name(i); i++)
        if (word_equal(bcifs_format_name(i), wanted))
            return bcifs_format_name(i);
    return wanted;
}

bool output_is_picture(const struct arguments *arguments)
{
    const char *format = output_format(arguments);
    for (size_t i = 0; bcifs_format_name(i); i++)
        if (bcifs_format_name(i) == format)
            return bcifs_format_is_picture(i);
    return false;
}

/* The command line as one could type it again. */
char *command_line(const struct arguments *arguments)
{
    size_t length = 1;
    for (int i = 0; i < arguments->argument_count; i++)
        length += 4 * strlen(arguments->words[i]) + 3;
    char *line = malloc(length), *end = line;
    if (!line)
        return NULL;
    for (int i = 0; i < arguments->argument_count; i++) {
        const char *word = i == 0 ? "bcifs" : arguments->words[i];
        bool plain = word[0] && strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                             "-_./=:,+%@") == strlen(word);
        if (i > 0)
            *end++ = ' ';
        if (!plain)
            *end++ = '\'';
        for (; *word; word++) {
            if (*word == '\'') {
                memcpy(end, "'\\'", 3);
                end += 3;
            }
            *end++ = *word;
        }
        if (!plain)
            *end++ = '\'';
    }
    *end = '\0';
    return line;
}

/* ---- Options ------------------------------------------------------------------------------------------- */

/* Where an option's argument (or flag) is kept. */
static const char **string_slot(struct arguments *arguments, const char *name)
{
    const struct {
        const char *name;
        const char **slot;
    } slots[] = {
        {"--figure", &arguments->figure},   {"--state", &arguments->state},     {"--points", &arguments->points},
        {"--curve", &arguments->curve},     {"--to", &arguments->to},           {"--pieces", &arguments->pieces},
        {"-o", &arguments->output},         {"--format", &arguments->format},   {"--depth", &arguments->depth},
        {"--show", &arguments->show},       {"--range", &arguments->range},     {"--levels", &arguments->levels},
        {"--as", &arguments->as},           {"--width", &arguments->width},     {"--effort", &arguments->effort},
        {"--threads", &arguments->threads}, {"--level", &arguments->level},     {"--coarsen", &arguments->coarsen},
        {"--refine", &arguments->refine},   {"--alpha", &arguments->alpha},     {"--free", &arguments->free},
        {"--keep", &arguments->keep},       {"--area", &arguments->area},       {"--energy", &arguments->energy},
        {"--pin", &arguments->pins},
    };
    for (size_t i = 0; i < sizeof slots / sizeof *slots; i++)
        if (strcmp(slots[i].name, name) == 0)
            return slots[i].slot;
    return NULL;
}

static bool *flag_slot(struct arguments *arguments, const char *name)
{
    const struct {
        const char *name;
        bool *slot;
    } slots[] = {
        {"--json", &arguments->json},       {"--quiet", &arguments->quiet}, {"--strict", &arguments->strict},
        {"--polygon", &arguments->polygon}, {"--check", &arguments->check},
    };
    for (size_t i = 0; i < sizeof slots / sizeof *slots; i++)
        if (strcmp(slots[i].name, name) == 0)
            return slots[i].slot;
    return NULL;
}

static int option_store(struct arguments *arguments, const char *name, const char *argument)
{
    if (strcmp(name, "--set") == 0) {
        if (arguments->setting_count == MOST_SETTINGS)
            return complain("more than %d --set", MOST_SETTINGS);
        arguments->settings[arguments->setting_count++] = argument;
        return EXIT_YES;
    }
    if (strcmp(name, "--over") == 0) {
        if (arguments->axis_count == MOST_AXES)
            return complain("more than %d --over", MOST_AXES);
        arguments->axes[arguments->axis_count++] = argument;
        return EXIT_YES;
    }
    if (strcmp(name, "--move") == 0) {
        if (arguments->move_count == MOST_MOVES)
            return complain("more than %d --move", MOST_MOVES);
        arguments->moves[arguments->move_count++] = argument;
        return EXIT_YES;
    }
    if (strcmp(name, "--at") == 0 || strcmp(name, "--address") == 0) {
        if (arguments->position_count == MOST_POSITIONS)
            return complain("more than %d --at and --address", MOST_POSITIONS);
        arguments->is_address[arguments->position_count] = name[3] == 'd';
        arguments->positions[arguments->position_count++] = argument;
        return EXIT_YES;
    }
    const char **string = string_slot(arguments, name);
    if (string && *string)
        return complain("%s is given twice", name);
    if (string)
        *string = argument;
    else
        *flag_slot(arguments, name) = true;
    return EXIT_YES;
}

/* The option that a word names, "--name" or "--name=argument"; `inline_argument` points behind the "=". */
static const struct option *option_find(const struct command *command, const char *word,
                                        const char **inline_argument)
{
    const char *equals = strchr(word, '=');
    size_t length = word[1] == '-' && equals ? (size_t)(equals - word) : strlen(word);
    *inline_argument = word[length] == '=' ? word + length + 1 : NULL;
    for (const struct option *option = command->options; option->name; option++)
        if (strlen(option->name) == length && memcmp(option->name, word, length) == 0)
            return option;
    return NULL;
}

/* Reads the option in words[*index], and its argument from the next word. */
static int option_read(const struct command *command, int count, char **words, int *index,
                       struct arguments *arguments)
{
    const char *argument;
    const struct option *option = option_find(command, words[*index], &argument);
    if (!option)
        return complain("%s has no option '%s'; 'bcifs help %s' lists them", command->name, words[*index],
                        command->name);
    if (!option->argument && argument)
        return complain("%s takes no argument", option->name);
    if (option->argument && !argument) {
        if (*index + 1 == count)
            return complain("%s needs an argument: %s", option->name, option->argument);
        argument = words[++*index];
    }
    return option_store(arguments, option->name, argument);
}

int arguments_read(const struct command *command, int count, char **words, struct arguments *arguments)
{
    bool only_files = false;
    for (int i = 0; i < count; i++) {
        const char *word = words[i];
        if (!only_files && (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0)) {
            command_help(command);
            return -1;
        }
        if (!only_files && strcmp(word, "--") == 0) {
            only_files = true;
        } else if (!only_files && word[0] == '-' && word[1] != '\0') {
            int status = option_read(command, count, words, &i, arguments);
            if (status)
                return status;
        } else if (arguments->file) {
            return complain("one file at a time: '%s' and '%s'", arguments->file, word);
        } else {
            arguments->file = word;
        }
    }
    if (!arguments->file)
        return complain("usage: bcifs %s %s", command->name, command->usage);
    return EXIT_YES;
}

void command_help(const struct command *command)
{
    printf("Usage: bcifs %s %s\n\n%s\n", command->name, command->usage, command->summary);
    if (command->text)
        printf("\n%s", command->text);
    printf("\nOptions:\n");
    for (const struct option *option = command->options; option->name; option++) {
        char left[64];
        snprintf(left, sizeof left, "%s%s%s", option->name, option->argument ? " " : "",
                 option->argument ? option->argument : "");
        printf("  %-24s %s\n", left, option->text);
    }
}
