/* Kernel: the inner loop of all evaluation, points = P·W. */
#ifndef EVALUATE_KERNEL_H
#define EVALUATE_KERNEL_H

#include <stddef.h>

/* out[k * dimension + c] = Σ_j p[c * inner + j] w[j * stride + k], k < count.
 * p is dimension × inner, w has rows `stride` numbers apart. The sum runs in the order of j for every point, so a
 * point has the same bits whatever the block it is computed in. */
void kernel_points(const double *p, size_t dimension, size_t inner, const double *w, size_t stride, size_t count,
                   double *out);

#endif
