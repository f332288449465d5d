/* Bench: what the benchmarks share. Each measures something beside a yardstick: both run by turns in one process, so
 * that whatever slows the machine slows both, and what counts is the ratio of their medians. */
#ifndef BENCH_H
#define BENCH_H

#include <stddef.h>

struct bench; /* the run: where results go, and which are wanted */

typedef void bench_work(void *context);

struct bench_case {
    const char *name;      /* "editor/drag near 128" */
    double items;          /* done by one call of `work`, */
    const char *unit;      /* in words: "points" */
    const char *yardstick; /* what `other` is, in words; NULL: nothing to compare with */
    bench_work *work, *other;
    void *context;
};

/* Measures, prints a line, and notes the result. Calls are repeated until one sample takes about a millisecond. */
void bench_measure(struct bench *bench, const struct bench_case *one);
/* Whether any case whose name begins so is wanted: what is slow to prepare asks first. */
int bench_wants(const struct bench *bench, const char *prefix);
/* Seconds of a clock that only goes forward. */
double bench_now(void);
/* Ends the program with a message when `status` (a bcifs_status) is not 0. */
void bench_require(int status, const char *what);

/* The groups; each is a file. */
void bench_banks(struct bench *bench);
void bench_editor(struct bench *bench);

#endif
