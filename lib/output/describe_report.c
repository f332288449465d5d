/* The report of bcifs_describe, as JSON (design, section 5) and as text for a person. */
#include <math.h>
#include <string.h>

#include "automaton/describe.h"
#include "base/decimal.h"
#include "output/json_text.h"

/* ---- JSON ---------------------------------------------------------------------------------------------- */

static void json_count(struct text *text, const char *key, size_t count)
{
    text_append(text, ", ");
    json_key(text, key);
    text_format(text, "%zu", count);
}

static void json_reason(struct text *text, const char *key, const char *reason)
{
    if (!reason)
        return;
    text_append(text, ", ");
    json_key(text, key);
    json_string(text, reason);
}

static void json_values(struct text *text, const struct value *values, size_t count)
{
    text_append(text, "[");
    for (size_t i = 0; i < count; i++) {
        text_append(text, i ? ", " : "");
        json_number(text, values[i].real);
    }
    text_append(text, "]");
}

/* The names of an argument as the file writes them; a product has those of its factors one after the other.
 */
static const char *argument_name(const struct definition *definition, size_t index)
{
    return definition->syntax && index < definition->syntax->argument_count
               ? definition->syntax->arguments[index]
               : NULL;
}

static void json_head(struct text *text, const bcifs_description *description, const struct described *told)
{
    const struct definition *definition = told->definition;
    text_append(text, "{");
    json_key(text, "state");
    json_string(text, definition->name);
    if (definition->argument_count > 0 && told->known) {
        const struct value *arguments = description->states.states[told->state].key.arguments;
        text_append(text, ", \"arguments\": ");
        bool named = argument_name(definition, definition->argument_count - 1) != NULL;
        text_append(text, named ? "{" : "[");
        for (size_t i = 0; i < definition->argument_count; i++) {
            text_append(text, i ? ", " : "");
            if (named)
                json_key(text, argument_name(definition, i));
            json_number(text, arguments[i].real);
        }
        text_append(text, named ? "}" : "]");
    }
    json_reason(text, "reason", told->reason);
}

static void json_masks(struct text *text, const struct level_masks *masks)
{
    text_append(text, ",\n   \"masks\": ");
    text_append(text, masks->masks ? "[" : "null");
    for (size_t q = 0; masks->masks && q < masks->count; q++) {
        text_append(text, q ? ", " : "");
        json_values(text, masks->masks[q].values, masks->masks[q].count);
    }
    text_append(text, masks->masks ? "], \"mask_offsets\": [" : "");
    for (size_t q = 0; masks->masks && q < masks->count; q++)
        text_format(text, "%s%td", q ? ", " : "", masks->masks[q].offset);
    text_append(text, masks->masks ? "]" : "");
    text_append(text, ", \"mask\": ");
    if (masks->row)
        json_values(text, masks->row, masks->row_count);
    else
        text_append(text, "null");
    json_reason(text, "mask_reason", masks->row_reason);
}

static void json_edge(struct text *text, const bcifs_description *description, const struct described *told)
{
    const struct states *states = &description->states;
    const struct state *state = &states->states[told->state];
    const struct state *joint = &states->states[state->boundaries[0]];
    const struct level_class *class = &told->class;
    json_count(text, "subdivisions", class->subdivisions);
    json_count(text, "step", class->step);
    json_count(text, "joint_points", class->joint[0]);
    json_count(text, "points", class->points);
    json_count(text, "degree", class->points - 1);
    json_count(text, "order", class->joint[0] - 1);
    text_append(text, ", \"case\": ");
    if (class->dependence)
        text_format(text, "%d", class->dependence);
    else
        text_append(text, "null");
    text_append(text, ", \"interpolating\": ");
    text_append(text, told->interpolating < 0 ? "null" : told->interpolating ? "true" : "false");
    json_reason(text, "interpolating_reason", told->interpolating_reason);
    json_count(text, "level", description->depth);
    text_append(text, ",\n   \"refinement\": ");
    if (told->refinement)
        json_matrix(text, told->refinement, class->points, told->columns);
    else
        text_append(text, "null");
    json_reason(text, "refinement_reason", told->refinement_reason);
    text_append(text, ",\n   \"joint\": ");
    json_matrix(text, joint->maps[0], joint->points, states->states[joint->children[0]].points);
    json_masks(text, &told->masks);
}

static void json_topology(struct text *text, const struct states *states, const struct state *state)
{
    text_append(text, ", \"children\": [");
    for (size_t i = 0; i < state->cell->child_count; i++) {
        text_append(text, i ? ", " : "");
        json_string(text, states->states[state->children[i]].key.definition->name);
    }
    text_append(text, "], \"boundaries\": {");
    for (size_t i = 0; i < state->cell->boundary_count; i++) {
        text_append(text, i ? ", " : "");
        json_key(text, state->cell->boundaries[i].name);
        json_string(text, states->states[state->boundaries[i]].key.definition->name);
    }
    text_append(text, "}");
}

static void json_told(struct text *text, const bcifs_description *description, const struct described *told)
{
    const struct states *states = &description->states;
    json_head(text, description, told);
    if (told->known && told->definition->kind == CELL_EDGE) {
        json_edge(text, description, told);
    } else if (told->known) {
        json_count(text, "subdivisions", states->states[told->state].cell->child_count);
        json_count(text, "points", states->states[told->state].points);
    }
    if (told->known)
        json_topology(text, states, &states->states[told->state]);
    text_append(text, "}");
}

static void json_kind(struct text *text, const bcifs_description *description, const char *key,
                      enum cell_kind kind)
{
    bool any = false;
    text_append(text, ",\n ");
    json_key(text, key);
    text_append(text, "[");
    for (size_t i = 0; i < description->count; i++) {
        if (description->states_told[i].definition->kind != kind)
            continue;
        text_append(text, any ? ",\n  " : "\n  ");
        json_told(text, description, &description->states_told[i]);
        any = true;
    }
    text_append(text, "]");
}

char *bcifs_description_json(const bcifs_description *description)
{
    const bcifs_automaton *automaton = description->automaton;
    struct text text = {0};
    text_append(&text, "{");
    json_key(&text, "automaton");
    json_string(&text, bcifs_automaton_name(automaton));
    text_append(&text, ",\n \"parameters\": {");
    for (size_t i = 0; i < automaton->parameter_count; i++) {
        text_append(&text, i ? ", " : "");
        json_key(&text, automaton->parameters[i].name);
        json_number(&text, automaton->parameters[i].value.real);
    }
    text_append(&text, "}");
    json_kind(&text, description, "edges", CELL_EDGE);
    json_kind(&text, description, "faces", CELL_FACE);
    json_kind(&text, description, "cells", CELL_CELL);
    text_append(&text, "}\n");
    return text_take(&text);
}

/* ---- Text ---------------------------------------------------------------------------------------------- */

enum { MOST_SHOWN = 24 /* columns of a matrix that fits on a screen */, MOST_ROWS = 64, DIGITS = 8 };

/* What entry (row, column) is: exact values where there are some, otherwise doubles. */
struct shown {
    const struct value *values;
    const double *reals;
    size_t rows, columns;
};

static void append_entry(struct text *text, const struct shown *shown, size_t index)
{
    char digits[DECIMAL_LONGEST];
    if (shown->values && shown->values[index].exact)
        value_write(text, shown->values[index]);
    else
        text_append_bytes(
            text, digits,
            decimal_print_digits(digits, shown->values ? shown->values[index].real : shown->reals[index],
                                 DIGITS));
}

static size_t entry_width(const struct shown *shown, size_t index)
{
    struct text text = {0};
    append_entry(&text, shown, index);
    size_t width = text.length;
    text_free(&text);
    return width;
}

/* A matrix in brackets, its columns lined up; too large a one is only told about. */
static void append_matrix(struct text *text, const char *title, const struct shown *shown)
{
    text_format(text, "  %s, %zu × %zu", title, shown->rows, shown->columns);
    if (shown->columns > MOST_SHOWN || shown->rows > MOST_ROWS) {
        text_append(text, ": too large to show; --json and -o x.mtx have it\n");
        return;
    }
    text_append(text, "\n");
    size_t widths[MOST_SHOWN] = {0};
    for (size_t i = 0; i < shown->rows * shown->columns; i++) {
        size_t width = entry_width(shown, i), *widest = &widths[i % shown->columns];
        *widest = width > *widest ? width : *widest;
    }
    for (size_t i = 0; i < shown->rows; i++) {
        text_append(text, "    [ ");
        for (size_t j = 0; j < shown->columns; j++) {
            append_entry(text, shown, i * shown->columns + j);
            text_append_character(text, ' ', widths[j] - entry_width(shown, i * shown->columns + j) + 1);
        }
        text_append(text, "]\n");
    }
}

static void append_values(struct text *text, const struct value *values, size_t count)
{
    const struct shown row = {values, NULL, 1, count};
    text_append(text, "[");
    for (size_t i = 0; i < count; i++) {
        text_append(text, " ");
        append_entry(text, &row, i);
    }
    text_append(text, " ]");
}

static void append_class(struct text *text, const struct level_class *class)
{
    static const char *const cases[] = {
        "", "case 1, Δ ≥ m_s: the joints inside the maps and T^s are independent",
        "case 2, NΔ ≥ m_s > Δ: the two occurrences of T^s in the refinement matrix do not overlap",
        "case 3, m_s > NΔ: T^s overlaps itself in the refinement matrix and is given by masks"};
    text_format(text, "  N = %zu subdivision%s, step Δ = %zu, joints of m_s = %zu control point%s\n",
                class->subdivisions, class->subdivisions == 1 ? "" : "s", class->step, class->joint[0],
                class->joint[0] == 1 ? "" : "s");
    text_format(text, "  degree %zu, order %zu", class->points - 1, class->joint[0] - 1);
    if (class->dependence)
        text_format(text, "; %s\n", cases[class->dependence]);
    else if (class->joint[0] != class->joint[1])
        text_format(text, "; no case: the start has %zu control points, the end %zu\n", class->joint[0],
                    class->joint[1]);
    else
        text_append(text, "; no case: the joint is as large as the arc\n");
}

static void append_masks(struct text *text, const struct level_masks *masks)
{
    if (!masks->masks)
        return;
    text_append(text, masks->count == 1 ? "  mask" : "  masks");
    for (size_t q = 0; q < masks->count; q++) {
        text_append(text, q ? ", " : " ");
        append_values(text, masks->masks[q].values, masks->masks[q].count);
    }
    text_append(text, "\n");
}

static void append_edge(struct text *text, const bcifs_description *description, const struct described *told)
{
    const struct states *states = &description->states;
    const struct state *state = &states->states[told->state];
    const struct value_matrix *map = states->states[state->boundaries[0]].cell->children[0].map;
    append_class(text, &told->class);
    if (told->interpolating < 0)
        text_format(text, "  neither interpolating nor approximating: %s\n", told->interpolating_reason);
    else
        text_append(text, told->interpolating
                              ? "  interpolating: the joint's limit point is one of its control points\n"
                              : "  approximating: the joint's limit point is none of its control points\n");
    if (told->refinement_reason)
        text_format(text, "  no refinement matrix: %s\n", told->refinement_reason);
    else if (description->depth == 1)
        append_matrix(text, "refinement matrix T_÷",
                      &(struct shown){told->fused->values, NULL, told->fused->rows, told->fused->columns});
    else
        append_matrix(text, "refinement matrix of the level",
                      &(struct shown){NULL, told->refinement, told->class.points, told->columns});
    append_matrix(text, "joint T^s", &(struct shown){map->values, NULL, map->rows, map->columns});
    append_masks(text, &told->masks);
    if (told->masks.row) {
        text_format(text, "  as one row: mask %zu ", told->class.subdivisions);
        append_values(text, told->masks.row, told->masks.row_count);
        text_append(text, "\n");
    } else {
        text_format(text, "  no mask of the language: %s\n", told->masks.row_reason);
    }
}

static void append_topology(struct text *text, const struct states *states, const struct state *state)
{
    text_format(text, "  %zu map%s: ", state->cell->child_count, state->cell->child_count == 1 ? "" : "s");
    for (size_t i = 0; i < state->cell->child_count; i++)
        text_format(text, "%s%s", i ? ", " : "", states->states[state->children[i]].key.definition->name);
    for (size_t i = 0; i < state->cell->boundary_count; i++)
        text_format(text, "%s%s %s", i ? ", " : "; boundaries: ", state->cell->boundaries[i].name,
                    states->states[state->boundaries[i]].key.definition->name);
    text_append(text, "\n");
}

static void append_told(struct text *text, const bcifs_description *description, const struct described *told)
{
    static const char *const kinds[] = {
        [CELL_VERTEX] = "vertex", [CELL_EDGE] = "edge", [CELL_FACE] = "face", [CELL_CELL] = "cell"};
    text_format(text, "\n%s ", kinds[told->definition->kind]);
    if (!told->known) {
        text_format(text, "%s: %s\n", told->definition->name, told->reason);
        return;
    }
    const struct state *state = &description->states.states[told->state];
    state_name(&state->key, text);
    text_format(text, ": %zu control point%s\n", state->points, state->points == 1 ? "" : "s");
    append_topology(text, &description->states, state);
    if (told->definition->kind == CELL_EDGE)
        append_edge(text, description, told);
}

char *bcifs_description_text(const bcifs_description *description)
{
    struct text text = {0};
    const bcifs_automaton *automaton = description->automaton;
    const char *title = bcifs_automaton_title(automaton);
    text_format(&text, "%s%s%s\n", bcifs_automaton_name(automaton), title[0] ? ": " : "", title);
    for (size_t i = 0; i < automaton->parameter_count; i++) {
        text_append(&text, i ? ", " : "with ");
        text_format(&text, "%s = ", automaton->parameters[i].name);
        value_write(&text, automaton->parameters[i].value);
    }
    text_append(&text, automaton->parameter_count ? "\n" : "");
    if (description->depth != 1)
        text_format(&text, "refinement matrices of level %u\n", description->depth);
    for (size_t i = 0; i < description->count; i++)
        append_told(&text, description, &description->states_told[i]);
    return text_take(&text);
}
