/* Expressions, by recursive descent with one function for each level of precedence. Inside the brackets of a
 * matrix the same functions read one entry, which white space ends. */
#include "language/parser.h"

#include <string.h>

#include "base/decimal.h"
#include "numeric/field.h"

enum {
    EXACT_DIGITS = 14, /* a decimal of more significant digits is taken for a rounded real number */
    LARGEST_EXPONENT = 1000 * 1000 * 1000 /* beyond it the residue is not computed */
};

/* ---- Nodes --------------------------------------------------------------------------------------------- */

static struct expression *new_node(struct parser *p, enum expression_kind kind, source_place place,
                                   size_t count)
{
    struct expression *node = parser_new(p, 1, sizeof *node);
    if (!node)
        return NULL;
    *node = (struct expression){.kind = kind, .place = place, .count = count, .height = 1};
    if (count > 0) {
        node->operands = parser_new(p, count, sizeof *node->operands);
        if (!node->operands)
            return NULL;
    }
    return node;
}

/* Completes a node whose operands and first token are set and whose last token was just read. */
static struct expression *close_node(struct parser *p, struct expression *node)
{
    for (size_t i = 0; i < node->count; i++)
        if (node->operands[i]->height >= node->height)
            node->height = node->operands[i]->height + 1;
    node->last = p->next - 1;
    if (node->height > SYNTAX_TALLEST) {
        parser_error(p, node->place,
                     "this expression has more than %d operations on top of each other, the limit",
                     SYNTAX_TALLEST);
        return NULL;
    }
    return node;
}

/* ---- Numbers ------------------------------------------------------------------------------------------- */

/* The parts of a decimal literal: its value is ±digits · 10^exponent. */
struct literal {
    uint64_t residue;   /* of the digits read as one integer */
    size_t significant; /* digits from the first that is not 0 */
    int64_t exponent;
    bool plain; /* neither point nor exponent */
};

static struct literal read_literal(const char *text, size_t length)
{
    struct literal literal = {.plain = true};
    size_t i = 0;
    bool after_point = false;
    for (; i < length && text[i] != 'e' && text[i] != 'E'; i++) {
        if (text[i] == '.') {
            after_point = true;
            literal.plain = false;
            continue;
        }
        uint64_t digit = (uint64_t)(text[i] - '0');
        literal.residue = field_add(field_multiply(literal.residue, 10), digit);
        literal.significant += literal.significant > 0 || digit > 0;
        literal.exponent -= after_point;
    }
    if (i == length)
        return literal;
    literal.plain = false;
    int64_t written = 0;
    bool negative = text[i + 1] == '-';
    for (i += text[i + 1] == '-' || text[i + 1] == '+' ? 2 : 1; i < length; i++)
        if (written <= LARGEST_EXPONENT)
            written = 10 * written + (text[i] - '0');
    literal.exponent += negative ? -written : written;
    return literal;
}

/* Fills in the value of a number node: in doubles, and in the field as digits · 10^±k. */
static bool set_value(struct expression *node, const char *text, size_t length)
{
    if (!decimal_parse(text, length, &node->number))
        return false;
    struct literal literal = read_literal(text, length);
    bool huge = literal.exponent > LARGEST_EXPONENT || literal.exponent < -LARGEST_EXPONENT;
    uint64_t power = 1;
    if (!huge && literal.exponent >= 0)
        power = field_power(10, (uint64_t)literal.exponent);
    else if (!huge)
        power = field_power(field_invert(10), (uint64_t)-literal.exponent);
    node->residue = field_multiply(literal.residue, power);
    node->exact = literal.plain || (!huge && literal.significant <= EXACT_DIGITS);
    return true;
}

/* NUMBER */
struct expression *parse_number(struct parser *p)
{
    const struct token *token = parser_next(p);
    struct expression *node = new_node(p, EXPRESSION_NUMBER, token->place, 0);
    if (!node)
        return NULL;
    if (!set_value(node, p->file->source->text + token->place, token->length)) {
        parser_error(p, token->place, "this number is too large: the largest is about 1.8e308");
        return NULL;
    }
    node->first = p->next++;
    return close_node(p, node);
}

/* ---- Operands ------------------------------------------------------------------------------------------ */

/* "(" expr { "," expr } ")" */
bool parse_arguments(struct parser *p, struct expression ***arguments, size_t *count)
{
    bool in_row = p->in_row;
    size_t capacity = 0;
    if (!parser_expect_mark(p, "(", "before the arguments") || !parser_enter(p))
        return false;
    p->in_row = false;
    do {
        struct expression *argument = parse_expression(p);
        if (!argument || !PARSER_RESERVE(p, *arguments, *count, capacity))
            return false;
        (*arguments)[(*count)++] = argument;
    } while (parser_accept_mark(p, ","));
    p->in_row = in_row;
    parser_leave(p);
    return parser_expect_mark(p, ")", "or ',' after an argument");
}

/* primary = "(" expr ")" | … */
static struct expression *parse_parenthesized(struct parser *p)
{
    bool in_row = p->in_row;
    uint32_t first = p->next++;
    if (!parser_enter(p))
        return NULL;
    p->in_row = false;
    struct expression *node = parse_expression(p);
    if (!node || !parser_expect_mark(p, ")", "or an operator"))
        return NULL;
    p->in_row = in_row;
    parser_leave(p);
    node->first = first;
    node->last = p->next - 1;
    return node;
}

/* primary = "p" "[" expr "]" | …, in rules only */
static struct expression *parse_point(struct parser *p)
{
    source_place place = parser_next(p)->place;
    if (!p->in_rules) {
        parser_error(p, place,
                     "expected an expression, found a control point 'p[': it may stand only in rules, as in "
                     "sub arc { q[0] = p[0] }");
        return NULL;
    }
    struct expression *node = new_node(p, EXPRESSION_POINT, place, 1);
    if (!node)
        return NULL;
    node->first = p->next;
    p->next += 2;
    if (!parser_enter(p))
        return NULL;
    node->operands[0] = parse_expression(p);
    parser_leave(p);
    if (!node->operands[0] || !parser_expect_mark(p, "]", "or an operator after the point's index"))
        return NULL;
    return close_node(p, node);
}

/* primary = "sum" "(" NAME "in" expr ".." expr "," expr ")" | …, in rules only */
static struct expression *parse_sum(struct parser *p)
{
    source_place place = parser_next(p)->place;
    if (!p->in_rules) {
        parser_error(p, place,
                     "expected an expression, found a sum over an index: it may stand only in rules, as in "
                     "sub arc { q[0] = sum(i in 0..3, p[i]/4) }");
        return NULL;
    }
    struct expression *node = new_node(p, EXPRESSION_SUM, place, 3);
    if (!node || !parser_enter(p))
        return NULL;
    node->first = p->next;
    p->next += 2;
    node->name = parser_name(p, "the sum's index", NULL);
    p->next++;
    if (!node->name || !(node->operands[0] = parse_expression(p)) ||
        !parser_expect_mark(p, "..", "between the bounds of the sum") ||
        !(node->operands[1] = parse_expression(p)) ||
        !parser_expect_mark(p, ",", "after the bounds of the sum") ||
        !(node->operands[2] = parse_expression(p)) || !parser_expect_mark(p, ")", "after the sum"))
        return NULL;
    parser_leave(p);
    return close_node(p, node);
}

/* primary = NAME [ "(" expr { "," expr } ")" ] | … */
static struct expression *parse_name(struct parser *p)
{
    const struct token *after = parser_after(p);
    bool call = token_is_mark(p, after, "(") && !(p->in_row && after->space_before);
    struct expression *node = new_node(p, call ? EXPRESSION_CALL : EXPRESSION_NAME, parser_next(p)->place, 0);
    if (!node)
        return NULL;
    node->first = p->next;
    node->name = parser_name(p, "a name", NULL);
    if (!node->name || (call && !parse_arguments(p, &node->operands, &node->count)))
        return NULL;
    return close_node(p, node);
}

/* Whether "sum" "(" NAME "in" follows. */
static bool at_sum(const struct parser *p)
{
    return parser_at_word(p, "sum") && token_is_mark(p, parser_after(p), "(") &&
           parser_token(p, p->next + 2)->kind == TOKEN_NAME &&
           token_is_word(p, parser_token(p, p->next + 3), "in");
}

/* primary = NUMBER | NAME … | "(" expr ")" | "p" "[" expr "]" | "sum" "(" … ")" */
static struct expression *parse_primary(struct parser *p)
{
    const struct token *token = parser_next(p), *after = parser_after(p);
    if (token->kind == TOKEN_NUMBER)
        return parse_number(p);
    if (token_is_mark(p, token, "("))
        return parse_parenthesized(p);
    if (token_is_word(p, token, "p") && token_is_mark(p, after, "["))
        return parse_point(p);
    if (token_is_word(p, token, "q") && token_is_mark(p, after, "[")) {
        parser_error(
            p, token->place,
            "expected an expression, found a new point 'q[': it may stand only on the left of a rule");
        return NULL;
    }
    if (at_sum(p))
        return parse_sum(p);
    if (token->kind == TOKEN_NAME)
        return parse_name(p);
    if (token_is_mark(p, token, "?"))
        parser_error(p, token->place,
                     "expected an expression, found '?': it may stand only as a whole entry of a matrix");
    else
        parser_expected(p, "an expression");
    return NULL;
}

/* ---- Operators ----------------------------------------------------------------------------------------- */

static const char OPERATORS[] = "+-*/%^";

static bool is_operator(const struct parser *p, const struct token *token, const char *operators)
{
    return token->kind == TOKEN_MARK && token->length == 1 &&
           strchr(operators, p->file->source->text[token->place]) != NULL;
}

static void spaced_operator(struct parser *p, const struct token *token)
{
    parser_error(
        p, token->place,
        "expected an entry, found '%c' with a space beside it: inside [ ] an operator with spaces around it "
        "must go in parentheses, as in (1 - a)",
        p->file->source->text[token->place]);
}

/* Inside brackets, whether the token after an operand may follow it: `1-a` goes on, `1 -a` is two entries,
 * and every other use of spaces is reported. */
static bool check_spacing(struct parser *p)
{
    const struct token *token = parser_next(p);
    if (!p->in_row || !is_operator(p, token, OPERATORS))
        return true;
    bool after = parser_after(p)->space_before;
    if (!after && (!token->space_before || is_operator(p, token, "+-")))
        return true;
    spaced_operator(p, token);
    return false;
}

/* Whether a binary operator out of `operators` goes on with the expression. */
static bool at_operator(const struct parser *p, const char *operators)
{
    const struct token *token = parser_next(p);
    return is_operator(p, token, operators) && !(p->in_row && token->space_before);
}

static enum expression_kind operator_kind(char character)
{
    switch (character) {
    case '+':
        return EXPRESSION_ADD;
    case '-':
        return EXPRESSION_SUBTRACT;
    case '*':
        return EXPRESSION_MULTIPLY;
    case '/':
        return EXPRESSION_DIVIDE;
    case '%':
        return EXPRESSION_REMAINDER;
    default:
        return EXPRESSION_POWER;
    }
}

typedef struct expression *parse_operand(struct parser *p);

/* left operator right, the operator being next. */
static struct expression *parse_right(struct parser *p, struct expression *left, parse_operand *operand)
{
    source_place place = parser_next(p)->place;
    struct expression *node = new_node(p, operator_kind(p->file->source->text[place]), place, 2);
    if (!node)
        return NULL;
    p->next++;
    node->first = left->first;
    node->operands[0] = left;
    node->operands[1] = operand(p);
    return node->operands[1] ? close_node(p, node) : NULL;
}

static struct expression *parse_signed(struct parser *p);

/* power = primary [ "^" signed ] */
static struct expression *parse_power(struct parser *p)
{
    struct expression *node = parse_primary(p);
    if (!node || !check_spacing(p))
        return NULL;
    if (!at_operator(p, "^"))
        return node;
    if (!parser_enter(p))
        return NULL;
    node = parse_right(p, node, parse_signed);
    parser_leave(p);
    return node;
}

/* signed = { "+" | "-" } power */
static struct expression *parse_signed(struct parser *p)
{
    const struct token *token = parser_next(p);
    if (!is_operator(p, token, "+-"))
        return parse_power(p);
    if (p->in_row && parser_after(p)->space_before) {
        spaced_operator(p, token);
        return NULL;
    }
    if (!parser_enter(p))
        return NULL;
    uint32_t first = p->next++;
    struct expression *operand = parse_signed(p), *node = operand;
    parser_leave(p);
    if (!operand)
        return NULL;
    if (is_operator(p, token, "-")) {
        node = new_node(p, EXPRESSION_NEGATE, token->place, 1);
        if (!node)
            return NULL;
        node->operands[0] = operand;
        node = close_node(p, node);
    }
    if (node)
        node->first = first;
    return node;
}

/* term = signed { ("*" | "/" | "%") signed } */
static struct expression *parse_term(struct parser *p)
{
    struct expression *node = parse_signed(p);
    while (node && at_operator(p, "*/%"))
        node = parse_right(p, node, parse_signed);
    return node;
}

/* expr = term { ("+" | "-") term } */
struct expression *parse_expression(struct parser *p)
{
    struct expression *node = parse_term(p);
    while (node && at_operator(p, "+-"))
        node = parse_right(p, node, parse_term);
    return node;
}

/* entry = expr | "?" */
struct expression *parse_entry(struct parser *p)
{
    const struct token *token = parser_next(p);
    if (!token_is_mark(p, token, "?")) {
        return parse_expression(p);
    }
    struct expression *node = new_node(p, EXPRESSION_UNKNOWN, token->place, 0);
    if (!node)
        return NULL;
    node->first = p->next++;
    if (at_operator(p, OPERATORS)) {
        parser_error(p, token->place, "'?' may stand only as a whole entry of a matrix");
        return NULL;
    }
    return close_node(p, node);
}
