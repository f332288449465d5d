/* Components: the strongly connected components of a directed graph, R. Tarjan (1972).
 *
 * They are numbered so that arcs lead to the same or a smaller number: whoever goes through them in order
 * meets what a component depends on before the component itself. */
#ifndef NUMERIC_COMPONENTS_H
#define NUMERIC_COMPONENTS_H

#include <stddef.h>

#include "base/memory.h"
#include "bcifs.h"

/* The arcs that leave vertex v of `count` lead to arcs[first[v]] … arcs[first[v + 1] - 1]. `component`
 * receives the number of each vertex's component. */
bcifs_status components_find(const size_t *first, const size_t *arcs, size_t count, struct arena *arena,
                             size_t *component, size_t *component_count);

#endif
