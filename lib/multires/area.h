/* Area: the signed area of a figure's limit curve, from the forms of its pieces (design, 6.1).
 *
 * A chain of pieces that closes has the area Σ ½ X m Y^T; an open one is closed by its chord, ½ (end ×
 * start). The sum does not depend on where the origin is, since m·1 = -(H(1) - H(0)), so it is taken at a
 * control point of the figure: far from the origin no digits are lost. */
#ifndef MULTIRES_AREA_H
#define MULTIRES_AREA_H

#include "automaton/figure.h"
#include "multires/form.h"

struct bcifs_area {
    struct arena arena;
    const bcifs_automaton *automaton;
    const char *figure; /* its name, "" for a bare state */
    struct states states;
    bool placed; /* there is an area */
    struct value value;
    const char *fraction;               /* NULL: it is not known as one */
    bcifs_form *told;                   /* of the pieces' states */
    const struct value *const *entries; /* of each: the same in values */
    size_t count;
};

#endif
