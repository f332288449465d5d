/* Parameter: exact arithmetic on a parameter 0 <= t < 1 as a figure is walked down.
 *
 * Each of N children takes an equal share, so digits of t in changing bases are wanted. A fraction is a multiple
 * of 2^-62; multiplying by N and splitting off the integer part loses nothing. */
#ifndef EVALUATE_PARAMETER_H
#define EVALUATE_PARAMETER_H

#include <stddef.h>
#include <stdint.h>

#define PARAMETER_ONE (UINT64_C(1) << 62)

/* t in 0..1 as a multiple of 2^-62. */
uint64_t parameter_from_double(double t);
/* The integer part of fraction · count (count below 2^31); `fraction` becomes the rest. */
size_t parameter_digit(uint64_t *fraction, size_t count);

#endif
