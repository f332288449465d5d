/* Which unknowns stay free: the choice that makes the answer short.
 *
 * Every entry is printed once, so the length of the text is a sum over rows of the solved system. Starting
 * from any solved form, a free unknown and one that it determines change places as long as that shortens the
 * text. Among equally short texts those are preferred that keep sums such as 1-a, not bare names, on the
 * diagonals of maps: names then stand for the share that a point takes of its neighbors, as in [SI]. */
#include "complete.h"

enum {
    CHARACTER = 1 << 12, /* the cost of a byte, far above those of all bare diagonal entries of a row */
    MOST_TERMS_VISITED = 1 << 22 /* in trying exchanges; a larger system keeps what was reached */
};

struct chooser {
    bcifs_complete *complete;
    struct text scratch;
    uint64_t *costs; /* per row */
    size_t visited;
};

static bool is_diagonal(const bcifs_complete *complete, size_t unknown)
{
    return complete->equations.unknowns[unknown].diagonal;
}

/* A row that is one unknown: a bare name. */
static bool is_bare(const bcifs_complete *complete, const struct linear_row *row)
{
    size_t unknowns = complete->automaton->unknowns;
    return row->count == 2 && row->terms[1].column < unknowns &&
           row->terms[0].factor.numerator * row->terms[1].factor.numerator < 0;
}

static uint64_t row_cost(struct chooser *chooser, const struct linear_row *row, size_t leading)
{
    chooser->scratch.length = 0;
    chooser->visited += row->count;
    complete_expression(chooser->complete, row, leading, &chooser->scratch);
    bool mark = is_diagonal(chooser->complete, leading) && is_bare(chooser->complete, row);
    return (uint64_t)chooser->scratch.length * CHARACTER + mark;
}

static uint64_t free_cost(const struct chooser *chooser, size_t unknown)
{
    return CHARACTER + is_diagonal(chooser->complete, unknown);
}

/* The cost after the exchange minus the cost before. Outcomes behind ELIMINATION_CONFLICT mean that it cannot
 * be had. */
static enum elimination_outcome exchange_gain(struct chooser *chooser, size_t row, size_t column,
                                              int64_t *gain)
{
    struct linear_system *system = &chooser->complete->system;
    struct linear_row leading;
    enum elimination_outcome outcome = linear_row_lead(&system->rows[row], column, &leading);
    if (outcome != ELIMINATION_ADDED)
        return outcome;
    *gain = (int64_t)(row_cost(chooser, &leading, column) + free_cost(chooser, system->pivots[row])) -
            (int64_t)(chooser->costs[row] + free_cost(chooser, column));
    for (size_t i = 0; i < system->count && outcome == ELIMINATION_ADDED; i++) {
        struct rational factor = linear_row_factor(&system->rows[i], column);
        struct linear_row fresh;
        if (i == row || rational_is_zero(factor))
            continue;
        outcome = linear_row_combine(&system->rows[i], rational_negate(factor), &leading, &fresh);
        if (outcome != ELIMINATION_ADDED)
            break;
        *gain += (int64_t)row_cost(chooser, &fresh, system->pivots[i]) - (int64_t)chooser->costs[i];
        memory_free(fresh.terms);
    }
    memory_free(leading.terms);
    return outcome;
}

static void costs_find(struct chooser *chooser)
{
    const struct linear_system *system = &chooser->complete->system;
    for (size_t i = 0; i < system->count; i++)
        chooser->costs[i] = row_cost(chooser, &system->rows[i], system->pivots[i]);
}

/* Makes the best exchange in which a row can take part, if it gains anything. */
static enum elimination_outcome row_improve(struct chooser *chooser, size_t row, bool *improved)
{
    struct linear_system *system = &chooser->complete->system;
    int64_t best = 0;
    size_t chosen = SIZE_MAX;
    for (size_t i = 0; i < system->rows[row].count && chooser->visited < MOST_TERMS_VISITED; i++) {
        size_t column = system->rows[row].terms[i].column;
        int64_t gain;
        if (column >= system->unknowns || column == system->pivots[row])
            continue;
        enum elimination_outcome outcome = exchange_gain(chooser, row, column, &gain);
        if (outcome == ELIMINATION_MEMORY)
            return outcome;
        if (outcome == ELIMINATION_ADDED && gain < best) {
            best = gain;
            chosen = column;
        }
    }
    if (chosen == SIZE_MAX)
        return ELIMINATION_ADDED;
    *improved = true;
    enum elimination_outcome outcome = linear_system_exchange(system, row, chosen);
    costs_find(chooser);
    return outcome;
}

bcifs_status complete_choose(bcifs_complete *complete, struct report *report)
{
    struct chooser chooser = {.complete = complete};
    enum elimination_outcome outcome = ELIMINATION_ADDED;
    chooser.costs = arena_new(&complete->arena, complete->system.count, sizeof *chooser.costs);
    if (!chooser.costs)
        return report_memory(report);
    costs_find(&chooser);
    for (bool improved = true; improved && outcome == ELIMINATION_ADDED;) {
        improved = false;
        for (size_t i = 0; i < complete->system.count && outcome == ELIMINATION_ADDED; i++)
            outcome = row_improve(&chooser, i, &improved);
    }
    bool no_memory = chooser.scratch.failed || outcome == ELIMINATION_MEMORY;
    text_free(&chooser.scratch);
    if (no_memory)
        return report_memory(report);
    if (outcome != ELIMINATION_ADDED) /* an exchange was tried before it was made, so only its size is left */
        return report_failure(report, BCIFS_INPUT, complete->automaton->modules[0]->source->name,
                              "the equations become too large to solve: more than %d terms",
                              ELIMINATION_MOST_TERMS);
    return BCIFS_OK;
}
