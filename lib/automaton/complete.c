#include "complete.h"

#include <string.h>

static bcifs_status out_of_memory(struct report *report)
{
    return report_memory(report);
}

/* ---- Conflicts ----------------------------------------------------------------------------------------- */

static void conflict_add(bcifs_complete *complete, const struct entry_equation *equation)
{
    bcifs_conflict *conflict = &complete->conflicts[complete->conflict_count++];
    unsigned column;
    *conflict = (bcifs_conflict){.state = equation->state,
                                 .kind = equation->kind,
                                 .equation = equation->text,
                                 .row = equation->row,
                                 .column = equation->column,
                                 .reason = equation->reason,
                                 .file = equation->source->name};
    source_locate(equation->source, equation->place, &conflict->line, &column);
}

static bcifs_status conflicts_reserve(bcifs_complete *complete, size_t count, struct report *report)
{
    complete->consistent = false;
    complete->conflict_count = 0;
    complete->contradiction = "";
    complete->conflicts = arena_new(&complete->arena, count, sizeof *complete->conflicts);
    return complete->conflicts ? BCIFS_OK : out_of_memory(report);
}

/* An equation that fails whatever the unknowns are, for a reason in words. */
static bcifs_status conflict_in_words(bcifs_complete *complete, struct report *report)
{
    const struct equations *equations = &complete->equations;
    for (size_t i = 0; i < equations->count && complete->consistent; i++)
        if (equations->equations[i].reason) {
            bcifs_status status = conflicts_reserve(complete, 1, report);
            if (status)
                return status;
            conflict_add(complete, &equations->equations[i]);
        }
    return BCIFS_OK;
}

static bcifs_status refuse_numbers(const bcifs_complete *complete, size_t index,
                                   enum elimination_outcome outcome, struct report *report)
{
    const struct entry_equation *equation = &complete->equations.equations[index];
    if (outcome == ELIMINATION_MEMORY)
        return out_of_memory(report);
    if (outcome == ELIMINATION_TOO_LARGE)
        return report_failure(report, BCIFS_INPUT, equation->source->name,
                              "the equations become too large to solve: more than %d terms",
                              ELIMINATION_MOST_TERMS);
    return report_error(report, equation->source, equation->place,
                        "solving '%s': %s, entry (%zu, %zu), needs fractions that do not fit in 64 bits",
                        equation->state, equation->text, equation->row, equation->column);
}

/* "0 = 1/4": the givens that are left of the conflicting equations. */
static bcifs_status contradiction_write(bcifs_complete *complete, const struct linear_row *row, size_t count,
                                        struct report *report)
{
    struct linear_row givens = {row->terms, count};
    struct text text = {0};
    text_append(&text, "0 = ");
    complete_expression(complete, &givens, SIZE_MAX, &text);
    complete->contradiction = text.failed ? NULL : arena_text(&complete->arena, text.data, text.length);
    text_free(&text);
    return complete->contradiction ? BCIFS_OK : out_of_memory(report);
}

/* The row that is left names the equations it came from, by the columns behind all givens. Those before the
 * last one are independent, so their combination is the only one: none of them can be left out. */
static bcifs_status conflict_read(bcifs_complete *complete, const struct linear_row *row,
                                  struct report *report)
{
    size_t first = complete->automaton->unknowns + complete->automaton->parameter_count + 1, givens = 0;
    while (givens < row->count && row->terms[givens].column < first)
        givens++;
    bcifs_status status = conflicts_reserve(complete, row->count - givens, report);
    for (size_t i = givens; i < row->count && status == BCIFS_OK; i++)
        conflict_add(complete, &complete->equations.equations[row->terms[i].column - first]);
    return status ? status : contradiction_write(complete, row, givens, report);
}

/* Solves equations 0 … last again, every one marked by a column of its own, to see which ones contradict it.
 */
static bcifs_status conflict_find(bcifs_complete *complete, size_t last, struct report *report)
{
    size_t columns = complete->automaton->unknowns + complete->automaton->parameter_count + 1;
    struct linear_system system;
    enum elimination_outcome outcome = ELIMINATION_ADDED;
    bcifs_status status = BCIFS_OK;
    if (!linear_system_create(&system, complete->automaton->unknowns))
        return out_of_memory(report);
    for (size_t i = 0; i <= last && outcome <= ELIMINATION_CONFLICT && status == BCIFS_OK; i++) {
        const struct entry_equation *equation = &complete->equations.equations[i];
        struct linear_term *terms = memory_new(equation->count + 1, sizeof *terms);
        if (!terms) {
            status = out_of_memory(report);
            break;
        }
        if (equation->count > 0)
            memcpy(terms, equation->terms, equation->count * sizeof *terms);
        terms[equation->count] = (struct linear_term){columns + i, {1, 1}};
        outcome = linear_system_add(&system, terms, equation->count + 1);
        memory_free(terms);
        if (outcome > ELIMINATION_CONFLICT)
            status = refuse_numbers(complete, i, outcome, report);
    }
    if (status == BCIFS_OK)
        status = conflict_read(complete, &system.conflict, report);
    linear_system_free(&system);
    return status;
}

/* ---- Solving ------------------------------------------------------------------------------------------- */

static bcifs_status solve(bcifs_complete *complete, struct report *report)
{
    struct linear_system *system = &complete->system;
    const struct equations *equations = &complete->equations;
    if (!linear_system_create(system, complete->automaton->unknowns))
        return out_of_memory(report);
    for (size_t i = 0; i < equations->count; i++) {
        enum elimination_outcome outcome =
            linear_system_add(system, equations->equations[i].terms, equations->equations[i].count);
        if (outcome == ELIMINATION_CONFLICT)
            return conflict_find(complete, i, report);
        if (outcome > ELIMINATION_CONFLICT)
            return refuse_numbers(complete, i, outcome, report);
    }
    complete->rank = system->count;
    complete->freedom = complete->automaton->unknowns - system->count;
    return BCIFS_OK;
}

bcifs_status complete_check(bcifs_complete *complete, const bcifs_automaton *automaton,
                            const bcifs_load_options *options, struct report *report)
{
    bcifs_check *check;
    bcifs_error error;
    bcifs_status status = bcifs_check_create(automaton, options, &check, &error);
    if (status)
        return report_failure(report, status, error.file, "%s", error.message);
    size_t count = bcifs_check_equation_count(check);
    if (!bcifs_check_valid(check))
        status = conflicts_reserve(complete, count, report);
    for (size_t i = 0; i < count && !complete->consistent && status == BCIFS_OK; i++) {
        const bcifs_equation *equation = bcifs_check_equation(check, i);
        if (equation->holds)
            continue;
        bcifs_conflict *conflict = &complete->conflicts[complete->conflict_count++];
        *conflict = (bcifs_conflict){.kind = equation->kind, .line = equation->line};
        conflict->row = (size_t)equation->row;
        conflict->column = (size_t)equation->column;
        conflict->reason = "its entries are all known, and it does not hold";
        conflict->state = arena_text(&complete->arena, equation->state, strlen(equation->state));
        conflict->equation = arena_text(&complete->arena, equation->text, strlen(equation->text));
        conflict->file = arena_text(&complete->arena, equation->file, strlen(equation->file));
        if (!conflict->state || !conflict->equation || !conflict->file)
            status = out_of_memory(report);
    }
    bcifs_check_free(check);
    return status;
}

static bcifs_status complete_all(bcifs_complete *complete, const bcifs_load_options *options,
                                 struct report *report)
{
    complete->consistent = true;
    complete->contradiction = "";
    complete->name_of = arena_new(&complete->arena, complete->automaton->unknowns, sizeof *complete->name_of);
    if (!complete->name_of)
        return out_of_memory(report);
    bcifs_status status = equations_pose(complete->automaton, &complete->arena, report, &complete->equations);
    if (status == BCIFS_OK && complete->automaton->unknowns == 0)
        status = complete_check(complete, complete->automaton, options, report);
    if (status == BCIFS_OK && complete->consistent)
        status = conflict_in_words(complete, report);
    if (status == BCIFS_OK && complete->consistent)
        status = solve(complete, report);
    if (status == BCIFS_OK && complete->consistent)
        status = complete_choose(complete, report);
    if (status == BCIFS_OK && complete->consistent)
        status = complete_write(complete, report);
    if (!complete->consistent)
        complete->freedom = 0;
    return status;
}

/* ---- Public -------------------------------------------------------------------------------------------- */

bcifs_status bcifs_complete_create(const bcifs_automaton *automaton, const bcifs_load_options *options,
                                   bcifs_complete **complete, bcifs_error *error)
{
    struct report report = report_new(options);
    bcifs_complete *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? BCIFS_OK : report_memory(&report);
    if (status == BCIFS_OK) {
        fresh->automaton = automaton;
        status = complete_all(fresh, options, &report);
    }
    if (status) {
        bcifs_complete_free(fresh);
        report_close(&report, error);
        return status;
    }
    *complete = fresh;
    return BCIFS_OK;
}

void bcifs_complete_free(bcifs_complete *complete)
{
    if (!complete)
        return;
    linear_system_free(&complete->system);
    arena_free(&complete->arena);
    memory_free(complete);
}

size_t bcifs_complete_unknowns(const bcifs_complete *complete)
{
    return complete->automaton->unknowns;
}

size_t bcifs_complete_equations(const bcifs_complete *complete)
{
    return complete->equations.posed;
}

int bcifs_complete_consistent(const bcifs_complete *complete)
{
    return complete->consistent;
}

size_t bcifs_complete_degrees_of_freedom(const bcifs_complete *complete)
{
    return complete->freedom;
}

const char *bcifs_complete_parameter(const bcifs_complete *complete, size_t index)
{
    return complete->consistent && index < complete->freedom ? complete->names[index] : NULL;
}

const char *bcifs_complete_automaton(const bcifs_complete *complete)
{
    return complete->consistent ? complete->text : NULL;
}

const bcifs_conflict *bcifs_complete_conflict(const bcifs_complete *complete, size_t index)
{
    return index < complete->conflict_count ? &complete->conflicts[index] : NULL;
}

const char *bcifs_complete_contradiction(const bcifs_complete *complete)
{
    return complete->contradiction;
}
