#include "kernel.h"

enum { BLOCK = 32 }; /* points at a time: the sums stay in registers and the first-level cache */

/* One coordinate of a full block; the constant length lets the compiler use vectors. */
static void block_sum(const double *p, size_t inner, const double *w, size_t stride, double *sum)
{
    for (size_t k = 0; k < BLOCK; k++)
        sum[k] = p[0] * w[k];
    for (size_t j = 1; j < inner; j++)
        for (size_t k = 0; k < BLOCK; k++)
            sum[k] += p[j] * w[j * stride + k];
}

static void block_points(const double *p, size_t dimension, size_t inner, const double *w, size_t stride,
                         double *out)
{
    double sum[2][BLOCK];
    if (dimension == 2) {
        block_sum(p, inner, w, stride, sum[0]);
        block_sum(p + inner, inner, w, stride, sum[1]);
        for (size_t k = 0; k < BLOCK; k++) {
            out[2 * k] = sum[0][k];
            out[2 * k + 1] = sum[1][k];
        }
        return;
    }
    for (size_t c = 0; c < dimension; c++) {
        block_sum(p + c * inner, inner, w, stride, sum[0]);
        for (size_t k = 0; k < BLOCK; k++)
            out[k * dimension + c] = sum[0][k];
    }
}

void kernel_points(const double *p, size_t dimension, size_t inner, const double *w, size_t stride, size_t count,
                   double *out)
{
    size_t k = 0;
    for (; k + BLOCK <= count; k += BLOCK)
        block_points(p, dimension, inner, w + k, stride, out + k * dimension);
    for (; k < count; k++)
        for (size_t c = 0; c < dimension; c++) {
            double sum = p[c * inner] * w[k];
            for (size_t j = 1; j < inner; j++)
                sum += p[c * inner + j] * w[j * stride + k];
            out[k * dimension + c] = sum;
        }
}
