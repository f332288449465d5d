#include "memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_SIZE = 64 * 1024, ALIGNMENT = 16 };

struct arena_block {
    struct arena_block *older;
    size_t size, used;
};

/* The header is padded so that what follows it is aligned like the block itself. */
static const size_t HEADER = (sizeof(struct arena_block) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;

void *memory_new(size_t count, size_t size)
{
    if (count == 0 || size == 0)
        count = size = 1;
    return calloc(count, size);
}

void *memory_resize(void *block, size_t count, size_t size)
{
    if (count == 0 || size == 0)
        count = size = 1;
    if (count > SIZE_MAX / size)
        return NULL;
    return realloc(block, count * size);
}

void memory_free(void *block)
{
    free(block);
}

void *arena_new(struct arena *arena, size_t count, size_t size)
{
    if (size != 0 && count > (SIZE_MAX / 2) / size)
        return NULL;
    size_t bytes = (count * size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    struct arena_block *block = arena->newest;
    if (!block || block->size - block->used < bytes) {
        size_t capacity = bytes > BLOCK_SIZE / 4 ? bytes : BLOCK_SIZE;
        struct arena_block *fresh = memory_new(1, HEADER + capacity);
        if (!fresh)
            return NULL;
        fresh->size = capacity;
        /* A large request gets a block of its own, placed behind the one that still has room. */
        if (block && capacity != BLOCK_SIZE) {
            fresh->older = block->older;
            block->older = fresh;
        } else {
            fresh->older = block;
            arena->newest = fresh;
        }
        block = fresh;
    }
    void *memory = (char *)block + HEADER + block->used;
    block->used += bytes;
    arena->used += bytes;
    return memory;
}

char *arena_text(struct arena *arena, const char *text, size_t length)
{
    char *copy = arena_new(arena, length + 1, 1);
    if (copy && length > 0)
        memcpy(copy, text, length);
    return copy;
}

void *arena_grow(struct arena *arena, const void *array, size_t count, size_t capacity, size_t size)
{
    void *larger = arena_new(arena, capacity, size);
    if (larger && count > 0)
        memcpy(larger, array, count * size);
    return larger;
}

int arena_reserve(struct arena *arena, void **array, size_t count, size_t *capacity, size_t size)
{
    size_t wanted = *capacity ? 2 * *capacity : 8;
    void *larger = arena_grow(arena, *array, count, wanted, size);
    if (!larger)
        return 0;
    *array = larger;
    *capacity = wanted;
    return 1;
}

void arena_free(struct arena *arena)
{
    struct arena_block *block = arena->newest;
    while (block) {
        struct arena_block *older = block->older;
        memory_free(block);
        block = older;
    }
    *arena = (struct arena){0};
}
