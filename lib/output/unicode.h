/* Unicode: text that comes from anywhere, character by character, fit to be written into a file.
 *
 * What is not UTF-8 (an argument of a command line may be anything) comes out as U+FFFD, the replacement
 * character. */
#ifndef OUTPUT_UNICODE_H
#define OUTPUT_UNICODE_H

#include <stddef.h>
#include <stdint.h>

struct unicode {
    uint32_t code;
    const char *bytes; /* its UTF-8 */
    size_t length;     /* of `bytes`; 0 past the end of the text */
    const char *rest;  /* the text that follows */
};

/* The first character of a NUL-terminated text; the one after `character`. */
struct unicode unicode_first(const char *text);
struct unicode unicode_next(const struct unicode *character);

#endif
