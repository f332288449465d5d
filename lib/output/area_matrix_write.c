/* Area matrices as files: the table of their formats. */
#include <string.h>

#include "base/decimal.h"
#include "output/area_matrix_draw.h"
#include "output/area_report.h"
#include "output/json_text.h"
#include "output/matrix_market.h"
#include "output/picture.h"
#include "output/provenance.h"

/* Rows that a format has: a page is no wider, and dense texts hold mostly zeros. */
enum { MOST_SHOWN = 32, MOST_JSON = 1024, MOST_CSV = 4096 };

static bcifs_status rows_check(const bcifs_area_matrix *matrix, const struct job *job, const char *format, size_t most)
{
    size_t rows = matrix->form.rows;
    if (rows <= most)
        return BCIFS_OK;
    return report_failure(job->report, BCIFS_INPUT, NULL,
                          "the area matrix has %zu rows, %s holds at most %zu: -o x.mtx writes any number", rows,
                          format, most);
}

static bcifs_status text_write(struct text *text, const struct job *job, struct file *file)
{
    bcifs_status status = text->failed ? report_memory(job->report) : BCIFS_OK;
    if (status == BCIFS_OK)
        file_write(file, text->data, text->length);
    text_free(text);
    return status;
}

/* ---- Text for a person --------------------------------------------------------------------------------- */

enum { SHOWN_DIGITS = 6, LONGEST_ENTRY = DECIMAL_LONGEST + 1 };

/* An entry as it is shown; returns its length. The zeros of a sparse matrix are points, so that the others stand out. */
static size_t entry_show(const bcifs_area_matrix *matrix, size_t row, size_t column, char shown[LONGEST_ENTRY])
{
    double value = sparse_entry(&matrix->form, row, column);
    size_t length = value != 0 ? decimal_print_digits(shown, value, SHOWN_DIGITS) : 1;
    if (value == 0)
        shown[0] = '.';
    shown[length] = '\0';
    return length;
}

static size_t column_width(const bcifs_area_matrix *matrix, size_t column)
{
    char shown[LONGEST_ENTRY];
    size_t widest = 1;
    for (size_t i = 0; i < matrix->form.rows; i++) {
        size_t length = entry_show(matrix, i, column, shown);
        widest = length > widest ? length : widest;
    }
    return widest;
}

/* Whether the details of a level begin at a row or column. */
static bool part_begins(const bcifs_area_matrix *matrix, size_t index)
{
    bool begins = false;
    for (unsigned part = 1; part <= matrix->coarsen; part++)
        begins = begins || matrix->starts[part] == index;
    return begins;
}

static void row_append(struct text *text, const bcifs_area_matrix *matrix, size_t row, const size_t *widths)
{
    char shown[LONGEST_ENTRY];
    text_append(text, "  [");
    for (size_t j = 0; j < matrix->form.width; j++) {
        size_t length = entry_show(matrix, row, j, shown);
        text_append(text, part_begins(matrix, j) ? " | " : " ");
        text_append_character(text, ' ', widths[j] - length);
        text_append(text, shown);
    }
    text_append(text, " ]\n");
}

static void rule_append(struct text *text, const bcifs_area_matrix *matrix, const size_t *widths)
{
    text_append(text, "  [");
    for (size_t j = 0; j < matrix->form.width; j++) {
        text_append(text, part_begins(matrix, j) ? "-+-" : "-");
        text_append_character(text, '-', widths[j]);
    }
    text_append(text, "-]\n");
}

/* "area matrix of level 1 of 3, 32 × 32: 8 control points, details 8, 16" */
static void sizes_append(struct text *text, const bcifs_area_matrix *matrix)
{
    text_format(text, "area matrix of level %u of %u, %zu × %zu: %zu control point%s", matrix->level, matrix->finest,
                matrix->form.rows, matrix->form.rows, matrix->starts[1], matrix->starts[1] == 1 ? "" : "s");
    for (unsigned part = 1; part <= matrix->coarsen; part++)
        text_format(text, "%s%zu", part == 1 ? ", details " : ", ", matrix->starts[part + 1] - matrix->starts[part]);
    text_append(text, "\n");
}

static bcifs_status txt_write(const bcifs_area_matrix *matrix, const struct job *job, struct file *file)
{
    struct text text = {0};
    size_t rows = matrix->form.rows, widths[MOST_SHOWN];
    area_text_head(&text, matrix->area);
    sizes_append(&text, matrix);
    if (rows > MOST_SHOWN)
        text_format(&text, "  %zu entries are not zero: too large to show, -o x.mtx writes them\n",
                    matrix->form.starts[rows]);
    for (size_t j = 0; j < rows && rows <= MOST_SHOWN; j++)
        widths[j] = column_width(matrix, j);
    for (size_t i = 0; i < rows && rows <= MOST_SHOWN; i++) {
        if (part_begins(matrix, i))
            rule_append(&text, matrix, widths);
        row_append(&text, matrix, i, widths);
    }
    return text_write(&text, job, file);
}

/* ---- Data ---------------------------------------------------------------------------------------------- */

static void row_json(struct text *text, const struct sparse *form, size_t row)
{
    size_t k = form->starts[row];
    text_append(text, "[");
    for (size_t j = 0; j < form->width; j++) {
        bool here = k < form->starts[row + 1] && form->columns[k] == j;
        text_append(text, j ? ", " : "");
        json_number(text, here ? form->values[k] : 0);
        k += here;
    }
    text_append(text, "]");
}

static bcifs_status json_write(const bcifs_area_matrix *matrix, const struct job *job, struct file *file)
{
    struct text text = {0};
    size_t rows = matrix->form.rows;
    bcifs_status status = rows_check(matrix, job, "JSON", MOST_JSON);
    if (status)
        return status;
    text_append(&text, "{");
    area_json_members(&text, matrix->area);
    text_format(&text, ",\n \"coarsen\": %u, \"level\": %u, \"scale_points\": %zu, \"level_sizes\": [", matrix->coarsen,
                matrix->level, matrix->starts[1]);
    for (unsigned part = 0; part <= matrix->coarsen; part++)
        text_format(&text, "%s%zu", part ? ", " : "", matrix->starts[part + 1] - matrix->starts[part]);
    text_format(&text, "], \"entries\": %zu,\n \"matrix\": [", matrix->form.starts[rows]);
    for (size_t i = 0; i < rows; i++) {
        text_append(&text, i ? ",\n  " : "\n  ");
        row_json(&text, &matrix->form, i);
    }
    text_append(&text, "]}\n");
    return text_write(&text, job, file);
}

static bcifs_status csv_write(const bcifs_area_matrix *matrix, const struct job *job, struct file *file)
{
    const struct sparse *form = &matrix->form;
    bcifs_status status = rows_check(matrix, job, "CSV", MOST_CSV);
    for (size_t i = 0; i < form->rows && status == BCIFS_OK && !file_failed(file); i++) {
        size_t k = form->starts[i];
        for (size_t j = 0; j < form->width; j++) {
            bool here = k < form->starts[i + 1] && form->columns[k] == j;
            file_text(file, j ? "," : "");
            file_number(file, here ? form->values[k] : 0);
            k += here;
        }
        file_text(file, "\n");
    }
    return status;
}

static void mtx_head_write(const bcifs_area_matrix *matrix, const struct job *job, struct file *file)
{
    file_text(file, "%%MatrixMarket matrix coordinate real skew-symmetric\n% bcifs " BCIFS_VERSION
                    ": area matrix of level ");
    file_integer(file, matrix->level);
    file_text(file, " of ");
    file_integer(file, matrix->finest);
    file_text(file, " of ");
    market_comment_write(file, job->automaton);
    file_text(file, job->figure[0] ? ", figure " : "");
    market_comment_write(file, job->figure);
    file_text(file, "\n% control points, then details of each level; numbers of them:");
    for (unsigned part = 0; part <= matrix->coarsen; part++) {
        file_text(file, " ");
        file_integer(file, matrix->starts[part + 1] - matrix->starts[part]);
    }
    if (job->command) {
        file_text(file, "\n% ");
        market_comment_write(file, job->command);
    }
    file_text(file, "\n");
}

/* Only what is below the diagonal: the format's word for antisymmetric is skew-symmetric. */
static bcifs_status mtx_write(const bcifs_area_matrix *matrix, const struct job *job, struct file *file)
{
    const struct sparse *form = &matrix->form;
    mtx_head_write(matrix, job, file);
    market_sizes_write(file, form->rows, form->width, form->starts[form->rows] / 2);
    for (size_t i = 0; i < form->rows && !file_failed(file); i++)
        for (size_t k = form->starts[i]; k < form->starts[i + 1] && form->columns[k] < i; k++)
            market_entry_write(file, i, form->columns[k], form->values[k]);
    return BCIFS_OK;
}

/* ---- The table ----------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    bcifs_status (*write)(const bcifs_area_matrix *matrix, const struct job *job, struct file *file);
} FORMATS[] = {{"txt", txt_write}, {"json", json_write},           {"csv", csv_write},
               {"mtx", mtx_write}, {"svg", area_matrix_svg_write}, {"png", area_matrix_png_write}};

/* The index of the format asked for, by name or by the ending of the path; "-" without a name is txt. */
static bcifs_status format_choose(const char *path, const char *name, struct report *report, size_t *index)
{
    const char *slash = strrchr(path, '/'), *ending = strrchr(slash ? slash + 1 : path, '.');
    if (!name)
        name = strcmp(path, "-") == 0 ? "txt" : ending ? ending + 1 : "";
    for (*index = 0; *index < sizeof FORMATS / sizeof FORMATS[0]; ++*index)
        if (strcmp(FORMATS[*index].name, name) == 0)
            return BCIFS_OK;
    return report_failure(report, BCIFS_INPUT, NULL,
                          "an area matrix is written as txt, json, csv, mtx, svg or png, not '%s'", name);
}

bcifs_status bcifs_area_matrix_write(const bcifs_area_matrix *matrix, const char *path,
                                     const bcifs_write_options *options, bcifs_error *error)
{
    static const bcifs_write_options defaults = {0};
    struct report report = report_new(NULL);
    const struct source *sources[AUTOMATON_MOST_MODULES];
    const bcifs_automaton *automaton = matrix->area->automaton;
    struct file file;
    size_t index;
    options = options ? options : &defaults;
    struct job job = {.automaton = bcifs_automaton_name(automaton),
                      .title = bcifs_automaton_title(automaton),
                      .figure = matrix->area->figure,
                      .command = options->command,
                      .width = options->width ? options->width : PICTURE_DEFAULT_WIDTH,
                      .report = &report};
    provenance_sources_take(&job, automaton, sources);
    bcifs_status status = format_choose(path, options->format, &report, &index);
    if (status == BCIFS_OK)
        status = file_open(&file, path, &report);
    if (status == BCIFS_OK)
        file_close(&file, FORMATS[index].write(matrix, &job, &file));
    return report_close(&report, error);
}
