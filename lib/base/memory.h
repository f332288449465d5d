/* Memory: the one place where the library asks for it, and the arena that most of it lives in.
 *
 * Everything that belongs to one job (a parsed file, a bound automaton, an evaluation plan) is taken from one
 * arena and given back with it, so no function needs a cleanup path. A request that fails returns NULL; sizes
 * are products checked for overflow, because counts come from files. */
#ifndef BASE_MEMORY_H
#define BASE_MEMORY_H

#include <stddef.h>

/* `count` zeroed elements of `size` bytes, or NULL. A zero-sized request yields a valid block. */
void *memory_new(size_t count, size_t size);
/* Resizes a block (or NULL) to `count` elements of `size` bytes; on failure returns NULL, `block` stays valid. */
void *memory_resize(void *block, size_t count, size_t size);
void memory_free(void *block);

struct arena_block;

/* Zero-initialize (`struct arena arena = {0}`), allocate, free as a whole. Not for use by two threads at once. */
struct arena {
    struct arena_block *newest;
    size_t used; /* bytes handed out so far, for limits */
};

/* `count` zeroed elements of `size` bytes, aligned for any type, or NULL. */
void *arena_new(struct arena *arena, size_t count, size_t size);
/* A NUL-terminated copy of `length` bytes of `text`, or NULL. */
char *arena_text(struct arena *arena, const char *text, size_t length);
/* A larger copy of an array of `count` elements with room for `capacity`, or NULL; the old one is abandoned. */
void *arena_grow(struct arena *arena, const void *array, size_t count, size_t capacity, size_t size);
void arena_free(struct arena *arena);

/* Makes room for one more element in an arena array: doubles `array` when `count` reaches `capacity`.
 * Evaluates to false when memory is out. */
#define ARENA_RESERVE(arena, array, count, capacity)                                                         \
    ((count) < (capacity) || arena_reserve((arena), (void **)&(array), (count), &(capacity), sizeof *(array)))
int arena_reserve(struct arena *arena, void **array, size_t count, size_t *capacity, size_t size);

#endif
