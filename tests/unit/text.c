/* Growing text: what is appended comes out, in every locale, and a failure is remembered. */
#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tap.h"

static long fail_after;

static void *failing_realloc(void *block, size_t size)
{
    return fail_after > 0 && --fail_after == 0 ? NULL : realloc(block, size);
}

static void *failing_calloc(size_t count, size_t size)
{
    return fail_after > 0 && --fail_after == 0 ? NULL : calloc(count, size);
}

#define calloc failing_calloc
#define realloc failing_realloc
#include "base/memory.c"
#undef calloc
#undef realloc

#include "base/text.h"

/* Random appends, against a plain buffer. */
static void test_append(void)
{
    static char expected[400000];
    uint64_t seed = 1;
    bool good = true;
    for (long round = 0; round < test_effort(20); round++) {
        struct text text = {0};
        size_t length = 0;
        for (int i = 0; i < 1000; i++) {
            char piece[100];
            size_t count = (size_t)(random_bits(&seed) % 90);
            for (size_t k = 0; k < count; k++)
                piece[k] = (char)('a' + random_bits(&seed) % 26);
            piece[count] = '\0';
            switch (random_bits(&seed) % 4) {
            case 0:
                text_append(&text, piece);
                break;
            case 1:
                text_append_bytes(&text, piece, count);
                break;
            case 2:
                memset(piece, '=', count);
                text_append_character(&text, '=', count);
                break;
            default:
                count = (size_t)snprintf(expected + length, sizeof expected - length, "%s|%d", piece, i);
                text_format(&text, "%s|%d", piece, i);
                length += count;
                continue;
            }
            memcpy(expected + length, piece, count);
            length += count;
        }
        expected[length] = '\0';
        good = good && !text.failed && text.length == length && strcmp(text.data, expected) == 0;
        text_free(&text);
        good = good && !text.data && text.length == 0;
    }
    ok(good, "text grows by what is appended");
    struct text text = {0};
    text_append_bytes(&text, "a\0b", 3);
    ok(text.length == 3 && memcmp(text.data, "a\0b", 4) == 0, "bytes may be anything");
    char *taken = text_take(&text);
    ok(taken && memcmp(taken, "a\0b", 4) == 0 && !text.data, "taken text leaves nothing");
    memory_free(taken);
    taken = text_take(&text);
    ok(!taken || *taken == '\0', "taking nothing is harmless");
    memory_free(taken);
    text_free(&text);
    text_format(&text, "%5000d", 7);
    ok(text.length == 5000 && text.data[4999] == '7', "long formats");
    text_free(&text);
}

static void test_numbers(void)
{
    static const char *const locales[] = {"C", "de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "C.UTF-8"};
    bool good = true;
    int tried = 0;
    for (size_t i = 0; i < sizeof locales / sizeof locales[0]; i++) {
        if (!setlocale(LC_ALL, locales[i]))
            continue;
        tried++;
        struct text text = {0};
        text_append_number(&text, 1234.5);
        text_append(&text, " ");
        text_append_number(&text, -0.1);
        text_append(&text, " ");
        text_append_number(&text, 1.0 / 3);
        good = good && strcmp(text.data, "1234.5 -0.1 0.3333333333333333") == 0;
        text_free(&text);
    }
    setlocale(LC_ALL, "C");
    ok(good, "numbers have a point in %d locales", tried);
}

/* Each request fails once: the text is failed from there on, and empty when taken. */
static void test_failures(void)
{
    bool good = true, done = false;
    long k = 1;
    for (; !done && k < 100; k++) {
        struct text text = {0};
        fail_after = k;
        for (int i = 0; i < 300; i++) {
            text_append(&text, "some text ");
            text_append_character(&text, 'x', 30);
            text_format(&text, "%d %s", i, "formatted");
            text_append_number(&text, i / 7.0);
        }
        done = !text.failed;
        fail_after = 0;
        if (!done) {
            size_t length = text.length;
            text_append(&text, "more");
            good = good && text.failed && text.length == length;
            good = good && text_take(&text) == NULL;
        }
        text_free(&text);
    }
    ok(good && k > 5, "each of %ld requests may fail", k - 2);
}

int main(void)
{
    test_append();
    test_numbers();
    test_failures();
    return done_testing();
}
