#include "editor_level.h"

#include <string.h>

/* ---- Forms --------------------------------------------------------------------------------------------- */

double form_area(const struct sparse *area, const double *points)
{
    double sum = 0;
    for (size_t i = 0; i < area->rows; i++) {
        double row = 0;
        for (size_t k = area->starts[i]; k < area->starts[i + 1]; k++)
            row += area->values[k] * points[2 * area->columns[k] + 1];
        sum += points[2 * i] * row;
    }
    return sum / 2;
}

double form_energy(const struct sparse *energy, const double *points)
{
    double sum = 0;
    for (size_t i = 0; i < energy->rows; i++) {
        double row[2] = {0, 0};
        for (size_t k = energy->starts[i]; k < energy->starts[i + 1]; k++)
            for (int c = 0; c < 2; c++)
                row[c] += energy->values[k] * points[2 * energy->columns[k] + (size_t)c];
        sum += points[2 * i] * row[0] + points[2 * i + 1] * row[1];
    }
    return sum / 2;
}

static bcifs_status energy_make(struct editor_level *level, bcifs_energy wanted)
{
    struct ladder *ladder = &level->ladder;
    unsigned top = ladder->levels;
    level->energy = wanted;
    if (wanted == BCIFS_NO_ENERGY)
        return BCIFS_OK;
    bcifs_status status = BCIFS_OK;
    if (wanted == BCIFS_BENDING)
        status = energy_assemble(ladder, top, &level->arena, &level->fine_energy, &level->energy_reason);
    if (status == BCIFS_OK && (wanted == BCIFS_DIFFERENCE || level->energy_reason)) {
        level->energy = BCIFS_DIFFERENCE;
        status = differences_assemble(ladder, top, &level->arena, &level->fine_energy);
    }
    return status ? status
                  : form_descend(&level->bank, &level->fine_energy, 1, &level->arena, &level->energy_form);
}

static bcifs_status forms_make(struct editor_level *level, bcifs_energy energy)
{
    bcifs_status status = area_assemble(&level->ladder, level->ladder.levels, &level->arena, &level->fine_area,
                                        &level->area_reason);
    if (status == BCIFS_OK && !level->area_reason)
        status = form_descend(&level->bank, &level->fine_area, -1, &level->arena, &level->area);
    return status ? status : energy_make(level, energy);
}

/* ---- The level ----------------------------------------------------------------------------------------- */

static bcifs_status level_make(struct editor_level *level, const bcifs_figure *figure, unsigned refine,
                               unsigned coarsen, bcifs_energy energy, struct report *report)
{
    struct ladder *ladder = &level->ladder;
    bcifs_status status = ladder_create(ladder, figure, refine, coarsen, &level->arena, report);
    if (status == BCIFS_OK)
        status = bank_create(&level->bank, ladder, ladder->levels - coarsen, ladder->levels, &level->arena, report);
    if (status == BCIFS_OK)
        status = forms_make(level, energy);
    if (status == BCIFS_MEMORY && report->errors == 0)
        report_memory(report);
    ladder->states.setting.report = NULL; /* it does not outlive this call */
    return status;
}

bcifs_status editor_level_create(const bcifs_figure *figure, unsigned refine, unsigned coarsen, bcifs_energy energy,
                                 struct report *report, struct editor_level **level)
{
    struct editor_level *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status =
        fresh ? level_make(fresh, figure, refine, coarsen, energy, report) : report_memory(report);
    if (status) {
        editor_level_free(fresh);
        return status;
    }
    *level = fresh;
    return BCIFS_OK;
}

void editor_level_free(struct editor_level *level)
{
    if (!level)
        return;
    arena_free(&level->arena);
    memory_free(level);
}
