/* Source: the text of one file, checked to be something the language can talk about.
 *
 * Text is UTF-8 without control characters other than tab, newline and carriage return, at most
 * SOURCE_LONGEST bytes. Places are byte offsets; line and column are computed when a message needs them. */
#ifndef LANGUAGE_SOURCE_H
#define LANGUAGE_SOURCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "bcifs.h"

enum { SOURCE_LONGEST = 16 * 1024 * 1024 };

struct source {
    const char *name; /* as the user gave it: for messages, and `use` paths are relative to it */
    const char *text; /* NUL-terminated */
    size_t length;
};

/* A place in a source: a byte offset. */
typedef uint32_t source_place;

struct report;

/* Reads the file `path` ("-": standard input, named "<stdin>"); a file that cannot be read is BCIFS_INPUT when it
 * does not exist, is a directory or is not permitted, BCIFS_SYSTEM otherwise. Everything is allocated in `arena`. */
bcifs_status source_read(struct arena *arena, const char *path, struct report *report, struct source **source);
/* Takes a copy of `length` bytes of `text`. */
bcifs_status source_from_text(struct arena *arena, const char *name, const char *text, size_t length,
                              struct report *report, struct source **source);

/* Line and column, from 1; the column counts characters (code points), a tab as one. */
void source_locate(const struct source *source, source_place place, unsigned *line, unsigned *column);

#endif
