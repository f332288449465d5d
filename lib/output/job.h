/* Job: everything a format's writer needs to know: the layers, the words that go with them, and where to
 * report.
 *
 * It stands between the public call (write.c) and the formats, so that these can be fed with any points. */
#ifndef OUTPUT_JOB_H
#define OUTPUT_JOB_H

#include "language/report.h"
#include "language/source.h"
#include "output/points.h"

struct layer {
    struct point_source points;
    bcifs_role role;
    bcifs_ink ink;
};

struct job {
    const struct layer *layers;          /* data formats hold the first, pictures all */
    size_t layer_count;                  /* at least 1 */
    const char *automaton;               /* its name */
    const char *title;                   /* its title, "" without one */
    const char *figure;                  /* the figure's name, "" for a bare state */
    const char *command;                 /* NULL when unknown */
    const struct source *const *sources; /* the automaton's files, the main one first */
    size_t source_count;
    unsigned width; /* of a picture, in pixels */
    bcifs_progress *progress;
    void *context;
    uint64_t done, total; /* points read, and to be read, over all passes */
    struct report *report;
};

#endif
