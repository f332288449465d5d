#include "picture.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

/* A twenty-fifth of the width on every side keeps lines and markers off the edge. */
static const double MARGIN = 0.04;
/* Height over width: nothing is drawn flatter or taller; a graph is drawn so. */
static const double FLATTEST = 0.125, TALLEST = 2.0, GRAPH = 0.5;
/* A side shorter than this part of the coordinates is rounding, and no extent at all; neither is one so short
 * that the scale would overflow. */
static const double ROUNDING = 0x1p-45, SHORTEST = 1e-290;

/* ---- Colors -------------------------------------------------------------------------------------------- */

/* The curve is nearly black, the control polygon stands back in gray-blue. */
static const struct color INK = {0x1c, 0x1c, 0x1c}, POLYGON_LINE = {0x93, 0xa6, 0xba},
                          POLYGON_MARKER = {0x5b, 0x76, 0x94}, TANGENT_LINE = {0xc6, 0x28, 0x28},
                          TARGET_LINE = {0xcc, 0xcc, 0xcc};

/* Levels run from ochre to deep blue. Lightness falls all the way, so that the order also shows in gray print
 * and to color-blind eyes. */
static const struct color LEVELS[] = {
    {0xdf, 0xa2, 0x2e}, {0xd0, 0x6f, 0x4a}, {0xab, 0x48, 0x75}, {0x6a, 0x3f, 0x95}, {0x2a, 0x3a, 0x7c}};

static unsigned char channel_between(unsigned char from, unsigned char to, double share)
{
    return (unsigned char)(from + (to - from) * share + 0.5);
}

/* The color of level `rank` of `count`, from the coarsest; the finest keeps clear of the ink. */
static struct color level_color(size_t rank, size_t count)
{
    size_t last = sizeof LEVELS / sizeof LEVELS[0] - 1;
    double place = count > 1 ? (double)rank / (double)(count - 1) * (double)last : 1.0;
    size_t index = place < (double)(last - 1) ? (size_t)place : last - 1;
    double share = place - (double)index;
    const struct color *from = &LEVELS[index], *to = &LEVELS[index + 1];
    return (struct color){channel_between(from->red, to->red, share),
                          channel_between(from->green, to->green, share),
                          channel_between(from->blue, to->blue, share)};
}

/* Loose points shrink from four pixels to one as they become many. */
static double dot_size(uint64_t count)
{
    return fmin(4.0, fmax(1.0, 120.0 / sqrt((double)count)));
}

/* The blue, green and red of [MR], light enough for the polygon, dark enough for the curve on it. */
static const struct color INK_LINES[] = {[BCIFS_BLUE] = {0x1f, 0x4e, 0xb4}, [BCIFS_GREEN] = {0x1d, 0x8a, 0x34},
                                         [BCIFS_RED] = {0xcc, 0x1f, 0x1f}},
                          INK_POLYGONS[] = {[BCIFS_BLUE] = {0xa9, 0xbd, 0xe6}, [BCIFS_GREEN] = {0xa3, 0xd6, 0xae},
                                            [BCIFS_RED] = {0xee, 0xae, 0xae}};

/* Colors chosen by the caller take the place of the role's. */
static void style_ink(struct style *style, bcifs_role role, bcifs_ink ink)
{
    if (ink == BCIFS_INK_OF_ROLE)
        return;
    style->line = role == BCIFS_POLYGON ? INK_POLYGONS[ink] : INK_LINES[ink];
    style->marker = INK_LINES[ink];
}

static struct style style_of(const struct layer *layer, size_t level, size_t levels)
{
    struct style style = {
        .line = INK, .marker = INK, .line_width = 1.3, .dot_size = dot_size(layer->points.count)};
    if (layer->role == BCIFS_LEVEL) {
        style.line = style.marker = level_color(level, levels);
        style.line_width = 1.1;
    } else if (layer->role == BCIFS_POLYGON) {
        style.line = POLYGON_LINE;
        style.marker = POLYGON_MARKER;
        style.line_width = 1.0;
        style.marker_size = 5.0;
    }
    if (layer->role == BCIFS_TANGENT) {
        style.line = style.marker = TANGENT_LINE;
        style.line_width = 1.6;
    }
    if (layer->role == BCIFS_TARGET) { /* so wide that it shows on both sides of the curve on it */
        style.line = style.marker = TARGET_LINE;
        style.line_width = 5.0;
    }
    style_ink(&style, layer->role, layer->ink);
    if (layer->points.polygon > 0 && layer->role != BCIFS_POLYGON) {
        style.fill = 0.12;
        style.line_width = 0.7;
    }
    return style;
}

/* ---- Order --------------------------------------------------------------------------------------------- */

static int role_rank(bcifs_role role)
{
    static const int ranks[] = {
        [BCIFS_TARGET] = 0, [BCIFS_POLYGON] = 1, [BCIFS_LEVEL] = 2, [BCIFS_CURVE] = 3, [BCIFS_TANGENT] = 4};
    return ranks[role];
}

/* Whether layer `a` is drawn before `b`: targets, polygons, then levels from coarse to fine, curves, half-tangents. */
static bool layer_precedes(const struct job *job, size_t a, size_t b)
{
    const struct layer *one = &job->layers[a], *other = &job->layers[b];
    int difference = role_rank(one->role) - role_rank(other->role);
    if (difference != 0)
        return difference < 0;
    if (one->role == BCIFS_LEVEL && one->points.count != other->points.count)
        return one->points.count < other->points.count;
    return a < b;
}

/* Insertion sort: the layers are few. */
static void layers_arrange(struct picture *picture)
{
    const struct job *job = picture->job;
    size_t levels = 0, level = 0;
    for (size_t i = 0; i < job->layer_count; i++) {
        size_t place = i;
        for (; place > 0 && layer_precedes(job, i, picture->order[place - 1]); place--)
            picture->order[place] = picture->order[place - 1];
        picture->order[place] = i;
        levels += job->layers[i].role == BCIFS_LEVEL;
    }
    for (size_t i = 0; i < job->layer_count; i++) {
        const struct layer *layer = &job->layers[picture->order[i]];
        picture->styles[picture->order[i]] = style_of(layer, level, levels);
        level += layer->role == BCIFS_LEVEL;
    }
}

/* ---- Projection and bounds ----------------------------------------------------------------------------- */

/* (x, y, z) ↦ (u, v). The axonometry is scaled by √6/4, so that the largest coordinates do not overflow. */
static void project(unsigned dimension, const double *point, double parameter, double *u, double *v)
{
    if (dimension == 1) {
        *u = parameter;
        *v = point[0];
    } else if (dimension == 2) {
        *u = point[0];
        *v = point[1];
    } else {
        const double c = 0.43301270189221932338; /* √3/4 */
        *u = c * point[0] + c * point[1];
        *v = 0.5 * point[2] + (0.25 * point[1] - 0.25 * point[0]);
    }
}

struct bounds {
    double u0, u1, v0, v1;
};

static void bounds_include(struct bounds *bounds, double u, double v)
{
    bounds->u0 = fmin(bounds->u0, u);
    bounds->u1 = fmax(bounds->u1, u);
    bounds->v0 = fmin(bounds->v0, v);
    bounds->v1 = fmax(bounds->v1, v);
}

static void box_include(struct picture *picture, const double *point)
{
    for (unsigned k = 0; k < picture->dimension; k++) {
        picture->low[k] = fmin(picture->low[k], point[k]);
        picture->high[k] = fmax(picture->high[k], point[k]);
    }
}

static bcifs_status layer_measure(struct picture *picture, size_t layer, struct bounds *bounds)
{
    struct reader reader;
    bcifs_status status = reader_open(&reader, picture->job, layer);
    if (status != BCIFS_OK)
        return status;
    while ((status = reader_next(&reader)) == BCIFS_OK && reader.count > 0) {
        for (size_t i = 0; i < reader.count; i++) {
            const double *point = reader.tile + i * picture->dimension;
            double u, v;
            project(picture->dimension, point, 0.0, &u, &v);
            bounds_include(bounds, u, v);
            if (layer == 0)
                box_include(picture, point);
        }
    }
    reader_close(&reader);
    return status;
}

static bcifs_status picture_measure(struct picture *picture, struct bounds *bounds)
{
    *bounds = (struct bounds){INFINITY, -INFINITY, INFINITY, -INFINITY};
    for (unsigned k = 0; k < 3; k++) {
        picture->low[k] = INFINITY;
        picture->high[k] = -INFINITY;
    }
    for (size_t i = 0; i < picture->job->layer_count; i++) {
        bcifs_status status = layer_measure(picture, i, bounds);
        if (status != BCIFS_OK)
            return status;
    }
    if (picture->dimension == 1)
        bounds->u0 = 0.0, bounds->u1 = 1.0;
    if (bounds->u0 > bounds->u1 || bounds->v0 > bounds->v1)
        *bounds = (struct bounds){0}; /* no points */
    return BCIFS_OK;
}

/* ---- Fitting ------------------------------------------------------------------------------------------- */

/* Half the length of an interval, for the whole may overflow; 0 when it is nothing but rounding. */
static double half_extent(double low, double high)
{
    double half = high / 2 - low / 2;
    return half <= ROUNDING * fmax(fabs(low), fabs(high)) || half < SHORTEST ? 0.0 : half;
}

/* The pixels per half unit at which an extent fills `room`. */
static double half_scale(double room, double half)
{
    return half > 0.0 ? room / half : 0.0;
}

static void picture_fit(struct picture *picture, const struct bounds *bounds)
{
    double width = picture->job->width, margins = 2 * MARGIN * width;
    double tallest = fmin(TALLEST * width, PICTURE_MOST_WIDTH), height;
    double u = half_extent(bounds->u0, bounds->u1), v = half_extent(bounds->v0, bounds->v1);
    double scale_u, scale_v;
    if (picture->dimension == 1) {
        height = floor(GRAPH * width);
        scale_u = half_scale(width - margins, u);
        scale_v = half_scale(height - margins, v);
    } else {
        bool wide = u > 0.0 && v / u <= (tallest - margins) / (width - margins);
        scale_u = scale_v = wide ? half_scale(width - margins, u) : half_scale(tallest - margins, v);
        /* Rounding up, but not over a whole number that was missed by rounding alone. */
        height = ceil(v * scale_v + margins - 1e-3);
        height = fmin(tallest, fmax(height, ceil(FLATTEST * width)));
    }
    picture->width = picture->job->width;
    picture->height = (unsigned)height;
    picture->u0 = bounds->u0;
    picture->v0 = bounds->v0;
    picture->scale_u = scale_u / 2;
    picture->scale_v = scale_v / 2;
    picture->left = width / 2 - (bounds->u1 / 2 - bounds->u0 / 2) / 2 * scale_u;
    picture->bottom = height / 2 + (bounds->v1 / 2 - bounds->v0 / 2) / 2 * scale_v;
}

static void mark_place(const struct picture *picture, double u, double v, struct mark *mark)
{
    mark->x = picture->left + (u / 2 - picture->u0 / 2) * (2 * picture->scale_u);
    mark->y = picture->bottom - (v / 2 - picture->v0 / 2) * (2 * picture->scale_v);
}

/* ---- Opening ------------------------------------------------------------------------------------------- */

static bcifs_status picture_check(const struct picture *picture)
{
    struct job *job = picture->job;
    if (picture->dimension > 3)
        return report_failure(
            job->report, BCIFS_INPUT, NULL,
            "a picture draws points of at most 3 coordinates, these have %u; write .csv or .npy",
            picture->dimension);
    for (size_t i = 1; i < job->layer_count; i++)
        if (job->layers[i].points.dimension != picture->dimension)
            return report_failure(job->report, BCIFS_INPUT, NULL,
                                  "the layers have points of %u and of %u coordinates", picture->dimension,
                                  job->layers[i].points.dimension);
    if (job->width < PICTURE_LEAST_WIDTH || job->width > PICTURE_MOST_WIDTH)
        return report_failure(job->report, BCIFS_INPUT, NULL, "a picture is %d to %d pixels wide, not %u",
                              PICTURE_LEAST_WIDTH, PICTURE_MOST_WIDTH, job->width);
    return BCIFS_OK;
}

bcifs_status picture_open(struct picture *picture, struct job *job)
{
    *picture = (struct picture){.job = job, .dimension = job->layers[0].points.dimension};
    bcifs_status status = picture_check(picture);
    if (status != BCIFS_OK)
        return status;
    job->total = 0;
    for (size_t i = 0; i < job->layer_count; i++)
        job->total += 2 * job->layers[i].points.count;
    picture->order = memory_new(job->layer_count, sizeof *picture->order);
    picture->styles = memory_new(job->layer_count, sizeof *picture->styles);
    struct bounds bounds = {0};
    status =
        picture->order && picture->styles ? picture_measure(picture, &bounds) : report_memory(job->report);
    if (status != BCIFS_OK) {
        picture_close(picture);
        return status;
    }
    layers_arrange(picture);
    picture_fit(picture, &bounds);
    return BCIFS_OK;
}

void picture_close(struct picture *picture)
{
    memory_free(picture->order);
    memory_free(picture->styles);
    picture->order = NULL;
    picture->styles = NULL;
}

/* ---- Tracing ------------------------------------------------------------------------------------------- */

bcifs_status trace_open(struct trace *trace, const struct picture *picture, size_t layer)
{
    *trace = (struct trace){.picture = picture};
    bcifs_status status = reader_open(&trace->reader, picture->job, layer);
    if (status == BCIFS_OK)
        trace->group = group_first(trace->reader.source);
    return status;
}

/* Where the graph of a curve, or of all loose points, has a point: they share 0..1 equally. Polygons, having
 * no parameter, stand one after the other. */
static double trace_parameter(const struct trace *trace, uint64_t index)
{
    const struct group *group = &trace->group;
    bool polygons = trace->reader.source->polygon > 0;
    uint64_t count = polygons ? trace->reader.source->count : group->count;
    uint64_t steps = group->closed && !polygons ? count : count - 1;
    return steps > 0 ? (double)(polygons ? index : index - group->first) / (double)steps : 0.0;
}

/* The graph of a closed curve does not close, it comes back to its first value at 1. */
static bool graph_close(struct trace *trace, struct mark *mark)
{
    trace->closing = false;
    mark_place(trace->picture, 1.0, trace->start, mark);
    mark->starts = mark->closes = false;
    mark->ends = true;
    return true;
}

bool trace_next(struct trace *trace, struct mark *mark)
{
    struct reader *reader = &trace->reader;
    if (trace->closing)
        return graph_close(trace, mark);
    if (trace->next == reader->count) {
        trace->status = reader_next(reader);
        trace->next = 0;
        if (trace->status != BCIFS_OK || reader->count == 0)
            return false;
    }
    unsigned dimension = trace->picture->dimension;
    uint64_t index = reader->first + trace->next;
    const double *point = reader->tile + trace->next++ * dimension;
    double u, v;
    project(dimension, point, dimension == 1 ? trace_parameter(trace, index) : 0.0, &u, &v);
    mark_place(trace->picture, u, v, mark);
    mark->starts = index == trace->group.first;
    mark->ends = index + 1 == trace->group.first + trace->group.count;
    mark->closes = mark->ends && trace->group.closed;
    if (dimension == 1 && reader->source->polygon == 0) {
        trace->start = mark->starts ? point[0] : trace->start;
        trace->closing = mark->closes;
        mark->ends = mark->ends && !mark->closes;
        mark->closes = false;
    }
    if (index + 1 == trace->group.first + trace->group.count)
        trace->group = group_next(reader->source, &trace->group);
    return true;
}

bcifs_status trace_close(struct trace *trace)
{
    reader_close(&trace->reader);
    return trace->status;
}
