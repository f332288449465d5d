#include "output/map_draw.h"

#include <math.h>
#include <string.h>

#include "base/decimal.h"
#include "base/memory.h"
#include "base/text.h"
#include "output/glyphs.h"
#include "output/picture.h"
#include "output/png.h"
#include "output/unicode.h"
#include "output/provenance.h"
#include "output/xml.h"

enum {
    CLASSES = BCIFS_C1 + 1,
    MOST_TICKS = 24,
    MOST_LINES = 2,
    LINE_RECTANGLES = 8 /* on a line of the file */
};
/* Lengths in pixels of a picture 1000 wide. */
static const double FONT = 17, MARGIN = 18, TICK = 7, GAP = 9, STRIP = 84, SWATCH = 17;

static const struct color INK = {0x1c, 0x1c, 0x1c}, PAPER = {0xff, 0xff, 0xff};

/* A class that includes another is a darker blue, so the order also shows in gray print and to color-blind
 * eyes; what is no answer is orange. */
static const struct color COLORS[CLASSES] = {[BCIFS_UNDECIDED] = {0xf0, 0xb3, 0x5a},
                                             [BCIFS_NOT_CONTRACTIVE] = {0xee, 0xec, 0xe8},
                                             [BCIFS_CONTRACTIVE] = {0xbf, 0xd7, 0xea},
                                             [BCIFS_TANGENT_CONTINUOUS] = {0x6d, 0xa7, 0xd6},
                                             [BCIFS_C1] = {0x14, 0x3d, 0x73}};
static const char *const WORDS[CLASSES] = {[BCIFS_UNDECIDED] = "undecided",
                                           [BCIFS_NOT_CONTRACTIVE] = "not contractive",
                                           [BCIFS_CONTRACTIVE] = "contractive",
                                           [BCIFS_TANGENT_CONTINUOUS] = "tangent continuous",
                                           [BCIFS_C1] = "C\xc2\xb9 (certified)"};
/* The order of the legend. */
static const bcifs_map_class LEGEND[CLASSES] = {BCIFS_NOT_CONTRACTIVE, BCIFS_CONTRACTIVE,
                                                BCIFS_TANGENT_CONTINUOUS, BCIFS_C1, BCIFS_UNDECIDED};

struct tick {
    double value;
    char text[DECIMAL_LONGEST + 1];
};

struct box {
    double x0, y0, x1, y1; /* pixels, y0 above y1 */
};

struct condition {
    double x0, y0, x1, y1; /* pixels; x0 < x1, y0 < y1 */
    struct text label;
    struct box box; /* of the label; empty when there is no room for it */
};

/* One of `svg` and `canvas` is set while something is drawn. */
struct chart {
    const bcifs_map *map;
    const struct job *job;
    struct file *svg;
    struct canvas *canvas;
    bool pixels;
    double unit; /* pixels to a length of 1 */
    unsigned width, height;
    struct box plot;
    struct tick ticks[MAP_MOST_AXES][MOST_TICKS];
    size_t tick_counts[MAP_MOST_AXES];
    size_t counts[CLASSES]; /* grid points of each class */
    struct condition conditions[MOST_LINES];
    size_t condition_count;
};

/* ---- Words --------------------------------------------------------------------------------------------- */

/* Pixels to a unit of a glyph; the letters of pixel pictures are a little smaller than those of vectors. */
static unsigned glyph_scale(const struct chart *chart)
{
    long scale = lround(2 * chart->unit);
    return scale < 1 ? 1 : (unsigned)scale;
}

/* The width of a text; of a vector picture, whose font is the viewer's, more than that of any usual one. */
static double text_width(const struct chart *chart, const char *text)
{
    double width = 0;
    if (chart->pixels)
        return (double)(glyphs_width(text) * glyph_scale(chart));
    for (struct unicode next = unicode_first(text); next.length > 0; next = unicode_next(&next)) {
        bool narrow = next.code < 128 && strchr("fijlt.,:'() ", (int)next.code);
        bool wide = next.code < 128 && strchr("mwMWQGO", (int)next.code);
        width += narrow ? 0.4 : wide ? 0.95 : next.code == 0xb9 ? 0.4 : 0.64;
    }
    return width * FONT * chart->unit;
}

static double text_height(const struct chart *chart)
{
    return chart->pixels ? GLYPH_ASCENT * (double)glyph_scale(chart) : 0.74 * FONT * chart->unit;
}

/* ---- Axes ---------------------------------------------------------------------------------------------- */

static double axis_low(const struct map_axis *axis)
{
    return axis->nodes[0].real;
}

static double axis_high(const struct map_axis *axis)
{
    return axis->nodes[axis->count - 1].real;
}

/* 1, 2 or 5 times a power of ten, so that there are about `wanted` steps. */
static double step_choose(double range, double wanted)
{
    double power = pow(10, floor(log10(range / wanted))), share = range / wanted / power;
    return power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
}

/* Multiples of the step; tick k is written as the nearest decimal of k·step. */
static void ticks_make(struct chart *chart, size_t which, double wanted)
{
    const struct map_axis *axis = &chart->map->axes[which];
    double low = axis_low(axis), high = axis_high(axis), step = step_choose(high - low, wanted);
    double k = ceil(low / step - 1e-9);
    size_t count = 0;
    for (; count < MOST_TICKS && k * step <= high + 1e-9 * step; k++) {
        struct tick *tick = &chart->ticks[which][count++];
        double value = fabs(k) < 0.5 ? 0 : k * step;
        tick->text[decimal_print_digits(tick->text, value, 12)] = '\0';
        tick->value = fmin(fmax(value, low), high);
    }
    chart->tick_counts[which] = count;
}

/* ---- Layout -------------------------------------------------------------------------------------------- */

static double place_x(const struct chart *chart, double value)
{
    const struct map_axis *axis = &chart->map->axes[0];
    double share = (value - axis_low(axis)) / (axis_high(axis) - axis_low(axis));
    return chart->plot.x0 + share * (chart->plot.x1 - chart->plot.x0);
}

static double place_y(const struct chart *chart, double value)
{
    const struct map_axis *axis = &chart->map->axes[1];
    double share = (value - axis_low(axis)) / (axis_high(axis) - axis_low(axis));
    return chart->plot.y1 - share * (chart->plot.y1 - chart->plot.y0);
}

/* Where the field of node k of an axis begins, as a value: half-way to the node before; node `count` ends the
 * last. */
static double field_edge(const struct map_axis *axis, size_t k)
{
    if (k == 0 || k == axis->count)
        return k == 0 ? axis_low(axis) : axis_high(axis);
    return axis->nodes[k - 1].real + (axis->nodes[k].real - axis->nodes[k - 1].real) / 2;
}

static double widest_tick(const struct chart *chart, size_t which)
{
    double widest = 0;
    for (size_t i = 0; i < chart->tick_counts[which]; i++)
        widest = fmax(widest, text_width(chart, chart->ticks[which][i].text));
    return widest;
}

/* Two params are drawn to one scale unless one range is far longer. */
static double plot_height(const struct chart *chart, double width)
{
    const struct map_axis *axes = chart->map->axes;
    if (chart->map->axis_count == 1)
        return STRIP * chart->unit;
    double ratio = (axis_high(&axes[1]) - axis_low(&axes[1])) / (axis_high(&axes[0]) - axis_low(&axes[0]));
    return ratio >= 0.5 && ratio <= 2 ? width * ratio : width;
}

static double legend_width(const struct chart *chart, bcifs_map_class class)
{
    return (SWATCH + GAP) * chart->unit + text_width(chart, WORDS[class]);
}

typedef void legend_visitor(const struct chart *chart, bcifs_map_class class, double x, double y);

/* The classes that occur, in rows of the plot's width; returns where the last row ends. */
static double legend_visit(const struct chart *chart, double top, legend_visitor *visit)
{
    double unit = chart->unit, x = chart->plot.x0, y = top;
    for (size_t i = 0; i < CLASSES; i++) {
        double width = legend_width(chart, LEGEND[i]);
        if (chart->counts[LEGEND[i]] == 0)
            continue;
        if (x > chart->plot.x0 && x + width > chart->plot.x1) {
            x = chart->plot.x0;
            y += (SWATCH + GAP) * unit;
        }
        if (visit)
            visit(chart, LEGEND[i], x, y);
        x += width + 2.5 * GAP * unit;
    }
    return y + SWATCH * unit;
}

/* From the plot's lower edge to the legend: ticks, their words, the name of the param. */
static double legend_top(const struct chart *chart)
{
    double line = text_height(chart) + GAP * chart->unit;
    return chart->plot.y1 + (TICK + 2 * GAP) * chart->unit + 2 * line;
}

static void layout(struct chart *chart)
{
    double unit = chart->unit, gap = GAP * unit;
    ticks_make(chart, 0, fmax(3, chart->width / (110 * unit)));
    double right = fmax(MARGIN * unit, widest_tick(chart, 0) / 2 + gap), left = right;
    double top = MARGIN * unit;
    if (chart->map->axis_count > 1) {
        ticks_make(chart, 1, 8);
        left = fmax(left, widest_tick(chart, 1) + TICK * unit + 2 * gap);
        top += text_height(chart) + gap;
    }
    /* Half a pixel in, so that lines one pixel wide cover one. */
    chart->plot = (struct box){round(left) + 0.5, round(top) + 0.5, round(chart->width - right) - 0.5, 0};
    chart->plot.y1 = chart->plot.y0 + round(plot_height(chart, chart->plot.x1 - chart->plot.x0));
    chart->height = (unsigned)ceil(legend_visit(chart, legend_top(chart), NULL) + MARGIN * unit);
}

/* ---- Conditions ---------------------------------------------------------------------------------------- */

/* "1 − 2a − b = 0" */
static void condition_label(const bcifs_map *map, bool first, struct text *label)
{
    for (size_t k = 0; k < 2; k++) {
        const char *name = map->axes[map->cut_axes[k]].name;
        bool twice = first == (k == 0);
        text_format(label, "%s \xe2\x88\x92 %s%s%s", k == 0 ? "1" : "", twice ? "2" : "",
                    twice && name[1] ? " " : "", name);
    }
    text_append(label, " = 0");
}

/* 1 - u x - v y = 0 within the plot, u and v positive: it falls to the right. */
static void condition_add(struct chart *chart, bool first)
{
    const bcifs_map *map = chart->map;
    struct condition *condition = &chart->conditions[chart->condition_count];
    double of_a = first ? 2 : 1, of_b = first ? 1 : 2;
    double u = map->cut_axes[0] == 0 ? of_a : of_b, v = map->cut_axes[0] == 0 ? of_b : of_a;
    double from = fmax(axis_low(&map->axes[0]), (1 - v * axis_high(&map->axes[1])) / u);
    double to = fmin(axis_high(&map->axes[0]), (1 - v * axis_low(&map->axes[1])) / u);
    if (!(from < to))
        return;
    *condition = (struct condition){.x0 = place_x(chart, from),
                                    .y0 = place_y(chart, (1 - u * from) / v),
                                    .x1 = place_x(chart, to),
                                    .y1 = place_y(chart, (1 - u * to) / v)};
    condition_label(map, first, &condition->label);
    chart->condition_count++;
}

static bool boxes_meet(const struct box *a, const struct box *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

/* Whether the falling segment passes through the box: the lower left corner and the upper right one lie on
 * different sides of it. */
static bool line_meets(const struct condition *line, const struct box *box)
{
    double dx = line->x1 - line->x0, dy = line->y1 - line->y0;
    double lower_left = (box->x0 - line->x0) * dy - (box->y1 - line->y0) * dx;
    double upper_right = (box->x1 - line->x0) * dy - (box->y0 - line->y0) * dx;
    const struct box own = {line->x0, line->y0, line->x1, line->y1};
    return boxes_meet(box, &own) && (lower_left < 0) != (upper_right < 0);
}

static bool label_fits(const struct chart *chart, const struct box *box)
{
    double edge = 4 * chart->unit;
    if (box->x0 < chart->plot.x0 + edge || box->x1 > chart->plot.x1 - edge ||
        box->y0 < chart->plot.y0 + edge || box->y1 > chart->plot.y1 - edge)
        return false;
    for (size_t i = 0; i < chart->condition_count; i++)
        if (line_meets(&chart->conditions[i], box) || boxes_meet(&chart->conditions[i].box, box))
            return false;
    return true;
}

/* The node whose field a position is in, `share` of the way along an axis. */
static size_t node_at(size_t count, double share)
{
    double node = share * (double)(count - 1) + 0.5;
    return node < 0 ? 0 : node >= (double)count ? count - 1 : (size_t)node;
}

/* Whether one color lies under the box, which is within the plot. */
static bool ground_is_plain(const struct chart *chart, const struct box *box)
{
    const bcifs_map *map = chart->map;
    const struct box *plot = &chart->plot;
    double width = plot->x1 - plot->x0, height = plot->y1 - plot->y0;
    size_t left = node_at(map->columns, (box->x0 - plot->x0) / width);
    size_t right = node_at(map->columns, (box->x1 - plot->x0) / width);
    size_t low = node_at(map->rows, (plot->y1 - box->y1) / height);
    size_t high = node_at(map->rows, (plot->y1 - box->y0) / height);
    unsigned char first = map->classes[low * map->columns + left];
    for (size_t j = low; j <= high; j++)
        for (size_t i = left; i <= right; i++)
            if (map->classes[j * map->columns + i] != first)
                return false;
    return true;
}

/* A label's box on the upper right (side 0) or lower left of its line, `share` of the way down. */
static struct box label_box(const struct chart *chart, const struct condition *condition, int side,
                            double share)
{
    double gap = GAP * chart->unit, width = text_width(chart, condition->label.data),
           height = text_height(chart);
    double x = condition->x0 + share * (condition->x1 - condition->x0);
    double y = condition->y0 + share * (condition->y1 - condition->y0);
    if (side == 0)
        return (struct box){x + gap, y - gap - height, x + gap + width, y - gap};
    return (struct box){x - gap - width, y + gap, x - gap, y + gap + height};
}

/* On plain ground where that can be had, on the upper right rather than the lower left, and near an end. */
static void label_place(const struct chart *chart, struct condition *condition)
{
    static const double shares[] = {0.12, 0.88, 0.16, 0.84, 0.2, 0.8, 0.25, 0.75, 0.3, 0.7, 0.4, 0.6, 0.5};
    enum { SHARES = sizeof shares / sizeof shares[0] };
    for (size_t k = 0; k < 4 * SHARES; k++) {
        bool plain = k < 2 * SHARES;
        struct box box = label_box(chart, condition, k / SHARES % 2, shares[k % SHARES]);
        if (label_fits(chart, &box) && (!plain || ground_is_plain(chart, &box))) {
            condition->box = box;
            return;
        }
    }
}

static bcifs_status conditions_make(struct chart *chart)
{
    if (!chart->map->cuts_corners)
        return BCIFS_OK;
    condition_add(chart, true);
    condition_add(chart, false);
    for (size_t i = 0; i < chart->condition_count; i++) {
        if (chart->conditions[i].label.failed)
            return report_memory(chart->job->report);
        label_place(chart, &chart->conditions[i]);
    }
    return BCIFS_OK;
}

/* ---- Strokes ------------------------------------------------------------------------------------------- */

static void color_write(struct file *file, const char *before, struct color color)
{
    static const char digits[] = "0123456789abcdef";
    const unsigned char channels[3] = {color.red, color.green, color.blue};
    file_text(file, before);
    file_text(file, "=\"#");
    for (size_t i = 0; i < 3; i++) {
        file_write(file, &digits[channels[i] >> 4], 1);
        file_write(file, &digits[channels[i] & 15], 1);
    }
    file_text(file, "\"");
}

static void fixed_write(struct file *file, const char *before, double number, const char *after)
{
    file_text(file, before);
    file_fixed(file, number, 2);
    file_text(file, after);
}

static void line_draw(const struct chart *chart, double x0, double y0, double x1, double y1, double width)
{
    if (chart->canvas) {
        canvas_segment(chart->canvas, x0, y0, x1, y1, width * chart->unit);
        canvas_paint(chart->canvas, INK, 1);
        return;
    }
    fixed_write(chart->svg, "<path d=\"M", x0, " ");
    fixed_write(chart->svg, "", y0, "L");
    fixed_write(chart->svg, "", x1, " ");
    fixed_write(chart->svg, "", y1, "\"");
    fixed_write(chart->svg, " stroke-width=\"", width * chart->unit, "\"/>\n");
}

/* `share` of the text lies left of x; y is its base line. */
static void words_draw(const struct chart *chart, double x, double y, double share, const char *text)
{
    static const char *const anchors[] = {"start", "middle", "end"};
    if (chart->canvas) {
        glyphs_cover(chart->canvas, lround(x - share * text_width(chart, text)), lround(y),
                     glyph_scale(chart), text);
        canvas_paint(chart->canvas, INK, 1);
        return;
    }
    fixed_write(chart->svg, "<text x=\"", x, "\"");
    fixed_write(chart->svg, " y=\"", y, "\"");
    file_text(chart->svg, " text-anchor=\"");
    file_text(chart->svg, anchors[lround(2 * share)]);
    file_text(chart->svg, "\">");
    xml_write(chart->svg, text);
    file_text(chart->svg, "</text>\n");
}

static void box_draw(const struct chart *chart, const struct box *box)
{
    line_draw(chart, box->x0, box->y0, box->x1, box->y0, 1);
    line_draw(chart, box->x1, box->y0, box->x1, box->y1, 1);
    line_draw(chart, box->x1, box->y1, box->x0, box->y1, 1);
    line_draw(chart, box->x0, box->y1, box->x0, box->y0, 1);
}

static void pixel_set(struct canvas *canvas, long column, long row, struct color color)
{
    if (column < 0 || row < 0 || column >= (long)canvas->width || row >= (long)canvas->height)
        return;
    unsigned char *pixel = canvas->pixels + 3 * ((size_t)row * canvas->width + (size_t)column);
    pixel[0] = color.red;
    pixel[1] = color.green;
    pixel[2] = color.blue;
}

static void swatch_fill(const struct chart *chart, const struct box *box, struct color color)
{
    if (chart->canvas) {
        for (long row = lround(box->y0); row < lround(box->y1); row++)
            for (long column = lround(box->x0); column < lround(box->x1); column++)
                pixel_set(chart->canvas, column, row, color);
        return;
    }
    fixed_write(chart->svg, "<rect x=\"", box->x0, "\"");
    fixed_write(chart->svg, " y=\"", box->y0, "\"");
    fixed_write(chart->svg, " width=\"", box->x1 - box->x0, "\"");
    fixed_write(chart->svg, " height=\"", box->y1 - box->y0, "\" stroke=\"none\"");
    color_write(chart->svg, " fill", color);
    file_text(chart->svg, "/>\n");
}

/* ---- Fields of color ----------------------------------------------------------------------------------- */

/* The edges of the fields of an axis in pixels: count + 1. NULL: no memory. */
static double *edges_make(const struct chart *chart, size_t which)
{
    static const struct map_axis none = {.count = 1};
    const struct map_axis *axis = which < chart->map->axis_count ? &chart->map->axes[which] : &none;
    double *edges = memory_new(axis->count + 1, sizeof *edges);
    for (size_t k = 0; edges && k <= axis->count; k++) {
        if (axis == &none)
            edges[k] = k == 0 ? chart->plot.y1 : chart->plot.y0;
        else
            edges[k] = which == 0 ? place_x(chart, field_edge(axis, k)) : place_y(chart, field_edge(axis, k));
    }
    return edges;
}

/* Fields of one class that lie side by side are one rectangle, and equal ones above each other too. */
struct run {
    size_t end; /* 0: no run begins here */
    size_t row; /* where the rectangle began */
};

struct sheet {
    const struct chart *chart;
    double *columns, *rows;  /* edges, in pixels */
    struct run *open, *next; /* by the first column */
    size_t written;
};

static void rectangle_write(struct sheet *sheet, size_t first, size_t end, size_t low, size_t high)
{
    struct file *file = sheet->chart->svg;
    double x0 = sheet->columns[first], x1 = sheet->columns[end], y0 = sheet->rows[high],
           y1 = sheet->rows[low];
    fixed_write(file, sheet->written++ % LINE_RECTANGLES ? "M" : "\nM", x0, " ");
    fixed_write(file, "", y0, "H");
    fixed_write(file, "", x1, "V");
    fixed_write(file, "", y1, "H");
    fixed_write(file, "", x0, "Z");
}

/* The runs of a class in a row; row `rows` has none. */
static void runs_find(const bcifs_map *map, size_t row, unsigned char class, struct run *runs)
{
    memset(runs, 0, map->columns * sizeof *runs);
    for (size_t i = 0; row < map->rows && i < map->columns; i++) {
        const unsigned char *classes = map->classes + row * map->columns;
        size_t first = i;
        if (classes[i] != class)
            continue;
        while (i < map->columns && classes[i] == class)
            i++;
        runs[first] = (struct run){i, row};
    }
}

static void class_write(struct sheet *sheet, bcifs_map_class class)
{
    const bcifs_map *map = sheet->chart->map;
    struct file *file = sheet->chart->svg;
    if (sheet->chart->counts[class] == 0)
        return;
    file_text(file, "<path class=\"");
    file_text(file, bcifs_map_class_name(class));
    file_text(file, "\" stroke=\"none\" shape-rendering=\"crispEdges\"");
    color_write(file, " fill", COLORS[class]);
    file_text(file, " d=\"");
    memset(sheet->open, 0, map->columns * sizeof *sheet->open);
    for (size_t row = 0; row <= map->rows && !file_failed(file); row++) {
        runs_find(map, row, (unsigned char)class, sheet->next);
        for (size_t i = 0; i < map->columns; i++) {
            if (sheet->open[i].end && sheet->open[i].end == sheet->next[i].end)
                sheet->next[i].row = sheet->open[i].row;
            else if (sheet->open[i].end)
                rectangle_write(sheet, i, sheet->open[i].end, sheet->open[i].row, row);
        }
        struct run *swap = sheet->open;
        sheet->open = sheet->next;
        sheet->next = swap;
    }
    file_text(file, "\"/>\n");
}

/* Pixel by pixel from edge to edge; where fields are finer than pixels, the later one shows. */
static void fields_paint(const struct sheet *sheet)
{
    const bcifs_map *map = sheet->chart->map;
    for (size_t j = 0; j < map->rows; j++)
        for (size_t i = 0; i < map->columns; i++)
            for (long row = lround(sheet->rows[j + 1]); row < lround(sheet->rows[j]); row++)
                for (long column = lround(sheet->columns[i]); column < lround(sheet->columns[i + 1]);
                     column++)
                    pixel_set(sheet->chart->canvas, column, row, COLORS[map->classes[j * map->columns + i]]);
}

static bcifs_status fields_draw(const struct chart *chart)
{
    struct sheet sheet = {.chart = chart, .columns = edges_make(chart, 0), .rows = edges_make(chart, 1)};
    struct run *first = sheet.open = memory_new(chart->map->columns, sizeof *first);
    struct run *second = sheet.next = memory_new(chart->map->columns, sizeof *second);
    bcifs_status status = BCIFS_OK;
    if (!sheet.columns || !sheet.rows || !first || !second)
        status = report_memory(chart->job->report);
    else if (chart->canvas)
        fields_paint(&sheet);
    else
        for (size_t class = 0; class < CLASSES; class ++)
            class_write(&sheet, (bcifs_map_class) class);
    memory_free(sheet.columns);
    memory_free(sheet.rows);
    memory_free(first);
    memory_free(second);
    return status;
}

/* ---- The picture --------------------------------------------------------------------------------------- */

static void axes_draw(const struct chart *chart)
{
    const struct box *plot = &chart->plot;
    double unit = chart->unit, gap = GAP * unit, tick = TICK * unit, height = text_height(chart);
    for (size_t i = 0; i < chart->tick_counts[0]; i++) {
        double x = floor(place_x(chart, chart->ticks[0][i].value)) + 0.5;
        line_draw(chart, x, plot->y1, x, plot->y1 + tick, 1);
        words_draw(chart, x, plot->y1 + tick + gap / 2 + height, 0.5, chart->ticks[0][i].text);
    }
    words_draw(chart, (plot->x0 + plot->x1) / 2, plot->y1 + tick + 1.5 * gap + 2 * height, 0.5,
               chart->map->axes[0].name);
    for (size_t i = 0; i < chart->tick_counts[1]; i++) {
        double y = floor(place_y(chart, chart->ticks[1][i].value)) + 0.5;
        line_draw(chart, plot->x0 - tick, y, plot->x0, y, 1);
        words_draw(chart, plot->x0 - tick - gap / 2, y + height / 2, 1, chart->ticks[1][i].text);
    }
    if (chart->map->axis_count > 1)
        words_draw(chart, plot->x0, plot->y0 - gap, 0, chart->map->axes[1].name);
    box_draw(chart, plot);
}

static void legend_draw(const struct chart *chart, bcifs_map_class class, double x, double y)
{
    double side = SWATCH * chart->unit, gap = GAP * chart->unit;
    const struct box swatch = {round(x) + 0.5, round(y) + 0.5, round(x + side) + 0.5, round(y + side) + 0.5};
    swatch_fill(chart, &swatch, COLORS[class]);
    box_draw(chart, &swatch);
    words_draw(chart, x + side + gap, y + (side + text_height(chart)) / 2, 0, WORDS[class]);
}

static bcifs_status chart_draw(const struct chart *chart)
{
    bcifs_status status = fields_draw(chart);
    for (size_t i = 0; i < chart->condition_count && status == BCIFS_OK; i++) {
        const struct condition *condition = &chart->conditions[i];
        line_draw(chart, condition->x0, condition->y0, condition->x1, condition->y1, 1.6);
        if (condition->box.x1 > condition->box.x0)
            words_draw(chart, condition->box.x0, condition->box.y1, 0, condition->label.data);
    }
    axes_draw(chart);
    legend_visit(chart, legend_top(chart), legend_draw);
    return status;
}

static bcifs_status chart_open(struct chart *chart, const bcifs_map *map, const struct job *job, bool pixels)
{
    enum { LEAST = 240 };
    *chart = (struct chart){
        .map = map, .job = job, .pixels = pixels, .width = job->width, .unit = job->width / 1000.0};
    if (job->width < LEAST || job->width > PICTURE_MOST_WIDTH / 2)
        return report_failure(job->report, BCIFS_INPUT, NULL, "a map is drawn %d to %d pixels wide, found %u",
                              LEAST, PICTURE_MOST_WIDTH / 2, job->width);
    chart->unit = fmax(chart->unit, 0.75);
    for (size_t i = 0; i < map->columns * map->rows; i++)
        chart->counts[map->classes[i]]++;
    layout(chart);
    return conditions_make(chart);
}

static void chart_close(struct chart *chart)
{
    for (size_t i = 0; i < MOST_LINES; i++)
        text_free(&chart->conditions[i].label);
}

bcifs_status map_png_write(const bcifs_map *map, const struct job *job, struct file *file)
{
    struct chart chart;
    struct canvas canvas = {0};
    bcifs_status status = chart_open(&chart, map, job, true);
    if (status == BCIFS_OK && !canvas_new(&canvas, chart.width, chart.height))
        status = report_memory(job->report);
    chart.canvas = &canvas;
    if (status == BCIFS_OK)
        status = chart_draw(&chart);
    if (status == BCIFS_OK)
        status = png_canvas_write(job, &canvas, file);
    canvas_free(&canvas);
    chart_close(&chart);
    return status;
}

/* ---- The head of a vector picture ---------------------------------------------------------------------- */

/* "40 x 20 values, a from 0 to 1, b from 0 to 1/2: 400 not contractive, …" */
static void description_write(const struct chart *chart)
{
    const bcifs_map *map = chart->map;
    struct file *file = chart->svg;
    file_text(file, "<desc>");
    for (size_t i = 0; i < map->axis_count; i++) {
        file_text(file, i ? ", " : "");
        file_integer(file, map->axes[i].count);
        file_text(file, " values of ");
        xml_write(file, map->axes[i].name);
        file_text(file, " from ");
        file_number(file, axis_low(&map->axes[i]));
        file_text(file, " to ");
        file_number(file, axis_high(&map->axes[i]));
    }
    const char *separator = "; grid points: ";
    for (size_t i = 0; i < CLASSES; i++) {
        if (chart->counts[LEGEND[i]] == 0)
            continue;
        file_text(file, separator);
        file_integer(file, chart->counts[LEGEND[i]]);
        file_text(file, " ");
        file_text(file, WORDS[LEGEND[i]]);
        separator = ", ";
    }
    file_text(file, "</desc>\n");
}

static void metadata_write(const struct chart *chart)
{
    const struct job *job = chart->job;
    struct file *file = chart->svg;
    file_text(file, "<metadata>\n");
    provenance_command_write(file, job->command);
    provenance_sources_write(file, job);
    file_text(file, "</metadata>\n");
}

static void head_write(const struct chart *chart)
{
    const struct job *job = chart->job;
    struct file *file = chart->svg;
    file_text(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                    "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:bcifs=\"urn:bcifs\"");
    xml_size_write(file, " width=\"", chart->width, "\" height=\"", chart->height);
    xml_size_write(file, "\" viewBox=\"0 0 ", chart->width, " ", chart->height);
    file_text(file, "\">\n<title>");
    xml_write(file, job->title[0] ? job->title : job->automaton);
    file_text(file, ", parameter map</title>\n");
    description_write(chart);
    metadata_write(chart);
    xml_size_write(file, "<rect width=\"", chart->width, "\" height=\"", chart->height);
    color_write(file, "\" fill", PAPER);
    file_text(file, "/>\n<g");
    color_write(file, " stroke", INK);
    color_write(file, " fill", INK);
    fixed_write(file, " stroke-linecap=\"square\" font-family=\"sans-serif\" font-size=\"",
                FONT * chart->unit, "\">\n<style>text{stroke:none}</style>\n");
}

bcifs_status map_svg_write(const bcifs_map *map, const struct job *job, struct file *file)
{
    struct chart chart;
    bcifs_status status = chart_open(&chart, map, job, false);
    chart.svg = file;
    if (status == BCIFS_OK) {
        head_write(&chart);
        status = chart_draw(&chart);
        file_text(file, "</g>\n</svg>\n");
    }
    chart_close(&chart);
    return status;
}
