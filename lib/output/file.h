/* File: output that appears whole or not at all.
 *
 * Bytes go through one buffer to a temporary file beside the target, which takes the target's name when all
 * of them have arrived and is removed otherwise. Standard output ("-") and what exists and is not a regular
 * file (a pipe, a device) is written as the bytes come. A failure is remembered and makes later writes do
 * nothing, so a writer may check now and then; file_close reports it. A process that is killed leaves its
 * temporary file,
 * `.bcifs-…`, behind. */
#ifndef OUTPUT_FILE_H
#define OUTPUT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "language/report.h"

struct file {
    struct report *report;
    const char *name; /* as the caller gave it, for messages */
    char *target;     /* what the temporary file becomes; NULL when the bytes are written as they come */
    char *temporary;
    int descriptor;
    int failure; /* the first errno, or 0 */
    size_t used;
    unsigned char *buffer;
};

/* `path` must stay valid until the file is closed. On failure nothing is left to close. */
bcifs_status file_open(struct file *file, const char *path, struct report *report);
void file_write(struct file *file, const void *bytes, size_t length);
void file_text(struct file *file, const char *text);
void file_integer(struct file *file, uint64_t number);
/* The shortest decimal of a finite number; or the number rounded to `decimals` places, |number| < 1e9. */
void file_number(struct file *file, double number);
void file_fixed(struct file *file, double number, int decimals);
bool file_failed(const struct file *file);
/* Puts the file in its place when `status`, the fate of what was to be written, is BCIFS_OK and every write
 * went well; otherwise leaves everything as it was. Returns the first thing that went wrong. */
bcifs_status file_close(struct file *file, bcifs_status status);

#endif
