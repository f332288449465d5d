#include "editor.h"

#include <math.h>
#include <string.h>

/* Areas of curves that turn both ways cancel: one below this share of the square that the curve extends over is told
 * relative to that. */
static const double AREA_SHARE = 0.01;

/* Beyond, products with it overflow. */
static const double MOST_ALPHA = 1e300;

/* ---- Stages -------------------------------------------------------------------------------------------- */

static size_t numbers(const bcifs_editor *editor)
{
    return 2 * editor->count;
}

static void stage_copy(bcifs_editor *editor, bcifs_stage from, bcifs_stage to)
{
    memcpy(editor->coefficients[to], editor->coefficients[from], numbers(editor) * sizeof(double));
    memcpy(editor->fine[to], editor->fine[from], numbers(editor) * sizeof(double));
}

static void stage_reconstruct(const bcifs_editor *editor, bcifs_stage stage)
{
    bank_reconstruct(&editor->level->bank, editor->coefficients[stage], 2, editor->fine[stage], editor->workspace);
}

/* All stages become the curve whose fine points fine[BCIFS_RESULT] holds. */
static void stages_settle(bcifs_editor *editor)
{
    bank_decompose(&editor->level->bank, editor->fine[BCIFS_RESULT], 2, editor->coefficients[BCIFS_RESULT],
                   editor->workspace);
    stage_copy(editor, BCIFS_RESULT, BCIFS_INITIAL);
    stage_copy(editor, BCIFS_RESULT, BCIFS_DEFORMED);
    editor->deformed_is_fine = editor->answered = true;
    editor->outcome = (struct deform_outcome){.global = true};
}

static double stage_area(const bcifs_editor *editor, bcifs_stage stage)
{
    return editor->level->area_reason ? NAN : form_area(&editor->level->fine_area, editor->fine[stage]);
}

/* ---- History ------------------------------------------------------------------------------------------- */

/* The present curve becomes the newest entry; what was undone is forgotten, and the oldest when there is no room. */
static bcifs_status history_push(bcifs_editor *editor)
{
    while (editor->history_count > 0 && editor->history_count > editor->history_at + 1)
        memory_free(editor->history[--editor->history_count]);
    double *points = memory_new(numbers(editor), sizeof *points);
    if (!points)
        return BCIFS_MEMORY;
    if (editor->history_count == editor->history_room) {
        memory_free(editor->history[0]);
        memmove(editor->history, editor->history + 1, --editor->history_count * sizeof *editor->history);
    }
    memcpy(points, editor->fine[BCIFS_RESULT], numbers(editor) * sizeof *points);
    editor->history[editor->history_count++] = points;
    editor->history_at = editor->history_count - 1;
    return BCIFS_OK;
}

static void history_restore(bcifs_editor *editor)
{
    memcpy(editor->fine[BCIFS_RESULT], editor->history[editor->history_at], numbers(editor) * sizeof(double));
    stages_settle(editor);
    editor->locked = editor->target = stage_area(editor, BCIFS_RESULT);
}

static void drag_end(bcifs_editor *editor)
{
    deform_free(editor->drag.deform);
    arena_free(&editor->drag.arena);
    editor->drag = (struct drag){.active = false};
}

/* What was dragged and not released, or an answer that did not reach its area, is no edit: the curve is again
 * the one before. */
static void attempt_drop(bcifs_editor *editor)
{
    if (editor->drag.active || !editor->answered) {
        stage_copy(editor, BCIFS_INITIAL, BCIFS_RESULT);
        stage_copy(editor, BCIFS_INITIAL, BCIFS_DEFORMED);
        editor->deformed_is_fine = editor->answered = true;
    }
    drag_end(editor);
}

/* First what is no edit yet, then edits. */
int bcifs_editor_undo(bcifs_editor *editor)
{
    bool attempted = !editor->answered || editor->drag.has_good;
    attempt_drop(editor);
    if (!attempted && editor->history_at == 0)
        return 0;
    if (!attempted)
        editor->history_at--;
    history_restore(editor);
    return 1;
}

int bcifs_editor_redo(bcifs_editor *editor)
{
    attempt_drop(editor);
    if (editor->history_at + 1 >= editor->history_count)
        return 0;
    editor->history_at++;
    history_restore(editor);
    return 1;
}

/* ---- Creation ------------------------------------------------------------------------------------------ */

static bcifs_status arrays_new(bcifs_editor *editor)
{
    bool made = true;
    for (int stage = 0; stage < EDITOR_STAGES; stage++) {
        editor->coefficients[stage] = memory_new(numbers(editor), sizeof(double));
        editor->fine[stage] = memory_new(numbers(editor), sizeof(double));
        made = made && editor->coefficients[stage] && editor->fine[stage];
    }
    editor->workspace = memory_new(BANK_WORKSPACE * numbers(editor), sizeof(double));
    editor->history_room = EDITOR_MOST_KEPT / (numbers(editor) + 1) + 2;
    if (editor->history_room > EDITOR_MOST_HISTORY)
        editor->history_room = EDITOR_MOST_HISTORY;
    editor->history = memory_new(editor->history_room, sizeof *editor->history);
    return made && editor->workspace && editor->history ? BCIFS_OK : BCIFS_MEMORY;
}

/* Takes the figure's points, relative to their mean from the start: subdivision rounds as little as can be
 * then. */
static bcifs_status curve_begin(bcifs_editor *editor)
{
    const bcifs_figure *figure = editor->figure;
    for (size_t i = 0; i < 2 * figure->point_count; i++)
        editor->center[i % 2] += figure->points[i] / (double)figure->point_count;
    bcifs_status status =
        ladder_figure_points(&editor->level->ladder, editor->center, editor->fine[BCIFS_RESULT]);
    if (status)
        return status;
    stages_settle(editor);
    editor->locked = editor->target = stage_area(editor, BCIFS_RESULT);
    return history_push(editor);
}

static bcifs_status editor_make(bcifs_editor *editor, const bcifs_editor_options *options, struct report *report)
{
    editor->refine = options->refine;
    editor->energy = options->energy;
    editor->constraint =
        (bcifs_constraint){.keep_area = 1, .alpha = 100, .free = BCIFS_FREE_SCALE};
    if (editor->figure->dimension != 2)
        return report_failure(report, BCIFS_INPUT, NULL,
                              "areas are of planar curves; the points of the figure '%s' have %u coordinate%s",
                              editor->figure->name, editor->figure->dimension,
                              editor->figure->dimension == 1 ? "" : "s");
    bcifs_status status = editor_level_create(editor->figure, options->refine, options->coarsen, options->energy,
                                              report, &editor->level);
    if (status)
        return status;
    editor->count = editor->level->bank.count;
    status = arrays_new(editor);
    if (status == BCIFS_OK)
        status = curve_begin(editor);
    return status ? report_memory(report) : BCIFS_OK;
}

bcifs_status bcifs_editor_create(const bcifs_figure *figure, const bcifs_editor_options *options,
                                 bcifs_editor **editor, bcifs_error *error)
{
    static const bcifs_editor_options defaults = {0};
    struct report report = report_new(NULL);
    bcifs_editor *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? BCIFS_OK : report_memory(&report);
    if (fresh) {
        fresh->figure = figure;
        status = editor_make(fresh, options ? options : &defaults, &report);
    }
    if (status) {
        bcifs_editor_free(fresh);
        report_close(&report, error);
        return status;
    }
    *editor = fresh;
    return BCIFS_OK;
}

static void constraint_free(bcifs_constraint *constraint)
{
    memory_free((void *)constraint->list);
    memory_free((void *)constraint->pins);
}

void bcifs_editor_free(bcifs_editor *editor)
{
    if (!editor)
        return;
    drag_end(editor);
    for (size_t i = 0; i < editor->history_count; i++)
        memory_free(editor->history[i]);
    memory_free(editor->history);
    for (int stage = 0; stage < EDITOR_STAGES; stage++) {
        memory_free(editor->coefficients[stage]);
        memory_free(editor->fine[stage]);
    }
    memory_free(editor->workspace);
    constraint_free(&editor->constraint);
    editor_level_free(editor->level);
    memory_free(editor);
}

bcifs_status bcifs_editor_coarsen(bcifs_editor *editor, unsigned coarsen, bcifs_error *error)
{
    struct report report = report_new(NULL);
    struct editor_level *level;
    bcifs_status status =
        editor_level_create(editor->figure, editor->refine, coarsen, editor->energy, &report, &level);
    if (status) {
        report_close(&report, error);
        return status;
    }
    attempt_drop(editor);
    editor_level_free(editor->level);
    editor->level = level;
    editor->constraint.list_count = editor->constraint.pin_count = 0;
    stages_settle(editor);
    return BCIFS_OK;
}

unsigned bcifs_editor_level(const bcifs_editor *editor)
{
    return editor->level->bank.top - editor->level->bank.bottom;
}

bcifs_energy bcifs_editor_energy(const bcifs_editor *editor, const char **reason)
{
    if (reason)
        *reason = editor->level->energy_reason;
    return editor->level->energy;
}

/* ---- The constraint ------------------------------------------------------------------------------------ */

static bcifs_status index_check(const bcifs_editor *editor, size_t index, struct report *report)
{
    if (index < editor->level->bank.scale)
        return BCIFS_OK;
    return report_failure(report, BCIFS_INPUT, NULL,
                          "there is no control point %zu at this level; it has %zu, from 0", index,
                          editor->level->bank.scale);
}

static bcifs_status constraint_check(const bcifs_editor *editor, const bcifs_constraint *constraint,
                                     struct report *report)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < constraint->pin_count && status == BCIFS_OK; i++)
        status = index_check(editor, constraint->pins[i], report);
    for (size_t i = 0; i < constraint->list_count && status == BCIFS_OK; i++)
        status = index_check(editor, constraint->list[i], report);
    if (status)
        return status;
    if (!(constraint->alpha >= 0 && constraint->alpha <= MOST_ALPHA))
        return report_failure(report, BCIFS_INPUT, NULL, "alpha must be a number from 0 to 1e300");
    if (constraint->has_target && !isfinite(constraint->target))
        return report_failure(report, BCIFS_INPUT, NULL, "the area wanted must be finite");
    if (constraint->keep_area && editor->level->area_reason)
        return report_failure(report, BCIFS_NO, NULL, "the figure '%s' has no area to keep: %s", editor->figure->name,
                              editor->level->area_reason);
    return BCIFS_OK;
}

static bcifs_status list_copy(const size_t *list, size_t count, const size_t **copy, struct report *report)
{
    size_t *fresh = memory_new(count, sizeof *fresh);
    if (!fresh)
        return report_memory(report);
    if (count > 0)
        memcpy(fresh, list, count * sizeof *fresh);
    *copy = fresh;
    return BCIFS_OK;
}

bcifs_status bcifs_editor_constrain(bcifs_editor *editor, const bcifs_constraint *constraint, bcifs_error *error)
{
    struct report report = report_new(NULL);
    bcifs_constraint fresh = *constraint;
    fresh.list = fresh.pins = NULL;
    bcifs_status status = constraint_check(editor, constraint, &report);
    if (status == BCIFS_OK)
        status = list_copy(constraint->list, constraint->list_count, &fresh.list, &report);
    if (status == BCIFS_OK)
        status = list_copy(constraint->pins, constraint->pin_count, &fresh.pins, &report);
    if (status) {
        constraint_free(&fresh);
        report_close(&report, error);
        return status;
    }
    if (editor->drag.active)
        attempt_drop(editor);
    constraint_free(&editor->constraint);
    editor->constraint = fresh;
    return BCIFS_OK;
}

/* ---- What is free -------------------------------------------------------------------------------------- */

/* Marks of coefficients. */
enum { MARK_FREE = 1, MARK_MOVED = 2 };

/* The `neighbors` control points on each side of `index`, within its chain. */
static void neighbors_mark(const bcifs_editor *editor, size_t index, size_t neighbors, unsigned char *marks)
{
    const struct ladder *ladder = &editor->level->ladder;
    size_t base = 0, chain = 0, place;
    while (index >= base + ladder->chains[chain].rungs[editor->level->bank.bottom].points)
        base += ladder->chains[chain++].rungs[editor->level->bank.bottom].points;
    size_t points = ladder->chains[chain].rungs[editor->level->bank.bottom].points;
    bool closed = ladder->chains[chain].closed;
    place = index - base;
    neighbors = neighbors < points ? neighbors : points;
    for (size_t k = 1; k <= neighbors; k++) {
        if (closed || place + k < points)
            marks[base + (place + k) % points] |= MARK_FREE;
        if (closed || place >= k)
            marks[base + (place + points - k) % points] |= MARK_FREE;
    }
}

/* Which coefficients are free, given those that are marked as moved. */
static void free_mark(const bcifs_editor *editor, unsigned char *marks)
{
    const bcifs_constraint *constraint = &editor->constraint;
    size_t scale = editor->level->bank.scale,
           all = constraint->free == BCIFS_FREE_ALL     ? editor->count
                 : constraint->free == BCIFS_FREE_SCALE ? scale
                                                        : 0;
    for (size_t i = 0; i < all; i++)
        marks[i] |= MARK_FREE;
    for (size_t i = 0; i < constraint->list_count && constraint->free == BCIFS_FREE_LIST; i++)
        marks[constraint->list[i]] |= MARK_FREE;
    for (size_t i = 0; i < scale && constraint->free == BCIFS_FREE_NEAR; i++)
        if (marks[i] & MARK_MOVED)
            neighbors_mark(editor, i, constraint->neighbors, marks);
    for (size_t i = 0; i < scale && constraint->free == BCIFS_FREE_NEAR; i++)
        if (marks[i] & MARK_MOVED)
            marks[i] &= (unsigned char)~MARK_FREE;
    for (size_t i = 0; i < constraint->pin_count; i++)
        marks[constraint->pins[i]] &= (unsigned char)~MARK_FREE;
}

/* The coefficients whose marks meet `mask`, rising. */
static bcifs_status marks_list(const unsigned char *marks, size_t count, unsigned mask, struct arena *arena,
                               const size_t **list, size_t *length)
{
    size_t found = 0, filled = 0;
    for (size_t i = 0; i < count; i++)
        found += (marks[i] & mask) != 0;
    size_t *fresh = arena_new(arena, found, sizeof *fresh);
    if (!fresh)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < count; i++)
        if (marks[i] & mask)
            fresh[filled++] = i;
    *list = fresh;
    *length = found;
    return BCIFS_OK;
}

/* ---- How fine points follow ---------------------------------------------------------------------------- */

/* Columns of the synthesis of one level: the fine points of all chains × the coarse points listed. */
static bcifs_status level_refinement(const struct bank *bank, unsigned rung, struct arena *arena,
                                     struct sparse *refinement)
{
    const struct bank_step *steps = bank->steps[rung - bank->bottom];
    size_t count = 0, filled = 0, row = 0, column = 0;
    struct sparse *parts = arena_new(arena, bank->ladder->chain_count, sizeof *parts);
    if (!parts)
        return BCIFS_MEMORY;
    for (size_t c = 0; c < bank->ladder->chain_count; c++) {
        if (!stencil_sparse(&steps[c].refinement, &parts[c], arena))
            return BCIFS_MEMORY;
        count += parts[c].starts[parts[c].rows];
    }
    if (bank->ladder->chain_count == 1) {
        *refinement = parts[0];
        return BCIFS_OK;
    }
    struct triple *triples = arena_new(arena, count, sizeof *triples);
    if (!triples)
        return BCIFS_MEMORY;
    for (size_t c = 0; c < bank->ladder->chain_count; c++) {
        for (size_t i = 0; i < parts[c].rows; i++)
            for (size_t k = parts[c].starts[i]; k < parts[c].starts[i + 1]; k++)
                triples[filled++] = (struct triple){row + i, column + parts[c].columns[k], parts[c].values[k]};
        row += parts[c].rows;
        column += parts[c].width;
    }
    return sparse_from_triples(refinement, row, column, triples, filled, arena) ? BCIFS_OK : BCIFS_MEMORY;
}

/* The product of all refinements, restricted to the changing control points; and which fine points it reaches. */
static bcifs_status reach_find(bcifs_editor *editor)
{
    const struct bank *bank = &editor->level->bank;
    struct drag *drag = &editor->drag;
    struct arena scratch = {0};
    struct triple *triples = arena_new(&scratch, drag->changing_count, sizeof *triples);
    struct sparse reach;
    bcifs_status status = BCIFS_MEMORY;
    for (size_t k = 0; triples && k < drag->changing_count; k++)
        triples[k] = (struct triple){drag->changing[k], k, 1};
    if (triples && sparse_from_triples(&reach, bank->scale, drag->changing_count, triples, drag->changing_count,
                                       bank->bottom == bank->top ? &drag->arena : &scratch))
        status = BCIFS_OK;
    for (unsigned rung = bank->bottom; rung < bank->top && status == BCIFS_OK; rung++) {
        struct sparse refinement, next = {0};
        status = level_refinement(bank, rung, &scratch, &refinement);
        if (status == BCIFS_OK && !sparse_multiply(&refinement, &reach, &next,
                                                   rung + 1 == bank->top ? &drag->arena : &scratch))
            status = BCIFS_MEMORY;
        reach = next;
    }
    size_t *reached = status ? NULL : arena_new(&drag->arena, editor->count, sizeof *reached);
    if (reached) {
        drag->reach = reach;
        for (size_t i = 0; i < editor->count; i++)
            if (reach.starts[i] < reach.starts[i + 1])
                reached[drag->reached_count++] = i;
        drag->reached = reached;
    }
    arena_free(&scratch);
    return status ? status : reached ? BCIFS_OK : BCIFS_MEMORY;
}

/* Fine points of a stage from those before the edit and what has changed since. */
static void stage_follow(bcifs_editor *editor, bcifs_stage stage)
{
    const struct drag *drag = &editor->drag;
    const double *before = editor->coefficients[BCIFS_INITIAL], *after = editor->coefficients[stage];
    for (size_t r = 0; r < drag->reached_count; r++) {
        size_t i = drag->reached[r];
        double x = editor->fine[BCIFS_INITIAL][2 * i], y = editor->fine[BCIFS_INITIAL][2 * i + 1];
        for (size_t k = drag->reach.starts[i]; k < drag->reach.starts[i + 1]; k++) {
            size_t j = drag->changing[drag->reach.columns[k]];
            x += drag->reach.values[k] * (after[2 * j] - before[2 * j]);
            y += drag->reach.values[k] * (after[2 * j + 1] - before[2 * j + 1]);
        }
        editor->fine[stage][2 * i] = x;
        editor->fine[stage][2 * i + 1] = y;
    }
}

/* ---- Edits --------------------------------------------------------------------------------------------- */

/* The reduced problem, unless the area is not kept. */
static bcifs_status drag_reduce(bcifs_editor *editor, struct report *report)
{
    struct drag *drag = &editor->drag;
    struct editor_level *level = editor->level;
    if (!editor->constraint.keep_area)
        return BCIFS_OK;
    drag->answer = arena_new(&drag->arena, 2 * drag->free_count, sizeof *drag->answer);
    struct deform_problem *problem = arena_new(&drag->arena, 1, sizeof *problem);
    if (!drag->answer || !problem)
        return BCIFS_MEMORY;
    *problem = (struct deform_problem){.count = editor->count,
                                       .energy = level->energy == BCIFS_NO_ENERGY ? NULL : &level->energy_form,
                                       .area = &level->area,
                                       .alpha = editor->constraint.alpha,
                                       .free = drag->free,
                                       .free_count = drag->free_count,
                                       .base = drag->base,
                                       .direction = drag->direction};
    bcifs_status status = deform_create(problem, &drag->deform);
    return status == BCIFS_INPUT
               ? report_failure(
                     report, BCIFS_INPUT, NULL,
                     "rounding leaves the energy of the figure '%s' indefinite over %u levels; take "
                     "another energy, a larger alpha or fewer levels",
                     editor->figure->name, bcifs_editor_level(editor))
               : status;
}

static bcifs_status drag_prepare(bcifs_editor *editor, unsigned char *marks, struct report *report)
{
    struct drag *drag = &editor->drag;
    free_mark(editor, marks);
    bcifs_status status =
        marks_list(marks, editor->count, MARK_FREE, &drag->arena, &drag->free, &drag->free_count);
    if (status == BCIFS_OK)
        status = marks_list(marks, editor->count, MARK_FREE | MARK_MOVED, &drag->arena, &drag->changing,
                            &drag->changing_count);
    drag->whole = editor->constraint.free == BCIFS_FREE_ALL;
    if (status == BCIFS_OK && !drag->whole)
        status = reach_find(editor);
    if (status == BCIFS_OK)
        status = drag_reduce(editor, report);
    return status == BCIFS_MEMORY ? report_memory(report) : status;
}

/* Begins with the last curve that was an answer. */
static void drag_begin(bcifs_editor *editor)
{
    attempt_drop(editor);
    stage_copy(editor, BCIFS_RESULT, BCIFS_INITIAL);
    stage_copy(editor, BCIFS_INITIAL, BCIFS_DEFORMED);
    editor->deformed_is_fine = editor->answered = true;
    editor->target = editor->constraint.has_target ? editor->constraint.target : editor->locked;
}

static bcifs_status area_refuse(const bcifs_editor *editor, struct report *report)
{
    const struct deform_outcome *outcome = &editor->outcome;
    const char *why = outcome->reason == DEFORM_NONE_FREE ? "no control point is free to answer"
                      : outcome->reason == DEFORM_INSENSITIVE
                          ? "it does not depend on the control points that are free to answer"
                          : "the control points that are free do not reach so far";
    struct text target = {0}, nearest = {0};
    text_append_number(&target, editor->target);
    text_append_number(&nearest, outcome->area);
    bcifs_status status =
        target.failed || nearest.failed
            ? report_memory(report)
            : report_failure(report, BCIFS_NO, NULL,
                             "the area cannot be made %s: %s; the nearest area within reach is %s", target.data, why,
                             nearest.data);
    text_free(&target);
    text_free(&nearest);
    return status;
}

/* The answer to c0 = base + direction·displacement. */
static bcifs_status drag_answer(bcifs_editor *editor, const double displacement[2], struct report *report)
{
    struct drag *drag = &editor->drag;
    double *deformed = editor->coefficients[BCIFS_DEFORMED], *result = editor->coefficients[BCIFS_RESULT];
    for (size_t k = 0; k < drag->changing_count; k++)
        for (size_t c = 0; c < 2; c++) {
            size_t i = 2 * drag->changing[k] + c;
            deformed[i] = drag->base[i];
            if (drag->direction)
                deformed[i] += drag->direction[drag->changing[k]] * displacement[c];
            result[i] = deformed[i];
        }
    editor->deformed_is_fine = editor->answered = false;
    editor->outcome = (struct deform_outcome){.global = true};
    if (drag->deform && deform_solve(drag->deform, displacement, editor->target, drag->answer, &editor->outcome))
        return report_memory(report);
    for (size_t k = 0; drag->deform && k < drag->free_count; k++)
        memcpy(result + 2 * drag->free[k], drag->answer + 2 * k, 2 * sizeof *result);
    if (drag->whole)
        stage_reconstruct(editor, BCIFS_RESULT);
    else
        stage_follow(editor, BCIFS_RESULT);
    editor->answered = editor->outcome.reason == DEFORM_REACHED;
    return editor->answered ? BCIFS_OK : area_refuse(editor, report);
}

/* The deformed curve's fine points are wanted when it is read only. */
static void deformed_refresh(const bcifs_editor *editor)
{
    bcifs_editor *writable = (bcifs_editor *)editor; /* a cache: the handle is documented not to be shared */
    if (editor->deformed_is_fine)
        return;
    if (editor->drag.active && !editor->drag.whole)
        stage_follow(writable, BCIFS_DEFORMED);
    else
        stage_reconstruct(writable, BCIFS_DEFORMED);
    writable->deformed_is_fine = true;
}

/* The answer is kept. An edit that let the area go, or gave it a target, sets the area to be kept from now on. */
static bcifs_status edit_commit(bcifs_editor *editor, struct report *report)
{
    deformed_refresh(editor);
    if (history_push(editor))
        return report_memory(report);
    if (!editor->constraint.keep_area)
        editor->locked = stage_area(editor, BCIFS_RESULT);
    else if (editor->constraint.has_target)
        editor->locked = editor->target;
    return BCIFS_OK;
}

/* Leaves nothing grabbed, and says how it went. */
static bcifs_status edit_end(bcifs_editor *editor, const struct report *report, bcifs_error *error)
{
    drag_end(editor);
    return report_close(report, error);
}

bcifs_status bcifs_editor_grab(bcifs_editor *editor, const size_t *indices, size_t count, bcifs_error *error)
{
    struct report report = report_new(NULL);
    drag_begin(editor);
    struct drag *drag = &editor->drag;
    unsigned char *marks = arena_new(&drag->arena, editor->count, sizeof *marks);
    double *direction = arena_new(&drag->arena, editor->count, sizeof *direction);
    bcifs_status status = marks && direction ? BCIFS_OK : report_memory(&report);
    for (size_t i = 0; i < count && status == BCIFS_OK; i++) {
        status = index_check(editor, indices[i], &report);
        if (status == BCIFS_OK) {
            direction[indices[i]] = 1;
            marks[indices[i]] |= MARK_MOVED;
        }
    }
    drag->base = editor->coefficients[BCIFS_INITIAL];
    drag->direction = direction;
    if (status == BCIFS_OK)
        status = drag_prepare(editor, marks, &report);
    if (status)
        return edit_end(editor, &report, error);
    drag->active = true;
    return BCIFS_OK;
}

bcifs_status bcifs_editor_drag(bcifs_editor *editor, double dx, double dy, bcifs_error *error)
{
    struct report report = report_new(NULL);
    struct drag *drag = &editor->drag;
    const double displacement[2] = {dx, dy};
    if (!drag->active)
        report_failure(&report, BCIFS_INPUT, NULL, "no control point is grabbed");
    else if (!isfinite(dx) || !isfinite(dy))
        report_failure(&report, BCIFS_INPUT, NULL, "a displacement must be finite");
    else if (drag_answer(editor, displacement, &report) == BCIFS_OK) {
        memcpy(drag->good, displacement, sizeof drag->good);
        drag->has_good = true;
    }
    return report_close(&report, error);
}

bcifs_status bcifs_editor_release(bcifs_editor *editor, bcifs_error *error)
{
    struct report report = report_new(NULL);
    struct drag *drag = &editor->drag;
    if (!drag->active)
        report_failure(&report, BCIFS_INPUT, NULL, "no control point is grabbed");
    else if (drag->has_good && (editor->answered || drag_answer(editor, drag->good, &report) == BCIFS_OK) &&
             edit_commit(editor, &report) == BCIFS_OK)
        drag_end(editor);
    attempt_drop(editor);
    return report_close(&report, error);
}

static bcifs_status moves_apply(const bcifs_editor *editor, const bcifs_move *moves, size_t count, double *base,
                                unsigned char *marks, struct report *report)
{
    memcpy(base, editor->coefficients[BCIFS_INITIAL], numbers(editor) * sizeof *base);
    for (size_t i = 0; i < count; i++) {
        bcifs_status status = index_check(editor, moves[i].index, report);
        if (status)
            return status;
        if (!isfinite(moves[i].dx) || !isfinite(moves[i].dy))
            return report_failure(report, BCIFS_INPUT, NULL, "a displacement must be finite");
        marks[moves[i].index] |= MARK_MOVED;
        base[2 * moves[i].index] += moves[i].dx;
        base[2 * moves[i].index + 1] += moves[i].dy;
    }
    return BCIFS_OK;
}

bcifs_status bcifs_editor_move(bcifs_editor *editor, const bcifs_move *moves, size_t count, bcifs_error *error)
{
    static const double nowhere[2] = {0, 0};
    struct report report = report_new(NULL);
    drag_begin(editor);
    struct drag *drag = &editor->drag;
    unsigned char *marks = arena_new(&drag->arena, editor->count, sizeof *marks);
    double *base = arena_new(&drag->arena, numbers(editor), sizeof *base);
    drag->base = base;
    bcifs_status status =
        marks && base ? moves_apply(editor, moves, count, base, marks, &report) : report_memory(&report);
    if (status == BCIFS_OK)
        status = drag_prepare(editor, marks, &report);
    if (status)
        return edit_end(editor, &report, error);
    drag->active = true;
    status = drag_answer(editor, nowhere, &report);
    if (status == BCIFS_OK)
        status = edit_commit(editor, &report);
    if (status == BCIFS_NO)
        deformed_refresh(editor);
    else if (status)
        attempt_drop(editor);
    return edit_end(editor, &report, error);
}

/* ---- Reading ------------------------------------------------------------------------------------------- */

size_t bcifs_editor_points(const bcifs_editor *editor)
{
    return editor->count;
}

size_t bcifs_editor_scale_points(const bcifs_editor *editor)
{
    return editor->level->bank.scale;
}

static void points_place(const bcifs_editor *editor, const double *from, size_t count, double *points)
{
    for (size_t i = 0; i < 2 * count; i++)
        points[i] = from[i] + editor->center[i % 2];
}

void bcifs_editor_read(const bcifs_editor *editor, bcifs_stage stage, double *points)
{
    if (stage == BCIFS_DEFORMED)
        deformed_refresh(editor);
    points_place(editor, editor->fine[stage], editor->count, points);
}

void bcifs_editor_read_scale(const bcifs_editor *editor, bcifs_stage stage, double *points)
{
    points_place(editor, editor->coefficients[stage], editor->level->bank.scale, points);
}

bcifs_status bcifs_editor_figure(const bcifs_editor *editor, bcifs_stage stage, int scale, bcifs_figure **figure,
                                 bcifs_error *error)
{
    struct report report = report_new(NULL);
    const struct bank *bank = &editor->level->bank;
    double *points = memory_new(numbers(editor), sizeof *points);
    if (!points) {
        report_memory(&report);
        return report_close(&report, error);
    }
    if (scale)
        bcifs_editor_read_scale(editor, stage, points);
    else
        bcifs_editor_read(editor, stage, points);
    ladder_figure(&editor->level->ladder, scale ? bank->bottom : bank->top, points, figure, &report);
    memory_free(points);
    return report_close(&report, error);
}

/* The square of the largest coordinate of the curve, from its middle. */
static double stage_extent(const bcifs_editor *editor, bcifs_stage stage)
{
    double largest = 0;
    for (size_t i = 0; i < numbers(editor); i++)
        largest = fmax(largest, fabs(editor->fine[stage][i]));
    return largest * largest;
}

void bcifs_editor_report(const bcifs_editor *editor, bcifs_edit_report *report)
{
    deformed_refresh(editor);
    const struct sparse *energy = &editor->level->fine_energy;
    double before = stage_area(editor, BCIFS_INITIAL), deformed = stage_area(editor, BCIFS_DEFORMED),
           after = stage_area(editor, BCIFS_RESULT);
    double size = fmax(fabs(editor->target), AREA_SHARE * fmax(stage_extent(editor, BCIFS_INITIAL), stage_extent(editor, BCIFS_RESULT)));
    *report = (bcifs_edit_report){.before = before,
                                  .deformed = deformed,
                                  .after = after,
                                  .target = editor->constraint.keep_area ? editor->target : after,
                                  .energy_deformed = form_energy(energy, editor->fine[BCIFS_DEFORMED]),
                                  .energy_after = form_energy(energy, editor->fine[BCIFS_RESULT]),
                                  .iterations = editor->outcome.iterations,
                                  .multiplier = editor->outcome.multiplier,
                                  .global = editor->outcome.global};
    report->relative_error = fabs(report->after - report->target) / (size > 0 ? size : 1);
}
