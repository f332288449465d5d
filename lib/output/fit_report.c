/* The results of a fit: its control points as CSV, and all of it as JSON (design, section 5). */
#include "multires/fit.h"
#include "output/json_text.h"

char *bcifs_fit_csv(const bcifs_fit *fit)
{
    static const char *const headers[] = {"x\n", "x,y\n", "x,y,z\n"};
    struct text text = {0};
    text_append(&text, headers[fit->dimension - 1]);
    for (size_t i = 0; i < fit->count * fit->dimension; i++) {
        text_append_number(&text, fit->points[i]);
        text_append(&text, (i + 1) % fit->dimension == 0 ? "\n" : ",");
    }
    return text_take(&text);
}

static void json_member(struct text *text, const char *key, double number)
{
    json_key(text, key);
    json_number(text, number);
    text_append(text, ",\n ");
}

char *bcifs_fit_json(const bcifs_fit *fit)
{
    struct text text = {0};
    text_append(&text, "{");
    json_key(&text, "automaton");
    json_string(&text, bcifs_automaton_name(fit->automaton));
    text_append(&text, ",\n ");
    json_key(&text, "figure");
    json_string(&text, fit->figure);
    text_append(&text, ",\n ");
    json_flag(&text, "closed", fit->closed);
    text_format(&text, ",\n \"pieces\": %zu,\n ", fit->pieces);
    json_member(&text, "rms", fit->rms);
    json_member(&text, "maximum", fit->maximum);
    text_format(&text, "\"iterations\": %u,\n ", fit->iterations);
    json_key(&text, "points");
    json_matrix(&text, fit->points, fit->count, fit->dimension);
    text_append(&text, "}\n");
    return text_take(&text);
}
