/* The two ways to write a map: a matrix, whose layout has a meaning, and rules, as a geometer writes them. */
#include "language/parser.h"

/* ---- Matrices ------------------------------------------------------------------------------------------ */

/* A matrix while it is read. */
struct rows {
    struct syntax_matrix *matrix;
    size_t count, capacity; /* entries */
    /* The first row with another number of entries than row 1. It is reported at the end, and alone: a matrix
     * that is never closed has rows that are none, and if row 1 is wrong, all others would be. */
    size_t ragged, ragged_count;
    source_place ragged_place;
};

static void expected_in_matrix(struct parser *p, const struct rows *rows, const char *what)
{
    unsigned line, column;
    source_locate(p->file->source, rows->matrix->place, &line, &column);
    parser_expected(p, "%s or the ']' that closes the '[' of line %u", what, line);
}

/* What stands after an entry must keep it apart from the next one. */
static bool check_end_of_entry(struct parser *p, const struct rows *rows)
{
    const struct token *token = parser_next(p);
    if (token->space_before || token_is_mark(p, token, ";") || token_is_mark(p, token, "]"))
        return true;
    expected_in_matrix(p, rows, "white space, ';'");
    return false;
}

/* row = entry { WHITE-SPACE entry } */
static bool parse_row(struct parser *p, struct rows *rows)
{
    struct syntax_matrix *matrix = rows->matrix;
    source_place place = parser_next(p)->place;
    size_t before = rows->count;
    do {
        const struct token *token = parser_next(p);
        if (token->kind == TOKEN_END || token_is_mark(p, token, "}") || token_is_mark(p, token, "{") ||
            token_is_mark(p, token, "[") || token_is_mark(p, token, "=")) {
            expected_in_matrix(p, rows, "an entry");
            return false;
        }
        if (rows->count == SYNTAX_MOST_ENTRIES) {
            parser_error(p, token->place, "a matrix may have %d entries", SYNTAX_MOST_ENTRIES);
            return false;
        }
        struct expression *entry = parse_entry(p);
        if (!entry || !check_end_of_entry(p, rows) ||
            !PARSER_RESERVE(p, matrix->entries, rows->count, rows->capacity))
            return false;
        matrix->entries[rows->count++] = entry;
    } while (!parser_next(p)->line_before && !parser_at_mark(p, ";") && !parser_at_mark(p, "]"));

    size_t found = rows->count - before;
    if (matrix->rows++ == 0)
        matrix->columns = found;
    if (found != matrix->columns && rows->ragged == 0) {
        rows->ragged = matrix->rows;
        rows->ragged_count = found;
        rows->ragged_place = place;
    }
    return true;
}

/* matrix = "[" row { ( ";" | NEWLINE ) row } "]" */
struct syntax_matrix *parse_matrix(struct parser *p, const char *context)
{
    struct rows rows = {.matrix = parser_new(p, 1, sizeof *rows.matrix)};
    if (!rows.matrix)
        return NULL;
    rows.matrix->first = p->next;
    rows.matrix->place = parser_next(p)->place;
    if (!parser_expect_mark(p, "[", context))
        return NULL;
    p->in_row = true;
    while (!parser_at_mark(p, "]") || rows.matrix->rows == 0) {
        if (parser_at_mark(p, ";") || parser_at_mark(p, "]")) {
            parser_expected(p, "an entry: a row may not be empty");
            return NULL;
        }
        if (!parse_row(p, &rows))
            return NULL;
        parser_accept_mark(p, ";");
    }
    p->in_row = false;
    rows.matrix->last = p->next++;
    if (rows.ragged > 0)
        parser_error(p, rows.ragged_place, "row %zu has %zu %s, expected %zu as in row 1", rows.ragged,
                     rows.ragged_count, rows.ragged_count == 1 ? "entry" : "entries", rows.matrix->columns);
    return rows.matrix;
}

/* ---- Rules --------------------------------------------------------------------------------------------- */

/* rule = "q" "[" expr "]" "=" linear | … */
static bool parse_assignment(struct parser *p, struct syntax_rule *rule)
{
    p->next += 2;
    return (rule->index = parse_expression(p)) != NULL &&
           parser_expect_mark(p, "]", "or an operator after the new point's index") &&
           parser_expect_mark(p, "=", "after the new point") && (rule->value = parse_expression(p)) != NULL;
}

/* rule = "for" NAME "in" expr ".." expr "{" { rule } "}" | … */
static bool parse_loop(struct parser *p, struct syntax_rule *rule)
{
    p->next++;
    rule->is_loop = true;
    if (!parser_enter(p))
        return false;
    rule->variable = parser_name(p, "the loop's index after 'for'", &rule->variable_place);
    bool good = rule->variable && parser_expect_word(p, "in", "after the loop's index") &&
                (rule->from = parse_expression(p)) != NULL &&
                parser_expect_mark(p, "..", "between the bounds of the loop") &&
                (rule->to = parse_expression(p)) != NULL && (rule->body = parse_rules(p)) != NULL;
    parser_leave(p);
    return good;
}

/* rule = "q" "[" … | "for" … */
static struct syntax_rule *parse_rule(struct parser *p, uint32_t open)
{
    struct syntax_rule *rule = parser_new(p, 1, sizeof *rule);
    if (!rule)
        return NULL;
    rule->first = p->next;
    rule->place = parser_next(p)->place;
    bool good = false;
    if (parser_at_word(p, "for"))
        good = parse_loop(p, rule);
    else if (parser_at_word(p, "q") && token_is_mark(p, parser_after(p), "["))
        good = parse_assignment(p, rule);
    else if (parser_next(p)->kind == TOKEN_END)
        parser_expected_closing(p, open);
    else
        parser_expected(p, "'}' or a rule, q[…] = … or for … in …");
    rule->last = p->next - 1;
    return good ? rule : NULL;
}

/* rules = "{" { rule } "}" */
struct syntax_rules *parse_rules(struct parser *p)
{
    struct syntax_rules *rules = parser_new(p, 1, sizeof *rules);
    size_t capacity = 0;
    bool in_rules = p->in_rules;
    if (!rules)
        return NULL;
    rules->first = p->next;
    rules->place = parser_next(p)->place;
    if (!parser_expect_mark(p, "{", "and rules"))
        return NULL;
    p->in_rules = true;
    while (!parser_at_mark(p, "}")) {
        struct syntax_rule *rule = parse_rule(p, rules->first);
        if (!rule || !PARSER_RESERVE(p, rules->rules, rules->count, capacity))
            return NULL;
        rules->rules[rules->count++] = rule;
    }
    p->in_rules = in_rules;
    rules->last = p->next++;
    return rules;
}
