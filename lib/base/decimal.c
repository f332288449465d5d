#include "decimal.h"

#include <stdint.h>
#include <string.h>

/* A double is significand · 2^exponent; its bits are a sign, 11 bits of exponent, 52 of fraction. */
enum { FRACTION_BITS = 52, SMALLEST_EXPONENT = -1074, LARGEST_EXPONENT = 971 };
static const uint64_t SIGN = (uint64_t)1 << 63;
static const uint64_t HIDDEN_BIT = (uint64_t)1 << FRACTION_BITS;
static const uint64_t INFINITY_BITS = (uint64_t)0x7ff << FRACTION_BITS;

/* Digits times a power of ten. */
struct decimal {
    uint64_t digits;
    int exponent;
};

/* Significand times a power of two. */
struct binary {
    uint64_t significand;
    int exponent;
};

/* A 128-bit integer. */
struct wide {
    uint64_t high, low;
};

#include "powers_of_ten.inc"

static const uint64_t SMALL_POWERS_OF_TEN[] = {
    1,
    10,
    100,
    1000,
    10000,
    100000,
    1000000,
    10000000,
    100000000,
    1000000000,
    10000000000,
    100000000000,
    1000000000000,
    10000000000000,
    100000000000000,
    1000000000000000,
    10000000000000000,
    100000000000000000,
    1000000000000000000,
    10000000000000000000u,
};

static uint64_t bits_of(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static double double_of(uint64_t bits)
{
    double number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

/* The sign is ignored. */
static struct binary decode(uint64_t bits)
{
    uint64_t fraction = bits & (HIDDEN_BIT - 1);
    int biased = (int)(bits >> FRACTION_BITS & 0x7ff);
    if (biased == 0)
        return (struct binary){fraction, SMALLEST_EXPONENT};
    return (struct binary){fraction | HIDDEN_BIT, biased - 1 + SMALLEST_EXPONENT};
}

/* Of a positive value. */
static int leading_zeros(uint64_t value)
{
#ifdef __GNUC__
    return __builtin_clzll(value);
#else
    int zeros = 0;
    for (int step = 32; step > 0; step /= 2) {
        if (value >> (64 - step) == 0) {
            value <<= step;
            zeros += step;
        }
    }
    return zeros;
#endif
}

static struct wide multiply(uint64_t a, uint64_t b)
{
#ifdef __SIZEOF_INT128__
    __extension__ typedef unsigned __int128 uint128;
    uint128 product = (uint128)a * b;
    return (struct wide){(uint64_t)(product >> 64), (uint64_t)product};
#else
    uint64_t a1 = a >> 32, a0 = (uint32_t)a, b1 = b >> 32, b0 = (uint32_t)b;
    uint64_t low = a0 * b0, middle = a1 * b0 + (low >> 32), other = a0 * b1 + (uint32_t)middle;
    return (struct wide){a1 * b1 + (middle >> 32) + (other >> 32), other << 32 | (uint32_t)low};
#endif
}

/* The upper 128 of the 192 bits of a · b. */
static struct wide multiply_wide(struct wide a, uint64_t b)
{
    struct wide upper = multiply(a.high, b), lower = multiply(a.low, b);
    upper.low += lower.high;
    upper.high += upper.low < lower.high;
    return upper;
}

/* value / 2^count, rounded to nearest, ties to even. With count >= 2 the lowest bit of `value` may stand for
 * any amount of lower bits. `value` is below 2^62, so beyond a count of 63 the result stays 0. */
static uint64_t shift_rounded(uint64_t value, int count)
{
    if (count > 63)
        count = 63;
    uint64_t half = (uint64_t)1 << (count - 1), quotient = value >> count, rest = value & (2 * half - 1);
    return quotient + (rest > half || (rest == half && (quotient & 1)));
}

/* floor(value / 2^count) */
static int shift_down(int value, int count)
{
    /* C leaves the right shift of a negative number to the compiler, so move the value up first. */
    return (int)(((uint32_t)value + 0x80000000u) >> count) - (int)(0x80000000u >> count);
}

/* floor(log2(10^k)); powers_of_ten.pl checks both logarithms in the ranges that occur. */
static int log2_of_power_of_ten(int k)
{
    return shift_down(k * 1741647, 19);
}

/* floor(log10(2^q)), or, when `narrow`, floor(log10(3/4 · 2^q)) */
static int log10_of_power_of_two(int q, bool narrow)
{
    return shift_down(q * 1262611 - (narrow ? 524031 : 0), 22);
}

/* 10^k = p · 2^(log2_of_power_of_ten(k) - 127), where p has 128 bits. The result is above p by less than 3:
 * the table rounds up by less than 1, which the normalization may double, and the last line makes up for the
 * bits that were dropped. powers_of_ten.pl checks that, and that the last line never carries. */
static struct wide power_of_ten(int k)
{
    unsigned index = (unsigned)(k - SMALLEST_POWER);
    struct wide base = POWERS_OF_TEN[index / STRIDE];
    uint64_t five = POWERS_OF_FIVE[index % STRIDE];
    struct wide upper = multiply(base.high, five), lower = multiply(base.low, five);
    upper.low += lower.high;
    upper.high += upper.low < lower.high;
    if (!(upper.high >> 63)) {
        upper.high = upper.high << 1 | upper.low >> 63;
        upper.low = upper.low << 1 | lower.low >> 63;
    }
    upper.low++;
    return upper;
}

/* An exact natural number, in base 10^9 because decimal digits go in on one side or come out on the other.
 * The largest numbers that occur are below 2^54 · 5^1098 in order_to_midpoint() and 2^53 · 5^1074 in
 * round_to_digits(): 784 and 767 digits. */
enum { LIMB_DIGITS = 9, LIMB_BASE = 1000000000, LIMBS = 88 };
struct natural {
    uint32_t limbs[LIMBS]; /* the least significant first */
    int count;             /* without leading zeros */
};

/* n = n · factor + summand */
static void natural_multiply_add(struct natural *n, uint32_t factor, uint64_t summand)
{
    uint64_t carry = summand;
    for (int i = 0; i < n->count; i++) {
        carry += (uint64_t)n->limbs[i] * factor;
        n->limbs[i] = (uint32_t)(carry % LIMB_BASE);
        carry /= LIMB_BASE;
    }
    for (; carry > 0; carry /= LIMB_BASE)
        n->limbs[n->count++] = (uint32_t)(carry % LIMB_BASE);
}

/* n = n · base^exponent, with base 2 or 5 */
static void natural_multiply_power(struct natural *n, uint32_t base, int exponent)
{
    /* The most factors at once that fit 32 bits. */
    const int most = base == 2 ? 31 : 13;
    while (exponent > 0) {
        uint32_t factor = 1;
        for (int i = 0; i < most && exponent > 0; i++, exponent--)
            factor *= base;
        natural_multiply_add(n, factor, 0);
    }
}

/* Negative, zero or positive as a is below, equal to or above b. */
static int natural_compare(const struct natural *a, const struct natural *b)
{
    if (a->count != b->count)
        return a->count - b->count;
    for (int i = a->count - 1; i >= 0; i--) {
        if (a->limbs[i] != b->limbs[i])
            return a->limbs[i] < b->limbs[i] ? -1 : 1;
    }
    return 0;
}

/* The digit of 10^place. */
static int natural_digit(const struct natural *n, int place)
{
    return (int)(n->limbs[place / LIMB_DIGITS] / SMALL_POWERS_OF_TEN[place % LIMB_DIGITS] % 10);
}

/* At least 1. */
static int count_digits(uint64_t value)
{
    value |= 1;                                              /* which makes no difference, except to 0 */
    int estimate = (64 - leading_zeros(value)) * 1233 >> 12; /* bits · log10(2): right or one too small */
    return estimate + (value >= SMALL_POWERS_OF_TEN[estimate]);
}

/* Printing: the shortest digits.
 *
 * Schubfach: Raffaello Giulietti, "The Schubfach way to render doubles", 2020. Let 10^k be the largest power
 * of ten not above the width of the interval of reals that are read as the number. Then the interval contains
 * a multiple of 10^k, and at most one of 10^(k+1); if there is that one it is the shortest, and otherwise one
 * of the two multiples of 10^k around the number is. */

/* The bounds are kept in units of 10^k / UNIT, rounded to odd: the lowest bit is set if bits were lost, so
 * that comparisons with multiples of UNIT / 2 come out as if they were exact. */
enum { UNIT = 64, UNIT_BITS = 6 };

/* n · 2^q · 10^-k · UNIT / 4, rounded to odd, from p = power_of_ten(-k) and n shifted to fit. The error of p
 * adds less than 3 in the middle word, and powers_of_ten.pl checks that an inexact product has at least 3
 * there. */
static uint64_t scale_to_odd(struct wide p, uint64_t n)
{
    struct wide product = multiply_wide(p, n);
    return product.high | (product.low > 2);
}

static struct decimal shortest(struct binary number)
{
    uint64_t c = number.significand;
    int q = number.exponent;
    /* Below a power of two the neighbor is half as far. */
    bool narrow = c == HIDDEN_BIT && q > SMALLEST_EXPONENT;
    int k = log10_of_power_of_two(q, narrow);
    int shift = q + log2_of_power_of_ten(-k) + UNIT_BITS - 1;
    struct wide p = power_of_ten(-k);
    /* Ties are read as the even number, so only that one owns the ends of its interval. */
    uint64_t odd = c & 1;
    uint64_t lower = scale_to_odd(p, (4 * c - 2 + narrow) << shift) + odd;
    uint64_t middle = scale_to_odd(p, (4 * c) << shift);
    uint64_t upper = scale_to_odd(p, (4 * c + 2) << shift) - odd;

    uint64_t fine = middle >> UNIT_BITS, coarse = fine / 10;
    bool below = lower <= 10 * UNIT * coarse, above = 10 * UNIT * (coarse + 1) <= upper;
    if (below != above)
        return (struct decimal){coarse + above, k + 1};
    below = lower <= UNIT * fine;
    above = UNIT * (fine + 1) <= upper;
    if (below != above)
        return (struct decimal){fine + above, k};
    uint64_t half = UNIT * fine + UNIT / 2;
    return (struct decimal){fine + (middle > half || (middle == half && (fine & 1))), k};
}

/* An integer below 2^53 is its own shortest decimal, and many numbers that people write are such. */
static bool is_integer(struct binary number)
{
    return number.exponent <= 0 && number.exponent >= -FRACTION_BITS &&
           (number.significand & (((uint64_t)1 << -number.exponent) - 1)) == 0;
}

static struct decimal find_digits(struct binary number)
{
    if (number.significand == 0)
        return (struct decimal){0, 0};
    if (is_integer(number))
        return (struct decimal){number.significand >> -number.exponent, 0};
    return shortest(number);
}

/* Printing: the layout. */

/* The 8 digits of value < 10^8, one in each byte, the first in the lowest byte. Halves, quarters and eighths
 * of the word are divided side by side; the factors stand for 1/100 and 1/10, and
 * are good enough for values below 10^4 and 10^2. */
static uint64_t eight_digits(uint32_t value)
{
    uint64_t pairs = (uint64_t)(value % 10000) << 32 | value / 10000;
    uint64_t hundreds = (pairs * 10486 >> 20) & 0x0000007f0000007f;
    pairs = (pairs - 100 * hundreds) << 16 | hundreds;
    uint64_t tens = (pairs * 103 >> 10) & 0x000f000f000f000f;
    return (pairs - 10 * tens) << 8 | tens;
}

/* Spelled out, not a loop: like this compilers make a single store of it, and it holds in any byte order. */
static void write_eight(char *out, uint64_t eight)
{
    eight += 0x3030303030303030; /* '0' in every byte */
    out[0] = (char)eight;
    out[1] = (char)(eight >> 8);
    out[2] = (char)(eight >> 16);
    out[3] = (char)(eight >> 24);
    out[4] = (char)(eight >> 32);
    out[5] = (char)(eight >> 40);
    out[6] = (char)(eight >> 48);
    out[7] = (char)(eight >> 56);
}

/* How many of the eight come before the trailing zeros. */
static int significant_digits(uint64_t eight)
{
    return eight == 0 ? 0 : 8 - leading_zeros(eight) / 8;
}

/* 1 to 17 digits, then zeros up to 17. */
struct digit_string {
    char first;
    uint64_t next, last; /* see eight_digits() */
    int count;           /* without trailing zeros, at least 1 */
};

static struct digit_string split_digits(uint64_t digits, int count)
{
    digits *= SMALL_POWERS_OF_TEN[17 - count];
    uint64_t upper = digits / 100000000;
    struct digit_string s = {.first = (char)('0' + upper / 100000000),
                             .next = eight_digits((uint32_t)(upper % 100000000)),
                             .last = eight_digits((uint32_t)(digits % 100000000))};
    s.count = s.last ? 9 + significant_digits(s.last) : 1 + significant_digits(s.next);
    return s;
}

/* Writes all 17; what is not wanted the caller overwrites or leaves behind the end. */
static void write_digits(char *out, const struct digit_string *s)
{
    out[0] = s->first;
    write_eight(out + 1, s->next);
    write_eight(out + 9, s->last);
}

static char *write_exponent(char *out, int exponent)
{
    *out++ = 'e';
    if (exponent < 0) {
        *out++ = '-';
        exponent = -exponent;
    }
    if (exponent >= 100)
        *out++ = (char)('0' + exponent / 100);
    if (exponent >= 10)
        *out++ = (char)('0' + exponent / 10 % 10);
    *out++ = (char)('0' + exponent % 10);
    return out;
}

/* Opens a place for the point behind the first `whole` digits, which stand one byte to the right. */
static void insert_point(char *out, int whole)
{
    for (int i = 0; i < whole; i++)
        out[i] = out[i + 1];
    out[whole] = '.';
}

/* Writes digits < 10^17 and returns the end; uses up to 24 bytes. */
static char *write_decimal(char *out, struct decimal number)
{
    int count = count_digits(number.digits), exponent = number.exponent + count - 1; /* of the first digit */
    struct digit_string s = split_digits(number.digits, count);
    if (exponent < -5 || exponent > 20) {
        write_digits(out + 1, &s);
        insert_point(out, 1);
        return write_exponent(out + (s.count == 1 ? 1 : s.count + 1), exponent);
    }
    if (exponent < 0) {
        memcpy(out, "0.0000", 6);
        write_digits(out + 1 - exponent, &s);
        return out + 1 - exponent + s.count;
    }
    if (s.count <= exponent + 1) {
        write_digits(out, &s);
        memcpy(out + 17, "0000", 4);
        return out + exponent + 1;
    }
    write_digits(out + 1, &s);
    insert_point(out, exponent + 1);
    return out + 1 + s.count;
}

/* No branch: half of the numbers may be negative, and then it would often be mispredicted. */
static char *write_sign(char *out, uint64_t bits)
{
    *out = '-';
    return out + (bits >> 63);
}

size_t decimal_print(char *out, double number)
{
    uint64_t bits = bits_of(number);
    char *end = write_decimal(write_sign(out, bits), find_digits(decode(bits)));
    return (size_t)(end - out);
}

/* Whether the digits below 10^place are all zero. */
static bool is_zero_below(const struct natural *n, int place)
{
    for (int i = 0; i < place / LIMB_DIGITS; i++) {
        if (n->limbs[i] != 0)
            return false;
    }
    return n->limbs[place / LIMB_DIGITS] % SMALL_POWERS_OF_TEN[place % LIMB_DIGITS] == 0;
}

/* The first `digits` digits of a positive number, rounded to nearest, ties to even. All digits of the number
 * are computed: c · 2^q is an integer, or c · 5^-q with a decimal point. */
static struct decimal round_to_digits(struct binary number, int digits)
{
    struct natural n = {.count = 0};
    natural_multiply_add(&n, 1, number.significand);
    int exponent = number.exponent < 0 ? number.exponent : 0;
    if (number.exponent < 0)
        natural_multiply_power(&n, 5, -number.exponent);
    else
        natural_multiply_power(&n, 2, number.exponent);

    int place = LIMB_DIGITS * (n.count - 1) + count_digits(n.limbs[n.count - 1]);
    struct decimal result = {0, exponent};
    for (int i = 0; i < digits && place > 0; i++)
        result.digits = 10 * result.digits + (uint64_t)natural_digit(&n, --place);
    result.exponent += place;
    if (place == 0)
        return result;
    int next = natural_digit(&n, place - 1);
    result.digits += next > 5 || (next == 5 && (!is_zero_below(&n, place - 1) || (result.digits & 1)));
    if (result.digits == SMALL_POWERS_OF_TEN[digits])
        return (struct decimal){1, result.exponent + digits};
    return result;
}

size_t decimal_print_digits(char *out, double number, int digits)
{
    uint64_t bits = bits_of(number);
    struct binary binary = decode(bits);
    struct decimal decimal = {0, 0};
    if (binary.significand != 0)
        decimal = round_to_digits(binary, digits);
    char *end = write_decimal(write_sign(out, bits), decimal);
    return (size_t)(end - out);
}

/* |number| · 10^decimals as the nearest integer, ties to even, for |number| < 10^9. */
static uint64_t scale_rounded(struct binary number, int decimals)
{
    /* Below 2^83; 21 bits are folded into the lowest one to fit 62. No number below 10^9 has an exponent
     * above -23, so at least 2 bits are left to drop, as shift_rounded() demands. */
    struct wide product = multiply(number.significand, SMALL_POWERS_OF_TEN[decimals]);
    uint64_t folded = product.high << 43 | product.low >> 21 | ((product.low << 43) != 0);
    return shift_rounded(folded, -number.exponent - 21);
}

static char *write_integer(char *out, uint32_t value)
{
    char *end = out + count_digits(value);
    for (char *digit = end; digit > out; value /= 10)
        *--digit = (char)('0' + value % 10);
    return end;
}

size_t decimal_print_fixed(char *out, double number, int decimals)
{
    if (!(number > -1e9 && number < 1e9))
        return decimal_print(out, number);
    uint64_t bits = bits_of(number), scale = SMALL_POWERS_OF_TEN[decimals];
    uint64_t scaled = scale_rounded(decode(bits), decimals);
    char *end = write_sign(out, scaled > 0 ? bits : 0);
    end = write_integer(end, (uint32_t)(scaled / scale));
    /* Nine decimals, so that the first is apart and eight follow. */
    uint32_t fraction = (uint32_t)(scaled % scale * SMALL_POWERS_OF_TEN[9 - decimals]);
    if (fraction > 0) {
        uint64_t eight = eight_digits(fraction % 100000000);
        *end++ = '.';
        *end++ = (char)('0' + fraction / 100000000);
        write_eight(end, eight);
        end += significant_digits(eight);
    }
    return (size_t)(end - out);
}

/* Reading. */

/* What the text says: digits · 10^exponent, if nothing was left out. */
struct numeral {
    bool negative;
    bool inexact;      /* digits that are not all zero were left out of `digits` */
    uint64_t digits;   /* the first 19 significant ones, or all if there are fewer */
    int64_t exponent;  /* of the last of `digits` */
    const char *rest;  /* where the digits (and maybe the point) that were left out begin, */
    const char *limit; /* and where they end */
};

/* 19 digits are held if another one might not fit 64 bits. */
static const uint64_t NINETEEN_DIGITS = 1000000000000000000;

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* The digits before or behind the point (`step` 0 or -1 in the exponent for each); returns their end. */
static const char *scan_digits(const char *text, const char *end, int step, struct numeral *n)
{
    for (; text < end && is_digit(*text) && n->digits < NINETEEN_DIGITS; text++) {
        n->digits = 10 * n->digits + (uint64_t)(*text - '0');
        n->exponent += step;
    }
    if (n->digits < NINETEEN_DIGITS || text == end || !is_digit(*text))
        return text;
    if (!n->rest)
        n->rest = text;
    for (; text < end && is_digit(*text); text++) {
        n->inexact |= *text != '0';
        n->exponent += 1 + step;
    }
    return text;
}

/* [-+]digits behind the e, or NULL. Capped where no mantissa that fits the memory could make up for it. */
static const char *scan_exponent(const char *text, const char *end, int64_t *exponent)
{
    const int64_t cap = INT64_MAX / 4;
    bool negative = text < end && *text == '-';
    if (text < end && (*text == '-' || *text == '+'))
        text++;
    if (text == end || !is_digit(*text))
        return NULL;
    *exponent = 0;
    for (; text < end && is_digit(*text); text++)
        *exponent = *exponent > cap / 10 ? cap : 10 * *exponent + (*text - '0');
    if (negative)
        *exponent = -*exponent;
    return text;
}

/* [-+]digits[.digits][e[-+]digits] */
static bool scan(const char *text, const char *end, struct numeral *n)
{
    n->negative = text < end && *text == '-';
    if (text < end && (*text == '-' || *text == '+'))
        text++;
    const char *start = text;
    text = scan_digits(text, end, 0, n);
    ptrdiff_t count = text - start;
    if (text < end && *text == '.') {
        start = ++text;
        text = scan_digits(text, end, -1, n);
        count += text - start;
    }
    n->limit = text;
    if (count == 0)
        return false;
    int64_t exponent = 0;
    if (text < end && (*text == 'e' || *text == 'E')) {
        text = scan_exponent(text + 1, end, &exponent);
        if (!text)
            return false;
    }
    n->exponent += exponent;
    return text == end;
}

/* The bits of the double nearest to value · 2^exponent, ties to even; infinity's if there is none. `value`
 * has its first one in the three highest bits. */
static uint64_t round_to_double(struct wide value, int exponent)
{
    /* Two bits of room for shift_rounded(), and the lower word only matters as not being zero. */
    uint64_t high = value.high >> 2 | ((value.high & 3) != 0 || value.low != 0);
    /* The exponent of the result's last bit, and from it how many to drop. */
    int last = exponent + 2 + 64 + 63 - leading_zeros(high) - FRACTION_BITS;
    if (last > LARGEST_EXPONENT)
        return INFINITY_BITS;
    if (last < SMALLEST_EXPONENT)
        last = SMALLEST_EXPONENT;
    uint64_t significand = shift_rounded(high, last - exponent - 2 - 64);
    /* The hidden bit, or a carry into the next power of two, counts the exponent up. */
    return ((uint64_t)(last - SMALLEST_EXPONENT) << FRACTION_BITS) + significand;
}

/* The doubles nearest to the ends of a small interval that contains the numeral: mostly the same. */
static void bound(const struct numeral *n, int k, uint64_t *lower, uint64_t *upper)
{
    int shift = leading_zeros(n->digits);
    struct wide product = multiply_wide(power_of_ten(k), n->digits << shift);
    int exponent = log2_of_power_of_ten(k) - 127 + 64 - shift;
    /* The power is too large by less than 3, which the factor below 2^64 makes less than 3 here; what was cut
     * off the product is less than 1, and what was left out of the digits less than 1 << shift times 2^64. */
    struct wide low = {product.high - (product.low < 3), product.low - 3};
    struct wide high = {product.high + (product.low + 1 == 0), product.low + 1};
    if (n->inexact)
        high.high += (uint64_t)1 << shift;
    *lower = round_to_double(low, exponent);
    *upper = round_to_double(high, exponent);
}

/* Compares the numeral with the midpoint between the double and the next one above, exactly: negative, zero
 * or positive as it is below, there or above. */
static int order_to_midpoint(const struct numeral *n, int k, uint64_t bits)
{
    /* No midpoint has more than 768 significant digits, so those behind 19 + 84 · 9 can only break a tie. */
    enum { MOST_CHUNKS = 84 };
    struct natural left = {.count = 0}, right = {.count = 0};
    natural_multiply_add(&left, 1, n->digits);
    const char *text = n->rest;
    for (int chunk = 0; text && text < n->limit && chunk < MOST_CHUNKS; chunk++) {
        uint32_t factor = 1, digits = 0;
        for (; text < n->limit && factor < LIMB_BASE; text++) {
            if (*text != '.') {
                digits = 10 * digits + (uint32_t)(*text - '0');
                factor *= 10;
                k--;
            }
        }
        natural_multiply_add(&left, factor, digits);
    }
    bool more = false;
    for (; text && text < n->limit; text++)
        more |= *text != '.' && *text != '0';

    /* digits · 10^k against (2 · c + 1) · 2^(q-1), without fractions */
    struct binary number = decode(bits);
    int q = number.exponent - 1;
    natural_multiply_add(&right, 1, 2 * number.significand + 1);
    natural_multiply_power(k < 0 ? &right : &left, 5, k < 0 ? -k : k);
    natural_multiply_power(q < k ? &left : &right, 2, q < k ? k - q : q - k);
    int order = natural_compare(&left, &right);
    return order == 0 ? more : order;
}

/* The nearest double's bits, for digits > 0. */
static uint64_t nearest(const struct numeral *n)
{
    /* 10^(magnitude - 1) <= numeral < 10^magnitude; what is left fits power_of_ten(). */
    int64_t magnitude = n->exponent + count_digits(n->digits);
    if (magnitude > 309)
        return INFINITY_BITS;
    if (magnitude < -323) /* less than half the smallest double, 2^-1075 = 2.47e-324 */
        return 0;
    int k = (int)n->exponent;
    uint64_t lower, upper;
    bound(n, k, &lower, &upper);
    if (lower == upper)
        return lower;
    int order = order_to_midpoint(n, k, lower);
    return lower + (order > 0 || (order == 0 && (lower & 1)));
}

bool decimal_parse(const char *text, size_t length, double *number)
{
    struct numeral n = {.digits = 0};
    if (length == 0 || !scan(text, text + length, &n))
        return false;
    uint64_t bits = n.digits > 0 ? nearest(&n) : 0;
    if (bits == INFINITY_BITS)
        return false;
    *number = double_of(n.negative ? bits | SIGN : bits);
    return true;
}
