/* Cells: their kind, name, arguments and number of control points, then the parts between the braces. */
#include "language/parser.h"

static const char *const PART_WORDS[] = {"sub", "start", "end", "boundary", "join", "refine", "mask"};
static const struct word_list PARTS = {PART_WORDS, sizeof PART_WORDS / sizeof PART_WORDS[0]};

/* Whether a part begins at token `index`: a keyword that stands at the start of a line or is followed by what
 * the part wants, and is not a boundary's name behind a point (join 0.end = 1.start). */
static bool part_starts(const struct parser *p, uint32_t index)
{
    const struct token *token = parser_token(p, index), *after = parser_token(p, index + 1);
    int kind = token_find_word(p, token, &PARTS);
    if (kind < 0 || (index > 0 && token_is_mark(p, parser_token(p, index - 1), ".")))
        return false;
    bool numbered = kind == PART_JOIN || kind == PART_REFINE || kind == PART_MASK;
    return token->line_before || after->kind == (numbered ? TOKEN_NUMBER : TOKEN_NAME);
}

/* ---- References and locations -------------------------------------------------------------------------- */

/* ref = NAME [ "." NAME ] [ "(" expr { "," expr } ")" ] */
struct syntax_reference *parse_reference(struct parser *p, const char *what)
{
    struct syntax_reference *reference = parser_new(p, 1, sizeof *reference);
    if (!reference)
        return NULL;
    reference->first = p->next;
    reference->name = parser_name(p, what, &reference->place);
    if (!reference->name)
        return NULL;
    if (parser_accept_mark(p, ".")) {
        reference->module = reference->name;
        reference->name = parser_name(p, "a name after the '.'", NULL);
        if (!reference->name)
            return NULL;
    }
    reference->has_arguments = parser_at_mark(p, "(");
    if (reference->has_arguments && !parse_arguments(p, &reference->arguments, &reference->count))
        return NULL;
    reference->last = p->next - 1;
    return reference;
}

/* NUMBER { NUMBER } */
static bool parse_indices(struct parser *p, struct syntax_location *location)
{
    size_t capacity = 0;
    do {
        uint64_t value;
        uint32_t index = p->next;
        if (!parser_integer(p, "a control point's index", 0, PARSER_MOST_INTEGER, &value, NULL))
            return false;
        p->next = index;
        struct expression *number = parse_number(p);
        if (!number || !PARSER_RESERVE(p, location->indices, location->count, capacity))
            return false;
        location->indices[location->count++] = number;
    } while (parser_next(p)->kind == TOKEN_NUMBER);
    return true;
}

/* The row of index expressions behind "at". */
static bool parse_index_row(struct parser *p, struct syntax_location *location)
{
    struct syntax_matrix *row = location->row = parse_matrix(p, "before indices");
    if (!row)
        return false;
    if (row->rows != 1) {
        parser_error(p, row->entries[row->columns]->place,
                     "the indices after 'at' stand in one row, found %zu rows", row->rows);
        return false;
    }
    location->bracketed = true;
    location->indices = row->entries;
    location->count = row->columns;
    for (size_t i = 0; i < row->columns; i++)
        if (row->entries[i]->kind == EXPRESSION_UNKNOWN) {
            parser_error(p, row->entries[i]->place,
                         "expected an index, found '?': only a matrix has open entries");
            return false;
        }
    return true;
}

/* place = "at" ( NUMBER { NUMBER } | matrix ) | matrix */
static bool parse_location(struct parser *p, struct syntax_location *location)
{
    location->place = parser_next(p)->place;
    if (parser_accept_word(p, "at")) {
        if (parser_at_mark(p, "["))
            return parse_index_row(p, location);
        if (parser_next(p)->kind == TOKEN_NUMBER)
            return parse_indices(p, location);
        parser_expected(p, "control points' indices, as in at 0 1 or at [ n n+1 ]");
        return false;
    }
    if (!parser_at_mark(p, "[")) {
        parser_expected(p, "'at' and control points' indices, or a matrix in '[ ]'");
        return false;
    }
    return (location->matrix = parse_matrix(p, "")) != NULL;
}

/* ---- Parts --------------------------------------------------------------------------------------------- */

/* matrix | rules */
static bool parse_map(struct parser *p, struct syntax_part *part)
{
    if (parser_at_mark(p, "{"))
        return (part->rules = parse_rules(p)) != NULL;
    if (parser_at_mark(p, "["))
        return (part->matrix = parse_matrix(p, "")) != NULL;
    parser_expected(p, "a matrix in '[ ]' or rules in '{ }'");
    return false;
}

/* part = "sub" ref ( matrix | rules ) | … */
static bool parse_sub(struct parser *p, struct syntax_part *part)
{
    return (part->reference = parse_reference(p, "the child's state after 'sub'")) != NULL &&
           parse_map(p, part);
}

/* part = ("start" | "end") ref place | … */
static bool parse_end(struct parser *p, struct syntax_part *part)
{
    part->name = part->kind == PART_START ? "start" : "end";
    part->name_place = part->place;
    return (part->reference = parse_reference(p, "the boundary's state")) != NULL &&
           parse_location(p, &part->location);
}

/* part = "boundary" NAME "=" ref place | … */
static bool parse_boundary(struct parser *p, struct syntax_part *part)
{
    return (part->name = parser_name(p, "the boundary's name", &part->name_place)) != NULL &&
           parser_expect_mark(p, "=", "after the boundary's name") &&
           (part->reference = parse_reference(p, "the boundary's state")) != NULL &&
           parse_location(p, &part->location);
}

/* NUMBER "." NAME */
static bool parse_side(struct parser *p, struct syntax_part *part, int side)
{
    return parser_integer(p, "a child's number", 0, PARSER_MOST_INTEGER, &part->child[side],
                          &part->side[side]) &&
           parser_expect_mark(p, ".", "between the child's number and its boundary") &&
           (part->boundary[side] = parser_name(p, "the name of a boundary", NULL)) != NULL;
}

/* part = "join" NUMBER "." NAME "=" NUMBER "." NAME [ "reversed" ] | … */
static bool parse_join(struct parser *p, struct syntax_part *part)
{
    if (!parse_side(p, part, 0) || !parser_expect_mark(p, "=", "between the sides of the join") ||
        !parse_side(p, part, 1))
        return false;
    part->reversed = parser_accept_word(p, "reversed");
    return true;
}

/* part = "refine" NUMBER ( matrix | rules ) | "mask" NUMBER matrix | … */
static bool parse_numbered(struct parser *p, struct syntax_part *part)
{
    if (!parser_integer(p, "the number of subdivisions", 0, PARSER_MOST_INTEGER, &part->number,
                        &part->number_place))
        return false;
    if (part->kind == PART_REFINE)
        return parse_map(p, part);
    return (part->matrix = parse_matrix(p, "and the mask's row of coefficients")) != NULL;
}

/* part = "sub" … | ("start" | "end") … | "boundary" … | "join" … | "refine" … | "mask" … */
static struct syntax_part *parse_part(struct parser *p, uint32_t open)
{
    static bool (*const parsers[])(struct parser *, struct syntax_part *) = {
        [PART_SUB] = parse_sub,           [PART_START] = parse_end, [PART_END] = parse_end,
        [PART_BOUNDARY] = parse_boundary, [PART_JOIN] = parse_join, [PART_REFINE] = parse_numbered,
        [PART_MASK] = parse_numbered};
    struct syntax_part *part = parser_new(p, 1, sizeof *part);
    if (!part)
        return NULL;
    int kind = token_find_word(p, parser_next(p), &PARTS);
    if (kind < 0) {
        parser_expected_part(p, open, &PARTS);
        return NULL;
    }
    part->kind = (enum part_kind)kind;
    part->place = parser_next(p)->place;
    part->first = p->next++;
    if (!parsers[kind](p, part))
        return NULL;
    part->last = p->next - 1;
    return part;
}

/* { part } "}", the opening brace being behind */
static bool parse_parts(struct parser *p, struct syntax_cell *cell)
{
    size_t capacity = 0;
    uint32_t open = p->next - 1;
    while (!parser_accept_mark(p, "}")) {
        uint32_t first = p->next;
        struct syntax_part *part = parse_part(p, open);
        if (part) {
            if (!PARSER_RESERVE(p, cell->parts, cell->part_count, capacity))
                return false;
            cell->parts[cell->part_count++] = part;
            continue;
        }
        parser_recover_part(p, first, part_starts);
        if (parser_stopped(p) || parser_next(p)->kind == TOKEN_END || parser_item_at_margin(p, p->next))
            return false;
    }
    return true;
}

/* ---- Cells --------------------------------------------------------------------------------------------- */

/* cell = "face" NAME "=" ref "*" ref | …, from the "=" on */
static bool parse_product(struct parser *p, struct syntax_cell *cell)
{
    if (cell->kind != CELL_FACE) {
        parser_expected(p, "'{' (only a face is a product of two edges)");
        return false;
    }
    p->next++;
    return (cell->factors[0] = parse_reference(p, "the first edge of the product")) != NULL &&
           parser_expect_mark(p, "*", "between the edges of the product") &&
           (cell->factors[1] = parse_reference(p, "the second edge of the product")) != NULL;
}

/* [ expr | "affine" NUMBER ] */
static bool parse_points(struct parser *p, struct syntax_cell *cell)
{
    enum { MOST_DIMENSIONS = 16 };
    enum token_kind after = parser_after(p)->kind;
    if (parser_at_mark(p, "{"))
        return true;
    if (parser_at_word(p, "affine") && (after == TOKEN_NUMBER || after == TOKEN_NAME)) {
        p->next++;
        cell->affine = true;
        return parser_integer(p, "the dimension after 'affine'", 1, MOST_DIMENSIONS, &cell->dimension,
                              &cell->dimension_place);
    }
    if (parser_next(p)->kind == TOKEN_END || (parser_next(p)->kind == TOKEN_MARK && !parser_at_mark(p, "-") &&
                                              !parser_at_mark(p, "+") && !parser_at_mark(p, "("))) {
        parser_expected(p, "the number of control points or '{'");
        return false;
    }
    return (cell->points = parse_expression(p)) != NULL;
}

/* cell = kind NAME [ "(" NAME { "," NAME } ")" ] [ expr | "affine" NUMBER ] "{" { part } "}"
 *      | "face" NAME "=" ref "*" ref */
struct syntax_cell *parse_cell(struct parser *p)
{
    static const char *const words[] = {"vertex", "edge", "face", "cell"};
    static const struct word_list kinds = {words, sizeof words / sizeof words[0]};
    struct syntax_cell *cell = parser_new(p, 1, sizeof *cell);
    if (!cell)
        return NULL;
    cell->kind = (enum cell_kind)token_find_word(p, parser_next(p), &kinds);
    cell->first = p->next++;
    cell->name = parser_name(p, "the cell's name", &cell->place);
    bool good = cell->name != NULL;
    if (good && parser_at_mark(p, "=")) {
        good = parse_product(p, cell);
    } else if (good) {
        if (parser_at_mark(p, "("))
            good = parse_argument_names(p, &cell->arguments, &cell->argument_places, &cell->argument_count);
        good = good && parse_points(p, cell) && parser_expect_mark(p, "{", "before the cell's parts") &&
               parse_parts(p, cell);
    }
    cell->last = p->next - 1;
    return good ? cell : NULL;
}

const struct syntax_part *syntax_part_of_kind(const struct syntax_cell *cell, enum part_kind kind,
                                              size_t number)
{
    for (size_t i = 0; i < cell->part_count; i++)
        if (cell->parts[i]->kind == kind && number-- == 0)
            return cell->parts[i];
    return NULL;
}
