/* Elimination: linear equations over the rationals, solved exactly and kept solved.
 *
 * A system has unknowns, columns 0 … unknowns-1, and givens, the columns behind them (parameters, and the
 * number 1). An equation is a sparse row Σ factor·column = 0. Rows are kept in reduced form (Gauss-Jordan):
 * each is led by one unknown, its pivot, with the factor 1, and no pivot occurs in another row; so a row says
 * what its pivot is in terms of free unknowns and givens. 64-bit fractions that overflow are refused, never
 * rounded. */
#ifndef NUMERIC_ELIMINATION_H
#define NUMERIC_ELIMINATION_H

#include "numeric/rational.h"

enum {
    ELIMINATION_MOST_TERMS = 1 << 22, /* held by a system at any time */
    ELIMINATION_FREE = -1             /* of row_of: the unknown is free */
};

struct linear_term {
    size_t column;
    struct rational factor; /* not 0 */
};

/* Terms by rising column. */
struct linear_row {
    struct linear_term *terms;
    size_t count;
};

enum elimination_outcome {
    ELIMINATION_ADDED,     /* the equation determines one more unknown */
    ELIMINATION_REDUNDANT, /* it follows from those before */
    ELIMINATION_CONFLICT,  /* it contradicts them: what is left of it has givens only */
    ELIMINATION_OVERFLOW,
    ELIMINATION_TOO_LARGE, /* ELIMINATION_MOST_TERMS */
    ELIMINATION_MEMORY
};

struct linear_system {
    size_t unknowns;
    struct linear_row *rows;
    size_t *pivots; /* of each row */
    size_t count, capacity;
    ptrdiff_t *row_of;          /* of each unknown: the row it leads, or ELIMINATION_FREE */
    size_t terms;               /* held now */
    struct linear_row conflict; /* what was left of the last equation that conflicted */
};

/* False when memory is out. */
bool linear_system_create(struct linear_system *system, size_t unknowns);
void linear_system_free(struct linear_system *system);
/* Adds Σ terms = 0, `count` terms by rising column, none twice, no factor 0. After an outcome behind
 * ELIMINATION_CONFLICT the system is of no more use. */
enum elimination_outcome linear_system_add(struct linear_system *system, const struct linear_term *terms,
                                           size_t count);
/* target + factor·row to a fresh row of terms (memory_new; NULL terms are valid when count is 0). */
enum elimination_outcome linear_row_combine(const struct linear_row *target, struct rational factor,
                                            const struct linear_row *row, struct linear_row *result);
/* The factor of a column, 0 when it does not occur. */
struct rational linear_row_factor(const struct linear_row *row, size_t column);
/* The row led by another of its unknowns: all factors divided by that one's. */
enum elimination_outcome linear_row_lead(const struct linear_row *row, size_t column,
                                         struct linear_row *result);
/* Makes `column`, free and occurring in rows[row], the pivot there; the old one becomes free. */
enum elimination_outcome linear_system_exchange(struct linear_system *system, size_t row, size_t column);

#endif
