#include "describe.h"

#include <string.h>

#include "automaton/figure.h"
#include "automaton/proof.h"

/* ---- Representatives ----------------------------------------------------------------------------------- */

bcifs_status representative_find(struct states *states, const struct definition *definition, size_t *index,
                                 bool *known)
{
    *known = true;
    for (*index = 0; *index < states->count; ++*index)
        if (states->states[*index].key.definition == definition)
            return BCIFS_OK;
    *known = !definition_is_structural(definition);
    if (!*known)
        return BCIFS_OK;
    struct value *ones = arena_new(states->arena, definition->argument_count, sizeof *ones);
    if (!ones)
        return states->setting.report ? report_memory(states->setting.report) : BCIFS_MEMORY;
    for (size_t i = 0; i < definition->argument_count; i++)
        ones[i] = value_from_integer(1);
    return states_intern(states, (struct state_key){definition, ones}, index);
}

/* ---- States -------------------------------------------------------------------------------------------- */

static bcifs_status edge_describe(bcifs_description *description, struct described *told)
{
    struct states *states = &description->states;
    bcifs_status status = levels_classify(states, told->state, &told->class);
    if (status == BCIFS_OK)
        status = levels_fuse(states, told->state, &told->fused, &told->refinement_reason);
    if (status == BCIFS_OK)
        status = levels_mask(states, told->state, told->fused, &told->masks);
    if (status == BCIFS_OK && !told->refinement_reason)
        status = levels_refine(states, told->state, description->depth, &told->refinement, &told->columns,
                               &told->refinement_reason);
    if (status == BCIFS_OK)
        status = levels_interpolate(states, told->state, &told->interpolating, &told->interpolating_reason);
    return status;
}

static bcifs_status state_describe(bcifs_description *description, const struct definition *definition)
{
    struct described *told = &description->states_told[description->count++];
    told->definition = definition;
    bcifs_status status = representative_find(&description->states, definition, &told->state, &told->known);
    if (!told->known)
        told->reason = "its sizes depend on its arguments, and no figure says which";
    if (status || !told->known)
        return status;
    status = states_expand(&description->states, told->state);
    if (status == BCIFS_OK && definition->kind == CELL_EDGE)
        status = edge_describe(description, told);
    return status;
}

/* ---- The handle ---------------------------------------------------------------------------------------- */

static bcifs_status name_refuse(const bcifs_automaton *automaton, const char *name, struct report *report)
{
    enum { MOST = 256 };
    const char *candidates[MOST];
    size_t count = 0;
    for (size_t i = 0; i < automaton->definition_count && count < MOST; i++)
        candidates[count++] = automaton->definitions[i]->name;
    const char *nearest = nearest_word(name, candidates, count);
    return report_failure(report, BCIFS_INPUT, automaton->modules[0]->source->name,
                          "there is no state '%s'%s%s%s", name, nearest ? "; did you mean '" : "",
                          nearest ? nearest : "", nearest ? "'?" : "");
}

static bcifs_status describe(bcifs_description *description, const char *name, struct report *report)
{
    const bcifs_automaton *automaton = description->automaton;
    if (automaton->unknowns > 0)
        return report_failure(report, BCIFS_INPUT, automaton->modules[0]->source->name,
                              "the automaton has %zu unknown entr%s '?'; bcifs complete solves for them",
                              automaton->unknowns, automaton->unknowns == 1 ? "y" : "ies");
    bcifs_status status = states_of_figures(automaton, &description->states, &description->arena);
    description->states.setting.report = report;
    if (status == BCIFS_MEMORY)
        return report_memory(report);
    description->states_told =
        arena_new(&description->arena, automaton->definition_count, sizeof *description->states_told);
    if (status || !description->states_told)
        return status ? status : report_memory(report);
    bool found = !name;
    for (size_t i = 0; i < automaton->definition_count && status == BCIFS_OK; i++) {
        const struct definition *definition = automaton->definitions[i];
        if (name && strcmp(name, definition->name) != 0)
            continue;
        found = true;
        if (definition->kind != CELL_VERTEX)
            status = state_describe(description, definition);
        else if (name)
            status = report_failure(report, BCIFS_INPUT, automaton->modules[0]->source->name,
                                    "the state '%s' is a vertex; describe tells about edges, faces and cells",
                                    name);
    }
    return status || found ? status : name_refuse(automaton, name, report);
}

bcifs_status bcifs_describe(const bcifs_automaton *automaton, const bcifs_describe_options *options,
                            bcifs_description **description, bcifs_error *error)
{
    struct report report = report_new(NULL);
    bcifs_description *fresh = memory_new(1, sizeof *fresh);
    bcifs_status status = fresh ? BCIFS_OK : report_memory(&report);
    if (fresh) {
        fresh->automaton = automaton;
        fresh->depth = options ? options->depth : 1;
        status = describe(fresh, options ? options->state : NULL, &report);
    }
    if (status) {
        bcifs_description_free(fresh);
        report_close(&report, error);
        return status;
    }
    fresh->states.setting.report = NULL; /* it does not outlive this call */
    *description = fresh;
    return BCIFS_OK;
}

void bcifs_description_free(bcifs_description *description)
{
    if (!description)
        return;
    arena_free(&description->arena);
    memory_free(description);
}
