/* Basis: a state's blending functions, that is its points when the control points are unit vectors.
 *
 * P·H with P the identity is H. So blending functions, and the columns of refinement matrices, are evaluated
 * by the plans and walkers that evaluate everything else, sixteen control points at a time. The functions of
 * a curve at level k are those of its cells of that level, each on its share of the parameter: H_k^x(n)(t) =
 * H_{k-iΔ}^a on the interval of cell i ([IM] 5.2). */
#ifndef EVALUATE_BASIS_H
#define EVALUATE_BASIS_H

#include "evaluate/plan.h"

enum {
    UNIT_DIMENSION = 16, /* unit vectors evaluated together: the most coordinates of a point */
    BASIS_MOST_FUNCTIONS = 1 << 16,
    BASIS_MOST_SAMPLES = 1 << 24 /* numbers in the tables of all states */
};

/* Reads the columns of a state: its points at unit-vector control points. */
struct unit_reader {
    size_t points; /* m: numbers of a column */
    size_t groups;
    struct unit_group *list;
    uint64_t body, count; /* columns before those that close an open chain, and all of them */
};

/* The state must be in the table, which may grow on its own afterwards. On failure nothing is left to close.
 */
bcifs_status unit_open(struct unit_reader *reader, const bcifs_figure *figure, const struct states *states,
                       size_t state, const bcifs_view *view, struct report *report);
/* The next columns, at most `capacity`: capacity × points numbers, column after column. Returns how many. */
size_t unit_next(struct unit_reader *reader, double *columns, size_t capacity);
void unit_close(struct unit_reader *reader);

/* One parameter: values[j] is that of function functions[j]; a function that occurs twice has their sum, all
 * others are 0. */
struct basis_row {
    double t;
    const size_t *functions;
    const double *values;
    size_t count;
};

/* Runs over the parameters of a curve figure. */
struct basis {
    struct arena arena;
    const bcifs_figure *figure;
    bcifs_basis_view view;
    struct report *report;
    struct states states;
    size_t functions;           /* in all */
    struct basis_table *tables; /* per state */
    size_t table_count, samples;
    struct basis_frame *frames; /* frames[0] is the piece, the last the cell of the level */
    size_t piece, chain, sample;
    size_t chain_base, chain_functions; /* the first function of the chain, and how many it has */
    size_t offset;                      /* of the cell's first function in its chain */
    size_t *indices;                    /* functions of the cell's control points */
    bool ended;
};

bcifs_status basis_open(struct basis *basis, const bcifs_figure *figure, const bcifs_basis_view *view,
                        struct report *report);
/* False at the end, or when `status` is not BCIFS_OK any more. */
bool basis_next(struct basis *basis, struct basis_row *row, bcifs_status *status);
void basis_close(struct basis *basis);

#endif
