#include "radius.h"

#include <float.h>
#include <math.h>

#include "automaton/restriction.h"

enum {
    MOST_STATES = 512, /* taken into the bound */
    MOST_DEGREE = 8    /* of the polynomials that are split off */
};

/* The family whose radius is that of the automaton: the restriction, and next to it what was split off,
 * families of numbers. Edge e is map origin[e] of the restriction. */
struct parts {
    size_t *dimensions, node_count;
    struct joint_edge *edges;
    size_t *origin, edge_count, capacity, origin_capacity;
};

/* What takes part in the bound. */
struct reached {
    size_t *list, count;
    bool complete;    /* no state is left out */
    size_t dimension; /* largest number of factors of a product, 1 without products */
};

static size_t factor_count(const struct definition *definition)
{
    if (definition->form != DEFINITION_PRODUCT)
        return 1;
    return factor_count(definition->factors[0]) + factor_count(definition->factors[1]);
}

/* Adds the two factors of a product to the table: with the arguments written for them, or their share of the
 * product's. */
static bcifs_status factors_intern(struct states *states, struct state_key key)
{
    const struct definition *product = key.definition;
    size_t next = 0, index;
    for (int i = 0; i < 2; i++) {
        struct state_key factor = {product->factors[i], key.arguments ? key.arguments + next : NULL};
        bcifs_status status = BCIFS_OK;
        if (product->factor_references[i])
            status = reference_evaluate(&states->setting, states->arena, product->factor_references[i],
                                        product->module, key.arguments, &factor);
        else
            next += product->factors[i]->argument_count;
        if (status == BCIFS_OK)
            status = states_intern(states, factor, &index);
        if (status)
            return status;
    }
    return BCIFS_OK;
}

/* Expands the states that are reached, and lists those that have numbers. Products do not take part, their
 * factors do: on differences, A ⊗ B has the blocks A, B (on differences of one factor's points) and A ⊗ B of
 * differences of both, whose radius is the product of the factors'. So it adds nothing when these are
 * below 1. */
static bcifs_status states_list(struct states *states, struct arena *arena, struct reached *reached)
{
    *reached = (struct reached){.complete = true, .dimension = 1};
    for (size_t i = 0; i < states->count && i < MOST_STATES; i++) {
        struct state_key key = states->states[i].key;
        bool is_product = key.definition->form == DEFINITION_PRODUCT;
        bcifs_status status = is_product ? factors_intern(states, key) : states_expand(states, i);
        if (status == BCIFS_MEMORY)
            return status;
        reached->complete = reached->complete && status == BCIFS_OK;
        if (is_product && factor_count(key.definition) > reached->dimension)
            reached->dimension = factor_count(key.definition);
    }
    reached->complete = reached->complete && states->count <= MOST_STATES;
    reached->list = arena_new(arena, states->count, sizeof *reached->list);
    if (!reached->list)
        return BCIFS_MEMORY;
    for (size_t i = 0; i < states->count; i++)
        if (states->states[i].expanded && states->states[i].key.definition->form != DEFINITION_PRODUCT)
            reached->list[reached->count++] = i;
    return BCIFS_OK;
}

static bcifs_status part_add(struct parts *parts, struct joint_edge edge, size_t origin, struct arena *arena)
{
    size_t count = parts->edge_count;
    if (!ARENA_RESERVE(arena, parts->edges, count, parts->capacity) ||
        !ARENA_RESERVE(arena, parts->origin, count, parts->origin_capacity))
        return BCIFS_MEMORY;
    parts->edges[count] = edge;
    parts->origin[count] = origin;
    parts->edge_count++;
    return BCIFS_OK;
}

/* With q^x A = N^-k q^y the maps are block triangular: what they do on the kernels of q, and the numbers N^-k
 * on the quotients, which are lines where q is not 0. */
static bcifs_status numbers_add(struct parts *parts, const struct restriction *restriction, int k,
                                struct value *const *q, struct arena *arena)
{
    size_t base = parts->node_count;
    parts->dimensions = arena_grow(arena, parts->dimensions, base, base + restriction->count, sizeof(size_t));
    if (!parts->dimensions)
        return BCIFS_MEMORY;
    parts->node_count += restriction->count;
    for (size_t x = 0; x < restriction->count; x++)
        for (size_t i = 0; i < restriction->dimensions[x]; i++)
            if (!value_is_zero(q[x][i]))
                parts->dimensions[base + x] = 1;
    for (size_t e = 0; e < restriction->map_count; e++) {
        const struct restricted_map *map = &restriction->maps[e];
        struct value number = value_divide(value_from_integer(1), value_power((int64_t)map->subdivisions, k));
        double *entry = arena_new(arena, 2, sizeof *entry);
        if (!entry)
            return BCIFS_MEMORY;
        entry[1] = value_pin(&number, DBL_EPSILON);
        entry[0] = number.real;
        bcifs_status status = part_add(
            parts, (struct joint_edge){base + map->from, base + map->to, entry, entry + 1}, e, arena);
        if (status)
            return status;
    }
    return BCIFS_OK;
}

/* Splits polynomials off as long as there are any, so that the search is left with what it is needed for. */
static bcifs_status parts_make(struct restriction *restriction, struct arena *arena, struct parts *parts,
                               struct joint_family *family)
{
    struct value **q = arena_new(arena, restriction->count, sizeof *q);
    *parts = (struct parts){0};
    if (!q)
        return BCIFS_MEMORY;
    for (int k = 1; k <= MOST_DEGREE && restriction->exact;) {
        size_t found;
        bcifs_status status = restriction_functional(restriction, k, arena, q, &found);
        if (status == BCIFS_OK && found > 0)
            status = numbers_add(parts, restriction, k, q, arena);
        if (status == BCIFS_OK && found > 0)
            status = restriction_reduce(restriction, (const struct value *const *)q, arena);
        if (status)
            return status;
        k += found == 0;
    }
    size_t base = parts->node_count;
    parts->dimensions = arena_grow(arena, parts->dimensions, base, base + restriction->count, sizeof(size_t));
    bcifs_status status = parts->dimensions ? restriction_family(restriction, arena, family) : BCIFS_MEMORY;
    for (size_t x = 0; x < restriction->count && status == BCIFS_OK; x++)
        parts->dimensions[parts->node_count++] = restriction->dimensions[x];
    for (size_t e = 0; e < restriction->map_count && status == BCIFS_OK; e++) {
        struct joint_edge edge = family->edges[e];
        edge.from += base;
        edge.to += base;
        status = part_add(parts, edge, e, arena);
    }
    *family = (struct joint_family){parts->dimensions, parts->node_count, parts->edges, parts->edge_count};
    return status;
}

/* "arc: 0 1": the state where the word begins, and its maps. */
static bcifs_status word_text(const struct states *states, const struct restriction *restriction,
                              const struct parts *parts, const struct joint_bounds *bounds,
                              struct arena *arena, struct radius *radius)
{
    struct text text = {0};
    radius->product = "";
    if (bounds->length == 0)
        return BCIFS_OK;
    const struct restricted_map *first = &restriction->maps[parts->origin[bounds->product[0]]];
    const struct state *state = &states->states[restriction->states[first->from]];
    state_name(&state->key, &text);
    text_append(&text, ":");
    for (size_t k = 0; k < bounds->length; k++)
        text_format(&text, " %lu", (unsigned long)restriction->maps[parts->origin[bounds->product[k]]].child);
    radius->product = text.failed ? NULL : arena_text(arena, text.data, text.length);
    text_free(&text);
    radius->source = state->cell->children[first->child].source;
    radius->place = state->cell->children[first->child].place;
    return radius->product ? BCIFS_OK : BCIFS_MEMORY;
}

static bcifs_status bound(struct states *states, struct arena *own, struct arena *arena,
                          struct radius *radius)
{
    struct restriction restriction;
    struct joint_family family;
    struct joint_bounds bounds;
    struct reached reached;
    struct parts parts;
    bcifs_status status = states_list(states, own, &reached);
    if (status == BCIFS_OK)
        status = restriction_begin(&restriction, states, reached.list, reached.count, own);
    if (status == BCIFS_OK)
        status = parts_make(&restriction, own, &parts, &family);
    if (status == BCIFS_OK)
        status = joint_radius_find(&family, 1, own, &bounds);
    if (status)
        return status;
    radius->lower = bounds.lower;
    radius->upper = reached.complete ? bounds.upper : INFINITY; /* a state left out is not bounded */
    if (radius->upper >= 1 && reached.dimension > 1)
        radius->upper = pow(radius->upper, (double)reached.dimension) * (1 + 8 * DBL_EPSILON);
    radius->certificate =
        reached.complete ? joint_bounds_text(&bounds, arena) : "not all states that are reached are bounded";
    if (!radius->certificate)
        return BCIFS_MEMORY;
    return word_text(states, &restriction, &parts, &bounds, arena, radius);
}

bcifs_status radius_bound(struct states *states, struct arena *arena, struct radius *radius)
{
    struct arena own = {0};
    *radius = (struct radius){.product = "", .certificate = ""};
    bcifs_status status = bound(states, &own, arena, radius);
    arena_free(&own);
    return status;
}
