/* bcifs edit: control points of any level moved, the enclosed area kept. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command.h"

enum {
    MOST_INDICES = 4096,
    DEFAULT_POINTS = 4096 /* of each curve in a picture */
};

/* Everything that one edit owns. */
struct editing {
    const struct arguments *arguments;
    bcifs_automaton *automaton;
    bcifs_figure *figure;
    bcifs_editor *editor;
    bcifs_editor_options options;
    bcifs_constraint constraint;
    size_t list[MOST_INDICES], pins[MOST_INDICES];
    bcifs_move moves[MOST_MOVES];
    size_t move_count;
};

/* ---- Options ------------------------------------------------------------------------------------------- */

/* I:dx,dy */
static int move_read(const char *text, bcifs_move *move)
{
    const char *colon = strchr(text, ':'), *comma = colon ? strchr(colon, ',') : NULL;
    char index[24];
    unsigned number;
    if (!comma || (size_t)(colon - text) >= sizeof index)
        return complain("--move: expected I:dx,dy, a control point and a vector, found '%s'", text);
    memcpy(index, text, (size_t)(colon - text));
    index[colon - text] = '\0';
    int status = unsigned_read("--move", index, &number);
    move->index = number;
    if (status == EXIT_YES)
        status = number_read("--move", colon + 1, (size_t)(comma - colon - 1), &move->dx);
    return status ? status : number_read("--move", comma + 1, strlen(comma + 1), &move->dy);
}

/* i,j,… */
static int indices_read(const char *option, const char *text, size_t *list, size_t *count)
{
    for (const char *field = text;;) {
        size_t length = strcspn(field, ",");
        char word[24];
        unsigned number;
        if (length == 0 || length >= sizeof word)
            return complain("%s: expected control points such as 0,3,5, found '%s'", option, text);
        if (*count == MOST_INDICES)
            return complain("%s: at most %d control points", option, MOST_INDICES);
        memcpy(word, field, length);
        word[length] = '\0';
        int status = unsigned_read(option, word, &number);
        list[(*count)++] = number;
        if (status || field[length] == '\0')
            return status;
        field += length + 1;
    }
}

/* all | scale | near:K | list:i,j,… */
static int free_read(struct editing *editing)
{
    const char *text = editing->arguments->free;
    bcifs_constraint *constraint = &editing->constraint;
    unsigned neighbors;
    if (!text || strcmp(text, "scale") == 0)
        return EXIT_YES;
    if (strcmp(text, "all") == 0) {
        constraint->free = BCIFS_FREE_ALL;
        return EXIT_YES;
    }
    if (strncmp(text, "near:", 5) == 0) {
        int status = unsigned_read("--free near", text + 5, &neighbors);
        constraint->free = BCIFS_FREE_NEAR;
        constraint->neighbors = neighbors;
        return status;
    }
    if (strncmp(text, "list:", 5) == 0) {
        constraint->free = BCIFS_FREE_LIST;
        return indices_read("--free list", text + 5, editing->list, &constraint->list_count);
    }
    return complain("--free: expected all, scale, near:K or list:i,j,…, found '%s'", text);
}

static int energy_read(const char *text, bcifs_energy *energy)
{
    static const struct {
        const char *name;
        bcifs_energy energy;
    } energies[] = {{"bending", BCIFS_BENDING}, {"discrete", BCIFS_DIFFERENCE}, {"none", BCIFS_NO_ENERGY}};
    for (size_t i = 0; i < sizeof energies / sizeof *energies && text; i++)
        if (strcmp(energies[i].name, text) == 0) {
            *energy = energies[i].energy;
            return EXIT_YES;
        }
    return text ? complain("--energy: expected bending, discrete or none, found '%s'", text) : EXIT_YES;
}

static int keep_read(const char *text, int *keep)
{
    *keep = !text || strcmp(text, "area") == 0;
    return *keep || strcmp(text, "none") == 0 ? EXIT_YES
                                              : complain("--keep: expected area or none, found '%s'", text);
}

static int numbers_read(struct editing *editing)
{
    const struct arguments *arguments = editing->arguments;
    bcifs_constraint *constraint = &editing->constraint;
    int status = EXIT_YES;
    constraint->alpha = 100;
    if (arguments->coarsen)
        status = unsigned_read("--coarsen", arguments->coarsen, &editing->options.coarsen);
    if (status == EXIT_YES && arguments->refine)
        status = unsigned_read("--refine", arguments->refine, &editing->options.refine);
    if (status == EXIT_YES && arguments->alpha)
        status = number_read("--alpha", arguments->alpha, strlen(arguments->alpha), &constraint->alpha);
    if (status == EXIT_YES && !(constraint->alpha >= 0))
        return complain("--alpha: expected a number not below 0, found '%s'", arguments->alpha);
    if (status == EXIT_YES && arguments->area)
        status = number_read("--area", arguments->area, strlen(arguments->area), &constraint->target);
    constraint->has_target = arguments->area != NULL;
    return status;
}

static int options_read(struct editing *editing)
{
    const struct arguments *arguments = editing->arguments;
    bcifs_constraint *constraint = &editing->constraint;
    int status = numbers_read(editing);
    if (status == EXIT_YES)
        status = free_read(editing);
    if (status == EXIT_YES)
        status = energy_read(arguments->energy, &editing->options.energy);
    if (status == EXIT_YES)
        status = keep_read(arguments->keep, &constraint->keep_area);
    if (status == EXIT_YES && arguments->pins)
        status = indices_read("--pin", arguments->pins, editing->pins, &constraint->pin_count);
    for (size_t i = 0; i < arguments->move_count && status == EXIT_YES; i++)
        status = move_read(arguments->moves[i], &editing->moves[editing->move_count++]);
    constraint->list = editing->list;
    constraint->pins = editing->pins;
    if (status == EXIT_YES && constraint->has_target && !constraint->keep_area)
        return complain("--area gives the area to be kept, --keep none lets it go");
    return status;
}

/* ---- Output -------------------------------------------------------------------------------------------- */

/* A curve and its control polygon, of one stage. */
static int stage_draw(const struct editing *editing, bcifs_stage stage, bcifs_figure *figures[2], bcifs_plan *plans[2],
                      bcifs_layer layers[2])
{
    static const bcifs_ink inks[] = {
        [BCIFS_INITIAL] = BCIFS_BLUE, [BCIFS_DEFORMED] = BCIFS_GREEN, [BCIFS_RESULT] = BCIFS_RED};
    bcifs_error error;
    unsigned depth = 0;
    int status = EXIT_YES;
    bcifs_status made = bcifs_editor_figure(editing->editor, stage, 0, &figures[0], &error);
    if (made == BCIFS_OK)
        made = bcifs_editor_figure(editing->editor, stage, 1, &figures[1], &error);
    if (made == BCIFS_OK && editing->arguments->depth)
        status = unsigned_read("--depth", editing->arguments->depth, &depth);
    else if (made == BCIFS_OK)
        depth = bcifs_figure_depth(figures[0], DEFAULT_POINTS);
    if (status)
        return status;
    const bcifs_view curve = {.depth = depth, .to = 1}, polygon = {.show = BCIFS_CONTROL, .to = 1};
    if (made == BCIFS_OK)
        made = bcifs_plan_create(figures[0], &curve, &plans[0], &error);
    if (made == BCIFS_OK)
        made = bcifs_plan_create(figures[1], &polygon, &plans[1], &error);
    layers[0] = (bcifs_layer){.plan = plans[0], .role = BCIFS_CURVE, .ink = inks[stage]};
    layers[1] = (bcifs_layer){.plan = plans[1], .role = BCIFS_POLYGON, .ink = inks[stage]};
    return made ? fail(made, &error) : EXIT_YES;
}

/* The initial curve in blue, the deformed one in green, the area-true one in red. */
static int picture_write(const struct editing *editing, const char *format)
{
    enum { STAGES = 3 };
    const struct arguments *arguments = editing->arguments;
    bcifs_figure *figures[2 * STAGES] = {NULL};
    bcifs_plan *plans[2 * STAGES] = {NULL};
    bcifs_layer layers[2 * STAGES];
    size_t count = editing->constraint.keep_area ? STAGES : STAGES - 1;
    unsigned width = 0;
    int status = arguments->width ? unsigned_read("--width", arguments->width, &width) : EXIT_YES;
    for (size_t stage = 0; stage < count && status == EXIT_YES; stage++)
        status = stage_draw(editing, (bcifs_stage)stage, figures + 2 * stage, plans + 2 * stage, layers + 2 * stage);
    if (status == EXIT_YES) {
        char *line = command_line(arguments);
        const bcifs_write_options options = {.format = format, .command = line, .width = width};
        bcifs_error error;
        bcifs_status written = bcifs_write(figures[0], layers, 2 * count, arguments->output, &options, &error);
        free(line);
        status = written ? fail(written, &error) : EXIT_YES;
    }
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        bcifs_plan_free(plans[i]);
        bcifs_figure_free(figures[i]);
    }
    return status;
}

/* The fine control points of the answer, in any format for points: --points takes them back. */
static int points_write(const struct editing *editing)
{
    const struct arguments *arguments = editing->arguments;
    const bcifs_view view = {.show = BCIFS_CONTROL, .to = 1};
    bcifs_figure *figure = NULL;
    bcifs_plan *plan = NULL;
    bcifs_error error;
    char *line = command_line(arguments);
    const bcifs_write_options options = {.format = output_format(arguments), .command = line};
    bcifs_status status = bcifs_editor_figure(editing->editor, BCIFS_RESULT, 0, &figure, &error);
    if (status == BCIFS_OK)
        status = bcifs_plan_create(figure, &view, &plan, &error);
    if (status == BCIFS_OK) {
        const bcifs_layer layer = {.plan = plan};
        status = bcifs_write(figure, &layer, 1, arguments->output ? arguments->output : "-", &options, &error);
    }
    bcifs_plan_free(plan);
    bcifs_figure_free(figure);
    free(line);
    return status ? fail(status, &error) : EXIT_YES;
}

static int output_write(const struct editing *editing)
{
    /* With --json the file of -o may still be a picture: the report then goes to standard output. */
    const struct arguments *arguments = editing->arguments;
    struct arguments drawn = *arguments, told = *arguments;
    drawn.json = false;
    bool picture = output_is_picture(&drawn), json = arguments->json || strcmp(output_format(arguments), "json") == 0;
    if (picture && !arguments->output)
        return complain("a picture needs a file: -o x.%s", output_format(&drawn));
    if (picture)
        told.output = NULL;
    int status = picture ? picture_write(editing, output_format(&drawn)) : EXIT_YES;
    if (status == EXIT_YES && json)
        return text_output(&told, bcifs_editor_json(editing->editor));
    if (picture || status)
        return status;
    return arguments->output || arguments->format ? points_write(editing)
                                                  : text_output(arguments, bcifs_editor_text(editing->editor));
}

/* ---- The edit ------------------------------------------------------------------------------------------ */

static void energy_tell(const struct editing *editing)
{
    const char *reason;
    bcifs_editor_energy(editing->editor, &reason);
    if (reason && !editing->arguments->quiet)
        fprintf(stderr,
                "bcifs: warning: there is no bending energy, second differences are used instead: %s "
                "(--energy discrete says so)\n",
                reason);
}

static int edit(struct editing *editing)
{
    bcifs_error error;
    int status = equations_check(editing->arguments, editing->automaton);
    if (status == EXIT_YES)
        status = figure_create(editing->arguments, editing->automaton, &editing->figure);
    if (status)
        return status;
    bcifs_status made = bcifs_editor_create(editing->figure, &editing->options, &editing->editor, &error);
    if (made == BCIFS_OK)
        made = bcifs_editor_constrain(editing->editor, &editing->constraint, &error);
    if (made)
        return fail(made, &error);
    energy_tell(editing);
    made = bcifs_editor_move(editing->editor, editing->moves, editing->move_count, &error);
    return made ? fail(made, &error) : output_write(editing);
}

static int run(const struct arguments *arguments)
{
    /* An edit is of the params' values. */
    struct arguments fixed = *arguments;
    struct editing *editing = calloc(1, sizeof *editing);
    if (!editing) {
        fputs("bcifs: error: no memory\n", stderr);
        return EXIT_SYSTEM;
    }
    fixed.fix_params = true;
    editing->arguments = &fixed;
    int status = options_read(editing);
    if (status == EXIT_YES)
        status = automaton_load(&fixed, &editing->automaton);
    if (status == EXIT_YES)
        status = edit(editing);
    bcifs_editor_free(editing->editor);
    bcifs_figure_free(editing->figure);
    bcifs_automaton_free(editing->automaton);
    free(editing);
    return status;
}

static const struct option options_list[] = {
    {"--move", "I:dx,dy", "move control point I of the level; may be repeated"},
    {"--coarsen", "J", "edit J levels above the fine control points (default 0)"},
    {"--refine", "n", "first subdivide the figure n times"},
    {"--free", "WHAT", "what answers: scale (default), all, near:K or list:i,j,…"},
    {"--pin", "i,j,…", "control points of the level that stay where they are"},
    {"--alpha", "A", "how closely the answer follows the move (default 100)"},
    {"--keep", "WHAT", "area (default) or none: the deformed curve is the answer"},
    {"--area", "VALUE", "the area wanted (default: the one before)"},
    {"--energy", "NAME", "bending (default), discrete or none"},
    {"--figure", "NAME", "which figure of the file (default: the first)"},
    {"--state", "NAME", "edit one state on its own, on the points of --points"},
    {"--points", "FILE", "control points from CSV, one a row, instead of the figure's"},
    {"--curve", "FILE", "control points from the first path of an SVG file"},
    {"--set", "NAME=EXPR", "give a param a value; may be repeated"},
    {"--json", NULL, "print one JSON object; with a picture too"},
    {"-o", "FILE", "a picture of the three curves, or the new fine control points"},
    {"--format", "NAME", "svg, png; csv, json, f64 or npy"},
    {"--depth", "n", "pictures: subdivide n times (default: about 4096 points)"},
    {"--width", "PIXELS", "pictures: their width (default 1000)"},
    {"--quiet", NULL, "no warnings"},
    {NULL, NULL, NULL},
};

const struct command command_edit = {
    .name = "edit",
    .usage = "FILE [options]",
    .summary = "moves control points of any level while the enclosed area stays exactly what it was",
    .text = "The curve is decomposed J times, points of its coarse polygon are moved, and the control points\n"
            "that are free answer: the smoothest curve near the deformed one that has the area. In pictures the\n"
            "initial curve is blue, the deformed one green, the area-true one red. An open curve is closed by\n"
            "its chord. Where the area cannot be reached the exit status is 1.\n",
    .options = options_list,
    .run = run,
};
