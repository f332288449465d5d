#include "cell.h"

#include <string.h>

/* One elaboration under way. */
struct elaboration {
    const struct setting *setting;
    struct arena *arena;
    struct state_key key;
    const struct syntax_cell *syntax;
    struct environment environment;
    size_t entries; /* of all matrices so far */
    struct cell *cell;
};

static const struct source *source_of(const struct elaboration *elaboration)
{
    return elaboration->key.definition->module->source;
}

/* Reports unless silent; always BCIFS_INPUT. */
#define REFUSE(elaboration, place, ...)                                                                      \
    ((elaboration)->setting->report                                                                          \
         ? report_error((elaboration)->setting->report, source_of(elaboration), (place), __VA_ARGS__)       \
         : BCIFS_INPUT)

static bcifs_status out_of_memory(const struct setting *setting)
{
    return setting->report ? report_memory(setting->report) : BCIFS_MEMORY;
}

static void environment_enter(struct environment *environment, const struct setting *setting,
                              const struct module *module, const struct value *arguments)
{
    *environment = (struct environment){.parameters = setting->parameters,
                                        .known = setting->automaton->parameter_count,
                                        .arguments = arguments,
                                        .steps = EVALUATION_MOST_STEPS,
                                        .source = module->source,
                                        .report = setting->report,
                                        .proving = setting->proving};
}

/* ---- States and sizes ---------------------------------------------------------------------------------- */

bool state_key_equal(struct state_key a, struct state_key b)
{
    if (a.definition != b.definition)
        return false;
    for (size_t i = 0; i < a.definition->argument_count; i++)
        if (!value_equal(a.arguments[i], b.arguments[i]))
            return false;
    return true;
}

bcifs_status reference_evaluate(const struct setting *setting, struct arena *arena,
                                const struct reference *reference, const struct module *module,
                                const struct value *arguments, struct state_key *key)
{
    size_t count = reference->definition->argument_count;
    struct value *values = arena_new(arena, count, sizeof *values);
    if (!values)
        return out_of_memory(setting);
    struct environment environment;
    environment_enter(&environment, setting, module, arguments);
    for (size_t i = 0; i < count; i++) {
        bcifs_status status = expression_evaluate(reference->arguments[i], &environment, &values[i]);
        if (status)
            return status;
    }
    *key = (struct state_key){reference->definition, values};
    return BCIFS_OK;
}

/* m_a = ceil((length - 1) / (N - 1)) control points for a mask, design section 4. */
static bcifs_status mask_points(const struct elaboration *elaboration, const struct syntax_part *mask,
                                size_t *points)
{
    if (mask->number < 2 || mask->number > CELL_MOST_CHILDREN)
        return REFUSE(elaboration, mask->number_place, "a mask subdivides into 2 to %d children",
                      CELL_MOST_CHILDREN);
    if (mask->matrix->rows != 1)
        return REFUSE(elaboration, mask->matrix->place, "a mask is one row, found %zu", mask->matrix->rows);
    size_t length = mask->matrix->columns, n = (size_t)mask->number;
    *points = (length - 1 + n - 2) / (n - 1);
    if (*points < 2)
        return REFUSE(elaboration, mask->matrix->place,
                      "a mask for %zu children needs at least %zu coefficients, found %zu", n, n + 1, length);
    return BCIFS_OK;
}

static bcifs_status refine_joint_points(const struct elaboration *elaboration, const struct syntax_part *refine,
                                        size_t points, size_t columns, size_t *joint_points)
{
    size_t n = (size_t)refine->number;
    if (refine->number < 2 || refine->number > CELL_MOST_CHILDREN)
        return REFUSE(elaboration, refine->number_place, "refine makes 2 to %d children", CELL_MOST_CHILDREN);
    size_t most = n * points;
    /* columns = N (m_a - m_s) + m_s, [IM] 4.1 */
    if (columns >= most || (most - columns) % (n - 1) != 0 || (most - columns) / (n - 1) >= points)
        return REFUSE(elaboration, refine->place,
                      "a refinement matrix of %zu rows for %zu children has N*(m - s) + s columns "
                      "for a joint of s points, 1 <= s < m; found %zu columns",
                      points, n, columns);
    *joint_points = (most - columns) / (n - 1);
    return BCIFS_OK;
}

/* The number of control points that the cell itself tells: its count, its affine dimension, its mask, or the rows
 * of its first matrix. */
static bcifs_status own_points(struct elaboration *elaboration, size_t *points)
{
    const struct syntax_cell *cell = elaboration->syntax;
    const struct syntax_part *mask = syntax_part_of_kind(cell, PART_MASK, 0), *refine = syntax_part_of_kind(cell, PART_REFINE, 0);
    const struct syntax_part *sub = syntax_part_of_kind(cell, PART_SUB, 0);
    size_t from_mask = 0;
    if (mask) {
        bcifs_status status = mask_points(elaboration, mask, &from_mask);
        if (status)
            return status;
    }
    if (cell->points) {
        int64_t count;
        bcifs_status status = expression_integer(cell->points, &elaboration->environment,
                                                 "number of control points", 1, CELL_MOST_POINTS, &count);
        if (status)
            return status;
        *points = (size_t)count;
        if (mask && *points != from_mask)
            return REFUSE(elaboration, cell->points->place, "the mask is for %zu control points, found %zu",
                          from_mask, *points);
    } else if (cell->affine) {
        *points = (size_t)cell->dimension + 1;
    } else if (mask) {
        *points = from_mask;
    } else if (refine && refine->matrix) {
        *points = refine->matrix->rows;
    } else if (sub && sub->matrix) {
        *points = sub->matrix->rows;
    } else {
        return REFUSE(elaboration, cell->place, "'%s' needs its number of control points: '%s 3', say",
                      cell->name, cell->name);
    }
    if (*points > CELL_MOST_POINTS)
        return REFUSE(elaboration, cell->place, "'%s' has %zu control points; the limit is %d", cell->name, *points,
                      CELL_MOST_POINTS);
    return BCIFS_OK;
}

static void elaboration_begin(struct elaboration *elaboration, const struct setting *setting,
                              struct arena *arena, struct state_key key)
{
    *elaboration = (struct elaboration){
        .setting = setting, .arena = arena, .key = key, .syntax = key.definition->syntax};
    environment_enter(&elaboration->environment, setting, key.definition->module, key.arguments);
}

/* The keys of a product's two factors: their own written arguments, or their share of the product's. */
static bcifs_status factor_keys(const struct setting *setting, struct arena *arena, struct state_key key,
                                struct state_key factors[2])
{
    const struct definition *product = key.definition;
    size_t next = 0;
    for (int i = 0; i < 2; i++) {
        if (product->factor_references[i]) {
            bcifs_status status = reference_evaluate(setting, arena, product->factor_references[i],
                                                     product->module, key.arguments, &factors[i]);
            if (status)
                return status;
        } else {
            factors[i] = (struct state_key){product->factors[i], key.arguments ? key.arguments + next : NULL};
            next += product->factors[i]->argument_count;
        }
    }
    return BCIFS_OK;
}

static bcifs_status refine_columns(struct elaboration *elaboration, const struct syntax_part *refine,
                                   size_t *columns);

/* m_s for the joint that an edge's refine or mask implies. */
static bcifs_status joint_points(struct elaboration *elaboration, size_t *points)
{
    size_t edge_points, columns;
    bcifs_status status = own_points(elaboration, &edge_points);
    if (status)
        return status;
    const struct syntax_part *refine = syntax_part_of_kind(elaboration->syntax, PART_REFINE, 0);
    if (!refine) {
        *points = edge_points - 1;
        return BCIFS_OK;
    }
    status = refine_columns(elaboration, refine, &columns);
    return status ? status : refine_joint_points(elaboration, refine, edge_points, columns, points);
}

bcifs_status cell_points(const struct setting *setting, struct arena *arena, struct state_key key, size_t *points)
{
    struct elaboration elaboration;
    struct state_key factors[2];
    size_t counts[2];
    bcifs_status status;
    elaboration_begin(&elaboration, setting, arena, key);
    switch (key.definition->form) {
    case DEFINITION_WRITTEN:
        return own_points(&elaboration, points);
    case DEFINITION_JOINT:
        return joint_points(&elaboration, points);
    case DEFINITION_PRODUCT:
        break;
    }
    status = factor_keys(setting, arena, key, factors);
    if (status == BCIFS_OK)
        status = cell_points(setting, arena, factors[0], &counts[0]);
    if (status == BCIFS_OK)
        status = cell_points(setting, arena, factors[1], &counts[1]);
    if (status)
        return status;
    *points = counts[0] * counts[1];
    if (*points > CELL_MOST_POINTS && setting->report)
        return report_failure(setting->report, BCIFS_INPUT, key.definition->module->source->name,
                              "'%s' has %zu control points; the limit is %d", key.definition->name, *points,
                              CELL_MOST_POINTS);
    return *points > CELL_MOST_POINTS ? BCIFS_INPUT : BCIFS_OK;
}

/* ---- Matrices ------------------------------------------------------------------------------------------ */

static bcifs_status matrix_make(struct elaboration *elaboration, source_place place, size_t rows, size_t columns,
                                struct value_matrix **matrix)
{
    if (rows * columns > CELL_MOST_ENTRIES - elaboration->entries)
        return REFUSE(elaboration, place, "the matrices of '%s' have more than %d entries",
                      elaboration->syntax->name, CELL_MOST_ENTRIES);
    elaboration->entries += rows * columns;
    *matrix = value_matrix_new(elaboration->arena, rows, columns);
    return *matrix ? BCIFS_OK : out_of_memory(elaboration->setting);
}

/* Adds factor · unknown to what is unknown in an entry of the matrix. */
static bcifs_status unknown_add(struct elaboration *elaboration, struct value_matrix *matrix, size_t entry,
                                size_t unknown, int factor)
{
    if (!matrix->unknowns)
        matrix->unknowns =
            arena_new(elaboration->arena, matrix->rows * matrix->columns, sizeof *matrix->unknowns);
    struct unknown_term *term = arena_new(elaboration->arena, 1, sizeof *term);
    if (!term || !matrix->unknowns)
        return out_of_memory(elaboration->setting);
    *term = (struct unknown_term){unknown, factor, matrix->unknowns[entry]};
    matrix->unknowns[entry] = term;
    return BCIFS_OK;
}

/* Entry `to` of one matrix has the unknowns of entry `from` of another added, times `factor`. */
static bcifs_status unknowns_add(struct elaboration *elaboration, struct value_matrix *matrix, size_t to,
                                 const struct value_matrix *other, size_t from, int factor)
{
    bcifs_status status = BCIFS_OK;
    if (other->unknowns)
        for (const struct unknown_term *term = other->unknowns[from]; term && status == BCIFS_OK; term = term->next)
            status = unknown_add(elaboration, matrix, to, term->unknown, factor * term->factor);
    return status;
}

/* Evaluates the entries as written. An unknown `?` counts, is noted, and has the value 0. */
static bcifs_status matrix_evaluate(struct elaboration *elaboration, const struct syntax_matrix *syntax,
                                    struct value_matrix **matrix)
{
    bcifs_status status = matrix_make(elaboration, syntax->place, syntax->rows, syntax->columns, matrix);
    for (size_t i = 0; status == BCIFS_OK && i < syntax->rows * syntax->columns; i++) {
        if (syntax->entries[i]->kind == EXPRESSION_UNKNOWN) {
            elaboration->cell->unknowns++;
            status = unknown_add(elaboration, *matrix, i, syntax->entries[i]->index, 1);
        } else {
            status = expression_evaluate(syntax->entries[i], &elaboration->environment, &(*matrix)->values[i]);
        }
    }
    if (status == BCIFS_OK)
        value_matrix_finish(*matrix);
    return status;
}

/* Runs rules. `visit` is given every index of q and the value assigned to it. */
typedef bcifs_status rule_visitor(struct elaboration *elaboration, void *context, const struct syntax_rule *rule,
                                  size_t index);

static bcifs_status rules_run(struct elaboration *elaboration, const struct syntax_rules *rules,
                              rule_visitor *visit, void *context)
{
    struct environment *environment = &elaboration->environment;
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < rules->count && status == BCIFS_OK; i++) {
        const struct syntax_rule *rule = rules->rules[i];
        int64_t low, high;
        if (!rule->is_loop) {
            status = expression_integer(rule->index, environment, "index of q", 0, CELL_MOST_ENTRIES, &low);
            status = status ? status : visit(elaboration, context, rule, (size_t)low);
            continue;
        }
        status = expression_integer(rule->from, environment, "start of the range", -1000000, 1000000, &low);
        if (status == BCIFS_OK)
            status = expression_integer(rule->to, environment, "end of the range", -1000000, 1000000, &high);
        size_t local = environment->local_count++;
        for (int64_t k = low; status == BCIFS_OK && k <= high; k++) {
            environment->locals[local] = value_from_integer(k);
            if (environment->steps-- == 0)
                return REFUSE(elaboration, rule->place, "these rules take more than %d steps",
                              EVALUATION_MOST_STEPS);
            status = rules_run(elaboration, rule->body, visit, context);
        }
        environment->local_count = local;
    }
    return status;
}

static bcifs_status visit_count(struct elaboration *elaboration, void *context, const struct syntax_rule *rule,
                                size_t index)
{
    size_t *count = context;
    (void)elaboration, (void)rule;
    if (index >= *count)
        *count = index + 1;
    return BCIFS_OK;
}

static bcifs_status refine_columns(struct elaboration *elaboration, const struct syntax_part *refine,
                                   size_t *columns)
{
    *columns = 0;
    if (!refine->matrix)
        return rules_run(elaboration, refine->rules, visit_count, columns);
    *columns = refine->matrix->columns;
    return BCIFS_OK;
}

struct rules_matrix {
    struct value_matrix *matrix;
    struct value *column; /* rows × 1 workspace */
    bool *assigned;       /* per column */
};

/* q[index] = Σ_k column[k] p[k] is column `index` of the map. */
static bcifs_status visit_assign(struct elaboration *elaboration, void *context, const struct syntax_rule *rule,
                                 size_t index)
{
    struct rules_matrix *target = context;
    size_t rows = target->matrix->rows, columns = target->matrix->columns;
    if (index >= columns)
        return REFUSE(elaboration, rule->place, "q[%zu] is beyond the child's %zu control points", index,
                      columns);
    if (target->assigned[index])
        return REFUSE(elaboration, rule->place, "q[%zu] is given twice", index);
    target->assigned[index] = true;
    for (size_t i = 0; i < rows; i++)
        target->column[i] = value_from_integer(0);
    bcifs_status status = expression_linear(rule->value, &elaboration->environment, value_from_integer(1),
                                            target->column, rows);
    for (size_t i = 0; i < rows; i++)
        target->matrix->values[i * columns + index] = target->column[i];
    return status;
}

static bcifs_status rules_evaluate(struct elaboration *elaboration, const struct syntax_rules *rules, size_t rows,
                                   size_t columns, struct value_matrix **matrix)
{
    bcifs_status status = matrix_make(elaboration, rules->place, rows, columns, matrix);
    if (status)
        return status;
    struct rules_matrix target = {*matrix, arena_new(elaboration->arena, rows, sizeof(struct value)),
                                  arena_new(elaboration->arena, columns, sizeof(bool))};
    if (!target.column || !target.assigned)
        return out_of_memory(elaboration->setting);
    status = rules_run(elaboration, rules, visit_assign, &target);
    for (size_t i = 0; i < columns && status == BCIFS_OK; i++)
        if (!target.assigned[i])
            status = REFUSE(elaboration, rules->place, "q[%zu] is not given; the child has %zu control points", i,
                            columns);
    if (status == BCIFS_OK)
        value_matrix_finish(*matrix);
    return status;
}

/* [A b] of R^D -> R^D' becomes barycentric on the frames O, X, Y, …: the image of O is b, of the j-th axis point
 * A e_j + b; the coordinate of O makes up the sum to 1. */
static bcifs_status affine_expand(struct elaboration *elaboration, const struct value_matrix *affine,
                                  source_place place, struct value_matrix **matrix)
{
    size_t dimension = affine->rows, columns = affine->columns;
    bcifs_status status = matrix_make(elaboration, place, dimension + 1, columns, matrix);
    if (status)
        return status;
    struct value *values = (*matrix)->values;
    for (size_t j = 0; j < columns; j++) {
        struct value rest = value_from_integer(1);
        for (size_t i = 0; i < dimension && status == BCIFS_OK; i++) {
            size_t offset = i * columns + columns - 1, image = (i + 1) * columns + j;
            struct value entry = affine->values[offset];
            if (j > 0)
                entry = value_add(entry, affine->values[i * columns + j - 1]);
            values[image] = entry;
            rest = value_subtract(rest, entry);
            if (!affine->unknowns)
                continue;
            status = unknowns_add(elaboration, *matrix, image, affine, offset, 1);
            if (status == BCIFS_OK && j > 0)
                status = unknowns_add(elaboration, *matrix, image, affine, i * columns + j - 1, 1);
            if (status == BCIFS_OK)
                status = unknowns_add(elaboration, *matrix, j, *matrix, image, -1);
        }
        values[j] = rest;
    }
    value_matrix_finish(*matrix);
    return status;
}

/* ---- Children ------------------------------------------------------------------------------------------ */

static bcifs_status child_matrix(struct elaboration *elaboration, const struct syntax_part *part,
                                 struct state_key child, size_t child_points, struct value_matrix **matrix)
{
    size_t points = elaboration->cell->points;
    const struct syntax_cell *cell = elaboration->syntax;
    if (part->rules && cell->affine)
        return REFUSE(elaboration, part->rules->place, "an affine state writes its maps as matrices");
    if (part->rules)
        return rules_evaluate(elaboration, part->rules, points, child_points, matrix);
    size_t rows = points - (cell->affine ? 1 : 0);
    if (cell->affine && !(child.definition->syntax && child.definition->syntax->affine))
        return REFUSE(elaboration, part->place, "'%s' is affine, so its child '%s' must be", cell->name,
                      child.definition->name);
    if (part->matrix->rows != rows || part->matrix->columns != child_points)
        return REFUSE(elaboration, part->matrix->place,
                      "this map must be %zu × %zu ('%s' has %zu control points, its child '%s' %zu), found %zu × %zu",
                      rows, child_points, cell->name, points, child.definition->name, child_points,
                      part->matrix->rows, part->matrix->columns);
    struct value_matrix *written;
    bcifs_status status = matrix_evaluate(elaboration, part->matrix, &written);
    if (status == BCIFS_OK && cell->affine)
        return affine_expand(elaboration, written, part->matrix->place, matrix);
    *matrix = written;
    return status;
}

static bcifs_status child_add(struct elaboration *elaboration, const struct syntax_part *part)
{
    struct cell *cell = elaboration->cell;
    struct state_key child;
    size_t points;
    struct value_matrix *matrix;
    bcifs_status status =
        reference_evaluate(elaboration->setting, elaboration->arena, part->reference->target,
                           elaboration->key.definition->module, elaboration->key.arguments, &child);
    if (status == BCIFS_OK)
        status = cell_points(elaboration->setting, elaboration->arena, child, &points);
    if (status == BCIFS_OK)
        status = child_matrix(elaboration, part, child, points, &matrix);
    if (status == BCIFS_OK)
        cell->children[cell->child_count++] =
            (struct cell_child){child, matrix, source_of(elaboration), part->place};
    return status;
}

static bcifs_status children_add(struct elaboration *elaboration)
{
    const struct syntax_cell *syntax = elaboration->syntax;
    struct cell *cell = elaboration->cell;
    size_t count = 0;
    for (size_t i = 0; i < syntax->part_count; i++)
        count += syntax->parts[i]->kind == PART_SUB;
    if (count > CELL_MOST_CHILDREN)
        return REFUSE(elaboration, syntax->place, "'%s' has %zu maps; the limit is %d", syntax->name, count,
                      CELL_MOST_CHILDREN);
    cell->children = arena_new(elaboration->arena, count, sizeof *cell->children);
    if (!cell->children)
        return out_of_memory(elaboration->setting);
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < syntax->part_count; i++)
        if (syntax->parts[i]->kind == PART_SUB) {
            bcifs_status one = child_add(elaboration, syntax->parts[i]);
            status = status ? status : one;
        }
    return status;
}

/* A vertex without a map keeps its one point. */
static bcifs_status vertex_default(struct elaboration *elaboration)
{
    struct cell *cell = elaboration->cell;
    if (cell->points != 1)
        return REFUSE(elaboration, elaboration->syntax->place,
                      "vertex '%s' has %zu control points and no map; give it one with sub",
                      elaboration->syntax->name, cell->points);
    struct value_matrix *identity;
    bcifs_status status = matrix_make(elaboration, elaboration->syntax->place, 1, 1, &identity);
    cell->children = arena_new(elaboration->arena, 1, sizeof *cell->children);
    if (status || !cell->children)
        return status ? status : out_of_memory(elaboration->setting);
    identity->values[0] = value_from_integer(1);
    cell->children[cell->child_count++] = (struct cell_child){
        elaboration->key, identity, source_of(elaboration), elaboration->syntax->place};
    return BCIFS_OK;
}

/* T_÷ as a matrix: written, by rules, or from the mask by T_i[j][j'] = c[i + N(m_a-1-j) - (m_a-1-j')], so that
 * column k = iΔ + j', Δ = 1, of T_÷ has entry c[k + N(m_a-1-j) - (m_a-1)] in row j. */
static bcifs_status refinement_evaluate(struct elaboration *elaboration, const struct syntax_part *part,
                                        size_t points, struct value_matrix **matrix)
{
    size_t columns, n = (size_t)part->number;
    if (part->kind == PART_REFINE) {
        bcifs_status status = refine_columns(elaboration, part, &columns);
        if (status)
            return status;
        if (!part->matrix)
            return rules_evaluate(elaboration, part->rules, points, columns, matrix);
        if (part->matrix->rows != points)
            return REFUSE(elaboration, part->matrix->place,
                          "the refinement matrix must have %zu rows, one for each control point, found %zu", points,
                          part->matrix->rows);
        return matrix_evaluate(elaboration, part->matrix, matrix);
    }
    struct value_matrix *mask;
    bcifs_status status = matrix_evaluate(elaboration, part->matrix, &mask);
    columns = n + points - 1;
    if (status == BCIFS_OK)
        status = matrix_make(elaboration, part->matrix->place, points, columns, matrix);
    if (status)
        return status;
    for (size_t j = 0; j < points; j++)
        for (size_t k = 0; k < columns; k++) {
            size_t index = k + n * (points - 1 - j);
            if (index < points - 1 || index - (points - 1) >= mask->columns)
                continue;
            (*matrix)->values[j * columns + k] = mask->values[index - (points - 1)];
            status = status ? status
                            : unknowns_add(elaboration, *matrix, j * columns + k, mask, index - (points - 1), 1);
        }
    value_matrix_finish(*matrix);
    return status;
}

/* Columns first … first + count - 1, of rows 0 … rows - 1. */
static bcifs_status matrix_part(struct elaboration *elaboration, const struct value_matrix *whole,
                                source_place place, size_t rows, size_t first, size_t count,
                                struct value_matrix **part)
{
    bcifs_status status = matrix_make(elaboration, place, rows, count, part);
    if (status)
        return status;
    for (size_t i = 0; i < rows; i++)
        for (size_t j = 0; j < count && status == BCIFS_OK; j++) {
            size_t from = i * whole->columns + first + j;
            (*part)->values[i * count + j] = whole->values[from];
            status = unknowns_add(elaboration, *part, i * count + j, whole, from, 1);
        }
    value_matrix_finish(*part);
    return status;
}

/* The children of an edge given by T_÷: T_i are its columns iΔ … iΔ + m_a - 1, [IM] corollary 4.1. */
static bcifs_status refinement_children(struct elaboration *elaboration, const struct syntax_part *part,
                                        size_t *joint)
{
    struct cell *cell = elaboration->cell;
    struct value_matrix *whole;
    bcifs_status status = joint_points(elaboration, joint);
    if (status == BCIFS_OK)
        status = refinement_evaluate(elaboration, part, cell->points, &whole);
    if (status)
        return status;
    size_t n = (size_t)part->number, step = cell->points - *joint;
    cell->children = arena_new(elaboration->arena, n, sizeof *cell->children);
    if (!cell->children)
        return out_of_memory(elaboration->setting);
    for (size_t i = 0; i < n && status == BCIFS_OK; i++) {
        struct value_matrix *map;
        status = matrix_part(elaboration, whole, part->place, cell->points, i * step, cell->points, &map);
        if (status == BCIFS_OK)
            cell->children[cell->child_count++] =
                (struct cell_child){elaboration->key, map, source_of(elaboration), part->place};
    }
    return status;
}

/* The joint of an edge given by T_÷: T^s is its corner m_s × m_s, [IM] (9). */
static bcifs_status joint_elaborate(struct elaboration *elaboration)
{
    struct cell *cell = elaboration->cell;
    const struct syntax_part *part = syntax_part_of_kind(elaboration->syntax, PART_REFINE, 0);
    size_t edge_points;
    struct value_matrix *whole, *map;
    if (!part)
        part = syntax_part_of_kind(elaboration->syntax, PART_MASK, 0);
    bcifs_status status = own_points(elaboration, &edge_points);
    if (status == BCIFS_OK)
        status = joint_points(elaboration, &cell->points);
    if (status == BCIFS_OK)
        status = refinement_evaluate(elaboration, part, edge_points, &whole);
    if (status == BCIFS_OK)
        status = matrix_part(elaboration, whole, part->place, cell->points, 0, cell->points, &map);
    if (status)
        return status;
    cell->unknowns = 0; /* they are counted with the edge */
    cell->children = arena_new(elaboration->arena, 1, sizeof *cell->children);
    if (!cell->children)
        return out_of_memory(elaboration->setting);
    cell->children[cell->child_count++] =
        (struct cell_child){elaboration->key, map, source_of(elaboration), part->place};
    return BCIFS_OK;
}

/* ---- Boundaries ---------------------------------------------------------------------------------------- */

/* The operator that selects control points: Π e_j = e_{indices[j]}, [IM] 2.2. */
static bcifs_status selection(struct elaboration *elaboration, source_place place, const size_t *indices,
                              size_t count, struct value_matrix **operator)
{
    bcifs_status status = matrix_make(elaboration, place, elaboration->cell->points, count, operator);
    for (size_t j = 0; j < count && status == BCIFS_OK; j++)
        (*operator)->values[indices[j] * count + j] = value_from_integer(1);
    return status;
}

static bcifs_status indices_evaluate(struct elaboration *elaboration, const struct syntax_part *part,
                                     size_t wanted, const size_t **indices)
{
    const struct syntax_location *location = &part->location;
    if (location->count != wanted)
        return REFUSE(elaboration, location->place, "'%s' has %zu control point%s, found %zu ind%s",
                      part->reference->name, wanted, wanted == 1 ? "" : "s", location->count,
                      location->count == 1 ? "ex" : "ices");
    size_t *values = arena_new(elaboration->arena, wanted, sizeof *values);
    if (!values)
        return out_of_memory(elaboration->setting);
    for (size_t i = 0; i < wanted; i++) {
        int64_t index;
        bcifs_status status =
            expression_integer(location->indices[i], &elaboration->environment, "index of a control point", 0,
                               (int64_t)elaboration->cell->points - 1, &index);
        if (status)
            return status;
        values[i] = (size_t)index;
    }
    *indices = values;
    return BCIFS_OK;
}

static bcifs_status boundary_operator(struct elaboration *elaboration, const struct syntax_part *part,
                                      size_t points, struct cell_boundary *boundary)
{
    const struct syntax_matrix *matrix = part->location.matrix;
    struct value_matrix *operator;
    bcifs_status status;
    if (!matrix) {
        status = indices_evaluate(elaboration, part, points, &boundary->indices);
        if (status == BCIFS_OK)
            status = selection(elaboration, part->place, boundary->indices, points, &operator);
    } else if (matrix->rows != elaboration->cell->points || matrix->columns != points) {
        return REFUSE(elaboration, matrix->place, "the boundary '%s' must be %zu × %zu, found %zu × %zu", part->name,
                      elaboration->cell->points, points, matrix->rows, matrix->columns);
    } else {
        status = matrix_evaluate(elaboration, matrix, &operator);
    }
    if (status == BCIFS_OK)
        boundary->operator = operator;
    return status;
}

static bcifs_status boundary_add(struct elaboration *elaboration, const struct syntax_part *part)
{
    struct cell *cell = elaboration->cell;
    struct cell_boundary *boundary = &cell->boundaries[cell->boundary_count];
    size_t points;
    bcifs_status status =
        reference_evaluate(elaboration->setting, elaboration->arena, part->reference->target,
                           elaboration->key.definition->module, elaboration->key.arguments, &boundary->state);
    if (status == BCIFS_OK)
        status = cell_points(elaboration->setting, elaboration->arena, boundary->state, &points);
    if (status == BCIFS_OK)
        status = boundary_operator(elaboration, part, points, boundary);
    boundary->name = part->name;
    boundary->source = source_of(elaboration);
    boundary->place = part->place;
    if (status == BCIFS_OK)
        cell->boundary_count++;
    return status;
}

/* start at 0 … m_s-1, end at Δ … m_a-1, [IM] (5). */
static bcifs_status boundary_default(struct elaboration *elaboration, const struct syntax_part *part,
                                     size_t joint)
{
    struct cell *cell = elaboration->cell;
    for (int side = 0; side < 2; side++) {
        struct value_matrix *operator;
        size_t *indices = arena_new(elaboration->arena, joint, sizeof *indices);
        if (!indices)
            return out_of_memory(elaboration->setting);
        for (size_t j = 0; j < joint; j++)
            indices[j] = j + (side ? cell->points - joint : 0);
        bcifs_status status = selection(elaboration, part->place, indices, joint, &operator);
        if (status)
            return status;
        cell->boundaries[cell->boundary_count++] =
            (struct cell_boundary){.name = side ? "end" : "start",
                                   .state = {elaboration->key.definition->joint, elaboration->key.arguments},
                                   .operator = operator,
                                   .indices = indices,
                                   .source = source_of(elaboration),
                                   .place = part->place};
    }
    return BCIFS_OK;
}

/* In the order of the file, but an edge's start always before its end. */
static bcifs_status boundaries_add(struct elaboration *elaboration)
{
    const struct syntax_cell *syntax = elaboration->syntax;
    bcifs_status status = BCIFS_OK;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < syntax->part_count; i++) {
            enum part_kind kind = syntax->parts[i]->kind;
            bool now = pass == 0 ? kind == PART_START || kind == PART_BOUNDARY : kind == PART_END;
            if (!now)
                continue;
            if (elaboration->cell->boundary_count == CELL_MOST_BOUNDARIES)
                return REFUSE(elaboration, syntax->parts[i]->place, "more than %d boundaries",
                              CELL_MOST_BOUNDARIES);
            bcifs_status one = boundary_add(elaboration, syntax->parts[i]);
            status = status ? status : one;
        }
    return status;
}

static bcifs_status joins_add(struct elaboration *elaboration)
{
    const struct syntax_cell *syntax = elaboration->syntax;
    struct cell *cell = elaboration->cell;
    cell->joins = arena_new(elaboration->arena, syntax->part_count, sizeof *cell->joins);
    if (!cell->joins)
        return out_of_memory(elaboration->setting);
    for (size_t i = 0; i < syntax->part_count; i++) {
        const struct syntax_part *part = syntax->parts[i];
        if (part->kind != PART_JOIN)
            continue;
        struct cell_join *join = &cell->joins[cell->join_count++];
        *join = (struct cell_join){.reversed = part->reversed, .place = part->place};
        for (int side = 0; side < 2; side++) {
            if (part->child[side] >= cell->child_count)
                return REFUSE(elaboration, part->side[side], "there is no child %llu; '%s' has %zu",
                              (unsigned long long)part->child[side], syntax->name, cell->child_count);
            join->child[side] = (size_t)part->child[side];
            join->boundary[side] = part->boundary[side];
        }
    }
    return BCIFS_OK;
}

const struct cell_boundary *cell_boundary_named(const struct cell *cell, const char *name)
{
    for (size_t i = 0; i < cell->boundary_count; i++)
        if (strcmp(cell->boundaries[i].name, name) == 0)
            return &cell->boundaries[i];
    return NULL;
}

/* ---- The whole ----------------------------------------------------------------------------------------- */

static bcifs_status written_elaborate(struct elaboration *elaboration)
{
    const struct syntax_cell *syntax = elaboration->syntax;
    struct cell *cell = elaboration->cell;
    size_t joint = 0;
    bcifs_status status = own_points(elaboration, &cell->points);
    cell->affine = syntax->affine;
    cell->boundaries = arena_new(elaboration->arena, CELL_MOST_BOUNDARIES, sizeof *cell->boundaries);
    if (status || !cell->boundaries)
        return status ? status : out_of_memory(elaboration->setting);
    const struct syntax_part *refinement = syntax_part_of_kind(syntax, PART_REFINE, 0);
    if (!refinement)
        refinement = syntax_part_of_kind(syntax, PART_MASK, 0);
    if (refinement)
        status = refinement_children(elaboration, refinement, &joint);
    else if (cell->definition->kind == CELL_VERTEX && !syntax_part_of_kind(syntax, PART_SUB, 0))
        status = vertex_default(elaboration);
    else
        status = children_add(elaboration);
    bcifs_status boundaries = refinement && cell->definition->joint && status == BCIFS_OK
                                  ? boundary_default(elaboration, refinement, joint)
                                  : boundaries_add(elaboration);
    status = status ? status : boundaries;
    return status ? status : joins_add(elaboration);
}

bcifs_status cell_elaborate(const struct setting *setting, struct arena *arena, struct state_key key,
                            struct cell **cell)
{
    struct elaboration elaboration;
    elaboration_begin(&elaboration, setting, arena, key);
    *cell = elaboration.cell = arena_new(arena, 1, sizeof **cell);
    if (!*cell)
        return out_of_memory(setting);
    (*cell)->definition = key.definition;
    (*cell)->arguments = key.arguments;
    struct state_key factors[2];
    bcifs_status status = BCIFS_OK;
    switch (key.definition->form) {
    case DEFINITION_WRITTEN:
        return written_elaborate(&elaboration);
    case DEFINITION_JOINT:
        return joint_elaborate(&elaboration);
    case DEFINITION_PRODUCT:
        status = factor_keys(setting, arena, key, factors);
        break;
    }
    return status ? status : product_elaborate(setting, arena, factors, *cell);
}
