/* Editor level: what an editing session knows of one level: the bank that leads to it, and the forms of area and
 * energy in its coefficients. All of it stays as it is while points are dragged. */
#ifndef MULTIRES_EDITOR_LEVEL_H
#define MULTIRES_EDITOR_LEVEL_H

#include "multires/levels_form.h"

struct editor_level {
    struct arena arena;
    struct ladder ladder;
    struct bank bank;
    bcifs_energy energy;           /* in use */
    const char *area_reason;       /* why there is no area, or NULL */
    const char *energy_reason;     /* why it is not the bending energy that was asked for, or NULL */
    struct sparse fine_area, fine_energy; /* M^n and H^n */
    struct sparse area, energy_form;      /* M^L and H^L; rows 0: none */
};

bcifs_status editor_level_create(const bcifs_figure *figure, unsigned refine, unsigned coarsen, bcifs_energy energy,
                                 struct report *report, struct editor_level **level);
void editor_level_free(struct editor_level *level);

/* ½ X M Y^T, and ½ X H X^T + ½ Y H Y^T, of planar points (a form's rows × 2 numbers). */
double form_area(const struct sparse *area, const double *points);
double form_energy(const struct sparse *energy, const double *points);

#endif
