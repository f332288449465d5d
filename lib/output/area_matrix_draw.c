#include "area_matrix_draw.h"

#include <stdio.h>
#include <string.h>

#include "base/decimal.h"
#include "output/pen.h"

/* Pixels around the matrix: names of the parts above and at the left, the caption below. */
enum { LEFT = 56, RIGHT = 24, TOP = 36, BOTTOM = 68, LINE = 24, LEAST_WIDTH = 240 };

enum { BLOCK_A, BLOCK_B, BLOCK_C, BLOCKS };

static const struct color INK = {0x1c, 0x1c, 0x1c};
/* Yellow, red and green as in [MR]; dark ones differ in lightness, too, for gray print and color-blind eyes. */
static const struct color PALE[BLOCKS] = {{0xff, 0xf3, 0xb0}, {0xfb, 0xd9, 0xd3}, {0xd9, 0xf0, 0xd3}},
                          DARK[BLOCKS] = {{0xd4, 0x9a, 0x00}, {0xb8, 0x22, 0x22}, {0x1b, 0x73, 0x3a}};

struct sheet {
    const bcifs_area_matrix *matrix;
    unsigned width, height;
    unsigned left, side; /* of the matrix */
    unsigned gap;        /* between entries that are large enough to be told apart */
    unsigned char *row;  /* side: of each pixel of a row, 1 + the block whose entry is there, or 0 */
    unsigned *boxes;     /* side × 4 */
};

static unsigned edge(const struct sheet *sheet, size_t index)
{
    return (unsigned)((uint64_t)index * sheet->side / sheet->matrix->form.rows);
}

/* Where an entry ends: it is a pixel wide at least. */
static unsigned edge_after(const struct sheet *sheet, size_t index)
{
    unsigned start = edge(sheet, index), end = edge(sheet, index + 1);
    return end > start ? end : start + 1;
}

/* ---- Entries ------------------------------------------------------------------------------------------- */

static unsigned block_of(const bcifs_area_matrix *matrix, size_t row, size_t column)
{
    size_t scale = matrix->starts[1];
    return (unsigned)(row >= scale) + (unsigned)(column >= scale);
}

static void row_mark(const struct sheet *sheet, size_t i)
{
    const struct sparse *form = &sheet->matrix->form;
    for (size_t k = form->starts[i]; k < form->starts[i + 1]; k++) {
        unsigned start = edge(sheet, form->columns[k]), end = edge_after(sheet, form->columns[k]) - sheet->gap;
        memset(sheet->row + start, (int)(1 + block_of(sheet->matrix, i, form->columns[k])), end - start);
    }
}

/* The runs of one block's entries in the row of pixels, from `top` to `bottom`. */
static void runs_draw(struct pen *pen, const struct sheet *sheet, unsigned block, unsigned top, unsigned bottom)
{
    size_t count = 0;
    for (unsigned x = 0; x < sheet->side; x++) {
        unsigned start = x;
        while (x < sheet->side && sheet->row[x] == block + 1)
            x++;
        if (x == start)
            continue;
        unsigned *box = sheet->boxes + 4 * count++;
        box[0] = sheet->left + start;
        box[1] = TOP + top;
        box[2] = sheet->left + x;
        box[3] = TOP + bottom;
    }
    pen_boxes(pen, sheet->boxes, count, DARK[block]);
}

/* Rows of the matrix that fall on one row of pixels are drawn together. */
static void entries_draw(struct pen *pen, const struct sheet *sheet)
{
    size_t rows = sheet->matrix->form.rows;
    for (size_t i = 0; i < rows; i++) {
        row_mark(sheet, i);
        if (i + 1 < rows && edge(sheet, i + 1) == edge(sheet, i))
            continue;
        for (unsigned block = 0; block < BLOCKS; block++)
            runs_draw(pen, sheet, block, edge(sheet, i), edge_after(sheet, i) - sheet->gap);
        memset(sheet->row, 0, sheet->side);
    }
}

/* ---- Blocks -------------------------------------------------------------------------------------------- */

static void blocks_draw(struct pen *pen, const struct sheet *sheet)
{
    unsigned scale = edge(sheet, sheet->matrix->starts[1]), x0 = sheet->left, x1 = x0 + scale, x2 = x0 + sheet->side,
             y0 = TOP, y1 = y0 + scale, y2 = y0 + sheet->side;
    const unsigned a[] = {x0, y0, x1, y1}, b[] = {x1, y0, x2, y1, x0, y1, x1, y2}, c[] = {x1, y1, x2, y2};
    bool details = x1 < x2;
    pen_boxes(pen, a, 1, PALE[BLOCK_A]);
    pen_boxes(pen, b, details ? 2 : 0, PALE[BLOCK_B]);
    pen_boxes(pen, c, details ? 1 : 0, PALE[BLOCK_C]);
}

/* Lines two wide are sharp between pixels, lines one wide in the middle of them. */
static void cross_draw(struct pen *pen, const struct sheet *sheet, unsigned at, double width)
{
    double shift = width < 2 ? -0.5 : 0, x = sheet->left + at + shift, y = TOP + at + shift;
    const double down[] = {x, TOP, x, TOP + sheet->side}, across[] = {sheet->left, y, sheet->left + sheet->side, y};
    pen_line(pen, down, 2, INK, width);
    pen_line(pen, across, 2, INK, width);
}

/* Parts that are too narrow for lines of their own are left to the larger ones. */
static void lines_draw(struct pen *pen, const struct sheet *sheet)
{
    enum { NARROW = 8 };
    const bcifs_area_matrix *matrix = sheet->matrix;
    double x0 = sheet->left, x1 = x0 + sheet->side, y0 = TOP, y1 = y0 + sheet->side;
    const double frame[] = {x0, y0, x1, y0, x1, y1, x0, y1, x0, y0};
    for (unsigned part = 2; part <= matrix->coarsen; part++)
        if (edge(sheet, matrix->starts[part]) - edge(sheet, matrix->starts[part - 1]) >= NARROW)
            cross_draw(pen, sheet, edge(sheet, matrix->starts[part]), 1);
    if (matrix->coarsen > 0 && edge(sheet, matrix->starts[1]) > 0)
        cross_draw(pen, sheet, edge(sheet, matrix->starts[1]), 2);
    pen_line(pen, frame, 5, INK, 2);
}

/* ---- Words --------------------------------------------------------------------------------------------- */

/* x^L, d^L, … at the parts that have room for it. */
static void parts_name(struct pen *pen, const struct sheet *sheet)
{
    const bcifs_area_matrix *matrix = sheet->matrix;
    double height = pen_height(pen);
    for (unsigned part = 0; part <= matrix->coarsen; part++) {
        char name[24];
        snprintf(name, sizeof name, "%c^%u", part ? 'd' : 'x', matrix->level + (part ? part - 1 : 0));
        unsigned start = edge(sheet, matrix->starts[part]), end = edge(sheet, matrix->starts[part + 1]);
        double middle = (start + end) / 2.0;
        if (end - start >= pen_width(pen, name))
            pen_words(pen, sheet->left + middle, TOP - 10, PEN_MIDDLE, name, INK);
        if (end - start >= height)
            pen_words(pen, sheet->left - 8.0, TOP + middle + height / 2 - 2, PEN_RIGHT, name, INK);
    }
}

/* "A 8 x 8", and the like, one after the other. */
static void blocks_name(struct pen *pen, const struct sheet *sheet, double y)
{
    enum { SPACE = 20 };
    size_t scale = sheet->matrix->starts[1], details = sheet->matrix->form.rows - scale;
    const size_t sizes[BLOCKS][2] = {{scale, scale}, {scale, details}, {details, details}};
    double x = LEFT;
    for (unsigned block = 0; block < (details ? BLOCKS : 1); block++) {
        char name[64];
        snprintf(name, sizeof name, "%c %zu x %zu", "ABC"[block], sizes[block][0], sizes[block][1]);
        pen_words(pen, x, y, PEN_LEFT, name, DARK[block]);
        x += pen_width(pen, name) + SPACE;
    }
}

static void caption_draw(struct pen *pen, const struct sheet *sheet)
{
    const bcifs_area_matrix *matrix = sheet->matrix;
    size_t rows = matrix->form.rows, entries = matrix->form.starts[rows];
    double y = TOP + sheet->side + LINE + 4, share = 100 * (double)entries / ((double)rows * (double)rows);
    char digits[DECIMAL_LONGEST + 1], line[192];
    digits[decimal_print_digits(digits, share, 3)] = '\0';
    snprintf(line, sizeof line, "M^%u, n = %u: %zu x %zu, %s %% not zero", matrix->level, matrix->finest, rows, rows,
             digits);
    pen_words(pen, LEFT, y, PEN_LEFT, line, INK);
    blocks_name(pen, sheet, y + LINE);
}

/* ---- The picture --------------------------------------------------------------------------------------- */

static void sheet_draw(struct pen *pen, const void *context)
{
    const struct sheet *sheet = context;
    blocks_draw(pen, sheet);
    entries_draw(pen, sheet);
    lines_draw(pen, sheet);
    parts_name(pen, sheet);
    caption_draw(pen, sheet);
}

/* Where there is room, all entries are of one size, with a gap between them. */
static void sheet_layout(struct sheet *sheet)
{
    enum { PLAIN = 3, TOLD_APART = 6 };
    size_t rows = sheet->matrix->form.rows;
    unsigned room = sheet->width - LEFT - RIGHT;
    sheet->side = room;
    if (rows * PLAIN <= room) {
        unsigned pixels = room / (unsigned)rows;
        sheet->side = pixels * (unsigned)rows;
        sheet->gap = pixels >= TOLD_APART;
    }
    sheet->left = LEFT + (room - sheet->side) / 2;
    sheet->height = TOP + sheet->side + BOTTOM;
}

typedef bcifs_status pen_write(const struct job *job, unsigned width, unsigned height, pen_drawing *draw,
                               const void *context, struct file *file);

static bcifs_status picture_write(const bcifs_area_matrix *matrix, const struct job *job, pen_write *write,
                                  struct file *file)
{
    struct sheet sheet = {.matrix = matrix, .width = job->width};
    if (job->width < LEAST_WIDTH || job->width > PICTURE_MOST_WIDTH / 2)
        return report_failure(job->report, BCIFS_INPUT, NULL, "a matrix is drawn %d to %d pixels wide, found %u",
                              LEAST_WIDTH, PICTURE_MOST_WIDTH / 2, job->width);
    sheet_layout(&sheet);
    sheet.row = memory_new(sheet.side, sizeof *sheet.row);
    sheet.boxes = memory_new(sheet.side, 4 * sizeof *sheet.boxes);
    bcifs_status status = sheet.row && sheet.boxes
                              ? write(job, sheet.width, sheet.height, sheet_draw, &sheet, file)
                              : report_memory(job->report);
    memory_free(sheet.row);
    memory_free(sheet.boxes);
    return status;
}

bcifs_status area_matrix_svg_write(const bcifs_area_matrix *matrix, const struct job *job, struct file *file)
{
    return picture_write(matrix, job, pen_write_svg, file);
}

bcifs_status area_matrix_png_write(const bcifs_area_matrix *matrix, const struct job *job, struct file *file)
{
    return picture_write(matrix, job, pen_write_png, file);
}
