/* Blending functions as a table, and as a diagram: one curve each, named at its peak. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/decimal.h"
#include "base/memory.h"
#include "evaluate/basis.h"
#include "output/pen.h"
#include "output/provenance.h"

/* ---- Table --------------------------------------------------------------------------------------------- */

static void row_write(struct file *file, double t, const double *values, size_t count)
{
    file_number(file, t);
    for (size_t k = 0; k < count; k++) {
        file_text(file, ",");
        file_number(file, values[k]);
    }
    file_text(file, "\n");
}

/* Spreads a row over all functions; `clear` takes it back. */
static void row_spread(const struct basis_row *row, double *values, bool clear)
{
    for (size_t j = 0; j < row->count; j++)
        values[row->functions[j]] = clear ? 0 : values[row->functions[j]] + row->values[j];
}

static bcifs_status table_write(struct basis *basis, struct file *file)
{
    struct basis_row row;
    bcifs_status status = BCIFS_OK;
    double *values = memory_new(basis->functions, sizeof *values);
    if (!values)
        return report_memory(basis->report);
    file_text(file, "t");
    for (size_t k = 0; k < basis->functions; k++) {
        file_text(file, ",h");
        file_integer(file, k);
    }
    file_text(file, "\n");
    while (!file_failed(file) && basis_next(basis, &row, &status)) {
        row_spread(&row, values, false);
        row_write(file, row.t, values, basis->functions);
        row_spread(&row, values, true);
    }
    memory_free(values);
    return status;
}

/* ---- Diagram ------------------------------------------------------------------------------------------- */

enum {
    MOST_DRAWN = 1 << 24 /* numbers of a diagram: functions × parameters */,
    LEFT = 56,
    RIGHT = 24,
    TOP = 28,
    BOTTOM = 40
};

/* A word that was drawn, with its surroundings. */
struct patch {
    double x0, y0, x1, y1;
};

struct diagram {
    struct job *job;
    unsigned width, height;
    size_t functions, rows;
    double *t, *values; /* rows; rows × functions */
    double low, high;   /* of the values */
    double *line;       /* rows × 2: workspace */
    struct patch *patches;
    size_t patch_count;
};

static const struct color INK = {0x1c, 0x1c, 0x1c}, PALE = {0xd8, 0xd8, 0xd8};

/* Okabe and Ito's colors, which also color-blind eyes tell apart, without the palest, and three darker ones.
 */
static struct color function_color(size_t k)
{
    static const struct color colors[] = {{0x00, 0x72, 0xb2}, {0xd5, 0x5e, 0x00}, {0x00, 0x9e, 0x73},
                                          {0xcc, 0x79, 0xa7}, {0xe6, 0x9f, 0x00}, {0x56, 0xb4, 0xe9},
                                          {0x5b, 0x3a, 0x8e}, {0x8b, 0x5a, 0x2b}, {0x60, 0x60, 0x60}};
    return colors[k % (sizeof colors / sizeof *colors)];
}

static double place_x(const struct diagram *diagram, double t)
{
    return LEFT + t * (diagram->width - LEFT - RIGHT);
}

static double place_y(const struct diagram *diagram, double value)
{
    double share = (value - diagram->low) / (diagram->high - diagram->low);
    return diagram->height - BOTTOM - share * (diagram->height - TOP - BOTTOM);
}

static void segment_draw(struct pen *pen, double x0, double y0, double x1, double y1, struct color color)
{
    const double xy[] = {x0, y0, x1, y1};
    pen_line(pen, xy, 2, color, 1);
}

/* 1, 2 or 5 times a power of ten, about a fifth of the range. */
static double tick_step(double range)
{
    double power = pow(10, floor(log10(range / 5))), share = range / 5 / power;
    return power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
}

static void tick_words(struct pen *pen, double x, double y, enum pen_anchor anchor, double number)
{
    char digits[DECIMAL_LONGEST + 1];
    digits[decimal_print_digits(digits, number, 6)] = '\0';
    pen_words(pen, x, y, anchor, digits, INK);
}

static void frame_draw(struct pen *pen, const struct diagram *diagram)
{
    double left = place_x(diagram, 0), right = place_x(diagram, 1);
    double bottom = place_y(diagram, diagram->low), top = place_y(diagram, diagram->high);
    double step = tick_step(diagram->high - diagram->low);
    for (long i = lround(ceil(diagram->low / step - 1e-9)); (double)i * step <= diagram->high + 1e-9 * step;
         i++) {
        double y = place_y(diagram, (double)i * step);
        segment_draw(pen, left, y, right, y, PALE);
        segment_draw(pen, left, y, left + 6, y, INK);
        tick_words(pen, left - 8, y + 4.5, PEN_RIGHT, (double)i * step);
    }
    for (int i = 0; i <= 4; i++) {
        double x = place_x(diagram, i / 4.0);
        segment_draw(pen, x, bottom, x, bottom - 6, INK);
        tick_words(pen, x, bottom + 18, i == 4 ? PEN_RIGHT : i == 0 ? PEN_LEFT : PEN_MIDDLE, i / 4.0);
    }
    pen_words(pen, place_x(diagram, 0.375), bottom + 18, PEN_MIDDLE, "t", INK);
    const double box[] = {left, bottom, right, bottom, right, top, left, top, left, bottom};
    pen_line(pen, box, 5, INK, 1);
}

static double value_at(const struct diagram *diagram, size_t row, size_t k)
{
    return diagram->values[row * diagram->functions + k];
}

/* The function where it is not zero, in as many runs as that takes. */
static void function_draw(struct pen *pen, const struct diagram *diagram, size_t k)
{
    size_t count = 0;
    for (size_t row = 0; row < diagram->rows; row++) {
        bool here = value_at(diagram, row, k) != 0;
        bool beside = (row > 0 && value_at(diagram, row - 1, k) != 0) ||
                      (row + 1 < diagram->rows && value_at(diagram, row + 1, k) != 0);
        if (here || beside) {
            diagram->line[2 * count] = place_x(diagram, diagram->t[row]);
            diagram->line[2 * count++ + 1] = place_y(diagram, value_at(diagram, row, k));
        }
        /* At a zero that is not a crossing the run ends; the next begins at the zero before it rises. */
        bool ends = row + 1 == diagram->rows || (!here && value_at(diagram, row + 1, k) == 0);
        if (ends && count > 1)
            pen_line(pen, diagram->line, count, function_color(k), 1.5);
        count = ends ? 0 : count;
    }
}

static bool patch_is_free(const struct diagram *diagram, const struct patch *patch)
{
    if (patch->x0 < LEFT || patch->x1 > diagram->width - RIGHT || patch->y0 < 2 ||
        patch->y1 > diagram->height - BOTTOM)
        return false;
    for (size_t i = 0; i < diagram->patch_count; i++) {
        const struct patch *other = &diagram->patches[i];
        if (patch->x0 < other->x1 && other->x0 < patch->x1 && patch->y0 < other->y1 && other->y0 < patch->y1)
            return false;
    }
    return true;
}

static size_t peak_find(const struct diagram *diagram, size_t k)
{
    size_t peak = 0;
    for (size_t row = 1; row < diagram->rows; row++)
        if (fabs(value_at(diagram, row, k)) > fabs(value_at(diagram, peak, k)))
            peak = row;
    return peak;
}

/* Writes the name above the curve at a row (below, where it is negative), `lift` lines away, if there is
 * room. */
static bool name_try(struct pen *pen, struct diagram *diagram, size_t k, const char *name, size_t row,
                     int lift)
{
    double width = pen_width(pen, name), height = pen_height(pen), value = value_at(diagram, row, k);
    double x = place_x(diagram, diagram->t[row]), y = place_y(diagram, value);
    x = fmin(fmax(x, LEFT + 2 + width / 2), diagram->width - RIGHT - 2 - width / 2);
    y += value < 0 ? height * (lift + 1) : -6 - height * lift;
    const struct patch patch = {x - width / 2, y - height + 2, x + width / 2, y + 2};
    if (!patch_is_free(diagram, &patch))
        return false;
    diagram->patches[diagram->patch_count++] = patch;
    pen_words(pen, x, y, PEN_MIDDLE, name, function_color(k));
    return true;
}

/* Names the function at its peak, a line or two away from it, or as near to it as there is room along the
 * upper half of the curve. A function without room keeps no name rather than an unreadable one. */
static void function_name(struct pen *pen, struct diagram *diagram, size_t k)
{
    enum { LINES = 3 };
    char name[32];
    snprintf(name, sizeof name, "h%zu", k);
    size_t peak = peak_find(diagram, k);
    double half = value_at(diagram, peak, k) / 2;
    for (int lift = 0; lift < LINES; lift++)
        if (name_try(pen, diagram, k, name, peak, lift))
            return;
    for (size_t away = 1; away < diagram->rows; away++)
        for (int side = 0; side < 2; side++) {
            size_t row = side ? peak - away : peak + away; /* below 0 it wraps, and is no row */
            if (row < diagram->rows && value_at(diagram, row, k) * half >= half * half &&
                name_try(pen, diagram, k, name, row, 0))
                return;
        }
}

static void diagram_draw(struct pen *pen, const void *context)
{
    struct diagram *diagram = *(struct diagram *const *)context;
    frame_draw(pen, diagram);
    for (size_t k = 0; k < diagram->functions; k++)
        function_draw(pen, diagram, k);
    for (size_t k = 0; k < diagram->functions; k++)
        function_name(pen, diagram, k);
}

/* ---- Sampling ------------------------------------------------------------------------------------------ */

static bcifs_status row_take(struct diagram *diagram, const struct basis_row *row, struct arena *arena,
                             size_t *capacities)
{
    size_t entries = diagram->rows * diagram->functions;
    if (entries + diagram->functions > MOST_DRAWN)
        return report_failure(
            diagram->job->report, BCIFS_INPUT, NULL,
            "a diagram has at most %d values: %zu functions at fewer parameters; choose a smaller "
            "--depth or --level",
            MOST_DRAWN, diagram->functions);
    if (!ARENA_RESERVE(arena, diagram->t, diagram->rows, capacities[0]))
        return report_memory(diagram->job->report);
    if (entries + diagram->functions > capacities[1]) {
        size_t grown = 2 * (entries + diagram->functions);
        diagram->values = memory_resize(diagram->values, grown, sizeof *diagram->values);
        if (!diagram->values)
            return report_memory(diagram->job->report);
        capacities[1] = grown;
    }
    double *values = diagram->values + entries;
    memset(values, 0, diagram->functions * sizeof *values);
    row_spread(row, values, false);
    for (size_t j = 0; j < row->count; j++) {
        double value = values[row->functions[j]];
        if (!isfinite(value))
            return report_failure(diagram->job->report, BCIFS_INPUT, NULL,
                                  "a blending function is not finite");
        diagram->low = fmin(diagram->low, value);
        diagram->high = fmax(diagram->high, value);
    }
    diagram->t[diagram->rows++] = row->t;
    return BCIFS_OK;
}

static bcifs_status diagram_sample(struct diagram *diagram, struct basis *basis, struct arena *arena)
{
    struct basis_row row;
    size_t capacities[2] = {0, 0};
    bcifs_status status = BCIFS_OK;
    diagram->functions = basis->functions;
    diagram->high = 1;
    while (status == BCIFS_OK && basis_next(basis, &row, &status))
        status = row_take(diagram, &row, arena, capacities);
    /* Room for the names below what is negative. */
    if (diagram->low < 0)
        diagram->low -= 0.06 * (diagram->high - diagram->low);
    diagram->line = arena_new(arena, 2 * diagram->rows, sizeof *diagram->line);
    diagram->patches = arena_new(arena, diagram->functions, sizeof *diagram->patches);
    if (status == BCIFS_OK && (!diagram->line || !diagram->patches))
        status = report_memory(diagram->job->report);
    return status;
}

/* ---- The whole ----------------------------------------------------------------------------------------- */

static bcifs_status diagram_write(struct diagram *diagram, struct basis *basis, bool svg, struct file *file)
{
    struct arena arena = {0};
    bcifs_status status = diagram_sample(diagram, basis, &arena);
    if (status == BCIFS_OK)
        status = (svg ? pen_write_svg : pen_write_png)(diagram->job, diagram->width, diagram->height,
                                                       diagram_draw, &diagram, file);
    memory_free(diagram->values);
    arena_free(&arena);
    return status;
}

static bcifs_status width_check(struct diagram *diagram, unsigned width)
{
    enum { LEAST = 160 };
    diagram->width = width ? width : PICTURE_DEFAULT_WIDTH;
    diagram->height = diagram->width * 11 / 20;
    if (diagram->width >= LEAST && diagram->width <= PICTURE_MOST_WIDTH)
        return BCIFS_OK;
    return report_failure(diagram->job->report, BCIFS_INPUT, NULL,
                          "a diagram is %d to %d pixels wide, found %u", LEAST, PICTURE_MOST_WIDTH, width);
}

static bcifs_status basis_write(struct job *job, struct basis *basis, const char *path,
                                const bcifs_write_options *options)
{
    struct diagram diagram = {.job = job};
    struct file file;
    const char *ending = strrchr(path, '.');
    const char *format = options && options->format    ? options->format
                         : strcmp(path, "-") && ending ? ending + 1
                                                       : "csv";
    bool csv = strcmp(format, "csv") == 0, svg = strcmp(format, "svg") == 0;
    if (!csv && !svg && strcmp(format, "png") != 0)
        return report_failure(job->report, BCIFS_INPUT, NULL,
                              "blending functions are written as csv, svg or png, not '%s'", format);
    bcifs_status status = width_check(&diagram, options ? options->width : 0);
    if (status == BCIFS_OK)
        status = file_open(&file, path, job->report);
    if (status)
        return status;
    return file_close(&file, csv ? table_write(basis, &file) : diagram_write(&diagram, basis, svg, &file));
}

bcifs_status bcifs_write_basis(const bcifs_figure *figure, const bcifs_basis_view *view, const char *path,
                               const bcifs_write_options *options, bcifs_error *error)
{
    struct report report = report_new(NULL);
    const bcifs_automaton *automaton = figure_automaton(figure);
    const struct source *sources[AUTOMATON_MOST_MODULES];
    struct job job = {.automaton = bcifs_automaton_name(automaton),
                      .title = bcifs_automaton_title(automaton),
                      .figure = figure->name,
                      .command = options ? options->command : NULL,
                      .report = &report};
    provenance_sources_take(&job, automaton, sources);
    struct basis basis;
    if (basis_open(&basis, figure, view, &report) == BCIFS_OK) {
        basis_write(&job, &basis, path, options);
        basis_close(&basis);
    }
    return report_close(&report, error);
}
