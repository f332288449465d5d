/* Fit: the control points of a curve figure whose limit curve is nearest to a drawn curve, in least squares.
 *
 * Control points enter linearly once it is known which parameter goes with which point of the target. So two
 * steps alternate: least squares for the control points (least_squares.h), and the nearest points of the new
 * curve for the parameters (feet.h); the best is kept. To begin with, parameters follow arc length, or the
 * pieces of the target, whichever fits better, and on a closed curve several places of its start are tried.
 */
#ifndef MULTIRES_FIT_H
#define MULTIRES_FIT_H

#include "automaton/figure.h"

struct bcifs_fit {
    const bcifs_automaton *automaton;
    const char *figure; /* its name, "" for a bare state */
    double *points;     /* count × dimension */
    size_t count, pieces;
    unsigned dimension, depth, iterations;
    double rms, maximum;
    bool closed;
};

#endif
