/* JSON text: the pieces that every JSON report is made of, appended to a text.
 *
 * Numbers are written in the shortest form that reads back exactly; what JSON cannot hold (an infinite bound)
 * is null. Commas and brackets between pieces are the report's own. */
#ifndef OUTPUT_JSON_TEXT_H
#define OUTPUT_JSON_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/text.h"

/* A string in quotes; control characters, quotes and backslashes are escaped. */
void json_string(struct text *text, const char *string);
/* "key": */
void json_key(struct text *text, const char *key);
/* A number, or null when it is not finite. */
void json_number(struct text *text, double number);
/* "key": true or false */
void json_flag(struct text *text, const char *key, bool flag);
/* An array of strings. */
void json_strings(struct text *text, const char *const *strings, size_t count);
/* An array of rows; the matrix is rows × columns numbers, row after row. */
void json_matrix(struct text *text, const double *matrix, size_t rows, size_t columns);

#endif
