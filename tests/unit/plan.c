/* Plans, walkers and single points: the same bits wherever a walk begins, counts by brute force, memory that does
 * not grow with the depth, and the use of one plan by several threads. */
#include <dirent.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "evaluate/kernel.h"
#include "evaluate/plan.h"
#include "tap.h"

/* ---- Samples ------------------------------------------------------------------------------------------- */

/* States with two, three and four children, of two and three control points. */
static const char unequal[] =
    "automaton unequal\n"
    "vertex end 1 { }\n"
    "edge a 2 { start end at 0 end end at 1\n"
    "  sub b [ 1 4/5; 0 1/5 ]  sub a [ 4/5 1/2; 1/5 1/2 ]  sub c [ 1/2 1/4 0; 1/2 3/4 1 ] }\n"
    "edge b 2 { start end at 0 end end at 1\n"
    "  sub a [ 1 1/3; 0 2/3 ]  sub a [ 1/3 0; 2/3 1 ] }\n"
    "edge c 3 { start end at 0 end end at 2\n"
    "  sub b [ 1 1/4; 0 1/2; 0 1/4 ]\n"
    "  sub c [ 1/4 1/4 1/4; 1/2 1/3 1/2; 1/4 5/12 1/4 ]\n"
    "  sub a [ 1/4 0; 1/2 1/2; 1/4 1/2 ]\n"
    "  sub b [ 0 0; 1/2 0; 1/2 1 ] }\n"
    "figure open { open a points [ 0 1; 2 -3 ] }\n"
    "figure chains { piece a at 0 1 piece c at 1 2 3 piece b at 0 3 piece c at 2 1 0\n"
    "  points [ 0 0; 1 5; 2 -1; 7 7 ] }\n"
    "cell x 2 { sub x [ 1/2 0; 1/2 1 ] sub y [ 1/2 1/4 1/8; 1/2 3/4 7/8 ] }\n"
    "cell y 3 { sub x [ 1/2 0; 1/4 0; 1/4 1 ] sub x [ 1/3 0; 1/3 1; 1/3 0 ] sub y [ 1/2 0 0; 1/2 1/2 0; 0 1/2 1 ] }\n"
    "figure cells { piece x at 0 1 piece y at 1 2 3 piece x at 3 0 points [ 0 0; 1 5; 2 -1; 7 7 ] }\n";

/* One figure to be evaluated; the gallery's are found in its files. */
struct sample {
    bcifs_automaton *automaton;
    bcifs_figure *figure;
    char name[128];
};

enum { MOST_SAMPLES = 200 };
static struct sample samples[MOST_SAMPLES];
static size_t sample_count;

static void sample_add(bcifs_automaton *automaton, const char *from)
{
    for (size_t i = 0; i < automaton->figure_count && sample_count < MOST_SAMPLES; i++) {
        struct sample *sample = &samples[sample_count];
        bcifs_figure_options options = {.figure = automaton->figures[i].name};
        bcifs_error error;
        sample->automaton = i == 0 ? automaton : NULL;
        snprintf(sample->name, sizeof sample->name, "%.60s, %.60s", from, options.figure);
        bcifs_status status = bcifs_figure_create(automaton, &options, &sample->figure, &error);
        if (status == BCIFS_OK && sample->figure->shape != FIGURE_SURFACE && !sample->figure->displaced)
            sample_count++;
        else if (status)
            note("%s: %s", sample->name, error.message);
    }
}

static bcifs_automaton *load_text(const char *text)
{
    bcifs_automaton *automaton = NULL;
    bcifs_error error;
    if (bcifs_load_text("text", text, strlen(text), NULL, &automaton, &error) != BCIFS_OK)
        note("%u:%u: %s", error.line, error.column, error.message);
    return automaton;
}

static void samples_make(void)
{
    DIR *directory = opendir("automata");
    sample_add(load_text(unequal), "unequal");
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        char path[300];
        bcifs_automaton *automaton = NULL;
        snprintf(path, sizeof path, "automata/%s", entry->d_name);
        if (strstr(path, ".bcifs") && bcifs_load(path, NULL, &automaton, NULL) == BCIFS_OK)
            sample_add(automaton, path);
    }
    if (directory)
        closedir(directory);
    ok(sample_count > 30, "%zu figures to evaluate", sample_count);
}

static bcifs_plan *plan_of(const bcifs_figure *figure, bcifs_view view)
{
    bcifs_plan *plan = NULL;
    bcifs_plan_create(figure, &view, &plan, NULL);
    return plan;
}

/* All points in one call; the caller frees them. */
static double *walk_whole(const bcifs_plan *plan)
{
    bcifs_walker *walker = NULL;
    size_t count = (size_t)bcifs_plan_points(plan), dimension = bcifs_plan_dimension(plan);
    double *points = calloc(count * dimension + 1, sizeof *points);
    if (bcifs_walker_create(plan, &walker, NULL) != BCIFS_OK)
        return points;
    if (bcifs_walker_next(walker, points, count + 10) != count)
        note("the walk is not as long as the plan");
    bcifs_walker_free(walker);
    return points;
}

/* ---- Walks --------------------------------------------------------------------------------------------- */

/* Random jumps, random capacities: the same bits, nothing written beyond, 0 at the end. */
static bool walks_agree(const bcifs_plan *plan, const double *whole, uint64_t *random)
{
    size_t count = (size_t)bcifs_plan_points(plan), dimension = bcifs_plan_dimension(plan);
    double *part = calloc((count + 1) * dimension, sizeof *part);
    bcifs_walker *walker = NULL;
    if (!part || bcifs_walker_create(plan, &walker, NULL) != BCIFS_OK)
        return false;
    bool good = true;
    for (long i = 0; i < test_effort(60) && good; i++) {
        size_t index = (size_t)(random_bits(random) % (count + 2));
        size_t capacity = (size_t)(random_bits(random) % (i % 3 == 0 ? 4 : i % 3 == 1 ? 100 : count + 1));
        size_t expected = index >= count ? 0 : count - index < capacity ? count - index : capacity;
        if (i % 4 != 0)
            bcifs_walker_seek(walker, index);
        else
            bcifs_walker_seek(walker, index = 0), expected = capacity < count ? capacity : count;
        part[expected * dimension] = 1234.5;
        size_t found = bcifs_walker_next(walker, part, capacity);
        good = found == expected && part[expected * dimension] == 1234.5 &&
               memcmp(part, whole + index * dimension, found * dimension * sizeof *part) == 0;
        /* And on from there. */
        size_t more = bcifs_walker_next(walker, part, 5), rest = index + found < count ? count - index - found : 0;
        good = good && more == (rest < 5 ? rest : 5) &&
               (more == 0 ||
                memcmp(part, whole + (index + found) * dimension, more * dimension * sizeof *part) == 0);
        if (!good)
            note("index %zu, capacity %zu of %zu: %zu points", index, capacity, count, found);
    }
    /* Point by point, all of them. */
    bcifs_walker_seek(walker, 0);
    size_t index = 0;
    for (size_t step = 1; good && bcifs_walker_next(walker, part, step) > 0; index++)
        good = memcmp(part, whole + index * dimension, dimension * sizeof *part) == 0;
    good = good && index == count && bcifs_walker_next(walker, part, 1) == 0;
    bcifs_walker_free(walker);
    free(part);
    return good;
}

/* The deepest level with at most `points` points. */
static unsigned depth_for(const bcifs_figure *figure, uint64_t points)
{
    unsigned depth = bcifs_figure_depth(figure, points);
    return depth > 60 ? 60 : depth;
}

static void test_walks(void)
{
    uint64_t random = 1;
    bool limit = true, control = true, range = true;
    for (size_t i = 0; i < sample_count; i++) {
        const bcifs_figure *figure = samples[i].figure;
        for (unsigned round = 0; round < 3; round++) {
            bcifs_view view = {.depth = round == 0 ? 0 : depth_for(figure, round == 1 ? 700 : 12000)};
            bool *verdict = &limit;
            if (round == 1)
                view.show = BCIFS_CONTROL, verdict = &control;
            bcifs_plan *plan = plan_of(figure, view);
            if (!plan) {
                /* Control polygons need arcs whose joints are their first and last control points. */
                if (round != 1)
                    note("%s: no plan", samples[i].name), *verdict = false;
                continue;
            }
            double *whole = walk_whole(plan);
            bool good = walks_agree(plan, whole, &random);
            if (round == 2) {
                bcifs_view part = {.depth = view.depth, .from = 0.123, .to = 0.789};
                bcifs_plan *shorter = plan_of(figure, part);
                double *some = shorter ? walk_whole(shorter) : NULL;
                bool same = shorter && walks_agree(shorter, some, &random);
                if (!same)
                    note("%s: range", samples[i].name);
                range = range && same;
                free(some);
                bcifs_plan_free(shorter);
            }
            if (!good)
                note("%s: depth %u", samples[i].name, view.depth);
            *verdict = *verdict && good;
            free(whole);
            bcifs_plan_free(plan);
        }
    }
    ok(limit, "walks from anywhere have the bits of the whole walk");
    ok(control, "control points too");
    ok(range, "ranges too");
}

/* The index of the most points there may be: a chaikin square of depth 38 has 2^40. */
static void test_far(void)
{
    static const char text[] = "automaton far\nedge arc { mask 2 [ 1/4 3/4 3/4 1/4 ] }\n"
                               "figure f { closed arc points [ 0 0; 2 0; 2 2; 0 2 ] }\n";
    bcifs_automaton *automaton = load_text(text);
    bcifs_figure *figure = NULL;
    bcifs_error error;
    bcifs_figure_create(automaton, NULL, &figure, &error);
    bcifs_plan *plan = plan_of(figure, (bcifs_view){.depth = 38});
    bcifs_walker *walker = NULL;
    ok(plan && bcifs_plan_points(plan) == UINT64_C(1) << 40, "a plan of 2^40 points");
    ok(bcifs_figure_depth(figure, UINT64_C(1) << 40) == 38, "which is the greatest depth");
    bcifs_walker_create(plan, &walker, &error);
    uint64_t random = 5;
    double worst = 0;
    for (long i = 0; i < test_effort(300); i++) {
        uint64_t index = random_bits(&random) % (UINT64_C(1) << 40);
        double point[2], expected[2];
        bcifs_walker_seek(walker, index);
        bcifs_walker_next(walker, point, 1);
        /* The B-spline's side `piece` is a parabola, written out for the square's corners. */
        size_t piece = (size_t)(index >> 38);
        double t = ldexp((double)(index & ((UINT64_C(1) << 38) - 1)), -38);
        static const double square[][2] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
        for (int c = 0; c < 2; c++) {
            expected[c] = square[piece][c] * (1 - t) * (1 - t) / 2 +
                          square[(piece + 1) % 4][c] * (0.5 + t - t * t) + square[(piece + 2) % 4][c] * t * t / 2;
            worst = fmax(worst, fabs(point[c] - expected[c]));
        }
    }
    ok(worst < 1e-14, "points of depth 38 are on the B-spline: %g", worst);
    bcifs_walker_free(walker);
    bcifs_plan_free(plan);
    plan = NULL;
    ok(bcifs_plan_create(figure, &(bcifs_view){.depth = 39}, &plan, &error) == BCIFS_INPUT && !plan &&
           strstr(error.message, "2^40") && strstr(error.message, "38"),
       "one level more is refused: %s", error.message);
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
}

/* ---- Counts, paths and memory -------------------------------------------------------------------------- */

/* Cells below a state, one by one. */
static uint64_t count_cells(const struct states *states, size_t index, unsigned depth)
{
    if (depth == 0)
        return 1;
    const struct state *state = &states->states[index];
    uint64_t sum = 0;
    for (size_t k = 0; k < state->cell->child_count; k++)
        sum += count_cells(states, state->children[k], depth - 1);
    return sum;
}

static void test_counts(void)
{
    bool counts = true, paths = true, depths = true;
    for (size_t i = 0; i < sample_count; i++) {
        const bcifs_figure *figure = samples[i].figure;
        uint64_t least = figure->shape == FIGURE_ATTRACTOR ? 3 : 2;
        for (unsigned depth = 0; depth <= 6; depth++) {
            bcifs_plan *plan = plan_of(figure, (bcifs_view){.depth = depth});
            uint64_t expected = 0;
            for (size_t k = 0; k < figure->piece_count; k++)
                expected += count_cells(&plan->states, figure->pieces[k].state, depth);
            for (size_t k = 0; k < figure->chain_count; k++)
                expected += !figure->chains[k].closed;
            bool good = bcifs_plan_points(plan) == expected;
            if (!good)
                note("%s: depth %u", samples[i].name, depth);
            counts = counts && good;
            /* Paths cover the points one after the other. */
            uint64_t covered = 0;
            for (size_t k = 0; k < bcifs_plan_path_count(plan); k++) {
                bcifs_path path = bcifs_plan_path(plan, k);
                paths = paths && path.first == covered && path.closed == figure->chains[k].closed;
                covered += path.count;
            }
            paths = paths && covered == (figure->shape == FIGURE_ATTRACTOR ? 0 : expected);
            /* bcifs_figure_depth is this depth for as many points, one less for one point less. */
            if (expected > least)
                depths = depths && bcifs_figure_depth(figure, expected) == depth &&
                         (depth == 0 || bcifs_figure_depth(figure, expected - 1) == depth - 1);
            bcifs_plan_free(plan);
        }
    }
    ok(counts, "as many points as cells, and one for every open end");
    ok(paths, "paths cover the points");
    ok(depths, "bcifs_figure_depth is the deepest level with so many points");
}

/* A level costs its row of counts; a state that appears late may still get a larger leaf table. */
static void test_memory(void)
{
    bool good = true, bounded = true;
    for (size_t i = 0; i < sample_count; i++) {
        bcifs_plan *plans[2] = {plan_of(samples[i].figure, (bcifs_view){.depth = 10}),
                                plan_of(samples[i].figure, (bcifs_view){.depth = 20})};
        if (!plans[0] || !plans[1]) {
            /* More than 2^40 points. */
            good = good && bcifs_figure_depth(samples[i].figure, PLAN_MOST_POINTS) < 20;
        } else {
            size_t row = plans[1]->walked * (sizeof(uint64_t) + sizeof(struct columns)) + 64;
            size_t growth = plans[1]->arena.used - plans[0]->arena.used;
            bool flat = growth <= 10 * row + plans[1]->walked * PLAN_TABLE_BYTES;
            if (!flat)
                note("%s: %zu bytes at depth 10, %zu at depth 20", samples[i].name, plans[0]->arena.used,
                     plans[1]->arena.used);
            good = good && flat;
            bounded = bounded && plans[1]->arena.used < 2 * (size_t)PLAN_TABLES_BYTES;
        }
        bcifs_plan_free(plans[0]);
        bcifs_plan_free(plans[1]);
    }
    ok(good, "a plan of depth 20 is hardly larger than one of depth 10");
    ok(bounded, "and bounded");
}

/* ---- Single points ------------------------------------------------------------------------------------- */

/* The point of index k at depth n is the one at the address of k, found by counting cells. */
static void test_addresses(void)
{
    uint64_t random = 77;
    bool good = true;
    for (size_t i = 0; i < sample_count; i++) {
        const bcifs_figure *figure = samples[i].figure;
        unsigned depth = depth_for(figure, 5000);
        bcifs_plan *plan = plan_of(figure, (bcifs_view){.depth = depth});
        size_t dimension = bcifs_plan_dimension(plan);
        double *whole = walk_whole(plan), size = 0;
        for (size_t k = 0; k < bcifs_plan_points(plan) * dimension; k++)
            size = fmax(size, fabs(whole[k]));
        for (long round = 0; round < test_effort(10); round++) {
            size_t piece = (size_t)(random_bits(&random) % figure->piece_count), index = figure->pieces[piece].state;
            char address[1000];
            int length = snprintf(address, sizeof address, "%zu.", piece);
            uint64_t position = 0;
            /* Points of the pieces before it; a chain that ended left one more. */
            for (size_t k = 0; k < piece; k++)
                position += count_cells(&plan->states, figure->pieces[k].state, depth);
            for (size_t k = 0; k < figure->chain_count; k++)
                position += !figure->chains[k].closed && figure->chains[k].first + figure->chains[k].count <= piece;
            for (unsigned level = 0; level < depth; level++) {
                const struct state *state = &plan->states.states[index];
                size_t child = (size_t)(random_bits(&random) % state->cell->child_count);
                for (size_t k = 0; k < child; k++)
                    position += count_cells(&plan->states, state->children[k], depth - level - 1);
                index = state->children[child];
                length += snprintf(address + length, sizeof address - (size_t)length, "%zu", child);
            }
            double point[16], error = 0;
            if (bcifs_point_at_address(figure, address, point, NULL) != BCIFS_OK)
                point[0] = NAN;
            for (size_t c = 0; c < dimension; c++)
                error = fmax(error, fabs(point[c] - whole[position * dimension + c]));
            /* Two orders of multiplying a dozen maps, entries up to 5/4. */
            if (isnan(point[0]) || !(error <= 4e-15 * size)) {
                note("%s: point %llu, address %s: error %g of %g", samples[i].name, (unsigned long long)position,
                     address, error, size);
                good = false;
            }
        }
        free(whole);
        bcifs_plan_free(plan);
    }
    ok(good, "addresses lead to the points of the walk");
}

/* ---- Threads ------------------------------------------------------------------------------------------- */

enum { THREADS = 4 };

struct task {
    const bcifs_figure *figure;
    const bcifs_plan *plan;
    const double *whole;
    size_t number;
    bool good;
};

/* A quarter of a shared plan, then a plan of its own, then single points. */
static void *task_run(void *context)
{
    struct task *task = context;
    size_t count = (size_t)bcifs_plan_points(task->plan), dimension = bcifs_plan_dimension(task->plan);
    size_t from = count * task->number / THREADS, to = count * (task->number + 1) / THREADS;
    double tile[37 * 16], point[16];
    bcifs_walker *walker = NULL;
    task->good = bcifs_walker_create(task->plan, &walker, NULL) == BCIFS_OK;
    for (int round = 0; round < 3 && task->good; round++) {
        bcifs_walker_seek(walker, from);
        for (size_t index = from, found; index < to && task->good; index += found) {
            found = bcifs_walker_next(walker, tile, 37);
            task->good = found > 0 && memcmp(tile, task->whole + index * dimension, found * dimension * sizeof *tile) == 0;
        }
    }
    bcifs_walker_free(walker);
    bcifs_plan *own = plan_of(task->figure, (bcifs_view){.depth = task->plan->depth});
    double *whole = own ? walk_whole(own) : NULL;
    task->good = task->good && whole && memcmp(whole, task->whole, count * dimension * sizeof *whole) == 0;
    free(whole);
    bcifs_plan_free(own);
    for (int i = 0; i < 20 && task->good; i++)
        task->good = bcifs_point_at(task->figure, (i + 0.5) / 20, point, NULL) == BCIFS_OK &&
                     bcifs_point_at_address(task->figure, "0.0101", point, NULL) == BCIFS_OK;
    return NULL;
}

static void test_threads(void)
{
    bool good = true;
    for (size_t i = 0; i < sample_count; i++) {
        bcifs_plan *plan = plan_of(samples[i].figure, (bcifs_view){.depth = depth_for(samples[i].figure, 8000)});
        double *whole = walk_whole(plan);
        struct task tasks[THREADS];
        pthread_t threads[THREADS];
        for (size_t t = 0; t < THREADS; t++) {
            tasks[t] = (struct task){samples[i].figure, plan, whole, t, false};
            if (pthread_create(&threads[t], NULL, task_run, &tasks[t]) != 0)
                abort();
        }
        for (size_t t = 0; t < THREADS; t++) {
            pthread_join(threads[t], NULL);
            if (!tasks[t].good)
                note("%s: thread %zu", samples[i].name, t);
            good = good && tasks[t].good;
        }
        free(whole);
        bcifs_plan_free(plan);
    }
    ok(good, "several threads walk one plan, and plan one figure, and all get the same bits");
}

/* ---- The kernel ---------------------------------------------------------------------------------------- */

static void test_kernel(void)
{
    uint64_t random = 3;
    bool good = true;
    for (long round = 0; round < test_effort(200); round++) {
        size_t dimension = 1 + random_bits(&random) % 16, inner = 1 + random_bits(&random) % 9;
        size_t count = random_bits(&random) % 150, stride = count + random_bits(&random) % 5;
        double p[16 * 9], *w = malloc((inner * stride + 1) * sizeof *w), *out = malloc((count * dimension + 1) * sizeof *out);
        for (size_t k = 0; k < dimension * inner; k++)
            p[k] = (double)(random_bits(&random) >> 11) / 9007199254740992.0 - 0.5;
        for (size_t k = 0; k < inner * stride; k++)
            w[k] = (double)(random_bits(&random) >> 11) / 9007199254740992.0 - 0.5;
        out[count * dimension] = 99;
        kernel_points(p, dimension, inner, w, stride, count, out);
        /* The sum in the order of j, which is what makes the bits the same everywhere. */
        for (size_t k = 0; k < count; k++)
            for (size_t c = 0; c < dimension; c++) {
                double sum = p[c * inner] * w[k];
                for (size_t j = 1; j < inner; j++) {
                    double product = p[c * inner + j] * w[j * stride + k];
                    sum += product;
                }
                if (sum != out[k * dimension + c]) {
                    note("dimension %zu, inner %zu, count %zu: point %zu", dimension, inner, count, k);
                    good = false;
                }
            }
        good = good && out[count * dimension] == 99;
        free(w);
        free(out);
    }
    ok(good, "P·W for random sizes, every bit");
}

/* ---- States without end -------------------------------------------------------------------------------- */

static void test_growth(void)
{
    /* Every child is in a state of its own: 2^n states at level n. Places are Cantor-like by construction. */
    static const char binary[] = "automaton grows\nvertex end 1 { }\n"
                                 "edge e(u) 2 { start end at 0 end end at 1\n"
                                 "  sub e(2*u) [ 1 1/2; 0 1/2 ] sub e(2*u+1) [ 1/2 0; 1/2 1 ] }\n"
                                 "figure f { open e(1) points [ 0; 1 ] }\n";
    static const char line[] = "automaton grows\nvertex end 1 { }\n"
                               "edge e(u) 2 { start end at 0 end end at 1\n"
                               "  sub e(u+1) [ 1 1/(u+1); 0 u/(u+1) ] sub e(u+1) [ 1/(u+1) 0; u/(u+1) 1 ] }\n"
                               "figure f { open e(1) points [ 0; 1 ] }\n";
    bcifs_error error = {0};
    bcifs_automaton *automaton = load_text(binary);
    bcifs_figure *figure = NULL;
    bcifs_plan *plan = NULL;
    bcifs_figure_create(automaton, NULL, &figure, &error);
    bcifs_status status = bcifs_plan_create(figure, &(bcifs_view){.depth = 12}, &plan, &error);
    bool good = status == BCIFS_OK && bcifs_plan_points(plan) == 4097;
    double *whole = good ? walk_whole(plan) : NULL;
    for (size_t k = 0; good && k <= 4096; k++)
        good = whole[k] == (double)k / 4096;
    ok(good, "4095 states are none too many: %s", error.message);
    free(whole);
    bcifs_plan_free(plan);
    plan = NULL;
    status = bcifs_plan_create(figure, &(bcifs_view){.depth = 18}, &plan, &error);
    ok(status == BCIFS_INPUT && !plan && strstr(error.message, "65536"), "2^18 are: %s", error.message);
    double point;
    ok(bcifs_point_at(figure, 1.0 / 3, &point, &error) == BCIFS_OK && fabs(point - 1.0 / 3) < 1e-15,
       "a single point needs only its own states");
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
    automaton = load_text(line);
    figure = NULL;
    bcifs_figure_create(automaton, NULL, &figure, &error);
    plan = plan_of(figure, (bcifs_view){.depth = 15});
    /* The cell that starts first ends at Π u/(u + 1) = 1/(n + 1). */
    whole = plan ? walk_whole(plan) : NULL;
    ok(whole && fabs(whole[1] - 1.0 / 16) < 1e-16 && whole[32768] == 1, "intervals that change from level to level");
    free(whole);
    bcifs_plan_free(plan);
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
}

int main(void)
{
    samples_make();
    test_walks();
    test_far();
    test_counts();
    test_memory();
    test_addresses();
    test_threads();
    test_kernel();
    test_growth();
    for (size_t i = 0; i < sample_count; i++)
        bcifs_figure_free(samples[i].figure);
    for (size_t i = 0; i < sample_count; i++)
        bcifs_automaton_free(samples[i].automaton);
    return done_testing();
}
