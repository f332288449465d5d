/* Forms: areas and energies of arcs against formulas of calculus, exact fractions, and polygons. */
#include "multires/form.h"

#include <math.h>
#include <string.h>
#include <time.h>

#include "automaton/figure.h"
#include "numeric/rational.h"
#include "tap.h"

enum { MOST = 16 };

/* Forms of all edges that an automaton's figures reach. */
struct forms {
    bcifs_automaton *automaton;
    struct arena arena;
    struct states states;
    struct report report;
    const struct form *forms;
    double seconds;
};

static bool forms_open(struct forms *forms, const char *text, const char *setting, bool energy)
{
    bcifs_error error;
    bcifs_load_options options = {.settings = &setting, .setting_count = setting != NULL, .fix_params = 1};
    *forms = (struct forms){.report = report_new(NULL)};
    bcifs_status status = bcifs_load_text("text", text, strlen(text), &options, &forms->automaton, &error);
    if (status) {
        note("%u:%u: %s", error.line, error.column, error.message);
        return false;
    }
    status = states_of_figures(forms->automaton, &forms->states, &forms->arena);
    forms->states.setting.report = &forms->report;
    size_t *list = arena_new(&forms->arena, forms->states.count, sizeof *list), count = 0;
    for (size_t i = 0; list && i < forms->states.count; i++)
        if (forms->states.states[i].key.definition->kind == CELL_EDGE)
            list[count++] = i;
    struct timespec begin, end;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
    if (status == BCIFS_OK)
        status =
            (energy ? forms_energy : forms_area)(&forms->states, list, count, &forms->arena, &forms->forms);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    forms->seconds = (double)(end.tv_sec - begin.tv_sec) + 1e-9 * (double)(end.tv_nsec - begin.tv_nsec);
    if (status)
        note("status %d: %s", (int)status, forms->report.first.message);
    return status == BCIFS_OK;
}

static void forms_close(struct forms *forms)
{
    arena_free(&forms->arena);
    bcifs_automaton_free(forms->automaton);
}

static size_t state_named(const struct forms *forms, const char *name)
{
    for (size_t i = 0; i < forms->states.count; i++) {
        struct text text = {0};
        state_name(&forms->states.states[i].key, &text);
        bool same = strcmp(text.data, name) == 0;
        text_free(&text);
        if (same)
            return i;
    }
    return SIZE_MAX;
}

static const struct form *form_named(const struct forms *forms, const char *name)
{
    size_t state = state_named(forms, name);
    return state == SIZE_MAX ? NULL : &forms->forms[state];
}

/* Whether a form is exactly `entries`, fractions row after row separated by blanks. */
static bool form_is(const struct form *form, const char *entries, size_t points)
{
    struct text text = {0};
    if (!form || !form->values || !form->exact) {
        note("no exact form: %s", form && form->reason ? form->reason : "");
        return false;
    }
    for (size_t i = 0; i < points * points; i++) {
        text_append(&text, i ? " " : "");
        value_write(&text, form->values[i]);
    }
    bool same = strcmp(text.data, entries) == 0;
    if (!same)
        note("found %s, expected %s", text.data, entries);
    text_free(&text);
    return same;
}

static bool has_reason(const struct form *form, const char *words)
{
    bool good = form && !form->values && form->reason && strstr(form->reason, words);
    if (!good)
        note("'%s' is not in '%s'", words, form && form->reason ? form->reason : "(no reason)");
    return good;
}

/* ---- Automata ------------------------------------------------------------------------------------------ */

static const char chaikin[] = "automaton t\nedge arc { mask 2 [ 1/4 3/4 3/4 1/4 ] }\n";
static const char cubic[] = "automaton t\nedge arc { mask 2 [ 1/8 1/2 3/4 1/2 1/8 ] }\n";
static const char quartic[] = "automaton t\nedge arc { mask 2 [ 1/16 5/16 5/8 5/8 5/16 1/16 ] }\n";
static const char four_point[] =
    "automaton t\nparam w = 1/16\nedge arc { mask 2 [ -w 0 1/2+w 1 1/2+w 0 -w ] }\n"
    "figure f { open arc points [ 0 0; 1 3; 4 -2; 5 5; 7 1; 8 8; 9 -3; 12 1 ] }\n";
static const char takagi[] =
    "automaton t\nparam w = 1/2\nvertex end 1 { }\nedge arc 3 {\n start end at 0\n end end at 2\n"
    "sub arc [ 1 5/8-w/2 1/4; 0 1/4+w 1/2; 0 1/8-w/2 1/4 ]\n"
    "sub arc [ 1/4 1/8-w/2 0; 1/2 1/4+w 0; 1/4 5/8-w/2 1 ]\n}\n";
static const char bezier2[] =
    "automaton t\nvertex end 1 { }\nedge arc 3 {\n start end at 0\n end end at 2\n"
    "sub arc [ 1 1/2 1/4; 0 1/2 1/2; 0 0 1/4 ]\n sub arc [ 1/4 0 0; 1/2 1/2 0; 1/4 1/2 1 ]\n}\n";
static const char bezier3[] = "automaton t\nvertex end 1 { }\nedge arc 4 {\n start end at 0\n end end at 3\n"
                              "sub arc [ 1 1/2 1/4 1/8; 0 1/2 1/2 3/8; 0 0 1/4 3/8; 0 0 0 1/8 ]\n"
                              "sub arc [ 1/8 0 0 0; 3/8 1/4 0 0; 3/8 1/2 1/2 0; 1/8 1/4 1/2 1 ]\n}\n";
static const char koch[] =
    "automaton t\nvertex end 1 { }\nedge arc 3 {\n start end at 0\n end end at 2\n"
    "sub arc [ 1 2/3 2/3; 0 1/3 0; 0 0 1/3 ]\n sub arc [ 2/3 1/3 0; 0 2/3 1; 1/3 0 0 ]\n"
    "sub arc [ 0 0 1/3; 1 2/3 0; 0 1/3 2/3 ]\n sub arc [ 1/3 0 0; 0 1/3 0; 2/3 2/3 1 ]\n}\n";
static const char dragon[] =
    "automaton t\nvertex end 1 { }\nedge forward 3 {\n start end at 0\n end end at 2\n"
    "sub forward [ 1 1/2 0; 0 1 1; 0 -1/2 0 ]\n sub backward [ 0 1/2 0; 1 0 0; 0 1/2 1 ]\n}\n"
    "edge backward 3 {\n start end at 0\n end end at 2\n"
    "sub forward [ 1 1/2 0; 0 0 1; 0 1/2 0 ]\n sub backward [ 0 -1/2 0; 1 1 0; 0 1/2 1 ]\n}\n"
    "edge whole 3 {\n start end at 0\n end end at 2\n"
    "sub forward [ 1 1/2 0; 0 1 1; 0 -1/2 0 ]\n sub backward [ 0 1/2 0; 1 0 0; 0 1/2 1 ]\n}\n";
static const char levy[] = "automaton t\nvertex end 1 { }\nedge arc 3 {\n start end at 0\n end end at 2\n"
                           "sub arc [ 1 1/2 0; 0 1 1; 0 -1/2 0 ]\n sub arc [ 0 -1/2 0; 1 1 0; 0 1/2 1 ]\n}\n";
static const char hilbert[] =
    "automaton t\nvertex end 1 { }\nedge arc 3 {\n start end at 0\n end end at 2\n"
    "sub arc [ 1 1/2 1/2; 0 0 1/2; 0 1/2 0 ]\n sub arc [ 1/2 0 0; 1/2 1 1/2; 0 0 1/2 ]\n"
    "sub arc [ 0 -1/2 -1/2; 1/2 1 1/2; 1/2 1/2 1 ]\n"
    "sub arc [ -1/2 0 0; 1/2 1/2 0; 1 1/2 1 ]\n}\n";
/* A Bézier arc plus Takagi's function f of the direction P3 - P1, f(t/2) = t/2 + w f(t), f(1 - t) = f(t). */
static const char peaked[] =
    "automaton t\nparam w = 1/8\nvertex end 1 { }\nedge arc 4 {\n start end at 0\n end end at 2\n"
    "sub arc [ 1 1/2 1/4 1/2; 0 1/4 0 1/4-w; 0 0 1/4 0; 0 1/4 1/2 1/4+w ]\n"
    "sub arc [ 1/4 0 0 0; 0 1/4 0 1/4-w; 1/4 1/2 1 1/2; 1/2 1/4 0 1/4+w ]\n}\n";

/* ---- Area ---------------------------------------------------------------------------------------------- */

/* ∫ H_j dH_k - H_k dH_j of Bernstein polynomials and B-splines by hand (design, 6.1). */
static void test_area_known(void)
{
    static const struct {
        const char *text, *setting, *entries;
        size_t points;
    } cases[] = {
        {chaikin, NULL, "0 5/12 1/12 -5/12 0 5/12 -1/12 -5/12 0", 3},
        {bezier2, NULL, "0 2/3 1/3 -2/3 0 2/3 -1/3 -2/3 0", 3},
        {bezier3, NULL, "0 3/5 3/10 1/10 -3/5 0 3/10 3/10 -3/10 -3/10 0 3/5 -1/10 -3/10 -3/5 0", 4},
        {takagi, NULL, "0 1 0 -1 0 1 0 -1 0", 3},
        {takagi, "w=1/4", "0 2/3 1/3 -2/3 0 2/3 -1/3 -2/3 0", 3},
        /* The tent is 1/3 of the triangle P0 P1 P2, and every subdivision adds 4/9 of what the last one did:
         * 3/5 of the triangle, m = chord + 3/5 (e0 ∧ e1 + e1 ∧ e2 - e0 ∧ e2). */
        {koch, NULL, "0 3/5 2/5 -3/5 0 3/5 -2/5 -3/5 0", 3},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct forms forms;
        bool good = forms_open(&forms, cases[i].text, cases[i].setting, false);
        ok(good && form_is(form_named(&forms, "arc"), cases[i].entries, cases[i].points),
           "area form %zu is the known one", i);
        forms_close(&forms);
    }
}

/* On the chord 0..1 with apex 1 Takagi's function is Σ w^n s(2^n x), of integral 1/(4(1 - w)): P0, P1, P2 at
 * (0,0), (1/2,1), (1,0) give ½ (m01·0 + m02·0 + m12·(½·0 - 1·1)) = -½ m12. So m12 = 1/(2(1 - w)). */
static void test_area_takagi(void)
{
    bool good = true;
    for (int n = -3; n < 8; n++) {
        char setting[32], expected[32];
        struct forms forms;
        snprintf(setting, sizeof setting, "w=%d/8", n);
        struct rational fraction;
        rational_make(4, 8 - n, &fraction);
        expected[rational_print(expected, fraction)] = '\0';
        good = forms_open(&forms, takagi, setting, false) && good;
        const struct form *form = form_named(&forms, "arc");
        struct text text = {0};
        if (form && form->values)
            value_write(&text, form->values[5]);
        if (!text.data || strcmp(text.data, expected) != 0) {
            note("%s: %s, expected %s", setting, text.data ? text.data : "none", expected);
            good = false;
        }
        text_free(&text);
        forms_close(&forms);
    }
    ok(good, "Takagi's family has the areas of its series");
    struct forms forms;
    forms_open(&forms, takagi, "w=1", false);
    ok(has_reason(form_named(&forms, "arc"), "do not converge"), "at w = 1 they do not converge");
    forms_close(&forms);
    forms_open(&forms, takagi, "w=-1", false);
    /* Every subdivision turns the sign of what it adds: the eigenvalue is -1. */
    ok(has_reason(form_named(&forms, "arc"), "is 1, not below 1"), "nor at w = -1");
    forms_close(&forms);
}

/* Lévy: both maps keep orientation and halve areas, 1/2 + 1/2 = 1. Dragon: forward turns its second half
 * over, the matrix of signed determinants is [ 1/2 -1/2; -1/2 1/2 ], with eigenvalues 0 and 1: polygons on
 * whole levels have a limit, others have another one. Hilbert: -1/4 + 1/4 + 1/4 - 1/4 = 0. */
static void test_area_filling(void)
{
    struct forms forms;
    forms_open(&forms, levy, NULL, false);
    ok(has_reason(form_named(&forms, "arc"), "is 1, not below 1"), "Lévy's curve has no area");
    forms_close(&forms);
    forms_open(&forms, dragon, NULL, false);
    ok(has_reason(form_named(&forms, "forward"), "is 1, not below 1") &&
           has_reason(form_named(&forms, "backward"), "is 1, not below 1"),
       "nor has the dragon");
    ok(has_reason(form_named(&forms, "whole"), "for 'forward'") ||
           has_reason(form_named(&forms, "whole"), "for 'backward'"),
       "nor what is made of dragons, for that reason");
    ok(has_reason(&forms.forms[state_named(&forms, "end")], "not among"), "a vertex has no form");
    forms_close(&forms);
    forms_open(&forms, hilbert, NULL, false);
    ok(form_is(form_named(&forms, "arc"), "0 1 0 -1 0 1 0 -1 0", 3), "Hilbert's parts cancel");
    forms_close(&forms);
}

/* Whether m·1 = -(H(1) - H(0)) and m = Σ T_i m T_i^T hold in values. */
static bool area_holds(struct forms *forms, size_t index)
{
    const struct form *form = &forms->forms[index];
    struct form_ends ends;
    if (!form->values || form_ends_find(&forms->states, index, &forms->arena, &ends) != BCIFS_OK)
        return false;
    const struct state *state = &forms->states.states[index];
    size_t n = state->points;
    bool good = true;
    for (size_t i = 0; i < n; i++) {
        struct value sum = value_subtract(ends.end[i], ends.start[i]);
        for (size_t j = 0; j < n; j++)
            sum = value_add(sum, form->values[i * n + j]);
        good = good && (sum.exact ? sum.residue == 0 : fabs(sum.real) < 1e-12);
    }
    for (size_t i = 0; i < n * n; i++) {
        struct value sum = form->values[i];
        for (size_t k = 0; k < state->cell->child_count; k++) {
            const struct value_matrix *t = state->cell->children[k].map;
            const struct value *child = forms->forms[state->children[k]].values;
            for (size_t a = 0; a < t->columns; a++)
                for (size_t b = 0; b < t->columns; b++)
                    sum = value_subtract(sum, value_multiply(value_multiply(t->values[i / n * t->columns + a],
                                                                            child[a * t->columns + b]),
                                                             t->values[i % n * t->columns + b]));
        }
        good = good && (sum.exact ? sum.residue == 0 : fabs(sum.real) < 1e-12);
    }
    return good;
}

#define NONUNIFORM                                                                                           \
    "automaton n\n"                                                                                          \
    "let a(u,v) = u/(2*(u+v))\nlet b(u,v) = v/(2*(u+v))\n"                                                   \
    "vertex k(u,v) 2 { sub k(u,v) [ 1-a(u,v) b(u,v); a(u,v) 1-b(u,v) ] }\n"                                  \
    "vertex joint 2 { sub joint [ 3/4 1/4; 1/4 3/4 ] }\n"                                                    \
    "edge p(u,v,w) 3 { start k(u,v) at 0 1 end k(v,w) at 1 2\n"                                              \
    "  sub left(u,v) [ 1-a(u,v) b(u,v) 0; a(u,v) 1-b(u,v) 1-a(v,w); 0 0 a(v,w) ]\n"                          \
    "  sub right(v,w) [ b(u,v) 0 0; 1-b(u,v) 1-a(v,w) b(v,w); 0 a(v,w) 1-b(v,w) ] }\n"                       \
    "edge left(u,v) 3 { start k(u,v) at 0 1 end joint at 1 2\n"                                              \
    "  sub left(u,v) [ 1-a(u,v) b(u,v) 0; a(u,v) 1-b(u,v) 3/4; 0 0 1/4 ]\n"                                  \
    "  sub uniform [ b(u,v) 0 0; 1-b(u,v) 3/4 1/4; 0 1/4 3/4 ] }\n"                                          \
    "edge right(v,w) 3 { start joint at 0 1 end k(v,w) at 1 2\n"                                             \
    "  sub uniform [ 3/4 1/4 0; 1/4 3/4 1-a(v,w); 0 0 a(v,w) ]\n"                                            \
    "  sub right(v,w) [ 1/4 0 0; 3/4 1-a(v,w) b(v,w); 0 a(v,w) 1-b(v,w) ] }\n"                               \
    "edge uniform 3 { start joint at 0 1 end joint at 1 2\n"                                                 \
    "  sub uniform [ 3/4 1/4 0; 1/4 3/4 3/4; 0 0 1/4 ] sub uniform [ 1/4 0 0; 3/4 3/4 1/4; 0 1/4 3/4 ] }\n"

/* The arc p(u,v,w) is the Bézier arc on (v P0 + u P1)/(u+v), P1, (w P1 + v P2)/(v+w). */
static void bezier_points(const double *intervals, double points[9])
{
    double u = intervals[0], v = intervals[1], w = intervals[2];
    const double columns[9] = {v / (u + v), 0, 0, u / (u + v), 1, w / (v + w), 0, 0, v / (v + w)};
    memcpy(points, columns, sizeof columns);
}

/* B form B^T, 3 × 3. */
static void congruence(const double b[9], const double form[9], double result[9])
{
    for (int i = 0; i < 9; i++) {
        result[i] = 0;
        for (int k = 0; k < 9; k++)
            result[i] += b[i / 3 * 3 + k / 3] * form[k] * b[i % 3 * 3 + k % 3];
    }
}

/* Figures of many random intervals; every piece is another state. */
static void test_nonuniform(bool energy)
{
    enum { PIECES = 150 };
    static const double area[9] = {0, 2. / 3, 1. / 3, -2. / 3, 0, 2. / 3, -1. / 3, -2. / 3, 0};
    static const double bend[9] = {4, -8, 4, -8, 16, -8, 4, -8, 4};
    for (uint64_t seed = 1; seed <= 3; seed++) {
        static char text[20000];
        double intervals[PIECES + 2], points[9], expected[9];
        uint64_t random = seed;
        int length = snprintf(text, sizeof text, "%sfigure f { open p intervals [", NONUNIFORM);
        for (int i = 0; i < PIECES + 2; i++) {
            intervals[i] = (double)(1 + random_bits(&random) % 64) / 8;
            length += snprintf(text + length, sizeof text - (size_t)length, " %d/8", (int)(8 * intervals[i]));
        }
        length += snprintf(text + length, sizeof text - (size_t)length, " ] points [ 0");
        for (int i = 1; i < PIECES + 2; i++)
            length += snprintf(text + length, sizeof text - (size_t)length, "; %d", i);
        snprintf(text + length, sizeof text - (size_t)length, " ] }\n");
        struct forms forms;
        bool good = forms_open(&forms, text, NULL, energy);
        double error = 0;
        for (int i = 0; i < PIECES && good; i++) {
            struct text name = {0};
            text_append(&name, "p(");
            for (int k = 0; k < 3; k++) {
                text_append(&name, k ? "," : "");
                text_append_number(&name, intervals[i + k]);
            }
            text_append(&name, ")");
            size_t index = state_named(&forms, name.data);
            good = index != SIZE_MAX && forms.forms[index].exact && (energy || area_holds(&forms, index));
            if (!good)
                note("%s: %s", name.data, index == SIZE_MAX ? "not there" : forms.forms[index].reason);
            text_free(&name);
            bezier_points(&intervals[i], points);
            congruence(points, energy ? bend : area, expected);
            for (int k = 0; k < 9 && good; k++)
                error = fmax(error, fabs(expected[k] - forms.forms[index].numbers[k]));
        }
        ok(good && error < 1e-14 * (energy ? 16 : 1), "seed %d: %s of %d non-uniform arcs, %g off, %.3f s",
           (int)seed, energy ? "energies" : "areas", PIECES, error, forms.seconds);
        forms_close(&forms);
    }
}

/* Numbers that are known in doubles only go the same way. */
static void test_area_inexact(void)
{
    static const char text[] =
        "automaton t\nedge arc { mask 2 [ sqrt(1/16) 1-sqrt(1/16) 1-sqrt(1/16) sqrt(1/16) ] }\n";
    static const double expected[9] = {0, 5. / 12, 1. / 12, -5. / 12, 0, 5. / 12, -1. / 12, -5. / 12, 0};
    for (int energy = 0; energy < 2; energy++) {
        struct forms forms;
        static const double bend[9] = {1, -2, 1, -2, 4, -2, 1, -2, 1};
        bool good = forms_open(&forms, text, NULL, energy);
        const struct form *form = form_named(&forms, "arc");
        good = good && form && form->values && !form->exact;
        if (form && form->reason)
            note("%s", form->reason);
        for (int i = 0; i < 9 && good; i++)
            good = fabs(form->numbers[i] - (energy ? bend : expected)[i]) < 1e-14;
        ok(good, "%s with roots among the entries", energy ? "energy" : "area");
        forms_close(&forms);
    }
}

/* ---- Energy -------------------------------------------------------------------------------------------- */

/* Second differences, rows of n-2 × n, times `factor`. */
static void second_differences(size_t n, double factor, double *d)
{
    memset(d, 0, (n - 2) * n * sizeof *d);
    for (size_t i = 0; i + 2 < n; i++)
        for (size_t k = 0; k < 3; k++)
            d[i * n + i + k] = k == 1 ? -2 * factor : factor;
}

/* c''(t) = Σ_i basis_i(t) (D P)_i: ∫ |c''|² = (DP)^T G (DP), by Gauss' rule of three points, exact up to
 * degree 5. */
static void energy_expected(size_t n, const double *d, void (*basis)(double t, double *values), double *h)
{
    static const double nodes[3] = {0.11270166537925831, 0.5, 0.88729833462074169},
                        weights[3] = {5. / 18, 4. / 9, 5. / 18};
    memset(h, 0, n * n * sizeof *h);
    for (int g = 0; g < 3; g++) {
        double values[MOST], row[MOST] = {0};
        basis(nodes[g], values);
        for (size_t i = 0; i + 2 < n; i++)
            for (size_t k = 0; k < n; k++)
                row[k] += values[i] * d[i * n + k];
        for (size_t i = 0; i < n * n; i++)
            h[i] += weights[g] * row[i / n] * row[i % n];
    }
}

static void constant(double t, double *values)
{
    (void)t;
    values[0] = 1;
}

static void linear(double t, double *values)
{
    values[0] = 1 - t;
    values[1] = t;
}

/* The uniform quadratic B-splines. */
static void quadratic(double t, double *values)
{
    values[0] = (1 - t) * (1 - t) / 2;
    values[1] = 0.5 + t - t * t;
    values[2] = t * t / 2;
}

/* c'' of a B-spline of degree p is the B-spline of degree p - 2 on the second differences, of a Bézier arc
 * the Bézier arc on p(p-1) times them. */
static void test_energy_known(void)
{
    static const struct {
        const char *text, *setting;
        size_t points;
        double factor;
        void (*basis)(double t, double *values);
    } cases[] = {
        {chaikin, NULL, 3, 1, constant}, {bezier2, NULL, 3, 2, constant}, {takagi, "w=1/4", 3, 2, constant},
        {cubic, NULL, 4, 1, linear},     {bezier3, NULL, 4, 6, linear},   {quartic, NULL, 5, 1, quadratic},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct forms forms;
        size_t n = cases[i].points;
        double d[MOST * MOST], expected[MOST * MOST], error = 0;
        bool good = forms_open(&forms, cases[i].text, cases[i].setting, true);
        const struct form *form = form_named(&forms, "arc");
        if (form && form->reason)
            note("%s", form->reason);
        good = good && form && form->values && form->exact;
        second_differences(n, cases[i].factor, d);
        energy_expected(n, d, cases[i].basis, expected);
        for (size_t k = 0; k < n * n && good; k++)
            error = fmax(error, fabs(form->numbers[k] - expected[k]));
        ok(good && error < 1e-14 * cases[i].factor * cases[i].factor, "energy form %zu: %g off", i, error);
        forms_close(&forms);
    }
}

/* 2^(3n) Σ |Δ² of the level's control points|² tends to ∫|c''|² for the four-point scheme, whose second
 * derivative is in L² though not continuous; the error falls like 2^(-0.88 n), twice the Sobolev exponent
 * beyond 2. */
static void test_energy_four_point(void)
{
    struct forms forms;
    bcifs_figure *figure = NULL;
    bcifs_error error;
    bool good = forms_open(&forms, four_point, NULL, true);
    const struct form *form = form_named(&forms, "arc");
    good = good && form && form->values &&
           bcifs_figure_create(forms.automaton, NULL, &figure, &error) == BCIFS_OK;
    double expected = 0, last = INFINITY;
    for (size_t p = 0; good && p < figure->piece_count; p++)
        for (size_t i = 0; i < 36; i++)
            for (unsigned axis = 0; axis < 2; axis++)
                expected += form->numbers[i] * figure->points[2 * figure->pieces[p].indices[i / 6] + axis] *
                            figure->points[2 * figure->pieces[p].indices[i % 6] + axis];
    for (unsigned depth = 8; good && depth <= 16; depth += 4) {
        bcifs_view view = {.depth = depth, .show = BCIFS_CONTROL};
        bcifs_plan *plan = NULL;
        bcifs_walker *walker = NULL;
        good = bcifs_plan_create(figure, &view, &plan, &error) == BCIFS_OK &&
               bcifs_walker_create(plan, &walker, &error) == BCIFS_OK;
        size_t count = good ? (size_t)bcifs_plan_points(plan) : 0;
        double *points = memory_new(count, 2 * sizeof *points), energy = 0;
        good = good && points && bcifs_walker_next(walker, points, count) == count;
        /* Three pieces are the parameter from 2 to 5 of control points 0 … 7: so many on each side are left
         * out. */
        size_t cell = (size_t)1 << depth, margin = (count - 3 * cell) / 2;
        for (size_t i = margin; good && i < margin + 3 * cell; i++)
            for (unsigned axis = 0; axis < 2; axis++) {
                const double *p = points + 2 * i + axis;
                energy += pow(p[2] - 2 * p[0] + p[-2], 2) * pow(8, depth);
            }
        double off = fabs(energy / expected - 1);
        note("depth %u: %.10g, expected %.10g", depth, energy, expected);
        good = good && off < 0.25 * last;
        last = off;
        memory_free(points);
        bcifs_walker_free(walker);
        bcifs_plan_free(plan);
    }
    ok(good && last < 1e-3, "the four-point scheme has the energy of its polygons, to %g", last);
    bcifs_figure_free(figure);
    forms_close(&forms);
}

/* Daubechies' scaling functions D4, D5, D10 (1988), to 19 digits. */
static const char *const daubechies[] = {
    "-0.01498698933036147245 0.04650360107098176461 0.04361630047417725266 -0.2645071673690397361 "
    "-0.03957502623564464310 0.8922001382467596232 1.010945715091828863 0.3258034280512983483",
    "0.004717427939067871525 -0.01779187010195419148 -0.008826800108358254544 0.1097026586421336470 "
    "-0.04560113188354729748 -0.3426567153829348864 0.1957669613478093481 1.024326944259197073 "
    "0.8539435427050283324 0.2264189825835583576",
    "-0.00001875841562750040834 0.0001323543668511067664 -0.0001647090060907779551 "
    "-0.0009699478398564109630 0.002817686590194676211 0.001973325364963205188 -0.01517900233585649879 "
    "0.005100436967814477465 0.04696981409739712169 -0.04165924808760161396 -0.1009665711967794341 "
    "0.1316029871010700146 0.1801274485333933327 -0.2771098787209663057 -0.3533362017941126005 "
    "0.3976377417690173790 0.9736281107336398914 0.7455750714864667698 0.2661221827938417898 "
    "0.03771715759224137777",
};

/* Their Sobolev exponents are 1.7756, 2.0968 and more than 3 (T. Eirola, 1992): ∫|c''|² exists from D5 on.
 * For D4 the radius is 2^(2(2 - 1.7756)) = 1.365. */
static void test_daubechies(void)
{
    for (size_t i = 0; i < 3; i++) {
        char text[800];
        struct forms forms;
        snprintf(text, sizeof text, "automaton t\nedge arc { mask 2 [ %s ] }\n", daubechies[i]);
        bool good = forms_open(&forms, text, NULL, false);
        ok(good && area_holds(&forms, state_named(&forms, "arc")),
           "a filter of Daubechies' has an area, %.3f s", forms.seconds);
        forms_close(&forms);
        good = forms_open(&forms, text, NULL, true);
        const struct form *form = form_named(&forms, "arc");
        if (i == 0)
            ok(good && has_reason(form, "is 1.36"), "D4 has no energy");
        else
            ok(good && form && form->values && !form->exact, "but this one has: %s",
               form && form->reason ? form->reason : "");
        forms_close(&forms);
    }
}

static void test_energy_refused(void)
{
    static const struct {
        const char *text, *setting, *words;
    } cases[] = {
        {takagi, NULL, "does not reproduce t²"},
        {takagi, "w=1/8", "does not reproduce t²"},
        {koch, NULL, "does not reproduce the parameter"},
        {dragon, NULL, "does not reproduce the parameter"},
        /* f is in H² of every half, but has corners: 8·2·w² < 1. */
        {peaked, NULL, "jumps where two children meet"},
        {peaked, "w=1/5", "jumps where two children meet"},
        /* 16 w² >= 1: the corners add up. */
        {peaked, "w=3/8", "is 2.25, not below 1"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct forms forms;
        bool good = forms_open(&forms, cases[i].text, cases[i].setting, true);
        const char *name = cases[i].text == dragon ? "forward" : "arc";
        ok(good && has_reason(form_named(&forms, name), cases[i].words), "energy refused: %s",
           cases[i].words);
        forms_close(&forms);
    }
}

/* ---- Ends ---------------------------------------------------------------------------------------------- */

static void test_ends(void)
{
    struct forms forms;
    struct form_ends ends;
    struct text text = {0};
    bool good = forms_open(&forms, cubic, NULL, false);
    size_t arc = state_named(&forms, "arc");
    good = good && form_ends_find(&forms.states, arc, &forms.arena, &ends) == BCIFS_OK;
    for (int i = 0; i < 8 && good; i++) {
        text_append(&text, i ? " " : "");
        value_write(&text, i < 4 ? ends.start[i] : ends.end[i - 4]);
    }
    ok(good && strcmp(text.data, "1/6 2/3 1/6 0 0 1/6 2/3 1/6") == 0,
       "a cubic B-spline begins at (1 4 1)/6: %s", text.data);
    text_free(&text);
    forms_close(&forms);
    /* Two vertices in turn: a -> b by [ 1/2 0; 1/2 1 ], b -> a by [ 1 1/3; 0 2/3 ]; a's cycle is their
     * product [ 1/2 1/6; 1/2 5/6 ], which fixes (1/4, 3/4). */
    good = forms_open(
        &forms,
        "automaton t\nvertex a 2 { sub b [ 1/2 0; 1/2 1 ] }\nvertex b 2 { sub a [ 1 1/3; 0 2/3 ] }\n"
        "edge x 3 { start a at 0 1 end a at 1 2 sub x [ 1 0 0; 0 1 0; 0 0 1 ] }\n",
        NULL, false);
    good = good && form_ends_find(&forms.states, state_named(&forms, "x"), &forms.arena, &ends) == BCIFS_OK;
    for (int i = 0; i < 3 && good; i++) {
        text_append(&text, i ? " " : "");
        value_write(&text, ends.start[i]);
    }
    ok(good && strcmp(text.data, "1/4 3/4 0") == 0, "the fixed point of a cycle of vertices: %s", text.data);
    text_free(&text);
    forms_close(&forms);
    bool refused = !forms_open(&forms,
                               "automaton t\nvertex a 2 { sub a [ 1 0; 0 1 ] }\n"
                               "edge x 3 { start a at 0 1 end a at 1 2 sub x [ 1 0 0; 0 1 0; 0 0 1 ] }\n",
                               NULL, false);
    ok(refused && forms.report.first.status == BCIFS_INPUT &&
           strstr(forms.report.first.message, "more than one point"),
       "a joint that fixes a line has no limit point");
    forms_close(&forms);
}

int main(void)
{
    test_area_known();
    test_area_takagi();
    test_area_filling();
    test_nonuniform(false);
    test_area_inexact();
    test_energy_known();
    test_nonuniform(true);
    test_energy_four_point();
    test_daubechies();
    test_energy_refused();
    test_ends();
    return done_testing();
}
