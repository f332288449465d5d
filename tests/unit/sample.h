/* Sample: points in memory as a layer to be written, and files read back. For the tests of lib/output. */
#ifndef TESTS_SAMPLE_H
#define TESTS_SAMPLE_H

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "output/format.h"
#include "output/picture.h"

struct sample {
    const double *points; /* count × dimension */
    uint64_t count;
    unsigned dimension;
    const bcifs_path *paths; /* NULL: loose points or polygons */
    size_t path_count;
    unsigned polygon;
};

struct sample_walk {
    const struct sample *sample;
    uint64_t next;
};

static inline bcifs_path sample_path(const void *origin, size_t index)
{
    return ((const struct sample *)origin)->paths[index];
}

static inline bcifs_status sample_open(const void *origin, void **walk, bcifs_error *error)
{
    struct sample_walk *fresh = calloc(1, sizeof *fresh);
    if (!fresh) {
        *error = (bcifs_error){.status = BCIFS_MEMORY, .message = "no memory"};
        return BCIFS_MEMORY;
    }
    fresh->sample = origin;
    *walk = fresh;
    return BCIFS_OK;
}

/* Hands out a little less than is asked for, as a walker at the end of a piece may. */
static inline size_t sample_next(void *walk, double *points, size_t capacity)
{
    struct sample_walk *place = walk;
    const struct sample *sample = place->sample;
    uint64_t left = sample->count - place->next;
    size_t count = capacity > 1000 ? 1000 : capacity;
    if (count > left)
        count = (size_t)left;
    memcpy(points, sample->points + place->next * sample->dimension,
           count * sample->dimension * sizeof *points);
    place->next += count;
    return count;
}

static inline void sample_close(void *walk)
{
    free(walk);
}

static inline struct layer sample_layer(const struct sample *sample, bcifs_role role)
{
    return (struct layer){.points = {.count = sample->count,
                                     .dimension = sample->dimension,
                                     .path_count = sample->path_count,
                                     .polygon = sample->polygon,
                                     .origin = sample,
                                     .path = sample_path,
                                     .open = sample_open,
                                     .next = sample_next,
                                     .close = sample_close},
                          .role = role};
}

static const char sample_text[] = "# <a> & \"b\" é\r\nautomaton sample\n";
static const struct source sample_source = {"dir/sa<mple.bcifs", sample_text, sizeof sample_text - 1};
static const struct source *const sample_sources[] = {&sample_source};

static inline struct job sample_job(const struct layer *layers, size_t count, struct report *report)
{
    *report = report_new(NULL);
    return (struct job){.layers = layers,
                        .layer_count = count,
                        .automaton = "sample",
                        .title = "A \"sample\" & more",
                        .figure = "shape",
                        .command = "bcifs eval 'a<b' \xff -o x",
                        .sources = sample_sources,
                        .source_count = 1,
                        .width = 1000,
                        .report = report};
}

/* Writes the layers to `path`; `error` (may be NULL) receives what failed. */
static inline bcifs_status sample_write(const struct layer *layers, size_t count, const char *path,
                                        unsigned width, bcifs_error *error)
{
    struct report report;
    struct job job = sample_job(layers, count, &report);
    job.width = width;
    const struct format *format = format_find(NULL, path, &report);
    if (format)
        format_write(format, &job, path);
    return report_close(&report, error);
}

static inline bcifs_status sample_write_one(const struct sample *sample, const char *path, bcifs_error *error)
{
    struct layer layer = sample_layer(sample, BCIFS_CURVE);
    return sample_write(&layer, 1, path, 1000, error);
}

/* A whole file, NUL-terminated; NULL when it cannot be read. */
static inline char *sample_read(const char *path, size_t *length)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    rewind(file);
    char *bytes = calloc((size_t)size + 1, 1);
    *length = bytes ? fread(bytes, 1, (size_t)size, file) : 0;
    fclose(file);
    return bytes;
}

/* Makes a fresh directory and goes there. */
static inline void sample_directory_enter(char name[64])
{
    strcpy(name, "/tmp/bcifs-test-XXXXXX");
    if (!mkdtemp(name) || chdir(name) != 0)
        abort();
}

/* How many files there are here, "." and ".." not counted. */
static inline int sample_directory_count(void)
{
    int count = -2;
    DIR *directory = opendir(".");
    if (!directory)
        return -1;
    while (readdir(directory))
        count++;
    closedir(directory);
    return count;
}

/* Leaves and removes it with the files in it. */
static inline void sample_directory_remove(const char *name)
{
    DIR *directory = opendir(".");
    for (struct dirent *entry; directory && (entry = readdir(directory));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            remove(entry->d_name);
    if (directory)
        closedir(directory);
    if (chdir("/") == 0)
        rmdir(name);
}

#endif
