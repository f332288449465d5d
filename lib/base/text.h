/* Text: a growing string, used for every report, picture and formatted file that is built in memory.
 *
 * A failure to get memory is remembered in `failed` and makes later appends do nothing, so a writer checks once,
 * at the end. Numbers are never written through printf, whose decimal point follows the locale: see decimal.h. */
#ifndef BASE_TEXT_H
#define BASE_TEXT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

struct text {
    char *data; /* NUL-terminated once anything was appended */
    size_t length, capacity;
    bool failed;
};

#if defined(__GNUC__)
#define TEXT_FORMAT(string, first) __attribute__((format(printf, string, first)))
#else
#define TEXT_FORMAT(string, first)
#endif

void text_append(struct text *text, const char *string);
void text_append_bytes(struct text *text, const char *bytes, size_t length);
void text_append_character(struct text *text, char character, size_t times);
/* printf for strings and integers only. */
void text_format(struct text *text, const char *format, ...) TEXT_FORMAT(2, 3);
/* The shortest decimal that reads back as `number`; NaN and infinities never reach it. */
void text_append_number(struct text *text, double number);
void text_free(struct text *text);
/* Hands the string over to the caller (memory_free) and empties the text; NULL when it failed. */
char *text_take(struct text *text);

#endif
