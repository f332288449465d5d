/* Runs the benchmarks: `bench [-o FILE] [PREFIX …]`. Prints median, minimum and maximum of several samples and the
 * ratio to the yardstick; -o writes all of it as a JSON list. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bcifs.h"
#include "bench.h"

enum { SAMPLES = 15, MOST_CALLS = 1 << 24 };
static const double SAMPLE_SECONDS = 1e-3;

struct bench {
    FILE *json;
    size_t count;
    char **prefixes;
    size_t prefix_count;
};

double bench_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void bench_require(int status, const char *what)
{
    if (status) {
        fprintf(stderr, "bench: %s failed\n", what);
        exit(1);
    }
}

int bench_wants(const struct bench *bench, const char *prefix)
{
    for (size_t i = 0; i < bench->prefix_count; i++) {
        size_t length = strlen(bench->prefixes[i]), other = strlen(prefix);
        if (strncmp(bench->prefixes[i], prefix, length < other ? length : other) == 0)
            return 1;
    }
    return bench->prefix_count == 0;
}

static double sample_take(bench_work *work, void *context, size_t calls)
{
    double began = bench_now();
    for (size_t i = 0; i < calls; i++)
        work(context);
    return (bench_now() - began) / (double)calls;
}

/* How many calls fill a sample. */
static size_t calls_choose(bench_work *work, void *context)
{
    size_t calls = 1;
    work(context);
    while (calls < MOST_CALLS) {
        double one = sample_take(work, context, calls);
        if (one * (double)calls >= SAMPLE_SECONDS / 2)
            break;
        calls *= 2;
    }
    return calls;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* 1.25 ms, 310 ns. */
static void time_text(char out[32], double seconds)
{
    static const struct {
        double unit;
        const char *name;
    } units[] = {{1, "s"}, {1e-3, "ms"}, {1e-6, "µs"}, {1e-9, "ns"}};
    size_t i = 0;
    while (i < 3 && seconds < units[i].unit)
        i++;
    snprintf(out, 32, "%.3g %s", seconds / units[i].unit, units[i].name);
}

static void result_tell(struct bench *bench, const struct bench_case *one, const double *times, double ratio)
{
    char median[32], least[32], most[32], number[40];
    time_text(median, times[SAMPLES / 2]);
    time_text(least, times[0]);
    time_text(most, times[SAMPLES - 1]);
    printf("%-38s %10s  (%s to %s)", one->name, median, least, most);
    if (one->yardstick)
        printf("  %.3g × %s", ratio, one->yardstick);
    putchar('\n');
    fflush(stdout);
    if (!bench->json)
        return;
    fprintf(bench->json, "%s\n  {\"name\": \"%s\", ", bench->count++ ? "," : "", one->name);
    bcifs_number_text(number, times[SAMPLES / 2]);
    fprintf(bench->json, "\"median_seconds\": %s, ", number);
    bcifs_number_text(number, times[0]);
    fprintf(bench->json, "\"least_seconds\": %s, ", number);
    bcifs_number_text(number, times[SAMPLES - 1]);
    fprintf(bench->json, "\"most_seconds\": %s, ", number);
    bcifs_number_text(number, one->items);
    fprintf(bench->json, "\"items\": %s, \"unit\": \"%s\", ", number, one->unit);
    if (one->yardstick) {
        bcifs_number_text(number, ratio);
        fprintf(bench->json, "\"yardstick\": \"%s\", \"ratio\": %s}", one->yardstick, number);
    } else {
        fprintf(bench->json, "\"yardstick\": null, \"ratio\": null}");
    }
}

void bench_measure(struct bench *bench, const struct bench_case *one)
{
    double times[SAMPLES], others[SAMPLES];
    if (!bench_wants(bench, one->name))
        return;
    size_t calls = calls_choose(one->work, one->context),
           other_calls = one->other ? calls_choose(one->other, one->context) : 0;
    for (int i = 0; i < SAMPLES; i++) {
        times[i] = sample_take(one->work, one->context, calls);
        others[i] = one->other ? sample_take(one->other, one->context, other_calls) : 1;
    }
    qsort(times, SAMPLES, sizeof *times, compare);
    qsort(others, SAMPLES, sizeof *others, compare);
    result_tell(bench, one, times, times[SAMPLES / 2] / others[SAMPLES / 2]);
}

int main(int count, char **words)
{
    struct bench bench = {.prefixes = words + 1, .prefix_count = (size_t)count - 1};
    if (count > 2 && strcmp(words[1], "-o") == 0) {
        bench.json = fopen(words[2], "w");
        bench_require(!bench.json, words[2]);
        fputs("[", bench.json);
        bench.prefixes += 2;
        bench.prefix_count -= 2;
    }
    bench_banks(&bench);
    bench_editor(&bench);
    if (bench.json) {
        fputs("\n]\n", bench.json);
        bench_require(fclose(bench.json), "writing the results");
    }
    return 0;
}
