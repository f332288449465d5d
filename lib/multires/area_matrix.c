#include "area_matrix.h"

#include <math.h>

#include "multires/editor_level.h"
#include "numeric/tolerance.h"

/* ---- Entries ------------------------------------------------------------------------------------------- */

/* The largest |m_ij| of each row: rows numbers. */
static void rows_measure(const struct sparse *form, double *largest)
{
    for (size_t i = 0; i < form->rows; i++)
        for (size_t k = form->starts[i]; k < form->starts[i + 1]; k++)
            largest[i] = fmax(largest[i], fabs(form->values[k]));
}

/* ½ (m_ij - m_ji) for i < j, and its negative; none where it is nothing but rounding. `triples` has room for twice as
 * many as the form has entries above its diagonal; returns how many there are. */
static size_t entries_clean(const struct sparse *form, const double *largest, struct triple *triples)
{
    size_t count = 0;
    for (size_t i = 0; i < form->rows; i++)
        for (size_t k = form->starts[i]; k < form->starts[i + 1]; k++) {
            size_t j = form->columns[k];
            if (j <= i)
                continue;
            double value = (form->values[k] - sparse_entry(form, j, i)) / 2;
            if (fabs(value) <= TOLERANCE_FORM * fmax(largest[i], largest[j]))
                continue;
            triples[count++] = (struct triple){i, j, value};
            triples[count++] = (struct triple){j, i, -value};
        }
    return count;
}

static size_t entries_above_diagonal(const struct sparse *form)
{
    size_t count = 0;
    for (size_t i = 0; i < form->rows; i++)
        for (size_t k = form->starts[i]; k < form->starts[i + 1]; k++)
            count += form->columns[k] > i;
    return count;
}

static bcifs_status form_clean(const struct sparse *form, struct arena *arena, struct sparse *clean)
{
    double *largest = memory_new(form->rows, sizeof *largest);
    struct triple *triples = memory_new(2 * entries_above_diagonal(form), sizeof *triples);
    bool made = largest && triples;
    if (made) {
        rows_measure(form, largest);
        size_t count = entries_clean(form, largest, triples);
        made = sparse_from_triples(clean, form->rows, form->width, triples, count, arena);
    }
    memory_free(largest);
    memory_free(triples);
    return made ? BCIFS_OK : BCIFS_MEMORY;
}

/* ---- The matrix ---------------------------------------------------------------------------------------- */

static bcifs_status parts_tell(bcifs_area_matrix *matrix, const struct bank *bank)
{
    matrix->level = bank->bottom;
    matrix->finest = bank->top;
    matrix->starts = arena_new(&matrix->arena, matrix->coarsen + 2, sizeof *matrix->starts);
    if (!matrix->starts)
        return BCIFS_MEMORY;
    for (unsigned k = 0; k < matrix->coarsen; k++)
        matrix->starts[k + 1] = bank_details_at(bank, bank->bottom + k);
    matrix->starts[matrix->coarsen + 1] = bank->count;
    return BCIFS_OK;
}

/* M^n from the forms of the finest cells, then M^L. */
static bcifs_status form_make(bcifs_area_matrix *matrix, struct ladder *ladder, const struct bank *bank,
                              struct arena *own, struct report *report)
{
    struct sparse mother, form;
    const char *reason;
    bcifs_status status = area_assemble(ladder, ladder->levels, own, &mother, &reason);
    if (status == BCIFS_OK && reason)
        return report_failure(report, BCIFS_NO, NULL, "there is no area: %s", reason);
    if (status == BCIFS_OK)
        status = form_descend(bank, &mother, -1, own, &form);
    return status ? status : form_clean(&form, &matrix->arena, &matrix->form);
}

static bcifs_status matrix_make(bcifs_area_matrix *matrix, const bcifs_figure *figure, unsigned refine,
                                struct arena *own, struct report *report)
{
    struct ladder ladder;
    struct bank bank;
    unsigned coarsen = matrix->coarsen;
    bcifs_status status = ladder_create(&ladder, figure, refine, coarsen, own, report);
    if (status == BCIFS_OK)
        status = bank_create(&bank, &ladder, ladder.levels - coarsen, ladder.levels, own, report);
    if (status == BCIFS_OK)
        status = parts_tell(matrix, &bank);
    return status ? status : form_make(matrix, &ladder, &bank, own, report);
}

bcifs_status bcifs_area_matrix_create(const bcifs_figure *figure, unsigned refine, unsigned coarsen,
                                      bcifs_area_matrix **matrix, bcifs_error *error)
{
    struct report report = report_new(NULL);
    struct arena own = {0};
    bcifs_area *area;
    bcifs_status status = bcifs_area_create(figure, &area, error);
    if (status)
        return status;
    bcifs_area_matrix *fresh = memory_new(1, sizeof *fresh);
    if (fresh) {
        fresh->area = area;
        fresh->coarsen = coarsen;
    } else {
        bcifs_area_free(area);
    }
    status = fresh ? matrix_make(fresh, figure, refine, &own, &report) : BCIFS_MEMORY;
    arena_free(&own);
    if (status == BCIFS_MEMORY && report.errors == 0)
        report_memory(&report);
    if (status) {
        bcifs_area_matrix_free(fresh);
        report_close(&report, error);
        return status;
    }
    *matrix = fresh;
    return BCIFS_OK;
}

void bcifs_area_matrix_free(bcifs_area_matrix *matrix)
{
    if (!matrix)
        return;
    bcifs_area_free(matrix->area);
    arena_free(&matrix->arena);
    memory_free(matrix);
}

/* ---- What it holds ------------------------------------------------------------------------------------- */

const bcifs_area *bcifs_area_matrix_area(const bcifs_area_matrix *matrix)
{
    return matrix->area;
}

unsigned bcifs_area_matrix_level(const bcifs_area_matrix *matrix, unsigned *finest)
{
    if (finest)
        *finest = matrix->finest;
    return matrix->level;
}

size_t bcifs_area_matrix_size(const bcifs_area_matrix *matrix)
{
    return matrix->form.rows;
}

size_t bcifs_area_matrix_scale_points(const bcifs_area_matrix *matrix)
{
    return matrix->starts[1];
}

size_t bcifs_area_matrix_start(const bcifs_area_matrix *matrix, unsigned part)
{
    return matrix->starts[part <= matrix->coarsen ? part : matrix->coarsen + 1];
}

size_t bcifs_area_matrix_entries(const bcifs_area_matrix *matrix, size_t *rows, size_t *columns, double *values)
{
    const struct sparse *form = &matrix->form;
    for (size_t i = 0; i < form->rows && rows; i++)
        for (size_t k = form->starts[i]; k < form->starts[i + 1]; k++) {
            rows[k] = i;
            columns[k] = form->columns[k];
            values[k] = form->values[k];
        }
    return form->starts[form->rows];
}

double bcifs_area_matrix_entry(const bcifs_area_matrix *matrix, size_t row, size_t column)
{
    return row < matrix->form.rows && column < matrix->form.width ? sparse_entry(&matrix->form, row, column) : 0;
}

double bcifs_area_matrix_value(const bcifs_area_matrix *matrix, const double *coefficients)
{
    return form_area(&matrix->form, coefficients);
}
