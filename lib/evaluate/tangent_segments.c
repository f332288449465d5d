/* Half-tangents of a figure as short segments to be drawn: bcifs_analysis_segments, see bcifs.h. */
#include <math.h>
#include <string.h>

#include "analysis/analysis.h"
#include "evaluate/plan.h"
#include "numeric/matrix.h"

enum { DEEPEST_LEVEL = 24, MOST_CELLS = 1 << 14 };

/* The segments under way. The matrices of a descent live in `arena`, one for each level. */
struct drawing {
    const struct bcifs_analysis *analysis;
    const bcifs_figure *figure;
    struct arena arena;
    struct states states; /* the analysis' own, with the figure's pieces added */
    double *matrices[DEEPEST_LEVEL + 1];
    double length; /* of a segment */
    double *segments;
    size_t count, capacity;
    unsigned level;
    struct report *report;
};

/* Relative to the figure, so that the picture scales with it: a twentieth of its control points' box. */
static double segment_length(const bcifs_figure *figure)
{
    double square = 0;
    for (unsigned c = 0; c < figure->dimension; c++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < figure->point_count; i++) {
            low = fmin(low, figure->points[i * figure->dimension + c]);
            high = fmax(high, figure->points[i * figure->dimension + c]);
        }
        square += (high - low) * (high - low);
    }
    return sqrt(square) / 20;
}

/* From H(0) forward, to H(1) from behind. A direction that the control points flatten to nothing draws nothing. */
static bcifs_status segment_add(struct drawing *drawing, const double *matrix, const struct half_tangent *half,
                                size_t points, int side)
{
    unsigned dimension = drawing->figure->dimension;
    double point[16], direction[16], length = 0;
    if (!half->direction)
        return BCIFS_OK;
    matrix_multiply(matrix, half->point, dimension, points, 1, point);
    matrix_multiply(matrix, half->direction, dimension, points, 1, direction);
    for (unsigned c = 0; c < dimension; c++)
        length += direction[c] * direction[c];
    length = sqrt(length);
    if (!(length > 0) || !isfinite(length))
        return BCIFS_OK;
    if (drawing->count == 2 * MOST_CELLS)
        return report_failure(drawing->report, BCIFS_INPUT, NULL, "more than %d half-tangents; lower the level",
                              2 * MOST_CELLS);
    if (drawing->count == drawing->capacity) {
        size_t capacity = drawing->capacity ? 2 * drawing->capacity : 64;
        double *segments = memory_resize(drawing->segments, capacity * 2 * dimension, sizeof *segments);
        if (!segments)
            return report_memory(drawing->report);
        drawing->segments = segments;
        drawing->capacity = capacity;
    }
    double *segment = drawing->segments + drawing->count++ * 2 * dimension;
    for (unsigned c = 0; c < dimension; c++) {
        double step = direction[c] / length * drawing->length;
        segment[c] = side ? point[c] - step : point[c];
        segment[dimension + c] = side ? point[c] : point[c] + step;
    }
    return BCIFS_OK;
}

/* Every cell `left` levels below a state with the control matrix at `height`; the depth is bounded. */
static bcifs_status cells_draw(struct drawing *drawing, size_t index, unsigned height)
{
    const struct state *state = &drawing->states.states[index];
    const double *matrix = drawing->matrices[height];
    bcifs_status status = BCIFS_OK;
    if (height == drawing->level) {
        const struct arc_tangents *arc = tangents_of(&drawing->analysis->tangents, index);
        for (int side = 0; side < 2 && arc && status == BCIFS_OK; side++)
            status = segment_add(drawing, matrix, &arc->ends[side], state->points, side);
        return status;
    }
    for (size_t i = 0; i < state->cell->child_count && status == BCIFS_OK; i++) {
        size_t child = state->children[i];
        matrix_multiply(matrix, state->maps[i], drawing->figure->dimension, state->points,
                        drawing->states.states[child].points, drawing->matrices[height + 1]);
        status = cells_draw(drawing, child, height + 1);
    }
    return status;
}

static bcifs_status pieces_draw(struct drawing *drawing)
{
    const bcifs_figure *figure = drawing->figure;
    size_t largest = 0;
    for (size_t i = 0; i < drawing->states.count; i++)
        largest = drawing->states.states[i].points > largest ? drawing->states.states[i].points : largest;
    for (unsigned h = 0; h <= drawing->level; h++) {
        drawing->matrices[h] = arena_new(&drawing->arena, largest * figure->dimension, sizeof(double));
        if (!drawing->matrices[h])
            return report_memory(drawing->report);
    }
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < figure->piece_count && status == BCIFS_OK; i++) {
        size_t index;
        struct state_key key = figure->states.states[figure->pieces[i].state].key;
        status = states_intern(&drawing->states, key, &index);
        if (status == BCIFS_OK && !tangents_of(&drawing->analysis->tangents, index))
            status = report_failure(drawing->report, BCIFS_INPUT, NULL, "the figure is not the analysis' own");
        if (status)
            break;
        piece_gather(figure, &figure->pieces[i], drawing->states.states[index].points, drawing->matrices[0]);
        status = cells_draw(drawing, index, 0);
    }
    return status;
}

bcifs_status bcifs_analysis_segments(const bcifs_analysis *analysis, const bcifs_figure *figure, unsigned level,
                                     double **segments, size_t *count, bcifs_error *error)
{
    struct report report = report_new(NULL);
    struct drawing drawing = {.analysis = analysis,
                              .figure = figure,
                              .length = segment_length(figure),
                              .level = level,
                              .report = &report};
    bcifs_status status = BCIFS_OK;
    if (figure->shape != FIGURE_CURVE || figure->dimension < 2)
        status = report_failure(&report, BCIFS_INPUT, NULL, "half-tangents are drawn for curves in the plane or in space; '%s' is none",
                                figure->name);
    else if (level > DEEPEST_LEVEL)
        status = report_failure(&report, BCIFS_INPUT, NULL, "the level must be at most %d, found %u", DEEPEST_LEVEL,
                                level);
    if (status == BCIFS_OK)
        status = states_copy(&drawing.states, &analysis->states, &drawing.arena, &report);
    if (status == BCIFS_OK)
        status = pieces_draw(&drawing);
    arena_free(&drawing.arena);
    if (status) {
        memory_free(drawing.segments);
        report_close(&report, error);
        return status;
    }
    *segments = drawing.segments;
    *count = drawing.count;
    return BCIFS_OK;
}
