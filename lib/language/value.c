#include "value.h"

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
