/* Branch and bound over products: G. Gripenberg, Computing the joint spectral radius (1996). */
#include "joint_block.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "numeric/eigen.h"
#include "numeric/enclosure.h"
#include "numeric/tolerance.h"

enum {
    MOST_LENGTH = 256,
    MOST_WORDS = 1 << 15 /* kept at one length */
};
static const size_t MOST_BYTES = (size_t)1 << 26; /* of all words together, whatever the effort */

static const double MOST_EIGEN_SHARE =
    5; /* eigenvalues may overdraw the work: without a candidate nothing is won */
static const size_t NO_PARENT = SIZE_MAX;

/* A path that still may lead to a larger radius. `bound`: the least norm^(1/length) of its beginnings. */
struct word {
    size_t start, end;
    const double *matrix;
    double norm, error, bound;
    size_t parent, edge;
};

struct search {
    const struct block *block;
    struct arena *arena;
    struct word *words;
    size_t count, capacity, level; /* `level`: where the current length begins */
    size_t length, bytes;          /* `bytes`: taken from the arena before the search */
    double sharp, work, most_work;
    double pruned; /* the largest bound among words given up */
    struct candidate *candidate;
    size_t path[MOST_LENGTH];
    double *workspace; /* largest² + 2 largest */
};

static void path_collect(struct search *search, size_t word)
{
    size_t k = search->length;
    for (size_t i = word; i != NO_PARENT && k > 0; i = search->words[i].parent)
        search->path[--k] = search->words[i].edge;
}

/* Whether two closed paths are rotations of each other. */
static bool is_rotation(const size_t *a, const size_t *b, size_t length)
{
    for (size_t shift = 0; shift < length; shift++) {
        size_t k = 0;
        while (k < length && a[k] == b[(k + shift) % length])
            k++;
        if (k == length)
            return true;
    }
    return false;
}

/* Whether the path is a shorter one several times. */
static bool is_power(const size_t *path, size_t length)
{
    for (size_t period = 1; 2 * period <= length; period++) {
        size_t k = period;
        while (k < length && path[k] == path[k - period])
            k++;
        if (k == length && length % period == 0)
            return true;
    }
    return false;
}

/* Keeps a closed path whose radius is better than the candidate's, or as good. */
static bcifs_status candidate_offer(struct search *search, double radius)
{
    struct candidate *candidate = search->candidate;
    if (!(radius >= candidate->radius * (1 - TOLERANCE_EXACT)) || radius == 0)
        return BCIFS_OK;
    bool better =
        radius > candidate->radius * (1 + TOLERANCE_EXACT); /* a longer one must not win by rounding */
    for (size_t i = 0; i < candidate->count && !better; i++)
        if (candidate->lengths[i] == search->length &&
            is_rotation(candidate->edges[i], search->path, search->length))
            return BCIFS_OK;
    if (better) {
        candidate->count = 0;
        candidate->radius = radius;
    }
    if (candidate->count == CANDIDATES_MOST)
        return BCIFS_OK;
    size_t *edges = arena_grow(search->arena, search->path, search->length, search->length, sizeof *edges);
    if (!edges)
        return BCIFS_MEMORY;
    candidate->edges[candidate->count] = edges;
    candidate->lengths[candidate->count++] = search->length;
    return BCIFS_OK;
}

/* A closed path may be a better candidate. Its norm bounds its radius, which saves most eigenvalues. All
 * rotations are looked at, because some of them begin with products that are too small to be kept. */
static bcifs_status cycle_try(struct search *search, const struct word *word, size_t index)
{
    size_t size = search->block->dimensions[word->start];
    double exponent = 1 / (double)search->length;
    if (word->start != word->end ||
        pow(word->norm, exponent) < search->candidate->radius * (1 - TOLERANCE_EXACT))
        return BCIFS_OK;
    path_collect(search, index);
    if (is_power(search->path, search->length))
        return BCIFS_OK;
    double cost = 25.0 * (double)(size * size * size);
    if (search->work + cost > MOST_EIGEN_SHARE * search->most_work)
        return BCIFS_OK;
    search->work += cost;
    memcpy(search->workspace, word->matrix, size * size * sizeof *search->workspace);
    double radius = spectral_radius(search->workspace, size, search->workspace + size * size);
    return candidate_offer(search, pow(radius, exponent));
}

/* Extends a word (NO_PARENT: the empty one) by an edge. */
static bcifs_status word_extend(struct search *search, size_t parent, size_t edge)
{
    const struct block_edge *e = &search->block->edges[edge];
    struct word word = {.start = e->from,
                        .end = e->to,
                        .matrix = e->matrix,
                        .norm = e->norm,
                        .error = e->error,
                        .bound = INFINITY,
                        .parent = parent,
                        .edge = edge};
    if (parent != NO_PARENT) {
        const struct word *before = &search->words[parent];
        size_t rows = search->block->dimensions[before->start];
        size_t inner = search->block->dimensions[e->from], columns = search->block->dimensions[e->to];
        double *product = arena_new(search->arena, rows * columns, sizeof *product);
        if (!product)
            return BCIFS_MEMORY;
        word.start = before->start;
        word.error = multiply_enclosed(before->matrix, before->norm, before->error, e->matrix, e->norm,
                                       e->error, rows, inner, columns, product);
        word.norm = row_norm(product, rows, columns);
        word.matrix = product;
        word.bound = before->bound;
        search->work += (double)(rows * (inner + 2) * columns) + 20;
    }
    word.bound =
        fmin(word.bound, round_up(pow(round_up(word.norm + word.error, 1), 1 / (double)search->length), 4));
    if (!ARENA_RESERVE(search->arena, search->words, search->count, search->capacity))
        return BCIFS_MEMORY;
    search->words[search->count++] = word;
    return cycle_try(search, &word, search->count - 1);
}

/* Drops the words of this length that cannot exceed the candidate; returns the largest bound among the
 * others. */
static double prune(struct search *search)
{
    double largest = 0, threshold = search->candidate->radius * (1 + search->sharp);
    size_t kept = search->level;
    for (size_t i = search->level; i < search->count; i++) {
        const struct word *word = &search->words[i];
        if (word->bound > threshold) {
            largest = fmax(largest, word->bound);
            search->words[kept++] = *word;
        } else {
            search->pruned = fmax(search->pruned, word->bound);
        }
    }
    search->count = kept;
    return largest;
}

/* Whether the next length would cost more than is left. */
static bool is_exhausted(const struct search *search)
{
    double live = (double)(search->count - search->level);
    double degree = (double)search->block->edge_count / (double)search->block->node_count;
    double size = (double)search->block->largest;
    return search->length >= MOST_LENGTH || live * degree > MOST_WORDS ||
           search->arena->used - search->bytes > MOST_BYTES ||
           search->work + live * degree * (size * size * (size + 2) + 20) > search->most_work;
}

static bcifs_status level_next(struct search *search)
{
    const struct block *block = search->block;
    size_t first = search->level, last = search->count;
    search->length++;
    search->level = last;
    for (size_t i = first; i < last; i++) {
        size_t end = search->words[i].end;
        for (size_t edge = block->first[end]; edge < block->first[end + 1]; edge++) {
            bcifs_status status = word_extend(search, i, edge);
            if (status)
                return status;
        }
    }
    return BCIFS_OK;
}

bcifs_status block_search(const struct block *block, double work, double sharp, struct arena *arena,
                          struct candidate *candidate, struct tree_outcome *outcome)
{
    struct search search = {.block = block,
                            .arena = arena,
                            .length = 1,
                            .sharp = sharp,
                            .most_work = work,
                            .candidate = candidate,
                            .bytes = arena->used};
    bcifs_status status = BCIFS_OK;
    search.workspace = arena_new(arena, block->largest * block->largest + 2 * block->largest, sizeof(double));
    if (!search.workspace)
        return BCIFS_MEMORY;
    for (size_t edge = 0; edge < block->edge_count && status == BCIFS_OK; edge++)
        status = word_extend(&search, NO_PARENT, edge);
    double live = prune(&search);
    *outcome = (struct tree_outcome){fmax(live, search.pruned), 1};
    while (status == BCIFS_OK && search.count > search.level && !is_exhausted(&search)) {
        status = level_next(&search);
        live = prune(&search);
        if (fmax(live, search.pruned) < outcome->upper)
            *outcome = (struct tree_outcome){fmax(live, search.pruned), search.length};
    }
    return status;
}

double *block_product(const struct block *block, const size_t *edges, size_t length, struct arena *arena,
                      double *error)
{
    const struct block_edge *e = &block->edges[edges[0]];
    size_t rows = block->dimensions[e->from];
    double *product = arena_grow(arena, e->matrix, rows * block->dimensions[e->to],
                                 rows * block->dimensions[e->to], sizeof *product);
    *error = e->error;
    for (size_t k = 1; k < length && product; k++) {
        e = &block->edges[edges[k]];
        size_t inner = block->dimensions[e->from], columns = block->dimensions[e->to];
        double *next = arena_new(arena, rows * columns, sizeof *next);
        if (next)
            *error = multiply_enclosed(product, row_norm(product, rows, inner), *error, e->matrix, e->norm,
                                       e->error, rows, inner, columns, next);
        product = next;
    }
    return product;
}
