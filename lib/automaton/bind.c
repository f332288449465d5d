#include "bind.h"

#include <string.h>

#include "automaton/module.h"

static const char *const kind_names[] = {
    [CELL_VERTEX] = "vertex", [CELL_EDGE] = "edge", [CELL_FACE] = "face", [CELL_CELL] = "cell"};

static const char *const part_names[] = {
    [PART_SUB] = "sub",   [PART_START] = "start",   [PART_END] = "end",  [PART_BOUNDARY] = "boundary",
    [PART_JOIN] = "join", [PART_REFINE] = "refine", [PART_MASK] = "mask"};

/* ---- Definitions --------------------------------------------------------------------------------------- */

static struct definition *definition_add(bcifs_automaton *automaton, struct definition definition,
                                         struct report *report)
{
    if (automaton->definition_count >= AUTOMATON_MOST_DEFINITIONS) {
        if (!automaton->is_full) /* once is enough */
            report_failure(report, BCIFS_INPUT, automaton->modules[0]->source->name,
                           "more than %d states, counting products", AUTOMATON_MOST_DEFINITIONS);
        automaton->is_full = true;
        return NULL;
    }
    struct definition *fresh = arena_new(&automaton->arena, 1, sizeof *fresh);
    if (!fresh || !ARENA_RESERVE(&automaton->arena, automaton->definitions, automaton->definition_count,
                                 automaton->definition_capacity)) {
        report_memory(report);
        return NULL;
    }
    *fresh = definition;
    automaton->definitions[automaton->definition_count++] = fresh;
    return fresh;
}

/* The state that a module's file calls `name`, or NULL. */
static struct definition *definition_named(const bcifs_automaton *automaton, const struct module *module,
                                           const char *name)
{
    for (size_t i = 0; i < automaton->definition_count; i++) {
        struct definition *definition = automaton->definitions[i];
        if (definition->module == module && definition->syntax && definition->form != DEFINITION_JOINT &&
            strcmp(definition->syntax->name, name) == 0)
            return definition;
    }
    return NULL;
}

static bcifs_status cell_declare(bcifs_automaton *automaton, struct module *module,
                                 struct syntax_cell *syntax, struct report *report)
{
    if (definition_named(automaton, module, syntax->name))
        return report_error(report, module->source, syntax->place, "the state '%s' is defined twice",
                            syntax->name);
    if (module_named(automaton, module, syntax->name))
        return report_error(report, module->source, syntax->place,
                            "'%s' is already the name of a used file; rename it with 'as'", syntax->name);
    struct definition definition = {
        .form = syntax->factors[0] ? DEFINITION_PRODUCT : DEFINITION_WRITTEN,
        .kind = syntax->kind,
        .name = module_qualify(automaton, module, syntax->name),
        .module = module,
        .syntax = syntax,
        .argument_count = syntax->argument_count,
    };
    if (!definition.name)
        return report_memory(report);
    return definition_add(automaton, definition, report) ? BCIFS_OK : report->first.status;
}

static bcifs_status figure_declare(bcifs_automaton *automaton, struct module *module,
                                   struct syntax_figure *syntax, struct report *report)
{
    for (size_t i = 0; i < automaton->figure_count; i++)
        if (strcmp(automaton->figures[i].name, syntax->name) == 0)
            return report_error(report, module->source, syntax->place, "the figure '%s' is defined twice",
                                syntax->name);
    if (!ARENA_RESERVE(&automaton->arena, automaton->figures, automaton->figure_count,
                       automaton->figure_capacity))
        return report_memory(report);
    automaton->figures[automaton->figure_count++] =
        (struct figure_definition){.name = syntax->name, .module = module, .syntax = syntax};
    return BCIFS_OK;
}

static bcifs_status declare_all(bcifs_automaton *automaton, struct report *report)
{
    bcifs_status status = BCIFS_OK;
    for (size_t m = 0; m < automaton->module_count; m++) {
        struct module *module = automaton->modules[m];
        for (size_t i = 0; i < module->syntax->count; i++) {
            struct syntax_item *item = &module->syntax->items[i];
            bcifs_status one = BCIFS_OK;
            if (item->kind == ITEM_CELL)
                one = cell_declare(automaton, module, item->cell, report);
            else if (item->kind == ITEM_FIGURE && m == 0)
                one = figure_declare(automaton, module, item->figure, report);
            if (one == BCIFS_MEMORY)
                return one;
            status = status ? status : one;
        }
    }
    return status;
}

/* ---- References ---------------------------------------------------------------------------------------- */

/* Where names are looked up: the module, and the arguments of the state that is being resolved. */
struct place_of_names {
    bcifs_automaton *automaton;
    struct module *module;
    const char *const *arguments;
    size_t argument_count;
    struct report *report;
};

static bcifs_status names_resolve(const struct place_of_names *names, struct expression *expression,
                                  const char *const *locals, size_t local_count)
{
    return expression_resolve(expression, names->module->scope, names->arguments, names->argument_count,
                              locals, local_count, names->module->source, names->report);
}

static bcifs_status unknown_state(const struct place_of_names *names, const struct module *module,
                                  const struct syntax_reference *syntax)
{
    enum { MOST = 256 };
    const char *candidates[MOST];
    size_t count = 0;
    for (size_t i = 0; i < names->automaton->definition_count && count < MOST; i++) {
        const struct definition *definition = names->automaton->definitions[i];
        if (definition->module == module && definition->syntax)
            candidates[count++] = definition->syntax->name;
    }
    const char *nearest = nearest_word(syntax->name, candidates, count);
    if (nearest)
        return report_error(names->report, names->module->source, syntax->place,
                            "unknown state '%s'; did you mean '%s'?", syntax->name, nearest);
    return report_error(names->report, names->module->source, syntax->place, "unknown state '%s'",
                        syntax->name);
}

static bcifs_status reference_resolve(const struct place_of_names *names, struct syntax_reference *syntax,
                                      bool may_omit_arguments)
{
    const struct module *module = names->module;
    if (syntax->module && !(module = module_named(names->automaton, names->module, syntax->module)))
        return report_error(names->report, names->module->source, syntax->place,
                            "no used file is called '%s'", syntax->module);
    struct definition *definition = definition_named(names->automaton, module, syntax->name);
    if (!definition)
        return unknown_state(names, module, syntax);
    size_t wanted = definition->argument_count;
    if (syntax->count != wanted && (syntax->has_arguments || !may_omit_arguments))
        return report_error(names->report, names->module->source, syntax->place,
                            "'%s' takes %zu argument%s, found %zu", syntax->name, wanted,
                            wanted == 1 ? "" : "s", syntax->count);
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < syntax->count; i++) {
        bcifs_status one = names_resolve(names, syntax->arguments[i], NULL, 0);
        status = status ? status : one;
    }
    struct reference *reference = arena_new(&names->automaton->arena, 1, sizeof *reference);
    if (!reference)
        return report_memory(names->report);
    reference->definition = definition;
    reference->arguments = syntax->has_arguments ? syntax->arguments : NULL;
    reference->place = syntax->place;
    syntax->target = reference;
    return status;
}

static bcifs_status matrix_resolve(const struct place_of_names *names, const struct syntax_matrix *matrix)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; matrix && i < matrix->rows * matrix->columns; i++) {
        if (matrix->entries[i]->kind == EXPRESSION_UNKNOWN) {
            matrix->entries[i]->index = (uint32_t)names->automaton->unknowns++;
            continue;
        }
        bcifs_status one = names_resolve(names, matrix->entries[i], NULL, 0);
        if (one && report_is_full(names->report))
            return one;
        status = status ? status : one;
    }
    return status;
}

static bcifs_status rules_resolve(const struct place_of_names *names, const struct syntax_rules *rules,
                                  const char **locals, size_t local_count)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; rules && i < rules->count; i++) {
        struct syntax_rule *rule = rules->rules[i];
        struct expression *first = rule->is_loop ? rule->from : rule->index;
        struct expression *second = rule->is_loop ? rule->to : rule->value;
        bcifs_status a = names_resolve(names, first, locals, local_count);
        bcifs_status b = names_resolve(names, second, locals, local_count);
        bcifs_status c = BCIFS_OK;
        if (rule->is_loop && local_count + 1 >= EVALUATION_MOST_LOCALS)
            return report_error(names->report, names->module->source, rule->place,
                                "more than %d loops inside each other", EVALUATION_MOST_LOCALS);
        if (rule->is_loop) {
            locals[local_count] = rule->variable;
            c = rules_resolve(names, rule->body, locals, local_count + 1);
        }
        status = status ? status : a ? a : b ? b : c;
        if (status && report_is_full(names->report))
            return status;
    }
    return status;
}

/* Which state a child or boundary may be in. */
static bcifs_status check_kinds(const struct place_of_names *names, const struct definition *definition,
                                const struct syntax_part *part)
{
    if (!part->reference || !part->reference->target)
        return BCIFS_OK;
    enum cell_kind found = part->reference->target->definition->kind;
    bool fits;
    const char *wanted;
    if (part->kind == PART_SUB) {
        fits = found == definition->kind;
        wanted = kind_names[definition->kind];
    } else if (definition->kind == CELL_EDGE) {
        fits = found == CELL_VERTEX;
        wanted = "vertex";
    } else {
        fits = found == CELL_EDGE || found == CELL_VERTEX;
        wanted = "edge or vertex";
    }
    if (fits)
        return BCIFS_OK;
    return report_error(names->report, names->module->source, part->reference->place,
                        "'%s' is %s %s; the %s of %s '%s' must be %s %s", part->reference->name,
                        found == CELL_EDGE ? "an" : "a", kind_names[found],
                        part->kind == PART_SUB ? "children" : "boundaries",
                        definition->kind == CELL_EDGE ? "edge" : kind_names[definition->kind],
                        definition->syntax->name, wanted[0] == 'e' ? "an" : "a", wanted);
}

static bcifs_status part_resolve(const struct place_of_names *names, const struct definition *definition,
                                 struct syntax_part *part)
{
    bcifs_status status = BCIFS_OK, one;
    if (part->reference) {
        status = reference_resolve(names, part->reference, false);
        one = check_kinds(names, definition, part);
        status = status ? status : one;
    }
    one = matrix_resolve(names, part->matrix);
    status = status ? status : one;
    const char *locals[EVALUATION_MOST_LOCALS];
    one = rules_resolve(names, part->rules, locals, 0);
    status = status ? status : one;
    one = matrix_resolve(names, part->location.matrix);
    status = status ? status : one;
    for (size_t i = 0; i < part->location.count; i++) {
        one = names_resolve(names, part->location.indices[i], NULL, 0);
        status = status ? status : one;
    }
    return status;
}

/* ---- What a state must have ---------------------------------------------------------------------------- */

static bool part_is_allowed(enum cell_kind cell, enum part_kind part)
{
    switch (part) {
    case PART_SUB:
        return true;
    case PART_START:
    case PART_END:
    case PART_REFINE:
    case PART_MASK:
        return cell == CELL_EDGE;
    case PART_BOUNDARY:
    case PART_JOIN:
        return cell == CELL_FACE;
    }
    return false;
}

static size_t parts_of_kind(const struct syntax_cell *cell, enum part_kind kind)
{
    size_t count = 0;
    for (size_t i = 0; i < cell->part_count; i++)
        count += cell->parts[i]->kind == kind;
    return count;
}

static bcifs_status check_part(const struct place_of_names *names, const struct syntax_cell *cell,
                               size_t index)
{
    const struct syntax_part *part = cell->parts[index];
    if (!part_is_allowed(cell->kind, part->kind))
        return report_error(names->report, names->module->source, part->place, "%s '%s' cannot have '%s'",
                            kind_names[cell->kind], cell->name, part_names[part->kind]);
    bool once = part->kind != PART_SUB && part->kind != PART_JOIN && part->kind != PART_BOUNDARY;
    for (size_t i = 0; i < index; i++) {
        const struct syntax_part *other = cell->parts[i];
        if (once && other->kind == part->kind)
            return report_error(names->report, names->module->source, part->place, "'%s' has '%s' twice",
                                cell->name, part_names[part->kind]);
        if (part->kind == PART_BOUNDARY && other->kind == PART_BOUNDARY &&
            strcmp(part->name, other->name) == 0)
            return report_error(names->report, names->module->source, part->name_place,
                                "'%s' has the boundary '%s' twice", cell->name, part->name);
    }
    return BCIFS_OK;
}

static bcifs_status check_edge(const struct place_of_names *names, const struct syntax_cell *cell)
{
    const struct source *source = names->module->source;
    size_t subs = parts_of_kind(cell, PART_SUB);
    const struct syntax_part *refine = syntax_part_of_kind(cell, PART_REFINE, 0),
                             *mask = syntax_part_of_kind(cell, PART_MASK, 0);
    bool start = syntax_part_of_kind(cell, PART_START, 0), end = syntax_part_of_kind(cell, PART_END, 0);
    if ((refine && mask) || ((refine || mask) && subs > 0))
        return report_error(names->report, source, (refine ? refine : mask)->place,
                            "edge '%s' gives its maps in two ways; keep one of sub, refine, mask",
                            cell->name);
    if (!refine && !mask && subs == 0)
        return report_error(names->report, source, cell->place,
                            "edge '%s' has no maps: give some with sub, refine or mask", cell->name);
    if (refine || mask) {
        if (start != end)
            return report_error(names->report, source, cell->place,
                                "edge '%s' needs both start and end, or neither: %s gives both", cell->name,
                                refine ? "refine" : "mask");
        return BCIFS_OK;
    }
    if (!start || !end)
        return report_error(names->report, source, cell->place, "edge '%s' has no %s", cell->name,
                            !start && !end ? "start and end"
                            : !start       ? "start"
                                           : "end");
    return BCIFS_OK;
}

static bcifs_status check_cell(const struct place_of_names *names, const struct syntax_cell *cell)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < cell->part_count; i++) {
        bcifs_status one = check_part(names, cell, i);
        status = status ? status : one;
    }
    if (status)
        return status;
    if (cell->kind == CELL_EDGE)
        return check_edge(names, cell);
    size_t subs = parts_of_kind(cell, PART_SUB);
    if (cell->kind == CELL_VERTEX && subs > 1)
        return report_error(names->report, names->module->source, cell->place,
                            "vertex '%s' has %zu maps; a vertex has one", cell->name, subs);
    if (cell->kind != CELL_VERTEX && subs == 0)
        return report_error(names->report, names->module->source, cell->place,
                            "%s '%s' has no maps: give some with sub", kind_names[cell->kind], cell->name);
    return BCIFS_OK;
}

/* ---- Joints and products ------------------------------------------------------------------------------- */

/* `refine` and `mask` imply the vertex state at both ends, [IM] (9), unless start and end are given. */
static bcifs_status joint_make(bcifs_automaton *automaton, struct definition *edge, struct report *report)
{
    const struct syntax_cell *cell = edge->syntax;
    if (syntax_part_of_kind(cell, PART_START, 0) ||
        (!syntax_part_of_kind(cell, PART_REFINE, 0) && !syntax_part_of_kind(cell, PART_MASK, 0)))
        return BCIFS_OK;
    size_t length = strlen(edge->name);
    char *name = arena_new(&automaton->arena, length + sizeof ".joint", 1);
    if (!name)
        return report_memory(report);
    memcpy(name, edge->name, length);
    memcpy(name + length, ".joint", sizeof ".joint");
    struct definition joint = {.form = DEFINITION_JOINT,
                               .kind = CELL_VERTEX,
                               .name = name,
                               .module = edge->module,
                               .syntax = edge->syntax,
                               .argument_count = edge->argument_count,
                               .edge = edge};
    edge->joint = definition_add(automaton, joint, report);
    return edge->joint ? BCIFS_OK : report->first.status;
}

struct definition *automaton_product(const bcifs_automaton *automaton, const struct definition *a,
                                     const struct definition *b)
{
    for (size_t i = 0; i < automaton->definition_count; i++) {
        struct definition *definition = automaton->definitions[i];
        if (definition->form == DEFINITION_PRODUCT && definition->factors[0] == a &&
            definition->factors[1] == b && !definition->factor_references[0] &&
            !definition->factor_references[1])
            return definition;
    }
    return NULL;
}

/* The state a * b whose arguments are those of a, then those of b; made unless it exists. */
static bcifs_status product_make(bcifs_automaton *automaton, struct definition *a, struct definition *b,
                                 struct report *report)
{
    if (automaton_product(automaton, a, b))
        return BCIFS_OK;
    struct text name = {0};
    text_format(&name, "%s*%s", a->name, b->name);
    struct definition product = {.form = DEFINITION_PRODUCT,
                                 .kind = a->kind == CELL_VERTEX   ? b->kind
                                         : b->kind == CELL_VERTEX ? a->kind
                                                                  : CELL_FACE,
                                 .module = automaton->modules[0],
                                 .argument_count = a->argument_count + b->argument_count,
                                 .factors = {a, b}};
    product.name = name.failed ? NULL : arena_text(&automaton->arena, name.data, name.length);
    text_free(&name);
    if (!product.name)
        return report_memory(report);
    return definition_add(automaton, product, report) ? BCIFS_OK : report->first.status;
}

/* Calls `visit` with every state that a state's children (or boundaries) are in. */
typedef bcifs_status definition_visitor(void *context, struct definition *definition);

static bcifs_status each_child(struct definition *definition, definition_visitor *visit, void *context)
{
    const struct syntax_cell *cell = definition->syntax;
    bool itself = definition->form == DEFINITION_JOINT || parts_of_kind(cell, PART_SUB) == 0;
    bcifs_status status = itself ? visit(context, definition) : BCIFS_OK;
    for (size_t i = 0; !itself && i < cell->part_count && status == BCIFS_OK; i++)
        if (cell->parts[i]->kind == PART_SUB && cell->parts[i]->reference->target)
            status = visit(context, cell->parts[i]->reference->target->definition);
    return status;
}

static bcifs_status each_boundary(struct definition *definition, definition_visitor *visit, void *context)
{
    if (definition->form == DEFINITION_JOINT)
        return BCIFS_OK;
    const struct syntax_cell *cell = definition->syntax;
    bcifs_status status = definition->joint ? visit(context, definition->joint) : BCIFS_OK;
    for (size_t i = 0; i < cell->part_count && status == BCIFS_OK; i++)
        if (cell->parts[i]->kind != PART_SUB && cell->parts[i]->reference &&
            cell->parts[i]->reference->target)
            status = visit(context, cell->parts[i]->reference->target->definition);
    return status;
}

struct product_visit {
    bcifs_automaton *automaton;
    struct report *report;
    struct definition *left, *right;
};

static bcifs_status visit_right(void *context, struct definition *definition)
{
    struct product_visit *visit = context;
    return product_make(visit->automaton, visit->left, definition, visit->report);
}

static bcifs_status visit_left(void *context, struct definition *definition)
{
    struct product_visit *visit = context;
    return product_make(visit->automaton, definition, visit->right, visit->report);
}

static bcifs_status visit_left_children(void *context, struct definition *definition)
{
    struct product_visit *visit = context, inner = *visit;
    inner.left = definition;
    return each_child(visit->right, visit_right, &inner);
}

/* The states of the children and boundaries of a product are products too, [IM] 6.1. */
static bcifs_status product_close(bcifs_automaton *automaton, struct definition *product,
                                  struct report *report)
{
    struct product_visit visit = {automaton, report, product->factors[0], product->factors[1]};
    bcifs_status status = each_child(product->factors[0], visit_left_children, &visit);
    if (status == BCIFS_OK)
        status = each_boundary(product->factors[0], visit_left, &visit);
    if (status == BCIFS_OK)
        status = each_boundary(product->factors[1], visit_right, &visit);
    return status;
}

/* `face NAME = a * b`. */
static bcifs_status factors_resolve(const struct place_of_names *names, struct definition *definition)
{
    for (int i = 0; i < 2; i++) {
        struct syntax_reference *syntax = definition->syntax->factors[i];
        bcifs_status status = reference_resolve(names, syntax, true);
        if (status)
            return status;
        struct definition *factor = syntax->target->definition;
        if (factor->kind != CELL_EDGE)
            return report_error(names->report, names->module->source, syntax->place,
                                "a product needs two edges; '%s' is a %s", syntax->name,
                                kind_names[factor->kind]);
        definition->factors[i] = factor;
        if (syntax->has_arguments)
            definition->factor_references[i] = syntax->target;
        else
            definition->argument_count += factor->argument_count;
    }
    return BCIFS_OK;
}

/* ---- Figures and wavelets ------------------------------------------------------------------------------ */

static bcifs_status figure_resolve(const struct place_of_names *names, const struct syntax_figure *figure)
{
    bcifs_status status = BCIFS_OK;
    struct definition *directions[2] = {NULL, NULL};
    size_t count = 0;
    for (size_t i = 0; i < figure->part_count; i++) {
        struct syntax_figure_part *part = figure->parts[i];
        bcifs_status one = matrix_resolve(names, part->matrix);
        status = status ? status : one;
        if (!part->reference)
            continue;
        one = reference_resolve(names, part->reference, part->kind != FIGURE_PIECE);
        status = status ? status : one;
        if (one == BCIFS_OK && part->kind != FIGURE_PIECE && count < 2)
            directions[count++] = part->reference->target->definition;
    }
    bool surface = count == 2 && directions[0]->kind == CELL_EDGE && directions[1]->kind == CELL_EDGE;
    if (status == BCIFS_OK && surface)
        status = product_make(names->automaton, directions[0], directions[1], names->report);
    return status;
}

static bcifs_status wavelet_resolve(const struct place_of_names *names, const struct syntax_wavelet *wavelet)
{
    bcifs_status status = reference_resolve(names, wavelet->reference, true);
    bcifs_status smooth = matrix_resolve(names, wavelet->smooth),
                 detail = matrix_resolve(names, wavelet->detail);
    if (status || smooth || detail)
        return status ? status : smooth ? smooth : detail;
    if (wavelet->reference->target->definition->kind != CELL_EDGE)
        return report_error(names->report, names->module->source, wavelet->reference->place,
                            "a wavelet belongs to an edge; '%s' is a %s", wavelet->reference->name,
                            kind_names[wavelet->reference->target->definition->kind]);
    if (wavelet->smooth->rows != 1 || wavelet->detail->rows != 1)
        return report_error(names->report, names->module->source,
                            (wavelet->smooth->rows != 1 ? wavelet->smooth : wavelet->detail)->place,
                            "a filter is one row");
    return BCIFS_OK;
}

static bcifs_status cell_resolve(struct place_of_names *names, struct definition *definition)
{
    const struct syntax_cell *cell = definition->syntax;
    names->arguments = cell->arguments;
    names->argument_count = cell->argument_count;
    if (definition->form == DEFINITION_PRODUCT)
        return factors_resolve(names, definition);
    bcifs_status status = check_cell(names, cell);
    if (cell->points) {
        bcifs_status points = names_resolve(names, cell->points, NULL, 0);
        status = status ? status : points;
    }
    for (size_t i = 0; i < cell->part_count && !report_is_full(names->report); i++) {
        bcifs_status one = part_resolve(names, definition, cell->parts[i]);
        status = status ? status : one;
    }
    return status;
}

static bcifs_status resolve_all(bcifs_automaton *automaton, struct report *report)
{
    bcifs_status status = BCIFS_OK;
    size_t written = automaton->definition_count;
    for (size_t i = 0; i < written && !report_is_full(report); i++) {
        struct place_of_names names = {automaton, automaton->definitions[i]->module, NULL, 0, report};
        bcifs_status one = cell_resolve(&names, automaton->definitions[i]);
        status = status ? status : one;
    }
    for (size_t m = 0; m < automaton->module_count && !report_is_full(report); m++) {
        struct place_of_names names = {automaton, automaton->modules[m], NULL, 0, report};
        const struct syntax_file *file = automaton->modules[m]->syntax;
        for (size_t i = 0; i < file->count && !report_is_full(report); i++) {
            bcifs_status one = BCIFS_OK;
            if (file->items[i].kind == ITEM_WAVELET)
                one = wavelet_resolve(&names, file->items[i].wavelet);
            else if (file->items[i].kind == ITEM_FIGURE && m == 0)
                one = figure_resolve(&names, file->items[i].figure);
            status = status ? status : one;
        }
    }
    return status;
}

static bcifs_status generate_all(bcifs_automaton *automaton, struct report *report)
{
    bcifs_status status = BCIFS_OK;
    for (size_t i = 0; i < automaton->definition_count && status == BCIFS_OK; i++)
        if (automaton->definitions[i]->form == DEFINITION_WRITTEN)
            status = joint_make(automaton, automaton->definitions[i], report);
    /* The list grows while products make the products of their boundaries; factors are edges and vertices, so
     * it is finite. */
    for (size_t i = 0; i < automaton->definition_count && status == BCIFS_OK; i++)
        if (automaton->definitions[i]->form == DEFINITION_PRODUCT)
            status = product_close(automaton, automaton->definitions[i], report);
    return status;
}

/* ---- What is structural -------------------------------------------------------------------------------- */

/* Parameters and arguments that sizes, indices or ranges depend on keep their values while equations are
 * proved; all others are replaced by random residues. The property travels from a child's argument to the
 * expressions that are written for it, until nothing changes. */
struct marking {
    bool *parameters;
    bool *arguments;
};

static void mark_linear(const struct expression *expression, const struct marking *marking)
{
    bool whole = expression->kind == EXPRESSION_REMAINDER;
    for (size_t i = 0; i < expression->count; i++) {
        bool bound = expression->kind == EXPRESSION_POINT || (expression->kind == EXPRESSION_SUM && i < 2);
        if (whole || bound)
            expression_mark(expression->operands[i], marking->parameters, marking->arguments);
        else
            mark_linear(expression->operands[i], marking);
    }
}

static void mark_rules(const struct syntax_rules *rules, const struct marking *marking)
{
    for (size_t i = 0; rules && i < rules->count; i++) {
        const struct syntax_rule *rule = rules->rules[i];
        if (rule->is_loop) {
            expression_mark(rule->from, marking->parameters, marking->arguments);
            expression_mark(rule->to, marking->parameters, marking->arguments);
            mark_rules(rule->body, marking);
        } else {
            expression_mark(rule->index, marking->parameters, marking->arguments);
            mark_linear(rule->value, marking);
        }
    }
}

static void mark_reference(const struct syntax_reference *syntax, const struct marking *marking)
{
    const struct reference *reference = syntax ? syntax->target : NULL;
    for (size_t i = 0; reference && reference->arguments && i < syntax->count; i++) {
        if (reference->definition->structural[i])
            expression_mark(syntax->arguments[i], marking->parameters, marking->arguments);
        else
            mark_linear(syntax->arguments[i], marking);
    }
}

static void mark_matrix(const struct syntax_matrix *matrix, const struct marking *marking)
{
    for (size_t i = 0; matrix && i < matrix->rows * matrix->columns; i++)
        mark_linear(matrix->entries[i], marking);
}

static void mark_cell(struct definition *definition, bool *parameters)
{
    const struct syntax_cell *cell = definition->syntax;
    struct marking marking = {parameters, definition->structural};
    if (cell->points)
        expression_mark(cell->points, parameters, definition->structural);
    for (size_t i = 0; i < cell->part_count; i++) {
        const struct syntax_part *part = cell->parts[i];
        mark_reference(part->reference, &marking);
        mark_matrix(part->matrix, &marking);
        mark_rules(part->rules, &marking);
        for (size_t j = 0; j < part->location.count; j++)
            expression_mark(part->location.indices[j], parameters, definition->structural);
    }
}

static void mark_product(struct definition *definition, bool *parameters)
{
    size_t next = 0;
    for (int i = 0; i < 2; i++) {
        const struct definition *factor = definition->factors[i];
        struct marking marking = {parameters, NULL};
        if (definition->factor_references[i])
            mark_reference(definition->syntax->factors[i], &marking);
        else
            for (size_t j = 0; j < factor->argument_count; j++)
                definition->structural[next++] |= factor->structural[j];
    }
}

static size_t count_marks(const bcifs_automaton *automaton, const bool *parameters)
{
    size_t count = 0;
    for (size_t i = 0; i < automaton->parameter_count; i++)
        count += parameters[i];
    for (size_t i = 0; i < automaton->definition_count; i++)
        for (size_t j = 0; j < automaton->definitions[i]->argument_count; j++)
            count += automaton->definitions[i]->structural[j];
    return count;
}

static bcifs_status mark_all(bcifs_automaton *automaton, struct report *report)
{
    bool *parameters = arena_new(&automaton->arena, automaton->parameter_count, sizeof *parameters);
    if (!parameters)
        return report_memory(report);
    for (size_t before = 0, now = 1; before != now;) {
        before = count_marks(automaton, parameters);
        for (size_t i = 0; i < automaton->definition_count; i++) {
            struct definition *definition = automaton->definitions[i];
            if (definition->form == DEFINITION_WRITTEN)
                mark_cell(definition, parameters);
            else if (definition->form == DEFINITION_PRODUCT)
                mark_product(definition, parameters);
            else
                memcpy(definition->structural, definition->edge->structural, sizeof definition->structural);
        }
        now = count_marks(automaton, parameters);
    }
    for (size_t i = 0; i < automaton->parameter_count; i++)
        automaton->parameters[i].structural = parameters[i];
    return BCIFS_OK;
}

bcifs_status automaton_bind(bcifs_automaton *automaton, struct report *report)
{
    bcifs_status status = declare_all(automaton, report);
    if (status == BCIFS_MEMORY)
        return status;
    bcifs_status names = resolve_all(automaton, report);
    status = status ? status : names;
    if (status == BCIFS_OK)
        status = generate_all(automaton, report);
    if (status == BCIFS_OK)
        status = mark_all(automaton, report);
    return status;
}
