/* Figures, and the filters that the editor uses on them. */
#include "language/parser.h"

static const char *const PART_WORDS[] = {"open",      "closed", "piece",   "size",
                                         "intervals", "points", "displace"};
static const struct word_list PARTS = {PART_WORDS, sizeof PART_WORDS / sizeof PART_WORDS[0]};

/* Whether a part begins at token `index`: a keyword at the start of a line or followed by what the part
 * wants. */
static bool part_starts(const struct parser *p, uint32_t index)
{
    const struct token *token = parser_token(p, index), *after = parser_token(p, index + 1);
    int kind = token_find_word(p, token, &PARTS);
    if (kind < 0)
        return false;
    if (token->line_before)
        return true;
    if (kind == FIGURE_INTERVALS || kind == FIGURE_POINTS)
        return token_is_mark(p, after, "[");
    return after->kind == (kind == FIGURE_SIZE || kind == FIGURE_DISPLACE ? TOKEN_NUMBER : TOKEN_NAME);
}

/* NUMBER { NUMBER }, from `least` to `most` of them */
static bool parse_numbers(struct parser *p, struct syntax_figure_part *part, const char *what, size_t least,
                          size_t most)
{
    size_t capacity = 0, place_capacity = 0, count = 0;
    while (count < least || (count < most && parser_next(p)->kind == TOKEN_NUMBER)) {
        uint64_t number;
        source_place place;
        if (!parser_integer(p, what, 0, PARSER_MOST_INTEGER, &number, &place) ||
            !PARSER_RESERVE(p, part->numbers, count, capacity) ||
            !PARSER_RESERVE(p, part->number_places, count, place_capacity))
            return false;
        part->numbers[count] = number;
        part->number_places[count++] = place;
    }
    part->number_count = count;
    return true;
}

/* What follows the keyword of a figure's part. */
static bool parse_part_body(struct parser *p, struct syntax_figure_part *part)
{
    switch (part->kind) {
    case FIGURE_OPEN: /* ("open" | "closed") ref */
    case FIGURE_CLOSED:
        return (part->reference = parse_reference(p, "the state of the pieces")) != NULL;
    case FIGURE_PIECE: /* "piece" ref "at" NUMBER { NUMBER } */
        return (part->reference = parse_reference(p, "the state of the piece")) != NULL &&
               parser_expect_word(p, "at", "and the piece's control points") &&
               parse_numbers(p, part, "a control point's index", 1, SIZE_MAX);
    case FIGURE_SIZE: /* "size" NUMBER NUMBER */
        return parse_numbers(p, part, "a number of rows or columns", 2, 2);
    case FIGURE_INTERVALS: /* "intervals" matrix */
        return (part->matrix = parse_matrix(p, "and the intervals")) != NULL;
    case FIGURE_POINTS: /* "points" matrix */
        return (part->matrix = parse_matrix(p, "and the control points, one a row")) != NULL;
    case FIGURE_DISPLACE: /* "displace" NUMBER NUMBER [ NUMBER ] matrix */
        return parse_numbers(p, part, "a level or the index of a point", 2, 3) &&
               (part->matrix = parse_matrix(p, "and the displacement")) != NULL;
    }
    return false;
}

/* figpart = ("open" | "closed") … | "piece" … | "size" … | "intervals" … | "points" … | "displace" … */
static struct syntax_figure_part *parse_part(struct parser *p, uint32_t open)
{
    struct syntax_figure_part *part = parser_new(p, 1, sizeof *part);
    if (!part)
        return NULL;
    int kind = token_find_word(p, parser_next(p), &PARTS);
    if (kind < 0) {
        parser_expected_part(p, open, &PARTS);
        return NULL;
    }
    part->kind = (enum figure_part_kind)kind;
    part->place = parser_next(p)->place;
    part->first = p->next++;
    if (!parse_part_body(p, part))
        return NULL;
    part->last = p->next - 1;
    return part;
}

/* { figpart } "}", the opening brace being behind */
static bool parse_parts(struct parser *p, struct syntax_figure *figure)
{
    size_t capacity = 0;
    uint32_t open = p->next - 1;
    while (!parser_accept_mark(p, "}")) {
        uint32_t first = p->next;
        struct syntax_figure_part *part = parse_part(p, open);
        if (part) {
            if (!PARSER_RESERVE(p, figure->parts, figure->part_count, capacity))
                return false;
            figure->parts[figure->part_count++] = part;
            continue;
        }
        parser_recover_part(p, first, part_starts);
        if (parser_stopped(p) || parser_next(p)->kind == TOKEN_END || parser_item_at_margin(p, p->next))
            return false;
    }
    return true;
}

/* figure = "figure" NAME "{" { figpart } "}" */
struct syntax_figure *parse_figure(struct parser *p)
{
    struct syntax_figure *figure = parser_new(p, 1, sizeof *figure);
    if (!figure)
        return NULL;
    figure->first = p->next++;
    figure->name = parser_name(p, "the figure's name", &figure->place);
    if (!figure->name || !parser_expect_mark(p, "{", "before the figure's parts") || !parse_parts(p, figure))
        return NULL;
    figure->last = p->next - 1;
    return figure;
}

/* INT matrix: INT is a NUMBER with or without a "-" */
static bool parse_filter(struct parser *p, int64_t *offset, struct syntax_matrix **matrix)
{
    bool negative = parser_accept_mark(p, "-");
    uint64_t number;
    if (!parser_integer(p, "the index of the filter's first coefficient", 0, PARSER_MOST_INTEGER, &number,
                        NULL))
        return false;
    *offset = negative ? -(int64_t)number : (int64_t)number;
    *matrix = parse_matrix(p, "and the filter's row of coefficients");
    return *matrix != NULL;
}

/* wavelet = "wavelet" ref "{" "smooth" INT matrix "detail" INT matrix "}" */
struct syntax_wavelet *parse_wavelet(struct parser *p)
{
    struct syntax_wavelet *wavelet = parser_new(p, 1, sizeof *wavelet);
    if (!wavelet)
        return NULL;
    wavelet->first = p->next++;
    wavelet->place = parser_next(p)->place;
    wavelet->reference = parse_reference(p, "the state that the filters are for");
    if (!wavelet->reference || !parser_expect_mark(p, "{", "before the filters") ||
        !parser_expect_word(p, "smooth", "and a filter") ||
        !parse_filter(p, &wavelet->smooth_offset, &wavelet->smooth) ||
        !parser_expect_word(p, "detail", "and a filter") ||
        !parse_filter(p, &wavelet->detail_offset, &wavelet->detail) ||
        !parser_expect_mark(p, "}", "after the filters"))
        return NULL;
    wavelet->last = p->next - 1;
    return wavelet;
}
