#include "subspace.h"

#include <math.h>
#include <string.h>

#include "numeric/tolerance.h"

static double dot(const double *a, const double *b, size_t size)
{
    double sum = 0;
    for (size_t i = 0; i < size; i++)
        sum += a[i] * b[i];
    return sum;
}

bool subspace_add(double *basis, size_t *count, size_t size, double *vector)
{
    double before = sqrt(dot(vector, vector, size));
    if (before == 0 || *count == size)
        return false;
    /* Gram-Schmidt twice is enough for orthogonality to rounding (Kahan, Parlett). */
    for (int round = 0; round < 2; round++)
        for (size_t k = 0; k < *count; k++) {
            double share = dot(basis + k * size, vector, size);
            for (size_t i = 0; i < size; i++)
                vector[i] -= share * basis[k * size + i];
        }
    double after = sqrt(dot(vector, vector, size));
    if (after <= TOLERANCE_RANK * before)
        return false;
    for (size_t i = 0; i < size; i++)
        basis[*count * size + i] = vector[i] / after;
    ++*count;
    return true;
}

static void swap_columns(double *a, size_t rows, size_t columns, size_t p, size_t q)
{
    for (size_t i = 0; i < rows && p != q; i++) {
        double keep = a[i * columns + p];
        a[i * columns + p] = a[i * columns + q];
        a[i * columns + q] = keep;
    }
}

static void swap_rows(double *a, size_t columns, size_t p, size_t q)
{
    for (size_t j = 0; j < columns && p != q; j++) {
        double keep = a[p * columns + j];
        a[p * columns + j] = a[q * columns + j];
        a[q * columns + j] = keep;
    }
}

/* Gauss-Jordan elimination with full pivoting; returns the rank. The leading block becomes the identity. */
static size_t eliminate(double *a, size_t rows, size_t columns, double tolerance, size_t *order)
{
    size_t rank = 0;
    for (size_t j = 0; j < columns; j++)
        order[j] = j;
    for (; rank < rows && rank < columns; rank++) {
        size_t row = rank, column = rank;
        for (size_t i = rank; i < rows; i++)
            for (size_t j = rank; j < columns; j++)
                if (fabs(a[i * columns + j]) > fabs(a[row * columns + column])) {
                    row = i;
                    column = j;
                }
        double pivot = a[row * columns + column];
        if (!(fabs(pivot) > tolerance))
            break;
        swap_rows(a, columns, row, rank);
        swap_columns(a, rows, columns, column, rank);
        size_t keep = order[column];
        order[column] = order[rank];
        order[rank] = keep;
        for (size_t j = rank; j < columns; j++)
            a[rank * columns + j] /= pivot;
        for (size_t i = 0; i < rows; i++) {
            double factor = a[i * columns + rank];
            for (size_t j = rank; j < columns && i != rank; j++)
                a[i * columns + j] -= factor * a[rank * columns + j];
        }
    }
    return rank;
}

size_t null_space(double *a, size_t rows, size_t columns, double tolerance, double *null, size_t *order,
                  double *workspace)
{
    size_t rank = eliminate(a, rows, columns, tolerance, order), count = 0;
    for (size_t free = rank; free < columns; free++) {
        memset(workspace, 0, columns * sizeof *workspace);
        workspace[order[free]] = 1;
        for (size_t i = 0; i < rank; i++)
            workspace[order[i]] = -a[i * columns + free];
        subspace_add(null, &count, columns, workspace);
    }
    return count;
}
