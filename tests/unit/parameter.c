/* Parameters: digits of a fraction in changing bases, against long multiplication by hand. */
#include <float.h>
#include <math.h>

#include "evaluate/parameter.h"
#include "tap.h"

enum { LIMBS = 8 }; /* of 16 bits */

/* A non-negative integer, the least significant limb first. */
struct big {
    uint32_t limbs[LIMBS];
};

static struct big big_from(uint64_t number)
{
    struct big big = {{0}};
    for (int i = 0; i < 4; i++)
        big.limbs[i] = number >> 16 * i & 0xffff;
    return big;
}

/* big · factor, factor below 2^31. */
static struct big big_multiply(struct big big, uint32_t factor)
{
    uint64_t carry = 0;
    for (int i = 0; i < LIMBS; i++) {
        carry += (uint64_t)big.limbs[i] * factor;
        big.limbs[i] = carry & 0xffff;
        carry >>= 16;
    }
    return big;
}

/* The bits from `low` to `low` + 63. */
static uint64_t big_bits(struct big big, int low)
{
    uint64_t bits = 0;
    for (int i = 63; i >= 0; i--) {
        int bit = low + i;
        bits = bits << 1 | (bit < 16 * LIMBS ? big.limbs[bit / 16] >> bit % 16 & 1 : 0);
    }
    return bits;
}

static void test_digits(void)
{
    uint64_t seed = 1;
    bool good = true;
    for (long round = 0; round < test_effort(20000); round++) {
        uint64_t fraction = random_bits(&seed) >> 2, start = fraction;
        /* Ends of the range too. */
        if (round % 50 == 0)
            fraction = start = PARAMETER_ONE - 1 - (uint64_t)(round % 7);
        if (round % 50 == 1)
            fraction = start = (uint64_t)(round % 7);
        for (int level = 0; level < 8; level++) {
            int bits = 1 + (int)(random_bits(&seed) % 31);
            uint32_t count = (uint32_t)(random_bits(&seed) >> (64 - bits)) | 1;
            if (round % 3 == 0)
                count = 0x7fffffff;
            struct big product = big_multiply(big_from(fraction), count);
            uint64_t digit = big_bits(product, 62), rest = big_bits(product, 0) & (PARAMETER_ONE - 1);
            size_t found = parameter_digit(&fraction, count);
            if (found != digit || fraction != rest) {
                note("start %llu, level %d, base %u: digit %zu, expected %llu", (unsigned long long)start, level,
                     (unsigned)count, found, (unsigned long long)digit);
                good = false;
            }
            fraction = rest;
        }
    }
    ok(good, "digits and rests are the high and low part of the product");
}

/* Digits of a dyadic fraction in base 2 are its bits, and nothing is left after them. */
static void test_dyadic(void)
{
    uint64_t seed = 2;
    bool good = true;
    for (long round = 0; round < test_effort(2000); round++) {
        int depth = 1 + (int)(random_bits(&seed) % 52);
        uint64_t index = random_bits(&seed) >> (64 - depth), read = 0;
        uint64_t fraction = parameter_from_double(ldexp((double)index, -depth));
        for (int level = 0; level < depth; level++)
            read = read << 1 | parameter_digit(&fraction, 2);
        good = good && read == index && fraction == 0;
    }
    ok(good, "k/2^n has the bits of k for digits, and no more");
    /* 1/3 in a double lies below 1/3 by 2^-54/3, so the digits are 01 repeated, to bit 54 at least. */
    uint64_t fraction = parameter_from_double(1.0 / 3);
    for (int level = 0; level < 54; level++)
        good = good && parameter_digit(&fraction, 2) == (size_t)(level % 2);
    ok(good, "1/3 is 0.010101…");
}

static void test_doubles(void)
{
    ok(parameter_from_double(0) == 0 && parameter_from_double(1) == PARAMETER_ONE, "0 and 1");
    ok(parameter_from_double(0.5) == PARAMETER_ONE / 2 && parameter_from_double(ldexp(1, -62)) == 1, "powers of two");
    ok(parameter_from_double(1 - DBL_EPSILON / 2) == PARAMETER_ONE - (1 << 9), "the largest below 1");
    ok(parameter_from_double(1e-300) == 0 && parameter_from_double(DBL_TRUE_MIN) == 0, "what is too small is 0");
    uint64_t one = PARAMETER_ONE;
    ok(parameter_digit(&one, 7) == 7 && one == 0, "1 is one past the last digit");
}

int main(void)
{
    test_digits();
    test_dyadic();
    test_doubles();
    return done_testing();
}
