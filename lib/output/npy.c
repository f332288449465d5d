/* NPY, version 1.0: a Python dictionary in a header padded to a multiple of 64 bytes, then the raw doubles
 * (https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html). */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "output/format.h"

enum { HEADER_SIZE = 128, PREFIX_SIZE = 10 };

bcifs_status npy_write(struct job *job, struct file *file)
{
    const struct point_source *source = &job->layers[0].points;
    char header[HEADER_SIZE + 1];
    /* The longest dictionary, of 2^64 points in 16 dimensions, has 83 bytes. */
    memset(header, ' ', sizeof header);
    memcpy(header, "\x93NUMPY\x01\x00", 8);
    header[8] = (char)(HEADER_SIZE - PREFIX_SIZE);
    header[9] = 0;
    int length = snprintf(header + PREFIX_SIZE, sizeof header - PREFIX_SIZE,
                          "{'descr': '<f8', 'fortran_order': False, 'shape': (%" PRIu64 ", %u), }",
                          source->count, source->dimension);
    header[PREFIX_SIZE + length] = ' ';
    header[HEADER_SIZE - 1] = '\n';
    file_write(file, header, HEADER_SIZE);
    return f64_write(job, file);
}
