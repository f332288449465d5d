/* Drawn and listed curves: bcifs_curve_read and what is asked of a curve, see bcifs.h. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "language/outline.h"
#include "language/points.h"
#include "language/svg_document.h"
#include "numeric/tolerance.h"

/* ---- Reading ------------------------------------------------------------------------------------------- */

/* Small and capital letters are alike. */
static bool ends_with(const char *path, const char *ending)
{
    size_t length = strlen(path), wanted = strlen(ending);
    if (length < wanted)
        return false;
    for (size_t i = 0; i < wanted; i++)
        if (tolower((unsigned char)path[length - wanted + i]) != ending[i])
            return false;
    return true;
}

/* The polyline through listed points; closed when the last is the first. */
static bcifs_status polyline_read(const struct source *source, struct report *report,
                                  struct bcifs_curve *outline)
{
    bcifs_status status =
        points_from_source(source, report, &outline->points, &outline->count, &outline->dimension);
    if (status)
        return status;
    if (outline->count < 2)
        return report_failure(report, BCIFS_INPUT, source->name, "a curve has at least 2 points, found 1");
    size_t dimension = outline->dimension;
    const double *last = outline->points + (outline->count - 1) * dimension;
    bool meets = true;
    for (size_t k = 0; k < dimension; k++)
        meets = meets && last[k] == outline->points[k];
    outline->closed = meets && outline->count > 2;
    outline->count -= outline->closed;
    return BCIFS_OK;
}

bcifs_status bcifs_curve_read(const char *path, const bcifs_load_options *options, bcifs_curve **curve,
                              bcifs_error *error)
{
    struct report report = report_new(options);
    struct arena arena = {0};
    struct source *source;
    bcifs_curve *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? source_read(&arena, path, &report, &source) : report_memory(&report);
    if (status == BCIFS_OK) {
        bool svg = ends_with(path, ".svg") || (!ends_with(path, ".csv") && svg_document_likely(source));
        status = svg ? svg_document_read(source, &report, fresh) : polyline_read(source, &report, fresh);
    }
    if (status) {
        bcifs_curve_free(fresh);
        report_close(&report, error);
    } else {
        *curve = fresh;
    }
    arena_free(&arena);
    return status;
}

void bcifs_curve_free(bcifs_curve *curve)
{
    if (!curve)
        return;
    memory_free(curve->points);
    memory_free(curve);
}

/* ---- What it is ---------------------------------------------------------------------------------------- */

int bcifs_curve_is_closed(const bcifs_curve *curve)
{
    return curve->closed;
}

int bcifs_curve_is_cubic(const bcifs_curve *curve)
{
    return curve->cubic;
}

unsigned bcifs_curve_dimension(const bcifs_curve *curve)
{
    return curve->dimension;
}

const double *bcifs_curve_points(const bcifs_curve *curve, size_t *count)
{
    *count = curve->count;
    return curve->points;
}

/* ---- Points by arc length ------------------------------------------------------------------------------ */

/* The parameter at which a piece has run through `wanted` of its `length`: by Newton's method, kept between
 * bounds that close in. */
static double piece_parameter(const struct outline_piece *piece, double length, double wanted)
{
    double low = 0, high = 1, t = length > 0 ? wanted / length : 0;
    t = fmin(1, fmax(0, t));
    for (int i = 0; piece->cubic && i < 60; i++) {
        double miss = outline_piece_length(piece, 0, t) - wanted;
        if (fabs(miss) <= TOLERANCE_LENGTH * length)
            break;
        *(miss > 0 ? &high : &low) = t;
        double step = fmin(1e-4, 1 - t) + fmin(1e-4, t);
        double from = fmax(0, t - 1e-4), rate = outline_piece_length(piece, from, from + step) / step;
        t = rate > 0 ? t - miss / rate : low;
        if (!(t > low && t < high))
            t = low / 2 + high / 2;
    }
    return t;
}

bcifs_status bcifs_curve_sample(const bcifs_curve *curve, size_t count, double *points, bcifs_error *error)
{
    struct report report = report_new(NULL);
    size_t pieces = outline_pieces(curve, false), next = 0;
    double total = 0, before = 0;
    for (size_t i = 0; i < pieces; i++) {
        struct outline_piece piece = outline_piece(curve, i);
        total += outline_piece_length(&piece, 0, 1);
    }
    if (count < 2 || !(total > 0) || !isfinite(total)) {
        report_failure(&report, BCIFS_INPUT, NULL,
                       count < 2    ? "a curve is sampled at 2 points or more"
                       : total == 0 ? "the curve has no length: all its points are the same"
                                    : "the curve is too long to be measured");
        return report_close(&report, error);
    }
    double step = total / (double)(curve->closed ? count : count - 1);
    for (size_t i = 0; i < pieces && next < count; i++) {
        struct outline_piece piece = outline_piece(curve, i);
        double length = outline_piece_length(&piece, 0, 1);
        bool last = i + 1 == pieces;
        for (; next < count && (last || step * (double)next < before + length); next++)
            outline_piece_point(&piece,
                                piece_parameter(&piece, length, fmin(length, step * (double)next - before)),
                                points + next * curve->dimension);
        before += length;
    }
    return BCIFS_OK;
}
