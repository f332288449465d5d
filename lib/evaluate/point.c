/* Single points: at a parameter or an address, by descending from the piece. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "evaluate/parameter.h"
#include "evaluate/plan.h"
#include "numeric/matrix.h"
#include "numeric/tolerance.h"

enum { DEEPEST_POINT = 1 << 16 /* levels that a parameter whose digits do not end is followed */ };

/* A cell on the way down. The arena is for states; the two matrices take turns. */
struct descent {
    struct arena arena;
    struct states states;
    const bcifs_figure *figure;
    size_t state;
    double *matrix; /* P·T_w: dimension × points */
    struct report report;
};

static bcifs_status descent_begin(struct descent *descent, const bcifs_figure *figure, size_t piece)
{
    *descent = (struct descent){.figure = figure, .report = report_new(NULL)};
    if (figure->shape == FIGURE_SURFACE)
        return report_failure(&descent->report, BCIFS_INPUT, NULL,
                              "the figure '%s' is a surface; only curves and attractors can be evaluated",
                              figure->name);
    bcifs_status status = states_copy(&descent->states, &figure->states, &descent->arena, &descent->report);
    if (status)
        return status;
    descent->state = figure->pieces[piece].state;
    size_t points = descent->states.states[descent->state].points;
    descent->matrix = memory_new(points * figure->dimension, sizeof *descent->matrix);
    if (!descent->matrix)
        return report_memory(&descent->report);
    piece_gather(figure, &figure->pieces[piece], points, descent->matrix);
    return BCIFS_OK;
}

static void descent_end(struct descent *descent)
{
    memory_free(descent->matrix);
    arena_free(&descent->arena);
}

static bcifs_status descent_step(struct descent *descent, size_t child)
{
    const struct state *state = &descent->states.states[descent->state];
    size_t next = state->children[child], points = descent->states.states[next].points;
    double *matrix = memory_new(points * descent->figure->dimension, sizeof *matrix);
    if (!matrix)
        return report_memory(&descent->report);
    matrix_multiply(descent->matrix, state->maps[child], descent->figure->dimension, state->points, points, matrix);
    memory_free(descent->matrix);
    descent->matrix = matrix;
    descent->state = next;
    return BCIFS_OK;
}

/* The limit point at the start (or end) of the cell. */
static bcifs_status descent_point(struct descent *descent, bool at_end, double *point)
{
    size_t points = descent->states.states[descent->state].points;
    double *column = arena_new(&descent->arena, points, sizeof *column);
    bcifs_status status =
        column ? states_end_limit(&descent->states, descent->state, at_end, column) : report_memory(&descent->report);
    if (status)
        return status;
    matrix_multiply(descent->matrix, column, descent->figure->dimension, points, 1, point);
    for (unsigned c = 0; c < descent->figure->dimension; c++)
        if (!isfinite(point[c]))
            return report_failure(&descent->report, BCIFS_INPUT, NULL,
                                  "the point is not finite; the automaton may not be contractive");
    return BCIFS_OK;
}

/* Whether the cell's control points agree to rounding, so that going on changes nothing. */
static bool descent_converged(const struct descent *descent)
{
    size_t points = descent->states.states[descent->state].points;
    for (size_t c = 0; c < descent->figure->dimension; c++)
        for (size_t j = 1; j < points; j++) {
            double first = descent->matrix[c * points], other = descent->matrix[c * points + j];
            if (fabs(other - first) > TOLERANCE_LIMIT / 8 * fabs(first))
                return false;
        }
    return true;
}

static bcifs_status point_finish(struct descent *descent, bcifs_status status, bcifs_error *error)
{
    if (status == BCIFS_MEMORY && descent->report.errors == 0)
        report_memory(&descent->report);
    descent_end(descent);
    if (status)
        report_close(&descent->report, error);
    return status;
}

bcifs_status bcifs_point_at(const bcifs_figure *figure, double t, double *point, bcifs_error *error)
{
    struct descent descent;
    if (!(t >= 0 && t <= 1)) {
        struct report report = report_new(NULL);
        report_failure(&report, BCIFS_INPUT, NULL, "the parameter must lie in 0..1");
        return report_close(&report, error);
    }
    uint64_t fraction = parameter_from_double(t);
    size_t piece = parameter_digit(&fraction, figure->piece_count);
    bool at_end = piece == figure->piece_count;
    bcifs_status status = descent_begin(&descent, figure, at_end ? piece - 1 : piece);
    for (int level = 0; level < DEEPEST_POINT && status == BCIFS_OK; level++) {
        if (fraction == 0 && !(at_end && figure->shape == FIGURE_ATTRACTOR))
            break;
        if (descent_converged(&descent))
            break;
        status = states_expand(&descent.states, descent.state);
        if (status)
            break;
        /* An attractor has no end vertex: its parameter 1 is the point of its last map again and again. */
        size_t children = descent.states.states[descent.state].cell->child_count;
        status = descent_step(&descent, at_end ? children - 1 : parameter_digit(&fraction, children));
    }
    if (status == BCIFS_OK)
        status = descent_point(&descent, at_end, point);
    return point_finish(&descent, status, error);
}

/* The next number of an address: one digit, or all up to the next comma when the word has commas. */
static bool address_digit(const char **text, bool commas, size_t *digit)
{
    if (**text < '0' || **text > '9')
        return false;
    if (!commas) {
        *digit = (size_t)(*(*text)++ - '0');
        return true;
    }
    for (*digit = 0; **text >= '0' && **text <= '9'; ++*text) {
        *digit = *digit * 10 + (size_t)(**text - '0');
        if (*digit > 1u << 30)
            return false;
    }
    if (**text == ',')
        return *++*text != '\0';
    return **text == '\0';
}

static bcifs_status address_walk(struct descent *descent, const char *word)
{
    bool commas = strchr(word, ',') != NULL;
    for (size_t position = 0; *word; position++) {
        size_t digit, children;
        bcifs_status status = states_expand(&descent->states, descent->state);
        if (status)
            return status;
        children = descent->states.states[descent->state].cell->child_count;
        if (!address_digit(&word, commas, &digit))
            return report_failure(&descent->report, BCIFS_INPUT, NULL,
                                  "the address has something else than map indices: '%.20s'", word);
        if (digit >= children)
            return report_failure(&descent->report, BCIFS_INPUT, NULL,
                                  "there is no map %zu at position %zu of the address; '%s' has %zu, from 0", digit,
                                  position, descent->states.states[descent->state].key.definition->name, children);
        status = descent_step(descent, digit);
        if (status)
            return status;
    }
    return BCIFS_OK;
}

bcifs_status bcifs_point_at_address(const bcifs_figure *figure, const char *address, double *point,
                                    bcifs_error *error)
{
    struct descent descent;
    struct report report = report_new(NULL);
    char *end;
    unsigned long piece = strtoul(address, &end, 10);
    if (address[0] < '0' || address[0] > '9' || (*end != '.' && *end != '\0') || piece >= figure->piece_count) {
        report_failure(&report, BCIFS_INPUT, NULL,
                       "the address '%.40s' must be PIECE.WORD with a piece below %zu, such as 0.0110", address,
                       figure->piece_count);
        return report_close(&report, error);
    }
    bcifs_status status = descent_begin(&descent, figure, piece);
    if (status == BCIFS_OK)
        status = address_walk(&descent, *end == '.' ? end + 1 : end);
    if (status == BCIFS_OK)
        status = descent_point(&descent, false, point);
    return point_finish(&descent, status, error);
}
