/* Orders of elimination for sparse_cholesky.h: four candidates, compared by the entries that L would have. */
#include "sparse_cholesky.h"

#include <string.h>

/* The pattern of A + A^T without the diagonal: of row i the neighbors list[starts[i] … starts[i + 1] - 1]. */
struct neighbors {
    size_t size;
    size_t *starts;
    uint32_t *list;
};

static const uint32_t NONE = UINT32_MAX;

static bool neighbors_make(struct neighbors *graph, const struct sparse *a, struct arena *arena)
{
    size_t count = 0;
    struct sparse b;
    graph->size = a->rows;
    graph->starts = arena_new(arena, a->rows + 1, sizeof *graph->starts);
    graph->list = arena_new(arena, 2 * a->starts[a->rows], sizeof *graph->list);
    if (!graph->starts || !graph->list || !sparse_transpose(a, &b, arena))
        return false;
    for (size_t i = 0; i < a->rows; i++) {
        size_t k = a->starts[i], l = b.starts[i];
        while (k < a->starts[i + 1] || l < b.starts[i + 1]) {
            uint32_t left = k < a->starts[i + 1] ? a->columns[k] : NONE;
            uint32_t right = l < b.starts[i + 1] ? b.columns[l] : NONE, column = left < right ? left : right;
            k += left == column;
            l += right == column;
            if (column != i)
                graph->list[count++] = column;
        }
        graph->starts[i + 1] = count;
    }
    return true;
}

static size_t degree(const struct neighbors *graph, size_t i)
{
    return graph->starts[i + 1] - graph->starts[i];
}

/* ---- Entries of L -------------------------------------------------------------------------------------- */

/* Workspace: size entries each. */
struct order_work {
    uint32_t *places, *parents, *ancestors, *marks;
};

/* The elimination tree and the entries of L below the diagonal, row by row along it (as sparse_cholesky.c has
 * it); `limit` when there are no fewer. */
static size_t count_entries(const struct neighbors *graph, const size_t *order, size_t limit,
                            const struct order_work *work)
{
    size_t count = 0;
    for (size_t i = 0; i < graph->size; i++)
        work->places[order[i]] = (uint32_t)i;
    for (size_t i = 0; i < graph->size && count < limit; i++) {
        const uint32_t *list = graph->list + graph->starts[order[i]];
        size_t entries = degree(graph, order[i]);
        work->parents[i] = work->ancestors[i] = NONE;
        work->marks[i] = (uint32_t)i;
        for (size_t k = 0; k < entries; k++) {
            uint32_t next;
            for (uint32_t j = work->places[list[k]]; j != NONE && j < i; j = next) {
                next = work->ancestors[j];
                work->ancestors[j] = (uint32_t)i;
                if (next == NONE)
                    work->parents[j] = (uint32_t)i;
            }
        }
        for (size_t k = 0; k < entries && count < limit; k++)
            for (uint32_t j = work->places[list[k]]; j < i && work->marks[j] != i; j = work->parents[j]) {
                work->marks[j] = (uint32_t)i;
                count++;
            }
    }
    return count < limit ? count : limit;
}

/* ---- Cuthill and McKee --------------------------------------------------------------------------------- */

/* Nodes of one component breadth first from `start`, of low degree first: order[count …]; returns the new
 * count. `marks` hold `mark` for nodes that were met. */
static size_t walk_breadth(const struct neighbors *graph, size_t start, uint32_t *marks, uint32_t mark,
                           size_t *order, size_t count)
{
    size_t next = count;
    order[count++] = start;
    marks[start] = mark;
    while (next < count) {
        size_t node = order[next++], first = count;
        for (size_t k = graph->starts[node]; k < graph->starts[node + 1]; k++) {
            size_t neighbor = graph->list[k], place = count;
            if (marks[neighbor] == mark)
                continue;
            marks[neighbor] = mark;
            count++;
            /* A node of very many neighbors is not worth sorting them: all its degrees are then large. */
            for (; place > first && place < first + 64 &&
                   degree(graph, order[place - 1]) > degree(graph, neighbor);
                 place--)
                order[place] = order[place - 1];
            order[place] = neighbor;
        }
    }
    return count;
}

/* Each component from a node far away from any other, the last one met from its first node; then reversed. */
static void order_cuthill_mckee(const struct neighbors *graph, uint32_t *marks, size_t *order)
{
    size_t count = 0, size = graph->size;
    memset(marks, 0, size * sizeof *marks);
    for (size_t i = 0; i < size; i++) {
        if (marks[i] != 0)
            continue;
        size_t end = walk_breadth(graph, i, marks, 1, order, count);
        count = walk_breadth(graph, order[end - 1], marks, 2, order, count);
    }
    for (size_t i = 0; i < size / 2; i++) {
        size_t keep = order[i];
        order[i] = order[size - 1 - i];
        order[size - 1 - i] = keep;
    }
}

/* ---- Minimum degree ------------------------------------------------------------------------------------ */

/* The graph of what is left: eliminating a node joins its neighbors to each other. Lists are held as they
 * are, not as cliques, so the work is that of the entries of L, squared where they are many: it is given up
 * beyond a budget. */
struct remaining {
    uint32_t **lists; /* unsorted; eliminated nodes are taken out */
    uint32_t *counts, *capacities;
    uint32_t *next, *previous; /* of the nodes of one degree, doubly linked; NONE at the ends */
    uint32_t *heads;           /* the first node of each degree */
    uint32_t *marks, stamp;
    size_t work, budget;
};

static void bucket_insert(struct remaining *left, uint32_t node)
{
    uint32_t *head = &left->heads[left->counts[node]];
    left->next[node] = *head;
    left->previous[node] = NONE;
    if (*head != NONE)
        left->previous[*head] = node;
    *head = node;
}

static void bucket_remove(struct remaining *left, uint32_t node)
{
    uint32_t next = left->next[node], previous = left->previous[node];
    if (previous == NONE)
        left->heads[left->counts[node]] = next;
    else
        left->next[previous] = next;
    if (next != NONE)
        left->previous[next] = previous;
}

static bool remaining_make(struct remaining *left, const struct neighbors *graph, struct arena *arena)
{
    size_t size = graph->size;
    left->lists = arena_new(arena, size, sizeof *left->lists);
    left->counts = arena_new(arena, size, sizeof *left->counts);
    left->capacities = arena_new(arena, size, sizeof *left->capacities);
    left->next = arena_new(arena, size, sizeof *left->next);
    left->previous = arena_new(arena, size, sizeof *left->previous);
    left->heads = arena_new(arena, size, sizeof *left->heads);
    left->marks = arena_new(arena, size, sizeof *left->marks);
    if (!left->lists || !left->counts || !left->capacities || !left->next || !left->previous ||
        !left->heads || !left->marks)
        return false;
    for (size_t i = 0; i < size; i++)
        left->heads[i] = NONE;
    for (size_t i = size; i-- > 0;) {
        left->lists[i] = graph->list + graph->starts[i];
        left->counts[i] = left->capacities[i] = (uint32_t)degree(graph, i);
        bucket_insert(left, (uint32_t)i);
    }
    return true;
}

/* The neighbors of `gone` that `node` lacks become its own, `gone` no longer is. */
static bool node_join(struct remaining *left, uint32_t node, uint32_t gone, struct arena *arena)
{
    uint32_t stamp = ++left->stamp, count = 0, most = left->counts[node] + left->counts[gone];
    uint32_t *list = left->lists[node];
    left->marks[node] = stamp;
    for (uint32_t k = 0; k < left->counts[node]; k++)
        if (list[k] != gone) {
            left->marks[list[k]] = stamp;
            list[count++] = list[k];
        }
    for (uint32_t k = 0; k < left->counts[gone]; k++) {
        uint32_t neighbor = left->lists[gone][k];
        if (left->marks[neighbor] == stamp)
            continue;
        if (count == left->capacities[node]) {
            list = arena_grow(arena, list, count, 2 * (size_t)most, sizeof *list);
            if (!list)
                return false;
            left->lists[node] = list;
            left->capacities[node] = 2 * most;
        }
        list[count++] = neighbor;
    }
    left->work += most;
    left->counts[node] = count;
    return true;
}

/* The node of least degree next, until none is left or the budget is spent: then `order` is not complete.
 * False when memory is out. */
static bool order_minimum_degree(const struct neighbors *graph, size_t budget, size_t *order, bool *complete)
{
    struct arena arena = {0};
    struct remaining left = {.budget = budget};
    bool made = remaining_make(&left, graph, &arena);
    size_t count = 0, least = 0;
    while (made && count < graph->size && left.work <= budget) {
        while (left.heads[least] == NONE)
            least++;
        uint32_t gone = left.heads[least];
        bucket_remove(&left, gone);
        order[count++] = gone;
        for (uint32_t k = 0; made && k < left.counts[gone]; k++) {
            uint32_t node = left.lists[gone][k];
            bucket_remove(&left, node);
            made = node_join(&left, node, gone, &arena);
            bucket_insert(&left, node);
            least = left.counts[node] < least ? left.counts[node] : least;
        }
    }
    *complete = count == graph->size;
    arena_free(&arena);
    return made;
}

/* ---- The best ------------------------------------------------------------------------------------------ */

/* Keeps `candidate` in `order` when it makes fewer entries than `*least`. */
static void order_compare(const struct neighbors *graph, const size_t *candidate,
                          const struct order_work *work, size_t *least, size_t *order)
{
    size_t count = count_entries(graph, candidate, *least, work);
    if (count < *least) {
        *least = count;
        memcpy(order, candidate, graph->size * sizeof *order);
    }
}

static bool order_choose(const struct neighbors *graph, struct arena *arena, size_t *order)
{
    enum { HOPELESS = 64, GOOD = 2, FAIR = 4, EFFORT = 512 };
    size_t size = graph->size, entries = graph->starts[size], least = HOPELESS * (entries + size);
    size_t *candidate = arena_new(arena, size, sizeof *candidate);
    struct order_work work = {
        arena_new(arena, size, sizeof(uint32_t)), arena_new(arena, size, sizeof(uint32_t)),
        arena_new(arena, size, sizeof(uint32_t)), arena_new(arena, size, sizeof(uint32_t))};
    if (!candidate || !work.places || !work.parents || !work.ancestors || !work.marks)
        return false;
    for (size_t i = 0; i < size; i++) {
        order[i] = i;
        candidate[i] = size - 1 - i;
    }
    /* A holds each of its entries twice. Where L has GOOD times as many nothing is to be gained; up to FAIR
     * times as many the search for a minimum degree costs more than it saves. */
    order_compare(graph, candidate, &work, &least, order);
    if (least <= GOOD * entries / 2)
        return true;
    for (size_t i = 0; i < size; i++)
        candidate[i] = i;
    order_compare(graph, candidate, &work, &least, order);
    if (least <= GOOD * entries / 2)
        return true;
    order_cuthill_mckee(graph, work.marks, candidate);
    order_compare(graph, candidate, &work, &least, order);
    if (least <= FAIR * entries / 2)
        return true;
    /* The work is that of factoring with the degrees it finds: it should not exceed twice that of the best so
     * far. */
    bool complete;
    double work_best = 2 * (double)least * (double)least / (double)size,
           work_most = EFFORT * (double)(entries + size);
    if (!order_minimum_degree(graph, (size_t)(work_best < work_most ? work_best : work_most), candidate,
                              &complete))
        return false;
    if (complete)
        order_compare(graph, candidate, &work, &least, order);
    return true;
}

bool sparse_order(const struct sparse *a, size_t *order)
{
    struct arena scratch = {0};
    struct neighbors graph;
    bool made = neighbors_make(&graph, a, &scratch) && order_choose(&graph, &scratch, order);
    arena_free(&scratch);
    return made;
}
