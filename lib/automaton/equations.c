#include "equations.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "numeric/field.h"
#include "numeric/tolerance.h"

enum { MOST_TRIES = 8 /* choices of numbers for the params when one hits a pole of the entries */ };

/* factor · unknown, in one probe. */
struct probe_term {
    size_t unknown;
    struct value factor;
};

/* One side of an equation: left·right, or the sums of right's columns when left is NULL. */
struct product {
    const struct value_matrix *left, *right;
    bool reversed; /* the columns of the product run backward */
};

/* The equation of one entry in all probes of its state. */
struct probed {
    struct entry_equation equation;
    struct probe_term *terms; /* of the constant probe; until it is taken, of the random one */
    size_t count;
    struct value *known;     /* per probe */
    double scale;            /* of the numbers in `known[0]` */
    bool varies;             /* a factor differs between probes */
    struct product sides[2]; /* of the constant probe; no right side: that matrix is NULL */
};

/* Probes of a state: 0 has random residues for the free params, 1 fixed numbers, 2 + i the same with free
 * param i one greater; the last, for a state with arguments, is 1 with other arguments. */
enum { PROBE_RANDOM, PROBE_CONSTANT, PROBE_STEP };

/* The posing of one state's equations. */
struct poser {
    struct equations *equations;
    const struct definition *definition;
    const size_t *free; /* parameters that are not pinned */
    size_t free_count;
    size_t probes, probe;
    uint64_t attempt; /* which numbers the probes take */
    struct probed *list;
    size_t count, capacity, next;
    size_t *choices; /* sides that the first probe chose, for the others */
    size_t choice_count, choice_capacity, next_choice;
    struct setting setting;
    struct arena *arena; /* of the state: lists and probes */
};

static bcifs_status out_of_memory(const struct equations *equations)
{
    return report_memory(equations->report);
}

/* ---- The open entries ---------------------------------------------------------------------------------- */

/* Whether an entry stands on the diagonal of a map: of T_i in a refinement matrix, whose columns are iΔ … of
 * it. */
static bool is_diagonal(const struct syntax_part *part, size_t row, size_t column)
{
    size_t rows = part->matrix->rows, columns = part->matrix->columns, n = (size_t)part->number;
    if (part->kind == PART_SUB)
        return row == column;
    if (part->kind != PART_REFINE || n < 2 || columns <= rows)
        return false;
    size_t step = (columns - rows) / (n - 1); /* columns = (N - 1)Δ + m_a, [IM] 4.1 */
    return step > 0 && column >= row && (column - row) % step == 0 && (column - row) / step < n;
}

/* Open entries where none may be: refused with a reason. */
static bcifs_status matrix_refuse(const struct equations *equations, const struct module *module,
                                  const struct syntax_matrix *matrix, const char *reason)
{
    for (size_t i = 0; matrix && i < matrix->rows * matrix->columns; i++)
        if (matrix->entries[i]->kind == EXPRESSION_UNKNOWN)
            return report_error(equations->report, module->source, matrix->entries[i]->place, "%s", reason);
    return BCIFS_OK;
}

static bcifs_status cell_unknowns(struct equations *equations, const struct module *module,
                                  const struct syntax_cell *cell)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < cell->part_count && status == BCIFS_OK; i++) {
        const struct syntax_part *part = cell->parts[i];
        const struct syntax_matrix *matrix = part->matrix;
        status = matrix_refuse(equations, module, part->location.matrix,
                               "a boundary must be known: with '?' in it the equations are not linear");
        if (status == BCIFS_OK && module != equations->automaton->modules[0])
            status = matrix_refuse(equations, module, matrix,
                                   "this file is used by another one: complete it on its own first");
        for (size_t j = 0; status == BCIFS_OK && matrix && j < matrix->rows * matrix->columns; j++)
            if (matrix->entries[j]->kind == EXPRESSION_UNKNOWN)
                equations->unknowns[matrix->entries[j]->index] = (struct open_entry){
                    matrix->entries[j], cell, is_diagonal(part, j / matrix->columns, j % matrix->columns)};
    }
    return status;
}

static bcifs_status item_unknowns(struct equations *equations, const struct module *module,
                                  const struct syntax_item *item)
{
    static const char elsewhere[] = "'?' may stand in maps, refinement matrices and masks only";
    bcifs_status status = BCIFS_OK;
    if (item->kind == ITEM_CELL)
        return cell_unknowns(equations, module, item->cell);
    if (item->kind == ITEM_WAVELET) {
        status = matrix_refuse(equations, module, item->wavelet->smooth, elsewhere);
        return status ? status : matrix_refuse(equations, module, item->wavelet->detail, elsewhere);
    }
    for (size_t i = 0; item->kind == ITEM_FIGURE && i < item->figure->part_count && status == BCIFS_OK; i++)
        status = matrix_refuse(equations, module, item->figure->parts[i]->matrix, elsewhere);
    return status;
}

static bcifs_status unknowns_list(struct equations *equations)
{
    const bcifs_automaton *automaton = equations->automaton;
    if (automaton->unknowns > EQUATIONS_MOST_UNKNOWNS)
        return report_failure(equations->report, BCIFS_INPUT, automaton->modules[0]->source->name,
                              "%zu entries are open ('?'); the limit is %d", automaton->unknowns,
                              EQUATIONS_MOST_UNKNOWNS);
    equations->unknowns = arena_new(equations->arena, automaton->unknowns, sizeof *equations->unknowns);
    if (!equations->unknowns)
        return out_of_memory(equations);
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < automaton->module_count; i++)
        for (size_t j = 0; j < automaton->modules[i]->syntax->count && status == BCIFS_OK; j++)
            status =
                item_unknowns(equations, automaton->modules[i], &automaton->modules[i]->syntax->items[j]);
    return status;
}

/* ---- One entry of an equation -------------------------------------------------------------------------- */

/* An entry while it is summed up in one probe. */
struct entry_sum {
    struct probe_term *terms;
    size_t count, capacity;
    struct value known;
    double scale;
    bool failed; /* no memory */
};

static void sum_unknown(struct poser *poser, struct entry_sum *sum, const struct unknown_term *term,
                        struct value factor, int sign)
{
    if (factor.exact && factor.fixed && factor.residue == 0)
        return;
    for (; term; term = term->next) {
        size_t i = 0;
        while (i < sum->count && sum->terms[i].unknown != term->unknown)
            i++;
        if (i == sum->count) {
            if (!ARENA_RESERVE(poser->arena, sum->terms, sum->count, sum->capacity)) {
                sum->failed = true;
                return;
            }
            sum->terms[sum->count++] = (struct probe_term){term->unknown, value_from_integer(0)};
        }
        struct value share = value_multiply(factor, value_from_integer(sign * term->factor));
        sum->terms[i].factor = value_add(sum->terms[i].factor, share);
    }
}

/* Adds ± entry (row, column) of left·right. */
static void sum_product(struct poser *poser, struct entry_sum *sum, const struct product *product, size_t row,
                        size_t column, int sign)
{
    const struct value_matrix *left = product->left, *right = product->right;
    struct value signed_one = value_from_integer(sign);
    if (product->reversed)
        column = right->columns - 1 - column;
    for (size_t k = 0; k < right->rows; k++) {
        size_t i = left ? row * left->columns + k : 0, j = k * right->columns + column;
        struct value a = left ? left->values[i] : value_from_integer(1), b = right->values[j];
        struct value share = value_multiply(a, b);
        sum->known = value_add(sum->known, value_multiply(signed_one, share));
        sum->scale = fmax(sum->scale, fabs(share.real));
        if (left && left->unknowns)
            sum_unknown(poser, sum, left->unknowns[i], b, sign);
        if (right->unknowns)
            sum_unknown(poser, sum, right->unknowns[j], a, sign);
    }
}

/* What a matrix equation is called and where it stands. */
struct label {
    bcifs_equation_kind kind;
    const char *text;
    const struct source *source;
    source_place place;
};

static bcifs_status too_many(const struct poser *poser)
{
    return report_failure(poser->equations->report, BCIFS_INPUT, poser->definition->module->source->name,
                          "more than %d equations, or %d terms in them", EQUATIONS_MOST,
                          EQUATIONS_MOST_TERMS);
}

/* The equation of this number: made in the first probe. */
static bcifs_status probed_open(struct poser *poser, const struct label *label, size_t row, size_t column,
                                struct probed **probed)
{
    if (poser->probe == 0) {
        struct probed fresh = {.equation = {.state = poser->definition->name,
                                            .kind = label->kind,
                                            .text = label->text,
                                            .row = row,
                                            .column = column,
                                            .source = label->source,
                                            .place = label->place},
                               .known = arena_new(poser->arena, poser->probes, sizeof *fresh.known)};
        if (poser->equations->posed + poser->count >= EQUATIONS_MOST)
            return too_many(poser);
        if (!fresh.known || !ARENA_RESERVE(poser->arena, poser->list, poser->count, poser->capacity))
            return out_of_memory(poser->equations);
        poser->list[poser->count++] = fresh;
    }
    /* Every probe enumerates alike; the guard only keeps a surprise from writing past the end. */
    *probed = poser->next < poser->count ? &poser->list[poser->next] : NULL;
    poser->next++;
    return BCIFS_OK;
}

static bool same_terms(const struct probed *probed, const struct entry_sum *sum)
{
    if (probed->count != sum->count)
        return false;
    for (size_t i = 0; i < sum->count; i++)
        if (probed->terms[i].unknown != sum->terms[i].unknown || !sum->terms[i].factor.exact ||
            probed->terms[i].factor.residue != sum->terms[i].factor.residue)
            return false;
    return true;
}

/* left - right = 0, entry by entry. */
static bcifs_status pose(struct poser *poser, const struct label *label, struct product left,
                         const struct product *right, size_t rows)
{
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < left.right->columns; c++) {
            struct probed *probed;
            struct entry_sum sum = {.known = value_from_integer(right ? 0 : -1), .scale = 1};
            bcifs_status status = probed_open(poser, label, r, c, &probed);
            if (status || !probed)
                return status;
            sum_product(poser, &sum, &left, r, c, 1);
            if (right)
                sum_product(poser, &sum, right, r, c, -1);
            if (sum.failed)
                return out_of_memory(poser->equations);
            poser->equations->terms += sum.count;
            if (poser->equations->terms > EQUATIONS_MOST_TERMS)
                return too_many(poser);
            probed->known[poser->probe] = sum.known;
            probed->varies = probed->varies || (poser->probe > 0 && !same_terms(probed, &sum));
            if (poser->probe <= PROBE_CONSTANT) {
                probed->terms = sum.terms;
                probed->count = sum.count;
                probed->scale = fmax(probed->scale, sum.scale);
                probed->sides[0] = left;
                probed->sides[1] = right ? *right : (struct product){0};
            }
        }
    return BCIFS_OK;
}

/* An equation that no numbers can satisfy. */
static bcifs_status pose_failure(struct poser *poser, const struct label *label, const struct text *reason)
{
    struct probed *probed;
    bcifs_status status = probed_open(poser, label, 0, 0, &probed);
    if (status || !probed || poser->probe > 0)
        return status;
    probed->equation.reason =
        reason->failed ? NULL : arena_text(poser->equations->arena, reason->data, reason->length);
    return probed->equation.reason ? BCIFS_OK : out_of_memory(poser->equations);
}

/* A label; its text is kept in the first probe only. Takes the text. */
static bcifs_status label_make(struct poser *poser, bcifs_equation_kind kind, struct text *text,
                               const struct source *source, source_place place, struct label *label)
{
    *label = (struct label){kind, "", source, place};
    if (poser->probe == 0)
        label->text = text->failed ? NULL : arena_text(poser->equations->arena, text->data, text->length);
    text_free(text);
    return label->text ? BCIFS_OK : out_of_memory(poser->equations);
}

/* ---- Cells --------------------------------------------------------------------------------------------- */

static bcifs_status pose_sums(struct poser *poser, const struct value_matrix *matrix, struct text *text,
                              const struct source *source, source_place place)
{
    struct label label;
    bcifs_status status = label_make(poser, BCIFS_BARYCENTRIC, text, source, place, &label);
    return status ? status : pose(poser, &label, (struct product){NULL, matrix, false}, NULL, 1);
}

/* 1·A = 1 for every map and boundary. */
static bcifs_status pose_barycentric(struct poser *poser, const struct cell *cell)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < cell->child_count && status == BCIFS_OK; i++) {
        const struct cell_child *child = &cell->children[i];
        struct text text = {0};
        if (cell->definition->kind == CELL_VERTEX)
            text_append(&text, "1·T = 1");
        else
            text_format(&text, "1·T%zu = 1", i);
        status = pose_sums(poser, child->map, &text, child->source, child->place);
    }
    for (size_t i = 0; i < cell->boundary_count && status == BCIFS_OK; i++) {
        const struct cell_boundary *boundary = &cell->boundaries[i];
        struct text text = {0};
        text_format(&text, "1·%s = 1", boundary->name);
        status = pose_sums(poser, boundary->operator, & text, boundary->source, boundary->place);
    }
    return status;
}

/* The cells of the children, for their boundaries. */
static bcifs_status children_elaborate(struct poser *poser, const struct cell *cell, struct cell ***children)
{
    *children = arena_new(poser->arena, cell->child_count, sizeof **children);
    if (!*children)
        return out_of_memory(poser->equations);
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < cell->child_count && status == BCIFS_OK; i++) {
        for (size_t j = 0; j < i && !(*children)[i]; j++)
            if (state_key_equal(cell->children[j].state, cell->children[i].state))
                (*children)[i] = (*children)[j];
        if (!(*children)[i])
            status = cell_elaborate(&poser->setting, poser->arena, cell->children[i].state, &(*children)[i]);
    }
    return status;
}

/* States that should be the same and are not: "… is in the state a, … b". */
static bcifs_status pose_states(struct poser *poser, const struct label *label, const char *what,
                                struct state_key a, const char *other, struct state_key b)
{
    struct text reason = {0};
    text_format(&reason, "%s is in the state ", what);
    state_name(&a, &reason);
    text_format(&reason, ", %s in ", other);
    state_name(&b, &reason);
    bcifs_status status = pose_failure(poser, label, &reason);
    text_free(&reason);
    return status;
}

/* T_i Π_side = Π_side T^s, [IM] (8). */
static bcifs_status pose_edge_incidence(struct poser *poser, const struct cell *cell, struct cell **children,
                                        int side)
{
    size_t i = side ? cell->child_count - 1 : 0;
    const struct cell_boundary *boundary = &cell->boundaries[side], *inner = &children[i]->boundaries[side];
    struct cell *vertex;
    struct label label;
    struct text text = {0};
    bcifs_status status = cell_elaborate(&poser->setting, poser->arena, boundary->state, &vertex);
    if (status)
        return status;
    text_format(&text, "T%zu·%s = %s·T(%s)", i, boundary->name, boundary->name,
                boundary->state.definition->name);
    status =
        label_make(poser, BCIFS_INCIDENCE, &text, cell->children[i].source, cell->children[i].place, &label);
    if (status)
        return status;
    if (!state_key_equal(inner->state, vertex->children[0].state))
        return pose_states(poser, &label, side ? "the end of the last child" : "the start of the first child",
                           inner->state, "the vertex there becomes one", vertex->children[0].state);
    struct product right = {boundary->operator, vertex->children[0].map, false};
    return pose(poser, &label, (struct product){cell->children[i].map, inner->operator, false}, &right,
                cell->points);
}

/* T_i Π_end = T_{i+1} Π_start, [IM] (6). */
static bcifs_status pose_edge_adjacency(struct poser *poser, const struct cell *cell, struct cell **children,
                                        size_t i)
{
    const struct cell_boundary *end = &children[i]->boundaries[1], *start = &children[i + 1]->boundaries[0];
    const struct cell_child *next = &cell->children[i + 1];
    struct label label;
    struct text text = {0};
    text_format(&text, "T%zu·end = T%zu·start", i, i + 1);
    bcifs_status status = label_make(poser, BCIFS_ADJACENCY, &text, next->source, next->place, &label);
    if (status)
        return status;
    if (!state_key_equal(end->state, start->state))
        return pose_states(poser, &label, "the end of the child", end->state, "the start of the next one",
                           start->state);
    struct product left = {cell->children[i].map, end->operator, false};
    struct product right = {next->map, start->operator, false};
    return pose(poser, &label, left, &right, cell->points);
}

static bcifs_status pose_edge(struct poser *poser, const struct cell *cell)
{
    struct cell **children;
    bcifs_status status = children_elaborate(poser, cell, &children);
    for (int side = 0; side < 2 && status == BCIFS_OK; side++)
        status = pose_edge_incidence(poser, cell, children, side);
    for (size_t i = 0; i + 1 < cell->child_count && status == BCIFS_OK; i++)
        status = pose_edge_adjacency(poser, cell, children, i);
    return status;
}

/* ---- Faces --------------------------------------------------------------------------------------------- */

/* T_i Π_γ, a boundary of a child. */
struct side {
    size_t child;
    const struct cell_boundary *boundary;
    struct product product;
};

static bcifs_status sides_list(struct poser *poser, const struct cell *cell, struct side **sides,
                               size_t *count)
{
    struct cell **children;
    bcifs_status status = children_elaborate(poser, cell, &children);
    if (status)
        return status;
    *count = 0;
    for (size_t i = 0; i < cell->child_count; i++)
        *count += children[i]->boundary_count;
    *sides = arena_new(poser->arena, *count, sizeof **sides);
    if (!*sides)
        return out_of_memory(poser->equations);
    struct side *next = *sides;
    for (size_t i = 0; i < cell->child_count; i++)
        for (size_t b = 0; b < children[i]->boundary_count; b++) {
            const struct cell_boundary *boundary = &children[i]->boundaries[b];
            *next++ = (struct side){i, boundary, {cell->children[i].map, boundary->operator, false}};
        }
    return BCIFS_OK;
}

/* Whether left = right can hold: no entry without unknowns fails. `open` tells whether some entry has
 * unknowns. */
static bool may_agree(struct poser *poser, const struct product *left, const struct product *right,
                      size_t rows, bool *open)
{
    *open = false;
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < left->right->columns; c++) {
            struct entry_sum sum = {.known = value_from_integer(0)};
            sum_product(poser, &sum, left, r, c, 1);
            sum_product(poser, &sum, right, r, c, -1);
            *open = *open || sum.count > 0;
            if (sum.count == 0 && (sum.known.exact ? sum.known.residue != 0
                                                   : fabs(sum.known.real) > TOLERANCE_EQUATION * sum.scale))
                return false;
        }
    return true;
}

enum { NO_SIDE = -1 };

/* The child's side that carries a part of the face's boundary: one that agrees, or the only one that can. */
static bcifs_status side_choose(struct poser *poser, const struct product *part, struct state_key state,
                                const struct side *sides, size_t count, size_t rows, const char *name,
                                size_t *chosen)
{
    size_t candidates = 0;
    *chosen = (size_t)NO_SIDE;
    for (size_t i = 0; i < count; i++) {
        bool open;
        if (!state_key_equal(sides[i].boundary->state, state) ||
            !may_agree(poser, part, &sides[i].product, rows, &open))
            continue;
        *chosen = i;
        if (!open)
            return BCIFS_OK;
        candidates++;
    }
    if (candidates <= 1)
        return BCIFS_OK;
    return report_error(
        poser->equations->report, poser->definition->module->source, poser->definition->syntax->place,
        "'%s': %zu sides of its children could carry a part of the boundary '%s'; its open entries "
        "do not pose linear equations before more of them are known",
        poser->definition->name, candidates, name);
}

/* Π_β T^y_j = T_i Π_γ for the i, γ that the first probe finds. */
static bcifs_status pose_face_incidence(struct poser *poser, const struct cell *cell,
                                        const struct cell_boundary *boundary, const struct cell *edge,
                                        size_t j, const struct side *sides, size_t count)
{
    struct product part = {boundary->operator, edge->children[j].map, false};
    if (poser->probe == 0) {
        size_t chosen;
        bcifs_status status = side_choose(poser, &part, edge->children[j].state, sides, count, cell->points,
                                          boundary->name, &chosen);
        if (status)
            return status;
        if (!ARENA_RESERVE(poser->arena, poser->choices, poser->choice_count, poser->choice_capacity))
            return out_of_memory(poser->equations);
        poser->choices[poser->choice_count++] = chosen;
    }
    size_t chosen = poser->choices[poser->next_choice++];
    struct text text = {0};
    text_format(&text, "%s·T%zu(%s) = ", boundary->name, j, boundary->state.definition->name);
    if (chosen < count)
        text_format(&text, "T%zu·%s", sides[chosen].child, sides[chosen].boundary->name);
    else
        text_append(&text, "Ti·boundary");
    struct label label;
    bcifs_status status =
        label_make(poser, BCIFS_INCIDENCE, &text, boundary->source, boundary->place, &label);
    if (status || chosen < count)
        return status ? status : pose(poser, &label, part, &sides[chosen].product, cell->points);
    struct text reason = {0};
    text_format(&reason, "no child can have this part of the boundary '%s'", boundary->name);
    status = pose_failure(poser, &label, &reason);
    text_free(&reason);
    return status;
}

static bcifs_status pose_join(struct poser *poser, const struct cell *cell, const struct cell_join *join,
                              const struct side *sides, size_t count)
{
    const struct side *found[2] = {NULL, NULL};
    for (int s = 0; s < 2; s++)
        for (size_t i = 0; i < count; i++)
            if (sides[i].child == join->child[s] && strcmp(sides[i].boundary->name, join->boundary[s]) == 0)
                found[s] = &sides[i];
    struct text text = {0}, reason = {0};
    text_format(&text, "T%zu·%s = T%zu·%s%s", join->child[0], join->boundary[0], join->child[1],
                join->boundary[1], join->reversed ? " reversed" : "");
    struct label label;
    bcifs_status status =
        label_make(poser, BCIFS_ADJACENCY, &text, cell->definition->module->source, join->place, &label);
    if (status)
        return status;
    if (found[0] && found[1] && !state_key_equal(found[0]->boundary->state, found[1]->boundary->state))
        return pose_states(poser, &label, "the first side", found[0]->boundary->state, "the second one",
                           found[1]->boundary->state);
    if (found[0] && found[1]) {
        struct product right = found[1]->product;
        right.reversed = join->reversed;
        return pose(poser, &label, found[0]->product, &right, cell->points);
    }
    text_append(&reason, "a child has no boundary of this name");
    status = pose_failure(poser, &label, &reason);
    text_free(&reason);
    return status;
}

static bcifs_status pose_face(struct poser *poser, const struct cell *cell)
{
    struct side *sides;
    size_t count;
    bcifs_status status = sides_list(poser, cell, &sides, &count);
    for (size_t b = 0; b < cell->boundary_count && status == BCIFS_OK; b++) {
        struct cell *edge;
        status = cell_elaborate(&poser->setting, poser->arena, cell->boundaries[b].state, &edge);
        for (size_t j = 0; status == BCIFS_OK && j < edge->child_count; j++)
            status = pose_face_incidence(poser, cell, &cell->boundaries[b], edge, j, sides, count);
    }
    for (size_t i = 0; i < cell->join_count && status == BCIFS_OK; i++)
        status = pose_join(poser, cell, &cell->joins[i], sides, count);
    return status;
}

/* ---- Probes -------------------------------------------------------------------------------------------- */

/* The fixed numbers that free params take are small integers, other ones at every try. */
static int64_t fixed_number(const struct poser *poser, size_t i)
{
    return (int64_t)(2 + i + 7 * (size_t)poser->attempt);
}

/* The parameters of a probe. */
static bcifs_status probe_parameters(struct poser *poser, size_t probe, uint64_t attempt)
{
    const bcifs_automaton *automaton = poser->equations->automaton;
    struct value *values = arena_grow(poser->arena, automaton->values, automaton->parameter_count,
                                      automaton->parameter_count + 1, sizeof *values);
    uint64_t state = UINT64_C(0x2545f4914f6cdd1d) * (attempt + 1);
    poser->attempt = attempt;
    if (!values)
        return out_of_memory(poser->equations);
    for (size_t i = 0; i < poser->free_count; i++) {
        struct value *value = &values[poser->free[i]];
        int64_t number = fixed_number(poser, i) + (probe == PROBE_STEP + i);
        uint64_t residue = field_random(&state);
        *value = probe == PROBE_RANDOM ? (struct value){value->real, residue, true, false}
                                       : value_from_integer(number);
    }
    poser->setting = (struct setting){.automaton = automaton, .parameters = values, .proving = true};
    return BCIFS_OK;
}

/* Random ones, the same in all probes but the last. */
static bcifs_status probe_arguments(struct poser *poser, size_t probe, uint64_t attempt,
                                    struct value **arguments)
{
    size_t count = poser->definition->argument_count;
    bool other = count > 0 && probe + 1 == poser->probes;
    uint64_t state = UINT64_C(0x9e3779b97f4a7c15) * (2 * attempt + 1 + other);
    *arguments = arena_new(poser->arena, count, sizeof **arguments);
    if (!*arguments)
        return out_of_memory(poser->equations);
    for (size_t i = 0; i < count; i++) {
        double real = (double)(8 + field_random(&state) % 10) / 8;
        (*arguments)[i] = (struct value){real, field_random(&state), true, false};
    }
    return BCIFS_OK;
}

static bcifs_status probe_run(struct poser *poser, size_t probe, uint64_t attempt)
{
    struct value *arguments;
    struct cell *cell;
    poser->probe = probe;
    poser->next = poser->next_choice = 0;
    bcifs_status status = probe_parameters(poser, probe, attempt);
    if (status == BCIFS_OK)
        status = probe_arguments(poser, probe, attempt, &arguments);
    if (status == BCIFS_OK)
        status = cell_elaborate(&poser->setting, poser->arena,
                                (struct state_key){poser->definition, arguments}, &cell);
    if (status == BCIFS_OK)
        status = pose_barycentric(poser, cell);
    if (status == BCIFS_OK && poser->definition->kind == CELL_EDGE)
        status = pose_edge(poser, cell);
    if (status == BCIFS_OK && poser->definition->kind == CELL_FACE)
        status = pose_face(poser, cell);
    return status;
}

/* All probes; again with other numbers when the entries have a pole at these. */
static bcifs_status probes_run(struct poser *poser)
{
    struct report *report = poser->equations->report;
    bcifs_status status = BCIFS_INPUT;
    for (uint64_t attempt = 0; attempt < MOST_TRIES && status == BCIFS_INPUT && report->errors == 0;
         attempt++) {
        poser->count = poser->choice_count = 0;
        status = BCIFS_OK;
        for (size_t i = 0; i < poser->probes && status == BCIFS_OK; i++)
            status = probe_run(poser, i, attempt);
    }
    if (status == BCIFS_INPUT && report->errors == 0)
        report_error(report, poser->definition->module->source, poser->definition->syntax->place,
                     "the entries of '%s' have no value where they were tried", poser->definition->name);
    return status;
}

/* ---- From probes to rows ------------------------------------------------------------------------------- */

static bcifs_status refuse(const struct poser *poser, const struct probed *probed, const char *reason)
{
    const struct entry_equation *equation = &probed->equation;
    return report_error(poser->equations->report, equation->source, equation->place,
                        "'%s': %s, entry (%zu, %zu): %s", equation->state, equation->text, equation->row,
                        equation->column, reason);
}

/* Whether the known part is c + Σ c_i·(param_i - its fixed number) in the field: the steps give the c_i, the
 * random probe the proof. */
static bool is_linear(const struct poser *poser, const struct probed *probed)
{
    const struct value *known = probed->known;
    uint64_t sum = known[PROBE_CONSTANT].residue;
    bool exact = known[PROBE_RANDOM].exact && known[PROBE_CONSTANT].exact;
    for (size_t i = 0; i < poser->free_count; i++) {
        uint64_t slope = field_subtract(known[PROBE_STEP + i].residue, known[PROBE_CONSTANT].residue);
        exact = exact && known[PROBE_STEP + i].exact;
        uint64_t number = field_from_integer(fixed_number(poser, i));
        uint64_t distance = field_subtract(poser->setting.parameters[poser->free[i]].residue, number);
        sum = field_add(sum, field_multiply(slope, distance));
    }
    return exact && sum == known[PROBE_RANDOM].residue;
}

/* Fixes the params that the equation visibly depends on; when none is, all of them. */
static void pin(struct poser *poser, const struct probed *probed)
{
    bool any = false;
    for (size_t i = 0; i < poser->free_count; i++) {
        struct value now = probed->known[PROBE_STEP + i], before = probed->known[PROBE_CONSTANT];
        bool depends = now.exact && before.exact && now.residue != before.residue;
        any = any || depends;
        if (depends && !probed->varies)
            poser->equations->pinned[poser->free[i]] = true;
    }
    for (size_t i = 0; i < poser->free_count && (!any || probed->varies); i++)
        poser->equations->pinned[poser->free[i]] = true;
}

static bool is_rational(struct value value)
{
    struct rational fraction;
    return value.exact && rational_reconstruct(value.residue, value.real, &fraction);
}

/* The first entry that takes part in the equation and is no fraction, or NULL when their sum is the first. */
static const struct value *irrational_entry(const struct probed *probed)
{
    for (size_t s = 0; s < 2 && probed->sides[s].right; s++) {
        const struct value_matrix *left = probed->sides[s].left, *right = probed->sides[s].right;
        for (size_t k = 0; k < right->rows; k++) {
            const struct value *a = left ? &left->values[probed->equation.row * left->columns + k] : NULL;
            const struct value *b = &right->values[k * right->columns + probed->equation.column];
            if (a && !is_rational(*a))
                return a;
            if (!is_rational(*b))
                return b;
        }
    }
    return NULL;
}

static bcifs_status refuse_irrational(const struct poser *poser, const struct probed *probed)
{
    const struct value *entry = irrational_entry(probed);
    struct text text = {0};
    if (entry) {
        text_append(&text, "the known entry ");
        text_append_number(&text, entry->real);
        text_append(&text, entry->exact
                               ? " is a fraction too large for 64-bit arithmetic"
                               : " is known as a rounded number only (a root, a function, or a decimal of "
                                 "15 digits or more), so that nothing can be solved exactly");
    } else {
        text_append(&text, "its known part is a fraction too large for 64-bit arithmetic");
    }
    bcifs_status status = text.failed ? out_of_memory(poser->equations) : refuse(poser, probed, text.data);
    text_free(&text);
    return status;
}

/* One term more, unless its factor is 0. */
static bool row_append(struct linear_term *terms, size_t *count, size_t column, struct value value)
{
    struct rational factor;
    if (!value.exact || !rational_reconstruct(value.residue, value.real, &factor))
        return false;
    if (!rational_is_zero(factor))
        terms[(*count)++] = (struct linear_term){column, factor};
    return true;
}

static bool row_known(struct poser *poser, const struct probed *probed, struct linear_term *terms,
                      size_t *count)
{
    const bcifs_automaton *automaton = poser->equations->automaton;
    struct value rest = probed->known[PROBE_CONSTANT];
    for (size_t i = 0; i < poser->free_count; i++) {
        size_t parameter = poser->free[i];
        struct value slope = value_subtract(probed->known[PROBE_STEP + i], probed->known[PROBE_CONSTANT]);
        size_t before = *count;
        if (!row_append(terms, count, automaton->unknowns + parameter, slope))
            return false;
        rest = value_subtract(rest, value_multiply(slope, value_from_integer(fixed_number(poser, i))));
        poser->equations->used[parameter] |= probed->count > 0 && *count > before;
    }
    return row_append(terms, count, automaton->unknowns + automaton->parameter_count, rest);
}

static int compare_terms(const struct linear_term *a, const struct linear_term *b)
{
    return (a->column > b->column) - (a->column < b->column);
}

/* Few terms, mostly sorted already. */
static void sort_terms(struct linear_term *terms, size_t count)
{
    for (size_t i = 1; i < count; i++)
        for (size_t j = i; j > 0 && compare_terms(&terms[j - 1], &terms[j]) > 0; j--) {
            struct linear_term keep = terms[j];
            terms[j] = terms[j - 1];
            terms[j - 1] = keep;
        }
}

/* The equation's row. */
static bcifs_status equation_finish(struct poser *poser, struct probed *probed)
{
    struct equations *equations = poser->equations;
    struct linear_term *terms =
        arena_new(equations->arena, probed->count + poser->free_count + 1, sizeof *terms);
    size_t count = 0;
    if (!terms)
        return out_of_memory(equations);
    for (size_t i = 0; i < probed->count; i++)
        if (!row_append(terms, &count, probed->terms[i].unknown, probed->terms[i].factor))
            return refuse_irrational(poser, probed);
    sort_terms(terms, count);
    if (!row_known(poser, probed, terms, &count))
        return refuse_irrational(poser, probed);
    probed->equation.terms = terms;
    probed->equation.count = count;
    if (!ARENA_RESERVE(equations->arena, equations->equations, equations->count, equations->capacity))
        return out_of_memory(equations);
    equations->equations[equations->count++] = probed->equation;
    return BCIFS_OK;
}

/* Whether a known equation holds: in the random probe, or in doubles. */
static bool known_holds(const struct probed *probed)
{
    const struct value *known = &probed->known[PROBE_RANDOM];
    return known->exact ? known->residue == 0 : fabs(known->real) <= TOLERANCE_EQUATION * probed->scale;
}

static bool arguments_matter(const struct poser *poser, const struct probed *probed)
{
    if (poser->definition->argument_count == 0)
        return false;
    const struct value *last = &probed->known[poser->probes - 1], *base = &probed->known[PROBE_CONSTANT];
    return !last->exact || !base->exact || last->residue != base->residue || probed->varies;
}

/* `again` is set when a param was pinned, so that all rows must be made anew. */
static bcifs_status equation_decide(struct poser *poser, struct probed *probed, bool *again)
{
    bool linear = is_linear(poser, probed);
    if (!probed->equation.reason && probed->count == 0) {
        if (known_holds(probed))
            return BCIFS_OK;
        if (!linear || arguments_matter(poser, probed))
            probed->equation.reason = "its entries are all known, and it does not hold";
    }
    if (probed->equation.reason) {
        if (!ARENA_RESERVE(poser->equations->arena, poser->equations->equations, poser->equations->count,
                           poser->equations->capacity))
            return out_of_memory(poser->equations);
        poser->equations->equations[poser->equations->count++] = probed->equation;
        return BCIFS_OK;
    }
    if (arguments_matter(poser, probed))
        return refuse(poser, probed,
                      "its known part depends on the state's arguments, so that no constants "
                      "satisfy it for all of them; write these entries as expressions");
    if (linear && !probed->varies)
        return BCIFS_OK;
    if (poser->free_count == 0)
        return refuse_irrational(poser, probed);
    pin(poser, probed);
    *again = true;
    return BCIFS_OK;
}

static bcifs_status state_finish(struct poser *poser, bool *again)
{
    bcifs_status status =
        probe_parameters(poser, PROBE_RANDOM, poser->attempt); /* is_linear() looks at them */
    for (size_t i = 0; i < poser->count && status == BCIFS_OK; i++)
        status = equation_decide(poser, &poser->list[i], again);
    for (size_t i = 0; i < poser->count && status == BCIFS_OK && !*again; i++) {
        struct probed *probed = &poser->list[i];
        if (!probed->equation.reason && (probed->count > 0 || !known_holds(probed)))
            status = equation_finish(poser, probed);
    }
    poser->equations->posed += poser->count;
    return status;
}

/* ---- All states ---------------------------------------------------------------------------------------- */

static bool has_unknowns(const struct equations *equations, const struct syntax_cell *cell)
{
    for (size_t i = 0; i < equations->automaton->unknowns; i++)
        if (equations->unknowns[i].cell == cell)
            return true;
    return false;
}

static bcifs_status state_pose(struct equations *equations, const struct definition *definition,
                               const size_t *free, size_t free_count, bool *again)
{
    struct arena arena = {0};
    struct poser poser = {.equations = equations,
                          .definition = definition,
                          .free = free,
                          .free_count = free_count,
                          .probes = PROBE_STEP + free_count + (definition->argument_count > 0),
                          .arena = &arena};
    bcifs_status status;
    if (!definition_is_structural(definition))
        status = probes_run(&poser);
    else if (!has_unknowns(equations, definition->syntax))
        return BCIFS_OK; /* the equations of the finished automaton are proved in any case */
    else
        status = report_error(
            equations->report, definition->module->source, definition->syntax->place,
            "the size of '%s' depends on its arguments: its entries '?' are not the same for all",
            definition->name);
    if (status == BCIFS_OK && !definition_is_structural(definition))
        status = state_finish(&poser, again);
    if (status == BCIFS_MEMORY && equations->report->errors == 0)
        report_memory(equations->report);
    arena_free(&arena);
    return status;
}

/* All states, with the params that are not pinned free. */
static bcifs_status states_pose(struct equations *equations, bool *again)
{
    const bcifs_automaton *automaton = equations->automaton;
    size_t *free = arena_new(equations->arena, automaton->parameter_count, sizeof *free), free_count = 0;
    if (!free)
        return out_of_memory(equations);
    for (size_t i = 0; i < automaton->parameter_count; i++)
        if (!equations->pinned[i] && !automaton->parameters[i].structural)
            free[free_count++] = i;
    bcifs_status status = BCIFS_OK;
    equations->count = equations->posed = equations->terms = 0;
    *again = false;
    for (size_t i = 0; i < automaton->definition_count && status == BCIFS_OK; i++)
        if (automaton->definitions[i]->form != DEFINITION_PRODUCT)
            status = state_pose(equations, automaton->definitions[i], free, free_count, again);
    return status;
}

bcifs_status equations_pose(const bcifs_automaton *automaton, struct arena *arena, struct report *report,
                            struct equations *equations)
{
    *equations = (struct equations){.arena = arena, .automaton = automaton, .report = report};
    equations->pinned = arena_new(arena, automaton->parameter_count, sizeof *equations->pinned);
    equations->used = arena_new(arena, automaton->parameter_count, sizeof *equations->used);
    if (!equations->pinned || !equations->used)
        return out_of_memory(equations);
    for (size_t i = 0; i < automaton->parameter_count; i++)
        equations->pinned[i] = automaton->parameters[i].is_set;
    bcifs_status status = unknowns_list(equations);
    bool again = true; /* every time around at least one more param is pinned */
    while (status == BCIFS_OK && again)
        status = states_pose(equations, &again);
    for (size_t i = 0; i < automaton->parameter_count && status == BCIFS_OK; i++) {
        const struct parameter *parameter = &automaton->parameters[i];
        bool pinned_here = equations->pinned[i] && !parameter->is_set;
        if (parameter->module != automaton->modules[0] && (equations->used[i] || pinned_here))
            status = report_failure(report, BCIFS_INPUT, automaton->modules[0]->source->name,
                                    "the entries '?' depend on the param '%s', which another file owns",
                                    parameter->name);
    }
    return status;
}
