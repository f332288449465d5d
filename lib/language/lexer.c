/* Characters to tokens. White space is not a token, but every token knows whether it or a newline stood
 * before it, which is what separates entries and rows inside brackets; comments are set aside for the
 * printer. */
#include "language/syntax.h"

#include <string.h>

struct scanner {
    struct arena *arena;
    const struct source *source;
    struct report *report;
    struct syntax_file *file;
    size_t token_capacity, comment_capacity;
    size_t at;  /* the next byte */
    bool space; /* white space or a comment stands between the last token and here */
    bool line;  /* a newline does */
    bool failed, out_of_memory;
};

static const char MARKS[] = "{}[](),;=+-*/%^?.";

/* Character classes of the language, not of the locale. */
static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_mark(char c)
{
    return c != '\0' && strchr(MARKS, c) != NULL;
}

/* Bytes of the token that is being read; the text ends in a NUL, so looking one ahead is safe. */
static char byte_at(const struct scanner *s, size_t at)
{
    return at < s->source->length ? s->source->text[at] : '\0';
}

static void add_token(struct scanner *s, enum token_kind kind, size_t start)
{
    struct syntax_file *file = s->file;
    if (!ARENA_RESERVE(s->arena, file->tokens, file->token_count, s->token_capacity)) {
        s->out_of_memory = true;
        return;
    }
    file->tokens[file->token_count++] = (struct token){.kind = kind,
                                                       .place = (source_place)start,
                                                       .length = (uint32_t)(s->at - start),
                                                       .space_before = s->space,
                                                       .line_before = s->line};
    s->space = s->line = false;
}

/* comment = "#" { any character but a newline } */
static void scan_comment(struct scanner *s)
{
    const char *text = s->source->text;
    size_t start = s->at;
    const char *newline = memchr(text + start, '\n', s->source->length - start);
    size_t end = newline ? (size_t)(newline - text) : s->source->length;
    s->at = end;
    while (text[end - 1] == ' ' || text[end - 1] == '\t' || text[end - 1] == '\r')
        end--;
    struct syntax_file *file = s->file;
    if (!ARENA_RESERVE(s->arena, file->comments, file->comment_count, s->comment_capacity)) {
        s->out_of_memory = true;
        return;
    }
    file->comments[file->comment_count++] =
        (struct comment){.place = (source_place)start, .length = (uint32_t)(end - start)};
}

static void skip_space(struct scanner *s)
{
    for (;;) {
        char c = byte_at(s, s->at);
        if (c == '#')
            scan_comment(s);
        else if (c == ' ' || c == '\t' || c == '\r' || c == '\n')
            s->at++;
        else
            return;
        s->space = true;
        s->line = s->line || c == '\n';
    }
}

/* NAME = letter { letter | digit } */
static void scan_name(struct scanner *s)
{
    size_t start = s->at;
    while (is_letter(byte_at(s, s->at)) || is_digit(byte_at(s, s->at)))
        s->at++;
    if (s->at - start > SYNTAX_LONGEST_NAME) {
        report_error(s->report, s->source, (source_place)start, "this name has %zu bytes; the limit is %d",
                     s->at - start, SYNTAX_LONGEST_NAME);
        s->failed = true;
        add_token(s, TOKEN_BAD, start);
        return;
    }
    add_token(s, TOKEN_NAME, start);
}

static void skip_digits(struct scanner *s)
{
    while (is_digit(byte_at(s, s->at)))
        s->at++;
}

/* NUMBER = (digits ["." digits] | "." digits) [("e" | "E") ["+" | "-"] digits]
 * A fraction needs a digit after the point, so that 0..1 is a range and 2.start a boundary of child 2. */
static void scan_number(struct scanner *s)
{
    size_t start = s->at;
    skip_digits(s);
    if (byte_at(s, s->at) == '.' && is_digit(byte_at(s, s->at + 1))) {
        s->at++;
        skip_digits(s);
    }
    char c = byte_at(s, s->at);
    if (c == 'e' || c == 'E') {
        char sign = byte_at(s, s->at + 1);
        size_t digit = s->at + (sign == '+' || sign == '-' ? 2 : 1);
        if (is_digit(byte_at(s, digit))) {
            s->at = digit;
            skip_digits(s);
        }
    }
    c = byte_at(s, s->at);
    if (!is_letter(c) && !(c == '.' && is_digit(byte_at(s, s->at + 1)))) {
        add_token(s, TOKEN_NUMBER, start);
        return;
    }
    report_error(s->report, s->source, (source_place)s->at,
                 "expected white space or an operator after the number, found '%c'", c);
    s->failed = true;
    while (is_letter(c) || is_digit(c) || (c == '.' && is_digit(byte_at(s, s->at + 1))))
        c = byte_at(s, ++s->at);
    add_token(s, TOKEN_BAD, start);
}

/* STRING = '"' { any character but '"' and newline } '"' */
static void scan_string(struct scanner *s)
{
    size_t start = s->at++;
    char c;
    while ((c = byte_at(s, s->at)) != '"' && c != '\n' && c != '\0')
        s->at++;
    if (c == '"') {
        s->at++;
        add_token(s, TOKEN_STRING, start);
        return;
    }
    report_error(s->report, s->source, (source_place)start,
                 "expected a '\"' that closes this string on its line");
    s->failed = true;
    add_token(s, TOKEN_BAD, start);
}

/* What people's keyboards and word processors write for a mark of the language. */
static const struct {
    const char *character, *meant;
} LOOKALIKES[] = {{"−", "-"}, {"–", "-"},  {"×", "*"},  {"·", "*"},  {"⋅", "*"},
                  {"÷", "/"}, {"“", "\""}, {"”", "\""}, {"…", ".."}, {"\xC2\xA0", " "}};

/* One error for a run of bytes that belong to no token. */
static void scan_foreign(struct scanner *s)
{
    const char *text = s->source->text;
    size_t start = s->at++;
    while (((unsigned char)byte_at(s, s->at) & 0xC0) == 0x80)
        s->at++;
    size_t length = s->at - start;
    const char *meant = NULL;
    for (size_t i = 0; i < sizeof LOOKALIKES / sizeof LOOKALIKES[0]; i++)
        if (strlen(LOOKALIKES[i].character) == length &&
            memcmp(LOOKALIKES[i].character, text + start, length) == 0)
            meant = LOOKALIKES[i].meant;
    if (meant)
        report_error(s->report, s->source, (source_place)start, "found '%.*s'; did you mean '%s'?",
                     (int)length, text + start, meant);
    else
        report_error(s->report, s->source, (source_place)start, "'%.*s' %s", (int)length, text + start,
                     length > 1 ? "may stand in comments and strings only"
                                : "is not a character of the language");
    s->failed = true;
    for (;;) {
        char c = byte_at(s, s->at);
        if (c == '\0' || strchr(" \t\r\n#\"", c) || is_letter(c) || is_digit(c) || is_mark(c))
            break;
        s->at++;
    }
    add_token(s, TOKEN_BAD, start);
}

static void scan_token(struct scanner *s)
{
    size_t start = s->at;
    char c = byte_at(s, start);
    /* ".5" is a number, but not behind a point: 0...5 would read as anything. */
    bool fraction =
        c == '.' && is_digit(byte_at(s, start + 1)) && (start == 0 || byte_at(s, start - 1) != '.');
    if (is_letter(c)) {
        scan_name(s);
    } else if (is_digit(c) || fraction) {
        scan_number(s);
    } else if (c == '"') {
        scan_string(s);
    } else if (is_mark(c)) {
        s->at += c == '.' && byte_at(s, start + 1) == '.' ? 2 : 1;
        add_token(s, TOKEN_MARK, start);
    } else {
        scan_foreign(s);
    }
}

bcifs_status syntax_scan(struct arena *arena, const struct source *source, struct report *report,
                         struct syntax_file *file)
{
    struct scanner s = {.arena = arena, .source = source, .report = report, .file = file, .line = true};
    file->source = source;
    if (source->length >= 3 && memcmp(source->text, "\xEF\xBB\xBF", 3) == 0)
        s.at = 3;
    skip_space(&s);
    while (s.at < source->length && !s.out_of_memory && !report_is_full(report)) {
        if (file->token_count == SYNTAX_MOST_TOKENS) {
            report_error(report, source, (source_place)s.at, "the file has more than %d words and signs",
                         SYNTAX_MOST_TOKENS);
            s.failed = true;
            break;
        }
        scan_token(&s);
        skip_space(&s);
    }
    add_token(&s, TOKEN_END, s.at);
    if (s.out_of_memory)
        return report_memory(report);
    return s.failed || report_is_full(report) ? BCIFS_INPUT : BCIFS_OK;
}
