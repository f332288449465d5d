#include "feet.h"

#include <math.h>
#include <string.h>

#include "numeric/tolerance.h"

/* ---- One point ----------------------------------------------------------------------------------------- */

/* |a - b|², of numbers of size 1. */
static double distance_squared(const double *a, const double *b, unsigned dimension)
{
    double sum = 0;
    for (unsigned k = 0; k < dimension; k++)
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

double foot_distance(const struct feet *feet, size_t j, double position)
{
    unsigned dimension = feet->target->dimension;
    double point[TARGET_MOST_DIMENSION], share;
    size_t from, to;
    blending_segment(feet->blending, position, &from, &to, &share);
    const double *a = feet->polyline + from * dimension, *b = feet->polyline + to * dimension;
    for (unsigned k = 0; k < dimension; k++)
        point[k] = a[k] + share * (b[k] - a[k]);
    return sqrt(distance_squared(point, feet->target->points + j * dimension, dimension));
}

double feet_distance(const struct feet *feet, const double *positions)
{
    double sum = 0;
    for (size_t j = 0; j < feet->target->count; j++) {
        double distance = foot_distance(feet, j, positions[j]);
        sum += feet->target->weights[j] * distance * distance;
    }
    return sqrt(sum);
}

void foot_direction(const struct feet *feet, double position, double *direction)
{
    unsigned dimension = feet->target->dimension;
    double share;
    size_t from, to;
    blending_segment(feet->blending, position, &from, &to, &share);
    const double *a = feet->polyline + from * dimension, *b = feet->polyline + to * dimension;
    double length = sqrt(distance_squared(a, b, dimension));
    for (unsigned k = 0; k < dimension; k++)
        direction[k] = length > 0 ? (b[k] - a[k]) / length : 0;
}

/* The nearest place on the segment from a to b: a + s (b - a), 0 <= s <= 1; returns the squared distance. */
static double segment_foot(const double *a, const double *b, const double *point, unsigned dimension,
                           double *s)
{
    double along = 0, length = distance_squared(a, b, dimension), foot[TARGET_MOST_DIMENSION];
    for (unsigned k = 0; k < dimension; k++)
        along += (point[k] - a[k]) * (b[k] - a[k]);
    *s = length > 0 ? fmin(1, fmax(0, along / length)) : 0;
    for (unsigned k = 0; k < dimension; k++)
        foot[k] = a[k] + *s * (b[k] - a[k]);
    return distance_squared(foot, point, dimension);
}

/* Among `window` segments on either side of `position`, which may be any number on a closed curve. A point
 * that is on the curve already stays where it is: another place there is no nearer than by rounding. */
static double nearest(const struct feet *feet, size_t j, double position, size_t window)
{
    unsigned dimension = feet->target->dimension;
    const struct blending *blending = feet->blending;
    double whole = (double)blending->segments, middle = floor(position);
    double first = middle - (double)window, last = middle + (double)window;
    if (blending->closed && last - first >= whole) {
        first = middle - floor(whole / 2);
        last = first + whole - 1;
    } else if (!blending->closed) {
        first = fmax(first, 0);
        last = fmin(last, whole - 1);
    }
    double best = position, least = foot_distance(feet, j, position), s;
    if (least <= TOLERANCE_FITTED)
        return position;
    least *= least;
    for (double segment = first; segment <= last; segment++) {
        double wrapped = segment - whole * floor(segment / whole);
        size_t from = (size_t)wrapped, to = (from + 1) % blending->rows;
        double found = segment_foot(feet->polyline + from * dimension, feet->polyline + to * dimension,
                                    feet->target->points + j * dimension, dimension, &s);
        if (found < least) {
            least = found;
            best = segment + s;
        }
    }
    return best;
}

/* ---- Their order --------------------------------------------------------------------------------------- */

/* The nearest rising sequence in least squares: neighbors that fall are pooled at their mean. */
static void make_rise(const struct feet *feet, double *positions)
{
    size_t count = feet->target->count, pools = 0, next = 0;
    for (size_t j = 0; j < count; j++) {
        feet->means[pools] = positions[j];
        feet->counts[pools++] = 1;
        while (pools > 1 && feet->means[pools - 2] > feet->means[pools - 1]) {
            double a = (double)feet->counts[pools - 2], b = (double)feet->counts[pools - 1];
            feet->means[pools - 2] = (a * feet->means[pools - 2] + b * feet->means[pools - 1]) / (a + b);
            feet->counts[pools - 2] += feet->counts[pools - 1];
            pools--;
        }
    }
    for (size_t pool = 0; pool < pools; pool++)
        for (size_t i = 0; i < feet->counts[pool]; i++)
            positions[next++] = feet->means[pool];
}

static void feet_move(const struct feet *feet, size_t window, double *positions)
{
    size_t count = feet->target->count, last = count - 1;
    double whole = (double)feet->blending->segments;
    for (size_t j = 0; j < count; j++)
        positions[j] = nearest(feet, j, positions[j], window);
    if (!feet->blending->closed) {
        positions[0] = 0;
        positions[last] = whole;
    }
    make_rise(feet, positions);
    for (size_t j = last; feet->blending->closed && j > 0 && positions[j] > positions[0] + whole; j--)
        positions[j] = positions[0] + whole;
}

void feet_find(const struct feet *feet, double *positions)
{
    size_t size = feet->target->count * sizeof *positions;
    double distance = feet_distance(feet, positions);
    memcpy(feet->before, positions, size);
    for (size_t window = feet->window; window > 0; window /= 8) {
        feet_move(feet, window, positions);
        if (feet_distance(feet, positions) <= distance)
            return;
        memcpy(positions, feet->before, size);
    }
}
