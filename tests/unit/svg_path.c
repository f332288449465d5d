/* Outlines from SVG: random paths whose points are known are written in every form that SVG allows; transforms are held
 * against matrices written out; what is wrong is refused where it stands. */
#include <math.h>
#include <string.h>

#include "language/svg_document.h"
#include "tap.h"

static bcifs_error error;

/* Reads a text; the outline's points are to be freed. */
static bcifs_status read_text(const char *text, struct bcifs_curve *outline)
{
    struct arena arena = {0};
    struct report report = report_new(NULL);
    struct source *source;
    *outline = (struct bcifs_curve){0};
    bcifs_status status = source_from_text(&arena, "x.svg", text, strlen(text), &report, &source);
    if (status == BCIFS_OK)
        status = svg_document_read(source, &report, outline);
    if (status)
        report_close(&report, &error);
    arena_free(&arena);
    return status;
}

static bool has_points(const char *text, bool closed, bool cubic, const double *points, size_t count,
                       double tolerance)
{
    struct bcifs_curve outline;
    bool good = read_text(text, &outline) == BCIFS_OK && outline.count == count && outline.closed == closed &&
                outline.cubic == cubic && outline.dimension == 2;
    for (size_t i = 0; i < 2 * count && good; i++)
        good = fabs(outline.points[i] - points[i]) <= tolerance;
    if (!good) {
        note("%s: %zu points, %s", text, outline.count, outline.closed ? "closed" : "open");
        for (size_t i = 0; i < outline.count && i < 20; i++)
            note("(%.17g, %.17g)", outline.points[2 * i], outline.points[2 * i + 1]);
    }
    memory_free(outline.points);
    return good;
}

/* ---- Forms --------------------------------------------------------------------------------------------- */

static void test_forms(void)
{
    ok(has_points("<svg><path d='M1 2L3 4'/></svg>", false, false, (double[]){1, -2, 3, -4}, 2, 0),
       "a line; y points up");
    ok(has_points("<svg><path d='m1-2.5.5 3z'/></svg>", true, false, (double[]){1, 2.5, 1.5, -0.5}, 2, 0),
       "packed numbers, relative, closed by its last line");
    ok(has_points("<path d='M1e1,2E0 , 3e-1 .4e+1H-.5v1.'/>", false, false,
                  (double[]){10, -2, 0.3, -4, -0.5, -4, -0.5, -5}, 4, 0),
       "exponents, commas, H and v");
    ok(has_points("<path d='M0 0L1 0 1 1 0 0Z'/>", true, false, (double[]){0, 0, 1, 0, 1, -1}, 3, 0),
       "a last point on the first is not repeated");
    ok(has_points("<path d='M0 0l.1 0 .1 0 .1.1-.3-.1z'/>", true, false,
                  (double[]){0, 0, 0.1, 0, 0.2, 0, 0.3, -0.1}, 4, 1e-15),
       "nor one that rounding keeps from it");
    ok(has_points("<path d='M0 0L3 3C4 4 5 5 6 0'/>", false, true,
                  (double[]){0, 0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6, 0}, 7, 0),
       "a line before a cubic has inner points at the thirds");
    ok(has_points("<path d='M0 0C0 1 1 2 2 2S4 3 5 0s1 1 2 2'/>", false, true,
                  (double[]){0, 0, 0, -1, 1, -2, 2, -2, 3, -2, 4, -3, 5, 0, 6, 3, 6, -1, 7, -2}, 10, 0),
       "S reflects the control point before it");
    ok(has_points("<path d='M0 0L3 0S4 3 6 0'/>", false, true,
                  (double[]){0, 0, 1, 0, 2, 0, 3, 0, 3, 0, 4, -3, 6, 0}, 7, 0),
       "and begins at the point itself after a line");
    ok(has_points("<path d='M0 0C0 3 3 3 3 0z'/>", true, true,
                  (double[]){0, 0, 0, -3, 3, -3, 3, 0, 2, 0, 1, 0}, 6, 0),
       "the line that closes a cubic path is a cubic");
}

/* ---- Documents ----------------------------------------------------------------------------------------- */

static void test_documents(void)
{
    static const double line[] = {0, 0, 1, -1};
    static const char *const texts[] = {
        "<?xml version=\"1.0\"?><!DOCTYPE svg [<!ENTITY a \"b>]\"> <!-- ]> ' -->]>\n<svg><path d='M0 0L1 1'/></svg>",
        "<svg><!-- <path d='M9 9L8 8'/> --><path d='M0 0L1 1'/></svg>",
        "<svg><![CDATA[<path d='M9 9L8 8'/>]]><path d='M0 0L1 1'/></svg>",
        "<svg><pathological d='M9 9L8 8'/><path id=\"d\" data-d='x' dd=\"M7 7\" d = \"M0 0L1 1\" /></svg>",
        "<svg title='a > b / c'><g\nid='g'><path\n\td='M0\n0\tL1,1'></path></g></svg>",
        ("<svg><defs><marker><path d='M9 9L8 8'/></marker></defs><clipPath><path d='M5 5z'/></clipPath>"
         "<path d='M0 0L1 1'/></svg>"),
        "<svg:svg><svg:path d='M0 0L1 1'/></svg:svg>",
        "<svg><g transform='rotate(9)'/><rect style='transform:none' transform='?'/><path d='M0 0L1 1'/></svg>",
        "<svg><path d='M0 0L1 1'/><path d='M0 0A",
        "\xEF\xBB\xBF<svg><path d='M0 0L1 1'/></svg>",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        ok(has_points(texts[i], false, false, line, 2, 0), "document %zu", i);
}

/* Images of (2, 1) and (0, 0) under matrices that are written out. */
static void test_transforms(void)
{
    static const struct {
        const char *text;
        double points[4]; /* in SVG's coordinates */
    } cases[] = {
        {"matrix(1 2 3 4 5 6)", {1 * 2 + 3 * 1 + 5, 2 * 2 + 4 * 1 + 6, 5, 6}},
        {"translate(7)", {9, 1, 7, 0}},
        {"translate(7,-3)", {9, -2, 7, -3}},
        {"scale(2)", {4, 2, 0, 0}},
        {"scale(2 -3)", {4, -3, 0, 0}},
        {"rotate(90)", {-1, 2, 0, 0}},
        {"rotate(-450)", {1, -2, 0, 0}},
        {"rotate(180 1 1)", {0, 1, 2, 2}},
        {"skewX(45)", {3, 1, 0, 0}},
        {"skewY(45)", {2, 3, 0, 0}},
        {"translate(1,2) scale(3)", {7, 5, 1, 2}},
        {"scale(3),translate(1,2)", {9, 9, 3, 6}},
        {"none", {2, 1, 0, 0}},
        {"", {2, 1, 0, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        const double *p = cases[i].points;
        snprintf(text, sizeof text, "<svg><path transform='%s' d='M2 1L0 0'/></svg>", cases[i].text);
        ok(has_points(text, false, false, (double[]){p[0], -p[1], p[2], -p[3]}, 2, 1e-14), "%s", cases[i].text);
    }
    ok(has_points("<svg transform='translate(1,2)'><g transform='scale(3)'><g/><path transform='rotate(90)' "
                  "d='M2 1L0 0'/></g></svg>",
                  false, false, (double[]){-2, -8, 1, -2}, 2, 0),
       "transforms around the path come first");
}

/* ---- Random paths -------------------------------------------------------------------------------------- */

enum { MOST = 12 };

struct writer {
    char text[8192];
    size_t length;
    uint64_t seed;
    double at[2];
    char before; /* the command letter that is in force */
};

static uint64_t choose(struct writer *writer, uint64_t count)
{
    return random_bits(&writer->seed) % count;
}

static void put(struct writer *writer, const char *text)
{
    writer->length += (size_t)snprintf(writer->text + writer->length, sizeof writer->text - writer->length, "%s",
                                       text);
}

/* Multiples of 1/8, which sums do not round, in one of several notations. */
static void put_number(struct writer *writer, double number)
{
    static const char *const separators[] = {" ", ",", "\n ", " , ", "\t,"};
    char last = writer->text[writer->length - 1], digits[64];
    snprintf(digits, sizeof digits, choose(writer, 3) ? "%.3f" : "%.9e", number);
    const char *text = digits;
    if (number >= 0 && number < 1 && digits[1] == '.' && !strchr(digits, 'e') && choose(writer, 2))
        text++; /* .5 */
    bool letter = strchr("MmLlHhVvCcSs", last) != NULL;
    if (letter ? choose(writer, 2) : *text != '-' || choose(writer, 2))
        put(writer, letter ? " " : separators[choose(writer, 5)]);
    put(writer, text);
}

static void put_command(struct writer *writer, char name)
{
    char letter[] = {' ', name, '\0'};
    /* More sets of arguments may follow without the letter; after M they are those of L. */
    char implied = writer->before == 'M' ? 'L' : writer->before == 'm' ? 'l' : writer->before;
    if (implied != name || choose(writer, 2))
        put(writer, letter + choose(writer, 2));
    writer->before = writer->text[writer->length - 1] == name ? name : writer->before;
}

/* A command to `points`, count of them, absolute or relative. */
static void put_points(struct writer *writer, char name, const double *points, int count)
{
    bool relative = choose(writer, 2);
    put_command(writer, relative ? (char)(name + 'a' - 'A') : name);
    for (int i = 0; i < 2 * count; i++)
        put_number(writer, points[i] - (relative ? writer->at[i % 2] : 0));
    memcpy(writer->at, points + 2 * (count - 1), sizeof writer->at);
}

static double random_number(struct writer *writer)
{
    return ((double)choose(writer, 801) - 400) / 8;
}

/* One random path and the points that it must have. */
static bool random_path_holds(uint64_t seed)
{
    struct writer writer = {.text = "<svg><path d='", .length = 14, .seed = seed};
    double points[2 * (3 * MOST + 4)], handle[2] = {0, 0};
    size_t count = 1, pieces = 1 + choose(&writer, MOST);
    points[0] = random_number(&writer);
    points[1] = random_number(&writer);
    put(&writer, choose(&writer, 2) ? "M" : "m");
    writer.before = writer.text[writer.length - 1];
    put_number(&writer, points[0]);
    put_number(&writer, points[1]);
    memcpy(writer.at, points, sizeof writer.at);
    memcpy(handle, points, sizeof handle);
    for (size_t i = 0; i < pieces; i++, count += 3) {
        double *next = points + 2 * count;
        const double *from = next - 2;
        bool cubic = i == 0 || choose(&writer, 2), smooth = cubic && choose(&writer, 3) == 0;
        for (int k = 0; k < 6; k++)
            next[k] = random_number(&writer);
        if (smooth)
            next[0] = 2 * from[0] - handle[0], next[1] = 2 * from[1] - handle[1];
        int straight = cubic ? 0 : (int)choose(&writer, 3); /* 1: horizontal, 2: vertical */
        for (int k = 0; k < 2 && !cubic; k++) {
            next[4 + k] = straight == 1 + !k ? from[k] : next[4 + k];
            next[k] = from[k] + (next[4 + k] - from[k]) / 3;
            next[2 + k] = next[4 + k] - (next[4 + k] - from[k]) / 3;
        }
        if (straight) {
            int k = straight - 1;
            bool relative = choose(&writer, 2);
            put_command(&writer, "HhVv"[2 * k + relative]);
            put_number(&writer, next[4 + k] - (relative ? from[k] : 0));
            writer.at[k] = next[4 + k];
        } else {
            put_points(&writer, !cubic ? 'L' : smooth ? 'S' : 'C', !cubic ? next + 4 : smooth ? next + 2 : next,
                       !cubic ? 1 : smooth ? 2 : 3);
        }
        memcpy(handle, cubic ? next + 2 : next + 4, sizeof handle);
    }
    bool closed = choose(&writer, 2), meets = points[2 * count - 2] == points[0] && points[2 * count - 1] == points[1];
    put(&writer, closed ? " Z '/></svg>" : "'/></svg>");
    for (int k = 0; k < 2 && closed && !meets; k++) {
        double from = points[2 * count - 2 + (size_t)k];
        points[2 * count + (size_t)k] = from + (points[k] - from) / 3;
        points[2 * count + 2 + (size_t)k] = points[k] - (points[k] - from) / 3;
    }
    count = closed ? meets ? count - 1 : count + 2 : count;
    for (size_t i = 0; i < count; i++)
        points[2 * i + 1] *= -1;
    bool good = has_points(writer.text, closed, true, points, count, 1e-13);
    if (!good)
        note("seed %llu", (unsigned long long)seed);
    return good;
}

static void test_random(void)
{
    bool good = true;
    long count = test_effort(3000);
    for (long i = 0; i < count && good; i++)
        good = random_path_holds((uint64_t)i + 1);
    ok(good, "random paths have their points however they are written");
}

/* ---- Errors -------------------------------------------------------------------------------------------- */

static void test_errors(void)
{
    static const struct {
        const char *text, *message;
        unsigned column; /* of line 1 */
    } cases[] = {
        {"<path d='M0 0A1 1 0 0 0 2 2'/>", "elliptical arcs (command A)", 14},
        {"<path d='M0 0q1 1 2 2'/>", "quadratic curves (command q)", 14},
        {"<path d='M0 0T1 1'/>", "quadratic curves (command T)", 14},
        {"<path d='L0 0'/>", "the command M", 10},
        {"<path d='M0 0X'/>", "a path command, found 'X'", 14},
        {"<path d='M0 0L1 NaN'/>", "expected a number, found 'NaN'", 17},
        {"<path d='M0 0L1 inf'/>", "expected a number", 17},
        {"<path d='M0 0L1'/>", "found the end of the value", 16},
        {"<path d='M0 0,,1 1'/>", "expected a number, found ',1'", 15},
        {"<path d='M0 0L,1 1'/>", "expected a number", 15},
        {"<path d='M0 0L1 1,'/>", "expected a number", 19},
        {"<path d='M0 0L1 0x10'/>", "a path command, found 'x10'", 18},
        {"<path d='M0 0L1 -e5'/>", "expected a number", 17},
        {"<path d='M0 0L1e999 1'/>", "'1e999' is too large", 15},
        {"<path d='M0 0L1e308 0l1e308 0'/>", "become too large", 23},
        {"<path d='M0 0L1 1M2 2'/>", "second outline", 18},
        {"<path d='M0 0L1 1zL2 2'/>", "second outline", 19},
        {"<path d='M0 0z'/>", "nothing but its first point", 10},
        {"<path d=''/>", "the path is empty", 10},
        {"<path/>", "no attribute d", 2},
        {"<path d='M0 0", "'d' is not closed", 9},
        {"<path d='M0 0<g>'/>", "'d' is not closed", 9},
        {"<path d='M0 0L1 1'", "<path> is not closed", 2},
        {"<path d=M0/>", "'d' must be in quotes", 9},
        {"<path d/>", "expected an attribute", 7},
        {"<svg><g></svg>", "</svg> closes nothing: <g> is open", 11},
        {"</svg>", "no element is open", 3},
        {"<svg><g>", "<g> is not closed", 7},
        {"<svg><!-- ", "the comment is not closed", 6},
        {"<svg><![CDATA[ ", "CDATA is not closed", 6},
        {"<!DOCTYPE svg [ '>", "the declaration is not closed", 1},
        {"<svg><circle r='1'/></svg>", "convert this <circle>", 7},
        {"<svg><defs><path d='M0 0L1 1'/></defs></svg>", "not drawn here", 13},
        {"<html></html>", "no <path> in this <html>", 2},
        {"<>", "the name of an element", 2},
        {"words", "no elements", 1},
        {"", "no elements", 1},
        {"<path transform='foo(1)' d='M0 0L1 1'/>", "expected matrix, translate", 18},
        {"<path transform='matrix(1 2)' d='M0 0L1 1'/>", "too few numbers: 2", 18},
        {"<path transform='rotate(1 2)' d='M0 0L1 1'/>", "too few numbers: 2", 18},
        {"<path transform='scale(1 2 3)' d='M0 0L1 1'/>", "expected ')'", 28},
        {"<path style='transform: rotate(3deg)' d='M0 0L1 1'/>", "in a style", 14},
        {"<path d='M0 0L&#10;1 1'/>", "expected a number, found '&#10;1'", 15},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct bcifs_curve outline;
        bcifs_status status = read_text(cases[i].text, &outline);
        bool good = status == BCIFS_INPUT && strstr(error.message, cases[i].message) && error.line == 1 &&
                    error.column == cases[i].column;
        ok(good, "%s", cases[i].text);
        if (!good)
            note("status %d, %u:%u: %s", (int)status, error.line, error.column, error.message);
        memory_free(outline.points);
    }
    char deep[4096] = "";
    for (int i = 0; i < 300; i++)
        strcat(deep, "<g>");
    struct bcifs_curve outline;
    ok(read_text(deep, &outline) == BCIFS_INPUT && strstr(error.message, "256"), "too many elements: %s", error.message);
    memory_free(outline.points);
}

/* Every text cut short is refused or read, and nothing else happens. */
static void test_cuts(void)
{
    static const char text[] = "<?xml?><!DOCTYPE a [<!-- b -->]><svg><g transform='rotate(3) scale(2,3)'><![CDATA[x]]>"
                               "<path id=\"p\" d='M1 2c.5.5-1-1 2,2S1 1 2 2H3v4L1e1 2z'/></g></svg>";
    bool good = true;
    for (size_t length = 0; length < sizeof text && good; length++) {
        char cut[sizeof text];
        memcpy(cut, text, length);
        cut[length] = '\0';
        struct bcifs_curve outline;
        bcifs_status status = read_text(cut, &outline);
        good = status == BCIFS_OK || (status == BCIFS_INPUT && error.message[0]);
        memory_free(outline.points);
    }
    ok(good, "a text that ends early is refused with a message");
}

/* ---- Lengths ------------------------------------------------------------------------------------------- */

static void test_lengths(void)
{
    struct bcifs_curve outline;
    /* A cubic that is a parabola, y = x² for x in 0..1 (y up): length √5/2 + asinh(2)/4. */
    bool good = read_text("<path d='M0 0C.33333333333333331 0 .66666666666666663-.33333333333333331 1-1'/>", &outline) ==
                BCIFS_OK;
    struct outline_piece piece = outline_piece(&outline, 0);
    double length = outline_piece_length(&piece, 0, 1), expected = sqrt(5) / 2 + asinh(2) / 4;
    ok(good && fabs(length - expected) < 1e-14, "the length of a parabola, error %g", length - expected);
    enum { COUNT = 50 };
    double points[2 * COUNT], worst = 0;
    good = bcifs_curve_sample(&outline, COUNT, points, &error) == BCIFS_OK;
    for (int i = 0; i < COUNT && good; i++) {
        double x = points[2 * i], s = (x * sqrt(1 + 4 * x * x) + asinh(2 * x) / 2) / 2;
        worst = fmax(worst, fmax(fabs(s - expected * i / (COUNT - 1)), fabs(points[2 * i + 1] - x * x)));
    }
    ok(good && worst < 1e-12, "points at equal lengths along it, error %g", worst);
    memory_free(outline.points);
    good = read_text("<path d='M0 0H4V-3H0z'/>", &outline) == BCIFS_OK &&
           bcifs_curve_sample(&outline, 7, points, &error) == BCIFS_OK;
    static const double around[] = {0, 0, 2, 0, 4, 0, 4, 2, 3, 3, 1, 3, 0, 2};
    for (int i = 0; i < 14 && good; i++)
        good = fabs(points[i] - around[i]) < 1e-13;
    ok(good, "points around a rectangle");
    ok(bcifs_curve_sample(&outline, 1, points, &error) == BCIFS_INPUT, "one point is too few");
    memory_free(outline.points);
    good = read_text("<path d='M1 1L1 1'/>", &outline) == BCIFS_OK;
    ok(good && bcifs_curve_sample(&outline, 2, points, &error) == BCIFS_INPUT, "no length: %s", error.message);
    memory_free(outline.points);
}

int main(void)
{
    test_forms();
    test_documents();
    test_transforms();
    test_random();
    test_errors();
    test_cuts();
    test_lengths();
    return done_testing();
}
