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

/* A vector whose part outside a span is a smaller share of it than this lies in the span. Vectors come from a few
 * products and one linear solution, so true parts are lost only when maps contract a billion times. */
#define TOLERANCE_RANK 1e-9

/* Rounding splits an eigenvalue whose Jordan block has size q by about 1e-16^(1/q) times the condition of its
 * eigenvectors: q eigenvalues within this factor of that (relative to the largest) count as one. */
#define TOLERANCE_CLUSTER 20

/* The same for a double eigenvalue: both lie within this of their mean. */
#define TOLERANCE_DOUBLE (1e-8 * TOLERANCE_CLUSTER)

/* A power of a matrix that has shrunk this much against its entries is 0: the matrix is nilpotent. */
#define TOLERANCE_NILPOTENT 1e-12

/* Moduli of different clusters closer than this are tied. Means of clusters are good to about 1e-12. */
#define TOLERANCE_TIED 1e-9

/* M - λ I has a null vector for a mean λ of a cluster when a pivot is below this share of M. */
#define TOLERANCE_NULL 1e-8

/* Unit directions that differ by less are the same: they come from null vectors. */
#define TOLERANCE_DIRECTION 1e-6

/* Bounds of a joint spectral radius that are relatively this close need no more search; a product, or an image of a
 * vertex, that exceeds the best one by less is not followed up. */
#define TOLERANCE_JOINT 1e-9

/* Bounds that are this close differ by rounding only: the radius is that of the product that attains the lower one. */
#define TOLERANCE_EXACT 1e-11

/* An image of a vertex counts as strictly inside an invariant polytope from this distance on. */
#define TOLERANCE_INSIDE 1e-8

/* q_k T = N^-k q_k holds for maps known in doubles when no pivot of the equations exceeds this share of the entries:
 * masks of 20 coefficients lose five digits to k-th differences. */
#define TOLERANCE_REPRODUCTION 1e-9

/* A Newton step that is this short against the distance to where the equation becomes singular leaves a remainder of
 * its square, which is rounding. */
#define TOLERANCE_LAST_STEP 1e-8

/* Constraints are met to this share of the numbers they are about. */
#define TOLERANCE_CONSTRAINT 1e-14

/* An area that is missed by more than this share was not reached. Rounding leaves less, also of answers that are a
 * thousand times as large as the curve was. */
#define TOLERANCE_MISSED 1e-6

/* An energy that does not see some deformation leaves it undetermined: at least this share of its own diagonal entry
 * draws each coefficient to where it was. What the energy sees is changed by no more; in directions that it does not
 * see, rounding may move things by 1e-16 over this, 1e-4 of the forces that act. */
#define TOLERANCE_UNSEEN 1e-12
/* Where that is not enough, because the energy's form has gone through many levels of filters, a larger share is taken,
 * at most this: bending energies lose up to three factors of N with each. */
#define TOLERANCE_UNSEEN_MOST 1e-6

/* Coefficients of an area that are products of filters and should cancel leave this share of what cancelled. */
#define TOLERANCE_CANCELLED 1e-14

/* Entries of a form in the coefficients of a decomposition that are this share of the largest in their row and column
 * are what rounding leaves of sums that should cancel: measured up to 3e-14, with true entries of the gallery's schemes
 * above 1e-11 for five levels. */
#define TOLERANCE_FORM 1e-13

/* A vector whose part outside a Krylov space is a smaller share is rounding: the space is complete. */
#define TOLERANCE_KRYLOV 1e-14

/* Solutions in a Krylov space are accepted when the equation's residual is this share of its right side. */
#define TOLERANCE_RESIDUAL 1e-12

/* The last point of a closed path whose coordinates are sums of as many steps as it has commands falls together with
 * the first when they differ by less than this share of the coordinates. */
#define TOLERANCE_MEETING 1e-12

/* A point of a curve is where its arc length says when it misses by less than this share of its piece's length: the
 * rule that measures is good to about that. */
#define TOLERANCE_LENGTH 1e-13

/* What smooths a least-squares problem: its share of the mean diagonal entry of the normal equations. Well above
 * TOLERANCE_SINGULAR times the size of a long gap, and low enough that a few refinements take it out again. */
#define TOLERANCE_SMOOTHING 1e-9

/* A fit ends when steps lower its error by less than this share of it, */
#define TOLERANCE_FALL 1e-5
/* or when the error is rounding: the coordinates are of size 1 and go through some hundred operations. */
#define TOLERANCE_FITTED 1e-14

#endif
