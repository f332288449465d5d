#include "matrix.h"

#include <math.h>
#include <string.h>

#include "numeric/tolerance.h"

void matrix_multiply(const double *a, const double *b, size_t rows, size_t inner, size_t columns, double *c)
{
    memset(c, 0, rows * columns * sizeof *c);
    for (size_t i = 0; i < rows; i++)
        for (size_t k = 0; k < inner; k++) {
            double factor = a[i * inner + k];
            for (size_t j = 0; j < columns; j++)
                c[i * columns + j] += factor * b[k * columns + j];
        }
}

static void swap(double *a, double *b)
{
    double keep = *a;
    *a = *b;
    *b = keep;
}

/* Brings the largest entry of the remaining block to (k, k); returns its size. */
static double pivot(double *a, double *b, size_t size, size_t *order, size_t k)
{
    size_t row = k, column = k;
    for (size_t i = k; i < size; i++)
        for (size_t j = k; j < size; j++)
            if (fabs(a[i * size + j]) > fabs(a[row * size + column])) {
                row = i;
                column = j;
            }
    for (size_t j = 0; j < size && row != k; j++)
        swap(&a[row * size + j], &a[k * size + j]);
    if (row != k)
        swap(&b[row], &b[k]);
    for (size_t i = 0; i < size && column != k; i++)
        swap(&a[i * size + column], &a[i * size + k]);
    size_t keep = order[column];
    order[column] = order[k];
    order[k] = keep;
    return fabs(a[k * size + k]);
}

bool matrix_solve(double *a, double *b, size_t size, size_t *order)
{
    double largest = 0;
    for (size_t i = 0; i < size * size; i++)
        largest = fmax(largest, fabs(a[i]));
    for (size_t i = 0; i < size; i++)
        order[i] = i;
    for (size_t k = 0; k < size; k++) {
        if (!(pivot(a, b, size, order, k) > TOLERANCE_SINGULAR * largest))
            return false;
        for (size_t i = k + 1; i < size; i++) {
            double factor = a[i * size + k] / a[k * size + k];
            for (size_t j = k; j < size && factor != 0; j++)
                a[i * size + j] -= factor * a[k * size + j];
            b[i] -= factor * b[k];
        }
    }
    for (size_t k = size; k-- > 0;) {
        for (size_t j = k + 1; j < size; j++)
            b[k] -= a[k * size + j] * b[j];
        b[k] /= a[k * size + k];
    }
    /* b holds the unknowns in pivot order; follow the cycles of the permutation back. */
    for (size_t k = 0; k < size; k++)
        while (order[k] != k) {
            size_t target = order[k];
            swap(&b[k], &b[target]);
            order[k] = order[target];
            order[target] = target;
        }
    return true;
}

/* Row `last` of T - I is minus the sum of the others (columns of T sum to 1), so the sum condition replaces it. */
static void fixed_point_system(const double *t, size_t size, double *a)
{
    memcpy(a, t, size * size * sizeof *a);
    for (size_t i = 0; i < size; i++)
        a[i * size + i] -= 1;
    for (size_t j = 0; j < size; j++)
        a[(size - 1) * size + j] = 1;
}

bool matrix_fixed_point(const double *t, size_t size, double *point, double *workspace, size_t *order)
{
    double *a = workspace, *b = workspace + size * size;
    memset(point, 0, size * sizeof *point);
    /* The second round solves for the remainder of the first: r = e - A x. */
    for (int round = 0; round < 2; round++) {
        fixed_point_system(t, size, a);
        for (size_t i = 0; i < size; i++) {
            double remainder = i + 1 == size ? 1 : 0;
            for (size_t j = 0; j < size; j++)
                remainder -= a[i * size + j] * point[j];
            b[i] = remainder;
        }
        if (!matrix_solve(a, b, size, order))
            return false;
        for (size_t i = 0; i < size; i++)
            point[i] += b[i];
    }
    return true;
}
