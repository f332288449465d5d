/* Walkers: see bcifs.h and plan.h. A walker holds one control matrix per level above the tables. */
#include "evaluate/kernel.h"
#include "evaluate/plan.h"
#include "numeric/matrix.h"

#include <string.h>

enum { MOST_STACK = 1 << 24 /* numbers */ };

struct frame {
    size_t state, child;
    double *matrix; /* P·T_w: dimension × points of the state */
};

struct bcifs_walker {
    struct arena arena;
    const bcifs_plan *plan;
    struct frame *frames; /* frames[0] is the piece; one for each level above the tables, or `depth` for a tail */
    size_t segment;
    unsigned height; /* of the frame that the columns belong to */
    const struct columns *columns; /* what is being written; NULL: the segment is not entered yet */
    size_t column;
    uint64_t position; /* in the plan's points */
};

void piece_gather(const bcifs_figure *figure, const struct piece *piece, size_t points, double *matrix)
{
    for (size_t c = 0; c < figure->dimension; c++)
        for (size_t j = 0; j < points; j++)
            matrix[c * points + j] = figure->points[piece->indices[j] * figure->dimension + c];
}

bcifs_status bcifs_walker_create(const bcifs_plan *plan, bcifs_walker **walker, bcifs_error *error)
{
    struct report report = report_new(NULL);
    bcifs_walker *fresh = memory_new(1, sizeof *fresh);
    size_t levels = (size_t)plan->depth + 1, size = plan->largest * plan->figure->dimension;
    bcifs_status status = BCIFS_OK;
    double *numbers = NULL;
    if (levels > MOST_STACK / (size ? size : 1))
        status = report_failure(&report, BCIFS_INPUT, NULL, "depth %u with %zu control points is too large a walk",
                                plan->depth, plan->largest);
    if (fresh && status == BCIFS_OK) {
        fresh->plan = plan;
        fresh->frames = arena_new(&fresh->arena, levels, sizeof *fresh->frames);
        numbers = arena_new(&fresh->arena, levels * size, sizeof *numbers);
    }
    if (status == BCIFS_OK && (!fresh || !fresh->frames || !numbers))
        status = report_memory(&report);
    if (status) {
        bcifs_walker_free(fresh);
        report_close(&report, error);
        return status;
    }
    for (size_t i = 0; i < levels; i++)
        fresh->frames[i].matrix = numbers + i * size;
    bcifs_walker_seek(fresh, 0);
    *walker = fresh;
    return BCIFS_OK;
}

void bcifs_walker_free(bcifs_walker *walker)
{
    if (!walker)
        return;
    arena_free(&walker->arena);
    memory_free(walker);
}

/* Makes frame `height + 1` for child `child` of frame `height`: P·T_w·T_i. */
static void frame_descend(bcifs_walker *walker, unsigned height, size_t child)
{
    const struct states *states = &walker->plan->states;
    struct frame *frame = &walker->frames[height], *next = frame + 1;
    const struct state *state = &states->states[frame->state];
    frame->child = child;
    next->state = state->children[child];
    next->child = 0;
    matrix_multiply(frame->matrix, state->maps[child], walker->plan->figure->dimension, state->points,
                    states->states[next->state].points, next->matrix);
}

static void segment_enter(bcifs_walker *walker, size_t segment)
{
    const bcifs_plan *plan = walker->plan;
    const struct piece *piece = &plan->figure->pieces[plan->segments[segment].piece];
    walker->segment = segment;
    walker->frames[0].state = piece->state;
    walker->frames[0].child = 0;
    piece_gather(plan->figure, piece, plan->states.states[piece->state].points, walker->frames[0].matrix);
}

static void columns_begin(bcifs_walker *walker, unsigned height, const struct columns *tables)
{
    walker->height = height;
    walker->columns = &tables[walker->frames[height].state];
    walker->column = 0;
}

/* Goes down to the subtree that holds the point `index` of the segment, and to its column there. */
static void segment_seek(bcifs_walker *walker, uint64_t index)
{
    const bcifs_plan *plan = walker->plan;
    unsigned heights = plan->depth - plan->tail;
    if (plan->segments[walker->segment].is_tail) {
        for (unsigned h = 0; h < plan->depth; h++)
            frame_descend(walker, h, plan->states.states[walker->frames[h].state].cell->child_count - 1);
        columns_begin(walker, plan->depth, plan->ends);
    } else {
        for (unsigned h = 0; h < heights; h++) {
            const struct state *state = &plan->states.states[walker->frames[h].state];
            const uint64_t *counts = plan->counts + (size_t)(plan->depth - h - 1) * plan->walked;
            size_t child = 0;
            for (; counts[state->children[child]] <= index; child++)
                index -= counts[state->children[child]];
            frame_descend(walker, h, child);
        }
        columns_begin(walker, heights, plan->tables);
    }
    walker->column = (size_t)index;
}

/* The segment that holds point `index` of the figure: the last that does not begin behind it. */
static size_t segment_find(const bcifs_plan *plan, uint64_t index)
{
    size_t low = 0, high = plan->segment_count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (plan->segments[middle].first <= index)
            low = middle;
        else
            high = middle;
    }
    return low;
}

void bcifs_walker_seek(bcifs_walker *walker, uint64_t index)
{
    const bcifs_plan *plan = walker->plan;
    walker->position = index < plan->points ? index : plan->points;
    walker->columns = NULL;
    if (index >= plan->points)
        return;
    index += plan->offset;
    segment_enter(walker, segment_find(plan, index));
    segment_seek(walker, index - plan->segments[walker->segment].first);
}

/* Goes to the next subtree: up until there is another child, then down to its first tables. */
static void subtree_next(bcifs_walker *walker)
{
    const bcifs_plan *plan = walker->plan;
    unsigned height = walker->height;
    bool is_tail = plan->segments[walker->segment].is_tail;
    while (height > 0 && !is_tail) {
        const struct frame *parent = &walker->frames[--height];
        size_t child = parent->child + 1;
        if (child >= plan->states.states[parent->state].cell->child_count)
            continue;
        frame_descend(walker, height++, child);
        for (; height < plan->depth - plan->tail; height++)
            frame_descend(walker, height, 0);
        columns_begin(walker, height, plan->tables);
        return;
    }
    segment_enter(walker, walker->segment + 1);
    segment_seek(walker, 0);
}

size_t bcifs_walker_next(bcifs_walker *walker, double *points, size_t capacity)
{
    const bcifs_plan *plan = walker->plan;
    size_t dimension = plan->figure->dimension, written = 0;
    if (capacity > plan->points - walker->position)
        capacity = (size_t)(plan->points - walker->position);
    while (written < capacity) {
        if (walker->column == walker->columns->count) {
            subtree_next(walker);
            continue;
        }
        const struct frame *frame = &walker->frames[walker->height];
        size_t count = walker->columns->count - walker->column;
        count = count < capacity - written ? count : capacity - written;
        kernel_points(frame->matrix, dimension, plan->states.states[frame->state].points,
                      walker->columns->numbers + walker->column, walker->columns->count, count,
                      points + written * dimension);
        walker->column += count;
        written += count;
    }
    walker->position += written;
    return written;
}
