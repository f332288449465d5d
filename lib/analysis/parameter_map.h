/* Parameter map: the class of an automaton at every node of a grid over one or two of its params.
 *
 * [SI] "Condition de différentiabilité" finds by hand for which ratios (a,b) of corner cutting the tangent is
 * continuous; a map shows the like for any automaton. The file is read once: a grid point is the same
 * definitions elaborated for other values. Nodes are exact fractions where the ends of the range are, so that
 * a grid that hits 1/3 or 1/16 hits it exactly. Grid points do not know of each other, so their classes are
 * the same for any number of threads. */
#ifndef ANALYSIS_PARAMETER_MAP_H
#define ANALYSIS_PARAMETER_MAP_H

#include "automaton/automaton.h"

enum {
    MAP_MOST_POINTS = 1 << 22, /* of a grid: one byte each */
    MAP_MOST_AXES = 2,
    MAP_MOST_THREADS = 256
};

struct map_axis {
    size_t parameter; /* of the automaton */
    const char *name;
    size_t count;              /* nodes, at least 2 */
    const struct value *nodes; /* rising, the first and the last are the ends of the range */
};

struct bcifs_map {
    struct arena arena;
    const bcifs_automaton *automaton;
    struct map_axis axes[MAP_MOST_AXES];
    size_t axis_count;
    size_t columns, rows;   /* counts of the first and the second axis; one axis has one row */
    unsigned char *classes; /* bcifs_map_class, rows × columns */
    /* The maps are those of corner cutting, [SI] "Cas des courbes construites par élimination des coins":
     * [1-a b 0; a 1-b 1-a; 0 0 a] and [b 0 0; 1-b 1-a b; 0 a 1-b]. Then the condition of [SI] is known:
     * 1-2a-b >= 0 and 1-a-2b >= 0. */
    bool cuts_corners;
    size_t cut_axes[2]; /* which axis is a, which is b */
};

#endif
