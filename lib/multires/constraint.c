#include "constraint.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "numeric/tolerance.h"

/* The workspace: q = Bx + b, and p = (K + λ/2 B)^-1 q, that is -2 dx/dλ. The third part serves the null
 * vector. */
static double *gradient_of(const struct constraint *c)
{
    return c->workspace;
}

static double *change_of(const struct constraint *c)
{
    return c->workspace + 2 * c->pencil.size;
}

static double *null_of(const struct constraint *c)
{
    return c->workspace + 4 * c->pencil.size;
}

/* x(λ), q and the value; `noise`: what rounding leaves uncertain in the value. */
static enum sparse_outcome evaluate(struct constraint *c, double lambda, double *noise)
{
    const struct pencil *pencil = &c->pencil;
    double *q = gradient_of(c), value = 0, terms = 0;
    enum sparse_outcome outcome = pencil->factor(pencil->context, lambda / 2);
    c->iterations++;
    if (outcome != SPARSE_DONE)
        return outcome;
    c->lambda = lambda;
    for (size_t k = 0; k < 2 * pencil->size; k++)
        c->x[k] = -(c->h[k] + lambda / 2 * c->b[k]);
    pencil->solve(pencil->context, c->x);
    pencil->apply(pencil->context, c->x, q);
    for (size_t k = 0; k < 2 * pencil->size; k++) {
        double term = c->x[k] * (q[k] + 2 * c->b[k]);
        q[k] += c->b[k];
        value += term;
        terms += fabs(term);
    }
    c->value = value / 4;
    *noise = DBL_EPSILON * terms;
    return SPARSE_DONE;
}

/* d value/dλ = -¼ q*p, and d²/dλ² = ⅜ p*Bp: for q' = -½ Bp and p' = -(K + λ/2 B)^-1 Bp. Halley's step to the
 * goal, -f/f' / (1 - f f''/(2 f'^2)): that share is ¾ near the singular end, where f is inverse to a square.
 */
static double step_to(struct constraint *c, double goal)
{
    const struct pencil *pencil = &c->pencil;
    double *q = gradient_of(c), *p = change_of(c), *image = null_of(c), slope = 0, curvature = 0;
    memcpy(p, q, 2 * pencil->size * sizeof *p);
    pencil->solve(pencil->context, p);
    pencil->apply(pencil->context, p, image);
    for (size_t k = 0; k < 2 * pencil->size; k++) {
        slope += q[k] * p[k];
        curvature += p[k] * image[k];
    }
    double newton = 4 * (c->value - goal) / slope, share = 0.75 * newton * curvature / slope;
    return newton / (share < 0.75 ? 1 - share : 0.25);
}

/* ---- The null vector ----------------------------------------------------------------------------------- */

static void normalize(double *v, size_t count)
{
    double largest = 0, square = 0;
    for (size_t k = 0; k < count; k++)
        largest = fmax(largest, fabs(v[k]));
    for (size_t k = 0; k < count && largest > 0; k++) {
        v[k] /= largest;
        square += v[k] * v[k];
    }
    for (size_t k = 0; k < count && largest > 0; k++)
        v[k] /= sqrt(square);
}

/* Inverse iteration, from a vector that is special in no way. At the end of the interval one step is enough.
 */
static void find_null(struct constraint *c, double *v)
{
    size_t count = 2 * c->pencil.size;
    uint32_t random = 1;
    for (size_t k = 0; k < count; k++) {
        random = random * 1664525 + 1013904223; /* Numerical Recipes' generator */
        v[k] = (double)(random >> 8) / 8388608.0 - 1;
    }
    for (int round = 0; round < 3; round++) {
        normalize(v, count);
        c->pencil.solve(c->pencil.context, v);
    }
    normalize(v, count);
}

/* x + tφv has the value f + t/2 |v*q| + t²/4 v*Bv + goal, with φ = v*q/|v*q|: t is the root that is nearer.
 */
static enum constraint_outcome complete(struct constraint *c, double goal)
{
    double *q = gradient_of(c), *image = change_of(c), *v = null_of(c);
    double real = 0, imaginary = 0, square = 0, missing = c->value - goal;
    find_null(c, v);
    c->pencil.apply(c->pencil.context, v, image);
    for (size_t k = 0; k < c->pencil.size; k++) {
        real += v[2 * k] * q[2 * k] + v[2 * k + 1] * q[2 * k + 1];
        imaginary += v[2 * k] * q[2 * k + 1] - v[2 * k + 1] * q[2 * k];
        square += v[2 * k] * image[2 * k] + v[2 * k + 1] * image[2 * k + 1];
    }
    double share = hypot(real, imaginary), discriminant = share * share / 4 - square * missing;
    double t = -2 * missing / (share / 2 + sqrt(discriminant));
    if (!isfinite(t))
        return CONSTRAINT_BEYOND;
    double cosine = share > 0 ? real / share : 1, sine = share > 0 ? imaginary / share : 0;
    for (size_t k = 0; k < c->pencil.size; k++) {
        c->x[2 * k] += t * (cosine * v[2 * k] - sine * v[2 * k + 1]);
        c->x[2 * k + 1] += t * (cosine * v[2 * k + 1] + sine * v[2 * k]);
    }
    c->value = goal;
    return CONSTRAINT_COMPLETED;
}

/* The bracket has closed without a solution: λ is at the singular end. `last`: the last λ known to be inside.
 */
static enum constraint_outcome finish_singular(struct constraint *c, double last, double goal)
{
    double noise;
    enum sparse_outcome outcome = evaluate(c, last, &noise);
    if (outcome != SPARSE_DONE)
        return outcome == SPARSE_MEMORY ? CONSTRAINT_MEMORY : CONSTRAINT_BEYOND;
    return complete(c, goal);
}

/* ---- Steps --------------------------------------------------------------------------------------------- */

/* A step so short against the way to the singular end that its square vanishes: x moves along its tangent. */
static void step_last(struct constraint *c, double step, double goal)
{
    const double *p = change_of(c);
    for (size_t k = 0; k < 2 * c->pencil.size; k++)
        c->x[k] -= step / 2 * p[k];
    c->lambda += step;
    c->value = goal;
}

/* The bracket: the value is above the goal at `low`, below it at `high`, or the matrix not definite there. */
enum constraint_outcome constraint_meet(struct constraint *c, double goal, double tolerance)
{
    enum { MOST = 400 }; /* bisection from any bracket ends before */
    double low = -c->bound, high = c->bound, inside = 0, noise;
    double lambda = fabs(c->lambda) < c->bound ? c->lambda : 0;
    for (int round = 0; round < MOST; round++) {
        enum sparse_outcome outcome = evaluate(c, lambda, &noise);
        if (outcome == SPARSE_MEMORY)
            return CONSTRAINT_MEMORY;
        if (outcome == SPARSE_INDEFINITE && lambda == 0)
            return CONSTRAINT_BEYOND;
        double next = NAN;
        if (outcome == SPARSE_INDEFINITE) {
            /* The interval of definiteness is symmetric. */
            low = fmax(low, -fabs(lambda));
            high = fmin(high, fabs(lambda));
        } else {
            double missing = c->value - goal, step;
            if (fabs(missing) <= fmax(tolerance, noise))
                return CONSTRAINT_MET;
            inside = lambda;
            *(missing > 0 ? &low : &high) = lambda;
            step = step_to(c, goal);
            if (isfinite(step) && fabs(step) <= TOLERANCE_LAST_STEP * (c->bound - fabs(lambda))) {
                step_last(c, step, goal);
                return CONSTRAINT_MET;
            }
            next = lambda + step;
        }
        if (!(next > low && next < high))
            next = low + (high - low) / 2;
        if (!isfinite(next))
            return CONSTRAINT_BEYOND;
        if (!(next > low && next < high) || high - low <= 4 * DBL_EPSILON * fmax(fabs(low), fabs(high)))
            return finish_singular(c, inside, goal);
        lambda = next;
    }
    return finish_singular(c, inside, goal);
}
