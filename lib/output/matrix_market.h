/* MatrixMarket: the lines of sparse matrices as text, coordinate format (Boisvert, Pozo and Remington, The Matrix Market
 * exchange formats, 1996): a header, comments, the sizes, then "row column value" from 1. */
#ifndef OUTPUT_MATRIX_MARKET_H
#define OUTPUT_MATRIX_MARKET_H

#include "output/file.h"

/* Part of a comment, which stays on its line whatever the text holds. */
void market_comment_write(struct file *file, const char *text);
void market_sizes_write(struct file *file, uint64_t rows, uint64_t columns, uint64_t entries);
/* An entry at a place counted from 0. */
void market_entry_write(struct file *file, uint64_t row, uint64_t column, double value);

#endif
