/* Radius: bounds of the joint spectral radius of an automaton's linear parts.
 *
 * The linear part of T_i acts on differences of points, in the basis of differences of consecutive control
 * points. Over all words of n maps that follow each other, ρ lies between the largest spectral radius of a
 * cyclic product and the largest norm of any product, both to the power 1/n. The system is contractive when ρ
 * < 1. The bounds are certified (numeric/joint_radius.h): rounding is accounted for. */
#ifndef AUTOMATON_RADIUS_H
#define AUTOMATON_RADIUS_H

#include "automaton/states.h"

struct radius {
    double lower, upper;
    const char *product; /* the word that attains `lower`, "arc: 0 1"; "" when there is none */
    const struct source *source;
    source_place place;      /* of the first map of that word */
    const char *certificate; /* what proves `upper`, in words */
};

/* Bounds for all states that are reached from those in the table; expands it. */
bcifs_status radius_bound(struct states *states, struct arena *arena, struct radius *radius);

#endif
