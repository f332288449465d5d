/* The automaton as a picture: faces and cells above, edges below them, vertices at the bottom.
 *
 * Arrows run along a grid. An arrow leaves its state through a port as wide as its label, so labels cannot
 * meet, and has a track of its own where it runs sideways. Ports below a state lie on multiples of GRID,
 * ports above one half a step beside them, so that no two arrows share a vertical line. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "output/graph.h"
#include "output/xml.h"

enum {
    GRID = 14,      /* between ports */
    TRACK = 14,     /* between tracks */
    BOX = 46,       /* height of a state */
    LABEL = 24,     /* height of a row of labels */
    GAP = 3 * GRID, /* between states */
    MARGIN = 2 * GRID,
    HEAD = 48,     /* for the title */
    FOOT = 34,     /* for the legend */
    CHARACTER = 8, /* width of a character of 13 pixels in a monospaced face, rounded up */
    RADIUS = 6,    /* of corners */
    LAYERS = 3,
    MOST_ARROWS = 4096
};

/* Where an arrow touches a state. */
struct port {
    size_t arrow;
    bool leaves; /* its tail: it has the label */
    int order;   /* of the state at the other end, from the left */
    int x;
};

struct box {
    int layer, x, y, width;
    struct port *ports[2]; /* above, below */
    size_t counts[2];
};

/* One arrow's way: from its tail sideways on a track, perhaps down a lane at the right and sideways again. */
struct route {
    int x0, x1, track[2];
    int lane; /* x, or 0 without one */
};

struct layout {
    const struct graph *graph;
    struct arena arena;
    struct box *boxes;
    struct route *routes;
    int map_tracks[LAYERS], boundary_tracks[LAYERS]; /* above, below each layer */
    int tops[LAYERS];                                /* y of the boxes of a layer */
    int lanes, width, height;
};

/* ---- Ports --------------------------------------------------------------------------------------------- */

/* UTF-8 characters. */
static int characters(const char *string)
{
    int count = 0;
    for (; *string && count < 1 << 16; string++)
        count += ((unsigned char)*string & 0xc0) != 0x80;
    return count;
}

static int round_up(int length)
{
    return (length + GRID - 1) / GRID * GRID;
}

static int layer_of(enum cell_kind kind)
{
    return kind == CELL_VERTEX ? 2 : kind == CELL_EDGE ? 1 : 0;
}

static int port_width(const struct layout *layout, const struct port *port)
{
    const char *label = layout->graph->arrows[port->arrow].label;
    return port->leaves ? round_up(characters(label) * CHARACTER + GRID) : GRID;
}

static int ports_compare(const void *a, const void *b)
{
    const struct port *one = a, *other = b;
    if (one->order != other->order)
        return one->order < other->order ? -1 : 1;
    if (one->arrow != other->arrow)
        return one->arrow < other->arrow ? -1 : 1;
    return one->leaves ? -1 : 1;
}

static void port_add(struct layout *layout, size_t box, int side, size_t arrow, bool leaves, size_t other)
{
    struct box *at = &layout->boxes[box];
    at->ports[side][at->counts[side]++] = (struct port){arrow, leaves, (int)other, 0};
}

/* Maps leave and enter above; boundaries leave below and enter above. */
static bcifs_status ports_make(struct layout *layout, struct report *report)
{
    const struct graph *graph = layout->graph;
    for (size_t i = 0; i < graph->node_count; i++)
        for (int side = 0; side < 2; side++) {
            size_t count = 0;
            for (size_t a = 0; a < graph->arrow_count; a++)
                count += (size_t)(graph->arrows[a].from == i) + (size_t)(graph->arrows[a].to == i);
            layout->boxes[i].ports[side] = arena_new(&layout->arena, count, sizeof(struct port));
            if (!layout->boxes[i].ports[side])
                return report_memory(report);
        }
    for (size_t a = 0; a < graph->arrow_count; a++) {
        const struct graph_arrow *arrow = &graph->arrows[a];
        port_add(layout, arrow->from, arrow->is_boundary, a, true, arrow->to);
        port_add(layout, arrow->to, 0, a, false, arrow->from);
    }
    for (size_t i = 0; i < graph->node_count; i++)
        for (int side = 0; side < 2; side++)
            qsort(layout->boxes[i].ports[side], layout->boxes[i].counts[side], sizeof(struct port),
                  ports_compare);
    return BCIFS_OK;
}

static int ports_width(const struct layout *layout, const struct box *box, int side)
{
    int width = 0;
    for (size_t i = 0; i < box->counts[side]; i++)
        width += port_width(layout, &box->ports[side][i]);
    return width;
}

static int larger(int a, int b)
{
    return a > b ? a : b;
}

/* ---- States -------------------------------------------------------------------------------------------- */

static void boxes_measure(struct layout *layout)
{
    for (size_t i = 0; i < layout->graph->node_count; i++) {
        const struct graph_node *node = &layout->graph->nodes[i];
        struct box *box = &layout->boxes[i];
        box->layer = layer_of(node->kind);
        /* The name is drawn in 15 pixels, its characters a sixth wider. */
        int width = larger(characters(node->name) * CHARACTER * 7 / 6, 12 * CHARACTER);
        width = larger(width, larger(ports_width(layout, box, 0), ports_width(layout, box, 1)));
        box->width = round_up(width + 2 * GRID);
    }
}

/* Ports are centered below and above their box. */
static void ports_place(struct layout *layout, struct box *box)
{
    for (int side = 0; side < 2; side++) {
        int x =
            box->x + (box->width - ports_width(layout, box, side)) / 2 / GRID * GRID + (side ? 0 : GRID / 2);
        for (size_t i = 0; i < box->counts[side]; i++) {
            struct port *port = &box->ports[side][i];
            struct route *route = &layout->routes[port->arrow];
            port->x = x;
            *(port->leaves ? &route->x0 : &route->x1) = x;
            x += port_width(layout, port);
        }
    }
}

/* The layers one below the other, each centered. */
static void boxes_place(struct layout *layout)
{
    int widths[LAYERS] = {0}, widest = 0;
    for (size_t i = 0; i < layout->graph->node_count; i++)
        widths[layout->boxes[i].layer] += layout->boxes[i].width + GAP;
    for (int layer = 0; layer < LAYERS; layer++)
        widest = larger(widest, widths[layer]);
    for (int layer = 0; layer < LAYERS; layer++) {
        int x = MARGIN + (widest - widths[layer]) / 2 / GRID * GRID;
        for (size_t i = 0; i < layout->graph->node_count; i++) {
            struct box *box = &layout->boxes[i];
            if (box->layer != layer)
                continue;
            box->x = x;
            x += box->width + GAP;
            ports_place(layout, box);
        }
    }
    layout->width = 2 * MARGIN + widest - GAP;
}

/* ---- Tracks -------------------------------------------------------------------------------------------- */

/* A stretch of a track. */
struct stretch {
    int low, high;
    int *track; /* what is to be found */
};

/* Short ones first, so that they lie nearest to the states. */
static int stretches_compare(const void *a, const void *b)
{
    const struct stretch *one = a, *other = b;
    int difference = (one->high - one->low) - (other->high - other->low);
    return difference ? difference : one->low - other->low;
}

/* Every stretch gets the first track where nothing lies beside it. Returns how many tracks that takes. */
static int tracks_choose(struct stretch *stretches, size_t count)
{
    int tracks = 0;
    qsort(stretches, count, sizeof *stretches, stretches_compare);
    for (size_t i = 0; i < count; i++) {
        int track = 0;
        for (size_t j = 0; j < i; j++)
            if (*stretches[j].track == track && stretches[j].low <= stretches[i].high + RADIUS &&
                stretches[i].low <= stretches[j].high + RADIUS) {
                track++;
                j = SIZE_MAX; /* begin again */
            }
        *stretches[i].track = track;
        tracks = larger(tracks, track + 1);
    }
    return tracks;
}

static void stretch_add(struct stretch *stretches, size_t *count, int from, int to, int *track)
{
    stretches[(*count)++] = (struct stretch){from < to ? from : to, larger(from, to), track};
}

/* Of the maps above a layer, or of the boundaries below it. */
static bcifs_status tracks_make(struct layout *layout, int layer, bool boundaries, struct report *report)
{
    const struct graph *graph = layout->graph;
    size_t count = 0;
    struct stretch *stretches = arena_new(&layout->arena, 2 * graph->arrow_count, sizeof *stretches);
    if (!stretches)
        return report_memory(report);
    for (size_t a = 0; a < graph->arrow_count; a++) {
        const struct graph_arrow *arrow = &graph->arrows[a];
        struct route *route = &layout->routes[a];
        int from = layout->boxes[arrow->from].layer;
        if (arrow->is_boundary != boundaries)
            continue;
        if (from == layer)
            stretch_add(stretches, &count, route->x0, route->lane ? route->lane : route->x1,
                        &route->track[0]);
        else if (route->lane && from + 1 == layer)
            stretch_add(stretches, &count, route->lane, route->x1, &route->track[1]);
    }
    *(boundaries ? &layout->boundary_tracks[layer] : &layout->map_tracks[layer]) =
        tracks_choose(stretches, count);
    return BCIFS_OK;
}

/* Boundaries that pass a layer by run down a lane at the right. */
static void lanes_make(struct layout *layout)
{
    for (size_t a = 0; a < layout->graph->arrow_count; a++) {
        const struct graph_arrow *arrow = &layout->graph->arrows[a];
        if (layout->boxes[arrow->to].layer - layout->boxes[arrow->from].layer > 1)
            layout->routes[a].lane = layout->width - MARGIN + ++layout->lanes * GRID;
    }
    layout->width += layout->lanes ? (layout->lanes + 1) * GRID : 0;
}

static bool layer_is_empty(const struct layout *layout, int layer)
{
    for (size_t i = 0; i < layout->graph->node_count; i++)
        if (layout->boxes[i].layer == layer)
            return false;
    return true;
}

static void heights_make(struct layout *layout)
{
    int y = HEAD;
    for (int layer = 0; layer < LAYERS; layer++) {
        if (layer_is_empty(layout, layer))
            continue;
        y += layout->map_tracks[layer] * TRACK + LABEL;
        layout->tops[layer] = y;
        y += BOX + (layout->boundary_tracks[layer] ? LABEL + layout->boundary_tracks[layer] * TRACK : 0);
    }
    for (size_t i = 0; i < layout->graph->node_count; i++)
        layout->boxes[i].y = layout->tops[layout->boxes[i].layer];
    layout->height = y + FOOT;
}

static bcifs_status layout_make(struct layout *layout, struct report *report)
{
    const struct graph *graph = layout->graph;
    if (graph->arrow_count > MOST_ARROWS)
        return report_failure(
            report, BCIFS_INPUT, NULL,
            "the automaton has %zu arrows; a picture of more than %d is no use, .dot has no limit",
            graph->arrow_count, MOST_ARROWS);
    layout->boxes = arena_new(&layout->arena, graph->node_count, sizeof *layout->boxes);
    layout->routes = arena_new(&layout->arena, graph->arrow_count, sizeof *layout->routes);
    if (!layout->boxes || !layout->routes)
        return report_memory(report);
    bcifs_status status = ports_make(layout, report);
    if (status)
        return status;
    boxes_measure(layout);
    boxes_place(layout);
    lanes_make(layout);
    for (int layer = 0; layer < LAYERS && status == BCIFS_OK; layer++) {
        status = tracks_make(layout, layer, false, report);
        if (status == BCIFS_OK)
            status = tracks_make(layout, layer, true, report);
    }
    heights_make(layout);
    return status;
}

/* ---- Drawing ------------------------------------------------------------------------------------------- */

static void number_write(struct file *file, const char *before, int number)
{
    file_text(file, before);
    file_text(file, number < 0 ? "-" : "");
    file_integer(file, (uint64_t)abs(number));
}

static void text_write(struct file *file, const char *class, int x, int y, const char *text)
{
    file_text(file, "<text class=\"");
    file_text(file, class);
    number_write(file, "\" x=\"", x);
    number_write(file, "\" y=\"", y);
    file_text(file, "\">");
    xml_write(file, text);
    file_text(file, "</text>\n");
}

static int sign(int number)
{
    return number < 0 ? -1 : number > 0;
}

/* Rounds the corner (x, y) from (x0, y0) to (x1, y1), one side of which is horizontal, the other vertical. */
static void corner_write(struct file *file, int x0, int y0, int x, int y, int x1, int y1)
{
    int before = abs(x - x0) + abs(y - y0), after = abs(x1 - x) + abs(y1 - y);
    int shorter = before < after ? before : after, radius = shorter / 2 < RADIUS ? shorter / 2 : RADIUS;
    number_write(file, "L", x - sign(x - x0) * radius);
    number_write(file, " ", y - sign(y - y0) * radius);
    number_write(file, "Q", x);
    number_write(file, " ", y);
    number_write(file, " ", x + sign(x1 - x) * radius);
    number_write(file, " ", y + sign(y1 - y) * radius);
}

/* A line through the corners, and the head at its end, which points down. */
static void way_write(struct file *file, const char *class, const int (*corners)[2], size_t count)
{
    const int *last = corners[count - 1];
    file_text(file, "<path class=\"");
    file_text(file, class);
    number_write(file, "\" d=\"M", corners[0][0]);
    number_write(file, " ", corners[0][1]);
    for (size_t i = 1; i + 1 < count; i++)
        corner_write(file, corners[i - 1][0], corners[i - 1][1], corners[i][0], corners[i][1],
                     corners[i + 1][0], corners[i + 1][1]);
    number_write(file, "L", last[0]);
    number_write(file, " ", last[1] - 8);
    number_write(file, "\"/>\n<path class=\"head\" d=\"M", last[0]);
    number_write(file, " ", last[1]);
    number_write(file, "L", last[0] - 4);
    number_write(file, " ", last[1] - 10);
    number_write(file, "L", last[0] + 4);
    number_write(file, " ", last[1] - 10);
    file_text(file, "Z\"/>\n");
}

static void map_write(const struct layout *layout, size_t index, struct file *file)
{
    const struct graph_arrow *arrow = &layout->graph->arrows[index];
    const struct route *route = &layout->routes[index];
    int top = layout->boxes[arrow->from].y, y = top - LABEL - route->track[0] * TRACK;
    const int corners[][2] = {{route->x0, top}, {route->x0, y}, {route->x1, y}, {route->x1, top}};
    way_write(file, "map", corners, 4);
    text_write(file, "label", route->x0 + 5, top - 7, arrow->label);
}

static void boundary_write(const struct layout *layout, size_t index, struct file *file)
{
    const struct graph_arrow *arrow = &layout->graph->arrows[index];
    const struct route *route = &layout->routes[index];
    const struct box *from = &layout->boxes[arrow->from], *to = &layout->boxes[arrow->to];
    int below = from->y + BOX, y = below + LABEL + route->track[0] * TRACK;
    text_write(file, "label", route->x0 + 5, below + 16, arrow->label);
    if (!route->lane) {
        const int corners[][2] = {{route->x0, below}, {route->x0, y}, {route->x1, y}, {route->x1, to->y}};
        way_write(file, "boundary", corners, 4);
        return;
    }
    int across = layout->tops[from->layer + 1] + BOX + LABEL + route->track[1] * TRACK;
    const int corners[][2] = {{route->x0, below},    {route->x0, y},      {route->lane, y},
                              {route->lane, across}, {route->x1, across}, {route->x1, to->y}};
    way_write(file, "boundary", corners, 6);
}

static bcifs_status box_write(const struct layout *layout, size_t index, struct file *file,
                              struct report *report)
{
    static const char *const classes[] = {
        [CELL_VERTEX] = "vertex", [CELL_EDGE] = "edge", [CELL_FACE] = "face", [CELL_CELL] = "face"};
    const struct graph_node *node = &layout->graph->nodes[index];
    const struct box *box = &layout->boxes[index];
    int radius = node->kind == CELL_VERTEX ? BOX / 2 : node->kind == CELL_EDGE ? 8 : 0;
    struct text points = {0};
    graph_points(node, &points);
    file_text(file, "<rect class=\"");
    file_text(file, classes[node->kind]);
    number_write(file, "\" x=\"", box->x);
    number_write(file, "\" y=\"", box->y);
    number_write(file, "\" width=\"", box->width);
    number_write(file, "\" height=\"", BOX);
    number_write(file, "\" rx=\"", radius);
    file_text(file, "\"/>\n");
    text_write(file, "name", box->x + box->width / 2, box->y + 20, node->name);
    text_write(file, "points", box->x + box->width / 2, box->y + 37, points.failed ? "" : points.data);
    bool failed = points.failed;
    text_free(&points);
    return failed ? report_memory(report) : BCIFS_OK;
}

static void head_write(const struct layout *layout, const char *command, struct file *file)
{
    const bcifs_automaton *automaton = layout->graph->automaton;
    const char *title = bcifs_automaton_title(automaton);
    title = title[0] ? title : bcifs_automaton_name(automaton);
    file_text(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"");
    number_write(file, " width=\"", layout->width);
    number_write(file, "\" height=\"", layout->height);
    number_write(file, "\" viewBox=\"0 0 ", layout->width);
    number_write(file, " ", layout->height);
    file_text(file, "\">\n<title>");
    xml_write(file, title);
    file_text(file, "</title>\n<desc>");
    xml_write(file, command ? command : "");
    file_text(file, "</desc>\n<style>\n"
                    "text { font-family: 'DejaVu Sans Mono', Menlo, Consolas, monospace; font-size: 13px; "
                    "fill: #1c1c1c }\n"
                    ".name { font-size: 15px; text-anchor: middle; font-weight: bold }\n"
                    ".points { font-size: 12px; text-anchor: middle; fill: #555 }\n"
                    ".title { font-size: 16px }\n"
                    ".map, .boundary { fill: none; stroke: #1c1c1c; stroke-width: 1.3 }\n"
                    ".boundary { stroke-dasharray: 5 3 }\n"
                    ".head { fill: #1c1c1c }\n"
                    ".face, .edge, .vertex { stroke: #1c1c1c; stroke-width: 1.3 }\n"
                    ".face { fill: #f3e3c3 }\n.edge { fill: #dbe6f1 }\n.vertex { fill: #e3efdc }\n"
                    "</style>\n");
    number_write(file, "<rect width=\"", layout->width);
    number_write(file, "\" height=\"", layout->height);
    file_text(file, "\" fill=\"#fff\"/>\n");
    text_write(file, "title", MARGIN, 30, title);
}

/* The title and the legend may be wider than the states. */
static void width_widen(struct layout *layout, const char *legend)
{
    const char *title = bcifs_automaton_title(layout->graph->automaton);
    int words = larger(characters(title) * CHARACTER * 5 / 4, characters(legend) * CHARACTER) + 2 * MARGIN;
    int narrower = words - layout->width;
    if (narrower <= 0)
        return;
    int shift = narrower / 2 / GRID * GRID;
    layout->width = words;
    for (size_t i = 0; i < layout->graph->node_count; i++)
        layout->boxes[i].x += shift;
    for (size_t a = 0; a < layout->graph->arrow_count; a++) {
        layout->routes[a].x0 += shift;
        layout->routes[a].x1 += shift;
        layout->routes[a].lane += layout->routes[a].lane ? shift : 0;
    }
}

bcifs_status graph_svg_write(const struct graph *graph, const char *command, struct file *file,
                             struct report *report)
{
    static const char legend[] = "solid: maps, dashed: boundaries";
    struct layout layout = {.graph = graph};
    bcifs_status status = layout_make(&layout, report);
    if (status == BCIFS_OK) {
        width_widen(&layout, legend);
        head_write(&layout, command, file);
        for (size_t a = 0; a < graph->arrow_count; a++)
            (graph->arrows[a].is_boundary ? boundary_write : map_write)(&layout, a, file);
        for (size_t i = 0; i < graph->node_count && status == BCIFS_OK; i++)
            status = box_write(&layout, i, file, report);
        text_write(file, "points\" style=\"text-anchor: start", MARGIN, layout.height - 12, legend);
        file_text(file, "</svg>\n");
    }
    arena_free(&layout.arena);
    return status;
}
