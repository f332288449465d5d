#include "blending.h"

#include <math.h>

/* ---- The table ----------------------------------------------------------------------------------------- */

/* How many limit points there are, and most control points of a piece. */
static bcifs_status size_find(struct blending *blending, const bcifs_figure *figure, unsigned depth,
                              struct report *report)
{
    const bcifs_view view = {.depth = depth, .show = BCIFS_LIMIT, .to = 1};
    bcifs_plan *plan;
    bcifs_error error;
    bcifs_status status = bcifs_plan_create(figure, &view, &plan, &error);
    if (status)
        return report_failure(report, status, NULL, "%s", error.message);
    uint64_t rows = bcifs_plan_points(plan);
    bcifs_plan_free(plan);
    blending->width = 0;
    for (size_t i = 0; i < figure->piece_count; i++) {
        size_t points = figure->states.states[figure->pieces[i].state].points;
        blending->width = points > blending->width ? points : blending->width;
    }
    if (rows > BLENDING_MOST_NUMBERS / blending->width)
        return report_failure(
            report, BCIFS_INPUT, NULL,
            "the blending functions at depth %u are more than %d numbers; choose a smaller depth", depth,
            BLENDING_MOST_NUMBERS);
    blending->rows = (size_t)rows;
    return BCIFS_OK;
}

static bcifs_status rows_fill(const struct blending *blending, struct basis *basis, double *t,
                              uint32_t *indices, double *values, struct report *report)
{
    struct basis_row row;
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < blending->rows && basis_next(basis, &row, &status); i++) {
        t[i] = row.t;
        for (size_t j = 0; j < row.count; j++) {
            indices[i * blending->width + j] = (uint32_t)row.functions[j];
            values[i * blending->width + j] = row.values[j];
            if (!isfinite(row.values[j]))
                return report_failure(
                    report, BCIFS_INPUT, NULL,
                    "a blending function is not finite; the automaton may not be contractive");
        }
    }
    return status;
}

bcifs_status blending_create(struct blending *blending, const bcifs_figure *figure, unsigned depth,
                             struct arena *arena, struct report *report)
{
    const bcifs_basis_view view = {.depth = depth, .level = 0};
    struct basis basis;
    *blending = (struct blending){.functions = figure->point_count};
    bcifs_status status = size_find(blending, figure, depth, report);
    if (status)
        return status;
    blending->closed = figure->chains[0].closed;
    blending->segments = blending->rows - !blending->closed;
    double *t = arena_new(arena, blending->rows, sizeof *t);
    uint32_t *indices = arena_new(arena, blending->rows * blending->width, sizeof *indices);
    double *values = arena_new(arena, blending->rows * blending->width, sizeof *values);
    if (!t || !indices || !values)
        return report_memory(report);
    status = basis_open(&basis, figure, &view, report);
    if (status)
        return status;
    status = rows_fill(blending, &basis, t, indices, values, report);
    basis_close(&basis);
    blending->t = t;
    blending->indices = indices;
    blending->values = values;
    return status;
}

/* ---- Positions ----------------------------------------------------------------------------------------- */

double blending_position(const struct blending *blending, double t)
{
    size_t low = 0, high = blending->segments;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        *(blending->t[middle] <= t ? &low : &high) = middle;
    }
    double from = blending->t[low], to = high < blending->rows ? blending->t[high] : 1;
    double share = to > from ? (t - from) / (to - from) : 0;
    return (double)low + fmin(1, fmax(0, share));
}

void blending_segment(const struct blending *blending, double position, size_t *from, size_t *to,
                      double *share)
{
    double whole = (double)blending->segments;
    if (blending->closed)
        position -= whole * floor(position / whole);
    position = fmin(fmax(position, 0), whole);
    double below = fmin(floor(position), whole - 1);
    *from = (size_t)below;
    *to = (*from + 1) % blending->rows;
    *share = position - below;
}

size_t blending_row(const struct blending *blending, double position, struct blending_entry *row)
{
    size_t ends[2], count = 0;
    double shares[2];
    blending_segment(blending, position, &ends[0], &ends[1], &shares[1]);
    shares[0] = 1 - shares[1];
    for (int end = 0; end < 2; end++)
        for (size_t j = 0; j < blending->width; j++) {
            size_t at = ends[end] * blending->width + j, place = count;
            struct blending_entry entry = {blending->indices[at], shares[end] * blending->values[at]};
            while (place > 0 && row[place - 1].function > entry.function)
                place--;
            if (entry.value == 0)
                continue;
            if (place > 0 && row[place - 1].function == entry.function) {
                row[place - 1].value += entry.value;
                continue;
            }
            for (size_t i = count++; i > place; i--)
                row[i] = row[i - 1];
            row[place] = entry;
        }
    return count;
}

void blending_polyline(const struct blending *blending, const double *x, unsigned dimension, double *polyline)
{
    for (size_t i = 0; i < blending->rows; i++)
        for (unsigned k = 0; k < dimension; k++) {
            double sum = 0;
            for (size_t j = i * blending->width; j < (i + 1) * blending->width; j++)
                sum += blending->values[j] * x[blending->indices[j] * dimension + k];
            polyline[i * dimension + k] = sum;
        }
}
