/* Value equations: linear systems whose coefficients are known in doubles and, where they are rational, exactly in
 * the prime field; whether a coefficient vanishes is then decided there. */
#ifndef NUMERIC_VALUE_EQUATIONS_H
#define NUMERIC_VALUE_EQUATIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/memory.h"
#include "bcifs.h"
#include "numeric/value.h"

/* Whether a coefficient counts as zero: exactly, or below TOLERANCE_REPRODUCTION times `scale`. */
bool value_is_negligible(struct value value, double scale);
/* Homogeneous linear equations in values, rows × unknowns (destroyed): exact when all entries are, otherwise
 * decided with TOLERANCE_REPRODUCTION. `free` receives how many unknowns are free, `solution` the solution
 * for which the first of these is 1, the second 2, and so on; with `inhomogeneous` set, the one for which the
 * last unknown is 1 and other free ones are 0, and `free` is 0 when there is none. */
bcifs_status equations_solve(struct value *equations, size_t rows, size_t unknowns, bool inhomogeneous,
                             struct arena *arena, struct value *solution, size_t *free);

#endif
