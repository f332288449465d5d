/* The report of bcifs_analysis, as JSON (design, section 5) and as text for a person. */
#include <math.h>
#include <stdio.h>

#include "analysis/analysis.h"
#include "base/decimal.h"
#include "output/json_text.h"

/* ---- JSON ---------------------------------------------------------------------------------------------- */

/* A real number as a number, a complex one as an object. */
static void json_complex(struct text *text, double re, double im)
{
    if (im == 0) {
        json_number(text, re);
        return;
    }
    text_append(text, "{\"re\": ");
    json_number(text, re);
    text_append(text, ", \"im\": ");
    json_number(text, im);
    text_append(text, "}");
}

static void json_vector(struct text *text, const double *vector, size_t count)
{
    if (!vector) {
        text_append(text, "null");
        return;
    }
    text_append(text, "[");
    for (size_t i = 0; i < count; i++) {
        text_append(text, i ? ", " : "");
        json_number(text, vector[i]);
    }
    text_append(text, "]");
}

static void json_reason(struct text *text, const char *reason)
{
    json_key(text, "reason");
    if (reason)
        json_string(text, reason);
    else
        text_append(text, "null");
}

static void json_half(struct text *text, const char *key, const struct half_tangent *half, size_t points)
{
    json_key(text, key);
    text_append(text, "{\"point\": ");
    json_vector(text, half->point, points);
    text_append(text, ", \"tangent\": ");
    json_vector(text, half->direction, points);
    text_append(text, ", \"eigenvalue\": ");
    json_complex(text, half->re, half->im);
    text_format(text, ", \"period\": %zu, ", half->period);
    json_reason(text, half->reason);
    text_append(text, "}");
}

/* An eigenvector: coordinates, complex ones as objects; null where there is none. */
static void json_eigenvector(struct text *text, const struct spectrum *spectrum, size_t k)
{
    const double *vector = spectrum->vectors[k];
    text_append(text, vector ? "[" : "null");
    for (size_t i = 0; vector && i < spectrum->count; i++) {
        text_append(text, i ? ", " : "");
        json_complex(text, vector[i], spectrum->im[k] == 0 ? 0 : vector[spectrum->count + i]);
    }
    text_append(text, vector ? "]" : "");
}

/* "eigenvalues" and "eigenvectors", null for a map to a state of another size. */
static void json_spectrum(struct text *text, const struct spectrum *spectrum)
{
    text_append(text,
                spectrum->count ? "\"eigenvalues\": [" : "\"eigenvalues\": null, \"eigenvectors\": null");
    for (size_t k = 0; k < spectrum->count; k++) {
        text_append(text, k ? ", " : "");
        json_complex(text, spectrum->re[k], spectrum->im[k]);
    }
    for (size_t k = 0; k < spectrum->count; k++) {
        text_append(text, k ? ", " : "], \"eigenvectors\": [");
        json_eigenvector(text, spectrum, k);
    }
    text_append(text, spectrum->count ? "]" : "");
}

static void json_maps(struct text *text, const struct edge_analysis *edge)
{
    text_append(text, "\"maps\": [");
    for (size_t i = 0; i < edge->child_count; i++) {
        text_append(text, i ? ", {" : "{");
        json_spectrum(text, &edge->maps[i]);
        text_append(text, "}");
    }
    text_append(text, "]");
}

static void json_junctions(struct text *text, const struct edge_analysis *edge)
{
    text_append(text, "\"junctions\": [");
    for (size_t i = 0; i + 1 < edge->child_count; i++) {
        const struct junction *junction = &edge->junctions[i];
        text_format(text, "%s{\"between\": [%zu, %zu], \"left\": ", i ? ", " : "", i, i + 1);
        json_vector(text, junction->left, edge->points);
        text_append(text, ", \"right\": ");
        json_vector(text, junction->right, edge->points);
        text_append(text, ", ");
        json_flag(text, "tangent_continuous", junction->tangent_continuous);
        text_append(text, ", ");
        json_reason(text, junction->reason);
        text_append(text, "}");
    }
    text_append(text, "]");
}

static void json_smoothness(struct text *text, const struct smoothness *smoothness)
{
    text_format(text, "\"smoothness\": {\"reproduces\": %d, \"holder_lower\": ", smoothness->reproduces);
    json_number(text, smoothness->holder_lower);
    text_append(text, ", \"holder_upper\": ");
    json_number(text, smoothness->holder_upper);
    text_append(text, ", ");
    json_flag(text, "exact", smoothness->exact);
    text_format(text, ", \"continuity\": %d, ", smoothness->continuity);
    json_key(text, "certificate");
    json_string(text, smoothness->certificate);
    text_append(text, "}");
}

static void json_edge(struct text *text, const struct edge_analysis *edge)
{
    text_append(text, "{");
    json_key(text, "state");
    json_string(text, edge->name);
    text_append(text, ",\n   ");
    json_maps(text, edge);
    text_append(text, ",\n   ");
    json_half(text, "start", &edge->ends[0], edge->points);
    text_append(text, ",\n   ");
    json_half(text, "end", &edge->ends[1], edge->points);
    text_append(text, ",\n   ");
    json_junctions(text, edge);
    text_append(text, ",\n   ");
    json_flag(text, "tangent_continuous", edge->tangent_continuous);
    text_append(text, ",\n   ");
    json_smoothness(text, &edge->smoothness);
    text_append(text, "}");
}

static void json_joint(struct text *text, const struct joint_analysis *joint)
{
    text_append(text, "{");
    json_key(text, "state");
    json_string(text, joint->name);
    text_append(text, ", \"point\": ");
    json_vector(text, joint->limit, joint->points);
    text_append(text, ", ");
    json_spectrum(text, &joint->map);
    text_append(text, "}");
}

static void json_figure(struct text *text, const struct figure_analysis *figure)
{
    text_append(text, "{");
    json_key(text, "figure");
    json_string(text, figure->name);
    text_append(text, ", \"junctions\": [");
    for (size_t i = 0; i < figure->junction_count; i++) {
        text_format(text, "%s{\"between\": [%zu, %zu], ", i ? ", " : "", figure->between[i][0],
                    figure->between[i][1]);
        json_flag(text, "tangent_continuous", figure->tangent_continuous[i]);
        text_append(text, "}");
    }
    text_append(text, "]}");
}

char *bcifs_analysis_json(const bcifs_analysis *analysis)
{
    struct text text = {0};
    text_append(&text, "{");
    json_key(&text, "automaton");
    json_string(&text, bcifs_automaton_name(analysis->automaton));
    text_append(&text, ",\n \"edges\": [");
    for (size_t i = 0; i < analysis->edge_count; i++) {
        text_append(&text, i ? ",\n  " : "\n  ");
        json_edge(&text, &analysis->edges[i]);
    }
    text_append(&text, "],\n \"joints\": [");
    for (size_t i = 0; i < analysis->joint_count; i++) {
        text_append(&text, i ? ",\n  " : "\n  ");
        json_joint(&text, &analysis->joints[i]);
    }
    text_append(&text, "],\n \"figures\": [");
    for (size_t i = 0; i < analysis->figure_count; i++) {
        text_append(&text, i ? ",\n  " : "\n  ");
        json_figure(&text, &analysis->figures[i]);
    }
    text_append(&text, "]}\n");
    return text_take(&text);
}

/* ---- Text ---------------------------------------------------------------------------------------------- */

enum { DIGITS = 6 };

static void append_digits(struct text *text, double number)
{
    char digits[DECIMAL_LONGEST];
    if (isfinite(number))
        text_append_bytes(text, digits, decimal_print_digits(digits, number, DIGITS));
    else
        text_append(text, "unknown");
}

/* Coordinates that are rounding only are shown as 0. */
static void append_vector(struct text *text, const double *vector, size_t count)
{
    text_append(text, "(");
    for (size_t i = 0; i < count; i++) {
        text_append(text, i ? ", " : "");
        append_digits(text, fabs(vector[i]) < 1e-12 ? 0 : vector[i]);
    }
    text_append(text, ")");
}

static void append_complex(struct text *text, double re, double im)
{
    append_digits(text, re);
    if (im != 0) {
        text_append(text, im > 0 ? "+" : "-");
        append_digits(text, fabs(im));
        text_append(text, "i");
    }
}

/* Real eigenvectors are shown beside their eigenvalues. */
static void append_spectrum(struct text *text, const char *name, const struct spectrum *spectrum)
{
    text_format(text, "  eigenvalues of %s: ", name);
    for (size_t i = 0; i < spectrum->count; i++) {
        text_append(text, i ? ", " : "");
        append_complex(text, spectrum->re[i], spectrum->im[i]);
        if (spectrum->im[i] == 0 && spectrum->vectors[i]) {
            text_append(text, " ");
            append_vector(text, spectrum->vectors[i], spectrum->count);
        }
    }
    text_append(text, spectrum->count ? "\n" : "none, the child is in a state of another size\n");
}

static void append_joint(struct text *text, const struct joint_analysis *joint)
{
    text_format(text, "vertex %s: limit point ", joint->name);
    append_vector(text, joint->limit, joint->points);
    text_append(text, "\n");
    append_spectrum(text, "T", &joint->map);
}

static void append_half(struct text *text, const char *name, const struct half_tangent *half, size_t points)
{
    text_format(text, "  %s at ", name);
    append_vector(text, half->point, points);
    if (half->direction) {
        text_append(text, ", tangent ");
        append_vector(text, half->direction, points);
    } else {
        text_append(text, ", no half-tangent");
    }
    text_format(text, "\n    %s\n", half->reason);
}

static void append_junctions(struct text *text, const struct edge_analysis *edge)
{
    for (size_t i = 0; i + 1 < edge->child_count; i++) {
        text_format(text, "  between children %zu and %zu: %s", i, i + 1,
                    edge->junctions[i].tangent_continuous ? "tangent continuous" : "not tangent continuous");
        if (edge->junctions[i].reason)
            text_format(text, ": %s", edge->junctions[i].reason);
        text_append(text, "\n");
    }
    text_format(text, "  %s\n",
                edge->tangent_continuous ? "tangent continuous at the junctions of every depth"
                                         : "not tangent continuous at the junctions of every depth");
}

static void append_smoothness(struct text *text, const struct smoothness *smoothness)
{
    text_format(text, "  reproduces polynomials of degree %d; Hölder exponent ", smoothness->reproduces);
    append_digits(text, smoothness->holder_lower);
    if (!smoothness->exact) {
        text_append(text, " to ");
        append_digits(text, smoothness->holder_upper);
    }
    text_append(text, smoothness->exact ? ", exactly; " : "; ");
    if (smoothness->continuity >= 0)
        text_format(text, "certified C^%d\n", smoothness->continuity);
    else
        text_append(text, "no continuity certified\n");
    text_format(text, "    %s\n", smoothness->certificate);
}

static void append_figure(struct text *text, const struct figure_analysis *figure)
{
    size_t broken = 0;
    for (size_t i = 0; i < figure->junction_count; i++)
        broken += !figure->tangent_continuous[i];
    if (figure->junction_count == 0)
        return;
    text_format(text, "figure %s: ", figure->name);
    if (broken == 0)
        text_format(text, "tangent continuous at all %zu joints of its pieces\n", figure->junction_count);
    else
        text_format(text, "not tangent continuous at %zu of %zu joints of its pieces\n", broken,
                    figure->junction_count);
}

char *bcifs_analysis_text(const bcifs_analysis *analysis)
{
    struct text text = {0};
    text_format(&text, "%s\n", bcifs_automaton_name(analysis->automaton));
    for (size_t i = 0; i < analysis->edge_count; i++) {
        const struct edge_analysis *edge = &analysis->edges[i];
        text_format(&text, "edge %s\n", edge->name);
        for (size_t k = 0; k < edge->child_count; k++) {
            char name[24];
            snprintf(name, sizeof name, "T%zu", k);
            append_spectrum(&text, name, &edge->maps[k]);
        }
        append_half(&text, "start", &edge->ends[0], edge->points);
        append_half(&text, "end", &edge->ends[1], edge->points);
        append_junctions(&text, edge);
        append_smoothness(&text, &edge->smoothness);
    }
    for (size_t i = 0; i < analysis->joint_count; i++)
        append_joint(&text, &analysis->joints[i]);
    for (size_t i = 0; i < analysis->figure_count; i++)
        append_figure(&text, &analysis->figures[i]);
    if (analysis->edge_count == 0)
        text_append(&text, "no edge state to analyze\n");
    return text_take(&text);
}
