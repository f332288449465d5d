/* Control points from CSV: bcifs_points_read, see bcifs.h. */
#include <string.h>

#include "base/decimal.h"
#include "language/points.h"

enum { MOST_COORDINATES = 16, MOST_ROWS = 1 << 24 };

struct table {
    const struct source *source;
    struct report *report;
    double *numbers;
    size_t count, capacity; /* numbers */
    size_t columns, rows;
};

/* A field without the white space around it. */
static void trim(const char **begin, const char **end)
{
    while (*begin < *end && (**begin == ' ' || **begin == '\t'))
        ++*begin;
    while (*end > *begin && ((*end)[-1] == ' ' || (*end)[-1] == '\t' || (*end)[-1] == '\r'))
        --*end;
}

static bool number_append(struct table *table, double number)
{
    if (table->count == table->capacity) {
        size_t capacity = table->capacity ? 2 * table->capacity : 256;
        double *numbers = memory_resize(table->numbers, capacity, sizeof *numbers);
        if (!numbers)
            return false;
        table->numbers = numbers;
        table->capacity = capacity;
    }
    table->numbers[table->count++] = number;
    return true;
}

/* Whether a row is the header: every field begins as a name does, and none is a number. */
static bool is_header(const char *begin, const char *end)
{
    while (begin <= end) {
        const char *stop = memchr(begin, ',', (size_t)(end - begin));
        const char *field_end = stop ? stop : end, *field = begin;
        double number;
        trim(&field, &field_end);
        bool name = field < field_end && !strchr("+-.0123456789", *field);
        if (!name || decimal_parse(field, (size_t)(field_end - field), &number))
            return false;
        if (!stop)
            break;
        begin = stop + 1;
    }
    return true;
}

static bcifs_status field_read(struct table *table, const char *begin, const char *end)
{
    double number;
    const char *written = begin;
    trim(&begin, &end);
    source_place place = (source_place)((begin < end ? begin : written) - table->source->text);
    if (begin == end)
        return report_error(table->report, table->source, place, "a coordinate is missing");
    if (!decimal_parse(begin, (size_t)(end - begin), &number))
        return report_error(table->report, table->source, place, "expected a number, found '%.*s'%s",
                            (int)(end - begin > 40 ? 40 : end - begin), begin,
                            memchr(begin, ' ', (size_t)(end - begin)) ? "; coordinates are separated by commas" : "");
    return number_append(table, number) ? BCIFS_OK : report_memory(table->report);
}

static bcifs_status row_read(struct table *table, const char *begin, const char *end)
{
    size_t columns = 0;
    const char *start = begin;
    for (bool more = true; more; columns++) {
        const char *stop = memchr(begin, ',', (size_t)(end - begin));
        bcifs_status status = field_read(table, begin, stop ? stop : end);
        if (status)
            return status;
        more = stop != NULL;
        begin = more ? stop + 1 : end;
    }
    source_place place = (source_place)(start - table->source->text);
    if (columns > MOST_COORDINATES)
        return report_error(table->report, table->source, place, "a point has at most %d coordinates, found %zu",
                            MOST_COORDINATES, columns);
    if (table->rows > 0 && columns != table->columns)
        return report_error(table->report, table->source, place, "this point has %zu coordinates, those above %zu",
                            columns, table->columns);
    if (table->rows++ == MOST_ROWS)
        return report_error(table->report, table->source, place, "more than %d points", MOST_ROWS);
    table->columns = columns;
    return BCIFS_OK;
}

static bcifs_status table_read(struct table *table)
{
    const char *line = table->source->text, *last = line + table->source->length;
    bool first = true;
    while (line < last && !report_is_full(table->report)) {
        const char *end = memchr(line, '\n', (size_t)(last - line));
        const char *begin = line;
        end = end ? end : last;
        line = end + 1;
        trim(&begin, &end);
        if (begin == end || *begin == '#')
            continue;
        bool header = first && is_header(begin, end);
        first = false;
        if (!header && row_read(table, begin, end) == BCIFS_MEMORY)
            return BCIFS_MEMORY;
    }
    if (table->report->errors > 0)
        return BCIFS_INPUT;
    if (table->rows == 0)
        return report_failure(table->report, BCIFS_INPUT, table->source->name, "the file has no points");
    return BCIFS_OK;
}

bcifs_status points_from_source(const struct source *source, struct report *report, double **points, size_t *count,
                                unsigned *dimension)
{
    struct table table = {.source = source, .report = report};
    bcifs_status status = table_read(&table);
    if (status) {
        memory_free(table.numbers);
        return status;
    }
    *points = table.numbers;
    *count = table.rows;
    *dimension = (unsigned)table.columns;
    return BCIFS_OK;
}

bcifs_status bcifs_points_read(const char *path, const bcifs_load_options *options, double **points, size_t *count,
                               unsigned *dimension, bcifs_error *error)
{
    struct report report = report_new(options);
    struct arena arena = {0};
    struct source *source;
    bcifs_status status = source_read(&arena, path, &report, &source);
    if (status == BCIFS_OK)
        status = points_from_source(source, &report, points, count, dimension);
    if (status)
        report_close(&report, error);
    arena_free(&arena);
    return status;
}

void bcifs_points_free(double *points)
{
    memory_free(points);
}
