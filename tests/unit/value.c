/* Values: both numbers of a value against exact fractions, and what keeps or loses exactness. */
#include <math.h>
#include <string.h>

#include "numeric/value.h"
#include "numeric/field.h"
#include "tap.h"

/* A fraction in lowest terms of small numbers. */
struct fraction {
    int64_t top, bottom; /* bottom > 0 */
};

static uint64_t seed = 1;

static int64_t common_divisor(int64_t a, int64_t b)
{
    while (b != 0) {
        int64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a < 0 ? -a : a;
}

static struct fraction fraction_of(int64_t top, int64_t bottom)
{
    int64_t divisor = common_divisor(top, bottom);
    if (bottom < 0)
        divisor = -divisor;
    return (struct fraction){top / divisor, bottom / divisor};
}

/* a·b mod p by doubling and adding, and 1/b by Euclid's algorithm: neither is how lib/numeric does it. */
static uint64_t product_modulo(uint64_t a, uint64_t b)
{
    uint64_t sum = 0;
    for (; b > 0; b >>= 1) {
        if (b & 1)
            sum = (sum + a) % FIELD_PRIME;
        a = a * 2 % FIELD_PRIME;
    }
    return sum;
}

static uint64_t inverse_modulo(uint64_t b)
{
    int64_t r0 = (int64_t)FIELD_PRIME, r1 = (int64_t)b, s0 = 0, s1 = 1;
    while (r1 != 0) {
        int64_t q = r0 / r1, r2 = r0 - q * r1, s2 = s0 - q * s1;
        r0 = r1, r1 = r2, s0 = s1, s1 = s2;
    }
    return s0 < 0 ? (uint64_t)(s0 + (int64_t)FIELD_PRIME) : (uint64_t)s0;
}

static uint64_t residue_of(struct fraction f)
{
    uint64_t top = f.top < 0 ? FIELD_PRIME - (uint64_t)-f.top : (uint64_t)f.top;
    return product_modulo(top % FIELD_PRIME, inverse_modulo((uint64_t)f.bottom));
}

static bool value_is(struct value value, struct fraction f)
{
    double expected = (double)f.top / (double)f.bottom;
    return value.exact && value.fixed && value.residue == residue_of(f) &&
           fabs(value.real - expected) <= 1e-13 * (1 + fabs(expected));
}

/* Random chains of field operations; numerators stay below 2^62 because they are reset in time. */
static void test_chains(void)
{
    bool good = true;
    for (long round = 0; round < test_effort(20000) && good; round++) {
        struct fraction f = {1, 1};
        struct value value = value_from_integer(1);
        for (int step = 0; step < 5; step++) {
            int64_t top = (int64_t)(random_bits(&seed) % 61) - 30, bottom = (int64_t)(random_bits(&seed) % 30) + 1;
            struct fraction g = fraction_of(top, bottom);
            struct value other = value_divide(value_from_integer(top), value_from_integer(bottom));
            switch (random_bits(&seed) % 4) {
            case 0:
                f = fraction_of(f.top * g.bottom + g.top * f.bottom, f.bottom * g.bottom);
                value = value_add(value, other);
                break;
            case 1:
                f = fraction_of(f.top * g.bottom - g.top * f.bottom, f.bottom * g.bottom);
                value = value_subtract(value, other);
                break;
            case 2:
                f = fraction_of(f.top * g.top, f.bottom * g.bottom);
                value = value_multiply(value, other);
                break;
            default:
                if (top == 0)
                    continue;
                f = fraction_of(f.top * g.bottom, f.bottom * g.top);
                value = value_divide(value, other);
                break;
            }
            good = good && value_is(value, f) && value_is(value_negate(value), (struct fraction){-f.top, f.bottom});
            good = good && value_is_zero(value) == (f.top == 0);
            good = good && value_equal(value, value_divide(value_from_integer(f.top), value_from_integer(f.bottom)));
            if (!good) {
                note("round %ld, step %d: %lld/%lld, real %.17g, residue %llu", round, step, (long long)f.top,
                     (long long)f.bottom, value.real, (unsigned long long)value.residue);
                break;
            }
        }
    }
    ok(good, "both numbers of a value are the fraction");
}

static void test_zero(void)
{
    struct value tenth = value_divide(value_from_integer(1), value_from_integer(10));
    struct value fifth = value_divide(value_from_integer(1), value_from_integer(5));
    struct value three = value_divide(value_from_integer(3), value_from_integer(10));
    struct value sum = value_add(tenth, fifth);
    ok(sum.real != three.real && value_equal(sum, three), "1/10 + 1/5 = 3/10, whatever doubles say");
    ok(value_is_zero(value_subtract(sum, three)) && value_subtract(sum, three).real != 0, "and their difference is zero");
    ok(!signbit(value_negate(value_from_integer(0)).real), "zero is not negative");
    ok(value_divide(value_from_integer(1), value_from_integer(0)).residue == 0 &&
           !isfinite(value_divide(value_from_integer(1), value_from_integer(0)).real),
       "a division by zero shows in the real");
}

static void test_inexact(void)
{
    struct value root = value_from_real(sqrt(2)), two = value_from_integer(2);
    struct value mixed[] = {value_add(root, two), value_subtract(two, root), value_multiply(root, two),
                            value_divide(two, root), value_negate(root)};
    double expected[] = {sqrt(2) + 2, 2 - sqrt(2), sqrt(2) * 2, 2 / sqrt(2), -sqrt(2)};
    bool good = true;
    for (int i = 0; i < 5; i++)
        good = good && !mixed[i].exact && !mixed[i].fixed && mixed[i].residue == 0 && mixed[i].real == expected[i];
    ok(good, "what a root touches is known in doubles only");
    ok(value_equal(value_multiply(root, root), two), "and equal to 1e-12");
    ok(!value_equal(value_from_real(1), value_from_real(1 + 1e-11)) &&
           value_equal(value_from_real(1), value_from_real(1 + 1e-13)),
       "no more and no less");
    ok(value_equal(value_from_real(0), value_from_integer(0)) && !value_equal(value_from_real(1e-300), value_from_integer(0)),
       "relative to their size");
    /* A free parameter: exact, but its residue is not this number's. */
    struct value free = {0.5, 123456789, true, false};
    ok(value_add(free, two).exact && !value_add(free, two).fixed, "what a free parameter touches is not fixed");
    ok(value_is_zero(value_subtract(free, free)), "and cancels exactly");
}

int main(void)
{
    test_chains();
    test_zero();
    test_inexact();
    return done_testing();
}
