#include "rational.h"

#include <math.h>

#include "numeric/field.h"
#include "numeric/tolerance.h"

/* ---- Checked integers ---------------------------------------------------------------------------------- */

static uint64_t magnitude(int64_t a)
{
    return a < 0 ? 0 - (uint64_t)a : (uint64_t)a;
}

static uint64_t greatest_divisor(uint64_t a, uint64_t b)
{
    while (b != 0) {
        uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

static bool checked_multiply(int64_t a, int64_t b, int64_t *product)
{
    uint64_t x = magnitude(a), y = magnitude(b);
    if (x != 0 && y > (uint64_t)INT64_MAX / x)
        return false;
    int64_t size = (int64_t)(x * y);
    *product = (a < 0) != (b < 0) ? -size : size;
    return true;
}

/* INT64_MIN does not count as an integer here: it has no negative. */
static bool checked_add(int64_t a, int64_t b, int64_t *sum)
{
    if ((b > 0 && a > INT64_MAX - b) || (b < 0 && a < -INT64_MAX - b))
        return false;
    *sum = a + b;
    return true;
}

/* ---- Fractions ----------------------------------------------------------------------------------------- */

struct rational rational_from_integer(int64_t integer)
{
    return (struct rational){integer, 1};
}

bool rational_make(int64_t numerator, int64_t denominator, struct rational *result)
{
    if (denominator == 0)
        return false;
    uint64_t n = magnitude(numerator), d = magnitude(denominator);
    uint64_t divisor = greatest_divisor(n, d);
    n /= divisor;
    d /= divisor;
    if (n > INT64_MAX || d > INT64_MAX)
        return false;
    bool negative = (numerator < 0) != (denominator < 0);
    *result = (struct rational){negative ? -(int64_t)n : (int64_t)n, (int64_t)d};
    return true;
}

/* With g = gcd(b, d): a/b + c/d = (a (d/g) + c (b/g)) / (b (d/g)). The sum and g may still have a common
 * divisor, which is taken out before the denominator is multiplied (Knuth, The Art of Computer Programming
 * 2, 4.5.1), so that the denominator overflows only when the result's does. */
bool rational_add(struct rational a, struct rational b, struct rational *result)
{
    int64_t common = (int64_t)greatest_divisor((uint64_t)a.denominator, (uint64_t)b.denominator);
    int64_t left, right, sum, denominator;
    if (!checked_multiply(a.numerator, b.denominator / common, &left) ||
        !checked_multiply(b.numerator, a.denominator / common, &right) || !checked_add(left, right, &sum))
        return false;
    int64_t shared = (int64_t)greatest_divisor(magnitude(sum), (uint64_t)common);
    if (!checked_multiply(a.denominator / common, b.denominator / shared, &denominator))
        return false;
    return rational_make(sum / shared, denominator, result);
}

bool rational_subtract(struct rational a, struct rational b, struct rational *result)
{
    return rational_add(a, rational_negate(b), result);
}

/* Crosswise divisors come out first, so that nothing overflows but the result itself. */
bool rational_multiply(struct rational a, struct rational b, struct rational *result)
{
    int64_t first = (int64_t)greatest_divisor(magnitude(a.numerator), (uint64_t)b.denominator);
    int64_t second = (int64_t)greatest_divisor(magnitude(b.numerator), (uint64_t)a.denominator);
    int64_t numerator, denominator;
    if (!checked_multiply(a.numerator / first, b.numerator / second, &numerator) ||
        !checked_multiply(a.denominator / second, b.denominator / first, &denominator))
        return false;
    *result = (struct rational){numerator, numerator == 0 ? 1 : denominator};
    return true;
}

bool rational_divide(struct rational a, struct rational b, struct rational *result)
{
    struct rational inverse;
    return rational_make(b.denominator, b.numerator, &inverse) && rational_multiply(a, inverse, result);
}

struct rational rational_negate(struct rational a)
{
    a.numerator = -a.numerator;
    return a;
}

bool rational_is_zero(struct rational a)
{
    return a.numerator == 0;
}

bool rational_equal(struct rational a, struct rational b)
{
    return a.numerator == b.numerator && a.denominator == b.denominator;
}

double rational_real(struct rational a)
{
    return (double)a.numerator / (double)a.denominator;
}

uint64_t rational_residue(struct rational a)
{
    return field_multiply(field_from_integer(a.numerator), field_invert(field_from_integer(a.denominator)));
}

static size_t print_integer(char *out, uint64_t integer)
{
    char digits[20];
    size_t count = 0;
    do
        digits[count++] = (char)('0' + integer % 10);
    while ((integer /= 10) != 0);
    for (size_t i = 0; i < count; i++)
        out[i] = digits[count - 1 - i];
    return count;
}

size_t rational_print(char *out, struct rational a)
{
    size_t length = 0;
    if (a.numerator < 0)
        out[length++] = '-';
    length += print_integer(out + length, magnitude(a.numerator));
    if (a.denominator != 1) {
        out[length++] = '/';
        length += print_integer(out + length, (uint64_t)a.denominator);
    }
    return length;
}

/* ---- Reconstruction ------------------------------------------------------------------------------------ */

static bool agrees(struct rational a, uint64_t residue, double real)
{
    double found = rational_real(a);
    return rational_residue(a) == residue &&
           fabs(found - real) <= TOLERANCE_EQUATION * fmax(fabs(found), fabs(real));
}

/* A decimal n/10^k with |n| < 2^53: the field tells exactly whether it is one. */
static bool reconstruct_decimal(uint64_t residue, double real, struct rational *result)
{
    int64_t power = 1;
    for (int k = 0; k <= 18; k++, power *= 10) {
        double scaled = real * (double)power;
        if (!(fabs(scaled) < 9007199254740992.0))
            return false;
        int64_t n = (int64_t)floor(scaled + 0.5);
        if (field_from_integer(n) == field_multiply(residue, field_from_integer(power)) &&
            rational_make(n, power, result) && agrees(*result, residue, real))
            return true;
        if (k == 18)
            break; /* 10^19 is no int64_t */
    }
    return false;
}

/* The remainders r_i = s_i p + t_i residue of Euclid's algorithm satisfy r_i/t_i = residue in the field, and
 * every n/d with |n| d < p/2 is among them (Wang, 1981; von zur Gathen and Gerhard, Modern Computer
 * Algebra, 5.10). Which one is meant, the double decides. */
bool rational_reconstruct(uint64_t residue, double real, struct rational *result)
{
    uint64_t r0 = FIELD_PRIME, r1 = residue, t0 = 0, t1 = 1;
    bool negative = false; /* the sign of t1: it alternates */
    if (residue == 0) {
        *result = rational_from_integer(0);
        return fabs(real) <= TOLERANCE_EQUATION;
    }
    while (r1 != 0 && t1 < FIELD_PRIME / 2) {
        struct rational candidate;
        int64_t numerator = negative ? -(int64_t)r1 : (int64_t)r1;
        if (r1 <= (FIELD_PRIME / 2) / t1 && rational_make(numerator, (int64_t)t1, &candidate) &&
            agrees(candidate, residue, real)) {
            *result = candidate;
            return true;
        }
        uint64_t quotient = r0 / r1, rest = r0 % r1, next = t0 + quotient * t1; /* |t| stays at most p */
        r0 = r1;
        r1 = rest;
        t0 = t1;
        t1 = next;
        negative = !negative;
    }
    return reconstruct_decimal(residue, real, result);
}
