#include "module.h"

#include <string.h>

#include "base/decimal.h"

/* ---- Files --------------------------------------------------------------------------------------------- */

/* The path of a used file: relative to the folder of the file that uses it. */
static char *path_resolve(struct arena *arena, const char *from, const char *path)
{
    const char *slash = strrchr(from, '/');
    if (path[0] == '/' || !slash)
        return arena_text(arena, path, strlen(path));
    size_t folder = (size_t)(slash - from) + 1;
    char *joined = arena_new(arena, folder + strlen(path) + 1, 1);
    if (!joined)
        return NULL;
    memcpy(joined, from, folder);
    memcpy(joined + folder, path, strlen(path));
    return joined;
}

/* Whether two paths name the same file as far as their text tells: "./" and "x/../" do not count. A cycle that
 * hides behind links ends at AUTOMATON_MOST_MODULES. */
static bool path_same(const char *a, const char *b)
{
    for (;;) {
        while (a[0] == '.' && a[1] == '/')
            a += 2;
        while (b[0] == '.' && b[1] == '/')
            b += 2;
        size_t length_a = strcspn(a, "/"), length_b = strcspn(b, "/");
        if (length_a != length_b || memcmp(a, b, length_a) != 0)
            return false;
        a += length_a;
        b += length_b;
        if (*a == '\0' || *b == '\0')
            return *a == *b;
        a++;
        b++;
    }
}

char *module_qualify(bcifs_automaton *automaton, const struct module *module, const char *name)
{
    if (module->name[0] == '\0')
        return arena_text(&automaton->arena, name, strlen(name));
    size_t prefix = strlen(module->name);
    char *qualified = arena_new(&automaton->arena, prefix + 1 + strlen(name) + 1, 1);
    if (!qualified)
        return NULL;
    memcpy(qualified, module->name, prefix);
    qualified[prefix] = '.';
    memcpy(qualified + prefix + 1, name, strlen(name));
    return qualified;
}

struct module *module_named(const bcifs_automaton *automaton, const struct module *owner, const char *name)
{
    size_t prefix = owner->name[0] ? strlen(owner->name) + 1 : 0;
    for (size_t i = 0; i < automaton->module_count; i++) {
        struct module *module = automaton->modules[i];
        if (module->owner == owner && strcmp(module->name + prefix, name) == 0)
            return module;
    }
    return NULL;
}

static bcifs_status use_load(bcifs_automaton *automaton, struct module *module, const struct syntax_use *use,
                             struct report *report)
{
    char *path = path_resolve(&automaton->arena, module->source->name, use->path);
    if (!path)
        return report_memory(report);
    for (const struct module *user = module; user; user = user->owner)
        if (path_same(user->source->name, path))
            return report_error(report, module->source, use->place, "circular use: '%s' uses itself", use->path);
    if (automaton->module_count >= AUTOMATON_MOST_MODULES)
        return report_error(report, module->source, use->place, "more than %d files are used",
                            AUTOMATON_MOST_MODULES);
    struct source *source;
    unsigned errors = report->errors;
    bcifs_status status = source_read(&automaton->arena, path, report, &source);
    if (status && report->errors > errors)
        return report_error(report, module->source, use->place, "cannot use '%s'", use->path);
    struct module *used;
    return status ? status : module_load(automaton, source, use, module, report, &used);
}

/* ---- Params and lets ----------------------------------------------------------------------------------- */

static bool name_is_taken(const struct scope *scope, const char *name)
{
    for (size_t i = 0; i < scope->parameter_count; i++)
        if (strcmp(scope->parameters[i]->name, name) == 0)
            return true;
    for (size_t i = 0; i < scope->let_count; i++)
        if (strcmp(scope->lets[i]->name, name) == 0)
            return true;
    return false;
}

/* A number's or function's name must be new in its file and not built in. */
static bool name_is_free(const struct scope *scope, const char *name, const struct source *source,
                         source_place place, struct report *report)
{
    if (name_is_builtin(name)) {
        report_error(report, source, place, "'%s' is built in; choose another name", name);
        return false;
    }
    if (name_is_taken(scope, name)) {
        report_error(report, source, place, "the name '%s' is used twice", name);
        return false;
    }
    return true;
}

static bcifs_status parameter_add(bcifs_automaton *automaton, struct module *module,
                                  struct syntax_parameter *syntax, struct report *report)
{
    if (automaton->parameter_count >= AUTOMATON_MOST_ITEMS)
        return report_error(report, module->source, syntax->place, "more than %d params", AUTOMATON_MOST_ITEMS);
    if (!ARENA_RESERVE(&automaton->arena, automaton->parameters, automaton->parameter_count,
                       automaton->parameter_capacity))
        return report_memory(report);
    const char *name = module_qualify(automaton, module, syntax->name);
    if (!name)
        return report_memory(report);
    syntax->index = (uint32_t)automaton->parameter_count;
    automaton->parameters[automaton->parameter_count++] =
        (struct parameter){.name = name, .module = module, .syntax = syntax};
    return BCIFS_OK;
}

/* Collects the params and lets of a module. */
static bcifs_status scope_fill(bcifs_automaton *automaton, struct module *module, struct report *report)
{
    const struct syntax_file *file = module->syntax;
    struct scope *scope = arena_new(&automaton->arena, 1, sizeof *scope);
    if (!scope)
        return report_memory(report);
    scope->parameters = arena_new(&automaton->arena, file->count, sizeof *scope->parameters);
    scope->lets = arena_new(&automaton->arena, file->count, sizeof *scope->lets);
    if (!scope->parameters || !scope->lets)
        return report_memory(report);
    module->scope = scope;
    bcifs_status result = BCIFS_OK;
    for (size_t i = 0; i < file->count; i++) {
        struct syntax_item *item = &file->items[i];
        bool is_parameter = item->kind == ITEM_PARAMETER;
        if (!is_parameter && item->kind != ITEM_LET)
            continue;
        const char *name = is_parameter ? item->parameter->name : item->let->name;
        source_place place = is_parameter ? item->parameter->place : item->let->place;
        if (!name_is_free(scope, name, module->source, place, report)) {
            result = BCIFS_INPUT;
        } else if (!is_parameter) {
            scope->lets[scope->let_count++] = item->let;
        } else {
            bcifs_status status = parameter_add(automaton, module, item->parameter, report);
            if (status)
                return status;
            scope->parameters[scope->parameter_count++] = item->parameter;
        }
    }
    return result;
}

bcifs_status module_load(bcifs_automaton *automaton, const struct source *source, const struct syntax_use *use,
                         struct module *owner, struct report *report, struct module **module)
{
    struct syntax_file *syntax;
    bcifs_status status = syntax_parse(&automaton->arena, source, report, &syntax);
    if (status)
        return status;
    if (!ARENA_RESERVE(&automaton->arena, automaton->modules, automaton->module_count,
                       automaton->module_capacity))
        return report_memory(report);
    struct module *fresh = arena_new(&automaton->arena, 1, sizeof *fresh);
    if (!fresh)
        return report_memory(report);
    *fresh = (struct module){.source = source, .syntax = syntax, .name = "", .owner = owner};
    const char *name = use && use->name ? use->name : syntax->name;
    if (owner && !(fresh->name = module_qualify(automaton, owner, name)))
        return report_memory(report);
    if (owner && module_named(automaton, owner, name))
        return report_error(report, owner->source, use->name ? use->name_place : use->place,
                            "two used files are both called '%s'; name one with 'as'", name);
    automaton->modules[automaton->module_count++] = fresh;
    *module = fresh;
    status = scope_fill(automaton, fresh, report);
    for (size_t i = 0; i < syntax->count; i++)
        if (syntax->items[i].kind == ITEM_USE && status != BCIFS_MEMORY) {
            bcifs_status used = use_load(automaton, fresh, syntax->items[i].use, report);
            status = status ? status : used;
        }
    return status;
}

/* ---- Values of params ---------------------------------------------------------------------------------- */

static bcifs_status value_of(const struct module *module, struct expression *expression,
                             const struct value *values, size_t known, struct report *report,
                             struct value *value)
{
    bcifs_status status =
        expression_resolve(expression, module->scope, NULL, 0, NULL, 0, module->source, report);
    if (status)
        return status;
    struct environment environment = {.parameters = values,
                                      .known = known,
                                      .steps = EVALUATION_MOST_STEPS,
                                      .source = module->source,
                                      .report = report};
    return expression_evaluate(expression, &environment, value);
}

/* The parameter that a setting "NAME=…" is for; `length` bytes of name. */
static struct parameter *parameter_find(bcifs_automaton *automaton, const char *name, size_t length)
{
    for (size_t i = 0; i < automaton->parameter_count; i++) {
        const char *candidate = automaton->parameters[i].name;
        if (strlen(candidate) == length && memcmp(candidate, name, length) == 0)
            return &automaton->parameters[i];
    }
    return NULL;
}

static bcifs_status unknown_parameter(const bcifs_automaton *automaton, const char *setting, size_t length,
                                      struct report *report)
{
    char name[SYNTAX_LONGEST_NAME + 1] = "";
    const char *candidates[64] = {NULL};
    size_t count = 0;
    if (length < sizeof name)
        memcpy(name, setting, length);
    for (size_t i = 0; i < automaton->parameter_count && count < 64; i++)
        candidates[count++] = automaton->parameters[i].name;
    const char *nearest = nearest_word(name, candidates, count);
    if (nearest)
        return report_failure(report, BCIFS_INPUT, NULL, "--set %s: the file has no param '%s'; did you mean '%s'?",
                              setting, name, nearest);
    return report_failure(report, BCIFS_INPUT, NULL, "--set %s: the file has no param '%s'%s", setting, name,
                          count ? "" : " (it has none at all)");
}

/* The expression of a setting, evaluated without any names but the built-in ones. */
static bcifs_status setting_read(bcifs_automaton *automaton, const char *setting, struct report *report,
                                 struct parameter **parameter, struct value *value)
{
    const char *equals = strchr(setting, '=');
    if (!equals)
        return report_failure(report, BCIFS_INPUT, NULL, "--set %s: expected NAME=EXPRESSION", setting);
    *parameter = parameter_find(automaton, setting, (size_t)(equals - setting));
    if (!*parameter)
        return unknown_parameter(automaton, setting, (size_t)(equals - setting), report);
    struct source *source;
    struct expression *expression;
    struct text name = {0};
    text_format(&name, "--set %s", (*parameter)->name);
    const char *kept = name.failed ? NULL : arena_text(&automaton->arena, name.data, name.length);
    text_free(&name);
    if (!kept)
        return report_memory(report);
    bcifs_status status =
        source_from_text(&automaton->arena, kept, equals + 1, strlen(equals + 1), report, &source);
    if (status == BCIFS_OK)
        status = syntax_parse_expression(&automaton->arena, source, report, &expression);
    const struct scope none = {0};
    struct module module = {.source = source, .scope = (struct scope *)&none};
    return status ? status : value_of(&module, expression, NULL, 0, report, value);
}

static bcifs_status settings_read(bcifs_automaton *automaton, const char *const *settings, size_t count,
                                  struct report *report)
{
    for (size_t i = 0; i < count; i++) {
        struct parameter *parameter = NULL;
        struct value value;
        bcifs_status status = setting_read(automaton, settings[i], report, &parameter, &value);
        if (status)
            return status;
        parameter->value = value;
        parameter->is_set = true;
    }
    return BCIFS_OK;
}

static bcifs_status parameter_range(struct parameter *parameter, const struct value *values, size_t known,
                                    struct report *report)
{
    const struct syntax_parameter *syntax = parameter->syntax;
    struct value low, high;
    bcifs_status status = value_of(parameter->module, syntax->low, values, known, report, &low);
    if (status == BCIFS_OK)
        status = value_of(parameter->module, syntax->high, values, known, report, &high);
    if (status)
        return status;
    parameter->has_range = true;
    parameter->low = low.real;
    parameter->high = high.real;
    if (!(low.real <= high.real))
        return report_error(report, parameter->module->source, syntax->low->place, "the range of '%s' is empty",
                            parameter->name);
    double real = parameter->value.real;
    if (real >= low.real && real <= high.real)
        return BCIFS_OK;
    char text[3][DECIMAL_LONGEST + 1];
    text[0][decimal_print(text[0], real)] = '\0';
    text[1][decimal_print(text[1], low.real)] = '\0';
    text[2][decimal_print(text[2], high.real)] = '\0';
    if (parameter->is_set)
        return report_failure(report, BCIFS_INPUT, NULL, "--set %s: %s lies outside its range %s..%s",
                              parameter->name, text[0], text[1], text[2]);
    return report_error(report, parameter->module->source, syntax->value->place,
                        "'%s' = %s lies outside its range %s..%s", parameter->name, text[0], text[1], text[2]);
}

static bcifs_status lets_resolve(const struct module *module, struct report *report)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < module->scope->let_count; i++) {
        bcifs_status one = let_resolve(module->scope->lets[i], module->scope, module->source, report);
        status = status ? status : one;
    }
    return status;
}

bcifs_status parameters_bind(bcifs_automaton *automaton, const bcifs_load_options *options, struct report *report)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < automaton->module_count; i++) {
        bcifs_status lets = lets_resolve(automaton->modules[i], report);
        status = status ? status : lets;
    }
    bcifs_status set =
        options ? settings_read(automaton, options->settings, options->setting_count, report) : BCIFS_OK;
    status = status ? status : set;
    struct value *values = arena_new(&automaton->arena, automaton->parameter_count, sizeof *values);
    if (!values)
        return report_memory(report);
    for (size_t i = 0; i < automaton->parameter_count && status == BCIFS_OK; i++) {
        struct parameter *parameter = &automaton->parameters[i];
        struct value own;
        status = value_of(parameter->module, parameter->syntax->value, values, i, report, &own);
        if (status == BCIFS_OK && !parameter->is_set)
            parameter->value = own;
        if (status == BCIFS_OK && parameter->syntax->low)
            status = parameter_range(parameter, values, i, report);
        values[i] = parameter->value;
    }
    for (size_t i = 0; options && options->fix_params && i < automaton->parameter_count; i++)
        automaton->parameters[i].is_set = true;
    automaton->values = values;
    return status;
}
