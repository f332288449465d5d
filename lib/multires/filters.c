#include "filters.h"

#include <math.h>
#include <string.h>

#include "automaton/levels.h"
#include "multires/complement.h"
#include "numeric/minimum_norm.h"
#include "numeric/tolerance.h"

/* A filter: weights at the fine points first … first + length - 1, for the coarse point (or detail) 0. */
struct filter {
    ptrdiff_t first;
    size_t length;
    double *weights;
};

/* Everything about the one block that P repeats, on an infinite curve: row h i + r of P begins at column i + offset. */
struct block_pattern {
    const struct stencil *refinement;
    size_t height;           /* fine points of a block, N */
    struct filter column;    /* column 0 of P */
    struct filter *details;  /* B: height - 1 filters for the block 0 */
    size_t detail_count;
};

enum { LONGEST = 96 /* support of a filter that is looked for */ };

/* ---- The pattern --------------------------------------------------------------------------------------- */

/* Whether P is one run of blocks, each one column further. */
static bool pattern_repeats(const struct stencil *refinement)
{
    const struct stencil_run *run = refinement->runs;
    return refinement->run_count == 1 && run->blocks == refinement->width &&
           (run->blocks == 1 || run->step == 1) && run->height > 1 && run->height * run->blocks == refinement->rows;
}

/* P[row][column] on the infinite curve. */
static double pattern_entry(const struct block_pattern *pattern, ptrdiff_t row, ptrdiff_t column)
{
    ptrdiff_t height = (ptrdiff_t)pattern->height, block = row >= 0 ? row / height : -((-row + height - 1) / height);
    const struct stencil *refinement = pattern->refinement;
    const struct stencil_row *template = &refinement->templates[refinement->runs[0].first +
                                                                (size_t)(row - block * height)];
    ptrdiff_t place = column - (block + (ptrdiff_t)refinement->runs[0].column + template->offset);
    return place >= 0 && place < (ptrdiff_t)template->length ? refinement->weights[template->first + (size_t)place] : 0;
}

/* Column 0 of P: from the first to the last row where it is not zero. */
static bool pattern_column(struct block_pattern *pattern, struct arena *arena)
{
    const struct stencil_run *run = pattern->refinement->runs;
    ptrdiff_t height = (ptrdiff_t)pattern->height, base = (ptrdiff_t)run->column,
              low = -(base + run->high) * height, high = (1 - base - run->low) * height;
    while (low < high && pattern_entry(pattern, low, 0) == 0)
        low++;
    while (high > low && pattern_entry(pattern, high - 1, 0) == 0)
        high--;
    if (low == high)
        return true;
    pattern->column = (struct filter){low, (size_t)(high - low), arena_new(arena, (size_t)(high - low), sizeof(double))};
    for (ptrdiff_t row = low; pattern->column.weights && row < high; row++)
        pattern->column.weights[row - low] = pattern_entry(pattern, row, 0);
    return pattern->column.weights != NULL;
}

/* B, from the complement of a long closed curve: its vectors do not see the curve's length. */
static bcifs_status pattern_details(struct block_pattern *pattern, struct arena *arena, bool *found)
{
    const struct stencil *refinement = pattern->refinement;
    const struct stencil_run *run = refinement->runs;
    struct stencil longer, details;
    size_t blocks = 8 * (size_t)(run->high - run->low) + 8, middle;
    stencil_begin(&longer, blocks, arena);
    stencil_block_begin(&longer, run->column);
    for (size_t r = 0; r < run->height; r++) {
        const struct stencil_row *row = &refinement->templates[run->first + r];
        stencil_row_add(&longer, (ptrdiff_t)run->column + row->offset, refinement->weights + row->first, row->length);
    }
    stencil_block_end(&longer);
    stencil_blocks_repeat(&longer, blocks - 1, 1);
    bcifs_status status = longer.failed ? BCIFS_MEMORY : complement_find(&longer, true, arena, &details, found);
    *found = *found && status == BCIFS_OK && details.run_count == 1 && details.runs[0].height + 1 == run->height;
    if (status || !*found)
        return status;
    pattern->detail_count = details.runs[0].height;
    pattern->details = arena_new(arena, pattern->detail_count, sizeof *pattern->details);
    middle = details.runs[0].first;
    for (size_t i = 0; pattern->details && i < pattern->detail_count; i++) {
        const struct stencil_row *row = &details.templates[middle + i];
        pattern->details[i] = (struct filter){row->offset, row->length, details.weights + row->first};
    }
    return pattern->details ? BCIFS_OK : BCIFS_MEMORY;
}

/* ---- Solving for a filter ------------------------------------------------------------------------------ */

/* Room for the equations of a filter of at most LONGEST taps. */
struct equations {
    double *g, *b;
    size_t rows, capacity;
};

static void equation_add(struct equations *equations, const double *row, size_t length, double right)
{
    if (equations->rows == equations->capacity)
        return;
    memcpy(equations->g + equations->rows * length, row, length * sizeof *row);
    equations->b[equations->rows++] = right;
}

/* a with Σ_f a_f P[f][c] = [c = 0] for all c, on the fine points first … first + length - 1. */
static bool smooth_try(const struct block_pattern *pattern, struct equations *equations, struct filter *smooth)
{
    ptrdiff_t height = (ptrdiff_t)pattern->height, end = smooth->first + (ptrdiff_t)smooth->length;
    ptrdiff_t low = (smooth->first - pattern->column.first - (ptrdiff_t)pattern->column.length) / height - 2,
              high = (end - pattern->column.first) / height + 2;
    double row[LONGEST];
    equations->rows = 0;
    for (ptrdiff_t c = low; c <= high; c++) {
        bool touched = c == 0;
        for (size_t j = 0; j < smooth->length; j++) {
            row[j] = pattern_entry(pattern, smooth->first + (ptrdiff_t)j, c);
            touched = touched || row[j] != 0;
        }
        if (touched)
            equation_add(equations, row, smooth->length, c == 0);
    }
    return minimum_norm_solve(equations->g, equations->b, equations->rows, smooth->length, smooth->weights);
}

static double absolute_sum(const struct filter *filter)
{
    double sum = 0;
    for (size_t j = 0; j < filter->length; j++)
        sum += fabs(filter->weights[j]);
    return sum;
}

/* A: the shortest, centered on column 0 of P, that amplifies hardly more than longer ones. Coefficients grow by Σ|a| a
 * level, and what they grow by is lost to rounding; a few more taps can save a digit (quintic splines: 10 with 5 taps,
 * 6 with 9), and beyond twice the length of the column there is nothing to gain. */
static bool smooth_find(const struct block_pattern *pattern, struct equations *equations, struct filter *smooth)
{
    const double near = 1.25;
    size_t least = pattern->column.length % 2 ? 1 : 2, most = 2 * pattern->column.length + 1, best = 0;
    double bound = INFINITY;
    for (int pass = 0; pass < 2; pass++)
        for (size_t length = least; length <= (best && best > most ? best : LONGEST); length += 2) {
            if (pass == 0 && best && length > most)
                break;
            smooth->length = length;
            smooth->first =
                pattern->column.first + ((ptrdiff_t)pattern->column.length - (ptrdiff_t)length) / 2;
            if (!smooth_try(pattern, equations, smooth))
                continue;
            best = length;
            if (pass == 1 && absolute_sum(smooth) <= near * bound)
                return true;
            bound = fmin(bound, absolute_sum(smooth));
        }
    return false;
}

/* The row Σ_f w_f q_f = right, with `filter` moved on by `shift` fine points; nothing when they do not overlap. */
static void overlap_add(struct equations *equations, const struct filter *filter, ptrdiff_t shift,
                        const struct filter *wavelet, double right)
{
    double row[LONGEST];
    bool touched = right != 0;
    for (size_t j = 0; j < wavelet->length; j++) {
        ptrdiff_t place = wavelet->first + (ptrdiff_t)j - shift - filter->first;
        bool inside = place >= 0 && place < (ptrdiff_t)filter->length;
        row[j] = inside ? filter->weights[place] : 0;
        touched = touched || inside;
    }
    if (touched)
        equation_add(equations, row, wavelet->length, right);
}

/* q with A·q = 0 and B·q the unit vector of detail `which`, on the given support. */
static bool wavelet_try(const struct block_pattern *pattern, const struct filter *smooth, size_t which,
                        struct equations *equations, struct filter *wavelet)
{
    ptrdiff_t height = (ptrdiff_t)pattern->height, reach = 2 * LONGEST / height + 2;
    equations->rows = 0;
    for (ptrdiff_t c = -reach; c <= reach; c++) {
        overlap_add(equations, smooth, c * height, wavelet, 0);
        for (size_t k = 0; k < pattern->detail_count; k++)
            overlap_add(equations, &pattern->details[k], c * height, wavelet, c == 0 && k == which);
    }
    return minimum_norm_solve(equations->g, equations->b, equations->rows, wavelet->length, wavelet->weights);
}

static bool wavelet_find(const struct block_pattern *pattern, const struct filter *smooth, size_t which,
                         struct equations *equations, struct filter *wavelet)
{
    const struct filter *detail = &pattern->details[which];
    for (size_t length = 1; length <= LONGEST; length++) {
        wavelet->length = length;
        wavelet->first = detail->first + ((ptrdiff_t)detail->length - (ptrdiff_t)length) / 2;
        if (wavelet_try(pattern, smooth, which, equations, wavelet))
            return true;
    }
    return false;
}

/* ---- Filters of one curve ------------------------------------------------------------------------------ */

/* One block a coarse point: the filters, moved on by the block's fine points. */
static void filters_spread(const struct stencil *refinement, const struct filter *filters, size_t count,
                           ptrdiff_t shift, struct arena *arena, struct stencil *stencil)
{
    size_t height = refinement->runs[0].height, blocks = refinement->runs[0].blocks;
    stencil_begin(stencil, refinement->rows, arena);
    stencil_block_begin(stencil, 0);
    for (size_t i = 0; i < count; i++)
        stencil_row_add(stencil, filters[i].first + shift, filters[i].weights, filters[i].length);
    stencil_block_end(stencil);
    stencil_blocks_repeat(stencil, blocks - 1, height);
}

/* Q row by row: fine point r of block 0 takes from the details whose filters reach it. The filters of one block are
 * `count` columns; the blocks that reach r are next to each other. */
static void synthesis_row(const struct filter *wavelets, size_t count, ptrdiff_t height, ptrdiff_t r, double *row,
                          struct stencil *synthesis)
{
    ptrdiff_t low = PTRDIFF_MAX, high = PTRDIFF_MIN; /* blocks i: r = first + height·i + j, 0 <= j < length */
    for (size_t k = 0; k < count; k++) {
        ptrdiff_t last = r - wavelets[k].first, first = last - (ptrdiff_t)wavelets[k].length + 1;
        ptrdiff_t from = first >= 0 ? (first + height - 1) / height : -(-first / height),
                  to = last >= 0 ? last / height : -((-last + height - 1) / height);
        low = from < low ? from : low;
        high = to > high ? to : high;
    }
    size_t length = low <= high ? (size_t)(high - low + 1) * count : 0;
    for (size_t c = 0; c < length; c++) {
        ptrdiff_t place = r - (low + (ptrdiff_t)(c / count)) * height - wavelets[c % count].first;
        bool inside = place >= 0 && place < (ptrdiff_t)wavelets[c % count].length;
        row[c] = inside ? wavelets[c % count].weights[place] : 0;
    }
    stencil_row_add(synthesis, low * (ptrdiff_t)count, row, length);
}

static bcifs_status synthesis_spread(const struct stencil *refinement, const struct filter *wavelets, size_t count,
                                     struct arena *arena, struct stencil *synthesis)
{
    size_t height = refinement->runs[0].height, blocks = refinement->runs[0].blocks, room = 2 * count;
    ptrdiff_t low = 0, high = 0;
    for (size_t k = 0; k < count; k++) {
        low = wavelets[k].first < low ? wavelets[k].first : low;
        high = wavelets[k].first + (ptrdiff_t)wavelets[k].length > high
                   ? wavelets[k].first + (ptrdiff_t)wavelets[k].length
                   : high;
    }
    room += ((size_t)(high - low) / height + 2) * count;
    double *row = arena_new(arena, room, sizeof *row);
    if (!row)
        return BCIFS_MEMORY;
    stencil_begin(synthesis, blocks * count, arena);
    stencil_block_begin(synthesis, 0);
    for (size_t r = 0; r < height; r++)
        synthesis_row(wavelets, count, (ptrdiff_t)height, (ptrdiff_t)r, row, synthesis);
    stencil_block_end(synthesis);
    stencil_blocks_repeat(synthesis, blocks - 1, count);
    return synthesis->failed ? BCIFS_MEMORY : BCIFS_OK;
}

static bcifs_status filters_build(const struct block_pattern *pattern, const struct filter *smooth,
                                  const struct filter *wavelets, struct arena *arena, struct filters *filters)
{
    const struct stencil *refinement = pattern->refinement;
    filters_spread(refinement, smooth, 1, 0, arena, &filters->smooth);
    filters_spread(refinement, pattern->details, pattern->detail_count, 0, arena, &filters->detail);
    filters_spread(refinement, wavelets, pattern->detail_count, 0, arena, &filters->wavelet);
    bool failed = filters->smooth.failed || filters->detail.failed || filters->wavelet.failed;
    return failed ? BCIFS_MEMORY
                  : synthesis_spread(refinement, wavelets, pattern->detail_count, arena, &filters->synthesis);
}

/* Details as long as the coefficients they go with: B is scaled to the norm of A. */
static void details_scale(struct block_pattern *pattern, const struct filter *smooth)
{
    double norm = 0;
    for (size_t j = 0; j < smooth->length; j++)
        norm += smooth->weights[j] * smooth->weights[j];
    for (size_t k = 0; k < pattern->detail_count; k++)
        for (size_t j = 0; j < pattern->details[k].length; j++)
            pattern->details[k].weights[j] *= sqrt(norm);
}

static bcifs_status equations_new(struct block_pattern *pattern, struct arena *arena, struct equations *equations)
{
    equations->capacity = (4 * LONGEST / pattern->height + 6) * pattern->height;
    equations->g = arena_new(arena, equations->capacity * LONGEST, sizeof *equations->g);
    equations->b = arena_new(arena, equations->capacity, sizeof *equations->b);
    return equations->g && equations->b ? BCIFS_OK : BCIFS_MEMORY;
}

/* Q for the pattern's A and B. */
static bcifs_status wavelets_find(const struct block_pattern *pattern, const struct filter *smooth,
                                  struct equations *equations, struct arena *arena, struct filter **wavelets,
                                  bool *found)
{
    *wavelets = arena_new(arena, pattern->detail_count, sizeof **wavelets);
    for (size_t k = 0; *wavelets && *found && k < pattern->detail_count; k++) {
        (*wavelets)[k].weights = arena_new(arena, LONGEST, sizeof(double));
        if (!(*wavelets)[k].weights)
            return BCIFS_MEMORY;
        *found = wavelet_find(pattern, smooth, k, equations, &(*wavelets)[k]);
    }
    return *wavelets ? BCIFS_OK : BCIFS_MEMORY;
}

static bcifs_status pattern_open(const struct stencil *refinement, struct arena *arena, struct block_pattern *pattern,
                                 struct equations *equations)
{
    *pattern = (struct block_pattern){.refinement = refinement, .height = refinement->runs[0].height};
    if (!pattern_column(pattern, arena))
        return BCIFS_MEMORY;
    return equations_new(pattern, arena, equations);
}

bcifs_status filters_derive(const struct stencil *refinement, struct arena *arena, struct filters *filters, bool *found)
{
    struct block_pattern pattern;
    struct equations equations;
    struct filter smooth = {0}, *wavelets;
    *found = pattern_repeats(refinement);
    if (!*found)
        return BCIFS_OK;
    bcifs_status status = pattern_open(refinement, arena, &pattern, &equations);
    smooth.weights = arena_new(arena, LONGEST, sizeof(double));
    if (status == BCIFS_OK)
        status = smooth.weights ? pattern_details(&pattern, arena, found) : BCIFS_MEMORY;
    if (status || !*found)
        return status;
    *found = pattern.column.length > 0 && smooth_find(&pattern, &equations, &smooth);
    if (!*found)
        return BCIFS_OK;
    details_scale(&pattern, &smooth);
    status = wavelets_find(&pattern, &smooth, &equations, arena, &wavelets, found);
    return status || !*found ? status : filters_build(&pattern, &smooth, wavelets, arena, filters);
}

/* ---- Declared filters ---------------------------------------------------------------------------------- */

/* A declared filter and its state's T_÷, in values; the fused matrix has column 2 i + r of cell i = 0. */
struct declaration {
    const struct value_matrix *fused;
    const struct module *module;
    const struct syntax_wavelet *syntax;
    struct value *smooth, *detail;
    struct filter wavelet; /* column 0 of Q */
    struct report *report;
};

static bcifs_status filter_values(const struct declaration *declaration, const bcifs_automaton *automaton,
                                  const struct syntax_matrix *matrix, struct arena *arena, struct value **values)
{
    struct environment environment = {.parameters = automaton->values,
                                      .known = automaton->parameter_count,
                                      .steps = EVALUATION_MOST_STEPS,
                                      .source = declaration->module->source,
                                      .report = declaration->report};
    bcifs_status status = BCIFS_OK;
    *values = arena_new(arena, matrix->columns, sizeof **values);
    if (!*values)
        return report_memory(declaration->report);
    for (size_t i = 0; i < matrix->columns && status == BCIFS_OK; i++)
        status = expression_evaluate(matrix->entries[i], &environment, &(*values)[i]);
    return status;
}

/* P[f][c] of the infinite curve: entry (c - i, r) of T_÷ for the fine point f = 2 i + r. */
static struct value fused_entry(const struct value_matrix *fused, ptrdiff_t f, ptrdiff_t c)
{
    ptrdiff_t i = f >= 0 ? f / 2 : -((1 - f) / 2), row = c - i;
    if (row < 0 || row >= (ptrdiff_t)fused->rows)
        return value_from_integer(0);
    return fused->values[(size_t)row * fused->columns + (size_t)(f - 2 * i)];
}

/* Σ_k filter[k] P[offset + k][c] for c = low … high, as text; whether it is the unit vector e_0 (or zero). */
static bool product_write(const struct declaration *declaration, const struct value *filter, size_t count,
                          int64_t offset, bool unit, struct text *text)
{
    ptrdiff_t first = (ptrdiff_t)offset, last = first + (ptrdiff_t)count - 1, rows = (ptrdiff_t)declaration->fused->rows;
    ptrdiff_t low = (first - 1) / 2 - 1 < 0 ? (first - 1) / 2 - 1 : 0, high = last / 2 + rows;
    bool right = true;
    for (ptrdiff_t c = low; c <= high; c++) {
        struct value sum = value_from_integer(0);
        for (size_t k = 0; k < count; k++)
            sum = value_add(sum,
                            value_multiply(filter[k], fused_entry(declaration->fused, first + (ptrdiff_t)k, c)));
        struct value wanted = value_from_integer(unit && c == 0);
        bool equal = sum.exact ? value_equal(sum, wanted) : fabs(sum.real - wanted.real) <= TOLERANCE_EQUATION;
        right = right && equal;
        if (!value_is_zero(sum) || c == 0) {
            text_append(text, text->length ? " " : "");
            value_write(text, sum);
            text_format(text, "·x%td", c);
        }
    }
    return right;
}

/* A·P = I and B·P = 0. */
static bcifs_status declaration_verify(const struct declaration *declaration)
{
    const struct syntax_wavelet *syntax = declaration->syntax;
    bcifs_status status = BCIFS_OK;
    for (int which = 0; which < 2 && status == BCIFS_OK; which++) {
        const struct syntax_matrix *matrix = which ? syntax->detail : syntax->smooth;
        struct text text = {0};
        bool right = product_write(declaration, which ? declaration->detail : declaration->smooth, matrix->columns,
                                   which ? syntax->detail_offset : syntax->smooth_offset, which == 0, &text);
        if (text.failed)
            status = report_memory(declaration->report);
        else if (!right)
            status = report_error(declaration->report, declaration->module->source, matrix->place,
                                  "the filters do not fit the refinement of '%s', P A + Q B = I: applied to refined "
                                  "points, %s gives %s instead of %s",
                                  syntax->reference->name, which ? "detail" : "smooth", text.data,
                                  which ? "0" : "1·x0");
        text_free(&text);
    }
    return status;
}

/* Tap `place` of a filter whose first is at `offset`. */
static struct value tap(const struct value *filter, size_t count, int64_t offset, ptrdiff_t place)
{
    ptrdiff_t index = place - (ptrdiff_t)offset;
    return index >= 0 && index < (ptrdiff_t)count ? filter[index] : value_from_integer(0);
}

/* Coefficient k of A_e B_o - A_o B_e, where A_e[i], A_o[i] are the taps of A at 2i and 2i + 1. */
static struct value determinant_coefficient(const struct declaration *declaration, ptrdiff_t k)
{
    const struct syntax_wavelet *syntax = declaration->syntax;
    size_t a_count = syntax->smooth->columns, b_count = syntax->detail->columns;
    ptrdiff_t a_first = (ptrdiff_t)syntax->smooth_offset / 2 - 1, a_last = a_first + (ptrdiff_t)a_count / 2 + 3;
    struct value sum = value_from_integer(0);
    for (ptrdiff_t i = a_first; i <= a_last; i++) {
        struct value a_even = tap(declaration->smooth, a_count, syntax->smooth_offset, 2 * i),
                     a_odd = tap(declaration->smooth, a_count, syntax->smooth_offset, 2 * i + 1),
                     b_even = tap(declaration->detail, b_count, syntax->detail_offset, 2 * (k - i)),
                     b_odd = tap(declaration->detail, b_count, syntax->detail_offset, 2 * (k - i) + 1);
        sum = value_add(sum, value_subtract(value_multiply(a_even, b_odd), value_multiply(a_odd, b_even)));
    }
    return sum;
}

/* Q: q[-2j] = -A_o[j + k]/δ and q[1 - 2j] = A_e[j + k]/δ for the determinant δ S^k. */
static bcifs_status wavelet_invert(struct declaration *declaration, struct value determinant, ptrdiff_t k,
                                   struct arena *arena)
{
    const struct syntax_wavelet *syntax = declaration->syntax;
    ptrdiff_t offset = (ptrdiff_t)syntax->smooth_offset, count = (ptrdiff_t)syntax->smooth->columns,
              low = 2 * k - (offset + count) - 1, high = 2 * k - offset + 2;
    double *weights = arena_new(arena, (size_t)(high - low + 1), sizeof *weights);
    if (!weights)
        return report_memory(declaration->report);
    for (ptrdiff_t place = low; place <= high; place++) {
        bool odd = place % 2 != 0;
        ptrdiff_t j = odd ? (1 - place) / 2 : -place / 2;
        struct value a = tap(declaration->smooth, (size_t)count, offset, 2 * (j + k) + !odd),
                     quotient = value_divide(a, determinant);
        weights[place - low] = odd ? quotient.real : -quotient.real;
    }
    while (low < high && weights[0] == 0)
        weights++, low++;
    while (low < high && weights[high - low] == 0)
        high--;
    declaration->wavelet = (struct filter){low, (size_t)(high - low + 1), weights};
    return BCIFS_OK;
}

/* The determinant must be one power of the shift. */
static bcifs_status declaration_invert(struct declaration *declaration, struct arena *arena)
{
    const struct syntax_wavelet *syntax = declaration->syntax;
    ptrdiff_t first = (ptrdiff_t)(syntax->smooth_offset + syntax->detail_offset) / 2 - 3,
              last = first + (ptrdiff_t)(syntax->smooth->columns + syntax->detail->columns) / 2 + 6, power = 0;
    struct value determinant = value_from_integer(0);
    struct text text = {0};
    size_t terms = 0;
    for (ptrdiff_t k = first; k <= last; k++) {
        struct value coefficient = determinant_coefficient(declaration, k);
        if (coefficient.exact ? value_is_zero(coefficient) : fabs(coefficient.real) <= TOLERANCE_EQUATION)
            continue;
        text_append(&text, terms++ ? " + " : "");
        value_write(&text, coefficient);
        text_format(&text, "·S^%td", k);
        determinant = coefficient;
        power = k;
    }
    bcifs_status status = BCIFS_OK;
    if (text.failed)
        status = report_memory(declaration->report);
    else if (terms != 1)
        status = report_error(declaration->report, declaration->module->source, syntax->place,
                              "smooth and detail of '%s' cannot be undone by short filters: their determinant is %s, not "
                              "one power of the shift S",
                              syntax->reference->name, terms ? text.data : "0");
    text_free(&text);
    return status ? status : wavelet_invert(declaration, determinant, power, arena);
}

static bcifs_status declaration_shape(const struct declaration *declaration, const struct cell *cell)
{
    size_t joint = cell->boundaries[0].operator->columns;
    if (cell->child_count == 2 && cell->points - joint == 1)
        return BCIFS_OK;
    return report_error(declaration->report, declaration->module->source, declaration->syntax->place,
                        "filters of one row each need a state with two maps and step 1; '%s' has %zu and %zu",
                        declaration->syntax->reference->name, cell->child_count, cell->points - joint);
}

static bcifs_status declaration_read(struct declaration *declaration, const bcifs_automaton *automaton,
                                     const struct definition *definition, struct arena *arena)
{
    struct setting setting = {.automaton = automaton, .parameters = automaton->values, .report = declaration->report};
    struct states states;
    const char *reason = NULL;
    size_t index;
    bcifs_status status = states_create(&states, arena, &setting);
    if (status == BCIFS_OK)
        status = states_intern(&states, (struct state_key){definition, NULL}, &index);
    if (status == BCIFS_OK)
        status = states_expand(&states, index);
    if (status == BCIFS_OK)
        status = declaration_shape(declaration, states.states[index].cell);
    if (status == BCIFS_OK)
        status = levels_fuse(&states, index, &declaration->fused, &reason);
    if (status == BCIFS_OK && reason)
        status = report_error(declaration->report, declaration->module->source, declaration->syntax->place,
                              "the maps of '%s' do not fuse: %s", declaration->syntax->reference->name, reason);
    if (status == BCIFS_OK)
        status = filter_values(declaration, automaton, declaration->syntax->smooth, arena, &declaration->smooth);
    if (status == BCIFS_OK)
        status = filter_values(declaration, automaton, declaration->syntax->detail, arena, &declaration->detail);
    if (status == BCIFS_OK)
        status = declaration_verify(declaration);
    return status ? status : declaration_invert(declaration, arena);
}

static const double *reals(const struct value *values, size_t count, struct arena *arena)
{
    double *numbers = arena_new(arena, count, sizeof *numbers);
    for (size_t i = 0; numbers && i < count; i++)
        numbers[i] = values[i].real;
    return numbers;
}

static const struct syntax_wavelet *wavelet_of(const bcifs_automaton *automaton, const struct definition *definition,
                                               const struct module **module)
{
    for (size_t m = 0; m < automaton->module_count; m++) {
        const struct syntax_file *file = automaton->modules[m]->syntax;
        *module = automaton->modules[m];
        for (size_t i = 0; i < file->count; i++)
            if (file->items[i].kind == ITEM_WAVELET &&
                file->items[i].wavelet->reference->target->definition == definition)
                return file->items[i].wavelet;
    }
    return NULL;
}

bcifs_status filters_declared(const bcifs_automaton *automaton, const struct definition *definition,
                              struct arena *arena, struct report *report, const struct declared_filters **declared)
{
    struct declaration declaration = {.report = report};
    *declared = NULL;
    declaration.syntax = wavelet_of(automaton, definition, &declaration.module);
    if (!declaration.syntax)
        return BCIFS_OK;
    if (definition->argument_count > 0)
        return report_error(report, declaration.module->source, declaration.syntax->place,
                            "filters are for states without arguments; '%s' takes %zu", definition->name,
                            definition->argument_count);
    bcifs_status status = declaration_read(&declaration, automaton, definition, arena);
    struct declared_filters *fresh = arena_new(arena, 1, sizeof *fresh);
    if (status || !fresh)
        return status ? status : report_memory(report);
    *fresh = (struct declared_filters){.module = declaration.module,
                                       .syntax = declaration.syntax,
                                       .smooth_count = declaration.syntax->smooth->columns,
                                       .detail_count = declaration.syntax->detail->columns,
                                       .wavelet = declaration.wavelet.weights,
                                       .wavelet_first = declaration.wavelet.first,
                                       .wavelet_count = declaration.wavelet.length};
    fresh->smooth = reals(declaration.smooth, fresh->smooth_count, arena);
    fresh->detail = reals(declaration.detail, fresh->detail_count, arena);
    *declared = fresh;
    return fresh->smooth && fresh->detail ? BCIFS_OK : report_memory(report);
}

bcifs_status filters_apply_declared(const struct stencil *refinement, const struct declared_filters *declared,
                                    struct arena *arena, struct filters *filters, bool *found)
{
    /* Filters are read only; weights are not const because derived ones are scaled in place. */
    struct filter detail = {(ptrdiff_t)declared->syntax->detail_offset, declared->detail_count,
                            (double *)declared->detail},
                  smooth = {(ptrdiff_t)declared->syntax->smooth_offset, declared->smooth_count,
                            (double *)declared->smooth},
                  wavelet = {declared->wavelet_first, declared->wavelet_count, (double *)declared->wavelet};
    struct block_pattern pattern = {
        .refinement = refinement, .height = 2, .details = &detail, .detail_count = 1};
    *found = pattern_repeats(refinement) && refinement->runs[0].height == 2;
    return *found ? filters_build(&pattern, &smooth, &wavelet, arena, filters) : BCIFS_OK;
}

bcifs_status bcifs_check_filters(const bcifs_automaton *automaton, const bcifs_load_options *options,
                                 bcifs_error *error)
{
    struct report report = report_new(options);
    struct arena arena = {0};
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < automaton->definition_count && status != BCIFS_MEMORY && !report_is_full(&report); i++) {
        const struct declared_filters *declared;
        status = filters_declared(automaton, automaton->definitions[i], &arena, &report, &declared);
    }
    arena_free(&arena);
    return report_close(&report, error);
}
