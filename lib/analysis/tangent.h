/* Tangent: half-tangents at the ends of arcs, and whether they agree where arcs meet.
 *
 * Near its start an arc H runs through T_0^n (H(s) - H(0)), s in [1/N, 1]. The half-tangent exists when these
 * differences settle to one direction, for every s: a question on the powers of T_0 (leading.h), restricted to the
 * space that differences of points of the arc span ([SI], "Tangente à une courbe fractale"). Directions are in
 * barycentric coordinates, so an answer holds for all control points. */
#ifndef ANALYSIS_TANGENT_H
#define ANALYSIS_TANGENT_H

#include "analysis/leading.h"
#include "automaton/states.h"

enum {
    TANGENT_MOST_STATES = 512, /* edge states taken into one analysis */
    TANGENT_MOST_POINTS = 128  /* control points of one */
};

struct half_tangent {
    const double *point;     /* H(0) or H(1): as many coordinates as the state has points */
    const double *direction; /* along the travel, coordinates sum to 0, length 1; NULL when there is none */
    double re, im;           /* the eigenvalue that decides; im >= 0 */
    size_t period;           /* of how many subdivisions it is the eigenvalue; 1 unless states alternate */
    const char *reason;      /* in words, also when the direction exists */
};

struct arc_tangents {
    size_t state;
    struct half_tangent ends[2]; /* start, end */
};

struct tangents {
    struct arc_tangents *arcs; /* every edge state that is reached */
    size_t count;
};

/* Finds the half-tangents of all edge states that are reached from those in the table; expands it. BCIFS_INPUT
 * (reported through the table's setting) when they are too many or too large. */
bcifs_status tangents_find(struct states *states, struct arena *arena, struct tangents *tangents);
/* The entry of a state, or NULL. */
const struct arc_tangents *tangents_of(const struct tangents *tangents, size_t state);

/* result = A v scaled to length 1 (rows numbers), A rows × columns; false when A v vanishes against v. */
bool direction_map(const double *a, const double *v, size_t rows, size_t columns, double *result);
/* Whether two unit directions are the same. */
bool direction_equal(const double *a, const double *b, size_t size);

#endif
