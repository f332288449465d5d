/* Syntax: the tree of one automaton file, as docs/language.md describes the language.
 *
 * The parser makes it, the printer writes it back in canonical layout, the binder (lib/automaton) resolves its
 * names in place. All nodes live in the arena of the parse. Every node that can be blamed has a place; every node
 * that is printed knows its first and last token, so that the printer repeats what was written, comments included. */
#ifndef LANGUAGE_SYNTAX_H
#define LANGUAGE_SYNTAX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "language/report.h"
#include "language/source.h"

enum {
    SYNTAX_DEEPEST = 200,          /* nesting of parentheses, calls, signs, powers and `for` */
    SYNTAX_TALLEST = 1000,         /* height of an expression's tree: a sum of that many terms */
    SYNTAX_MOST_TOKENS = 1 << 21,  /* of one file: twice what its largest matrix takes */
    SYNTAX_LONGEST_NAME = 128,     /* bytes of a name */
    SYNTAX_MOST_ENTRIES = 1 << 20, /* entries of one matrix: 1024 x 1024 */
    SYNTAX_MOST_ARGUMENTS = 16     /* of a state or a let */
};

/* ---- Tokens -------------------------------------------------------------------------------------------- */

enum token_kind {
    TOKEN_NAME,
    TOKEN_NUMBER,
    TOKEN_STRING, /* "…": no escapes, no newline */
    TOKEN_MARK,   /* one of { } [ ] ( ) , ; = + - * / % ^ ? . .. */
    TOKEN_BAD,    /* bytes that are no token, already reported: nothing more is said about them */
    TOKEN_END
};

struct token {
    enum token_kind kind;
    source_place place; /* of its first byte */
    uint32_t length;    /* in bytes; a string's quotes included */
    bool space_before;  /* white space, a newline or a comment stands before it */
    bool line_before;   /* a newline stands before it */
};

/* `# …` to the end of the line; kept for the printer. */
struct comment {
    source_place place;
    uint32_t length; /* without trailing white space */
};

/* ---- Expressions --------------------------------------------------------------------------------------- */

enum expression_kind {
    EXPRESSION_NUMBER,
    EXPRESSION_NAME,
    EXPRESSION_CALL,    /* name(operands…) */
    EXPRESSION_NEGATE,  /* -operands[0]; a unary plus makes no node */
    EXPRESSION_ADD,     /* operands[0] + operands[1]; the rest likewise */
    EXPRESSION_SUBTRACT,
    EXPRESSION_MULTIPLY,
    EXPRESSION_DIVIDE,
    EXPRESSION_REMAINDER, /* % */
    EXPRESSION_POWER,     /* ^, binds to the right and tighter than a sign before it: -a^2 = -(a^2) */
    EXPRESSION_POINT,     /* p[operands[0]]: a control point, in rules */
    EXPRESSION_SUM,       /* sum(name in operands[0]..operands[1], operands[2]) */
    EXPRESSION_UNKNOWN    /* ? */
};

/* What a name stands for; EXPRESSION_NAME and EXPRESSION_CALL are resolved by expression_resolve. */
enum binding_kind { BINDING_NONE, BINDING_PARAMETER, BINDING_ARGUMENT, BINDING_LOCAL, BINDING_LET, BINDING_BUILTIN };

struct expression {
    enum expression_kind kind;
    uint32_t first, last; /* tokens, parentheses around it included */
    source_place place;   /* of the number, the name or the operator */
    uint32_t height;      /* 1 for a leaf */
    const char *name;     /* NAME, CALL, SUM: NUL-terminated */
    struct expression **operands;
    size_t count;
    enum binding_kind binding;
    uint32_t index;           /* of the parameter, argument, local, builtin or unknown */
    struct syntax_let *let;   /* BINDING_LET */
    double number;            /* NUMBER: rounded to the nearest double */
    uint64_t residue;         /* NUMBER: in the prime field (numeric/field.h) */
    bool exact;               /* NUMBER: an integer, or a decimal of fewer than 15 significant digits */
};

/* `[ … ]`. Rows have equal lengths. */
struct syntax_matrix {
    uint32_t first, last; /* tokens of the brackets */
    source_place place;   /* of the opening bracket */
    size_t rows, columns;
    struct expression **entries; /* row after row */
};

/* ---- Items --------------------------------------------------------------------------------------------- */

/* NAME ["." NAME] ["(" expr, … ")"] */
struct syntax_reference {
    uint32_t first, last;
    source_place place;
    const char *module; /* the name before the point, or NULL */
    const char *name;
    struct expression **arguments;
    size_t count;
    bool has_arguments; /* parentheses were written */
    struct reference *target; /* what it names; set by the binder (automaton/automaton.h) */
};

/* q[index] = value, or for variable in from..to { body } */
struct syntax_rule {
    uint32_t first, last;
    source_place place;
    bool is_loop;
    struct expression *index, *value; /* of an assignment */
    const char *variable;
    source_place variable_place;
    struct expression *from, *to;
    struct syntax_rules *body;
};

struct syntax_rules {
    uint32_t first, last; /* the braces */
    source_place place;
    struct syntax_rule **rules;
    size_t count;
};

/* What follows a boundary's state: `at` and indices, `at` and a one-row matrix of index expressions, or a matrix.
 * Exactly one of `matrix` (given without `at`) and `indices` is set. */
struct syntax_location {
    source_place place;
    struct expression **indices; /* a point each, numbers or expressions */
    size_t count;
    bool bracketed;               /* the indices were written in brackets: `row` */
    struct syntax_matrix *row;    /* those brackets */
    struct syntax_matrix *matrix; /* m_x × m_y */
};

enum part_kind { PART_SUB, PART_START, PART_END, PART_BOUNDARY, PART_JOIN, PART_REFINE, PART_MASK };

struct syntax_part {
    enum part_kind kind;
    uint32_t first, last;
    source_place place;                /* of its keyword */
    const char *name;                  /* BOUNDARY: its name; START "start", END "end" */
    source_place name_place;
    struct syntax_reference *reference; /* SUB: the child; START, END, BOUNDARY: the boundary's state */
    struct syntax_matrix *matrix;      /* SUB, REFINE (or rules), MASK */
    struct syntax_rules *rules;        /* SUB, REFINE */
    struct syntax_location location;   /* START, END, BOUNDARY */
    uint64_t number;                   /* REFINE, MASK: N */
    source_place number_place;
    uint64_t child[2];                 /* JOIN: child[0].boundary[0] = child[1].boundary[1] */
    const char *boundary[2];
    source_place side[2];              /* JOIN: place of each side */
    bool reversed;
};

enum cell_kind { CELL_VERTEX, CELL_EDGE, CELL_FACE, CELL_CELL };

struct syntax_cell {
    enum cell_kind kind;
    uint32_t first, last;
    source_place place; /* of its name */
    const char *name;
    const char **arguments; /* names */
    source_place *argument_places;
    size_t argument_count;
    struct expression *points; /* number of control points, or NULL */
    bool affine;               /* `affine D`: maps are D × (D+1) */
    uint64_t dimension;        /* D */
    source_place dimension_place;
    struct syntax_part **parts;
    size_t part_count;
    struct syntax_reference *factors[2]; /* face NAME = a * b: both set, no parts */
};

struct syntax_use {
    uint32_t first, last;
    source_place place; /* of the string */
    const char *path;   /* without quotes */
    const char *name;   /* after `as`, or NULL */
    source_place name_place;
};

struct syntax_parameter {
    uint32_t first, last;
    source_place place; /* of its name */
    const char *name;
    struct expression *value;
    struct expression *low, *high; /* both NULL without `in` */
    uint32_t index;                /* in the automaton's parameters; set by the binder */
};

struct syntax_let {
    uint32_t first, last;
    source_place place; /* of its name */
    const char *name;
    const char **arguments;
    source_place *argument_places;
    size_t argument_count;
    bool has_arguments;
    struct expression *value;
    int resolving;   /* 0 not yet, 1 under way, 2 done, 3 with mistakes; used by expression_resolve */
    uint32_t height; /* of its tree with those of the lets it calls below it; once resolved */
    bool structural; /* its params have been marked; used by expression_mark */
};

struct syntax_wavelet {
    uint32_t first, last;
    source_place place;
    struct syntax_reference *reference;
    int64_t smooth_offset, detail_offset;
    struct syntax_matrix *smooth, *detail;
};

enum figure_part_kind {
    FIGURE_OPEN,
    FIGURE_CLOSED,
    FIGURE_PIECE,
    FIGURE_SIZE,
    FIGURE_INTERVALS,
    FIGURE_POINTS,
    FIGURE_DISPLACE
};

struct syntax_figure_part {
    enum figure_part_kind kind;
    uint32_t first, last;
    source_place place;                 /* of its keyword */
    struct syntax_reference *reference; /* OPEN, CLOSED, PIECE */
    uint64_t *numbers;                  /* PIECE: indices; SIZE: two; DISPLACE: level, then one or two indices */
    source_place *number_places;
    size_t number_count;
    struct syntax_matrix *matrix; /* INTERVALS, POINTS, DISPLACE */
};

struct syntax_figure {
    uint32_t first, last;
    source_place place; /* of its name */
    const char *name;
    struct syntax_figure_part **parts;
    size_t part_count;
};

enum item_kind { ITEM_USE, ITEM_PARAMETER, ITEM_LET, ITEM_CELL, ITEM_WAVELET, ITEM_FIGURE };

struct syntax_item {
    enum item_kind kind;
    union {
        struct syntax_use *use;
        struct syntax_parameter *parameter;
        struct syntax_let *let;
        struct syntax_cell *cell;
        struct syntax_wavelet *wavelet;
        struct syntax_figure *figure;
    };
};

struct syntax_file {
    const struct source *source;
    uint32_t header_first, header_last; /* tokens of `automaton NAME ["title"]` */
    const char *name, *title;           /* title "" without one */
    source_place name_place;
    struct syntax_item *items;
    size_t count;
    struct token *tokens; /* TOKEN_END is the last */
    size_t token_count;
    struct comment *comments;
    size_t comment_count;
};

/* ---- Functions ----------------------------------------------------------------------------------------- */

/* Characters to tokens and comments: fills those fields of `file`. */
bcifs_status syntax_scan(struct arena *arena, const struct source *source, struct report *report,
                         struct syntax_file *file);
/* Text to tree. Reports every independent syntax error (up to REPORT_MOST) and then returns BCIFS_INPUT. */
bcifs_status syntax_parse(struct arena *arena, const struct source *source, struct report *report,
                          struct syntax_file **file);
/* A single expression, all of the source: the right side of --set. */
bcifs_status syntax_parse_expression(struct arena *arena, const struct source *source, struct report *report,
                                     struct expression **expression);
/* The part of a kind that is number `number` of them, from 0; NULL when there are not so many. */
const struct syntax_part *syntax_part_of_kind(const struct syntax_cell *cell, enum part_kind kind, size_t number);
/* The file in canonical layout. Formatting its own result changes nothing. */
void syntax_print(const struct syntax_file *file, struct text *text);

#endif
