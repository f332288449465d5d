/* Rational: fractions of 64-bit integers, exact or refused.
 *
 * A fraction is kept in lowest terms, its denominator positive, both of at most 2^63 - 1 in size. An
 * operation whose result does not fit says so; nothing is ever rounded. There is no 128-bit type behind it.
 */
#ifndef NUMERIC_RATIONAL_H
#define NUMERIC_RATIONAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct rational {
    int64_t numerator, denominator;
};

enum { RATIONAL_LONGEST = 40 }; /* bytes that any fraction takes in print: a sign, 19 digits twice, a slash */

struct rational rational_from_integer(int64_t integer); /* not INT64_MIN */
/* numerator/denominator in lowest terms. False when the denominator is 0 or the fraction does not fit. */
bool rational_make(int64_t numerator, int64_t denominator, struct rational *result);
/* a + b, a - b, a·b, a/b; `result` may be one of the operands. False, `result` untouched, when the result (of
 * a sum: or a product on the way to it) does not fit, or b is 0 in a division. */
bool rational_add(struct rational a, struct rational b, struct rational *result);
bool rational_subtract(struct rational a, struct rational b, struct rational *result);
bool rational_multiply(struct rational a, struct rational b, struct rational *result);
bool rational_divide(struct rational a, struct rational b, struct rational *result);
struct rational rational_negate(struct rational a);
bool rational_is_zero(struct rational a);
bool rational_equal(struct rational a, struct rational b);
/* The nearest double, to two roundings. */
double rational_real(struct rational a);
/* The image in the prime field (numeric/field.h); the denominator is no multiple of the prime 2^61 - 1, or
 * the image is 0. */
uint64_t rational_residue(struct rational a);
/* Writes "3/4", "-1/2" or "2", as the language reads them, without a NUL; returns the length. */
size_t rational_print(char *out, struct rational a);

/* The fraction with this image in the prime field and this value in doubles (to TOLERANCE_EQUATION). Found
 * when |numerator|·denominator < 2^60 (rational reconstruction by the extended Euclidean algorithm), or when
 * it is a decimal of at most 15 digits. False: there is none of these kinds. */
bool rational_reconstruct(uint64_t residue, double real, struct rational *result);

#endif
