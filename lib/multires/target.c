#include "target.h"

#include <math.h>

/* Center and scale of the control points: the middle of their box, and a power of 2, by which nothing is
 * rounded. */
static void box_find(struct target *target, const struct bcifs_curve *outline)
{
    double extent = 0;
    for (unsigned k = 0; k < target->dimension; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < outline->count; i++) {
            low = fmin(low, outline->points[i * target->dimension + k]);
            high = fmax(high, outline->points[i * target->dimension + k]);
        }
        target->center[k] = low / 2 + high / 2;
        extent = fmax(extent, high / 2 - low / 2);
    }
    int exponent;
    frexp(extent, &exponent);
    target->scale = extent > 0 ? ldexp(1, exponent > 1023 ? 1023 : exponent) : 0;
}

/* The outline in coordinates of size 1. */
static bcifs_status outline_scale(const struct target *target, const struct bcifs_curve *outline,
                                  struct bcifs_curve *scaled, struct arena *arena, struct report *report)
{
    *scaled = *outline;
    size_t count = outline->count * target->dimension;
    scaled->points = arena_new(arena, count, sizeof *scaled->points);
    if (!scaled->points)
        return report_memory(report);
    for (size_t i = 0; i < count; i++) {
        double center = target->center[i % target->dimension];
        scaled->points[i] = (outline->points[i] / 2 - center / 2) / target->scale * 2;
    }
    return BCIFS_OK;
}

/* The length of a part of a piece. Points of one coordinate are values of a function, whose parameter every
 * piece has an equal share of: that is what is measured then. */
static double part_length(const struct outline_piece *piece, double from, double to)
{
    return piece->dimension == 1 ? to - from : outline_piece_length(piece, from, to);
}

/* The parts that a piece is divided into, none longer than the `wanted`-th of the whole. */
static size_t piece_parts(double length, double total, size_t wanted)
{
    double parts = ceil(length / total * (double)wanted);
    return parts < 1 ? 1 : (size_t)parts;
}

/* Counts the points; lengths[i] receives that of piece i. */
static bcifs_status pieces_measure(struct target *target, const struct bcifs_curve *outline, size_t pieces,
                                   size_t wanted, double *lengths, double *total, struct report *report)
{
    *total = 0;
    for (size_t i = 0; i < pieces; i++) {
        struct outline_piece piece = outline_piece(outline, i);
        lengths[i] = part_length(&piece, 0, 1);
        *total += lengths[i];
    }
    if (!(*total > 0))
        return report_failure(report, BCIFS_INPUT, NULL,
                              "the target has no length: all its points are the same");
    target->count = 0;
    for (size_t i = 0; i < pieces; i++)
        target->count += piece_parts(lengths[i], *total, wanted);
    return BCIFS_OK;
}

/* Points, and where they are, without the last of an open target. */
static void points_fill(struct target *target, const struct bcifs_curve *outline, size_t pieces,
                        size_t wanted, const double *lengths, double total)
{
    size_t next = 0;
    double before = 0;
    for (size_t i = 0; i < pieces; i++) {
        struct outline_piece piece = outline_piece(outline, i);
        size_t parts = piece_parts(lengths[i], total, wanted);
        for (size_t j = 0; j < parts; j++, next++) {
            double share = (double)j / (double)parts;
            outline_piece_point(&piece, share, target->points + next * target->dimension);
            target->lengths[next] = fmin(1, (before + part_length(&piece, 0, share)) / total);
            target->shares[next] = ((double)i + share) / (double)pieces;
        }
        before += lengths[i];
    }
}

static void weights_fill(struct target *target, bool closed)
{
    size_t last = target->count - 1;
    for (size_t i = 0; i <= last; i++) {
        double before = i > 0 ? target->lengths[i - 1] : closed ? target->lengths[last] - 1 : 0;
        double after = i < last ? target->lengths[i + 1] : 1;
        target->weights[i] = (after - before) / 2;
    }
}

bcifs_status target_create(struct target *target, const struct bcifs_curve *outline, bool closed,
                           size_t wanted, struct arena *arena, struct report *report)
{
    struct bcifs_curve scaled;
    double total;
    *target = (struct target){.dimension = outline->dimension};
    if (outline->dimension > TARGET_MOST_DIMENSION)
        return report_failure(report, BCIFS_INPUT, NULL, "a target has at most %d coordinates, found %u",
                              TARGET_MOST_DIMENSION, outline->dimension);
    size_t pieces = outline_pieces(outline, closed);
    if (pieces + wanted > TARGET_MOST_POINTS)
        return report_failure(report, BCIFS_INPUT, NULL, "the target has %zu pieces; the limit is %d", pieces,
                              TARGET_MOST_POINTS - (int)wanted);
    box_find(target, outline);
    if (target->scale == 0)
        return report_failure(report, BCIFS_INPUT, NULL,
                              "the target has no length: all its points are the same");
    double *lengths = arena_new(arena, pieces, sizeof *lengths);
    bcifs_status status = outline_scale(target, outline, &scaled, arena, report);
    if (status || !lengths)
        return status ? status : report_memory(report);
    status = pieces_measure(target, &scaled, pieces, wanted, lengths, &total, report);
    if (status)
        return status;
    size_t count = target->count + !closed;
    target->points = arena_new(arena, count * target->dimension, sizeof *target->points);
    target->weights = arena_new(arena, count, sizeof *target->weights);
    target->lengths = arena_new(arena, count, sizeof *target->lengths);
    target->shares = arena_new(arena, count, sizeof *target->shares);
    if (!target->points || !target->weights || !target->lengths || !target->shares)
        return report_memory(report);
    points_fill(target, &scaled, pieces, wanted, lengths, total);
    if (!closed) {
        struct outline_piece piece = outline_piece(&scaled, pieces - 1);
        outline_piece_point(&piece, 1, target->points + target->count * target->dimension);
        target->lengths[target->count] = target->shares[target->count] = 1;
        target->count++;
    }
    weights_fill(target, closed);
    return BCIFS_OK;
}
