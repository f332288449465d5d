/* Reports and sources: places, excerpts, shortened messages, the limit on errors, and what is refused as
 * text. */
#include "language/report.h"
#include "language/source.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tap.h"

/* The last finding, and how many there were. */
struct seen {
    unsigned count, warnings, line, column;
    char file[1024], message[1024], excerpt[1024];
    bool has_file, has_excerpt;
};

static void see(void *context, const bcifs_diagnostic *diagnostic)
{
    struct seen *seen = context;
    seen->count++;
    seen->warnings += diagnostic->is_warning != 0;
    seen->line = diagnostic->line;
    seen->column = diagnostic->column;
    seen->has_file = diagnostic->file != NULL;
    seen->has_excerpt = diagnostic->excerpt != NULL;
    snprintf(seen->file, sizeof seen->file, "%s", diagnostic->file ? diagnostic->file : "");
    snprintf(seen->message, sizeof seen->message, "%s", diagnostic->message);
    snprintf(seen->excerpt, sizeof seen->excerpt, "%s", diagnostic->excerpt ? diagnostic->excerpt : "");
}

static struct report new_report(struct seen *seen)
{
    *seen = (struct seen){0};
    bcifs_load_options options = {.report = see, .context = seen};
    return report_new(&options);
}

static bool is_utf8_cut(const char *text)
{
    size_t length = strlen(text);
    return length >= 3 && strcmp(text + length - 3, "…") == 0;
}

/* Whether `text` is made of whole characters. */
static bool is_utf8(const char *text)
{
    for (const unsigned char *at = (const unsigned char *)text; *at;) {
        int more = *at < 0x80 ? 0 : *at < 0xC0 ? -1 : *at < 0xE0 ? 1 : *at < 0xF0 ? 2 : 3;
        if (more < 0)
            return false;
        for (at++; more > 0; more--)
            if ((*at++ & 0xC0) != 0x80)
                return false;
    }
    return true;
}

/* ---- Places -------------------------------------------------------------------------------------------- */

static void check_place(const char *text, size_t place, unsigned line, unsigned column, const char *excerpt)
{
    struct source source = {"x.bcifs", text, strlen(text)};
    struct seen seen;
    struct report report = new_report(&seen);
    report_error(&report, &source, (source_place)place, "no");
    bool good = seen.line == line && seen.column == column && strcmp(seen.excerpt, excerpt) == 0;
    if (!ok(good, "place %zu is line %u, column %u", place, line, column))
        note("got %u:%u with excerpt of %zu bytes", seen.line, seen.column, strlen(seen.excerpt));
}

static void test_places(void)
{
    check_place("one\ntwo\n", 0, 1, 1, "one\n^");
    check_place("one\ntwo\n", 2, 1, 3, "one\n  ^");
    check_place("one\ntwo\n", 4, 2, 1, "two\n^");
    check_place("one\ntwo\n", 7, 2, 4, "two\n   ^");
    check_place("one\ntwo\n", 8, 3, 1, "");
    check_place("one\ntwo\n", 1000, 3, 1, "");
    check_place("one\r\ntwo\r\n", 6, 2, 2, "two\n ^");
    check_place("\ta\tb", 3, 1, 4, "\ta\tb\n\t \t^");
    check_place("é…x", 5, 1, 3, "é…x\n  ^");
    check_place("\xEF\xBB\xBF"
                "ab",
                4, 1, 2, "ab\n ^");
    check_place("", 0, 1, 1, "");
}

static void test_long_lines(void)
{
    char line[1001];
    for (size_t i = 0; i < 1000; i++)
        line[i] = (char)('a' + i % 26);
    line[1000] = '\0';
    bool good = true;
    for (size_t place = 0; place <= 1000; place++) {
        struct source source = {"x", line, 1000};
        struct seen seen;
        struct report report = new_report(&seen);
        report_error(&report, &source, (source_place)place, "no");
        char *newline = strchr(seen.excerpt, '\n');
        size_t bytes = (size_t)(newline - seen.excerpt);
        /* The caret's column counts the ellipsis, three bytes, as one. */
        size_t caret = strlen(newline + 1) - 1;
        size_t shift = strncmp(seen.excerpt, "…", 3) == 0 ? 2 : 0;
        bool found = place == 1000 || seen.excerpt[caret + shift] == line[place];
        good &= bytes >= 120 && bytes <= 126 && found && is_utf8(seen.excerpt);
    }
    ok(good, "a long line is cut around the place, and the caret stays below it");

    char wide[901] = "";
    for (int i = 0; i < 300; i++)
        memcpy(wide + 3 * i, "…", 3);
    wide[900] = '\0';
    good = true;
    for (size_t place = 0; place <= 900; place += 3) {
        struct source source = {"x", wide, 900};
        struct seen seen;
        struct report report = new_report(&seen);
        report_error(&report, &source, (source_place)place, "no");
        good &= is_utf8(seen.excerpt) && seen.column == place / 3 + 1;
    }
    ok(good, "it is cut between characters");
}

/* ---- Messages ------------------------------------------------------------------------------------------ */

static void test_messages(void)
{
    struct seen seen;
    struct report report = new_report(&seen);
    struct source source = {"x.bcifs", "text", 4};
    bcifs_error error;
    ok(report_close(&report, &error) == BCIFS_OK && error.status == BCIFS_OK, "a new report has no error");
    report_warning(&report, &source, 1, "careful, %d", 7);
    ok(report.warnings == 1 && report.errors == 0 && seen.warnings == 1, "a warning is no error");
    ok(report_error(&report, &source, 2, "bad %s", "thing") == BCIFS_INPUT, "an error is bad input");
    report_error(&report, &source, 3, "worse");
    ok(report_close(&report, &error) == BCIFS_INPUT && strcmp(error.message, "bad thing") == 0 &&
           error.line == 1 && error.column == 3 && strcmp(error.file, "x.bcifs") == 0,
       "the first error is kept");
    ok(report_close(&report, NULL) == BCIFS_INPUT, "no error struct is needed");

    report = new_report(&seen);
    ok(report_failure(&report, BCIFS_SYSTEM, NULL, "disk on fire") == BCIFS_SYSTEM && !seen.has_file &&
           !seen.has_excerpt && seen.line == 0,
       "a failure has no place");
    report = new_report(&seen);
    ok(report_memory(&report) == BCIFS_MEMORY && report.first.status == BCIFS_MEMORY, "no memory");

    report = report_new(NULL);
    report_error(&report, &source, 0, "unheard");
    ok(report.errors == 1, "a report needs no listener");
}

static void test_shortening(void)
{
    struct seen seen;
    struct source source = {NULL, "text", 4};
    bool good = true;
    for (size_t shift = 0; shift < 4; shift++) {
        char text[1201] = "aaaa", name[601] = "aaaa";
        for (size_t i = 0; i < 390; i++)
            memcpy(text + shift + 3 * i, "…", 4);
        for (size_t i = 0; i < 190; i++)
            memcpy(name + shift + 3 * i, "…", 4);
        source.name = name;
        struct report report = new_report(&seen);
        report_error(&report, &source, 0, "%s", text);
        good &= is_utf8(report.first.message) && is_utf8(report.first.file) &&
                is_utf8_cut(report.first.message) &&
                strlen(report.first.message) > sizeof report.first.message - 8 &&
                strlen(report.first.file) > sizeof report.first.file - 8 && strcmp(seen.file, name) == 0;
    }
    ok(good, "long messages and names are cut between characters");
}

static void test_limit(void)
{
    struct seen seen;
    struct report report = new_report(&seen);
    struct source source = {"x", "text", 4};
    for (int i = 0; i < 3 * REPORT_MOST; i++) {
        bool full = report_is_full(&report);
        if (full != (i >= REPORT_MOST))
            ok(false, "full after %d", i);
        report_error(&report, &source, 0, "%d", i);
    }
    ok(seen.count == REPORT_MOST && report.errors == 3 * REPORT_MOST, "%d errors are handed on", REPORT_MOST);
    ok(strcmp(report.first.message, "0") == 0, "the first one stays the first");
}

/* ---- Near words ---------------------------------------------------------------------------------------- */

static void check_nearest(const char *word, const char *expected)
{
    static const char *const words[] = {"start", "end", "sub", "boundary", "refine", "u", "v", "sqrt"};
    const char *found = nearest_word(word, words, sizeof words / sizeof words[0]);
    ok(expected ? found && strcmp(found, expected) == 0 : !found, "near to '%s' is %s", word,
       expected ? expected : "nothing");
}

static void test_nearest(void)
{
    check_nearest("strat", "start");
    check_nearest("strt", "start");
    check_nearest("starts", "start");
    check_nearest("ned", "end");
    check_nearest("sup", "sub");
    check_nearest("bondary", "boundary");
    check_nearest("boundry", "boundary");
    check_nearest("reffine", "refine");
    check_nearest("sqr", "sqrt");
    check_nearest("w", NULL);
    check_nearest("", NULL);
    check_nearest("xyz", NULL);
    check_nearest("polynomial", NULL);
    check_nearest("aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", NULL);
}

/* ---- Sources ------------------------------------------------------------------------------------------- */

static void check_refused(const char *text, size_t length, unsigned line, unsigned column,
                          const char *message)
{
    struct arena arena = {0};
    struct seen seen;
    struct report report = new_report(&seen);
    struct source *source = NULL;
    bcifs_status status = source_from_text(&arena, "x", text, length, &report, &source);
    bool good = status == BCIFS_INPUT && !source && seen.count == 1 && seen.line == line &&
                seen.column == column && strcmp(seen.message, message) == 0;
    if (!ok(good, "refused: %s", message))
        note("got %u:%u: %s", seen.line, seen.column, seen.message);
    arena_free(&arena);
}

static void test_text(void)
{
    check_refused("ab\0\1\xFF", 5, 1, 3, "this is not a text file: it contains a NUL byte");
    check_refused("a\n\xFF", 3, 2, 1, "this is not UTF-8 text: unexpected byte 0xFF");
    check_refused("\xC3", 1, 1, 1, "this is not UTF-8 text: unexpected byte 0xC3");
    check_refused("\xC0\x80", 2, 1, 1, "this is not UTF-8 text: unexpected byte 0xC0");
    check_refused("\xE0\x80\x80", 3, 1, 1, "this is not UTF-8 text: unexpected byte 0xE0");
    check_refused("\xED\xA0\x80", 3, 1, 1, "this is not UTF-8 text: unexpected byte 0xED");
    check_refused("\xF4\x90\x80\x80", 4, 1, 1, "this is not UTF-8 text: unexpected byte 0xF4");
    check_refused("# \x1B[2J", 6, 1, 3, "the control character 0x1B may not stand in an automaton file");
    check_refused("\x7F", 1, 1, 1, "the control character 0x7F may not stand in an automaton file");
    check_refused("\xC2\x9B", 2, 1, 1, "the control character 0x9B may not stand in an automaton file");
    check_refused(
        "a\rb", 3, 1, 2,
        "expected a newline after the carriage return: save the file with Unix or Windows line ends");

    struct arena arena = {0};
    struct report report = report_new(NULL);
    struct source *source = NULL;
    const char good[] = "\xEF\xBB\xBF# é ≤ 𝄞\r\n\tok\n";
    ok(source_from_text(&arena, "name", good, sizeof good - 1, &report, &source) == BCIFS_OK &&
           source->length == sizeof good - 1 && strcmp(source->text, good) == 0 &&
           strcmp(source->name, "name") == 0,
       "text is copied");
    size_t length = (size_t)SOURCE_LONGEST + 1;
    char *large = malloc(length);
    if (large) {
        memset(large, ' ', length);
        ok(source_from_text(&arena, "name", large, length - 1, &report, &source) == BCIFS_OK,
           "16 MiB are enough");
        ok(source_from_text(&arena, "name", large, length, &report, &source) == BCIFS_INPUT &&
               strcmp(report.first.message, "the file is longer than 16777216 bytes, the limit") == 0,
           "more is refused");
    }
    free(large);
    arena_free(&arena);
}

static void check_unreadable(const char *path, const char *message)
{
    struct arena arena = {0};
    struct report report = report_new(NULL);
    struct source *source = NULL;
    bcifs_status status = source_read(&arena, path, &report, &source);
    if (!ok(status == BCIFS_INPUT && !source && strcmp(report.first.message, message) == 0 &&
                strcmp(report.first.file, path) == 0,
            "%s", message))
        note("got %d: %s", (int)status, report.first.message);
    arena_free(&arena);
}

static void test_files(void)
{
    check_unreadable("/nonexistent/x.bcifs", "cannot open '/nonexistent/x.bcifs': No such file or directory");
    check_unreadable("/", "cannot read '/': it is a directory");
    check_unreadable("/dev/zero", "the file is longer than 16777216 bytes, the limit");

    char path[] = "/tmp/bcifs-report-XXXXXX";
    int descriptor = mkstemp(path);
    struct arena arena = {0};
    struct report report = report_new(NULL);
    struct source *source = NULL;
    bool written = descriptor >= 0 && write(descriptor, "automaton a\n", 12) == 12;
    if (descriptor >= 0)
        close(descriptor);
    ok(written && source_read(&arena, path, &report, &source) == BCIFS_OK && source->length == 12 &&
           strcmp(source->text, "automaton a\n") == 0 && strcmp(source->name, path) == 0,
       "a file is read whole");
    ok(freopen(path, "rb", stdin) && source_read(&arena, "-", &report, &source) == BCIFS_OK &&
           source->length == 12 && strcmp(source->name, "<stdin>") == 0,
       "'-' is standard input");
    unlink(path);
    arena_free(&arena);
}

int main(void)
{
    test_places();
    test_long_lines();
    test_messages();
    test_shortening();
    test_limit();
    test_nearest();
    test_text();
    test_files();
    return done_testing();
}
