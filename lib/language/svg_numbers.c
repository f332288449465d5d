#include "svg_numbers.h"

#include <stdio.h>
#include <string.h>

#include "base/decimal.h"

enum { MOST_SHOWN = 24 /* bytes of the file that a message quotes */ };

bcifs_status svg_error(const struct svg_cursor *cursor, const char *place, const char *format, ...)
{
    char message[sizeof((bcifs_error *)0)->message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return report_error(cursor->report, cursor->source, (source_place)(place - cursor->source->text), "%s",
                        message);
}

bcifs_status svg_expected(const struct svg_cursor *cursor, const char *what)
{
    if (cursor->at == cursor->end)
        return svg_error(cursor, cursor->at, "expected %s, found the end of the value", what);
    int length = 1;
    while (length < MOST_SHOWN && cursor->at + length < cursor->end &&
           !strchr(" \t\r\n,", cursor->at[length]))
        length++;
    while (cursor->at + length < cursor->end && (cursor->at[length] & 0xC0) == 0x80)
        length++; /* not in the middle of a character */
    return svg_error(cursor, cursor->at, "expected %s, found '%.*s'", what, length, cursor->at);
}

void svg_skip_space(struct svg_cursor *cursor)
{
    while (cursor->at < cursor->end && strchr(" \t\r\n", *cursor->at))
        cursor->at++;
}

bool svg_number_follows(struct svg_cursor *cursor)
{
    svg_skip_space(cursor);
    return cursor->at < cursor->end && strchr("+-.0123456789,", *cursor->at);
}

static const char *digits_skip(const char *at, const char *end)
{
    while (at < end && *at >= '0' && *at <= '9')
        at++;
    return at;
}

/* The end of the longest number at `at`, or `at`: [+-] (digits [. digits] | . digits) [e [+-] digits]. */
static const char *number_end(const char *at, const char *end)
{
    const char *begin = at;
    at += at < end && (*at == '+' || *at == '-');
    const char *whole = digits_skip(at, end), *stop = whole;
    if (whole < end && *whole == '.')
        stop = digits_skip(whole + 1, end);
    if (whole == at && stop <= whole + 1)
        return begin;
    if (stop < end && (*stop == 'e' || *stop == 'E')) {
        const char *exponent = stop + 1;
        exponent += exponent < end && (*exponent == '+' || *exponent == '-');
        if (digits_skip(exponent, end) > exponent)
            return digits_skip(exponent, end);
    }
    return stop;
}

bcifs_status svg_number(struct svg_cursor *cursor, const char *what, double *number)
{
    svg_skip_space(cursor);
    if (cursor->after_number && cursor->at < cursor->end && *cursor->at == ',') {
        cursor->at++;
        svg_skip_space(cursor);
    }
    const char *stop = number_end(cursor->at, cursor->end);
    if (stop == cursor->at)
        return svg_expected(cursor, what);
    size_t length = (size_t)(stop - cursor->at);
    if (!decimal_parse(cursor->at, length, number))
        return svg_error(cursor, cursor->at, "the number '%.*s' is too large",
                         (int)(length > MOST_SHOWN ? MOST_SHOWN : length), cursor->at);
    cursor->at = stop;
    cursor->after_number = true;
    return BCIFS_OK;
}

bcifs_status svg_numbers(struct svg_cursor *cursor, const char *what, double *numbers, size_t count)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < count && status == BCIFS_OK; i++)
        status = svg_number(cursor, what, &numbers[i]);
    return status;
}
