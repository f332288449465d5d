/* The report of bcifs_area, as JSON (design, section 5) and as text for a person. */
#include "output/area_report.h"

#include "output/json_text.h"

/* ---- JSON ---------------------------------------------------------------------------------------------- */

static void json_form(struct text *text, const bcifs_form *form)
{
    text_append(text, "{");
    json_key(text, "state");
    json_string(text, form->state);
    text_append(text, ", ");
    json_flag(text, "exact", form->exact);
    text_append(text, ", ");
    json_key(text, "form");
    json_matrix(text, form->matrix, form->size, form->size);
    text_append(text, "}");
}

void area_json_members(struct text *text, const bcifs_area *area)
{
    json_key(text, "automaton");
    json_string(text, bcifs_automaton_name(area->automaton));
    text_append(text, ", ");
    json_key(text, "figure");
    json_string(text, area->figure);
    text_append(text, ",\n ");
    json_key(text, "area");
    if (area->placed)
        json_number(text, area->value.real);
    else
        text_append(text, "null");
    text_append(text, ", ");
    json_flag(text, "exact", area->fraction != NULL);
    text_append(text, ", ");
    json_key(text, "fraction");
    if (area->fraction)
        json_string(text, area->fraction);
    else
        text_append(text, "null");
    text_append(text, ",\n ");
    json_key(text, "form");
    json_matrix(text, area->told[0].matrix, area->told[0].size, area->told[0].size);
    text_append(text, ",\n ");
    json_key(text, "forms");
    text_append(text, "[");
    for (size_t i = 0; i < area->count; i++) {
        text_append(text, i ? ",\n  " : "\n  ");
        json_form(text, &area->told[i]);
    }
    text_append(text, "]");
}

char *bcifs_area_json(const bcifs_area *area)
{
    struct text text = {0};
    text_append(&text, "{");
    area_json_members(&text, area);
    text_append(&text, "}\n");
    return text_take(&text);
}

/* ---- Text ---------------------------------------------------------------------------------------------- */

enum { MOST_SHOWN = 12 /* control points of a form that is shown */ };

/* Appends an entry, padded to `width`; returns how long it is. */
static size_t append_entry(struct text *text, struct value entry, size_t width)
{
    size_t before = text->length;
    value_write(text, entry);
    size_t length = text->length - before;
    text_append_character(text, ' ', width > length ? width - length : 0);
    return length;
}

/* The widest entry of each column, found by writing them and taking that back. */
static void widths_find(struct text *text, const struct value *entries, size_t size, size_t *widths)
{
    size_t before = text->length;
    for (size_t i = 0; i < size * size; i++) {
        size_t width = append_entry(text, entries[i], 0);
        widths[i % size] = width > widths[i % size] ? width : widths[i % size];
    }
    text->length = before;
}

static void append_form(struct text *text, const bcifs_form *form, const struct value *entries)
{
    size_t n = form->size, widths[MOST_SHOWN] = {0};
    text_format(text, "form of %s, %zu × %zu", form->state, n, n);
    if (n > MOST_SHOWN) {
        text_append(text, ": too large to show; --json has it\n");
        return;
    }
    text_append(text, form->exact ? "\n" : ", rounded\n");
    widths_find(text, entries, n, widths);
    for (size_t i = 0; i < n; i++) {
        text_append(text, "  [ ");
        for (size_t j = 0; j < n; j++) {
            append_entry(text, entries[i * n + j], widths[j]);
            text_append(text, " ");
        }
        text_append(text, "]\n");
    }
}

void area_text_head(struct text *text, const bcifs_area *area)
{
    text_append(text, bcifs_automaton_name(area->automaton));
    if (area->figure[0])
        text_format(text, ", figure %s", area->figure);
    text_append(text, "\n");
    if (area->placed) {
        text_append(text, "area ");
        if (area->fraction)
            text_append(text, area->fraction);
        else
            text_append_number(text, area->value.real);
        text_append(text, area->fraction ? " (exact)\n" : "\n");
    }
}

char *bcifs_area_text(const bcifs_area *area)
{
    struct text text = {0};
    area_text_head(&text, area);
    for (size_t i = 0; i < area->count; i++)
        append_form(&text, &area->told[i], area->entries[i]);
    return text_take(&text);
}
