/* Tolerance: every threshold of a numerical decision, in one place. All are relative to the data. */
#ifndef NUMERIC_TOLERANCE_H
#define NUMERIC_TOLERANCE_H

/* Two numbers that an equation says are equal and that are known in doubles only (roots, decimals of 15 digits and
 * more, which carry relative errors of 1e-15 that a product of matrices multiplies by its inner size). */
#define TOLERANCE_EQUATION 1e-12

/* A pivot below this share of the matrix's largest entry makes a linear system singular. */
#define TOLERANCE_SINGULAR 1e-13

/* A product of maps whose columns differ by less than this has reached its limit point. */
#define TOLERANCE_LIMIT 1e-15

/* A spectral radius is taken to reach 1 from here on; rounding leaves an isometry just below or above. */
#define TOLERANCE_RADIUS 1e-9

#endif
