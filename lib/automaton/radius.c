#include "radius.h"

#include <math.h>

#include "automaton/restriction.h"

enum { MOST_STATES = 512 /* taken into the bound */ };

/* Expands the states that are reached, and lists those that have numbers. `complete`: none is left out. */
static bcifs_status states_list(struct states *states, struct arena *arena, size_t **list, size_t *count,
                                bool *complete)
{
    *count = 0;
    *complete = true;
    for (size_t i = 0; i < states->count && i < MOST_STATES; i++) {
        bcifs_status status = states_expand(states, i);
        if (status == BCIFS_MEMORY)
            return status;
        *complete = *complete && status == BCIFS_OK;
    }
    *complete = *complete && states->count <= MOST_STATES;
    *list = arena_new(arena, states->count, sizeof **list);
    if (!*list)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < states->count; i++)
        if (states->states[i].expanded)
            (*list)[(*count)++] = i;
    return BCIFS_OK;
}

/* "arc: 0 1": the state where the word begins, and its maps. */
static bcifs_status word_text(const struct states *states, const struct restriction *restriction,
                              const struct joint_bounds *bounds, struct arena *arena, struct radius *radius)
{
    struct text text = {0};
    radius->product = "";
    if (bounds->length == 0)
        return BCIFS_OK;
    const struct restricted_map *first = &restriction->maps[bounds->product[0]];
    const struct state *state = &states->states[restriction->states[first->from]];
    state_name(&state->key, &text);
    text_append(&text, ":");
    for (size_t k = 0; k < bounds->length; k++)
        text_format(&text, " %lu", (unsigned long)restriction->maps[bounds->product[k]].child);
    radius->product = text.failed ? NULL : arena_text(arena, text.data, text.length);
    text_free(&text);
    radius->source = state->cell->children[first->child].source;
    radius->place = state->cell->children[first->child].place;
    return radius->product ? BCIFS_OK : BCIFS_MEMORY;
}

static bcifs_status bound(struct states *states, struct arena *own, struct arena *arena, struct radius *radius)
{
    struct restriction restriction;
    struct joint_family family;
    struct joint_bounds bounds;
    size_t *list, count;
    bool complete;
    bcifs_status status = states_list(states, own, &list, &count, &complete);
    if (status == BCIFS_OK)
        status = restriction_begin(&restriction, states, list, count, own);
    if (status == BCIFS_OK)
        status = restriction_family(&restriction, own, &family);
    if (status == BCIFS_OK)
        status = joint_radius_find(&family, 1, own, &bounds);
    if (status)
        return status;
    radius->lower = bounds.lower;
    radius->upper = complete ? bounds.upper : INFINITY; /* a state left out is not bounded */
    radius->certificate = complete ? joint_bounds_text(&bounds, arena) : "not all states that are reached are bounded";
    if (!radius->certificate)
        return BCIFS_MEMORY;
    return word_text(states, &restriction, &bounds, arena, radius);
}

bcifs_status radius_bound(struct states *states, struct arena *arena, struct radius *radius)
{
    struct arena own = {0};
    *radius = (struct radius){.product = "", .certificate = ""};
    bcifs_status status = bound(states, &own, arena, radius);
    arena_free(&own);
    return status;
}
