/* Stencil: sparse matrices whose rows repeat, as those that refine a curve do: row r + n of one block has the weights
 * of row r of the block before, a few columns further on.
 *
 * Rows come in blocks (one for each cell of a curve). Equal blocks that follow each other are held once, as a run, so
 * that the matrix of a uniform curve takes a few numbers whatever its size, and applying it streams the vector
 * only. Columns are taken modulo the width: closed curves wrap. */
#ifndef NUMERIC_STENCIL_H
#define NUMERIC_STENCIL_H

#include <stdbool.h>
#include <stddef.h>

#include "base/memory.h"
#include "numeric/sparse.h"

/* weights[first … first + length - 1] stand in the columns base + offset … of the block's base column. */
struct stencil_row {
    ptrdiff_t offset;
    size_t length, first;
};

struct stencil_run {
    size_t row, column;    /* of its first block: first row, base column */
    size_t blocks, step;   /* the next block's base is `step` columns on */
    size_t first, height;  /* its rows: stencil->templates[first … first + height - 1] */
    ptrdiff_t low, high;   /* columns that a block touches, from its base: low <= … < high */
};

struct stencil {
    struct arena *arena;
    size_t rows, width;
    struct stencil_run *runs;
    struct stencil_row *templates;
    double *weights;
    size_t run_count, run_capacity, template_count, template_capacity, weight_count, weight_capacity;
    bool failed; /* memory is out: what was added since is missing */
    /* The block being added: */
    size_t block_template, block_weight, block_column;
    size_t last_column; /* base of the last finished block */
};

/* An empty matrix of `width` columns; rows are appended, block by block. */
void stencil_begin(struct stencil *stencil, size_t width, struct arena *arena);
/* One block: its base column, then its rows. A row's columns are absolute and may lie outside 0 … width - 1. */
void stencil_block_begin(struct stencil *stencil, size_t column);
void stencil_row_add(struct stencil *stencil, ptrdiff_t column, const double *weights, size_t length);
void stencil_block_end(struct stencil *stencil);
/* Adds `count` blocks equal to the last one, each `step` columns on. */
void stencil_blocks_repeat(struct stencil *stencil, size_t count, size_t step);

/* y = S x, or y += S x; x is width × components, y rows × components. */
void stencil_apply(const struct stencil *stencil, const double *x, size_t components, bool add, double *y);
/* y += S^T x; x is rows × components, y width × components. */
void stencil_apply_transposed(const struct stencil *stencil, const double *x, size_t components, double *y);
/* All of it, as a sparse matrix; false when memory is out. */
bool stencil_sparse(const struct stencil *stencil, struct sparse *sparse, struct arena *arena);

#endif
