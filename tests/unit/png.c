/* Pixel pictures, decoded by an inflate written from RFC 1951 for this test alone, and the compressor. */
#include <math.h>

#include "output/deflate.h"
#include "output/raster.h"
#include "sample.h"
#include "tap.h"

static bcifs_error failure;

/* ---- Inflate ------------------------------------------------------------------------------------------- */

struct inflate {
    const unsigned char *bytes;
    size_t length, bit; /* next bit to read */
    unsigned char *out;
    size_t used, capacity;
    bool bad;
};

struct table {
    int counts[16];
    int symbols[288];
};

static unsigned bits_get(struct inflate *in, unsigned count)
{
    unsigned value = 0;
    for (unsigned i = 0; i < count; i++, in->bit++) {
        if (in->bit / 8 >= in->length) {
            in->bad = true;
            return 0;
        }
        value |= (unsigned)(in->bytes[in->bit / 8] >> in->bit % 8 & 1) << i;
    }
    return value;
}

/* False when the lengths are not those of a complete code (one lone code of length 1 is allowed). */
static bool table_make(struct table *table, const unsigned char *lengths, int size)
{
    int offsets[16] = {0}, left = 1, codes = 0;
    memset(table->counts, 0, sizeof table->counts);
    for (int i = 0; i < size; i++)
        table->counts[lengths[i]]++;
    codes = size - table->counts[0];
    table->counts[0] = 0;
    for (int i = 1; i < 16; i++) {
        left = 2 * left - table->counts[i];
        offsets[i] = offsets[i - 1] + table->counts[i - 1];
        if (left < 0)
            return false;
    }
    for (int i = 0; i < size; i++)
        if (lengths[i])
            table->symbols[offsets[lengths[i]]++] = i;
    return left == 0 || codes == 1;
}

static int symbol_get(struct inflate *in, const struct table *table)
{
    int code = 0, first = 0, index = 0;
    for (int length = 1; length < 16; length++) {
        code |= (int)bits_get(in, 1);
        int count = table->counts[length];
        if (code - count < first)
            return table->symbols[index + code - first];
        index += count;
        first = (first + count) << 1;
        code <<= 1;
    }
    in->bad = true;
    return 256;
}

static void byte_out(struct inflate *in, unsigned char byte)
{
    if (in->used == in->capacity)
        in->out = realloc(in->out, in->capacity = 2 * in->capacity + 4096);
    in->out[in->used++] = byte;
}

static void symbols_inflate(struct inflate *in, const struct table *literals, const struct table *distances)
{
    static const unsigned short length_base[] = {3,  4,  5,  6,   7,   8,   9,   10,  11, 13,
                                                 15, 17, 19, 23,  27,  31,  35,  43,  51, 59,
                                                 67, 83, 99, 115, 131, 163, 195, 227, 258};
    static const unsigned char length_bits[] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                                2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
    static const unsigned short distance_base[] = {
        1,   2,   3,   4,   5,   7,    9,    13,   17,   25,   33,   49,   65,    97,    129,
        193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
    while (!in->bad) {
        int symbol = symbol_get(in, literals);
        if (symbol == 256)
            return;
        if (symbol < 256) {
            byte_out(in, (unsigned char)symbol);
            continue;
        }
        if (symbol > 285)
            break;
        size_t length = length_base[symbol - 257] + bits_get(in, length_bits[symbol - 257]);
        int code = symbol_get(in, distances);
        if (code > 29)
            break;
        size_t distance = distance_base[code] + bits_get(in, code < 4 ? 0 : (unsigned)code / 2 - 1);
        if (distance > in->used)
            break;
        for (; length > 0; length--)
            byte_out(in, in->out[in->used - distance]);
    }
    in->bad = true;
}

static void dynamic_inflate(struct inflate *in)
{
    static const unsigned char order[] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    unsigned char lengths[320] = {0};
    struct table codes, literals, distances;
    int literal_count = (int)bits_get(in, 5) + 257, distance_count = (int)bits_get(in, 5) + 1;
    int sent = (int)bits_get(in, 4) + 4, count = 0;
    for (int i = 0; i < sent; i++)
        lengths[order[i]] = (unsigned char)bits_get(in, 3);
    in->bad = in->bad || !table_make(&codes, lengths, 19) || literal_count > 286 || distance_count > 30;
    while (!in->bad && count < literal_count + distance_count) {
        int symbol = symbol_get(in, &codes), run = 1;
        unsigned char value = (unsigned char)symbol;
        if (symbol == 16 && count > 0) {
            value = lengths[count - 1];
            run = 3 + (int)bits_get(in, 2);
        } else if (symbol >= 16) {
            value = 0;
            run = symbol == 17 ? 3 + (int)bits_get(in, 3) : 11 + (int)bits_get(in, 7);
            in->bad = in->bad || symbol == 16;
        }
        in->bad = in->bad || count + run > literal_count + distance_count;
        for (; run > 0 && !in->bad; run--)
            lengths[count++] = value;
    }
    if (in->bad || !table_make(&literals, lengths, literal_count) ||
        !table_make(&distances, lengths + literal_count, distance_count))
        in->bad = true;
    else
        symbols_inflate(in, &literals, &distances);
}

static void fixed_inflate(struct inflate *in)
{
    unsigned char lengths[288], fives[32];
    struct table literals, distances;
    for (int i = 0; i < 288; i++)
        lengths[i] = i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8;
    memset(fives, 5, sizeof fives);
    table_make(&literals, lengths, 288);
    table_make(&distances, fives, 32);
    symbols_inflate(in, &literals, &distances);
}

static void stored_inflate(struct inflate *in)
{
    in->bit = (in->bit + 7) / 8 * 8;
    unsigned length = bits_get(in, 16), check = bits_get(in, 16);
    in->bad = in->bad || (length ^ 0xffff) != check;
    for (; length > 0 && !in->bad; length--)
        byte_out(in, (unsigned char)bits_get(in, 8));
}

/* Unpacks a zlib stream, its checksum included; free the result. NULL when it is not one. */
static unsigned char *inflate(const unsigned char *bytes, size_t length, size_t *unpacked)
{
    struct inflate in = {.bytes = bytes, .length = length, .bit = 16};
    in.bad = length < 6 || (bytes[0] & 15) != 8 || (bytes[0] * 256 + bytes[1]) % 31 != 0 || (bytes[1] & 32);
    for (bool last = false; !last && !in.bad;) {
        last = bits_get(&in, 1);
        unsigned kind = bits_get(&in, 2);
        if (kind == 0)
            stored_inflate(&in);
        else if (kind == 1)
            fixed_inflate(&in);
        else if (kind == 2)
            dynamic_inflate(&in);
        else
            in.bad = true;
    }
    uint32_t a = 1, b = 0, sum = 0;
    for (size_t i = 0; i < in.used; i++) {
        a = (a + in.out[i]) % 65521;
        b = (b + a) % 65521;
    }
    size_t end = (in.bit + 7) / 8;
    for (size_t i = 0; i < 4 && end + 4 == length; i++)
        sum = sum << 8 | bytes[end + i];
    *unpacked = in.used;
    if (in.bad || end + 4 != length || sum != (b << 16 | a)) {
        free(in.out);
        return NULL;
    }
    return in.out ? in.out : calloc(1, 1);
}

/* ---- The compressor ------------------------------------------------------------------------------------ */

struct bytes {
    unsigned char *data;
    size_t length;
};

static void bytes_add(void *context, const unsigned char *data, size_t length)
{
    struct bytes *bytes = context;
    bytes->data = realloc(bytes->data, bytes->length + length + 1);
    memcpy(bytes->data + bytes->length, data, length);
    bytes->length += length;
}

/* Bytes of several characters: noise, few symbols, runs, repeats from far back, geometric frequencies. */
static void bytes_fill(unsigned char *bytes, size_t length, int kind, uint64_t *state)
{
    for (size_t i = 0; i < length; i++) {
        uint64_t bits = random_bits(state);
        switch (kind) {
        case 0:
            bytes[i] = (unsigned char)bits;
            break;
        case 1:
            bytes[i] = (unsigned char)(bits % 3);
            break;
        case 2:
            bytes[i] = (unsigned char)(i > 0 && bits % 1000 ? bytes[i - 1] : bits >> 32);
            break;
        case 3:
            bytes[i] = i >= 32768 && bits % 5000 ? bytes[i - 32768] : (unsigned char)(bits >> 32);
            break;
        case 4: {
            /* As frequent as the two rarer symbols after it together: codes would have over 20 bits. */
            unsigned symbol = 0;
            while (symbol < 255 && random_bits(state) % 1000 < 618)
                symbol++;
            bytes[i] = (unsigned char)symbol;
            break;
        }
        default:
            bytes[i] = 255;
        }
    }
}

static void test_deflate(void)
{
    uint64_t state = 11;
    static const size_t lengths[] = {0, 1, 2, 3, 4, 257, 258, 259, 65535, 65536, 65537, 98304, 300000};
    bool same = true;
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++)
        for (int kind = 0; kind < 6; kind++) {
            size_t length = lengths[i], unpacked;
            unsigned char *bytes = malloc(length + 1);
            struct bytes packed = {0};
            bytes_fill(bytes, length, kind, &state);
            struct deflate *deflate = deflate_new(bytes_add, &packed);
            for (size_t done = 0, piece; done < length; done += piece) {
                piece = random_bits(&state) % 70000 + 1;
                piece = piece < length - done ? piece : length - done;
                deflate_write(deflate, bytes + done, piece);
            }
            deflate_finish(deflate);
            unsigned char *back = inflate(packed.data, packed.length, &unpacked);
            bool good = back && unpacked == length && memcmp(back, bytes, length) == 0;
            if (!good)
                note("kind %d, length %zu: %s", kind, length, back ? "differs" : "no zlib stream");
            if (length == 300000)
                note("kind %d: %zu bytes in %zu", kind, length, packed.length);
            if (kind >= 2 && kind != 4 && length == 300000 && packed.length > 120000)
                good = false;
            same = same && good;
            free(back);
            free(bytes);
            free(packed.data);
        }
    ok(same, "deflate: every kind of bytes unpacks to itself");
    deflate_finish(NULL);
}

/* ---- Pictures ------------------------------------------------------------------------------------------ */

struct image {
    unsigned width, height, channels;
    unsigned char *rows; /* each with its filter byte in front */
    char texts[2000];    /* keyword=about=text of every text chunk, one a line */
    bool good;
};

static uint32_t word_get(const unsigned char *bytes)
{
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

static uint32_t crc_of(const unsigned char *bytes, size_t length)
{
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < length; i++) {
        crc ^= bytes[i];
        for (int k = 0; k < 8; k++)
            crc = crc & 1 ? crc >> 1 ^ 0xedb88320 : crc >> 1;
    }
    return ~crc;
}

static void text_note(struct image *image, const unsigned char *chunk, size_t length)
{
    size_t used = strlen(image->texts), keyword = strlen((const char *)chunk);
    const char *about = (const char *)chunk + keyword + 4, *text = about + strlen(about) + 1;
    snprintf(image->texts + used, sizeof image->texts - used, "%s=%s=%.*s\n", (const char *)chunk, about,
             (int)(length - (size_t)(text - (const char *)chunk)), text);
}

static struct image image_read(const char *path)
{
    struct image image = {0};
    struct bytes packed = {0};
    size_t length = 0, place = 8, unpacked = 0;
    unsigned char *bytes = (unsigned char *)sample_read(path, &length);
    bool good = bytes && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0, ended = false;
    while (good && !ended && place + 12 <= length) {
        size_t size = word_get(bytes + place);
        const unsigned char *chunk = bytes + place + 8;
        good = place + 12 + size <= length && word_get(chunk + size) == crc_of(chunk - 4, size + 4);
        if (good && memcmp(chunk - 4, "IHDR", 4) == 0) {
            image.width = word_get(chunk);
            image.height = word_get(chunk + 4);
            image.channels = chunk[9] == 2 ? 3 : 1;
            good = chunk[8] == 8 && chunk[10] == 0 && chunk[11] == 0 && chunk[12] == 0;
        } else if (good && memcmp(chunk - 4, "IDAT", 4) == 0) {
            bytes_add(&packed, chunk, size);
        } else if (good && memcmp(chunk - 4, "iTXt", 4) == 0) {
            text_note(&image, chunk, size);
        }
        ended = good && memcmp(chunk - 4, "IEND", 4) == 0;
        place += 12 + size;
    }
    image.rows = packed.data ? inflate(packed.data, packed.length, &unpacked) : NULL;
    image.good = good && ended && place == length && image.rows &&
                 unpacked == (size_t)image.height * (1 + image.width * image.channels);
    for (size_t y = 0; image.good && y < image.height; y++)
        image.good = image.rows[y * (1 + image.width * image.channels)] == 0;
    free(packed.data);
    free(bytes);
    return image;
}

static const unsigned char *pixel(const struct image *image, double x, double y)
{
    size_t stride = 1 + image->width * image->channels;
    return image->rows + (size_t)y * stride + 1 + (size_t)x * image->channels;
}

static struct image drawn(const struct layer *layers, size_t count, unsigned width)
{
    if (sample_write(layers, count, "a.png", width, &failure) != BCIFS_OK)
        note("%s", failure.message);
    struct image image = image_read("a.png");
    remove("a.png");
    return image;
}

static void test_line(void)
{
    static const double points[] = {0, 0, 10, 0, 10, 5};
    static const bcifs_path path = {0, 3, 1};
    struct sample sample = {points, 3, 2, &path, 1, 0};
    struct layer layers[] = {sample_layer(&sample, BCIFS_CURVE), sample_layer(&sample, BCIFS_POLYGON)};
    struct image image = drawn(layers, 1, 500);
    ok(image.good && image.width == 500 && image.height == 270 && image.channels == 1,
       "a gray picture: %u x %u", image.width, image.height);
    ok(pixel(&image, 5, 5)[0] == 255 && pixel(&image, 200, 100)[0] == 255, "the paper is white");
    /* The margin is 20 pixels: the base runs along y = 250 from 20 to 480. */
    ok(pixel(&image, 250, 250)[0] < 120 && pixel(&image, 480, 100)[0] < 120, "the sides are dark");
    ok(fmin(pixel(&image, 249, 135)[0], pixel(&image, 250, 134)[0]) < 120, "the third side closes the path");
    /* A line of width 1.3 between two rows of pixels covers 0.65 of each. */
    double cover = 0;
    for (int y = 240; y < 260; y++)
        cover += 255 - pixel(&image, 200, y)[0];
    ok(fabs(cover / (255 - 0x1c) - 1.3) < 0.05, "a hairline of 1.3 pixels: %g", cover / (255 - 0x1c));
    ok(strstr(image.texts, "Title==A \"sample\" & more, shape\n") &&
           strstr(image.texts, "Software==bcifs ") &&
           strstr(image.texts, "Command==bcifs eval 'a<b' \xef\xbf\xbd -o x\n") &&
           strstr(image.texts, "Automaton=dir/sa<mple.bcifs=# <a> & \"b\" \xc3\xa9\nautomaton sample\n"),
       "texts: %s", "title, software, command, automaton");
    free(image.rows);
    image = drawn(layers, 2, 500);
    ok(image.good && image.channels == 3, "a picture with a polygon has colors");
    const unsigned char *marker = pixel(&image, 21.5, 248.5);
    ok(marker[2] > marker[0] && marker[0] < 200, "its points are marked");
    free(image.rows);
}

static void test_density(void)
{
    enum { POINTS = 40000 };
    double *points = malloc(2 * POINTS * sizeof *points);
    uint64_t state = 5;
    for (size_t i = 0; i < POINTS; i++) {
        /* Half of the points on the lower left quarter, as many on the rest, none in the middle. */
        double x = (double)(random_bits(&state) >> 11) * 0x1p-53,
               y = (double)(random_bits(&state) >> 11) * 0x1p-53;
        points[2 * i] = i % 2 ? x * 0.4 : x < 0.5 ? x * 0.8 : x * 0.8 + 0.2;
        points[2 * i + 1] = i % 2 ? y * 0.4 : y < 0.5 ? y * 0.8 : y * 0.8 + 0.2;
    }
    struct sample sample = {points, POINTS, 2, NULL, 0, 0};
    struct layer layer = sample_layer(&sample, BCIFS_CURVE);
    struct image image = drawn(&layer, 1, 100);
    double ink[2] = {0};
    for (int y = 10; y < 35; y++)
        for (int x = 10; x < 35; x++) {
            ink[0] += 255 - pixel(&image, x, 99 - y)[0];
            ink[1] += 255 - pixel(&image, 99 - x, y)[0];
        }
    ok(image.good && ink[0] > 1.1 * ink[1] && ink[1] > 0, "the denser part is darker: %g, %g", ink[0],
       ink[1]);
    ok(pixel(&image, 50, 50)[0] == 255, "where no point is, there is paper");
    free(image.rows);
    free(points);
}

static void test_dots_and_polygons(void)
{
    static const double points[] = {0, 0, 1, 0, 0, 1, 1, 1, 0.2, 0.2, 0.8, 0.2, 0.8, 0.8, 0.2, 0.8};
    struct sample loose = {points, 4, 2, NULL, 0, 0}, frames = {points + 8, 4, 2, NULL, 0, 4};
    struct layer layer = sample_layer(&loose, BCIFS_CURVE);
    struct image image = drawn(&layer, 1, 100);
    ok(image.good && pixel(&image, 4, 4)[0] < 128 && pixel(&image, 95, 95)[0] < 128 &&
           pixel(&image, 50, 50)[0] == 255,
       "few loose points are dots");
    free(image.rows);
    layer = sample_layer(&frames, BCIFS_CURVE);
    image = drawn(&layer, 1, 100);
    unsigned char inside = pixel(&image, 50, 50)[0];
    ok(image.good && inside < 255 && inside > 200, "polygons are filled lightly: %d", inside);
    ok(pixel(&image, 4, 50)[0] < inside && pixel(&image, 1, 50)[0] == 255, "and have an outline");
    free(image.rows);
}

/* The area under the mask is the area of the shape. */
static void test_coverage(void)
{
    struct canvas canvas;
    struct crossing crossings[8];
    uint64_t state = 9;
    bool polygons = true, segments = true;
    ok(canvas_new(&canvas, 60, 50), "a canvas");
    for (long round = 0; round < test_effort(200); round++) {
        double xy[6], area = 0, covered = 0;
        for (int i = 0; i < 6; i++)
            xy[i] = 5 + 40 * (double)(random_bits(&state) >> 11) * 0x1p-53;
        area = fabs((xy[2] - xy[0]) * (xy[5] - xy[1]) - (xy[4] - xy[0]) * (xy[3] - xy[1])) / 2;
        canvas_polygon(&canvas, xy, 3, crossings);
        for (int i = 0; i < 60 * 50; i++)
            covered += canvas.coverage[i] / 255.0;
        polygons = polygons && fabs(covered - area) < 1.5;
        canvas_paint(&canvas, (struct color){0, 0, 0}, 1);
        double length = hypot(xy[2] - xy[0], xy[3] - xy[1]);
        canvas_segment(&canvas, xy[0], xy[1], xy[2], xy[3], 2);
        covered = 0;
        for (int i = 0; i < 60 * 50; i++)
            covered += canvas.coverage[i] / 255.0;
        segments = segments && fabs(covered - (2 * length + acos(-1))) < 0.06 * length + 1;
        canvas_paint(&canvas, (struct color){0, 0, 0}, 1);
    }
    ok(polygons, "polygons cover their area");
    ok(segments, "segments cover length times width");
    /* Whatever lies outside leaves the canvas alone. */
    canvas_segment(&canvas, -1e6, -2e6, 3e6, 1e6, 3);
    canvas_segment(&canvas, 100, 100, 200, 300, 3);
    canvas_polygon(&canvas, (double[]){-50, -50, 500, -50, 500, 500}, 3, crossings);
    canvas_free(&canvas);
}

static void test_size(void)
{
    static const double tall[] = {0, 0, 0, 1, 0, 2}, wide[] = {0, 0, 1, 0, 2, 0};
    static const bcifs_path path = {0, 3, 0};
    struct sample sample = {tall, 3, 2, &path, 1, 0};
    struct layer layer = sample_layer(&sample, BCIFS_CURVE);
    struct image image = drawn(&layer, 1, 64);
    ok(image.good && image.width == 64 && image.height == 128,
       "a tall picture is at most twice as high as wide");
    free(image.rows);
    sample.points = wide;
    image = drawn(&layer, 1, 16);
    ok(image.good && image.width == 16 && image.height == 2, "the smallest picture: %u x %u", image.width,
       image.height);
    free(image.rows);
    ok(sample_write(&layer, 1, "a.png", 20000, &failure) == BCIFS_INPUT && sample_directory_count() == 0,
       "%s", failure.message);
}

int main(void)
{
    char directory[64];
    sample_directory_enter(directory);
    test_deflate();
    test_coverage();
    test_line();
    test_density();
    test_dots_and_polygons();
    test_size();
    sample_directory_remove(directory);
    return done_testing();
}
