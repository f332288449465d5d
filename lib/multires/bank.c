#include "bank.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "numeric/field.h"

/* ---- Decomposition and reconstruction of one step ----------------------------------------------------------- */

/* x^j = P x^{j-1} + Q d^{j-1}. */
static void step_reconstruct(const struct bank_step *step, const double *coarse, const double *details,
                             size_t components, double *fine)
{
    stencil_apply(&step->refinement, coarse, components, false, fine);
    if (step->filtered)
        stencil_apply(&step->synthesis, details, components, true, fine);
    else
        stencil_apply_transposed(&step->wavelet, details, components, fine);
}

/* c = A x and d = B x, or the least squares that stand for them. `rest` and `workspace` hold fine × components
 * numbers each. */
static void step_analyze(const struct bank_step *step, const double *fine, size_t components, double *coarse,
                         double *details, double *rest, double *workspace)
{
    if (step->filtered) {
        stencil_apply(&step->smooth, fine, components, false, coarse);
        stencil_apply(&step->detail, fine, components, false, details);
        return;
    }
    memset(coarse, 0, step->coarse * components * sizeof *coarse);
    stencil_apply_transposed(&step->refinement, fine, components, coarse);
    sparse_cholesky_solve(&step->coarse_gram, coarse, components, workspace);
    stencil_apply(&step->refinement, coarse, components, false, rest);
    for (size_t i = 0; i < step->fine * components; i++)
        rest[i] = fine[i] - rest[i];
    stencil_apply(&step->wavelet, rest, components, false, details);
    if (step->details > 0)
        sparse_cholesky_solve(&step->detail_gram, details, components, workspace);
}

/* x^{j-1} and d^{j-1} of one chain. `workspace` holds four times fine × components numbers. */
static void step_decompose(const struct bank_step *step, const double *fine, size_t components, double *coarse,
                           double *details, double *workspace)
{
    size_t numbers = step->fine * components, scale = step->coarse * components;
    double *rest = workspace, *solving = rest + numbers, *missed = solving + numbers, *more = missed + numbers;
    step_analyze(step, fine, components, coarse, details, rest, solving);
    if (!step->refined)
        return;
    /* What reconstruction misses is taken apart again. */
    step_reconstruct(step, coarse, details, components, missed);
    for (size_t i = 0; i < numbers; i++)
        missed[i] = fine[i] - missed[i];
    step_analyze(step, missed, components, more, more + scale, rest, solving);
    for (size_t i = 0; i < scale; i++)
        coarse[i] += more[i];
    for (size_t i = scale; i < numbers; i++)
        details[i - scale] += more[i];
}
/* ---- Steps --------------------------------------------------------------------------------------------- */

/* L L^T = S^T S. */
static enum sparse_outcome gram_factor(const struct sparse *s, struct arena *arena, struct sparse_cholesky *factor)
{
    struct arena scratch = {0};
    struct sparse transposed, gram;
    bool made = sparse_transpose(s, &transposed, &scratch) && sparse_multiply(&transposed, s, &gram, &scratch);
    enum sparse_outcome outcome = made ? sparse_cholesky_factor(&gram, NULL, arena, factor) : SPARSE_MEMORY;
    arena_free(&scratch);
    return outcome;
}

static enum sparse_outcome grams_factor(struct bank_step *step, struct arena *arena)
{
    struct arena scratch = {0};
    struct sparse refinement, rows, wavelet;
    enum sparse_outcome outcome = SPARSE_MEMORY;
    if (stencil_sparse(&step->refinement, &refinement, &scratch))
        outcome = gram_factor(&refinement, arena, &step->coarse_gram);
    if (outcome == SPARSE_DONE && step->details > 0) {
        outcome = SPARSE_MEMORY;
        if (stencil_sparse(&step->wavelet, &rows, &scratch) && sparse_transpose(&rows, &wavelet, &scratch))
            outcome = gram_factor(&wavelet, arena, &step->detail_gram);
    }
    arena_free(&scratch);
    return outcome;
}

static bcifs_status step_refuse(const struct ladder *ladder, size_t chain, unsigned rung, struct report *report)
{
    const struct rung *cells = &ladder->chains[chain].rungs[rung];
    return report_failure(report, BCIFS_INPUT, NULL,
                          "there is no decomposition of '%s' to %zu control points: its refinement matrix does not "
                          "have full rank",
                          ladder->states.states[cells->cells[0]].key.definition->name, cells->points);
}

/* The filters that the file declares for the state of all cells, or derived ones. */
static bcifs_status step_filter(struct bank_step *step, const struct ladder *ladder, size_t chain, unsigned rung,
                                struct arena *arena, struct report *report)
{
    const struct rung *cells = &ladder->chains[chain].rungs[rung];
    const struct definition *definition = ladder->states.states[cells->cells[0]].key.definition;
    const struct declared_filters *declared = NULL;
    struct filters filters;
    bcifs_status status = filters_declared(ladder->figure->automaton, definition, arena, report, &declared);
    if (status || !ladder->chains[chain].closed)
        return status;
    for (size_t i = 1; declared && i < cells->count; i++)
        if (ladder->states.states[cells->cells[i]].key.definition != definition)
            declared = NULL;
    if (declared)
        status = filters_apply_declared(&step->refinement, declared, arena, &filters, &step->filtered);
    if (status == BCIFS_OK && !step->filtered)
        status = filters_derive(&step->refinement, arena, &filters, &step->filtered);
    if (status)
        return report_memory(report);
    if (step->filtered) {
        step->smooth = filters.smooth;
        step->detail = filters.detail;
        step->wavelet = filters.wavelet;
        step->synthesis = filters.synthesis;
    }
    return BCIFS_OK;
}

/* Whether the normal equations lose too much, for they square the condition: a curve with all frequencies is taken
 * apart and put together, and what is missing is measured. */
static bcifs_status step_judge(struct bank_step *step)
{
    const double enough = 16 * DBL_EPSILON;
    double *points = memory_new(7 * step->fine, sizeof *points), worst = 0;
    if (!points)
        return BCIFS_MEMORY;
    double *coefficients = points + step->fine, *again = coefficients + step->fine, *workspace = again + step->fine;
    uint64_t state = 1;
    for (size_t i = 0; i < step->fine; i++)
        points[i] = (double)field_random(&state) / (double)FIELD_PRIME;
    step_decompose(step, points, 1, coefficients, coefficients + step->coarse, workspace);
    step_reconstruct(step, coefficients, coefficients + step->coarse, 1, again);
    for (size_t i = 0; i < step->fine; i++)
        worst = fmax(worst, fabs(again[i] - points[i]));
    step->refined = !(worst <= enough);
    memory_free(points);
    return BCIFS_OK;
}

static bcifs_status step_create(struct bank_step *step, const struct ladder *ladder, size_t chain, unsigned rung,
                                struct arena *arena, struct report *report)
{
    const struct rung *rungs = ladder->chains[chain].rungs;
    step->coarse = rungs[rung].points;
    step->fine = rungs[rung + 1].points;
    if (step->fine < step->coarse)
        return step_refuse(ladder, chain, rung, report);
    step->details = step->fine - step->coarse;
    bcifs_status status = ladder_refinement(ladder, chain, rung, &step->refinement);
    if (status == BCIFS_OK)
        status = step_filter(step, ladder, chain, rung, arena, report);
    if (status || step->filtered)
        return status;
    bool found;
    if (complement_find(&step->refinement, ladder->chains[chain].closed, arena, &step->wavelet, &found))
        return report_memory(report);
    if (!found)
        return step_refuse(ladder, chain, rung, report);
    enum sparse_outcome outcome = grams_factor(step, arena);
    if (outcome == SPARSE_DONE)
        return step_judge(step) ? report_memory(report) : BCIFS_OK;
    return outcome == SPARSE_INDEFINITE ? step_refuse(ladder, chain, rung, report) : report_memory(report);
}

bcifs_status bank_create(struct bank *bank, const struct ladder *ladder, unsigned bottom, unsigned top,
                         struct arena *arena, struct report *report)
{
    *bank = (struct bank){.arena = arena,
                          .ladder = ladder,
                          .bottom = bottom,
                          .top = top,
                          .count = ladder_points(ladder, top),
                          .scale = ladder_points(ladder, bottom)};
    bank->steps = arena_new(arena, top - bottom, sizeof *bank->steps);
    if (!bank->steps)
        return report_memory(report);
    for (unsigned rung = top; rung-- > bottom;) {
        struct bank_step *steps = arena_new(arena, ladder->chain_count, sizeof *steps);
        bank->steps[rung - bottom] = steps;
        if (!steps)
            return report_memory(report);
        for (size_t c = 0; c < ladder->chain_count; c++) {
            bcifs_status status = step_create(&steps[c], ladder, c, rung, arena, report);
            if (status)
                return status;
        }
    }
    return BCIFS_OK;
}

size_t bank_details_at(const struct bank *bank, unsigned rung)
{
    return ladder_points(bank->ladder, rung);
}

/* ---- Decomposition and reconstruction ------------------------------------------------------------------ */

void bank_decompose(const struct bank *bank, const double *points, size_t components, double *coefficients,
                    double *workspace)
{
    size_t stride = bank->count * components;
    double *turns[2] = {workspace, workspace + stride}; /* coarse points of one step are the fine ones of the next */
    const double *fine = points;
    for (unsigned rung = bank->top; rung-- > bank->bottom;) {
        double *coarse = rung == bank->bottom ? coefficients : turns[rung % 2], *next = coarse;
        double *details = coefficients + bank_details_at(bank, rung) * components;
        const struct bank_step *steps = bank->steps[rung - bank->bottom];
        for (size_t c = 0; c < bank->ladder->chain_count; c++) {
            step_decompose(&steps[c], fine, components, coarse, details, workspace + 2 * stride);
            fine += steps[c].fine * components;
            coarse += steps[c].coarse * components;
            details += steps[c].details * components;
        }
        fine = next;
    }
    if (bank->top == bank->bottom)
        memcpy(coefficients, points, stride * sizeof *coefficients);
}

void bank_reconstruct(const struct bank *bank, const double *coefficients, size_t components, double *points,
                      double *workspace)
{
    size_t stride = bank->count * components;
    const double *coarse = coefficients;
    for (unsigned rung = bank->bottom; rung < bank->top; rung++) {
        const struct bank_step *steps = bank->steps[rung - bank->bottom];
        const double *details = coefficients + bank_details_at(bank, rung) * components;
        double *fine = rung + 1 == bank->top ? points : workspace + (rung % 2 ? stride : 0), *next = fine;
        for (size_t c = 0; c < bank->ladder->chain_count; c++) {
            step_reconstruct(&steps[c], coarse, details, components, fine);
            coarse += steps[c].coarse * components;
            details += steps[c].details * components;
            fine += steps[c].fine * components;
        }
        coarse = next;
    }
    if (bank->top == bank->bottom)
        memcpy(points, coefficients, stride * sizeof *points);
}

/* ---- The handle ---------------------------------------------------------------------------------------- */

struct bcifs_bank {
    struct arena arena;
    struct ladder ladder;
    struct bank bank;
    double *workspace; /* for so many: */
    size_t components;
};

static bcifs_status handle_make(bcifs_bank *handle, const bcifs_figure *figure, unsigned refine, unsigned coarsen,
                                struct report *report)
{
    struct ladder *ladder = &handle->ladder;
    bcifs_status status = ladder_create(ladder, figure, refine, coarsen, &handle->arena, report);
    if (status == BCIFS_OK)
        status = bank_create(&handle->bank, ladder, ladder->levels - coarsen, ladder->levels, &handle->arena, report);
    ladder->states.setting.report = NULL; /* it does not outlive this call */
    return status;
}

bcifs_status bcifs_bank_create(const bcifs_figure *figure, unsigned refine, unsigned coarsen, bcifs_bank **bank,
                               bcifs_error *error)
{
    struct report report = report_new(NULL);
    bcifs_bank *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? handle_make(fresh, figure, refine, coarsen, &report) : report_memory(&report);
    if (status == BCIFS_MEMORY && report.errors == 0)
        report_memory(&report);
    if (status) {
        bcifs_bank_free(fresh);
        report_close(&report, error);
        return status;
    }
    *bank = fresh;
    return BCIFS_OK;
}

void bcifs_bank_free(bcifs_bank *bank)
{
    if (!bank)
        return;
    memory_free(bank->workspace);
    arena_free(&bank->arena);
    memory_free(bank);
}

size_t bcifs_bank_points(const bcifs_bank *bank)
{
    return bank->bank.count;
}

size_t bcifs_bank_scale_points(const bcifs_bank *bank)
{
    return bank->bank.scale;
}

static bcifs_status memory_refuse(bcifs_error *error)
{
    struct report report = report_new(NULL);
    report_memory(&report);
    return report_close(&report, error);
}

bcifs_status bcifs_bank_figure_points(const bcifs_bank *bank, double *points, bcifs_error *error)
{
    return ladder_figure_points(&bank->ladder, NULL, points) ? memory_refuse(error) : BCIFS_OK;
}

typedef void conversion(const struct bank *bank, const double *from, size_t components, double *to,
                        double *workspace);

/* Fresh memory costs more than the arithmetic, so the workspace stays. */
static bcifs_status convert(bcifs_bank *bank, conversion *run, const double *from, unsigned dimension,
                            double *to, bcifs_error *error)
{
    if (dimension > bank->components) {
        double *grown = memory_resize(bank->workspace, BANK_WORKSPACE * bank->bank.count, dimension * sizeof *grown);
        if (!grown)
            return memory_refuse(error);
        bank->workspace = grown;
        bank->components = dimension;
    }
    run(&bank->bank, from, dimension, to, bank->workspace);
    return BCIFS_OK;
}

bcifs_status bcifs_bank_decompose(bcifs_bank *bank, const double *points, unsigned dimension,
                                  double *coefficients, bcifs_error *error)
{
    return convert(bank, bank_decompose, points, dimension, coefficients, error);
}

bcifs_status bcifs_bank_reconstruct(bcifs_bank *bank, const double *coefficients, unsigned dimension,
                                    double *points, bcifs_error *error)
{
    return convert(bank, bank_reconstruct, coefficients, dimension, points, error);
}
