/* Filter banks: decomposition to one or two control points and reconstruction of a million planar points, beside a
 * copy of the same bytes. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bcifs.h"
#include "bench.h"

struct job {
    bcifs_automaton *automaton;
    bcifs_figure *figure;
    bcifs_bank *bank;
    size_t count;
    double *points, *coefficients, *copy;
};

static void decompose(void *context)
{
    struct job *job = context;
    bcifs_error error;
    bench_require(bcifs_bank_decompose(job->bank, job->points, 2, job->coefficients, &error), "decomposition");
}

static void reconstruct(void *context)
{
    struct job *job = context;
    bcifs_error error;
    bench_require(bcifs_bank_reconstruct(job->bank, job->coefficients, 2, job->copy, &error), "reconstruction");
}

static void copy(void *context)
{
    struct job *job = context;
    memcpy(job->copy, job->points, 2 * job->count * sizeof *job->copy);
}

static void run(struct bench *bench, const char *name, const char *file, const char *figure, unsigned levels)
{
    struct job job = {0};
    bcifs_error error;
    char title[80];
    const bcifs_figure_options options = {.figure = figure};
    snprintf(title, sizeof title, "banks/%s", name);
    if (!bench_wants(bench, title))
        return;
    bench_require(bcifs_load(file, NULL, &job.automaton, &error), file);
    bench_require(bcifs_figure_create(job.automaton, &options, &job.figure, &error), figure);
    bench_require(bcifs_bank_create(job.figure, levels, levels, &job.bank, &error), "the bank");
    job.count = bcifs_bank_points(job.bank);
    job.points = malloc(2 * job.count * sizeof *job.points);
    job.coefficients = malloc(2 * job.count * sizeof *job.points);
    job.copy = malloc(2 * job.count * sizeof *job.points);
    bench_require(!job.points || !job.coefficients || !job.copy, "memory");
    for (size_t i = 0; i < 2 * job.count; i++)
        job.points[i] = (double)(i * 2654435761u % 1000) / 1000;
    memset(job.copy, 1, 2 * job.count * sizeof *job.copy);
    decompose(&job);
    snprintf(title, sizeof title, "banks/%s decompose 2^20", name);
    struct bench_case one = {title, (double)job.count, "points", "a copy", decompose, copy, &job};
    bench_measure(bench, &one);
    snprintf(title, sizeof title, "banks/%s reconstruct 2^20", name);
    one.work = reconstruct;
    bench_measure(bench, &one);
    free(job.points);
    free(job.coefficients);
    free(job.copy);
    bcifs_bank_free(job.bank);
    bcifs_figure_free(job.figure);
    bcifs_automaton_free(job.automaton);
}

void bench_banks(struct bench *bench)
{
    run(bench, "chaikin closed", "automata/chaikin.bcifs", "square", 18);
    run(bench, "four-point closed", "automata/four-point.bcifs", "star", 17);
    run(bench, "takagi open", "automata/takagi.bcifs", "curve", 19);
    run(bench, "cubic open", "automata/bspline-cubic.bcifs", "two_arcs", 19);
}
