/* The automaton for Graphviz: dot -Tpdf x.dot. */
#include "output/graph.h"

/* A string in quotes, as the dot language reads it. */
static void quoted_write(struct file *file, const char *text)
{
    file_text(file, "\"");
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            file_text(file, "\\");
        file_write(file, (unsigned char)*text < 0x20 ? " " : text, 1);
    }
    file_text(file, "\"");
}

static bcifs_status node_write(const struct graph_node *node, size_t index, struct file *file,
                               struct report *report)
{
    static const char *const shapes[] = {[CELL_VERTEX] = "ellipse",
                                         [CELL_EDGE] = "box, style=rounded",
                                         [CELL_FACE] = "box",
                                         [CELL_CELL] = "box"};
    struct text label = {0};
    text_append(&label, node->name);
    text_append(&label, ": ");
    graph_points(node, &label);
    file_text(file, "  n");
    file_integer(file, index);
    file_text(file, " [label=");
    quoted_write(file, label.failed ? "" : label.data);
    file_text(file, ", shape=");
    file_text(file, shapes[node->kind]);
    file_text(file, "];\n");
    bool failed = label.failed;
    text_free(&label);
    return failed ? report_memory(report) : BCIFS_OK;
}

static void arrow_write(const struct graph_arrow *arrow, struct file *file)
{
    file_text(file, "  n");
    file_integer(file, arrow->from);
    file_text(file, " -> n");
    file_integer(file, arrow->to);
    file_text(file, " [label=");
    quoted_write(file, arrow->label);
    file_text(file, arrow->is_boundary ? ", style=dashed];\n" : "];\n");
}

bcifs_status graph_dot_write(const struct graph *graph, struct file *file, struct report *report)
{
    bcifs_status status = BCIFS_OK;
    const char *title = bcifs_automaton_title(graph->automaton);
    file_text(file, "// Maps are solid arrows, boundaries dashed ones.\ndigraph ");
    quoted_write(file, bcifs_automaton_name(graph->automaton));
    file_text(file, " {\n  label=");
    quoted_write(file, title[0] ? title : bcifs_automaton_name(graph->automaton));
    file_text(file, ";\n  labelloc=t;\n");
    for (size_t i = 0; i < graph->node_count && status == BCIFS_OK; i++)
        status = node_write(&graph->nodes[i], i, file, report);
    for (size_t i = 0; i < graph->arrow_count; i++)
        arrow_write(&graph->arrows[i], file);
    file_text(file, "}\n");
    return status;
}
