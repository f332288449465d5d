/* The canonical layout. The printer walks the tree for the structure and hands out the file's own tokens,
 * each once and in order; what stood between two tokens (comments, blank lines) is dealt with as the second
 * one is put.
 *
 * A construct that the source has on one line is first tried on one line; if that passes LINE_LONGEST
 * columns, the text is taken back and the construct is broken. As one that is broken is never joined again
 * (but for a matrix of one row, which has no other form), formatting twice gives what formatting once gave. A
 * comment ends its line: a token behind it goes on the next line, further to the right when the line was not
 * to end there. */
#include "language/syntax.h"

#include <string.h>

#include "base/memory.h"

enum {
    LINE_LONGEST = 100,
    INDENT = 2,
    HANG = 4,              /* further indentation of a line that continues one cut by a comment */
    PADDED_LONGEST = 40,   /* wider entries are not lined up with: a long one would pad every row */
    FARTHEST_COLUMN = 100, /* rows of a matrix that begins behind this column are not aligned with it */
    TOKENS_PER_LINE = 200, /* more tokens cannot fit in LINE_LONGEST, so no attempt is made */
    NESTING = SYNTAX_DEEPEST + 2
};

struct printer {
    const struct syntax_file *file;
    const char *source;
    struct text *text;
    uint32_t next;    /* token to put */
    uint32_t comment; /* comment to put */
    size_t end;       /* where the last token or comment put ends in the source */
    size_t column;    /* bytes on the current line of the output */
    size_t indent;    /* of the lines of the current block */
    size_t hang;      /* of a line that continues one cut by a comment */
    bool flat;        /* an attempt to stay on one line */
    bool too_long;    /* it failed: nothing more is written */
};

/* How a line break treats the blank lines and comments of the source. */
struct line_style {
    size_t comments, token; /* columns */
    bool after_open;        /* no blank line first */
    bool before_close;      /* no blank line last */
    bool separate;          /* at least one blank line */
};

/* ---- Bytes --------------------------------------------------------------------------------------------- */

static void write_bytes(struct printer *p, const char *bytes, size_t length)
{
    if (p->too_long)
        return;
    text_append_bytes(p->text, bytes, length);
    p->column += length;
    p->too_long = p->flat && p->column > LINE_LONGEST;
}

static void write_spaces(struct printer *p, size_t count)
{
    if (p->too_long)
        return;
    text_append_character(p->text, ' ', count);
    p->column += count;
}

static void write_newline(struct printer *p, size_t count, size_t column)
{
    if (p->text->length > 0)
        text_append_character(p->text, '\n', count);
    p->column = 0;
    write_spaces(p, column);
}

/* ---- What stands between tokens ------------------------------------------------------------------------ */

static const struct token *next_token(const struct printer *p)
{
    return &p->file->tokens[p->next];
}

/* The next comment, if it stands before the next token; otherwise NULL. */
static const struct comment *next_comment(const struct printer *p)
{
    if (p->comment == p->file->comment_count)
        return NULL;
    const struct comment *comment = &p->file->comments[p->comment];
    return comment->place < next_token(p)->place ? comment : NULL;
}

/* Whether the source has a newline between the last thing put and `place`. */
static bool newline_before(const struct printer *p, size_t place)
{
    return memchr(p->source + p->end, '\n', place - p->end) != NULL;
}

/* Whether it has a line with nothing but white space there. */
static bool blank_before(const struct printer *p, size_t place)
{
    bool newline = p->end == 0;
    for (size_t i = p->end; i < place; i++) {
        char c = p->source[i];
        if (c == '\n' && newline)
            return true;
        newline = c == '\n' || (newline && (c == ' ' || c == '\t' || c == '\r'));
    }
    return false;
}

static void write_comment(struct printer *p)
{
    const struct comment *comment = &p->file->comments[p->comment++];
    write_bytes(p, p->source + comment->place, comment->length);
    p->end = comment->place + comment->length;
}

/* A comment on the line of the last token stays there. */
static void put_trailing_comment(struct printer *p)
{
    const struct comment *comment = next_comment(p);
    if (!comment || p->end == 0 || newline_before(p, comment->place))
        return;
    write_spaces(p, 2);
    write_comment(p);
}

/* Ends the line: puts the comments before the next token and goes to the column where it begins. */
static void break_line(struct printer *p, struct line_style style)
{
    size_t place = next_token(p)->place;
    bool add_blank = style.separate && !blank_before(p, place);
    bool first = true;
    put_trailing_comment(p);
    for (const struct comment *comment; (comment = next_comment(p)) != NULL; first = false) {
        bool blank = blank_before(p, comment->place) && !(first && style.after_open);
        write_newline(p, blank || (first && add_blank) ? 2 : 1, style.comments);
        write_comment(p);
    }
    bool blank = blank_before(p, place) && !(first && style.after_open) && !style.before_close;
    write_newline(p, blank || (first && add_blank) ? 2 : 1, style.token);
}

/* ---- Tokens -------------------------------------------------------------------------------------------- */

static bool is_word_byte(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/* Whether a space is needed to keep the next token apart from what was written: two words, or `..` and `.5`.
 */
static bool needs_space(const struct printer *p)
{
    if (p->column == 0 || p->text->length == 0)
        return false;
    char last = p->text->data[p->text->length - 1], first = p->source[next_token(p)->place];
    return (is_word_byte(last) && is_word_byte(first)) || (last == '.' && first == '.');
}

static void write_token(struct printer *p)
{
    const struct token *token = next_token(p);
    write_bytes(p, p->source + token->place, token->length);
    p->end = token->place + token->length;
    p->next++;
}

/* Puts the next token on the current line behind `spaces`, or on the next line if a comment comes first. */
static void put(struct printer *p, size_t spaces)
{
    if (next_comment(p))
        break_line(p, (struct line_style){
                          .comments = p->hang, .token = p->hang, .after_open = true, .before_close = true});
    else
        write_spaces(p, spaces == 0 && needs_space(p) ? 1 : spaces);
    write_token(p);
}

static bool is_mark(const struct printer *p, uint32_t index, char mark)
{
    const struct token *token = &p->file->tokens[index];
    return token->kind == TOKEN_MARK && token->length == 1 && p->source[token->place] == mark;
}

/* Whether tokens first..last stand on one line of the source and could on one of the output. */
static bool is_one_line(const struct printer *p, uint32_t first, uint32_t last)
{
    if (last - first > TOKENS_PER_LINE)
        return false;
    for (uint32_t i = first + 1; i <= last; i++)
        if (p->file->tokens[i].line_before)
            return false;
    return true;
}

/* Where to go back to when an attempt to stay on one line fails. */
struct attempt {
    struct printer before;
    size_t length;
};

/* Begins an attempt to put tokens first..last on one line, if the source has them so. */
static bool begin_flat(struct printer *p, uint32_t first, uint32_t last, struct attempt *attempt)
{
    if (!is_one_line(p, first, last))
        return false;
    *attempt = (struct attempt){*p, p->text->length};
    p->flat = true;
    return true;
}

/* Ends it: true if all is on the line, otherwise everything is as before. */
static bool end_flat(struct printer *p, const struct attempt *attempt)
{
    p->flat = attempt->before.flat;
    if (!p->too_long)
        return true;
    *p = attempt->before;
    p->text->length = attempt->length;
    if (p->text->data)
        p->text->data[attempt->length] = '\0';
    return false;
}

/* ---- Expressions --------------------------------------------------------------------------------------- */

/* What the spacing of a token inside an expression depends on. */
struct spacing {
    bool spaced;         /* outside matrices: spaces around + and - at depth 0 */
    unsigned depth;      /* of parentheses and p[ ] */
    bool operand;        /* the token before ends an operand, so that + and - are binary */
    bool name, in;       /* it is a name; it is the `in` of a sum */
    bool binary;         /* it is a binary + or - with spaces around it */
    bool range[NESTING]; /* `..` was seen at that depth: the next comma is a sum's */
    bool comma;          /* the token before is such a comma */
};

/* The number of spaces before the next token, which `s` then takes into account. */
static size_t space_before(const struct printer *p, struct spacing *s)
{
    const struct token *token = next_token(p);
    char c = p->source[token->place];
    bool mark = token->kind == TOKEN_MARK, range = mark && token->length == 2;
    bool in = token->kind == TOKEN_NAME && s->name;
    bool binary = mark && (c == '+' || c == '-') && s->operand && s->spaced && s->depth == 0;
    size_t spaces = in || s->in || s->binary || s->comma || binary;
    if (mark && (c == '(' || c == '[') && s->depth + 1 < NESTING)
        s->range[++s->depth] = false;
    if (mark && (c == ')' || c == ']') && s->depth > 0)
        s->depth--;
    s->comma = mark && c == ',' && s->range[s->depth];
    s->range[s->depth] = range || (s->range[s->depth] && !s->comma);
    s->operand = (!mark && !in) || c == ')' || c == ']' || c == '?';
    s->name = token->kind == TOKEN_NAME && !in;
    s->in = in;
    s->binary = binary;
    return spaces;
}

/* Puts tokens up to `last`, an expression or a reference, behind `spaces`. */
static void put_run(struct printer *p, size_t spaces, uint32_t last, bool spaced)
{
    struct spacing spacing = {.spaced = spaced};
    space_before(p, &spacing);
    put(p, spaces);
    while (p->next <= last && !p->too_long)
        put(p, space_before(p, &spacing));
    p->next = last + 1;
}

static void put_expression(struct printer *p, size_t spaces, const struct expression *expression)
{
    put_run(p, spaces, expression->last, true);
}

static void put_reference(struct printer *p, size_t spaces, const struct syntax_reference *reference)
{
    put_run(p, spaces, reference->last, false);
}

/* from..to, the token `..` between them */
static void put_range(struct printer *p, const struct expression *from, const struct expression *to)
{
    put_run(p, 1, from->last, false);
    put(p, 0);
    put_run(p, 0, to->last, false);
}

/* ---- Matrices ------------------------------------------------------------------------------------------ */

/* The width of an entry as it is written, without spaces; SIZE_MAX if a comment stands inside. */
static size_t entry_width(const struct printer *p, const struct expression *entry)
{
    size_t width = 0;
    const struct token *tokens = p->file->tokens;
    for (uint32_t i = entry->first; i <= entry->last; i++) {
        size_t gap = i == entry->first ? tokens[i].place : tokens[i - 1].place + tokens[i - 1].length;
        if (memchr(p->source + gap, '#', tokens[i].place - gap))
            return SIZE_MAX;
        width += tokens[i].length;
    }
    return width;
}

/* How a column of a broken matrix is aligned: on the left, behind a place for signs if an entry has one. */
struct column {
    size_t width; /* of the widest entry, the place for signs included */
    bool sign;
};

static bool has_sign(const struct printer *p, const struct expression *entry)
{
    return p->source[p->file->tokens[entry->first].place] == '-';
}

/* Spaces before an entry that leave the place for a sign free. */
static size_t sign_space(const struct printer *p, const struct column *columns, size_t j,
                         const struct expression *entry)
{
    return columns && columns[j].sign && !has_sign(p, entry);
}

/* Puts the entries of one row behind each other; `columns` (NULL: no alignment) says how they line up. */
static void put_row(struct printer *p, const struct syntax_matrix *matrix, size_t row, size_t first_spaces,
                    const struct column *columns)
{
    size_t spaces = first_spaces;
    for (size_t j = 0; j < matrix->columns && !p->too_long; j++) {
        const struct expression *entry = matrix->entries[row * matrix->columns + j];
        size_t sign = sign_space(p, columns, j, entry);
        p->next = entry->first;
        put_run(p, spaces + sign, entry->last, false);
        size_t width = columns ? sign + entry_width(p, entry) : 0;
        spaces = columns && width < columns[j].width ? columns[j].width - width + 1 : 1;
    }
}

/* [ a b; c d ] */
static void put_flat_matrix(struct printer *p, const struct syntax_matrix *matrix)
{
    put(p, 1);
    for (size_t i = 0; i < matrix->rows && !p->too_long; i++) {
        if (i > 0)
            write_bytes(p, ";", 1);
        put_row(p, matrix, i, 1, NULL);
    }
    p->next = matrix->last;
    put(p, 1);
}

/* The alignment of the columns; NULL when the matrix has a comment inside an entry, so that nothing can line up,
 * or when memory is out, which the text remembers. */
static struct column *columns_align(struct printer *p, const struct syntax_matrix *matrix)
{
    struct column *columns = memory_new(matrix->columns, sizeof *columns);
    size_t count = matrix->rows * matrix->columns;
    if (!columns)
        p->text->failed = true;
    for (size_t i = 0; columns && i < count; i++)
        columns[i % matrix->columns].sign |= has_sign(p, matrix->entries[i]);
    for (size_t i = 0; columns && i < count; i++) {
        struct column *column = &columns[i % matrix->columns];
        size_t width = entry_width(p, matrix->entries[i]);
        if (width == SIZE_MAX) {
            memory_free(columns);
            return NULL;
        }
        width += sign_space(p, columns, i % matrix->columns, matrix->entries[i]);
        if (width > column->width && width <= PADDED_LONGEST)
            column->width = width;
    }
    return columns;
}

/* Each row on a line of its own, the first behind the bracket. */
static void put_broken_matrix(struct printer *p, const struct syntax_matrix *matrix)
{
    size_t hang = p->hang;
    struct column *columns = columns_align(p, matrix);
    put(p, 1);
    bool far = p->column > FARTHEST_COLUMN;
    size_t bracket = far ? p->indent + HANG : p->column - 1;
    p->hang = bracket + 2;
    put_row(p, matrix, 0, 1, columns);
    for (size_t i = 1; i < matrix->rows && !p->text->failed; i++) {
        p->next = matrix->entries[i * matrix->columns]->first;
        break_line(p, (struct line_style){.comments = p->hang, .token = p->hang});
        put_row(p, matrix, i, 0, columns);
    }
    memory_free(columns);
    p->next = matrix->last;
    if (next_comment(p))
        break_line(p, (struct line_style){.comments = p->hang, .token = bracket, .before_close = true});
    else
        write_spaces(p, 1);
    write_token(p);
    p->hang = hang;
}

static bool has_comments(const struct printer *p, const struct syntax_matrix *matrix)
{
    const struct token *tokens = p->file->tokens;
    uint32_t comment = p->comment;
    while (comment < p->file->comment_count && p->file->comments[comment].place < tokens[matrix->first].place)
        comment++;
    return comment < p->file->comment_count && p->file->comments[comment].place < tokens[matrix->last].place;
}

static void put_matrix(struct printer *p, const struct syntax_matrix *matrix)
{
    struct attempt attempt;
    if (p->flat || (matrix->rows == 1 && !has_comments(p, matrix))) {
        put_flat_matrix(p, matrix);
        return;
    }
    if (begin_flat(p, matrix->first, matrix->last, &attempt)) {
        put_flat_matrix(p, matrix);
        if (end_flat(p, &attempt))
            return;
    }
    put_broken_matrix(p, matrix);
}

/* ---- Blocks -------------------------------------------------------------------------------------------- */

/* The things between two braces: `item(p, block, i)` puts the i-th, whose first token is already placed. */
struct block {
    const void *owner;
    size_t count;
    void (*put)(struct printer *p, const void *owner, size_t index);
    uint32_t last;      /* the closing brace */
    size_t flat_spaces; /* between things on one line */
};

/* Puts `{ … }` on the current line. */
static void put_flat_block(struct printer *p, const struct block *block)
{
    put(p, 1);
    for (size_t i = 0; i < block->count && !p->too_long; i++) {
        write_spaces(p, i == 0 ? 1 : block->flat_spaces);
        block->put(p, block->owner, i);
    }
    p->next = block->last;
    put(p, 1);
}

/* Puts `{`, a line for each thing, and `}`. */
static void put_broken_block(struct printer *p, const struct block *block)
{
    size_t hang = p->hang;
    put(p, 1);
    p->indent += INDENT;
    p->hang = p->indent + HANG;
    for (size_t i = 0; i < block->count && !p->text->failed; i++) {
        break_line(p, (struct line_style){.comments = p->indent, .token = p->indent, .after_open = i == 0});
        block->put(p, block->owner, i);
    }
    size_t inside = p->indent;
    p->indent -= INDENT;
    p->hang = hang;
    break_line(p, (struct line_style){.comments = inside,
                                      .token = p->indent,
                                      .after_open = block->count == 0,
                                      .before_close = true});
    write_token(p);
}

/* ---- Rules --------------------------------------------------------------------------------------------- */

static void put_rules(struct printer *p, const struct syntax_rules *rules);

/* q[index] = value, or for variable in from..to rules */
static void put_rule(struct printer *p, const void *owner, size_t index)
{
    const struct syntax_rule *rule = ((const struct syntax_rules *)owner)->rules[index];
    write_token(p);
    if (rule->is_loop) {
        put(p, 1);
        put(p, 1);
        put_range(p, rule->from, rule->to);
        put_rules(p, rule->body);
        return;
    }
    put(p, 0);
    put_run(p, 0, rule->index->last, false);
    put(p, 0);
    put(p, 1);
    put_expression(p, 1, rule->value);
}

static void put_rules(struct printer *p, const struct syntax_rules *rules)
{
    struct block block = {rules, rules->count, put_rule, rules->last, 2};
    struct attempt attempt;
    if (p->flat) {
        put_flat_block(p, &block);
        return;
    }
    if (begin_flat(p, rules->first, rules->last, &attempt)) {
        put_flat_block(p, &block);
        if (end_flat(p, &attempt))
            return;
    }
    put_broken_block(p, &block);
}

/* ---- Parts of cells ------------------------------------------------------------------------------------ */

/* "at" NUMBER { NUMBER }, "at" matrix, or matrix */
static void put_location(struct printer *p, const struct syntax_location *location)
{
    if (location->matrix) {
        put_matrix(p, location->matrix);
        return;
    }
    put(p, 1);
    if (location->row) {
        put_matrix(p, location->row);
        return;
    }
    for (size_t i = 0; i < location->count; i++)
        put(p, 1);
}

/* A part of a cell; its keyword is placed. */
static void put_part(struct printer *p, const void *owner, size_t index)
{
    const struct syntax_part *part = ((const struct syntax_cell *)owner)->parts[index];
    write_token(p);
    switch (part->kind) {
    case PART_SUB:
        put_reference(p, 1, part->reference);
        break;
    case PART_BOUNDARY: /* its name, the "=", and on as for start and end */
        put(p, 1);
        put(p, 1);
        put_reference(p, 1, part->reference);
        put_location(p, &part->location);
        break;
    case PART_START:
    case PART_END:
        put_reference(p, 1, part->reference);
        put_location(p, &part->location);
        break;
    case PART_JOIN: /* 0.end = 1.start reversed */
        for (int side = 0; side < 2; side++) {
            put(p, 1);
            put(p, 0);
            put(p, 0);
            if (side == 0 || part->reversed)
                put(p, 1);
        }
        break;
    case PART_REFINE:
    case PART_MASK:
        put(p, 1);
        break;
    }
    if (part->matrix)
        put_matrix(p, part->matrix);
    else if (part->rules)
        put_rules(p, part->rules);
}

/* A part of a figure; its keyword is placed. */
static void put_figure_part(struct printer *p, const void *owner, size_t index)
{
    const struct syntax_figure_part *part = ((const struct syntax_figure *)owner)->parts[index];
    write_token(p);
    if (part->reference)
        put_reference(p, 1, part->reference);
    if (part->kind == FIGURE_PIECE)
        put(p, 1);
    for (size_t i = 0; i < part->number_count; i++)
        put(p, 1);
    if (part->matrix)
        put_matrix(p, part->matrix);
}

/* A filter of a wavelet; its keyword is placed. */
static void put_filter(struct printer *p, const void *owner, size_t index)
{
    const struct syntax_wavelet *wavelet = owner;
    write_token(p);
    if (is_mark(p, p->next, '-')) {
        put(p, 1);
        put(p, 0);
    } else {
        put(p, 1);
    }
    put_matrix(p, index == 0 ? wavelet->smooth : wavelet->detail);
}

/* ---- Items --------------------------------------------------------------------------------------------- */

/* kind NAME = ref * ref, or kind NAME(arguments) points { */
static void put_cell_head(struct printer *p, const struct syntax_cell *cell)
{
    write_token(p);
    put(p, 1);
    if (cell->factors[0]) {
        put(p, 1);
        put_reference(p, 1, cell->factors[0]);
        put(p, 1);
        put_reference(p, 1, cell->factors[1]);
        return;
    }
    if (cell->argument_count > 0) /* parentheses, names, and commas between them */
        put_run(p, 0, p->next + 2 * (uint32_t)cell->argument_count, false);
    if (cell->affine) {
        put(p, 1);
        put(p, 1);
    } else if (cell->points) {
        put_expression(p, 1, cell->points);
    }
}

static void put_cell(struct printer *p, const struct syntax_cell *cell)
{
    struct block block = {cell, cell->part_count, put_part, cell->last, 1};
    struct attempt attempt;
    if (cell->part_count <= 1 && begin_flat(p, cell->first, cell->last, &attempt)) {
        put_cell_head(p, cell);
        if (!cell->factors[0])
            put_flat_block(p, &block);
        if (end_flat(p, &attempt))
            return;
    }
    put_cell_head(p, cell);
    if (!cell->factors[0])
        put_broken_block(p, &block);
}

static void put_figure(struct printer *p, const struct syntax_figure *figure)
{
    struct block block = {figure, figure->part_count, put_figure_part, figure->last, 1};
    struct attempt attempt;
    if (figure->part_count <= 1 && begin_flat(p, figure->first, figure->last, &attempt)) {
        write_token(p);
        put(p, 1);
        put_flat_block(p, &block);
        if (end_flat(p, &attempt))
            return;
    }
    write_token(p);
    put(p, 1);
    put_broken_block(p, &block);
}

static void put_wavelet(struct printer *p, const struct syntax_wavelet *wavelet)
{
    struct block block = {wavelet, 2, put_filter, wavelet->last, 1};
    write_token(p);
    put_reference(p, 1, wavelet->reference);
    put_broken_block(p, &block);
}

static void put_let(struct printer *p, const struct syntax_let *let)
{
    write_token(p);
    put(p, 1);
    if (let->has_arguments)
        put_run(p, 0, p->next + 2 * (uint32_t)let->argument_count, false);
    put(p, 1);
    put_expression(p, 1, let->value);
}

static void put_parameter(struct printer *p, const struct syntax_parameter *parameter)
{
    write_token(p);
    put(p, 1);
    put(p, 1);
    put_expression(p, 1, parameter->value);
    if (parameter->low) {
        put(p, 1);
        put_range(p, parameter->low, parameter->high);
    }
}

static void put_item(struct printer *p, const struct syntax_item *item)
{
    switch (item->kind) {
    case ITEM_USE:
        write_token(p);
        while (p->next <= item->use->last)
            put(p, 1);
        break;
    case ITEM_PARAMETER:
        put_parameter(p, item->parameter);
        break;
    case ITEM_LET:
        put_let(p, item->let);
        break;
    case ITEM_CELL:
        put_cell(p, item->cell);
        break;
    case ITEM_WAVELET:
        put_wavelet(p, item->wavelet);
        break;
    case ITEM_FIGURE:
        put_figure(p, item->figure);
        break;
    }
}

/* ---- The file ------------------------------------------------------------------------------------------ */

/* Whether the items are of a kind that takes one line and stands in groups. */
static bool are_grouped(const struct syntax_item *a, const struct syntax_item *b)
{
    if (a->kind != b->kind)
        return false;
    if (a->kind == ITEM_CELL)
        return a->cell->factors[0] && b->cell->factors[0];
    return a->kind == ITEM_USE || a->kind == ITEM_PARAMETER || a->kind == ITEM_LET;
}

/* Whether a comment stands on a line of its own before the next token. */
static bool has_comment_line(struct printer *p)
{
    const struct comment *comment = next_comment(p);
    if (comment && !newline_before(p, comment->place)) {
        p->comment++;
        comment = next_comment(p);
        p->comment--;
    }
    return comment != NULL;
}

static void put_header(struct printer *p)
{
    if (next_comment(p))
        break_line(p, (struct line_style){.after_open = true});
    write_token(p);
    while (p->next <= p->file->header_last)
        put(p, 1);
}

void syntax_print(const struct syntax_file *file, struct text *text)
{
    struct printer p = {.file = file, .source = file->source->text, .text = text, .hang = HANG};
    put_header(&p);
    for (size_t i = 0; i < file->count && !text->failed; i++) {
        const struct syntax_item *item = &file->items[i];
        bool separate = i == 0 || !are_grouped(item - 1, item) || has_comment_line(&p);
        break_line(&p, (struct line_style){.separate = separate});
        put_item(&p, item);
    }
    if (text->failed)
        return;
    put_trailing_comment(&p);
    while (next_comment(&p)) {
        write_newline(&p, blank_before(&p, next_comment(&p)->place) ? 2 : 1, 0);
        write_comment(&p);
    }
    write_newline(&p, 1, 0);
}
