/* Ladder: the control polygons of a curve figure at a row of levels, and the cells that they belong to.
 *
 * A figure's own control points stand on one rung. Finer rungs are its subdivisions, [IM] 5.1: every cell is replaced
 * by its children. Coarser ones undo a subdivision: consecutive cells are recognized as the children of one cell. States
 * are recognized by what they do (the same maps, and children that do the same), so that p(u,v,v) is found to be the
 * left(u,v) that a non-uniform spline subdivides to.
 *
 * The polygon of a chain runs through all control points of its cells: consecutive cells share m_s of them ([IM] (5));
 * that of a closed chain wraps. Polygons of several chains stand one after the other. */
#ifndef MULTIRES_LADDER_H
#define MULTIRES_LADDER_H

#include "automaton/figure.h"
#include "numeric/stencil.h"

enum { LADDER_MOST_LEVELS = 64, LADDER_MOST_POINTS = 1 << 26 };

/* The cells of a chain at one level. */
struct rung {
    const size_t *cells; /* states */
    size_t count;
    size_t points; /* of the polygon */
};

struct ladder_chain {
    bool closed;
    struct rung *rungs; /* [0] is the coarsest level, [levels] the finest */
};

struct ladder {
    struct arena *arena;
    const bcifs_figure *figure;
    struct states states;
    unsigned levels; /* between the coarsest and the finest rung */
    unsigned own;    /* the rung of the figure's own control points */
    struct ladder_chain *chains;
    size_t chain_count;
    const size_t *places; /* on the own rung: the figure's control point that each point of the polygon is */
};

/* The rungs from `coarsen` subdivisions above to `refine` below the figure's own: refine + coarsen levels where
 * `coarsen` counts from the finest. BCIFS_INPUT with the reason when the figure is no curve, when its control points do
 * not form polygons, or when it cannot be coarsened so far: the message says how far it can, and what would do. */
bcifs_status ladder_create(struct ladder *ladder, const bcifs_figure *figure, unsigned refine, unsigned coarsen,
                           struct arena *arena, struct report *report);
/* Points of all chains' polygons together. */
size_t ladder_points(const struct ladder *ladder, unsigned rung);
/* The refinement matrix P of a chain from rung `rung` to rung + 1: points of the finer polygon × of the coarser, [MR]
 * (2), [IM] 4.1. One block for each cell. */
bcifs_status ladder_refinement(const struct ladder *ladder, size_t chain, unsigned rung, struct stencil *refinement);
/* The figure's control points, as seen from `origin` (dimension numbers; NULL: 0), subdivided down to the finest rung:
 * ladder_points × dimension numbers. */
bcifs_status ladder_figure_points(const struct ladder *ladder, const double *origin, double *points);
/* A figure of its own on the cells of a rung, with control points of the figure's dimension (ladder_points of them). */
bcifs_status ladder_figure(const struct ladder *ladder, unsigned rung, const double *points, bcifs_figure **figure,
                           struct report *report);
/* Whether two states do the same. */
bcifs_status states_equivalent(struct states *states, size_t a, size_t b, bool *equivalent);

#endif
