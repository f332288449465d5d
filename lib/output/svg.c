/* SVG: a vector picture as one puts it into a paper: hairlines whose width does not scale, colors that print,
 * and, in the file, everything that is needed to make it again or to read coordinates off it. */
#include <math.h>
#include <string.h>

#include "base/decimal.h"
#include "base/memory.h"
#include "output/format.h"
#include "output/picture.h"
#include "output/provenance.h"
#include "output/xml.h"

enum {
    POINTS_MOST = 1 << 24, /* written points; a file of some 200 MB, more than any viewer takes */
    LINE_POINTS = 8        /* points on a line of the file */
};
/* Bits of the map of loose points: 64 MiB. */
static const uint64_t CELLS_MOST = UINT64_C(1) << 29;

struct drawing {
    struct picture picture;
    struct file *file;
    int decimals;    /* of coordinates */
    double grid;     /* cells per pixel: 10^decimals */
    uint64_t points; /* written so far */
};

/* ---- Words --------------------------------------------------------------------------------------------- */

static void count_write(struct file *file, uint64_t count, const char *what, const char *of)
{
    file_text(file, what);
    file_text(file, of);
    file_integer(file, count);
    file_text(file, count == 1 ? " point" : " points");
}

/* "Closed curve of 1536 points", "4 paths of …", "1000 points", "27 polygons of …". */
static void layer_describe(struct file *file, const struct layer *layer)
{
    const struct point_source *source = &layer->points;
    const char *name = layer->role == BCIFS_POLYGON ? "control polygon"
                       : layer->role == BCIFS_LEVEL ? "level"
                       : layer->role == BCIFS_TARGET ? "target"
                                                    : "curve";
    if (points_are_loose(source)) {
        count_write(file, source->count, layer->role == BCIFS_LEVEL ? "level of " : "", "");
    } else if (source->polygon > 0) {
        file_integer(file, source->count / source->polygon);
        count_write(file, source->polygon, " control frames", " of ");
    } else if (layer->role == BCIFS_TANGENT) {
        file_integer(file, source->path_count);
        file_text(file, " half-tangents");
    } else if (source->path_count == 1) {
        file_text(file, source->path(source->origin, 0).closed ? "closed " : "open ");
        count_write(file, source->count, name, " of ");
    } else {
        file_integer(file, source->path_count);
        count_write(file, source->count, " paths", " of together ");
    }
}

/* A number that is read by people: twelve digits. */
static void rounded_write(struct file *file, double number)
{
    char digits[DECIMAL_LONGEST];
    file_write(file, digits, decimal_print_digits(digits, number, 12));
}

static void description_write(const struct drawing *drawing)
{
    static const char *const axes[] = {"x from ", ", y from ", ", z from "};
    const struct picture *picture = &drawing->picture;
    const struct job *job = picture->job;
    struct file *file = drawing->file;
    file_text(file, "<desc>");
    layer_describe(file, &job->layers[0]);
    if (job->layers[0].points.count > 0)
        file_text(file, "; ");
    for (unsigned k = 0; k < picture->dimension && job->layers[0].points.count > 0; k++) {
        file_text(file, axes[k]);
        rounded_write(file, picture->low[k]);
        file_text(file, " to ");
        rounded_write(file, picture->high[k]);
    }
    for (size_t i = 1; i < job->layer_count; i++) {
        file_text(file, "; ");
        layer_describe(file, &job->layers[i]);
    }
    file_text(file, "</desc>\n");
}

static void attribute_write(struct file *file, const char *name, double value)
{
    file_text(file, " ");
    file_text(file, name);
    file_text(file, "=\"");
    file_number(file, value);
    file_text(file, "\"");
}

/* What turns picture coordinates back into the data's. */
static void transform_write(const struct drawing *drawing)
{
    static const char *const us[] = {"the parameter", "x", "(x + y)*sqrt(3)/4"};
    static const char *const vs[] = {"x", "y", "z/2 + (y - x)/4"};
    const struct picture *picture = &drawing->picture;
    struct file *file = drawing->file;
    file_text(file, "<!-- A point (u, v) of the data is drawn at (left + scale-u*(u - u0), bottom - "
                    "scale-v*(v - v0)). -->\n"
                    "<bcifs:transform u=\"");
    file_text(file, us[picture->dimension - 1]);
    file_text(file, "\" v=\"");
    file_text(file, vs[picture->dimension - 1]);
    file_text(file, "\"");
    attribute_write(file, "u0", picture->u0);
    attribute_write(file, "v0", picture->v0);
    attribute_write(file, "scale-u", picture->scale_u);
    attribute_write(file, "scale-v", picture->scale_v);
    attribute_write(file, "left", picture->left);
    attribute_write(file, "bottom", picture->bottom);
    file_text(file, "/>\n");
}

static void metadata_write(const struct drawing *drawing)
{
    const struct job *job = drawing->picture.job;
    struct file *file = drawing->file;
    file_text(file, "<metadata>\n");
    provenance_command_write(file, job->command);
    transform_write(drawing);
    provenance_sources_write(file, job);
    file_text(file, "</metadata>\n");
}

static void head_write(const struct drawing *drawing)
{
    const struct picture *picture = &drawing->picture;
    const struct job *job = picture->job;
    struct file *file = drawing->file;
    file_text(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                    "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:bcifs=\"urn:bcifs\"");
    xml_size_write(file, " width=\"", picture->width, "\" height=\"", picture->height);
    xml_size_write(file, "\" viewBox=\"0 0 ", picture->width, " ", picture->height);
    file_text(file, "\">\n<title>");
    xml_write(file, job->title[0] ? job->title : job->automaton);
    if (job->figure[0])
        file_text(file, ", ");
    xml_write(file, job->figure);
    file_text(file, "</title>\n");
    description_write(drawing);
    metadata_write(drawing);
    xml_size_write(file, "<rect width=\"", picture->width, "\" height=\"", picture->height);
    file_text(file,
              "\" fill=\"#fff\"/>\n<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n");
}

/* ---- Points -------------------------------------------------------------------------------------------- */

/* A place on the grid to which coordinates are rounded. */
struct spot {
    long x, y;
};

static struct spot spot_of(const struct drawing *drawing, const struct mark *mark)
{
    return (struct spot){lround(mark->x * drawing->grid), lround(mark->y * drawing->grid)};
}

static void spot_write(struct drawing *drawing, const char *verb, struct spot spot)
{
    struct file *file = drawing->file;
    if (drawing->points++ % LINE_POINTS == 0)
        file_text(file, "\n");
    file_text(file, verb);
    file_fixed(file, (double)spot.x / drawing->grid, drawing->decimals);
    file_text(file, " ");
    file_fixed(file, (double)spot.y / drawing->grid, drawing->decimals);
}

/* Whether writing may go on. */
static bool drawing_continues(const struct drawing *drawing)
{
    return drawing->points <= POINTS_MOST && !file_failed(drawing->file);
}

static bcifs_status drawing_status(const struct drawing *drawing, bcifs_status status)
{
    if (status == BCIFS_OK && drawing->points > POINTS_MOST)
        return report_failure(
            drawing->picture.job->report, BCIFS_INPUT, NULL,
            "a vector picture holds at most %d points; choose a smaller depth, or write .png", POINTS_MOST);
    return status;
}

static void color_write(struct file *file, const char *before, struct color color)
{
    static const char digits[] = "0123456789abcdef";
    unsigned char channels[3] = {color.red, color.green, color.blue};
    file_text(file, before);
    file_text(file, "=\"#");
    for (size_t i = 0; i < 3; i++) {
        file_write(file, &digits[channels[i] >> 4], 1);
        file_write(file, &digits[channels[i] & 15], 1);
    }
    file_text(file, "\"");
}

static void path_begin(struct file *file, const char *kind, struct color color, double width, double fill)
{
    file_text(file, "<path class=\"");
    file_text(file, kind);
    file_text(file, "\"");
    if (fill > 0) {
        color_write(file, " fill", color);
        file_text(file, " fill-opacity=\"");
        file_fixed(file, fill, 2);
        file_text(file, "\"");
    }
    color_write(file, " stroke", color);
    file_text(file, " stroke-width=\"");
    file_fixed(file, width, 2);
    file_text(file, "\" vector-effect=\"non-scaling-stroke\" d=\"");
}

static void path_end(struct file *file)
{
    file_text(file, "\"/>\n");
}

/* Paths, without the points that fall on the same spot as the one before. */
static bcifs_status lines_draw(struct drawing *drawing, size_t layer)
{
    struct trace trace;
    struct mark mark;
    struct spot last = {0};
    uint64_t first = 0; /* drawing->points where the path began */
    bcifs_status status = trace_open(&trace, &drawing->picture, layer);
    if (status != BCIFS_OK)
        return status;
    while (drawing_continues(drawing) && trace_next(&trace, &mark)) {
        struct spot spot = spot_of(drawing, &mark);
        if (mark.starts)
            first = drawing->points;
        if (mark.starts || spot.x != last.x || spot.y != last.y)
            spot_write(drawing, mark.starts ? "M" : "L", spot);
        last = spot;
        /* A path that is all in one spot shows as the dot that its round caps make. */
        if (mark.ends && drawing->points == first + 1)
            file_text(drawing->file, "h0");
        if (mark.closes)
            file_text(drawing->file, "Z");
    }
    return drawing_status(drawing, trace_close(&trace));
}

/* Every point as a stroke without length, whose round cap is a disk of the same size at every scale. */
static bcifs_status markers_draw(struct drawing *drawing, size_t layer)
{
    struct trace trace;
    struct mark mark;
    bcifs_status status = trace_open(&trace, &drawing->picture, layer);
    if (status != BCIFS_OK)
        return status;
    while (drawing_continues(drawing) && trace_next(&trace, &mark)) {
        spot_write(drawing, "M", spot_of(drawing, &mark));
        file_text(drawing->file, "h0");
    }
    return drawing_status(drawing, trace_close(&trace));
}

/* Writes a closed polygon counterclockwise, so that polygons that overlap do not cancel where the rule counts
 * their turns. */
static void polygon_write(struct drawing *drawing, const struct spot *spots, size_t count)
{
    double area = 0.0;
    for (size_t i = 0; i < count; i++) {
        const struct spot *a = &spots[i], *b = &spots[(i + 1) % count];
        area += (double)a->x * (double)b->y - (double)b->x * (double)a->y;
    }
    for (size_t i = 0; i < count; i++)
        spot_write(drawing, i == 0 ? "M" : "L", spots[area > 0 ? (count - i) % count : i]);
    file_text(drawing->file, "Z");
}

static bcifs_status polygons_draw(struct drawing *drawing, size_t layer)
{
    struct trace trace;
    struct mark mark;
    size_t count = 0;
    struct spot *spots = memory_new(drawing->picture.job->layers[layer].points.polygon, sizeof *spots);
    if (!spots)
        return report_memory(drawing->picture.job->report);
    bcifs_status status = trace_open(&trace, &drawing->picture, layer);
    if (status == BCIFS_OK) {
        while (drawing_continues(drawing) && trace_next(&trace, &mark)) {
            spots[count++] = spot_of(drawing, &mark);
            if (mark.ends) {
                polygon_write(drawing, spots, count);
                count = 0;
            }
        }
        status = drawing_status(drawing, trace_close(&trace));
    }
    memory_free(spots);
    return status;
}

/* ---- Loose points -------------------------------------------------------------------------------------- */

/* Which cells of a fine grid hold a point. Cells are drawn, not points: a million points make a file no
 * larger than the picture. */
struct cells {
    unsigned density; /* cells per pixel, 4 unless the picture is very large */
    size_t columns, rows;
    unsigned char *bits;
};

static bool cells_new(struct cells *cells, const struct picture *picture)
{
    uint64_t pixels = (uint64_t)picture->width * picture->height;
    cells->density = 4;
    while (pixels * cells->density * cells->density > CELLS_MOST && cells->density > 1)
        cells->density /= 2;
    cells->columns = (size_t)picture->width * cells->density + 1;
    cells->rows = (size_t)picture->height * cells->density + 1;
    cells->bits = memory_new((cells->columns * cells->rows + 7) / 8, 1);
    return cells->bits != NULL;
}

static bool cell_get(const struct cells *cells, size_t row, size_t column)
{
    size_t bit = row * cells->columns + column;
    return cells->bits[bit / 8] >> (bit % 8) & 1;
}

static void cell_set(struct cells *cells, const struct mark *mark)
{
    size_t column = (size_t)lround(mark->x * cells->density), row = (size_t)lround(mark->y * cells->density);
    size_t bit = row * cells->columns + column;
    cells->bits[bit / 8] = (unsigned char)(cells->bits[bit / 8] | 1u << bit % 8);
}

/* Neighbors in a row become one stroke. */
static void cells_write(struct drawing *drawing, const struct cells *cells)
{
    double step = drawing->grid / cells->density;
    for (size_t row = 0; row < cells->rows; row++) {
        for (size_t column = 0; column < cells->columns && drawing_continues(drawing); column++) {
            if (!cell_get(cells, row, column))
                continue;
            size_t end = column;
            while (end + 1 < cells->columns && cell_get(cells, row, end + 1))
                end++;
            spot_write(drawing, "M",
                       (struct spot){lround((double)column * step), lround((double)row * step)});
            file_text(drawing->file, "h");
            file_fixed(drawing->file, (double)(end - column) / cells->density, drawing->decimals);
            column = end;
        }
    }
}

static bcifs_status dots_draw(struct drawing *drawing, size_t layer)
{
    struct trace trace;
    struct mark mark;
    struct cells cells;
    if (!cells_new(&cells, &drawing->picture))
        return report_memory(drawing->picture.job->report);
    bcifs_status status = trace_open(&trace, &drawing->picture, layer);
    if (status == BCIFS_OK) {
        while (trace_next(&trace, &mark))
            cell_set(&cells, &mark);
        status = trace_close(&trace);
    }
    if (status == BCIFS_OK)
        cells_write(drawing, &cells);
    memory_free(cells.bits);
    return drawing_status(drawing, status);
}

/* ---- Layers -------------------------------------------------------------------------------------------- */

static bcifs_status layer_draw(struct drawing *drawing, size_t index)
{
    static const char *const kinds[] = {
        [BCIFS_CURVE] = "curve", [BCIFS_POLYGON] = "polygon", [BCIFS_LEVEL] = "level", [BCIFS_TANGENT] = "tangent",
        [BCIFS_TARGET] = "target"};
    const struct layer *layer = &drawing->picture.job->layers[index];
    const struct style *style = &drawing->picture.styles[index];
    bool loose = points_are_loose(&layer->points);
    bcifs_status status = BCIFS_OK;
    if (loose && style->marker_size == 0) {
        path_begin(drawing->file, kinds[layer->role], style->line, style->dot_size, 0);
        status = dots_draw(drawing, index);
        path_end(drawing->file);
    } else if (!loose) {
        path_begin(drawing->file, kinds[layer->role], style->line, style->line_width, style->fill);
        status = layer->points.polygon > 0 ? polygons_draw(drawing, index) : lines_draw(drawing, index);
        path_end(drawing->file);
    }
    if (status == BCIFS_OK && style->marker_size > 0) {
        path_begin(drawing->file, "points", style->marker, style->marker_size, 0);
        status = markers_draw(drawing, index);
        path_end(drawing->file);
    }
    return status;
}

/* A hundred-thousandth of the width is finer than print. */
static int decimals_for(unsigned width)
{
    return width <= 100 ? 3 : width <= 10000 ? 2 : 1;
}

bcifs_status svg_write(struct job *job, struct file *file)
{
    struct drawing drawing = {.file = file};
    bcifs_status status = picture_open(&drawing.picture, job);
    if (status != BCIFS_OK)
        return status;
    drawing.decimals = decimals_for(drawing.picture.width);
    drawing.grid = drawing.decimals == 3 ? 1000.0 : drawing.decimals == 2 ? 100.0 : 10.0;
    head_write(&drawing);
    for (size_t i = 0; i < job->layer_count && status == BCIFS_OK; i++)
        status = layer_draw(&drawing, drawing.picture.order[i]);
    file_text(file, "</g>\n</svg>\n");
    picture_close(&drawing.picture);
    return status;
}
