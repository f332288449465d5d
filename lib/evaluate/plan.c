#include "plan.h"

#include <math.h>
#include <string.h>

#include "evaluate/parameter.h"
#include "numeric/matrix.h"

/* ---- States and counts --------------------------------------------------------------------------------- */

/* A breadth-first walk over the states. */
struct reach {
    size_t *least; /* per state: the level where it first appears, SIZE_MAX before */
    size_t *queue;
    size_t capacity, head, tail;
};

static bcifs_status reach_note(struct reach *reach, const struct states *states, struct arena *arena, size_t state,
                               size_t level)
{
    if (states->count > reach->capacity) {
        size_t grown = 2 * states->count;
        reach->least = arena_grow(arena, reach->least, reach->capacity, grown, sizeof *reach->least);
        reach->queue = arena_grow(arena, reach->queue, reach->capacity, grown, sizeof *reach->queue);
        if (!reach->least || !reach->queue)
            return BCIFS_MEMORY;
        for (size_t k = reach->capacity; k < grown; k++)
            reach->least[k] = SIZE_MAX;
        reach->capacity = grown;
    }
    if (reach->least[state] == SIZE_MAX) {
        reach->least[state] = level;
        reach->queue[reach->tail++] = state;
    }
    return BCIFS_OK;
}

/* Expands every state that is reached above `depth` and notes the level where it first appears. */
static bcifs_status states_reach(struct states *states, const bcifs_figure *figure, unsigned depth,
                                 struct arena *arena, size_t **least)
{
    struct reach reach = {0};
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < figure->piece_count && status == BCIFS_OK; i++)
        status = reach_note(&reach, states, arena, figure->pieces[i].state, 0);
    while (reach.head < reach.tail && status == BCIFS_OK) {
        size_t state = reach.queue[reach.head++], level = reach.least[state];
        if (level == depth)
            continue;
        status = states_expand(states, state);
        for (size_t k = 0; status == BCIFS_OK && k < states->states[state].cell->child_count; k++)
            status = reach_note(&reach, states, arena, states->states[state].children[k], level + 1);
    }
    /* The boundaries of the last state may have come after the last note. */
    if (status == BCIFS_OK && reach.tail > 0)
        status = reach_note(&reach, states, arena, reach.queue[0], 0);
    *least = reach.least;
    return status;
}

static uint64_t add_saturated(uint64_t a, uint64_t b)
{
    return a > UINT64_MAX - b ? UINT64_MAX : a + b;
}

/* counts[level][state] for level 0 … depth and the first n states, given what one cell of each contributes. */
static bcifs_status counts_make(const struct states *states, size_t n, const size_t *least,
                                const struct columns *leaves, unsigned depth, struct arena *arena,
                                const uint64_t **counts)
{
    uint64_t *table = arena_new(arena, (depth + 1) * n, sizeof *table);
    if (!table)
        return BCIFS_MEMORY;
    for (size_t s = 0; s < n; s++)
        table[s] = least[s] == SIZE_MAX ? 0 : leaves[s].count;
    for (unsigned level = 1; level <= depth; level++)
        for (size_t s = 0; s < n; s++) {
            const struct state *state = &states->states[s];
            if (least[s] > depth - level || !state->expanded)
                continue;
            uint64_t sum = 0;
            for (size_t k = 0; k < state->cell->child_count; k++)
                sum = add_saturated(sum, table[(level - 1) * n + state->children[k]]);
            table[level * n + s] = sum;
        }
    *counts = table;
    return BCIFS_OK;
}

/* ---- What a cell contributes --------------------------------------------------------------------------- */

static bcifs_status plan_refuse(const struct bcifs_plan *plan, const char *format, const char *name)
{
    struct report *report = plan->states.setting.report;
    return report_failure(report, BCIFS_INPUT, plan->figure->automaton->modules[0]->source->name, format, name);
}

/* The seed in the space of a state: itself for a cell, Π q for an arc. */
static bcifs_status leaf_seed(struct bcifs_plan *plan, size_t index, bool at_end, double *column)
{
    struct states *states = &plan->states;
    bool edge = states->states[index].key.definition->kind == CELL_EDGE;
    size_t wanted = states->states[index].points;
    if (edge) {
        bcifs_status status = states_expand(states, index);
        if (status)
            return status;
        wanted = states->states[states->states[index].boundaries[at_end]].points;
    }
    if (wanted != plan->seed_count)
        return report_failure(states->setting.report, BCIFS_INPUT, NULL,
                              "the seed must have %zu coordinate%s (%s), found %zu", wanted, wanted == 1 ? "" : "s",
                              edge ? "one for each control point of the joint"
                                   : "one for each control point of the cell",
                              plan->seed_count);
    if (edge)
        return states_boundary_point(states, index, at_end, plan->seed, column);
    memcpy(column, plan->seed, wanted * sizeof *column);
    return BCIFS_OK;
}

/* Whether the start is at the first control points of the state and the end at the last, as consecutive arcs
 * need in order that their control polygons join to one. */
static bool is_stepped(const struct state *state)
{
    for (int side = 0; side < 2; side++) {
        const struct cell_boundary *boundary = &state->cell->boundaries[side];
        size_t joint = boundary->operator->columns, shift = side ? state->points - joint : 0;
        for (size_t j = 0; j < joint; j++)
            if (!boundary->indices || boundary->indices[j] != j + shift)
                return false;
    }
    return true;
}

/* Columns first … first + count - 1 of the identity. */
static bcifs_status unit_columns(struct bcifs_plan *plan, size_t size, size_t first, size_t count,
                                 struct columns *columns)
{
    double *numbers = arena_new(&plan->arena, size * count, sizeof *numbers);
    if (!numbers)
        return BCIFS_MEMORY;
    for (size_t j = 0; j < count; j++)
        numbers[(first + j) * count + j] = 1;
    *columns = (struct columns){numbers, count};
    return BCIFS_OK;
}

static bcifs_status leaf_control(struct bcifs_plan *plan, size_t index, bool at_end, struct columns *columns)
{
    struct states *states = &plan->states;
    size_t points = states->states[index].points;
    if (states->states[index].key.definition->kind != CELL_EDGE)
        return unit_columns(plan, points, 0, points, columns);
    bcifs_status status = states_expand(states, index);
    if (status)
        return status;
    const struct state *state = &states->states[index];
    if (!is_stepped(state))
        return plan_refuse(plan,
                           "the control points of '%s' do not form one polygon: its start must be at its first "
                           "control points and its end at its last",
                           state->key.definition->name);
    size_t joint = state->cell->boundaries[1].operator->columns;
    return at_end ? unit_columns(plan, points, points - joint, joint, columns)
                  : unit_columns(plan, points, 0, points - joint, columns);
}

static bcifs_status leaf_make(struct bcifs_plan *plan, size_t index, bool at_end, struct columns *columns)
{
    if (plan->show == BCIFS_CONTROL)
        return leaf_control(plan, index, at_end, columns);
    double *numbers = arena_new(&plan->arena, plan->states.states[index].points, sizeof *numbers);
    if (!numbers)
        return BCIFS_MEMORY;
    *columns = (struct columns){numbers, 1};
    return plan->show == BCIFS_LIMIT ? states_end_limit(&plan->states, index, at_end, numbers)
                                     : leaf_seed(plan, index, at_end, numbers);
}

/* The state of the last cell at the plan's depth below a piece. */
static size_t last_leaf(const struct bcifs_plan *plan, size_t index)
{
    for (unsigned level = 0; level < plan->depth; level++) {
        const struct state *state = &plan->states.states[index];
        index = state->children[state->cell->child_count - 1];
    }
    return index;
}

static bcifs_status leaves_make(struct bcifs_plan *plan)
{
    size_t count = plan->walked;
    plan->leaves = arena_new(&plan->arena, count, sizeof *plan->leaves);
    plan->ends = arena_new(&plan->arena, count, sizeof *plan->ends);
    if (!plan->leaves || !plan->ends)
        return BCIFS_MEMORY;
    bcifs_status status = BCIFS_OK;
    for (size_t s = 0; s < count && status == BCIFS_OK; s++)
        if (plan->least[s] <= plan->depth)
            status = leaf_make(plan, s, false, &plan->leaves[s]);
    for (size_t i = 0; i < plan->figure->chain_count && status == BCIFS_OK; i++) {
        const struct chain *chain = &plan->figure->chains[i];
        if (chain->closed)
            continue;
        size_t end = last_leaf(plan, plan->figure->pieces[chain->first + chain->count - 1].state);
        if (!plan->ends[end].numbers)
            status = leaf_make(plan, end, true, &plan->ends[end]);
    }
    return status;
}

/* ---- Leaf tables --------------------------------------------------------------------------------------- */

/* The largest number of levels whose tables stay within their sizes. */
static unsigned tail_choose(const struct bcifs_plan *plan)
{
    size_t states = plan->walked;
    unsigned tail = 0;
    for (unsigned level = 1; level <= plan->depth; level++) {
        uint64_t total = 0;
        for (size_t s = 0; s < states; s++) {
            uint64_t columns = plan->counts[level * states + s];
            if (plan->least[s] > plan->depth - level)
                continue;
            if (columns > PLAN_TABLE_BYTES / sizeof(double) / plan->states.states[s].points)
                return tail;
            total += columns * plan->states.states[s].points * sizeof(double);
        }
        if (total > PLAN_TABLES_BYTES)
            return tail;
        tail = level;
    }
    return tail;
}

/* W of the next level: [T_0 W_0 | T_1 W_1 | …], W_i the table of child i one level below. */
static bcifs_status table_extend(struct bcifs_plan *plan, size_t index, const struct columns *below,
                                 struct columns *table)
{
    const struct state *state = &plan->states.states[index];
    size_t count = 0, column = 0;
    for (size_t k = 0; k < state->cell->child_count; k++)
        count += below[state->children[k]].count;
    double *numbers = arena_new(&plan->arena, state->points * count, sizeof *numbers);
    if (!numbers)
        return BCIFS_MEMORY;
    for (size_t k = 0; k < state->cell->child_count; k++) {
        const struct columns *child = &below[state->children[k]];
        size_t inner = plan->states.states[state->children[k]].points;
        for (size_t i = 0; i < state->points; i++)
            for (size_t j = 0; j < inner; j++)
                for (size_t c = 0; c < child->count; c++)
                    numbers[i * count + column + c] +=
                        state->maps[k][i * inner + j] * child->numbers[j * child->count + c];
        column += child->count;
    }
    *table = (struct columns){numbers, count};
    return BCIFS_OK;
}

static bcifs_status tables_make(struct bcifs_plan *plan)
{
    size_t states = plan->walked;
    struct columns *below = plan->leaves;
    plan->tail = tail_choose(plan);
    for (unsigned level = 1; level <= plan->tail; level++) {
        struct columns *tables = arena_new(&plan->arena, states, sizeof *tables);
        if (!tables)
            return BCIFS_MEMORY;
        for (size_t s = 0; s < states; s++)
            if (plan->least[s] <= plan->depth - level) {
                bcifs_status status = table_extend(plan, s, below, &tables[s]);
                if (status)
                    return status;
            }
        below = tables;
    }
    plan->tables = below;
    return BCIFS_OK;
}

/* ---- Segments and paths -------------------------------------------------------------------------------- */

static void segment_add(struct bcifs_plan *plan, size_t piece, bool is_tail, uint64_t count)
{
    plan->segments[plan->segment_count++] = (struct segment){piece, is_tail, plan->points};
    plan->points = add_saturated(plan->points, count);
}

static bcifs_status segments_make(struct bcifs_plan *plan)
{
    const bcifs_figure *figure = plan->figure;
    const uint64_t *counts = plan->counts + plan->depth * plan->walked;
    plan->segments = arena_new(&plan->arena, figure->piece_count + figure->chain_count, sizeof *plan->segments);
    plan->paths = arena_new(&plan->arena, figure->chain_count, sizeof *plan->paths);
    if (!plan->segments || !plan->paths)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < figure->piece_count && figure->shape == FIGURE_ATTRACTOR; i++)
        segment_add(plan, i, false, counts[figure->pieces[i].state]);
    for (size_t i = 0; i < figure->chain_count; i++) {
        const struct chain *chain = &figure->chains[i];
        uint64_t first = plan->points;
        for (size_t j = 0; j < chain->count; j++)
            segment_add(plan, chain->first + j, false, counts[figure->pieces[chain->first + j].state]);
        if (!chain->closed) {
            size_t last = chain->first + chain->count - 1;
            segment_add(plan, last, true, plan->ends[last_leaf(plan, figure->pieces[last].state)].count);
        }
        plan->paths[plan->path_count++] = (bcifs_path){first, plan->points - first, chain->closed};
    }
    return BCIFS_OK;
}

/* ---- A part of the parameter --------------------------------------------------------------------------- */

/* Among the points below a state with `level` levels left: how many lie before the fraction, and whether one lies
 * exactly there. Every cell begins at its own share of the parameter. */
static uint64_t points_before(const struct bcifs_plan *plan, size_t index, uint64_t fraction, bool *exactly)
{
    uint64_t before = 0;
    for (unsigned level = plan->depth; level > 0; level--) {
        const struct state *state = &plan->states.states[index];
        const uint64_t *counts = plan->counts + (level - 1) * plan->walked;
        size_t digit = parameter_digit(&fraction, state->cell->child_count);
        for (size_t k = 0; k < digit; k++)
            before += counts[state->children[k]];
        index = state->children[digit];
    }
    *exactly = fraction == 0;
    return before + (fraction > 0);
}

/* The index of the first point with parameter >= t, or (after) of the first with parameter > t. */
static uint64_t parameter_index(const struct bcifs_plan *plan, double t, bool after)
{
    const bcifs_figure *figure = plan->figure;
    uint64_t fraction = parameter_from_double(t);
    size_t piece = parameter_digit(&fraction, figure->piece_count), segment = 0;
    bool exactly;
    /* A chain's last point lies at the end of its last piece, where the next piece begins. */
    while (segment < plan->segment_count && plan->segments[segment].piece + plan->segments[segment].is_tail < piece)
        segment++;
    bool tail_here = segment < plan->segment_count && plan->segments[segment].is_tail;
    if (tail_here && (fraction > 0 || (after && piece < figure->piece_count)))
        segment++;
    else if (tail_here)
        return after ? plan->points : plan->segments[segment].first;
    if (segment == plan->segment_count)
        return plan->points;
    uint64_t before = points_before(plan, figure->pieces[piece].state, fraction, &exactly);
    return plan->segments[segment].first + before + (after && exactly);
}

static bcifs_status range_apply(struct bcifs_plan *plan, double from, double to)
{
    if (from == 0 && (to == 0 || to == 1))
        return BCIFS_OK;
    if (!(from >= 0 && from <= to && to <= 1))
        return plan_refuse(plan, "a range of parameters lies in 0..1 and does not run backwards%s", "");
    if (plan->show == BCIFS_CONTROL)
        return plan_refuse(plan, "control points have no parameter: a range needs limit points or a seed%s", "");
    uint64_t first = parameter_index(plan, from, false);
    uint64_t last = to == 1 ? plan->points : parameter_index(plan, to, true);
    size_t kept = 0;
    for (size_t i = 0; i < plan->path_count; i++) {
        bcifs_path path = plan->paths[i];
        uint64_t begin = path.first > first ? path.first : first;
        uint64_t end = path.first + path.count < last ? path.first + path.count : last;
        if (begin >= end)
            continue;
        bool whole = end - begin == path.count;
        plan->paths[kept++] = (bcifs_path){begin - first, end - begin, path.closed && whole};
    }
    plan->path_count = kept;
    plan->offset = first;
    plan->points = last > first ? last - first : 0;
    if (plan->points == 0)
        return plan_refuse(plan, "no point of this depth has its parameter in the range%s", "");
    return BCIFS_OK;
}

/* ---- The handle ---------------------------------------------------------------------------------------- */

static bcifs_status view_check(const bcifs_figure *figure, const bcifs_view *view, struct report *report)
{
    const char *file = figure->automaton->modules[0]->source->name;
    if (figure->shape == FIGURE_SURFACE)
        return report_failure(report, BCIFS_INPUT, file,
                              "the figure '%s' is a surface; only curves and attractors can be evaluated",
                              figure->name);
    if (figure->displaced)
        return report_failure(report, BCIFS_INPUT, file,
                              "the figure '%s' has displace lines, which cannot be evaluated yet", figure->name);
    if (view->depth > PLAN_DEEPEST)
        return report_failure(report, BCIFS_INPUT, NULL, "the depth must be at most %d, found %u", PLAN_DEEPEST,
                              view->depth);
    double sum = 0;
    for (size_t i = 0; i < view->seed_count && view->show == BCIFS_SEED; i++)
        sum += view->seed[i];
    if (view->show == BCIFS_SEED && !(fabs(sum - 1) <= 1e-9))
        return report_failure(report, BCIFS_INPUT, NULL, "the barycentric coordinates of the seed must sum to 1");
    return BCIFS_OK;
}

static bcifs_status size_check(struct bcifs_plan *plan)
{
    if (plan->points <= PLAN_MOST_POINTS)
        return BCIFS_OK;
    return report_failure(plan->states.setting.report, BCIFS_INPUT, NULL,
                          "depth %u has more than 2^40 points; the greatest depth here is %u", plan->depth,
                          bcifs_figure_depth(plan->figure, PLAN_MOST_POINTS));
}

static bcifs_status plan_make(struct bcifs_plan *plan, const bcifs_figure *figure, const bcifs_view *view,
                              struct report *report)
{
    bcifs_status status = view_check(figure, view, report);
    if (status)
        return status;
    plan->figure = figure;
    plan->show = view->show;
    plan->depth = view->depth;
    plan->seed = view->seed;
    plan->seed_count = view->seed_count;
    status = states_copy(&plan->states, &figure->states, &plan->arena, report);
    if (status == BCIFS_OK)
        status = states_reach(&plan->states, figure, plan->depth, &plan->arena, &plan->least);
    if (status)
        return status;
    plan->walked = plan->states.count;
    if ((size_t)(plan->depth + 1) * plan->walked > PLAN_MOST_COUNTS)
        return report_failure(report, BCIFS_INPUT, NULL,
                              "depth %u with %zu states: levels times states must stay below %d", plan->depth,
                              plan->walked, PLAN_MOST_COUNTS);
    status = leaves_make(plan);
    if (status == BCIFS_OK)
        status = counts_make(&plan->states, plan->walked, plan->least, plan->leaves, plan->depth, &plan->arena,
                             &plan->counts);
    return status;
}

/* Control frames are polygons of one size. */
static bcifs_status polygon_measure(struct bcifs_plan *plan)
{
    if (plan->figure->shape != FIGURE_ATTRACTOR || plan->show != BCIFS_CONTROL)
        return BCIFS_OK;
    size_t points = plan->states.states[plan->figure->pieces[0].state].points;
    for (size_t s = 0; s < plan->walked; s++)
        if (plan->least[s] <= plan->depth && plan->states.states[s].points != points)
            return plan_refuse(plan, "control frames are drawn for cells of one size only; '%s' differs",
                               plan->states.states[s].key.definition->name);
    plan->polygon = (unsigned)points;
    return BCIFS_OK;
}

static bcifs_status plan_finish(struct bcifs_plan *plan, const bcifs_view *view)
{
    bcifs_status status = segments_make(plan);
    if (status == BCIFS_OK)
        status = size_check(plan);
    if (status == BCIFS_OK)
        status = tables_make(plan);
    if (status == BCIFS_OK)
        status = range_apply(plan, view->from, view->to);
    for (size_t s = 0; s < plan->walked; s++)
        if (plan->states.states[s].points > plan->largest)
            plan->largest = plan->states.states[s].points;
    return status ? status : polygon_measure(plan);
}

bcifs_status bcifs_plan_create(const bcifs_figure *figure, const bcifs_view *view, bcifs_plan **plan,
                               bcifs_error *error)
{
    struct report report = report_new(NULL);
    bcifs_plan *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? plan_make(fresh, figure, view, &report) : BCIFS_MEMORY;
    if (status == BCIFS_OK)
        status = plan_finish(fresh, view);
    if (status == BCIFS_MEMORY && report.errors == 0)
        report_memory(&report);
    if (status) {
        bcifs_plan_free(fresh);
        report_close(&report, error);
        return status;
    }
    fresh->states.setting.report = NULL;
    *plan = fresh;
    return BCIFS_OK;
}

void bcifs_plan_free(bcifs_plan *plan)
{
    if (!plan)
        return;
    arena_free(&plan->arena);
    memory_free(plan);
}

uint64_t bcifs_plan_points(const bcifs_plan *plan)
{
    return plan->points;
}

unsigned bcifs_plan_dimension(const bcifs_plan *plan)
{
    return plan->figure->dimension;
}

size_t bcifs_plan_path_count(const bcifs_plan *plan)
{
    return plan->path_count;
}

bcifs_path bcifs_plan_path(const bcifs_plan *plan, size_t index)
{
    return plan->paths[index];
}

unsigned bcifs_plan_polygon(const bcifs_plan *plan)
{
    return plan->polygon;
}

/* Points of the whole figure at a depth, by counts alone; UINT64_MAX when it cannot be counted. */
static uint64_t figure_points(const bcifs_figure *figure, unsigned depth)
{
    struct arena arena = {0};
    struct states states;
    size_t *least;
    const uint64_t *counts;
    uint64_t sum = UINT64_MAX;
    bcifs_status status = states_copy(&states, &figure->states, &arena, NULL);
    if (status == BCIFS_OK)
        status = states_reach(&states, figure, depth, &arena, &least);
    struct columns *one = status ? NULL : arena_new(&arena, states.count, sizeof *one);
    for (size_t s = 0; one && s < states.count; s++)
        one[s].count = 1;
    if (one && counts_make(&states, states.count, least, one, depth, &arena, &counts) == BCIFS_OK) {
        sum = 0;
        for (size_t i = 0; i < figure->piece_count; i++)
            sum = add_saturated(sum, counts[depth * states.count + figure->pieces[i].state]);
        for (size_t i = 0; i < figure->chain_count; i++)
            sum = add_saturated(sum, !figure->chains[i].closed);
    }
    arena_free(&arena);
    return sum;
}

unsigned bcifs_figure_depth(const bcifs_figure *figure, uint64_t points)
{
    enum { DEEPEST = 64 };
    unsigned depth = 0;
    while (depth < DEEPEST && figure_points(figure, depth + 1) <= points)
        depth++;
    return depth;
}
