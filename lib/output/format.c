#include "format.h"

#include <string.h>

static const struct format FORMATS[] = {
    {"csv", ".csv", "comma-separated text with a header, one point a line, an empty line between paths",
     false, csv_write},
    {"json", ".json", "one JSON object with the points of every path", false, json_write},
    {"npy", ".npy", "NumPy array of doubles, points x dimension", false, npy_write},
    {"f64", ".f64", "raw little-endian doubles, point after point", false, f64_write},
    {"svg", ".svg", "vector picture", true, svg_write},
    {"png", ".png", "pixel picture", true, png_write},
};

enum { FORMAT_COUNT = sizeof FORMATS / sizeof FORMATS[0] };

const char *bcifs_format_name(size_t index)
{
    return index < FORMAT_COUNT ? FORMATS[index].name : NULL;
}

const char *bcifs_format_text(size_t index)
{
    return index < FORMAT_COUNT ? FORMATS[index].text : NULL;
}

int bcifs_format_is_picture(size_t index)
{
    return index < FORMAT_COUNT && FORMATS[index].is_picture;
}

/* Letters of ASCII only: the C library's idea of a letter follows the locale. */
static int letter_lower(char letter)
{
    return letter >= 'A' && letter <= 'Z' ? letter - 'A' + 'a' : letter;
}

static bool words_alike(const char *a, const char *b)
{
    while (*a && letter_lower(*a) == letter_lower(*b))
        a++, b++;
    return letter_lower(*a) == letter_lower(*b);
}

/* Writes the names, or the endings, of all formats: "a, b or c". */
static void formats_list(char *list, size_t capacity, bool endings)
{
    size_t used = 0;
    for (size_t i = 0; i < FORMAT_COUNT; i++) {
        const char *separator = i == 0 ? "" : i + 1 < FORMAT_COUNT ? ", " : " or ";
        const char *word = endings ? FORMATS[i].ending : FORMATS[i].name;
        size_t length = strlen(separator) + strlen(word);
        if (used + length + 1 > capacity)
            break;
        memcpy(list + used, separator, strlen(separator));
        memcpy(list + used + strlen(separator), word, strlen(word));
        used += length;
    }
    list[used] = '\0';
}

static const struct format *format_by_name(const char *name, struct report *report)
{
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (words_alike(name, FORMATS[i].name))
            return &FORMATS[i];
    char list[128];
    formats_list(list, sizeof list, false);
    report_failure(report, BCIFS_INPUT, NULL, "unknown format '%s'; expected %s", name, list);
    return NULL;
}

const struct format *format_find(const char *name, const char *path, struct report *report)
{
    if (name)
        return format_by_name(name, report);
    if (strcmp(path, "-") == 0)
        return &FORMATS[0];
    const char *slash = strrchr(path, '/');
    const char *ending = strrchr(slash ? slash + 1 : path, '.');
    for (size_t i = 0; ending && i < FORMAT_COUNT; i++)
        if (words_alike(ending, FORMATS[i].ending))
            return &FORMATS[i];
    char list[128];
    formats_list(list, sizeof list, true);
    report_failure(report, BCIFS_INPUT, NULL, "the ending of '%s' names no known format; expected %s", path,
                   list);
    return NULL;
}

bcifs_status format_write(const struct format *format, struct job *job, const char *path)
{
    struct file file;
    bcifs_status status = file_open(&file, path, job->report);
    if (status != BCIFS_OK)
        return status;
    return file_close(&file, format->write(job, &file));
}
