/* Deflate: lossless compression as pixel pictures need it: RFC 1951 inside the frame of RFC 1950 (zlib).
 *
 * Repetitions are found through chains of positions with equal hashes of three bytes; literals and matches of
 * each block are written with Huffman codes made for that block. Memory is fixed, whatever the length of the
 * data. */
#ifndef OUTPUT_DEFLATE_H
#define OUTPUT_DEFLATE_H

#include <stddef.h>

struct deflate;

/* Receives the compressed bytes. */
typedef void deflate_sink(void *context, const unsigned char *bytes, size_t length);

/* NULL: no memory. */
struct deflate *deflate_new(deflate_sink *sink, void *context);
void deflate_write(struct deflate *deflate, const unsigned char *bytes, size_t length);
/* Ends the stream and frees `deflate` (which may be NULL). */
void deflate_finish(struct deflate *deflate);

#endif
