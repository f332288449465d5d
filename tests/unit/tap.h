/* TAP: what the unit tests are written with. They print one line per check, as the Test Anything Protocol
 * wants it (testanything.org), and can be run alone or by any harness that speaks it, such as prove.
 *
 * A test program calls ok() once per claim and ends with `return done_testing();`. Loops over random inputs
 * make one claim together; they print the inputs that break it with note(). */
#ifndef TAP_H
#define TAP_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef __GNUC__
#define TAP_FORMAT(at, arguments) __attribute__((format(printf, at, arguments)))
#else
#define TAP_FORMAT(at, arguments)
#endif

static int tap_count, tap_failures;

/* ok(int condition, const char *format, ...): one claim. Returns whether it holds. */
#define ok(...) tap_ok(__FILE__, __LINE__, __VA_ARGS__)

static inline bool tap_ok(const char *file, int line, int condition, const char *format, ...)
    TAP_FORMAT(4, 5);
static inline void note(const char *format, ...) TAP_FORMAT(1, 2);

static inline bool tap_ok(const char *file, int line, int condition, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    printf("%s %d - ", condition ? "ok" : "not ok", ++tap_count);
    vprintf(format, arguments);
    va_end(arguments);
    putchar('\n');
    if (!condition) {
        tap_failures++;
        printf("# %s:%d\n", file, line);
    }
    fflush(stdout); /* so that nothing is lost if the next check crashes */
    return condition != 0;
}

/* A line for the reader. */
static inline void note(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("# ", stdout);
    vprintf(format, arguments);
    va_end(arguments);
    putchar('\n');
}

/* Prints the plan; returns the exit status. */
static inline int done_testing(void)
{
    printf("1..%d\n", tap_count);
    if (tap_failures > 0)
        note("%d of %d failed", tap_failures, tap_count);
    return tap_failures > 0;
}

/* 64 random bits; any `state` will do as a seed. (Splitmix64: Steele, Lea, Flood, "Fast splittable
 * pseudorandom number generators", 2014.) */
static inline uint64_t random_bits(uint64_t *state)
{
    uint64_t bits = *state += 0x9e3779b97f4a7c15;
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9;
    bits = (bits ^ bits >> 27) * 0x94d049bb133111eb;
    return bits ^ bits >> 31;
}

/* How often to repeat a random check: `count` times, times the environment variable TEST_EFFORT, at least
 * once. */
static inline long test_effort(long count)
{
    const char *effort = getenv("TEST_EFFORT");
    double repetitions = (double)count * (effort ? atof(effort) : 1);
    return repetitions > 1 ? (long)repetitions : 1;
}

#endif
