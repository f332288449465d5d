/* Rationals against their definition: cross-multiplication in small numbers, and the edges of 64 bits. */
#include "numeric/rational.h"

#include <string.h>

#include "numeric/elimination.h"
#include "numeric/field.h"
#include "tap.h"

static uint64_t seed = 1;

static int64_t any_integer(int64_t bound)
{
    return (int64_t)(random_bits(&seed) % (uint64_t)(2 * bound + 1)) - bound;
}

static struct rational any_fraction(int64_t bound)
{
    struct rational a;
    int64_t denominator = any_integer(bound);
    return rational_make(any_integer(bound), denominator ? denominator : 1, &a) ? a
                                                                                : rational_from_integer(0);
}

static bool is_reduced(struct rational a)
{
    if (a.denominator < 1)
        return false;
    uint64_t x = a.numerator < 0 ? 0 - (uint64_t)a.numerator : (uint64_t)a.numerator,
             y = (uint64_t)a.denominator;
    while (y != 0) {
        uint64_t rest = x % y;
        x = y;
        y = rest;
    }
    return x == 1;
}

/* With numbers below 2^15 every product below fits. a/b + c/d = (ad + cb)/bd, and so on. */
static void test_arithmetic(void)
{
    bool sums = true, differences = true, products = true, quotients = true, reduced = true;
    for (long i = 0; i < test_effort(20000); i++) {
        struct rational a = any_fraction(1 << 14), b = any_fraction(1 << 14), r;
        int64_t both = a.denominator * b.denominator;
        sums &=
            rational_add(a, b, &r) &&
            r.numerator * both == (a.numerator * b.denominator + b.numerator * a.denominator) * r.denominator;
        reduced &= is_reduced(r);
        differences &=
            rational_subtract(a, b, &r) &&
            r.numerator * both == (a.numerator * b.denominator - b.numerator * a.denominator) * r.denominator;
        products &=
            rational_multiply(a, b, &r) && r.numerator * both == a.numerator * b.numerator * r.denominator;
        reduced &= is_reduced(r);
        bool divided = rational_divide(a, b, &r);
        quotients &= divided == (b.numerator != 0);
        if (divided)
            quotients &=
                r.numerator * (a.denominator * b.numerator) == a.numerator * b.denominator * r.denominator &&
                is_reduced(r);
    }
    ok(sums, "a/b + c/d");
    ok(differences, "a/b - c/d");
    ok(products, "a/b · c/d");
    ok(quotients, "a/b ÷ c/d, refused for c = 0 only");
    ok(reduced, "in lowest terms, with a positive denominator");
}

static void test_overflow(void)
{
    const int64_t huge = INT64_MAX; /* 7^2 · 73 · 127 · 337 · 92737 · 649657 */
    struct rational r = {5, 7}, one = {1, 1}, most = {huge, 1}, least = {-huge, 1}, tiny = {1, huge};
    ok(!rational_make(1, 0, &r), "no denominator 0");
    ok(!rational_make(INT64_MIN, 1, &r) && !rational_make(1, INT64_MIN, &r), "2^63 does not fit");
    ok(rational_make(INT64_MIN, 2, &r) && r.numerator == INT64_MIN / 2, "but half of it does");
    ok(rational_make(INT64_MIN, INT64_MIN, &r) && rational_equal(r, one), "and its quotient");
    r = (struct rational){5, 7};
    ok(!rational_add(most, one, &r) && !rational_subtract(least, one, &r) &&
           !rational_multiply(most, most, &r) && !rational_multiply(tiny, tiny, &r) &&
           !rational_add(tiny, (struct rational){1, 2}, &r),
       "what does not fit is refused");
    ok(r.numerator == 5 && r.denominator == 7, "and the result left alone");
    ok(rational_multiply(most, tiny, &r) && rational_equal(r, one), "(2^63 - 1) · 1/(2^63 - 1) = 1");
    ok(rational_add(most, least, &r) && rational_is_zero(r) && r.denominator == 1, "a - a = 0/1");
    ok(rational_add((struct rational){1, huge}, (struct rational){-1, huge}, &r) && rational_is_zero(r),
       "with a denominator whose square does not fit");
    /* p = 2^61 - 1 and p - 1: 1/p + 1/(p - 1) has a denominator of about 2^122. */
    int64_t prime = (int64_t)FIELD_PRIME;
    ok(!rational_add((struct rational){1, prime}, (struct rational){1, prime - 1}, &r),
       "a common denominator that does not fit");
}

static void expect_print(int64_t numerator, int64_t denominator, const char *wanted)
{
    char out[RATIONAL_LONGEST + 1];
    struct rational a;
    if (rational_make(numerator, denominator, &a))
        out[rational_print(out, a)] = '\0';
    else
        strcpy(out, "?");
    ok(strcmp(out, wanted) == 0, "%s is printed %s", wanted, out);
}

static void test_print(void)
{
    expect_print(6, 8, "3/4");
    expect_print(1, -2, "-1/2");
    expect_print(-4, -2, "2");
    expect_print(0, 9, "0");
    expect_print(-INT64_MAX, INT64_MAX - 1, "-9223372036854775807/9223372036854775806");
}

static void test_reconstruction(void)
{
    bool balanced = true, decimals = true, impostors = true;
    for (long i = 0; i < test_effort(5000); i++) {
        struct rational r, a = any_fraction((1 << 29) - 1);
        balanced &= rational_reconstruct(rational_residue(a), rational_real(a), &r) && rational_equal(a, r);
        int64_t power = 1;
        for (uint64_t k = random_bits(&seed) % 15; k > 0; k--)
            power *= 10;
        if (!rational_make(any_integer(999999999999999), power, &a))
            decimals = false;
        decimals &= rational_reconstruct(rational_residue(a), rational_real(a), &r) && rational_equal(a, r);
        /* The right image with another value is no number that is meant. */
        a = any_fraction(1000);
        impostors &=
            !rational_reconstruct(rational_residue(a), rational_real(a) + 1e-6, &r) || !rational_equal(a, r);
    }
    ok(balanced, "fractions of 29-bit numbers come back");
    ok(decimals, "decimals of 15 digits come back");
    ok(impostors, "a residue is believed only with its double");
    struct rational r, a = {12345678901, 98765432101};
    ok(!rational_reconstruct(rational_residue(a), rational_real(a), &r) || rational_equal(a, r),
       "a fraction beyond the field is refused, or right");
}

/* x + y = 1, x - y = 1/2 give 3/4 and 1/4; 2x = 3/2 then says nothing new and x = 1 contradicts. */
static void test_elimination(void)
{
    struct linear_system system;
    /* columns: x, y, the number 1 */
    struct linear_term sum[] = {{0, {1, 1}}, {1, {1, 1}}, {2, {-1, 1}}};
    struct linear_term difference[] = {{0, {1, 1}}, {1, {-1, 1}}, {2, {-1, 2}}};
    struct linear_term twice[] = {{0, {2, 1}}, {2, {-3, 2}}}, wrong[] = {{0, {1, 1}}, {2, {-1, 1}}};
    ok(linear_system_create(&system, 2), "a system of two unknowns");
    ok(linear_system_add(&system, sum, 3) == ELIMINATION_ADDED, "x + y = 1");
    ok(linear_system_add(&system, difference, 3) == ELIMINATION_ADDED, "x - y = 1/2");
    struct rational x = linear_row_factor(&system.rows[system.row_of[0]], 2);
    struct rational y = linear_row_factor(&system.rows[system.row_of[1]], 2);
    ok(rational_equal(x, (struct rational){-3, 4}) && rational_equal(y, (struct rational){-1, 4}),
       "x - 3/4 = 0, y - 1/4 = 0");
    ok(linear_system_add(&system, twice, 2) == ELIMINATION_REDUNDANT, "2x = 3/2 follows");
    ok(linear_system_add(&system, wrong, 2) == ELIMINATION_CONFLICT, "x = 1 contradicts");
    ok(system.conflict.count == 1 &&
           rational_equal(system.conflict.terms[0].factor, (struct rational){-1, 4}),
       "by 0 = -1/4");
    linear_system_free(&system);
}

/* x_{i+1} = n x_i + 1/n: coefficients n^k leave 64 bits after a known number of steps and are refused. */
static void test_elimination_overflow(void)
{
    struct linear_system system;
    enum { COUNT = 12 };
    enum elimination_outcome outcome = ELIMINATION_ADDED;
    size_t steps = 0;
    linear_system_create(&system, COUNT + 1);
    for (size_t i = 0; i < COUNT && outcome == ELIMINATION_ADDED; i++, steps++) {
        struct linear_term terms[] = {{i, {1000003, 1}}, {i + 1, {-1, 1}}, {COUNT + 1, {1, 1000003}}};
        outcome = linear_system_add(&system, terms, 3);
    }
    ok(outcome == ELIMINATION_OVERFLOW && steps <= 5, "(10^6 + 3)^4 is beyond 64 bits");
    linear_system_free(&system);
}

int main(void)
{
    test_arithmetic();
    test_overflow();
    test_print();
    test_reconstruction();
    test_elimination();
    test_elimination_overflow();
    return done_testing();
}
