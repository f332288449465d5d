/* The prime field against its definition: the same results by slower ways. */
#include "numeric/field.h"

#include "tap.h"

static uint64_t seed = 1;

static uint64_t any_element(void)
{
    static const uint64_t corners[] = {0,
                                       1,
                                       2,
                                       FIELD_PRIME - 1,
                                       FIELD_PRIME - 2,
                                       FIELD_PRIME / 2,
                                       UINT64_C(1) << 31,
                                       UINT64_C(1) << 32,
                                       UINT64_C(0xffffffff)};
    uint64_t bits = random_bits(&seed);
    if (bits % 4 == 0)
        return corners[bits / 4 % (sizeof corners / sizeof corners[0])];
    return bits % FIELD_PRIME;
}

/* a·b by doubling and adding; 2·FIELD_PRIME fits in 64 bits. */
static uint64_t slow_product(uint64_t a, uint64_t b)
{
    uint64_t product = 0;
    for (; b > 0; b >>= 1) {
        if (b & 1)
            product = (product + a) % FIELD_PRIME;
        a = (a + a) % FIELD_PRIME;
    }
    return product;
}

static void test_against_definition(void)
{
    bool sums = true, differences = true, products = true;
    for (long i = 0; i < test_effort(20000); i++) {
        uint64_t a = any_element(), b = any_element();
        bool sum = field_add(a, b) == (a + b) % FIELD_PRIME;
        bool difference = field_subtract(a, b) == (a + FIELD_PRIME - b) % FIELD_PRIME;
        bool product = field_multiply(a, b) == slow_product(a, b);
        if (!sum || !difference || !product)
            note("a = %llu, b = %llu", (unsigned long long)a, (unsigned long long)b);
        sums &= sum;
        differences &= difference;
        products &= product;
    }
    ok(sums, "a + b");
    ok(differences, "a - b");
    ok(products, "a b");
}

static void test_laws(void)
{
    bool inverses = true, powers = true, distributive = true;
    for (long i = 0; i < test_effort(500); i++) {
        uint64_t a = any_element(), b = any_element(), c = any_element();
        uint64_t m = random_bits(&seed) % 1000, n = random_bits(&seed);
        inverses &= field_multiply(a, field_invert(a)) == (a != 0);
        distributive &=
            field_multiply(a, field_add(b, c)) == field_add(field_multiply(a, b), field_multiply(a, c));
        n >>= 1; /* m + n must not overflow */
        powers &= field_power(a, m + n) == field_multiply(field_power(a, m), field_power(a, n));
    }
    ok(inverses, "a (1/a) = 1, and 1/0 is given as 0");
    ok(distributive, "a (b + c) = a b + a c");
    ok(powers, "a^(m+n) = a^m a^n");
    ok(field_power(0, 0) == 1 && field_power(7, 0) == 1 && field_power(7, 1) == 7, "small exponents");
    ok(field_power(3, FIELD_PRIME - 1) == 1, "Fermat's little theorem");
}

static void test_integers(void)
{
    ok(field_from_integer(0) == 0 && field_from_integer(5) == 5, "small integers are themselves");
    ok(field_from_integer(-1) == FIELD_PRIME - 1, "-1");
    ok(field_from_integer((int64_t)FIELD_PRIME) == 0, "the prime is 0");
    ok(field_from_integer(INT64_MAX) == 3, "2^63 - 1 = 3, because 2^61 = 1");
    ok(field_from_integer(INT64_MIN) == FIELD_PRIME - 4, "-2^63 = -4");
}

static void test_random(void)
{
    uint64_t state = 42, again = 42, other = 43, all = 0;
    bool in_range = true, repeats = true, differs = false;
    for (int i = 0; i < 1000; i++) {
        uint64_t a = field_random(&state);
        all |= a;
        in_range &= a > 0 && a < FIELD_PRIME;
        repeats &= a == field_random(&again);
        differs |= a != field_random(&other);
    }
    ok(in_range, "random elements lie strictly between 0 and the prime");
    ok(repeats, "the same state gives the same sequence");
    ok(differs, "another state gives another");
    ok(all == FIELD_PRIME, "every bit is used");
}

int main(void)
{
    test_against_definition();
    test_laws();
    test_integers();
    test_random();
    return done_testing();
}
