/* Report: where findings about a file go: `file:line:column: error: …`, with the line and a caret below it.
 *
 * A report counts, keeps the first error for the bcifs_error of the public call, and hands each finding on to the
 * caller's bcifs_reporter. It stops handing on after REPORT_MOST errors. It allocates nothing. */
#ifndef LANGUAGE_REPORT_H
#define LANGUAGE_REPORT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/text.h"
#include "bcifs.h"
#include "language/source.h"

enum { REPORT_MOST = 20 };

struct report {
    bcifs_reporter *callback; /* may be NULL */
    void *context;
    bcifs_error first; /* the first error; status BCIFS_OK while there is none */
    unsigned errors, warnings;
};

struct report report_new(const bcifs_load_options *options);
/* Errors about a place of a source. All return BCIFS_INPUT, so that a caller may `return report_error(…)`. */
bcifs_status report_error(struct report *report, const struct source *source, source_place place,
                          const char *format, ...) TEXT_FORMAT(4, 5);
void report_warning(struct report *report, const struct source *source, source_place place, const char *format,
                    ...) TEXT_FORMAT(4, 5);
/* An error with no place in a file; `file` may be NULL. Returns `status`. */
bcifs_status report_failure(struct report *report, bcifs_status status, const char *file, const char *format, ...)
    TEXT_FORMAT(4, 5);
/* Reports that memory is out and returns BCIFS_MEMORY. */
bcifs_status report_memory(struct report *report);
/* Whether REPORT_MOST errors are reached and work should stop. */
bool report_is_full(const struct report *report);
/* Copies the first error to `error` (may be NULL) and returns its status. */
bcifs_status report_close(const struct report *report, bcifs_error *error);

/* The candidate nearest to `word` by edits (insert, delete, replace, swap neighbors), or NULL when none is near
 * enough to be what was meant (at most a third of the length, at least 1, differs). Words over 64 bytes have none. */
const char *nearest_word(const char *word, const char *const *candidates, size_t count);

#endif
