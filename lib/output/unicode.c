#include "unicode.h"

/* Bytes of the well-formed sequence at `text`, 1 to 4, with its code; 0 when there is none. No sequence reads
 * past a NUL, which continues nothing. */
static size_t sequence_decode(const char *text, uint32_t *code)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    unsigned char lead = (unsigned char)text[0];
    if (lead < 0x80) {
        *code = lead;
        return 1;
    }
    size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4)
        return 0;
    *code = lead & (0x7fu >> length);
    for (size_t i = 1; i < length; i++) {
        unsigned char byte = (unsigned char)text[i];
        if ((byte & 0xc0) != 0x80)
            return 0;
        *code = *code << 6 | (byte & 0x3f);
    }
    if (*code < least[length] || *code > 0x10ffff || (*code >= 0xd800 && *code <= 0xdfff))
        return 0;
    return length;
}

struct unicode unicode_first(const char *text)
{
    struct unicode result = {.bytes = text, .rest = text};
    if (text[0] == '\0')
        return result;
    result.length = sequence_decode(text, &result.code);
    result.rest = text + (result.length ? result.length : 1);
    if (result.length == 0) {
        result.code = 0xfffd;
        result.bytes = "\xef\xbf\xbd";
        result.length = 3;
    }
    return result;
}

struct unicode unicode_next(const struct unicode *character)
{
    return unicode_first(character->rest);
}
