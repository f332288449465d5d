/* The answers of the area-true editor ([MR] 4; design, 6.5), on random curves of every scheme of the gallery: the area
 * is measured on the resulting figure and as the limit of polygons; the first-order conditions are written out with
 * dense matrices, the reconstruction of unit vectors; what must stay is compared bit for bit; curves that are moved,
 * turned and scaled have answers that are. */
#include <float.h>
#include <time.h>

#include "curves.h"
#include "multires/editor.h"

static uint64_t seed = 11;

static size_t below(size_t limit)
{
    return (size_t)(random_bits(&seed) % limit);
}

/* ---- One curve under edit ------------------------------------------------------------------------------ */

struct job {
    bcifs_figure *figure;
    bcifs_editor *editor;
    size_t count, scale;
    /* Dense, count × count: reconstruction (fine points × coefficients), and in coefficients the forms of area and
     * energy. */
    double *synthesis, *area, *energy;
};

/* form = S^T F S, F given sparse. */
static void form_dense(const struct sparse *fine, const double *s, size_t n, double *form)
{
    double *half = calloc(n * n, sizeof *half);
    for (size_t i = 0; i < fine->rows; i++)
        for (size_t k = fine->starts[i]; k < fine->starts[i + 1]; k++)
            for (size_t j = 0; j < n; j++)
                half[i * n + j] += fine->values[k] * s[fine->columns[k] * n + j];
    for (size_t r = 0; r < n; r++)
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; s[r * n + i] != 0 && j < n; j++)
                form[i * n + j] += s[r * n + i] * half[r * n + j];
    free(half);
}

static void job_close(struct job *job)
{
    bcifs_editor_free(job->editor);
    bcifs_figure_free(job->figure);
    free(job->synthesis);
    free(job->area);
    free(job->energy);
}

/* Columns of the synthesis by the public bank, not by the editor's own. */
static bool synthesis_fill(struct job *job, unsigned refine, unsigned coarsen)
{
    bcifs_bank *bank = NULL;
    size_t n = job->count;
    double *unit = calloc(n, sizeof *unit), *column = calloc(n, sizeof *column);
    bool made = bcifs_bank_create(job->figure, refine, coarsen, &bank, NULL) == BCIFS_OK;
    for (size_t j = 0; made && j < n; j++) {
        unit[j] = 1;
        made = bcifs_bank_reconstruct(bank, unit, 1, column, NULL) == BCIFS_OK;
        unit[j] = 0;
        for (size_t i = 0; i < n; i++)
            job->synthesis[i * n + j] = column[i];
    }
    bcifs_bank_free(bank);
    free(unit);
    free(column);
    return made;
}

/* False, with nothing to be closed, for curves without an editor. */
static bool job_open(struct job *job, const struct curve_sample *sample, const double *points,
                     bcifs_editor_options options, bool dense)
{
    *job = (struct job){.figure = curve_figure(sample, points)};
    bcifs_error error;
    if (job->figure && bcifs_editor_create(job->figure, &options, &job->editor, &error) == BCIFS_OK &&
        !job->editor->level->area_reason) {
        size_t n = job->count = bcifs_editor_points(job->editor);
        job->scale = bcifs_editor_scale_points(job->editor);
        if (!dense)
            return true;
        job->synthesis = calloc(n * n, sizeof(double));
        job->area = calloc(n * n, sizeof(double));
        job->energy = calloc(n * n, sizeof(double));
        if (synthesis_fill(job, options.refine, options.coarsen)) {
            form_dense(&job->editor->level->fine_area, job->synthesis, n, job->area);
            form_dense(&job->editor->level->fine_energy, job->synthesis, n, job->energy);
            return true;
        }
    }
    job_close(job);
    return false;
}

static double *read_points(const bcifs_editor *editor, bcifs_stage stage)
{
    double *points = calloc(2 * bcifs_editor_points(editor), sizeof *points);
    bcifs_editor_read(editor, stage, points);
    return points;
}

/* The largest coordinate, about the first point. */
static double extent(const double *points, size_t count)
{
    double size = 0;
    for (size_t i = 0; i < 2 * count; i++)
        size = fmax(size, fabs(points[i] - points[i % 2]));
    return size;
}

/* The area that `bcifs area` finds of a stage; NAN when it does not. */
static double area_of_stage(const bcifs_editor *editor, bcifs_stage stage)
{
    bcifs_figure *figure = NULL;
    bcifs_area *area = NULL;
    double value = NAN;
    if (bcifs_editor_figure(editor, stage, 0, &figure, NULL) == BCIFS_OK &&
        bcifs_area_create(figure, &area, NULL) == BCIFS_OK)
        value = bcifs_area_value(area);
    bcifs_area_free(area);
    bcifs_figure_free(figure);
    return value;
}

/* ---- Constraints --------------------------------------------------------------------------------------- */

enum { MOST_LISTED = 4, FREE_SETS = 8 };

struct edit {
    bcifs_constraint constraint;
    size_t list[MOST_LISTED], pins[2];
    bcifs_move moves[2];
    size_t move_count;
    char text[100];
};

/* scale, all, near:1, near:2, near:5, list, and pins with scale and with all. */
static void edit_make(struct edit *edit, const struct job *job, size_t set, double alpha, double size)
{
    static const char *const names[FREE_SETS] = {"scale",  "all",  "near:1",     "near:2",
                                                 "near:5", "list", "scale, pins", "all, pins"};
    static const size_t neighbors[FREE_SETS] = {0, 0, 1, 2, 5, 0, 0, 0};
    *edit = (struct edit){.constraint = {.keep_area = 1, .alpha = alpha}};
    bcifs_constraint *constraint = &edit->constraint;
    constraint->free = set == 1 || set == 7 ? BCIFS_FREE_ALL
                       : neighbors[set]     ? BCIFS_FREE_NEAR
                       : set == 5           ? BCIFS_FREE_LIST
                                            : BCIFS_FREE_SCALE;
    constraint->neighbors = neighbors[set];
    constraint->list = edit->list;
    constraint->pins = edit->pins;
    constraint->list_count = set == 5 ? MOST_LISTED : 0;
    constraint->pin_count = set >= 6 ? 2 : 0;
    for (size_t i = 0; i < MOST_LISTED; i++)
        edit->list[i] = below(job->scale);
    for (size_t i = 0; i < 2; i++)
        edit->pins[i] = below(job->scale);
    edit->move_count = 1 + below(2);
    for (size_t i = 0; i < edit->move_count; i++)
        edit->moves[i] = (bcifs_move){below(job->scale), size * random_number(&seed), size * random_number(&seed)};
    snprintf(edit->text, sizeof edit->text, "%s, alpha %g, move %zu", names[set], alpha, edit->moves[0].index);
}

static bcifs_status edit_run(bcifs_editor *editor, const struct edit *edit, bcifs_error *error)
{
    bcifs_status status = bcifs_editor_constrain(editor, &edit->constraint, error);
    return status ? status : bcifs_editor_move(editor, edit->moves, edit->move_count, error);
}

static bool is_moved(const struct edit *edit, size_t index)
{
    for (size_t i = 0; i < edit->move_count; i++)
        if (edit->moves[i].index == index)
            return true;
    return false;
}

/* Whether `index` is within `neighbors` steps of a moved point on its chain. */
static bool is_near(const struct job *job, const struct edit *edit, size_t index)
{
    const struct ladder *ladder = &job->editor->level->ladder;
    size_t base = 0, k = edit->constraint.neighbors;
    for (size_t c = 0; c < ladder->chain_count; c++) {
        size_t points = ladder->chains[c].rungs[job->editor->level->bank.bottom].points;
        for (size_t i = 0; i < edit->move_count; i++) {
            size_t moved = edit->moves[i].index;
            if (moved < base || moved >= base + points || index < base || index >= base + points)
                continue;
            size_t apart = moved > index ? moved - index : index - moved;
            if (apart <= k || (ladder->chains[c].closed && points - apart <= k))
                return true;
        }
        base += points;
    }
    return false;
}

/* What the header says is free. */
static void free_fill(const struct job *job, const struct edit *edit, bool *is_free)
{
    const bcifs_constraint *c = &edit->constraint;
    for (size_t i = 0; i < job->count; i++)
        is_free[i] = c->free == BCIFS_FREE_ALL || (c->free == BCIFS_FREE_SCALE && i < job->scale) ||
                     (c->free == BCIFS_FREE_NEAR && i < job->scale && !is_moved(edit, i) && is_near(job, edit, i));
    for (size_t i = 0; i < c->list_count; i++)
        is_free[c->list[i]] = true;
    for (size_t i = 0; i < c->pin_count; i++)
        is_free[c->pins[i]] = false;
}

/* ---- The first-order conditions ------------------------------------------------------------------------ */

/* α, and what stands for it where nothing else would give a scale (multires/deform.h). */
static double alpha_used(const struct job *job, const struct edit *edit)
{
    double largest = 0;
    for (size_t i = 0; i < job->count; i++)
        largest = fmax(largest, job->energy[i * job->count + i]);
    return edit->constraint.alpha == 0 && largest == 0 ? 1 : edit->constraint.alpha;
}

/* The gradient H z + 2α (z - c0) + λ/2 (M y, -M x) on the free coefficients, against the sum of its terms. */
static double gradient_error(const struct job *job, const struct edit *edit, const bool *is_free, double lambda)
{
    const double *z = job->editor->coefficients[BCIFS_RESULT], *c0 = job->editor->coefficients[BCIFS_DEFORMED];
    size_t n = job->count;
    double worst = 0, largest = 0, alpha = alpha_used(job, edit);
    for (size_t i = 0; i < n; i++) {
        if (!is_free[i])
            continue;
        double unit = 1 / sqrt(job->energy[i * n + i] + 2 * alpha);
        for (size_t c = 0; c < 2; c++) {
            double sum = 2 * alpha * (z[2 * i + c] - c0[2 * i + c]), terms = fabs(sum) + 2 * alpha * fabs(z[2 * i + c]);
            for (size_t j = 0; j < n; j++) {
                double h = job->energy[i * n + j] * z[2 * j + c];
                double m = (c == 0 ? 1 : -1) * lambda / 2 * job->area[i * n + j] * z[2 * j + 1 - c];
                sum += h + m;
                terms += fabs(h) + fabs(m);
            }
            worst = fmax(worst, fabs(sum) * unit);
            largest = fmax(largest, terms * unit);
        }
    }
    return worst > 0 ? worst / largest : 0;
}

/* Whether K + λ/2 B is positive semidefinite on the free coefficients, K = H + 2α: elimination of the real matrix
 * (K, λ/2 M; -λ/2 M, K), each diagonal entry raised by a little. */
static bool is_global(const struct job *job, const struct edit *edit, const bool *is_free, double lambda)
{
    size_t n = job->count, f = 0, *list = calloc(n, sizeof *list);
    double alpha = alpha_used(job, edit);
    for (size_t i = 0; i < n; i++)
        if (is_free[i])
            list[f++] = i;
    double *a = calloc(4 * f * f + 1, sizeof *a);
    for (size_t p = 0; p < f; p++)
        for (size_t q = 0; q < f; q++) {
            double k = job->energy[list[p] * n + list[q]] + (p == q ? 2 * alpha : 0);
            double m = lambda / 2 * job->area[list[p] * n + list[q]];
            a[p * 2 * f + q] = a[(f + p) * 2 * f + f + q] = k * (p == q ? 1 + 1e-8 : 1);
            a[p * 2 * f + f + q] = m;
            a[(f + p) * 2 * f + q] = -m;
        }
    bool definite = true;
    for (size_t k = 0; k < 2 * f && definite; k++) {
        definite = a[k * 2 * f + k] > 0;
        for (size_t i = k + 1; i < 2 * f && definite; i++) {
            double factor = a[i * 2 * f + k] / a[k * 2 * f + k];
            for (size_t j = k; j < 2 * f && factor != 0; j++)
                a[i * 2 * f + j] -= factor * a[k * 2 * f + j];
        }
    }
    free(list);
    free(a);
    return definite;
}

/* The area does not depend on any free coefficient: M_FF = 0 and the rows M_F z vanish, against what they would be
 * if nothing cancelled. */
static bool is_insensitive(const struct job *job, const bool *is_free)
{
    const double *z = job->editor->coefficients[BCIFS_DEFORMED];
    size_t n = job->count;
    double reach = 0;
    for (size_t i = 0; i < 2 * n; i++)
        reach = fmax(reach, fabs(z[i]));
    for (size_t i = 0; i < n; i++) {
        double x = 0, y = 0, sum = 0;
        for (size_t j = 0; j < n && is_free[i]; j++) {
            double m = job->area[i * n + j];
            if (is_free[j] && fabs(m) > 1e-13)
                return false;
            x += m * z[2 * j];
            y += m * z[2 * j + 1];
            sum += fabs(m);
        }
        if (fabs(x) + fabs(y) > 1e-13 * sum * reach)
            return false;
    }
    return true;
}

/* ---- Every scheme, every free set ---------------------------------------------------------------------- */

static struct tally {
    int curves, edits, refused, wrong;
    double area, gradient, reported;
} tally;

static void complain(const struct curve_sample *sample, const struct edit *edit, const char *what, double value)
{
    if (++tally.wrong <= 12)
        note("%s, %s: %s (%.3g)", sample->name, edit->text, what, value);
}

/* What is not free stays where the deformation put it; details do so in the fine points too. */
static void check_fixed(const struct curve_sample *sample, const struct job *job, const struct edit *edit,
                        const bool *is_free)
{
    const double *z = job->editor->coefficients[BCIFS_RESULT], *c0 = job->editor->coefficients[BCIFS_DEFORMED],
                 *before = job->editor->coefficients[BCIFS_INITIAL];
    for (size_t i = 0; i < job->count; i++) {
        if (!is_free[i] && memcmp(z + 2 * i, c0 + 2 * i, 2 * sizeof *z) != 0)
            complain(sample, edit, "a coefficient that is not free has changed", (double)i);
        if (i >= job->scale && memcmp(before + 2 * i, c0 + 2 * i, 2 * sizeof *z) != 0)
            complain(sample, edit, "the deformation changed a detail", (double)i);
    }
    /* The fine points are those of the coefficients. */
    double *fine = read_points(job->editor, BCIFS_RESULT), worst = 0;
    for (size_t i = 0; i < job->count; i++)
        for (size_t c = 0; c < 2; c++) {
            double sum = job->editor->center[c];
            for (size_t j = 0; j < job->count; j++)
                sum += job->synthesis[i * job->count + j] * z[2 * j + c];
            worst = fmax(worst, fabs(sum - fine[2 * i + c]));
        }
    double *start = read_points(job->editor, BCIFS_INITIAL);
    double size = fmax(extent(start, job->count), extent(fine, job->count)); /* an answer may shrink to a point */
    free(start);
    if (!(worst <= 1e-12 * size))
        complain(sample, edit, "fine points are not those of the coefficients", worst / size);
    free(fine);
}

static void check_edit(const struct curve_sample *sample, struct job *job, const struct edit *edit)
{
    bcifs_error error;
    bool is_free[1024] = {false};
    double before = area_of_stage(job->editor, BCIFS_RESULT);
    double target = edit->constraint.has_target ? edit->constraint.target : before;
    bcifs_status status = edit_run(job->editor, edit, &error);
    bcifs_edit_report report;
    bcifs_editor_report(job->editor, &report);
    free_fill(job, edit, is_free);
    tally.edits++;
    if (status) {
        tally.refused++;
        /* The Hermitian form B has the eigenvalues of a real antisymmetric matrix, which come in pairs ±μ: every area
         * is within reach unless it depends on nothing that is free. */
        if (status != BCIFS_NO || !is_insensitive(job, is_free))
            complain(sample, edit, error.message, status);
        return;
    }
    double *fine = read_points(job->editor, BCIFS_RESULT);
    double *start = read_points(job->editor, BCIFS_INITIAL);
    double reach = fmax(extent(start, job->count), extent(fine, job->count)); /* an answer may shrink to a point */
    double size = fmax(fabs(target), 0.01 * reach * reach);
    free(start);
    double after = area_of_stage(job->editor, BCIFS_RESULT), missed = fabs(after - target) / size;
    double gradient = gradient_error(job, edit, is_free, report.multiplier);
    free(fine);
    tally.area = fmax(tally.area, missed);
    tally.gradient = fmax(tally.gradient, gradient);
    tally.reported = fmax(tally.reported, report.relative_error);
    /* With α = 0 and all free an open curve may straighten into a long one, whose two ends the sum of products of
     * coordinates, which the area is, tells apart with that many fewer digits. */
    double tolerance = edit->constraint.alpha == 0 ? 2e-11 : 1e-12;
    if (!(missed <= tolerance))
        complain(sample, edit, "the area is missed", missed);
    if (!(fabs(report.before - before) <= 1e-12 * size && fabs(report.after - after) <= tolerance * size &&
          fabs(report.target - target) <= 1e-12 * size && report.relative_error <= tolerance))
        complain(sample, edit, "the report differs", report.relative_error);
    if (!(gradient <= 1e-9))
        complain(sample, edit, "the gradient does not vanish", gradient);
    if (report.global && below(8) == 0 && !is_global(job, edit, is_free, report.multiplier))
        complain(sample, edit, "the answer is not the global minimum", report.multiplier);
    check_fixed(sample, job, edit, is_free);
}

static void test_sample(const struct curve_sample *sample)
{
    static const double alphas[] = {0, 1e-6, 1e-3, 1, 100, 1e4, 1e6};
    static const bcifs_energy energies[] = {BCIFS_BENDING, BCIFS_DIFFERENCE, BCIFS_NO_ENERGY};
    double *points = calloc(2 * sample->count, sizeof *points);
    for (size_t round = 0; round < 3; round++) {
        struct job job;
        unsigned levels = 1 + (unsigned)below(sample->count > 10 ? 2 : 3);
        curve_points(sample, round == 0 ? 0 : 0.2, &seed, points);
        if (!job_open(&job, sample, points, (bcifs_editor_options){levels, levels, energies[round]}, false))
            break;
        size_t count = job.count;
        job_close(&job);
        if (count > 200)
            levels = 1;
        if (!job_open(&job, sample, points, (bcifs_editor_options){levels, levels, energies[round]}, true))
            break;
        tally.curves++;
        double size = extent(sample->points, sample->count);
        for (size_t set = 0; set < FREE_SETS; set++) {
            struct edit edit;
            edit_make(&edit, &job, set, alphas[below(7)], 0.3 * size);
            if (below(4) == 0) {
                edit.constraint.has_target = 1;
                edit.constraint.target = size * size * random_number(&seed);
            }
            check_edit(sample, &job, &edit);
            bcifs_editor_undo(job.editor);
        }
        job_close(&job);
    }
    free(points);
}

static void test_answers(void)
{
    for (long round = 0; round < test_effort(1); round++)
        curves_each(test_sample);
    note("%d curves, %d edits, %d refused; area missed by %.1e, gradient %.1e, reported error %.1e", tally.curves,
         tally.edits, tally.refused, tally.area, tally.gradient, tally.reported);
    ok(tally.curves >= 100, "every curve of the gallery that has an area is edited");
    ok(tally.wrong == 0, "the area is met, the first-order conditions hold, what is fixed stays");
}

int main(void)
{
    test_answers();
    return done_testing();
}
