/* The report of bcifs_complete, as JSON (design, section 5) and, where there is a conflict, in words. */
#include "automaton/complete.h"
#include "output/json_text.h"

static const char *const kind_names[] = {
    [BCIFS_BARYCENTRIC] = "barycentric", [BCIFS_INCIDENCE] = "incidence", [BCIFS_ADJACENCY] = "adjacency"};

/* ---- JSON ---------------------------------------------------------------------------------------------- */

static void json_text_member(struct text *text, const char *key, const char *value)
{
    json_key(text, key);
    json_string(text, value);
}

static void json_conflict(struct text *text, const bcifs_conflict *conflict)
{
    text_append(text, "{");
    json_text_member(text, "state", conflict->state);
    text_append(text, ", ");
    json_text_member(text, "kind", kind_names[conflict->kind]);
    text_append(text, ", ");
    json_text_member(text, "equation", conflict->equation);
    text_format(text, ", \"row\": %zu, \"column\": %zu, ", conflict->row, conflict->column);
    json_text_member(text, "file", conflict->file);
    text_format(text, ", \"line\": %u", conflict->line);
    if (conflict->reason) {
        text_append(text, ", ");
        json_text_member(text, "reason", conflict->reason);
    }
    text_append(text, "}");
}

char *bcifs_complete_json(const bcifs_complete *complete)
{
    struct text text = {0};
    text_format(&text, "{\"unknowns\": %zu,\n \"equations\": %zu,\n", bcifs_complete_unknowns(complete),
                bcifs_complete_equations(complete));
    if (complete->consistent)
        text_format(&text, " \"rank\": %zu,\n \"degrees_of_freedom\": %zu,\n", complete->rank,
                    complete->freedom);
    else
        text_append(&text, " \"rank\": null,\n \"degrees_of_freedom\": null,\n");
    text_append(&text, " \"parameters\": ");
    json_strings(&text, complete->names, complete->freedom);
    text_append(&text, ",\n ");
    json_flag(&text, "consistent", complete->consistent);
    text_append(&text, ",\n \"conflicts\": [");
    for (size_t i = 0; i < complete->conflict_count; i++) {
        text_append(&text, i ? ",\n  " : "\n  ");
        json_conflict(&text, &complete->conflicts[i]);
    }
    text_append(&text, "],\n ");
    json_text_member(&text, "contradiction", complete->contradiction);
    text_append(&text, ",\n ");
    json_key(&text, "automaton");
    if (complete->consistent)
        json_string(&text, complete->text);
    else
        text_append(&text, "null");
    text_append(&text, "}\n");
    return text_take(&text);
}

/* ---- Text ---------------------------------------------------------------------------------------------- */

char *bcifs_complete_text(const bcifs_complete *complete)
{
    struct text text = {0};
    if (complete->contradiction[0])
        text_format(&text, "%s: these equations contradict each other, they come to %s:\n",
                    bcifs_automaton_name(complete->automaton), complete->contradiction);
    else if (complete->conflict_count > 0)
        text_format(&text, "%s: the equations cannot be satisfied:\n",
                    bcifs_automaton_name(complete->automaton));
    for (size_t i = 0; i < complete->conflict_count; i++) {
        const bcifs_conflict *conflict = &complete->conflicts[i];
        text_format(&text, "  %s: %s, ", conflict->state, conflict->equation);
        if (conflict->reason)
            text_format(&text, "%s", conflict->reason);
        else if (conflict->kind == BCIFS_BARYCENTRIC)
            text_format(&text, "column %zu", conflict->column);
        else
            text_format(&text, "entry (%zu, %zu)", conflict->row, conflict->column);
        text_format(&text, "  (%s:%u)\n", conflict->file, conflict->line);
    }
    text_append(&text, "");
    return text_take(&text);
}
