/* Deform: the deformation under an area constraint, [MR] (20), with the constraint met exactly (design, 6.5).
 *
 * Coefficients are complex numbers z = x + iy, real ones K = H + 2αI and antisymmetric ones M; B = -iM is
 * Hermitian. Of the coefficients c some are free, F, all others, X, stay where c0 has them. Among the z with
 * z_X = c0_X
 *
 *     minimize ½ z*Hz + α |z - c0|²   subject to   A(z) = ¼ z*Bz = target.
 *
 * Stationary points solve (K + λ/2 B)_FF z_F = 2α c0_F - (H + λ/2 B)_FX z_X, and the minimizer is global
 * where the matrix on the left is positive definite; there A falls strictly with λ, so that a search for the one
 * number λ finds it (constraint.h).
 *
 * K does not depend on where points are dragged: it is factored once. The problem is then reduced to an
 * antisymmetric matrix C = V^T M_FF V, V^T K_FF V = 1, made tridiagonal, so that one value of λ costs as many
 * steps as V has columns. Where many coefficients are free, V spans a block Krylov space that is grown until
 * the equation holds to rounding. */
#ifndef MULTIRES_DEFORM_H
#define MULTIRES_DEFORM_H

#include "bcifs.h"
#include "numeric/sparse.h"

struct deform_problem {
    size_t count;                /* coefficients */
    const struct sparse *energy; /* H, count × count, symmetric and positive semidefinite; NULL: 0 */
    const struct sparse *area;   /* M, count × count, antisymmetric: A = ½ X M Y^T */
    double alpha;                /* >= 0 */
    const size_t *free;          /* F, rising */
    size_t free_count;
    const double *base;      /* count × 2: c0 before the drag */
    const double *direction; /* count: during a drag c0 = base + direction·(dx, dy); NULL: 0 */
};

enum deform_reason {
    DEFORM_REACHED,
    DEFORM_NONE_FREE,   /* no coefficient is free */
    DEFORM_INSENSITIVE, /* the area does not depend on the free coefficients */
    DEFORM_BEYOND       /* the target is not reached; `area` is the nearest area that is */
};

struct deform_outcome {
    enum deform_reason reason;
    double area;         /* reached, or the nearest that can be */
    double multiplier;   /* λ */
    unsigned iterations; /* solutions for one λ */
    bool global;         /* the matrix was positive definite: no other z has less */
};

struct deform;

/* Prepares all that does not depend on (dx, dy) and target. free, base and direction must outlive the handle,
 * the matrices need not. Every coefficient is drawn to c0 by at least TOLERANCE_UNSEEN of its diagonal entry
 * in H: with α = 0 what H and A do not see stays where it is. Up to TOLERANCE_UNSEEN_MOST is taken where rounding
 * makes H indefinite. H = 0 and α = 0 is taken as α = 1, for no scale is given then. BCIFS_INPUT: H is not positive
 * semidefinite at all. */
bcifs_status deform_create(const struct deform_problem *problem, struct deform **deform);
void deform_free(struct deform *deform);
/* The minimizer for c0 = base + direction·displacement: free_count × 2 numbers to `result` (for a reason
 * other than DEFORM_REACHED: what comes nearest in area, c0 where nothing is free). BCIFS_MEMORY is the only
 * failure. */
bcifs_status deform_solve(struct deform *deform, const double displacement[2], double target, double *result,
                          struct deform_outcome *outcome);

#endif
