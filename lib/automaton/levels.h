/* Levels: the class of an edge state and its three levels of description, [IM] 4: maps, the fused refinement
 * matrix T_÷, masks.
 *
 * The maps T_0 … T_N-1 of an edge overlap: T_i Π_end = T_i+1 Π_start. Written over each other they are one
 * matrix T_÷ of m_a × (NΔ + m_s), whose column iΔ + j is column j of T_i ([IM] proposition 4.1). When
 * moreover row and column indices only enter through k - (NΔ/Δ) j, T_÷ repeats NΔ columns, its masks
 * ([IM] 4.3), and for Δ = 1 the masks interleave to the one row c of the language. A level that a state does
 * not have says why in words. */
#ifndef AUTOMATON_LEVELS_H
#define AUTOMATON_LEVELS_H

#include "automaton/states.h"

enum {
    LEVELS_MOST_ENTRIES = 1 << 20, /* of one level-n refinement matrix */
    LEVELS_MOST_TOTAL = 1 << 24,   /* of all that are needed on the way to it */
    LEVELS_DEEPEST = 64
};

/* (N, Δ, m_s) and what follows from it, [IM] 4.3. */
struct level_class {
    size_t points;       /* m_a */
    size_t subdivisions; /* N */
    size_t joint[2];     /* m_s at the start and at the end */
    size_t step;         /* Δ = m_a - m_s, with the start's m_s */
    int dependence; /* case 1: Δ >= m_s; 2: NΔ >= m_s > Δ; 3: m_s > NΔ; 0 without one m_s or with Δ = 0 */
};

/* One of the NΔ masks: column k ≡ its number (mod NΔ) of T_÷ holds it from row offset + Δ⌊k/NΔ⌋ on. */
struct level_mask {
    ptrdiff_t offset;
    const struct value *values;
    size_t count;
};

struct level_masks {
    const struct level_mask *masks; /* NΔ of them, without zeros at their ends; NULL: no masks */
    size_t count;
    const struct value *row; /* c of `mask N [ c ]`, Δ = 1; NULL when there is none */
    size_t row_count;
    const char *reason;     /* why there are no masks */
    const char *row_reason; /* why there is no row */
};

/* The class of the edge state `index`; expands it. */
bcifs_status levels_classify(struct states *states, size_t index, struct level_class *class);

/* Whether the start of the state is at its first control points and its end at its last, [IM] (5). */
bool levels_is_stepped(const struct cell *cell);

/* T_÷ of the edge state. NULL with `reason` when its maps do not fuse. Equality of what overlaps is decided
 * by value_equal, so it is an identity when the states' setting has random residues for what is free. */
bcifs_status levels_fuse(struct states *states, size_t index, const struct value_matrix **matrix,
                         const char **reason);

/* The masks of the edge state, given its T_÷ (NULL: no masks). */
bcifs_status levels_mask(struct states *states, size_t index, const struct value_matrix *refinement,
                         struct level_masks *masks);

/* The level-n refinement matrix, m_a × columns (N^n Δ + m_s when all states subdivide alike). NULL with
 * `reason` when some state on the way does not fuse. BCIFS_INPUT when it is too large. */
bcifs_status levels_refine(struct states *states, size_t index, unsigned depth, const double **matrix,
                           size_t *columns, const char **reason);

/* Whether the limit point of both joints is one of their control points. -1 with `reason` when a joint has no
 * single limit point. Decided exactly where the joint's map keeps its state and is rational, otherwise within
 * TOLERANCE_EQUATION. */
bcifs_status levels_interpolate(struct states *states, size_t index, int *interpolating, const char **reason);

#endif
