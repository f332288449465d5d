/* Filter banks: every curve of the gallery, and some that it lacks, taken apart and put together again; Chaikin's
 * filters against [MR] (7) and (8), the misprint corrected; subdivided curves have no details. */
#include <dirent.h>
#include <math.h>
#include <string.h>

#include "multires/bank.h"
#include "tap.h"

/* ---- Samples ------------------------------------------------------------------------------------------- */

static const char extra[] =
    "automaton extra\n"
    "edge ternary { mask 3 [ 1/27 4/27 10/27 16/27 19/27 16/27 10/27 4/27 1/27 ] }\n"
    "edge dense { mask 2 [ 1/2 1 1/2 ] }\n"
    "edge quintic { mask 2 [ 1/32 6/32 15/32 20/32 15/32 6/32 1/32 ] }\n"
    "vertex end 1 { }\n"
    "edge a 2 { start end at 0 end end at 1\n"
    "  sub b [ 1 4/5; 0 1/5 ]  sub a [ 4/5 1/2; 1/5 1/2 ]  sub b [ 1/2 0; 1/2 1 ] }\n"
    "edge b 2 { start end at 0 end end at 1\n"
    "  sub a [ 1 1/3; 0 2/3 ]  sub a [ 1/3 0; 2/3 1 ] }\n"
    "figure ternary { closed ternary points [ 0 0; 1 0; 3 4; 1 1; 0 7 ] }\n"
    "figure open_ternary { open ternary points [ 0 0; 1 0; 3 4; 1 1; 0 7; 2 2 ] }\n"
    "figure dense { closed dense points [ 0 0; 1 0; 3 4 ] }\n"
    "figure quintic { closed quintic points [ 0 0; 1 0; 3 4; 5 5 ] }\n"
    "figure open_quintic { open quintic points [ 0 0; 1 0; 3 4; 5 5; 6 0; 7 1; 8 2; 9 9 ] }\n"
    "figure mixed { open a points [ 0 0; 1 3; 2 -1; 4 4 ] }\n"
    "figure chains { piece a at 0 1 piece b at 1 2 piece a at 3 4 points [ 0 0; 1 3; 2 -1; 4 4; 5 0 ] }\n";

static void random_points(double *points, size_t count, uint64_t *state)
{
    for (size_t i = 0; i < count; i++)
        points[i] = (double)(random_bits(state) >> 11) * 0x1p-52 - 1;
}

static double largest_difference(const double *a, const double *b, size_t count)
{
    double largest = 0;
    for (size_t i = 0; i < count; i++)
        largest = fmax(largest, fabs(a[i] - b[i]));
    return largest;
}

struct job {
    struct arena arena;
    struct ladder ladder;
    struct bank bank;
    double *points, *coefficients, *again, *workspace;
};

static bool job_open(struct job *job, const bcifs_figure *figure, unsigned refine, unsigned coarsen, const char *name)
{
    struct report report = report_new(NULL);
    *job = (struct job){.arena = {0}};
    bcifs_status status = ladder_create(&job->ladder, figure, refine, coarsen, &job->arena, &report);
    if (status == BCIFS_OK)
        status = bank_create(&job->bank, &job->ladder, job->ladder.levels - coarsen, job->ladder.levels, &job->arena,
                             &report);
    if (status) {
        note("%s, %u - %u levels: %s", name, refine, coarsen, report.first.message);
        arena_free(&job->arena);
        return false;
    }
    size_t count = 2 * job->bank.count;
    job->points = arena_new(&job->arena, count, sizeof(double));
    job->coefficients = arena_new(&job->arena, count, sizeof(double));
    job->again = arena_new(&job->arena, count, sizeof(double));
    job->workspace = arena_new(&job->arena, BANK_WORKSPACE * count, sizeof(double));
    return true;
}

/* Relative error of reconstruction, and the largest detail of a subdivided curve. */
static void check_figure(const bcifs_figure *figure, const char *name, double *worst, double *details, int *tested)
{
    uint64_t state = 7;
    for (unsigned refine = 1; refine <= 4; refine++) {
        struct job job;
        if (!job_open(&job, figure, refine, refine, name))
            continue;
        size_t count = 2 * job.bank.count, scale = 2 * job.bank.scale;
        random_points(job.points, count, &state);
        bank_decompose(&job.bank, job.points, 2, job.coefficients, job.workspace);
        bank_reconstruct(&job.bank, job.coefficients, 2, job.again, job.workspace);
        double error = largest_difference(job.points, job.again, count);
        if (error > 1e-13)
            note("%s, %u levels of %zu points: %g", name, refine, job.bank.count, error);
        *worst = fmax(*worst, error);
        random_points(job.coefficients, scale, &state);
        memset(job.coefficients + scale, 0, (count - scale) * sizeof(double));
        bank_reconstruct(&job.bank, job.coefficients, 2, job.points, job.workspace);
        bank_decompose(&job.bank, job.points, 2, job.again, job.workspace);
        double wrong = largest_difference(job.again, job.coefficients, count);
        if (wrong > 1e-11)
            note("%s, %u levels: a subdivided curve has details %g", name, refine, wrong);
        *details = fmax(*details, wrong);
        ++*tested;
        arena_free(&job.arena);
    }
}

static void check_automaton(const bcifs_automaton *automaton, const char *from, double *worst, double *details,
                            int *tested)
{
    for (size_t i = 0; i < automaton->figure_count; i++) {
        bcifs_figure_options options = {.figure = automaton->figures[i].name};
        bcifs_figure *figure = NULL;
        bcifs_error error;
        char name[200];
        snprintf(name, sizeof name, "%.80s, %.80s", from, options.figure);
        if (bcifs_figure_create(automaton, &options, &figure, &error) == BCIFS_OK &&
            figure->shape == FIGURE_CURVE && !figure->displaced)
            check_figure(figure, name, worst, details, tested);
        bcifs_figure_free(figure);
    }
}

static void test_reconstruction(void)
{
    double worst = 0, details = 0;
    int tested = 0;
    bcifs_automaton *automaton = NULL;
    DIR *directory = opendir("automata");
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        char path[300];
        snprintf(path, sizeof path, "automata/%s", entry->d_name);
        if (!strstr(path, ".bcifs") || bcifs_load(path, NULL, &automaton, NULL))
            continue;
        check_automaton(automaton, path, &worst, &details, &tested);
        bcifs_automaton_free(automaton);
    }
    closedir(directory);
    bcifs_load_text("extra", extra, strlen(extra), NULL, &automaton, NULL);
    check_automaton(automaton, "extra", &worst, &details, &tested);
    bcifs_automaton_free(automaton);
    note("%d banks, worst reconstruction %g, worst detail of a subdivided curve %g", tested, worst, details);
    ok(tested >= 100, "every curve of the gallery has a filter bank of four levels");
    ok(worst <= 1e-12, "every curve is reconstructed to 1e-12");
    ok(details <= 1e-10, "a subdivided curve has no details");
}

/* [MR] (7), and (8) with - d_{i+1} in its second line, written out. */
static void test_chaikin(void)
{
    bcifs_automaton *automaton = NULL;
    bcifs_figure *figure = NULL;
    struct job job;
    uint64_t state = 5;
    double worst = 0;
    bcifs_load("automata/chaikin.bcifs", NULL, &automaton, NULL);
    bcifs_figure_create(automaton, NULL, &figure, NULL);
    if (!ok(job_open(&job, figure, 3, 1, "chaikin"), "Chaikin's bank"))
        return;
    size_t n = job.bank.count;
    const double *f = job.points, *x = job.coefficients, *d = job.coefficients + n;
    random_points(job.points, 2 * n, &state);
    bank_decompose(&job.bank, job.points, 2, job.coefficients, job.workspace);
    bank_reconstruct(&job.bank, job.coefficients, 2, job.again, job.workspace);
    for (size_t i = 0; i < n / 2; i++)
        for (size_t c = 0; c < 2; c++) {
            size_t a = 2 * ((2 * i + n - 2) % n) + c, b = 2 * ((2 * i + n - 1) % n) + c, e = 4 * i + c,
                   g = 4 * i + 2 + c, next = 2 * ((i + 1) % (n / 2)) + c, here = 2 * i + c;
            worst = fmax(worst, fabs(x[here] - (-f[a] + 3 * f[b] + 3 * f[e] - f[g]) / 4));
            worst = fmax(worst, fabs(d[here] - (f[a] - 3 * f[b] + 3 * f[e] - f[g]) / 4));
            worst = fmax(worst, fabs(job.again[e] - (0.75 * (x[here] + d[here]) + 0.25 * (x[next] - d[next]))));
            worst = fmax(worst, fabs(job.again[g] - (0.25 * (x[here] + d[here]) + 0.75 * (x[next] - d[next]))));
        }
    ok(worst <= 1e-15 * 8, "decomposition is (7), reconstruction is (8)");
    arena_free(&job.arena);
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
}

int main(void)
{
    test_reconstruction();
    test_chaikin();
    return done_testing();
}
