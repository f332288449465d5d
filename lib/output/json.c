/* JSON: one object. Curves are `paths`, loose points `coordinates`, control frames `polygons`. */
#include "output/format.h"
#include "output/unicode.h"

static void string_write(struct file *file, const char *text)
{
    static const char digits[] = "0123456789abcdef";
    file_text(file, "\"");
    for (struct unicode next = unicode_first(text); next.length > 0; next = unicode_next(&next)) {
        if (next.code < 0x20) {
            char escape[6] = {'\\', 'u', '0', '0', digits[next.code >> 4], digits[next.code & 15]};
            file_write(file, escape, sizeof escape);
        } else {
            if (next.code == '"' || next.code == '\\')
                file_text(file, "\\");
            file_write(file, next.bytes, next.length);
        }
    }
    file_text(file, "\"");
}

static void head_write(const struct job *job, struct file *file)
{
    const struct point_source *source = &job->layers[0].points;
    file_text(file, "{\"automaton\": ");
    string_write(file, job->automaton);
    file_text(file, ", \"figure\": ");
    string_write(file, job->figure);
    file_text(file, ", \"dimension\": ");
    file_integer(file, source->dimension);
    file_text(file, ", \"points\": ");
    file_integer(file, source->count);
    file_text(file, points_are_loose(source) ? ", \"coordinates\": ["
                    : source->polygon > 0    ? ", \"polygons\": ["
                                             : ", \"paths\": [");
}

static void point_write(struct file *file, const double *point, unsigned dimension)
{
    for (unsigned i = 0; i < dimension; i++) {
        file_write(file, i == 0 ? "[" : ",", 1);
        file_number(file, point[i]);
    }
    file_write(file, "]", 1);
}

/* What stands before and after the points of a group. */
static void group_begin(const struct point_source *source, const struct group *group, struct file *file)
{
    if (source->polygon > 0)
        file_text(file, "\n[");
    else if (!points_are_loose(source))
        file_text(file, group->closed ? "\n{\"closed\": true, \"points\": ["
                                      : "\n{\"closed\": false, \"points\": [");
}

static void group_end(const struct point_source *source, struct file *file)
{
    if (source->polygon > 0)
        file_text(file, "]");
    else if (!points_are_loose(source))
        file_text(file, "]}");
}

bcifs_status json_write(struct job *job, struct file *file)
{
    const struct point_source *source = &job->layers[0].points;
    struct reader reader;
    bcifs_status status = reader_open(&reader, job, 0);
    if (status != BCIFS_OK)
        return status;
    job->total = source->count;
    head_write(job, file);
    struct group group = group_first(source);
    while ((status = reader_next(&reader)) == BCIFS_OK && reader.count > 0 && !file_failed(file)) {
        for (size_t i = 0; i < reader.count; i++) {
            uint64_t index = reader.first + i;
            if (index == group.first)
                group_begin(source, &group, file);
            file_text(file, "\n");
            point_write(file, reader.tile + i * source->dimension, source->dimension);
            bool last = index + 1 == group.first + group.count;
            if (last)
                group_end(source, file);
            if (last)
                group = group_next(source, &group);
            if (index + 1 < source->count)
                file_text(file, ",");
        }
    }
    file_text(file, "]}\n");
    reader_close(&reader);
    return status;
}
