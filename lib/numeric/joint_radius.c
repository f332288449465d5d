#include "joint_radius.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/text.h"
#include "numeric/components.h"
#include "numeric/enclosure.h"
#include "numeric/joint_block.h"
#include "numeric/matrix.h"
#include "numeric/tolerance.h"

enum {
    MOST_ENTRIES = 1 << 24, /* entries of all matrices that are not zero */
    MOST_ELLIPSOID = 64,    /* total dimension up to which ellipsoids and polytopes are tried */
    ELLIPSOID_STEPS = 300
};
static const double WORK_FIRST = 4e6, WORK_TREE = 2e7,
                    WORK_POLYTOPE = 4e7; /* multiplications, times the effort */

struct solution {
    double lower, upper;
    bool exact;
    const size_t *edges; /* of the family */
    size_t length;
    enum joint_method method;
    size_t size;
};

/* ---- Irreducible blocks -------------------------------------------------------------------------------- */

/* The graph of coordinates: (x, i) → (y, j) when some edge x → y has an entry (i, j) that may differ from 0.
 * A family is block triangular along its strongly connected components, whatever the order of the
 * coordinates, and its radius is the largest of theirs. */
struct coordinates {
    const struct joint_family *family;
    size_t count;
    size_t *base;        /* first coordinate of each node */
    size_t *node;        /* of each coordinate */
    size_t *first, *arc; /* adjacency */
    size_t *component;   /* of each coordinate */
    size_t component_count;
};

static bool entry_is_zero(const struct joint_edge *edge, size_t index)
{
    return edge->matrix[index] == 0 && (!edge->error || edge->error[index] == 0);
}

/* Counts (arc NULL) or lists the arcs that leave each coordinate. */
static void arcs_visit(const struct coordinates *c, size_t *next, size_t *arc)
{
    const struct joint_family *family = c->family;
    for (size_t e = 0; e < family->edge_count; e++) {
        const struct joint_edge *edge = &family->edges[e];
        size_t rows = family->dimensions[edge->from], columns = family->dimensions[edge->to];
        for (size_t i = 0; i < rows; i++)
            for (size_t j = 0; j < columns; j++)
                if (!entry_is_zero(edge, i * columns + j)) {
                    size_t place = next[c->base[edge->from] + i]++;
                    if (arc)
                        arc[place] = c->base[edge->to] + j;
                }
    }
}

static bcifs_status coordinates_make(struct coordinates *c, const struct joint_family *family,
                                     struct arena *arena)
{
    c->family = family;
    c->base = arena_new(arena, family->node_count + 1, sizeof *c->base);
    if (!c->base)
        return BCIFS_MEMORY;
    for (size_t x = 0; x < family->node_count; x++)
        c->base[x + 1] = c->base[x] + family->dimensions[x];
    c->count = c->base[family->node_count];
    c->node = arena_new(arena, c->count, sizeof *c->node);
    c->first = arena_new(arena, c->count + 1, sizeof *c->first);
    c->component = arena_new(arena, c->count, sizeof *c->component);
    size_t *next = arena_new(arena, c->count, sizeof *next);
    if (!c->node || !c->first || !c->component || !next)
        return BCIFS_MEMORY;
    for (size_t x = 0; x < family->node_count; x++)
        for (size_t i = c->base[x]; i < c->base[x + 1]; i++)
            c->node[i] = x;
    arcs_visit(c, next, NULL);
    for (size_t i = 0; i < c->count; i++)
        c->first[i + 1] = c->first[i] + next[i];
    c->arc = arena_new(arena, c->first[c->count], sizeof *c->arc);
    if (!c->arc)
        return BCIFS_MEMORY;
    memcpy(next, c->first, c->count * sizeof *next);
    arcs_visit(c, next, c->arc);
    return BCIFS_OK;
}

/* The part of an edge between coordinates of one component; false when it is zero. `rows`, `columns` list
 * them. */
static bool edge_restrict(const struct joint_edge *edge, size_t width, const size_t *rows, size_t row_count,
                          const size_t *columns, size_t column_count, double *matrix,
                          struct block_edge *result)
{
    bool is_zero = true;
    double error = 0;
    for (size_t i = 0; i < row_count; i++) {
        double sum = 0;
        for (size_t j = 0; j < column_count; j++) {
            size_t index = rows[i] * width + columns[j];
            matrix[i * column_count + j] = edge->matrix[index];
            sum += edge->error ? edge->error[index] : 0;
            is_zero = is_zero && entry_is_zero(edge, index);
        }
        error = fmax(error, sum);
    }
    result->matrix = matrix;
    result->norm = row_norm(matrix, row_count, column_count);
    result->error = round_up(error, column_count);
    return !is_zero;
}

/* Sorts edges by the node they leave and finds `first`. */
static bcifs_status block_finish(struct block *block, struct arena *arena)
{
    size_t *first = arena_new(arena, block->node_count + 2, sizeof *first);
    struct block_edge *sorted = arena_new(arena, block->edge_count, sizeof *sorted);
    if (!first || !sorted)
        return BCIFS_MEMORY;
    for (size_t e = 0; e < block->edge_count; e++)
        first[block->edges[e].from + 2]++;
    for (size_t x = 0; x < block->node_count; x++)
        first[x + 2] += first[x + 1];
    for (size_t e = 0; e < block->edge_count; e++)
        sorted[first[block->edges[e].from + 1]++] = block->edges[e];
    block->edges = sorted;
    block->first = first;
    block->total = block->largest = 0;
    for (size_t x = 0; x < block->node_count; x++) {
        block->total += block->dimensions[x];
        if (block->dimensions[x] > block->largest)
            block->largest = block->dimensions[x];
    }
    return BCIFS_OK;
}

/* The block of the coordinates `members`, rising. */
static bcifs_status block_make(const struct coordinates *c, const size_t *members, size_t count,
                               struct arena *arena, struct block *block)
{
    const struct joint_family *family = c->family;
    size_t *dimensions = arena_new(arena, count, sizeof *dimensions);
    size_t *local = arena_new(arena, count, sizeof *local); /* coordinates within their nodes */
    size_t *start = arena_new(arena, count + 1, sizeof *start);
    size_t *nodes = arena_new(arena, family->node_count, sizeof *nodes); /* number in the block, from 1 */
    if (!dimensions || !local || !start || !nodes)
        return BCIFS_MEMORY;
    *block = (struct block){.dimensions = dimensions};
    for (size_t i = 0; i < count; i++) {
        size_t x = c->node[members[i]];
        if (!nodes[x]) {
            start[block->node_count] = i;
            nodes[x] = ++block->node_count;
        }
        dimensions[nodes[x] - 1]++;
        local[i] = members[i] - c->base[x];
    }
    block->edges = arena_new(arena, family->edge_count, sizeof *block->edges);
    if (!block->edges)
        return BCIFS_MEMORY;
    for (size_t e = 0; e < family->edge_count; e++) {
        const struct joint_edge *edge = &family->edges[e];
        if (!nodes[edge->from] || !nodes[edge->to])
            continue;
        size_t from = nodes[edge->from] - 1, to = nodes[edge->to] - 1;
        double *matrix = arena_new(arena, dimensions[from] * dimensions[to], sizeof *matrix);
        struct block_edge part = {.from = from, .to = to, .origin = e};
        if (!matrix)
            return BCIFS_MEMORY;
        if (edge_restrict(edge, family->dimensions[edge->to], local + start[from], dimensions[from],
                          local + start[to], dimensions[to], matrix, &part))
            block->edges[block->edge_count++] = part;
    }
    return block_finish(block, arena);
}

/* ---- Ellipsoids ---------------------------------------------------------------------------------------- */

/* The same block in the bases R_x: matrices R_x A R_y^-1, with R upper triangular. With R Y = I - G, |G| <=
 * η, R^-1 = Y (I - G)^-1. False with status BCIFS_OK: some R is too ill conditioned. */
static bcifs_status block_transform(const struct block *block, double *const *r, struct arena *arena,
                                    struct block *result, bool *good)
{
    double **inverse = arena_new(arena, block->node_count, sizeof *inverse);
    double *eta = arena_new(arena, block->node_count, sizeof *eta);
    struct block_edge *edges =
        arena_grow(arena, block->edges, block->edge_count, block->edge_count, sizeof *edges);
    double *workspace = arena_new(arena, block->largest * block->largest, sizeof *workspace);
    if (!inverse || !eta || !edges || !workspace)
        return BCIFS_MEMORY;
    *good = true;
    for (size_t x = 0; x < block->node_count; x++) {
        size_t n = block->dimensions[x];
        double *y = inverse[x] = arena_new(arena, n * n, sizeof *y);
        if (!y)
            return BCIFS_MEMORY;
        for (size_t j = 0; j < n; j++)
            for (size_t i = j + 1; i-- > 0;) {
                double sum = i == j;
                for (size_t k = i + 1; k <= j; k++)
                    sum -= r[x][i * n + k] * y[k * n + j];
                y[i * n + j] = sum / r[x][i * n + i];
            }
        double error =
            multiply_enclosed(r[x], row_norm(r[x], n, n), 0, y, row_norm(y, n, n), 0, n, n, n, workspace);
        for (size_t i = 0; i < n; i++)
            workspace[i * n + i] -= 1; /* exact, or rounded far below `error` */
        eta[x] = round_up(row_norm(workspace, n, n) + error + DBL_EPSILON, 2);
        *good = *good && eta[x] < 1e-3;
    }
    for (size_t e = 0; e < block->edge_count && *good; e++) {
        struct block_edge *edge = &edges[e];
        size_t rows = block->dimensions[edge->from], columns = block->dimensions[edge->to];
        const double *left = r[edge->from], *right = inverse[edge->to];
        double *matrix = arena_new(arena, rows * columns, sizeof *matrix);
        if (!matrix)
            return BCIFS_MEMORY;
        double error = multiply_enclosed(left, row_norm(left, rows, rows), 0, edge->matrix, edge->norm,
                                         edge->error, rows, rows, columns, workspace);
        error = multiply_enclosed(workspace, row_norm(workspace, rows, columns), error, right,
                                  row_norm(right, columns, columns), 0, rows, columns, columns, matrix);
        edge->matrix = matrix;
        edge->norm = row_norm(matrix, rows, columns);
        edge->error = round_up(error + 1.01 * eta[edge->to] / (1 - eta[edge->to]) * (edge->norm + error), 6);
    }
    *result = *block;
    result->edges = edges;
    return BCIFS_OK;
}

/* Q <- R with Q = R^T R, R upper triangular. False when Q is not safely positive definite. */
static bool cholesky(double *q, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        double pivot = q[k * n + k];
        for (size_t i = 0; i < k; i++)
            pivot -= q[i * n + k] * q[i * n + k];
        if (!(pivot > 1e-12 * fabs(q[k * n + k])))
            return false;
        q[k * n + k] = sqrt(pivot);
        for (size_t j = k + 1; j < n; j++) {
            double sum = q[k * n + j];
            for (size_t i = 0; i < k; i++)
                sum -= q[i * n + k] * q[i * n + j];
            q[k * n + j] = sum / q[k * n + k];
        }
        for (size_t j = 0; j < k; j++)
            q[k * n + j] = 0;
    }
    return true;
}

/* sum += A^T Q A, A rows × columns. */
static void congruence_add(const double *a, const double *q, size_t rows, size_t columns, double *sum,
                           double *workspace)
{
    matrix_multiply(q, a, rows, rows, columns, workspace);
    for (size_t k = 0; k < rows; k++)
        for (size_t i = 0; i < columns; i++) {
            double factor = a[k * columns + i];
            for (size_t j = 0; j < columns && factor != 0; j++)
                sum[i * columns + j] += factor * workspace[k * columns + j];
        }
}

/* The quadratic forms that Σ_e A_e^T Q_from A_e reproduces up to a factor: where all maps are similarities
 * (von Koch's, the dragon's) the form that they preserve, so that its ellipsoids give the radius exactly. */
static bcifs_status forms_find(const struct block *block, struct arena *arena, double ***forms)
{
    double **q = arena_new(arena, block->node_count, sizeof *q);
    double **next = arena_new(arena, block->node_count, sizeof *next);
    double *workspace = arena_new(arena, block->largest * block->largest, sizeof *workspace);
    if (!q || !next || !workspace)
        return BCIFS_MEMORY;
    for (size_t x = 0; x < block->node_count; x++) {
        size_t n = block->dimensions[x];
        q[x] = arena_new(arena, n * n, sizeof **q);
        next[x] = arena_new(arena, n * n, sizeof **next);
        if (!q[x] || !next[x])
            return BCIFS_MEMORY;
        for (size_t i = 0; i < n; i++)
            q[x][i * n + i] = 1;
    }
    for (int step = 0; step < ELLIPSOID_STEPS; step++) {
        double trace = 0, old = 0;
        for (size_t x = 0; x < block->node_count; x++)
            memset(next[x], 0, block->dimensions[x] * block->dimensions[x] * sizeof **next);
        for (size_t e = 0; e < block->edge_count; e++) {
            const struct block_edge *edge = &block->edges[e];
            congruence_add(edge->matrix, q[edge->from], block->dimensions[edge->from],
                           block->dimensions[edge->to], next[edge->to], workspace);
        }
        for (size_t x = 0; x < block->node_count; x++)
            for (size_t i = 0, n = block->dimensions[x]; i < n; i++) {
                trace += next[x][i * n + i];
                old += q[x][i * n + i];
            }
        /* The mean of old and new: the iteration must not oscillate on a periodic graph. */
        for (size_t x = 0; x < block->node_count; x++)
            for (size_t i = 0; i < block->dimensions[x] * block->dimensions[x]; i++)
                q[x][i] = 0.5 * q[x][i] / old + 0.5 * next[x][i] / trace;
    }
    *forms = q;
    return BCIFS_OK;
}

/* The largest spectral norm of a matrix of the block: |A|_2² = ρ(A^T A). */
static bcifs_status euclidean_bound(const struct block *block, struct arena *arena, double *upper)
{
    *upper = 0;
    for (size_t e = 0; e < block->edge_count; e++) {
        const struct block_edge *edge = &block->edges[e];
        size_t rows = block->dimensions[edge->from], columns = block->dimensions[edge->to];
        double *transpose = arena_new(arena, rows * columns, sizeof *transpose);
        double *gram = arena_new(arena, columns * columns, sizeof *gram), low, high;
        if (!transpose || !gram)
            return BCIFS_MEMORY;
        for (size_t i = 0; i < rows; i++)
            for (size_t j = 0; j < columns; j++)
                transpose[j * rows + i] = edge->matrix[i * columns + j];
        double error = multiply_enclosed(transpose, row_norm(transpose, columns, rows), 0, edge->matrix,
                                         edge->norm, 0, columns, rows, columns, gram);
        if (!spectral_radius_enclose(gram, columns, error, arena, &low, &high))
            return BCIFS_MEMORY;
        /* The error in the row norm is one of at most sqrt(rows) times that in the spectral norm. */
        *upper = fmax(*upper, round_up(sqrt(high) + sqrt((double)rows) * edge->error, 6));
    }
    return BCIFS_OK;
}

/* ---- One block ----------------------------------------------------------------------------------------- */

static void upper_offer(struct solution *solution, double upper, enum joint_method method, size_t size)
{
    if (upper < solution->upper) {
        solution->upper = upper;
        solution->method = method;
        solution->size = size;
    }
}

static bool is_closed(const struct solution *solution, double relative)
{
    return solution->upper <= solution->lower * (1 + relative);
}

/* The candidate's radius as a certified lower bound (and, for `upper` not NULL, an upper one). */
static bcifs_status candidate_certify(const struct block *block, const struct candidate *candidate,
                                      struct arena *arena, struct solution *solution, double *upper)
{
    double error, low, high;
    if (candidate->count == 0)
        return BCIFS_OK;
    const size_t *path = candidate->edges[0];
    size_t length = candidate->lengths[0], size = block->dimensions[block->edges[path[0]].from];
    double *product = block_product(block, path, length, arena, &error);
    if (!product || !spectral_radius_enclose(product, size, error, arena, &low, &high))
        return BCIFS_MEMORY;
    double exponent = 1 / (double)length;
    bool single = length == 1;
    low = single ? low : round_down(pow(low, exponent), 4);
    if (upper)
        *upper = single ? high : round_up(pow(high, exponent), 4);
    if (low <= solution->lower && solution->length > 0)
        return BCIFS_OK;
    size_t *edges = arena_new(arena, length, sizeof *edges);
    if (!edges)
        return BCIFS_MEMORY;
    for (size_t k = 0; k < length; k++)
        edges[k] = block->edges[path[k]].origin;
    solution->lower = fmax(low, 0);
    solution->edges = edges;
    solution->length = length;
    return BCIFS_OK;
}

/* Dimension one: products of numbers commute, so the largest in modulus is the radius. */
static bcifs_status numbers_solve(const struct block *block, struct arena *arena, struct solution *solution)
{
    bcifs_status status = BCIFS_OK;
    double upper, largest = 0;
    for (size_t e = 0; e < block->edge_count && status == BCIFS_OK; e++) {
        struct candidate candidate = {.count = 1, .edges = {&e}, .lengths = {1}};
        status = candidate_certify(block, &candidate, arena, solution, &upper);
        largest = fmax(largest, upper);
    }
    upper_offer(solution, largest, JOINT_CLOSED, 1);
    return status;
}

/* One cycle and nothing else: the radius is that of its product. */
static bcifs_status cycle_solve(const struct block *block, struct arena *arena, struct solution *solution)
{
    size_t *edges = arena_new(arena, block->node_count, sizeof *edges);
    struct candidate candidate = {.count = 1, .edges = {edges}, .lengths = {block->node_count}};
    double upper;
    if (!edges)
        return BCIFS_MEMORY;
    for (size_t k = 0, x = 0; k < block->node_count; k++) {
        edges[k] = block->first[x];
        x = block->edges[block->first[x]].to;
    }
    bcifs_status status = candidate_certify(block, &candidate, arena, solution, &upper);
    upper_offer(solution, upper, JOINT_CLOSED, block->node_count);
    return status;
}

/* Searches in the block's basis, and keeps what is better. */
static bcifs_status tree_try(const struct block *block, double work, struct arena *arena,
                             struct candidate *candidate, struct solution *solution)
{
    struct tree_outcome tree;
    bcifs_status status = block_search(block, work, TOLERANCE_JOINT, arena, candidate, &tree);
    if (status == BCIFS_OK)
        upper_offer(solution, tree.upper, JOINT_TREE, tree.length);
    return status;
}

/* The block in the basis of its ellipsoids; `result` is a copy of `block` where there is none. */
static bcifs_status ellipsoid_try(const struct block *block, struct arena *arena, struct block *result,
                                  struct solution *solution)
{
    double **forms, upper;
    bool good = true;
    *result = *block;
    if (block->total > MOST_ELLIPSOID)
        return BCIFS_OK;
    bcifs_status status = forms_find(block, arena, &forms);
    for (size_t x = 0; x < block->node_count && status == BCIFS_OK; x++)
        good = good && cholesky(forms[x], block->dimensions[x]);
    if (status || !good)
        return status;
    struct block fresh;
    status = block_transform(block, forms, arena, &fresh, &good);
    if (status || !good)
        return status;
    *result = fresh;
    status = euclidean_bound(result, arena, &upper);
    if (status == BCIFS_OK)
        upper_offer(solution, upper, JOINT_ELLIPSOID, block->total);
    return status;
}

static bcifs_status polytope_try(const struct block *block, const struct candidate *candidate, double work,
                                 struct arena *arena, struct solution *solution)
{
    struct polytope_outcome polytope;
    if (block->total > MOST_ELLIPSOID || candidate->count == 0)
        return BCIFS_OK;
    bcifs_status status = block_polytope(block, candidate, work, arena, &polytope);
    if (status == BCIFS_OK) {
        upper_offer(solution, polytope.upper, JOINT_POLYTOPE, polytope.vertices);
        solution->exact = polytope.strict;
    }
    return status;
}

/* From cheap to dear, until the bounds meet. The tree comes first because it finds the candidate that the
 * polytope needs; a longer tree may find a better one. */
static bcifs_status search_solve(const struct block *block, double effort, struct arena *arena,
                                 struct solution *solution)
{
    struct candidate candidate = {0};
    struct block ellipsoid;
    bcifs_status status = tree_try(block, WORK_FIRST * effort, arena, &candidate, solution);
    if (status == BCIFS_OK)
        status = candidate_certify(block, &candidate, arena, solution, NULL);
    if (status || is_closed(solution, TOLERANCE_EXACT))
        return status;
    double by_tree = solution->upper, before = candidate.radius;
    status = ellipsoid_try(block, arena, &ellipsoid, solution);
    if (status || is_closed(solution, TOLERANCE_EXACT))
        return status;
    status = polytope_try(block, &candidate, WORK_POLYTOPE * effort, arena, solution);
    if (status || is_closed(solution, TOLERANCE_JOINT))
        return status;
    bool rounder = solution->method == JOINT_ELLIPSOID && solution->upper < by_tree;
    status = tree_try(rounder ? &ellipsoid : block, WORK_TREE * effort, arena, &candidate, solution);
    if (status == BCIFS_OK)
        status = candidate_certify(block, &candidate, arena, solution, NULL);
    if (status || !(candidate.radius > before))
        return status;
    return polytope_try(block, &candidate, WORK_POLYTOPE * effort, arena, solution);
}

static bcifs_status block_solve(const struct block *block, double effort, struct arena *arena,
                                struct solution *solution)
{
    bcifs_status status;
    *solution = (struct solution){.upper = INFINITY};
    if (block->total == 1)
        status = numbers_solve(block, arena, solution);
    else if (block->edge_count == block->node_count)
        status = cycle_solve(block, arena, solution);
    else
        status = search_solve(block, effort, arena, solution);
    solution->exact =
        (solution->exact && is_closed(solution, TOLERANCE_INSIDE)) || is_closed(solution, TOLERANCE_EXACT);
    return status;
}

/* ---- The whole ----------------------------------------------------------------------------------------- */

/* The block with the larger radius decides; the result is exact when no other may exceed it. */
static void solutions_join(struct joint_bounds *bounds, const struct solution *solution, bool *others)
{
    if (bounds->blocks == 0 || solution->upper > bounds->upper) {
        bounds->upper = solution->upper;
        bounds->method = solution->method;
        bounds->size = solution->size;
    }
    if (bounds->blocks == 0 || solution->lower > bounds->lower) {
        bounds->lower = solution->lower;
        bounds->product = solution->edges;
        bounds->length = solution->length;
    }
    others[bounds->blocks++] = solution->exact;
}

/* A cycle is there when a component has two coordinates, or an arc to itself. */
static bool component_has_cycle(const struct coordinates *c, const size_t *members, size_t count)
{
    bool loop = count > 1;
    for (size_t k = c->first[members[0]]; k < c->first[members[0] + 1] && !loop; k++)
        loop = c->arc[k] == members[0];
    return loop;
}

/* Lists the coordinates component by component. */
static size_t *members_list(const struct coordinates *c, struct arena *arena, size_t **starts)
{
    size_t *list = arena_new(arena, c->count, sizeof *list);
    *starts = arena_new(arena, c->component_count + 2, sizeof **starts);
    if (!list || !*starts)
        return NULL;
    for (size_t i = 0; i < c->count; i++)
        (*starts)[c->component[i] + 2]++;
    for (size_t k = 0; k < c->component_count; k++)
        (*starts)[k + 2] += (*starts)[k + 1];
    for (size_t i = 0; i < c->count; i++)
        list[(*starts)[c->component[i] + 1]++] = i;
    return list;
}

/* Scales by a power of 2, which is exact unless an entry is 2^-1000 times the largest. */
static bcifs_status family_scale(const struct joint_family *family, struct arena *arena,
                                 struct joint_family *scaled, int *shift)
{
    struct joint_edge *edges =
        arena_grow(arena, family->edges, family->edge_count, family->edge_count, sizeof *edges);
    double largest = 0;
    if (!edges)
        return BCIFS_MEMORY;
    for (size_t e = 0; e < family->edge_count; e++) {
        size_t count = family->dimensions[edges[e].from] * family->dimensions[edges[e].to];
        for (size_t i = 0; i < count; i++)
            largest = fmax(largest, fabs(edges[e].matrix[i]));
    }
    frexp(largest, shift);
    for (size_t e = 0; e < family->edge_count; e++) {
        size_t count = family->dimensions[edges[e].from] * family->dimensions[edges[e].to];
        double *matrix = arena_new(arena, count, sizeof *matrix),
               *error = arena_new(arena, count, sizeof *error);
        if (!matrix || !error)
            return BCIFS_MEMORY;
        for (size_t i = 0; i < count; i++) {
            matrix[i] = ldexp(edges[e].matrix[i], -*shift);
            bool lost = ldexp(matrix[i], *shift) != edges[e].matrix[i];
            error[i] = edges[e].error ? ldexp(edges[e].error[i], -*shift) : 0;
            if (lost || (edges[e].error && edges[e].error[i] > 0))
                error[i] = error[i] * (1 + DBL_EPSILON) + DBL_MIN;
        }
        edges[e].matrix = matrix;
        edges[e].error = error;
    }
    *scaled = *family;
    scaled->edges = edges;
    return BCIFS_OK;
}

/* Its work takes memory of its own, given back at once. */
static bcifs_status component_solve(const struct coordinates *c, const size_t *members, size_t count,
                                    double effort, struct arena *arena, struct solution *solution)
{
    struct arena own = {0};
    struct block block;
    bcifs_status status = block_make(c, members, count, &own, &block);
    if (status == BCIFS_OK)
        status = block_solve(&block, effort, &own, solution);
    if (status == BCIFS_OK) {
        solution->edges =
            arena_grow(arena, solution->edges, solution->length, solution->length, sizeof *solution->edges);
        status = solution->edges ? BCIFS_OK : BCIFS_MEMORY;
    }
    arena_free(&own);
    return status;
}

static bcifs_status components_solve(const struct coordinates *c, double effort, struct arena *arena,
                                     struct joint_bounds *bounds)
{
    size_t *starts, *members = members_list(c, arena, &starts);
    bool *exact = arena_new(arena, c->component_count, sizeof *exact);
    double *uppers = arena_new(arena, c->component_count, sizeof *uppers);
    if (!members || !exact || !uppers)
        return BCIFS_MEMORY;
    for (size_t k = 0; k < c->component_count; k++) {
        size_t count = starts[k + 1] - starts[k];
        struct solution solution;
        if (!component_has_cycle(c, members + starts[k], count))
            continue;
        bcifs_status status = component_solve(c, members + starts[k], count, effort, arena, &solution);
        if (status)
            return status;
        uppers[bounds->blocks] = solution.upper;
        solutions_join(bounds, &solution, exact);
    }
    bounds->exact = true;
    for (size_t k = 0; k < bounds->blocks; k++)
        bounds->exact = bounds->exact && (exact[k] || uppers[k] <= bounds->lower);
    return BCIFS_OK;
}

static bcifs_status find(const struct joint_family *family, double effort, struct arena *arena,
                         struct joint_bounds *bounds)
{
    struct coordinates c = {0};
    struct joint_family scaled;
    int shift;
    bcifs_status status = family_scale(family, arena, &scaled, &shift);
    if (status == BCIFS_OK)
        status = coordinates_make(&c, &scaled, arena);
    if (status == BCIFS_OK)
        status = components_find(c.first, c.arc, c.count, arena, c.component, &c.component_count);
    if (status == BCIFS_OK)
        status = components_solve(&c, effort, arena, bounds);
    bounds->lower = ldexp(bounds->lower, shift);
    bounds->upper = ldexp(bounds->upper, shift);
    return status;
}

bcifs_status joint_radius_find(const struct joint_family *family, double effort, struct arena *arena,
                               struct joint_bounds *bounds)
{
    struct arena own = {0};
    *bounds = (struct joint_bounds){0};
    bcifs_status status = find(family, effort, &own, bounds);
    const size_t *product = bounds->product;
    bounds->product = arena_grow(arena, product, bounds->length, bounds->length, sizeof *product);
    arena_free(&own);
    return status == BCIFS_OK && !bounds->product ? BCIFS_MEMORY : status;
}

const char *joint_bounds_text(const struct joint_bounds *bounds, struct arena *arena)
{
    struct text text = {0};
    unsigned long size = (unsigned long)bounds->size;
    switch (bounds->method) {
    case JOINT_NO_CYCLE:
        text_append(&text, "no cycle of maps");
        break;
    case JOINT_CLOSED:
        text_append(&text, "closed formula");
        break;
    case JOINT_ELLIPSOID:
        text_append(&text, "invariant ellipsoid");
        break;
    case JOINT_TREE:
        text_format(&text, "norms of all products of up to %lu maps", size);
        break;
    case JOINT_POLYTOPE:
        text_format(&text, "invariant polytope of %lu vertices", size);
        break;
    }
    if (bounds->blocks > 1)
        text_format(&text, ", %lu irreducible blocks", (unsigned long)bounds->blocks);
    const char *copy = text.failed ? NULL : arena_text(arena, text.data, text.length);
    text_free(&text);
    return copy;
}
