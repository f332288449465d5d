/* Vector pictures: well-formed, true to the data through the transform that they record, and the same
 * whatever the scale and place of the data. */
#include <ctype.h>
#include <math.h>

#include "sample.h"
#include "tap.h"

enum { SIDES = 100 };

static bcifs_error failure;

static char *drawn_layers(const struct layer *layers, size_t count, unsigned width)
{
    size_t length;
    bcifs_status status = sample_write(layers, count, "a.svg", width, &failure);
    char *text = status == BCIFS_OK ? sample_read("a.svg", &length) : NULL;
    if (status != BCIFS_OK)
        note("%s", failure.message);
    remove("a.svg");
    return text;
}

static char *drawn(const struct sample *sample)
{
    struct layer layer = sample_layer(sample, BCIFS_CURVE);
    return drawn_layers(&layer, 1, 1000);
}

/* ---- A small scanner of XML ---------------------------------------------------------------------------- */

/* Checks the references in text up to `end`; returns where it ends, NULL when it is not well-formed. */
static const char *xml_text(const char *text, char end)
{
    static const char *const references[] = {"&lt;", "&gt;", "&amp;", "&quot;", "&#13;"};
    for (; *text && *text != end; text++) {
        bool known = *text != '&';
        for (size_t i = 0; i < 5 && !known; i++)
            known = strncmp(text, references[i], strlen(references[i])) == 0;
        if (!known || *text == '<' || ((unsigned char)*text < 0x20 && !strchr("\n\t", *text)))
            return NULL;
    }
    return text;
}

/* One tag after its '<': name, attributes, '>' or '/>'. Writes the name, and whether the tag is empty. */
static const char *xml_tag(const char *text, char name[40], bool *empty)
{
    size_t length = strcspn(text, " \n/>");
    snprintf(name, 40, "%.*s", (int)length, text);
    for (text += length;;) {
        text += strspn(text, " \n");
        *empty = *text == '/';
        if (*text == '/' || *text == '>')
            return text[*empty] == '>' ? text + 1 + *empty : NULL;
        text += strcspn(text, "= \n>");
        if (text[0] != '=' || text[1] != '"' || !(text = xml_text(text + 2, '"')) || *text++ != '"')
            return NULL;
    }
}

static bool xml_is_well_formed(const char *text)
{
    char names[16][40], closing[50];
    int depth = 0, roots = 0;
    static const char declaration[] = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    if (!text || strncmp(text, declaration, sizeof declaration - 1) != 0)
        return false;
    for (text += sizeof declaration - 1; (text = xml_text(text, '<')) && *text;) {
        bool empty;
        if (strncmp(text, "<!--", 4) == 0) {
            text = strstr(text, "-->") + 3;
        } else if (text[1] == '/') {
            snprintf(closing, sizeof closing, "</%s>", depth > 0 ? names[depth - 1] : "");
            if (strncmp(text, closing, strlen(closing)) != 0)
                return false;
            text += strlen(closing);
            depth--;
        } else {
            roots += depth == 0;
            text = xml_tag(text + 1, names[depth], &empty);
            if (!text || (depth += !empty) == 16)
                return false;
        }
    }
    return text && depth == 0 && roots == 1;
}

static double attribute(const char *text, const char *name)
{
    char key[40];
    snprintf(key, sizeof key, " %s=\"", name);
    const char *place = text ? strstr(text, key) : NULL;
    return place ? strtod(place + strlen(key), NULL) : NAN;
}

/* The coordinates of the path data of the first <path> of a class; returns how many numbers. `verbs` receives
 * the letters. */
static size_t path_numbers(const char *text, const char *kind, double *numbers, size_t capacity, char *verbs)
{
    char key[60];
    size_t count = 0;
    snprintf(key, sizeof key, "<path class=\"%s\"", kind);
    const char *place = text ? strstr(text, key) : NULL;
    place = place ? strstr(place, " d=\"") : NULL;
    for (place = place ? place + 4 : "\""; *place != '"' && count < capacity;) {
        if (isalpha((unsigned char)*place))
            *verbs++ = *place++;
        else if (isspace((unsigned char)*place))
            place++;
        else
            numbers[count++] = strtod(place, (char **)&place);
    }
    *verbs = '\0';
    return count;
}

/* ---- Samples ------------------------------------------------------------------------------------------- */

static double shape[2 * SIDES];
static const bcifs_path closed_path = {0, SIDES, 1}, open_path = {0, SIDES, 0};

/* A flower, its coordinates scaled and moved. */
static struct sample flower(double scale, double x, double y)
{
    for (int i = 0; i < SIDES; i++) {
        double angle = 2 * acos(-1) * i / SIDES, radius = 2 + cos(5 * angle);
        shape[2 * i] = x + scale * radius * cos(angle);
        shape[2 * i + 1] = y + scale * radius * sin(angle);
    }
    return (struct sample){shape, SIDES, 2, &closed_path, 1, 0};
}

static void test_words(void)
{
    struct sample sample = flower(1, 0, 0);
    char *text = drawn(&sample);
    ok(xml_is_well_formed(text), "the file is well-formed XML");
    ok(text && strstr(text, "<title>A &quot;sample&quot; &amp; more, shape</title>"), "the title");
    ok(text && strstr(text, "<desc>closed curve of 100 points; x from ") && strstr(text, " to 3, y from "),
       "the description");
    ok(text && strstr(text, "bcifs eval 'a&lt;b' \xef\xbf\xbd -o x</"), "the command line, escaped");
    ok(text && strstr(text, "# &lt;a&gt; &amp; &quot;b&quot; \xc3\xa9&#13;\nautomaton sample\n</"),
       "the automaton");
    ok(attribute(text, "width") == 1000 && strstr(text, "viewBox=\"0 0 1000 "), "the size");
    free(text);
}

/* Coordinates are the data's, through the recorded transform, within half a step of the grid. */
static void test_read_back(const struct sample *sample, double grid, unsigned width, const char *what)
{
    static double numbers[4 * SIDES];
    char verbs[2 * SIDES + 8];
    struct layer layer = sample_layer(sample, BCIFS_CURVE);
    char *text = drawn_layers(&layer, 1, width);
    size_t count = path_numbers(text, "curve", numbers, 4 * SIDES, verbs);
    double u0 = attribute(text, "u0"), v0 = attribute(text, "v0"), error = 0;
    for (size_t i = 0; i + 1 < count; i += 2) {
        double u = sample->points[i], v = sample->points[i + 1];
        double x = attribute(text, "left") + attribute(text, "scale-u") * (u - u0);
        double y = attribute(text, "bottom") - attribute(text, "scale-v") * (v - v0);
        error = fmax(error, fmax(fabs(x - numbers[i]), fabs(y - numbers[i + 1])));
    }
    ok(count == 2 * SIDES && error <= 0.5001 * grid, "%s: coordinates read back, error %g", what, error);
    ok(verbs[0] == 'M' && verbs[1] == 'L' && strchr(verbs, 'Z') - verbs == SIDES, "%s: one closed path",
       what);
    bool inside = true;
    for (size_t i = 0; i + 1 < count; i += 2)
        inside = inside && numbers[i] >= 0 && numbers[i] <= width && numbers[i + 1] >= 0 &&
                 numbers[i + 1] <= attribute(text, "height");
    ok(inside, "%s: inside the picture", what);
    free(text);
}

static void test_invariance(void)
{
    static const struct {
        double scale, x, y;
    } moves[] = {{1024, 0, 0},  {1, 1e6, -1e6}, {1, 1e9, 1e9},  {1e-9, 0, 0}, {1e-9, 1e-8, 0},
                 {3e300, 0, 0}, {0.7, 5, -3},   {1e-280, 0, 0}, {5e307, 0, 0}};
    static double first[2 * SIDES], moved[2 * SIDES];
    char verbs[2 * SIDES + 8];
    struct sample sample = flower(1, 0, 0);
    char *text = drawn(&sample);
    size_t count = path_numbers(text, "curve", first, 2 * SIDES, verbs);
    double height = attribute(text, "height");
    free(text);
    ok(count == 2 * SIDES, "all points are drawn");
    for (size_t i = 0; i < sizeof moves / sizeof moves[0]; i++) {
        sample = flower(moves[i].scale, moves[i].x, moves[i].y);
        text = drawn(&sample);
        double difference = path_numbers(text, "curve", moved, 2 * SIDES, verbs) == count ? 0 : INFINITY;
        for (size_t k = 0; k < count; k++)
            difference = fmax(difference, fabs(first[k] - moved[k]));
        ok(xml_is_well_formed(text) && difference < 0.011 && attribute(text, "height") == height,
           "scale %g, translation (%g, %g) change nothing: %g", moves[i].scale, moves[i].x, moves[i].y,
           difference);
        free(text);
    }
}

static void test_up(void)
{
    static const double ell[] = {0, 0, 1, 0, 1, 2};
    static const bcifs_path path = {0, 3, 0};
    double numbers[10];
    char verbs[20];
    struct sample sample = {ell, 3, 2, &path, 1, 0};
    char *text = drawn(&sample);
    path_numbers(text, "curve", numbers, 10, verbs);
    ok(numbers[2] > numbers[0] && numbers[3] == numbers[1] && numbers[5] < numbers[3] &&
           strcmp(verbs, "MLL") == 0,
       "up in the data is up in the picture; an open path stays open");
    free(text);
}

/* Data that leave the scale open must give a picture all the same. */
static void test_degenerate(void)
{
    static const double spots[][6] = {{5, 1, 5, 1, 5, 1},
                                      {1, 5, 2, 5, 4, 5},
                                      {5, 1, 5, 2, 5, 4},
                                      {0, 0, 0, 0, 0, 0},
                                      {1, 1, 1 + 2e-16, 1, 1, 1 - 1e-16},
                                      {1e-320, 0, 0, 1e-320, 0, 0}};
    static const bcifs_path path = {0, 3, 0}, none = {0, 0, 0};
    for (size_t i = 0; i < sizeof spots / sizeof spots[0]; i++) {
        double numbers[20];
        char verbs[20];
        for (unsigned dimension = 1; dimension <= 3; dimension++) {
            struct sample sample = {spots[i], dimension == 3 ? 2 : 3, dimension, &path, 1, 0};
            bcifs_path shorter = {0, sample.count, 0};
            sample.paths = &shorter;
            char *text = drawn(&sample);
            size_t count = path_numbers(text, "curve", numbers, 20, verbs);
            bool sane = count >= 2 && attribute(text, "height") >= 100 && attribute(text, "height") <= 2000;
            for (size_t k = 0; k < count; k++)
                sane = sane && numbers[k] >= 0 && numbers[k] <= 2000;
            ok(sane && xml_is_well_formed(text), "degenerate data %zu in %u dimensions", i, dimension);
            free(text);
        }
    }
    char *text = drawn(&(struct sample){spots[0], 0, 2, &none, 1, 0});
    ok(xml_is_well_formed(text), "no points at all");
    free(text);
}

static void test_dropped(void)
{
    static double points[2 * 30001];
    static double numbers[2 * 30001];
    static char verbs[30010];
    for (int i = 0; i <= 30000; i++)
        points[2 * i] = i, points[2 * i + 1] = 0.5 * i;
    bcifs_path path = {0, 30001, 0};
    struct sample sample = {points, 30001, 2, &path, 1, 0};
    struct layer layer = sample_layer(&sample, BCIFS_CURVE);
    char *text = drawn_layers(&layer, 1, 200);
    size_t count = path_numbers(text, "curve", numbers, 2 * 30001, verbs);
    bool distinct = true;
    for (size_t i = 2; i + 1 < count; i += 2)
        distinct = distinct && (numbers[i] != numbers[i - 2] || numbers[i + 1] != numbers[i - 1]);
    ok(distinct && count > 20000 && count < 50000, "points on the same spot are dropped: %zu left",
       count / 2);
    free(text);
}

/* ---- Other kinds --------------------------------------------------------------------------------------- */

static void test_graph(void)
{
    static const double values[] = {0, 3, 1, 2};
    static const bcifs_path path = {0, 4, 1};
    double numbers[20];
    char verbs[20];
    char *text = drawn(&(struct sample){values, 4, 1, &path, 1, 0});
    size_t count = path_numbers(text, "curve", numbers, 20, verbs);
    ok(count == 10 && strcmp(verbs, "MLLLL") == 0 && numbers[9] == numbers[1],
       "the graph of a closed curve comes back to its first value");
    ok(fabs(numbers[2] - numbers[0] - 230) < 0.02 && fabs(numbers[8] - numbers[6] - 230) < 0.02,
       "parameters are equally spaced");
    ok(numbers[3] < numbers[7] && numbers[7] < numbers[5] && numbers[5] < numbers[1], "values go up");
    free(text);
}

static void test_axonometry(void)
{
    /* Unit steps along x, y and z from the origin; isometry sees them equally long, 120 degrees apart. */
    static const double axes[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const bcifs_path path = {0, 4, 0};
    double n[20];
    char verbs[20];
    char *text = drawn(&(struct sample){axes, 4, 3, &path, 1, 0});
    ok(path_numbers(text, "curve", n, 20, verbs) == 8, "a space curve is drawn");
    double x = hypot(n[2] - n[0], n[3] - n[1]), y = hypot(n[4] - n[0], n[5] - n[1]),
           z = hypot(n[6] - n[0], n[7] - n[1]);
    ok(fabs(x - y) < 0.05 && fabs(x - z) < 0.05, "the axes are equally long: %g %g %g", x, y, z);
    ok(fabs(n[6] - n[0]) < 0.02 && n[7] < n[1] && n[2] > n[0] && n[4] > n[0] && n[5] < n[3],
       "z is up, x comes forward to the right, y goes back");
    free(text);
    double four[4] = {0};
    ok(sample_write_one(&(struct sample){four, 1, 4, NULL, 0, 0}, "a.svg", &failure) == BCIFS_INPUT &&
           strstr(failure.message, ".csv") && strstr(failure.message, ".npy"),
       "four coordinates: %s", failure.message);
}

static void test_loose(void)
{
    enum { POINTS = 300000 };
    double *points = malloc(2 * POINTS * sizeof *points);
    uint64_t state = 3;
    for (size_t i = 0; i < 2 * POINTS; i++)
        points[i] = (double)(random_bits(&state) % 64);
    char *text = drawn(&(struct sample){points, POINTS, 2, NULL, 0, 0});
    double *numbers = malloc(3 * POINTS * sizeof *numbers);
    char *verbs = malloc(3 * POINTS);
    size_t count = path_numbers(text, "curve", numbers, 3 * POINTS, verbs);
    ok(count == 3 * 64 * 64, "points on the same spot are drawn once: %zu", count / 3);
    bool dots = true;
    for (size_t i = 0; i < count / 3; i++)
        dots = dots && verbs[2 * i] == 'M' && verbs[2 * i + 1] == 'h' && numbers[3 * i + 2] == 0;
    ok(dots && strstr(text, "stroke-linecap=\"round\""), "as strokes without length");
    ok(xml_is_well_formed(text), "well-formed");
    free(text);
    free(points);
    free(numbers);
    free(verbs);
}

static void test_polygons(void)
{
    /* The second triangle runs the other way; they overlap. */
    static const double triangles[] = {0, 0, 4, 0, 0, 4, 1, 1, 1, 5, 5, 1};
    double n[20];
    char verbs[20];
    char *text = drawn(&(struct sample){triangles, 6, 2, NULL, 0, 3});
    ok(path_numbers(text, "curve", n, 20, verbs) == 12 && strcmp(verbs, "MLLZMLLZ") == 0,
       "polygons are closed");
    double turn[2];
    for (int i = 0; i < 2; i++) {
        const double *p = n + 6 * i;
        turn[i] = (p[2] - p[0]) * (p[5] - p[1]) - (p[4] - p[0]) * (p[3] - p[1]);
    }
    ok(turn[0] * turn[1] > 0, "and turn the same way");
    ok(text && strstr(text, "fill-opacity"), "and filled");
    free(text);
}

static void test_layers(void)
{
    struct sample sample = flower(1, 0, 0);
    struct sample coarse = {shape, 5, 2, &(bcifs_path){0, 5, 1}, 1, 0};
    struct sample middle = {shape, 20, 2, &(bcifs_path){0, 20, 1}, 1, 0};
    struct layer layers[] = {sample_layer(&sample, BCIFS_CURVE), sample_layer(&middle, BCIFS_LEVEL),
                             sample_layer(&coarse, BCIFS_POLYGON), sample_layer(&coarse, BCIFS_LEVEL)};
    char *text = drawn_layers(layers, 4, 1000);
    ok(xml_is_well_formed(text), "layers: well-formed");
    const char *polygon = text ? strstr(text, "class=\"polygon\"") : NULL;
    const char *points = polygon ? strstr(polygon, "class=\"points\"") : NULL;
    const char *first = points ? strstr(points, "class=\"level\"") : NULL;
    const char *second = first ? strstr(first + 1, "class=\"level\"") : NULL;
    const char *curve = second ? strstr(second, "class=\"curve\"") : NULL;
    ok(curve && !strstr(curve, "class=\"level\""), "layers: polygon, its points, levels, curve");
    ok(second && curve - second > second - first, "layers: the finer level above the coarser");
    ok(first && strncmp(strstr(first, "stroke="), strstr(second, "stroke="), 16) != 0,
       "layers: levels differ in color");
    free(text);
}

static void test_width(void)
{
    struct sample sample = flower(1, 0, 0);
    struct layer layer = sample_layer(&sample, BCIFS_CURVE);
    ok(sample_write(&layer, 1, "a.svg", 15, &failure) == BCIFS_INPUT && strstr(failure.message, "15"), "%s",
       failure.message);
    ok(sample_write(&layer, 1, "a.svg", 16385, &failure) == BCIFS_INPUT && sample_directory_count() == 0,
       "%s", failure.message);
}

int main(void)
{
    char directory[64];
    sample_directory_enter(directory);
    test_words();
    struct sample sample = flower(1, 0, 0);
    test_read_back(&sample, 0.01, 1000, "as it is");
    sample = flower(1e-7, 1000, -2000);
    test_read_back(&sample, 0.01, 2000, "small and far off");
    sample = flower(1e300, 0, 1e300);
    test_read_back(&sample, 0.1, 16384, "huge");
    sample.paths = &open_path;
    test_invariance();
    test_up();
    test_degenerate();
    test_dropped();
    test_graph();
    test_axonometry();
    test_loose();
    test_polygons();
    test_layers();
    test_width();
    sample_directory_remove(directory);
    return done_testing();
}
