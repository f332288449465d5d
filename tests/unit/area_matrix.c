/* Area matrices of all levels: the area of any curve is the same in the coefficients of every level; entries against dense
 * products with the matrix of the reconstruction; block A is the mother matrix of the coarse curve; antisymmetry. */
#include <time.h>

#include "curves.h"

enum { MOST_REFINED = 3, MOST_DENSE = 160 };

static int tested, refused;
static double worst_value, worst_area, worst_entry, worst_block;
static bool antisymmetric = true, parted = true;

/* The larger one; what is no number is worst of all. */
static double worse(double a, double b)
{
    return isnan(a) || a >= b ? a : b;
}

/* ---- One curve ----------------------------------------------------------------------------------------- */

/* Σ |x_i m_ij y_j|, what a value's rounding is a share of. */
static double value_terms(const bcifs_area_matrix *matrix, const double *coefficients)
{
    size_t count = bcifs_area_matrix_entries(matrix, NULL, NULL, NULL);
    size_t *rows = calloc(count, sizeof *rows), *columns = calloc(count, sizeof *columns);
    double *values = calloc(count, sizeof *values), sum = 0;
    bcifs_area_matrix_entries(matrix, rows, columns, values);
    for (size_t k = 0; k < count; k++)
        sum += fabs(coefficients[2 * rows[k]] * values[k] * coefficients[2 * columns[k] + 1]);
    free(rows);
    free(columns);
    free(values);
    return sum;
}

static void check_antisymmetry(const bcifs_area_matrix *matrix, const char *name)
{
    size_t count = bcifs_area_matrix_entries(matrix, NULL, NULL, NULL), last = 0;
    size_t *rows = calloc(count, sizeof *rows), *columns = calloc(count, sizeof *columns);
    double *values = calloc(count, sizeof *values);
    bcifs_area_matrix_entries(matrix, rows, columns, values);
    bool good = true;
    for (size_t k = 0; k < count; k++) {
        size_t place = rows[k] * bcifs_area_matrix_size(matrix) + columns[k];
        good = good && values[k] != 0 && values[k] == bcifs_area_matrix_entry(matrix, rows[k], columns[k]) &&
               values[k] == -bcifs_area_matrix_entry(matrix, columns[k], rows[k]) && (k == 0 || place > last);
        last = place;
    }
    if (!good)
        note("%s, level %u: not antisymmetric, or not in order", name, bcifs_area_matrix_level(matrix, NULL));
    antisymmetric = antisymmetric && good;
    free(rows);
    free(columns);
    free(values);
}

/* M^L = R^T M^n R, R holding what each coefficient alone is reconstructed to. */
static void check_entries(const bcifs_area_matrix *matrix, const bcifs_area_matrix *mother, bcifs_bank *bank,
                          const char *name)
{
    size_t n = bcifs_area_matrix_size(matrix);
    double *r = calloc(n * n, sizeof *r), *product = calloc(n * n, sizeof *product), *unit = calloc(n, sizeof *unit),
           *column = calloc(n, sizeof *column), worst = 0, largest = 0;
    for (size_t j = 0; j < n; j++) {
        unit[j] = 1;
        bcifs_bank_reconstruct(bank, unit, 1, column, NULL);
        unit[j] = 0;
        for (size_t i = 0; i < n; i++)
            r[i * n + j] = column[i];
    }
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < n; k++) {
            double entry = bcifs_area_matrix_entry(mother, i, k);
            for (size_t j = 0; entry != 0 && j < n; j++)
                product[i * n + j] += entry * r[k * n + j];
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            double sum = 0;
            for (size_t k = 0; k < n; k++)
                sum += r[k * n + i] * product[k * n + j];
            largest = fmax(largest, fabs(sum));
            worst = fmax(worst, fabs(sum - bcifs_area_matrix_entry(matrix, i, j)));
        }
    if (!(worst <= 1e-11 * largest))
        note("%s, level %u: an entry differs by %g of %g", name, bcifs_area_matrix_level(matrix, NULL), worst, largest);
    worst_entry = worse(worst_entry, worst / largest);
    free(r);
    free(product);
    free(unit);
    free(column);
}

/* I(φ^L, φ^L) is the form of the coarse polygon itself, whatever it is subdivided to. */
static void check_block(const bcifs_area_matrix *matrix, const bcifs_figure *figure, unsigned refine, const char *name)
{
    bcifs_area_matrix *coarse = NULL;
    size_t scale = bcifs_area_matrix_scale_points(matrix);
    double worst = 0, largest = 0;
    if (bcifs_area_matrix_create(figure, refine, 0, &coarse, NULL) || bcifs_area_matrix_size(coarse) != scale) {
        worst = INFINITY;
        scale = 0;
    }
    for (size_t i = 0; i < scale; i++)
        for (size_t j = 0; j < scale; j++) {
            double entry = bcifs_area_matrix_entry(coarse, i, j);
            largest = fmax(largest, fabs(entry));
            worst = fmax(worst, fabs(entry - bcifs_area_matrix_entry(matrix, i, j)));
        }
    if (!(worst <= 1e-12 * largest))
        note("%s, refined %u times: block A differs by %g of %g", name, refine, worst, largest);
    worst_block = worse(worst_block, scale ? worst / largest : worst);
    bcifs_area_matrix_free(coarse);
}

static void check_parts(const bcifs_area_matrix *matrix, unsigned refine, unsigned coarsen, const char *name)
{
    unsigned finest;
    bool good = bcifs_area_matrix_level(matrix, &finest) == refine - coarsen && finest == refine &&
                bcifs_area_matrix_start(matrix, 0) == 0 &&
                bcifs_area_matrix_start(matrix, 1) == bcifs_area_matrix_scale_points(matrix) &&
                bcifs_area_matrix_start(matrix, coarsen + 1) == bcifs_area_matrix_size(matrix) &&
                bcifs_area_matrix_start(matrix, coarsen + 9) == bcifs_area_matrix_size(matrix);
    for (unsigned part = 0; part <= coarsen; part++)
        good = good && bcifs_area_matrix_start(matrix, part) <= bcifs_area_matrix_start(matrix, part + 1);
    if (!good)
        note("%s, %u - %u levels: wrong parts", name, refine, coarsen);
    parted = parted && good;
}

/* Fine points, random and the figure's own, in the coefficients of a level. */
static void check_values(const bcifs_area_matrix *matrix, const bcifs_area_matrix *mother, bcifs_bank *bank,
                         uint64_t *state, const char *name)
{
    size_t count = 2 * bcifs_area_matrix_size(matrix);
    double *points = calloc(count, sizeof *points), *coefficients = calloc(count, sizeof *coefficients);
    for (size_t i = 0; i < count; i++)
        points[i] = random_number(state);
    bcifs_bank_decompose(bank, points, 2, coefficients, NULL);
    double error = fabs(bcifs_area_matrix_value(matrix, coefficients) - bcifs_area_matrix_value(mother, points)) /
                   (value_terms(matrix, coefficients) + value_terms(mother, points));
    bcifs_bank_figure_points(bank, points, NULL);
    bcifs_bank_decompose(bank, points, 2, coefficients, NULL);
    double area = bcifs_area_value(bcifs_area_matrix_area(matrix)),
           wrong = fabs(bcifs_area_matrix_value(matrix, coefficients) - area) /
                   (value_terms(matrix, coefficients) + value_terms(mother, points));
    if (!(error <= 1e-13) || !(wrong <= 1e-13))
        note("%s, level %u: areas differ by %g, %g", name, bcifs_area_matrix_level(matrix, NULL), error, wrong);
    worst_value = worse(worst_value, error);
    worst_area = worse(worst_area, wrong);
    free(points);
    free(coefficients);
}

static void check_level(const bcifs_figure *figure, const bcifs_area_matrix *mother, unsigned refine, unsigned coarsen,
                        uint64_t *state, const char *name)
{
    bcifs_area_matrix *matrix = NULL;
    bcifs_bank *bank = NULL;
    bcifs_error error;
    if (bcifs_area_matrix_create(figure, refine, coarsen, &matrix, &error) ||
        bcifs_bank_create(figure, refine, coarsen, &bank, &error)) {
        note("%s, %u - %u levels: %s", name, refine, coarsen, error.message);
        worst_value = INFINITY;
    } else {
        check_parts(matrix, refine, coarsen, name);
        check_antisymmetry(matrix, name);
        check_values(matrix, mother, bank, state, name);
        check_block(matrix, figure, refine - coarsen, name);
        if (bcifs_area_matrix_size(matrix) <= MOST_DENSE)
            check_entries(matrix, mother, bank, name);
        tested++;
    }
    bcifs_area_matrix_free(matrix);
    bcifs_bank_free(bank);
}

static void check_curve(const struct curve_sample *sample)
{
    uint64_t state = 11;
    double *points = calloc(2 * sample->count, sizeof *points);
    curve_points(sample, 0.3, &state, points);
    bcifs_figure *figure = curve_figure(sample, points);
    for (unsigned refine = 0; refine <= MOST_REFINED && figure; refine++) {
        bcifs_area_matrix *mother = NULL;
        bcifs_status status = bcifs_area_matrix_create(figure, refine, 0, &mother, NULL);
        refused += status == BCIFS_NO;
        for (unsigned coarsen = 0; coarsen <= refine && status == BCIFS_OK; coarsen++)
            check_level(figure, mother, refine, coarsen, &state, sample->name);
        bcifs_area_matrix_free(mother);
    }
    bcifs_figure_free(figure);
    free(points);
}

static void test_gallery(void)
{
    curves_each(check_curve);
    note("%d matrices; worst value %g, area %g, entry %g, block A %g; %d without area", tested, worst_value, worst_area,
         worst_entry, worst_block, refused);
    ok(tested >= 300, "curves of all schemes have matrices of all levels");
    ok(refused >= 4, "those without an area are refused");
    ok(worst_value <= 1e-13, "the area of random points is the same in the coefficients of every level");
    ok(worst_area <= 1e-13, "that of the figure's points is its area");
    ok(worst_entry <= 1e-11, "entries are those of the dense product");
    ok(worst_block <= 1e-12, "block A is the mother matrix of the coarse curve");
    ok(antisymmetric, "all are antisymmetric, to the last bit, and in order");
    ok(parted, "levels and parts are told");
}

/* ---- Chaikin ------------------------------------------------------------------------------------------- */

/* The form of an arc is [0 5/12 1/12; …]: a circulant of 5/12 + 5/12 and 1/12. */
static void test_chaikin(const bcifs_figure *figure)
{
    bcifs_area_matrix *matrix = NULL;
    bool good = bcifs_area_matrix_create(figure, 4, 3, &matrix, NULL) == BCIFS_OK;
    for (size_t i = 0; i < 8 && good; i++)
        for (size_t j = 0; j < 8 && good; j++) {
            size_t ahead = (j + 8 - i) % 8;
            double expected = ahead == 1   ? 5.0 / 6
                              : ahead == 2 ? 1.0 / 12
                              : ahead == 6 ? -1.0 / 12
                              : ahead == 7 ? -5.0 / 6
                                           : 0;
            good = fabs(bcifs_area_matrix_entry(matrix, i, j) - expected) < 1e-15;
        }
    ok(good && bcifs_area_matrix_scale_points(matrix) == 8, "Chaikin: block A of every level is the same circulant");
    ok(bcifs_area_matrix_entry(matrix, 64, 0) == 0 && bcifs_area_matrix_entry(matrix, 0, 64) == 0,
       "there is nothing outside");
    bcifs_area_matrix_free(matrix);
}

/* Storage like n log n: entries of M^0 for n = 4·2^k. */
static void test_growth(const bcifs_figure *figure)
{
    size_t last = 0;
    double least = INFINITY, most = 0;
    bool good = true;
    for (unsigned refine = 6; refine <= 12; refine++) {
        bcifs_area_matrix *matrix = NULL;
        clock_t start = clock();
        good = good && bcifs_area_matrix_create(figure, refine, refine, &matrix, NULL) == BCIFS_OK;
        double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
        size_t count = good ? bcifs_area_matrix_entries(matrix, NULL, NULL, NULL) : 0,
               size = good ? bcifs_area_matrix_size(matrix) : 1;
        double ratio = (double)count / ((double)size * log2((double)size));
        note("%zu points, %u levels: %zu entries, %.2f n log2 n, %.0f ms", size, refine, count, ratio, 1e3 * seconds);
        good = good && count > 2 * last;
        least = fmin(least, ratio);
        most = fmax(most, ratio);
        last = count;
        bcifs_area_matrix_free(matrix);
    }
    ok(good && most < 6 && most < 1.25 * least, "entries grow like n log n: %.2f to %.2f times that", least, most);
}

/* ---- Refusals ------------------------------------------------------------------------------------------ */

static void test_refusals(const bcifs_figure *figure)
{
    bcifs_area_matrix *matrix = NULL;
    bcifs_error error;
    ok(bcifs_area_matrix_create(figure, 0, 3, &matrix, &error) == BCIFS_INPUT && !matrix &&
           strstr(error.message, "can be coarsened 2 times") && strstr(error.message, "multiple of 8 pieces"),
       "too far: how far it goes, and what would do");
    ok(bcifs_area_matrix_create(figure, 65, 0, &matrix, &error) == BCIFS_INPUT && strstr(error.message, "64 levels"),
       "too many levels");
    ok(bcifs_area_matrix_create(figure, 0, 1, &matrix, &error) == BCIFS_OK, "as far as it goes");
    ok(bcifs_area_matrix_write(matrix, "-", &(bcifs_write_options){.format = "npy"}, &error) == BCIFS_INPUT &&
           strstr(error.message, "not 'npy'"),
       "a format that there is not");
    ok(bcifs_area_matrix_write(matrix, "/tmp/x.svg", &(bcifs_write_options){.width = 100}, &error) == BCIFS_INPUT &&
           strstr(error.message, "240 to 8192"),
       "a picture too narrow");
    bcifs_area_matrix_free(matrix);
    bcifs_area_matrix_free(NULL);
}

int main(void)
{
    bcifs_automaton *automaton = NULL;
    bcifs_figure *figure = NULL;
    test_gallery();
    if (bcifs_load("automata/chaikin.bcifs", NULL, &automaton, NULL) ||
        bcifs_figure_create(automaton, NULL, &figure, NULL))
        return 1;
    test_chaikin(figure);
    test_growth(figure);
    test_refusals(figure);
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
    return done_testing();
}
