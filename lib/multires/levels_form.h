/* Forms of levels: the area (or energy) of a whole curve as a form in its control points, and in the coefficients of its
 * decomposition, [MR] section 3.
 *
 * The mother matrix M^n is assembled from the forms of the cells of the finest level. The matrices of coarser levels
 * follow from it by the filters (14)-(18): I(φ^{k-1}, φ^{k-1}) = P^T I(φ^k, φ^k) P and so on; nothing is integrated again,
 * and products are of sparse matrices, so that cost and storage follow the entries that are not zero. */
#ifndef MULTIRES_LEVELS_FORM_H
#define MULTIRES_LEVELS_FORM_H

#include "multires/bank.h"
#include "multires/form.h"

/* The mother matrix of the area on a rung: ½ X M Y^T is the area that the limit curve encloses, open chains being closed
 * by their chords. `reason` is set, and no matrix made, where a state has no area form. */
bcifs_status area_assemble(struct ladder *ladder, unsigned rung, struct arena *arena, struct sparse *mother,
                           const char **reason);
/* The matrix H^n: ½ X H X^T + ½ Y H Y^T is ∫|c''|², each cell of the rung having unit parameter length. */
bcifs_status energy_assemble(struct ladder *ladder, unsigned rung, struct arena *arena, struct sparse *mother,
                             const char **reason);
/* The same for the sum of squared second differences of the polygons. */
bcifs_status differences_assemble(const struct ladder *ladder, unsigned rung, struct arena *arena,
                                  struct sparse *mother);

/* M^L from M^n (or H^L from H^n; `sign` is -1 for antisymmetric ones, 1 for symmetric ones), from the bank's top rung to
 * its bottom; rows and columns in the order of the coefficients. */
bcifs_status form_descend(const struct bank *bank, const struct sparse *mother, double sign, struct arena *arena,
                          struct sparse *form);

#endif
