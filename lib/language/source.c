/* Reading a file whole, within a bound, and refusing what is not text before anything looks at it. */
#include "language/source.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "language/report.h"

static const char BYTE_ORDER_MARK[] = "\xEF\xBB\xBF";

/* ---- What is text -------------------------------------------------------------------------------------- */

/* The length in bytes of the well-formed UTF-8 character at `bytes` (a NUL follows the text), or 0: no
 * overlong forms, no surrogates, nothing above U+10FFFF (RFC 3629). */
static size_t character_length(const unsigned char *bytes)
{
    unsigned char first = bytes[0];
    if (first < 0x80)
        return 1;
    size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
    for (size_t i = 1; i < length; i++)
        if ((bytes[i] & 0xC0) != 0x80)
            return 0;
    if ((first == 0xE0 && bytes[1] < 0xA0) || (first == 0xED && bytes[1] >= 0xA0) ||
        (first == 0xF0 && bytes[1] < 0x90) || (first == 0xF4 && bytes[1] >= 0x90))
        return 0;
    return length;
}

/* Control characters could rewrite a terminal's screen when a message shows the line; C1 controls likewise.
 */
static bool is_control(const unsigned char *bytes)
{
    unsigned char first = bytes[0];
    if (first == '\r')
        return bytes[1] != '\n';
    return (first < 0x20 && first != '\t' && first != '\n') || first == 0x7F ||
           (first == 0xC2 && bytes[1] < 0xA0);
}

static bcifs_status check_text(const struct source *source, struct report *report)
{
    const unsigned char *bytes = (const unsigned char *)source->text;
    const char *nul = memchr(source->text, '\0', source->length);
    if (nul)
        return report_error(report, source, (source_place)(nul - source->text),
                            "this is not a text file: it contains a NUL byte");
    for (size_t i = 0; i < source->length;) {
        size_t length = character_length(bytes + i);
        if (length == 0)
            return report_error(report, source, (source_place)i,
                                "this is not UTF-8 text: unexpected byte 0x%02X", bytes[i]);
        if (bytes[i] == '\r' && is_control(bytes + i))
            return report_error(
                report, source, (source_place)i,
                "expected a newline after the carriage return: save the file with Unix or Windows "
                "line ends");
        if (is_control(bytes + i))
            return report_error(report, source, (source_place)i,
                                "the control character 0x%02X may not stand in an automaton file",
                                length == 1 ? bytes[i] : bytes[i + 1]);
        i += length;
    }
    return BCIFS_OK;
}

bcifs_status source_from_text(struct arena *arena, const char *name, const char *text, size_t length,
                              struct report *report, struct source **source)
{
    if (length > SOURCE_LONGEST)
        return report_failure(report, BCIFS_INPUT, name, "the file is longer than %d bytes, the limit",
                              SOURCE_LONGEST);
    struct source *made = arena_new(arena, 1, sizeof *made);
    char *name_copy = arena_text(arena, name, strlen(name));
    char *text_copy = arena_text(arena, text, length);
    if (!made || !name_copy || !text_copy)
        return report_memory(report);
    *made = (struct source){.name = name_copy, .text = text_copy, .length = length};
    bcifs_status status = check_text(made, report);
    if (status == BCIFS_OK)
        *source = made;
    return status;
}

/* ---- Files --------------------------------------------------------------------------------------------- */

/* Whether the user can mend the failure by naming another file. */
static bcifs_status failure_status(int code)
{
    switch (code) {
    case ENOENT:
    case ENOTDIR:
    case EISDIR:
    case EACCES:
    case EPERM:
    case ELOOP:
    case ENAMETOOLONG:
        return BCIFS_INPUT;
    case ENOMEM:
        return BCIFS_MEMORY;
    default:
        return BCIFS_SYSTEM;
    }
}

/* Reads up to one byte more than the limit, so that the caller sees that it was passed; *text is the caller's
 * to free. Memory follows the bytes that came, whatever the file claims to be. */
static bcifs_status read_stream(FILE *stream, const char *name, struct report *report, char **text,
                                size_t *length)
{
    size_t capacity = 0, used = 0;
    char *buffer = NULL;
    while (used <= SOURCE_LONGEST) {
        if (used == capacity) {
            capacity = capacity ? 2 * capacity : 64 * 1024;
            char *larger = memory_resize(buffer, capacity, 1);
            if (!larger) {
                memory_free(buffer);
                return report_memory(report);
            }
            buffer = larger;
        }
        size_t got = fread(buffer + used, 1, capacity - used, stream);
        used += got;
        if (got == 0)
            break;
    }
    if (ferror(stream)) {
        int code = errno;
        memory_free(buffer);
        return report_failure(report, failure_status(code), name, "cannot read '%s': %s", name,
                              strerror(code));
    }
    *text = buffer;
    *length = used;
    return BCIFS_OK;
}

static bcifs_status open_stream(const char *path, struct report *report, FILE **stream)
{
    FILE *opened = fopen(path, "rb");
    if (!opened) {
        int code = errno;
        return report_failure(report, failure_status(code), path, "cannot open '%s': %s", path,
                              strerror(code));
    }
    struct stat state;
    if (fstat(fileno(opened), &state) == 0 && S_ISDIR(state.st_mode)) {
        fclose(opened);
        return report_failure(report, BCIFS_INPUT, path, "cannot read '%s': it is a directory", path);
    }
    *stream = opened;
    return BCIFS_OK;
}

bcifs_status source_read(struct arena *arena, const char *path, struct report *report, struct source **source)
{
    bool standard = strcmp(path, "-") == 0;
    const char *name = standard ? "<stdin>" : path;
    FILE *stream = stdin;
    if (!standard) {
        bcifs_status status = open_stream(path, report, &stream);
        if (status != BCIFS_OK)
            return status;
    }
    char *text = NULL;
    size_t length = 0;
    bcifs_status status = read_stream(stream, name, report, &text, &length);
    if (!standard)
        fclose(stream);
    if (status == BCIFS_OK)
        status = source_from_text(arena, name, text, length, report, source);
    memory_free(text);
    return status;
}

/* ---- Places -------------------------------------------------------------------------------------------- */

void source_locate(const struct source *source, source_place place, unsigned *line, unsigned *column)
{
    size_t end = place < source->length ? place : source->length;
    size_t start = 0;
    unsigned lines = 1, characters = 1;
    for (const char *at = source->text; (at = memchr(at, '\n', (size_t)(source->text + end - at))) != NULL;
         at++) {
        lines++;
        start = (size_t)(at - source->text) + 1;
    }
    if (start == 0 && end >= 3 && memcmp(source->text, BYTE_ORDER_MARK, 3) == 0)
        start = 3;
    for (size_t i = start; i < end; i++)
        if (((unsigned char)source->text[i] & 0xC0) != 0x80)
            characters++;
    *line = lines;
    *column = characters;
}
