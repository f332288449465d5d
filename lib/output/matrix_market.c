#include "output/matrix_market.h"

#include "automaton/automaton.h"
#include "base/memory.h"
#include "evaluate/basis.h"

/* ---- Lines --------------------------------------------------------------------------------------------- */

void market_comment_write(struct file *file, const char *text)
{
    for (; *text; text++)
        file_write(file, (unsigned char)*text < 0x20 ? " " : text, 1);
}

void market_sizes_write(struct file *file, uint64_t rows, uint64_t columns, uint64_t entries)
{
    file_integer(file, rows);
    file_text(file, " ");
    file_integer(file, columns);
    file_text(file, " ");
    file_integer(file, entries);
    file_text(file, "\n");
}

void market_entry_write(struct file *file, uint64_t row, uint64_t column, double value)
{
    file_integer(file, row + 1);
    file_text(file, " ");
    file_integer(file, column + 1);
    file_text(file, " ");
    file_number(file, value);
    file_text(file, "\n");
}

/* ---- Refinement matrices ------------------------------------------------------------------------------- */

/* The sizes say how many entries follow, so the columns are run over twice; they are never held. */
struct market {
    const bcifs_figure *figure;
    struct states states;
    bcifs_view view;
    struct report *report;
    struct file *file; /* NULL: entries are counted only */
    uint64_t columns, entries;
};

enum { TILE = 64 /* columns read at a time */ };

/* One column: a control point of the figure may stand several times among the piece's, and is one row. */
static void column_write(struct market *market, const struct piece *piece, double *column, size_t points)
{
    market->columns++;
    for (size_t j = 0; j < points; j++)
        for (size_t k = j + 1; k < points; k++)
            if (piece->indices[k] == piece->indices[j]) {
                column[j] += column[k];
                column[k] = 0;
            }
    for (size_t j = 0; j < points; j++) {
        if (column[j] == 0)
            continue;
        market->entries++;
        if (market->file)
            market_entry_write(market->file, piece->indices[j], market->columns - 1, column[j]);
    }
}

/* The columns of one piece; those that close the chain only when it ends here. */
static bcifs_status piece_write(struct market *market, const struct piece *piece, bool ends)
{
    struct unit_reader reader;
    bcifs_status status =
        unit_open(&reader, market->figure, &market->states, piece->state, &market->view, market->report);
    if (status)
        return status;
    double *columns = memory_new(TILE * reader.points, sizeof *columns);
    if (!columns)
        status = report_memory(market->report);
    uint64_t left = ends ? reader.count : reader.body;
    while (left > 0 && status == BCIFS_OK && !(market->file && file_failed(market->file))) {
        size_t count = unit_next(&reader, columns, left < TILE ? (size_t)left : TILE);
        for (size_t i = 0; i < count; i++)
            column_write(market, piece, columns + i * reader.points, reader.points);
        left = count > 0 ? left - count : 0;
    }
    memory_free(columns);
    unit_close(&reader);
    return status;
}

static bcifs_status pieces_write(struct market *market)
{
    const bcifs_figure *figure = market->figure;
    bcifs_status status = BCIFS_OK;
    market->columns = market->entries = 0;
    for (size_t i = 0; i < figure->piece_count && figure->shape == FIGURE_ATTRACTOR && status == BCIFS_OK;
         i++)
        status = piece_write(market, &figure->pieces[i], true);
    for (size_t c = 0; c < figure->chain_count && status == BCIFS_OK; c++) {
        const struct chain *chain = &figure->chains[c];
        for (size_t i = 0; i < chain->count && status == BCIFS_OK; i++)
            status = piece_write(market, &figure->pieces[chain->first + i],
                                 !chain->closed && i + 1 == chain->count);
    }
    return status;
}

static void head_write(const struct market *market, const char *command)
{
    struct file *file = market->file;
    file_text(file, "%%MatrixMarket matrix coordinate real general\n% bcifs " BCIFS_VERSION
                    ": refinement matrix of level ");
    file_integer(file, market->view.depth);
    file_text(file, " of ");
    market_comment_write(file, bcifs_automaton_name(market->figure->automaton));
    file_text(file, market->figure->name[0] ? ", figure " : "");
    market_comment_write(file, market->figure->name);
    file_text(
        file,
        "\n% rows: control points; columns: control points of the level, in order; each column sums to 1\n");
    if (command) {
        file_text(file, "% ");
        market_comment_write(file, command);
        file_text(file, "\n");
    }
    market_sizes_write(file, market->figure->point_count, market->columns, market->entries);
}

static bcifs_status market_write(struct market *market, const char *path, const char *command)
{
    struct file file;
    bcifs_status status = pieces_write(market); /* counts */
    if (status == BCIFS_OK)
        status = file_open(&file, path, market->report);
    if (status)
        return status;
    market->file = &file;
    head_write(market, command);
    return file_close(&file, pieces_write(market));
}

bcifs_status bcifs_write_refinement(const bcifs_figure *figure, unsigned depth, const char *path,
                                    const bcifs_write_options *options, bcifs_error *error)
{
    struct report report = report_new(NULL);
    struct arena arena = {0};
    struct market market = {
        .figure = figure, .view = {.depth = depth, .show = BCIFS_CONTROL, .to = 1}, .report = &report};
    if (figure->shape == FIGURE_SURFACE)
        report_failure(
            &report, BCIFS_INPUT, NULL,
            "'%s' is a surface; its refinement matrix is the tensor product of its curves' ([IM] 6.2)",
            figure->name);
    else if (states_copy(&market.states, &figure->states, &arena, &report) == BCIFS_OK)
        market_write(&market, path, options ? options->command : NULL);
    arena_free(&arena);
    return report_close(&report, error);
}
