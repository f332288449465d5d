/* CSV: a header, one point a line in numbers that read back exactly, an empty line before every path (or
 * polygon) but the first, which is how gnuplot tells curves apart. */
#include "output/format.h"

static void header_write(struct file *file, unsigned dimension)
{
    static const char *const names[] = {"x", "x,y", "x,y,z"};
    if (dimension <= 3) {
        file_text(file, names[dimension - 1]);
    } else {
        for (unsigned i = 0; i < dimension; i++) {
            file_text(file, i == 0 ? "x" : ",x");
            file_integer(file, i);
        }
    }
    file_text(file, "\n");
}

static void row_write(struct file *file, const double *point, unsigned dimension)
{
    for (unsigned i = 0; i < dimension; i++) {
        if (i > 0)
            file_write(file, ",", 1);
        file_number(file, point[i]);
    }
    file_write(file, "\n", 1);
}

bcifs_status csv_write(struct job *job, struct file *file)
{
    const struct point_source *source = &job->layers[0].points;
    struct reader reader;
    bcifs_status status = reader_open(&reader, job, 0);
    if (status != BCIFS_OK)
        return status;
    job->total = source->count;
    header_write(file, source->dimension);
    struct group group = group_first(source);
    while ((status = reader_next(&reader)) == BCIFS_OK && reader.count > 0 && !file_failed(file)) {
        for (size_t i = 0; i < reader.count; i++) {
            if (reader.first + i == group.first + group.count) {
                group = group_next(source, &group);
                file_write(file, "\n", 1);
            }
            row_write(file, reader.tile + i * source->dimension, source->dimension);
        }
    }
    reader_close(&reader);
    return status;
}
