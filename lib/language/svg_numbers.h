/* SVG numbers: what path data and transforms of SVG are written with: numbers that may be packed ("1-2.5.5"),
 * separated by white space and at most one comma (SVG 1.1, 8.3.9). */
#ifndef LANGUAGE_SVG_NUMBERS_H
#define LANGUAGE_SVG_NUMBERS_H

#include "language/report.h"

/* A part of a source that is being read: the value of an attribute. */
struct svg_cursor {
    const struct source *source;
    struct report *report;
    const char *at, *end;
    bool after_number; /* a comma may come */
};

void svg_skip_space(struct svg_cursor *cursor);
/* Whether another number follows, perhaps behind a comma. Steps over white space. */
bool svg_number_follows(struct svg_cursor *cursor);
/* Reads a number, and the comma before it; "expected `what`, found …" when there is none. */
bcifs_status svg_number(struct svg_cursor *cursor, const char *what, double *number);
/* The same for a list. */
bcifs_status svg_numbers(struct svg_cursor *cursor, const char *what, double *numbers, size_t count);
/* Reports an error at `place`, a pointer into the source. Returns BCIFS_INPUT. */
bcifs_status svg_error(const struct svg_cursor *cursor, const char *place, const char *format, ...)
    TEXT_FORMAT(3, 4);
/* Reports "expected `what`, found …" at the next character. */
bcifs_status svg_expected(const struct svg_cursor *cursor, const char *what);

#endif
