/* Analysis: what `bcifs analyze` tells of every edge state: eigenvalues, half-tangents, junctions, smoothness. */
#ifndef ANALYSIS_ANALYSIS_H
#define ANALYSIS_ANALYSIS_H

#include "analysis/smoothness.h"
#include "analysis/spectrum.h"
#include "analysis/tangent.h"
#include "automaton/figure.h"

/* Where child i ends and child i + 1 begins; directions in the parent's coordinates, NULL when there is none. */
struct junction {
    const double *left, *right;
    bool tangent_continuous;
    const char *reason; /* why not, or NULL */
};

struct edge_analysis {
    const char *name; /* with arguments: "p(1,2,1)" */
    size_t state, points, child_count;
    const struct spectrum *maps;
    const struct half_tangent *ends; /* 2 */
    struct junction *junctions;      /* child_count - 1 */
    bool tangent_continuous;         /* at every junction of every depth */
    struct smoothness smoothness;
};

/* The joints between a figure's pieces. */
struct figure_analysis {
    const char *name;
    size_t junction_count;
    const size_t (*between)[2];
    const bool *tangent_continuous;
};

/* A vertex state: the behavior common to the arcs that meet there, [IM] (3). */
struct joint_analysis {
    const char *name;
    size_t points;
    const double *limit; /* c^s */
    struct spectrum map;
};

struct bcifs_analysis {
    struct arena arena;
    const bcifs_automaton *automaton;
    struct states states;
    struct tangents tangents;
    struct edge_analysis *edges;
    size_t edge_count;
    struct joint_analysis *joints;
    size_t joint_count;
    struct figure_analysis *figures;
    size_t figure_count;
};

#endif
