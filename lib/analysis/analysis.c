#include "analysis.h"

#include <math.h>
#include <string.h>

#include "automaton/proof.h"
#include "numeric/matrix.h"
#include "numeric/tolerance.h"

/* ---- Edges --------------------------------------------------------------------------------------------- */

static bcifs_status spectra_find(struct bcifs_analysis *analysis, struct edge_analysis *edge)
{
    const struct state *state = &analysis->states.states[edge->state];
    struct spectrum *maps = arena_new(&analysis->arena, edge->child_count, sizeof *maps);
    bcifs_status status = maps ? BCIFS_OK : BCIFS_MEMORY;
    edge->maps = maps;
    for (size_t i = 0; i < edge->child_count && status == BCIFS_OK; i++)
        if (analysis->states.states[state->children[i]].points == edge->points)
            status = spectrum_find(state->maps[i], edge->points, &analysis->arena, &maps[i]);
    return status;
}

static const char *junction_reason(const struct half_tangent *end, const struct half_tangent *start,
                                   const struct junction *junction)
{
    if (!end->direction)
        return end->reason;
    if (!start->direction)
        return start->reason;
    if (!junction->left || !junction->right)
        return "a map collapses the direction";
    return "the half-tangents on both sides point different ways";
}

/* T_i (end of child i) and T_{i+1} (start of child i + 1), both in the parent's coordinates. */
static bcifs_status junction_find(struct bcifs_analysis *analysis, struct edge_analysis *edge, size_t i)
{
    const struct state *state = &analysis->states.states[edge->state];
    struct junction *junction = &edge->junctions[i];
    const struct half_tangent *halves[2] = {
        &tangents_of(&analysis->tangents, state->children[i])->ends[1],
        &tangents_of(&analysis->tangents, state->children[i + 1])->ends[0]};
    const double **sides[2] = {&junction->left, &junction->right};
    for (size_t side = 0; side < 2; side++) {
        double *mapped = arena_new(&analysis->arena, edge->points, sizeof *mapped);
        if (!mapped)
            return BCIFS_MEMORY;
        size_t points = analysis->states.states[state->children[i + side]].points;
        if (halves[side]->direction &&
            direction_map(state->maps[i + side], halves[side]->direction, edge->points, points, mapped))
            *sides[side] = mapped;
    }
    junction->tangent_continuous =
        junction->left && junction->right && direction_equal(junction->left, junction->right, edge->points);
    if (!junction->tangent_continuous)
        junction->reason = junction_reason(halves[0], halves[1], junction);
    return BCIFS_OK;
}

static const char *name_copy(struct bcifs_analysis *analysis, const struct state_key *key)
{
    struct text name = {0};
    state_name(key, &name);
    const char *copy = name.failed ? NULL : arena_text(&analysis->arena, name.data, name.length);
    text_free(&name);
    return copy;
}

static bcifs_status edge_analyze(struct bcifs_analysis *analysis, const struct arc_tangents *arc,
                                 struct edge_analysis *edge)
{
    const struct state *state = &analysis->states.states[arc->state];
    *edge = (struct edge_analysis){.name = name_copy(analysis, &state->key),
                                   .state = arc->state,
                                   .points = state->points,
                                   .child_count = state->cell->child_count,
                                   .ends = arc->ends,
                                   .tangent_continuous = true};
    edge->junctions = arena_new(&analysis->arena, edge->child_count, sizeof *edge->junctions);
    if (!edge->name || !edge->junctions)
        return BCIFS_MEMORY;
    bcifs_status status = spectra_find(analysis, edge);
    for (size_t i = 0; i + 1 < edge->child_count && status == BCIFS_OK; i++) {
        status = junction_find(analysis, edge, i);
        edge->tangent_continuous = edge->tangent_continuous && edge->junctions[i].tangent_continuous;
    }
    return status;
}

static struct edge_analysis *edge_of(struct bcifs_analysis *analysis, size_t state)
{
    for (size_t i = 0; i < analysis->edge_count; i++)
        if (analysis->edges[i].state == state)
            return &analysis->edges[i];
    return NULL;
}

/* A junction deeper down is the image of one of a child: the property passes from children to parents. */
static void continuity_spread(struct bcifs_analysis *analysis)
{
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t i = 0; i < analysis->edge_count; i++) {
            struct edge_analysis *edge = &analysis->edges[i];
            const struct state *state = &analysis->states.states[edge->state];
            for (size_t k = 0; k < edge->child_count && edge->tangent_continuous; k++)
                if (!edge_of(analysis, state->children[k])->tangent_continuous) {
                    edge->tangent_continuous = false;
                    changed = true;
                }
        }
    }
}

/* ---- Joints -------------------------------------------------------------------------------------------- */

static bcifs_status joint_analyze(struct bcifs_analysis *analysis, size_t index, struct joint_analysis *joint)
{
    bcifs_status status = states_expand(&analysis->states, index);
    if (status)
        return status;
    const struct state *state = &analysis->states.states[index];
    double *limit = arena_new(&analysis->arena, state->points, sizeof *limit);
    *joint = (struct joint_analysis){
        .name = name_copy(analysis, &state->key), .points = state->points, .limit = limit};
    if (!joint->name || !limit)
        return BCIFS_MEMORY;
    if (analysis->states.states[state->children[0]].points == state->points)
        status = spectrum_find(state->maps[0], state->points, &analysis->arena, &joint->map);
    return status ? status : states_limit(&analysis->states, index, limit);
}

/* Every vertex state that bounds an edge state of the analysis. */
static bcifs_status joints_analyze(struct bcifs_analysis *analysis)
{
    size_t capacity = 0;
    for (size_t e = 0; e < analysis->edge_count; e++)
        for (int side = 0; side < 2; side++) {
            size_t index = analysis->states.states[analysis->edges[e].state].boundaries[side];
            bool known = false;
            for (size_t f = 0; f <= e && !known; f++)
                for (int other = 0; other < (f == e ? side : 2) && !known; other++)
                    known = analysis->states.states[analysis->edges[f].state].boundaries[other] == index;
            if (known)
                continue;
            if (!ARENA_RESERVE(&analysis->arena, analysis->joints, analysis->joint_count, capacity))
                return BCIFS_MEMORY;
            bcifs_status status = joint_analyze(analysis, index, &analysis->joints[analysis->joint_count++]);
            if (status)
                return status;
        }
    return BCIFS_OK;
}

/* ---- Figures ------------------------------------------------------------------------------------------- */

/* Adds a piece's direction, in the figure's control points. */
static void direction_scatter(const struct piece *piece, const double *direction, size_t points,
                              double *figure)
{
    for (size_t j = 0; j < points; j++)
        figure[piece->indices[j]] += direction[j];
}

/* Whether two directions, spread over the figure's points, agree; clears them again. Closed figures of few
 * points may use one twice, so lengths are measured anew. */
static bool scattered_equal(const struct piece *const pieces[2], const size_t points[2],
                            double *const sides[2])
{
    double square[2] = {0, 0}, product = 0;
    for (int p = 0; p < 2; p++)
        for (size_t j = 0; j < points[p]; j++) {
            size_t index = pieces[p]->indices[j];
            square[0] += sides[0][index] * sides[0][index];
            square[1] += sides[1][index] * sides[1][index];
            product += sides[0][index] * sides[1][index];
            sides[0][index] = sides[1][index] = 0;
        }
    double both = sqrt(square[0] * square[1]);
    /* |a - b|² = 2 - 2 cos for unit vectors. */
    return both > 0 && 1 - product / both <= TOLERANCE_DIRECTION * TOLERANCE_DIRECTION / 2 + 4e-16;
}

static bcifs_status pieces_compare(struct bcifs_analysis *analysis, const bcifs_figure *figure, size_t a,
                                   size_t b, double *const sides[2], bool *continuous)
{
    const struct piece *pieces[2] = {&figure->pieces[a], &figure->pieces[b]};
    const struct half_tangent *halves[2];
    size_t points[2];
    *continuous = false;
    for (int side = 0; side < 2; side++) {
        struct state_key key = figure->states.states[pieces[side]->state].key;
        size_t state;
        bcifs_status status = states_intern(&analysis->states, key, &state);
        const struct arc_tangents *arc = status ? NULL : tangents_of(&analysis->tangents, state);
        if (!arc)
            return status ? status : BCIFS_INPUT;
        halves[side] = &arc->ends[side == 0];
        points[side] = analysis->states.states[state].points;
    }
    if (!halves[0]->direction || !halves[1]->direction)
        return BCIFS_OK;
    direction_scatter(pieces[0], halves[0]->direction, points[0], sides[0]);
    direction_scatter(pieces[1], halves[1]->direction, points[1], sides[1]);
    *continuous = scattered_equal(pieces, points, sides);
    return BCIFS_OK;
}

static bcifs_status figure_junctions(struct bcifs_analysis *analysis, const bcifs_figure *figure,
                                     struct figure_analysis *result)
{
    struct arena *arena = &analysis->arena;
    size_t(*between)[2] = arena_new(arena, figure->piece_count, sizeof *between);
    bool *continuous = arena_new(arena, figure->piece_count, sizeof *continuous);
    double *sides[2] = {arena_new(arena, figure->point_count, sizeof(double)),
                        arena_new(arena, figure->point_count, sizeof(double))};
    if (!between || !continuous || !sides[0] || !sides[1])
        return BCIFS_MEMORY;
    *result = (struct figure_analysis){figure->name, 0, (const size_t(*)[2])between, continuous};
    for (size_t c = 0; c < figure->chain_count; c++) {
        const struct chain *chain = &figure->chains[c];
        for (size_t i = 0; i + !chain->closed < chain->count; i++) {
            size_t a = chain->first + i, b = chain->first + (i + 1) % chain->count,
                   k = result->junction_count++;
            between[k][0] = a;
            between[k][1] = b;
            bcifs_status status = pieces_compare(analysis, figure, a, b, sides, &continuous[k]);
            if (status)
                return status;
        }
    }
    return BCIFS_OK;
}

static bcifs_status figures_analyze(struct bcifs_analysis *analysis)
{
    const bcifs_automaton *automaton = analysis->automaton;
    analysis->figures = arena_new(&analysis->arena, automaton->figure_count, sizeof *analysis->figures);
    if (!analysis->figures)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < automaton->figure_count; i++) {
        bcifs_figure figure = {0};
        struct report silent = report_new(NULL);
        bcifs_status status = figure_bind(&figure, automaton, &automaton->figures[i], NULL, &silent);
        if (status == BCIFS_OK && figure.shape == FIGURE_CURVE)
            status = figure_junctions(analysis, &figure, &analysis->figures[analysis->figure_count++]);
        arena_free(&figure.arena);
        if (status)
            return status;
    }
    return BCIFS_OK;
}

/* ---- The whole ----------------------------------------------------------------------------------------- */

/* The equations come first: without them arcs do not meet and nothing below means anything. */
static bcifs_status equations_require(const bcifs_automaton *automaton, const bcifs_load_options *options,
                                      bcifs_error *error)
{
    bcifs_check *check;
    bcifs_status status = bcifs_check_create(automaton, options, &check, error);
    if (status)
        return status;
    status = bcifs_check_require(check, options, error);
    bcifs_check_free(check);
    return status;
}

static bcifs_status analyze(struct bcifs_analysis *analysis, double effort, struct report *report)
{
    bcifs_status status = states_of_figures(analysis->automaton, &analysis->states, &analysis->arena);
    analysis->states.setting.report = report;
    if (status == BCIFS_OK)
        status = tangents_find(&analysis->states, &analysis->arena, &analysis->tangents);
    if (status)
        return status;
    size_t count = analysis->tangents.count;
    analysis->edges = arena_new(&analysis->arena, count, sizeof *analysis->edges);
    if (!analysis->edges)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < count && status == BCIFS_OK; i++) {
        struct edge_analysis *edge = &analysis->edges[analysis->edge_count++];
        status = edge_analyze(analysis, &analysis->tangents.arcs[i], edge);
        if (status == BCIFS_OK)
            status =
                smoothness_find(&analysis->states, edge->state, effort, &analysis->arena, &edge->smoothness);
    }
    if (status)
        return status;
    continuity_spread(analysis);
    status = joints_analyze(analysis);
    return status ? status : figures_analyze(analysis);
}

bcifs_status bcifs_analysis_create(const bcifs_automaton *automaton, double effort,
                                   const bcifs_load_options *options, bcifs_analysis **analysis,
                                   bcifs_error *error)
{
    bcifs_status status = equations_require(automaton, options, error);
    if (status)
        return status; /* reported already */
    struct report report = report_new(options);
    bcifs_analysis *fresh = memory_new(1, sizeof *fresh);
    status = BCIFS_MEMORY;
    if (fresh) {
        fresh->automaton = automaton;
        status = analyze(fresh, effort, &report);
    }
    if (status == BCIFS_MEMORY && report.errors == 0)
        report_memory(&report);
    if (status) {
        bcifs_analysis_free(fresh);
        report_close(&report, error);
        return status;
    }
    fresh->states.setting.report = NULL;
    *analysis = fresh;
    return BCIFS_OK;
}

void bcifs_analysis_free(bcifs_analysis *analysis)
{
    if (!analysis)
        return;
    arena_free(&analysis->arena);
    memory_free(analysis);
}
