#include "multires/form.h"

#include "automaton/reach.h"
#include "base/decimal.h"
#include "multires/moments.h"
#include "multires/similar.h"

/* Forms being found: arrays by place in the reach. */
struct search {
    struct states *states;
    struct reach reach;
    struct arena *arena;        /* of the results */
    struct arena own;           /* of what is needed to the end of the search */
    const struct value **forms; /* NULL: there is none */
    const char **reasons;       /* why not */
    struct frame *frames;
    /* Area: the chords' forms. Energy: what the parameter is read off with, and derivatives at the ends. */
    const struct value **chords;
    struct moments moments;
    const struct value **starts, **ends;
};

static const struct state *state_at(const struct search *search, size_t place)
{
    return &search->states->states[search->reach.list[place]];
}

/* ---- Reasons ------------------------------------------------------------------------------------------- */

static void append_short(struct text *text, double number)
{
    char digits[DECIMAL_LONGEST];
    text_append_bytes(text, digits, decimal_print_digits(digits, number, 6));
}

/* Gives the whole component a reason, a copy of `text`, which is freed. */
static bcifs_status reason_take(struct search *search, size_t c, struct text *text)
{
    const char *reason = text->failed ? NULL : arena_text(search->arena, text->data, text->length);
    text_free(text);
    for (size_t k = search->reach.first[c]; k < search->reach.first[c + 1]; k++)
        search->reasons[search->reach.members[k]] = reason;
    return reason ? BCIFS_OK : BCIFS_MEMORY;
}

static bcifs_status reason_give(struct search *search, size_t c, const char *words)
{
    struct text text = {0};
    text_append(&text, words);
    return reason_take(search, c, &text);
}

static void append_name(const struct search *search, size_t c, struct text *text)
{
    text_append(text, "'");
    state_name(&state_at(search, search->reach.members[search->reach.first[c]])->key, text);
    text_append(text, "'");
}

static bcifs_status size_refuse(struct search *search, size_t c, size_t unknowns)
{
    struct text text = {0};
    text_append(&text, "the form of ");
    append_name(search, c, &text);
    text_format(&text, " and the states that it comes back to has %lu entries; the limit is %d",
                (unsigned long)unknowns, SIMILAR_MOST_UNKNOWNS);
    return reason_take(search, c, &text);
}

/* In words: which sum does not converge, and the radius that says so. */
struct divergence {
    const char *certain, *undecided, *operator;
};

/* The spectral radius must be below 1 for certain; otherwise the component gets the reason. */
static bcifs_status radius_judge(struct search *search, const struct similar *similar,
                                 const struct divergence *words, bool *converges)
{
    double lower, upper;
    struct arena own = {0};
    struct text text = {0};
    bcifs_status status = similar_radius(similar, &own, &lower, &upper);
    arena_free(&own);
    *converges = status == BCIFS_OK && upper < 1;
    if (status || *converges)
        return status;
    text_format(&text, "%s: the spectral radius of %s, for ", lower >= 1 ? words->certain : words->undecided,
                words->operator);
    append_name(search, similar->component, &text);
    text_append(&text, lower >= 1 ? ", is " : ", is at least ");
    append_short(&text, lower);
    if (lower >= 1) {
        text_append(&text, ", not below 1");
    } else if (upper < 1e300) {
        text_append(&text, " and at most ");
        append_short(&text, upper);
    }
    return reason_take(search, similar->component, &text);
}

/* A part without a form leaves the whole without one. False then. */
static bool parts_have_forms(struct search *search, size_t c)
{
    const struct reach *reach = &search->reach;
    const char *reason = NULL;
    for (size_t k = reach->first[c]; k < reach->first[c + 1] && !reason; k++) {
        const struct state *state = state_at(search, reach->members[k]);
        if (state->key.definition->kind != CELL_EDGE)
            reason = "it is not an edge";
        for (size_t i = 0; i < state->cell->child_count && !reason; i++)
            reason = search->reasons[reach->place[state->children[i]]];
    }
    for (size_t k = reach->first[c]; k < reach->first[c + 1]; k++)
        search->reasons[reach->members[k]] = reason;
    return !reason;
}

/* ---- Area ---------------------------------------------------------------------------------------------- */

/* H(0) H(1)^T - H(1) H(0)^T: the form of the arc's chord, and m·1 = -(H(1) - H(0)) holds for it already. */
static bcifs_status chord_find(struct search *search, size_t x)
{
    size_t points = state_at(search, x)->points;
    struct form_ends ends;
    bcifs_status status = form_ends_find(search->states, search->reach.list[x], &search->own, &ends);
    struct value *chord = arena_new(&search->own, points * points, sizeof *chord);
    if (status || !chord)
        return status ? status : BCIFS_MEMORY;
    for (size_t i = 0; i < points; i++)
        for (size_t j = 0; j < points; j++)
            chord[i * points + j] = value_subtract(value_multiply(ends.start[i], ends.end[j]),
                                                   value_multiply(ends.end[i], ends.start[j]));
    search->chords[x] = chord;
    return BCIFS_OK;
}

/* m = chord + c, c = Σ T_i c T_i^T + the areas between the chord and the children's chords, c·1 = 0. */
static bcifs_status area_find(struct search *search, size_t c)
{
    const struct reach *reach = &search->reach;
    const struct similar similar = {search->states, reach, c, search->frames, -1, 0};
    const struct similar_data data = {search->forms, search->chords, NULL};
    static const struct divergence words = {"the areas of its parts do not converge",
                                            "it is not decided whether the areas of its parts converge",
                                            "Σ T ∧ T on differences of points"};
    bool go_on;
    for (size_t k = reach->first[c]; k < reach->first[c + 1]; k++) {
        size_t x = reach->members[k];
        bcifs_status status = chord_find(search, x);
        if (status == BCIFS_OK)
            status = frame_begin(&search->frames[x], state_at(search, x)->points, &search->own);
        if (status == BCIFS_OK)
            status = frame_cut(&search->frames[x], search->moments.unit[x], &search->own);
        if (status)
            return status;
    }
    size_t unknowns = similar_unknowns(&similar);
    if (unknowns > SIMILAR_MOST_UNKNOWNS)
        return size_refuse(search, c, unknowns);
    bcifs_status status = radius_judge(search, &similar, &words, &go_on);
    if (status || !go_on)
        return status;
    status = similar_solve(&similar, &data, search->arena, search->forms, &go_on);
    return status || go_on ? status
                           : reason_give(search, c, "the equations of its area have no single solution");
}

/* ---- Energy -------------------------------------------------------------------------------------------- */

/* The members' frames: columns on which 1, ℓ and, with `square`, q vanish. */
static bcifs_status energy_frames(struct search *search, size_t c, bool square)
{
    const struct reach *reach = &search->reach;
    const struct moments *moments = &search->moments;
    bcifs_status status = BCIFS_OK;
    for (size_t k = reach->first[c]; k < reach->first[c + 1] && status == BCIFS_OK; k++) {
        size_t x = reach->members[k];
        struct frame *frame = &search->frames[x];
        status = frame_begin(frame, state_at(search, x)->points, &search->own);
        if (status == BCIFS_OK)
            status = frame_cut(frame, moments->unit[x], &search->own);
        if (status == BCIFS_OK)
            status = frame_cut(frame, moments->parameter[x], &search->own);
        if (status == BCIFS_OK && square)
            status = frame_cut(frame, moments->square[x], &search->own);
    }
    return status;
}

/* ℓ and q must exist for all members. */
static bcifs_status reproduction_judge(struct search *search, size_t c, bool *reproduces)
{
    const struct reach *reach = &search->reach;
    size_t points = 0;
    bool parameter = true, square = true;
    for (size_t k = reach->first[c]; k < reach->first[c + 1]; k++) {
        size_t x = reach->members[k];
        points += state_at(search, x)->points;
        parameter = parameter && search->moments.parameter[x];
        square = square && search->moments.square[x];
    }
    *reproduces = parameter && square;
    if (*reproduces)
        return BCIFS_OK;
    struct text text = {0};
    if (points > MOMENTS_MOST_UNKNOWNS)
        text_format(&text, "it and the states that it comes back to have %lu control points; the limit is %d",
                    (unsigned long)points, MOMENTS_MOST_UNKNOWNS);
    else
        text_append(&text, parameter
                               ? "it does not reproduce t²: its second derivative, if there is one, is 0 or "
                                 "not square-integrable"
                               : "it does not reproduce the parameter t");
    return reason_take(search, c, &text);
}

/* h = N³ Σ T_i h T_i^T on forms that vanish on 1 and ℓ, q h q^T = 4. On those that vanish on q, too, the
 * operator must contract: then the second derivatives of approximations that take the arc's values and
 * derivatives at all joints of a level (cubic Hermite arcs) converge in L². They have no jumps of the first
 * derivative when it agrees there. */
static bcifs_status energy_find(struct search *search, size_t c)
{
    struct similar similar = {search->states, &search->reach, c, search->frames, 1, 3};
    const struct similar_data data = {search->forms, NULL, search->moments.square};
    static const struct divergence words = {
        "its second derivative is not square-integrable",
        "it is not decided whether its second derivative is square-integrable",
        "N³ Σ T·Tᵀ on what vanishes on 1, t and t²"};
    bool go_on, determined;
    bcifs_status status = reproduction_judge(search, c, &go_on);
    if (status || !go_on)
        return status;
    status = energy_frames(search, c, false);
    size_t unknowns = status ? 0 : similar_unknowns(&similar);
    if (unknowns > SIMILAR_MOST_UNKNOWNS)
        return size_refuse(search, c, unknowns);
    if (status == BCIFS_OK)
        status = energy_frames(search, c, true);
    if (status == BCIFS_OK)
        status = radius_judge(search, &similar, &words, &go_on);
    if (status || !go_on)
        return status;
    status = derivatives_join(search->states, &search->reach, &search->moments, c, &search->own,
                              search->starts, search->ends, &determined, &go_on);
    if (status == BCIFS_OK && !determined)
        return reason_give(search, c, "the equations of its derivatives at the ends have no single solution");
    if (status == BCIFS_OK && !go_on)
        return reason_give(search, c,
                           "its second derivative is not square-integrable: the first one jumps where "
                           "two children meet");
    if (status == BCIFS_OK)
        status = energy_frames(search, c, false);
    if (status == BCIFS_OK)
        status = similar_solve(&similar, &data, search->arena, search->forms, &go_on);
    return status || go_on ? status
                           : reason_give(search, c, "the equations of its energy have no single solution");
}

/* ---- The whole ----------------------------------------------------------------------------------------- */

static bcifs_status search_begin(struct search *search, const size_t *list, size_t count, bool energy)
{
    bcifs_status status = reach_find(search->states, list, count, &search->own, &search->reach);
    if (status)
        return status;
    size_t places = search->reach.count;
    const struct value **rows = arena_new(&search->own, places, 4 * sizeof *rows);
    search->reasons = arena_new(&search->own, places, sizeof *search->reasons);
    search->frames = arena_new(&search->own, places, sizeof *search->frames);
    if (!rows || !search->reasons || !search->frames)
        return BCIFS_MEMORY;
    search->forms = rows;
    search->chords = rows + places;
    search->starts = rows + 2 * places;
    search->ends = rows + 3 * places;
    return moments_find(search->states, &search->reach, energy ? 2 : 0, &search->own, &search->moments);
}

/* The values with their doubles. */
static bcifs_status form_finish(const struct search *search, size_t x, struct form *form)
{
    size_t points = state_at(search, x)->points, count = points * points;
    double *numbers = arena_new(search->arena, count, sizeof *numbers);
    if (!numbers)
        return BCIFS_MEMORY;
    *form = (struct form){.values = search->forms[x], .numbers = numbers, .exact = true};
    for (size_t i = 0; i < count; i++) {
        numbers[i] = form->values[i].real;
        form->exact = form->exact && form->values[i].exact;
    }
    return BCIFS_OK;
}

static bcifs_status forms_finish(const struct search *search, const struct form **forms)
{
    size_t count = search->states->count;
    struct form *table = arena_new(search->arena, count, sizeof *table);
    bcifs_status status = table ? BCIFS_OK : BCIFS_MEMORY;
    for (size_t i = 0; i < count && status == BCIFS_OK; i++)
        table[i].reason = "it is not among the states that were asked for";
    for (size_t x = 0; x < search->reach.count && status == BCIFS_OK; x++) {
        struct form *form = &table[search->reach.list[x]];
        form->reason = search->reasons[x];
        if (search->forms[x])
            status = form_finish(search, x, form);
    }
    *forms = table;
    return status;
}

static bcifs_status forms_find(struct states *states, const size_t *list, size_t count, bool energy,
                               struct arena *arena, const struct form **forms)
{
    struct search search = {.states = states, .arena = arena};
    bcifs_status status = search_begin(&search, list, count, energy);
    for (size_t c = 0; status == BCIFS_OK && c < search.reach.component_count; c++)
        if (parts_have_forms(&search, c))
            status = energy ? energy_find(&search, c) : area_find(&search, c);
    if (status == BCIFS_OK)
        status = forms_finish(&search, forms);
    arena_free(&search.own);
    return status;
}

bcifs_status forms_area(struct states *states, const size_t *list, size_t count, struct arena *arena,
                        const struct form **forms)
{
    return forms_find(states, list, count, false, arena, forms);
}

bcifs_status forms_energy(struct states *states, const size_t *list, size_t count, struct arena *arena,
                          const struct form **forms)
{
    return forms_find(states, list, count, true, arena, forms);
}
