#include "graph.h"

#include <string.h>

#include "automaton/figure.h"
#include "base/memory.h"
#include "output/format.h"

/* ---- Labels -------------------------------------------------------------------------------------------- */

static bcifs_status text_keep(struct graph *graph, struct text *text, struct report *report,
                              const char **kept)
{
    *kept = text->failed ? NULL : arena_text(&graph->arena, text->data, text->length);
    text_free(text);
    return *kept ? BCIFS_OK : report_memory(report);
}

/* "p(u,v,w)": the state as the file defines it. */
static bcifs_status name_make(struct graph *graph, const struct definition *definition, struct report *report,
                              const char **name)
{
    struct text text = {0};
    text_append(&text, definition->name);
    const struct syntax_cell *syntax = definition->syntax;
    for (size_t i = 0; syntax && i < syntax->argument_count; i++)
        text_format(&text, "%s%s", i ? "," : "(", syntax->arguments[i]);
    text_append(&text, syntax && syntax->argument_count ? ")" : "");
    return text_keep(graph, &text, report, name);
}

void graph_points(const struct graph_node *node, struct text *text)
{
    if (node->known)
        text_format(text, "%zu point%s", node->points, node->points == 1 ? "" : "s");
    else
        text_append(text, "points vary");
}

static size_t node_of(const struct graph *graph, const struct definition *definition)
{
    size_t i = 0;
    while (i < graph->node_count && graph->automaton->definitions[i] != definition)
        i++;
    return i;
}

/* Adds ", T4…T7": three and more that follow each other are a range. */
static void range_append(struct text *text, size_t first, size_t last)
{
    text_format(text, "%sT%zu", text->length ? ", " : "", first);
    if (last > first)
        text_format(text, last > first + 1 ? "…T%zu" : ", T%zu", last);
}

static bcifs_status arrow_add(struct graph *graph, size_t from, size_t to, bool is_boundary,
                              struct text *label, struct report *report)
{
    struct graph_arrow arrow = {from, to, is_boundary, NULL};
    bcifs_status status = text_keep(graph, label, report, &arrow.label);
    if (status)
        return status;
    if (!ARENA_RESERVE(&graph->arena, graph->arrows, graph->arrow_count, graph->arrow_capacity))
        return report_memory(report);
    graph->arrows[graph->arrow_count++] = arrow;
    return BCIFS_OK;
}

/* The maps from `node` to the state of child `first`, unless an earlier child went there. */
static bcifs_status maps_add(struct graph *graph, size_t node, const struct cell *cell, size_t first,
                             struct report *report)
{
    const struct definition *target = cell->children[first].state.definition;
    struct text label = {0};
    for (size_t i = 0; i < first; i++)
        if (cell->children[i].state.definition == target)
            return BCIFS_OK;
    for (size_t i = first; i < cell->child_count; i++) {
        size_t last = i;
        if (cell->children[i].state.definition != target)
            continue;
        while (last + 1 < cell->child_count && cell->children[last + 1].state.definition == target)
            last++;
        range_append(&label, i, last);
        i = last;
    }
    return arrow_add(graph, node, node_of(graph, target), false, &label, report);
}

/* The boundaries in the state of boundary `first`, unless an earlier one is. */
static bcifs_status boundaries_add(struct graph *graph, size_t node, const struct cell *cell, size_t first,
                                   struct report *report)
{
    const struct definition *target = cell->boundaries[first].state.definition;
    struct text label = {0};
    for (size_t i = 0; i < first; i++)
        if (cell->boundaries[i].state.definition == target)
            return BCIFS_OK;
    for (size_t i = first; i < cell->boundary_count; i++)
        if (cell->boundaries[i].state.definition == target)
            text_format(&label, "%s%s", label.length ? ", " : "", cell->boundaries[i].name);
    return arrow_add(graph, node, node_of(graph, target), true, &label, report);
}

/* ---- The whole ----------------------------------------------------------------------------------------- */

static bcifs_status node_make(struct graph *graph, struct states *states, size_t index, struct report *report)
{
    const struct definition *definition = graph->automaton->definitions[index];
    struct graph_node *node = &graph->nodes[index];
    size_t state = 0;
    node->kind = definition->kind;
    bcifs_status status = name_make(graph, definition, report, &node->name);
    if (status == BCIFS_OK)
        status = representative_find(states, definition, &state, &node->known);
    if (status || !node->known)
        return status;
    status = states_expand(states, state);
    if (status)
        return status;
    const struct cell *cell = states->states[state].cell;
    node->points = cell->points;
    for (size_t i = 0; i < cell->child_count && status == BCIFS_OK; i++)
        status = maps_add(graph, index, cell, i, report);
    for (size_t i = 0; i < cell->boundary_count && status == BCIFS_OK; i++)
        status = boundaries_add(graph, index, cell, i, report);
    return status;
}

static bcifs_status graph_make(struct graph *graph, const bcifs_automaton *automaton, struct report *report)
{
    struct states states;
    graph->automaton = automaton;
    graph->node_count = automaton->definition_count;
    graph->nodes = arena_new(&graph->arena, graph->node_count, sizeof *graph->nodes);
    if (!graph->nodes || states_of_figures(automaton, &states, &graph->arena) == BCIFS_MEMORY)
        return report_memory(report);
    states.setting.report = report;
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < graph->node_count && status == BCIFS_OK; i++)
        status = node_make(graph, &states, i, report);
    return status;
}

bcifs_status bcifs_write_graph(const bcifs_automaton *automaton, const char *path,
                               const bcifs_write_options *options, bcifs_error *error)
{
    struct report report = report_new(NULL);
    struct graph graph = {0};
    struct file file;
    const char *ending = strrchr(path, '.');
    const char *format = options && options->format ? options->format : ending ? ending + 1 : "dot";
    bool dot = strcmp(format, "dot") == 0;
    bcifs_status status = BCIFS_OK;
    if (!dot && strcmp(format, "svg") != 0)
        status = report_failure(&report, BCIFS_INPUT, NULL, "an automaton is drawn as dot or svg, not '%s'",
                                format);
    if (status == BCIFS_OK)
        status = graph_make(&graph, automaton, &report);
    if (status == BCIFS_OK)
        status = file_open(&file, path, &report);
    if (status == BCIFS_OK)
        file_close(&file, dot ? graph_dot_write(&graph, &file, &report)
                              : graph_svg_write(&graph, options ? options->command : NULL, &file, &report));
    arena_free(&graph.arena);
    return report_close(&report, error);
}
