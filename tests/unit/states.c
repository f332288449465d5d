/* States: which are reached, when two are the same, and their limit points against fixed points found by hand. */
#include <math.h>
#include <string.h>

#include "automaton/figure.h"
#include "automaton/states.h"
#include "numeric/tolerance.h"
#include "tap.h"

/* An automaton, its first figure, and a table of states that may grow. */
struct sample {
    bcifs_automaton *automaton;
    bcifs_figure *figure;
    struct states states;
    struct arena arena;
    struct report report;
};

static bool sample_open(struct sample *sample, const char *text)
{
    bcifs_error error;
    *sample = (struct sample){.report = report_new(NULL)};
    bcifs_status status = bcifs_load_text("text", text, strlen(text), NULL, &sample->automaton, &error);
    if (status == BCIFS_OK)
        status = bcifs_figure_create(sample->automaton, NULL, &sample->figure, &error);
    if (status == BCIFS_OK)
        status = states_copy(&sample->states, &sample->figure->states, &sample->arena, &sample->report);
    if (status)
        note("%u:%u: %s", error.line, error.column, error.message);
    return status == BCIFS_OK;
}

static void sample_close(struct sample *sample)
{
    arena_free(&sample->arena);
    bcifs_figure_free(sample->figure);
    bcifs_automaton_free(sample->automaton);
}

/* Expands until nothing new comes, or `most` states are there. */
static bcifs_status expand_all(struct sample *sample, size_t most)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < sample->states.count && i < most && status == BCIFS_OK; i++)
        status = states_expand(&sample->states, i);
    return status;
}

static size_t state_named(const struct sample *sample, const char *name)
{
    for (size_t i = 0; i < sample->states.count; i++) {
        struct text text = {0};
        state_name(&sample->states.states[i].key, &text);
        bool same = strcmp(text.data, name) == 0;
        text_free(&text);
        if (same)
            return i;
    }
    return SIZE_MAX;
}

static bool limit_is(struct sample *sample, const char *name, const double *expected, size_t count)
{
    double point[8], error = 0;
    size_t state = state_named(sample, name);
    if (state == SIZE_MAX || sample->states.states[state].points != count ||
        states_limit(&sample->states, state, point) != BCIFS_OK) {
        note("no limit of %s: %s", name, sample->report.first.message);
        return false;
    }
    for (size_t i = 0; i < count; i++)
        error = fmax(error, fabs(point[i] - expected[i]));
    /* Two units in the last place of 1 for a fixed point; a product of maps stops at TOLERANCE_LIMIT. */
    double tolerance = strncmp(name, "c(", 2) == 0 ? TOLERANCE_LIMIT : 4e-16;
    if (error > tolerance)
        note("limit of %s is %g off: %.17g %.17g …", name, error, point[0], point[1]);
    return error <= tolerance;
}

/* ---- Reached states ------------------------------------------------------------------------------------ */

/* [SI]: p(u,v,w) leads to left(u,v), right(v,w), uniform and the vertices k(u,v), k(v,w), joint: no more, however
 * the intervals are written. */
#define NONUNIFORM                                                                                          \
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
    "  sub uniform [ 3/4 1/4 0; 1/4 3/4 3/4; 0 0 1/4 ] sub uniform [ 1/4 0 0; 3/4 3/4 1/4; 0 1/4 3/4 ] }\n"  \
    "figure f { "

static void test_reached(void)
{
    static const struct {
        const char *figure;
        size_t states;
    } cases[] = {
        {"open p intervals [ 1 2 3 ] points [ 0; 1; 2 ] }", 7},
        /* p(1,1,1), k(1,1), left(1,1), right(1,1), uniform, joint. */
        {"open p intervals [ 1 1 1 ] points [ 0; 1; 2 ] }", 6},
        {"open p intervals [ 1/2 0.5 5e-1 ] points [ 0; 1; 2 ] }", 6},
        /* Equal numbers that doubles tell apart. */
        {"open p intervals [ 0.3 0.1+0.2 3/10 ] points [ 0; 1; 2 ] }", 6},
        /* Two pieces p(1,2,1), p(2,1,2): k(1,2), k(2,1), left and right of both, uniform, joint. */
        {"open p intervals [ 1 2 1 2 ] points [ 0; 1; 2; 3 ] }", 10},
        {"closed p intervals [ 1 1 1 1 1 ] points [ 0; 1; 2; 3; 4 ] }", 6},
    };
    bool good = true;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[4000];
        struct sample sample;
        snprintf(text, sizeof text, "%s%s", NONUNIFORM, cases[i].figure);
        bool found = sample_open(&sample, text) && expand_all(&sample, 1000) == BCIFS_OK;
        if (!found || sample.states.count != cases[i].states) {
            note("%s: %zu states, expected %zu", cases[i].figure, sample.states.count, cases[i].states);
            for (size_t k = 0; k < sample.states.count; k++) {
                struct text name = {0};
                state_name(&sample.states.states[k].key, &name);
                note("  %s", name.data);
                text_free(&name);
            }
            good = false;
        }
        sample_close(&sample);
    }
    ok(good, "non-uniform splines reach a handful of states");
}

/* Interning the same state twice gives the same index, also after the table has grown. */
static void test_intern(void)
{
    struct sample sample;
    bool good = sample_open(&sample, "automaton a\nvertex end 1 { }\n"
                                     "edge e(u) 2 { start end at 0 end end at 1\n"
                                     "  sub e(3*u+1) [ 1 1/2; 0 1/2 ] sub e(u/2) [ 1/2 0; 1/2 1 ] }\n"
                                     "figure f { open e(1) points [ 0; 1 ] }\n");
    good = good && expand_all(&sample, 3000) == BCIFS_OK;
    size_t count = sample.states.count;
    for (size_t i = 0; i < count && good; i++) {
        size_t index;
        good = states_intern(&sample.states, sample.states.states[i].key, &index) == BCIFS_OK && index == i;
        const struct state *state = &sample.states.states[i];
        for (size_t k = 0; state->expanded && strcmp(state->key.definition->name, "e") == 0 && k < 2; k++) {
            const struct state *child = &sample.states.states[state->children[k]];
            double u = state->key.arguments[0].real, expected = k == 0 ? 3 * u + 1 : u / 2;
            good = good && fabs(child->key.arguments[0].real - expected) <= 1e-12 * expected;
        }
    }
    ok(good && sample.states.count == count && count > 3000, "%zu states, each found again", count);
    sample_close(&sample);
}

/* ---- Limit points -------------------------------------------------------------------------------------- */

static void test_limits(void)
{
    struct sample sample;
    /* T^s c = c by hand, [SI] and [IM] (3). */
    char text[4000];
    snprintf(text, sizeof text, "%s%s", NONUNIFORM, "open p intervals [ 1 3 2 ] points [ 0; 1; 2 ] }");
    bool good = sample_open(&sample, text) && expand_all(&sample, 100) == BCIFS_OK;
    /* The curve touches side i at the fraction u/(u + v). */
    good = good && limit_is(&sample, "joint", (double[]){0.5, 0.5}, 2) &&
           limit_is(&sample, "k(1,3)", (double[]){0.75, 0.25}, 2) && limit_is(&sample, "k(3,2)", (double[]){0.4, 0.6}, 2);
    /* An edge's limit is the one of its first map: its start. */
    good = good && limit_is(&sample, "uniform", (double[]){0.5, 0.5, 0}, 3) &&
           limit_is(&sample, "p(1,3,2)", (double[]){0.75, 0.25, 0}, 3);
    ok(good, "joints of quadratic B-splines");
    sample_close(&sample);
    good = sample_open(&sample, "automaton a\nedge arc { mask 2 [ 1/8 1/2 3/4 1/2 1/8 ] }\n"
                                "figure f { open arc points [ 0; 1; 2; 3 ] }\n");
    size_t joint = good ? sample.figure->states.states[sample.figure->pieces[0].state].boundaries[0] : 0;
    double point[3];
    good = good && states_limit(&sample.states, joint, point) == BCIFS_OK && fabs(point[0] - 1.0 / 6) < 2e-16 &&
           fabs(point[1] - 2.0 / 3) < 2e-16 && fabs(point[2] - 1.0 / 6) < 2e-16;
    ok(good, "the cubic joint: 1/6, 2/3, 1/6");
    sample_close(&sample);
}

static void test_cycles(void)
{
    struct sample sample;
    /* x -> y -> z -> y: on two points, places of a line. x takes y's frame at 1/2, y z's at 1/3, z y's at 1/5 from
     * the first point, all half as long: a point s of the child is a + s/2 in the parent. The cycle's point s in y:
     * s = 1/3 + (1/5 + s/2)/2, so s = 26/45; in x 1/2 + s/2 = 71/90, in z 1/5 + s/2 = 22/45. */
    bool good = sample_open(&sample, "automaton a\n"
                                     "cell x 2 { sub y [ 1/2 0; 1/2 1 ] }\n"
                                     "cell y 2 { sub z [ 2/3 1/6; 1/3 5/6 ] }\n"
                                     "cell z 2 { sub y [ 4/5 3/10; 1/5 7/10 ] }\n"
                                     "figure f { piece x at 0 1 points [ 0; 1 ] }\n") &&
                expand_all(&sample, 10) == BCIFS_OK;
    good = good && limit_is(&sample, "x", (double[]){19.0 / 90, 71.0 / 90}, 2) &&
           limit_is(&sample, "y", (double[]){19.0 / 45, 26.0 / 45}, 2) &&
           limit_is(&sample, "z", (double[]){23.0 / 45, 22.0 / 45}, 2);
    ok(good, "limits through a cycle of states");
    sample_close(&sample);
    /* States that never come back: the cell n spans 1/2 to 1 of cell n - 1, up to 1. */
    good = sample_open(&sample, "automaton a\ncell c(n) 2 { sub c(n+1) [ 1/2 0; 1/2 1 ] }\n"
                                "figure f { piece c(1) at 0 1 points [ 0; 1 ] }\n");
    good = good && limit_is(&sample, "c(1)", (double[]){0, 1}, 2);
    ok(good, "limits of states that never return");
    sample_close(&sample);
}

static void test_none(void)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"automaton a\ncell c 2 { sub c [ 1 0; 0 1 ] }\nfigure f { piece c at 0 1 points [ 0; 1 ] }\n", "more than one"},
        {"automaton a\ncell c(n) 2 { sub c(n+1) [ 0 1; 1 0 ] }\nfigure f { piece c(1) at 0 1 points [ 0; 1 ] }\n",
         "converge"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct sample sample;
        double point[2];
        bool opened = sample_open(&sample, cases[i].text);
        bcifs_status status = opened ? states_limit(&sample.states, 0, point) : BCIFS_OK;
        ok(status == BCIFS_INPUT && strstr(sample.report.first.message, "'c") &&
               strstr(sample.report.first.message, cases[i].message),
           "no single limit point: %s", sample.report.first.message);
        sample_close(&sample);
    }
}

int main(void)
{
    test_reached();
    test_intern();
    test_limits();
    test_cycles();
    test_none();
    return done_testing();
}
