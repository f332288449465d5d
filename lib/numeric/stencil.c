#include "stencil.h"

#include <string.h>

void stencil_begin(struct stencil *stencil, size_t width, struct arena *arena)
{
    *stencil = (struct stencil){.arena = arena, .width = width};
}

/* ---- Blocks -------------------------------------------------------------------------------------------- */

void stencil_block_begin(struct stencil *stencil, size_t column)
{
    stencil->block_template = stencil->template_count;
    stencil->block_weight = stencil->weight_count;
    stencil->block_column = column;
}

void stencil_row_add(struct stencil *stencil, ptrdiff_t column, const double *weights, size_t length)
{
    struct stencil_row row = {column - (ptrdiff_t)stencil->block_column, length, stencil->weight_count};
    for (size_t j = 0; j < length && !stencil->failed; j++) {
        if (!ARENA_RESERVE(stencil->arena, stencil->weights, stencil->weight_count, stencil->weight_capacity))
            stencil->failed = true;
        else
            stencil->weights[stencil->weight_count++] = weights[j];
    }
    if (stencil->failed || !ARENA_RESERVE(stencil->arena, stencil->templates, stencil->template_count,
                                          stencil->template_capacity))
        stencil->failed = true;
    else
        stencil->templates[stencil->template_count++] = row;
}

/* Whether the rows added since the block began are those of `run`. */
static bool block_equals(const struct stencil *stencil, const struct stencil_run *run)
{
    size_t height = stencil->template_count - stencil->block_template;
    if (height != run->height)
        return false;
    for (size_t r = 0; r < height; r++) {
        const struct stencil_row *a = &stencil->templates[run->first + r],
                                 *b = &stencil->templates[stencil->block_template + r];
        if (a->offset != b->offset || a->length != b->length ||
            memcmp(stencil->weights + a->first, stencil->weights + b->first, a->length * sizeof(double)) != 0)
            return false;
    }
    return true;
}

/* A run may grow by a block whose base is as far on as all before; its second block sets the step. */
static bool run_continues(const struct stencil *stencil, const struct stencil_run *run)
{
    if (stencil->block_column < stencil->last_column)
        return false;
    return (run->blocks == 1 || stencil->block_column - stencil->last_column == run->step) &&
           block_equals(stencil, run);
}

static void run_measure(const struct stencil *stencil, struct stencil_run *run)
{
    for (size_t r = 0; r < run->height; r++) {
        const struct stencil_row *row = &stencil->templates[run->first + r];
        ptrdiff_t end = row->offset + (ptrdiff_t)row->length;
        run->low = r == 0 || row->offset < run->low ? row->offset : run->low;
        run->high = r == 0 || end > run->high ? end : run->high;
    }
}

void stencil_block_end(struct stencil *stencil)
{
    if (stencil->failed)
        return;
    size_t height = stencil->template_count - stencil->block_template;
    struct stencil_run *last = stencil->run_count ? &stencil->runs[stencil->run_count - 1] : NULL;
    if (last && run_continues(stencil, last)) {
        last->step = stencil->block_column - stencil->last_column;
        last->blocks++;
        stencil->template_count = stencil->block_template;
        stencil->weight_count = stencil->block_weight;
    } else if (!ARENA_RESERVE(stencil->arena, stencil->runs, stencil->run_count, stencil->run_capacity)) {
        stencil->failed = true;
        return;
    } else {
        struct stencil_run run = {.row = stencil->rows,
                                  .column = stencil->block_column,
                                  .blocks = 1,
                                  .first = stencil->block_template,
                                  .height = height};
        run_measure(stencil, &run);
        stencil->runs[stencil->run_count++] = run;
    }
    stencil->last_column = stencil->block_column;
    stencil->rows += height;
}

void stencil_blocks_repeat(struct stencil *stencil, size_t count, size_t step)
{
    if (stencil->failed || count == 0)
        return;
    struct stencil_run *run = &stencil->runs[stencil->run_count - 1];
    if (run->blocks > 1 && run->step != step) {
        struct stencil_run fresh = *run;
        fresh.row = stencil->rows - run->height;
        fresh.column = stencil->last_column;
        fresh.blocks = 1;
        run->blocks--;
        if (!ARENA_RESERVE(stencil->arena, stencil->runs, stencil->run_count, stencil->run_capacity)) {
            stencil->failed = true;
            return;
        }
        stencil->runs[stencil->run_count++] = fresh;
        run = &stencil->runs[stencil->run_count - 1];
    }
    run->step = step;
    run->blocks += count;
    stencil->last_column += count * step;
    stencil->rows += count * run->height;
}

/* ---- Application --------------------------------------------------------------------------------------- */

/* The blocks of a run whose columns lie within 0 … width - 1 without wrapping: first <= k < last. */
static void run_inside(const struct stencil *stencil, const struct stencil_run *run, size_t *first, size_t *last)
{
    ptrdiff_t low = (ptrdiff_t)run->column + run->low, high = (ptrdiff_t)run->column + run->high,
              width = (ptrdiff_t)stencil->width, step = (ptrdiff_t)run->step, blocks = (ptrdiff_t)run->blocks;
    ptrdiff_t begin = low < 0 ? (step ? (-low + step - 1) / step : blocks) : 0;
    ptrdiff_t end = high > width ? 0 : step ? (width - high) / step + 1 : blocks;
    end = end < blocks ? end : blocks;
    begin = begin < end ? begin : end;
    *first = (size_t)begin;
    *last = (size_t)end;
}

static size_t column_wrap(ptrdiff_t column, size_t width)
{
    ptrdiff_t rest = column % (ptrdiff_t)width;
    return (size_t)(rest < 0 ? rest + (ptrdiff_t)width : rest);
}

/* y (+)= Σ_j w_j x_j for one row whose columns may wrap. */
static void row_apply_wrapped(const struct stencil *stencil, const struct stencil_row *row, size_t base,
                              const double *x, size_t components, bool add, double *y)
{
    const double *weights = stencil->weights + row->first;
    for (size_t c = 0; c < components && !add; c++)
        y[c] = 0;
    for (size_t j = 0; j < row->length; j++) {
        size_t column = column_wrap((ptrdiff_t)(base + j) + row->offset, stencil->width);
        for (size_t c = 0; c < components; c++)
            y[c] += weights[j] * x[column * components + c];
    }
}

/* The same for planar points, nothing wrapping; the compiler unrolls the common lengths. */
static inline void row_apply_planar(const double *weights, size_t length, const double *x, bool add, double *y)
{
    double u = 0, v = 0;
    for (size_t j = 0; j < length; j++) {
        u += weights[j] * x[2 * j];
        v += weights[j] * x[2 * j + 1];
    }
    y[0] = add ? y[0] + u : u;
    y[1] = add ? y[1] + v : v;
}

static void row_apply(const double *weights, size_t length, const double *x, size_t components, bool add, double *y)
{
    if (components == 2 && length == 2)
        row_apply_planar(weights, 2, x, add, y);
    else if (components == 2 && length == 4)
        row_apply_planar(weights, 4, x, add, y);
    else if (components == 2)
        row_apply_planar(weights, length, x, add, y);
    else
        for (size_t c = 0; c < components; c++) {
            double sum = add ? y[c] : 0;
            for (size_t j = 0; j < length; j++)
                sum += weights[j] * x[j * components + c];
            y[c] = sum;
        }
}

/* Row r of the blocks first … last - 1 of a run, which do not wrap. */
static void blocks_apply(const struct stencil *stencil, const struct stencil_run *run, size_t first, size_t last,
                         const double *x, size_t components, bool add, double *y)
{
    const struct stencil_row *rows = stencil->templates + run->first;
    for (size_t k = first; k < last; k++) {
        ptrdiff_t base = (ptrdiff_t)(run->column + k * run->step);
        double *out = y + (run->row + k * run->height) * components;
        for (size_t r = 0; r < run->height; r++)
            row_apply(stencil->weights + rows[r].first, rows[r].length,
                      x + (base + rows[r].offset) * (ptrdiff_t)components, components, add, out + r * components);
    }
}

static void blocks_apply_wrapped(const struct stencil *stencil, const struct stencil_run *run, size_t first,
                                 size_t last, const double *x, size_t components, bool add, double *y)
{
    for (size_t k = first; k < last; k++)
        for (size_t r = 0; r < run->height; r++)
            row_apply_wrapped(stencil, &stencil->templates[run->first + r], run->column + k * run->step, x,
                              components, add, y + (run->row + k * run->height + r) * components);
}

void stencil_apply(const struct stencil *stencil, const double *x, size_t components, bool add, double *y)
{
    for (size_t i = 0; i < stencil->run_count; i++) {
        const struct stencil_run *run = &stencil->runs[i];
        size_t first, last;
        run_inside(stencil, run, &first, &last);
        blocks_apply_wrapped(stencil, run, 0, first, x, components, add, y);
        blocks_apply(stencil, run, first, last, x, components, add, y);
        blocks_apply_wrapped(stencil, run, last, run->blocks, x, components, add, y);
    }
}

void stencil_apply_transposed(const struct stencil *stencil, const double *x, size_t components, double *y)
{
    for (size_t i = 0; i < stencil->run_count; i++) {
        const struct stencil_run *run = &stencil->runs[i];
        size_t first, last;
        run_inside(stencil, run, &first, &last);
        for (size_t k = 0; k < run->blocks; k++)
            for (size_t r = 0; r < run->height; r++) {
                const struct stencil_row *row = &stencil->templates[run->first + r];
                const double *weights = stencil->weights + row->first,
                             *in = x + (run->row + k * run->height + r) * components;
                ptrdiff_t column = (ptrdiff_t)(run->column + k * run->step) + row->offset;
                bool wraps = k < first || k >= last;
                if (components == 2 && !wraps) {
                    double *out = y + 2 * column;
                    for (size_t j = 0; j < row->length; j++) {
                        out[2 * j] += weights[j] * in[0];
                        out[2 * j + 1] += weights[j] * in[1];
                    }
                    continue;
                }
                for (size_t j = 0; j < row->length; j++) {
                    size_t place = wraps ? column_wrap(column + (ptrdiff_t)j, stencil->width)
                                         : (size_t)column + j;
                    for (size_t c = 0; c < components; c++)
                        y[place * components + c] += weights[j] * in[c];
                }
            }
    }
}

bool stencil_sparse(const struct stencil *stencil, struct sparse *sparse, struct arena *arena)
{
    size_t count = 0, filled = 0;
    for (size_t i = 0; i < stencil->run_count; i++)
        for (size_t r = 0; r < stencil->runs[i].height; r++)
            count += stencil->runs[i].blocks * stencil->templates[stencil->runs[i].first + r].length;
    struct triple *triples = memory_new(count, sizeof *triples);
    if (!triples)
        return false;
    for (size_t i = 0; i < stencil->run_count; i++) {
        const struct stencil_run *run = &stencil->runs[i];
        for (size_t k = 0; k < run->blocks; k++)
            for (size_t r = 0; r < run->height; r++) {
                const struct stencil_row *row = &stencil->templates[run->first + r];
                ptrdiff_t column = (ptrdiff_t)(run->column + k * run->step) + row->offset;
                for (size_t j = 0; j < row->length; j++)
                    triples[filled++] =
                        (struct triple){run->row + k * run->height + r,
                                        column_wrap(column + (ptrdiff_t)j, stencil->width),
                                        stencil->weights[row->first + j]};
            }
    }
    bool made = sparse_from_triples(sparse, stencil->rows, stencil->width, triples, filled, arena);
    memory_free(triples);
    return made;
}
