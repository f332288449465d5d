/* Rewriting the main file at another level of description, [IM] 4.
 *
 * The text is edited where an edge's maps stand, and then put in canonical layout; everything else stays as
 * it was written. Where the level can be written by moving entries about, their own texts are moved, so that
 * params and arguments stay free: that the moved entries agree is then an identity, checked with random
 * residues in place of everything free. Otherwise the entries are written as numbers, for the params' values.
 */
#include <string.h>

#include "automaton/describe.h"
#include "automaton/proof.h"
#include "numeric/field.h"

/* A matrix of texts, with the values that they have. */
struct script {
    size_t rows, columns;
    const char **texts; /* an entry may be NULL: it has no text of its own */
};

/* Bytes from … to - 1 of the source give way to `text`. */
struct edit {
    size_t from, to;
    const char *text;
};

struct rewriting {
    const bcifs_automaton *automaton;
    bcifs_level level;
    struct report *report;
    struct arena arena;
    const struct source *source;
    const struct syntax_file *file;
    struct edit *edits;
    size_t count, capacity;
    char reason[512]; /* why the answer is no; "" while it is not */
};

/* One edge, elaborated. */
struct subject {
    const struct definition *definition;
    struct states states;
    size_t state;
    const struct cell *cell;
    struct level_class class;
    const struct value_matrix *fused;
    struct level_masks masks;
};

static bcifs_status out_of_memory(const struct rewriting *rewriting)
{
    return report_memory(rewriting->report);
}

/* The answer is no: keeps the first reason. */
static bcifs_status decline(struct rewriting *rewriting, const struct definition *definition,
                            const char *reason)
{
    static const char *const forms[] = {
        [BCIFS_MAPS] = "maps", [BCIFS_REFINEMENT] = "a refinement matrix", [BCIFS_MASK] = "a mask"};
    struct text text = {0};
    text_format(&text, "'%s' cannot be written as %s: %s", definition->name, forms[rewriting->level], reason);
    if (!text.failed && !rewriting->reason[0]) {
        size_t length =
            text.length < sizeof rewriting->reason - 1 ? text.length : sizeof rewriting->reason - 1;
        memcpy(rewriting->reason, text.data, length);
        rewriting->reason[length] = '\0';
    }
    bool failed = text.failed;
    text_free(&text);
    return failed ? out_of_memory(rewriting) : BCIFS_NO;
}

/* ---- Texts --------------------------------------------------------------------------------------------- */

static const struct token *token_at(const struct rewriting *rewriting, uint32_t index)
{
    return &rewriting->file->tokens[index];
}

/* Keeps a text in the arena; takes it. */
static bcifs_status text_keep(struct rewriting *rewriting, struct text *text, const char **kept)
{
    *kept = text->failed ? NULL : arena_text(&rewriting->arena, text->data ? text->data : "", text->length);
    text_free(text);
    return *kept ? BCIFS_OK : out_of_memory(rewriting);
}

/* An entry as it was written, on one line and without comments. */
static bcifs_status entry_text(struct rewriting *rewriting, const struct expression *entry, const char **kept)
{
    struct text text = {0};
    for (uint32_t i = entry->first; i <= entry->last; i++) {
        const struct token *token = token_at(rewriting, i);
        if (i > entry->first && token->space_before)
            text_append(&text, " ");
        text_append_bytes(&text, rewriting->source->text + token->place, token->length);
    }
    return text_keep(rewriting, &text, kept);
}

static bcifs_status script_new(struct rewriting *rewriting, size_t rows, size_t columns,
                               struct script *script)
{
    *script =
        (struct script){rows, columns, arena_new(&rewriting->arena, rows * columns, sizeof *script->texts)};
    return script->texts ? BCIFS_OK : out_of_memory(rewriting);
}

static bcifs_status script_of_matrix(struct rewriting *rewriting, const struct syntax_matrix *matrix,
                                     struct script *script)
{
    bcifs_status status = script_new(rewriting, matrix->rows, matrix->columns, script);
    for (size_t i = 0; i < matrix->rows * matrix->columns && status == BCIFS_OK; i++)
        status = entry_text(rewriting, matrix->entries[i], &script->texts[i]);
    return status;
}

static void script_write(struct text *text, const struct script *script)
{
    text_append(text, "[ ");
    for (size_t i = 0; i < script->rows; i++) {
        text_append(text, i ? "\n  " : "");
        for (size_t j = 0; j < script->columns; j++) {
            text_append(text, j ? " " : "");
            text_append(text, script->texts[i * script->columns + j]);
        }
    }
    text_append(text, " ]");
}

/* Columns first … first + columns - 1 of rows 0 … rows - 1. */
static bcifs_status script_part(struct rewriting *rewriting, const struct script *whole, size_t rows,
                                size_t first, size_t columns, struct script *part)
{
    bcifs_status status = script_new(rewriting, rows, columns, part);
    for (size_t i = 0; i < rows && status == BCIFS_OK; i++)
        for (size_t j = 0; j < columns; j++)
            part->texts[i * columns + j] = whole->texts[i * whole->columns + first + j];
    return status;
}

static bcifs_status edit_add(struct rewriting *rewriting, size_t from, size_t to, const char *text)
{
    if (!ARENA_RESERVE(&rewriting->arena, rewriting->edits, rewriting->count, rewriting->capacity))
        return out_of_memory(rewriting);
    /* Sorted by place; of two at one place the first added comes first. */
    size_t place = rewriting->count++;
    for (; place > 0 && rewriting->edits[place - 1].from > from; place--)
        rewriting->edits[place] = rewriting->edits[place - 1];
    rewriting->edits[place] = (struct edit){from, to, text};
    return BCIFS_OK;
}

static size_t token_end(const struct rewriting *rewriting, uint32_t index)
{
    const struct token *token = token_at(rewriting, index);
    return token->place + token->length;
}

static bcifs_status tokens_replace(struct rewriting *rewriting, uint32_t first, uint32_t last,
                                   const char *text)
{
    return edit_add(rewriting, token_at(rewriting, first)->place, token_end(rewriting, last), text);
}

/* ---- The edge's matrices ------------------------------------------------------------------------------- */

/* Elaborates the edge: `free` with random residues for params and arguments, otherwise at the params' values.
 */
static bcifs_status subject_make(struct rewriting *rewriting, const struct definition *definition, bool free,
                                 uint64_t seed, struct subject *subject)
{
    struct sample sample;
    size_t index = 0;
    const char *reason;
    *subject = (struct subject){.definition = definition};
    bcifs_status status =
        sample_take(rewriting->automaton, definition, NULL, free ? SAMPLE_PROVING : SAMPLE_ACTUAL, seed,
                    &rewriting->arena, rewriting->report, &sample);
    /* A param that was set is a number here, but stays a param in the file. */
    for (size_t i = 0; status == BCIFS_OK && free && i < rewriting->automaton->parameter_count; i++) {
        const struct parameter *parameter = &rewriting->automaton->parameters[i];
        uint64_t state = seed + 7919 * (i + 1);
        if (parameter->is_set && !parameter->structural)
            sample.parameters[i] = (struct value){parameter->value.real, field_random(&state), true, false};
    }
    if (status == BCIFS_OK)
        status = states_create(&subject->states, &rewriting->arena, &sample.setting);
    if (status == BCIFS_OK)
        status = states_intern(&subject->states, sample.key, &index);
    if (status == BCIFS_OK)
        status = levels_classify(&subject->states, index, &subject->class);
    if (status == BCIFS_OK)
        status = levels_fuse(&subject->states, index, &subject->fused, &reason);
    if (status == BCIFS_OK)
        status = levels_mask(&subject->states, index, subject->fused, &subject->masks);
    subject->state = index;
    subject->cell = status == BCIFS_OK ? subject->states.states[index].cell : NULL;
    if (status == BCIFS_OK && !subject->fused)
        subject->masks.reason = subject->masks.row_reason = reason;
    return status;
}

/* T_÷ by its texts, as far as there are any: from the mask, the refinement matrix or the maps. */
static bcifs_status refinement_script(struct rewriting *rewriting, const struct subject *subject,
                                      struct script *script)
{
    const struct syntax_cell *cell = subject->definition->syntax;
    const struct syntax_part *mask = syntax_part_of_kind(cell, PART_MASK, 0),
                             *refine = syntax_part_of_kind(cell, PART_REFINE, 0);
    const struct syntax_part *part = mask ? mask : refine;
    size_t m = subject->class.points, n = subject->class.subdivisions, step = subject->class.step;
    struct script written;
    if (refine && refine->matrix)
        return script_of_matrix(rewriting, refine->matrix, script);
    bcifs_status status = script_new(rewriting, m, n * step + subject->class.joint[0], script);
    if (status == BCIFS_OK && mask)
        status = script_of_matrix(rewriting, mask->matrix, &written);
    /* Entry (j, k) is c[k + N(m-1-j) - (m-1)], 0 beyond its ends (cell.c, refinement_evaluate). */
    for (size_t i = 0; status == BCIFS_OK && mask && i < m * script->columns; i++) {
        size_t index = i % script->columns + n * (m - 1 - i / script->columns);
        bool inside = index >= m - 1 && index - (m - 1) < written.columns;
        script->texts[i] = inside ? written.texts[index - (m - 1)] : "0";
    }
    for (size_t k = 0; status == BCIFS_OK && !part && k < n; k++) {
        part = syntax_part_of_kind(cell, PART_SUB, k);
        if (part->matrix)
            status = script_of_matrix(rewriting, part->matrix, &written);
        for (size_t i = 0; status == BCIFS_OK && part->matrix && i < m * m; i++) {
            const char **text = &script->texts[i / m * script->columns + k * step + i % m];
            *text = *text ? *text : written.texts[i];
        }
        part = NULL;
    }
    return status;
}

/* The entries without a text, or all, become numbers; BCIFS_NO where these depend on arguments. */
static bcifs_status script_complete(struct rewriting *rewriting, const struct subject *free,
                                    const struct subject *actual, bool all, struct script *script,
                                    bool *of_params)
{
    *of_params = false;
    for (size_t i = 0; i < script->rows * script->columns; i++) {
        const struct value value = actual->fused->values[i];
        if (script->texts[i] && !all)
            continue;
        bool fixed = free->fused && free->fused->values[i].fixed;
        if (!fixed && actual->definition->argument_count > 0)
            return decline(rewriting, actual->definition,
                           "an entry depends on its arguments and has no text to copy");
        struct text text = {0};
        *of_params = *of_params || !fixed;
        value_write(&text, value);
        bcifs_status status = text_keep(rewriting, &text, &script->texts[i]);
        if (status)
            return status;
    }
    return BCIFS_OK;
}

/* Whether the level exists identically: the same for several random choices of what is free. */
static bcifs_status level_proved(struct rewriting *rewriting, const struct definition *definition,
                                 struct subject *free, const char **reason)
{
    *reason = NULL;
    for (uint64_t round = 0; round < PROOF_ROUNDS && !*reason; round++) {
        bcifs_status status = subject_make(rewriting, definition, true, round, free);
        if (status)
            return status;
        *reason = !free->fused                                         ? free->masks.reason
                  : rewriting->level == BCIFS_MASK && !free->masks.row ? free->masks.row_reason
                                                                       : NULL;
    }
    return BCIFS_OK;
}

/* Both refine and mask put every child in the state itself, arguments included. */
static bool children_are_own(const struct syntax_cell *cell, const struct definition *definition)
{
    for (size_t i = 0; syntax_part_of_kind(cell, PART_SUB, i); i++) {
        const struct reference *target = syntax_part_of_kind(cell, PART_SUB, i)->reference->target;
        if (target->definition != definition)
            return false;
        for (size_t k = 0; k < definition->argument_count; k++) {
            const struct expression *argument = target->arguments ? target->arguments[k] : NULL;
            if (!argument || argument->kind != EXPRESSION_NAME || argument->binding != BINDING_ARGUMENT ||
                argument->index != k)
                return false;
        }
    }
    return true;
}

/* T_÷ in words and numbers, and a note when numbers stand for params. BCIFS_NO when the level does not exist.
 */
static bcifs_status edge_script(struct rewriting *rewriting, const struct definition *definition,
                                struct subject *actual, struct script *script, bool *of_params)
{
    struct subject free;
    const char *reason;
    if (!children_are_own(definition->syntax, definition))
        return decline(rewriting, definition,
                       definition->argument_count
                           ? "its children are in other states, or have other arguments"
                           : "its children are in other states");
    bcifs_status status = level_proved(rewriting, definition, &free, &reason);
    if (status == BCIFS_OK)
        status = subject_make(rewriting, definition, false, 0, actual);
    if (status)
        return status;
    bool missing = !actual->fused || (rewriting->level == BCIFS_MASK && !actual->masks.row);
    if (missing || (reason && definition->argument_count > 0))
        return decline(rewriting, definition,
                       actual->fused && missing ? actual->masks.row_reason
                       : missing                ? actual->masks.reason
                                                : reason);
    if (actual->class.step == 0 || actual->class.joint[0] != actual->class.joint[1] ||
        actual->class.subdivisions < 2)
        return decline(rewriting, definition,
                       "it needs two children and joints of one size, smaller than the arc");
    status = refinement_script(rewriting, actual, script);
    return status ? status : script_complete(rewriting, &free, actual, reason != NULL, script, of_params);
}

/* ---- Writing ------------------------------------------------------------------------------------------- */

/* "# …" before the edge when numbers were taken for params. */
static bcifs_status note_add(struct rewriting *rewriting, const struct syntax_cell *cell)
{
    struct text text = {0};
    const char *kept;
    text_append(&text, "# The entries are for ");
    for (size_t i = 0; i < rewriting->automaton->parameter_count; i++) {
        text_format(&text, "%s%s = ", i ? ", " : "", rewriting->automaton->parameters[i].name);
        value_write(&text, rewriting->automaton->parameters[i].value);
    }
    text_append(&text, ".\n");
    bcifs_status status = text_keep(rewriting, &text, &kept);
    size_t place = token_at(rewriting, cell->first)->place;
    return status ? status : edit_add(rewriting, place, place, kept);
}

/* The part that held the maps gives way to `text`; of several `sub` the first does, the others go. */
static bcifs_status maps_replace(struct rewriting *rewriting, const struct syntax_cell *cell,
                                 struct text *text)
{
    const char *kept;
    bcifs_status status = text_keep(rewriting, text, &kept);
    for (size_t i = 0; i < cell->part_count && status == BCIFS_OK; i++) {
        const struct syntax_part *part = cell->parts[i];
        if (part->kind != PART_SUB && part->kind != PART_REFINE && part->kind != PART_MASK)
            continue;
        status = tokens_replace(rewriting, part->first, part->last, kept);
        kept = "";
    }
    return status;
}

static bcifs_status refinement_write(struct rewriting *rewriting, const struct definition *definition,
                                     const struct subject *actual, const struct script *script)
{
    struct text text = {0};
    text_format(&text, "refine %zu ", actual->class.subdivisions);
    script_write(&text, script);
    return maps_replace(rewriting, definition->syntax, &text);
}

/* c[k + N(m-1-j) - (m-1)] is entry (j, k) of T_÷; the first that has a place names it. */
static bcifs_status mask_write(struct rewriting *rewriting, const struct definition *definition,
                               const struct subject *actual, const struct script *script)
{
    size_t m = actual->class.points, n = actual->class.subdivisions;
    struct script row;
    struct text text = {0};
    bcifs_status status = script_new(rewriting, 1, actual->masks.row_count, &row);
    if (status)
        return status;
    for (size_t i = 0; i < m * script->columns; i++) {
        size_t index = i % script->columns + n * (m - 1 - i / script->columns);
        if (index >= m - 1 && index - (m - 1) < row.columns && !row.texts[index - (m - 1)])
            row.texts[index - (m - 1)] = script->texts[i];
    }
    for (size_t i = 0; i < row.columns; i++)
        row.texts[i] = row.texts[i] ? row.texts[i] : "0";
    text_format(&text, "mask %zu ", n);
    script_write(&text, &row);
    return maps_replace(rewriting, definition->syntax, &text);
}

/* "(u,v)" when the edge takes arguments. */
static void arguments_write(struct text *text, const struct syntax_cell *cell)
{
    for (size_t i = 0; i < cell->argument_count; i++)
        text_format(text, "%s%s", i ? "," : "(", cell->arguments[i]);
    text_append(text, cell->argument_count ? ")" : "");
}

/* Whether the file says this name anywhere, so that it must not be given to something new. */
static bool name_is_taken(const struct rewriting *rewriting, const char *name)
{
    size_t length = strlen(name);
    for (size_t i = 0; i < rewriting->file->token_count; i++) {
        const struct token *token = token_at(rewriting, (uint32_t)i);
        if (token->kind == TOKEN_NAME && token->length == length &&
            memcmp(rewriting->source->text + token->place, name, length) == 0)
            return true;
    }
    return name_is_builtin(name);
}

/* "arc_joint", or the first of "arc_joint_2", … that is free. */
static bcifs_status joint_name(struct rewriting *rewriting, const struct definition *definition,
                               const char **name)
{
    for (unsigned number = 1;; number++) {
        struct text text = {0};
        text_format(&text, "%s_joint", definition->syntax->name);
        if (number > 1)
            text_format(&text, "_%u", number);
        bcifs_status status = text_keep(rewriting, &text, name);
        if (status || !name_is_taken(rewriting, *name))
            return status;
    }
}

/* The vertex state that refine and mask imply, before the edge, and the boundaries in it. */
static bcifs_status joint_write(struct rewriting *rewriting, const struct subject *actual,
                                const struct script *script, struct text *boundaries)
{
    const struct syntax_cell *cell = actual->definition->syntax;
    size_t joint = actual->class.joint[0];
    struct script map;
    struct text text = {0};
    const char *name, *kept;
    bcifs_status status = joint_name(rewriting, actual->definition, &name);
    if (status == BCIFS_OK)
        status = script_part(rewriting, script, joint, 0, joint, &map);
    if (status)
        return status;
    text_format(&text, "vertex %s", name);
    arguments_write(&text, cell);
    text_format(&text, " %zu { sub %s", joint, name);
    arguments_write(&text, cell);
    text_append(&text, " ");
    script_write(&text, &map);
    text_append(&text, "\n}\n\n");
    for (int side = 0; side < 2; side++) {
        text_format(boundaries, "%s %s", side ? "end" : "start", name);
        arguments_write(boundaries, cell);
        text_append(boundaries, " at");
        for (size_t j = 0; j < joint; j++)
            text_format(boundaries, " %zu", j + (side ? actual->class.step : 0));
        text_append(boundaries, "\n");
    }
    status = text_keep(rewriting, &text, &kept);
    size_t place = token_at(rewriting, cell->first)->place;
    return status ? status : edit_add(rewriting, place, place, kept);
}

/* A count of control points, which a mask need not give. */
static bcifs_status count_write(struct rewriting *rewriting, const struct subject *actual)
{
    const struct syntax_cell *cell = actual->definition->syntax;
    struct text text = {0};
    const char *kept;
    if (cell->points)
        return BCIFS_OK;
    text_format(&text, "%zu ", actual->class.points);
    bcifs_status status = text_keep(rewriting, &text, &kept);
    uint32_t brace = cell->first;
    while (rewriting->source->text[token_at(rewriting, brace)->place] != '{')
        brace++;
    size_t place = token_at(rewriting, brace)->place;
    return status ? status : edit_add(rewriting, place, place, kept);
}

static bcifs_status maps_write(struct rewriting *rewriting, const struct definition *definition,
                               const struct subject *actual, const struct script *script)
{
    const struct syntax_cell *cell = definition->syntax;
    struct text text = {0};
    bcifs_status status = count_write(rewriting, actual);
    if (status == BCIFS_OK && definition->joint)
        status = joint_write(rewriting, actual, script, &text);
    for (size_t i = 0; i < actual->class.subdivisions && status == BCIFS_OK; i++) {
        struct script map;
        status = script_part(rewriting, script, actual->class.points, i * actual->class.step,
                             actual->class.points, &map);
        if (status)
            break;
        text_format(&text, "%ssub %s", i ? "\n" : "", cell->name);
        arguments_write(&text, cell);
        text_append(&text, " ");
        script_write(&text, &map);
    }
    if (status) {
        text_free(&text);
        return status;
    }
    return maps_replace(rewriting, cell, &text);
}

/* ---- The file ------------------------------------------------------------------------------------------ */

static bcifs_status edge_rewrite(struct rewriting *rewriting, const struct definition *definition)
{
    static const enum part_kind kinds[] = {
        [BCIFS_MAPS] = PART_SUB, [BCIFS_REFINEMENT] = PART_REFINE, [BCIFS_MASK] = PART_MASK};
    struct subject actual;
    struct script script;
    bool of_params = false;
    if (syntax_part_of_kind(definition->syntax, kinds[rewriting->level], 0))
        return BCIFS_OK;
    if (definition_is_structural(definition))
        return decline(rewriting, definition, "its sizes depend on its arguments");
    bcifs_status status = edge_script(rewriting, definition, &actual, &script, &of_params);
    if (status == BCIFS_OK && of_params && rewriting->automaton->parameter_count > 0)
        status = note_add(rewriting, definition->syntax);
    if (status)
        return status;
    switch (rewriting->level) {
    case BCIFS_MAPS:
        return maps_write(rewriting, definition, &actual, &script);
    case BCIFS_REFINEMENT:
        return refinement_write(rewriting, definition, &actual, &script);
    case BCIFS_MASK:
        return mask_write(rewriting, definition, &actual, &script);
    }
    return BCIFS_OK;
}

/* A param that was set gets its new value. */
static bcifs_status parameters_rewrite(struct rewriting *rewriting)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < rewriting->automaton->parameter_count && status == BCIFS_OK; i++) {
        const struct parameter *parameter = &rewriting->automaton->parameters[i];
        struct text text = {0};
        const char *kept;
        if (!parameter->is_set || parameter->module != rewriting->automaton->modules[0])
            continue;
        value_write(&text, parameter->value);
        status = text_keep(rewriting, &text, &kept);
        if (status == BCIFS_OK)
            status = tokens_replace(rewriting, parameter->syntax->value->first,
                                    parameter->syntax->value->last, kept);
    }
    return status;
}

static bcifs_status edges_rewrite(struct rewriting *rewriting)
{
    const bcifs_automaton *automaton = rewriting->automaton;
    size_t edges = 0;
    for (size_t i = 0; i < automaton->definition_count; i++) {
        const struct definition *definition = automaton->definitions[i];
        if (definition->form != DEFINITION_WRITTEN || definition->kind != CELL_EDGE ||
            definition->module != automaton->modules[0])
            continue;
        bcifs_status status = edge_rewrite(rewriting, definition);
        if (status)
            return status;
        edges++;
    }
    if (edges > 0 || rewriting->level == BCIFS_MAPS)
        return BCIFS_OK;
    static const char nothing[] = "the file has no edge; refinement matrices and masks are for edges";
    memcpy(rewriting->reason, nothing, sizeof nothing);
    return BCIFS_NO;
}

/* The edited text in canonical layout. */
static bcifs_status text_finish(struct rewriting *rewriting, struct text *text)
{
    struct text edited = {0};
    struct source *source;
    struct syntax_file *file;
    size_t place = 0;
    for (size_t i = 0; i < rewriting->count; i++) {
        const struct edit *edit = &rewriting->edits[i];
        text_append_bytes(&edited, rewriting->source->text + place, edit->from - place);
        text_append(&edited, edit->text);
        place = edit->to;
    }
    text_append_bytes(&edited, rewriting->source->text + place, rewriting->source->length - place);
    bcifs_status status = edited.failed
                              ? out_of_memory(rewriting)
                              : source_from_text(&rewriting->arena, rewriting->source->name, edited.data,
                                                 edited.length, rewriting->report, &source);
    if (status == BCIFS_OK)
        status = syntax_parse(&rewriting->arena, source, rewriting->report, &file);
    text_free(&edited);
    if (status)
        return status;
    syntax_print(file, text);
    return text->failed ? out_of_memory(rewriting) : BCIFS_OK;
}

bcifs_status bcifs_rewrite(const bcifs_automaton *automaton, bcifs_level level, char **text,
                           bcifs_error *error)
{
    struct report report = report_new(NULL);
    struct rewriting rewriting = {.automaton = automaton,
                                  .level = level,
                                  .report = &report,
                                  .source = automaton->modules[0]->source,
                                  .file = automaton->modules[0]->syntax};
    struct text result = {0};
    bcifs_status status = BCIFS_OK;
    if (automaton->unknowns > 0)
        status = report_failure(&report, BCIFS_INPUT, rewriting.source->name,
                                "the automaton has unknown entries '?'; bcifs complete solves for them");
    if (status == BCIFS_OK)
        status = edges_rewrite(&rewriting);
    if (status == BCIFS_OK)
        status = parameters_rewrite(&rewriting);
    if (status == BCIFS_OK)
        status = text_finish(&rewriting, &result);
    if (status == BCIFS_NO)
        report_failure(&report, BCIFS_NO, rewriting.source->name, "%s", rewriting.reason);
    if (status == BCIFS_OK)
        *text = text_take(&result);
    else
        report_close(&report, error);
    text_free(&result);
    arena_free(&rewriting.arena);
    return status;
}
