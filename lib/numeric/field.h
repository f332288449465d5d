/* Field: the integers modulo the prime 2^61 - 1, in which equations are proved.
 *
 * A rational expression that is not identically zero vanishes at a random point with probability at most
 * degree / 2^61 (Schwartz-Zippel). Elements are uint64_t below FIELD_PRIME. */
#ifndef NUMERIC_FIELD_H
#define NUMERIC_FIELD_H

#include <stdint.h>

#define FIELD_PRIME ((UINT64_C(1) << 61) - 1)

uint64_t field_add(uint64_t a, uint64_t b);
uint64_t field_subtract(uint64_t a, uint64_t b);
uint64_t field_multiply(uint64_t a, uint64_t b);
uint64_t field_power(uint64_t a, uint64_t exponent);
/* 1/a, or 0 for a = 0. */
uint64_t field_invert(uint64_t a);
/* The image of any integer. */
uint64_t field_from_integer(int64_t integer);
/* The next element of a sequence that behaves as random (splitmix64); never 0. */
uint64_t field_random(uint64_t *state);

#endif
