/* Figure: pieces in states with numbers, their control points chosen from the figure's, [IM] (1) and 3.3.
 *
 * Arcs form chains: consecutive pieces share the control points of their joint, which is verified. Cells stand
 * alone. The states that are reached from the pieces are shared by all plans made from the figure. */
#ifndef AUTOMATON_FIGURE_H
#define AUTOMATON_FIGURE_H

#include "automaton/automaton.h"
#include "automaton/states.h"

/* One piece: control point j of its state is point indices[j] of the figure. */
struct piece {
    size_t state; /* in the figure's states */
    const size_t *indices;
};

/* Consecutive pieces that meet; `closed` when the last meets the first. */
struct chain {
    size_t first, count; /* pieces */
    bool closed;
};

enum figure_shape { FIGURE_CURVE, FIGURE_ATTRACTOR, FIGURE_SURFACE };

struct bcifs_figure {
    struct arena arena;
    const bcifs_automaton *automaton;
    const char *name; /* "" for a bare state */
    enum figure_shape shape;
    bool displaced;     /* it has `displace` lines */
    unsigned dimension; /* of a point */
    bool unplaced;      /* a bare state without control points of its own: `points` stand for any */
    const double *points; /* point_count × dimension */
    const struct value *exact_points; /* the same as the file writes them; NULL where they were given in doubles */
    size_t point_count;
    struct piece *pieces;
    size_t piece_count;
    struct chain *chains; /* of a curve */
    size_t chain_count;
    struct states states; /* of the pieces, and what was reached in binding them */
};

const bcifs_automaton *figure_automaton(const bcifs_figure *figure);
/* Binds a figure of the file (or, with `definition` NULL, one piece in the state of options->state, or in the first
 * affine one) to its control points. `figure` is zeroed and holds its arena already. */
bcifs_status figure_bind(bcifs_figure *figure, const bcifs_automaton *automaton,
                         const struct figure_definition *definition, const bcifs_figure_options *options,
                         struct report *report);
/* The states without arguments and those that the figures' pieces are in, with what they reach (up to a limit). */
bcifs_status states_of_figures(const bcifs_automaton *automaton, struct states *states, struct arena *arena);

#endif
