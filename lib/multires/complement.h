/* Complement: local details for a refinement matrix P: vectors q on few consecutive fine points with P^T q = 0.
 *
 * Going along the fine points, row e of P either brings something new or depends on the rows just before it. Each
 * dependent row gives one vector, that ends at e and reaches back as little as possible. There is one for every
 * fine point that the coarse ones do not account for, so that together they span all that P cannot reach; they
 * are orthogonal to it, hence the least-squares ("semi-orthogonal") wavelets of the curve. */
#ifndef MULTIRES_COMPLEMENT_H
#define MULTIRES_COMPLEMENT_H

#include "bcifs.h"
#include "numeric/stencil.h"

/* A row of P by its index; before the first and behind the last row of a closed curve it goes on periodically: row
 * e - rows has the columns of row e, less the width. False where an open curve has no row. */
struct stencil_place {
    ptrdiff_t column;
    size_t length;
    const double *weights;
};
bool refinement_row(const struct stencil *refinement, bool closed, ptrdiff_t row, struct stencil_place *place);

/* Q^T, (rows - width) × rows of P: one block for each block of P. `found` is false when there are not as many vectors,
 * because the columns of P depend on each other. The only failure is BCIFS_MEMORY. */
bcifs_status complement_find(const struct stencil *refinement, bool closed, struct arena *arena,
                             struct stencil *details, bool *found);

#endif
