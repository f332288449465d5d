/* The public header as a program uses it: misuse, broken texts, every refusal with its reason, and every
 * allocation failing once: the call says so, frees what it had, and works the next time. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bcifs.h"
#include "tap.h"

/* ---- The allocator that fails -------------------------------------------------------------------------- */

static long requests;   /* so far */
static long fail_at;    /* the request that fails; 0: none */
static bool fail_after; /* and all that follow */
static long alive;      /* blocks */

static bool fails(void)
{
    requests++;
    return fail_at > 0 && (requests == fail_at || (fail_after && requests > fail_at));
}

static void *counted_calloc(size_t count, size_t size)
{
    void *block = fails() ? NULL : calloc(count, size);
    alive += block != NULL;
    return block;
}

static void *counted_realloc(void *old, size_t size)
{
    void *block = fails() ? NULL : realloc(old, size);
    alive += block != NULL && old == NULL;
    return block;
}

static void counted_free(void *block)
{
    alive -= block != NULL;
    free(block);
}

/* The library's one place of allocation, compiled here on top of these. Its names then need not be linked. What is
 * asked of an arena is a request as well, or most would never fail: a block of an arena serves many. */
#include "base/memory.h"
#define calloc counted_calloc
#define realloc counted_realloc
#define free counted_free
#define arena_new plain_arena_new
#define arena_text plain_arena_text
#define arena_grow plain_arena_grow
#define arena_reserve plain_arena_reserve
void *arena_new(struct arena *arena, size_t count, size_t size);
char *arena_text(struct arena *arena, const char *text, size_t length);
void *arena_grow(struct arena *arena, const void *array, size_t count, size_t capacity, size_t size);
int arena_reserve(struct arena *arena, void **array, size_t count, size_t *capacity, size_t size);
#include "base/memory.c"
#undef calloc
#undef realloc
#undef free
#undef arena_new
#undef arena_text
#undef arena_grow
#undef arena_reserve

void *arena_new(struct arena *arena, size_t count, size_t size)
{
    return fails() ? NULL : plain_arena_new(arena, count, size);
}

char *arena_text(struct arena *arena, const char *text, size_t length)
{
    return fails() ? NULL : plain_arena_text(arena, text, length);
}

void *arena_grow(struct arena *arena, const void *array, size_t count, size_t capacity, size_t size)
{
    return fails() ? NULL : plain_arena_grow(arena, array, count, capacity, size);
}

int arena_reserve(struct arena *arena, void **array, size_t count, size_t *capacity, size_t size)
{
    return fails() ? 0 : plain_arena_reserve(arena, array, count, capacity, size);
}

/* ---- Samples ------------------------------------------------------------------------------------------- */

static const char arcs[] = "automaton arcs \"Arcs\"\n"
                           "param w = 1/2 in 0..1\n"
                           "let a(u,v) = u/(u+v)\n"
                           "vertex end 1 { }\n"
                           "edge arc 3 { start end at 0 end end at 2\n"
                           "  sub arc [ 1 5/8-w/2 1/4; 0 1/4+w 1/2; 0 1/8-w/2 1/4 ]\n"
                           "  sub arc [ 1/4 1/8-w/2 0; 1/2 1/4+w 0; 1/4 5/8-w/2 1 ] }\n"
                           "edge piece(u) 2 { start end at 0 end end at 1\n"
                           "  sub piece(u) [ 1 a(u,1); 0 1-a(u,1) ] sub piece(1) [ a(u,1) 0; 1-a(u,1) 1 ] }\n"
                           "edge spline { mask 2 [ 1/8 1/2 3/4 1/2 1/8 ] }\n"
                           "cell dust affine 2 { sub dust [ 1/3 0 0; 0 1/3 0 ] sub dust [ 1/3 0 2/3; 0 1/3 2/3 ] }\n"
                           "face patch = arc * spline\n"
                           "figure curve { open arc points [ 0 0; 1/2 1; 1 0 ] }\n"
                           "figure ring { closed spline points [ 0 0; 2 0; 2 2; 0 2 ] }\n"
                           "figure line { open piece intervals [ 1 2 ] points [ 0; 1; 3 ] }\n"
                           "figure dust { piece dust at 0 1 2 }\n";

static bcifs_automaton *load(const char *text, bcifs_error *error)
{
    bcifs_automaton *automaton = NULL;
    bcifs_load_text("text.bcifs", text, strlen(text), NULL, &automaton, error);
    return automaton;
}

/* Diagnostics as they come. */
struct diagnostics {
    int errors, warnings;
    bcifs_error first; /* of the errors */
    bool sane;
};

static void report(void *context, const bcifs_diagnostic *diagnostic)
{
    struct diagnostics *diagnostics = context;
    if (diagnostic->is_warning) {
        diagnostics->warnings++;
    } else if (diagnostics->errors++ == 0) {
        diagnostics->first.line = diagnostic->line;
        diagnostics->first.column = diagnostic->column;
        snprintf(diagnostics->first.message, sizeof diagnostics->first.message, "%s", diagnostic->message);
    }
    diagnostics->sane = diagnostics->sane && diagnostic->message && diagnostic->message[0] &&
                        (diagnostic->line > 0) == (diagnostic->column > 0) &&
                        (!diagnostic->excerpt || strchr(diagnostic->excerpt, '^'));
}

/* ---- Misuse -------------------------------------------------------------------------------------------- */

static void test_nothing(void)
{
    bcifs_text_free(NULL);
    bcifs_automaton_free(NULL);
    bcifs_check_free(NULL);
    bcifs_area_free(NULL);
    bcifs_area_matrix_free(NULL);
    bcifs_figure_free(NULL);
    bcifs_points_free(NULL);
    bcifs_plan_free(NULL);
    bcifs_walker_free(NULL);
    ok(1, "everything that frees accepts NULL");
    bool good = true;
    for (int status = -2; status < 10; status++) {
        const char *text = bcifs_status_text((bcifs_status)status);
        good = good && text && text[0];
    }
    ok(good, "every status has words");
    ok(strcmp(bcifs_version(), BCIFS_VERSION) == 0, "the library is the header's version");
    size_t formats = 0;
    while (bcifs_format_name(formats)) {
        good = good && bcifs_format_text(formats) && bcifs_format_text(formats)[0];
        formats++;
    }
    ok(good && formats >= 6 && !bcifs_format_name(formats) && !bcifs_format_text(formats) &&
           !bcifs_format_is_picture(formats),
       "%zu formats, and nothing behind them", formats);
}

static void test_broken(void)
{
    static const struct {
        const char *text;
        int errors; /* 0: any number */
        unsigned line, column;
        const char *message;
    } cases[] = {
        {"", 0, 1, 1, "automaton"},
        {"automaton a\ncell c 2 { sub c [ 1 0; 1 ] }\n", 1, 2, 0, ""},
        {"automaton a\ncell c 2 {\n  sub joint [ 1 0; 0 1 ]\n}\n", 1, 3, 7, "joint"},
        {"automaton a\nvertex end 1 { }\nvertex end 1 { }\n", 1, 3, 8, "end"},
        {"automaton a\ncell c 2 { sub c [ 1 0; 0 x ] }\ncell d 2 { sub d [ 1 0; 0 y ] }\n", 2, 2, 27, "x"},
        {"automaton a\nparam a = 1/0\n", 1, 2, 12, "zero"},
        {"automaton a\nfigure f { open arc points [ 0 ] }\n", 1, 2, 17, "arc"},
        {"automaton a\n\xff\n", 1, 2, 1, "UTF-8"},
    };
    bool good = true;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct diagnostics seen = {.sane = true};
        bcifs_load_options options = {.report = report, .context = &seen};
        bcifs_error error = {0};
        bcifs_automaton *automaton = NULL;
        bcifs_status status =
            bcifs_load_text("a b.bcifs", cases[i].text, strlen(cases[i].text), &options, &automaton, &error);
        bool same = status == BCIFS_INPUT && error.status == status && !automaton && error.line == cases[i].line &&
                    (cases[i].column == 0 || error.column == cases[i].column) &&
                    strstr(error.message, cases[i].message) && strcmp(error.file, "a b.bcifs") == 0;
        same = same && seen.sane && seen.errors >= 1 && (cases[i].errors == 0 || seen.errors == cases[i].errors) &&
               seen.first.line == error.line && seen.first.column == error.column &&
               strcmp(seen.first.message, error.message) == 0;
        /* Without anyone to tell, too. */
        same = same && bcifs_load_text("a b.bcifs", cases[i].text, strlen(cases[i].text), NULL, &automaton, NULL) == status;
        if (!same) {
            note("%zu: status %d, %d errors, %s:%u:%u: %s", i, (int)status, seen.errors, error.file, error.line,
                 error.column, error.message);
            good = false;
        }
    }
    ok(good, "broken texts: the place and the words, to the error and to the reporter");
    /* At most 20 errors are reported. */
    static char many[20000] = "automaton a\n";
    for (int i = 0; i < 100; i++)
        sprintf(many + strlen(many), "cell c%d 1 { sub c%d [ x%d ] }\n", i, i, i);
    struct diagnostics seen = {.sane = true};
    bcifs_load_options options = {.report = report, .context = &seen};
    bcifs_automaton *automaton = NULL;
    bcifs_error error;
    ok(bcifs_load_text("many", many, strlen(many), &options, &automaton, &error) == BCIFS_INPUT && seen.errors == 20,
       "%d of 100 errors", seen.errors);
    ok(bcifs_load("/no/such/file.bcifs", NULL, &automaton, &error) == BCIFS_INPUT && error.line == 0 &&
           strstr(error.file, "/no/such/file.bcifs"),
       "a file that is not there: %s", error.message);
    static const char nul[] = "automaton a\n\0cell";
    ok(bcifs_load_text("nul", nul, sizeof nul - 1, NULL, &automaton, &error) == BCIFS_INPUT && error.line == 2,
       "a NUL in the text: %s", error.message);
}

static void test_settings(void)
{
    static const char *const good[] = {"w=1/4"};
    static const char *const bad[][2] = {{"v=1", "v"}, {"w", "="}, {"w=", ""}, {"w=x", "x"}, {"w=2", "0..1"}, {"=1", ""}};
    bcifs_automaton *automaton = NULL;
    bcifs_figure *figure = NULL;
    bcifs_load_options options = {.settings = good, .setting_count = 1};
    bcifs_error error = {0};
    double point[2] = {0, 0};
    bool set = bcifs_load_text("t", arcs, strlen(arcs), &options, &automaton, &error) == BCIFS_OK &&
               bcifs_figure_create(automaton, NULL, &figure, &error) == BCIFS_OK &&
               bcifs_point_at(figure, 0.25, point, &error) == BCIFS_OK;
    /* w = 1/4 is the parabola 2x(1 - x) with its apex at 1. */
    ok(set && point[0] == 0.25 && fabs(point[1] - 0.375) < 1e-15, "a param is set: %s", error.message);
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
    bool refused = true;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        automaton = NULL;
        options.settings = &bad[i][0];
        bcifs_status status = bcifs_load_text("t", arcs, strlen(arcs), &options, &automaton, &error);
        if (status != BCIFS_INPUT || automaton || !strstr(error.message, bad[i][1])) {
            note("'%s': status %d: %s", bad[i][0], (int)status, error.message);
            refused = false;
            bcifs_automaton_free(automaton);
        }
    }
    ok(refused, "settings that make no sense are refused");
}

static void test_figures(void)
{
    bcifs_error error;
    bcifs_automaton *automaton = load(arcs, &error);
    static const double points[] = {0, 0, 1, 2, 2, 0, 3, 3}, bad[] = {0, 0, NAN, 2, 2, 0}, worse[] = {0, 0, 1, INFINITY, 2, 0};
    static const struct {
        bcifs_figure_options options;
        const char *message;
    } cases[] = {
        {{.figure = "curves"}, "curve"},
        {{.state = "arcs"}, "arc"},
        {{.state = "arc"}, "points"},
        {{.points = bad, .point_count = 3, .dimension = 2}, "finite"},
        {{.points = worse, .point_count = 3, .dimension = 2}, "finite"},
        {{.points = points, .point_count = 4, .dimension = 2}, "4"},
        {{.points = points, .point_count = 2, .dimension = 2}, "2"},
        {{.points = points, .point_count = 0, .dimension = 2}, "0"},
        {{.points = points, .point_count = 3, .dimension = 0}, "0"},
        {{.points = points, .point_count = 3, .dimension = 17}, "17"},
        {{.points = points, .point_count = SIZE_MAX, .dimension = 2}, ""},
        {{.state = "piece", .points = points, .point_count = 2, .dimension = 2}, "argument"},
    };
    bool refused = true;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bcifs_figure *figure = NULL;
        memset(&error, 0, sizeof error);
        bcifs_status status = bcifs_figure_create(automaton, &cases[i].options, &figure, &error);
        if (status != BCIFS_INPUT || figure || error.status != status || !strstr(error.message, cases[i].message)) {
            note("case %zu: status %d: %s", i, (int)status, error.message);
            refused = false;
            bcifs_figure_free(figure);
        }
        refused = refused && bcifs_figure_create(automaton, &cases[i].options, &figure, NULL) == status;
    }
    ok(refused, "figures that cannot be bound are refused with a reason");
    bcifs_figure *figure = NULL;
    ok(bcifs_figure_create(automaton, &(bcifs_figure_options){.state = "arc", .points = points, .point_count = 3, .dimension = 2},
                           &figure, &error) == BCIFS_OK &&
           strcmp(bcifs_figure_name(figure), "") == 0 && bcifs_figure_dimension(figure) == 2 &&
           !bcifs_figure_is_attractor(figure),
       "a bare state is a figure without a name");
    bcifs_figure_free(figure);
    figure = NULL;
    ok(bcifs_figure_create(automaton, &(bcifs_figure_options){.figure = "dust"}, &figure, &error) == BCIFS_OK &&
           strcmp(bcifs_figure_name(figure), "dust") == 0 && bcifs_figure_is_attractor(figure) &&
           bcifs_figure_dimension(figure) == 2,
       "cells are attractors");
    bcifs_figure_free(figure);
    ok(strcmp(bcifs_automaton_name(automaton), "arcs") == 0 && strcmp(bcifs_automaton_title(automaton), "Arcs") == 0,
       "name and title");
    bcifs_automaton_free(automaton);
    automaton = load("automaton a\ncell c 1 { sub c [ 1 ] }\n", &error);
    figure = NULL;
    ok(automaton && strcmp(bcifs_automaton_title(automaton), "") == 0, "no title is an empty one");
    ok(bcifs_figure_create(automaton, NULL, &figure, &error) == BCIFS_INPUT && !figure, "no figure: %s", error.message);
    bcifs_automaton_free(automaton);
    automaton = load("automaton a\ncell c 2 { sub c [ ? 0; 1/2 1 ] }\nfigure f { piece c at 0 1 points [ 0; 1 ] }\n", &error);
    ok(automaton && bcifs_figure_create(automaton, NULL, &figure, &error) == BCIFS_INPUT && strstr(error.message, "?"),
       "entries to be completed: %s", error.message);
    bcifs_automaton_free(automaton);
}

/* Takagi's curve over a chord of length 1 and an apex 1 high has the area 1/2, clockwise. */
static void test_area(void)
{
    bcifs_error error;
    bcifs_automaton *automaton = load(arcs, &error);
    bcifs_figure *figure = NULL;
    bcifs_area *area = NULL;
    bool good = bcifs_figure_create(automaton, NULL, &figure, &error) == BCIFS_OK &&
                bcifs_area_create(figure, &area, &error) == BCIFS_OK;
    const bcifs_form *form = good ? bcifs_area_form(area, 0) : NULL;
    ok(good && bcifs_area_value(area) == -0.5 && bcifs_area_exact(area) &&
           strcmp(bcifs_area_fraction(area), "-1/2") == 0 && strcmp(form->state, "arc") == 0 && form->size == 3 &&
           form->exact && form->matrix[1] == 1 && form->matrix[2] == 0 && !bcifs_area_form(area, 1),
       "the area of Takagi's curve");
    bcifs_area_free(area);
    bcifs_figure_free(figure);
    area = NULL;
    good = bcifs_figure_create(automaton, &(bcifs_figure_options){.state = "spline", .unplaced = 1}, &figure, &error) ==
               BCIFS_OK &&
           bcifs_area_create(figure, &area, &error) == BCIFS_OK;
    ok(good && bcifs_area_value(area) == 0 && !bcifs_area_exact(area) && !bcifs_area_fraction(area) &&
           bcifs_area_form(area, 0)->size == 4,
       "a state without points has a form, no area");
    bcifs_area_free(area);
    bcifs_figure_free(figure);
    static const struct {
        const char *figure, *message;
    } cases[] = {{"line", "two coordinates"}, {"dust", "not a curve"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        area = NULL;
        good = bcifs_figure_create(automaton, &(bcifs_figure_options){.figure = cases[i].figure}, &figure, &error) ==
                   BCIFS_OK &&
               bcifs_area_create(figure, &area, &error) == BCIFS_INPUT && !area;
        ok(good && strstr(error.message, cases[i].message), "refused: %s", error.message);
        bcifs_figure_free(figure);
    }
    bcifs_automaton_free(automaton);
}

static void test_views(void)
{
    static const double seed[] = {0.5, 0.5, 0, 0}, off[] = {0.5, 0.6}, nan[] = {NAN};
    static const struct {
        bcifs_view view;
        const char *message;
    } cases[] = {
        {{.depth = 64}, "2^40"},
        {{.depth = 4097}, "4096"},
        {{.depth = UINT32_MAX}, "4096"},
        {{.depth = 3, .show = BCIFS_SEED, .seed = seed, .seed_count = 4}, "1 coordinate"},
        {{.depth = 3, .show = BCIFS_SEED, .seed = off, .seed_count = 2}, "sum to 1"},
        {{.depth = 3, .show = BCIFS_SEED, .seed = nan, .seed_count = 1}, "sum to 1"},
        {{.depth = 3, .show = BCIFS_SEED}, "sum to 1"},
        {{.depth = 3, .from = 0.5, .to = 0.25}, "0..1"},
        {{.depth = 3, .from = -0.5, .to = 0.25}, "0..1"},
        {{.depth = 3, .from = 0.5, .to = 1.5}, "0..1"},
        {{.depth = 3, .from = NAN, .to = 1}, "0..1"},
        {{.depth = 3, .from = 0, .to = NAN}, "0..1"},
        {{.depth = 1, .from = 0.1, .to = 0.2}, "no point"},
        {{.depth = 3, .show = BCIFS_CONTROL, .from = 0.25, .to = 0.5}, "control"},
    };
    bcifs_error error;
    bcifs_automaton *automaton = load(arcs, &error);
    bcifs_figure *figure = NULL;
    bcifs_figure_create(automaton, NULL, &figure, &error);
    bool refused = true;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bcifs_plan *plan = NULL;
        memset(&error, 0, sizeof error);
        bcifs_status status = bcifs_plan_create(figure, &cases[i].view, &plan, &error);
        if (status != BCIFS_INPUT || plan || !strstr(error.message, cases[i].message)) {
            note("case %zu: status %d: %s", i, (int)status, error.message);
            refused = false;
            bcifs_plan_free(plan);
        }
    }
    ok(refused, "views that cannot be shown are refused with a reason");
    static const char *const addresses[] = {"", "x", "1.", "-1.0", "0.2", "0.0x", "0.0.1", "0..1", "0.1,", "0.1,,0", "0 .1",
                                            "99999999999999999999.0", "0.-1", "0.1,2", "0.0,99999999999999999999"};
    double point[2];
    bool addressed = true;
    for (size_t i = 0; i < sizeof addresses / sizeof addresses[0]; i++) {
        bcifs_status status = bcifs_point_at_address(figure, addresses[i], point, &error);
        if (status != BCIFS_INPUT || !error.message[0]) {
            note("'%s': status %d", addresses[i], (int)status);
            addressed = false;
        }
    }
    ok(addressed, "addresses that lead nowhere are refused");
    ok(bcifs_point_at_address(figure, "0", point, &error) == BCIFS_OK && bcifs_point_at_address(figure, "0.", point, &error) == BCIFS_OK &&
           point[0] == 0,
       "an empty word is the start of the piece");
    bool outside = true;
    static const double parameters[] = {-1e-300, 1.0000001, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < 5; i++)
        outside = outside && bcifs_point_at(figure, parameters[i], point, &error) == BCIFS_INPUT;
    ok(outside, "parameters outside 0..1 are refused");
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
}

static void test_numbers(void)
{
    char text[40];
    double number;
    bcifs_error error;
    ok(bcifs_number_text(text, 0.1) == 3 && strcmp(text, "0.1") == 0, "a number as text");
    ok(bcifs_number_read("1/3", &number, &error) == BCIFS_OK && number == 1.0 / 3 &&
           bcifs_number_read("sqrt(2)/2", &number, NULL) == BCIFS_OK && number == sqrt(2) / 2 &&
           bcifs_number_read(" -2^2 ", &number, NULL) == BCIFS_OK && number == -4,
       "text as a number");
    static const char *const bad[] = {"", "x", "1/0", "1 2", "0..1", "nan", "inf", "0x10", "1e999", "?", "p[0]", "1,5", "sqrt(-1)"};
    bool good = true;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        number = 7;
        if (bcifs_number_read(bad[i], &number, &error) != BCIFS_INPUT || number != 7 || !error.message[0]) {
            note("'%s' is read as %g", bad[i], number);
            good = false;
        }
    }
    ok(good, "what is none");
}

/* A refuted equation is an answer, not a failure. */
static void test_check(void)
{
    bcifs_error error;
    bcifs_check *check = NULL;
    bcifs_automaton *automaton = load(arcs, &error);
    ok(bcifs_check_create(automaton, NULL, &check, &error) == BCIFS_OK && bcifs_check_valid(check), "equations that hold");
    bool good = true;
    for (size_t i = 0; i < bcifs_check_equation_count(check); i++) {
        const bcifs_equation *equation = bcifs_check_equation(check, i);
        good = good && equation->holds && equation->exact && equation->residual == 0 && equation->text[0] &&
               equation->state[0] && equation->line > 0 && !equation->left && !equation->right;
    }
    ok(good && bcifs_check_equation_count(check) > 20, "all %zu exactly", bcifs_check_equation_count(check));
    double lower, upper;
    const char *product;
    bcifs_check_contraction(check, &lower, &upper, &product);
    ok(lower > 0 && lower <= upper && product, "contraction within %g .. %g by %s", lower, upper, product);
    bcifs_check_free(check);
    bcifs_automaton_free(automaton);
    check = NULL;
    automaton = load("automaton a\nparam w = 1/4\ncell c 2 { sub c [ w 0; 1/2 1 ] }\n", &error);
    ok(bcifs_check_create(automaton, NULL, &check, &error) == BCIFS_OK && !bcifs_check_valid(check), "one that does not");
    const bcifs_equation *equation = bcifs_check_equation(check, 0);
    ok(!equation->holds && equation->exact && equation->residual > 0 && equation->kind == BCIFS_BARYCENTRIC &&
           strstr(equation->at, "w = "),
       "is shown: %s at %s", equation->text, equation->at);
    char *json = bcifs_check_json(check), *text = bcifs_check_text(check);
    ok(json && text && json[0] == '{' && text[0], "as JSON and as text");
    bcifs_text_free(json);
    bcifs_text_free(text);
    bcifs_check_free(check);
    bcifs_automaton_free(automaton);
    struct diagnostics seen = {.sane = true};
    bcifs_load_options options = {.report = report, .context = &seen};
    automaton = load("automaton a\ncell c 2 { sub c [ 1 0; 0 1 ] }\n", &error);
    check = NULL;
    ok(bcifs_check_create(automaton, &options, &check, &error) == BCIFS_OK && bcifs_check_valid(check) &&
           seen.warnings == 1 && seen.errors == 0 && seen.sane,
       "a map that does not contract is a warning");
    bcifs_check_free(check);
    bcifs_automaton_free(automaton);
}

/* ---- Every allocation fails ---------------------------------------------------------------------------- */

static char directory[] = "/tmp/bcifs-test-XXXXXX";

/* Each step returns BCIFS_OK or the status of what failed; it frees all it made. */
static bcifs_status use_load(bcifs_error *error)
{
    bcifs_automaton *automaton = NULL;
    bcifs_status status = bcifs_load_text("text", arcs, strlen(arcs), NULL, &automaton, error);
    bcifs_automaton_free(automaton);
    return status;
}

static bcifs_status use_file(bcifs_error *error)
{
    bcifs_automaton *automaton = NULL;
    static const char *const settings[] = {"w=1/3"};
    bcifs_load_options options = {.settings = settings, .setting_count = 1};
    bcifs_status status = bcifs_load("arcs.bcifs", &options, &automaton, error);
    bcifs_automaton_free(automaton);
    return status;
}

static bcifs_status use_format(bcifs_error *error)
{
    char *original = NULL, *formatted = NULL;
    bcifs_status status = bcifs_format_file("arcs.bcifs", NULL, &original, &formatted, error);
    bcifs_text_free(original);
    bcifs_text_free(formatted);
    return status;
}

static bcifs_automaton *shared; /* loaded before anything fails */
static bcifs_figure *shared_figure;

static char *whole_json, *whole_text; /* of a check that had all its memory */

/* The texts of a check are NULL without memory, and otherwise complete. */
static bcifs_status use_check_text(bcifs_error *error)
{
    bcifs_check *check = NULL;
    bcifs_status status = bcifs_check_create(shared, NULL, &check, error);
    char *json = status == BCIFS_OK ? bcifs_check_json(check) : NULL;
    char *text = status == BCIFS_OK ? bcifs_check_text(check) : NULL;
    if (status == BCIFS_OK && (!json || !text)) {
        status = BCIFS_MEMORY;
        *error = (bcifs_error){.status = status, .message = "no memory"};
    } else if (status == BCIFS_OK && whole_json && (strcmp(json, whole_json) != 0 || strcmp(text, whole_text) != 0)) {
        note("a check that lacked memory says something else");
        status = BCIFS_NO;
    }
    if (status == BCIFS_OK && !whole_json) {
        whole_json = strdup(json);
        whole_text = strdup(text);
    }
    bcifs_text_free(json);
    bcifs_text_free(text);
    bcifs_check_free(check);
    return status;
}

static bcifs_status use_figures(bcifs_error *error)
{
    static const char *const names[] = {"curve", "ring", "line", "dust"};
    bcifs_status status = BCIFS_OK;
    for (int i = 0; i < 4 && status == BCIFS_OK; i++) {
        bcifs_figure *figure = NULL;
        status = bcifs_figure_create(shared, &(bcifs_figure_options){.figure = names[i]}, &figure, error);
        bcifs_figure_free(figure);
    }
    return status;
}

static bcifs_status use_plan(bcifs_error *error)
{
    static const double seed[] = {0.25, 0.5, 0.25};
    bcifs_status status = BCIFS_OK;
    for (int show = BCIFS_LIMIT; show <= BCIFS_SEED && status == BCIFS_OK; show++) {
        bcifs_plan *plan = NULL;
        bcifs_walker *walker = NULL;
        double points[20];
        bcifs_view view = {.depth = 12, .show = (bcifs_show)show, .seed = seed, .seed_count = 3};
        status = bcifs_plan_create(shared_figure, &view, &plan, error);
        if (status == BCIFS_OK)
            status = bcifs_walker_create(plan, &walker, error);
        if (status == BCIFS_OK)
            bcifs_walker_next(walker, points, 10);
        bcifs_walker_free(walker);
        bcifs_plan_free(plan);
    }
    return status;
}

static bcifs_status use_point(bcifs_error *error)
{
    double point[2];
    bcifs_status status = bcifs_point_at(shared_figure, 1.0 / 3, point, error);
    return status ? status : bcifs_point_at_address(shared_figure, "2.0110", point, error);
}

static bcifs_status use_area(bcifs_error *error)
{
    bcifs_area *area = NULL;
    bcifs_status status = bcifs_area_create(shared_figure, &area, error);
    char *json = status == BCIFS_OK ? bcifs_area_json(area) : NULL;
    char *text = status == BCIFS_OK ? bcifs_area_text(area) : NULL;
    if (status == BCIFS_OK && (!json || !text)) {
        status = BCIFS_MEMORY;
        *error = (bcifs_error){.status = status, .message = "no memory"};
    }
    bcifs_text_free(json);
    bcifs_text_free(text);
    bcifs_area_free(area);
    return status;
}

static bcifs_status use_area_matrix(bcifs_error *error)
{
    static const char *const formats[] = {"txt", "json", "csv", "mtx", "svg", "png"};
    bcifs_area_matrix *matrix = NULL;
    bcifs_status status = bcifs_area_matrix_create(shared_figure, 2, 2, &matrix, error);
    for (size_t i = 0; i < sizeof formats / sizeof *formats && status == BCIFS_OK; i++) {
        char path[40];
        snprintf(path, sizeof path, "out.%s", formats[i]);
        status = bcifs_area_matrix_write(matrix, path, &(bcifs_write_options){.width = 240}, error);
        if ((access(path, F_OK) == 0) != (status == BCIFS_OK))
            note("%s: status %d, file %s", path, (int)status, status ? "left behind" : "missing"), status = BCIFS_NO;
        remove(path);
    }
    bcifs_area_matrix_free(matrix);
    return status;
}

static bcifs_status use_points(bcifs_error *error)
{
    double *points = NULL;
    size_t count;
    unsigned dimension;
    bcifs_status status = bcifs_points_read("points.csv", NULL, &points, &count, &dimension, error);
    bcifs_points_free(points);
    return status;
}

static bcifs_status use_curves(bcifs_error *error)
{
    static const char *const paths[] = {"path.svg", "points.csv"};
    bcifs_status status = BCIFS_OK;
    for (int i = 0; i < 2 && status == BCIFS_OK; i++) {
        bcifs_curve *curve = NULL;
        bcifs_figure *figure = NULL;
        bcifs_plan *plan = NULL;
        status = bcifs_curve_read(paths[i], NULL, &curve, error);
        const bcifs_figure_options options = {.figure = "curve", .curve = curve};
        if (status == BCIFS_OK)
            status = bcifs_figure_create(shared, &options, &figure, error);
        if (status == BCIFS_OK)
            status = bcifs_plan_create(figure, &(bcifs_view){.depth = 2}, &plan, error);
        const bcifs_layer layers[] = {{.plan = plan}, {.curve = curve, .role = BCIFS_TARGET}};
        const bcifs_write_options writing = {.width = 50};
        if (status == BCIFS_OK)
            status = bcifs_write(figure, layers, 2, "out.svg", &writing, error);
        remove("out.svg");
        bcifs_plan_free(plan);
        bcifs_figure_free(figure);
        bcifs_curve_free(curve);
    }
    return status;
}

static bcifs_status use_fit(bcifs_error *error)
{
    bcifs_curve *curve = NULL;
    bcifs_fit *fit = NULL;
    const bcifs_fit_options options = {.figure = "curve", .depth = 3, .iterations = 2};
    bcifs_status status = bcifs_curve_read("points.csv", NULL, &curve, error);
    if (status == BCIFS_OK)
        status = bcifs_fit_create(shared, curve, &options, &fit, error);
    char *csv = status ? NULL : bcifs_fit_csv(fit), *json = status ? NULL : bcifs_fit_json(fit);
    if (status == BCIFS_OK && (!csv || !json)) {
        status = BCIFS_MEMORY;
        *error = (bcifs_error){.status = status, .message = "no memory"};
    }
    bcifs_text_free(csv);
    bcifs_text_free(json);
    bcifs_fit_free(fit);
    bcifs_curve_free(curve);
    return status;
}

static bcifs_status use_write(bcifs_error *error)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; bcifs_format_name(i) && status == BCIFS_OK; i++) {
        bcifs_plan *plan = NULL, *polygon = NULL;
        char path[40];
        snprintf(path, sizeof path, "out.%s", bcifs_format_name(i));
        status = bcifs_plan_create(shared_figure, &(bcifs_view){.depth = 5}, &plan, error);
        if (status == BCIFS_OK)
            status = bcifs_plan_create(shared_figure, &(bcifs_view){.show = BCIFS_CONTROL}, &polygon, error);
        bcifs_layer layers[] = {{.plan = plan, .role = BCIFS_CURVE}, {.plan = polygon, .role = BCIFS_POLYGON}};
        bcifs_write_options options = {.command = "bcifs", .width = 50};
        if (status == BCIFS_OK)
            status = bcifs_write(shared_figure, layers, bcifs_format_is_picture(i) ? 2 : 1, path, &options, error);
        /* A file that could not be written whole is not there. */
        if ((access(path, F_OK) == 0) != (status == BCIFS_OK))
            note("%s: status %d, file %s", path, (int)status, status ? "left behind" : "missing"), status = BCIFS_NO;
        remove(path);
        bcifs_plan_free(polygon);
        bcifs_plan_free(plan);
    }
    return status;
}

static bcifs_status use_text(bcifs_error *error)
{
    bcifs_status status = bcifs_write_text("out.txt", "text\n", 5, error);
    remove("out.txt");
    return status;
}

/* The k-th request fails, then the k-th and all after it. A function may do without what it asked for only where
 * its results are compared. */
static void test_failing(const char *what, bcifs_status (*use)(bcifs_error *), bool may_do_without)
{
    bool good = true;
    long k = 0, tried = 0, before = alive;
    bcifs_error error;
    fail_at = 0;
    bcifs_status status = use(&error);
    good = status == BCIFS_OK && alive == before;
    if (!good)
        note("%s: works without failures: status %d, %s; %ld blocks left", what, (int)status, error.message,
             alive - before);
    for (int mode = 0; mode < 2 && good; mode++) {
        status = BCIFS_MEMORY;
        /* Every one of the first, then some: a check makes thousands. */
        for (k = 1; good && k < 1000000; k += 1 + k / test_effort(100)) {
            tried++;
            memset(&error, 0, sizeof error);
            requests = 0;
            fail_at = k;
            fail_after = mode == 1;
            status = use(&error);
            bool reached = requests >= k;
            fail_at = 0;
            if (!reached)
                break;
            bool told = status == BCIFS_MEMORY && error.status == BCIFS_MEMORY && error.message[0];
            good = (told || (status == BCIFS_OK && may_do_without)) && alive == before;
            if (!good)
                note("%s: request %ld fails%s: status %d (%d), '%s', %ld blocks left", what, k,
                     mode ? " and all after it" : "", (int)status, (int)error.status, error.message, alive - before);
        }
        good = good && status == BCIFS_OK;
    }
    fail_after = false;
    good = good && use(&error) == BCIFS_OK && alive == before;
    ok(good, "%s: %ld of some %ld requests may fail", what, tried / 2, k - 1);
}

static void file_make(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    if (!file || fputs(text, file) < 0 || fclose(file) != 0)
        abort();
}

static void test_memory(void)
{
    bcifs_error error;
    if (!mkdtemp(directory) || chdir(directory) != 0)
        abort();
    file_make("arcs.bcifs", arcs);
    file_make("points.csv", "x,y\n0,0\n1,2\n2,0\n");
    file_make("path.svg", "<svg><g transform='scale(2)'><path d='M0 0L1 2C2 2 3 2 4 0L5 5 6 6'/></g></svg>");
    shared = load(arcs, &error);
    if (bcifs_figure_create(shared, &(bcifs_figure_options){.figure = "ring"}, &shared_figure, &error) != BCIFS_OK)
        abort();
    test_failing("load_text", use_load, false);
    test_failing("load", use_file, false);
    test_failing("format_file", use_format, false);
    test_failing("check_json, check_text", use_check_text, true);
    test_failing("figure", use_figures, false);
    test_failing("plan and walker", use_plan, false);
    test_failing("point_at", use_point, false);
    test_failing("area", use_area, false);
    test_failing("area_matrix", use_area_matrix, false);
    test_failing("points_read", use_points, false);
    test_failing("curve_read, pictures of it", use_curves, false);
    test_failing("fit", use_fit, false);
    test_failing("write", use_write, false);
    test_failing("write_text", use_text, false);
    bcifs_figure_free(shared_figure);
    bcifs_automaton_free(shared);
    free(whole_json);
    free(whole_text);
    remove("arcs.bcifs");
    remove("points.csv");
    remove("path.svg");
    ok(chdir("/") == 0 && rmdir(directory) == 0, "no file is left behind");
    ok(alive == 0, "no block is left over");
}

int main(void)
{
    test_nothing();
    test_broken();
    test_settings();
    test_figures();
    test_area();
    test_views();
    test_numbers();
    test_check();
    ok(alive == 0, "nothing was lost on the way");
    test_memory();
    return done_testing();
}
