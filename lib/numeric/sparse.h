/* Sparse: matrices of doubles of which only the entries that are not zero are held, row after row (CSR). */
#ifndef NUMERIC_SPARSE_H
#define NUMERIC_SPARSE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"

/* Row i holds values[k] in column columns[k], starts[i] <= k < starts[i + 1], columns rising, none twice. */
struct sparse {
    size_t rows, width;   /* rows × width */
    const size_t *starts; /* rows + 1 */
    const uint32_t *columns;
    const double *values;
};

/* Every result is made in `arena`; false when memory is out. Widths and heights are below 2^32. */

/* From `count` triples (row, column, value) in any order; those of one place add up. */
struct triple {
    size_t row, column;
    double value;
};
bool sparse_from_triples(struct sparse *a, size_t rows, size_t width, const struct triple *triples,
                         size_t count, struct arena *arena);
/* B = A^T. */
bool sparse_transpose(const struct sparse *a, struct sparse *b, struct arena *arena);
/* C = A·B. Cost and storage follow the entries that are not zero. */
bool sparse_multiply(const struct sparse *a, const struct sparse *b, struct sparse *c, struct arena *arena);
/* The rows and columns listed (rising, none twice), in that order. */
bool sparse_select(const struct sparse *a, const size_t *rows, size_t row_count, const size_t *columns,
                   size_t column_count, struct sparse *b, struct arena *arena);
/* y = A x: x is width × components, y rows × components, rows of both adjacent in memory; `add`: y += A x. */
void sparse_apply(const struct sparse *a, const double *x, size_t components, bool add, double *y);
/* Entry (row, column), 0 where nothing is held. */
double sparse_entry(const struct sparse *a, size_t row, size_t column);

#endif
