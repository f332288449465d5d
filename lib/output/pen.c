#include "output/pen.h"

#include <math.h>
#include <string.h>

#include "output/glyphs.h"
#include "output/png.h"
#include "output/raster.h"
#include "output/provenance.h"
#include "output/xml.h"

/* One of the two is set. */
struct pen {
    struct file *svg;
    struct canvas *canvas;
};

/* ---- Vectors ------------------------------------------------------------------------------------------- */

static void color_write(struct file *file, struct color color)
{
    static const char digits[] = "0123456789abcdef";
    const unsigned char channels[3] = {color.red, color.green, color.blue};
    file_text(file, "#");
    for (size_t i = 0; i < 3; i++) {
        file_write(file, &digits[channels[i] >> 4], 1);
        file_write(file, &digits[channels[i] & 15], 1);
    }
}

static void line_write(struct file *file, const double *xy, size_t count, struct color color, double width)
{
    file_text(file, "<polyline stroke=\"");
    color_write(file, color);
    file_text(file, "\" stroke-width=\"");
    file_fixed(file, width, 2);
    file_text(file, "\" points=\"");
    for (size_t i = 0; i < count; i++) {
        file_text(file, i % 8 ? " " : "\n");
        file_fixed(file, xy[2 * i], 2);
        file_text(file, ",");
        file_fixed(file, xy[2 * i + 1], 2);
    }
    file_text(file, "\"/>\n");
}

static void boxes_write(struct file *file, const unsigned *boxes, size_t count, struct color color)
{
    file_text(file, "<path shape-rendering=\"crispEdges\" fill=\"");
    color_write(file, color);
    file_text(file, "\" d=\"");
    for (size_t i = 0; i < count; i++, boxes += 4) {
        file_text(file, i % 8 ? "M" : "\nM");
        file_integer(file, boxes[0]);
        file_text(file, " ");
        file_integer(file, boxes[1]);
        file_text(file, "H");
        file_integer(file, boxes[2]);
        file_text(file, "V");
        file_integer(file, boxes[3]);
        file_text(file, "H");
        file_integer(file, boxes[0]);
        file_text(file, "z");
    }
    file_text(file, "\"/>\n");
}

static void words_write(struct file *file, double x, double y, enum pen_anchor anchor, const char *text,
                        struct color color)
{
    static const char *const anchors[] = {[PEN_LEFT] = "start", [PEN_MIDDLE] = "middle", [PEN_RIGHT] = "end"};
    file_text(file, "<text x=\"");
    file_fixed(file, x, 2);
    file_text(file, "\" y=\"");
    file_fixed(file, y, 2);
    file_text(file, "\" text-anchor=\"");
    file_text(file, anchors[anchor]);
    file_text(file, "\" fill=\"");
    color_write(file, color);
    file_text(file, "\">");
    xml_write(file, text);
    file_text(file, "</text>\n");
}

/* ---- Pixels -------------------------------------------------------------------------------------------- */

/* Pixels of a unit of the letters: two, which is as large as the letters of vectors, unless the picture is
 * small. */
static unsigned letter_scale(const struct canvas *canvas)
{
    enum { SMALL = 700 };
    return canvas->width < SMALL ? 1 : 2;
}

static void box_fill(struct canvas *canvas, const unsigned *box, struct color color)
{
    for (unsigned row = box[1]; row < box[3] && row < canvas->height; row++)
        for (unsigned column = box[0]; column < box[2] && column < canvas->width; column++) {
            unsigned char *pixel = canvas->pixels + 3 * ((size_t)row * canvas->width + column);
            pixel[0] = color.red;
            pixel[1] = color.green;
            pixel[2] = color.blue;
        }
}

static void words_cover(struct canvas *canvas, double x, double y, enum pen_anchor anchor, const char *text)
{
    unsigned scale = letter_scale(canvas);
    double width = (double)(glyphs_width(text) * scale);
    x -= anchor == PEN_LEFT ? 0 : anchor == PEN_MIDDLE ? width / 2 : width;
    glyphs_cover(canvas, lround(x), lround(y), scale, text);
}

/* ---- Both ---------------------------------------------------------------------------------------------- */

double pen_width(const struct pen *pen, const char *text)
{
    enum { CHARACTER = 8, AROUND = 4 };
    return AROUND + (pen->svg ? CHARACTER * (double)strlen(text)
                              : (double)(glyphs_width(text) * letter_scale(pen->canvas)));
}

double pen_height(const struct pen *pen)
{
    enum { LETTER = 10, AROUND = 4 };
    return AROUND + (pen->svg ? LETTER : (double)(GLYPH_ASCENT * letter_scale(pen->canvas)));
}

void pen_line(struct pen *pen, const double *xy, size_t count, struct color color, double width)
{
    if (pen->svg) {
        line_write(pen->svg, xy, count, color, width);
        return;
    }
    for (size_t i = 0; i + 1 < count; i++)
        canvas_segment(pen->canvas, xy[2 * i], xy[2 * i + 1], xy[2 * i + 2], xy[2 * i + 3], width);
    canvas_paint(pen->canvas, color, 1);
}

void pen_boxes(struct pen *pen, const unsigned *boxes, size_t count, struct color color)
{
    if (pen->svg && count > 0)
        boxes_write(pen->svg, boxes, count, color);
    for (size_t i = 0; pen->canvas && i < count; i++)
        box_fill(pen->canvas, boxes + 4 * i, color);
}

void pen_words(struct pen *pen, double x, double y, enum pen_anchor anchor, const char *text,
               struct color color)
{
    if (pen->svg) {
        words_write(pen->svg, x, y, anchor, text, color);
        return;
    }
    words_cover(pen->canvas, x, y, anchor, text);
    canvas_paint(pen->canvas, color, 1);
}

static void head_write(const struct job *job, unsigned width, unsigned height, struct file *file)
{
    file_text(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
                    "xmlns:bcifs=\"urn:bcifs\" width=\"");
    file_integer(file, width);
    file_text(file, "\" height=\"");
    file_integer(file, height);
    file_text(file, "\" viewBox=\"0 0 ");
    file_integer(file, width);
    file_text(file, " ");
    file_integer(file, height);
    file_text(file, "\">\n<title>");
    xml_write(file, job->title[0] ? job->title : job->automaton);
    file_text(file, job->figure[0] ? ", " : "");
    xml_write(file, job->figure);
    file_text(file, "</title>\n<metadata>\n");
    provenance_command_write(file, job->command);
    provenance_sources_write(file, job);
    file_text(file, "</metadata>\n<rect width=\"");
    file_integer(file, width);
    file_text(file, "\" height=\"");
    file_integer(file, height);
    file_text(file, "\" fill=\"#fff\"/>\n<g fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" "
                    "font-family=\"'DejaVu Sans Mono', Menlo, Consolas, monospace\" font-size=\"13\">\n");
}

bcifs_status pen_write_svg(const struct job *job, unsigned width, unsigned height, pen_drawing *draw,
                           const void *context, struct file *file)
{
    struct pen pen = {.svg = file};
    head_write(job, width, height, file);
    draw(&pen, context);
    file_text(file, "</g>\n</svg>\n");
    return BCIFS_OK;
}

bcifs_status pen_write_png(const struct job *job, unsigned width, unsigned height, pen_drawing *draw,
                           const void *context, struct file *file)
{
    struct canvas canvas;
    struct pen pen = {.canvas = &canvas};
    if (!canvas_new(&canvas, width, height))
        return report_memory(job->report);
    draw(&pen, context);
    bcifs_status status = png_canvas_write(job, &canvas, file);
    canvas_free(&canvas);
    return status;
}
