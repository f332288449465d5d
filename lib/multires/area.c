#include "multires/area.h"

#include <math.h>

#include "numeric/rational.h"

/* An area being computed. */
struct measure {
    struct bcifs_area *area;
    const bcifs_figure *figure;
    struct report *report;
    struct arena own;
    const struct form *forms; /* by state */
    struct value half;
};

static bcifs_status refuse(const struct measure *measure, bcifs_status status, const char *reason)
{
    const bcifs_figure *figure = measure->figure;
    const char *file = figure->automaton->modules[0]->source->name;
    if (figure->name[0])
        return report_failure(measure->report, status, file, "figure '%s' has no area: %s", figure->name,
                              reason);
    return report_failure(measure->report, status, file, "there is no area: %s", reason);
}

static bcifs_status figure_judge(const struct measure *measure)
{
    const bcifs_figure *figure = measure->figure;
    if (figure->shape != FIGURE_CURVE)
        return refuse(measure, BCIFS_INPUT, "it is not a curve");
    if (figure->displaced)
        return refuse(measure, BCIFS_INPUT,
                      "it has displaced points, whose curve is no combination of its own points");
    if (figure->dimension != 2 && !figure->unplaced)
        return refuse(measure, BCIFS_INPUT, "its points do not have two coordinates");
    return BCIFS_OK;
}

/* ---- Forms --------------------------------------------------------------------------------------------- */

/* The states of the pieces, each once; `mark` holds a flag for every state. */
static size_t states_distinct(const bcifs_figure *figure, bool *mark, size_t *list)
{
    size_t count = 0;
    for (size_t i = 0; i < figure->piece_count; i++) {
        size_t state = figure->pieces[i].state;
        if (!mark[state])
            list[count++] = state;
        mark[state] = true;
    }
    return count;
}

/* Whether every entry is a fraction of the size that can be told. */
static bool all_are_fractions(const struct value *values, size_t count)
{
    struct rational fraction;
    for (size_t i = 0; i < count; i++)
        if (!values[i].exact || !values[i].fixed ||
            !rational_reconstruct(values[i].residue, values[i].real, &fraction))
            return false;
    return true;
}

static bcifs_status form_tell(struct measure *measure, size_t state, bcifs_form *told,
                              const struct value **entries)
{
    const struct form *form = &measure->forms[state];
    const struct state *entry = &measure->area->states.states[state];
    struct text name = {0};
    if (!form->values)
        return refuse(measure, BCIFS_NO, form->reason);
    state_name(&entry->key, &name);
    *told =
        (bcifs_form){.state = name.failed ? NULL : arena_text(&measure->area->arena, name.data, name.length),
                     .size = entry->points,
                     .matrix = form->numbers,
                     .exact = all_are_fractions(form->values, entry->points * entry->points)};
    *entries = form->values;
    text_free(&name);
    return told->state ? BCIFS_OK : BCIFS_MEMORY;
}

static bcifs_status forms_tell(struct measure *measure)
{
    struct bcifs_area *area = measure->area;
    const bcifs_figure *figure = measure->figure;
    bcifs_status status = states_copy(&area->states, &figure->states, &area->arena, measure->report);
    if (status)
        return status;
    bool *mark = arena_new(&measure->own, area->states.count, sizeof *mark);
    size_t *list = arena_new(&measure->own, figure->piece_count, sizeof *list);
    if (!mark || !list)
        return BCIFS_MEMORY;
    size_t count = states_distinct(figure, mark, list);
    status = forms_area(&area->states, list, count, &area->arena, &measure->forms);
    if (status)
        return status;
    const struct value **entries = arena_new(&area->arena, count, sizeof *entries);
    area->told = arena_new(&area->arena, count, sizeof *area->told);
    if (!entries || !area->told)
        return BCIFS_MEMORY;
    area->entries = entries;
    for (; area->count < count && status == BCIFS_OK; area->count++)
        status = form_tell(measure, list[area->count], &area->told[area->count], &entries[area->count]);
    return status;
}

/* ---- The sum ------------------------------------------------------------------------------------------- */

/* Coordinate `axis` of a control point of the figure, seen from its first one. */
static struct value coordinate(const bcifs_figure *figure, size_t point, unsigned axis)
{
    size_t index = point * figure->dimension + axis;
    if (figure->exact_points)
        return value_subtract(figure->exact_points[index], figure->exact_points[axis]);
    return value_from_real(figure->points[index] - figure->points[axis]);
}

/* a × b, for points of two coordinates. */
static struct value cross(const struct value *a, const struct value *b)
{
    return value_subtract(value_multiply(a[0], b[1]), value_multiply(a[1], b[0]));
}

/* ½ X m Y^T = ½ Σ_j<k m_jk (P_j × P_k). */
static bcifs_status piece_add(struct measure *measure, const struct piece *piece)
{
    size_t points = measure->area->states.states[piece->state].points;
    const struct value *form = measure->forms[piece->state].values;
    struct value(*p)[2] = arena_new(&measure->own, points, sizeof *p);
    struct value sum = value_from_integer(0);
    if (!p)
        return BCIFS_MEMORY;
    for (size_t j = 0; j < points; j++)
        for (unsigned axis = 0; axis < 2; axis++)
            p[j][axis] = coordinate(measure->figure, piece->indices[j], axis);
    for (size_t j = 0; j < points; j++)
        for (size_t k = j + 1; k < points; k++)
            sum = value_add(sum, value_multiply(form[j * points + k], cross(p[j], p[k])));
    measure->area->value = value_add(measure->area->value, value_multiply(measure->half, sum));
    return BCIFS_OK;
}

/* The point P·H at an end of a piece. */
static bcifs_status end_point(struct measure *measure, const struct piece *piece, bool at_end,
                              struct value *point)
{
    struct form_ends ends;
    bcifs_status status = form_ends_find(&measure->area->states, piece->state, &measure->own, &ends);
    size_t points = measure->area->states.states[piece->state].points;
    for (unsigned axis = 0; axis < 2; axis++)
        point[axis] = value_from_integer(0);
    for (size_t j = 0; j < points && status == BCIFS_OK; j++)
        for (unsigned axis = 0; axis < 2; axis++) {
            struct value weight = at_end ? ends.end[j] : ends.start[j];
            point[axis] = value_add(
                point[axis], value_multiply(weight, coordinate(measure->figure, piece->indices[j], axis)));
        }
    return status;
}

static bcifs_status chain_add(struct measure *measure, const struct chain *chain)
{
    const struct piece *first = &measure->figure->pieces[chain->first], *last = first + chain->count - 1;
    struct value start[2], end[2];
    bcifs_status status = BCIFS_OK;
    for (const struct piece *piece = first; piece <= last && status == BCIFS_OK; piece++)
        status = piece_add(measure, piece);
    if (status || chain->closed)
        return status;
    status = end_point(measure, first, false, start);
    if (status == BCIFS_OK)
        status = end_point(measure, last, true, end);
    if (status)
        return status;
    measure->area->value = value_add(measure->area->value, value_multiply(measure->half, cross(end, start)));
    return BCIFS_OK;
}

/* The fraction, where the area is one of the size that can be told. */
static bcifs_status fraction_tell(struct measure *measure)
{
    struct bcifs_area *area = measure->area;
    struct text text = {0};
    value_pin(&area->value, 0);
    if (!isfinite(area->value.real))
        return refuse(measure, BCIFS_INPUT, "its points are too far apart for numbers of 64 bits");
    if (!all_are_fractions(&area->value, 1))
        return BCIFS_OK;
    value_write(&text, area->value);
    area->fraction = text.failed ? NULL : arena_text(&area->arena, text.data, text.length);
    text_free(&text);
    return area->fraction ? BCIFS_OK : BCIFS_MEMORY;
}

/* ---- The handle ---------------------------------------------------------------------------------------- */

static bcifs_status area_measure(struct measure *measure)
{
    const bcifs_figure *figure = measure->figure;
    struct bcifs_area *area = measure->area;
    area->automaton = figure->automaton;
    area->figure = figure->name;
    area->placed = !figure->unplaced;
    area->value = value_from_integer(0);
    measure->half = value_divide(value_from_integer(1), value_from_integer(2));
    bcifs_status status = figure_judge(measure);
    if (status == BCIFS_OK)
        status = forms_tell(measure);
    for (size_t c = 0; c < figure->chain_count && status == BCIFS_OK && area->placed; c++)
        status = chain_add(measure, &figure->chains[c]);
    return status || !area->placed ? status : fraction_tell(measure);
}

bcifs_status bcifs_area_create(const bcifs_figure *figure, bcifs_area **area, bcifs_error *error)
{
    struct report report = report_new(NULL);
    bcifs_area *fresh = memory_new(1, sizeof *fresh);
    struct measure measure = {.area = fresh, .figure = figure, .report = &report};
    bcifs_status status = fresh ? area_measure(&measure) : BCIFS_MEMORY;
    arena_free(&measure.own);
    if (status == BCIFS_MEMORY && report.errors == 0)
        report_memory(&report);
    if (status) {
        bcifs_area_free(fresh);
        report_close(&report, error);
        return status;
    }
    fresh->states.setting.report = NULL;
    *area = fresh;
    return BCIFS_OK;
}

void bcifs_area_free(bcifs_area *area)
{
    if (!area)
        return;
    arena_free(&area->arena);
    memory_free(area);
}

double bcifs_area_value(const bcifs_area *area)
{
    return area->value.real;
}

int bcifs_area_exact(const bcifs_area *area)
{
    return area->fraction != NULL;
}

const char *bcifs_area_fraction(const bcifs_area *area)
{
    return area->fraction;
}

const bcifs_form *bcifs_area_form(const bcifs_area *area, size_t index)
{
    return index < area->count ? &area->told[index] : NULL;
}
