/* Memory: alignment, zeros, overflow of sizes, and what an arena does when a request fails. The allocator below
 * the library is replaced here by one that can be told to fail. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tap.h"

/* Requests until one fails (0: never), and blocks that are alive. */
static long fail_after;
static long alive;

static bool fails(void)
{
    return fail_after > 0 && --fail_after == 0;
}

/* calloc itself refuses products that overflow; a sanitizer's ends the program instead. */
static void *counted_calloc(size_t count, size_t size)
{
    void *block = fails() || count > SIZE_MAX / size ? NULL : calloc(count, size);
    alive += block != NULL;
    return block;
}

static void *counted_realloc(void *old, size_t size)
{
    void *block = fails() ? NULL : realloc(old, size);
    alive += block != NULL && old == NULL;
    return block;
}

static void counted_free(void *block)
{
    alive -= block != NULL;
    free(block);
}

/* The library's one place of allocation, compiled here on top of these. Its names then need not be linked. */
#define calloc counted_calloc
#define realloc counted_realloc
#define free counted_free
#include "base/memory.c"
#undef calloc
#undef realloc
#undef free

static bool is_zero(const void *bytes, size_t length)
{
    const unsigned char *next = bytes;
    for (size_t i = 0; i < length; i++)
        if (next[i] != 0)
            return false;
    return true;
}

static void test_blocks(void)
{
    unsigned char *block = memory_new(1000, 3);
    ok(block && is_zero(block, 3000), "a new block is zeroed");
    memset(block, 7, 3000);
    unsigned char *larger = memory_resize(block, 100000, 1);
    ok(larger && larger[0] == 7 && larger[2999] == 7, "resizing keeps what was there");
    fail_after = 1;
    ok(!memory_resize(larger, 200000, 1) && larger[2999] == 7, "a failed resize leaves the block");
    memory_free(larger);
    memory_free(NULL);
    void *nothing = memory_new(0, 8), *less = memory_resize(NULL, 0, 0);
    ok(nothing && less, "requests for nothing are valid");
    memory_free(nothing);
    memory_free(less);
    ok(!memory_new(SIZE_MAX / 2, 3) && !memory_new(SIZE_MAX, SIZE_MAX) && !memory_resize(NULL, SIZE_MAX / 2, 3),
       "products that overflow fail");
    ok(alive == 0, "all blocks are back");
}

/* Random requests: aligned, zeroed, apart from each other. */
static void test_arena(void)
{
    enum { REQUESTS = 3000 };
    static unsigned char *blocks[REQUESTS];
    static size_t lengths[REQUESTS];
    uint64_t seed = 1;
    struct arena arena = {0};
    bool good = true;
    size_t total = 0;
    for (int i = 0; i < REQUESTS; i++) {
        size_t count = (size_t)(random_bits(&seed) % (i % 100 == 0 ? 100000 : 40)), size = 1 + (size_t)(random_bits(&seed) % 24);
        lengths[i] = count * size;
        blocks[i] = arena_new(&arena, count, size);
        good = good && blocks[i] && (uintptr_t)blocks[i] % 16 == 0 && is_zero(blocks[i], lengths[i]);
        memset(blocks[i], i & 0xff, lengths[i]);
        total += lengths[i];
    }
    ok(good, "blocks of an arena are aligned and zeroed");
    for (int i = 0; i < REQUESTS && good; i++)
        for (size_t k = 0; k < lengths[i] && good; k++)
            good = blocks[i][k] == (i & 0xff);
    ok(good, "and do not overlap");
    ok(arena.used >= total && arena.used <= total + 16 * REQUESTS, "it counts what it gave");
    ok(!arena_new(&arena, SIZE_MAX / 2, 3) && !arena_new(&arena, SIZE_MAX, 1), "sizes that overflow fail");
    char *text = arena_text(&arena, "abc\0def", 7);
    ok(text && memcmp(text, "abc\0def", 8) == 0, "a copy of text ends with NUL");
    ok(arena_text(&arena, NULL, 0) && *arena_text(&arena, "x", 0) == '\0', "empty text too");
    arena_free(&arena);
    ok(alive == 0 && arena.used == 0 && !arena.newest, "everything goes back at once");
    arena_free(&arena);
    ok(alive == 0, "an empty arena may be freed");
}

static void test_growing(void)
{
    struct arena arena = {0};
    uint32_t *array = NULL;
    size_t count = 0, capacity = 0;
    bool good = true;
    for (uint32_t i = 0; i < 10000 && good; i++) {
        good = ARENA_RESERVE(&arena, array, count, capacity);
        if (good)
            array[count++] = i;
    }
    for (uint32_t i = 0; i < 10000 && good; i++)
        good = array[i] == i;
    ok(good && capacity >= count, "an array grows and keeps its elements");
    ok(arena.used < 10000 * sizeof *array * 5, "in doubling steps");
    arena_free(&arena);
}

/* Every request fails once: NULL, and the arena stays as it was and can be freed. */
static void test_failures(void)
{
    bool good = true;
    long k = 1;
    for (bool done = false; !done && k < 100; k++) {
        struct arena arena = {0};
        int failures = 0;
        fail_after = k;
        for (int i = 0; i < 200; i++) {
            size_t used = arena.used;
            unsigned char *block = arena_new(&arena, 1000 + (size_t)i * 100, 1);
            failures += !block;
            good = good && (block || arena.used == used) && (!block || is_zero(block, 1000));
            if (block)
                memset(block, 0xee, 1000);
        }
        done = failures == 0;
        good = good && failures == !done;
        fail_after = 0;
        arena_free(&arena);
        good = good && alive == 0;
    }
    ok(good && k > 20, "each of %ld requests may fail", k - 2);
    struct arena arena = {0};
    int *array = NULL;
    size_t count = 0, capacity = 0;
    fail_after = 1;
    ok(!ARENA_RESERVE(&arena, array, count, capacity) && !array && capacity == 0, "so may the growth of an array");
    fail_after = 0;
    arena_free(&arena);
}

int main(void)
{
    test_blocks();
    test_arena();
    test_growing();
    test_failures();
    return done_testing();
}
