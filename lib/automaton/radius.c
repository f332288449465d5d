#include "radius.h"

#include <math.h>
#include <string.h>

#include "numeric/eigen.h"
#include "numeric/matrix.h"

enum {
    MOST_STATES = 512,     /* taken into the bound */
    MOST_PRODUCTS = 1 << 14, /* kept at one length */
    MOST_LENGTH = 64
};
static const double WORK = 3e7;   /* multiplications spent on lengthening words */
static const double MOST_WORK = 5e8; /* and in all: a cell of hundreds of points gets coarser bounds */
static const double SHARP = 1e-9; /* how close the bounds are brought, when the work allows it */

/* A product of maps along states start … end, that still may exceed the lower bound. */
struct word {
    size_t start, end;
    const double *matrix; /* (points of start - 1) × (points of end - 1) */
    double bound;         /* min over its prefixes of norm^(1/length) */
    size_t parent;        /* in the list of all words; SIZE_MAX: none */
    uint32_t map;
};

struct search {
    struct states *states;
    struct arena *arena;
    struct report *report;
    bool complete;          /* every reached state takes part */
    const double ***linear; /* per state, per child: the linear part in the basis of differences */
    struct word *words;     /* all that were kept, level after level */
    size_t count, capacity, level; /* `level`: where the current length begins */
    size_t length;
    bool columns_norm, exhausted;
    double lower, upper, work;
    size_t best; /* the word that attains `lower` */
    uint32_t best_map;
    size_t best_length;
};

/* Column j of the linear part is T e_{j+1} - T e_j = Σ_i a_i (e_{i+1} - e_i), with a_i = -Σ_{k<=i} of its
 * coordinates, because they sum to 0. */
static double *linear_part(struct arena *arena, const double *map, size_t rows, size_t columns)
{
    double *linear = arena_new(arena, (rows - 1) * (columns - 1), sizeof *linear);
    for (size_t j = 0; linear && j + 1 < columns; j++) {
        double sum = 0;
        for (size_t i = 0; i + 1 < rows; i++) {
            sum += map[i * columns + j + 1] - map[i * columns + j];
            linear[i * (columns - 1) + j] = 0 - sum;
        }
    }
    return linear;
}

/* Largest absolute row sum, or column sum. */
static double norm(const double *matrix, size_t rows, size_t columns, bool by_columns)
{
    double largest = 0;
    size_t outer = by_columns ? columns : rows, inner = by_columns ? rows : columns;
    for (size_t i = 0; i < outer; i++) {
        double sum = 0;
        for (size_t j = 0; j < inner; j++)
            sum += fabs(by_columns ? matrix[j * columns + i] : matrix[i * columns + j]);
        largest = fmax(largest, sum);
    }
    return largest;
}

static bcifs_status linear_parts(struct search *search)
{
    struct states *states = search->states;
    for (size_t i = 0; i < states->count && i < MOST_STATES; i++) {
        bcifs_status status = states_expand(states, i);
        if (status == BCIFS_MEMORY)
            return status;
        search->complete = search->complete && status == BCIFS_OK;
    }
    search->complete = search->complete && states->count <= MOST_STATES;
    search->linear = arena_new(search->arena, states->count, sizeof *search->linear);
    if (!search->linear)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < states->count; i++) {
        const struct state *state = &states->states[i];
        size_t children = state->expanded ? state->cell->child_count : 0;
        search->linear[i] = arena_new(search->arena, children, sizeof **search->linear);
        if (!search->linear[i])
            return BCIFS_MEMORY;
        for (size_t k = 0; k < children; k++) {
            search->linear[i][k] = linear_part(search->arena, state->maps[k], state->points,
                                               states->states[state->children[k]].points);
            if (!search->linear[i][k])
                return BCIFS_MEMORY;
        }
    }
    return BCIFS_OK;
}

/* A cyclic product raises the lower bound. */
static bcifs_status word_radius(struct search *search, const double *matrix, size_t size, size_t parent,
                                uint32_t map)
{
    double cost = 20.0 * (double)size * (double)size * (double)size;
    if (search->work + cost > MOST_WORK)
        return BCIFS_OK;
    double *copy = arena_grow(search->arena, matrix, size * size, size * size + 2 * size, sizeof *copy);
    if (!copy)
        return BCIFS_MEMORY;
    double radius = pow(spectral_radius(copy, size, copy + size * size), 1 / (double)search->length);
    search->work += cost;
    /* A longer power of the same product must not win by rounding. */
    if (radius > search->lower * (1 + 1e-12)) {
        search->lower = radius;
        search->best = parent;
        search->best_map = map;
        search->best_length = search->length;
    }
    return BCIFS_OK;
}

/* Extends a word (SIZE_MAX: the empty one at `start`) by a map. */
static bcifs_status word_extend(struct search *search, size_t parent, size_t start, size_t end, uint32_t map)
{
    const struct state *states = search->states->states;
    size_t next = states[end].children[map];
    size_t rows = states[start].points - 1, inner = states[end].points - 1, columns = states[next].points - 1;
    const double *matrix = search->linear[end][map];
    if (parent != SIZE_MAX) {
        double *product = arena_new(search->arena, rows * columns, sizeof *product);
        if (!product)
            return BCIFS_MEMORY;
        matrix_multiply(search->words[parent].matrix, matrix, rows, inner, columns, product);
        matrix = product;
        search->work += (double)(rows * inner * columns);
    }
    double bound = pow(norm(matrix, rows, columns, search->columns_norm), 1 / (double)search->length);
    if (parent != SIZE_MAX)
        bound = fmin(bound, search->words[parent].bound);
    if (start == next && rows > 0) {
        bcifs_status status = word_radius(search, matrix, rows, parent, map);
        if (status)
            return status;
    }
    if (!ARENA_RESERVE(search->arena, search->words, search->count, search->capacity))
        return BCIFS_MEMORY;
    search->words[search->count++] = (struct word){start, next, matrix, bound, parent, map};
    return BCIFS_OK;
}

/* Gripenberg (1996): words whose bound does not exceed the lower one cannot raise it. Returns the largest bound. */
static double prune(struct search *search, size_t first)
{
    double largest = 0;
    size_t kept = first;
    for (size_t i = first; i < search->count; i++)
        if (search->words[i].bound > search->lower + SHARP) {
            largest = fmax(largest, search->words[i].bound);
            search->words[kept++] = search->words[i];
        }
    search->count = kept;
    return fmax(largest, search->lower + SHARP);
}

static bcifs_status level_first(struct search *search)
{
    search->length = 1;
    search->count = search->level = 0;
    for (size_t i = 0; i < search->states->count; i++) {
        const struct state *state = &search->states->states[i];
        size_t children = state->expanded ? state->cell->child_count : 0;
        for (size_t k = 0; k < children; k++) {
            bcifs_status status = word_extend(search, SIZE_MAX, i, i, (uint32_t)k);
            if (status)
                return status;
        }
    }
    search->upper = prune(search, 0);
    return BCIFS_OK;
}

static bcifs_status level_next(struct search *search)
{
    size_t first = search->level, last = search->count;
    search->length++;
    search->level = last;
    for (size_t i = first; i < last; i++) {
        if (search->work > MOST_WORK || search->count - last > 4 * MOST_PRODUCTS) {
            search->exhausted = true; /* this length is incomplete, so it bounds nothing */
            return BCIFS_OK;
        }
        struct word word = search->words[i];
        const struct state *state = &search->states->states[word.end];
        for (size_t k = 0; state->expanded && k < state->cell->child_count; k++) {
            bcifs_status status = word_extend(search, i, word.start, word.end, (uint32_t)k);
            if (status)
                return status;
        }
    }
    search->upper = fmin(search->upper, prune(search, search->level));
    return BCIFS_OK;
}

/* "arc: 0 1": the state where the word begins, and its maps. */
static bcifs_status word_text(struct search *search, struct radius *radius)
{
    uint32_t maps[MOST_LENGTH];
    size_t length = search->best_length, start = SIZE_MAX;
    radius->product = "";
    if (length == 0)
        return BCIFS_OK;
    maps[length - 1] = search->best_map;
    for (size_t i = search->best, k = length - 1; i != SIZE_MAX; i = search->words[i].parent) {
        maps[--k] = search->words[i].map;
        start = search->words[i].start;
    }
    if (start == SIZE_MAX) /* a single map: its state is the first that has this radius */
        for (size_t i = 0; i < search->states->count && start == SIZE_MAX; i++) {
            const struct state *state = &search->states->states[i];
            if (!state->expanded || search->best_map >= state->cell->child_count ||
                state->children[search->best_map] != i || state->points < 2)
                continue;
            size_t size = state->points - 1;
            double *copy = arena_grow(search->arena, search->linear[i][search->best_map], size * size,
                                      size * size + 2 * size, sizeof *copy);
            if (!copy)
                return BCIFS_MEMORY;
            if (spectral_radius(copy, size, copy + size * size) >= search->lower * (1 - 1e-12))
                start = i;
        }
    if (start == SIZE_MAX)
        return BCIFS_OK;
    struct text text = {0};
    const struct state *state = &search->states->states[start];
    state_name(&state->key, &text);
    text_append(&text, ":");
    for (size_t k = 0; k < length; k++)
        text_format(&text, " %lu", (unsigned long)maps[k]);
    radius->product = text.failed ? NULL : arena_text(search->arena, text.data, text.length);
    text_free(&text);
    radius->source = state->cell->children[maps[0]].source;
    radius->place = state->cell->children[maps[0]].place;
    return radius->product ? BCIFS_OK : BCIFS_MEMORY;
}

bcifs_status radius_bound(struct states *states, struct arena *arena, struct radius *radius)
{
    struct search search = {.states = states, .arena = arena, .complete = true};
    *radius = (struct radius){.product = ""};
    bcifs_status status = linear_parts(&search);
    if (status == BCIFS_OK)
        status = level_first(&search);
    double by_rows = search.upper;
    search.columns_norm = true;
    if (status == BCIFS_OK)
        status = level_first(&search);
    if (status == BCIFS_OK && by_rows < search.upper) {
        search.columns_norm = false;
        status = level_first(&search);
    }
    while (status == BCIFS_OK && !search.exhausted && search.count > search.level &&
           search.length < MOST_LENGTH && search.count - search.level < MOST_PRODUCTS && search.work < WORK)
        status = level_next(&search);
    if (status)
        return status;
    radius->lower = search.lower;
    radius->upper = search.complete ? search.upper : INFINITY; /* a state left out is not bounded */
    return word_text(&search, radius);
}
