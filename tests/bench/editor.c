/* The area-true editor in the setting of [MR]: 2^n control points, edited at level L = 2 … 4. One drag step is solved and
 * reconstructed; the yardstick is what a program does that knows nothing of the structure: one dense Gaussian elimination
 * of the real 2n × 2n system of the first-order conditions. With many points, of which few coefficients decide, it is a
 * copy of the points, for these are to be written at least. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bcifs.h"
#include "bench.h"

struct job {
    bcifs_automaton *automaton;
    bcifs_figure *figure;
    bcifs_editor *editor;
    bcifs_editor_options options;
    unsigned step;
    size_t size; /* of the dense system */
    double *dense, *work;
};

static void drag(void *context)
{
    struct job *job = context;
    bcifs_error error;
    double angle = 0.1 * job->step++;
    bench_require(bcifs_editor_drag(job->editor, 0.1 * cos(angle), 0.1 * sin(angle), &error), "drag");
}

static void grab(void *context)
{
    struct job *job = context;
    const size_t point = 0;
    bcifs_error error;
    bench_require(bcifs_editor_grab(job->editor, &point, 1, &error), "grab");
}

static void create(void *context)
{
    struct job *job = context;
    bcifs_editor *editor;
    bcifs_error error;
    bench_require(bcifs_editor_create(job->figure, &job->options, &editor, &error), "editor");
    bcifs_editor_free(editor);
}

/* Elimination without pivoting of a diagonally dominant matrix; one right-hand side. */
static void dense_solve(void *context)
{
    struct job *job = context;
    size_t n = job->size;
    double *a = job->work;
    memcpy(a, job->dense, n * (n + 1) * sizeof *a);
    for (size_t k = 0; k < n; k++)
        for (size_t i = k + 1; i < n; i++) {
            double factor = a[i * (n + 1) + k] / a[k * (n + 1) + k];
            for (size_t j = k; j <= n; j++)
                a[i * (n + 1) + j] -= factor * a[k * (n + 1) + j];
        }
    for (size_t k = n; k-- > 0;) {
        for (size_t j = k + 1; j < n; j++)
            a[k * (n + 1) + n] -= a[k * (n + 1) + j] * a[j * (n + 1) + n];
        a[k * (n + 1) + n] /= a[k * (n + 1) + k];
    }
}

static void copy(void *context)
{
    struct job *job = context;
    memcpy(job->work, job->dense, job->size * sizeof *job->work);
}

static void dense_make(struct job *job, size_t size)
{
    job->size = size;
    job->dense = malloc(size * (size + 1) * sizeof *job->dense);
    job->work = malloc(size * (size + 1) * sizeof *job->work);
    bench_require(!job->dense || !job->work, "memory");
    for (size_t i = 0; i < size * (size + 1); i++)
        job->dense[i] = (double)(i * 2654435761u % 1000) / 1000;
    for (size_t i = 0; i < size; i++)
        job->dense[i * (size + 1) + i] += (double)size;
}

/* An outline with details of two sizes. */
static void job_open(struct job *job, unsigned n, unsigned level)
{
    size_t count = (size_t)1 << n;
    bcifs_error error;
    double *points = malloc(2 * count * sizeof *points);
    bench_require(!points, "memory");
    for (size_t i = 0; i < count; i++) {
        double angle = 8 * atan(1) * (double)i / (double)count, r = 1 + 0.1 * sin(9 * angle) + 0.02 * sin(41 * angle);
        points[2 * i] = r * cos(angle);
        points[2 * i + 1] = r * sin(angle);
    }
    const bcifs_figure_options options = {.points = points, .point_count = count, .dimension = 2};
    job->options = (bcifs_editor_options){.coarsen = n - level};
    bench_require(bcifs_load("automata/chaikin.bcifs", NULL, &job->automaton, &error), "automata/chaikin.bcifs");
    bench_require(bcifs_figure_create(job->automaton, &options, &job->figure, &error), "the figure");
    bench_require(bcifs_editor_create(job->figure, &job->options, &job->editor, &error), "the editor");
    free(points);
}

static void run(struct bench *bench, unsigned n, unsigned level, const char *free_name, bcifs_free free_set)
{
    struct job job = {0};
    char title[80];
    bcifs_error error;
    const bcifs_constraint constraint = {.keep_area = 1, .alpha = 100, .free = free_set, .neighbors = 2};
    snprintf(title, sizeof title, "editor/drag %s 2^%u L=%u", free_name, n, level);
    if (!bench_wants(bench, title))
        return;
    job_open(&job, n, level);
    bench_require(bcifs_editor_constrain(job.editor, &constraint, &error), "the constraint");
    struct bench_case one = {title, 1, "drag steps", "a dense solve", drag, dense_solve, &job};
    dense_make(&job, free_set == BCIFS_FREE_ALL ? (size_t)2 << 7 : (size_t)2 << level);
    if (n > 7) {
        free(job.dense);
        free(job.work);
        job.size = (size_t)2 << n;
        job.dense = calloc(job.size, sizeof *job.dense);
        job.work = calloc(job.size, sizeof *job.work);
        bench_require(!job.dense || !job.work, "memory");
        one.yardstick = "a copy of the points";
        one.other = copy;
    }
    grab(&job);
    bench_measure(bench, &one);
    free(job.dense);
    free(job.work);
    bcifs_editor_free(job.editor);
    bcifs_figure_free(job.figure);
    bcifs_automaton_free(job.automaton);
}

static void run_setup(struct bench *bench, unsigned n, unsigned level)
{
    struct job job = {0};
    char title[80];
    snprintf(title, sizeof title, "editor/matrices 2^%u L=%u", n, level);
    if (!bench_wants(bench, title))
        return;
    job_open(&job, n, level);
    const struct bench_case one = {title, (double)((size_t)1 << n), "points", NULL, create, NULL, &job};
    bench_measure(bench, &one);
    bcifs_editor_free(job.editor);
    bcifs_figure_free(job.figure);
    bcifs_automaton_free(job.automaton);
}

void bench_editor(struct bench *bench)
{
    static const unsigned sizes[] = {7, 14};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (unsigned level = 2; level <= 4; level++) {
            run(bench, sizes[i], level, "near", BCIFS_FREE_NEAR);
            run(bench, sizes[i], level, "scale", BCIFS_FREE_SCALE);
        }
    run(bench, 7, 4, "all", BCIFS_FREE_ALL);
    run(bench, 10, 4, "all", BCIFS_FREE_ALL);
    run_setup(bench, 7, 4);
    run_setup(bench, 14, 4);
}
