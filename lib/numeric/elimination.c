#include "elimination.h"

#include <string.h>

#include "base/memory.h"

bool linear_system_create(struct linear_system *system, size_t unknowns)
{
    *system = (struct linear_system){.unknowns = unknowns};
    system->row_of = memory_new(unknowns, sizeof *system->row_of);
    for (size_t i = 0; system->row_of && i < unknowns; i++)
        system->row_of[i] = ELIMINATION_FREE;
    return system->row_of != NULL;
}

void linear_system_free(struct linear_system *system)
{
    for (size_t i = 0; i < system->count; i++)
        memory_free(system->rows[i].terms);
    memory_free(system->rows);
    memory_free(system->pivots);
    memory_free(system->row_of);
    memory_free(system->conflict.terms);
    *system = (struct linear_system){0};
}

/* ---- Rows ---------------------------------------------------------------------------------------------- */

enum elimination_outcome linear_row_combine(const struct linear_row *target, struct rational factor,
                                            const struct linear_row *row, struct linear_row *result)
{
    struct linear_term *terms = memory_new(target->count + row->count, sizeof *terms);
    size_t i = 0, j = 0, count = 0;
    if (!terms)
        return ELIMINATION_MEMORY;
    while (i < target->count || j < row->count) {
        bool left = j == row->count || (i < target->count && target->terms[i].column <= row->terms[j].column);
        bool right =
            i == target->count || (j < row->count && row->terms[j].column <= target->terms[i].column);
        struct linear_term sum = left ? target->terms[i++] : (struct linear_term){0, {0, 1}};
        if (right) {
            struct rational scaled;
            sum.column = row->terms[j].column;
            if (!rational_multiply(factor, row->terms[j++].factor, &scaled) ||
                !rational_add(sum.factor, scaled, &sum.factor)) {
                memory_free(terms);
                return ELIMINATION_OVERFLOW;
            }
        }
        if (!rational_is_zero(sum.factor))
            terms[count++] = sum;
    }
    *result = (struct linear_row){terms, count};
    return ELIMINATION_ADDED;
}

struct rational linear_row_factor(const struct linear_row *row, size_t column)
{
    size_t low = 0, high = row->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (row->terms[middle].column < column)
            low = middle + 1;
        else
            high = middle;
    }
    return low < row->count && row->terms[low].column == column ? row->terms[low].factor
                                                                : rational_from_integer(0);
}

enum elimination_outcome linear_row_lead(const struct linear_row *row, size_t column,
                                         struct linear_row *result)
{
    struct rational factor = linear_row_factor(row, column);
    struct linear_term *terms = memory_new(row->count, sizeof *terms);
    if (!terms)
        return ELIMINATION_MEMORY;
    for (size_t i = 0; i < row->count; i++) {
        terms[i].column = row->terms[i].column;
        if (!rational_divide(row->terms[i].factor, factor, &terms[i].factor)) {
            memory_free(terms);
            return ELIMINATION_OVERFLOW;
        }
    }
    *result = (struct linear_row){terms, row->count};
    return ELIMINATION_ADDED;
}

/* ---- Systems ------------------------------------------------------------------------------------------- */

/* Replaces row i by rows[i] - factor(column)·row, which rids it of `column`. */
static enum elimination_outcome row_clear(struct linear_system *system, size_t i, size_t column,
                                          const struct linear_row *row)
{
    struct rational factor = linear_row_factor(&system->rows[i], column);
    if (rational_is_zero(factor))
        return ELIMINATION_ADDED;
    struct linear_row fresh;
    enum elimination_outcome outcome =
        linear_row_combine(&system->rows[i], rational_negate(factor), row, &fresh);
    if (outcome != ELIMINATION_ADDED)
        return outcome;
    system->terms = system->terms - system->rows[i].count + fresh.count;
    memory_free(system->rows[i].terms);
    system->rows[i] = fresh;
    return system->terms > ELIMINATION_MOST_TERMS ? ELIMINATION_TOO_LARGE : ELIMINATION_ADDED;
}

/* The equation with every pivot replaced by what it is. No row holds another's pivot, so one pass does it. */
static enum elimination_outcome row_reduce(const struct linear_system *system,
                                           const struct linear_term *terms, size_t count,
                                           struct linear_row *result)
{
    struct linear_row row = {memory_new(count, sizeof *row.terms), count};
    if (!row.terms)
        return ELIMINATION_MEMORY;
    if (count > 0)
        memcpy(row.terms, terms, count * sizeof *terms);
    for (size_t i = 0; i < count && terms[i].column < system->unknowns; i++) {
        ptrdiff_t index = system->row_of[terms[i].column];
        if (index == ELIMINATION_FREE)
            continue;
        struct linear_row fresh;
        enum elimination_outcome outcome =
            linear_row_combine(&row, rational_negate(terms[i].factor), &system->rows[index], &fresh);
        memory_free(row.terms);
        if (outcome != ELIMINATION_ADDED)
            return outcome;
        row = fresh;
    }
    *result = row;
    return ELIMINATION_ADDED;
}

/* How much a factor makes of fractions when it is divided by. */
static uint64_t weight(struct rational a)
{
    uint64_t numerator = a.numerator < 0 ? 0 - (uint64_t)a.numerator : (uint64_t)a.numerator;
    return numerator / 2 + (uint64_t)a.denominator / 2 + (numerator > 1) + (a.denominator > 1);
}

/* The unknown that the equation is solved for: the lightest factor, of equals the last. `unknowns`: none. */
static size_t choose_pivot(const struct linear_system *system, const struct linear_row *row)
{
    size_t best = system->unknowns;
    uint64_t least = 0;
    for (size_t i = 0; i < row->count && row->terms[i].column < system->unknowns; i++) {
        uint64_t own = weight(row->terms[i].factor);
        if (best == system->unknowns || own <= least) {
            best = row->terms[i].column;
            least = own;
        }
    }
    return best;
}

static bool reserve_row(struct linear_system *system)
{
    if (system->count < system->capacity)
        return true;
    size_t capacity = system->capacity ? 2 * system->capacity : 64;
    struct linear_row *rows = memory_resize(system->rows, capacity, sizeof *rows);
    system->rows = rows ? rows : system->rows;
    size_t *pivots = memory_resize(system->pivots, capacity, sizeof *pivots);
    system->pivots = pivots ? pivots : system->pivots;
    if (!rows || !pivots)
        return false;
    system->capacity = capacity;
    return true;
}

static enum elimination_outcome row_insert(struct linear_system *system, size_t pivot,
                                           const struct linear_row *row)
{
    struct linear_row leading;
    if (!reserve_row(system))
        return ELIMINATION_MEMORY;
    enum elimination_outcome outcome = linear_row_lead(row, pivot, &leading);
    if (outcome != ELIMINATION_ADDED)
        return outcome;
    for (size_t i = 0; i < system->count && outcome == ELIMINATION_ADDED; i++)
        outcome = row_clear(system, i, pivot, &leading);
    system->rows[system->count] = leading;
    system->pivots[system->count] = pivot;
    system->row_of[pivot] = (ptrdiff_t)system->count++;
    system->terms += leading.count;
    return outcome;
}

enum elimination_outcome linear_system_add(struct linear_system *system, const struct linear_term *terms,
                                           size_t count)
{
    struct linear_row row;
    enum elimination_outcome outcome = row_reduce(system, terms, count, &row);
    if (outcome != ELIMINATION_ADDED)
        return outcome;
    size_t pivot = choose_pivot(system, &row);
    if (pivot < system->unknowns) {
        outcome = row_insert(system, pivot, &row);
    } else if (row.count > 0) {
        memory_free(system->conflict.terms);
        system->conflict = row;
        return ELIMINATION_CONFLICT;
    } else {
        outcome = ELIMINATION_REDUNDANT;
    }
    memory_free(row.terms);
    return outcome;
}

enum elimination_outcome linear_system_exchange(struct linear_system *system, size_t row, size_t column)
{
    struct linear_row leading;
    enum elimination_outcome outcome = linear_row_lead(&system->rows[row], column, &leading);
    if (outcome != ELIMINATION_ADDED)
        return outcome;
    for (size_t i = 0; i < system->count && outcome == ELIMINATION_ADDED; i++)
        if (i != row)
            outcome = row_clear(system, i, column, &leading);
    memory_free(system->rows[row].terms);
    system->rows[row] = leading;
    system->row_of[system->pivots[row]] = ELIMINATION_FREE;
    system->row_of[column] = (ptrdiff_t)row;
    system->pivots[row] = column;
    return outcome;
}
