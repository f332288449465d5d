/* The answer as text: names, values and expressions put into the source, which is otherwise kept as it is. */
#include "complete.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "automaton/figure.h"
#include "automaton/radius.h"
#include "numeric/tolerance.h"

/* ---- Expressions --------------------------------------------------------------------------------------- */

static const char *column_name(const bcifs_complete *complete, size_t column)
{
    size_t unknowns = complete->automaton->unknowns;
    if (column >= unknowns)
        return complete->automaton->parameters[column - unknowns].syntax->name;
    return complete->name_of[column] ? complete->name_of[column] : "a"; /* any letter, for lengths */
}

static void append_rational(struct text *text, struct rational a)
{
    char digits[RATIONAL_LONGEST];
    text_append_bytes(text, digits, rational_print(digits, a));
}

/* ±factor·name: "a", "-a", "+2*a", "-a/2", "+3/4*a". */
static void append_term(struct text *text, struct rational factor, const char *name, bool first)
{
    if (factor.numerator < 0)
        text_append(text, "-");
    else if (!first)
        text_append(text, "+");
    factor.numerator = factor.numerator < 0 ? -factor.numerator : factor.numerator;
    if (!name) {
        append_rational(text, factor);
        return;
    }
    int64_t denominator = factor.denominator;
    if (factor.numerator == 1)
        factor.denominator = 1;
    if (factor.numerator != 1) {
        append_rational(text, factor);
        text_append(text, "*");
    }
    text_append(text, name);
    if (factor.numerator == 1 && denominator != 1) {
        text_append(text, "/");
        append_rational(text, rational_from_integer(denominator));
    }
}

/* What stands first reads best with a plus: a positive number, or the first positive term, or else the first.
 */
static size_t first_term(const struct linear_row *row, size_t constant, size_t leading, int sign)
{
    size_t first = SIZE_MAX;
    for (size_t i = 0; i < row->count; i++) {
        bool positive = (row->terms[i].factor.numerator > 0) == (sign > 0);
        if (row->terms[i].column == leading)
            continue;
        if (row->terms[i].column == constant && positive)
            return i;
        bool better = positive && first != SIZE_MAX && (row->terms[first].factor.numerator > 0) != (sign > 0);
        if (first == SIZE_MAX || better)
            first = i;
    }
    return first;
}

void complete_expression(const bcifs_complete *complete, const struct linear_row *row, size_t leading,
                         struct text *text)
{
    size_t constant = complete->automaton->unknowns + complete->automaton->parameter_count;
    int sign = leading == SIZE_MAX ? 1 : -1;
    if (!row) {
        text_append(text, column_name(complete, leading));
        return;
    }
    size_t first = first_term(row, constant, leading, sign);
    if (first == SIZE_MAX) {
        text_append(text, "0");
        return;
    }
    for (size_t k = 0; k <= row->count; k++) {
        size_t i = k == 0 ? first : k - 1;
        if (row->terms[i].column == leading || (k > 0 && i == first))
            continue;
        struct rational factor = row->terms[i].factor;
        const char *name =
            row->terms[i].column == constant ? NULL : column_name(complete, row->terms[i].column);
        append_term(text, sign > 0 ? factor : rational_negate(factor), name, k == 0);
    }
}

/* ---- Names --------------------------------------------------------------------------------------------- */

/* Whether the main file has the name for anything: a name with two meanings would be no help to the reader.
 */
static bool name_is_taken(const bcifs_complete *complete, const char *name)
{
    const struct syntax_file *file = complete->automaton->modules[0]->syntax;
    size_t length = strlen(name);
    for (size_t i = 0; i < file->token_count; i++)
        if (file->tokens[i].kind == TOKEN_NAME && file->tokens[i].length == length &&
            memcmp(file->source->text + file->tokens[i].place, name, length) == 0)
            return true;
    return name_is_builtin(name);
}

/* The candidates are a … z without p and q, the points of rules, then a1 … z1, a2 … */
static const char *next_name(const bcifs_complete *complete, struct arena *arena, size_t *candidate)
{
    static const char letters[] = "abcdefghijklmnorstuvwxyz";
    for (;;) {
        size_t count = sizeof letters - 1, round = *candidate / count;
        char name[32];
        int length = snprintf(name, sizeof name, "%c", letters[*candidate % count]);
        if (round > 0)
            length = snprintf(name, sizeof name, "%c%zu", letters[*candidate % count], round);
        ++*candidate;
        if (!name_is_taken(complete, name))
            return arena_text(arena, name, (size_t)length);
    }
}

static bcifs_status name_give(bcifs_complete *complete, size_t unknown, size_t *count, size_t *candidate,
                              struct report *report)
{
    if (complete->name_of[unknown])
        return BCIFS_OK;
    const char *name = next_name(complete, &complete->arena, candidate);
    complete->name_of[unknown] = name;
    complete->names[(*count)++] = name;
    return name ? BCIFS_OK : report_memory(report);
}

/* In the order in which a reader of the file meets them. */
static bcifs_status names_give(bcifs_complete *complete, const size_t *order, struct report *report)
{
    const struct linear_system *system = &complete->system;
    size_t count = 0, candidate = 0;
    bcifs_status status = BCIFS_OK;
    complete->names = arena_new(&complete->arena, complete->freedom, sizeof *complete->names);
    if (!complete->names)
        return report_memory(report);
    for (size_t i = 0; i < system->unknowns && status == BCIFS_OK; i++) {
        ptrdiff_t row = system->row_of[order[i]];
        if (row == ELIMINATION_FREE)
            status = name_give(complete, order[i], &count, &candidate, report);
        for (size_t k = 0; row != ELIMINATION_FREE && k < system->rows[row].count && status == BCIFS_OK;
             k++) {
            size_t column = system->rows[row].terms[k].column;
            if (column < system->unknowns && column != order[i])
                status = name_give(complete, column, &count, &candidate, report);
        }
    }
    return status;
}

/* ---- The edited source --------------------------------------------------------------------------------- */

/* Bytes from … to of the source, and what replaces them. */
struct edit {
    size_t from, to;
    const char *text;
};

struct edits {
    struct edit *list;
    size_t count;
};

static int compare_edits(const void *a, const void *b)
{
    const struct edit *x = a, *y = b;
    return (x->from > y->from) - (x->from < y->from);
}

static bcifs_status edit_add(bcifs_complete *complete, struct edits *edits, size_t from, size_t to,
                             const struct text *text, struct report *report)
{
    const char *copy = text->failed ? NULL : arena_text(&complete->arena, text->data, text->length);
    edits->list[edits->count++] = (struct edit){from, to, copy};
    return copy ? BCIFS_OK : report_memory(report);
}

static bcifs_status edit_unknown(bcifs_complete *complete, struct edits *edits, size_t unknown,
                                 struct report *report)
{
    struct text text = {0};
    ptrdiff_t row = complete->system.row_of[unknown];
    size_t place = complete->equations.unknowns[unknown].expression->place;
    complete_expression(complete, row == ELIMINATION_FREE ? NULL : &complete->system.rows[row], unknown,
                        &text);
    bcifs_status status = edit_add(complete, edits, place, place + 1, &text, report);
    text_free(&text);
    return status;
}

/* A param that the answer holds for one value of becomes a let: `param w = 1/2 in 0..1` is then `let w =
 * 3/8`. */
static bcifs_status edit_pinned(bcifs_complete *complete, struct edits *edits,
                                const struct parameter *parameter, struct report *report)
{
    const struct syntax_file *file = parameter->module->syntax;
    const struct token *first = &file->tokens[parameter->syntax->first],
                       *last = &file->tokens[parameter->syntax->last];
    struct rational value;
    struct text text = {0};
    text_format(&text, "let %s = ", parameter->syntax->name);
    if (parameter->value.exact &&
        rational_reconstruct(parameter->value.residue, parameter->value.real, &value))
        append_rational(&text, value);
    else
        text_append_number(&text, parameter->value.real);
    bcifs_status status =
        edit_add(complete, edits, first->place, (size_t)last->place + last->length, &text, report);
    text_free(&text);
    return status;
}

/* Where the params go: behind the header, or behind a comment on its line. */
static size_t header_end(const struct syntax_file *file)
{
    const struct token *last = &file->tokens[file->header_last];
    const char *text = file->source->text;
    size_t end = (size_t)last->place + last->length, blank = end;
    while (text[blank] == ' ' || text[blank] == '\t')
        blank++;
    if (text[blank] != '#')
        return end;
    while (text[blank] != '\0' && text[blank] != '\n' && text[blank] != '\r')
        blank++;
    return blank;
}

static bcifs_status edits_make(bcifs_complete *complete, const size_t *order, struct edits *edits,
                               struct report *report)
{
    const bcifs_automaton *automaton = complete->automaton;
    edits->list =
        arena_new(&complete->arena, automaton->unknowns + automaton->parameter_count, sizeof *edits->list);
    bcifs_status status = edits->list ? BCIFS_OK : report_memory(report);
    for (size_t i = 0; i < automaton->unknowns && status == BCIFS_OK; i++)
        status = edit_unknown(complete, edits, order[i], report);
    for (size_t i = 0; i < automaton->parameter_count && status == BCIFS_OK; i++)
        if (complete->equations.pinned[i] && automaton->parameters[i].module == automaton->modules[0])
            status = edit_pinned(complete, edits, &automaton->parameters[i], report);
    if (edits->count > 0)
        qsort(edits->list, edits->count, sizeof *edits->list, compare_edits);
    return status;
}

static void append_params(const bcifs_complete *complete, const struct rational *values, struct text *text)
{
    if (complete->freedom == 0)
        return;
    text_append(text, "\n\n# Degrees of freedom: the equations hold for all values.\n");
    for (size_t i = 0; i < complete->freedom; i++) {
        text_format(text, "param %s = ", complete->names[i]);
        append_rational(text, values[i]);
        text_append(text, "\n");
    }
}

/* The source with the edits and, behind the header, the params. */
static void source_edit(const bcifs_complete *complete, const struct edits *edits,
                        const struct rational *values, struct text *text)
{
    const struct syntax_file *file = complete->automaton->modules[0]->syntax;
    const struct source *source = file->source;
    size_t at = header_end(file);
    text_append_bytes(text, source->text, at);
    append_params(complete, values, text);
    for (size_t i = 0; i < edits->count; i++) {
        const struct edit *edit = &edits->list[i];
        text_append_bytes(text, source->text + at, edit->from - at);
        text_append(text, edit->text);
        at = edit->to;
    }
    text_append_bytes(text, source->text + at, source->length - at);
}

/* The same in canonical layout. */
static bcifs_status answer_print(const bcifs_complete *complete, const struct edits *edits,
                                 const struct rational *values, struct text *answer, struct report *report)
{
    struct arena arena = {0};
    struct text edited = {0};
    struct source *source;
    struct syntax_file *file;
    source_edit(complete, edits, values, &edited);
    bcifs_status status = edited.failed ? report_memory(report) : BCIFS_OK;
    if (status == BCIFS_OK)
        status = source_from_text(&arena, complete->automaton->modules[0]->source->name, edited.data,
                                  edited.length, report, &source);
    if (status == BCIFS_OK)
        status = syntax_parse(&arena, source, report, &file);
    if (status == BCIFS_OK) {
        syntax_print(file, answer);
        status = answer->failed ? report_memory(report) : BCIFS_OK;
    }
    text_free(&edited);
    arena_free(&arena);
    return status;
}

/* ---- Values -------------------------------------------------------------------------------------------- */

/* What is tried, in this order: ratios that designers use. */
static const struct rational simple[] = {{1, 4},  {1, 2}, {1, 8}, {3, 8}, {1, 3},
                                         {1, 16}, {0, 1}, {3, 4}, {1, 1}, {-1, 8}};
enum { SIMPLE = sizeof simple / sizeof *simple, MOST_LOADS = 96 };
static const double MOST_WORK = 4e6; /* cubes of control points in all tries */

/* The search for values that make the answer contractive. */
struct search {
    bcifs_complete *complete;
    const struct edits *edits;
    struct report *report;
    size_t loads; /* left */
};

/* What one try costs, roughly. */
static double cubes(const struct states *states)
{
    double sum = 1;
    for (size_t i = 0; i < states->count; i++)
        sum += pow((double)states->states[i].points, 3);
    return sum;
}

/* An upper bound of the joint spectral radius of the answer with these values, infinite when there is none.
 */
static bcifs_status radius_of(struct search *search, const struct rational *values, double *radius)
{
    struct text answer = {0};
    struct arena arena = {0};
    struct states states;
    struct radius bound;
    bcifs_automaton *automaton = NULL;
    *radius = INFINITY;
    bcifs_status status = answer_print(search->complete, search->edits, values, &answer, search->report);
    if (status == BCIFS_OK)
        status = bcifs_load_text(search->complete->automaton->modules[0]->source->name, answer.data,
                                 answer.length, NULL, &automaton, NULL);
    if (status == BCIFS_OK)
        status = states_of_figures(automaton, &states, &arena);
    if (status == BCIFS_OK)
        status = radius_bound(&states, &arena, &bound);
    if (status == BCIFS_OK)
        *radius = bound.upper;
    if (status == BCIFS_OK && (double)search->loads * cubes(&states) > MOST_WORK)
        search->loads = (size_t)(MOST_WORK / cubes(&states));
    search->loads -= search->loads > 0;
    text_free(&answer);
    arena_free(&arena);
    bcifs_automaton_free(automaton);
    return status == BCIFS_INPUT && search->report->errors == 0 ? BCIFS_OK : status;
}

/* First all values alike; when no such choice is contractive, one after the other by whichever helps most. */
static bcifs_status values_choose(struct search *search, struct rational *values)
{
    size_t count = search->complete->freedom;
    double best = INFINITY, radius;
    struct rational *tried = arena_new(&search->complete->arena, count, sizeof *tried);
    bcifs_status status = tried ? BCIFS_OK : report_memory(search->report);
    for (size_t i = 0; i < count; i++)
        values[i] = simple[0];
    for (size_t k = 0; k < SIMPLE && count > 0 && status == BCIFS_OK && search->loads > 0 && best >= 1; k++) {
        for (size_t i = 0; i < count; i++)
            tried[i] = simple[k];
        status = radius_of(search, tried, &radius);
        if (radius < best)
            memcpy(values, tried, count * sizeof *values);
        best = fmin(best, radius);
    }
    for (size_t i = 0; i < count && status == BCIFS_OK; i++)
        for (size_t k = 0; k < SIMPLE && status == BCIFS_OK && search->loads > 0 && best >= 1; k++) {
            memcpy(tried, values, count * sizeof *values);
            tried[i] = simple[k];
            status = radius_of(search, tried, &radius);
            if (radius < best)
                memcpy(values, tried, count * sizeof *values);
            best = fmin(best, radius);
        }
    return status;
}

/* ---- The whole ----------------------------------------------------------------------------------------- */

struct placed {
    size_t place, unknown;
};

static int compare_placed(const void *a, const void *b)
{
    const struct placed *x = a, *y = b;
    return (x->place > y->place) - (x->place < y->place);
}

/* The unknowns in the order of the file. */
static bcifs_status reading_order(bcifs_complete *complete, size_t **order, struct report *report)
{
    size_t count = complete->automaton->unknowns;
    struct placed *placed = arena_new(&complete->arena, count, sizeof *placed);
    *order = arena_new(&complete->arena, count, sizeof **order);
    if (!placed || !*order)
        return report_memory(report);
    for (size_t i = 0; i < count; i++)
        placed[i] = (struct placed){complete->equations.unknowns[i].expression->place, i};
    if (count > 0)
        qsort(placed, count, sizeof *placed, compare_placed);
    for (size_t i = 0; i < count; i++)
        (*order)[i] = placed[i].unknown;
    return BCIFS_OK;
}

/* The answer is held to what it promises: read again, its equations are proved. */
static bcifs_status answer_check(bcifs_complete *complete, struct report *report)
{
    bcifs_automaton *automaton;
    bcifs_error error;
    const char *name = complete->automaton->modules[0]->source->name;
    if (complete->automaton->unknowns == 0)
        return BCIFS_OK; /* that was the question */
    bcifs_status status =
        bcifs_load_text(name, complete->text, strlen(complete->text), NULL, &automaton, &error);
    if (status)
        return report_failure(report, status, name, "the completed automaton is not valid: %s",
                              error.message);
    status = complete_check(complete, automaton, NULL, report);
    bcifs_automaton_free(automaton);
    return status;
}

bcifs_status complete_write(bcifs_complete *complete, struct report *report)
{
    size_t *order = NULL;
    struct edits edits = {0};
    struct text answer = {0};
    struct rational *values = arena_new(&complete->arena, complete->freedom, sizeof *values);
    struct search search = {complete, &edits, report, MOST_LOADS};
    bcifs_status status = values ? reading_order(complete, &order, report) : report_memory(report);
    if (status == BCIFS_OK)
        status = names_give(complete, order, report);
    if (status == BCIFS_OK)
        status = edits_make(complete, order, &edits, report);
    if (status == BCIFS_OK)
        status = values_choose(&search, values);
    if (status == BCIFS_OK)
        status = answer_print(complete, &edits, values, &answer, report);
    if (status == BCIFS_OK) {
        complete->text = arena_text(&complete->arena, answer.data, answer.length);
        status = complete->text ? answer_check(complete, report) : report_memory(report);
    }
    text_free(&answer);
    return status;
}
