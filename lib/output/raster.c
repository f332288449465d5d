#include "raster.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

enum { SUBROWS = 4 }; /* scan lines per row of pixels inside a polygon; along them coverage is exact */

bool canvas_new(struct canvas *canvas, unsigned width, unsigned height)
{
    size_t area = (size_t)width * height;
    *canvas = (struct canvas){.width = width, .height = height};
    canvas->pixels = memory_new(area, 3);
    canvas->coverage = memory_new(area, 1);
    if (!canvas->pixels || !canvas->coverage) {
        canvas_free(canvas);
        return false;
    }
    memset(canvas->pixels, 255, 3 * area);
    return true;
}

void canvas_free(struct canvas *canvas)
{
    memory_free(canvas->pixels);
    memory_free(canvas->coverage);
    canvas->pixels = canvas->coverage = NULL;
}

/* ---- Segments ------------------------------------------------------------------------------------------ */

/* The pixels from `low` to `high`, clipped to 0 … size − 1. */
struct span {
    long first, last;
};

static struct span span_of(double low, double high, unsigned size)
{
    double limit = (double)size - 1;
    if (high < 0 || low > limit)
        return (struct span){0, -1};
    return (struct span){(long)fmax(0, floor(low)), (long)fmin(limit, floor(high))};
}

struct segment {
    double x, y, dx, dy; /* from (x, y) to (x + dx, y + dy) */
    double square;       /* dx² + dy² */
    double reach;        /* coverage falls from 1 to 0 over the pixel that ends here */
};

/* Covers one pixel by its center's distance to the segment: exact for an edge that runs along the axes, and
 * within a few hundredths otherwise. */
static void pixel_cover(struct canvas *canvas, const struct segment *segment, long column, long row)
{
    double px = (double)column + 0.5 - segment->x, py = (double)row + 0.5 - segment->y;
    double t = segment->square > 0 ? (px * segment->dx + py * segment->dy) / segment->square : 0.0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    double ex = px - t * segment->dx, ey = py - t * segment->dy;
    double covered = segment->reach - sqrt(ex * ex + ey * ey);
    if (covered <= 0)
        return;
    unsigned char level = (unsigned char)(covered >= 1 ? 255 : covered * 255 + 0.5);
    unsigned char *pixel = &canvas->coverage[(size_t)row * canvas->width + (size_t)column];
    if (level > *pixel)
        *pixel = level;
}

/* The part of the segment that can touch the strip [low, high] of the axis along (start, delta), as positions
 * on the axis across. */
static void strip_cut(double low, double high, double start, double delta, double across, double across_delta,
                      double *least, double *most)
{
    double t0 = (low - start) / delta, t1 = (high - start) / delta;
    t0 = fmin(1, fmax(0, t0));
    t1 = fmin(1, fmax(0, t1));
    double a = across + t0 * across_delta, b = across + t1 * across_delta;
    *least = fmin(a, b);
    *most = fmax(a, b);
}

void canvas_segment(struct canvas *canvas, double x0, double y0, double x1, double y1, double width)
{
    struct segment segment = {x0, y0, x1 - x0, y1 - y0, 0, width / 2 + 0.5};
    segment.square = segment.dx * segment.dx + segment.dy * segment.dy;
    double reach = segment.reach;
    bool steep = fabs(segment.dy) > fabs(segment.dx);
    double start = steep ? y0 : x0, delta = steep ? segment.dy : segment.dx;
    double across = steep ? x0 : y0, across_delta = steep ? segment.dx : segment.dy;
    struct span along = span_of(fmin(start, start + delta) - reach, fmax(start, start + delta) + reach,
                                steep ? canvas->height : canvas->width);
    for (long i = along.first; i <= along.last; i++) {
        double least = across, most = across;
        if (delta != 0)
            strip_cut((double)i + 0.5 - reach, (double)i + 0.5 + reach, start, delta, across, across_delta,
                      &least, &most);
        struct span span = span_of(least - reach, most + reach, steep ? canvas->width : canvas->height);
        for (long j = span.first; j <= span.last; j++)
            pixel_cover(canvas, &segment, steep ? j : i, steep ? i : j);
    }
}

/* ---- Polygons ------------------------------------------------------------------------------------------ */

/* Where the horizontal line at y crosses the polygon, from left to right. */
static size_t crossings_find(const double *xy, size_t count, double y, struct crossing *crossings)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        const double *a = &xy[2 * i], *b = &xy[2 * ((i + 1) % count)];
        if ((a[1] <= y) == (b[1] <= y))
            continue;
        struct crossing crossing = {a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]), a[1] <= y ? 1 : -1};
        size_t place = found++;
        for (; place > 0 && crossings[place - 1].x > crossing.x; place--)
            crossings[place] = crossings[place - 1];
        crossings[place] = crossing;
    }
    return found;
}

/* Adds the part of each pixel of a row that [x0, x1] covers, over SUBROWS. */
static void run_cover(unsigned char *row, unsigned width, double x0, double x1)
{
    x0 = fmax(x0, 0);
    x1 = fmin(x1, width);
    for (long i = (long)floor(x0); (double)i < x1; i++) {
        double covered = fmin(x1, (double)i + 1) - fmax(x0, (double)i);
        int level = row[i] + (int)(covered * 255 / SUBROWS + 0.5);
        row[i] = (unsigned char)(level > 255 ? 255 : level);
    }
}

void canvas_polygon(struct canvas *canvas, const double *xy, size_t count, struct crossing *crossings)
{
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        low = fmin(low, xy[2 * i + 1]);
        high = fmax(high, xy[2 * i + 1]);
    }
    struct span rows = span_of(low, high, canvas->height);
    for (long row = rows.first; row <= rows.last; row++) {
        for (int sub = 0; sub < SUBROWS; sub++) {
            double y = (double)row + (sub + 0.5) / SUBROWS;
            size_t found = crossings_find(xy, count, y, crossings);
            int winding = 0;
            for (size_t i = 0; i + 1 < found; i++) {
                winding += crossings[i].turn;
                if (winding != 0)
                    run_cover(canvas->coverage + (size_t)row * canvas->width, canvas->width, crossings[i].x,
                              crossings[i + 1].x);
            }
        }
    }
}

/* ---- Painting ------------------------------------------------------------------------------------------ */

static void pixel_blend(unsigned char *pixel, struct color color, double opacity)
{
    pixel[0] = (unsigned char)(pixel[0] + (color.red - pixel[0]) * opacity + 0.5);
    pixel[1] = (unsigned char)(pixel[1] + (color.green - pixel[1]) * opacity + 0.5);
    pixel[2] = (unsigned char)(pixel[2] + (color.blue - pixel[2]) * opacity + 0.5);
}

void canvas_paint(struct canvas *canvas, struct color color, double opacity)
{
    size_t area = (size_t)canvas->width * canvas->height;
    for (size_t i = 0; i < area; i++)
        if (canvas->coverage[i] > 0)
            pixel_blend(canvas->pixels + 3 * i, color, opacity * canvas->coverage[i] / 255);
    memset(canvas->coverage, 0, area);
}

/* ---- Density ------------------------------------------------------------------------------------------- */

bool density_new(struct density *density, unsigned width, unsigned height)
{
    *density = (struct density){.width = width, .height = height};
    density->counts = memory_new((size_t)width * height, sizeof *density->counts);
    return density->counts != NULL;
}

void density_free(struct density *density)
{
    memory_free(density->counts);
    density->counts = NULL;
}

static void count_add(struct density *density, long column, long row, unsigned weight)
{
    if (column < 0 || row < 0 || column >= (long)density->width || row >= (long)density->height)
        return;
    uint32_t *count = &density->counts[(size_t)row * density->width + (size_t)column];
    *count = *count > UINT32_MAX - weight ? UINT32_MAX : *count + weight;
}

void density_add(struct density *density, double x, double y)
{
    /* In sixteenths of a pixel, from the center of the pixel up and to the left. */
    long fx = lround((x - 0.5) * 16), fy = lround((y - 0.5) * 16);
    long column = fx >> 4, row = fy >> 4;
    unsigned right = (unsigned)(fx & 15), below = (unsigned)(fy & 15);
    count_add(density, column, row, (16 - right) * (16 - below));
    count_add(density, column + 1, row, right * (16 - below));
    count_add(density, column, row + 1, (16 - right) * below);
    count_add(density, column + 1, row + 1, right * below);
}

void density_paint(const struct density *density, struct canvas *canvas, struct color color)
{
    /* A whole point on a pixel has already this share of the color: addresses are equally likely, so the
     * outer parts of an attractor often have one point where the inner ones have thousands. */
    const double single = 0.65;
    size_t area = (size_t)density->width * density->height;
    uint32_t most = 0;
    for (size_t i = 0; i < area; i++)
        most = density->counts[i] > most ? density->counts[i] : most;
    double range = log1p(most / 256.0);
    for (size_t i = 0; i < area; i++)
        if (density->counts[i] > 0) {
            double count = density->counts[i] / 256.0;
            double tone = single * fmin(1, count) + (1 - single) * log1p(count) / range;
            pixel_blend(canvas->pixels + 3 * i, color, tone);
        }
}
