#include "reach.h"

#include "numeric/components.h"

/* The list as it grows; `place` holds, for every state of the table, its place from 1 on, or 0. */
struct growth {
    size_t *list, count, capacity;
    size_t *place, known;
};

static bcifs_status state_add(struct growth *growth, size_t state, struct arena *arena)
{
    if (state >= growth->known) {
        size_t known = 2 * state + 16;
        growth->place = arena_grow(arena, growth->place, growth->known, known, sizeof *growth->place);
        if (!growth->place)
            return BCIFS_MEMORY;
        growth->known = known;
    }
    if (growth->place[state])
        return BCIFS_OK;
    if (!ARENA_RESERVE(arena, growth->list, growth->count, growth->capacity))
        return BCIFS_MEMORY;
    growth->list[growth->count] = state;
    growth->place[state] = ++growth->count;
    return BCIFS_OK;
}

static bcifs_status states_gather(struct states *states, const size_t *list, size_t count,
                                  struct arena *arena, struct growth *growth)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < count && status == BCIFS_OK; i++)
        status = state_add(growth, list[i], arena);
    for (size_t i = 0; i < growth->count && status == BCIFS_OK; i++) {
        status = states_expand(states, growth->list[i]);
        const struct state *state = &states->states[growth->list[i]];
        for (size_t k = 0; status == BCIFS_OK && k < state->cell->child_count; k++)
            status = state_add(growth, state->children[k], arena);
    }
    return status;
}

/* Sorts the places by component. */
static bcifs_status members_sort(struct reach *reach, struct arena *arena)
{
    size_t *first = arena_new(arena, reach->component_count + 2, sizeof *first);
    size_t *members = arena_new(arena, reach->count, sizeof *members);
    if (!first || !members)
        return BCIFS_MEMORY;
    for (size_t x = 0; x < reach->count; x++)
        first[reach->component[x] + 2]++;
    for (size_t c = 0; c < reach->component_count; c++)
        first[c + 2] += first[c + 1];
    for (size_t x = 0; x < reach->count; x++)
        members[first[reach->component[x] + 1]++] = x;
    reach->first = first;
    reach->members = members;
    return BCIFS_OK;
}

bcifs_status reach_find(struct states *states, const size_t *list, size_t count, struct arena *arena,
                        struct reach *reach)
{
    struct growth growth = {0};
    bcifs_status status = states_gather(states, list, count, arena, &growth);
    if (status)
        return status;
    size_t arc_count = 0, next = 0;
    for (size_t x = 0; x < growth.count; x++)
        arc_count += states->states[growth.list[x]].cell->child_count;
    size_t *first = arena_new(arena, growth.count + 1, sizeof *first);
    size_t *arcs = arena_new(arena, arc_count, sizeof *arcs);
    size_t *component = arena_new(arena, growth.count, sizeof *component);
    if (!first || !arcs || !component)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < growth.known; i++)
        growth.place[i] -= growth.place[i] > 0;
    for (size_t x = 0; x < growth.count; x++) {
        const struct state *state = &states->states[growth.list[x]];
        for (size_t k = 0; k < state->cell->child_count; k++)
            arcs[next++] = growth.place[state->children[k]];
        first[x + 1] = next;
    }
    *reach = (struct reach){
        .list = growth.list, .count = growth.count, .place = growth.place, .component = component};
    status = components_find(first, arcs, growth.count, arena, component, &reach->component_count);
    return status ? status : members_sort(reach, arena);
}
