#include "value_equations.h"

#include <math.h>

#include "numeric/tolerance.h"

bool value_is_negligible(struct value value, double scale)
{
    return value.exact ? value.residue == 0 : fabs(value.real) <= TOLERANCE_REPRODUCTION * scale;
}

/* row <- row - factor·pivot row, from column `first` on. */
static void row_eliminate(struct value *row, const struct value *pivot, struct value factor, size_t first,
                          size_t unknowns)
{
    for (size_t j = first; j < unknowns; j++) {
        if (value_is_zero(pivot[j]))
            continue;
        row[j] = value_subtract(row[j], value_multiply(factor, pivot[j]));
        if (row[j].exact && row[j].residue == 0)
            row[j].real = 0;
    }
}

/* Brings the best pivot of column j among rows `rank` … to row `rank`. False when there is none. */
static bool pivot_find(struct value *equations, size_t rows, size_t unknowns, size_t rank, size_t j,
                       double scale)
{
    size_t best = rank;
    for (size_t i = rank; i < rows; i++) {
        struct value candidate = equations[i * unknowns + j], leader = equations[best * unknowns + j];
        if (value_is_negligible(leader, scale) ||
            (!value_is_negligible(candidate, scale) && fabs(candidate.real) > fabs(leader.real)))
            best = i;
    }
    if (rank >= rows || value_is_negligible(equations[best * unknowns + j], scale))
        return false;
    for (size_t k = 0; k < unknowns && best != rank; k++) {
        struct value keep = equations[best * unknowns + k];
        equations[best * unknowns + k] = equations[rank * unknowns + k];
        equations[rank * unknowns + k] = keep;
    }
    return true;
}

/* To reduced row echelon form; pivots[i] is the column that leads row i. Returns the rank. */
static size_t equations_reduce(struct value *equations, size_t rows, size_t unknowns, size_t *pivots)
{
    double scale = 0;
    size_t rank = 0;
    for (size_t i = 0; i < rows * unknowns; i++)
        scale = fmax(scale, fabs(equations[i].real));
    for (size_t j = 0; j < unknowns; j++) {
        if (!pivot_find(equations, rows, unknowns, rank, j, scale))
            continue;
        struct value *pivot = &equations[rank * unknowns],
                     inverse = value_divide(value_from_integer(1), pivot[j]);
        for (size_t k = 0; k < unknowns; k++)
            pivot[k] = k == j ? value_from_integer(1) : value_multiply(pivot[k], inverse);
        for (size_t i = 0; i < rows; i++) {
            struct value factor = equations[i * unknowns + j];
            if (i == rank || value_is_zero(factor))
                continue;
            row_eliminate(&equations[i * unknowns], pivot, factor, j, unknowns);
            equations[i * unknowns + j] = value_from_integer(0);
        }
        pivots[rank++] = j;
    }
    return rank;
}

bcifs_status equations_solve(struct value *equations, size_t rows, size_t unknowns, bool inhomogeneous,
                             struct arena *arena, struct value *solution, size_t *free)
{
    size_t *pivots = arena_new(arena, unknowns, sizeof *pivots);
    if (!pivots)
        return BCIFS_MEMORY;
    size_t rank = equations_reduce(equations, rows, unknowns, pivots);
    *free = 0;
    for (size_t j = 0, i = 0; j < unknowns; j++) {
        bool is_pivot = i < rank && pivots[i] == j;
        i += is_pivot;
        *free += !is_pivot;
        int64_t choice = inhomogeneous ? j + 1 == unknowns : (int64_t)*free;
        solution[j] = value_from_integer(is_pivot ? 0 : choice);
    }
    if (inhomogeneous && rank > 0 && pivots[rank - 1] + 1 == unknowns)
        *free = 0;
    for (size_t i = 0; i < rank; i++) {
        struct value sum = value_from_integer(0);
        for (size_t j = pivots[i] + 1; j < unknowns; j++)
            sum = value_subtract(sum, value_multiply(equations[i * unknowns + j], solution[j]));
        solution[pivots[i]] = sum; /* columns of other pivots are 0 in this row */
    }
    return BCIFS_OK;
}
