#include "value.h"

#include <float.h>
#include <math.h>

#include "numeric/field.h"
#include "numeric/rational.h"
#include "numeric/tolerance.h"

struct value value_from_integer(int64_t integer)
{
    return (struct value){(double)integer, field_from_integer(integer), true, true};
}

struct value value_from_real(double real)
{
    return (struct value){real, 0, false, false};
}

/* The result of a field operation: as exact, and as fixed, as both operands. */
static struct value combine(struct value a, struct value b, double real, uint64_t residue)
{
    bool exact = a.exact && b.exact;
    return (struct value){real, exact ? residue : 0, exact, a.fixed && b.fixed};
}

struct value value_add(struct value a, struct value b)
{
    return combine(a, b, a.real + b.real, field_add(a.residue, b.residue));
}

struct value value_subtract(struct value a, struct value b)
{
    return combine(a, b, a.real - b.real, field_subtract(a.residue, b.residue));
}

struct value value_multiply(struct value a, struct value b)
{
    return combine(a, b, a.real * b.real, field_multiply(a.residue, b.residue));
}

struct value value_negate(struct value a)
{
    a.real = 0 - a.real; /* not -a.real: a zero keeps its plus sign */
    a.residue = a.exact ? field_subtract(0, a.residue) : 0;
    return a;
}

struct value value_divide(struct value a, struct value b)
{
    return combine(a, b, a.real / b.real, field_multiply(a.residue, field_invert(b.residue)));
}

bool value_is_zero(struct value a)
{
    return a.exact ? a.residue == 0 : a.real == 0;
}

bool value_equal(struct value a, struct value b)
{
    if (a.exact && b.exact)
        return a.residue == b.residue;
    return fabs(a.real - b.real) <= TOLERANCE_EQUATION * fmax(fabs(a.real), fabs(b.real));
}

void value_write(struct text *text, struct value value)
{
    struct rational fraction;
    char digits[RATIONAL_LONGEST];
    if (value.exact && value.fixed && rational_reconstruct(value.residue, value.real, &fraction))
        text_append_bytes(text, digits, rational_print(digits, fraction));
    else
        text_append_number(text, value.real);
}

/* The image of a double, m·2^e; 2 has order 61. */
static uint64_t double_residue(double x)
{
    int exponent;
    double mantissa = frexp(x, &exponent);
    int shift = ((exponent - 53) % 61 + 61) % 61;
    return field_multiply(field_from_integer((int64_t)ldexp(mantissa, 53)), UINT64_C(1) << shift);
}

double value_pin(struct value *value, double error)
{
    struct rational rational;
    if (!value->exact || !value->fixed)
        return error;
    if (value->residue == 0) {
        value->real = 0;
        return 0;
    }
    if (double_residue(value->real) == value->residue)
        return 0;
    if (!rational_reconstruct(value->residue, value->real, &rational))
        return error;
    value->real = rational_real(rational);
    double n = (double)rational.numerator, d = (double)rational.denominator;
    bool small = fabs(n) < 0x1p53 && d < 0x1p53; /* n, d and their quotient are then rounded once at most */
    if (small && fma(value->real, d, -n) == 0)
        return 0;
    return 2 * DBL_EPSILON * fabs(value->real);
}

struct value value_power(int64_t base, int exponent)
{
    struct value result = value_from_integer(1);
    for (int k = 0; k < exponent; k++)
        result = value_multiply(result, value_from_integer(base));
    return result;
}
