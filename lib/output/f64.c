/* F64: the points' doubles, the least significant byte first, and nothing else. */
#include <string.h>

#include "output/format.h"

/* Puts the bytes of each number in order, in place: on a little-endian machine this changes nothing. */
static void bytes_order(double *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t bits;
        unsigned char bytes[sizeof bits];
        memcpy(&bits, &numbers[i], sizeof bits);
        for (size_t k = 0; k < sizeof bits; k++)
            bytes[k] = (unsigned char)(bits >> (8 * k));
        memcpy(&numbers[i], bytes, sizeof bytes);
    }
}

bcifs_status f64_write(struct job *job, struct file *file)
{
    const struct point_source *source = &job->layers[0].points;
    struct reader reader;
    bcifs_status status = reader_open(&reader, job, 0);
    if (status != BCIFS_OK)
        return status;
    job->total = source->count;
    while ((status = reader_next(&reader)) == BCIFS_OK && reader.count > 0 && !file_failed(file)) {
        bytes_order(reader.tile, reader.count * source->dimension);
        file_write(file, reader.tile, reader.count * source->dimension * sizeof *reader.tile);
    }
    reader_close(&reader);
    return status;
}
