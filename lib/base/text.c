#include "text.h"

#include <stdio.h>
#include <string.h>

#include "decimal.h"
#include "memory.h"

/* Makes room for `extra` more bytes and the NUL. */
static bool text_reserve(struct text *text, size_t extra)
{
    if (text->failed)
        return false;
    size_t needed = text->length + extra + 1;
    if (needed <= text->capacity)
        return true;
    size_t capacity = text->capacity ? text->capacity : 256;
    while (capacity < needed)
        capacity *= 2;
    char *data = memory_resize(text->data, capacity, 1);
    if (!data) {
        text->failed = true;
        return false;
    }
    text->data = data;
    text->capacity = capacity;
    return true;
}

void text_append_bytes(struct text *text, const char *bytes, size_t length)
{
    if (!text_reserve(text, length))
        return;
    if (length > 0)
        memcpy(text->data + text->length, bytes, length);
    text->length += length;
    text->data[text->length] = '\0';
}

void text_append(struct text *text, const char *string)
{
    text_append_bytes(text, string, strlen(string));
}

void text_append_character(struct text *text, char character, size_t times)
{
    if (!text_reserve(text, times))
        return;
    memset(text->data + text->length, character, times);
    text->length += times;
    text->data[text->length] = '\0';
}

void text_format(struct text *text, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (length < 0 || !text_reserve(text, (size_t)length)) {
        text->failed = true;
        return;
    }
    va_start(arguments, format);
    vsnprintf(text->data + text->length, (size_t)length + 1, format, arguments);
    va_end(arguments);
    text->length += (size_t)length;
}

void text_append_number(struct text *text, double number)
{
    char digits[DECIMAL_LONGEST];
    text_append_bytes(text, digits, decimal_print(digits, number));
}

void text_free(struct text *text)
{
    memory_free(text->data);
    *text = (struct text){0};
}

char *text_take(struct text *text)
{
    if (!text_reserve(text, 0)) {
        text_free(text);
        return NULL;
    }
    char *data = text->data;
    data[text->length] = '\0';
    *text = (struct text){0};
    return data;
}
