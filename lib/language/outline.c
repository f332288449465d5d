#include "outline.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

bcifs_status outline_add(struct bcifs_curve *outline, const double *points, size_t count)
{
    unsigned dimension = outline->dimension;
    if (count > OUTLINE_MOST_POINTS - outline->count)
        return BCIFS_INPUT;
    if (outline->capacity < outline->count + count) {
        size_t capacity = 2 * outline->capacity + count + 64;
        double *grown = memory_resize(outline->points, capacity, dimension * sizeof *grown);
        if (!grown)
            return BCIFS_MEMORY;
        outline->points = grown;
        outline->capacity = capacity;
    }
    memcpy(outline->points + outline->count * dimension, points, count * dimension * sizeof *points);
    outline->count += count;
    return BCIFS_OK;
}

/* ---- Pieces -------------------------------------------------------------------------------------------- */

size_t outline_pieces(const struct bcifs_curve *outline, bool close)
{
    size_t step = outline->cubic ? 3 : 1;
    if (outline->closed)
        return outline->count / step;
    return (outline->count - 1) / step + close;
}

struct outline_piece outline_piece(const struct bcifs_curve *outline, size_t index)
{
    size_t step = outline->cubic ? 3 : 1, first = index * step;
    struct outline_piece piece = {.dimension = outline->dimension, .cubic = outline->cubic};
    if (!outline->closed && first + step >= outline->count) {
        piece.cubic = false; /* the line that closes it */
        step = 1;
    }
    for (size_t j = 0; j <= step; j++)
        piece.points[j] = outline->points + (first + j) % outline->count * outline->dimension;
    return piece;
}

/* Σ B_j(t) p_j, with Bernstein's polynomials. */
void outline_piece_point(const struct outline_piece *piece, double t, double *point)
{
    double s = 1 - t;
    double weights[4] = {s, t};
    if (piece->cubic) {
        weights[0] = s * s * s;
        weights[1] = 3 * s * s * t;
        weights[2] = 3 * s * t * t;
        weights[3] = t * t * t;
    }
    for (unsigned k = 0; k < piece->dimension; k++) {
        point[k] = 0;
        for (int j = 0; j < (piece->cubic ? 4 : 2); j++)
            point[k] += weights[j] * piece->points[j][k];
    }
}

/* |c'(t)|, without overflow of squares. */
static double speed(const struct outline_piece *piece, double t)
{
    double s = 1 - t, sum = 0;
    for (unsigned k = 0; k < piece->dimension; k++) {
        double p0 = piece->points[0][k], p1 = piece->points[1][k], rate = p1 - p0;
        if (piece->cubic) {
            double p2 = piece->points[2][k], p3 = piece->points[3][k];
            rate = 3 * (s * s * (p1 - p0) + 2 * s * t * (p2 - p1) + t * t * (p3 - p2));
        }
        sum = hypot(sum, rate);
    }
    return sum;
}

/* ∫|c'|, by Gauss and Legendre's rule with five nodes on each of a few parts: sixteen of a whole cubic leave
 * an error below 1e-12 of its length unless it has a cusp. */
double outline_piece_length(const struct outline_piece *piece, double from, double to)
{
    static const double nodes[] = {0, 0.53846931010568309, 0.90617984593866399};
    static const double weights[] = {0.56888888888888889, 0.47862867049936647, 0.23692688505618909};
    int parts = piece->cubic ? (int)ceil(16 * (to - from)) : 1;
    double sum = 0;
    if (!piece->cubic)
        return (to - from) * speed(piece, 0);
    for (int i = 0; i < parts; i++) {
        double half = (to - from) / (2 * parts), middle = from + (2 * i + 1) * half;
        sum += half * weights[0] * speed(piece, middle);
        for (int k = 1; k < 3; k++)
            sum += half * weights[k] *
                   (speed(piece, middle - half * nodes[k]) + speed(piece, middle + half * nodes[k]));
    }
    return sum;
}
