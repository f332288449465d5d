#include "basis.h"

#include <string.h>

/* ---- Unit vectors -------------------------------------------------------------------------------------- */

struct unit_group {
    bcifs_figure *figure;
    bcifs_plan *plan;
    bcifs_walker *walker;
    double *points; /* what the walker gives */
    size_t dimension;
};

enum { UNIT_TILE = 256 /* columns asked of a walker at a time */ };

/* One piece in the state, whose control points first … first + dimension - 1 are unit vectors, the others 0.
 */
static bcifs_status group_figure(struct unit_group *group, const bcifs_figure *model,
                                 const struct states *states, size_t state, size_t first,
                                 struct report *report)
{
    size_t m = states->states[state].points;
    bcifs_figure *figure = group->figure = memory_new(1, sizeof *figure);
    if (!figure)
        return report_memory(report);
    double *points = arena_new(&figure->arena, m * group->dimension, sizeof *points);
    size_t *indices = arena_new(&figure->arena, m, sizeof *indices);
    figure->pieces = arena_new(&figure->arena, 1, sizeof *figure->pieces);
    figure->chains = arena_new(&figure->arena, 1, sizeof *figure->chains);
    group->points = arena_new(&figure->arena, UNIT_TILE * group->dimension, sizeof *group->points);
    if (!points || !indices || !figure->pieces || !figure->chains || !group->points)
        return report_memory(report);
    for (size_t j = 0; j < m; j++)
        indices[j] = j;
    for (size_t j = 0; j < group->dimension; j++)
        points[(first + j) * group->dimension + j] = 1;
    figure->automaton = model->automaton;
    figure->name = model->name;
    figure->shape = model->shape;
    figure->dimension = (unsigned)group->dimension;
    figure->points = points;
    figure->point_count = m;
    figure->pieces[0] = (struct piece){state, indices};
    figure->piece_count = 1;
    figure->chains[0] = (struct chain){0, 1, false};
    figure->chain_count = figure->shape == FIGURE_CURVE;
    bcifs_status status = states_copy(&figure->states, states, &figure->arena, report);
    figure->states.setting.report = NULL;
    return status;
}

static bcifs_status group_open(struct unit_group *group, const bcifs_view *view, struct report *report)
{
    bcifs_error error;
    bcifs_status status = bcifs_plan_create(group->figure, view, &group->plan, &error);
    if (status == BCIFS_OK)
        status = bcifs_walker_create(group->plan, &group->walker, &error);
    return status ? report_failure(report, status, error.file[0] ? error.file : NULL, "%s", error.message)
                  : BCIFS_OK;
}

bcifs_status unit_open(struct unit_reader *reader, const bcifs_figure *figure, const struct states *states,
                       size_t state, const bcifs_view *view, struct report *report)
{
    size_t m = states->states[state].points;
    *reader = (struct unit_reader){.points = m, .groups = (m + UNIT_DIMENSION - 1) / UNIT_DIMENSION};
    reader->list = memory_new(reader->groups, sizeof *reader->list);
    if (!reader->list)
        return report_memory(report);
    bcifs_status status = BCIFS_OK;
    for (size_t g = 0; g < reader->groups && status == BCIFS_OK; g++) {
        struct unit_group *group = &reader->list[g];
        size_t first = g * UNIT_DIMENSION;
        group->dimension = m - first < UNIT_DIMENSION ? m - first : UNIT_DIMENSION;
        status = group_figure(group, figure, states, state, first, report);
        if (status == BCIFS_OK)
            status = group_open(group, view, report);
    }
    if (status) {
        unit_close(reader);
        return status;
    }
    const bcifs_plan *plan = reader->list[0].plan;
    reader->count = plan->points;
    reader->body = plan->segment_count > 1 ? plan->segments[1].first : plan->points;
    return BCIFS_OK;
}

size_t unit_next(struct unit_reader *reader, double *columns, size_t capacity)
{
    size_t count = 0;
    capacity = capacity < UNIT_TILE ? capacity : UNIT_TILE;
    for (size_t g = 0; g < reader->groups; g++) {
        const struct unit_group *group = &reader->list[g];
        count = bcifs_walker_next(group->walker, group->points, capacity);
        for (size_t i = 0; i < count; i++)
            memcpy(columns + i * reader->points + g * UNIT_DIMENSION, group->points + i * group->dimension,
                   group->dimension * sizeof *columns);
    }
    return count;
}

void unit_close(struct unit_reader *reader)
{
    for (size_t g = 0; reader->list && g < reader->groups; g++) {
        bcifs_walker_free(reader->list[g].walker);
        bcifs_plan_free(reader->list[g].plan);
        bcifs_figure_free(reader->list[g].figure);
    }
    memory_free(reader->list);
    reader->list = NULL;
}

/* ---- Tables -------------------------------------------------------------------------------------------- */

/* A parameter as a fraction of integers, so that it has the same bits whatever the level (below 2^53). */
struct share {
    double numerator, denominator;
};

/* The samples of a state at the depth below the level: count columns, `body` of them before its end. */
struct basis_table {
    const double *columns;
    const struct share *shares; /* where they are in the cell's own parameter, 0..1 */
    size_t body, count;
};

/* The part `index` of `count`: (a + i/n) / b, where the whole is a/b … (a + 1)/b. */
static struct share share_part(struct share whole, size_t index, size_t count)
{
    return (struct share){whole.numerator * (double)count + (double)index, whole.denominator * (double)count};
}

/* Every child takes an equal share of its parent's parameter, as in bcifs_point_at. */
static bcifs_status shares_fill(struct basis *basis, size_t state, unsigned depth, struct share low,
                                struct share *shares, size_t *count)
{
    if (depth == 0) {
        shares[(*count)++] = low;
        return BCIFS_OK;
    }
    bcifs_status status = states_expand(&basis->states, state);
    size_t children = status ? 0 : basis->states.states[state].cell->child_count;
    for (size_t i = 0; i < children && status == BCIFS_OK; i++)
        status = shares_fill(basis, basis->states.states[state].children[i], depth - 1,
                             share_part(low, i, children), shares, count);
    return status;
}

static bcifs_status table_read(struct basis *basis, size_t state, struct unit_reader *reader,
                               struct basis_table *table)
{
    size_t m = reader->points, filled = 0;
    if (reader->count > (BASIS_MOST_SAMPLES - basis->samples) / m)
        return report_failure(
            basis->report, BCIFS_INPUT, NULL,
            "the samples of one cell of level %u at depth %u are more than %d numbers; choose a "
            "smaller --depth",
            basis->view.level, basis->view.depth, BASIS_MOST_SAMPLES);
    basis->samples += (size_t)reader->count * m;
    double *columns = arena_new(&basis->arena, (size_t)reader->count * m, sizeof *columns);
    struct share *shares = arena_new(&basis->arena, (size_t)reader->count, sizeof *shares);
    if (!columns || !shares)
        return report_memory(basis->report);
    for (size_t done = 0, more = 1; more > 0; done += more)
        more = unit_next(reader, columns + done * m, (size_t)reader->count - done);
    bcifs_status status = shares_fill(basis, state, basis->view.depth - basis->view.level,
                                      (struct share){0, 1}, shares, &filled);
    if (filled < reader->count)
        shares[filled] = (struct share){1, 1};
    *table = (struct basis_table){columns, shares, (size_t)reader->body, (size_t)reader->count};
    return status;
}

/* The table of a state, made on first use. */
static bcifs_status table_find(struct basis *basis, size_t state, const struct basis_table **table)
{
    if (basis->states.count > basis->table_count) {
        basis->tables = arena_grow(&basis->arena, basis->tables, basis->table_count, 2 * basis->states.count,
                                   sizeof *basis->tables);
        basis->table_count = 2 * basis->states.count;
        if (!basis->tables)
            return report_memory(basis->report);
    }
    *table = &basis->tables[state];
    if ((*table)->columns)
        return BCIFS_OK;
    struct unit_reader reader;
    const bcifs_view view = {.depth = basis->view.depth - basis->view.level, .show = BCIFS_LIMIT, .to = 1};
    bcifs_status status = unit_open(&reader, basis->figure, &basis->states, state, &view, basis->report);
    if (status)
        return status;
    status = table_read(basis, state, &reader, &basis->tables[state]);
    unit_close(&reader);
    return status;
}

/* ---- Cells of the level -------------------------------------------------------------------------------- */

/* A cell above or at the level: its state, which child comes next, and its share of the parameter. */
struct basis_frame {
    size_t state, child;
    struct share share; /* where it begins; it is 1/denominator wide */
};

static bool at_level_zero(const struct basis *basis)
{
    return basis->view.level == 0;
}

/* The columns that a cell adds to its chain's control polygon, Δ, and those that close an open one, m_s. */
static size_t cell_step(const struct basis *basis, size_t state)
{
    const struct cell *cell = basis->states.states[state].cell;
    return cell->points - cell->boundaries[1].operator->columns;
}

/* Goes down from frame `height` to the first cell of the level below it. */
static bcifs_status frames_descend(struct basis *basis, unsigned height)
{
    for (; height < basis->view.level; height++) {
        struct basis_frame *frame = &basis->frames[height];
        bcifs_status status = states_expand(&basis->states, frame->state);
        if (status)
            return status;
        const struct state *state = &basis->states.states[frame->state];
        frame[1] = (struct basis_frame){state->children[frame->child], 0,
                                        share_part(frame->share, frame->child, state->cell->child_count)};
    }
    return states_expand(&basis->states, basis->frames[basis->view.level].state);
}

static bcifs_status piece_enter(struct basis *basis)
{
    basis->frames[0] = (struct basis_frame){basis->figure->pieces[basis->piece].state,
                                            0,
                                            {(double)basis->piece, (double)basis->figure->piece_count}};
    return frames_descend(basis, 0);
}

/* Which functions of the level are the chain's: those of its control points. */
static bcifs_status chain_measure(struct basis *basis)
{
    bcifs_view view = {.depth = basis->view.level, .show = BCIFS_CONTROL, .to = 1};
    bcifs_error error;
    bcifs_plan *plan;
    if (at_level_zero(basis))
        return BCIFS_OK;
    bcifs_status status = bcifs_plan_create(basis->figure, &view, &plan, &error);
    if (status)
        return report_failure(basis->report, status, NULL, "%s", error.message);
    bcifs_path path = bcifs_plan_path(plan, basis->chain);
    bcifs_plan_free(plan);
    basis->chain_base = (size_t)path.first;
    basis->chain_functions = (size_t)path.count;
    return BCIFS_OK;
}

/* The next cell of the chain; false at its end. */
static bool cell_advance(struct basis *basis, bcifs_status *status)
{
    const struct chain *chain = &basis->figure->chains[basis->chain];
    basis->offset += cell_step(basis, basis->frames[basis->view.level].state);
    basis->sample = 0;
    for (unsigned height = basis->view.level; height-- > 0;) {
        struct basis_frame *frame = &basis->frames[height];
        if (++frame->child < basis->states.states[frame->state].cell->child_count) {
            *status = frames_descend(basis, height);
            return *status == BCIFS_OK;
        }
    }
    if (basis->piece + 1 == chain->first + chain->count)
        return false;
    basis->piece++;
    *status = piece_enter(basis);
    return *status == BCIFS_OK;
}

/* ---- Rows ---------------------------------------------------------------------------------------------- */

bcifs_status basis_open(struct basis *basis, const bcifs_figure *figure, const bcifs_basis_view *view,
                        struct report *report)
{
    uint64_t count;
    bcifs_error error;
    *basis = (struct basis){.figure = figure, .view = *view, .report = report};
    bcifs_status status = bcifs_basis_count(figure, view->level, &count, &error);
    if (status)
        return report_failure(report, status, NULL, "%s", error.message);
    if (view->depth < view->level)
        return report_failure(report, BCIFS_INPUT, NULL, "the depth, %u, must be at least the level, %u",
                              view->depth, view->level);
    if (count > BASIS_MOST_FUNCTIONS)
        return report_failure(report, BCIFS_INPUT, NULL,
                              "level %u has %llu blending functions; the limit is %d", view->level,
                              (unsigned long long)count, BASIS_MOST_FUNCTIONS);
    basis->functions = (size_t)count;
    status = states_copy(&basis->states, &figure->states, &basis->arena, report);
    basis->frames = arena_new(&basis->arena, (size_t)view->level + 1, sizeof *basis->frames);
    basis->indices = arena_new(&basis->arena, CELL_MOST_POINTS, sizeof *basis->indices);
    if (status == BCIFS_OK && (!basis->frames || !basis->indices))
        status = report_memory(report);
    if (status == BCIFS_OK)
        status = chain_measure(basis);
    if (status == BCIFS_OK)
        status = piece_enter(basis);
    if (status)
        basis_close(basis);
    return status;
}

static void row_make(struct basis *basis, const struct basis_table *table, struct basis_row *row)
{
    const struct basis_frame *cell = &basis->frames[basis->view.level];
    size_t m = basis->states.states[cell->state].points;
    const struct piece *piece = &basis->figure->pieces[basis->piece];
    for (size_t j = 0; j < m; j++)
        basis->indices[j] = at_level_zero(basis)
                                ? piece->indices[j]
                                : basis->chain_base + (basis->offset + j) % basis->chain_functions;
    const struct share whole = cell->share, part = table->shares[basis->sample];
    row->t = (whole.numerator * part.denominator + part.numerator) / (whole.denominator * part.denominator);
    row->functions = basis->indices;
    row->values = table->columns + basis->sample * m;
    row->count = m;
}

/* After the last cell of a chain and its end: the next chain. */
static bool chain_advance(struct basis *basis, bcifs_status *status)
{
    if (++basis->chain == basis->figure->chain_count) {
        basis->ended = true;
        return false;
    }
    basis->piece = basis->figure->chains[basis->chain].first;
    basis->offset = basis->sample = 0;
    *status = chain_measure(basis);
    if (*status == BCIFS_OK)
        *status = piece_enter(basis);
    return *status == BCIFS_OK;
}

/* Whether the current cell is the last of its chain. */
static bool cell_is_last(const struct basis *basis)
{
    const struct chain *chain = &basis->figure->chains[basis->chain];
    bool last = basis->piece + 1 == chain->first + chain->count;
    for (unsigned height = 0; height < basis->view.level && last; height++) {
        const struct basis_frame *frame = &basis->frames[height];
        last = frame->child + 1 == basis->states.states[frame->state].cell->child_count;
    }
    return last;
}

bool basis_next(struct basis *basis, struct basis_row *row, bcifs_status *status)
{
    const struct basis_table *table = NULL;
    *status = BCIFS_OK;
    while (!basis->ended) {
        *status = table_find(basis, basis->frames[basis->view.level].state, &table);
        if (*status)
            return false;
        bool last = cell_is_last(basis);
        if (basis->sample < (last ? table->count : table->body)) {
            row_make(basis, table, row);
            basis->sample++;
            return true;
        }
        if (last ? !chain_advance(basis, status) : !cell_advance(basis, status))
            return false;
    }
    return false;
}

void basis_close(struct basis *basis)
{
    arena_free(&basis->arena);
}

bcifs_status bcifs_basis_count(const bcifs_figure *figure, unsigned level, uint64_t *count,
                               bcifs_error *error)
{
    struct report report = report_new(NULL);
    const bcifs_view view = {.depth = level, .show = BCIFS_CONTROL, .to = 1};
    bcifs_plan *plan;
    if (figure->shape != FIGURE_CURVE) {
        report_failure(
            &report, BCIFS_INPUT, NULL, "blending functions are drawn for curves; '%s' is %s", figure->name,
            figure->shape == FIGURE_SURFACE ? "a surface: those of its two directions multiply ([IM] 6.2)"
                                            : "an attractor");
        return report_close(&report, error);
    }
    *count = figure->point_count;
    if (level == 0)
        return BCIFS_OK;
    bcifs_status status = bcifs_plan_create(figure, &view, &plan, error);
    if (status)
        return status;
    *count = plan->points;
    bcifs_plan_free(plan);
    return BCIFS_OK;
}
