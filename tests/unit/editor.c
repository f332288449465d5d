/* The answers of the area-true editor ([MR] 4; design, 6.5), on random curves of every scheme of the gallery:
 * the area is measured on the resulting figure and as the limit of polygons; the first-order conditions are
 * written out with dense matrices, the reconstruction of unit vectors; what must stay is compared bit for
 * bit; curves that are moved, turned and scaled have answers that are. */
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
    /* Dense, count × count: reconstruction (fine points × coefficients), and in coefficients the forms of
     * area and energy. */
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
    static const char *const names[FREE_SETS] = {"scale",  "all",  "near:1",      "near:2",
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
        edit->moves[i] =
            (bcifs_move){below(job->scale), size * random_number(&seed), size * random_number(&seed)};
    snprintf(edit->text, sizeof edit->text, "%s, alpha %g, move %zu", names[set], alpha,
             edit->moves[0].index);
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
        is_free[i] =
            c->free == BCIFS_FREE_ALL || (c->free == BCIFS_FREE_SCALE && i < job->scale) ||
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
static double gradient_error(const struct job *job, const struct edit *edit, const bool *is_free,
                             double lambda)
{
    const double *z = job->editor->coefficients[BCIFS_RESULT],
                 *c0 = job->editor->coefficients[BCIFS_DEFORMED];
    size_t n = job->count;
    double worst = 0, largest = 0, alpha = alpha_used(job, edit);
    for (size_t i = 0; i < n; i++) {
        if (!is_free[i])
            continue;
        double unit = 1 / sqrt(job->energy[i * n + i] + 2 * alpha);
        for (size_t c = 0; c < 2; c++) {
            double sum = 2 * alpha * (z[2 * i + c] - c0[2 * i + c]),
                   terms = fabs(sum) + 2 * alpha * fabs(z[2 * i + c]);
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

/* Whether K + λ/2 B is positive semidefinite on the free coefficients, K = H + 2α: elimination of the real
 * matrix (K, λ/2 M; -λ/2 M, K), each diagonal entry raised by a little. */
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

/* The area does not depend on any free coefficient: M_FF = 0 and the rows M_F z vanish, against what they
 * would be if nothing cancelled. */
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

static void complain(const struct curve_sample *sample, const struct edit *edit, const char *what,
                     double value)
{
    if (++tally.wrong <= 12)
        note("%s, %s: %s (%.3g)", sample->name, edit->text, what, value);
}

/* What is not free stays where the deformation put it; details do so in the fine points too. */
static void check_fixed(const struct curve_sample *sample, const struct job *job, const struct edit *edit,
                        const bool *is_free)
{
    const double *z = job->editor->coefficients[BCIFS_RESULT],
                 *c0 = job->editor->coefficients[BCIFS_DEFORMED],
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
    double size =
        fmax(extent(start, job->count), extent(fine, job->count)); /* an answer may shrink to a point */
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
        /* The Hermitian form B has the eigenvalues of a real antisymmetric matrix, which come in pairs ±μ:
         * every area is within reach unless it depends on nothing that is free. */
        if (status != BCIFS_NO || !is_insensitive(job, is_free))
            complain(sample, edit, error.message, status);
        return;
    }
    double *fine = read_points(job->editor, BCIFS_RESULT);
    double *start = read_points(job->editor, BCIFS_INITIAL);
    double reach =
        fmax(extent(start, job->count), extent(fine, job->count)); /* an answer may shrink to a point */
    double size = fmax(fabs(target), 0.01 * reach * reach);
    free(start);
    double after = area_of_stage(job->editor, BCIFS_RESULT), missed = fabs(after - target) / size;
    double gradient = gradient_error(job, edit, is_free, report.multiplier);
    free(fine);
    tally.area = fmax(tally.area, missed);
    tally.gradient = fmax(tally.gradient, gradient);
    tally.reported = fmax(tally.reported, report.relative_error);
    /* With α = 0 and all free an open curve may straighten into a long one, whose two ends the sum of
     * products of coordinates, which the area is, tells apart with that many fewer digits. */
    double tolerance = edit->constraint.alpha == 0 ? 1e-10 : 1e-12;
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
    note("%d curves, %d edits, %d refused; area missed by %.1e, gradient %.1e, reported error %.1e",
         tally.curves, tally.edits, tally.refused, tally.area, tally.gradient, tally.reported);
    ok(tally.curves >= 100, "every curve of the gallery that has an area is edited");
    ok(tally.wrong == 0, "the area is met, the first-order conditions hold, what is fixed stays");
}

/* ---- Areas as limits ----------------------------------------------------------------------------------- */

/* The shoelace formula on the limit points of depth `depth`, each path closed by its chord. */
static double polygon_area(const bcifs_figure *figure, unsigned depth)
{
    const bcifs_view view = {.depth = depth, .to = 1};
    bcifs_plan *plan = NULL;
    bcifs_walker *walker = NULL;
    if (bcifs_plan_create(figure, &view, &plan, NULL) || bcifs_walker_create(plan, &walker, NULL))
        return NAN;
    size_t count = (size_t)bcifs_plan_points(plan);
    double *points = calloc(2 * count + 2, sizeof *points), area = 0;
    count = bcifs_walker_next(walker, points, count);
    for (size_t p = 0; p < bcifs_plan_path_count(plan); p++) {
        bcifs_path path = bcifs_plan_path(plan, p);
        for (uint64_t i = 0; i < path.count; i++) {
            const double *a = points + 2 * (path.first + i),
                         *b = points + 2 * (path.first + (i + 1) % path.count);
            const double *o = points + 2 * path.first;
            area += ((a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1])) / 2;
        }
    }
    free(points);
    bcifs_walker_free(walker);
    bcifs_plan_free(plan);
    return area;
}

enum { MOST_TERMS = 12 };

/* How far a number is from the limit of a sequence whose errors are sums of geometric ones: extrapolated by
 * Wynn's epsilon algorithm, the best of its even columns, which remove one, two, three of them. */
static double limit_error(const double *terms, size_t count, double number)
{
    double odd[MOST_TERMS + 1] = {0}, even[MOST_TERMS], best = fabs(terms[count - 1] - number);
    memcpy(even, terms, count * sizeof *even);
    for (size_t length = count; length >= 3; length -= 2) {
        for (size_t i = 0; i + 1 < length; i++)
            odd[i] = odd[i + 1] + 1 / (even[i + 1] - even[i]);
        for (size_t i = 0; i + 2 < length; i++)
            even[i] = even[i + 1] + 1 / (odd[i + 1] - odd[i]);
        double error = fabs(even[length - 3] - number);
        best = isfinite(error) ? fmin(best, error) : best;
    }
    return best;
}

static int limits, limits_wrong;
static double limits_worst;

/* X M^L Y^T at every L, on the coefficients of one curve, and the limit of the polygons' areas. */
static void test_limit_of(const struct curve_sample *sample)
{
    double *points = calloc(2 * sample->count, sizeof *points), reference = NAN, size = 0;
    curve_points(sample, 0.3, &seed, points);
    for (unsigned coarsen = 0; coarsen <= 2; coarsen++) {
        struct job job;
        if (!job_open(&job, sample, points, (bcifs_editor_options){2, coarsen, BCIFS_NO_ENERGY}, false))
            break;
        double area = form_area(&job.editor->level->area, job.editor->coefficients[BCIFS_RESULT]);
        if (coarsen == 0) {
            double terms[MOST_TERMS];
            unsigned most = bcifs_figure_depth(job.figure, 30000), first = most > 10 ? most - 9 : 1;
            for (unsigned depth = first; depth <= most; depth++)
                terms[depth - first] = polygon_area(job.figure, depth);
            size = extent(job.editor->fine[BCIFS_RESULT], job.count);
            size *= size;
            reference = area;
            double error = limit_error(terms, most - first + 1, area) / size;
            limits++;
            limits_worst = fmax(limits_worst, error);
            if (!(error <= 1e-9) && ++limits_wrong)
                note("%s: the area %.15g, of polygons %.15g, %g from their limit", sample->name, area,
                     terms[most - first], error);
        }
        if (!(fabs(area - reference) <= 1e-13 * size) && ++limits_wrong)
            note("%s: the area %.17g, from %u levels above %.17g", sample->name, reference, coarsen, area);
        job_close(&job);
    }
    free(points);
}

static void test_limits(void)
{
    for (long round = 0; round < test_effort(1); round++)
        curves_each(test_limit_of);
    ok(limits >= 30 && limits_wrong == 0,
       "M^L gives one area at every L, the limit of polygons (%d curves, %.1e)", limits, limits_worst);
}

/* Von Koch's snowflake: 8/5 of its triangle, of side 1, run through clockwise. */
static void test_snowflake(void)
{
    bcifs_automaton *automaton = NULL;
    bcifs_load("automata/koch.bcifs", NULL, &automaton, NULL);
    bcifs_figure *figure = NULL;
    bcifs_figure_create(automaton, &(bcifs_figure_options){.figure = "snowflake"}, &figure, NULL);
    for (unsigned levels = 0; levels <= 2; levels++) {
        bcifs_editor *editor = NULL;
        bcifs_edit_report report = {0};
        bcifs_editor_create(figure, &(bcifs_editor_options){2, levels, BCIFS_DIFFERENCE}, &editor, NULL);
        if (editor)
            bcifs_editor_report(editor, &report);
        ok(fabs(fabs(report.before) - 8.0 / 5 * sqrt(3) / 4) < 1e-14,
           "the snowflake's area, from %u levels above", levels);
        bcifs_editor_free(editor);
    }
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
}

/* ---- What alpha does ----------------------------------------------------------------------------------- */

static int alphas_tried, alphas_wrong;

static double square_distance(const double *a, const double *b, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < 2 * count; i++)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
}

/* Of minimizers of E + α D, E rises and D falls with α. With α large the answer is the point of the right
 * area that is nearest to what the user did: it is no farther away than the correction needs, |A - target| /
 * |gradient of A|, up to the square of that. With α small the energy is below the deformed curve's. */
static void test_alphas_of(const struct curve_sample *sample)
{
    static const double alphas[] = {1e-8, 1e-4, 1e-2, 1, 100, 1e6};
    double *points = calloc(2 * sample->count, sizeof *points), size = extent(sample->points, sample->count);
    curve_points(sample, 0.1, &seed, points);
    struct job job;
    struct edit edit;
    bool open = job_open(&job, sample, points, (bcifs_editor_options){1, 1, BCIFS_BENDING}, true);
    free(points);
    if (!open)
        return;
    edit_make(&edit, &job, below(2), 1, 0.05 * size);
    double energy = -1, away = INFINITY, deformed = 0;
    for (size_t k = 0; k < 6; k++) {
        bcifs_edit_report report;
        bcifs_error error;
        edit.constraint.alpha = alphas[k];
        if (edit_run(job.editor, &edit, &error))
            break;
        bcifs_editor_report(job.editor, &report);
        const double *c0 = job.editor->coefficients[BCIFS_DEFORMED],
                     *z = job.editor->coefficients[BCIFS_RESULT];
        double farther = square_distance(z, c0, job.count);
        deformed = report.energy_deformed;
        alphas_tried++;
        /* Where the curve collapses or stretches, what is lost is a share of the deformed curve's energy. */
        double rounding = 1e-9 * (fabs(deformed) + report.energy_after),
               apart = 1e-9 * (farther + size * size);
        if ((report.energy_after < energy - rounding || farther > away + apart) && ++alphas_wrong)
            note("%s, %s: energy %.15g after %.15g, distance %.15g after %.15g", sample->name, edit.text,
                 report.energy_after, energy, farther, away);
        /* Making an area larger may cost energy whatever is done. */
        bool shrinks = report.target / report.deformed >= 0 && report.target / report.deformed <= 1;
        if (k == 0 && shrinks && edit.constraint.free == BCIFS_FREE_ALL &&
            !(report.energy_after <= deformed + rounding) && ++alphas_wrong)
            note("%s, %s: energy %g, deformed %g", sample->name, edit.text, report.energy_after, deformed);
        if (k == 5) {
            double gradient = 0, missing = report.deformed - report.target;
            for (size_t i = 0; i < (edit.constraint.free == BCIFS_FREE_ALL ? job.count : job.scale); i++) {
                double x = 0, y = 0;
                for (size_t j = 0; j < job.count; j++) {
                    x += job.area[i * job.count + j] * c0[2 * j];
                    y += job.area[i * job.count + j] * c0[2 * j + 1];
                }
                gradient += (x * x + y * y) / 4;
            }
            double needed = fabs(missing) / sqrt(gradient);
            if (!(sqrt(farther) <= needed * (1 + needed / size * 10) + 1e-3 * size) && ++alphas_wrong)
                note("%s, %s: %g away, %g would do", sample->name, edit.text, sqrt(farther), needed);
        }
        energy = report.energy_after;
        away = farther;
        bcifs_editor_undo(job.editor);
    }
    job_close(&job);
}

static void test_alphas(void)
{
    for (long round = 0; round < test_effort(1); round++)
        curves_each(test_alphas_of);
    ok(alphas_tried >= 200 && alphas_wrong == 0,
       "energy rises and distance falls with alpha, to the least that the area needs");
}

/* ---- Curves that are moved, turned and scaled ---------------------------------------------------------- */

/* p -> scale (cosine -sine; sine cosine) p + to. */
struct similarity {
    double scale, cosine, sine, x, y, tolerance;
    const char *name;
};

static void transform(const struct similarity *by, const double *from, size_t count, double *to)
{
    for (size_t i = 0; i < count; i++) {
        double x = from[2 * i], y = from[2 * i + 1];
        to[2 * i] = by->scale * (by->cosine * x - by->sine * y) + by->x;
        to[2 * i + 1] = by->scale * (by->sine * x + by->cosine * y) + by->y;
    }
}

static int similarities, similarities_wrong;

static void test_similar(const struct curve_sample *sample, const struct similarity *by, bcifs_energy energy,
                         size_t set, double alpha)
{
    double *points = calloc(2 * sample->count, sizeof *points),
           *images = calloc(2 * sample->count, sizeof *images);
    double size = extent(sample->points, sample->count);
    const bcifs_editor_options options = {1, 1, energy};
    struct job job = {0}, image = {0};
    curve_points(sample, 0.2, &seed, points);
    transform(by, points, sample->count, images);
    if (job_open(&job, sample, points, options, false)) {
        if (job_open(&image, sample, images, options, false)) {
            struct edit edit;
            bcifs_error error = {.message = ""};
            edit_make(&edit, &job, set, alpha, 0.2 * size);
            bcifs_status status = edit_run(job.editor, &edit, &error);
            for (size_t i = 0; i < edit.move_count; i++) {
                struct similarity linear = *by;
                linear.x = linear.y = 0;
                double move[2] = {edit.moves[i].dx, edit.moves[i].dy};
                transform(&linear, move, 1, move);
                edit.moves[i].dx = move[0];
                edit.moves[i].dy = move[1];
            }
            bcifs_status other = edit_run(image.editor, &edit, &error);
            double *result = read_points(job.editor, BCIFS_RESULT),
                   *moved = read_points(image.editor, BCIFS_RESULT);
            double reach = extent(result, job.count), worst = 0;
            transform(by, result, job.count, result);
            for (size_t i = 0; i < 2 * job.count; i++)
                worst = isfinite(moved[i]) ? fmax(worst, fabs(moved[i] - result[i]) / by->scale / reach)
                                           : INFINITY;
            similarities++;
            if ((status != other || !(worst <= by->tolerance)) && ++similarities_wrong <= 12)
                note("%s, %s, %s: status %d and %d, %g apart %s", sample->name, by->name, edit.text, status,
                     other, worst, error.message);
            free(result);
            free(moved);
            job_close(&image);
        } else if (++similarities_wrong <= 12) {
            note("%s, %s: no editor", sample->name, by->name);
        }
        job_close(&job);
    }
    free(points);
    free(images);
}

static void test_similar_all(const struct curve_sample *sample)
{
    const double angle = 1;
    const struct similarity list[] = {
        {1, 1, 0, 3, -5, 1e-8, "moved"},
        {1, cos(angle), sin(angle), 0, 0, 1e-8, "turned"},
        {7, 1, 0, 0, 0, 1e-8, "scaled"},
        {0x1p20, 1, 0, 0, 0, 0, "times 2^20"},
        {0x1p-30, 1, 0, 0, 0, 0, "times 2^-30"},
        {1e6, cos(angle), sin(angle), 1e5, -1e5, 1e-8, "all at once"},
        {1, 1, 0, 1e6, -1e6, 1e-6, "far away"},
        {1e150, 1, 0, 0, 0, 1e-8, "times 1e150"},
        {1e-150, 1, 0, 0, 0, 1e-8, "times 1e-150"},
    };
    static const bcifs_energy energies[] = {BCIFS_BENDING, BCIFS_DIFFERENCE, BCIFS_NO_ENERGY};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        test_similar(sample, &list[i], energies[below(3)], below(FREE_SETS),
                     pow(10, 2 * random_number(&seed)));
}

static void test_similarities(void)
{
    for (long round = 0; round < test_effort(1); round++)
        curves_each(test_similar_all);
    ok(similarities >= 300 && similarities_wrong == 0,
       "a curve that is moved, turned, scaled has an answer that is (%d edits)", similarities);
}

/* ---- Degenerate curves --------------------------------------------------------------------------------- */

static int degenerate, degenerate_wrong;

/* All points equal, or on one line: the area is 0 and stays so, or is made what is wanted. */
static void test_degenerate_of(const struct curve_sample *sample)
{
    double *points = calloc(2 * sample->count, sizeof *points);
    for (int kind = 0; kind < 3; kind++) {
        for (size_t i = 0; i < sample->count; i++) {
            points[2 * i] = kind == 0 ? 0 : kind == 1 ? 3 : (double)(i % 5);
            points[2 * i + 1] = kind == 0 ? 0 : kind == 1 ? -1e3 : 2 * points[2 * i] + 1;
        }
        for (size_t set = 0; set < FREE_SETS; set++) {
            struct job job;
            if (!job_open(&job, sample, points, (bcifs_editor_options){1, 1, BCIFS_BENDING}, false))
                continue;
            struct edit edit;
            bcifs_error error = {.message = ""};
            bcifs_edit_report report;
            edit_make(&edit, &job, set, 1, 1);
            edit.move_count = set % 3;
            edit.move_count = edit.move_count > 2 ? 2 : edit.move_count;
            edit.constraint.has_target = set % 2;
            edit.constraint.target = 2.5;
            bcifs_status status = edit_run(job.editor, &edit, &error);
            bcifs_editor_report(job.editor, &report);
            double *result = read_points(job.editor, BCIFS_RESULT);
            bool finite = true;
            for (size_t i = 0; i < 2 * job.count; i++)
                finite = finite && isfinite(result[i]);
            degenerate++;
            bool reached = fabs(area_of_stage(job.editor, BCIFS_RESULT) - report.target) <= 1e-11;
            if (!(finite && (status == BCIFS_NO ||
                             (status == BCIFS_OK && reached && report.relative_error <= 1e-11))) &&
                ++degenerate_wrong <= 12)
                note("%s, kind %d, %s: status %d, area %g of %g, error %g, finite %d %s", sample->name, kind,
                     edit.text, status, report.after, report.target, report.relative_error, finite,
                     error.message);
            free(result);
            job_close(&job);
        }
    }
    free(points);
}

static void test_degenerate(void)
{
    for (long round = 0; round < test_effort(1); round++)
        curves_each(test_degenerate_of);
    ok(degenerate >= 500 && degenerate_wrong == 0, "points that are all the same or in line (%d edits)",
       degenerate);
}

int main(void)
{
    test_answers();
    test_limits();
    test_snowflake();
    test_alphas();
    test_similarities();
    test_degenerate();
    return done_testing();
}
