/* Reach: the states that are reached from some of a table through their maps, in strongly connected
 * components.
 *
 * What a state's maps determine of it (moments, forms) is one linear system for all states of a component;
 * everything else that occurs in it belongs to components of smaller numbers. So a figure with hundreds of
 * states, most of which never come back to themselves, costs hundreds of small systems. */
#ifndef AUTOMATON_REACH_H
#define AUTOMATON_REACH_H

#include "automaton/states.h"

struct reach {
    size_t *list, count;     /* states of the table, all expanded */
    const size_t *place;     /* of each child of these states: where it stands in the list */
    const size_t *component; /* of each place; those of children are not greater */
    size_t component_count;
    const size_t *first, *members; /* component c: places members[first[c]] … members[first[c + 1] - 1] */
};

/* From the `count` states listed, which may be named twice. */
bcifs_status reach_find(struct states *states, const size_t *list, size_t count, struct arena *arena,
                        struct reach *reach);

#endif
