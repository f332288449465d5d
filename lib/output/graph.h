/* Graph: an automaton as the slides of [SI] draw it: a node for every state, arrows for maps and for
 * boundaries. */
#ifndef OUTPUT_GRAPH_H
#define OUTPUT_GRAPH_H

#include "automaton/describe.h"
#include "output/file.h"

/* A definition; its arguments are shown by their names. */
struct graph_node {
    const char *name; /* "p(u,v,w)" */
    enum cell_kind kind;
    size_t points;
    bool known; /* false: its sizes depend on arguments that no figure gives, so it has no arrows */
};

/* All maps, or all boundaries, from one state to another. */
struct graph_arrow {
    size_t from, to;
    bool is_boundary;
    const char *label; /* "T0, T1", "start, end" */
};

struct graph {
    struct arena arena;
    const bcifs_automaton *automaton;
    struct graph_node *nodes;
    size_t node_count;
    struct graph_arrow *arrows;
    size_t arrow_count, arrow_capacity;
};

/* "3 points" */
void graph_points(const struct graph_node *node, struct text *text);

bcifs_status graph_dot_write(const struct graph *graph, struct file *file, struct report *report);
bcifs_status graph_svg_write(const struct graph *graph, const char *command, struct file *file,
                             struct report *report);

#endif
