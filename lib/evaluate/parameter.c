#include "parameter.h"

#include <math.h>

uint64_t parameter_from_double(double t)
{
    return (uint64_t)ldexp(t, 62);
}

size_t parameter_digit(uint64_t *fraction, size_t count)
{
    const uint64_t half = (UINT64_C(1) << 31) - 1;
    uint64_t low = (*fraction & half) * count;
    uint64_t high = (*fraction >> 31) * count + (low >> 31);
    *fraction = (high & half) << 31 | (low & half);
    return (size_t)(high >> 31);
}
