#include "levels.h"

#include <math.h>
#include <string.h>

#include "numeric/matrix.h"
#include "numeric/tolerance.h"

static bcifs_status out_of_memory(const struct states *states)
{
    return states->setting.report ? report_memory(states->setting.report) : BCIFS_MEMORY;
}

/* Keeps a formatted reason; takes the text. */
static bcifs_status reason_keep(struct states *states, struct text *text, const char **reason)
{
    *reason = text->failed ? NULL : arena_text(states->arena, text->data, text->length);
    text_free(text);
    return *reason ? BCIFS_OK : out_of_memory(states);
}

/* ---- Class --------------------------------------------------------------------------------------------- */

bcifs_status levels_classify(struct states *states, size_t index, struct level_class *class)
{
    bcifs_status status = states_expand(states, index);
    if (status)
        return status;
    const struct cell *cell = states->states[index].cell;
    size_t n = cell->child_count, start = cell->boundaries[0].operator->columns,
           end = cell->boundaries[1].operator->columns;
    *class = (struct level_class){.points = cell->points, .subdivisions = n, .joint = {start, end}};
    class->step = cell->points > start ? cell->points - start : 0;
    if (start == end && class->step > 0)
        class->dependence = class->step >= start ? 1 : n * class->step >= start ? 2 : 3;
    return BCIFS_OK;
}

bool levels_is_stepped(const struct cell *cell)
{
    const struct value one = value_from_integer(1), zero = value_from_integer(0);
    for (int side = 0; side < 2; side++) {
        const struct value_matrix *operator= cell->boundaries[side].operator;
        if (operator->columns> operator->rows)
            return false;
        size_t shift = side ? operator->rows - operator->columns : 0;
        for (size_t i = 0; i < operator->rows; i++)
            for (size_t j = 0; j < operator->columns; j++)
                if (!value_equal(operator->values[i * operator->columns + j], i == j + shift ? one : zero))
                    return false;
    }
    return true;
}

/* ---- Fusion -------------------------------------------------------------------------------------------- */

/* Whether the children share one step and one joint size, and what keeps them from fusing otherwise. */
static bcifs_status children_examine(struct states *states, size_t index, struct level_class *class,
                                     const char **reason)
{
    struct text text = {0};
    for (size_t i = 0; i < states->states[index].cell->child_count; i++) {
        size_t child = states->states[index].children[i];
        struct level_class other;
        bcifs_status status = levels_classify(states, child, &other);
        if (status)
            return status;
        const char *name = states->states[child].key.definition->name;
        if (!levels_is_stepped(states->states[child].cell))
            text_format(&text,
                        "the start of '%s' is not at its first control points or its end not at its last",
                        name);
        else if (other.joint[0] != other.joint[1])
            text_format(&text, "'%s' starts with a joint of %zu control points and ends with one of %zu",
                        name, other.joint[0], other.joint[1]);
        else if (i > 0 && (other.step != class->step || other.joint[0] != class->joint[0]))
            text_format(&text,
                        "the steps of the children differ: child 0 has (Δ, m_s) = (%zu, %zu), child %zu has "
                        "(%zu, %zu)",
                        class->step, class->joint[0], i, other.step, other.joint[0]);
        if (text.length > 0 || text.failed)
            return reason_keep(states, &text, reason);
        *class = other;
    }
    return BCIFS_OK;
}

/* Lays the columns of T_i over iΔ … ; the first entry where two maps differ is the reason. */
static bcifs_status columns_lay(struct states *states, const struct cell *cell, size_t step,
                                struct value_matrix *matrix, const char **reason)
{
    for (size_t i = 0; i < cell->child_count; i++) {
        const struct value_matrix *map = cell->children[i].map;
        size_t overlap = i == 0 ? 0 : map->columns - step;
        for (size_t row = 0; row < map->rows; row++)
            for (size_t j = 0; j < map->columns; j++) {
                struct value *entry = &matrix->values[row * matrix->columns + i * step + j];
                const struct value found = map->values[row * map->columns + j];
                if (j < overlap && !value_equal(*entry, found)) {
                    struct text text = {0};
                    text_format(&text, "T%zu·end ≠ T%zu·start: the equations of '%s' do not hold", i - 1, i,
                                cell->definition->name);
                    return reason_keep(states, &text, reason);
                }
                if (j >= overlap)
                    *entry = found;
            }
    }
    value_matrix_finish(matrix);
    return BCIFS_OK;
}

bcifs_status levels_fuse(struct states *states, size_t index, const struct value_matrix **matrix,
                         const char **reason)
{
    struct level_class class = {0};
    *matrix = NULL;
    *reason = NULL;
    bcifs_status status = states_expand(states, index);
    if (status == BCIFS_OK)
        status = children_examine(states, index, &class, reason);
    if (status || *reason)
        return status;
    const struct cell *cell = states->states[index].cell;
    size_t columns = cell->child_count * class.step + class.joint[0];
    if (cell->points > CELL_MOST_ENTRIES / columns) {
        *reason = "its refinement matrix is too large";
        return BCIFS_OK;
    }
    struct value_matrix *fused = value_matrix_new(states->arena, cell->points, columns);
    if (!fused)
        return out_of_memory(states);
    status = columns_lay(states, cell, class.step, fused, reason);
    if (status == BCIFS_OK && !*reason)
        *matrix = fused;
    return status;
}

/* ---- Masks --------------------------------------------------------------------------------------------- */

/* The shape of T_÷ as masks see it. */
struct weave {
    const struct value_matrix *matrix;
    size_t period, step; /* NΔ, Δ */
};

/* The entries (row + Δu, column + NΔu), u = 0, 1, …, must be one number; beyond the matrix it is 0, as the
 * columns that are cut off there sum to 1 like the others. */
static bool weave_value(const struct weave *weave, size_t column, ptrdiff_t offset, struct value *value)
{
    const struct value_matrix *matrix = weave->matrix;
    const struct value zero = value_from_integer(0);
    bool found = false, outside = false;
    *value = zero;
    for (size_t k = column, u = 0; k < matrix->columns; k += weave->period, u++) {
        ptrdiff_t row = offset + (ptrdiff_t)(u * weave->step);
        if (row < 0 || row >= (ptrdiff_t)matrix->rows) {
            outside = true;
            continue;
        }
        struct value entry = matrix->values[(size_t)row * matrix->columns + k];
        if (found && !value_equal(entry, *value))
            return false;
        *value = entry;
        found = true;
    }
    return !outside || value_equal(*value, zero);
}

/* Mask number `column`, without zeros at its ends. False when T_÷ does not repeat it. */
static bcifs_status mask_take(struct states *states, const struct weave *weave, size_t column,
                              struct level_mask *mask, bool *repeats)
{
    const struct value_matrix *matrix = weave->matrix;
    size_t below = (matrix->columns / weave->period + 1) * weave->step, height = below + matrix->rows,
           first = height, last = 0;
    struct value *values = arena_new(states->arena, height, sizeof *values);
    if (!values)
        return out_of_memory(states);
    *repeats = true;
    for (size_t i = 0; i < height; i++) {
        *repeats = *repeats && weave_value(weave, column, (ptrdiff_t)i - (ptrdiff_t)below, &values[i]);
        if (value_is_zero(values[i]))
            continue;
        first = first == height ? i : first;
        last = i + 1;
    }
    first = first == height ? last : first;
    *mask = (struct level_mask){(ptrdiff_t)first - (ptrdiff_t)below, values + first, last - first};
    return BCIFS_OK;
}

/* c[q + N(m-1-r) - (m-1)] is the entry of mask q in row r, design section 4; its length is the full (N-1)m +
 * 1 without the zeros that m_a = ceil((length-1)/(N-1)) does not need. */
static bcifs_status row_make(struct states *states, const struct level_class *class,
                             struct level_masks *masks)
{
    size_t n = class->subdivisions, m = class->points, length = (n - 1) * m + 1;
    struct value *row = arena_new(states->arena, length, sizeof *row);
    if (!row)
        return out_of_memory(states);
    for (size_t i = 0; i < length; i++)
        row[i] = value_from_integer(0);
    for (size_t q = 0; q < masks->count; q++)
        for (size_t i = 0; i < masks->masks[q].count; i++) {
            ptrdiff_t r = masks->masks[q].offset + (ptrdiff_t)i;
            ptrdiff_t place = (ptrdiff_t)q + (ptrdiff_t)n * ((ptrdiff_t)m - 1 - r) - ((ptrdiff_t)m - 1);
            if (place >= 0 && place < (ptrdiff_t)length) {
                row[place] = masks->masks[q].values[i];
            } else if (!value_is_zero(masks->masks[q].values[i])) {
                masks->row_reason = "its mask is longer than (N-1) m_a + 1 coefficients";
                return BCIFS_OK;
            }
        }
    while (length > (n - 1) * (m - 1) + 2 && value_is_zero(row[length - 1]))
        length--;
    masks->row = row;
    masks->row_count = length;
    return BCIFS_OK;
}

static bcifs_status masks_collect(struct states *states, const struct weave *weave, struct level_masks *masks)
{
    struct level_mask *list = arena_new(states->arena, weave->period, sizeof *list);
    if (!list)
        return out_of_memory(states);
    for (size_t q = 0; q < weave->period; q++) {
        bool repeats = false;
        bcifs_status status = mask_take(states, weave, q, &list[q], &repeats);
        if (status)
            return status;
        if (!repeats) {
            struct text text = {0};
            text_format(
                &text,
                "column %zu of its refinement matrix is not repeated %zu row%s lower every %zu columns", q,
                weave->step, weave->step == 1 ? "" : "s", weave->period);
            return reason_keep(states, &text, &masks->reason);
        }
    }
    masks->masks = list;
    masks->count = weave->period;
    return BCIFS_OK;
}

bcifs_status levels_mask(struct states *states, size_t index, const struct value_matrix *refinement,
                         struct level_masks *masks)
{
    struct level_class class;
    *masks = (struct level_masks){0};
    bcifs_status status = levels_classify(states, index, &class);
    if (status)
        return status;
    const struct state *state = &states->states[index];
    for (size_t i = 0; i < class.subdivisions && !masks->reason; i++)
        if (state->children[i] != index)
            masks->reason = "its children are in other states";
    if (!refinement)
        masks->reason = masks->reason ? masks->reason : "it has no refinement matrix";
    else if (!masks->reason && class.dependence == 0)
        masks->reason = "its joints are not of one size smaller than its own";
    if (!masks->reason) {
        const struct weave weave = {refinement, class.subdivisions * class.step, class.step};
        status = masks_collect(states, &weave, masks);
    }
    masks->row_reason = masks->reason;
    if (status || masks->reason)
        return status;
    if (class.step != 1) {
        struct text text = {0};
        text_format(&text, "its step is %zu; a mask has step 1", class.step);
        return reason_keep(states, &text, &masks->row_reason);
    }
    if (class.points < 2 || class.subdivisions < 2)
        masks->row_reason = "a mask needs two control points and two children";
    return masks->row_reason ? BCIFS_OK : row_make(states, &class, masks);
}

/* ---- Level n ------------------------------------------------------------------------------------------- */

/* The states within some levels of the first, breadth first. */
struct gathering {
    size_t *least; /* per state: the level where it first appears, SIZE_MAX before */
    size_t *queue;
    size_t count, capacity, tail, queue_capacity;
};

static bcifs_status gathering_note(struct gathering *gathering, struct states *states, size_t state,
                                   size_t level)
{
    while (gathering->count <= state) {
        if (!ARENA_RESERVE(states->arena, gathering->least, gathering->count, gathering->capacity))
            return out_of_memory(states);
        gathering->least[gathering->count++] = SIZE_MAX;
    }
    if (gathering->least[state] != SIZE_MAX)
        return BCIFS_OK;
    if (!ARENA_RESERVE(states->arena, gathering->queue, gathering->tail, gathering->queue_capacity))
        return out_of_memory(states);
    gathering->least[state] = level;
    gathering->queue[gathering->tail++] = state;
    return BCIFS_OK;
}

/* Expands every state within `depth` of `index`, and sees that those above the last level fuse. */
static bcifs_status states_gather(struct states *states, size_t index, unsigned depth,
                                  struct gathering *gathering, const char **reason)
{
    bcifs_status status = gathering_note(gathering, states, index, 0);
    for (size_t head = 0; head < gathering->tail && status == BCIFS_OK; head++) {
        size_t state = gathering->queue[head], level = gathering->least[state];
        const struct value_matrix *fused;
        if (level == depth) {
            status = states_expand(states, state);
            continue;
        }
        status = levels_fuse(states, state, &fused, reason);
        if (status || *reason)
            return status;
        for (size_t k = 0; k < states->states[state].cell->child_count && status == BCIFS_OK; k++)
            status = gathering_note(gathering, states, states->states[state].children[k], level + 1);
    }
    return status;
}

/* The refinement matrices of all states at one level. */
struct tier {
    const double **matrices; /* per state: its points × columns; NULL: not needed */
    size_t *columns;
    size_t *joints; /* columns that neighbors share at this level */
};

static bcifs_status tier_new(struct states *states, size_t count, struct tier *tier)
{
    tier->matrices = arena_new(states->arena, count, sizeof *tier->matrices);
    tier->columns = arena_new(states->arena, count, sizeof *tier->columns);
    tier->joints = arena_new(states->arena, count, sizeof *tier->joints);
    return tier->matrices && tier->columns && tier->joints ? BCIFS_OK : out_of_memory(states);
}

static bcifs_status tier_first(struct states *states, const struct gathering *gathering, struct tier *tier)
{
    bcifs_status status = tier_new(states, gathering->count, tier);
    for (size_t s = 0; s < gathering->count && status == BCIFS_OK; s++) {
        if (gathering->least[s] == SIZE_MAX)
            continue;
        size_t m = states->states[s].points;
        double *unit = arena_new(states->arena, m * m, sizeof *unit);
        if (!unit)
            return out_of_memory(states);
        for (size_t i = 0; i < m; i++)
            unit[i * m + i] = 1;
        tier->matrices[s] = unit;
        tier->columns[s] = m;
        tier->joints[s] = states->states[s].cell->boundaries[0].operator->columns;
    }
    return status;
}

/* R_n = [T_0 R_n-1(y_0) | T_1 R_n-1(y_1) | …], consecutive blocks sharing their m_s columns. */
static bcifs_status state_refine(struct states *states, size_t index, const struct tier *below,
                                 struct tier *tier, size_t *total)
{
    const struct state *state = &states->states[index];
    size_t joint = below->joints[state->children[0]], columns = joint;
    for (size_t i = 0; i < state->cell->child_count; i++)
        columns += below->columns[state->children[i]] - joint;
    *total += state->points * columns;
    if (columns > LEVELS_MOST_ENTRIES / state->points || *total > LEVELS_MOST_TOTAL)
        return BCIFS_INPUT;
    double *matrix = arena_new(states->arena, state->points * columns, sizeof *matrix);
    if (!matrix)
        return out_of_memory(states);
    size_t first = 0;
    for (size_t i = 0; i < state->cell->child_count; i++) {
        size_t child = state->children[i], width = below->columns[child],
               inner = states->states[child].points;
        double *product = arena_new(states->arena, state->points * width, sizeof *product);
        if (!product)
            return out_of_memory(states);
        matrix_multiply(state->maps[i], below->matrices[child], state->points, inner, width, product);
        for (size_t row = 0; row < state->points; row++)
            memcpy(matrix + row * columns + first, product + row * width, width * sizeof *matrix);
        first += width - joint;
    }
    tier->matrices[index] = matrix;
    tier->columns[index] = columns;
    tier->joints[index] = joint;
    return BCIFS_OK;
}

static bcifs_status size_refuse(struct states *states, size_t index, unsigned depth)
{
    if (!states->setting.report)
        return BCIFS_INPUT;
    return report_failure(states->setting.report, BCIFS_INPUT, NULL,
                          "the level-%u refinement matrix of '%s' has more than %d entries; choose a smaller "
                          "--depth, or -o x.mtx, which has no limit",
                          depth, states->states[index].key.definition->name, LEVELS_MOST_ENTRIES);
}

bcifs_status levels_refine(struct states *states, size_t index, unsigned depth, const double **matrix,
                           size_t *columns, const char **reason)
{
    struct gathering gathering = {0};
    struct tier tier, next;
    size_t total = 0;
    *matrix = NULL;
    *reason = NULL;
    if (depth > LEVELS_DEEPEST)
        return size_refuse(states, index, depth);
    bcifs_status status = states_gather(states, index, depth, &gathering, reason);
    if (status || *reason)
        return status;
    status = tier_first(states, &gathering, &tier);
    for (unsigned level = 1; level <= depth && status == BCIFS_OK; level++) {
        status = tier_new(states, gathering.count, &next);
        for (size_t s = 0; s < gathering.count && status == BCIFS_OK; s++)
            if (gathering.least[s] <= depth - level)
                status = state_refine(states, s, &tier, &next, &total);
        tier = next;
    }
    if (status == BCIFS_INPUT)
        return size_refuse(states, index, depth);
    if (status == BCIFS_OK) {
        *matrix = tier.matrices[index];
        *columns = tier.columns[index];
    }
    return status;
}

/* ---- Interpolation ------------------------------------------------------------------------------------- */

/* Whether T e_j = e_j in exact arithmetic. */
static bool column_is_fixed(const struct value_matrix *map, size_t j)
{
    for (size_t i = 0; i < map->rows; i++)
        if (map->values[i * map->columns + j].residue != (uint64_t)(i == j))
            return false;
    return true;
}

/* The control point that the limit point c is, or m_s. */
static size_t unit_find(const double *point, size_t count)
{
    size_t found = count;
    for (size_t j = 0; j < count; j++)
        if (fabs(point[j] - 1) <= TOLERANCE_EQUATION)
            found = j;
    for (size_t i = 0; i < count && found < count; i++)
        if (fabs(point[i] - (i == found)) > TOLERANCE_EQUATION)
            return count;
    return found;
}

bcifs_status levels_interpolate(struct states *states, size_t index, int *interpolating, const char **reason)
{
    bcifs_status status = states_expand(states, index);
    *interpolating = 1;
    *reason = NULL;
    for (int side = 0; side < 2 && status == BCIFS_OK && *interpolating == 1; side++) {
        size_t vertex = states->states[index].boundaries[side];
        status = states_expand(states, vertex);
        size_t points = states->states[vertex].points;
        double *limit = arena_new(states->arena, points, sizeof *limit);
        if (status || !limit)
            return status ? status : out_of_memory(states);
        struct report *report = states->setting.report;
        states->setting.report = NULL; /* without a limit point there is no error, but no answer either */
        bcifs_status found = states_limit(states, vertex, limit);
        states->setting.report = report;
        if (found == BCIFS_MEMORY)
            return out_of_memory(states);
        if (found) {
            *interpolating = -1;
            *reason = "its joint has no single limit point";
            return BCIFS_OK;
        }
        const struct state *state = &states->states[vertex];
        const struct value_matrix *map = state->cell->children[0].map;
        size_t j = unit_find(limit, points);
        bool exact = map->exact && state->children[0] == vertex;
        *interpolating = j < points && (!exact || column_is_fixed(map, j));
    }
    return status;
}
