#include "minimum_norm.h"

#include <math.h>

#include "numeric/tolerance.h"

static double dot(const double *a, const double *b, size_t size)
{
    double sum = 0;
    for (size_t i = 0; i < size; i++)
        sum += a[i] * b[i];
    return sum;
}

bool minimum_norm_solve(double *g, double *b, size_t rows, size_t unknowns, double *x)
{
    for (size_t j = 0; j < unknowns; j++)
        x[j] = 0;
    for (size_t i = 0; i < rows; i++) {
        double *row = g + i * unknowns, norm = sqrt(dot(row, row, unknowns)), given = fabs(b[i]);
        for (int pass = 0; pass < 2; pass++)
            for (size_t k = 0; k < i; k++) {
                double share = dot(row, g + k * unknowns, unknowns);
                for (size_t j = 0; j < unknowns; j++)
                    row[j] -= share * g[k * unknowns + j];
                b[i] -= share * b[k];
            }
        double rest = sqrt(dot(row, row, unknowns));
        bool dependent = rest <= TOLERANCE_RANK * norm;
        if (dependent && fabs(b[i]) > TOLERANCE_RANK * fmax(norm, given))
            return false;
        for (size_t j = 0; j < unknowns; j++)
            row[j] = dependent ? 0 : row[j] / rest;
        b[i] = dependent ? 0 : b[i] / rest;
        for (size_t j = 0; j < unknowns; j++)
            x[j] += b[i] * row[j];
    }
    return true;
}
