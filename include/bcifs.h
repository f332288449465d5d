/* bcifs: boundary controlled iterated function systems.
 *
 * A text file describes an automaton of cells (vertices, edges, faces) and their subdivision matrices. This
 * library reads it, proves its incidence and adjacency equations, and evaluates its curves and attractors.
 * The language is described in docs/language.md, the mathematics in docs/mathematics.md.
 *
 * Conventions
 * - A handle (bcifs_automaton, bcifs_check, bcifs_figure, bcifs_plan, bcifs_walker) is made by one function and
 *   freed by one, which accepts NULL. Unless said otherwise a handle may outlive nothing it was made from: free
 *   the automaton last.
 * - There is no global state. Calls on different handles may run in parallel; calls that take a handle as
 *   `const` may run in parallel on the same one.
 * - A function that can fail returns a bcifs_status, 0 on success, writes its result through its last-but-one
 *   parameter only then, and fills `error` (which may be NULL) otherwise.
 * - The library never prints, exits, or changes the locale. Text is UTF-8. Numbers are written and read with a
 *   decimal point in every locale.
 * - Matrices are stored row after row; points one after the other, their coordinates adjacent. */
#ifndef BCIFS_H
#define BCIFS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define BCIFS_VERSION "0.1.0"

#if defined(__GNUC__)
#define BCIFS_PUBLIC __attribute__((visibility("default")))
#else
#define BCIFS_PUBLIC
#endif

/* ---- Status and errors -------------------------------------------------------------------------------- */

typedef enum bcifs_status {
    BCIFS_OK = 0,
    BCIFS_NO = 1,     /* the question was well posed and the answer is no: an equation fails */
    BCIFS_INPUT = 2,  /* a file, an argument or a limit: the caller can mend it */
    BCIFS_SYSTEM = 3, /* reading or writing failed */
    BCIFS_MEMORY = 4  /* no memory */
} bcifs_status;

/* A status in words, such as "bad input". Never NULL. */
BCIFS_PUBLIC const char *bcifs_status_text(bcifs_status status);

/* What went wrong. `file` is empty and `line`, `column` (from 1) are 0 where no place in a file is to blame. */
typedef struct bcifs_error {
    bcifs_status status;
    char file[256];
    unsigned line, column;
    char message[768];
} bcifs_error;

/* One finding in a file. The pointers are valid during the call of the reporter only. */
typedef struct bcifs_diagnostic {
    int is_warning;
    const char *file;      /* NULL where no file is to blame */
    unsigned line, column; /* from 1; 0 when unknown */
    const char *message;
    const char *excerpt; /* the line of the file and a caret below it, two lines, or NULL */
} bcifs_diagnostic;

typedef void bcifs_reporter(void *context, const bcifs_diagnostic *diagnostic);

/* Frees text that the library returned. Accepts NULL. */
BCIFS_PUBLIC void bcifs_text_free(char *text);

/* The version of the library that is linked, "major.minor.patch". */
BCIFS_PUBLIC const char *bcifs_version(void);

/* ---- Automata ------------------------------------------------------------------------------------------ */

typedef struct bcifs_automaton bcifs_automaton;

typedef struct bcifs_load_options {
    const char *const *settings; /* "NAME=EXPRESSION": values for the file's params */
    size_t setting_count;
    int fix_params;         /* take every param at its value, as if it were set: none is free in equations */
    bcifs_reporter *report; /* called for every diagnostic (at most 20 errors), or NULL */
    void *context;          /* handed to `report` */
} bcifs_load_options;

/* Reads and binds the automaton in the file `path` ("-" is standard input). `options` may be NULL.
 * `error` holds the first error; `options->report` sees all. */
BCIFS_PUBLIC bcifs_status bcifs_load(const char *path, const bcifs_load_options *options,
                                     bcifs_automaton **automaton, bcifs_error *error);
/* The same from `length` bytes of text; `name` stands for the file in messages and for `use`. */
BCIFS_PUBLIC bcifs_status bcifs_load_text(const char *name, const char *text, size_t length,
                                          const bcifs_load_options *options, bcifs_automaton **automaton,
                                          bcifs_error *error);
BCIFS_PUBLIC void bcifs_automaton_free(bcifs_automaton *automaton);
/* The name after `automaton`, and the title string after it ("" without one). Valid as long as the automaton. */
BCIFS_PUBLIC const char *bcifs_automaton_name(const bcifs_automaton *automaton);
BCIFS_PUBLIC const char *bcifs_automaton_title(const bcifs_automaton *automaton);

/* The text of the file `path` ("-": standard input) in canonical layout; free it with bcifs_text_free.
 * `original`, when not NULL, receives the text as it was read, to compare with. Only the syntax is checked. */
BCIFS_PUBLIC bcifs_status bcifs_format_file(const char *path, const bcifs_load_options *options, char **original,
                                            char **formatted, bcifs_error *error);

/* ---- The equations ------------------------------------------------------------------------------------- */

typedef struct bcifs_check bcifs_check;

typedef enum bcifs_equation_kind {
    BCIFS_BARYCENTRIC, /* columns sum to 1 */
    BCIFS_INCIDENCE,   /* the boundary of a cell is subdivided by the cell's subdivision, [IM] (8) */
    BCIFS_ADJACENCY    /* neighbouring children share their common boundary, [IM] (6) */
} bcifs_equation_kind;

typedef struct bcifs_equation {
    const char *state; /* "arc", "bezier.arc" or a product "a*b" */
    bcifs_equation_kind kind;
    const char *text; /* such as "T0·end = T1·start" */
    int exact;        /* decided in exact arithmetic; otherwise in doubles, within a stated tolerance */
    int holds;
    double residual;    /* largest difference of an entry, in doubles; 0 when it holds exactly */
    const char *reason; /* where it fails for another cause than an entry (states differ, say): in words; or NULL */
    /* A refuted equation is shown: both sides, each rows × columns, and the entry (from 0) that differs most,
     * at the values of the parameters and arguments in `at` ("a = 1/4, u = 2"; "" without any). */
    int rows, columns;
    const double *left, *right; /* NULL when it holds or `reason` says why it fails */
    int row, column;
    const char *at;
    const char *file; /* where the map or boundary stands */
    unsigned line;
} bcifs_equation;

/* Checks every equation of every state. The answer "no" is BCIFS_OK with bcifs_check_valid() = 0. `options` (may be
 * NULL) is used for its reporter: a non-contractive automaton is a warning.
 * Exact verdicts hold identically in all params that were not set when loading, and in all arguments: both sides
 * agree at several independent random points of the field of integers modulo 2^61 - 1 (Schwartz-Zippel). */
BCIFS_PUBLIC bcifs_status bcifs_check_create(const bcifs_automaton *automaton, const bcifs_load_options *options,
                                             bcifs_check **check, bcifs_error *error);
BCIFS_PUBLIC void bcifs_check_free(bcifs_check *check);
BCIFS_PUBLIC int bcifs_check_valid(const bcifs_check *check);
/* BCIFS_OK when every equation holds; otherwise BCIFS_NO, and the first that fails is an error for the reporter. */
BCIFS_PUBLIC bcifs_status bcifs_check_require(const bcifs_check *check, const bcifs_load_options *options,
                                              bcifs_error *error);
BCIFS_PUBLIC size_t bcifs_check_equation_count(const bcifs_check *check);
BCIFS_PUBLIC const bcifs_equation *bcifs_check_equation(const bcifs_check *check, size_t index);

/* Verifies the filters that the file declares (`wavelet`) against the refinement matrices of their states, exactly where
 * they are rational, for the params' values. BCIFS_INPUT: some do not fit, or cannot be undone; the message shows the
 * product. `options` (may be NULL) is used for its reporter. */
BCIFS_PUBLIC bcifs_status bcifs_check_filters(const bcifs_automaton *automaton, const bcifs_load_options *options,
                                              bcifs_error *error);

/* Bounds of the joint spectral radius of the linear parts of all maps, for the params' values: below 1 the
 * automaton is contractive. Rounding is accounted for. `upper` is infinite when nothing bounds it. `product`, the word
 * of maps that attains `lower` ("arc: 0 1"), is valid as long as the check. */
BCIFS_PUBLIC void bcifs_check_contraction(const bcifs_check *check, double *lower, double *upper,
                                          const char **product);

/* The whole check as one JSON object, or as text for a person; free with bcifs_text_free. NULL: no memory. */
BCIFS_PUBLIC char *bcifs_check_json(const bcifs_check *check);
BCIFS_PUBLIC char *bcifs_check_text(const bcifs_check *check);

/* ---- Tangents and smoothness ---------------------------------------------------------------------------- */

/* What is found of every edge state that the file's figures reach: eigenvalues of its maps, half-tangents at its
 * ends and at the junctions of its children, certified smoothness; and of the joints of every curve figure. */
typedef struct bcifs_analysis bcifs_analysis;

/* BCIFS_NO when an equation fails. `effort` scales the search for smoothness; 1 is usual. `options` (may be NULL) is
 * used for its reporter. */
BCIFS_PUBLIC bcifs_status bcifs_analysis_create(const bcifs_automaton *automaton, double effort,
                                                const bcifs_load_options *options, bcifs_analysis **analysis,
                                                bcifs_error *error);
BCIFS_PUBLIC void bcifs_analysis_free(bcifs_analysis *analysis);
/* The whole as one JSON object, or as text for a person; free with bcifs_text_free. NULL: no memory. */
BCIFS_PUBLIC char *bcifs_analysis_json(const bcifs_analysis *analysis);
BCIFS_PUBLIC char *bcifs_analysis_text(const bcifs_analysis *analysis);

/* ---- Levels of description ------------------------------------------------------------------------------ */

/* The class of every edge state and its three levels of description, [IM] 4; faces and cells are listed. */
typedef struct bcifs_description bcifs_description;

typedef struct bcifs_describe_options {
    const char *state; /* this one only; NULL: all */
    unsigned depth;    /* the level of the refinement matrices; 1 is T_÷ itself */
} bcifs_describe_options;

/* `options` may be NULL: all states, depth 1. A state with arguments is described for the first ones that a figure of
 * the file gives it. */
BCIFS_PUBLIC bcifs_status bcifs_describe(const bcifs_automaton *automaton, const bcifs_describe_options *options,
                                         bcifs_description **description, bcifs_error *error);
BCIFS_PUBLIC void bcifs_description_free(bcifs_description *description);
/* The whole as one JSON object, or as text for a person; free with bcifs_text_free. NULL: no memory. */
BCIFS_PUBLIC char *bcifs_description_json(const bcifs_description *description);
BCIFS_PUBLIC char *bcifs_description_text(const bcifs_description *description);

typedef enum bcifs_level {
    BCIFS_MAPS,       /* subdivision matrices: sub */
    BCIFS_REFINEMENT, /* the fused matrix T_÷: refine */
    BCIFS_MASK        /* one row: mask */
} bcifs_level;

/* The automaton's main file with its edges written at `level`, in canonical layout; free with bcifs_text_free.
 * BCIFS_NO, with the reason in `error`, when an edge cannot be written so. Params that were set keep their new value. */
BCIFS_PUBLIC bcifs_status bcifs_rewrite(const bcifs_automaton *automaton, bcifs_level level, char **text,
                                        bcifs_error *error);

/* ---- Completion ---------------------------------------------------------------------------------------- */

/* An automaton whose entries written `?` were solved for: the barycentric, incidence and adjacency equations are linear
 * in them. What the equations leave free becomes new params. */
typedef struct bcifs_complete bcifs_complete;

/* One of the scalar equations that contradict each other: entry (row, column), from 0, of a matrix equation. */
typedef struct bcifs_conflict {
    const char *state;
    bcifs_equation_kind kind;
    const char *equation; /* such as "T0·end = T1·start" */
    size_t row, column;
    const char *reason; /* NULL, or why it fails whatever the numbers are, in words */
    const char *file;   /* where the map or boundary stands */
    unsigned line;
} bcifs_conflict;

/* Solves the equations exactly, over the rationals. An answer "no", equations that contradict each other, is BCIFS_OK
 * with bcifs_complete_consistent() = 0. BCIFS_INPUT: an entry that is not rational, fractions beyond 64 bits, `?` where
 * the equations are not linear, more than 4096 unknowns. Params keep their names where known entries are linear in them;
 * others, and those that were set when loading, are taken at their values and become `let`s. An automaton without `?`
 * is checked, as by bcifs_check_create. `options` (may be NULL) is used for its reporter. */
BCIFS_PUBLIC bcifs_status bcifs_complete_create(const bcifs_automaton *automaton,
                                                const bcifs_load_options *options, bcifs_complete **complete,
                                                bcifs_error *error);
BCIFS_PUBLIC void bcifs_complete_free(bcifs_complete *complete);
/* The number of entries `?`, and of scalar equations: entries of all matrix equations, known ones included. */
BCIFS_PUBLIC size_t bcifs_complete_unknowns(const bcifs_complete *complete);
BCIFS_PUBLIC size_t bcifs_complete_equations(const bcifs_complete *complete);
BCIFS_PUBLIC int bcifs_complete_consistent(const bcifs_complete *complete);
/* The number of new params; 0 when inconsistent. */
BCIFS_PUBLIC size_t bcifs_complete_degrees_of_freedom(const bcifs_complete *complete);
/* The name of a degree of freedom, in order of appearance; NULL past the last. */
BCIFS_PUBLIC const char *bcifs_complete_parameter(const bcifs_complete *complete, size_t index);
/* The completed file in canonical layout, as long as the handle lives; NULL when inconsistent. `bcifs check` proves
 * it: its equations hold identically in all its params. */
BCIFS_PUBLIC const char *bcifs_complete_automaton(const bcifs_complete *complete);
/* The equations that contradict each other, none of which can be left out; NULL past the last. And what they come to:
 * "0 = 1/4", or "" when they fail for a reason in words or there is no conflict. */
BCIFS_PUBLIC const bcifs_conflict *bcifs_complete_conflict(const bcifs_complete *complete, size_t index);
BCIFS_PUBLIC const char *bcifs_complete_contradiction(const bcifs_complete *complete);
/* The whole as one JSON object; the conflict in words, "" without one. Free with bcifs_text_free. NULL: no memory. */
BCIFS_PUBLIC char *bcifs_complete_json(const bcifs_complete *complete);
BCIFS_PUBLIC char *bcifs_complete_text(const bcifs_complete *complete);

/* ---- Drawn curves -------------------------------------------------------------------------------------- */

/* A curve of straight and cubic pieces, read from a drawing or a list of points. */
typedef struct bcifs_curve bcifs_curve;

/* Reads the file `path` ("-": standard input): the first drawn <path> of an SVG file (one outline of the commands
 * M L H V C S Z, with the transforms around it, y negated so that it points up), or CSV as bcifs_points_read reads it, a
 * polyline that is closed when its last point is its first. The ending .svg or .csv tells which, otherwise the text.
 * `options` is used for its reporter only. */
BCIFS_PUBLIC bcifs_status bcifs_curve_read(const char *path, const bcifs_load_options *options, bcifs_curve **curve,
                                           bcifs_error *error);
BCIFS_PUBLIC void bcifs_curve_free(bcifs_curve *curve);
BCIFS_PUBLIC int bcifs_curve_is_closed(const bcifs_curve *curve);
/* Whether it has cubic pieces, so that its points are a Bézier control polygon. */
BCIFS_PUBLIC int bcifs_curve_is_cubic(const bcifs_curve *curve);
/* Number of coordinates of a point: 2 from SVG, 1 to 16 from CSV. */
BCIFS_PUBLIC unsigned bcifs_curve_dimension(const bcifs_curve *curve);
/* Its control points, count × dimension numbers, valid as long as the curve: the ends of its lines or, when it is
 * cubic, the Bézier points of its pieces, 3K + 1 for K of them (3K when closed), lines being raised to cubics. The
 * first point is not repeated on a closed curve. */
BCIFS_PUBLIC const double *bcifs_curve_points(const bcifs_curve *curve, size_t *count);
/* Writes `count` points, at least 2, at equal distances along the curve: from its first to its last point or, on a
 * closed one, without coming back to the first. BCIFS_INPUT when it has no length. */
BCIFS_PUBLIC bcifs_status bcifs_curve_sample(const bcifs_curve *curve, size_t count, double *points,
                                             bcifs_error *error);

/* ---- Figures and their evaluation ---------------------------------------------------------------------- */

typedef struct bcifs_figure bcifs_figure;

typedef struct bcifs_figure_options {
    const char *figure; /* its name; NULL: the file's first */
    const char *state;  /* not NULL: one piece in this state instead of a figure of the file */
    /* Control points that replace the figure's: point_count × dimension numbers. NULL: the figure's own. */
    const double *points;
    size_t point_count;
    unsigned dimension;
    int unplaced; /* with `state`: no points are needed, as only the basis or the refinement is wanted */
    /* Not NULL: its points instead of those. A closed figure takes no last point that repeats the first; an open one
     * on a closed curve gets the first once more at its end. */
    const bcifs_curve *curve;
    size_t pieces; /* not 0: a curve of so many pieces, all its points 0 */
} bcifs_figure_options;

/* Binds a figure to its control points; `options` may be NULL. Refuses one whose automaton has entries `?`. */
BCIFS_PUBLIC bcifs_status bcifs_figure_create(const bcifs_automaton *automaton,
                                              const bcifs_figure_options *options, bcifs_figure **figure,
                                              bcifs_error *error);
BCIFS_PUBLIC void bcifs_figure_free(bcifs_figure *figure);
/* Its name, "" for a bare state. */
BCIFS_PUBLIC const char *bcifs_figure_name(const bcifs_figure *figure);
/* Number of coordinates of a point, 1 to 16. */
BCIFS_PUBLIC unsigned bcifs_figure_dimension(const bcifs_figure *figure);
/* Whether its pieces are cells, drawn as an attractor, not arcs. */
BCIFS_PUBLIC int bcifs_figure_is_attractor(const bcifs_figure *figure);
/* The greatest depth at which `show` limit has at most `points` points, at most 64. */
BCIFS_PUBLIC unsigned bcifs_figure_depth(const bcifs_figure *figure, uint64_t points);

/* The control points of a curve figure that come nearest to a drawn curve. */
typedef struct bcifs_fit bcifs_fit;

typedef struct bcifs_fit_options {
    const char *figure; /* its name; NULL: the file's first. Its own control points do not matter */
    const char *state;  /* not NULL: one piece in this state instead of a figure of the file */
    size_t pieces;      /* as many pieces; 0: as many as the figure has */
    unsigned depth;     /* at which distances are measured; 0: chosen, 1024 limit points or more */
    unsigned iterations; /* most steps; 0: 100 */
} bcifs_fit_options;

/* Finds the control points whose limit curve is nearest to `target`, of 1 to 3 coordinates, in least squares. A closed
 * figure closes the target by a straight line if it is open; an open one runs once around a closed target. The search
 * begins from parameters by arc length, and may end in a local minimum. With one coordinate the target is a function of
 * its parameter. `options` may be NULL. BCIFS_INPUT when the figure is not one curve, when its intervals do not fit
 * the number of pieces, or when the target has no length. The automaton must outlive the fit. */
BCIFS_PUBLIC bcifs_status bcifs_fit_create(const bcifs_automaton *automaton, const bcifs_curve *target,
                                           const bcifs_fit_options *options, bcifs_fit **fit, bcifs_error *error);
BCIFS_PUBLIC void bcifs_fit_free(bcifs_fit *fit);
/* Its control points, count × dimension numbers, valid as long as the fit: for bcifs_figure_options. */
BCIFS_PUBLIC const double *bcifs_fit_points(const bcifs_fit *fit, size_t *count);
BCIFS_PUBLIC unsigned bcifs_fit_dimension(const bcifs_fit *fit);
BCIFS_PUBLIC size_t bcifs_fit_pieces(const bcifs_fit *fit);
/* Root mean square (by arc length) and maximum of the distances of the target's points from the curve, in its units. */
BCIFS_PUBLIC double bcifs_fit_rms(const bcifs_fit *fit);
BCIFS_PUBLIC double bcifs_fit_maximum(const bcifs_fit *fit);
/* Steps that were made. */
BCIFS_PUBLIC unsigned bcifs_fit_iterations(const bcifs_fit *fit);
/* The control points as CSV; all of the above as one JSON object. Free with bcifs_text_free. NULL: no memory. */
BCIFS_PUBLIC char *bcifs_fit_csv(const bcifs_fit *fit);
BCIFS_PUBLIC char *bcifs_fit_json(const bcifs_fit *fit);

/* Reads control points from a CSV file, one point a row: count × dimension numbers, to be freed with
 * bcifs_points_free. A first row without any number is a header. `options` is used for its reporter only. */
BCIFS_PUBLIC bcifs_status bcifs_points_read(const char *path, const bcifs_load_options *options, double **points,
                                            size_t *count, unsigned *dimension, bcifs_error *error);
BCIFS_PUBLIC void bcifs_points_free(double *points);

/* The limit point at parameter `t` in 0..1 along the figure (every piece, and every child of a cell, takes an equal
 * share), or at an address: the piece, a point, and the word of map indices, digits or numbers separated by
 * commas. `point` receives dimension numbers. */
BCIFS_PUBLIC bcifs_status bcifs_point_at(const bcifs_figure *figure, double t, double *point, bcifs_error *error);
BCIFS_PUBLIC bcifs_status bcifs_point_at_address(const bcifs_figure *figure, const char *address, double *point,
                                                 bcifs_error *error);

typedef enum bcifs_show {
    BCIFS_LIMIT,   /* limit points: the start of every cell of the level, for cells the point 000… of each */
    BCIFS_CONTROL, /* control points of the level; for cells, the image of the control frame under every word */
    BCIFS_SEED     /* the image of one given point of the joint (or of the cell), [IM] 3.5 */
} bcifs_show;

typedef struct bcifs_view {
    unsigned depth;
    bcifs_show show;
    const double *seed; /* BCIFS_SEED: barycentric coordinates in the joint (cells: in the cell) */
    size_t seed_count;
    double from, to; /* only the points with parameter from <= t <= to; 0, 1 (or 0, 0): all */
} bcifs_view;

/* A plan holds everything that evaluating a figure at one depth needs; its size does not depend on the number of
 * points. The points form paths (curves), loose points (attractors), or polygons of equal size (control frames
 * of an attractor). A point shared by two pieces or two children appears once. */
typedef struct bcifs_plan bcifs_plan;

typedef struct bcifs_path {
    uint64_t first, count; /* points */
    int closed;
} bcifs_path;

BCIFS_PUBLIC bcifs_status bcifs_plan_create(const bcifs_figure *figure, const bcifs_view *view, bcifs_plan **plan,
                                            bcifs_error *error);
BCIFS_PUBLIC void bcifs_plan_free(bcifs_plan *plan);
BCIFS_PUBLIC uint64_t bcifs_plan_points(const bcifs_plan *plan);
BCIFS_PUBLIC unsigned bcifs_plan_dimension(const bcifs_plan *plan);
/* Number of paths; 0 when the points are loose or form polygons. */
BCIFS_PUBLIC size_t bcifs_plan_path_count(const bcifs_plan *plan);
BCIFS_PUBLIC bcifs_path bcifs_plan_path(const bcifs_plan *plan, size_t index);
/* Points of each polygon when the points form polygons, otherwise 0. */
BCIFS_PUBLIC unsigned bcifs_plan_polygon(const bcifs_plan *plan);

/* A walker runs over the points of a plan in order. Several may run over one plan in parallel. */
typedef struct bcifs_walker bcifs_walker;

BCIFS_PUBLIC bcifs_status bcifs_walker_create(const bcifs_plan *plan, bcifs_walker **walker, bcifs_error *error);
BCIFS_PUBLIC void bcifs_walker_free(bcifs_walker *walker);
/* Goes to the point `index`; its address is computed, not walked to. */
BCIFS_PUBLIC void bcifs_walker_seek(bcifs_walker *walker, uint64_t index);
/* Writes the next points, at most `capacity`, to `points` (capacity × dimension numbers) and returns how many;
 * 0 at the end. The same point has the same bits whatever the capacity and the place where the walk began. */
BCIFS_PUBLIC size_t bcifs_walker_next(bcifs_walker *walker, double *points, size_t capacity);

/* The half-tangents at both ends of every cell of level `level` of a curve figure, as segments to be drawn: from
 * the point forward at a start, to the point at an end. count × 2 points of the figure's dimension, a twentieth of
 * the figure's size long; free with bcifs_points_free. */
BCIFS_PUBLIC bcifs_status bcifs_analysis_segments(const bcifs_analysis *analysis, const bcifs_figure *figure,
                                                  unsigned level, double **segments, size_t *count,
                                                  bcifs_error *error);

/* ---- Files --------------------------------------------------------------------------------------------- */

typedef enum bcifs_role {
    BCIFS_CURVE,   /* drawn as a line, or as a density picture when its points are loose */
    BCIFS_POLYGON, /* drawn as a control polygon with its points marked */
    BCIFS_LEVEL,   /* a coarser level laid over the curve */
    BCIFS_TANGENT, /* half-tangents */
    BCIFS_TARGET   /* what a curve was fitted to */
} bcifs_role;

/* The color of a layer. */
typedef enum bcifs_ink {
    BCIFS_INK_OF_ROLE, /* what its role is usually drawn in */
    BCIFS_BLUE,        /* the colors of [MR]: the curve before an edit, */
    BCIFS_GREEN,       /* as it was deformed, */
    BCIFS_RED          /* with its area restored */
} bcifs_ink;

typedef struct bcifs_layer {
    const bcifs_plan *plan; /* or NULL: */
    bcifs_role role;
    const double *segments; /* segment_count pairs of points of the figure's dimension */
    size_t segment_count;
    const bcifs_curve *curve; /* or, when not NULL, a drawn curve of the figure's dimension */
    bcifs_ink ink;
} bcifs_layer;

/* Called now and then during long work with the share that is done, 0..1. */
typedef void bcifs_progress(void *context, double done);

typedef struct bcifs_write_options {
    const char *format;  /* a name of bcifs_format_name; NULL: after the ending of the path */
    const char *command; /* the command line that makes this file, kept in pictures; may be NULL */
    unsigned width;      /* of a picture, in pixels; 0: 1000 */
    bcifs_progress *progress;
    void *context;
} bcifs_write_options;

/* Writes layers[0] (data formats) or all layers (pictures) to `path`, "-" being standard output. A file appears
 * whole or not at all; what is not a regular file is written as it comes. BCIFS_INPUT when a point is not finite
 * or the format cannot hold the points. */
BCIFS_PUBLIC bcifs_status bcifs_write(const bcifs_figure *figure, const bcifs_layer *layers, size_t layer_count,
                                      const char *path, const bcifs_write_options *options, bcifs_error *error);
/* Writes `length` bytes of text to `path` under the same promises. */
BCIFS_PUBLIC bcifs_status bcifs_write_text(const char *path, const char *text, size_t length, bcifs_error *error);

/* Writes the level-`depth` refinement matrix of a curve or attractor, the figure's control points × the control points
 * of the level in the order of BCIFS_CONTROL, [IM] 5.1: sparse, MatrixMarket coordinates (.mtx). Memory does not grow
 * with the number of columns. Of `options` only the command is used. */
BCIFS_PUBLIC bcifs_status bcifs_write_refinement(const bcifs_figure *figure, unsigned depth, const char *path,
                                                 const bcifs_write_options *options, bcifs_error *error);
/* Draws the automaton itself, states as nodes, maps and boundaries as labeled arrows: format dot (Graphviz) or svg. */
BCIFS_PUBLIC bcifs_status bcifs_write_graph(const bcifs_automaton *automaton, const char *path,
                                            const bcifs_write_options *options, bcifs_error *error);

/* The blending functions H_k of a curve at level `level`, [IM] 5.2, at the parameters of depth `depth` >= level. */
typedef struct bcifs_basis_view {
    unsigned depth, level;
} bcifs_basis_view;

/* How many they are: the control points of the level. */
BCIFS_PUBLIC bcifs_status bcifs_basis_count(const bcifs_figure *figure, unsigned level, uint64_t *count,
                                            bcifs_error *error);
/* Writes them as a table (csv: t,h0,h1,…) or draws them (svg, png). */
BCIFS_PUBLIC bcifs_status bcifs_write_basis(const bcifs_figure *figure, const bcifs_basis_view *view, const char *path,
                                            const bcifs_write_options *options, bcifs_error *error);

/* The formats that bcifs_write knows: name, and one line on what it is; NULL past the last. */
BCIFS_PUBLIC const char *bcifs_format_name(size_t index);
BCIFS_PUBLIC const char *bcifs_format_text(size_t index);
/* Whether a format holds a picture, so that several layers make sense. */
BCIFS_PUBLIC int bcifs_format_is_picture(size_t index);

/* Writes the shortest decimal that reads back as `number` and a NUL to `out`, 40 bytes; returns the length. */
BCIFS_PUBLIC size_t bcifs_number_text(char *out, double number);
/* Reads a number expression of the language without names ("0.5", "1/3", "sqrt(2)/2"). */
BCIFS_PUBLIC bcifs_status bcifs_number_read(const char *text, double *number, bcifs_error *error);

/* ---- Filter banks -------------------------------------------------------------------------------------- */

/* Decomposition of a curve's control points into coarser ones and details, and its exact inverse, for any scheme. */
typedef struct bcifs_bank bcifs_bank;

/* The bank from the figure's control points down `coarsen` levels. When `refine` > 0 the figure is subdivided so often
 * first, and its control points at that level are the fine ones. BCIFS_INPUT when the figure cannot be coarsened so far:
 * the message says how far it can, and what number of control points would do. The figure must outlive the bank. */
BCIFS_PUBLIC bcifs_status bcifs_bank_create(const bcifs_figure *figure, unsigned refine, unsigned coarsen,
                                            bcifs_bank **bank, bcifs_error *error);
BCIFS_PUBLIC void bcifs_bank_free(bcifs_bank *bank);
/* Fine control points, which is also the number of coefficients; and how many of those are coarse control points. A
 * control point that stands in several places of the figure's curves is one for each. */
BCIFS_PUBLIC size_t bcifs_bank_points(const bcifs_bank *bank);
BCIFS_PUBLIC size_t bcifs_bank_scale_points(const bcifs_bank *bank);
/* The figure's own control points, subdivided `refine` times: bcifs_bank_points × dimension numbers. */
BCIFS_PUBLIC bcifs_status bcifs_bank_figure_points(const bcifs_bank *bank, double *points, bcifs_error *error);
/* Fine control points to coefficients and back, bcifs_bank_points × dimension numbers each, in distinct arrays. Calls on
 * one bank must not run in parallel. The coefficients are the coarse control points, then the details of each level from the coarsest on ([MR] (12)). */
BCIFS_PUBLIC bcifs_status bcifs_bank_decompose(bcifs_bank *bank, const double *points, unsigned dimension,
                                               double *coefficients, bcifs_error *error);
BCIFS_PUBLIC bcifs_status bcifs_bank_reconstruct(bcifs_bank *bank, const double *coefficients,
                                                 unsigned dimension, double *points, bcifs_error *error);

/* ---- The area-true editor ------------------------------------------------------------------------------ */

/* An editing session on a planar curve figure: control points of any level are dragged, and the curve is deformed so
 * that the area it encloses stays exactly what it was ([MR] section 4; open curves are closed by their chords).
 * Calls on one editor must not run in parallel. */
typedef struct bcifs_editor bcifs_editor;

typedef enum bcifs_energy {
    BCIFS_BENDING,    /* ∫|c''|², each piece of the finest level having unit parameter length */
    BCIFS_DIFFERENCE, /* sum of squared second differences of the finest control polygon */
    BCIFS_NO_ENERGY
} bcifs_energy;

typedef struct bcifs_editor_options {
    unsigned refine;     /* the figure is subdivided so often first: its control points then are the fine ones */
    unsigned coarsen;    /* J: control points are dragged J levels above the fine ones */
    bcifs_energy energy; /* BCIFS_BENDING is taken for BCIFS_DIFFERENCE where the scheme has none */
} bcifs_editor_options;

/* `options` may be NULL: the figure's own control points. The figure must outlive the editor. */
BCIFS_PUBLIC bcifs_status bcifs_editor_create(const bcifs_figure *figure, const bcifs_editor_options *options,
                                              bcifs_editor **editor, bcifs_error *error);
BCIFS_PUBLIC void bcifs_editor_free(bcifs_editor *editor);
/* Chooses another level: J as above. Pins and lists of free points, which are of a level, are dropped. */
BCIFS_PUBLIC bcifs_status bcifs_editor_coarsen(bcifs_editor *editor, unsigned coarsen, bcifs_error *error);
BCIFS_PUBLIC unsigned bcifs_editor_level(const bcifs_editor *editor);
/* The energy in use, and why it is not the bending energy that was asked for (NULL otherwise). */
BCIFS_PUBLIC bcifs_energy bcifs_editor_energy(const bcifs_editor *editor, const char **reason);

typedef enum bcifs_free {
    BCIFS_FREE_SCALE, /* all control points of the level */
    BCIFS_FREE_ALL,   /* and all details */
    BCIFS_FREE_NEAR,  /* the `neighbors` control points on each side of those that are moved, which stay where they are put */
    BCIFS_FREE_LIST   /* those listed */
} bcifs_free;

/* How the curve answers: minimize ½ c^T H c + α‖c - c0‖² over the free coefficients c, c0 being those of the
 * deformed curve, subject to the area (design 6.5). Control points are counted from 0 at the editor's level. */
typedef struct bcifs_constraint {
    int keep_area;     /* 0: the deformed curve is the answer */
    int has_target;    /* the area is to become `target`; otherwise it stays what it was */
    double target;
    double alpha;      /* 0 to 1e300; 100 is usual */
    bcifs_free free;
    size_t neighbors;
    const size_t *list;
    size_t list_count;
    const size_t *pins; /* control points that stay, whatever is free */
    size_t pin_count;
} bcifs_constraint;

/* Sets the constraint for the moves to come; the lists are copied. An editor begins with keep_area, alpha 100, all
 * control points of the level free. */
BCIFS_PUBLIC bcifs_status bcifs_editor_constrain(bcifs_editor *editor, const bcifs_constraint *constraint,
                                                 bcifs_error *error);

/* A drag: grab control points of the level, drag them together by (dx, dy) from where they were grabbed, as often as
 * the pointer moves, and release. What does not change during a drag is computed by the grab. BCIFS_NO when the area cannot
 * be reached: the message says why, and what the nearest area is; the curve then is the deformed one brought as near as
 * can be. A release that follows keeps the last answer that reached the area, if there was one. */
BCIFS_PUBLIC bcifs_status bcifs_editor_grab(bcifs_editor *editor, const size_t *indices, size_t count,
                                            bcifs_error *error);
BCIFS_PUBLIC bcifs_status bcifs_editor_drag(bcifs_editor *editor, double dx, double dy, bcifs_error *error);
BCIFS_PUBLIC bcifs_status bcifs_editor_release(bcifs_editor *editor, bcifs_error *error);

/* One edit as a whole: several control points by a vector each (none at all: only the constraint answers). */
typedef struct bcifs_move {
    size_t index;
    double dx, dy;
} bcifs_move;
BCIFS_PUBLIC bcifs_status bcifs_editor_move(bcifs_editor *editor, const bcifs_move *moves, size_t count,
                                            bcifs_error *error);

/* Back to the curve before the last edit, and forth again; 0 when there is none. A drag that was not released, and an edit
 * that did not reach its area, are undone first; whatever else is called then drops them. */
BCIFS_PUBLIC int bcifs_editor_undo(bcifs_editor *editor);
BCIFS_PUBLIC int bcifs_editor_redo(bcifs_editor *editor);

/* The three curves of [MR]: before the last edit (or the drag under way), as the user deformed it, and the answer. */
typedef enum bcifs_stage { BCIFS_INITIAL, BCIFS_DEFORMED, BCIFS_RESULT } bcifs_stage;

/* Fine control points, and control points of the level: how many, and where: count × 2 numbers. */
BCIFS_PUBLIC size_t bcifs_editor_points(const bcifs_editor *editor);
BCIFS_PUBLIC size_t bcifs_editor_scale_points(const bcifs_editor *editor);
BCIFS_PUBLIC void bcifs_editor_read(const bcifs_editor *editor, bcifs_stage stage, double *points);
BCIFS_PUBLIC void bcifs_editor_read_scale(const bcifs_editor *editor, bcifs_stage stage, double *points);
/* A figure with the fine control points of a stage, or with the control points of the level, to be evaluated and drawn. It
 * must not outlive the editor. */
BCIFS_PUBLIC bcifs_status bcifs_editor_figure(const bcifs_editor *editor, bcifs_stage stage, int scale,
                                              bcifs_figure **figure, bcifs_error *error);

typedef struct bcifs_edit_report {
    double before, deformed, after, target; /* areas; NAN where the scheme has none. `after` is computed from the fine
                                               control points of the answer */
    double relative_error; /* of `after`, against the target or, when that is nearly 0, a hundredth of the square of the
                              curve's extent from its middle */
    double energy_deformed, energy_after;
    unsigned iterations; /* values of λ that were tried */
    double multiplier;   /* λ */
    int global;          /* no other curve with this area has a lower objective */
} bcifs_edit_report;

/* What the last edit (or drag) did. */
BCIFS_PUBLIC void bcifs_editor_report(const bcifs_editor *editor, bcifs_edit_report *report);
/* The whole as one JSON object, or as text for a person; free with bcifs_text_free. NULL: no memory. */
BCIFS_PUBLIC char *bcifs_editor_json(const bcifs_editor *editor);
BCIFS_PUBLIC char *bcifs_editor_text(const bcifs_editor *editor);

/* ---- Area ---------------------------------------------------------------------------------------------- */

/* The signed area that a figure's limit curve encloses, a fractal one's too, and the forms that it is computed
 * from: an arc whose control points have the coordinates X, Y contributes ½ X m Yᵀ. */
typedef struct bcifs_area bcifs_area;

/* The antisymmetric form m of a state that pieces of the figure are in. */
typedef struct bcifs_form {
    const char *state;    /* with its arguments: "p(1,2,1)" */
    size_t size;          /* control points */
    const double *matrix; /* size × size numbers */
    int exact;            /* its entries are known as fractions, of which these are the nearest doubles */
} bcifs_form;

/* The figure must be a curve in the plane, or a bare state that is `unplaced`, of which there are forms but no area.
 * The equations are not checked: see bcifs_check_require. BCIFS_NO, with the reason in `error`: the areas of finer and
 * finer polygons do not converge, or it could not be certified that they do. BCIFS_INPUT: no curve, not in the plane,
 * displaced, more control points than the limits. */
BCIFS_PUBLIC bcifs_status bcifs_area_create(const bcifs_figure *figure, bcifs_area **area, bcifs_error *error);
BCIFS_PUBLIC void bcifs_area_free(bcifs_area *area);
/* The area, in the square of the unit of the coordinates, positive where the curve runs counterclockwise: the sum over
 * the figure's chains of arcs, each open one closed by its chord. 0 for an unplaced state. */
BCIFS_PUBLIC double bcifs_area_value(const bcifs_area *area);
/* Whether it is known as a fraction, and that fraction, "10/3"; NULL when it is not. Valid as long as the handle. */
BCIFS_PUBLIC int bcifs_area_exact(const bcifs_area *area);
BCIFS_PUBLIC const char *bcifs_area_fraction(const bcifs_area *area);
/* The forms of the states that pieces are in, in order of appearance; NULL past the last. */
BCIFS_PUBLIC const bcifs_form *bcifs_area_form(const bcifs_area *area, size_t index);
/* The whole as one JSON object, or as text for a person; free with bcifs_text_free. NULL: no memory. */
BCIFS_PUBLIC char *bcifs_area_json(const bcifs_area *area);
BCIFS_PUBLIC char *bcifs_area_text(const bcifs_area *area);

/* The form of the area in the coefficients (x^L, d^L, …, d^{n-1}) of a curve that was decomposed J = n - L times, as by
 * bcifs_bank_decompose: an antisymmetric matrix M with the area ½ X M Yᵀ, [MR] (11)-(13). Its blocks are A (control points ×
 * control points), B (control points × details), -Bᵀ and C. Only the entries that are not zero are held. */
typedef struct bcifs_area_matrix bcifs_area_matrix;

/* `refine` and `coarsen` are those of bcifs_bank_create; the figure is one for bcifs_area_create, and must outlive the
 * matrix. Errors are those of both. Entries of at most 1e-13 of the largest in their row or column are rounding and are
 * dropped. */
BCIFS_PUBLIC bcifs_status bcifs_area_matrix_create(const bcifs_figure *figure, unsigned refine, unsigned coarsen,
                                                   bcifs_area_matrix **matrix, bcifs_error *error);
BCIFS_PUBLIC void bcifs_area_matrix_free(bcifs_area_matrix *matrix);
/* The area of the figure itself and the forms of its states, valid as long as the matrix. */
BCIFS_PUBLIC const bcifs_area *bcifs_area_matrix_area(const bcifs_area_matrix *matrix);
/* L, the coarsest level that `refine` and `coarsen` speak of being 0; `finest` (may be NULL) receives n. */
BCIFS_PUBLIC unsigned bcifs_area_matrix_level(const bcifs_area_matrix *matrix, unsigned *finest);
/* Its rows, which are as many as the fine control points, and those of block A, the coarse control points. */
BCIFS_PUBLIC size_t bcifs_area_matrix_size(const bcifs_area_matrix *matrix);
BCIFS_PUBLIC size_t bcifs_area_matrix_scale_points(const bcifs_area_matrix *matrix);
/* The row (and column) where a part of the coefficients begins: 0 for part 0, x^L; then the details, part 1 being d^L and
 * part J d^{n-1}; the size from part J + 1 on. */
BCIFS_PUBLIC size_t bcifs_area_matrix_start(const bcifs_area_matrix *matrix, unsigned part);
/* How many entries are not zero. When `rows` is not NULL, writes them to three arrays of so many elements, row after row,
 * columns rising. */
BCIFS_PUBLIC size_t bcifs_area_matrix_entries(const bcifs_area_matrix *matrix, size_t *rows, size_t *columns,
                                              double *values);
/* One entry; 0 outside the matrix. */
BCIFS_PUBLIC double bcifs_area_matrix_entry(const bcifs_area_matrix *matrix, size_t row, size_t column);
/* ½ X M Yᵀ of planar coefficients, size × 2 numbers. */
BCIFS_PUBLIC double bcifs_area_matrix_value(const bcifs_area_matrix *matrix, const double *coefficients);
/* Writes it to `path`, "-" being standard output, as txt (the default of "-"; entries shown up to 32 rows), json (with what
 * bcifs_area_json tells; up to 1024 rows), csv (all rows, without a header; up to 4096), mtx (MatrixMarket, real
 * skew-symmetric, any size), svg or png (a picture of the blocks: A yellow, B and -Bᵀ red, C green, entries dark). Of
 * `options` the format, the command and the width are used. BCIFS_INPUT: another format, or too many rows for it. */
BCIFS_PUBLIC bcifs_status bcifs_area_matrix_write(const bcifs_area_matrix *matrix, const char *path,
                                                  const bcifs_write_options *options, bcifs_error *error);

/* ---- Parameter maps ------------------------------------------------------------------------------------ */

/* The class of an automaton at every node of a grid over one or two of its params. */
typedef struct bcifs_map bcifs_map;

/* A class includes those before it, undecided aside. */
typedef enum bcifs_map_class {
    BCIFS_UNDECIDED,          /* the bounds of the joint spectral radius have 1 between them; or there are no numbers
                                 here (a division by zero), or more states or control points than the limits */
    BCIFS_NOT_CONTRACTIVE,    /* a product of maps has a spectral radius of at least 1 on differences of points */
    BCIFS_CONTRACTIVE,        /* certified: the joint spectral radius is below 1 */
    BCIFS_TANGENT_CONTINUOUS, /* half-tangents agree at all junctions of all depths, for all control points */
    BCIFS_C1                  /* certified: the blending functions have Hölder exponents above 1 */
} bcifs_map_class;

typedef struct bcifs_map_options {
    const char *state; /* a state without arguments; NULL: all edge states of the main file that have none, together,
                          or else the pieces of its first figure */
    double effort;     /* scales the search at each grid point; 1 is usual, and 0 is taken for it */
    unsigned threads;  /* at most 256; 0: as many as there are processors. The map does not depend on it. */
    bcifs_progress *progress; /* called in the calling thread, or NULL */
    void *context;
} bcifs_map_options;

/* `axes` are one or two texts "NAME=LOW..HIGH:COUNT": COUNT nodes, LOW and HIGH the first and the last, evenly spaced;
 * COUNT is at least 2, and all nodes together are at most 2^22. LOW and HIGH are number expressions. Params that depend
 * on those of the axes by default follow them. `options` may be NULL. BCIFS_NO when an equation does not hold
 * identically in the params of the axes. The automaton must outlive the map. */
BCIFS_PUBLIC bcifs_status bcifs_map_create(const bcifs_automaton *automaton, const char *const *axes,
                                           size_t axis_count, const bcifs_map_options *options, bcifs_map **map,
                                           bcifs_error *error);
BCIFS_PUBLIC void bcifs_map_free(bcifs_map *map);
BCIFS_PUBLIC size_t bcifs_map_axis_count(const bcifs_map *map);
/* The param of an axis; NULL past the last. */
BCIFS_PUBLIC const char *bcifs_map_parameter(const bcifs_map *map, size_t axis);
/* The number of nodes of an axis (1 past the last), and the value at one of them. */
BCIFS_PUBLIC size_t bcifs_map_count(const bcifs_map *map, size_t axis);
BCIFS_PUBLIC double bcifs_map_value(const bcifs_map *map, size_t axis, size_t index);
/* The class at node i of the first axis and j of the second (0 without one). */
BCIFS_PUBLIC bcifs_map_class bcifs_map_at(const bcifs_map *map, size_t i, size_t j);
/* "undecided", "not-contractive", "contractive", "tangent-continuous", "C1". */
BCIFS_PUBLIC const char *bcifs_map_class_name(bcifs_map_class which);
/* Draws the map (svg, png) or lists it (csv: params and class, the second param changing fastest). Of `options` the
 * format, the command and the width are used. */
BCIFS_PUBLIC bcifs_status bcifs_map_write(const bcifs_map *map, const char *path, const bcifs_write_options *options,
                                          bcifs_error *error);

#ifdef __cplusplus
}
#endif

#endif
