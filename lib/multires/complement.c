#include "complement.h"

#include <math.h>
#include <string.h>

#include "numeric/tolerance.h"

bool refinement_row(const struct stencil *refinement, bool closed, ptrdiff_t row, struct stencil_place *place)
{
    ptrdiff_t rows = (ptrdiff_t)refinement->rows, turn = 0;
    if (row < 0 || row >= rows) {
        if (!closed)
            return false;
        turn = row < 0 ? -((-row + rows - 1) / rows) : row / rows;
        row -= turn * rows;
    }
    size_t low = 0, high = refinement->run_count;
    while (low + 1 < high) {
        size_t middle = low + (high - low) / 2;
        if (refinement->runs[middle].row <= (size_t)row)
            low = middle;
        else
            high = middle;
    }
    const struct stencil_run *run = &refinement->runs[low];
    size_t block = ((size_t)row - run->row) / run->height, r = ((size_t)row - run->row) % run->height;
    const struct stencil_row *template = &refinement->templates[run->first + r];
    place->column = (ptrdiff_t)(run->column + block * run->step) + template->offset +
                    turn * (ptrdiff_t)refinement->width;
    place->length = template->length;
    place->weights = refinement->weights + template->first;
    return true;
}

/* The search for one vector: row e, and the rows before it made orthonormal. */
struct search {
    const struct stencil *refinement;
    bool closed;
    size_t reach;       /* rows looked at before e */
    size_t span, ahead; /* columns kept: those from `column` on, `ahead` of them behind the last of row e */
    ptrdiff_t column;
    double *rest;       /* span: what of row e is not accounted for yet */
    double *basis;      /* reach × span */
    double *recipe;     /* reach × (reach + 1): basis vector k in terms of the rows e, e - 1, … */
    double *vector;     /* reach + 1: the coefficients of the rows e, e - 1, … */
    double *spread;     /* span */
};

static bool row_spread(const struct search *search, ptrdiff_t row, double *spread)
{
    struct stencil_place place;
    memset(spread, 0, search->span * sizeof *spread);
    if (!refinement_row(search->refinement, search->closed, row, &place))
        return false;
    for (size_t j = 0; j < place.length; j++) {
        ptrdiff_t column = place.column + (ptrdiff_t)j - search->column;
        if (column >= 0 && column < (ptrdiff_t)search->span)
            spread[column] = place.weights[j];
    }
    return true;
}

static double dot(const double *a, const double *b, size_t size)
{
    double sum = 0;
    for (size_t i = 0; i < size; i++)
        sum += a[i] * b[i];
    return sum;
}

static void add_scaled(double *a, double factor, const double *b, size_t size)
{
    for (size_t i = 0; i < size; i++)
        a[i] += factor * b[i];
}

/* Makes search->spread, the row `back` before e, orthogonal to the basis and adds it unless nothing is left. */
static bool basis_extend(struct search *search, size_t count, size_t back)
{
    double *row = search->spread, *recipe = search->recipe + count * (search->reach + 1);
    double norm = sqrt(dot(row, row, search->span));
    memset(recipe, 0, (search->reach + 1) * sizeof *recipe);
    recipe[back] = 1;
    for (int pass = 0; pass < 2; pass++)
        for (size_t k = 0; k < count; k++) {
            double share = dot(row, search->basis + k * search->span, search->span);
            add_scaled(row, -share, search->basis + k * search->span, search->span);
            add_scaled(recipe, -share, search->recipe + k * (search->reach + 1), search->reach + 1);
        }
    double rest = sqrt(dot(row, row, search->span));
    if (rest <= TOLERANCE_RANK * norm)
        return false;
    for (size_t i = 0; i < search->span; i++)
        search->basis[count * search->span + i] = row[i] / rest;
    for (size_t i = 0; i <= search->reach; i++)
        recipe[i] /= rest;
    return true;
}

/* Whether row e depends on the `reach` rows before it; search->vector then holds q_e, q_e-1, …, *length of them. */
static bool vector_find(struct search *search, ptrdiff_t e, size_t *length)
{
    struct stencil_place place;
    size_t count = 0;
    refinement_row(search->refinement, search->closed, e, &place);
    search->column = place.column + (ptrdiff_t)(place.length + search->ahead) - (ptrdiff_t)search->span;
    row_spread(search, e, search->rest);
    double norm = sqrt(dot(search->rest, search->rest, search->span));
    memset(search->vector, 0, (search->reach + 1) * sizeof *search->vector);
    search->vector[0] = 1;
    for (size_t back = 1; back <= search->reach; back++) {
        if (!row_spread(search, e - (ptrdiff_t)back, search->spread))
            return false;
        if (!basis_extend(search, count, back))
            continue;
        const double *fresh = search->basis + count * search->span;
        double share = dot(search->rest, fresh, search->span);
        add_scaled(search->rest, -share, fresh, search->span);
        add_scaled(search->vector, -share, search->recipe + count * (search->reach + 1), search->reach + 1);
        count++;
        if (sqrt(dot(search->rest, search->rest, search->span)) <= TOLERANCE_RANK * norm) {
            *length = back + 1;
            return true;
        }
    }
    return false;
}

/* Appends q, in the order of the fine points, of length 1. */
static void vector_add(const struct search *search, ptrdiff_t e, size_t length, double *workspace,
                       struct stencil *details)
{
    double norm = sqrt(dot(search->vector, search->vector, length));
    for (size_t i = 0; i < length; i++)
        workspace[length - 1 - i] = search->vector[i] / norm;
    stencil_row_add(details, e - (ptrdiff_t)length + 1, workspace, length);
}

static void block_complement(struct search *search, size_t row, size_t height, double *workspace,
                             struct stencil *details)
{
    size_t length;
    stencil_block_begin(details, row);
    for (size_t r = 0; r < height; r++)
        if (vector_find(search, (ptrdiff_t)(row + r), &length))
            vector_add(search, (ptrdiff_t)(row + r), length, workspace, details);
    stencil_block_end(details);
}

/* Every block of P; those whose rows before them are as far as can be seen those of the block before repeat it. */
static bcifs_status blocks_complement(struct search *search, double *workspace, struct stencil *details)
{
    const struct stencil *refinement = search->refinement;
    for (size_t i = 0; i < refinement->run_count; i++) {
        const struct stencil_run *run = &refinement->runs[i];
        size_t own = search->reach / run->height + 2; /* blocks that see another run, and one that does not */
        own = own < run->blocks ? own : run->blocks;
        for (size_t k = 0; k < own; k++)
            block_complement(search, run->row + k * run->height, run->height, workspace, details);
        stencil_blocks_repeat(details, run->blocks - own, run->height);
    }
    return details->failed ? BCIFS_MEMORY : BCIFS_OK;
}

/* The widest block of P decides how far vectors reach: w rows that touch w/N + m - 1 columns depend on each other as
 * soon as w > (m - 1) N/(N - 1); twice that, and a few blocks, leaves room for matrices that are not generic. */
static void search_size(struct search *search)
{
    const struct stencil *refinement = search->refinement;
    size_t height = 0, width = 0;
    for (size_t i = 0; i < refinement->run_count; i++) {
        const struct stencil_run *run = &refinement->runs[i];
        height = run->height > height ? run->height : height;
        width = (size_t)(run->high - run->low) > width ? (size_t)(run->high - run->low) : width;
    }
    search->reach = 4 * width + 2 * height;
    search->ahead = width;
    search->span = 4 * width + (search->reach / (height ? height : 1) + 2) * width;
}

bcifs_status complement_find(const struct stencil *refinement, bool closed, struct arena *arena,
                             struct stencil *details, bool *found)
{
    struct search search = {.refinement = refinement, .closed = closed};
    search_size(&search);
    size_t side = search.reach + 1;
    double *numbers = memory_new(2 * search.span + search.reach * search.span + search.reach * side + 2 * side,
                                 sizeof *numbers);
    if (!numbers)
        return BCIFS_MEMORY;
    search.rest = numbers;
    search.spread = search.rest + search.span;
    search.basis = search.spread + search.span;
    search.recipe = search.basis + search.reach * search.span;
    search.vector = search.recipe + search.reach * side;
    stencil_begin(details, refinement->rows, arena);
    bcifs_status status = blocks_complement(&search, search.vector + side, details);
    *found = details->rows + refinement->width == refinement->rows;
    memory_free(numbers);
    return status;
}
