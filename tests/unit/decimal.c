/* Decimal against the C library's own strtod() and snprintf(), which are exact in glibc. */
#include "base/decimal.h"
#include "tap.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { TEXT_SIZE = 8192 };

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

/* Any finite double, each exponent as likely as another. */
static double random_double(uint64_t *state)
{
    double number;
    do
        number = double_of(random_bits(state));
    while (!isfinite(number));
    return number;
}

/* Counts a failure; true for the first few, which are worth a note. */
static bool count_failure(int *failures)
{
    return ++*failures <= 5;
}

/* Results go through a buffer of just the size that is promised to suffice, for sanitizers to watch. */

static size_t terminate(char *text, const char *out, size_t length)
{
    memcpy(text, out, length);
    text[length] = '\0';
    return length;
}

static size_t print(char *text, double number)
{
    char out[DECIMAL_LONGEST];
    return terminate(text, out, decimal_print(out, number));
}

static size_t print_digits(char *text, double number, int digits)
{
    char out[DECIMAL_LONGEST];
    return terminate(text, out, decimal_print_digits(out, number, digits));
}

static size_t print_fixed(char *text, double number, int decimals)
{
    char out[DECIMAL_LONGEST];
    return terminate(text, out, decimal_print_fixed(out, number, decimals));
}

/* A decimal without its layout: digits · 10^exponent, no zeros at either end. */
struct canonical {
    char digits[64];
    int count, exponent;
    bool negative;
};

static struct canonical canonical(const char *text)
{
    struct canonical c = {.negative = *text == '-'};
    bool behind_point = false;
    for (text += c.negative; *text && *text != 'e'; text++) {
        if (*text == '.') {
            behind_point = true;
            continue;
        }
        if (c.count > 0 || *text != '0')
            c.digits[c.count++] = *text;
        c.exponent -= behind_point;
    }
    if (*text == 'e')
        c.exponent += atoi(text + 1);
    for (; c.count > 0 && c.digits[c.count - 1] == '0'; c.exponent++)
        c.digits[--c.count] = '\0';
    if (c.count == 0)
        c.exponent = 0;
    return c;
}

static bool same_decimal(const char *a, const char *b)
{
    struct canonical x = canonical(a), y = canonical(b);
    return x.negative == y.negative && x.exponent == y.exponent && strcmp(x.digits, y.digits) == 0;
}

static bool reads_back(const char *text, double number)
{
    return bits_of(strtod(text, NULL)) == bits_of(number);
}

static void test_layout(void)
{
    static const struct {
        double number;
        const char *text;
    } cases[] = {
        {0.0, "0"},
        {-0.0, "-0"},
        {1, "1"},
        {-1, "-1"},
        {10, "10"},
        {0.25, "0.25"},
        {-12.5, "-12.5"},
        {0.1, "0.1"},
        {0.3, "0.3"},
        {0.1 + 0.2, "0.30000000000000004"},
        {1.0 / 3, "0.3333333333333333"},
        {123456.789, "123456.789"},
        {1e-5, "0.00001"},
        {-1.2345678901234568e-5, "-0.000012345678901234568"},
        {9.999999999999999e-6, "9.999999999999999e-6"},
        {1.5e-7, "1.5e-7"},
        {1e20, "100000000000000000000"},
        {123456789012345680000.0, "123456789012345680000"},
        {999999999999999900000.0, "999999999999999900000"},
        {1e21, "1e21"},
        {-1.5e21, "-1.5e21"},
        {1e22, "1e22"},
        {1e23, "1e23"},
        {1e300, "1e300"},
        {9007199254740991, "9007199254740991"},
        {9007199254740992, "9007199254740992"},
        {9007199254740994, "9007199254740994"},
        {4503599627370495.5, "4503599627370495.5"},
        {DBL_MAX, "1.7976931348623157e308"},
        {-DBL_MAX, "-1.7976931348623157e308"},
        {DBL_MIN, "2.2250738585072014e-308"},
        {DBL_EPSILON, "2.220446049250313e-16"},
        {0x1p-1074, "5e-324"},
        {0x1p-1073, "1e-323"},
        {0x0.fffffffffffffp-1022, "2.225073858507201e-308"},
        {0x1p-44, "5.684341886080802e-14"}, /* the nearest of 16 digits, ...801e-14, would not read back */
        {8887055249355788 * 0x1p664,
         "6.802601037806062e215"}, /* the closest to its 10^k: see powers_of_ten.pl */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[TEXT_SIZE];
        size_t length = print(text, cases[i].number);
        if (!ok(strcmp(text, cases[i].text) == 0, "%.17g is printed as %s", cases[i].number, cases[i].text))
            note("got %s (%zu bytes)", text, length);
    }
}

static void test_round_trip(void)
{
    uint64_t state = 1;
    int failures = 0;
    long count = test_effort(200000);
    for (long i = 0; i < count; i++) {
        char text[TEXT_SIZE];
        double number = random_double(&state), parsed = 0;
        size_t length = print(text, number);
        bool right = reads_back(text, number) && decimal_parse(text, length, &parsed) &&
                     bits_of(parsed) == bits_of(number);
        if (!right && count_failure(&failures))
            note("%a is printed as %s, which is parsed as %a", number, text, parsed);
    }
    ok(failures == 0, "%ld random doubles are read back from what is printed", count);
}

/* Writes the decimal of `count` digits closest to the number, plus `step` in its last digit. */
static void write_candidate(char *text, double number, int count, int step)
{
    struct canonical c;
    snprintf(text, TEXT_SIZE, "%.*e", count - 1, number);
    c = canonical(text);
    long long digits = strtoll(c.digits, NULL, 10);
    for (; c.count < count; c.count++, c.exponent--)
        digits *= 10;
    snprintf(text, TEXT_SIZE, "%s%llde%d", c.negative ? "-" : "", digits + step, c.exponent);
}

/* No decimal with a digit less reads back, and none of as many digits that does is closer. Where the doubles
 * below the number are denser than those above, the closest decimal may be read as one of them but the next
 * one not. */
static bool is_shortest(const char *text, double number)
{
    char candidate[TEXT_SIZE], next[TEXT_SIZE];
    int count = canonical(text).count;
    for (int step = -1; count > 1 && step <= 1; step++) {
        write_candidate(candidate, number, count - 1, step);
        if (reads_back(candidate, number))
            return false;
    }
    write_candidate(candidate, number, count, 0);
    write_candidate(next, number, count, 1);
    return same_decimal(text, candidate) || (!reads_back(candidate, number) && same_decimal(text, next));
}

static void check_shortest(double number, int *failures)
{
    char text[TEXT_SIZE];
    print(text, number);
    if ((!reads_back(text, number) || !is_shortest(text, number)) && count_failure(failures))
        note("%a is printed as %s", number, text);
}

static void check_neighborhood(double number, int *failures)
{
    for (uint64_t bits = bits_of(number) - 2; bits != bits_of(number) + 3; bits++) {
        double neighbor = double_of(bits);
        if (isfinite(neighbor) && neighbor > 0)
            check_shortest(neighbor, failures);
    }
}

/* Whether decimal_parse() does with a well-formed number what strtod() does. */
static void check_parse(const char *text, int *failures)
{
    double expected = strtod(text, NULL), number = 123;
    bool valid = decimal_parse(text, strlen(text), &number);
    bool right = isfinite(expected) ? valid && bits_of(number) == bits_of(expected) : !valid && number == 123;
    if (!right && count_failure(failures))
        note("%.300s is parsed as %a instead of %a", text, valid ? number : INFINITY, expected);
}

/* Decimals odd · 10^exponent that are exactly halfway between two doubles, like 1e23: the product of the odd
 * number and 5^exponent has 54 bits. Only the even double may be printed like that. */
static void check_short_midpoint(uint64_t *state, int *failures)
{
    char text[TEXT_SIZE];
    uint64_t power = 1;
    int exponent = (int)(random_bits(state) % 23) + 1;
    for (int i = 0; i < exponent; i++)
        power *= 5;
    uint64_t least = ((uint64_t)1 << 53) / power;
    uint64_t odd = (least + random_bits(state) % (least + 1)) | 1;
    snprintf(text, sizeof text, "%llue%d", (unsigned long long)odd, exponent);
    double number = strtod(text, NULL);
    check_shortest(number, failures);
    check_shortest(nextafter(number, 0), failures);
    check_shortest(nextafter(number, INFINITY), failures);
    check_parse(text, failures);
}

static void test_shortest(void)
{
    uint64_t state = 2;
    int failures = 0;
    long count = test_effort(60000);
    for (long i = 0; i < count; i++)
        check_shortest(random_double(&state), &failures);
    ok(failures == 0, "%ld random doubles: printed shortest and closest", count);

    failures = 0;
    for (long i = 0; i < count / 2; i++)
        check_shortest((double)(int64_t)random_bits(&state) / 0x1p63 * 1000, &failures);
    ok(failures == 0, "%ld random coordinates: printed shortest and closest", count / 2);

    failures = 0;
    for (long i = 0; i < count / 2; i++) {
        char text[TEXT_SIZE];
        uint64_t bits = random_bits(&state);
        snprintf(text, sizeof text, "%llde%d", (long long)(bits >> 32) >> bits % 32,
                 (int)(bits >> 5 & 31) - 20);
        check_shortest(strtod(text, NULL) + 0.0, &failures);
    }
    ok(failures == 0, "%ld random short decimals: printed shortest and closest", count / 2);

    failures = 0;
    for (long i = 0; i < count / 2; i++)
        check_short_midpoint(&state, &failures);
    ok(failures == 0, "%ld short decimals halfway between doubles: printed shortest and closest", count / 2);

    failures = 0;
    for (int exponent = -1074; exponent < 1024; exponent++)
        check_neighborhood(ldexp(1, exponent), &failures);
    ok(failures == 0, "powers of two and their neighbors: printed shortest and closest");

    failures = 0;
    for (int exponent = -323; exponent <= 308; exponent++) {
        char text[16];
        snprintf(text, sizeof text, "1e%d", exponent);
        check_neighborhood(strtod(text, NULL), &failures);
    }
    ok(failures == 0, "powers of ten and their neighbors: printed shortest and closest");

    failures = 0;
    for (uint64_t bits = 1; bits < 2000; bits++)
        check_shortest(double_of(bits), &failures);
    ok(failures == 0, "the smallest doubles: printed shortest and closest");
}

static void check_digits(double number, int digits, int *failures)
{
    char text[TEXT_SIZE], expected[TEXT_SIZE];
    print_digits(text, number, digits);
    snprintf(expected, sizeof expected, "%.*e", digits - 1, number);
    if (!same_decimal(text, expected) && count_failure(failures))
        note("%a with %d digits is printed as %s instead of %s", number, digits, text, expected);
}

static void test_digits(void)
{
    static const struct {
        double number;
        int digits;
        const char *text;
    } cases[] = {
        {0.0, 5, "0"},
        {-0.0, 5, "-0"},
        {0.1, 17, "0.10000000000000001"},
        {0.1, 16, "0.1"},
        {2.5, 1, "2"},
        {3.5, 1, "4"},
        {99.5, 2, "100"}, /* a tie, and 99 is odd */
        {9.9999, 3, "10"},
        {123456, 2, "120000"},
        {1e21, 1, "1e21"},
        {-0.000099996, 4, "-0.0001"},
        {0.0000099996, 4, "0.00001"},
        {999999999999999900000.0, 3, "1e21"},
        {DBL_MAX, 1, "2e308"},
        {0x1p-1074, 17, "4.9406564584124654e-324"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[TEXT_SIZE];
        print_digits(text, cases[i].number, cases[i].digits);
        if (!ok(strcmp(text, cases[i].text) == 0, "%.17g with %d digits is printed as %s", cases[i].number,
                cases[i].digits, cases[i].text))
            note("got %s", text);
    }

    uint64_t state = 3;
    int failures = 0;
    long count = test_effort(60000);
    for (long i = 0; i < count; i++) {
        double number = i % 2 ? random_double(&state) : (double)(int64_t)random_bits(&state) / 0x1p63 * 1000;
        check_digits(number, (int)(random_bits(&state) % 17) + 1, &failures);
    }
    ok(failures == 0, "%ld random doubles: rounded to digits like snprintf() does", count);

    /* Short binary fractions end in 5, so that many are ties. */
    failures = 0;
    for (long i = 0; i < count; i++) {
        double number = ldexp((double)(random_bits(&state) % 10000), -(int)(random_bits(&state) % 12));
        check_digits(number, (int)(random_bits(&state) % 17) + 1, &failures);
    }
    ok(failures == 0, "%ld short binary fractions: rounded to digits like snprintf() does", count);
}

static void check_fixed(double number, int decimals, int *failures)
{
    char text[TEXT_SIZE], expected[TEXT_SIZE];
    print_fixed(text, number, decimals);
    int length = snprintf(expected, sizeof expected, "%.*f", decimals, number);
    if (decimals > 0) {
        while (expected[length - 1] == '0')
            length--;
        if (expected[length - 1] == '.')
            length--;
        expected[length] = '\0';
    }
    if (strcmp(text, strcmp(expected, "-0") == 0 ? "0" : expected) != 0 && count_failure(failures))
        note("%a with %d decimals is printed as %s instead of %s", number, decimals, text, expected);
}

static void test_fixed(void)
{
    static const struct {
        double number;
        int decimals;
        const char *text;
    } cases[] = {
        {0.0, 3, "0"},
        {-0.0, 3, "0"},
        {-0.0004, 3, "0"},
        {-0.0006, 3, "-0.001"},
        {0.5, 0, "0"},
        {1.5, 0, "2"},
        {-12.5, 2, "-12.5"},
        {1e-300, 9, "0"},
        {1e-9, 9, "0.000000001"},
        {1.005, 2, "1"}, /* the double is below the tie */
        {99.9996, 3, "100"},
        {-999999999.9999999, 9, "-999999999.999999881"},
        {-999999999.9999999, 6, "-1000000000"},
        {1.5e9, 3, "1500000000"},
        {-1e300, 3, "-1e300"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[TEXT_SIZE];
        print_fixed(text, cases[i].number, cases[i].decimals);
        if (!ok(strcmp(text, cases[i].text) == 0, "%.17g with %d decimals is printed as %s", cases[i].number,
                cases[i].decimals, cases[i].text))
            note("got %s", text);
    }

    uint64_t state = 4;
    int failures = 0;
    long count = test_effort(100000);
    for (long i = 0; i < count; i++) {
        uint64_t bits = random_bits(&state);
        double number = ldexp((double)(int64_t)bits, -34 - (int)(bits % 60)); /* below 2^29 */
        if (i % 2)                                                            /* many ties */
            number = floor(number * 256) / 256;
        check_fixed(number, (int)(random_bits(&state) % 10), &failures);
    }
    ok(failures == 0, "%ld random coordinates: rounded to decimals like snprintf() does", count);
}

static void test_syntax(void)
{
    static const char *const good[] = {
        "0",     "-0",    "+0",     "1",       "+1",    "-1",     "1.",     ".5",     "-.5",
        "00012", "1e5",   "1E5",    "1e+5",    "1e-5",  "1.e5",   ".1e1",   "0e0",    "0e99999",
        "0.000", "1e022", "1e-400", "-1e-400", "1e308", "5e-324", "2e-324", "3e-324", "0.5e-323",
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        int failures = 0;
        check_parse(good[i], &failures);
        ok(failures == 0, "'%s' is parsed like strtod() does", good[i]);
    }
    static const char *const bad[] = {
        "",
        "-",
        "+",
        ".",
        "-.",
        "e5",
        ".e5",
        "1e",
        "1e+",
        "1e-",
        "1e5.0",
        "1.2.3",
        "--1",
        "+-1",
        " 1",
        "1 ",
        "1 e5",
        "0x10",
        "1p3",
        "nan",
        "inf",
        "-inf",
        "1,5",
        "infinity",
        "1e5e5",
        "1_0",
        "1f",
        "1e309",
        "-1e309",
        "1e400000",
        "1e99999999999999999999",
        "\xd9\xa1",
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        double number = 123;
        bool valid = decimal_parse(bad[i], strlen(bad[i]), &number);
        ok(!valid && number == 123, "'%s' is refused", bad[i]);
    }
    double number = 123;
    ok(!decimal_parse("1\0", 2, &number), "a NUL is refused");
    ok(decimal_parse("12345", 3, &number) && number == 123, "nothing behind the length is read");
}

/* A decimal of 1 to `most` digits with a point somewhere and an exponent up to `range`. */
static void write_random_decimal(char *text, uint64_t *state, unsigned most, unsigned range)
{
    unsigned count = (unsigned)(random_bits(state) % most) + 1;
    unsigned point = (unsigned)(random_bits(state) % (2 * count)); /* every other time there is none */
    if (random_bits(state) % 2)
        *text++ = '-';
    for (unsigned i = 0; i < count; i++) {
        if (i == point)
            *text++ = '.';
        *text++ = (char)('0' + random_bits(state) % 10);
    }
    snprintf(text, 16, "e%d", (int)(random_bits(state) % (2 * range + 1)) - (int)range);
}

static void test_parse(void)
{
    static const struct {
        unsigned most_digits, range;
        long count;
    } kinds[] = {{5, 10, 50000}, {17, 25, 50000}, {19, 350, 50000}, {40, 350, 50000}, {2000, 350, 2000}};
    uint64_t state = 5;
    char text[TEXT_SIZE];
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        int failures = 0;
        long count = test_effort(kinds[i].count);
        for (long j = 0; j < count; j++) {
            write_random_decimal(text, &state, kinds[i].most_digits, kinds[i].range);
            check_parse(text, &failures);
        }
        ok(failures == 0, "%ld random decimals of up to %u digits: parsed like strtod() does", count,
           kinds[i].most_digits);
    }

    /* Subnormals, and the largest; 17 digits and a few more. */
    int failures = 0;
    long count = test_effort(50000);
    for (long i = 0; i < count; i++) {
        uint64_t bits = random_bits(&state) >> (12 + random_bits(&state) % 52);
        double number = double_of(i % 4 ? bits : bits_of(DBL_MAX) - bits % 1000);
        snprintf(text, sizeof text, "%.*e", (int)(random_bits(&state) % 30), number);
        check_parse(text, &failures);
    }
    ok(failures == 0, "%ld decimals near the limits: parsed like strtod() does", count);
}

/* digits · 10^exponent, as long as need be */
struct long_decimal {
    char digits[1200]; /* '0' to '9', the most significant first */
    int count, exponent;
};

static void multiply(struct long_decimal *d, uint32_t factor)
{
    char reversed[sizeof d->digits];
    uint64_t carry = 0;
    int count = 0;
    for (int i = d->count - 1; i >= 0 || carry > 0; i--, carry /= 10) {
        if (i >= 0)
            carry += (uint64_t)(d->digits[i] - '0') * factor;
        reversed[count++] = (char)('0' + carry % 10);
    }
    for (int i = 0; i < count; i++)
        d->digits[i] = reversed[count - 1 - i];
    d->count = count;
}

/* The midpoint between a positive number and the next one above. */
static struct long_decimal midpoint(double number)
{
    int exponent;
    double fraction = frexp(number, &exponent);
    if (exponent < -1021) { /* subnormals have the spacing of the smallest normal numbers */
        fraction = ldexp(fraction, exponent + 1021);
        exponent = -1021;
    }
    struct long_decimal d = {.exponent = 0};
    d.count = snprintf(d.digits, sizeof d.digits, "%llu", 2 * (unsigned long long)ldexp(fraction, 53) + 1);
    exponent -= 54;
    for (; exponent > 0; exponent -= exponent < 31 ? exponent : 31)
        multiply(&d, exponent < 31 ? (uint32_t)1 << exponent : (uint32_t)1 << 31);
    d.exponent = exponent;
    for (; exponent < -11; exponent += 12)
        multiply(&d, 244140625); /* 5^12 */
    for (; exponent < 0; exponent++)
        multiply(&d, 5);
    return d;
}

/* One in the last digit less. */
static void decrement(struct long_decimal *d)
{
    int i = d->count - 1;
    for (; d->digits[i] == '0'; i--)
        d->digits[i] = '9';
    d->digits[i]--;
}

/* Writes the decimal with `zeros` zeros and then `tail` behind it, in one of three layouts. */
static void write_long(char *text, const struct long_decimal *d, int zeros, const char *tail, int layout)
{
    char digits[TEXT_SIZE / 2];
    int count = d->count + zeros + (int)strlen(tail), exponent = d->exponent + d->count - count;
    memcpy(digits, d->digits, (size_t)d->count);
    memset(digits + d->count, '0', (size_t)zeros);
    strcpy(digits + d->count + zeros, tail);
    if (layout == 0)
        snprintf(text, TEXT_SIZE, "%se%d", digits, exponent);
    else if (layout == 1)
        snprintf(text, TEXT_SIZE, "%c.%se%d", digits[0], digits + 1, exponent + count - 1);
    else
        snprintf(text, TEXT_SIZE, "0.000%se%d", digits, exponent + count + 3);
}

static void check_halfway(double number, uint64_t *state, int *failures)
{
    static const char *const tails[] = {"", "1", "000000000000000000000", "0000000000000000000000001"};
    char text[TEXT_SIZE];
    struct long_decimal d = midpoint(number);
    int zeros = random_bits(state) % 8 ? (int)(random_bits(state) % 20) : (int)(random_bits(state) % 2000);
    write_long(text, &d, zeros, tails[random_bits(state) % 4], (int)(random_bits(state) % 3));
    check_parse(text, failures);
    decrement(&d);
    write_long(text, &d, zeros, tails[random_bits(state) % 4], (int)(random_bits(state) % 3));
    check_parse(text, failures);
}

static void test_halfway(void)
{
    uint64_t state = 6;
    int failures = 0;
    long count = test_effort(600);
    for (long i = 0; i < count; i++)
        check_halfway(fabs(random_double(&state)), &state, &failures);
    ok(failures == 0, "%ld midpoints of random doubles: parsed like strtod() does", count);

    failures = 0;
    count = test_effort(10000);
    for (long i = 0; i < count; i++)
        check_halfway((double)(random_bits(&state) >> 11) / (double)((uint64_t)1 << random_bits(&state) % 60),
                      &state, &failures);
    ok(failures == 0, "%ld midpoints of random coordinates: parsed like strtod() does", count);

    failures = 0;
    count = test_effort(200);
    for (long i = 0; i < count; i++)
        check_halfway(double_of(random_bits(&state) >> (12 + random_bits(&state) % 52)), &state, &failures);
    ok(failures == 0, "%ld midpoints of subnormals: parsed like strtod() does", count);

    static const double edges[] = {0x1p-1074, 0x0.fffffffffffffp-1022, 0x1p-1022, 0x1.fffffffffffffp-1022, 1,
                                   DBL_MAX};
    failures = 0;
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) {
        for (int j = 0; j < 20; j++)
            check_halfway(edges[i], &state, &failures);
    }
    for (int j = 0; j < 20; j++)
        check_halfway(0, &state, &failures);
    ok(failures == 0, "midpoints next to the limits: parsed like strtod() does");
}

/* Text far longer than any number needs to be. */
static void test_long(void)
{
    enum { LENGTH = 300000 };
    static char text[LENGTH + 32];
    double number = 123;
    memset(text, '0', LENGTH);
    memcpy(text + LENGTH, "1e-300000", 10);
    ok(decimal_parse(text, strlen(text), &number) && number == 0, "leading zeros do not count");
    text[1] = '.';
    memcpy(text + LENGTH, "1e300000", 9);
    ok(decimal_parse(text, strlen(text), &number) && number == 10, "an exponent may make up for zeros");
    memcpy(text + LENGTH, "1e300308", 9);
    ok(!decimal_parse(text, strlen(text), &number), "but not for too many");
    text[0] = '7';
    text[1] = '0';
    memcpy(text + LENGTH, "1e-300000", 10);
    ok(decimal_parse(text, strlen(text), &number) && number == 7, "trailing digits may be many");
    memcpy(text + LENGTH, "e-99999999999999999999999999999", 32);
    ok(decimal_parse(text, strlen(text), &number) && number == 0, "exponents do not overflow");
    memset(text, '9', LENGTH);
    memcpy(text + LENGTH, "e-300000", 9);
    ok(decimal_parse(text, strlen(text), &number) && number == 1, "many nines are one");
    memcpy(text + LENGTH, "e", 2);
    ok(!decimal_parse(text, strlen(text), &number), "a long text may be malformed");
}

int main(void)
{
    test_layout();
    test_round_trip();
    test_shortest();
    test_digits();
    test_fixed();
    test_syntax();
    test_parse();
    test_halfway();
    test_long();
    return done_testing();
}
