/* Expressions: random formulas evaluated twice, by the program from their text and here while they are made, in
 * doubles and modulo the prime; and what precedence, functions, sums, lets and limits mean. */
#include <math.h>
#include <string.h>

#include "language/expression.h"
#include "numeric/field.h"
#include "tap.h"

static uint64_t seed = 1;

/* a·b mod p by doubling and adding, 1/b by Euclid: neither is how lib/numeric does it. */
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

/* ---- Text to value ------------------------------------------------------------------------------------- */

enum { PARAMETERS = 2 };

/* Names x and y; f(u, v) = u/(u + v); half = 1/2. */
struct language {
    struct arena arena;
    struct report report;
    struct scope scope;
    struct syntax_parameter parameters[PARAMETERS], *parameter_list[PARAMETERS];
    struct syntax_let lets[2], *let_list[2];
};

static const char *const let_arguments[] = {"u", "v"};

static bcifs_status language_read(struct language *language, const char *text, struct expression **expression)
{
    struct source *source;
    bcifs_status status = source_from_text(&language->arena, "text", text, strlen(text), &language->report, &source);
    if (status == BCIFS_OK)
        status = syntax_parse_expression(&language->arena, source, &language->report, expression);
    return status;
}

static struct language *language_new(void)
{
    static const char *const names[] = {"x", "y"};
    struct language *language = calloc(1, sizeof *language);
    language->report = report_new(NULL);
    for (uint32_t i = 0; i < PARAMETERS; i++) {
        language->parameters[i].name = names[i];
        language->parameters[i].index = i;
        language->parameter_list[i] = &language->parameters[i];
    }
    language->lets[0] = (struct syntax_let){.name = "f",
                                            .arguments = (const char **)let_arguments,
                                            .argument_count = 2,
                                            .has_arguments = true};
    language->lets[1].name = "half";
    language_read(language, "u/(u+v)", &language->lets[0].value);
    language_read(language, "1/2", &language->lets[1].value);
    language->let_list[0] = &language->lets[0];
    language->let_list[1] = &language->lets[1];
    language->scope = (struct scope){language->parameter_list, PARAMETERS, language->let_list, 2};
    return language;
}

static void language_free(struct language *language)
{
    arena_free(&language->arena);
    free(language);
}

static bcifs_status evaluate_with(const char *text, const struct value *parameters, bool proving, struct value *value,
                                  bcifs_error *error)
{
    struct language *language = language_new();
    struct expression *expression;
    struct source source = {"text", text, strlen(text)};
    bcifs_status status = language_read(language, text, &expression);
    if (status == BCIFS_OK)
        status = expression_resolve(expression, &language->scope, NULL, 0, NULL, 0, &source, &language->report);
    if (status == BCIFS_OK) {
        struct environment *environment = calloc(1, sizeof *environment);
        *environment = (struct environment){.parameters = parameters,
                                            .known = PARAMETERS,
                                            .steps = EVALUATION_MOST_STEPS,
                                            .source = &source,
                                            .report = &language->report,
                                            .proving = proving};
        status = expression_evaluate(expression, environment, value);
        free(environment);
    }
    if (error)
        report_close(&language->report, error);
    language_free(language);
    return status;
}

static const struct value plain[PARAMETERS] = {{2, 2, true, true}, {3, 3, true, true}};

static bcifs_status evaluate(const char *text, struct value *value, bcifs_error *error)
{
    return evaluate_with(text, plain, false, value, error);
}

/* ---- Random formulas ----------------------------------------------------------------------------------- */

/* A formula as it is made: its text and both its numbers. */
struct formula {
    char text[4000];
    double real;
    uint64_t residue;
    bool pole; /* a divisor near zero: nothing is claimed */
};

static double parameter_reals[PARAMETERS];
static uint64_t parameter_residues[PARAMETERS];

static void leaf_make(struct formula *formula)
{
    uint64_t kind = random_bits(&seed) % 6, number = random_bits(&seed) % 100;
    *formula = (struct formula){.pole = false};
    if (kind < 2) {
        snprintf(formula->text, sizeof formula->text, "%s", kind == 0 ? "x" : "y");
        formula->real = parameter_reals[kind];
        formula->residue = parameter_residues[kind];
    } else if (kind == 2) {
        /* d.dd: the decimal over 100. */
        snprintf(formula->text, sizeof formula->text, "%d.%02d", (int)number % 10, (int)number);
        uint64_t hundredths = number % 10 * 100 + number;
        formula->real = (double)hundredths / 100;
        formula->residue = product_modulo(hundredths, inverse_modulo(100));
    } else if (kind == 3) {
        /* 3e-2 and 3e2 */
        int exponent = (int)(random_bits(&seed) % 7) - 3;
        uint64_t power = 1;
        for (int i = 0; i < abs(exponent); i++)
            power *= 10;
        snprintf(formula->text, sizeof formula->text, "%de%d", (int)number, exponent);
        formula->real = exponent < 0 ? (double)number / (double)power : (double)number * (double)power;
        formula->residue = product_modulo(number, exponent < 0 ? inverse_modulo(power) : power);
    } else {
        snprintf(formula->text, sizeof formula->text, "%d", (int)number);
        formula->real = (double)number;
        formula->residue = number;
    }
}

static uint64_t residue_power(uint64_t a, int exponent)
{
    uint64_t power = 1;
    for (int i = 0; i < abs(exponent); i++)
        power = product_modulo(power, a);
    return exponent < 0 ? inverse_modulo(power) : power;
}

/* Every operand stands in parentheses, so the text means what is computed here without rules of precedence. */
static void formula_make(struct formula *formula, int depth)
{
    struct formula left, right, *a = &left, *b = &right;
    uint64_t kind = random_bits(&seed) % 8;
    if (depth == 0 || kind == 0) {
        leaf_make(formula);
        return;
    }
    formula_make(a, depth - 1);
    formula_make(b, depth - 1);
    formula->pole = a->pole || b->pole;
    switch (kind) {
    case 1:
    case 2:
        snprintf(formula->text, sizeof formula->text, "(%.1900s)+(%.1900s)", a->text, b->text);
        formula->real = a->real + b->real;
        formula->residue = (a->residue + b->residue) % FIELD_PRIME;
        break;
    case 3:
        snprintf(formula->text, sizeof formula->text, "(%.1900s) - (%.1900s)", a->text, b->text);
        formula->real = a->real - b->real;
        formula->residue = (a->residue + FIELD_PRIME - b->residue) % FIELD_PRIME;
        break;
    case 4:
        snprintf(formula->text, sizeof formula->text, "(%.1900s)*(%.1900s)", a->text, b->text);
        formula->real = a->real * b->real;
        formula->residue = product_modulo(a->residue, b->residue);
        break;
    case 5:
        snprintf(formula->text, sizeof formula->text, "(%.1900s)/(%.1900s)", a->text, b->text);
        formula->real = a->real / b->real;
        formula->residue = b->residue ? product_modulo(a->residue, inverse_modulo(b->residue)) : 0;
        formula->pole = formula->pole || fabs(b->real) < 1e-6 || b->residue == 0;
        break;
    case 6: {
        int exponent = (int)(random_bits(&seed) % 7) - 3;
        snprintf(formula->text, sizeof formula->text, "(%.1900s)^%s%d", a->text, exponent < 0 ? "-" : "", abs(exponent));
        formula->real = pow(a->real, exponent);
        formula->pole = a->pole || (exponent < 0 && (fabs(a->real) < 1e-6 || a->residue == 0));
        formula->residue = formula->pole ? 0 : residue_power(a->residue, exponent);
        break;
    }
    default:
        /* f(u, v) = u/(u + v) */
        snprintf(formula->text, sizeof formula->text, "f(%.1900s, -(%.1900s))", a->text, b->text);
        formula->real = a->real / (a->real - b->real);
        uint64_t sum = (a->residue + FIELD_PRIME - b->residue) % FIELD_PRIME;
        formula->residue = sum ? product_modulo(a->residue, inverse_modulo(sum)) : 0;
        formula->pole = formula->pole || fabs(a->real - b->real) < 1e-6 || sum == 0;
        break;
    }
    formula->pole = formula->pole || !isfinite(formula->real) || fabs(formula->real) > 1e100;
}

static void test_random(void)
{
    bool good = true;
    long compared = 0, poles = 0;
    for (long round = 0; round < test_effort(4000); round++) {
        static struct formula formula;
        struct value parameters[PARAMETERS], value;
        bcifs_error error;
        for (int i = 0; i < PARAMETERS; i++) {
            parameter_reals[i] = (double)(random_bits(&seed) % 1000) / 64 - 5;
            parameter_residues[i] = random_bits(&seed) % FIELD_PRIME;
            parameters[i] = (struct value){parameter_reals[i], parameter_residues[i], true, false};
        }
        formula_make(&formula, 1 + (int)(round % 5));
        if (formula.pole) {
            poles++;
            continue;
        }
        bcifs_status status = evaluate_with(formula.text, parameters, false, &value, &error);
        compared++;
        /* The same operations on the same doubles, but for powers, decimals and what follows from them. */
        bool same = status == BCIFS_OK && value.exact && value.residue == formula.residue;
        if (!same) {
            note("%s at x = %.17g, y = %.17g", formula.text, parameter_reals[0], parameter_reals[1]);
            note("status %d, residue %llu, expected %llu; %s", (int)status, (unsigned long long)value.residue,
                 (unsigned long long)formula.residue, status ? error.message : "");
            good = false;
        }
        if (status == BCIFS_OK && value.real != formula.real &&
            fabs(value.real - formula.real) > 1e-6 * fmax(fabs(formula.real), 1)) {
            note("%s: %.17g, expected %.17g", formula.text, value.real, formula.real);
            good = false;
        }
    }
    ok(good && compared > poles, "%ld random formulas, modulo the prime and in doubles", compared);
}

/* Integers that stay below 2^53: the double is the integer and the residue its image. */
static void test_integers(void)
{
    bool good = true;
    for (long round = 0; round < test_effort(3000); round++) {
        char text[1000] = "0";
        size_t length = 1;
        int64_t total = 0, term = 0;
        /* A sum of products without parentheses: 0 +a*b*c -d*e … */
        for (int i = 0; i < 6; i++) {
            bool minus = random_bits(&seed) & 1;
            term = 1;
            length += (size_t)snprintf(text + length, sizeof text - length, "%s", minus ? " -" : " + ");
            int factors = 1 + (int)(random_bits(&seed) % 4);
            for (int k = 0; k < factors; k++) {
                int factor = (int)(random_bits(&seed) % 1000);
                term *= factor;
                length += (size_t)snprintf(text + length, sizeof text - length, "%s%d", k ? "*" : "", factor);
            }
            total += minus ? -term : term;
        }
        struct value value;
        uint64_t residue = total < 0 ? FIELD_PRIME - (uint64_t)-total : (uint64_t)total;
        if (evaluate(text, &value, NULL) != BCIFS_OK || value.real != (double)total || value.residue != residue) {
            note("%s = %lld, found %.17g", text, (long long)total, value.real);
            good = false;
        }
    }
    ok(good, "integer sums of products, by precedence");
}

/* ---- Rules of the language ----------------------------------------------------------------------------- */

static void test_meaning(void)
{
    static const struct {
        const char *text;
        double real;
    } cases[] = {
        {"-2^2", -4},          {"(-2)^2", 4},        {"2^3^2", 512},         {"2^-1", 0.5},
        {"-x^y", -8},          {"8-3-2", 3},         {"8/4/2", 1},           {"8/4*2", 4},
        {"7%3", 1},            {"-7%3", 2},          {"(-7)%3", 2},          {"7%(-3)", -2},
        {"2+3*4%5", 4},        {"--3", 3},           {"-+-3", 3},            {"+x", 2},
        {"min(x,y)", 2},       {"max(x,y)", 3},      {"abs(x-y)", 1},        {"half", 0.5},
        {"f(x,y)", 0.4},       {"f(half,half)", 0.5}, {".5+5", 5.5},        {"1e-3*1E3", 1},
        {"0^0", 1},            {"1-1-1+1", 0},       {"((((1))))", 1},
    };
    bool good = true;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct value value = {0};
        bcifs_error error = {0};
        bcifs_status status = evaluate(cases[i].text, &value, &error);
        if (status || value.real != cases[i].real || !value.exact || !value.fixed) {
            note("%s: %.17g, expected %.17g; exact %d, fixed %d; %s", cases[i].text, value.real, cases[i].real,
                 value.exact, value.fixed, error.message);
            good = false;
        }
    }
    ok(good, "precedence, functions and lets, all exact");
}

static void test_exactness(void)
{
    static const struct {
        const char *text;
        double real;
        bool exact;
    } cases[] = {
        {"0.1+0.2-0.3", 5.551115123125783e-17, true},
        {"0.12345678901234", 0.12345678901234, true},    /* 14 digits */
        {"0.123456789012345", 0.123456789012345, false}, /* 15: a rounded real number */
        {"123456789012345678", 123456789012345678.0, true}, /* an integer all the same */
        {"sqrt(4)", 2, false},
        {"pi", 3.141592653589793, false},
        {"cos(0)", 1, false},
        {"exp(0)+log(1)+sin(0)+tan(0)", 1, false},
        {"2^(1/2)", 1.4142135623730951, false},
        {"sqrt(2)*sqrt(2)-2", 4.440892098500626e-16, false},
    };
    bool good = true;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct value value = {0};
        bcifs_error error = {0};
        if (evaluate(cases[i].text, &value, &error) || fabs(value.real - cases[i].real) > 1e-16 * fabs(cases[i].real) ||
            value.exact != cases[i].exact) {
            note("%s: %.17g, exact %d; %s", cases[i].text, value.real, value.exact, error.message);
            good = false;
        }
    }
    ok(good, "what is exact and what is not");
    struct value zero;
    ok(evaluate("0.1+0.2-0.3", &zero, NULL) == BCIFS_OK && value_is_zero(zero), "0.1 + 0.2 - 0.3 is zero");
    /* A choice between free parameters cannot be made in the field. */
    struct value parameters[PARAMETERS] = {{2, 77, true, false}, {3, 99, true, false}}, value;
    good = true;
    static const char *const choices[] = {"min(x,y)", "max(x,y)", "abs(x)", "x%y", "2^x"};
    for (size_t i = 0; i < 5; i++)
        good = good && evaluate_with(choices[i], parameters, false, &value, NULL) == BCIFS_OK && !value.exact;
    ok(good, "min, max, abs, %% and powers of free parameters are not exact");
    ok(evaluate_with("x^2-x*x", parameters, false, &value, NULL) == BCIFS_OK && value.exact && value_is_zero(value),
       "identities in free parameters are");
}

static void test_refusals(void)
{
    static const struct {
        const char *text, *message;
        unsigned column;
    } cases[] = {
        {"1/0", "zero", 2},        {"1/(0.1+0.2-0.3)", "zero", 2}, {"x%0", "zero", 2},    {"0^-1", "zero", 2},
        {"sqrt(-1)", "finite", 1}, {"log(0)", "finite", 1},        {"1e300*1e300", "finite", 6},
        {"z", "z", 1},             {"f(1)", "2", 1},               {"min(1)", "2", 1},    {"sqr(2)", "sqrt", 1},
        {"?", "?", 1},             {"p[0]", "p", 1},               {"sum(i in 1..2, i)", "rules", 1},
        {"1+", "", 3},             {"(1", "", 3},                  {"1)", "", 2},         {"", "", 1},
        {"f(1,-1)", "zero", 1},
    };
    bool good = true;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct value value;
        bcifs_error error = {0};
        bcifs_status status = evaluate(cases[i].text, &value, &error);
        /* A let fails where it is written, in a text of its own. */
        bool here = error.column == cases[i].column || strcmp(cases[i].text, "f(1,-1)") == 0;
        if (status != BCIFS_INPUT || !strstr(error.message, cases[i].message) || error.line != 1 || !here) {
            note("'%s': status %d, %u:%u: %s", cases[i].text, (int)status, error.line, error.column, error.message);
            good = false;
        }
    }
    ok(good, "what has no value is refused at its place");
}

/* Towers and long sums end in an error, not in a crash. */
static void test_limits(void)
{
    static char text[200000];
    struct value value;
    bcifs_error error;
    memset(text, '(', 100000);
    ok(evaluate(text, &value, &error) == BCIFS_INPUT, "100000 parentheses: %s", error.message);
    memset(text, '-', 100000);
    text[99999] = '1';
    ok(evaluate(text, &value, &error) == BCIFS_INPUT, "100000 signs: %s", error.message);
    for (size_t i = 0; i < 50000; i++)
        memcpy(text + 2 * i, "1+", 2);
    text[99999] = '\0';
    ok(evaluate(text, &value, &error) == BCIFS_INPUT, "50000 terms: %s", error.message);
    text[2 * 900 - 1] = '\0';
    ok(evaluate(text, &value, NULL) == BCIFS_OK && value.real == 900, "900 terms are fine");
}

/* ---- Linear expressions -------------------------------------------------------------------------------- */

/* Coefficients of p[0] … p[3]. */
static bcifs_status linear_read(const char *text, struct value column[4], bcifs_error *error)
{
    struct language *language = language_new();
    struct source *source = NULL;
    struct syntax_file *file = NULL;
    char whole[500];
    /* Points have a meaning in rules only. */
    snprintf(whole, sizeof whole, "automaton a\ncell c 4 { sub c { q[0] = %s } }\n", text);
    bcifs_status status = source_from_text(&language->arena, "text", whole, strlen(whole), &language->report, &source);
    if (status == BCIFS_OK)
        status = syntax_parse(&language->arena, source, &language->report, &file);
    if (status == BCIFS_OK) {
        struct expression *value = file->items[0].cell->parts[0]->rules->rules[0]->value;
        struct environment *environment = calloc(1, sizeof *environment);
        *environment = (struct environment){.parameters = plain,
                                            .known = PARAMETERS,
                                            .steps = EVALUATION_MOST_STEPS,
                                            .source = source,
                                            .report = &language->report};
        for (int i = 0; i < 4; i++)
            column[i] = value_from_integer(0);
        status = expression_resolve(value, &language->scope, NULL, 0, NULL, 0, source, &language->report);
        if (status == BCIFS_OK)
            status = expression_linear(value, environment, value_from_integer(1), column, 4);
        free(environment);
    }
    report_close(&language->report, error);
    language_free(language);
    return status;
}

static void test_linear(void)
{
    static const struct {
        const char *text;
        double coefficients[4];
    } cases[] = {
        {"p[0]", {1, 0, 0, 0}},
        {"3/4*p[0] + p[1]/4", {0.75, 0.25, 0, 0}},
        {"-p[3] + 2*(p[1] - p[2])*x", {0, 4, -4, -1}},
        {"sum(i in 0..3, i*p[i])", {0, 1, 2, 3}},
        {"sum(i in 1..2, sum(j in 0..1, p[i+j]))", {0, 1, 2, 1}},
        {"p[1+1]*half - p[y]/(1+1)", {0, 0, 0.5, -0.5}},
        {"p[0]*(3-3) + p[1]", {0, 1, 0, 0}},
        {"p[0] + 0*x", {1, 0, 0, 0}},
        {"p[3]*sum(i in 1..4, i)", {0, 0, 0, 10}},
        {"p[2]*sum(i in 1..3, sum(j in 1..i, j*x))", {0, 0, 20, 0}},
        {"p[1] + sum(i in 2..1, p[i])", {0, 1, 0, 0}},
        {"p[0]*x*sum(x in 1..3, x)", {12, 0, 0, 0}},
        {"sum(i in 1..1000000, p[0])", {1000000, 0, 0, 0}},
    };
    bool good = true;
    bcifs_error error;
    struct value column[4];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bcifs_status status = linear_read(cases[i].text, column, &error);
        bool same = status == BCIFS_OK;
        for (int k = 0; k < 4 && same; k++)
            same = column[k].real == cases[i].coefficients[k] && column[k].exact;
        if (!same)
            note("%s: %s", cases[i].text, status ? error.message : "other coefficients");
        good = good && same;
    }
    ok(good, "coefficients of linear expressions");
    static const char *const refused[] = {"p[0]*p[1]", "1/p[0]", "p[4]", "p[-1]", "p[1/2]", "p[0]+1", "p[0]^2", "sqrt(p[0])",
                                        "sum(i in 1..1000000, sum(j in 1..1000000, p[0]))", "sum(i in 0..1/2, p[i])"};
    good = true;
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
        if (linear_read(refused[i], column, &error) != BCIFS_INPUT || error.line == 0) {
            note("%s is taken for linear", refused[i]);
            good = false;
        }
    ok(good, "what is not linear is refused");
}

int main(void)
{
    test_random();
    test_integers();
    test_meaning();
    test_exactness();
    test_refusals();
    test_limits();
    test_linear();
    return done_testing();
}
