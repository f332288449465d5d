/* Plan: everything that evaluating a figure at one depth needs, of a size that does not depend on the number of
 * points (design, section 8).
 *
 * Every cell of the depth contributes a few columns in its own barycentric space: the limit point of its start
 * vertex, a seed there, its control points up to those it shares with the next cell. The leaf table W of a state
 * holds these columns for all words of the last `tail` levels, multiplied out, so the points of a subtree are
 * P·W: one small dense product that streams its output, the same for every automaton. Counts say how many points
 * each subtree has, so any point can be found without walking to it. */
#ifndef EVALUATE_PLAN_H
#define EVALUATE_PLAN_H

#include "automaton/figure.h"

enum {
    PLAN_DEEPEST = 4096,
    PLAN_TABLE_BYTES = 16 * 1024,           /* of one leaf table: half of a first-level cache */
    PLAN_TABLES_BYTES = 8 * 1024 * 1024,    /* of all together */
    PLAN_MOST_COUNTS = 1 << 24              /* entries of the table of counts: levels × states */
};
#define PLAN_MOST_POINTS (UINT64_C(1) << 40)

/* Columns in a state's space: points × count numbers. */
struct columns {
    const double *numbers;
    size_t count;
};

/* A run of points: a piece's subtree, or the last points of an open chain, which no next cell brings. */
struct segment {
    size_t piece;
    bool is_tail;
    uint64_t first; /* index of its first point */
};

struct bcifs_plan {
    struct arena arena;
    const bcifs_figure *figure;
    struct states states;
    bcifs_show show;
    const double *seed;
    size_t seed_count;
    unsigned depth, tail; /* the last `tail` levels are in the tables */
    size_t walked;        /* states that cells are in; limit points may have reached vertices after them */
    size_t *least;        /* per state: the smallest level at which it is reached, or SIZE_MAX */
    const uint64_t *counts; /* counts[level * walked + state]: points below a state with `level` levels left */
    struct columns *leaves; /* per state: what one cell contributes */
    struct columns *tables; /* per state: W */
    struct columns *ends;   /* per state: what the last cell of an open chain adds; NULL numbers: not needed */
    size_t largest;         /* control points of any state */
    struct segment *segments;
    size_t segment_count;
    bcifs_path *paths;
    size_t path_count;
    unsigned polygon;
    uint64_t offset, points; /* of the whole figure's points, those from `offset` on are the plan's */
};

/* P·C for the piece's own control points: dimension × points of its state, row after row. */
void piece_gather(const bcifs_figure *figure, const struct piece *piece, size_t points, double *matrix);

#endif
