/* Invariant polytopes: N. Guglielmi and V. Protasov, Exact computation of joint spectral characteristics of
 * linear operators (2013).
 *
 * At every node x stands the absolutely convex hull P_x of vertices v: all Σ c v with Σ |c| <= 1. When every
 * matrix A : R^y → R^x of the block takes every vertex of P_y into κ P_x, the hulls are unit balls of norms
 * in which no matrix is longer than κ, so the radius is at most κ. The vertices are the leading eigenvectors
 * of the candidate's product and its cyclic shifts, and their images divided by the candidate's radius, as
 * long as these lie outside. With a complex leading eigenvalue the coefficients c are complex (balanced
 * complex polytopes, Guglielmi and Zennaro, 2007).
 *
 * Which vertices there are, and by which coefficients an image is written, is found without any care for
 * rounding. The certificate is what is computed from them at the end: see certify. */
#include "joint_block.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "numeric/eigen.h"
#include "numeric/enclosure.h"
#include "numeric/tolerance.h"

enum { MOST_VERTICES = 4000, MOST_PIVOTS = 400, FRESH_PIVOTS = 40 };

static const double ARTIFICIAL_COST =
    1e5; /* of leaving the span of the vertices; true coefficients stay below */
static const double THICKNESS =
    1e-2; /* of the hulls, before anything is known; the cycles' vertices have size 1 */
static const size_t ARTIFICIAL = SIZE_MAX;

/* Coefficient re + i im of a vertex. */
struct term {
    size_t vertex;
    double re, im;
};

/* P_x in real coordinates: `width` is dimension (real) or twice that (complex: real parts, then imaginary
 * ones). */
struct hull {
    size_t dimension, width;
    double *vertices; /* count × width */
    size_t count, capacity;
    /* The last basis of the linear program: `width` columns, phase times vertex, and the inverse of their
     * matrix. */
    struct term *basis;
    double *columns; /* width × width, column j in row j */
    double *inverse; /* width × width */
    double *amounts, *prices, *direction;
    int pivots; /* since `inverse` was computed afresh */
};

/* The image of a vertex under an edge, written in vertices of the hull it falls in. */
struct image {
    size_t edge, vertex;
    struct term *terms;
    size_t count;
    bool defines; /* a vertex, the only term */
};

struct polytope {
    const struct block *block;
    struct arena *arena;
    double radius;
    bool complex_case;
    struct hull *hulls;
    size_t *entering, *first_entering; /* edges by the node they lead to */
    struct {
        size_t node, vertex;
    } * queue;
    size_t queue_count, queue_capacity;
    struct image *images;
    size_t image_count, image_capacity;
    double work, most_work;
};

/* ---- The gauge of a vector ----------------------------------------------------------------------------- */

static void hull_reset(struct hull *hull)
{
    size_t n = hull->width;
    memset(hull->columns, 0, n * n * sizeof(double));
    memset(hull->inverse, 0, n * n * sizeof(double));
    for (size_t i = 0; i < n; i++) {
        hull->columns[i * n + i] = hull->inverse[i * n + i] = 1;
        hull->basis[i] = (struct term){ARTIFICIAL, 1, 0};
    }
    hull->pivots = 0;
}

/* The column of a vertex times re + i im. */
static void column_make(const struct hull *hull, const struct term *term, double *column)
{
    const double *v = hull->vertices + term->vertex * hull->width;
    size_t n = hull->width, d = hull->dimension;
    if (n == d) {
        for (size_t i = 0; i < n; i++)
            column[i] = term->re * v[i];
        return;
    }
    for (size_t i = 0; i < d; i++) {
        column[i] = term->re * v[i] - term->im * v[d + i];
        column[d + i] = term->im * v[i] + term->re * v[d + i];
    }
}

/* inverse <- columns^-1 by Gauss-Jordan elimination with pivoting. False when singular. */
static bool hull_invert(struct hull *hull, double *workspace)
{
    size_t n = hull->width;
    double *a = workspace, *b = hull->inverse;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            a[i * n + j] = hull->columns[j * n + i];
            b[i * n + j] = i == j;
        }
    for (size_t k = 0; k < n; k++) {
        size_t best = k;
        for (size_t i = k + 1; i < n; i++)
            if (fabs(a[i * n + k]) > fabs(a[best * n + k]))
                best = i;
        if (!(fabs(a[best * n + k]) > 1e-14))
            return false;
        for (size_t j = 0; j < n && best != k; j++) {
            double keep = a[k * n + j];
            a[k * n + j] = a[best * n + j];
            a[best * n + j] = keep;
            keep = b[k * n + j];
            b[k * n + j] = b[best * n + j];
            b[best * n + j] = keep;
        }
        double pivot = a[k * n + k];
        for (size_t j = 0; j < n; j++) {
            a[k * n + j] /= pivot;
            b[k * n + j] /= pivot;
        }
        for (size_t i = 0; i < n; i++) {
            double factor = i == k ? 0 : a[i * n + k];
            for (size_t j = 0; j < n && factor != 0; j++) {
                a[i * n + j] -= factor * a[k * n + j];
                b[i * n + j] -= factor * b[k * n + j];
            }
        }
    }
    hull->pivots = 0;
    return true;
}

/* amounts = inverse · w, all made positive by turning columns round: a hull is symmetric. */
static void amounts_find(struct hull *hull, const double *w)
{
    size_t n = hull->width;
    for (size_t j = 0; j < n; j++) {
        double sum = 0, *row = &hull->inverse[j * n];
        for (size_t i = 0; i < n; i++)
            sum += row[i] * w[i];
        hull->amounts[j] = fabs(sum);
        if (sum >= 0)
            continue;
        for (size_t i = 0; i < n; i++) {
            row[i] = -row[i];
            hull->columns[j * n + i] = -hull->columns[j * n + i];
        }
        hull->basis[j].re = -hull->basis[j].re;
        hull->basis[j].im = -hull->basis[j].im;
    }
}

static double cost_of(const struct term *term)
{
    return term->vertex == ARTIFICIAL ? ARTIFICIAL_COST : 1;
}

/* The multiple of a vertex that the prices y value most, max |y·(c v)| over |c| = 1. */
static double price_best(const struct hull *hull, struct term *best)
{
    size_t n = hull->width, d = hull->dimension;
    const double *y = hull->prices;
    double largest = -1;
    for (size_t k = 0; k < hull->count; k++) {
        const double *v = hull->vertices + k * n;
        double a = 0, b = 0;
        for (size_t i = 0; i < n; i++)
            a += y[i] * v[i];
        if (n > d)
            for (size_t i = 0; i < d; i++)
                b += y[d + i] * v[i] - y[i] * v[d + i];
        double size = n > d ? hypot(a, b) : fabs(a);
        if (size > largest) {
            largest = size;
            *best = (struct term){k, size > 0 ? a / size : 1, size > 0 ? b / size : 0};
        }
    }
    return largest;
}

/* Brings a column into the basis in place of the one that is used up first. */
static bool pivot(struct hull *hull, const struct term *term, double *column)
{
    size_t n = hull->width, leaving = n;
    double least = INFINITY;
    column_make(hull, term, column);
    for (size_t j = 0; j < n; j++) {
        double sum = 0;
        for (size_t i = 0; i < n; i++)
            sum += hull->inverse[j * n + i] * column[i];
        hull->direction[j] = sum;
        if (sum > 1e-9 && hull->amounts[j] / sum < least) {
            least = hull->amounts[j] / sum;
            leaving = j;
        }
    }
    if (leaving == n)
        return false;
    double *row = &hull->inverse[leaving * n];
    for (size_t i = 0; i < n; i++)
        row[i] /= hull->direction[leaving];
    for (size_t j = 0; j < n; j++) {
        double factor = hull->direction[j];
        if (j == leaving || factor == 0)
            continue;
        for (size_t i = 0; i < n; i++)
            hull->inverse[j * n + i] -= factor * row[i];
        hull->amounts[j] = fmax(0, hull->amounts[j] - factor * least);
    }
    hull->amounts[leaving] = least;
    hull->basis[leaving] = *term;
    memcpy(&hull->columns[leaving * n], column, n * sizeof *column);
    hull->pivots++;
    return true;
}

/* The least Σ |c| with Σ c v = w, by the simplex method with columns generated as they are priced. Stops
 * early when it is surely above `outside`. Leaves the coefficients in the basis. */
static double gauge(struct polytope *polytope, struct hull *hull, const double *w, double outside,
                    double *workspace)
{
    size_t n = hull->width;
    double *column = workspace + n * n, sum = INFINITY;
    if (hull->count == 0)
        return INFINITY;
    if (hull->pivots > FRESH_PIVOTS && !hull_invert(hull, workspace))
        hull_reset(hull);
    amounts_find(hull, w);
    for (int step = 0; step < MOST_PIVOTS; step++) {
        struct term best = {0, 0, 0};
        double value = 0;
        sum = 0;
        memset(hull->prices, 0, n * sizeof *hull->prices);
        for (size_t j = 0; j < n; j++) {
            double cost = cost_of(&hull->basis[j]);
            sum += cost * hull->amounts[j];
            for (size_t i = 0; i < n; i++)
                hull->prices[i] += cost * hull->inverse[j * n + i];
        }
        for (size_t i = 0; i < n; i++)
            value += hull->prices[i] * w[i];
        double largest = price_best(hull, &best);
        polytope->work += (double)(n * (2 * n + (n > hull->dimension ? 2 : 1) * hull->count));
        if (largest <= 1 + 1e-13 || value / largest > outside)
            break;
        if (!pivot(hull, &best, column))
            break;
    }
    return sum;
}

/* ---- Building ------------------------------------------------------------------------------------------ */

static bcifs_status vertex_add(struct polytope *polytope, size_t node, const double *v, size_t *index)
{
    struct hull *hull = &polytope->hulls[node];
    size_t n = hull->width;
    if (hull->count == hull->capacity) {
        size_t capacity = hull->capacity ? 2 * hull->capacity : 16;
        double *larger =
            arena_grow(polytope->arena, hull->vertices, hull->count * n, capacity * n, sizeof *larger);
        if (!larger)
            return BCIFS_MEMORY;
        hull->vertices = larger;
        hull->capacity = capacity;
    }
    memcpy(hull->vertices + hull->count * n, v, n * sizeof *v);
    *index = hull->count++;
    if (!ARENA_RESERVE(polytope->arena, polytope->queue, polytope->queue_count, polytope->queue_capacity))
        return BCIFS_MEMORY;
    polytope->queue[polytope->queue_count].node = node;
    polytope->queue[polytope->queue_count++].vertex = *index;
    return BCIFS_OK;
}

static bcifs_status image_add(struct polytope *polytope, struct image image)
{
    if (!ARENA_RESERVE(polytope->arena, polytope->images, polytope->image_count, polytope->image_capacity))
        return BCIFS_MEMORY;
    polytope->images[polytope->image_count++] = image;
    return BCIFS_OK;
}

/* The image is one vertex times re + i im. */
static bcifs_status image_single(struct polytope *polytope, size_t edge, size_t vertex, struct term term)
{
    struct term *terms = arena_grow(polytope->arena, &term, 1, 1, sizeof *terms);
    return terms ? image_add(polytope, (struct image){edge, vertex, terms, 1, true}) : BCIFS_MEMORY;
}

/* What the last gauge was made of: at most `width` terms. */
static size_t basis_terms(const struct hull *hull, struct term *terms)
{
    size_t count = 0;
    for (size_t j = 0; j < hull->width; j++)
        if (hull->basis[j].vertex != ARTIFICIAL && hull->amounts[j] > 0)
            terms[count++] = (struct term){hull->basis[j].vertex, hull->amounts[j] * hull->basis[j].re,
                                           hull->amounts[j] * hull->basis[j].im};
    return count;
}

/* The image as the last gauge wrote it. */
static bcifs_status image_from_basis(struct polytope *polytope, size_t edge, size_t vertex)
{
    const struct hull *hull = &polytope->hulls[polytope->block->edges[edge].from];
    struct term *terms = arena_new(polytope->arena, hull->width, sizeof *terms);
    if (!terms)
        return BCIFS_MEMORY;
    size_t count = basis_terms(hull, terms);
    return image_add(polytope, (struct image){edge, vertex, terms, count, false});
}

/* result = A v / radius, v a vertex of the edge's end. */
static void image_compute(const struct polytope *polytope, size_t edge, const double *v, double *result)
{
    const struct block_edge *e = &polytope->block->edges[edge];
    size_t rows = polytope->block->dimensions[e->from], columns = polytope->block->dimensions[e->to];
    for (size_t part = 0; part < (polytope->complex_case ? 2u : 1u); part++)
        for (size_t i = 0; i < rows; i++) {
            double sum = 0;
            for (size_t j = 0; j < columns; j++)
                sum += e->matrix[i * columns + j] * v[part * columns + j];
            result[part * rows + i] = sum / polytope->radius;
        }
}

/* The leading eigenvector of the product, re and im (size each) by inverse iteration, scaled to maximum 1. */
static bcifs_status eigenvector_find(const double *product, size_t size, struct arena *arena,
                                     double complex *value, double *vector)
{
    double *copy = arena_grow(arena, product, size * size, size * size + 2 * size, sizeof *copy);
    double complex *m = arena_new(arena, size * size + size, sizeof *m);
    if (!copy || !m)
        return BCIFS_MEMORY;
    double *re = copy + size * size, *im = re + size, norm = row_norm(product, size, size);
    double complex *x = m + size * size, lambda = 0;
    if (eigenvalues(copy, size, re, im))
        lambda = re[0] + I * im[0];
    *value = lambda;
    for (size_t i = 0; i < size; i++)
        x[i] = 1 + 0.3 * sin(3.0 * (double)i + 1);
    for (int step = 0; step < 4; step++) {
        for (size_t i = 0; i < size * size; i++)
            m[i] = product[i];
        for (size_t i = 0; i < size; i++)
            m[i * size + i] -= lambda * (1 + 1e-14);
        complex_solve(m, x, size, 1, norm * DBL_EPSILON);
        size_t top = 0;
        for (size_t i = 0; i < size; i++)
            top = cabs(x[i]) > cabs(x[top]) ? i : top;
        double complex scale = x[top];
        for (size_t i = 0; i < size; i++)
            x[i] /= scale;
    }
    for (size_t i = 0; i < size; i++) {
        vector[i] = creal(x[i]);
        vector[size + i] = cimag(x[i]);
    }
    return BCIFS_OK;
}

/* The eigenvectors along one closed path, as first vertices; the last image closes the cycle. Where the
 * eigenvalue is not real its conjugate leads as well, with the conjugate eigenvectors. */
static bcifs_status cycle_add(struct polytope *polytope, const size_t *path, size_t length, bool conjugate)
{
    const struct block *block = polytope->block;
    size_t node = block->edges[path[0]].from, start = 0, vertex;
    double error, *vector = arena_new(polytope->arena, 2 * block->largest, sizeof *vector);
    double *image = arena_new(polytope->arena, 2 * block->largest, sizeof *image);
    double *product = block_product(block, path, length, polytope->arena, &error);
    double complex value = 0;
    if (!vector || !image || !product)
        return BCIFS_MEMORY;
    bcifs_status status = eigenvector_find(product, block->dimensions[node], polytope->arena, &value, vector);
    for (size_t i = 0; i < block->dimensions[node] && conjugate; i++)
        vector[block->dimensions[node] + i] = -vector[block->dimensions[node] + i];
    value = conjugate ? conj(value) : value;
    if (status == BCIFS_OK)
        status = vertex_add(polytope, node, vector, &start);
    vertex = start;
    for (size_t k = length; k-- > 1 && status == BCIFS_OK;) {
        size_t before = vertex;
        image_compute(polytope, path[k],
                      polytope->hulls[node].vertices + vertex * polytope->hulls[node].width, image);
        node = block->edges[path[k]].from;
        status = vertex_add(polytope, node, image, &vertex);
        if (status == BCIFS_OK)
            status = image_single(polytope, path[k], before, (struct term){vertex, 1, 0});
    }
    double size = cabs(value);
    if (status == BCIFS_OK)
        status = image_single(polytope, path[0], vertex,
                              (struct term){start, creal(value) / size, cimag(value) / size});
    return status;
}

/* Small vertices along the axes. Hulls of long cycles are thin: errors of 1e-11 in a map would lead out of
 * them by more than their thickness. */
static bcifs_status axes_add(struct polytope *polytope)
{
    for (size_t x = 0; x < polytope->block->node_count; x++)
        for (size_t i = 0; i < polytope->hulls[x].dimension; i++) {
            size_t index;
            double *v = arena_new(polytope->arena, polytope->hulls[x].width, sizeof *v);
            if (!v)
                return BCIFS_MEMORY;
            v[i] = THICKNESS;
            bcifs_status status = vertex_add(polytope, x, v, &index);
            if (status)
                return status;
        }
    return BCIFS_OK;
}

static bool is_accounted(const struct polytope *polytope, size_t known, size_t edge, size_t vertex)
{
    for (size_t i = 0; i < known; i++)
        if (polytope->images[i].edge == edge && polytope->images[i].vertex == vertex)
            return true;
    return false;
}

/* Writes every image of every vertex in vertices, adding those images that lie outside while there is room.
 */
static bcifs_status images_account(struct polytope *polytope, double slack, double *workspace)
{
    size_t known = polytope->image_count; /* of the cycles */
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < polytope->queue_count && status == BCIFS_OK; i++) {
        size_t node = polytope->queue[i].node, vertex = polytope->queue[i].vertex;
        for (size_t k = polytope->first_entering[node]; k < polytope->first_entering[node + 1]; k++) {
            size_t edge = polytope->entering[k], from = polytope->block->edges[edge].from, fresh;
            struct hull *source = &polytope->hulls[node], *target = &polytope->hulls[from];
            bool room = polytope->work < polytope->most_work && target->count < MOST_VERTICES;
            if (is_accounted(polytope, known, edge, vertex))
                continue;
            image_compute(polytope, edge, source->vertices + vertex * source->width, workspace);
            double size =
                gauge(polytope, target, workspace, room ? 1 + slack : INFINITY, workspace + target->width);
            if (size > 1 + slack && room) {
                status = vertex_add(polytope, from, workspace, &fresh);
                if (status == BCIFS_OK)
                    status = image_single(polytope, edge, vertex, (struct term){fresh, 1, 0});
            } else {
                status = image_from_basis(polytope, edge, vertex);
            }
            if (status || polytope->work > 2 * polytope->most_work)
                return status;
        }
    }
    return status;
}

/* ---- The certificate ----------------------------------------------------------------------------------- */

/* rest <- rest - scale Σ c v. Returns a bound of the gauge of scale Σ c v, and in `size` one of the absolute
 * terms that an entry adds up. */
static double combination_subtract(const struct hull *hull, const struct term *terms, size_t count,
                                   double scale, double *rest, double *size)
{
    size_t n = hull->width, d = hull->dimension;
    double sum = 0;
    for (size_t k = 0; k < count; k++) {
        const double *u = hull->vertices + terms[k].vertex * n;
        double re = terms[k].re * scale, im = terms[k].im * scale, largest = 0;
        for (size_t i = 0; i < d; i++) {
            rest[i] -= n > d ? re * u[i] - im * u[d + i] : re * u[i];
            if (n > d)
                rest[d + i] -= im * u[i] + re * u[d + i];
        }
        for (size_t i = 0; i < n; i++)
            largest = fmax(largest, fabs(u[i]));
        sum += hypot(terms[k].re, terms[k].im);
        *size += (fabs(re) + fabs(im)) * largest;
    }
    return round_up(scale * round_up(sum, 4 * count), 2);
}

/* A bound of what is left: the largest entry, and its rounding when every entry is a sum of `operations`
 * products whose absolute values add up to at most `size`. */
static double rest_bound(const double *rest, size_t n, size_t operations, double size)
{
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        largest = fabs(rest[i]) <= largest ? largest : fabs(rest[i]); /* keeps a NaN */
    return round_up(largest + (double)operations * DBL_EPSILON * size, 4);
}

/* μ with gauge(r) <= μ max |r_i|: the sum of the gauges of the axes, each found like any other and bounded by
 * means of the small vertices along the axes themselves, gauge(r) <= Σ |r_i| / THICKNESS. */
static double reach_find(struct polytope *polytope, struct hull *hull, double *workspace, struct term *terms)
{
    size_t n = hull->width, d = hull->dimension;
    double turn = n > d ? 1.4143 : 1; /* |r_i| <= sqrt 2 max(|Re r_i|, |Im r_i|) */
    double coarse = round_up(turn * (double)d / THICKNESS, 4), reach = 0;
    for (size_t i = 0; i < d; i++) {
        double *axis = workspace, size = 1;
        memset(axis, 0, n * sizeof *axis);
        axis[i] = 1;
        gauge(polytope, hull, axis, INFINITY, workspace + n);
        size_t count = basis_terms(hull, terms);
        double sum = combination_subtract(hull, terms, count, 1, axis, &size);
        reach += fmin(sum + coarse * rest_bound(axis, n, 4 * count + 8, size), 1 / THICKNESS);
    }
    return round_up(turn * reach, 2 * d);
}

/* A bound of the gauge of A v: radius Σ |c| for the vertices, μ max |r_i| for the rest r = A v - radius Σ c
 * v. */
static double image_bound(const struct polytope *polytope, const struct image *image, double reach,
                          double *rest)
{
    const struct block_edge *e = &polytope->block->edges[image->edge];
    const struct hull *target = &polytope->hulls[e->from], *source = &polytope->hulls[e->to];
    size_t rows = target->dimension, columns = source->dimension;
    const double *v = source->vertices + image->vertex * source->width;
    double largest = 0;
    for (size_t part = 0; part < target->width / rows; part++)
        for (size_t i = 0; i < rows; i++) {
            double entry = 0;
            for (size_t j = 0; j < columns; j++)
                entry += e->matrix[i * columns + j] * v[part * columns + j];
            rest[part * rows + i] = entry;
        }
    for (size_t j = 0; j < source->width; j++)
        largest = fmax(largest, fabs(v[j]));
    double size = e->norm * largest;
    double sum = combination_subtract(target, image->terms, image->count, polytope->radius, rest, &size);
    double left = rest_bound(rest, target->width, columns + 4 * image->count + 8, size) + e->error * largest;
    return round_up(sum + round_up(reach * left, 4), 2);
}

/* κ: the largest gauge of an image. All images are accounted for, or there is no certificate. `strict`: those
 * that define no vertex are inside by TOLERANCE_INSIDE. */
static bcifs_status certify(struct polytope *polytope, double *workspace, struct polytope_outcome *outcome)
{
    const struct block *block = polytope->block;
    size_t wanted = 0;
    for (size_t e = 0; e < block->edge_count; e++)
        wanted += polytope->hulls[block->edges[e].to].count;
    for (size_t x = 0; x < block->node_count; x++)
        outcome->vertices += polytope->hulls[x].count;
    if (polytope->image_count < wanted)
        return BCIFS_OK;
    double *reach = arena_new(polytope->arena, block->node_count, sizeof *reach);
    struct term *terms = arena_new(polytope->arena, 2 * block->largest, sizeof *terms);
    if (!reach || !terms)
        return BCIFS_MEMORY;
    for (size_t x = 0; x < block->node_count; x++)
        reach[x] = reach_find(polytope, &polytope->hulls[x], workspace, terms);
    outcome->upper = 0;
    outcome->strict = true;
    for (size_t i = 0; i < polytope->image_count; i++) {
        const struct image *image = &polytope->images[i];
        double bound = image_bound(polytope, image, reach[block->edges[image->edge].from], workspace);
        outcome->upper =
            bound <= outcome->upper ? outcome->upper : bound; /* a NaN is kept, and proves nothing */
        if (!image->defines && !(bound <= polytope->radius * (1 - TOLERANCE_INSIDE)))
            outcome->strict = false;
    }
    if (!(outcome->upper < INFINITY))
        *outcome = (struct polytope_outcome){.upper = INFINITY, .vertices = outcome->vertices};
    return BCIFS_OK;
}

/* ---- The whole ----------------------------------------------------------------------------------------- */

static bcifs_status hull_create(struct hull *hull, size_t dimension, bool complex_case, struct arena *arena)
{
    size_t n = complex_case ? 2 * dimension : dimension;
    double *numbers = arena_new(arena, 2 * n * n + 3 * n, sizeof *numbers);
    *hull = (struct hull){.dimension = dimension, .width = n};
    hull->basis = arena_new(arena, n, sizeof *hull->basis);
    if (!numbers || !hull->basis)
        return BCIFS_MEMORY;
    hull->columns = numbers;
    hull->inverse = numbers + n * n;
    hull->amounts = hull->inverse + n * n;
    hull->prices = hull->amounts + n;
    hull->direction = hull->prices + n;
    hull_reset(hull);
    return BCIFS_OK;
}

static bcifs_status polytope_create(struct polytope *polytope)
{
    const struct block *block = polytope->block;
    struct arena *arena = polytope->arena;
    polytope->hulls = arena_new(arena, block->node_count, sizeof *polytope->hulls);
    polytope->entering = arena_new(arena, block->edge_count, sizeof *polytope->entering);
    polytope->first_entering = arena_new(arena, block->node_count + 1, sizeof *polytope->first_entering);
    if (!polytope->hulls || !polytope->entering || !polytope->first_entering)
        return BCIFS_MEMORY;
    size_t count = 0;
    for (size_t x = 0; x < block->node_count; x++) {
        polytope->first_entering[x] = count;
        for (size_t e = 0; e < block->edge_count; e++)
            if (block->edges[e].to == x)
                polytope->entering[count++] = e;
        if (hull_create(&polytope->hulls[x], block->dimensions[x], polytope->complex_case, arena))
            return BCIFS_MEMORY;
    }
    polytope->first_entering[block->node_count] = count;
    return BCIFS_OK;
}

/* Whether the leading eigenvalue of the candidate's product is not real. */
static bcifs_status eigenvalue_is_complex(const struct block *block, const struct candidate *candidate,
                                          struct arena *arena, bool *is_complex)
{
    size_t size = block->dimensions[block->edges[candidate->edges[0][0]].from];
    double error, *product = block_product(block, candidate->edges[0], candidate->lengths[0], arena, &error);
    double *parts = arena_new(arena, 2 * size, sizeof *parts);
    if (!product || !parts)
        return BCIFS_MEMORY;
    *is_complex = eigenvalues(product, size, parts, parts + size) &&
                  fabs(parts[size]) > TOLERANCE_CLUSTER * 1e-8 * fabs(parts[0]);
    return BCIFS_OK;
}

bcifs_status block_polytope(const struct block *block, const struct candidate *candidate, double work,
                            struct arena *arena, struct polytope_outcome *outcome)
{
    struct polytope polytope = {
        .block = block, .arena = arena, .radius = candidate->radius, .most_work = work};
    size_t width = 2 * block->largest;
    double *workspace = arena_new(arena, 2 * width * width + 4 * width, sizeof *workspace);
    *outcome = (struct polytope_outcome){.upper = INFINITY};
    bcifs_status status = workspace ? BCIFS_OK : BCIFS_MEMORY;
    if (status == BCIFS_OK)
        status = eigenvalue_is_complex(block, candidate, arena, &polytope.complex_case);
    if (status == BCIFS_OK)
        status = polytope_create(&polytope);
    for (size_t i = 0; i < candidate->count && status == BCIFS_OK; i++) {
        status = cycle_add(&polytope, candidate->edges[i], candidate->lengths[i], false);
        if (status == BCIFS_OK && polytope.complex_case)
            status = cycle_add(&polytope, candidate->edges[i], candidate->lengths[i], true);
    }
    if (status == BCIFS_OK)
        status = axes_add(&polytope);
    if (status == BCIFS_OK)
        status = images_account(&polytope, TOLERANCE_JOINT, workspace);
    if (status == BCIFS_OK)
        status = certify(&polytope, workspace, outcome);
    return status;
}
