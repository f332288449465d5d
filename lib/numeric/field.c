/* Arithmetic modulo 2^61 - 1 in 64-bit words, without a 128-bit type: 2^61 = 1 in the field, so a number is
 * reduced by adding its high bits to its low 61. */
#include "numeric/field.h"

/* The representative below FIELD_PRIME of any 64-bit number. */
static uint64_t reduce(uint64_t a)
{
    a = (a & FIELD_PRIME) + (a >> 61);
    return a >= FIELD_PRIME ? a - FIELD_PRIME : a;
}

uint64_t field_add(uint64_t a, uint64_t b)
{
    return reduce(a + b);
}

uint64_t field_subtract(uint64_t a, uint64_t b)
{
    return reduce(a + (FIELD_PRIME - b));
}

/* a·b = high·2^64 + low = (8·high + low div 2^61) + (low mod 2^61) in the field. */
uint64_t field_multiply(uint64_t a, uint64_t b)
{
    const uint64_t half = UINT64_C(0xffffffff);
    uint64_t a0 = a & half, a1 = a >> 32, b0 = b & half, b1 = b >> 32;
    uint64_t low_product = a0 * b0;
    /* a1, b1 < 2^29, so the middle sum does not overflow. */
    uint64_t middle = a1 * b0 + a0 * b1 + (low_product >> 32);
    uint64_t high = a1 * b1 + (middle >> 32);
    uint64_t low = (middle << 32) | (low_product & half);
    return reduce((high << 3 | low >> 61) + (low & FIELD_PRIME));
}

uint64_t field_power(uint64_t a, uint64_t exponent)
{
    uint64_t result = 1;
    for (; exponent > 0; exponent >>= 1) {
        if (exponent & 1)
            result = field_multiply(result, a);
        a = field_multiply(a, a);
    }
    return result;
}

/* Fermat: a^(p-2) = 1/a, and 0 for 0. */
uint64_t field_invert(uint64_t a)
{
    return field_power(a, FIELD_PRIME - 2);
}

uint64_t field_from_integer(int64_t integer)
{
    if (integer >= 0)
        return reduce((uint64_t)integer);
    return field_subtract(0, reduce(0 - (uint64_t)integer));
}

uint64_t field_random(uint64_t *state)
{
    uint64_t z;
    do {
        z = *state += UINT64_C(0x9e3779b97f4a7c15);
        z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
        z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
        z = (z ^ z >> 31) >> 3;
    } while (z == 0 || z == FIELD_PRIME);
    return z;
}
