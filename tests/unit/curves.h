/* Curves: every planar curve figure of the gallery, and of some schemes that it lacks, for tests of what
 * works on any curve. */
#ifndef TESTS_CURVES_H
#define TESTS_CURVES_H

#include <dirent.h>
#include <math.h>
#include <string.h>

#include "automaton/figure.h"
#include "tap.h"

/* Ternary and dense masks, the quintic B-spline; two states that alternate; chains of pieces. */
static const char curves_extra[] =
    "automaton extra\n"
    "edge ternary { mask 3 [ 1/27 4/27 10/27 16/27 19/27 16/27 10/27 4/27 1/27 ] }\n"
    "edge dense { mask 2 [ 1/2 1 1/2 ] }\n"
    "edge quintic { mask 2 [ 1/32 6/32 15/32 20/32 15/32 6/32 1/32 ] }\n"
    "vertex end 1 { }\n"
    "edge a 2 { start end at 0 end end at 1\n"
    "  sub b [ 1 4/5; 0 1/5 ]  sub a [ 4/5 1/2; 1/5 1/2 ]  sub b [ 1/2 0; 1/2 1 ] }\n"
    "edge b 2 { start end at 0 end end at 1\n"
    "  sub a [ 1 1/3; 0 2/3 ]  sub a [ 1/3 0; 2/3 1 ] }\n"
    "edge bent_a 3 { start end at 0 end end at 2\n"
    "  sub bent_b [ 1 2/5 1/4; 0 1/2 1/2; 0 1/10 1/4 ]  sub bent_a [ 1/4 -1/10 0; 1/2 3/5 0; 1/4 1/2 1 ] }\n"
    "edge bent_b 3 { start end at 0 end end at 2\n"
    "  sub bent_a [ 1 1/2 1/3; 0 1/2 1/3; 0 0 1/3 ]  sub bent_b [ 1/3 0 0; 1/3 1/4 0; 1/3 3/4 1 ] }\n"
    "figure ternary { closed ternary points [ 0 0; 1 0; 3 4; 1 1; 0 7 ] }\n"
    "figure open_ternary { open ternary points [ 0 0; 1 0; 3 4; 1 1; 0 7; 2 2 ] }\n"
    "figure dense { closed dense points [ 0 0; 1 0; 3 4 ] }\n"
    "figure quintic { closed quintic points [ 0 0; 1 0; 3 4; 5 5; 2 6; -1 3 ] }\n"
    "figure open_quintic { open quintic points [ 0 0; 1 0; 3 4; 5 5; 6 0; 7 1; 8 2; 9 9 ] }\n"
    "figure mixed { open a points [ 0 0; 1 3; 2 -1; 4 4 ] }\n"
    "figure bent { closed bent_a points [ 0 0; 1 3; 2 -1; 4 4; 3 5; 1 4 ] }\n"
    "figure chains { piece a at 0 1 piece b at 1 2 piece a at 3 4 points [ 0 0; 1 3; 2 -1; 4 4; 5 0 ] }\n";

/* One figure of one file: its name in messages, and its own control points. */
struct curve_sample {
    const bcifs_automaton *automaton;
    const char *figure;
    char name[160];
    const double *points; /* count × 2 */
    size_t count;
};

typedef void curve_test(const struct curve_sample *sample);

static inline void curves_of(const bcifs_automaton *automaton, const char *from, curve_test *test)
{
    for (size_t i = 0; i < automaton->figure_count; i++) {
        struct curve_sample sample = {.automaton = automaton, .figure = automaton->figures[i].name};
        const bcifs_figure_options options = {.figure = sample.figure};
        bcifs_figure *figure = NULL;
        snprintf(sample.name, sizeof sample.name, "%.70s, %.70s", from, sample.figure);
        if (bcifs_figure_create(automaton, &options, &figure, NULL) == BCIFS_OK &&
            figure->shape == FIGURE_CURVE && !figure->displaced && figure->dimension == 2) {
            sample.points = figure->points;
            sample.count = figure->point_count;
            test(&sample);
        }
        bcifs_figure_free(figure);
    }
}

/* Hands every figure to `test`. */
static inline void curves_each(curve_test *test)
{
    bcifs_automaton *automaton = NULL;
    struct dirent **entries;
    int count = scandir("automata", &entries, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        char path[300];
        snprintf(path, sizeof path, "automata/%s", entries[i]->d_name);
        free(entries[i]);
        if (!strstr(path, ".bcifs") || bcifs_load(path, NULL, &automaton, NULL))
            continue;
        curves_of(automaton, path, test);
        bcifs_automaton_free(automaton);
    }
    if (count >= 0)
        free(entries);
    if (bcifs_load_text("extra", curves_extra, strlen(curves_extra), NULL, &automaton, NULL) == BCIFS_OK) {
        curves_of(automaton, "extra", test);
        bcifs_automaton_free(automaton);
    }
}

/* The sample's figure on other points (count × 2), or on its own; NULL when it cannot be. */
static inline bcifs_figure *curve_figure(const struct curve_sample *sample, const double *points)
{
    const bcifs_figure_options options = {.figure = sample->figure,
                                          .points = points,
                                          .point_count = points ? sample->count : 0,
                                          .dimension = points ? 2 : 0};
    bcifs_figure *figure = NULL;
    bcifs_error error;
    if (bcifs_figure_create(sample->automaton, &options, &figure, &error))
        note("%s: %s", sample->name, error.message);
    return figure;
}

/* An even number in -1 … 1. */
static inline double random_number(uint64_t *state)
{
    return (double)(random_bits(state) >> 11) * 0x1p-52 - 1;
}

/* The sample's points, each moved by up to `share` of the figure's size: count × 2 numbers. */
static inline void curve_points(const struct curve_sample *sample, double share, uint64_t *state,
                                double *points)
{
    double size = 0;
    for (size_t i = 0; i < 2 * sample->count; i++)
        size = fmax(size, fabs(sample->points[i] - sample->points[i % 2]));
    for (size_t i = 0; i < 2 * sample->count; i++)
        points[i] = sample->points[i] + share * size * random_number(state);
}

#endif
