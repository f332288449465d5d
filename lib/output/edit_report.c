/* The report of bcifs_editor, as JSON (design, section 5) and as text for a person. */
#include <math.h>

#include "multires/editor.h"
#include "output/json_text.h"

static const char *energy_name(bcifs_energy energy)
{
    static const char *const names[] = {
        [BCIFS_BENDING] = "bending", [BCIFS_DIFFERENCE] = "discrete", [BCIFS_NO_ENERGY] = "none"};
    return names[energy];
}

/* ---- JSON ---------------------------------------------------------------------------------------------- */

static void json_named(struct text *text, const char *key, double number, const char *behind)
{
    json_key(text, key);
    json_number(text, number);
    text_append(text, behind);
}

/* Points of a stage as an array of pairs. */
static void json_points(struct text *text, const char *key, const bcifs_editor *editor, bool scale)
{
    size_t count = scale ? bcifs_editor_scale_points(editor) : bcifs_editor_points(editor);
    double *points = memory_new(2 * count, sizeof *points);
    text->failed = text->failed || !points;
    if (!points)
        return;
    if (scale)
        bcifs_editor_read_scale(editor, BCIFS_RESULT, points);
    else
        bcifs_editor_read(editor, BCIFS_RESULT, points);
    json_key(text, key);
    json_matrix(text, points, count, 2);
    memory_free(points);
}

char *bcifs_editor_json(const bcifs_editor *editor)
{
    struct text text = {0};
    bcifs_edit_report report;
    const char *reason;
    bcifs_energy energy = bcifs_editor_energy(editor, &reason);
    bcifs_editor_report(editor, &report);
    text_append(&text, "{");
    json_key(&text, "automaton");
    json_string(&text, bcifs_automaton_name(editor->figure->automaton));
    text_append(&text, ", ");
    json_key(&text, "figure");
    json_string(&text, editor->figure->name);
    text_format(&text, ",\n \"level\": %u,\n \"area\": {", bcifs_editor_level(editor));
    json_named(&text, "before", report.before, ", ");
    json_named(&text, "deformed", report.deformed, ", ");
    json_named(&text, "after", report.after, ", ");
    json_named(&text, "target", report.target, ", ");
    json_named(&text, "relative_error", report.relative_error, "},\n ");
    json_key(&text, "energy");
    text_append(&text, "{\"kind\": ");
    json_string(&text, energy_name(energy));
    text_append(&text, ", ");
    json_named(&text, "deformed", report.energy_deformed, ", ");
    json_named(&text, "after", report.energy_after, "},\n ");
    text_format(&text, "\"iterations\": %u, ", report.iterations);
    json_named(&text, "multiplier", report.multiplier, ", ");
    json_flag(&text, "global", report.global);
    text_append(&text, ",\n ");
    json_points(&text, "scale_points", editor, true);
    text_append(&text, ",\n ");
    json_points(&text, "points", editor, false);
    text_append(&text, "}\n");
    return text_take(&text);
}

/* ---- Text ---------------------------------------------------------------------------------------------- */

static void append_line(struct text *text, const char *name, double number)
{
    if (!isfinite(number))
        return;
    text_append(text, name);
    text_append_number(text, number);
    text_append(text, "\n");
}

char *bcifs_editor_text(const bcifs_editor *editor)
{
    struct text text = {0};
    bcifs_edit_report report;
    bcifs_energy energy = bcifs_editor_energy(editor, NULL);
    bcifs_editor_report(editor, &report);
    text_format(&text, "%s, figure %s: %zu control points, edited by %zu, %u level%s above\n",
                bcifs_automaton_name(editor->figure->automaton), editor->figure->name, bcifs_editor_points(editor),
                bcifs_editor_scale_points(editor), bcifs_editor_level(editor),
                bcifs_editor_level(editor) == 1 ? "" : "s");
    append_line(&text, "area before    ", report.before);
    append_line(&text, "     deformed  ", report.deformed);
    append_line(&text, "     after     ", report.after);
    if (isfinite(report.after)) {
        append_line(&text, "     target    ", report.target);
        append_line(&text, "     missed by ", report.relative_error);
    }
    if (energy != BCIFS_NO_ENERGY) {
        text_format(&text, "energy (%s)\n", energy_name(energy));
        append_line(&text, "     deformed  ", report.energy_deformed);
        append_line(&text, "     after     ", report.energy_after);
    }
    return text_take(&text);
}
