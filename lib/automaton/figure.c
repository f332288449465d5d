#include "figure.h"

#include <math.h>
#include <string.h>

#include "language/outline.h"
#include "numeric/tolerance.h"

enum { MOST_POINTS = 1 << 24, MOST_DIMENSION = 16, MOST_REACHED = 1 << 12 /* states expanded */ };

/* A figure being bound. */
struct binding {
    bcifs_figure *figure;
    const struct figure_definition *definition;
    const struct source *source;
    struct report *report;
    const struct syntax_figure_part *directions[2];
    size_t direction_count;
    const struct syntax_figure_part *points, *size, *intervals[2];
    size_t interval_count;
    size_t piece_parts;
    bool points_given; /* the control points are not the file's */
    /* Per direction: */
    struct state_key *keys[2]; /* of each piece's factor */
    size_t counts[2];          /* pieces */
    size_t steps[2], widths[2], lengths[2]; /* Δ, m_a, control points */
};

static struct arena *arena_of(const struct binding *binding)
{
    return &binding->figure->arena;
}

/* ---- Parts --------------------------------------------------------------------------------------------- */

static bcifs_status twice(const struct binding *binding, const struct syntax_figure_part *part, const char *what)
{
    return report_error(binding->report, binding->source, part->place, "figure '%s' has '%s' more than once",
                        binding->definition->name, what);
}

static bcifs_status part_collect(struct binding *binding, const struct syntax_figure_part *part)
{
    switch (part->kind) {
    case FIGURE_OPEN:
    case FIGURE_CLOSED:
        if (binding->direction_count == 2)
            return report_error(binding->report, binding->source, part->place,
                                "open or closed stands once for a curve, twice for a surface, not more");
        binding->directions[binding->direction_count++] = part;
        return BCIFS_OK;
    case FIGURE_PIECE:
        binding->piece_parts++;
        return BCIFS_OK;
    case FIGURE_SIZE:
        if (binding->size)
            return twice(binding, part, "size");
        binding->size = part;
        return BCIFS_OK;
    case FIGURE_INTERVALS:
        if (binding->interval_count == 2)
            return twice(binding, part, "intervals");
        binding->intervals[binding->interval_count++] = part;
        return BCIFS_OK;
    case FIGURE_POINTS:
        if (binding->points)
            return twice(binding, part, "points");
        binding->points = part;
        return BCIFS_OK;
    case FIGURE_DISPLACE:
        binding->figure->displaced = true;
        return BCIFS_OK;
    }
    return BCIFS_OK;
}

static bcifs_status parts_collect(struct binding *binding)
{
    const struct syntax_figure *syntax = binding->definition->syntax;
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < syntax->part_count && status == BCIFS_OK; i++)
        status = part_collect(binding, syntax->parts[i]);
    if (status)
        return status;
    if (binding->direction_count == 0 && binding->piece_parts == 0)
        return report_error(binding->report, binding->source, syntax->place,
                            "figure '%s' has no pieces: say open, closed or piece", syntax->name);
    if (binding->direction_count > 0 && binding->piece_parts > 0)
        return report_error(binding->report, binding->source, syntax->place,
                            "figure '%s' has both piece and open or closed", syntax->name);
    if (binding->size && binding->direction_count != 2)
        return report_error(binding->report, binding->source, binding->size->place,
                            "size is for surfaces: figures with open or closed twice");
    if (binding->interval_count > binding->direction_count)
        return report_error(binding->report, binding->source, binding->intervals[0]->place,
                            "intervals stand once for each open or closed");
    return BCIFS_OK;
}

/* ---- Points -------------------------------------------------------------------------------------------- */

static bcifs_status matrix_values(const struct binding *binding, const struct syntax_matrix *matrix,
                                  struct value **values)
{
    struct environment environment = {.parameters = binding->figure->automaton->values,
                                      .known = binding->figure->automaton->parameter_count,
                                      .steps = EVALUATION_MOST_STEPS,
                                      .source = binding->source,
                                      .report = binding->report};
    size_t count = matrix->rows * matrix->columns;
    *values = arena_new(arena_of(binding), count, sizeof **values);
    if (!*values)
        return report_memory(binding->report);
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < count && status == BCIFS_OK; i++)
        status = expression_evaluate(matrix->entries[i], &environment, &(*values)[i]);
    return status;
}

static bcifs_status points_written(struct binding *binding, const struct syntax_matrix *matrix)
{
    bcifs_figure *figure = binding->figure;
    if (matrix->columns > MOST_DIMENSION)
        return report_error(binding->report, binding->source, matrix->place,
                            "a point has at most %d coordinates, found %zu", MOST_DIMENSION, matrix->columns);
    struct value *values;
    bcifs_status status = matrix_values(binding, matrix, &values);
    size_t count = matrix->rows * matrix->columns;
    double *points = arena_new(arena_of(binding), count, sizeof *points);
    if (status || !points)
        return status ? status : report_memory(binding->report);
    for (size_t i = 0; i < count; i++)
        points[i] = values[i].real;
    figure->points = points;
    figure->exact_points = values;
    figure->point_count = matrix->rows;
    figure->dimension = (unsigned)matrix->columns;
    return BCIFS_OK;
}

static bcifs_status points_given(struct binding *binding, const bcifs_figure_options *options)
{
    bcifs_figure *figure = binding->figure;
    if (options->dimension < 1 || options->dimension > MOST_DIMENSION || options->point_count > MOST_POINTS)
        return report_failure(binding->report, BCIFS_INPUT, NULL,
                              "%zu points of %u coordinates: at most %d points of 1 to %d", options->point_count,
                              options->dimension, MOST_POINTS, MOST_DIMENSION);
    size_t count = options->point_count * options->dimension;
    for (size_t i = 0; i < count; i++)
        if (!isfinite(options->points[i]))
            return report_failure(binding->report, BCIFS_INPUT, NULL, "point %zu is not finite",
                                  i / options->dimension);
    figure->points = arena_grow(arena_of(binding), options->points, count, count, sizeof *options->points);
    if (!figure->points)
        return report_memory(binding->report);
    figure->point_count = options->point_count;
    figure->dimension = options->dimension;
    return BCIFS_OK;
}

/* The points of a drawn curve. A closed figure comes back to its first point by itself, an open one must be told to. */
static bcifs_status points_drawn(struct binding *binding, const bcifs_curve *curve, bool closed, bool open)
{
    size_t dimension = curve->dimension, count = curve->count, size = dimension * sizeof *curve->points;
    if (closed && !curve->closed && memcmp(curve->points, curve->points + (count - 1) * dimension, size) == 0)
        count--;
    size_t more = open && curve->closed;
    double *points = arena_grow(arena_of(binding), curve->points, count * dimension, (count + more) * dimension,
                                sizeof *points);
    if (!points)
        return report_memory(binding->report);
    if (more)
        memcpy(points + count * dimension, points, size);
    bcifs_figure_options options = {
        .points = points, .point_count = count + more, .dimension = curve->dimension};
    return points_given(binding, &options);
}

/* The frame O, X, Y, … that an affine state is written on, design section 4. */
static bcifs_status points_frame(struct binding *binding, size_t dimension)
{
    bcifs_figure *figure = binding->figure;
    size_t count = (dimension + 1) * dimension;
    double *points = arena_new(arena_of(binding), count, sizeof *points);
    struct value *values = arena_new(arena_of(binding), count, sizeof *values);
    if (!points || !values)
        return report_memory(binding->report);
    for (size_t i = 0; i < dimension; i++)
        points[(i + 1) * dimension + i] = 1;
    for (size_t i = 0; i < count; i++)
        values[i] = value_from_integer((int64_t)points[i]);
    figure->points = points;
    figure->exact_points = values;
    figure->point_count = dimension + 1;
    figure->dimension = (unsigned)dimension;
    return BCIFS_OK;
}

/* Any points at all: what is asked of the figure does not depend on where they are. */
static bcifs_status points_unplaced(struct binding *binding, size_t count)
{
    binding->figure->points = arena_new(arena_of(binding), count, sizeof *binding->figure->points);
    if (!binding->figure->points)
        return report_memory(binding->report);
    binding->figure->point_count = count;
    binding->figure->dimension = 1;
    binding->figure->unplaced = true;
    return BCIFS_OK;
}

/* ---- Curves: pieces Δi … Δi + m_a - 1 ------------------------------------------------------------------ */

/* m_a and Δ of an edge state. */
static bcifs_status edge_measure(struct binding *binding, struct state_key key, source_place place, size_t *width,
                                 size_t *step)
{
    struct states *states = &binding->figure->states;
    size_t index;
    bcifs_status status = states_intern(states, key, &index);
    if (status == BCIFS_OK)
        status = states_expand(states, index);
    if (status)
        return status;
    const struct state *state = &states->states[index];
    size_t joint = states->states[state->boundaries[0]].points;
    if (joint >= state->points)
        return report_error(binding->report, binding->source, place,
                            "'%s' shares all its %zu control points with the next arc, so it cannot advance",
                            key.definition->name, state->points);
    *width = state->points;
    *step = state->points - joint;
    return BCIFS_OK;
}

static bcifs_status count_refuse(const struct binding *binding, int direction, const char *reason)
{
    const struct syntax_figure_part *part = binding->directions[direction];
    size_t width = binding->widths[direction], step = binding->steps[direction];
    const char *name = part->reference->name;
    source_place place = binding->points && !binding->points_given ? binding->points->place : part->place;
    if (part->kind == FIGURE_CLOSED && step == 1)
        return report_error(binding->report, binding->source, place,
                            "%s: a closed curve of '%s' needs at least 2 control points, found %zu", reason, name,
                            binding->lengths[direction]);
    if (part->kind == FIGURE_CLOSED)
        return report_error(binding->report, binding->source, place,
                            "%s: a closed curve of '%s' needs a multiple of %zu control points, at least %zu, "
                            "found %zu",
                            reason, name, step, step > 1 ? step : 2, binding->lengths[direction]);
    if (step == 1)
        return report_error(binding->report, binding->source, place,
                            "%s: an open curve of '%s' needs %zu control points or more, found %zu", reason, name,
                            width, binding->lengths[direction]);
    return report_error(binding->report, binding->source, place,
                        "%s: an open curve of '%s' needs %zu + %zu k control points (%zu, %zu, %zu, …), found %zu",
                        reason, name, width, step, width, width + step, width + 2 * step,
                        binding->lengths[direction]);
}

static bcifs_status direction_count(struct binding *binding, int direction)
{
    size_t length = binding->lengths[direction], width = binding->widths[direction],
           step = binding->steps[direction];
    bool closed = binding->directions[direction]->kind == FIGURE_CLOSED;
    if (closed ? length < 2 : length < width)
        return count_refuse(binding, direction, "too few points");
    if ((closed ? length : length - width) % step != 0)
        return count_refuse(binding, direction, "the points do not fit the step");
    binding->counts[direction] = closed ? length / step : (length - width) / step + 1;
    return BCIFS_OK;
}

/* The arguments of each piece: its own written ones, or intervals i, i+1, …. */
static bcifs_status direction_arguments(struct binding *binding, int direction, size_t *used_intervals)
{
    const struct syntax_figure_part *part = binding->directions[direction];
    const struct reference *reference = part->reference->target;
    size_t arity = reference->definition->argument_count, count = binding->counts[direction];
    bool closed = part->kind == FIGURE_CLOSED;
    for (size_t i = 1; i < count && (reference->arguments || arity == 0); i++)
        binding->keys[direction][i] = binding->keys[direction][0];
    if (reference->arguments || arity == 0)
        return BCIFS_OK;
    const struct syntax_figure_part *intervals = binding->intervals[(*used_intervals)++];
    size_t wanted = closed ? count : count + arity - 1, found = intervals->matrix->columns;
    if (found != wanted)
        return report_error(binding->report, binding->source, intervals->matrix->place,
                            "%zu piece%s of '%s' need%s %zu intervals, found %zu", count, count == 1 ? "" : "s",
                            part->reference->name, count == 1 ? "s" : "", wanted, found);
    struct value *values;
    bcifs_status status = matrix_values(binding, intervals->matrix, &values);
    for (size_t i = 0; i < count && status == BCIFS_OK; i++) {
        struct value *arguments = arena_new(arena_of(binding), arity, sizeof *arguments);
        if (!arguments)
            return report_memory(binding->report);
        for (size_t j = 0; j < arity; j++)
            arguments[j] = values[(i + j) % found];
        binding->keys[direction][i] = (struct state_key){reference->definition, arguments};
    }
    return status;
}

/* The first piece's state, from which Δ and m_a are read. */
static bcifs_status direction_first(struct binding *binding, int direction, size_t interval)
{
    const struct syntax_figure_part *part = binding->directions[direction];
    const struct reference *reference = part->reference->target;
    const struct definition *definition = reference->definition;
    size_t arity = definition->argument_count;
    struct state_key key = {definition, NULL};
    if (definition->kind != CELL_EDGE)
        return report_error(binding->report, binding->source, part->reference->place,
                            "a curve is made of edges; '%s' is not one (use 'piece' for cells)",
                            part->reference->name);
    if (reference->arguments) {
        bcifs_status status =
            reference_evaluate(&binding->figure->states.setting, arena_of(binding), reference,
                               binding->definition->module, NULL, &key);
        if (status)
            return status;
    } else if (arity > 0) {
        if (interval >= binding->interval_count)
            return report_error(binding->report, binding->source, part->place,
                                "'%s' takes %zu argument%s: give the figure 'intervals'", part->reference->name,
                                arity, arity == 1 ? "" : "s");
        const struct syntax_matrix *matrix = binding->intervals[interval]->matrix;
        if (matrix->rows != 1)
            return report_error(binding->report, binding->source, matrix->place, "intervals are one row");
        struct value *values;
        bcifs_status status = matrix_values(binding, matrix, &values);
        struct value *arguments = arena_new(arena_of(binding), arity, sizeof *arguments);
        if (status || !arguments)
            return status ? status : report_memory(binding->report);
        for (size_t j = 0; j < arity; j++)
            arguments[j] = values[j % matrix->columns];
        key.arguments = arguments;
    }
    binding->keys[direction] = arena_new(arena_of(binding), 1, sizeof **binding->keys);
    if (!binding->keys[direction])
        return report_memory(binding->report);
    binding->keys[direction][0] = key;
    return edge_measure(binding, key, part->place, &binding->widths[direction], &binding->steps[direction]);
}

static bcifs_status direction_bind(struct binding *binding, int direction, size_t *used_intervals)
{
    bcifs_status status = direction_count(binding, direction);
    if (status)
        return status;
    size_t count = binding->counts[direction];
    binding->keys[direction] =
        arena_grow(arena_of(binding), binding->keys[direction], 1, count, sizeof **binding->keys);
    if (!binding->keys[direction])
        return report_memory(binding->report);
    return direction_arguments(binding, direction, used_intervals);
}

static bcifs_status lengths_bind(struct binding *binding)
{
    size_t points = binding->figure->point_count;
    binding->lengths[0] = points;
    if (binding->direction_count == 1)
        return BCIFS_OK;
    const struct syntax_figure_part *size = binding->size;
    if (!size)
        return report_error(binding->report, binding->source, binding->definition->syntax->place,
                            "a surface needs 'size': rows and columns of its control grid");
    if (size->numbers[0] * size->numbers[1] != points)
        return report_error(binding->report, binding->source, size->place,
                            "a grid of %llu × %llu does not hold %zu points", (unsigned long long)size->numbers[0],
                            (unsigned long long)size->numbers[1], points);
    binding->lengths[0] = (size_t)size->numbers[0];
    binding->lengths[1] = (size_t)size->numbers[1];
    return BCIFS_OK;
}

/* The state of a surface's piece: the product of its directions'. */
static bcifs_status product_state(struct binding *binding, struct state_key a, struct state_key b,
                                  struct state_key *key)
{
    size_t count_a = a.definition->argument_count, count_b = b.definition->argument_count;
    struct value *arguments = arena_new(arena_of(binding), count_a + count_b, sizeof *arguments);
    if (!arguments)
        return report_memory(binding->report);
    for (size_t i = 0; i < count_a; i++)
        arguments[i] = a.arguments[i];
    for (size_t i = 0; i < count_b; i++)
        arguments[count_a + i] = b.arguments[i];
    *key = (struct state_key){automaton_product(binding->figure->automaton, a.definition, b.definition),
                              arguments};
    return BCIFS_OK;
}

/* One piece of a curve (j = 0) or surface. */
static bcifs_status grid_piece(struct binding *binding, size_t i, size_t j, struct piece *piece)
{
    bool surface = binding->direction_count == 2;
    struct state_key key = binding->keys[0][i];
    size_t width_b = surface ? binding->widths[1] : 1, length_b = surface ? binding->lengths[1] : 1;
    bcifs_status status = BCIFS_OK;
    if (surface)
        status = product_state(binding, key, binding->keys[1][j], &key);
    if (status == BCIFS_OK)
        status = states_intern(&binding->figure->states, key, &piece->state);
    size_t *indices = arena_new(arena_of(binding), binding->widths[0] * width_b, sizeof *indices);
    if (status || !indices)
        return status ? status : report_memory(binding->report);
    size_t found = binding->figure->states.states[piece->state].points;
    if (found != binding->widths[0] * width_b)
        return report_error(binding->report, binding->source, binding->directions[0]->place,
                            "piece %zu has %zu control points, the first has %zu",
                            i * (surface ? binding->counts[1] : 1) + j, found,
                            binding->widths[0] * width_b);
    for (size_t a = 0; a < binding->widths[0]; a++)
        for (size_t b = 0; b < width_b; b++) {
            size_t row = (i * binding->steps[0] + a) % binding->lengths[0];
            size_t column = surface ? (j * binding->steps[1] + b) % length_b : 0;
            indices[a * width_b + b] = row * length_b + column;
        }
    piece->indices = indices;
    return BCIFS_OK;
}

static bcifs_status grid_bind(struct binding *binding)
{
    bcifs_figure *figure = binding->figure;
    bcifs_status status = lengths_bind(binding);
    size_t interval = 0;
    for (int i = 0; i < (int)binding->direction_count && status == BCIFS_OK; i++)
        status = direction_bind(binding, i, &interval);
    if (status)
        return status;
    size_t columns = binding->direction_count == 2 ? binding->counts[1] : 1;
    figure->shape = binding->direction_count == 2 ? FIGURE_SURFACE : FIGURE_CURVE;
    figure->pieces = arena_new(arena_of(binding), binding->counts[0] * columns, sizeof *figure->pieces);
    if (!figure->pieces)
        return report_memory(binding->report);
    for (size_t i = 0; i < binding->counts[0]; i++)
        for (size_t j = 0; j < columns && status == BCIFS_OK; j++)
            status = grid_piece(binding, i, j, &figure->pieces[figure->piece_count++]);
    return status;
}

/* ---- Any other composition ----------------------------------------------------------------------------- */

static bcifs_status piece_indices(struct binding *binding, const struct syntax_figure_part *part, size_t points,
                                  struct piece *piece)
{
    if (part->number_count != points)
        return report_error(binding->report, binding->source, part->place,
                            "'%s' has %zu control points, found %zu indices", part->reference->name, points,
                            part->number_count);
    size_t *indices = arena_new(arena_of(binding), points, sizeof *indices);
    if (!indices)
        return report_memory(binding->report);
    for (size_t i = 0; i < points; i++) {
        if (part->numbers[i] >= binding->figure->point_count)
            return report_error(binding->report, binding->source, part->number_places[i],
                                "there is no point %llu; the figure has %zu, from 0",
                                (unsigned long long)part->numbers[i], binding->figure->point_count);
        indices[i] = (size_t)part->numbers[i];
    }
    piece->indices = indices;
    return BCIFS_OK;
}

static bcifs_status piece_bind(struct binding *binding, const struct syntax_figure_part *part,
                               struct piece *piece)
{
    struct states *states = &binding->figure->states;
    struct state_key key;
    bcifs_status status = reference_evaluate(&states->setting, arena_of(binding), part->reference->target,
                                             binding->definition->module, NULL, &key);
    if (status == BCIFS_OK)
        status = states_intern(states, key, &piece->state);
    if (status == BCIFS_OK)
        status = states_expand(states, piece->state);
    return status ? status : piece_indices(binding, part, states->states[piece->state].points, piece);
}

static bcifs_status pieces_bind(struct binding *binding)
{
    bcifs_figure *figure = binding->figure;
    const struct syntax_figure *syntax = binding->definition->syntax;
    figure->pieces = arena_new(arena_of(binding), binding->piece_parts, sizeof *figure->pieces);
    if (!figure->pieces)
        return report_memory(binding->report);
    const struct syntax_figure_part *first = NULL;
    for (size_t i = 0; i < syntax->part_count; i++) {
        const struct syntax_figure_part *part = syntax->parts[i];
        if (part->kind != FIGURE_PIECE)
            continue;
        enum cell_kind kind = part->reference->target->definition->kind;
        first = first ? first : part;
        if (kind == CELL_VERTEX || kind != first->reference->target->definition->kind)
            return report_error(binding->report, binding->source, part->place,
                                "the pieces of a figure are all edges, all faces or all cells");
        bcifs_status status = piece_bind(binding, part, &figure->pieces[figure->piece_count]);
        if (status)
            return status;
        figure->piece_count++;
        figure->shape = kind == CELL_EDGE   ? FIGURE_CURVE
                        : kind == CELL_CELL ? FIGURE_ATTRACTOR
                                            : FIGURE_SURFACE;
    }
    return BCIFS_OK;
}

/* ---- Chains -------------------------------------------------------------------------------------------- */

/* Adds sign · Π e_j, carried into the figure's control points, to `sums`. */
static void boundary_gather(const struct piece *piece, const struct cell_boundary *boundary, size_t j, bool minus,
                            struct value *sums)
{
    const struct value_matrix *operator = boundary->operator;
    for (size_t i = 0; i < operator->rows; i++) {
        struct value entry = operator->values[i * operator->columns + j];
        struct value *sum = &sums[piece->indices[i]];
        *sum = minus ? value_subtract(*sum, entry) : value_add(*sum, entry);
    }
}

static bool boundary_is_zero(const struct piece *piece, const struct cell *cell, struct value *sums)
{
    bool zero = true;
    for (size_t i = 0; i < cell->points; i++) {
        struct value *sum = &sums[piece->indices[i]];
        zero = zero && (sum->exact ? sum->residue == 0 : fabs(sum->real) <= TOLERANCE_EQUATION);
        *sum = value_from_integer(0);
    }
    return zero;
}

/* Whether the end of piece a is the start of piece b: same vertex state, same control points of the figure.
 * `sums` holds one zero for each control point, and does again afterwards. */
static bool pieces_meet(const bcifs_figure *figure, const struct piece *a, const struct piece *b,
                        struct value *sums)
{
    const struct state *state_a = &figure->states.states[a->state], *state_b = &figure->states.states[b->state];
    if (state_a->boundaries[1] != state_b->boundaries[0])
        return false;
    const struct cell_boundary *end = &state_a->cell->boundaries[1], *start = &state_b->cell->boundaries[0];
    bool meet = true;
    for (size_t j = 0; j < end->operator->columns; j++) {
        boundary_gather(a, end, j, false, sums);
        boundary_gather(b, start, j, true, sums);
        bool zero = boundary_is_zero(a, state_a->cell, sums);
        meet = boundary_is_zero(b, state_b->cell, sums) && zero && meet;
    }
    return meet;
}

static bcifs_status chains_bind(struct binding *binding)
{
    bcifs_figure *figure = binding->figure;
    struct value *sums = arena_new(arena_of(binding), figure->point_count, sizeof *sums);
    figure->chains = arena_new(arena_of(binding), figure->piece_count, sizeof *figure->chains);
    if (!sums || !figure->chains)
        return report_memory(binding->report);
    for (size_t i = 0; i < figure->point_count; i++)
        sums[i] = value_from_integer(0);
    for (size_t i = 0; i < figure->piece_count; i++) {
        bcifs_status status = states_expand(&figure->states, figure->pieces[i].state);
        if (status)
            return status;
        struct chain *last = figure->chain_count ? &figure->chains[figure->chain_count - 1] : NULL;
        if (last && pieces_meet(figure, &figure->pieces[i - 1], &figure->pieces[i], sums))
            last->count++;
        else
            figure->chains[figure->chain_count++] = (struct chain){i, 1, false};
    }
    for (size_t i = 0; i < figure->chain_count; i++) {
        struct chain *chain = &figure->chains[i];
        chain->closed = pieces_meet(figure, &figure->pieces[chain->first + chain->count - 1],
                                    &figure->pieces[chain->first], sums);
    }
    return BCIFS_OK;
}

/* An open or closed curve is one chain; that its pieces meet follows from the states' boundaries. */
static bcifs_status curve_check(const struct binding *binding)
{
    bcifs_figure *figure = binding->figure;
    const struct syntax_figure_part *part = binding->directions[0];
    if (figure->chain_count == 1 && (part->kind == FIGURE_OPEN || figure->chains[0].closed)) {
        figure->chains[0].closed = part->kind == FIGURE_CLOSED;
        return BCIFS_OK;
    }
    size_t piece = figure->chain_count > 1 ? figure->chains[1].first : 0;
    return report_error(binding->report, binding->source, part->place,
                        "piece %zu of the curve does not begin where the one before it ends: the end of '%s' and "
                        "its start must be the same vertex state on the control points that the pieces share",
                        piece, part->reference->name);
}

/* ---- Displacements ------------------------------------------------------------------------------------- */

static bcifs_status displacements_check(const struct binding *binding)
{
    const struct syntax_figure *syntax = binding->definition->syntax;
    for (size_t i = 0; i < syntax->part_count; i++) {
        const struct syntax_figure_part *part = syntax->parts[i];
        if (part->kind != FIGURE_DISPLACE)
            continue;
        size_t wanted = binding->direction_count == 2 ? 3 : 2;
        if (part->number_count != wanted)
            return report_error(binding->report, binding->source, part->place,
                                "displace takes a level and %s here", wanted == 3 ? "two indices" : "one index");
        if (part->matrix->rows != 1 || part->matrix->columns != binding->figure->dimension)
            return report_error(binding->report, binding->source, part->matrix->place,
                                "a displacement is one row of %u coordinates", binding->figure->dimension);
        struct value *values;
        bcifs_status status = matrix_values(binding, part->matrix, &values);
        if (status)
            return status;
    }
    return BCIFS_OK;
}

/* ---- The whole ----------------------------------------------------------------------------------------- */

/* The frame of a figure's pieces when they are affine and all of one dimension; 0 otherwise. */
static size_t affine_dimension(const struct syntax_figure *syntax)
{
    size_t dimension = 0;
    for (size_t i = 0; i < syntax->part_count; i++) {
        const struct syntax_reference *reference = syntax->parts[i]->reference;
        if (!reference)
            continue;
        const struct syntax_cell *cell = reference->target->definition->syntax;
        if (!cell || !cell->affine || (dimension && dimension != cell->dimension))
            return 0;
        dimension = (size_t)cell->dimension;
    }
    return dimension;
}

/* As many points as `pieces` pieces have: KΔ of a closed curve, KΔ + m_s of an open one. */
static bcifs_status pieces_unplaced(struct binding *binding, size_t pieces)
{
    size_t step = binding->steps[0], joint = binding->widths[0] - step;
    if (binding->direction_count != 1)
        return report_error(binding->report, binding->source, binding->definition->syntax->place,
                            "figure '%s' has its own pieces; their number is chosen for an open or closed curve",
                            binding->definition->name);
    if (pieces > (MOST_POINTS - joint) / step)
        return report_failure(binding->report, BCIFS_INPUT, NULL, "%zu pieces have more than %d control points",
                              pieces, MOST_POINTS);
    return points_unplaced(binding, pieces * step + (binding->directions[0]->kind == FIGURE_OPEN ? joint : 0));
}

static bcifs_status points_bind(struct binding *binding, const bcifs_figure_options *options)
{
    const struct syntax_figure_part *along = binding->direction_count == 1 ? binding->directions[0] : NULL;
    binding->points_given = options && (options->points || options->curve || options->pieces);
    if (options && options->pieces)
        return pieces_unplaced(binding, options->pieces);
    if (options && options->curve)
        return points_drawn(binding, options->curve, along && along->kind == FIGURE_CLOSED,
                            along && along->kind == FIGURE_OPEN);
    if (binding->points_given)
        return points_given(binding, options);
    if (binding->points)
        return points_written(binding, binding->points->matrix);
    size_t dimension = affine_dimension(binding->definition->syntax);
    if (dimension)
        return points_frame(binding, dimension);
    return report_error(binding->report, binding->source, binding->definition->syntax->place,
                        "figure '%s' has no points", binding->definition->name);
}

static bcifs_status written_figure(struct binding *binding, const bcifs_figure_options *options)
{
    bcifs_status status = parts_collect(binding);
    size_t interval = 0;
    for (int i = 0; i < (int)binding->direction_count && status == BCIFS_OK; i++) {
        status = direction_first(binding, i, interval);
        const struct reference *reference = binding->directions[i]->reference->target;
        interval += !reference->arguments && reference->definition->argument_count > 0;
    }
    if (status == BCIFS_OK && interval < binding->interval_count)
        status = report_error(binding->report, binding->source, binding->intervals[interval]->place,
                              "intervals are for states with arguments; this figure's have none");
    if (status == BCIFS_OK)
        status = points_bind(binding, options);
    if (status == BCIFS_OK)
        status = binding->direction_count ? grid_bind(binding) : pieces_bind(binding);
    if (status == BCIFS_OK && binding->figure->shape == FIGURE_CURVE)
        status = chains_bind(binding);
    if (status == BCIFS_OK && binding->figure->shape == FIGURE_CURVE && binding->direction_count)
        status = curve_check(binding);
    return status ? status : displacements_check(binding);
}

/* One piece in a state, on points of its own. */
static bcifs_status bare_figure(struct binding *binding, const struct definition *definition,
                                const bcifs_figure_options *options)
{
    bcifs_figure *figure = binding->figure;
    bcifs_status status = BCIFS_OK;
    figure->pieces = arena_new(arena_of(binding), 1, sizeof *figure->pieces);
    if (!figure->pieces)
        return report_memory(binding->report);
    if (definition->argument_count > 0)
        return report_failure(binding->report, BCIFS_INPUT, binding->source->name,
                              "the state '%s' takes arguments: put it in a figure", definition->name);
    if (definition->kind == CELL_VERTEX)
        return report_failure(binding->report, BCIFS_INPUT, binding->source->name,
                              "the state '%s' is a vertex; draw an edge or a cell", definition->name);
    status = states_intern(&figure->states, (struct state_key){definition, NULL}, &figure->pieces[0].state);
    if (status == BCIFS_OK)
        status = states_expand(&figure->states, figure->pieces[0].state);
    if (status)
        return status;
    size_t points = figure->states.states[figure->pieces[0].state].points;
    if (options && options->pieces > 1)
        status = report_failure(binding->report, BCIFS_INPUT, binding->source->name,
                                "the state '%s' on its own is one piece, not %zu", definition->name, options->pieces);
    else if (options && options->curve)
        status = points_drawn(binding, options->curve, false, definition->kind == CELL_EDGE);
    else if (options && options->points)
        status = points_given(binding, options);
    else if (options && (options->unplaced || options->pieces))
        status = points_unplaced(binding, points);
    else if (definition->syntax && definition->syntax->affine)
        status = points_frame(binding, points - 1);
    else
        status = report_failure(binding->report, BCIFS_INPUT, binding->source->name,
                                "the state '%s' needs %zu control points: give them with --points FILE",
                                definition->name, points);
    if (status == BCIFS_OK && figure->point_count != points)
        status = report_failure(binding->report, BCIFS_INPUT, binding->source->name,
                                "the state '%s' has %zu control points, found %zu", definition->name, points,
                                figure->point_count);
    size_t *indices = arena_new(arena_of(binding), points, sizeof *indices);
    if (status || !indices)
        return status ? status : report_memory(binding->report);
    for (size_t i = 0; i < points; i++)
        indices[i] = i;
    figure->pieces[0].indices = indices;
    figure->piece_count = 1;
    figure->shape = definition->kind == CELL_EDGE   ? FIGURE_CURVE
                    : definition->kind == CELL_CELL ? FIGURE_ATTRACTOR
                                                    : FIGURE_SURFACE;
    return figure->shape == FIGURE_CURVE ? chains_bind(binding) : BCIFS_OK;
}

static bcifs_status bare_definition(struct binding *binding, const bcifs_figure_options *options,
                                    const struct definition **found)
{
    const bcifs_automaton *automaton = binding->figure->automaton;
    const char *wanted = options ? options->state : NULL;
    enum { MOST = 256 };
    const char *candidates[MOST];
    size_t count = 0;
    for (size_t i = 0; i < automaton->definition_count; i++) {
        const struct definition *definition = automaton->definitions[i];
        if (wanted ? strcmp(definition->name, wanted) == 0
                   : definition->form == DEFINITION_WRITTEN && definition->syntax->affine) {
            *found = definition;
            return BCIFS_OK;
        }
        if (count < MOST)
            candidates[count++] = definition->name;
    }
    if (!wanted)
        return report_failure(binding->report, BCIFS_INPUT, binding->source->name,
                              "the file has no figure to draw: add one, or give --state and --points");
    const char *nearest = nearest_word(wanted, candidates, count);
    return report_failure(binding->report, BCIFS_INPUT, binding->source->name, "there is no state '%s'%s%s%s", wanted,
                          nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}

bcifs_status figure_bind(bcifs_figure *figure, const bcifs_automaton *automaton,
                         const struct figure_definition *definition, const bcifs_figure_options *options,
                         struct report *report)
{
    struct setting setting = {.automaton = automaton, .parameters = automaton->values, .report = report};
    struct binding binding = {.figure = figure,
                              .definition = definition,
                              .source = definition ? definition->module->source : automaton->modules[0]->source,
                              .report = report};
    figure->automaton = automaton;
    figure->name = definition ? definition->name : "";
    const struct definition *bare = NULL;
    bcifs_status status = states_create(&figure->states, &figure->arena, &setting);
    if (status == BCIFS_OK && definition)
        status = written_figure(&binding, options);
    else if (status == BCIFS_OK && (status = bare_definition(&binding, options, &bare)) == BCIFS_OK)
        status = bare_figure(&binding, bare, options);
    figure->states.setting.report = NULL; /* it does not outlive this call */
    return status;
}

const bcifs_automaton *figure_automaton(const bcifs_figure *figure)
{
    return figure->automaton;
}

bcifs_status states_of_figures(const bcifs_automaton *automaton, struct states *states, struct arena *arena)
{
    struct setting setting = {.automaton = automaton, .parameters = automaton->values};
    bcifs_status status = states_create(states, arena, &setting);
    for (size_t i = 0; i < automaton->definition_count && status == BCIFS_OK; i++) {
        const struct definition *definition = automaton->definitions[i];
        size_t index;
        if (definition->argument_count == 0)
            status = states_intern(states, (struct state_key){definition, NULL}, &index);
    }
    for (size_t i = 0; i < automaton->figure_count && status == BCIFS_OK; i++) {
        bcifs_figure figure = {0};
        struct report silent = report_new(NULL);
        status = figure_bind(&figure, automaton, &automaton->figures[i], NULL, &silent);
        for (size_t j = 0; j < figure.piece_count && status == BCIFS_OK; j++) {
            struct state_key key = figure.states.states[figure.pieces[j].state].key;
            size_t index, count = key.definition->argument_count;
            key.arguments = arena_grow(arena, key.arguments, count, count, sizeof *key.arguments);
            status = key.arguments ? states_intern(states, key, &index) : BCIFS_MEMORY;
        }
        arena_free(&figure.arena);
    }
    for (size_t i = 0; i < states->count && i < MOST_REACHED && status == BCIFS_OK; i++)
        status = states_expand(states, i);
    /* A state without numbers, or more states than the limit, is for evaluation to complain about. */
    return status == BCIFS_INPUT ? BCIFS_OK : status;
}

/* ---- The handle ---------------------------------------------------------------------------------------- */

static bcifs_status figure_choose(const bcifs_automaton *automaton, const bcifs_figure_options *options,
                                  struct report *report, const struct figure_definition **definition)
{
    *definition = automaton->figure_count ? &automaton->figures[0] : NULL;
    if (options && options->state)
        *definition = NULL;
    if (!options || !options->figure || options->state)
        return BCIFS_OK;
    enum { MOST = 256 };
    const char *candidates[MOST];
    size_t count = 0;
    for (size_t i = 0; i < automaton->figure_count; i++) {
        if (strcmp(automaton->figures[i].name, options->figure) == 0) {
            *definition = &automaton->figures[i];
            return BCIFS_OK;
        }
        if (count < MOST)
            candidates[count++] = automaton->figures[i].name;
    }
    const char *nearest = nearest_word(options->figure, candidates, count);
    return report_failure(report, BCIFS_INPUT, automaton->modules[0]->source->name,
                          "there is no figure '%s'%s%s%s", options->figure, nearest ? "; did you mean '" : "",
                          nearest ? nearest : "", nearest ? "'?" : "");
}

bcifs_status bcifs_figure_create(const bcifs_automaton *automaton, const bcifs_figure_options *options,
                                 bcifs_figure **figure, bcifs_error *error)
{
    struct report report = report_new(NULL);
    const struct figure_definition *definition;
    bcifs_figure *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? BCIFS_OK : report_memory(&report);
    if (status == BCIFS_OK && automaton->unknowns > 0)
        status = report_failure(&report, BCIFS_INPUT, automaton->modules[0]->source->name,
                                "the automaton has %zu unknown entr%s '?'; a figure needs them all",
                                automaton->unknowns, automaton->unknowns == 1 ? "y" : "ies");
    if (status == BCIFS_OK)
        status = figure_choose(automaton, options, &report, &definition);
    if (status == BCIFS_OK)
        status = figure_bind(fresh, automaton, definition, options, &report);
    if (status) {
        bcifs_figure_free(fresh);
        report_close(&report, error);
        return status;
    }
    *figure = fresh;
    return BCIFS_OK;
}

void bcifs_figure_free(bcifs_figure *figure)
{
    if (!figure)
        return;
    arena_free(&figure->arena);
    memory_free(figure);
}

const char *bcifs_figure_name(const bcifs_figure *figure)
{
    return figure->name;
}

unsigned bcifs_figure_dimension(const bcifs_figure *figure)
{
    return figure->dimension;
}

int bcifs_figure_is_attractor(const bcifs_figure *figure)
{
    return figure->shape == FIGURE_ATTRACTOR;
}
