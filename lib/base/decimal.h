/* Decimal: numbers to text and back, exactly and the same in every locale.
 *
 * Printing gives the shortest decimal that reads back as the same double (Raffaello Giulietti, "The Schubfach
 * way to render doubles", 2020); reading is correctly rounded. All rounding is to nearest, ties to even,
 * computed in integers, so results are the same on every machine. Nothing is allocated and there is no state:
 * calls may run in parallel. */
#ifndef BASE_DECIMAL_H
#define BASE_DECIMAL_H

#include <stdbool.h>
#include <stddef.h>

enum {
    DECIMAL_LONGEST = 32 /* bytes that `out` must have: any result, without a NUL, and room to work in */
};

/* Writes the shortest decimal of a finite `number` that reads back exactly (of several shortest the one
 * closest to it) and returns its length; no NUL is written. Layout as JSON and people like it: "0", "-0",
 * "1", "0.25", "-12.5", "1e+300" is written "1e300", small ones "1.5e-7"; plain notation for
 * 1e-5 <= |number| < 1e21. */
size_t decimal_print(char *out, double number);

/* The same with at most `digits` (1 to 17) significant digits, correctly rounded, without trailing zeros. */
size_t decimal_print_digits(char *out, double number, int digits);

/* Writes `number` rounded to `decimals` (0 to 9) places, trailing zeros and a trailing point dropped, "-0"
 * written "0"; for pictures, whose coordinates are small: below 1e9, beyond which it is written like
 * decimal_print() does. Returns the length. */
size_t decimal_print_fixed(char *out, double number, int decimals);

/* Reads all of `length` bytes as [-+]digits[.digits][e[-+]digits] (at least one digit before or after the
 * point; E is as good as e), correctly rounded. False, and `number` untouched, when the bytes are not such a
 * number or the value overflows to infinity; underflow gives a subnormal or zero. No NaN, no "inf", no
 * hexadecimal, no blanks. */
bool decimal_parse(const char *text, size_t length, double *number);

#endif
