/* Area matrix: the form of the area in the coefficients of a decomposition, M^L of [MR] (13).
 *
 * It is taken down from the mother matrix M^n by levels_form.h, made antisymmetric to the last bit, and rid of the
 * entries that are rounding: wavelets are orthogonal to much, and what should cancel leaves 1e-16 of what it was. Where
 * the coefficients of each level begin is kept, for the blocks A, B and C of figure 3. */
#ifndef MULTIRES_AREA_MATRIX_H
#define MULTIRES_AREA_MATRIX_H

#include "multires/area.h"
#include "numeric/sparse.h"

struct bcifs_area_matrix {
    struct arena arena;
    bcifs_area *area;       /* of the figure, for reports */
    unsigned coarsen;       /* J */
    unsigned level, finest; /* L and n, the coarsest rung being level 0 */
    size_t *starts;         /* coarsen + 2: of x^L, d^L, …, d^(n-1), and the size */
    struct sparse form;
};

#endif
