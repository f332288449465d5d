/* The report of bcifs_check, as JSON (design, section 5) and as text for a person. */
#include "automaton/proof.h"
#include "base/decimal.h"
#include "output/json_text.h"

#include <math.h>
#include <string.h>

static const char *const kind_names[] = {
    [CELL_VERTEX] = "vertex", [CELL_EDGE] = "edge", [CELL_FACE] = "face", [CELL_CELL] = "cell"};

static const char *const equation_names[] = {[BCIFS_BARYCENTRIC] = "barycentric",
                                             [BCIFS_INCIDENCE] = "incidence",
                                             [BCIFS_ADJACENCY] = "adjacency"};

/* ---- JSON ---------------------------------------------------------------------------------------------- */

static void json_state(struct text *text, const struct state_summary *state)
{
    text_append(text, "{");
    json_key(text, "name");
    json_string(text, state->name);
    text_append(text, ", ");
    json_key(text, "kind");
    json_string(text, kind_names[state->kind]);
    text_format(text, ", \"points\": %zu, ", state->points);
    json_key(text, "children");
    json_strings(text, state->children, state->child_count);
    text_append(text, ", \"boundaries\": {");
    for (size_t i = 0; i < state->boundary_count; i++) {
        text_append(text, i ? ", " : "");
        json_key(text, state->boundaries[i]);
        json_string(text, state->boundary_states[i]);
    }
    text_append(text, "}}");
}

static void json_equation(struct text *text, const bcifs_equation *equation)
{
    text_append(text, "{");
    json_key(text, "state");
    json_string(text, equation->state);
    text_append(text, ", ");
    json_key(text, "kind");
    json_string(text, equation_names[equation->kind]);
    text_append(text, ", ");
    json_key(text, "equation");
    json_string(text, equation->text);
    text_append(text, ", ");
    json_flag(text, "exact", equation->exact);
    text_append(text, ", ");
    json_flag(text, "holds", equation->holds);
    text_append(text, ", \"residual\": ");
    json_number(text, equation->residual);
    text_append(text, ", ");
    json_key(text, "file");
    json_string(text, equation->file);
    text_format(text, ", \"line\": %u", equation->line);
    if (equation->reason) {
        text_append(text, ", ");
        json_key(text, "reason");
        json_string(text, equation->reason);
    }
    if (equation->left) {
        text_append(text, ", \"left\": ");
        json_matrix(text, equation->left, (size_t)equation->rows, (size_t)equation->columns);
        text_append(text, ", \"right\": ");
        json_matrix(text, equation->right, (size_t)equation->rows, (size_t)equation->columns);
        text_format(text, ", \"row\": %d, \"column\": %d, ", equation->row, equation->column);
        json_key(text, "at");
        json_string(text, equation->at);
    }
    text_append(text, "}");
}

char *bcifs_check_json(const bcifs_check *check)
{
    const bcifs_automaton *automaton = check->automaton;
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
    text_append(&text, "},\n \"states\": [");
    for (size_t i = 0; i < check->state_count; i++) {
        text_append(&text, i ? ",\n  " : "\n  ");
        json_state(&text, &check->states[i]);
    }
    text_append(&text, "],\n \"equations\": [");
    for (size_t i = 0; i < check->count; i++) {
        text_append(&text, i ? ",\n  " : "\n  ");
        json_equation(&text, &check->equations[i]);
    }
    text_append(&text, "],\n \"contraction\": {\"lower\": ");
    json_number(&text, check->radius.lower);
    text_append(&text, ", \"upper\": ");
    json_number(&text, check->radius.upper);
    text_append(&text, ", ");
    json_key(&text, "product");
    json_string(&text, check->radius.product);
    text_append(&text, "},\n ");
    json_flag(&text, "valid", check->valid);
    text_append(&text, "}\n");
    return text_take(&text);
}

/* ---- Text ---------------------------------------------------------------------------------------------- */

enum { EQUATION_WIDTH = 34, MOST_SHOWN = 10 /* rows and columns of a matrix */, DIGITS = 8 };

static void append_digits(struct text *text, double number, size_t width)
{
    char digits[DECIMAL_LONGEST];
    size_t length = decimal_print_digits(digits, number, DIGITS);
    text_append_bytes(text, digits, length);
    if (length < width)
        text_append_character(text, ' ', width - length);
}

/* UTF-8 characters, so that columns line up. */
static size_t characters(const char *string)
{
    size_t count = 0;
    for (; *string; string++)
        count += ((unsigned char)*string & 0xc0) != 0x80;
    return count;
}

static void append_padded(struct text *text, const char *string, size_t width)
{
    size_t length = characters(string);
    text_append(text, string);
    text_append_character(text, ' ', length < width ? width - length : 1);
}

static size_t widest(const double *matrix, int count)
{
    size_t width = 1;
    char digits[DECIMAL_LONGEST];
    for (int i = 0; i < count; i++) {
        size_t length = decimal_print_digits(digits, matrix[i], DIGITS);
        width = length > width ? length : width;
    }
    return width;
}

static void append_row(struct text *text, const bcifs_equation *equation, const double *matrix, int row,
                       size_t width)
{
    text_append(text, "[ ");
    for (int j = 0; j < equation->columns && j < MOST_SHOWN; j++) {
        append_digits(text, matrix[row * equation->columns + j], width);
        text_append(text, " ");
    }
    text_append(text, equation->columns > MOST_SHOWN ? "… ]" : "]");
}

/* Both sides beside each other, and the entry that differs most. */
static void append_sides(struct text *text, const bcifs_equation *equation)
{
    int count = equation->rows * equation->columns;
    size_t left = widest(equation->left, count), right = widest(equation->right, count);
    for (int i = 0; i < equation->rows && i < MOST_SHOWN; i++) {
        text_append(text, "      ");
        append_row(text, equation, equation->left, i, left);
        text_append(text, i == 0 ? "  ≠  " : "     ");
        append_row(text, equation, equation->right, i, right);
        text_append(text, "\n");
    }
    if (equation->rows > MOST_SHOWN)
        text_append(text, "      …\n");
    text_format(text, "      they differ most in row %d, column %d (from 0): ", equation->row, equation->column);
    size_t entry = (size_t)(equation->row * equation->columns + equation->column);
    append_digits(text, equation->left[entry], 0);
    text_append(text, " and ");
    append_digits(text, equation->right[entry], 0);
    text_append(text, "\n");
}

static void append_equation(struct text *text, const bcifs_equation *equation)
{
    text_append(text, "  ");
    append_padded(text, equation->text, EQUATION_WIDTH);
    if (equation->holds && equation->exact) {
        text_append(text, "proved\n");
        return;
    }
    text_append(text, equation->holds ? "holds numerically, residual " : "FAILS");
    if (equation->holds)
        append_digits(text, equation->residual, 0);
    else
        text_format(text, " (%s:%u)%s%s", equation->file, equation->line,
                    equation->left && equation->at[0] ? ", seen at " : "", equation->left ? equation->at : "");
    text_append(text, "\n");
    if (equation->reason)
        text_format(text, "      %s\n", equation->reason);
    if (equation->left)
        append_sides(text, equation);
}

static void append_state(struct text *text, const bcifs_check *check, const struct state_summary *state)
{
    text_format(text, "%s %s: %zu control point%s, %zu map%s\n", kind_names[state->kind], state->name,
                state->points, state->points == 1 ? "" : "s", state->child_count,
                state->child_count == 1 ? "" : "s");
    for (size_t i = 0; i < check->count; i++)
        if (strcmp(check->equations[i].state, state->name) == 0)
            append_equation(text, &check->equations[i]);
}

static void append_contraction(struct text *text, const struct radius *radius)
{
    text_append(text, "joint spectral radius of the linear parts: ");
    append_digits(text, radius->lower, 0);
    text_append(text, " (");
    text_append(text, radius->product);
    text_append(text, ") to ");
    if (isfinite(radius->upper))
        append_digits(text, radius->upper, 0);
    else
        text_append(text, "unknown");
    text_append(text, radius->upper < 1    ? ": contractive, certified\n"
                      : radius->lower >= 1 ? ": not contractive\n"
                                           : ": not decided\n");
}

char *bcifs_check_text(const bcifs_check *check)
{
    struct text text = {0};
    size_t failing = 0, numerical = 0;
    const char *title = bcifs_automaton_title(check->automaton);
    text_format(&text, "%s%s%s\n", bcifs_automaton_name(check->automaton), title[0] ? ": " : "", title);
    for (size_t i = 0; i < check->state_count; i++)
        append_state(&text, check, &check->states[i]);
    append_contraction(&text, &check->radius);
    for (size_t i = 0; i < check->count; i++) {
        failing += !check->equations[i].holds;
        numerical += !check->equations[i].exact;
    }
    if (failing > 0)
        text_format(&text, "not valid: %zu of %zu equations fail\n", failing, check->count);
    else if (numerical > 0)
        text_format(&text, "valid: all %zu equations hold, %zu of them numerically\n", check->count, numerical);
    else
        text_format(&text, "valid: all %zu equations are proved\n", check->count);
    return text_take(&text);
}
