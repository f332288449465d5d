#include "output/json_text.h"

#include <math.h>

void json_string(struct text *text, const char *string)
{
    text_append(text, "\"");
    for (const char *s = string; *s; s++) {
        if (*s == '"' || *s == '\\')
            text_append_character(text, '\\', 1);
        if ((unsigned char)*s < 0x20)
            text_format(text, "\\u%04x", (unsigned)(unsigned char)*s);
        else
            text_append_character(text, *s, 1);
    }
    text_append(text, "\"");
}

void json_key(struct text *text, const char *key)
{
    json_string(text, key);
    text_append(text, ": ");
}

void json_number(struct text *text, double number)
{
    if (isfinite(number))
        text_append_number(text, number);
    else
        text_append(text, "null");
}

void json_flag(struct text *text, const char *key, bool flag)
{
    json_key(text, key);
    text_append(text, flag ? "true" : "false");
}

void json_strings(struct text *text, const char *const *strings, size_t count)
{
    text_append(text, "[");
    for (size_t i = 0; i < count; i++) {
        text_append(text, i ? ", " : "");
        json_string(text, strings[i]);
    }
    text_append(text, "]");
}

void json_matrix(struct text *text, const double *matrix, size_t rows, size_t columns)
{
    text_append(text, "[");
    for (size_t i = 0; i < rows; i++) {
        text_append(text, i ? ", [" : "[");
        for (size_t j = 0; j < columns; j++) {
            text_append(text, j ? ", " : "");
            json_number(text, matrix[i * columns + j]);
        }
        text_append(text, "]");
    }
    text_append(text, "]");
}
