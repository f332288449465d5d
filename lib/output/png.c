/* PNG: a pixel picture with the same layers and colors as the vector one. Loose points, when they are many,
 * are drawn by how densely they lie. The automaton's text and the command line go along as text chunks. */
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "output/deflate.h"
#include "output/format.h"
#include "output/png.h"
#include "output/raster.h"
#include "output/unicode.h"

enum {
    DOTS_MOST = 20000, /* loose points that are drawn as disks */
    STEPS = 16         /* points closer than a sixteenth of a pixel are one */
};

/* Lines get wider when the picture is larger than any screen shows it. */
static double pen_scale(const struct picture *picture)
{
    return fmax(1.0, picture->width / 2000.0);
}

/* ---- Drawing ------------------------------------------------------------------------------------------- */

static bool marks_meet(const struct mark *a, const struct mark *b)
{
    return lround(a->x * STEPS) == lround(b->x * STEPS) && lround(a->y * STEPS) == lround(b->y * STEPS);
}

/* Paths, polygons' outlines and, each of its own, markers: to the mask. */
static bcifs_status lines_cover(struct canvas *canvas, const struct picture *picture, size_t layer,
                                double width, bool apart)
{
    struct trace trace;
    struct mark mark, first = {0}, last = {0};
    bcifs_status status = trace_open(&trace, picture, layer);
    if (status != BCIFS_OK)
        return status;
    while (trace_next(&trace, &mark)) {
        if (mark.starts)
            first = mark;
        if (mark.starts || apart)
            last = mark;
        if (mark.starts || apart || mark.ends || !marks_meet(&mark, &last)) {
            canvas_segment(canvas, last.x, last.y, mark.x, mark.y, width);
            last = mark;
        }
        if (mark.closes && !apart)
            canvas_segment(canvas, mark.x, mark.y, first.x, first.y, width);
    }
    return trace_close(&trace);
}

static bcifs_status polygons_cover(struct canvas *canvas, const struct picture *picture, size_t layer)
{
    struct trace trace;
    struct mark mark;
    size_t size = picture->job->layers[layer].points.polygon, count = 0;
    double *xy = memory_new(size, 2 * sizeof *xy);
    struct crossing *crossings = memory_new(size, sizeof *crossings);
    bcifs_status status =
        xy && crossings ? trace_open(&trace, picture, layer) : report_memory(picture->job->report);
    if (status == BCIFS_OK) {
        while (trace_next(&trace, &mark)) {
            xy[2 * count] = mark.x;
            xy[2 * count + 1] = mark.y;
            count++;
            if (mark.ends) {
                canvas_polygon(canvas, xy, count, crossings);
                count = 0;
            }
        }
        status = trace_close(&trace);
    }
    memory_free(xy);
    memory_free(crossings);
    return status;
}

static bcifs_status density_draw(struct canvas *canvas, const struct picture *picture, size_t layer)
{
    struct trace trace;
    struct mark mark;
    struct density density;
    if (!density_new(&density, canvas->width, canvas->height))
        return report_memory(picture->job->report);
    bcifs_status status = trace_open(&trace, picture, layer);
    if (status == BCIFS_OK) {
        while (trace_next(&trace, &mark))
            density_add(&density, mark.x, mark.y);
        status = trace_close(&trace);
    }
    if (status == BCIFS_OK)
        density_paint(&density, canvas, picture->styles[layer].line);
    density_free(&density);
    return status;
}

static bcifs_status layer_draw(struct canvas *canvas, const struct picture *picture, size_t index)
{
    const struct layer *layer = &picture->job->layers[index];
    const struct style *style = &picture->styles[index];
    double scale = pen_scale(picture);
    bool loose = points_are_loose(&layer->points);
    bcifs_status status = BCIFS_OK;
    if (style->fill > 0) {
        status = polygons_cover(canvas, picture, index);
        canvas_paint(canvas, style->line, style->fill);
    }
    if (loose && style->marker_size == 0) {
        if (layer->points.count > DOTS_MOST)
            return density_draw(canvas, picture, index);
        status = lines_cover(canvas, picture, index, scale * style->dot_size, true);
        canvas_paint(canvas, style->line, 1);
    } else if (!loose && status == BCIFS_OK) {
        status = lines_cover(canvas, picture, index, scale * style->line_width, false);
        canvas_paint(canvas, style->line, 1);
    }
    if (style->marker_size > 0 && status == BCIFS_OK) {
        status = lines_cover(canvas, picture, index, scale * style->marker_size, true);
        canvas_paint(canvas, style->marker, 1);
    }
    return status;
}

/* ---- Chunks -------------------------------------------------------------------------------------------- */

/* The polynomial division of ISO 3309, four bits at a time. */
static uint32_t crc_add(uint32_t crc, const unsigned char *bytes, size_t length)
{
    static const uint32_t table[16] = {0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac, 0x76dc4190, 0x6b6b51f4,
                                       0x4db26158, 0x5005713c, 0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c,
                                       0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c};
    for (size_t i = 0; i < length; i++) {
        crc ^= bytes[i];
        crc = crc >> 4 ^ table[crc & 15];
        crc = crc >> 4 ^ table[crc & 15];
    }
    return crc;
}

static void number_put(unsigned char *bytes, uint32_t number)
{
    for (int i = 0; i < 4; i++)
        bytes[i] = (unsigned char)(number >> (24 - 8 * i));
}

static void chunk_write(struct file *file, const char *type, const void *bytes, size_t length)
{
    unsigned char word[4];
    number_put(word, (uint32_t)length);
    file_write(file, word, 4);
    file_write(file, type, 4);
    file_write(file, bytes, length);
    uint32_t crc = crc_add(crc_add(0xffffffffu, (const unsigned char *)type, 4), bytes, length);
    number_put(word, ~crc);
    file_write(file, word, 4);
}

/* Appends text as UTF-8 without the control characters that PNG does not allow. */
static void text_add(struct text *chunk, const char *text)
{
    for (struct unicode next = unicode_first(text); next.length > 0; next = unicode_next(&next))
        if (next.code >= 0x20 || next.code == '\t' || next.code == '\n')
            text_append_bytes(chunk, next.bytes, next.length);
}

/* An iTXt chunk: keyword, not compressed, no language, `about` as the keyword's translation, text. */
static bcifs_status text_write(const struct job *job, struct file *file, const char *keyword,
                               const char *about, const char *text)
{
    struct text chunk = {0};
    text_append(&chunk, keyword);
    text_append_character(&chunk, '\0', 4);
    text_add(&chunk, about);
    text_append_character(&chunk, '\0', 1);
    text_add(&chunk, text);
    bcifs_status status = chunk.failed ? report_memory(job->report) : BCIFS_OK;
    if (status == BCIFS_OK)
        chunk_write(file, "iTXt", chunk.data, chunk.length);
    text_free(&chunk);
    return status;
}

static bcifs_status title_write(const struct job *job, struct file *file)
{
    struct text title = {0};
    text_append(&title, job->title[0] ? job->title : job->automaton);
    if (job->figure[0])
        text_append(&title, ", ");
    text_append(&title, job->figure);
    bcifs_status status =
        title.failed ? report_memory(job->report) : text_write(job, file, "Title", "", title.data);
    text_free(&title);
    return status;
}

static bcifs_status texts_write(const struct job *job, struct file *file)
{
    bcifs_status status = title_write(job, file);
    if (status == BCIFS_OK)
        status = text_write(job, file, "Software", "", "bcifs " BCIFS_VERSION);
    if (status == BCIFS_OK && job->command)
        status = text_write(job, file, "Command", "", job->command);
    for (size_t i = 0; i < job->source_count && status == BCIFS_OK; i++)
        status = text_write(job, file, "Automaton", job->sources[i]->name, job->sources[i]->text);
    return status;
}

/* ---- Pixels -------------------------------------------------------------------------------------------- */

static void pixels_sink(void *context, const unsigned char *bytes, size_t length)
{
    chunk_write(context, "IDAT", bytes, length);
}

static bool canvas_is_gray(const struct canvas *canvas)
{
    size_t area = (size_t)canvas->width * canvas->height;
    for (size_t i = 0; i < area; i++) {
        const unsigned char *pixel = canvas->pixels + 3 * i;
        if (pixel[0] != pixel[1] || pixel[1] != pixel[2])
            return false;
    }
    return true;
}

/* Rows without a filter: on flat paper with thin lines, pixels repeat more than differences. */
static bcifs_status pixels_write(const struct job *job, const struct canvas *canvas, bool gray,
                                 struct file *file)
{
    size_t channels = gray ? 1 : 3;
    unsigned char *row = memory_new(1 + canvas->width * channels, 1);
    struct deflate *deflate = row ? deflate_new(pixels_sink, file) : NULL;
    for (size_t y = 0; deflate && y < canvas->height && !file_failed(file); y++) {
        const unsigned char *pixels = canvas->pixels + 3 * y * canvas->width;
        for (size_t x = 0; x < canvas->width; x++)
            memcpy(row + 1 + channels * x, pixels + 3 * x, channels);
        deflate_write(deflate, row, 1 + canvas->width * channels);
    }
    bool complete = deflate != NULL;
    deflate_finish(deflate);
    memory_free(row);
    return complete ? BCIFS_OK : report_memory(job->report);
}

bcifs_status png_canvas_write(const struct job *job, const struct canvas *canvas, struct file *file)
{
    bool gray = canvas_is_gray(canvas);
    unsigned char header[13] = {0};
    number_put(header, canvas->width);
    number_put(header + 4, canvas->height);
    header[8] = 8;            /* bits per channel */
    header[9] = gray ? 0 : 2; /* gray or red, green, blue */
    file_write(file, "\x89PNG\r\n\x1a\n", 8);
    chunk_write(file, "IHDR", header, sizeof header);
    bcifs_status status = texts_write(job, file);
    if (status == BCIFS_OK)
        status = pixels_write(job, canvas, gray, file);
    chunk_write(file, "IEND", NULL, 0);
    return status;
}

bcifs_status png_write(struct job *job, struct file *file)
{
    struct picture picture;
    struct canvas canvas;
    bcifs_status status = picture_open(&picture, job);
    if (status != BCIFS_OK)
        return status;
    if (!canvas_new(&canvas, picture.width, picture.height)) {
        picture_close(&picture);
        return report_memory(job->report);
    }
    for (size_t i = 0; i < job->layer_count && status == BCIFS_OK; i++)
        status = layer_draw(&canvas, &picture, picture.order[i]);
    if (status == BCIFS_OK)
        status = png_canvas_write(job, &canvas, file);
    canvas_free(&canvas);
    picture_close(&picture);
    return status;
}
