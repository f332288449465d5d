/* Format: the table of what bcifs_write can write. Adding a format is one file and one row. */
#ifndef OUTPUT_FORMAT_H
#define OUTPUT_FORMAT_H

#include <stdbool.h>

#include "output/file.h"
#include "output/job.h"

struct format {
    const char *name;
    const char *ending; /* of a path, its point included */
    const char *text;   /* what it is, in one line */
    bool is_picture;
    bcifs_status (*write)(struct job *job, struct file *file);
};

/* The format called `name` or, when that is NULL, the one that the ending of `path` asks for; "-" without a
 * name is csv. Small and capital letters are alike. NULL after reporting that there is none. */
const struct format *format_find(const char *name, const char *path, struct report *report);

/* The whole job as one file; returns what is reported. */
bcifs_status format_write(const struct format *format, struct job *job, const char *path);

/* The writers. Each reports what fails on the side of the points; the file remembers its own failures. */
bcifs_status csv_write(struct job *job, struct file *file);
bcifs_status json_write(struct job *job, struct file *file);
bcifs_status f64_write(struct job *job, struct file *file);
bcifs_status npy_write(struct job *job, struct file *file);
bcifs_status svg_write(struct job *job, struct file *file);
bcifs_status png_write(struct job *job, struct file *file);

#endif
