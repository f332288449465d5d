#include "levels_form.h"

/* ---- Mother matrices ----------------------------------------------------------------------------------- */

/* Entries being collected; the first failure to get memory is remembered. */
struct entries {
    struct triple *list;
    size_t count, capacity;
    bool failed;
};

static void entry_add(struct entries *entries, size_t row, size_t column, double value)
{
    if (value == 0 || entries->failed)
        return;
    if (entries->count == entries->capacity) {
        size_t capacity = entries->capacity ? 2 * entries->capacity : 1024;
        struct triple *list = memory_resize(entries->list, capacity, sizeof *list);
        entries->failed = !list;
        if (!list)
            return;
        entries->list = list;
        entries->capacity = capacity;
    }
    entries->list[entries->count++] = (struct triple){row, column, value};
}

static bcifs_status entries_finish(struct entries *entries, size_t rows, size_t width, struct arena *arena,
                                   struct sparse *matrix)
{
    bool made = !entries->failed &&
                sparse_from_triples(matrix, rows, width, entries->list, entries->count, arena);
    memory_free(entries->list);
    return made ? BCIFS_OK : BCIFS_MEMORY;
}

static size_t cell_step(const struct ladder *ladder, size_t state)
{
    const struct cell *cell = ladder->states.states[state].cell;
    return cell->points - cell->boundaries[1].operator->columns;
}

/* The states of all cells of a rung, each once. */
static bcifs_status rung_states(const struct ladder *ladder, unsigned rung, struct arena *arena, size_t **list,
                                size_t *count)
{
    bool *seen = arena_new(arena, ladder->states.count, sizeof *seen);
    *list = arena_new(arena, ladder->states.count, sizeof **list);
    *count = 0;
    if (!seen || !*list)
        return BCIFS_MEMORY;
    for (size_t c = 0; c < ladder->chain_count; c++) {
        const struct rung *cells = &ladder->chains[c].rungs[rung];
        for (size_t i = 0; i < cells->count; i++) {
            if (!seen[cells->cells[i]])
                (*list)[(*count)++] = cells->cells[i];
            seen[cells->cells[i]] = true;
        }
    }
    return BCIFS_OK;
}

/* Adds scale · form of every cell of a chain, at its control points. */
static void chain_assemble(const struct ladder *ladder, size_t chain, unsigned rung, size_t base, double scale,
                           const struct form *forms, struct entries *entries)
{
    const struct rung *cells = &ladder->chains[chain].rungs[rung];
    for (size_t i = 0, first = 0; i < cells->count; i++) {
        size_t state = cells->cells[i], m = ladder->states.states[state].points;
        for (size_t j = 0; j < m; j++)
            for (size_t k = 0; k < m; k++)
                entry_add(entries, base + (first + j) % cells->points, base + (first + k) % cells->points,
                          scale * forms[state].numbers[j * m + k]);
        first += cell_step(ladder, state);
    }
}

/* e s^T - s e^T: the chord from the end of an open chain back to its start. */
static bcifs_status chord_assemble(struct ladder *ladder, size_t chain, unsigned rung, size_t base,
                                   struct arena *arena, struct entries *entries)
{
    const struct rung *cells = &ladder->chains[chain].rungs[rung];
    size_t first_state = cells->cells[0], last_state = cells->cells[cells->count - 1],
           start_points = ladder->states.states[first_state].points,
           end_points = ladder->states.states[last_state].points, end_first = cells->points - end_points;
    struct form_ends first, last;
    bcifs_status status = form_ends_find(&ladder->states, first_state, arena, &first);
    if (status == BCIFS_OK)
        status = form_ends_find(&ladder->states, last_state, arena, &last);
    if (status)
        return status;
    for (size_t j = 0; j < end_points; j++)
        for (size_t k = 0; k < start_points; k++) {
            double product = last.end[j].real * first.start[k].real;
            entry_add(entries, base + end_first + j, base + k, product);
            entry_add(entries, base + k, base + end_first + j, -product);
        }
    return BCIFS_OK;
}

/* Assembles one kind of form; chords are for areas. */
static bcifs_status cells_assemble(struct ladder *ladder, unsigned rung, bool area, struct arena *arena,
                                   struct sparse *mother, const char **reason)
{
    struct entries entries = {0};
    const struct form *forms;
    size_t *list, count, base = 0;
    *reason = NULL;
    bcifs_status status = rung_states(ladder, rung, arena, &list, &count);
    if (status == BCIFS_OK)
        status = area ? forms_area(&ladder->states, list, count, arena, &forms)
                      : forms_energy(&ladder->states, list, count, arena, &forms);
    if (status)
        return status;
    for (size_t i = 0; i < count && !*reason; i++)
        *reason = forms[list[i]].reason;
    if (*reason)
        return BCIFS_OK;
    for (size_t c = 0; c < ladder->chain_count && status == BCIFS_OK; c++) {
        chain_assemble(ladder, c, rung, base, area ? 1 : 2, forms, &entries);
        if (area && !ladder->chains[c].closed)
            status = chord_assemble(ladder, c, rung, base, arena, &entries);
        base += ladder->chains[c].rungs[rung].points;
    }
    bcifs_status made = entries_finish(&entries, base, base, arena, mother);
    return status ? status : made;
}

bcifs_status area_assemble(struct ladder *ladder, unsigned rung, struct arena *arena, struct sparse *mother,
                           const char **reason)
{
    return cells_assemble(ladder, rung, true, arena, mother, reason);
}

bcifs_status energy_assemble(struct ladder *ladder, unsigned rung, struct arena *arena, struct sparse *mother,
                             const char **reason)
{
    return cells_assemble(ladder, rung, false, arena, mother, reason);
}

bcifs_status differences_assemble(const struct ladder *ladder, unsigned rung, struct arena *arena,
                                  struct sparse *mother)
{
    static const double weights[] = {1, -2, 1};
    struct entries entries = {0};
    size_t base = 0;
    for (size_t c = 0; c < ladder->chain_count; c++) {
        size_t points = ladder->chains[c].rungs[rung].points, inner = points < 2 ? 0 : points - 2;
        for (size_t i = 0; i < (ladder->chains[c].closed ? points : inner); i++)
            for (size_t j = 0; j < 3; j++)
                for (size_t k = 0; k < 3; k++)
                    entry_add(&entries, base + (i + j) % points, base + (i + k) % points,
                              2 * weights[j] * weights[k]);
        base += points;
    }
    return entries_finish(&entries, base, base, arena, mother);
}

/* ---- Descent, [MR] (14)-(18) --------------------------------------------------------------------------- */

/* P and Q of a level, all chains, and their transposes. */
struct level_filters {
    struct sparse p, q, p_transposed, q_transposed;
};

static void stencil_collect(const struct sparse *part, size_t row_base, size_t column_base, bool transposed,
                            struct entries *entries)
{
    for (size_t i = 0; i < part->rows; i++)
        for (size_t k = part->starts[i]; k < part->starts[i + 1]; k++) {
            size_t row = transposed ? part->columns[k] : i, column = transposed ? i : part->columns[k];
            entry_add(entries, row_base + row, column_base + column, part->values[k]);
        }
}

static bcifs_status level_filters_make(const struct bank *bank, unsigned rung, struct arena *arena,
                                       struct level_filters *filters)
{
    const struct bank_step *steps = bank->steps[rung - bank->bottom];
    struct entries p = {0}, q = {0};
    size_t fine = 0, coarse = 0, details = 0;
    for (size_t c = 0; c < bank->ladder->chain_count; c++) {
        struct sparse refinement, wavelet;
        if (!stencil_sparse(&steps[c].refinement, &refinement, arena) ||
            !stencil_sparse(&steps[c].wavelet, &wavelet, arena)) {
            p.failed = true;
            break;
        }
        stencil_collect(&refinement, fine, coarse, false, &p);
        stencil_collect(&wavelet, fine, details, true, &q);
        fine += steps[c].fine;
        coarse += steps[c].coarse;
        details += steps[c].details;
    }
    bcifs_status status = entries_finish(&p, fine, coarse, arena, &filters->p),
                 other = entries_finish(&q, fine, details, arena, &filters->q);
    if (status || other || !sparse_transpose(&filters->p, &filters->p_transposed, arena) ||
        !sparse_transpose(&filters->q, &filters->q_transposed, arena))
        return BCIFS_MEMORY;
    return BCIFS_OK;
}

/* The blocks of M^k while it is taken down: `scale` = I(φ^k, φ^k), mixed[l] = I(φ^k, ψ^l), details[k][l] = I(ψ^k, ψ^l)
 * for k <= l; those below the diagonal follow by symmetry. */
struct blocks {
    struct sparse scale;
    struct sparse mixed[LADDER_MOST_LEVELS];
    struct sparse details[LADDER_MOST_LEVELS][LADDER_MOST_LEVELS];
};

/* From level `rung` + 1 to `rung`: the (PP), (PQ), (QQ), (P) and (Q) filters. */
static bcifs_status blocks_descend(struct blocks *blocks, const struct level_filters *filters, unsigned level,
                                   unsigned levels, struct arena *arena)
{
    struct sparse p_scale, q_scale;
    if (!sparse_multiply(&filters->p_transposed, &blocks->scale, &p_scale, arena) ||
        !sparse_multiply(&filters->q_transposed, &blocks->scale, &q_scale, arena) ||
        !sparse_multiply(&p_scale, &filters->p, &blocks->scale, arena) ||
        !sparse_multiply(&p_scale, &filters->q, &blocks->mixed[level], arena) ||
        !sparse_multiply(&q_scale, &filters->q, &blocks->details[level][level], arena))
        return BCIFS_MEMORY;
    for (unsigned l = level + 1; l < levels; l++) {
        struct sparse above = blocks->mixed[l];
        if (!sparse_multiply(&filters->p_transposed, &above, &blocks->mixed[l], arena) ||
            !sparse_multiply(&filters->q_transposed, &above, &blocks->details[level][l], arena))
            return BCIFS_MEMORY;
    }
    return BCIFS_OK;
}

/* Adds a block and, where it is off the diagonal, its mirror image. */
static void block_collect(const struct sparse *block, size_t row, size_t column, double sign,
                          struct entries *entries)
{
    for (size_t i = 0; i < block->rows; i++)
        for (size_t k = block->starts[i]; k < block->starts[i + 1]; k++) {
            entry_add(entries, row + i, column + block->columns[k], block->values[k]);
            if (row != column)
                entry_add(entries, column + block->columns[k], row + i, sign * block->values[k]);
        }
}

bcifs_status form_descend(const struct bank *bank, const struct sparse *mother, double sign, struct arena *arena,
                          struct sparse *form)
{
    struct arena scratch = {0};
    struct entries entries = {0};
    unsigned levels = bank->top - bank->bottom;
    struct blocks *blocks = arena_new(&scratch, 1, sizeof *blocks);
    bcifs_status status = blocks ? BCIFS_OK : BCIFS_MEMORY;
    if (blocks)
        blocks->scale = *mother;
    for (unsigned level = levels; level-- > 0 && status == BCIFS_OK;) {
        struct level_filters filters;
        status = level_filters_make(bank, bank->bottom + level, &scratch, &filters);
        if (status == BCIFS_OK)
            status = blocks_descend(blocks, &filters, level, levels, &scratch);
    }
    if (status == BCIFS_OK)
        block_collect(&blocks->scale, 0, 0, sign, &entries);
    for (unsigned k = 0; k < levels && status == BCIFS_OK; k++) {
        size_t row = bank_details_at(bank, bank->bottom + k);
        block_collect(&blocks->mixed[k], 0, row, sign, &entries);
        for (unsigned l = k; l < levels; l++)
            block_collect(&blocks->details[k][l], row, bank_details_at(bank, bank->bottom + l), sign, &entries);
    }
    bcifs_status made = entries_finish(&entries, bank->count, bank->count, arena, form);
    arena_free(&scratch);
    return status ? status : made;
}
