/* Least squares: the control points whose curve comes nearest to given points at given positions.
 *
 * The sum  Σ_j w_j |M_j (B(u_j) x - q_j)|²  is minimized, M_j = I - (1 - √μ) τ_j τ_j^T: a miss along the
 * curve's direction τ_j counts μ times. With μ = 1 (or without directions) it is the distance to the point at
 * u_j. With a small μ points may slide along the curve, which is what moves their parameters in a few steps
 * (tangent distance; Wang, Pottmann, Liu, "Fitting B-spline curves to point clouds by curvature-based squared
 * distance minimization", 2006).
 *
 * Normal equations by sparse Cholesky factorization, with TOLERANCE_SMOOTHING of the sum of squared
 * differences of consecutive control points of the step added, so that functions that no point sees, or that
 * depend on each other, have a solution; steps of refinement take its influence out again where the points
 * decide. */
#ifndef MULTIRES_LEAST_SQUARES_H
#define MULTIRES_LEAST_SQUARES_H

#include "multires/blending.h"
#include "multires/target.h"

struct least_squares {
    const struct blending *blending;
    const struct target *target;
    const double *positions;  /* target->count */
    const double *directions; /* target->count × dimension, of length 1 or 0; NULL: none */
    double slack;             /* μ */
};

/* x (functions × dimension) is where to start, and receives the solution. */
bcifs_status least_squares_solve(const struct least_squares *problem, double *x, struct report *report);

#endif
