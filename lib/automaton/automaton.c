#include "automaton.h"

#include <string.h>

#include "automaton/bind.h"
#include "automaton/cell.h"
#include "automaton/figure.h"
#include "automaton/module.h"
#include "automaton/proof.h"
#include "base/decimal.h"

/* Elaborates every state once, to find what can only be seen with numbers: shapes, indices, divisions by zero.
 * States with arguments are tried at random ones; those whose sizes depend on them wait until a figure says. */
static bcifs_status states_validate(const bcifs_automaton *automaton, struct report *report)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < automaton->definition_count && !report_is_full(report); i++) {
        const struct definition *definition = automaton->definitions[i];
        if (definition->form != DEFINITION_WRITTEN || definition_is_structural(definition))
            continue;
        struct arena arena = {0};
        struct sample sample;
        struct cell *cell;
        bcifs_status one = sample_take(automaton, definition, NULL, SAMPLE_ACTUAL, 0, &arena, report, &sample);
        sample.setting.proving = definition->argument_count > 0;
        if (one == BCIFS_OK)
            one = cell_elaborate(&sample.setting, &arena, sample.key, &cell);
        arena_free(&arena);
        status = status ? status : one;
    }
    return status;
}

static bcifs_status figures_validate(const bcifs_automaton *automaton, struct report *report)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < automaton->figure_count && !report_is_full(report); i++) {
        bcifs_figure figure = {0};
        bcifs_status one = figure_bind(&figure, automaton, &automaton->figures[i], NULL, report);
        arena_free(&figure.arena);
        status = status ? status : one;
    }
    return status;
}

static bcifs_status load(bcifs_automaton *automaton, const struct source *source,
                         const bcifs_load_options *options, struct report *report)
{
    struct module *module;
    bcifs_status status = module_load(automaton, source, NULL, NULL, report, &module);
    if (automaton->module_count == 0 || status == BCIFS_MEMORY)
        return status;
    bcifs_status parameters = parameters_bind(automaton, options, report);
    status = status ? status : parameters;
    if (status)
        return status;
    status = automaton_bind(automaton, report);
    if (status == BCIFS_OK)
        status = states_validate(automaton, report);
    return status ? status : figures_validate(automaton, report);
}

static bcifs_status load_close(bcifs_automaton *fresh, bcifs_status status, const struct report *report,
                               bcifs_automaton **automaton, bcifs_error *error)
{
    if (status) {
        bcifs_automaton_free(fresh);
        report_close(report, error);
        return status;
    }
    *automaton = fresh;
    return BCIFS_OK;
}

bcifs_status bcifs_load(const char *path, const bcifs_load_options *options, bcifs_automaton **automaton,
                        bcifs_error *error)
{
    struct report report = report_new(options);
    struct source *source;
    bcifs_automaton *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? source_read(&fresh->arena, path, &report, &source) : report_memory(&report);
    if (status == BCIFS_OK)
        status = load(fresh, source, options, &report);
    return load_close(fresh, status, &report, automaton, error);
}

bcifs_status bcifs_load_text(const char *name, const char *text, size_t length, const bcifs_load_options *options,
                             bcifs_automaton **automaton, bcifs_error *error)
{
    struct report report = report_new(options);
    struct source *source;
    bcifs_automaton *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status =
        fresh ? source_from_text(&fresh->arena, name, text, length, &report, &source) : report_memory(&report);
    if (status == BCIFS_OK)
        status = load(fresh, source, options, &report);
    return load_close(fresh, status, &report, automaton, error);
}

void bcifs_automaton_free(bcifs_automaton *automaton)
{
    if (!automaton)
        return;
    arena_free(&automaton->arena);
    memory_free(automaton);
}

const char *bcifs_automaton_name(const bcifs_automaton *automaton)
{
    return automaton->modules[0]->syntax->name;
}

const char *bcifs_automaton_title(const bcifs_automaton *automaton)
{
    return automaton->modules[0]->syntax->title;
}

bcifs_status bcifs_format_file(const char *path, const bcifs_load_options *options, char **original,
                               char **formatted, bcifs_error *error)
{
    struct report report = report_new(options);
    struct arena arena = {0};
    struct source *source;
    struct syntax_file *file;
    struct text text = {0}, copy = {0};
    bcifs_status status = source_read(&arena, path, &report, &source);
    if (status == BCIFS_OK)
        status = syntax_parse(&arena, source, &report, &file);
    if (status == BCIFS_OK) {
        syntax_print(file, &text);
        text_append_bytes(&copy, source->text, source->length);
        if (text.failed || copy.failed)
            status = report_memory(&report);
    }
    if (status == BCIFS_OK) {
        *formatted = text_take(&text);
        if (original)
            *original = text_take(&copy);
    } else {
        report_close(&report, error);
    }
    text_free(&text);
    text_free(&copy);
    arena_free(&arena);
    return status;
}

void bcifs_text_free(char *text)
{
    memory_free(text);
}

const char *bcifs_version(void)
{
    return BCIFS_VERSION;
}

const char *bcifs_status_text(bcifs_status status)
{
    static const char *const words[] = {"success", "the answer is no", "bad input", "the system failed",
                                        "no memory"};
    return (unsigned)status < sizeof words / sizeof *words ? words[status] : "unknown status";
}

size_t bcifs_number_text(char *out, double number)
{
    size_t length = decimal_print(out, number);
    out[length] = '\0';
    return length;
}

bcifs_status bcifs_number_read(const char *text, double *number, bcifs_error *error)
{
    struct report report = report_new(NULL);
    struct arena arena = {0};
    struct source *source;
    struct expression *expression;
    struct value value;
    const struct scope none = {0};
    bcifs_status status = source_from_text(&arena, "number", text, strlen(text), &report, &source);
    if (status == BCIFS_OK)
        status = syntax_parse_expression(&arena, source, &report, &expression);
    if (status == BCIFS_OK)
        status = expression_resolve(expression, &none, NULL, 0, NULL, 0, source, &report);
    if (status == BCIFS_OK) {
        struct environment environment = {
            .steps = EVALUATION_MOST_STEPS, .source = source, .report = &report};
        status = expression_evaluate(expression, &environment, &value);
    }
    if (status == BCIFS_OK)
        *number = value.real;
    else
        report_close(&report, error);
    arena_free(&arena);
    return status;
}
