#include "points.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "language/outline.h"
#include "output/job.h"

enum {
    PROGRESS_POINTS = 1 << 16,
    CUBIC_PARTS = 32 /* lines that a cubic piece is drawn with: they leave it by a thousandth of its size */
};

/* ---- Points of a plan ---------------------------------------------------------------------------------- */

static bcifs_path plan_path(const void *origin, size_t index)
{
    return bcifs_plan_path(origin, index);
}

static bcifs_status plan_open(const void *origin, void **walk, bcifs_error *error)
{
    bcifs_walker *walker;
    bcifs_status status = bcifs_walker_create(origin, &walker, error);
    if (status == BCIFS_OK)
        *walk = walker;
    return status;
}

static size_t plan_next(void *walk, double *points, size_t capacity)
{
    return bcifs_walker_next(walk, points, capacity);
}

static void plan_close(void *walk)
{
    bcifs_walker_free(walk);
}

struct point_source points_of_plan(const bcifs_plan *plan)
{
    return (struct point_source){.count = bcifs_plan_points(plan),
                                 .dimension = bcifs_plan_dimension(plan),
                                 .path_count = bcifs_plan_path_count(plan),
                                 .polygon = bcifs_plan_polygon(plan),
                                 .origin = plan,
                                 .path = plan_path,
                                 .open = plan_open,
                                 .next = plan_next,
                                 .close = plan_close};
}

/* ---- Points of segments -------------------------------------------------------------------------------- */

struct segments_walk {
    const struct segments *segments;
    size_t next; /* point */
};

static bcifs_path segments_path(const void *origin, size_t index)
{
    (void)origin;
    return (bcifs_path){2 * (uint64_t)index, 2, 0};
}

static bcifs_status segments_open(const void *origin, void **walk, bcifs_error *error)
{
    struct segments_walk *fresh = memory_new(1, sizeof *fresh);
    if (!fresh) {
        struct report report = report_new(NULL);
        report_memory(&report);
        return report_close(&report, error);
    }
    fresh->segments = origin;
    *walk = fresh;
    return BCIFS_OK;
}

static size_t segments_next(void *walk, double *points, size_t capacity)
{
    struct segments_walk *own = walk;
    const struct segments *segments = own->segments;
    size_t left = 2 * segments->count - own->next, count = left < capacity ? left : capacity;
    if (count > 0)
        memcpy(points, segments->points + own->next * segments->dimension,
               count * segments->dimension * sizeof *points);
    own->next += count;
    return count;
}

struct point_source points_of_segments(const struct segments *segments)
{
    return (struct point_source){.count = 2 * (uint64_t)segments->count,
                                 .dimension = segments->dimension,
                                 .path_count = segments->count,
                                 .origin = segments,
                                 .path = segments_path,
                                 .open = segments_open,
                                 .next = segments_next,
                                 .close = memory_free};
}

/* ---- Points of a drawn curve --------------------------------------------------------------------------- */

struct curve_walk {
    const bcifs_curve *curve;
    uint64_t next;
};

static uint64_t curve_count(const bcifs_curve *curve)
{
    return (uint64_t)outline_pieces(curve, false) * (curve->cubic ? CUBIC_PARTS : 1) + !curve->closed;
}

static bcifs_path curve_path(const void *origin, size_t index)
{
    const bcifs_curve *curve = origin;
    (void)index;
    return (bcifs_path){0, curve_count(curve), curve->closed};
}

static bcifs_status curve_open(const void *origin, void **walk, bcifs_error *error)
{
    struct curve_walk *fresh = memory_new(1, sizeof *fresh);
    if (!fresh) {
        struct report report = report_new(NULL);
        report_memory(&report);
        return report_close(&report, error);
    }
    fresh->curve = origin;
    *walk = fresh;
    return BCIFS_OK;
}

static size_t curve_next(void *walk, double *points, size_t capacity)
{
    struct curve_walk *own = walk;
    const bcifs_curve *curve = own->curve;
    size_t parts = curve->cubic ? CUBIC_PARTS : 1, count = 0;
    uint64_t total = curve_count(curve), pieces = outline_pieces(curve, false);
    for (; count < capacity && own->next < total; count++, own->next++) {
        bool end = own->next == pieces * parts;
        struct outline_piece piece = outline_piece(curve, (size_t)(end ? pieces - 1 : own->next / parts));
        double t = end ? 1 : (double)(own->next % parts) / (double)parts;
        outline_piece_point(&piece, t, points + count * curve->dimension);
    }
    return count;
}

struct point_source points_of_curve(const bcifs_curve *curve)
{
    return (struct point_source){.count = curve_count(curve),
                                 .dimension = curve->dimension,
                                 .path_count = 1,
                                 .origin = curve,
                                 .path = curve_path,
                                 .open = curve_open,
                                 .next = curve_next,
                                 .close = memory_free};
}

bool points_are_loose(const struct point_source *source)
{
    return source->path_count == 0 && source->polygon == 0;
}

/* ---- Groups -------------------------------------------------------------------------------------------- */

/* The first group with points among those from `number` on. */
static struct group group_from(const struct point_source *source, size_t number)
{
    if (source->polygon > 0) {
        uint64_t first = (uint64_t)number * source->polygon;
        uint64_t count = first < source->count ? source->polygon : 0;
        return (struct group){number, first, count, true};
    }
    if (source->path_count == 0)
        return (struct group){number, 0, number == 0 ? source->count : 0, false};
    for (; number < source->path_count; number++) {
        bcifs_path path = source->path(source->origin, number);
        if (path.count > 0)
            return (struct group){number, path.first, path.count, path.closed != 0};
    }
    return (struct group){number, source->count, 0, false};
}

struct group group_first(const struct point_source *source)
{
    return group_from(source, 0);
}

struct group group_next(const struct point_source *source, const struct group *group)
{
    return group_from(source, group->number + 1);
}

/* ---- Reading ------------------------------------------------------------------------------------------- */

bcifs_status reader_open(struct reader *reader, struct job *job, size_t layer)
{
    const struct point_source *source = &job->layers[layer].points;
    *reader = (struct reader){.job = job, .source = source};
    reader->tile = memory_new((size_t)TILE_POINTS * source->dimension, sizeof *reader->tile);
    if (!reader->tile)
        return report_memory(job->report);
    bcifs_error error;
    bcifs_status status = source->open(source->origin, &reader->walk, &error);
    if (status != BCIFS_OK) {
        memory_free(reader->tile);
        return report_failure(job->report, status, NULL, "%s", error.message);
    }
    return BCIFS_OK;
}

static bcifs_status tile_check(const struct reader *reader)
{
    unsigned dimension = reader->source->dimension;
    size_t count = reader->count * dimension;
    for (size_t i = 0; i < count; i++)
        if (!isfinite(reader->tile[i]))
            return report_failure(reader->job->report, BCIFS_INPUT, NULL,
                                  "the point %" PRIu64 " is not finite; the automaton may not be contractive",
                                  reader->first + i / dimension);
    return BCIFS_OK;
}

static void progress_advance(struct job *job, uint64_t points)
{
    uint64_t before = job->done / PROGRESS_POINTS;
    job->done += points;
    if (!job->progress || job->done / PROGRESS_POINTS == before)
        return;
    double share = job->done < job->total ? (double)job->done / (double)job->total : 1.0;
    job->progress(job->context, share);
}

bcifs_status reader_next(struct reader *reader)
{
    reader->first += reader->count;
    uint64_t left = reader->source->count - reader->first;
    reader->count = 0;
    if (left == 0)
        return BCIFS_OK;
    size_t wanted = left < TILE_POINTS ? (size_t)left : TILE_POINTS;
    reader->count = reader->source->next(reader->walk, reader->tile, wanted);
    if (reader->count == 0)
        return report_failure(reader->job->report, BCIFS_INPUT, NULL,
                              "the points end after %" PRIu64 " of %" PRIu64, reader->first,
                              reader->source->count);
    progress_advance(reader->job, reader->count);
    return tile_check(reader);
}

void reader_close(struct reader *reader)
{
    reader->source->close(reader->walk);
    memory_free(reader->tile);
}
