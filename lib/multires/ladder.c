#include "ladder.h"

#include <string.h>

#include "automaton/levels.h"

enum {
    MOST_PAIRS = 1 << 14,     /* of states that are compared on the way to one answer */
    MOST_CANDIDATES = 64,     /* argument lists tried for one parent */
    MOST_ARGUMENTS_SEEN = 16  /* of a group of siblings, laid over each other */
};

static bcifs_status out_of_memory(const struct states *states)
{
    return states->setting.report ? report_memory(states->setting.report) : BCIFS_MEMORY;
}

/* ---- States that do the same --------------------------------------------------------------------------- */

/* Pairs taken to be equivalent: if no contradiction is found among all that they imply, they are (the largest
 * bisimulation). */
struct pairing {
    size_t (*pairs)[2];
    size_t count, capacity;
};

static bool matrices_equal(const struct value_matrix *a, const struct value_matrix *b)
{
    if (a->rows != b->rows || a->columns != b->columns)
        return false;
    for (size_t i = 0; i < a->rows * a->columns; i++)
        if (!value_equal(a->values[i], b->values[i]))
            return false;
    return true;
}

/* Whether the maps agree; their children are then to be compared. */
static bool cells_agree(const struct cell *a, const struct cell *b)
{
    bool agree = a->points == b->points && a->child_count == b->child_count &&
                 a->boundary_count == b->boundary_count;
    for (size_t i = 0; agree && i < a->child_count; i++)
        agree = matrices_equal(a->children[i].map, b->children[i].map);
    for (size_t i = 0; agree && i < a->boundary_count; i++)
        agree = matrices_equal(a->boundaries[i].operator, b->boundaries[i].operator);
    return agree;
}

static bcifs_status pairing_add(struct pairing *pairing, struct states *states, size_t a, size_t b)
{
    for (size_t i = 0; i < pairing->count; i++)
        if (pairing->pairs[i][0] == a && pairing->pairs[i][1] == b)
            return BCIFS_OK;
    if (!ARENA_RESERVE(states->arena, pairing->pairs, pairing->count, pairing->capacity))
        return out_of_memory(states);
    pairing->pairs[pairing->count][0] = a;
    pairing->pairs[pairing->count++][1] = b;
    return BCIFS_OK;
}

bcifs_status states_equivalent(struct states *states, size_t a, size_t b, bool *equivalent)
{
    struct pairing pairing = {0};
    *equivalent = true;
    bcifs_status status = a == b ? BCIFS_OK : pairing_add(&pairing, states, a, b);
    for (size_t i = 0; i < pairing.count && *equivalent && status == BCIFS_OK; i++) {
        size_t one = pairing.pairs[i][0], other = pairing.pairs[i][1];
        status = states_expand(states, one);
        if (status == BCIFS_OK)
            status = states_expand(states, other);
        if (status)
            return status;
        const struct state *x = &states->states[one], *y = &states->states[other];
        *equivalent = i < MOST_PAIRS && cells_agree(x->cell, y->cell);
        for (size_t k = 0; *equivalent && k < x->cell->child_count && status == BCIFS_OK; k++)
            if (x->children[k] != y->children[k])
                status = pairing_add(&pairing, states, x->children[k], y->children[k]);
    }
    return status;
}

/* ---- Polygons ------------------------------------------------------------------------------------------ */

static const struct cell *cell_of(const struct ladder *ladder, size_t state)
{
    return ladder->states.states[state].cell;
}

/* Δ of a cell in its chain: the control points before those that the next cell begins with. */
static size_t cell_step(const struct ladder *ladder, size_t state)
{
    const struct cell *cell = cell_of(ladder, state);
    return cell->points - cell->boundaries[1].operator->columns;
}

/* Expands the cells, sees that each advances, and counts the points of the polygon. */
static bcifs_status rung_measure(struct ladder *ladder, bool closed, struct rung *rung)
{
    struct report *report = ladder->states.setting.report;
    size_t known = SIZE_MAX;
    rung->points = 0;
    for (size_t i = 0; i < rung->count; i++) {
        size_t state = rung->cells[i];
        bcifs_status status = state == known ? BCIFS_OK : states_expand(&ladder->states, state);
        if (status)
            return status;
        const struct cell *cell = cell_of(ladder, state);
        if (state != known && (!levels_is_stepped(cell) || cell_step(ladder, state) == 0))
            return report_failure(report, BCIFS_INPUT, NULL,
                                  "the control points of '%s' do not form one polygon: its start must be at its first "
                                  "control points and its end at its last",
                                  cell->definition->name);
        known = state;
        rung->points += cell_step(ladder, state);
    }
    if (!closed)
        rung->points += cell_of(ladder, rung->cells[rung->count - 1])->boundaries[1].operator->columns;
    if (rung->points > LADDER_MOST_POINTS)
        return report_failure(report, BCIFS_INPUT, NULL, "the finest level has more than %d control points",
                              LADDER_MOST_POINTS);
    return BCIFS_OK;
}

/* Every cell by its children. */
static bcifs_status rung_refine(struct ladder *ladder, bool closed, const struct rung *coarse, struct rung *fine)
{
    size_t count = 0;
    for (size_t i = 0; i < coarse->count; i++)
        count += cell_of(ladder, coarse->cells[i])->child_count;
    if (count > LADDER_MOST_POINTS)
        return report_failure(ladder->states.setting.report, BCIFS_INPUT, NULL,
                              "the finest level has more than %d cells", LADDER_MOST_POINTS);
    size_t *cells = arena_new(ladder->arena, count, sizeof *cells);
    if (!cells)
        return out_of_memory(&ladder->states);
    *fine = (struct rung){.cells = cells};
    for (size_t i = 0; i < coarse->count; i++) {
        const struct state *state = &ladder->states.states[coarse->cells[i]];
        for (size_t k = 0; k < state->cell->child_count; k++)
            cells[fine->count++] = state->children[k];
    }
    return rung_measure(ladder, closed, fine);
}

/* ---- Parents ------------------------------------------------------------------------------------------- */

/* Whether the cells are the children of `parent`. */
static bcifs_status children_match(struct ladder *ladder, size_t parent, const size_t *cells, size_t count,
                                   bool *match)
{
    *match = false;
    bcifs_status status = states_expand(&ladder->states, parent);
    if (status || cell_of(ladder, parent)->child_count > count)
        return status;
    *match = true;
    for (size_t k = 0; *match && k < cell_of(ladder, parent)->child_count && status == BCIFS_OK; k++) {
        size_t child = ladder->states.states[parent].children[k];
        if (child != cells[k])
            status = states_equivalent(&ladder->states, child, cells[k], match);
    }
    return status;
}

/* The arguments of siblings laid over each other, as intervals are: all of the first, the last of each other. */
static size_t arguments_lay(const struct ladder *ladder, const size_t *cells, size_t count,
                            struct value seen[MOST_ARGUMENTS_SEEN])
{
    size_t filled = 0;
    for (size_t k = 0; k < count; k++) {
        const struct state_key *key = &ladder->states.states[cells[k]].key;
        size_t arity = key->definition->argument_count;
        for (size_t j = k == 0 || arity == 0 ? 0 : arity - 1; j < arity && filled < MOST_ARGUMENTS_SEEN; j++)
            seen[filled++] = key->arguments[j];
    }
    return filled;
}

/* The next choice of `arity` out of `count` places in rising order; false after the last. */
static bool choice_next(size_t *choice, size_t arity, size_t count)
{
    for (size_t i = arity; i-- > 0;)
        if (choice[i] + 1 < count - (arity - 1 - i)) {
            choice[i]++;
            for (size_t j = i + 1; j < arity; j++)
                choice[j] = choice[j - 1] + 1;
            return true;
        }
    return false;
}

/* A parent in the cells' own definition, its arguments chosen from theirs: the intervals of a coarse spline are among
 * those of the fine one. */
static bcifs_status parent_with_arguments(struct ladder *ladder, const size_t *cells, size_t count, size_t *parent,
                                          bool *found)
{
    const struct definition *definition = ladder->states.states[cells[0]].key.definition;
    size_t arity = definition->argument_count, choice[SYNTAX_MOST_ARGUMENTS];
    struct value seen[MOST_ARGUMENTS_SEEN];
    size_t siblings = cell_of(ladder, cells[0])->child_count, laid;
    bcifs_status status = BCIFS_OK;
    *found = false;
    laid = arguments_lay(ladder, cells, siblings < count ? siblings : count, seen);
    if (arity == 0 || arity > laid || arity > SYNTAX_MOST_ARGUMENTS)
        return BCIFS_OK;
    for (size_t j = 0; j < arity; j++)
        choice[j] = j;
    for (int tried = 0; tried < MOST_CANDIDATES && !*found && status == BCIFS_OK; tried++) {
        struct value *arguments = arena_new(ladder->arena, arity, sizeof *arguments);
        if (!arguments)
            return out_of_memory(&ladder->states);
        for (size_t j = 0; j < arity; j++)
            arguments[j] = seen[choice[j]];
        status = states_intern(&ladder->states, (struct state_key){definition, arguments}, parent);
        if (status == BCIFS_OK)
            status = children_match(ladder, *parent, cells, count, found);
        if (!choice_next(choice, arity, laid))
            break;
    }
    return status;
}

/* A state whose children the first of `count` cells are. */
static bcifs_status parent_find(struct ladder *ladder, const size_t *cells, size_t count, size_t last_parent,
                                size_t *parent, bool *found)
{
    bcifs_status status = BCIFS_OK;
    const size_t likely[] = {last_parent, cells[0]};
    *found = false;
    for (size_t i = 0; i < 2 && !*found && status == BCIFS_OK; i++)
        if (likely[i] != SIZE_MAX)
            status = children_match(ladder, *parent = likely[i], cells, count, found);
    if (status == BCIFS_OK && !*found)
        status = parent_with_arguments(ladder, cells, count, parent, found);
    size_t known = ladder->states.count;
    for (size_t s = 0; s < known && !*found && status == BCIFS_OK; s++) {
        const struct definition *definition = ladder->states.states[s].key.definition;
        if (definition->kind == CELL_EDGE && definition->argument_count == 0)
            status = children_match(ladder, *parent = s, cells, count, found);
    }
    return status;
}

/* Whether neighbors of the coarse rung meet: the joints between them do the same. */
static bcifs_status rung_meets(struct ladder *ladder, bool closed, const struct rung *rung, bool *meets)
{
    bcifs_status status = BCIFS_OK;
    *meets = true;
    for (size_t i = 0; i + !closed < rung->count && *meets && status == BCIFS_OK; i++) {
        const struct state *a = &ladder->states.states[rung->cells[i]],
                           *b = &ladder->states.states[rung->cells[(i + 1) % rung->count]];
        status = states_equivalent(&ladder->states, a->boundaries[1], b->boundaries[0], meets);
    }
    return status;
}

/* The cells that those of `fine` are the children of. `stuck` is the place where no parent is found. */
static bcifs_status rung_coarsen(struct ladder *ladder, bool closed, const struct rung *fine, struct rung *coarse,
                                 size_t *stuck)
{
    size_t *cells = arena_new(ladder->arena, fine->count, sizeof *cells), last = SIZE_MAX, place = 0;
    if (!cells)
        return out_of_memory(&ladder->states);
    *coarse = (struct rung){.cells = cells};
    *stuck = SIZE_MAX;
    while (place < fine->count) {
        bool found;
        bcifs_status status = parent_find(ladder, fine->cells + place, fine->count - place, last, &last, &found);
        if (status)
            return status;
        if (!found) {
            *stuck = place;
            return BCIFS_OK;
        }
        cells[coarse->count++] = last;
        place += cell_of(ladder, last)->child_count;
    }
    bool meets;
    bcifs_status status = rung_meets(ladder, closed, coarse, &meets);
    *stuck = meets ? SIZE_MAX : 0;
    return status ? status : meets ? rung_measure(ladder, closed, coarse) : BCIFS_OK;
}

/* ---- Refusals ------------------------------------------------------------------------------------------ */

static size_t power_bounded(size_t base, unsigned exponent)
{
    size_t power = 1;
    for (unsigned k = 0; k < exponent && power <= LADDER_MOST_POINTS; k++)
        power *= base;
    return power;
}

/* "this figure can be coarsened 1 time; 3 times need a multiple of 8 pieces, such as 8: 10 control points". */
static bcifs_status coarsen_refuse(struct ladder *ladder, const struct ladder_chain *chain, const struct rung *own,
                                   unsigned done, unsigned wanted, size_t stuck)
{
    size_t state = own->cells[0], n = cell_of(ladder, state)->child_count,
           multiple = power_bounded(n, wanted), near = (own->count + multiple - 1) / multiple * multiple,
           step = cell_step(ladder, state), joint = cell_of(ladder, state)->points - step;
    const char *times = done == 1 ? "time" : "times", *name = ladder->figure->name;
    struct report *report = ladder->states.setting.report;
    if (multiple > LADDER_MOST_POINTS || (own->count % multiple == 0 && stuck != SIZE_MAX))
        return report_failure(report, BCIFS_INPUT, NULL,
                              "the figure '%s' of %zu piece%s can be coarsened %u %s only: the cells of that level are "
                              "not the children of others; refine the figure first to have more levels",
                              name, own->count, own->count == 1 ? "" : "s", done, times);
    return report_failure(report, BCIFS_INPUT, NULL,
                          "the figure '%s' of %zu piece%s can be coarsened %u %s only; %u need a multiple of %zu pieces, "
                          "such as %zu: %zu control points (or refine the figure first)",
                          name, own->count, own->count == 1 ? "" : "s", done, times, wanted, multiple, near,
                          near * step + (chain->closed ? 0 : joint));
}

static bcifs_status figure_check(const bcifs_figure *figure, struct report *report)
{
    if (figure->shape != FIGURE_CURVE)
        return report_failure(report, BCIFS_INPUT, NULL, "the figure '%s' is not a curve: only curves are edited",
                              figure->name);
    if (figure->displaced)
        return report_failure(report, BCIFS_INPUT, NULL,
                              "the figure '%s' has displace lines: only figures without them are edited", figure->name);
    return BCIFS_OK;
}

/* ---- Rungs --------------------------------------------------------------------------------------------- */

static bcifs_status chain_climb(struct ladder *ladder, size_t index, unsigned above)
{
    struct ladder_chain *chain = &ladder->chains[index];
    const struct chain *source = &ladder->figure->chains[index];
    chain->closed = source->closed;
    chain->rungs = arena_new(ladder->arena, ladder->levels + 1, sizeof *chain->rungs);
    size_t *cells = arena_new(ladder->arena, source->count, sizeof *cells), stuck = SIZE_MAX;
    if (!chain->rungs || !cells)
        return out_of_memory(&ladder->states);
    for (size_t i = 0; i < source->count; i++)
        cells[i] = ladder->figure->pieces[source->first + i].state;
    struct rung own = {.cells = cells, .count = source->count}, rung;
    bcifs_status status = rung_measure(ladder, chain->closed, &own);
    rung = own;
    for (unsigned k = 0; k < above && status == BCIFS_OK; k++) {
        chain->rungs[above - k] = rung;
        struct rung fine = rung;
        status = rung_coarsen(ladder, chain->closed, &fine, &rung, &stuck);
        if (status == BCIFS_OK && stuck != SIZE_MAX)
            return coarsen_refuse(ladder, chain, &own, k, above, stuck);
    }
    chain->rungs[0] = rung;
    for (unsigned k = above; k < ladder->levels && status == BCIFS_OK; k++)
        status = rung_refine(ladder, chain->closed, &chain->rungs[k], &chain->rungs[k + 1]);
    return status;
}

/* Every point of the own polygons is one of the figure's. One that stands in several places is several of theirs. */
static bcifs_status places_find(struct ladder *ladder)
{
    const bcifs_figure *figure = ladder->figure;
    size_t *places = arena_new(ladder->arena, ladder_points(ladder, ladder->own), sizeof *places), base = 0;
    if (!places)
        return out_of_memory(&ladder->states);
    for (size_t c = 0; c < ladder->chain_count; c++) {
        const struct rung *rung = &ladder->chains[c].rungs[ladder->own];
        for (size_t i = 0, first = 0; i < rung->count; i++) {
            const struct piece *piece = &figure->pieces[figure->chains[c].first + i];
            size_t m = cell_of(ladder, rung->cells[i])->points;
            for (size_t j = 0; j < m; j++)
                places[base + (first + j) % rung->points] = piece->indices[j];
            first += cell_step(ladder, rung->cells[i]);
        }
        base += rung->points;
    }
    ladder->places = places;
    return BCIFS_OK;
}

bcifs_status ladder_create(struct ladder *ladder, const bcifs_figure *figure, unsigned refine, unsigned coarsen,
                           struct arena *arena, struct report *report)
{
    unsigned above = coarsen > refine ? coarsen - refine : 0;
    *ladder = (struct ladder){.arena = arena,
                              .figure = figure,
                              .levels = refine + above,
                              .own = above,
                              .chain_count = figure->chain_count};
    bcifs_status status = figure_check(figure, report);
    if (status == BCIFS_OK && (refine > LADDER_MOST_LEVELS || coarsen > LADDER_MOST_LEVELS))
        status = report_failure(report, BCIFS_INPUT, NULL, "a curve has at most %d levels", LADDER_MOST_LEVELS);
    if (status == BCIFS_OK)
        status = states_copy(&ladder->states, &figure->states, arena, report);
    if (status)
        return status;
    ladder->chains = arena_new(arena, ladder->chain_count, sizeof *ladder->chains);
    if (!ladder->chains)
        return report_memory(report);
    for (size_t c = 0; c < ladder->chain_count && status == BCIFS_OK; c++)
        status = chain_climb(ladder, c, above);
    return status ? status : places_find(ladder);
}

size_t ladder_points(const struct ladder *ladder, unsigned rung)
{
    size_t points = 0;
    for (size_t c = 0; c < ladder->chain_count; c++)
        points += ladder->chains[c].rungs[rung].points;
    return points;
}

/* ---- Refinement ---------------------------------------------------------------------------------------- */

/* The new points of one cell, those that the next cell does not bring: columns of its maps, [IM] proposition 4.1. */
static void cell_refine(const struct ladder *ladder, size_t index, size_t first, bool last, double *weights,
                        struct stencil *refinement)
{
    const struct state *state = &ladder->states.states[index];
    size_t m = state->points;
    stencil_block_begin(refinement, first);
    for (size_t i = 0; i < state->cell->child_count; i++) {
        size_t child = state->children[i], points = ladder->states.states[child].points,
               step = cell_step(ladder, child);
        bool tail = last && i + 1 == state->cell->child_count;
        for (size_t j = 0; j < (tail ? points : step); j++) {
            size_t low = 0, high = m;
            for (size_t r = 0; r < m; r++)
                weights[r] = state->maps[i][r * points + j];
            while (low + 1 < high && weights[low] == 0)
                low++;
            while (high > low + 1 && weights[high - 1] == 0)
                high--;
            stencil_row_add(refinement, (ptrdiff_t)(first + low), weights + low, high - low);
        }
    }
    stencil_block_end(refinement);
}

bcifs_status ladder_refinement(const struct ladder *ladder, size_t chain, unsigned rung, struct stencil *refinement)
{
    const struct rung *coarse = &ladder->chains[chain].rungs[rung];
    bool closed = ladder->chains[chain].closed;
    size_t widest = 0, first = 0;
    for (size_t i = 0; i < coarse->count; i++)
        if (ladder->states.states[coarse->cells[i]].points > widest)
            widest = ladder->states.states[coarse->cells[i]].points;
    double *weights = arena_new(ladder->arena, widest, sizeof *weights);
    if (!weights)
        return out_of_memory(&ladder->states);
    stencil_begin(refinement, coarse->points, ladder->arena);
    for (size_t i = 0; i < coarse->count; i++) {
        cell_refine(ladder, coarse->cells[i], first, !closed && i + 1 == coarse->count, weights, refinement);
        first += cell_step(ladder, coarse->cells[i]);
    }
    return refinement->failed ? out_of_memory(&ladder->states) : BCIFS_OK;
}

bcifs_status ladder_figure_points(const struct ladder *ladder, const double *origin, double *points)
{
    const bcifs_figure *figure = ladder->figure;
    struct arena scratch = {0};
    size_t d = figure->dimension, count = ladder_points(ladder, ladder->own);
    double *coarse = arena_new(&scratch, count * d, sizeof *coarse);
    bcifs_status status = coarse ? BCIFS_OK : BCIFS_MEMORY;
    for (size_t i = 0; coarse && i < count * d; i++)
        coarse[i] = figure->points[ladder->places[i / d] * d + i % d] - (origin ? origin[i % d] : 0);
    struct ladder work = *ladder; /* its refinement matrices are made in the scratch arena */
    work.arena = &scratch;
    for (unsigned rung = ladder->own; rung < ladder->levels && status == BCIFS_OK; rung++) {
        double *fine = arena_new(&scratch, ladder_points(ladder, rung + 1) * d, sizeof *fine), *next = fine;
        for (size_t c = 0; fine && c < ladder->chain_count && status == BCIFS_OK; c++) {
            struct stencil refinement;
            status = ladder_refinement(&work, c, rung, &refinement);
            if (status == BCIFS_OK)
                stencil_apply(&refinement, coarse, d, false, next);
            coarse += ladder->chains[c].rungs[rung].points * d;
            next += ladder->chains[c].rungs[rung + 1].points * d;
        }
        status = fine ? status : BCIFS_MEMORY;
        coarse = fine;
    }
    if (status == BCIFS_OK)
        memcpy(points, coarse, ladder_points(ladder, ladder->levels) * d * sizeof *points);
    arena_free(&scratch);
    return status;
}

/* ---- Figures ------------------------------------------------------------------------------------------- */

static bcifs_status chain_place(const struct ladder *ladder, size_t index, unsigned rung, size_t base,
                                bcifs_figure *figure)
{
    const struct rung *cells = &ladder->chains[index].rungs[rung];
    figure->chains[index] = (struct chain){figure->piece_count, cells->count, ladder->chains[index].closed};
    for (size_t i = 0, first = 0; i < cells->count; i++) {
        size_t m = ladder->states.states[cells->cells[i]].points;
        size_t *indices = arena_new(&figure->arena, m, sizeof *indices);
        if (!indices)
            return BCIFS_MEMORY;
        for (size_t j = 0; j < m; j++)
            indices[j] = base + (first + j) % cells->points;
        figure->pieces[figure->piece_count++] = (struct piece){cells->cells[i], indices};
        first += cell_step(ladder, cells->cells[i]);
    }
    return BCIFS_OK;
}

static bcifs_status figure_fill(const struct ladder *ladder, unsigned rung, const double *points,
                                bcifs_figure *figure)
{
    size_t pieces = 0, count = ladder_points(ladder, rung), base = 0, numbers = count * ladder->figure->dimension;
    for (size_t c = 0; c < ladder->chain_count; c++)
        pieces += ladder->chains[c].rungs[rung].count;
    figure->automaton = ladder->figure->automaton;
    figure->name = ladder->figure->name;
    figure->shape = FIGURE_CURVE;
    figure->dimension = ladder->figure->dimension;
    figure->points = arena_grow(&figure->arena, points, numbers, numbers, sizeof *points);
    figure->point_count = count;
    figure->pieces = arena_new(&figure->arena, pieces, sizeof *figure->pieces);
    figure->chains = arena_new(&figure->arena, ladder->chain_count, sizeof *figure->chains);
    figure->chain_count = ladder->chain_count;
    if (!figure->points || !figure->pieces || !figure->chains)
        return BCIFS_MEMORY;
    bcifs_status status = states_copy(&figure->states, &ladder->states, &figure->arena, NULL);
    for (size_t c = 0; c < ladder->chain_count && status == BCIFS_OK; c++) {
        status = chain_place(ladder, c, rung, base, figure);
        base += ladder->chains[c].rungs[rung].points;
    }
    return status;
}

bcifs_status ladder_figure(const struct ladder *ladder, unsigned rung, const double *points, bcifs_figure **figure,
                           struct report *report)
{
    bcifs_figure *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? figure_fill(ladder, rung, points, fresh) : BCIFS_MEMORY;
    if (status) {
        bcifs_figure_free(fresh);
        return report_memory(report);
    }
    *figure = fresh;
    return BCIFS_OK;
}
