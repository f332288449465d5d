/* The lexer: kinds, lengths and gaps of tokens, comments, and each lexical error once. */
#include "language/syntax.h"

#include <stdio.h>
#include <string.h>

#include "tap.h"

struct seen {
    unsigned count, line, column;
    char message[1024];
};

static void see(void *context, const bcifs_diagnostic *diagnostic)
{
    struct seen *seen = context;
    if (seen->count++ > 0)
        return;
    seen->line = diagnostic->line;
    seen->column = diagnostic->column;
    snprintf(seen->message, sizeof seen->message, "%s", diagnostic->message);
}

static bcifs_status scan(struct arena *arena, const char *text, struct seen *seen, struct syntax_file *file)
{
    *seen = (struct seen){0};
    *file = (struct syntax_file){0};
    bcifs_load_options options = {.report = see, .context = seen};
    struct report report = report_new(&options);
    struct source *source;
    bcifs_status status = source_from_text(arena, "test", text, strlen(text), &report, &source);
    return status == BCIFS_OK ? syntax_scan(arena, source, &report, file) : status;
}

/* Writes tokens as `N`ame, n`U`mber, `S`tring, `M`ark, `B`ad with their text; `_` and `/` for space and line
 * before, "N:a _M:+ /U:1". */
static void describe(const struct syntax_file *file, char *out, size_t size)
{
    size_t used = 0;
    out[0] = '\0';
    for (size_t i = 0; i + 1 < file->token_count && used < size; i++) {
        const struct token *token = &file->tokens[i];
        const char *gap = token->line_before ? "/" : token->space_before ? "_" : "";
        used +=
            (size_t)snprintf(out + used, size - used, "%s%s%c:%.*s", i ? " " : "", gap, "NUSMB"[token->kind],
                             (int)token -> length, file -> source -> text + token -> place);
    }
}

static void check(const char *text, const char *expected)
{
    struct arena arena = {0};
    struct seen seen;
    struct syntax_file file;
    char got[1024];
    bcifs_status status = scan(&arena, text, &seen, &file);
    describe(&file, got, sizeof got);
    if (!ok(status == BCIFS_OK && strcmp(got, expected) == 0, "%s", expected))
        note("got %s", got);
    arena_free(&arena);
}

static void test_tokens(void)
{
    check("a+1", "/N:a M:+ U:1");
    check("a - 1", "/N:a _M:- _U:1");
    check("a\n-1", "/N:a /M:- U:1");
    check("a # c\n b", "/N:a /N:b");
    check("a\r\nb", "/N:a /N:b");
    check("\xEF\xBB\xBF"
          "a",
          "/N:a");
    check("_a1 B_2", "/N:_a1 _N:B_2");
    check("{}[](),;=+-*/%^?", "/M:{ M:} M:[ M:] M:( M:) M:, M:; M:= M:+ M:- M:* M:/ M:% M:^ M:?");
    check("\"a # b\" \"\"", "/S:\"a # b\" _S:\"\"");
    check("\"é\"", "/S:\"é\"");
    check("sub.start", "/N:sub M:. N:start");
}

static void test_numbers(void)
{
    check("0..1", "/U:0 M:.. U:1");
    check("2.start", "/U:2 M:. N:start");
    check("0.5 .5 12 1e-3 1E+3 2e5 .5e2 0.25e-10",
          "/U:0.5 _U:.5 _U:12 _U:1e-3 _U:1E+3 _U:2e5 _U:.5e2 _U:0.25e-10");
    check("0...5", "/U:0 M:.. M:. U:5");
    check("0.. .5", "/U:0 M:.. _U:.5");
    check("1.5..2.5", "/U:1.5 M:.. U:2.5");
    check("1-.5", "/U:1 M:- U:.5");
    check("1.e5", "/U:1 M:. N:e5");
}

static void test_comments(void)
{
    struct arena arena = {0};
    struct seen seen;
    struct syntax_file file;
    const char *text = "# one \t\r\na #two#\n#\n\"#\" # é";
    bool good = scan(&arena, text, &seen, &file) == BCIFS_OK && file.comment_count == 4;
    static const char *const expected[] = {"# one", "#two#", "#", "# é"};
    for (size_t i = 0; good && i < 4; i++)
        good = file.comments[i].length == strlen(expected[i]) &&
               memcmp(text + file.comments[i].place, expected[i], file.comments[i].length) == 0;
    ok(good, "comments are kept without the white space at their end");
    ok(file.token_count == 3 && file.tokens[2].kind == TOKEN_END && file.tokens[2].place == strlen(text),
       "the end is the last token");
    ok(scan(&arena, "", &seen, &file) == BCIFS_OK && file.token_count == 1 && file.tokens[0].line_before,
       "an empty file has an end only");
    arena_free(&arena);
}

static void check_error(const char *text, unsigned column, const char *message, const char *tokens)
{
    struct arena arena = {0};
    struct seen seen;
    struct syntax_file file;
    char got[1024];
    bcifs_status status = scan(&arena, text, &seen, &file);
    describe(&file, got, sizeof got);
    bool good = status == BCIFS_INPUT && seen.count == 1 && seen.line == 1 && seen.column == column &&
                strcmp(seen.message, message) == 0 && strcmp(got, tokens) == 0;
    if (!ok(good, "%s", message))
        note("got %u errors, %u:%u: %s; tokens %s", seen.count, seen.line, seen.column, seen.message, got);
    arena_free(&arena);
}

static void test_errors(void)
{
    check_error("a & b", 3, "'&' is not a character of the language", "/N:a _B:& _N:b");
    check_error("a &&|~ b", 3, "'&' is not a character of the language", "/N:a _B:&&|~ _N:b");
    check_error("a é b", 3, "'é' may stand in comments and strings only", "/N:a _B:é _N:b");
    check_error("1 − 2", 3, "found '−'; did you mean '-'?", "/U:1 _B:− _U:2");
    check_error("“a", 1, "found '“'; did you mean '\"'?", "/B:“ N:a");
    check_error("\"abc", 1, "expected a '\"' that closes this string on its line", "/B:\"abc");
    check_error("\"abc\nd", 1, "expected a '\"' that closes this string on its line", "/B:\"abc /N:d");
    check_error("2x + 1", 2, "expected white space or an operator after the number, found 'x'",
                "/B:2x _M:+ _U:1");
    check_error("1e 2", 2, "expected white space or an operator after the number, found 'e'", "/B:1e _U:2");
    check_error("0x10", 2, "expected white space or an operator after the number, found 'x'", "/B:0x10");
    check_error("1.2.3", 4, "expected white space or an operator after the number, found '.'", "/B:1.2.3");

    char name[SYNTAX_LONGEST_NAME + 2];
    memset(name, 'a', sizeof name);
    name[SYNTAX_LONGEST_NAME + 1] = '\0';
    struct arena arena = {0};
    struct seen seen;
    struct syntax_file file;
    ok(scan(&arena, name, &seen, &file) == BCIFS_INPUT &&
           strcmp(seen.message, "this name has 129 bytes; the limit is 128") == 0,
       "a name of 129 bytes is too long");
    name[SYNTAX_LONGEST_NAME] = '\0';
    ok(scan(&arena, name, &seen, &file) == BCIFS_OK, "one of 128 is not");

    char many[101];
    memset(many, '&', 100);
    for (int i = 1; i < 100; i += 2)
        many[i] = ' ';
    many[100] = '\0';
    ok(scan(&arena, many, &seen, &file) == BCIFS_INPUT && seen.count == REPORT_MOST,
       "it stops after %d errors", REPORT_MOST);
    arena_free(&arena);
}

int main(void)
{
    test_tokens();
    test_numbers();
    test_comments();
    test_errors();
    return done_testing();
}
