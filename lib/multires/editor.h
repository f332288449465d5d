/* Editor: a session of area-true deformations, [MR] section 4: decomposition, deformation, answer.
 *
 * Points are held relative to the figure's centroid, so that where a figure lies costs no digits. Three stages of the
 * curve are kept: before the edit, as deformed, and the answer, each as coefficients of the level; fine points follow by
 * reconstruction. During a drag only a few coefficients change, those that are moved and those that are free; the
 * fine points that these reach are found by the grab. */
#ifndef MULTIRES_EDITOR_H
#define MULTIRES_EDITOR_H

#include "multires/deform.h"
#include "multires/editor_level.h"

enum { EDITOR_STAGES = 3, EDITOR_MOST_HISTORY = 256, EDITOR_MOST_KEPT = 1 << 24 /* numbers in the history */ };

/* What one drag needs. */
struct drag {
    struct arena arena;
    bool active;
    const double *base;     /* c0 before the displacement: count × 2 */
    const double *direction; /* count: 1 for what is grabbed */
    const size_t *free;     /* coefficients that answer, rising */
    size_t free_count;
    const size_t *changing; /* free ones and moved ones, rising */
    size_t changing_count;
    bool whole;             /* details are free: all is reconstructed; otherwise by: */
    struct sparse reach;    /* fine points × changing: how those follow */
    const size_t *reached;  /* fine points that do */
    size_t reached_count;
    struct deform *deform;  /* NULL: the area is not kept */
    double *answer;         /* free_count × 2 */
    double good[2];         /* the last displacement whose area was reached */
    bool has_good;
};

struct bcifs_editor {
    const bcifs_figure *figure;
    unsigned refine;
    bcifs_energy energy; /* as asked for */
    struct editor_level *level;
    size_t count;     /* fine points */
    double center[2];
    double *coefficients[EDITOR_STAGES]; /* count × 2 each */
    double *fine[EDITOR_STAGES];         /* count × 2 each */
    double *workspace;                   /* BANK_WORKSPACE × count × 2 */
    bool deformed_is_fine;               /* fine[BCIFS_DEFORMED] is up to date */
    bool answered;                       /* the result is the curve that the next edit begins with */
    bcifs_constraint constraint;         /* its lists are the editor's own */
    double locked;                       /* the area that is kept */
    double target;                       /* of the last edit */
    struct deform_outcome outcome;
    struct drag drag;
    double **history; /* fine points; [history_at] is the present */
    size_t history_count, history_at, history_room;
};

#endif
