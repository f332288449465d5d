/* Findings are composed in buffers of fixed size, so that the one about missing memory can be made too. */
#include "language/report.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum {
    EXCERPT_BYTES = 120,                  /* of a source line: what a terminal shows in one or two lines */
    EXCERPT_SIZE = 2 * EXCERPT_BYTES + 16 /* the line, the carets' line as long, two ellipses, two newlines */
};

static const char ELLIPSIS[] = "…";

static bool is_continuation(char byte)
{
    return ((unsigned char)byte & 0xC0) == 0x80;
}

/* ---- Text that fits ------------------------------------------------------------------------------------ */

/* Copies `text` to `out` (`size` bytes), shortened at a character's border when it is too long. */
static void copy_text(char *out, size_t size, const char *text)
{
    size_t length = strlen(text);
    if (length < size) {
        memcpy(out, text, length + 1);
        return;
    }
    length = size - sizeof ELLIPSIS;
    while (length > 0 && is_continuation(text[length]))
        length--;
    memcpy(out, text, length);
    memcpy(out + length, ELLIPSIS, sizeof ELLIPSIS);
}

/* printf to `out` (`size` bytes), shortened in the same way. */
static void format_text(char *out, size_t size, const char *format, va_list arguments)
{
    int length = vsnprintf(out, size, format, arguments);
    if (length < 0)
        out[0] = '\0';
    if (length < 0 || (size_t)length < size)
        return;
    size_t end = size - sizeof ELLIPSIS;
    while (end > 0 && is_continuation(out[end]))
        end--;
    memcpy(out + end, ELLIPSIS, sizeof ELLIPSIS);
}

/* ---- The excerpt --------------------------------------------------------------------------------------- */

/* Narrows start..end, a line, to EXCERPT_BYTES around `place`, on borders of characters. */
static void cut_line(const char *text, size_t place, size_t *start, size_t *end)
{
    if (*end - *start <= EXCERPT_BYTES)
        return;
    size_t from = place - *start > EXCERPT_BYTES / 2 ? place - EXCERPT_BYTES / 2 : *start;
    if (*end - from < EXCERPT_BYTES)
        from = *end - EXCERPT_BYTES;
    size_t to = from + EXCERPT_BYTES;
    while (from > *start && from < place && is_continuation(text[from]))
        from++;
    while (to < *end && to > place && is_continuation(text[to]))
        to--;
    *start = from;
    *end = to;
}

/* The length of the character at `bytes` when it may be shown on a terminal; 0 for control characters and what is not
 * UTF-8, of which the file may be full: that is being reported. */
static size_t shown_length(const unsigned char *bytes, size_t length)
{
    if (bytes[0] < 0x80)
        return bytes[0] == '\t' || (bytes[0] >= 0x20 && bytes[0] != 0x7f);
    size_t wanted = bytes[0] >= 0xf0 ? 4 : bytes[0] >= 0xe0 ? 3 : 2;
    if (bytes[0] < 0xc2 || bytes[0] > 0xf4 || wanted > length || (bytes[0] == 0xc2 && bytes[1] < 0xa0))
        return 0;
    for (size_t i = 1; i < wanted; i++)
        if (!is_continuation((char)bytes[i]))
            return 0;
    return wanted;
}

static void mask_unshown(char *text, size_t length)
{
    for (size_t i = 0; i < length;) {
        size_t shown = shown_length((const unsigned char *)text + i, length - i);
        if (shown == 0)
            text[i] = '?';
        i += shown ? shown : 1;
    }
}

/* Writes the line around `place` and a caret below it; false when the line is blank, as at the end of a file.
 */
static bool write_excerpt(const struct source *source, size_t place, char out[EXCERPT_SIZE])
{
    const char *text = source->text;
    size_t line_start = place, line_end = place;
    while (line_start > 0 && text[line_start - 1] != '\n')
        line_start--;
    while (line_end < source->length && text[line_end] != '\n')
        line_end++;
    if (line_end > line_start && text[line_end - 1] == '\r')
        line_end--;
    if (line_start == 0 && line_end >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0)
        line_start = 3;
    if (strspn(text + line_start, " \t") >= line_end - line_start)
        return false;
    if (place > line_end)
        place = line_end;
    if (place < line_start)
        place = line_start;
    size_t start = line_start, end = line_end, used = 0;
    cut_line(text, place, &start, &end);

    if (start > line_start)
        used += (size_t)sprintf(out, "%s", ELLIPSIS);
    char *line = out + used;
    memcpy(line, text + start, end - start);
    mask_unshown(line, end - start);
    used += end - start;
    if (end < line_end)
        used += (size_t)sprintf(out + used, "%s", ELLIPSIS);
    out[used++] = '\n';
    if (start > line_start)
        out[used++] = ' ';
    for (size_t i = 0; i < place - start; i++)
        if (!is_continuation(line[i]))
            out[used++] = line[i] == '\t' ? '\t' : ' ';
    out[used++] = '^';
    out[used] = '\0';
    return true;
}

/* ---- Reports ------------------------------------------------------------------------------------------- */

struct report report_new(const bcifs_load_options *options)
{
    struct report report = {0};
    if (options) {
        report.callback = options->report;
        report.context = options->context;
    }
    return report;
}

/* Counts a finding, keeps the first error, and hands the finding on unless enough were. */
static void add_finding(struct report *report, bcifs_status status, const bcifs_diagnostic *finding)
{
    bool full = report_is_full(report);
    if (finding->is_warning) {
        report->warnings++;
    } else if (report->errors++ == 0) {
        report->first = (bcifs_error){.status = status, .line = finding->line, .column = finding->column};
        copy_text(report->first.file, sizeof report->first.file, finding->file ? finding->file : "");
        copy_text(report->first.message, sizeof report->first.message, finding->message);
    }
    if (!full && report->callback)
        report->callback(report->context, finding);
}

static void add_placed(struct report *report, bool is_warning, const struct source *source,
                       source_place place, const char *format, va_list arguments)
{
    char message[sizeof report->first.message], excerpt[EXCERPT_SIZE];
    size_t at = place < source->length ? place : source->length;
    bcifs_diagnostic finding = {.is_warning = is_warning, .file = source->name, .message = message};
    format_text(message, sizeof message, format, arguments);
    source_locate(source, (source_place)at, &finding.line, &finding.column);
    if (write_excerpt(source, at, excerpt))
        finding.excerpt = excerpt;
    add_finding(report, BCIFS_INPUT, &finding);
}

bcifs_status report_error(struct report *report, const struct source *source, source_place place,
                          const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_placed(report, false, source, place, format, arguments);
    va_end(arguments);
    return BCIFS_INPUT;
}

void report_warning(struct report *report, const struct source *source, source_place place,
                    const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add_placed(report, true, source, place, format, arguments);
    va_end(arguments);
}

bcifs_status report_failure(struct report *report, bcifs_status status, const char *file, const char *format,
                            ...)
{
    char message[sizeof report->first.message];
    va_list arguments;
    va_start(arguments, format);
    format_text(message, sizeof message, format, arguments);
    va_end(arguments);
    add_finding(report, status, &(bcifs_diagnostic){.file = file, .message = message});
    return status;
}

bcifs_status report_memory(struct report *report)
{
    return report_failure(report, BCIFS_MEMORY, NULL, "out of memory");
}

bool report_is_full(const struct report *report)
{
    return report->errors >= REPORT_MOST;
}

bcifs_status report_close(const struct report *report, bcifs_error *error)
{
    if (error)
        *error = report->first;
    return report->first.status;
}

/* ---- Words that were meant ----------------------------------------------------------------------------- */

enum { WORD_LONGEST = 64 };

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* The number of edits between two words of at most WORD_LONGEST bytes: D(i,j) is the distance of the first i
 * bytes of `a` from the first j of `b` (optimal string alignment); three rows of D are enough. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t rows[3][WORD_LONGEST + 1], *before = rows[0], *above = rows[1], *row = rows[2];
    size_t length = strlen(b);
    for (size_t j = 0; j <= length; j++)
        row[j] = j;
    for (size_t i = 1; a[i - 1] != '\0'; i++) {
        size_t *freed = before;
        before = above;
        above = row;
        row = freed;
        row[0] = i;
        for (size_t j = 1; j <= length; j++) {
            size_t replace = above[j - 1] + (a[i - 1] != b[j - 1]);
            row[j] = least(replace, least(above[j], row[j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = least(row[j], before[j - 2] + 1);
        }
    }
    return row[length];
}

const char *nearest_word(const char *word, const char *const *candidates, size_t count)
{
    size_t length = strlen(word);
    if (length > WORD_LONGEST)
        return NULL;
    const char *nearest = NULL;
    size_t nearest_distance = length / 3 > 1 ? length / 3 : 1;
    for (size_t i = 0; i < count; i++) {
        if (strlen(candidates[i]) > WORD_LONGEST)
            continue;
        size_t distance = edit_distance(word, candidates[i]);
        /* A word with no letter in common is not a slip of the pen. */
        if (distance == 0 || distance >= length || distance > nearest_distance ||
            (nearest && distance == nearest_distance))
            continue;
        nearest = candidates[i];
        nearest_distance = distance;
    }
    return nearest;
}
