#include "components.h"

#include <stdbool.h>
#include <stdint.h>

/* The walk, with an explicit stack: graphs come from files. */
struct walk {
    size_t count;
    const size_t *first, *arcs;
    size_t
        *order; /* when a vertex was first seen, from 1; 0: not yet; beyond `count`: its component is known */
    size_t *low;  /* the earliest vertex on the stack that is known to be reached */
    size_t *next; /* the arc to follow next */
    size_t *stack, height;
    size_t *calls, depth;
    size_t seen;
};

static void vertex_enter(struct walk *walk, size_t v)
{
    walk->order[v] = walk->low[v] = ++walk->seen;
    walk->next[v] = walk->first[v];
    walk->stack[walk->height++] = v;
    walk->calls[walk->depth++] = v;
}

/* Follows one arc of v; false when none is left. */
static bool arc_follow(struct walk *walk, size_t v)
{
    if (walk->next[v] == walk->first[v + 1])
        return false;
    size_t w = walk->arcs[walk->next[v]++];
    if (!walk->order[w])
        vertex_enter(walk, w);
    else if (walk->order[w] <= walk->count && walk->order[w] < walk->low[v])
        walk->low[v] = walk->order[w];
    return true;
}

static void vertex_leave(struct walk *walk, size_t v, size_t *component, size_t *component_count)
{
    if (walk->low[v] == walk->order[v]) {
        for (size_t w = SIZE_MAX; w != v;) {
            w = walk->stack[--walk->height];
            component[w] = *component_count;
            walk->order[w] += walk->count;
        }
        ++*component_count;
    }
    if (--walk->depth == 0)
        return;
    size_t caller = walk->calls[walk->depth - 1];
    if (walk->low[v] < walk->low[caller])
        walk->low[caller] = walk->low[v];
}

bcifs_status components_find(const size_t *first, const size_t *arcs, size_t count, struct arena *arena,
                             size_t *component, size_t *component_count)
{
    size_t *room = arena_new(arena, count, 5 * sizeof *room);
    if (!room)
        return BCIFS_MEMORY;
    struct walk walk = {.count = count,
                        .first = first,
                        .arcs = arcs,
                        .order = room,
                        .low = room + count,
                        .next = room + 2 * count,
                        .stack = room + 3 * count,
                        .calls = room + 4 * count};
    *component_count = 0;
    for (size_t root = 0; root < count; root++) {
        if (walk.order[root])
            continue;
        vertex_enter(&walk, root);
        while (walk.depth > 0) {
            size_t v = walk.calls[walk.depth - 1];
            if (!arc_follow(&walk, v))
                vertex_leave(&walk, v, component, component_count);
        }
    }
    return BCIFS_OK;
}
