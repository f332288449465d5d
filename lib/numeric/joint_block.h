/* Joint block: the irreducible parts of a family, and what is tried on each. For joint_radius.c and its kind
 * only. */
#ifndef NUMERIC_JOINT_BLOCK_H
#define NUMERIC_JOINT_BLOCK_H

#include "numeric/joint_radius.h"

struct block_edge {
    size_t from, to;
    const double *matrix;
    double norm, error; /* row norms of the matrix (not below it) and of its error */
    size_t origin;      /* which edge of the family */
};

/* A family whose graph is strongly connected, in some basis. */
struct block {
    size_t node_count, edge_count;
    const size_t *dimensions;
    struct block_edge *edges;
    const size_t *first;   /* edges leaving node x: first[x] … first[x + 1] - 1 */
    size_t total, largest; /* sum and maximum of the dimensions */
};

enum { CANDIDATES_MOST = 8 };

/* Closed paths, none a rotation or power of another, and the spectral radius of their products per map,
 * computed without a certificate: the largest that is known, and those that tie with the first of them. */
struct candidate {
    size_t count;
    double radius;
    const size_t *edges[CANDIDATES_MOST]; /* of the block */
    size_t lengths[CANDIDATES_MOST];
};

/* Products of growing length. `candidate` may be improved; the family's radius is at most `upper`. */
struct tree_outcome {
    double upper;
    size_t length;
};

/* Gripenberg's branch and bound with the row norm of the block's basis. `work`: multiplications that may be
 * spent; `sharp`: relative gap that is good enough. */
bcifs_status block_search(const struct block *block, double work, double sharp, struct arena *arena,
                          struct candidate *candidate, struct tree_outcome *outcome);

/* The product of a closed path, with a bound of its error in the row norm. NULL: no memory. */
double *block_product(const struct block *block, const size_t *edges, size_t length, struct arena *arena,
                      double *error);

/* An invariant polytope for the candidate. `upper` is a bound of the block's radius, infinite when none was
 * found; `strict`: every image but those that define a vertex is strictly inside, so that the radius is the
 * candidate's. */
struct polytope_outcome {
    double upper;
    bool strict;
    size_t vertices;
};

bcifs_status block_polytope(const struct block *block, const struct candidate *candidate, double work,
                            struct arena *arena, struct polytope_outcome *outcome);

#endif
