#include "proof.h"

#include <math.h>
#include <string.h>

#include "automaton/figure.h"
#include "base/decimal.h"
#include "numeric/tolerance.h"

enum {
    MOST_EQUATIONS = 1 << 16,
    MOST_TRIES = 16,        /* samples tried when one hits a pole of the entries */
    MOST_WITNESSES = 64     /* places searched for one where a refuted equation visibly fails */
};

/* The proof of one state. Its equations are enumerated in the same order for every sample; `next` counts them. */
struct prover {
    bcifs_check *check;
    struct report *report;
    const struct definition *definition;
    const struct value *fixed; /* arguments that sizes depend on, or NULL */
    const char *name;          /* of the state; with those arguments, "corner(3)" */
    size_t first;              /* of this state's equations */
    size_t next;
    bool opening; /* the first round: equations are added */
    /* Looking for numbers at which equation `wanted` fails: its sides, once found. */
    bool witnessing;
    size_t wanted;
    const struct value_matrix *left, *right;
    struct sample *sample;
    struct arena *arena; /* of this round */
};

static bcifs_status out_of_memory(const struct prover *prover)
{
    return report_memory(prover->report);
}

/* ---- Verdicts ------------------------------------------------------------------------------------------ */

/* Largest difference of entries in doubles, where it is, and the size of the data. */
static double difference(const struct value_matrix *left, const struct value_matrix *right, size_t *where,
                         double *scale)
{
    double largest = 0;
    *where = 0;
    *scale = 0;
    for (size_t i = 0; i < left->rows * left->columns; i++) {
        double entry = fabs(left->values[i].real - right->values[i].real);
        if (!(entry <= largest)) { /* NaN counts as large */
            largest = entry;
            *where = i;
        }
        *scale = fmax(*scale, fmax(fabs(left->values[i].real), fabs(right->values[i].real)));
    }
    return largest;
}

/* Whether L = R: in the field when both are exact there, otherwise within the tolerance. */
static bool sides_agree(const struct value_matrix *left, const struct value_matrix *right)
{
    if (left->rows != right->rows || left->columns != right->columns)
        return false;
    if (left->exact && right->exact) {
        for (size_t i = 0; i < left->rows * left->columns; i++)
            if (left->values[i].residue != right->values[i].residue)
                return false;
        return true;
    }
    size_t where;
    double scale, largest = difference(left, right, &where, &scale);
    return largest <= TOLERANCE_EQUATION * scale;
}

/* The next equation of this round: a new one in the first round, the one of the same number later. */
static bcifs_status equation_open(struct prover *prover, bcifs_equation_kind kind, const struct text *text,
                                  const struct source *source, source_place place, bcifs_equation **equation)
{
    bcifs_check *check = prover->check;
    size_t index = prover->first + prover->next++;
    if (prover->opening) {
        if (check->count >= MOST_EQUATIONS)
            return report_failure(prover->report, BCIFS_INPUT, check->automaton->modules[0]->source->name,
                                  "more than %d equations", MOST_EQUATIONS);
        unsigned column;
        bcifs_equation fresh = {.state = prover->name, .kind = kind, .exact = 1, .holds = 1, .at = ""};
        fresh.text = text->failed ? NULL : arena_text(&check->arena, text->data, text->length);
        fresh.file = source->name;
        source_locate(source, place, &fresh.line, &column);
        if (!fresh.text || !ARENA_RESERVE(&check->arena, check->equations, check->count, check->capacity) ||
            !ARENA_RESERVE(&check->arena, check->places, check->count, check->place_capacity))
            return out_of_memory(prover);
        check->places[check->count] = (struct equation_place){source, place};
        check->equations[check->count++] = fresh;
    }
    /* Every round enumerates alike; the guard only keeps a surprise from writing past the end. */
    *equation = index < check->count ? &check->equations[index] : NULL;
    return BCIFS_OK;
}

/* Decides L = R in this round. Takes the text. */
static bcifs_status equation_decide(struct prover *prover, bcifs_equation_kind kind, struct text *text,
                                    const struct source *source, source_place place,
                                    const struct value_matrix *left, const struct value_matrix *right)
{
    bcifs_equation *equation;
    size_t where;
    double scale;
    if (!left || !right) {
        text_free(text);
        return out_of_memory(prover);
    }
    if (prover->witnessing && prover->first + prover->next == prover->wanted) {
        prover->left = left;
        prover->right = right;
    }
    bcifs_status status = equation_open(prover, kind, text, source, place, &equation);
    text_free(text);
    if (status || !equation || prover->witnessing)
        return status;
    bool exact = left->exact && right->exact;
    if (!exact)
        equation->exact = 0;
    equation->holds = equation->holds && sides_agree(left, right);
    if (!exact && left->rows == right->rows && left->columns == right->columns)
        equation->residual = fmax(equation->residual, difference(left, right, &where, &scale));
    return BCIFS_OK;
}

/* An equation that fails for another cause than an entry. */
static bcifs_status equation_refuse(struct prover *prover, bcifs_equation_kind kind, struct text *text,
                                    const struct source *source, source_place place, struct text *reason)
{
    bcifs_equation *equation;
    bcifs_status status = equation_open(prover, kind, text, source, place, &equation);
    if (status == BCIFS_OK && equation && !prover->witnessing) {
        equation->holds = 0;
        if (!equation->reason && !reason->failed)
            equation->reason = arena_text(&prover->check->arena, reason->data, reason->length);
        if (!equation->reason)
            status = out_of_memory(prover);
    }
    text_free(text);
    text_free(reason);
    return status;
}

/* ---- Barycentric --------------------------------------------------------------------------------------- */

/* 1·A = 1. */
static bcifs_status check_sums(struct prover *prover, const struct value_matrix *matrix, const char *name,
                               const struct source *source, source_place place)
{
    struct value_matrix *sums = value_matrix_new(prover->arena, 1, matrix->columns);
    struct value_matrix *ones = value_matrix_new(prover->arena, 1, matrix->columns);
    struct text text = {0};
    if (!sums || !ones)
        return out_of_memory(prover);
    for (size_t j = 0; j < matrix->columns; j++) {
        for (size_t i = 0; i < matrix->rows; i++)
            sums->values[j] = value_add(sums->values[j], matrix->values[i * matrix->columns + j]);
        ones->values[j] = value_from_integer(1);
    }
    value_matrix_finish(sums);
    text_format(&text, "1·%s = 1", name);
    return equation_decide(prover, BCIFS_BARYCENTRIC, &text, source, place, sums, ones);
}

static bcifs_status check_barycentric(struct prover *prover, const struct cell *cell)
{
    bcifs_status status = BCIFS_OK;
    char name[32] = "T";
    for (size_t i = 0; i < cell->child_count && status == BCIFS_OK; i++) {
        const struct cell_child *child = &cell->children[i];
        struct text text = {0};
        text_format(&text, "T%zu", i);
        if (text.failed || text.length >= sizeof name)
            return out_of_memory(prover);
        memcpy(name, text.data, text.length + 1);
        text_free(&text);
        status = check_sums(prover, child->map, cell->definition->kind == CELL_VERTEX ? "T" : name, child->source,
                            child->place);
    }
    for (size_t i = 0; i < cell->boundary_count && status == BCIFS_OK; i++) {
        const struct cell_boundary *boundary = &cell->boundaries[i];
        status = check_sums(prover, boundary->operator, boundary->name, boundary->source, boundary->place);
    }
    return status;
}

/* ---- Edges --------------------------------------------------------------------------------------------- */

/* The boundaries of a cell's children, elaborated. */
static bcifs_status children_elaborate(struct prover *prover, const struct cell *cell, struct cell ***children)
{
    *children = arena_new(prover->arena, cell->child_count, sizeof **children);
    if (!*children)
        return out_of_memory(prover);
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < cell->child_count && status == BCIFS_OK; i++) {
        struct state_key key = cell->children[i].state;
        for (size_t j = 0; j < i && !(*children)[i]; j++)
            if (state_key_equal(cell->children[j].state, key))
                (*children)[i] = (*children)[j];
        if (!(*children)[i])
            status = cell_elaborate(&prover->sample->setting, prover->arena, key, &(*children)[i]);
    }
    return status;
}

static void states_differ(struct text *reason, const char *what, struct state_key a, const char *other,
                          struct state_key b)
{
    text_format(reason, "%s is in the state ", what);
    state_name(&a, reason);
    text_format(reason, ", %s ", other);
    state_name(&b, reason);
}

/* T_i Π_side = Π_side T^s at one end of an edge, [IM] (8); [SI] "Equations d'incidence". */
static bcifs_status check_edge_incidence(struct prover *prover, const struct cell *cell, struct cell **children,
                                         int side)
{
    size_t i = side ? cell->child_count - 1 : 0;
    const struct cell_boundary *boundary = &cell->boundaries[side];
    const struct cell_boundary *inner = &children[i]->boundaries[side];
    struct cell *vertex;
    bcifs_status status = cell_elaborate(&prover->sample->setting, prover->arena, boundary->state, &vertex);
    if (status)
        return status;
    struct text text = {0};
    text_format(&text, "T%zu·%s = %s·T(%s)", i, boundary->name, boundary->name,
                boundary->state.definition->name);
    if (!state_key_equal(inner->state, vertex->children[0].state)) {
        struct text reason = {0};
        text_format(&reason, "%s of child %zu", side ? "the end" : "the start", i);
        states_differ(&reason, "", inner->state, "but the vertex there becomes", vertex->children[0].state);
        return equation_refuse(prover, BCIFS_INCIDENCE, &text, boundary->source, boundary->place, &reason);
    }
    return equation_decide(
        prover, BCIFS_INCIDENCE, &text, cell->children[i].source, cell->children[i].place,
        value_matrix_multiply(prover->arena, cell->children[i].map, inner->operator),
        value_matrix_multiply(prover->arena, boundary->operator, vertex->children[0].map));
}

/* T_i Π_end = T_{i+1} Π_start, [IM] (6). */
static bcifs_status check_edge_adjacency(struct prover *prover, const struct cell *cell, struct cell **children,
                                         size_t i)
{
    const struct cell_boundary *end = &children[i]->boundaries[1], *start = &children[i + 1]->boundaries[0];
    const struct cell_child *next = &cell->children[i + 1];
    struct text text = {0};
    text_format(&text, "T%zu·end = T%zu·start", i, i + 1);
    if (!state_key_equal(end->state, start->state)) {
        struct text reason = {0};
        text_format(&reason, "the end of child %zu", i);
        states_differ(&reason, "", end->state, "the start of the next child in", start->state);
        return equation_refuse(prover, BCIFS_ADJACENCY, &text, next->source, next->place, &reason);
    }
    return equation_decide(prover, BCIFS_ADJACENCY, &text, next->source, next->place,
                           value_matrix_multiply(prover->arena, cell->children[i].map, end->operator),
                           value_matrix_multiply(prover->arena, next->map, start->operator));
}

static bcifs_status check_edge(struct prover *prover, const struct cell *cell)
{
    struct cell **children;
    bcifs_status status = children_elaborate(prover, cell, &children);
    for (int side = 0; side < 2 && status == BCIFS_OK; side++)
        status = check_edge_incidence(prover, cell, children, side);
    for (size_t i = 0; i + 1 < cell->child_count && status == BCIFS_OK; i++)
        status = check_edge_adjacency(prover, cell, children, i);
    return status;
}

/* ---- Faces --------------------------------------------------------------------------------------------- */

/* T_i Π_γ for every boundary γ of every child: where the face's boundary must be found again. */
struct side {
    size_t child;
    const struct cell_boundary *boundary;
    const struct value_matrix *operator;
};

static bcifs_status sides_list(struct prover *prover, const struct cell *cell, struct side **sides, size_t *count)
{
    struct cell **children;
    bcifs_status status = children_elaborate(prover, cell, &children);
    if (status)
        return status;
    *count = 0;
    for (size_t i = 0; i < cell->child_count; i++)
        *count += children[i]->boundary_count;
    *sides = arena_new(prover->arena, *count, sizeof **sides);
    if (!*sides)
        return out_of_memory(prover);
    size_t next = 0;
    for (size_t i = 0; i < cell->child_count; i++)
        for (size_t b = 0; b < children[i]->boundary_count; b++) {
            const struct cell_boundary *boundary = &children[i]->boundaries[b];
            const struct value_matrix *operator =
                value_matrix_multiply(prover->arena, cell->children[i].map, boundary->operator);
            if (!operator)
                return out_of_memory(prover);
            (*sides)[next++] = (struct side){i, boundary, operator};
        }
    return BCIFS_OK;
}

/* Π_β T^y_j = T^x_i Π_γ for some i, γ: design, section 3. */
static bcifs_status check_face_incidence(struct prover *prover, const struct cell_boundary *boundary,
                                         const struct cell *edge, size_t j, const struct side *sides,
                                         size_t count)
{
    const struct cell_child *piece = &edge->children[j];
    const struct value_matrix *left = value_matrix_multiply(prover->arena, boundary->operator, piece->map);
    const struct side *found = NULL, *near = NULL;
    if (!left)
        return out_of_memory(prover);
    for (size_t i = 0; i < count && !found; i++)
        if (state_key_equal(sides[i].boundary->state, piece->state)) {
            near = near ? near : &sides[i];
            found = sides_agree(left, sides[i].operator) ? &sides[i] : NULL;
        }
    struct text text = {0};
    text_format(&text, "%s·T%zu(%s) = ", boundary->name, j, boundary->state.definition->name);
    if (found) {
        text_format(&text, "T%zu·%s", found->child, found->boundary->name);
        return equation_decide(prover, BCIFS_INCIDENCE, &text, boundary->source, boundary->place, left,
                               found->operator);
    }
    struct text reason = {0};
    text_append(&text, "Ti·boundary");
    text_format(&reason, "no child has this part of the boundary '%s'", boundary->name);
    if (!near) {
        text_append(&reason, ": none has a boundary in the state ");
        state_name(&piece->state, &reason);
    }
    return equation_refuse(prover, BCIFS_INCIDENCE, &text, boundary->source, boundary->place, &reason);
}

/* A·R with R reversing the order of the columns. */
static const struct value_matrix *reversed(struct arena *arena, const struct value_matrix *matrix)
{
    struct value_matrix *result = value_matrix_new(arena, matrix->rows, matrix->columns);
    for (size_t i = 0; result && i < matrix->rows * matrix->columns; i++) {
        size_t row = i / matrix->columns, column = i % matrix->columns;
        result->values[i] = matrix->values[row * matrix->columns + matrix->columns - 1 - column];
    }
    if (result)
        value_matrix_finish(result);
    return result;
}

static const struct side *side_find(const struct side *sides, size_t count, size_t child, const char *name)
{
    for (size_t i = 0; i < count; i++)
        if (sides[i].child == child && strcmp(sides[i].boundary->name, name) == 0)
            return &sides[i];
    return NULL;
}

/* An asserted `join i.β = j.γ`. */
static bcifs_status check_join(struct prover *prover, const struct cell *cell, const struct cell_join *join,
                               const struct side *sides, size_t count)
{
    const struct source *source = cell->definition->module->source;
    const struct side *a = side_find(sides, count, join->child[0], join->boundary[0]);
    const struct side *b = side_find(sides, count, join->child[1], join->boundary[1]);
    struct text text = {0}, reason = {0};
    text_format(&text, "T%zu·%s = T%zu·%s%s", join->child[0], join->boundary[0], join->child[1],
                join->boundary[1], join->reversed ? " reversed" : "");
    if (!a || !b)
        text_format(&reason, "child %zu has no boundary '%s'", join->child[a ? 1 : 0],
                    join->boundary[a ? 1 : 0]);
    else if (!state_key_equal(a->boundary->state, b->boundary->state))
        states_differ(&reason, "the first side", a->boundary->state, "the second", b->boundary->state);
    if (reason.length > 0)
        return equation_refuse(prover, BCIFS_ADJACENCY, &text, source, join->place, &reason);
    return equation_decide(prover, BCIFS_ADJACENCY, &text, source, join->place, a->operator,
                           join->reversed ? reversed(prover->arena, b->operator) : b->operator);
}

/* Whether the file asserts this very gluing, so that it is an equation already. */
static bool is_joined(const struct cell *cell, const struct side *a, const struct side *b, bool backwards)
{
    const struct side *sides[2] = {a, b};
    for (size_t i = 0; i < cell->join_count; i++)
        for (int turned = 0; turned < 2; turned++) {
            const struct cell_join *join = &cell->joins[i];
            bool same = join->reversed == backwards;
            for (int k = 0; k < 2; k++)
                same = same && join->child[k] == sides[k ^ turned]->child &&
                       strcmp(join->boundary[k], sides[k ^ turned]->boundary->name) == 0;
            if (same)
                return true;
        }
    return false;
}

/* T_i Π_γ = T_j Π_δ, or with the second run backwards; vertices have no direction. NULL: neither. */
static const struct value_matrix *glued(struct prover *prover, const struct side *a, const struct side *b,
                                        bool *backwards)
{
    *backwards = false;
    if (a->child == b->child || !state_key_equal(a->boundary->state, b->boundary->state))
        return NULL;
    if (sides_agree(a->operator, b->operator))
        return b->operator;
    *backwards = true;
    if (a->boundary->state.definition->kind != CELL_EDGE)
        return NULL;
    const struct value_matrix *turned = reversed(prover->arena, b->operator);
    return turned && sides_agree(a->operator, turned) ? turned : NULL;
}

/* Sides of two children that are found to coincide: the engine glues them without being told. */
static bcifs_status check_gluing(struct prover *prover, const struct cell *cell, const struct side *sides,
                                 size_t count)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count && status == BCIFS_OK; j++) {
            bool backwards;
            const struct value_matrix *other = glued(prover, &sides[i], &sides[j], &backwards);
            if (!other || is_joined(cell, &sides[i], &sides[j], backwards))
                continue;
            struct text text = {0};
            text_format(&text, "T%zu·%s = T%zu·%s%s", sides[i].child, sides[i].boundary->name, sides[j].child,
                        sides[j].boundary->name, backwards ? " reversed" : "");
            const struct cell_child *child = &cell->children[sides[j].child];
            status = equation_decide(prover, BCIFS_ADJACENCY, &text, child->source, child->place,
                                     sides[i].operator, other);
        }
    return status;
}

static bcifs_status check_face(struct prover *prover, const struct cell *cell)
{
    struct side *sides;
    size_t count;
    bcifs_status status = sides_list(prover, cell, &sides, &count);
    for (size_t b = 0; b < cell->boundary_count && status == BCIFS_OK; b++) {
        const struct cell_boundary *boundary = &cell->boundaries[b];
        struct cell *edge;
        status = cell_elaborate(&prover->sample->setting, prover->arena, boundary->state, &edge);
        for (size_t j = 0; status == BCIFS_OK && j < edge->child_count; j++)
            status = check_face_incidence(prover, boundary, edge, j, sides, count);
    }
    for (size_t i = 0; i < cell->join_count && status == BCIFS_OK; i++)
        status = check_join(prover, cell, &cell->joins[i], sides, count);
    return status ? status : check_gluing(prover, cell, sides, count);
}

/* ---- One state ----------------------------------------------------------------------------------------- */

/* Goes through all equations of the state for one sample. */
static bcifs_status check_round(struct prover *prover, struct sample *sample)
{
    struct cell *cell;
    prover->sample = sample;
    prover->next = 0;
    bcifs_status status = cell_elaborate(&sample->setting, prover->arena, sample->key, &cell);
    if (status)
        return status;
    status = check_barycentric(prover, cell);
    if (status == BCIFS_OK && cell->definition->kind == CELL_EDGE)
        status = check_edge(prover, cell);
    if (status == BCIFS_OK && cell->definition->kind == CELL_FACE)
        status = check_face(prover, cell);
    return status;
}

/* The values of a sample that are free: "a = 1/4, u = 2". */
static const char *sample_text(const struct prover *prover, const struct sample *sample)
{
    const bcifs_automaton *automaton = prover->check->automaton;
    const struct definition *definition = prover->definition;
    struct text text = {0};
    for (size_t i = 0; i < automaton->parameter_count; i++) {
        text_format(&text, "%s%s = ", text.length ? ", " : "", automaton->parameters[i].name);
        text_append_number(&text, sample->parameters[i].real);
    }
    for (size_t i = 0; i < definition->argument_count; i++) {
        bool named = definition->syntax && definition->syntax->argument_count == definition->argument_count;
        text_append(&text, text.length ? ", " : "");
        if (named)
            text_format(&text, "%s = ", definition->syntax->arguments[i]);
        else
            text_format(&text, "argument %zu = ", i);
        text_append_number(&text, sample->arguments[i].real);
    }
    const char *copy = text.failed ? NULL : arena_text(&prover->check->arena, text.data, text.length);
    text_free(&text);
    return copy;
}

static const double *side_reals(const struct prover *prover, const struct value_matrix *matrix)
{
    size_t count = matrix->rows * matrix->columns;
    double *reals = arena_new(&prover->check->arena, count, sizeof *reals);
    for (size_t i = 0; reals && i < count; i++)
        reals[i] = matrix->values[i].real;
    return reals;
}

/* Keeps both sides of the equation at a sample where it visibly fails. */
static bcifs_status witness_keep(struct prover *prover, bcifs_equation *equation, const struct sample *sample,
                                 size_t where, double largest)
{
    equation->rows = (int)prover->left->rows;
    equation->columns = (int)prover->left->columns;
    equation->left = side_reals(prover, prover->left);
    equation->right = side_reals(prover, prover->right);
    equation->row = (int)(where / prover->left->columns);
    equation->column = (int)(where % prover->left->columns);
    equation->residual = largest;
    equation->at = sample_text(prover, sample);
    return equation->left && equation->right && equation->at ? BCIFS_OK : out_of_memory(prover);
}

/* Searches numbers at which a refuted equation can be seen to fail: the file's own first. */
static bcifs_status witness_find(struct prover *prover, size_t index)
{
    bcifs_equation *equation = &prover->check->equations[index];
    bool found = false;
    bcifs_status status = BCIFS_OK;
    prover->witnessing = true;
    prover->wanted = index;
    for (uint64_t i = 0; i < MOST_WITNESSES && !found && status == BCIFS_OK; i++) {
        struct arena arena = {0};
        struct sample sample;
        prover->arena = &arena;
        prover->left = prover->right = NULL;
        enum sample_kind kind = i == 0 ? SAMPLE_ACTUAL : SAMPLE_WITNESS;
        status = sample_take(prover->check->automaton, prover->definition, prover->fixed, kind, i, &arena, NULL,
                             &sample);
        bcifs_status round = status ? status : check_round(prover, &sample);
        if (round == BCIFS_MEMORY)
            status = round;
        if (round == BCIFS_OK && prover->left && prover->right) {
            size_t where;
            double scale, largest = difference(prover->left, prover->right, &where, &scale);
            found = largest > 1e-9 * scale && isfinite(largest);
            if (found)
                status = witness_keep(prover, equation, &sample, where, largest);
        }
        arena_free(&arena);
    }
    prover->witnessing = false;
    if (status == BCIFS_OK && !found && !equation->reason)
        equation->reason = "it fails as an identity; no numbers were found at which the difference shows";
    return status;
}

/* One round that has a value: a sample may hit a pole of the entries by accident, and is then replaced. */
static bcifs_status round_run(struct prover *prover, unsigned round)
{
    bcifs_status status = BCIFS_INPUT;
    for (uint64_t i = 0; i < MOST_TRIES && status == BCIFS_INPUT; i++) {
        struct arena arena = {0};
        struct sample sample;
        prover->arena = &arena;
        prover->check->count = prover->opening ? prover->first : prover->check->count;
        status = sample_take(prover->check->automaton, prover->definition, prover->fixed, SAMPLE_PROVING,
                             round * MOST_TRIES + i, &arena, NULL, &sample);
        if (status == BCIFS_OK)
            status = check_round(prover, &sample);
        arena_free(&arena);
    }
    return status;
}

/* Entries that have no value wherever they are tried: let the evaluation say so itself. */
static bcifs_status round_explain(struct prover *prover)
{
    struct arena arena = {0};
    struct sample sample;
    prover->arena = &arena;
    bcifs_status status = sample_take(prover->check->automaton, prover->definition, prover->fixed, SAMPLE_ACTUAL, 0,
                                      &arena, prover->report, &sample);
    if (status == BCIFS_OK)
        status = check_round(prover, &sample);
    arena_free(&arena);
    if (status == BCIFS_OK)
        status = report_failure(prover->report, BCIFS_INPUT, prover->definition->module->source->name,
                                "the entries of '%s' have no value where they were tried",
                                prover->definition->name);
    return status;
}

static bcifs_status state_summarize(struct prover *prover);

/* The state's name; the arguments that its size depends on have values, the others stay names: "corner(3,u)". */
static const char *checked_name(bcifs_check *check, const struct definition *definition, const struct value *fixed)
{
    struct text text = {0};
    text_append(&text, definition->name);
    for (size_t i = 0; fixed && i < definition->argument_count; i++) {
        bool named = definition->syntax && definition->syntax->argument_count == definition->argument_count;
        text_append(&text, i ? "," : "(");
        if (definition->structural[i])
            text_append_number(&text, fixed[i].real);
        else
            text_append(&text, named ? definition->syntax->arguments[i] : "·");
    }
    text_append(&text, fixed ? ")" : "");
    const char *name = text.failed ? NULL : arena_text(&check->arena, text.data, text.length);
    text_free(&text);
    return name;
}

static bcifs_status state_check(bcifs_check *check, const struct definition *definition,
                                const struct value *fixed, struct report *report)
{
    struct prover prover = {.check = check,
                            .report = report,
                            .definition = definition,
                            .fixed = fixed,
                            .name = checked_name(check, definition, fixed),
                            .first = check->count};
    bcifs_status status = prover.name ? BCIFS_OK : report_memory(report);
    for (unsigned round = 0; round < PROOF_ROUNDS && status == BCIFS_OK; round++) {
        prover.opening = round == 0;
        status = round_run(&prover, round);
    }
    if (status == BCIFS_INPUT && report->errors == 0)
        status = round_explain(&prover);
    prover.opening = false;
    for (size_t i = prover.first; i < check->count && status == BCIFS_OK; i++)
        if (!check->equations[i].holds && !check->equations[i].reason)
            status = witness_find(&prover, i);
    return status ? status : state_summarize(&prover);
}

/* ---- Summaries ----------------------------------------------------------------------------------------- */

static bcifs_status summary_fill(struct prover *prover, const struct cell *cell)
{
    bcifs_check *check = prover->check;
    struct arena *arena = &check->arena;
    struct state_summary summary = {.name = prover->name,
                                    .kind = cell->definition->kind,
                                    .points = cell->points,
                                    .child_count = cell->child_count,
                                    .boundary_count = cell->boundary_count};
    summary.children = arena_new(arena, cell->child_count, sizeof *summary.children);
    summary.boundaries = arena_new(arena, cell->boundary_count, sizeof *summary.boundaries);
    summary.boundary_states = arena_new(arena, cell->boundary_count, sizeof *summary.boundary_states);
    if (!summary.children || !summary.boundaries || !summary.boundary_states)
        return out_of_memory(prover);
    for (size_t i = 0; i < cell->child_count; i++)
        summary.children[i] = cell->children[i].state.definition->name;
    for (size_t i = 0; i < cell->boundary_count; i++) {
        summary.boundaries[i] = arena_text(arena, cell->boundaries[i].name, strlen(cell->boundaries[i].name));
        summary.boundary_states[i] = cell->boundaries[i].state.definition->name;
        if (!summary.boundaries[i])
            return out_of_memory(prover);
    }
    if (!ARENA_RESERVE(arena, check->states, check->state_count, check->state_capacity))
        return out_of_memory(prover);
    check->states[check->state_count++] = summary;
    return BCIFS_OK;
}

/* What the state looks like, once for each definition. */
static bcifs_status state_summarize(struct prover *prover)
{
    const bcifs_check *check = prover->check;
    if (check->state_count > 0 &&
        strcmp(check->states[check->state_count - 1].name, prover->name) == 0)
        return BCIFS_OK;
    struct arena arena = {0};
    struct sample sample;
    struct cell *cell;
    bcifs_status status = sample_take(check->automaton, prover->definition, prover->fixed, SAMPLE_PROVING, 0,
                                      &arena, NULL, &sample);
    for (uint64_t i = 1; i <= MOST_TRIES && status == BCIFS_OK; i++) {
        status = cell_elaborate(&sample.setting, &arena, sample.key, &cell);
        if (status != BCIFS_INPUT)
            break;
        status = sample_take(check->automaton, prover->definition, prover->fixed, SAMPLE_PROVING, i, &arena, NULL,
                             &sample);
    }
    if (status == BCIFS_OK)
        status = summary_fill(prover, cell);
    arena_free(&arena);
    return status;
}

/* ---- All states ---------------------------------------------------------------------------------------- */

/* States whose sizes depend on arguments are checked as the figures reach them. */
static bcifs_status reached_check(bcifs_check *check, struct states *states, const struct definition *definition,
                                  struct report *report)
{
    bcifs_status status = BCIFS_OK;
    bool reached = false;
    for (size_t i = 0; i < states->count && status == BCIFS_OK; i++) {
        if (states->states[i].key.definition != definition)
            continue;
        bool again = false;
        for (size_t j = 0; j < i && !again; j++) {
            again = states->states[j].key.definition == definition;
            for (size_t k = 0; again && k < definition->argument_count; k++)
                again = !definition->structural[k] || value_equal(states->states[i].key.arguments[k],
                                                                  states->states[j].key.arguments[k]);
        }
        reached = true;
        if (!again)
            status = state_check(check, definition, states->states[i].key.arguments, report);
    }
    if (!reached)
        report_warning(report, definition->module->source, definition->syntax->place,
                       "the size of '%s' depends on its arguments and no figure reaches it: not checked",
                       definition->name);
    return status;
}

static bcifs_status contraction_check(bcifs_check *check, struct states *states, struct report *report)
{
    bcifs_status status = radius_bound(states, &check->arena, &check->radius);
    if (status || check->radius.lower < 1 - TOLERANCE_RADIUS)
        return status;
    char radius[DECIMAL_LONGEST + 1];
    radius[decimal_print_digits(radius, check->radius.lower, 6)] = '\0';
    if (check->radius.source)
        report_warning(report, check->radius.source, check->radius.place,
                       "not contractive: the linear part of the product %s has spectral radius %s per map",
                       check->radius.product, radius);
    return BCIFS_OK;
}

static bcifs_status check_all(bcifs_check *check, struct report *report)
{
    const bcifs_automaton *automaton = check->automaton;
    struct arena arena = {0};
    struct states states;
    bcifs_status status = BCIFS_OK;
    if (automaton->unknowns > 0)
        return report_failure(report, BCIFS_INPUT, automaton->modules[0]->source->name,
                              "the automaton has %zu unknown entr%s '?'; nothing can be checked before they are "
                              "filled in",
                              automaton->unknowns, automaton->unknowns == 1 ? "y" : "ies");
    status = states_of_figures(automaton, &states, &arena);
    for (size_t i = 0; i < automaton->definition_count && status == BCIFS_OK; i++) {
        const struct definition *definition = automaton->definitions[i];
        if (definition_is_structural(definition))
            status = reached_check(check, &states, definition, report);
        else
            status = state_check(check, definition, NULL, report);
    }
    check->valid = true;
    for (size_t i = 0; i < check->count; i++)
        check->valid = check->valid && check->equations[i].holds;
    if (status == BCIFS_OK)
        status = contraction_check(check, &states, report);
    arena_free(&arena);
    if (status == BCIFS_MEMORY && report->errors == 0)
        report_memory(report);
    else if (status && report->errors == 0)
        report_failure(report, status, automaton->modules[0]->source->name, "the automaton has no finite numbers");
    return status;
}

bcifs_status bcifs_check_create(const bcifs_automaton *automaton, const bcifs_load_options *options,
                                bcifs_check **check, bcifs_error *error)
{
    struct report report = report_new(options);
    bcifs_check *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? BCIFS_OK : report_memory(&report);
    if (status == BCIFS_OK) {
        fresh->automaton = automaton;
        status = check_all(fresh, &report);
    }
    if (status) {
        bcifs_check_free(fresh);
        report_close(&report, error);
        return status;
    }
    *check = fresh;
    return BCIFS_OK;
}

void bcifs_check_free(bcifs_check *check)
{
    if (!check)
        return;
    arena_free(&check->arena);
    memory_free(check);
}

int bcifs_check_valid(const bcifs_check *check)
{
    return check->valid;
}

size_t bcifs_check_equation_count(const bcifs_check *check)
{
    return check->count;
}

const bcifs_equation *bcifs_check_equation(const bcifs_check *check, size_t index)
{
    return index < check->count ? &check->equations[index] : NULL;
}

bcifs_status bcifs_check_require(const bcifs_check *check, const bcifs_load_options *options, bcifs_error *error)
{
    struct report report = report_new(options);
    for (size_t i = 0; i < check->count && report.errors == 0; i++)
        if (!check->equations[i].holds)
            report_error(&report, check->places[i].source, check->places[i].place,
                         "'%s' does not satisfy %s; 'bcifs check' shows why", check->equations[i].state,
                         check->equations[i].text);
    if (report.errors > 0)
        report.first.status = BCIFS_NO;
    return report_close(&report, error);
}

void bcifs_check_contraction(const bcifs_check *check, double *lower, double *upper, const char **product)
{
    *lower = check->radius.lower;
    *upper = check->radius.upper;
    *product = check->radius.product;
}
