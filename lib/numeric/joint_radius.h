/* Joint radius: certified bounds of the joint spectral radius of a constrained family of matrices.
 *
 * The family is a directed graph: its nodes have dimensions, its edges carry matrices, dimension(from) ×
 * dimension(to), that are multiplied along paths. The joint spectral radius is the limit, over ever longer
 * paths, of the largest norm of a product to the power 1/length (Rota and Strang, 1960; for graphs, Dai,
 * 2012). One node makes it the usual one; no cycle makes it 0.
 *
 * Both bounds hold in exact arithmetic, for every family whose entries lie within the stated errors of those
 * given (docs/mathematics.md, "Joint spectral radius"). */
#ifndef NUMERIC_JOINT_RADIUS_H
#define NUMERIC_JOINT_RADIUS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/memory.h"
#include "bcifs.h"

struct joint_edge {
    size_t from, to;
    const double *matrix; /* dimension(from) × dimension(to), finite */
    const double *error;  /* how far each entry may be off, not negative; NULL: not at all */
};

struct joint_family {
    const size_t *dimensions; /* of the nodes; 0 is a dimension */
    size_t node_count;
    const struct joint_edge *edges;
    size_t edge_count;
};

/* What proves the upper bound. */
enum joint_method {
    JOINT_NO_CYCLE,  /* no product is longer than the graph: the radius is 0 */
    JOINT_CLOSED,    /* dimension one, or one single cycle: a formula */
    JOINT_ELLIPSOID, /* a norm of ellipsoids, one for each node */
    JOINT_TREE,      /* norms of all products that can matter, up to a length (Gripenberg, 1996) */
    JOINT_POLYTOPE   /* a norm of polytopes, one for each node (Guglielmi and Protasov, 2013) */
};

struct joint_bounds {
    double lower, upper;
    bool exact;            /* the radius is that of `product`, proved; the bounds differ by rounding only */
    const size_t *product; /* indices of edges: a cycle whose product attains `lower` */
    size_t length;         /* 0: there is no cycle */
    enum joint_method method;
    size_t size;   /* length of products (JOINT_TREE) or number of vertices (JOINT_POLYTOPE) */
    size_t blocks; /* irreducible blocks that the family was split into */
};

/* `effort` scales the work that may be spent, 1 is usual: a tenth of a second for a dozen dimensions. Results
 * go to `arena`. The only failure is BCIFS_MEMORY; a search that gives up leaves wide bounds. */
bcifs_status joint_radius_find(const struct joint_family *family, double effort, struct arena *arena,
                               struct joint_bounds *bounds);

/* What proves the upper bound, in words, or NULL (no memory). */
const char *joint_bounds_text(const struct joint_bounds *bounds, struct arena *arena);

#endif
