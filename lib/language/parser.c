/* The parser's common ground, and the items of a file. */
#include "language/parser.h"

#include <stdio.h>
#include <string.h>

/* ---- Tokens -------------------------------------------------------------------------------------------- */

const struct token *parser_token(const struct parser *p, uint32_t index)
{
    size_t last = p->file->token_count - 1;
    return &p->file->tokens[index < last ? index : last];
}

const struct token *parser_next(const struct parser *p)
{
    return parser_token(p, p->next);
}

const struct token *parser_after(const struct parser *p)
{
    return parser_token(p, p->next + 1);
}

static bool token_is(const struct parser *p, const struct token *token, enum token_kind kind,
                     const char *text)
{
    size_t length = strlen(text);
    return token->kind == kind && token->length == length &&
           memcmp(p->file->source->text + token->place, text, length) == 0;
}

bool token_is_mark(const struct parser *p, const struct token *token, const char *mark)
{
    return token_is(p, token, TOKEN_MARK, mark);
}

bool token_is_word(const struct parser *p, const struct token *token, const char *word)
{
    return token_is(p, token, TOKEN_NAME, word);
}

int token_find_word(const struct parser *p, const struct token *token, const struct word_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        if (token_is_word(p, token, list->words[i]))
            return (int)i;
    return -1;
}

bool parser_at_mark(const struct parser *p, const char *mark)
{
    return token_is_mark(p, parser_next(p), mark);
}

bool parser_at_word(const struct parser *p, const char *word)
{
    return token_is_word(p, parser_next(p), word);
}

bool parser_accept_mark(struct parser *p, const char *mark)
{
    bool found = parser_at_mark(p, mark);
    p->next += found;
    return found;
}

bool parser_accept_word(struct parser *p, const char *word)
{
    bool found = parser_at_word(p, word);
    p->next += found;
    return found;
}

bool parser_expect_mark(struct parser *p, const char *mark, const char *context)
{
    if (parser_accept_mark(p, mark))
        return true;
    parser_expected(p, "'%s' %s", mark, context);
    return false;
}

bool parser_expect_word(struct parser *p, const char *word, const char *context)
{
    if (parser_accept_word(p, word))
        return true;
    parser_expected(p, "'%s' %s", word, context);
    return false;
}

static const char *copy_token(struct parser *p, const struct token *token, uint32_t margin)
{
    char *copy =
        arena_text(p->arena, p->file->source->text + token->place + margin, token->length - 2 * margin);
    if (!copy)
        p->out_of_memory = true;
    return copy;
}

static const char *take_token(struct parser *p, enum token_kind kind, uint32_t margin, const char *what,
                              source_place *place)
{
    const struct token *token = parser_next(p);
    if (token->kind != kind) {
        parser_expected(p, "%s", what);
        return NULL;
    }
    if (place)
        *place = token->place;
    p->next++;
    return copy_token(p, token, margin);
}

const char *parser_name(struct parser *p, const char *what, source_place *place)
{
    return take_token(p, TOKEN_NAME, 0, what, place);
}

const char *parser_string(struct parser *p, const char *what, source_place *place)
{
    return take_token(p, TOKEN_STRING, 1, what, place);
}

bool parser_integer(struct parser *p, const char *what, uint64_t least, uint64_t most, uint64_t *number,
                    source_place *place)
{
    const struct token *token = parser_next(p);
    const char *digits = p->file->source->text + token->place;
    uint64_t value = 0;
    bool plain = token->kind == TOKEN_NUMBER;
    for (uint32_t i = 0; plain && i < token->length; i++) {
        plain = digits[i] >= '0' && digits[i] <= '9' && value <= PARSER_MOST_INTEGER;
        value = 10 * value + (uint64_t)(digits[i] - '0');
    }
    if (!plain || value < least || value > most) {
        if (most == PARSER_MOST_INTEGER)
            parser_expected(p, "%s, an integer below 2147483648", what);
        else
            parser_expected(p, "%s, an integer from %d to %d", what, (int)least, (int)most);
        return false;
    }
    *number = value;
    if (place)
        *place = token->place;
    p->next++;
    return true;
}

/* ---- Errors and memory --------------------------------------------------------------------------------- */

void parser_error(struct parser *p, source_place place, const char *format, ...)
{
    /* A second complaint about the same place is an echo of the first. */
    if (p->has_error && p->last_error == place)
        return;
    char message[sizeof p->report->first.message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    report_error(p->report, p->file->source, place, "%s", message);
    p->has_error = true;
    p->last_error = place;
}

enum { FOUND_SIZE = 80, EXPECTED_SIZE = 512 };

/* The next token in words. */
static void describe_found(const struct parser *p, char found[FOUND_SIZE])
{
    const struct token *token = parser_next(p);
    int longest = FOUND_SIZE - 16, length = (int)token->length;
    const char *text = p->file->source->text + token->place, *dots = "";
    if (token->kind == TOKEN_END) {
        snprintf(found, FOUND_SIZE, "the end of the file");
        return;
    }
    if (length > longest) {
        length = longest;
        while (((unsigned char)text[length] & 0xC0) == 0x80)
            length--;
        dots = "…";
    }
    const char *quote = token->kind == TOKEN_STRING ? "" : "'";
    snprintf(found, FOUND_SIZE, "%s%.*s%s%s", quote, length, text, dots, quote);
}

static void report_expected(struct parser *p, const char *expected, const char *meant)
{
    if (parser_next(p)->kind == TOKEN_BAD)
        return;
    char found[FOUND_SIZE];
    describe_found(p, found);
    if (meant)
        parser_error(p, parser_next(p)->place, "expected %s, found %s; did you mean '%s'?", expected, found,
                     meant);
    else
        parser_error(p, parser_next(p)->place, "expected %s, found %s", expected, found);
}

void parser_expected(struct parser *p, const char *format, ...)
{
    char expected[EXPECTED_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(expected, sizeof expected, format, arguments);
    va_end(arguments);
    report_expected(p, expected, NULL);
}

/* The keyword that the next token may have been meant for, or NULL. */
static const char *word_meant(const struct parser *p, const struct word_list *list)
{
    const struct token *token = parser_next(p);
    char word[SYNTAX_LONGEST_NAME + 1] = "";
    if (token->kind == TOKEN_NAME)
        memcpy(word, p->file->source->text + token->place, token->length);
    return nearest_word(word, list->words, list->count);
}

void parser_expected_word(struct parser *p, const char *lead, const struct word_list *list)
{
    char expected[EXPECTED_SIZE];
    size_t used = (size_t)snprintf(expected, sizeof expected, "%sone of", lead);
    for (size_t i = 0; i < list->count && used < sizeof expected; i++)
        used +=
            (size_t)snprintf(expected + used, sizeof expected - used, "%s %s", i ? "," : "", list->words[i]);
    report_expected(p, expected, word_meant(p, list));
}

void parser_expected_part(struct parser *p, uint32_t open, const struct word_list *list)
{
    if (parser_next(p)->kind == TOKEN_END)
        parser_expected_closing(p, open);
    else
        parser_expected_word(p, "'}' or ", list);
}

void parser_expected_closing(struct parser *p, uint32_t open)
{
    unsigned line, column;
    source_locate(p->file->source, parser_token(p, open)->place, &line, &column);
    parser_expected(p, "the '}' that closes the '{' of line %u", line);
}

bool parser_stopped(const struct parser *p)
{
    return p->out_of_memory || report_is_full(p->report);
}

void *parser_new(struct parser *p, size_t count, size_t size)
{
    void *memory = arena_new(p->arena, count, size);
    if (!memory)
        p->out_of_memory = true;
    return memory;
}

bool parser_enter(struct parser *p)
{
    if (p->depth >= SYNTAX_DEEPEST) {
        parser_error(p, parser_next(p)->place, "this is nested more than %d levels deep, the limit",
                     SYNTAX_DEEPEST);
        return false;
    }
    p->depth++;
    return true;
}

void parser_leave(struct parser *p)
{
    p->depth--;
}

/* ---- Recovery ------------------------------------------------------------------------------------------ */

static const char *const ITEM_WORDS[] = {"use",  "param", "let",     "vertex", "edge",
                                         "face", "cell",  "wavelet", "figure"};
static const struct word_list ITEMS = {ITEM_WORDS, sizeof ITEM_WORDS / sizeof ITEM_WORDS[0]};

static bool is_item_word(const struct parser *p, uint32_t index)
{
    const struct token *token = parser_token(p, index);
    return (token->line_before || index == 0) && token_find_word(p, token, &ITEMS) >= 0;
}

static bool is_at_margin(const struct parser *p, uint32_t index)
{
    source_place place = parser_token(p, index)->place;
    return place == 0 || p->file->source->text[place - 1] == '\n';
}

/* Whether token `index` is surely the keyword of an item, not a name: a name or a string follows it on its
 * line. */
static bool is_item_head(const struct parser *p, uint32_t index)
{
    const struct token *after = parser_token(p, index + 1);
    return is_item_word(p, index) && !after->line_before &&
           (after->kind == TOKEN_NAME || after->kind == TOKEN_STRING);
}

/* Whether an item begins at token `index`, outside of braces. */
static bool item_starts(const struct parser *p, uint32_t index)
{
    return is_item_head(p, index) || (is_item_word(p, index) && is_at_margin(p, index));
}

bool parser_item_at_margin(const struct parser *p, uint32_t index)
{
    return is_item_head(p, index) && is_at_margin(p, index);
}

static void leave_all(struct parser *p)
{
    p->depth = 0;
    p->in_row = p->in_rules = false;
}

/* Gives up what began at token `first`. Braces are counted from there, so that what is skipped stays
 * balanced; an item at the left margin ends the search at any depth, for then a brace is missing. */
static void recover(struct parser *p, uint32_t first, parser_starts *starts, bool in_block)
{
    unsigned depth = 0;
    uint32_t i = first;
    for (; parser_token(p, i)->kind != TOKEN_END; i++) {
        const struct token *token = parser_token(p, i);
        bool reached = i > first && i >= p->next;
        if (reached && (parser_item_at_margin(p, i) || (depth == 0 && starts(p, i))))
            break;
        if (token_is_mark(p, token, "{")) {
            depth++;
        } else if (token_is_mark(p, token, "}")) {
            if (depth == 0 && in_block)
                break;
            depth -= depth > 0;
            /* The end of the item that was given up; what follows at the margin is another, even if its
             * keyword is misspelled. */
            if (depth == 0 && !in_block && i >= p->next && is_at_margin(p, i + 1)) {
                i++;
                break;
            }
        }
    }
    p->next = i;
    leave_all(p);
}

void parser_recover_part(struct parser *p, uint32_t first, parser_starts *starts)
{
    if (parser_item_at_margin(p, p->next))
        leave_all(p);
    else
        recover(p, first, starts, true);
}

/* ---- Items --------------------------------------------------------------------------------------------- */

/* item = "use" STRING [ "as" NAME ] | … */
static bool parse_use(struct parser *p, struct syntax_item *item)
{
    struct syntax_use *use = item->use = parser_new(p, 1, sizeof *use);
    if (!use)
        return false;
    use->first = p->next++;
    use->path = parser_string(p, "a file's path in quotes after 'use'", &use->place);
    if (!use->path)
        return false;
    if (parser_accept_word(p, "as")) {
        use->name = parser_name(p, "a name after 'as'", &use->name_place);
        if (!use->name)
            return false;
    }
    use->last = p->next - 1;
    return true;
}

/* item = "param" NAME "=" expr [ "in" expr ".." expr ] | … */
static bool parse_parameter(struct parser *p, struct syntax_item *item)
{
    struct syntax_parameter *parameter = item->parameter = parser_new(p, 1, sizeof *parameter);
    if (!parameter)
        return false;
    parameter->first = p->next++;
    parameter->name = parser_name(p, "a name after 'param'", &parameter->place);
    if (!parameter->name || !parser_expect_mark(p, "=", "and a value after the param's name"))
        return false;
    parameter->value = parse_expression(p);
    if (!parameter->value)
        return false;
    if (parser_accept_word(p, "in")) {
        parameter->low = parse_expression(p);
        if (!parameter->low || !parser_expect_mark(p, "..", "between the bounds of the param"))
            return false;
        parameter->high = parse_expression(p);
        if (!parameter->high)
            return false;
    }
    parameter->last = p->next - 1;
    return true;
}

/* "(" NAME { "," NAME } ")" */
bool parse_argument_names(struct parser *p, const char ***names, source_place **places, size_t *count)
{
    const char **list = parser_new(p, SYNTAX_MOST_ARGUMENTS, sizeof *list);
    source_place *list_places = parser_new(p, SYNTAX_MOST_ARGUMENTS, sizeof *list_places);
    size_t used = 0;
    if (!list || !list_places || !parser_expect_mark(p, "(", "before the arguments"))
        return false;
    do {
        source_place place;
        const char *name = parser_name(p, "an argument's name", &place);
        if (!name)
            return false;
        for (size_t i = 0; i < used; i++)
            if (strcmp(list[i], name) == 0)
                parser_error(p, place, "the argument '%s' is named twice", name);
        if (used == SYNTAX_MOST_ARGUMENTS) {
            parser_error(p, place, "there are more than %d arguments, the limit", SYNTAX_MOST_ARGUMENTS);
            return false;
        }
        list[used] = name;
        list_places[used++] = place;
    } while (parser_accept_mark(p, ","));
    *names = list;
    *places = list_places;
    *count = used;
    return parser_expect_mark(p, ")", "or ',' after an argument's name");
}

/* item = "let" NAME [ "(" NAME { "," NAME } ")" ] "=" expr | … */
static bool parse_let(struct parser *p, struct syntax_item *item)
{
    struct syntax_let *let = item->let = parser_new(p, 1, sizeof *let);
    if (!let)
        return false;
    let->first = p->next++;
    let->name = parser_name(p, "a name after 'let'", &let->place);
    if (!let->name)
        return false;
    let->has_arguments = parser_at_mark(p, "(");
    if (let->has_arguments &&
        !parse_argument_names(p, &let->arguments, &let->argument_places, &let->argument_count))
        return false;
    if (!parser_expect_mark(p, "=", "and a value after the name of the let"))
        return false;
    let->value = parse_expression(p);
    let->last = p->next - 1;
    return let->value != NULL;
}

/* item = "use" … | "param" … | "let" … | cell | wavelet | figure */
static bool parse_item(struct parser *p, struct syntax_item *item)
{
    const struct token *token = parser_next(p);
    if (token_is_word(p, token, "use")) {
        item->kind = ITEM_USE;
        return parse_use(p, item);
    }
    if (token_is_word(p, token, "param")) {
        item->kind = ITEM_PARAMETER;
        return parse_parameter(p, item);
    }
    if (token_is_word(p, token, "let")) {
        item->kind = ITEM_LET;
        return parse_let(p, item);
    }
    if (token_is_word(p, token, "wavelet")) {
        item->kind = ITEM_WAVELET;
        return (item->wavelet = parse_wavelet(p)) != NULL;
    }
    if (token_is_word(p, token, "figure")) {
        item->kind = ITEM_FIGURE;
        return (item->figure = parse_figure(p)) != NULL;
    }
    if (token_find_word(p, token, &ITEMS) >= 0) {
        item->kind = ITEM_CELL;
        return (item->cell = parse_cell(p)) != NULL;
    }
    parser_expected_word(p, "", &ITEMS);
    return false;
}

/* ---- The file ------------------------------------------------------------------------------------------ */

/* file = "automaton" NAME [STRING] { item } */
static void parse_header(struct parser *p)
{
    static const char *const words[] = {"automaton"};
    static const struct word_list first_words = {words, 1};
    struct syntax_file *file = p->file;
    file->header_first = p->next;
    file->title = "";
    if (!parser_at_word(p, "automaton"))
        report_expected(p, "'automaton' and a name at the start of the file", word_meant(p, &first_words));
    bool good = parser_accept_word(p, "automaton") &&
                (file->name = parser_name(p, "the automaton's name", &file->name_place)) != NULL;
    if (good && parser_next(p)->kind == TOKEN_STRING)
        file->title = parser_string(p, "a title", NULL);
    file->header_last = p->next - (p->next > 0);
    if (!good && !item_starts(p, p->next))
        recover(p, p->next, item_starts, false);
}

/* Where a value is missing at the end of an item, the keyword of the next item was taken for a name. That
 * shows only now, at the word behind it: says what is missing and goes back to the keyword. */
static bool went_too_far(struct parser *p)
{
    if (p->next <= p->file->header_last + 1 || token_find_word(p, parser_next(p), &ITEMS) >= 0 ||
        !is_item_head(p, p->next - 1))
        return false;
    p->next--;
    parser_expected(p, "an expression");
    return true;
}

static void parse_file(struct parser *p)
{
    struct syntax_file *file = p->file;
    size_t capacity = 0;
    parse_header(p);
    while (!parser_stopped(p) && parser_next(p)->kind != TOKEN_END) {
        /* After an error, a brace too many is likely to be its echo. */
        if ((p->has_error && parser_accept_mark(p, "}")) || went_too_far(p))
            continue;
        uint32_t first = p->next;
        struct syntax_item item = {0};
        if (!parse_item(p, &item)) {
            recover(p, first, item_starts, false);
            continue;
        }
        if (!PARSER_RESERVE(p, file->items, file->count, capacity))
            return;
        file->items[file->count++] = item;
    }
}

bcifs_status syntax_parse(struct arena *arena, const struct source *source, struct report *report,
                          struct syntax_file **file)
{
    unsigned errors = report->errors;
    struct parser p = {.arena = arena, .report = report, .file = arena_new(arena, 1, sizeof **file)};
    if (!p.file)
        return report_memory(report);
    if (syntax_scan(arena, source, report, p.file) == BCIFS_MEMORY)
        return BCIFS_MEMORY;
    if (p.file->token_count > SYNTAX_MOST_TOKENS)
        return BCIFS_INPUT; /* reported; half a file would only give echoes */
    parse_file(&p);
    if (p.out_of_memory)
        return report_memory(report);
    if (report->errors > errors)
        return BCIFS_INPUT;
    *file = p.file;
    return BCIFS_OK;
}

bcifs_status syntax_parse_expression(struct arena *arena, const struct source *source, struct report *report,
                                     struct expression **expression)
{
    unsigned errors = report->errors;
    struct parser p = {.arena = arena, .report = report, .file = arena_new(arena, 1, sizeof *p.file)};
    if (!p.file)
        return report_memory(report);
    if (syntax_scan(arena, source, report, p.file) == BCIFS_MEMORY)
        return BCIFS_MEMORY;
    struct expression *value = parse_expression(&p);
    if (value && parser_next(&p)->kind != TOKEN_END)
        parser_expected(&p, "an operator or the end");
    if (p.out_of_memory)
        return report_memory(report);
    if (report->errors > errors)
        return BCIFS_INPUT;
    *expression = value;
    return BCIFS_OK;
}
