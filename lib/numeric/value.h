/* Value: a number of the language, known in two ways at once.
 *
 * `real` is the number in doubles. `residue` is its image in the prime field (numeric/field.h), where a parameter
 * or argument that is meant to be free was replaced by a random element: that is how equations are proved
 * (design, "Exactness"). A value that passed through a root or a transcendental function, or came from a decimal
 * of 15 or more digits, has no image: `exact` is false and only `real` counts. `fixed` says that the residue is
 * the image of this very number, not of a random stand-in; functions that are not field operations (min, %, …)
 * keep exactness only then. */
#ifndef NUMERIC_VALUE_H
#define NUMERIC_VALUE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/text.h"

struct value {
    double real;
    uint64_t residue;
    bool exact, fixed;
};

struct value value_from_integer(int64_t integer);
/* A number that is known in doubles only. */
struct value value_from_real(double real);
struct value value_add(struct value a, struct value b);
struct value value_subtract(struct value a, struct value b);
struct value value_multiply(struct value a, struct value b);
/* Whether two values are the same number: in the field when both are exact, otherwise to 1e-12 relative. */
bool value_equal(struct value a, struct value b);
struct value value_negate(struct value a);
/* a/b. The real part is not finite when b's is 0; the residue is 0 when b's is. The caller decides what that means. */
struct value value_divide(struct value a, struct value b);
/* Whether a value is zero: by its residue when it is exact. */
bool value_is_zero(struct value a);
/* Appends a value as the language reads it: "3/4" where it is a number known exactly, otherwise the shortest decimal
 * that reads back as its real part. */
void value_write(struct text *text, struct value value);
/* The double nearest to an exact value, as far as the field tells; sets value->real. Returns a bound of its
 * error. */
double value_pin(struct value *value, double error);
/* base^exponent. */
struct value value_power(int64_t base, int exponent);

#endif
