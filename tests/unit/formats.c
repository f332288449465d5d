/* The data formats, read back by other code than wrote them, and the table of formats. */
#include <math.h>

#include "sample.h"
#include "tap.h"

enum { MANY = 10007 };

static bcifs_error failure;
static double many[3 * MANY];

static void random_fill(void)
{
    uint64_t state = 7;
    for (size_t i = 0; i < 3 * MANY; i++) {
        do {
            uint64_t bits = random_bits(&state);
            memcpy(&many[i], &bits, sizeof bits);
        } while (!isfinite(many[i]));
    }
    many[0] = -0.0;
    many[1] = 5e-324;
    many[2] = 1.7976931348623157e308;
}

static char *written(const struct sample *sample, const char *path, size_t *length)
{
    bcifs_status status = sample_write_one(sample, path, &failure);
    char *text = status == BCIFS_OK ? sample_read(path, length) : NULL;
    if (status != BCIFS_OK)
        note("%s", failure.message);
    remove(path);
    return text;
}

/* ---- csv ----------------------------------------------------------------------------------------------- */

static void test_csv(void)
{
    struct sample sample = {many, MANY, 3, NULL, 0, 0};
    size_t length, count = 0;
    char *text = written(&sample, "a.csv", &length);
    ok(text && strncmp(text, "x,y,z\n", 6) == 0, "csv: header of three coordinates");
    bool same = text != NULL;
    char *next = text ? text + 6 : NULL;
    while (same && *next && count < 3 * MANY) {
        double number = strtod(next, &next);
        same = memcmp(&number, &many[count], sizeof number) == 0 && *next == (count % 3 == 2 ? '\n' : ',');
        next++;
        count++;
    }
    ok(same && count == 3 * MANY && *next == '\0', "csv: every bit comes back (%zu numbers)", count);
    free(text);
}

static void csv_is(const struct sample *sample, const char *expected, const char *what)
{
    size_t length;
    char *text = written(sample, "a.csv", &length);
    ok(text && strcmp(text, expected) == 0, "csv: %s", what);
    free(text);
}

static const double grid[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
static const bcifs_path two_paths[] = {{0, 2, 0}, {2, 0, 0}, {2, 4, 1}};

static void test_csv_groups(void)
{
    csv_is(&(struct sample){grid, 6, 2, two_paths, 3, 0}, "x,y\n0,1\n2,3\n\n4,5\n6,7\n8,9\n10,11\n",
           "an empty line between paths, an empty path none");
    csv_is(&(struct sample){grid, 6, 2, NULL, 0, 3}, "x,y\n0,1\n2,3\n4,5\n\n6,7\n8,9\n10,11\n",
           "an empty line between polygons");
    csv_is(&(struct sample){grid, 3, 1, NULL, 0, 0}, "x\n0\n1\n2\n", "one coordinate");
    csv_is(&(struct sample){grid, 3, 4, NULL, 0, 0}, "x0,x1,x2,x3\n0,1,2,3\n4,5,6,7\n8,9,10,11\n",
           "numbered coordinates beyond three");
    csv_is(&(struct sample){grid, 0, 2, NULL, 0, 0}, "x,y\n", "no points");
}

/* ---- raw numbers --------------------------------------------------------------------------------------- */

static bool bytes_match(const unsigned char *bytes, const double *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t bits = 0, expected;
        for (int k = 7; k >= 0; k--)
            bits = bits << 8 | bytes[8 * i + (size_t)k];
        memcpy(&expected, &numbers[i], sizeof expected);
        if (bits != expected)
            return false;
    }
    return true;
}

static void test_f64(void)
{
    struct sample sample = {many, MANY, 3, NULL, 0, 0};
    size_t length;
    char *bytes = written(&sample, "a.f64", &length);
    ok(bytes && length == 24 * MANY, "f64: eight bytes a number");
    ok(bytes && bytes_match((unsigned char *)bytes, many, 3 * MANY), "f64: little-endian");
    free(bytes);
}

static void test_npy(void)
{
    static const struct sample samples[] = {{many, MANY, 3, NULL, 0, 0}, {grid, 12, 1, NULL, 0, 0}};
    for (size_t i = 0; i < 2; i++) {
        const struct sample *sample = &samples[i];
        size_t length;
        char *bytes = written(sample, "a.npy", &length), shape[64];
        unsigned char *head = (unsigned char *)bytes;
        ok(bytes && memcmp(bytes, "\x93NUMPY\x01\x00", 8) == 0, "npy: magic and version");
        size_t data = head ? 10u + head[8] + 256u * head[9] : 0;
        ok(data % 64 == 0 && bytes[data - 1] == '\n', "npy: the header is aligned");
        snprintf(shape, sizeof shape, "'shape': (%d, %u)", (int)sample->count, sample->dimension);
        bytes[data - 1] = '\0';
        ok(bytes[10] == '{' && strstr(bytes + 10, shape) && strstr(bytes + 10, "'descr': '<f8'") &&
               strstr(bytes + 10, "'fortran_order': False") && strrchr(bytes + 10, '}'),
           "npy: dictionary %s", bytes + 10);
        size_t numbers = (size_t)sample->count * sample->dimension;
        ok(length == data + 8 * numbers && bytes_match(head + data, sample->points, numbers),
           "npy: the numbers");
        free(bytes);
    }
}

/* ---- json ---------------------------------------------------------------------------------------------- */

/* Checks the syntax of one JSON value and copies it, white space left out, to `out`. */
static const char *json_copy(const char *text, char **out)
{
    text += strspn(text, " \n");
    char open = *text;
    if (open == '{' || open == '[') {
        *(*out)++ = *text++;
        for (bool first = true;; first = false) {
            text += strspn(text, " \n");
            if (*text == (open == '{' ? '}' : ']')) {
                *(*out)++ = *text++;
                return text;
            }
            if (!first && (*text != ',' || !(*(*out)++ = *text++)))
                return NULL;
            if (open == '{') {
                text = json_copy(text, out);
                if (!text || *text != ':')
                    return NULL;
                *(*out)++ = *text++;
            }
            text = json_copy(text, out);
            if (!text)
                return NULL;
        }
    }
    const char *start = text;
    if (open == '"') {
        for (text++; *text && *text != '"'; text++)
            if (*text == '\\')
                text++;
        text++;
    } else {
        text += strcspn(text, " \n,:]}");
    }
    memcpy(*out, start, (size_t)(text - start));
    *out += text - start;
    return text > start ? text : NULL;
}

static void json_is(const struct sample *sample, const char *expected, const char *what)
{
    size_t length;
    char *text = written(sample, "a.json", &length), bare[1000] = "", *out = bare;
    const char *rest = text ? json_copy(text, &out) : NULL;
    ok(rest && strcmp(rest, "\n") == 0 && strcmp(bare, expected) == 0, "json: %s", what);
    if (strcmp(bare, expected) != 0)
        note("%s", bare);
    free(text);
}

static void test_json(void)
{
#define HEAD(dimension, points)                                                                              \
    "{\"automaton\":\"sample\",\"figure\":\"shape\",\"dimension\":" #dimension ",\"points\":" #points ","
    json_is(&(struct sample){grid, 6, 2, two_paths, 3, 0},
            HEAD(2, 6) "\"paths\":[{\"closed\":false,\"points\":[[0,1],[2,3]]},"
                       "{\"closed\":true,\"points\":[[4,5],[6,7],[8,9],[10,11]]}]}",
            "paths");
    json_is(&(struct sample){grid, 6, 2, NULL, 0, 3},
            HEAD(2, 6) "\"polygons\":[[[0,1],[2,3],[4,5]],[[6,7],[8,9],[10,11]]]}", "polygons");
    json_is(&(struct sample){grid, 3, 1, NULL, 0, 0}, HEAD(1, 3) "\"coordinates\":[[0],[1],[2]]}",
            "loose points");
    json_is(&(struct sample){grid, 0, 1, NULL, 0, 0}, HEAD(1, 0) "\"coordinates\":[]}", "no points");
    struct sample sample = {grid, 2, 1, NULL, 0, 0};
    struct layer layer = sample_layer(&sample, BCIFS_CURVE);
    struct report report;
    struct job job = sample_job(&layer, 1, &report);
    job.figure = "q\"\\\x01\xc3\xa9\xff";
    format_write(format_find("json", "", &report), &job, "a.json");
    size_t length;
    char *text = sample_read("a.json", &length);
    ok(text && strstr(text, "\"figure\": \"q\\\"\\\\\\u0001\xc3\xa9\xef\xbf\xbd\""), "json: escapes");
    free(text);
    remove("a.json");
}

/* ---- Promises ------------------------------------------------------------------------------------------ */

static void test_not_finite(void)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    struct sample sample = {many, MANY, 2, NULL, 0, 0};
    for (size_t i = 0; bcifs_format_name(i); i++) {
        char path[16];
        snprintf(path, sizeof path, "bad.%s", bcifs_format_name(i));
        double saved = many[2 * 9001 + 1];
        many[2 * 9001 + 1] = bad[i % 3];
        ok(sample_write_one(&sample, path, &failure) == BCIFS_INPUT && sample_directory_count() == 0,
           "%s: no file with a number that is none", bcifs_format_name(i));
        ok(strstr(failure.message, "point 9001 is not finite") != NULL, "%s: %s", bcifs_format_name(i),
           failure.message);
        many[2 * 9001 + 1] = saved;
    }
}

static double shares[1000];
static int share_count;

static void share_note(void *context, double share)
{
    *(int *)context += 1;
    shares[share_count++ % 1000] = share;
}

static void test_progress(void)
{
    enum { POINTS = 5 << 16 };
    double *points = calloc(POINTS, sizeof *points);
    struct sample sample = {points, POINTS, 1, NULL, 0, 0};
    struct layer layer = sample_layer(&sample, BCIFS_CURVE);
    for (size_t i = 0; bcifs_format_name(i); i++) {
        struct report report;
        struct job job = sample_job(&layer, 1, &report);
        int calls = 0;
        share_count = 0;
        job.progress = share_note;
        job.context = &calls;
        format_write(format_find(bcifs_format_name(i), "", &report), &job, "/dev/null");
        bool rising = true;
        for (int k = 0; k < share_count; k++)
            rising = rising && shares[k] > (k ? shares[k - 1] : 0) && shares[k] <= 1;
        ok(calls == (bcifs_format_is_picture(i) ? 10 : 5) && rising, "%s: progress rises to 1 in %d calls",
           bcifs_format_name(i), calls);
    }
    free(points);
}

static void test_table(void)
{
    struct report report = report_new(NULL);
    ok(strcmp(format_find(NULL, "-", &report)->name, "csv") == 0, "- without a format is csv");
    ok(strcmp(format_find(NULL, "a.b/c.PNG", &report)->name, "png") == 0, "endings in capitals");
    ok(strcmp(format_find("Svg", "x.csv", &report)->name, "svg") == 0, "a name goes before the ending");
    ok(!format_find(NULL, "dir.csv/plain", &report), "a directory's ending is none");
    ok(report_close(&report, &failure) == BCIFS_INPUT && strstr(failure.message, "'dir.csv/plain'") &&
           strstr(failure.message, ".csv, ") && strstr(failure.message, " or .png"),
       "%s", failure.message);
    report = report_new(NULL);
    ok(!format_find("gif", "x.csv", &report), "an unknown name");
    report_close(&report, &failure);
    ok(strstr(failure.message, "'gif'") && strstr(failure.message, "csv, "), "%s", failure.message);
    size_t count = 0;
    for (; bcifs_format_name(count); count++)
        if (!bcifs_format_text(count))
            break;
    ok(count == 6 && !bcifs_format_text(count) && !bcifs_format_is_picture(count), "the table ends");
}

int main(void)
{
    char directory[64];
    sample_directory_enter(directory);
    random_fill();
    test_csv();
    test_csv_groups();
    test_f64();
    test_npy();
    test_json();
    test_not_finite();
    test_progress();
    test_table();
    sample_directory_remove(directory);
    return done_testing();
}
