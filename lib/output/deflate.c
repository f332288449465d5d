#include "deflate.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"

enum {
    HISTORY = 32768, /* how far back a match may lie */
    BLOCK = 65536,   /* bytes compressed with one set of codes */
    HASH_BITS = 15,
    MATCH_LEAST = 3,
    MATCH_MOST = 258,
    CHAIN_MOST = 64, /* candidates looked at for a match: flat pictures gain nothing from more */
    LITERALS = 286,  /* literals, the end of the block, and lengths */
    DISTANCES = 30,
    END_OF_BLOCK = 256,
    CODE_LENGTHS = 19,
    SINK_SIZE = 16384
};

/* A set of Huffman codes: of each symbol its code, bits reversed as deflate sends them, and length. */
struct codes {
    uint32_t frequency[LITERALS];
    uint16_t code[LITERALS];
    unsigned char length[LITERALS]; /* 0: the symbol does not occur */
};

struct deflate {
    deflate_sink *sink;
    void *context;
    uint32_t adler_a, adler_b;
    /* The block being filled, behind the bytes before it that matches may copy. */
    unsigned char data[HISTORY + BLOCK];
    size_t history, filled;
    /* Chains of positions: the newest with a hash, and for each position the one before it, both plus one;
     * they are counted from the start of `data` and move with it. */
    uint32_t newest[1 << HASH_BITS], older[HISTORY + BLOCK];
    /* Literals (0, byte) and matches (distance, length) of the block. */
    uint32_t tokens[BLOCK];
    size_t token_count;
    struct codes literals, distances;
    uint64_t bits;
    unsigned bit_count;
    unsigned char output[SINK_SIZE];
    size_t output_used;
};

/* ---- Bits ---------------------------------------------------------------------------------------------- */

static void byte_put(struct deflate *deflate, unsigned char byte)
{
    deflate->output[deflate->output_used++] = byte;
    if (deflate->output_used == SINK_SIZE) {
        deflate->sink(deflate->context, deflate->output, SINK_SIZE);
        deflate->output_used = 0;
    }
}

/* Appends the low `count` bits (at most 16), the lowest first. */
static void bits_put(struct deflate *deflate, uint32_t bits, unsigned count)
{
    deflate->bits |= (uint64_t)bits << deflate->bit_count;
    deflate->bit_count += count;
    for (; deflate->bit_count >= 8; deflate->bit_count -= 8) {
        byte_put(deflate, (unsigned char)deflate->bits);
        deflate->bits >>= 8;
    }
}

/* ---- Lengths and distances (RFC 1951, 3.2.5) ----------------------------------------------------------- */

/* A symbol followed by the low bits of the value, which it leaves open. */
struct symbol {
    unsigned symbol, extra_count;
    uint32_t extra;
};

static unsigned logarithm(uint32_t value)
{
    unsigned bits = 0;
    while (value >>= 1)
        bits++;
    return bits;
}

/* From 4 (lengths: 8) on, symbols come in groups of 2 (4) that share the number of open bits. */
static struct symbol symbol_of(uint32_t value, unsigned group_bits)
{
    if (value < 2u << group_bits)
        return (struct symbol){value, 0, 0};
    unsigned open = logarithm(value) - group_bits;
    return (struct symbol){(open << group_bits) + (value >> open), open, value & ((1u << open) - 1)};
}

static struct symbol length_symbol(uint32_t length)
{
    if (length == MATCH_MOST)
        return (struct symbol){285, 0, 0};
    struct symbol result = symbol_of(length - MATCH_LEAST, 2);
    result.symbol += 257;
    return result;
}

static struct symbol distance_symbol(uint32_t distance)
{
    return symbol_of(distance - 1, 1);
}

/* ---- Huffman codes ------------------------------------------------------------------------------------- */

/* Sorts the symbols that occur by rising frequency; returns how many there are. Shell's sort: short and quick
 * enough for 286 symbols a block. */
static size_t symbols_sort(const struct codes *codes, size_t size, uint16_t *symbols)
{
    size_t count = 0;
    for (size_t i = 0; i < size; i++)
        if (codes->frequency[i] > 0)
            symbols[count++] = (uint16_t)i;
    for (size_t gap = count / 2; gap > 0; gap /= 2)
        for (size_t i = gap; i < count; i++) {
            uint16_t moving = symbols[i];
            size_t place = i;
            for (; place >= gap && codes->frequency[symbols[place - gap]] > codes->frequency[moving];
                 place -= gap)
                symbols[place] = symbols[place - gap];
            symbols[place] = moving;
        }
    return count;
}

/* Depths of the leaves of Huffman's tree, counted per depth: how many codes of each length. The tree is built
 * with two queues, the sorted leaves and the inner nodes, which arise in order of weight. */
static void depths_count(const struct codes *codes, const uint16_t *symbols, size_t count,
                         uint32_t *of_length)
{
    uint32_t weight[2 * LITERALS], parent[2 * LITERALS], depth[2 * LITERALS];
    size_t leaf = 0, inner = count, node = count;
    for (size_t i = 0; i < count; i++)
        weight[i] = codes->frequency[symbols[i]];
    for (; node < 2 * count - 1; node++) {
        weight[node] = 0;
        for (int child = 0; child < 2; child++) {
            bool takes_leaf = leaf < count && (inner == node || weight[leaf] <= weight[inner]);
            size_t taken = takes_leaf ? leaf++ : inner++;
            weight[node] += weight[taken];
            parent[taken] = (uint32_t)node;
        }
    }
    depth[node - 1] = 0;
    for (size_t i = node - 1; i-- > 0;)
        depth[i] = depth[parent[i]] + 1;
    for (size_t i = 0; i < count; i++)
        of_length[depth[i] < 31 ? depth[i] : 31]++;
}

/* Makes no code longer than `most` bits. Shortening the long ones oversubscribes the code space; each repair
 * lengthens one shorter code by a bit to make room, until Kraft's sum is 1 again. */
static void depths_limit(uint32_t *of_length, unsigned most)
{
    uint64_t kraft = 0;
    for (unsigned length = 31; length > most; length--) {
        of_length[most] += of_length[length];
        of_length[length] = 0;
    }
    for (unsigned length = 1; length <= most; length++)
        kraft += (uint64_t)of_length[length] << (most - length);
    for (; kraft > (uint64_t)1 << most; kraft--) {
        unsigned length = most - 1;
        while (of_length[length] == 0)
            length--;
        of_length[length]--;
        of_length[length + 1] += 2;
        of_length[most]--;
    }
}

static uint16_t bits_reverse(uint32_t bits, unsigned count)
{
    uint32_t reversed = 0;
    for (unsigned i = 0; i < count; i++)
        reversed |= (bits >> i & 1) << (count - 1 - i);
    return (uint16_t)reversed;
}

/* Canonical codes: by length, then by symbol (RFC 1951, 3.2.2). */
static void codes_assign(struct codes *codes, size_t size, const uint32_t *of_length, unsigned most)
{
    uint32_t next[32] = {0};
    for (unsigned length = 1; length <= most; length++)
        next[length] = (next[length - 1] + (length > 1 ? of_length[length - 1] : 0)) << 1;
    for (size_t i = 0; i < size; i++)
        if (codes->length[i] > 0)
            codes->code[i] = bits_reverse(next[codes->length[i]]++, codes->length[i]);
}

/* Makes the codes of the symbols below `size` from their frequencies. */
static void codes_make(struct codes *codes, size_t size, unsigned most)
{
    uint16_t symbols[LITERALS];
    uint32_t of_length[32] = {0};
    size_t count = symbols_sort(codes, size, symbols);
    /* A code for one symbol alone would have no bits: decoders want a tree. */
    for (size_t i = 0; count < 2 && i < 2; i++)
        if (codes->frequency[i] == 0) {
            codes->frequency[i] = 1;
            count = symbols_sort(codes, size, symbols);
        }
    depths_count(codes, symbols, count, of_length);
    depths_limit(of_length, most);
    memset(codes->length, 0, sizeof codes->length);
    size_t place = 0;
    for (unsigned length = most; length > 0; length--)
        for (uint32_t i = 0; i < of_length[length]; i++)
            codes->length[symbols[place++]] = (unsigned char)length;
    codes_assign(codes, size, of_length, most);
}

/* ---- Blocks -------------------------------------------------------------------------------------------- */

/* The lengths of all codes in run lengths (RFC 1951, 3.2.7): symbols 0–15, 16 (repeat), 17 and 18 (zeros),
 * each with its extra bits above. Returns how many. */
static size_t lengths_pack(const unsigned char *lengths, size_t count, uint16_t *packed)
{
    size_t used = 0;
    for (size_t i = 0; i < count;) {
        size_t run = 1;
        while (i + run < count && lengths[i + run] == lengths[i])
            run++;
        if (lengths[i] == 0 && run >= 3) {
            run = run < 138 ? run : 138;
            packed[used++] =
                (uint16_t)(run < 11 ? 17u | (unsigned)(run - 3) << 8 : 18u | (unsigned)(run - 11) << 8);
        } else if (i > 0 && lengths[i] == lengths[i - 1] && run >= 3) {
            run = run < 6 ? run : 6;
            packed[used++] = (uint16_t)(16u | (unsigned)(run - 3) << 8);
        } else {
            run = 1;
            packed[used++] = lengths[i];
        }
        i += run;
    }
    return used;
}

static size_t codes_used(const struct codes *codes, size_t size, size_t least)
{
    while (size > least && codes->length[size - 1] == 0)
        size--;
    return size;
}

/* The codes themselves, as their lengths, which are Huffman coded in turn. */
static void codes_put(struct deflate *deflate)
{
    static const unsigned char order[CODE_LENGTHS] = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                      11, 4,  12, 3, 13, 2, 14, 1, 15};
    unsigned char lengths[LITERALS + DISTANCES];
    uint16_t packed[LITERALS + DISTANCES];
    struct codes codes = {0};
    size_t literals = codes_used(&deflate->literals, LITERALS, 257);
    size_t distances = codes_used(&deflate->distances, DISTANCES, 1);
    memcpy(lengths, deflate->literals.length, literals);
    memcpy(lengths + literals, deflate->distances.length, distances);
    size_t count = lengths_pack(lengths, literals + distances, packed);
    for (size_t i = 0; i < count; i++)
        codes.frequency[packed[i] & 31]++;
    codes_make(&codes, CODE_LENGTHS, 7);
    size_t sent = CODE_LENGTHS;
    while (sent > 4 && codes.length[order[sent - 1]] == 0)
        sent--;
    bits_put(deflate, (uint32_t)literals - 257, 5);
    bits_put(deflate, (uint32_t)distances - 1, 5);
    bits_put(deflate, (uint32_t)sent - 4, 4);
    for (size_t i = 0; i < sent; i++)
        bits_put(deflate, codes.length[order[i]], 3);
    for (size_t i = 0; i < count; i++) {
        static const unsigned char extra[] = {2, 3, 7};
        unsigned symbol = packed[i] & 31;
        bits_put(deflate, codes.code[symbol], codes.length[symbol]);
        if (symbol >= 16)
            bits_put(deflate, packed[i] >> 8, extra[symbol - 16]);
    }
}

static void symbol_put(struct deflate *deflate, const struct codes *codes, struct symbol symbol)
{
    bits_put(deflate, codes->code[symbol.symbol], codes->length[symbol.symbol]);
    bits_put(deflate, symbol.extra, symbol.extra_count);
}

static void block_put(struct deflate *deflate, bool last)
{
    deflate->literals.frequency[END_OF_BLOCK]++;
    codes_make(&deflate->literals, LITERALS, 15);
    codes_make(&deflate->distances, DISTANCES, 15);
    bits_put(deflate, last, 1);
    bits_put(deflate, 2, 2); /* dynamic codes */
    codes_put(deflate);
    for (size_t i = 0; i < deflate->token_count; i++) {
        uint32_t distance = deflate->tokens[i] >> 16, value = deflate->tokens[i] & 0xffff;
        if (distance == 0) {
            bits_put(deflate, deflate->literals.code[value], deflate->literals.length[value]);
        } else {
            symbol_put(deflate, &deflate->literals, length_symbol(value));
            symbol_put(deflate, &deflate->distances, distance_symbol(distance));
        }
    }
    bits_put(deflate, deflate->literals.code[END_OF_BLOCK], deflate->literals.length[END_OF_BLOCK]);
    deflate->token_count = 0;
    memset(deflate->literals.frequency, 0, sizeof deflate->literals.frequency);
    memset(deflate->distances.frequency, 0, sizeof deflate->distances.frequency);
}

/* ---- Matches ------------------------------------------------------------------------------------------- */

static void token_add(struct deflate *deflate, uint32_t distance, uint32_t value)
{
    deflate->tokens[deflate->token_count++] = distance << 16 | value;
    if (distance == 0) {
        deflate->literals.frequency[value]++;
    } else {
        deflate->literals.frequency[length_symbol(value).symbol]++;
        deflate->distances.frequency[distance_symbol(distance).symbol]++;
    }
}

static uint32_t *chain_at(struct deflate *deflate, size_t position)
{
    const unsigned char *at = deflate->data + position;
    uint32_t three = at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16;
    return &deflate->newest[three * 0x9e3779b1u >> (32 - HASH_BITS)];
}

/* Makes `position` known; three bytes must follow. */
static void position_add(struct deflate *deflate, size_t position, size_t end)
{
    if (position + MATCH_LEAST > end)
        return;
    uint32_t *newest = chain_at(deflate, position);
    deflate->older[position] = *newest;
    *newest = (uint32_t)position + 1;
}

static size_t match_length(const unsigned char *a, const unsigned char *b, size_t most)
{
    size_t length = 0;
    while (length < most && a[length] == b[length])
        length++;
    return length;
}

/* The longest earlier occurrence of what follows `position`, nearest first; length 0 when there is none. */
static size_t match_find(struct deflate *deflate, size_t position, size_t end, size_t *distance)
{
    size_t most = end - position < MATCH_MOST ? end - position : MATCH_MOST, best = MATCH_LEAST - 1;
    if (most < MATCH_LEAST)
        return 0;
    uint32_t candidate = *chain_at(deflate, position);
    for (int tries = 0; candidate > 0 && tries < CHAIN_MOST && best < most; tries++) {
        size_t earlier = candidate - 1;
        if (position - earlier > HISTORY)
            break;
        if (deflate->data[earlier + best] == deflate->data[position + best]) {
            size_t length = match_length(deflate->data + earlier, deflate->data + position, most);
            if (length > best) {
                best = length;
                *distance = position - earlier;
            }
        }
        candidate = deflate->older[earlier];
    }
    return best >= MATCH_LEAST ? best : 0;
}

/* Turns the block's bytes into tokens. A match waits for the next position, which may have a longer one. */
static void block_match(struct deflate *deflate)
{
    size_t end = deflate->history + deflate->filled, position = deflate->history;
    size_t distance = 0, length = position < end ? match_find(deflate, position, end, &distance) : 0;
    while (position < end) {
        position_add(deflate, position, end);
        size_t next_distance = 0, next_length = 0;
        if (position + 1 < end && length < MATCH_MOST)
            next_length = match_find(deflate, position + 1, end, &next_distance);
        if (length > 0 && length >= next_length) {
            token_add(deflate, (uint32_t)distance, (uint32_t)length);
            for (size_t i = 1; i < length; i++)
                position_add(deflate, position + i, end);
            position += length;
            length = position < end ? match_find(deflate, position, end, &distance) : 0;
        } else {
            token_add(deflate, 0, deflate->data[position++]);
            length = next_length;
            distance = next_distance;
        }
    }
}

/* Drops all but the last HISTORY bytes, so that the next block has room. */
static void history_slide(struct deflate *deflate)
{
    size_t end = deflate->history + deflate->filled;
    size_t dropped = end > HISTORY ? end - HISTORY : 0;
    memmove(deflate->data, deflate->data + dropped, end - dropped);
    for (size_t i = 0; i < sizeof deflate->newest / sizeof deflate->newest[0]; i++)
        deflate->newest[i] = deflate->newest[i] > dropped ? deflate->newest[i] - (uint32_t)dropped : 0;
    for (size_t i = 0; i < end - dropped; i++) {
        uint32_t older = deflate->older[i + dropped];
        deflate->older[i] = older > dropped ? older - (uint32_t)dropped : 0;
    }
    deflate->history = end - dropped;
    deflate->filled = 0;
}

/* ---- The stream ---------------------------------------------------------------------------------------- */

struct deflate *deflate_new(deflate_sink *sink, void *context)
{
    struct deflate *deflate = memory_new(1, sizeof *deflate);
    if (!deflate)
        return NULL;
    deflate->sink = sink;
    deflate->context = context;
    deflate->adler_a = 1;
    byte_put(deflate, 0x78); /* deflate with a window of 32 KiB */
    byte_put(deflate, 0xda); /* no dictionary; best effort */
    return deflate;
}

static void adler_add(struct deflate *deflate, const unsigned char *bytes, size_t length)
{
    while (length > 0) {
        /* The most bytes whose sums fit in 32 bits. */
        size_t part = length < 5552 ? length : 5552;
        length -= part;
        for (; part > 0; part--) {
            deflate->adler_a += *bytes++;
            deflate->adler_b += deflate->adler_a;
        }
        deflate->adler_a %= 65521;
        deflate->adler_b %= 65521;
    }
}

void deflate_write(struct deflate *deflate, const unsigned char *bytes, size_t length)
{
    adler_add(deflate, bytes, length);
    while (length > 0) {
        if (deflate->filled == BLOCK) {
            block_match(deflate);
            block_put(deflate, false);
            history_slide(deflate);
        }
        size_t part = length < BLOCK - deflate->filled ? length : BLOCK - deflate->filled;
        memcpy(deflate->data + deflate->history + deflate->filled, bytes, part);
        deflate->filled += part;
        bytes += part;
        length -= part;
    }
}

void deflate_finish(struct deflate *deflate)
{
    if (!deflate)
        return;
    block_match(deflate);
    block_put(deflate, true);
    if (deflate->bit_count > 0)
        bits_put(deflate, 0, 8 - deflate->bit_count);
    uint32_t adler = deflate->adler_b << 16 | deflate->adler_a;
    for (int shift = 24; shift >= 0; shift -= 8)
        byte_put(deflate, (unsigned char)(adler >> shift));
    deflate->sink(deflate->context, deflate->output, deflate->output_used);
    memory_free(deflate);
}
