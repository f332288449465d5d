/* Parser: what the files of the recursive descent share: the position, the questions asked about the next
 * token, the one routine that reports errors, and recovery.
 *
 * A parsing function returns NULL (or false) when it failed, having reported why; the part or item it belongs
 * to is then given up and parsing resumes at the next. No word is reserved: each is looked at only where it
 * can mean something. */
#ifndef LANGUAGE_PARSER_H
#define LANGUAGE_PARSER_H

#include "language/syntax.h"

struct parser {
    struct arena *arena;
    struct report *report;
    struct syntax_file *file;
    uint32_t next;  /* index of the next token */
    unsigned depth; /* of nesting, see SYNTAX_DEEPEST */
    bool in_row;    /* inside [ ] at parenthesis depth 0, where white space separates */
    bool in_rules;  /* where p[…] and sum(… in …) have a meaning */
    bool out_of_memory;
    bool has_error; /* an error was reported, the last one at: */
    source_place last_error;
};

/* A list of keywords and the text that introduces it in messages. */
struct word_list {
    const char *const *words;
    size_t count;
};

/* ---- Tokens -------------------------------------------------------------------------------------------- */

const struct token *parser_token(const struct parser *p, uint32_t index);
/* The next token, and the one after it. */
const struct token *parser_next(const struct parser *p);
const struct token *parser_after(const struct parser *p);
bool token_is_mark(const struct parser *p, const struct token *token, const char *mark);
bool token_is_word(const struct parser *p, const struct token *token, const char *word);
/* The index of the keyword that the token is, or -1. */
int token_find_word(const struct parser *p, const struct token *token, const struct word_list *list);
bool parser_at_mark(const struct parser *p, const char *mark);
bool parser_at_word(const struct parser *p, const char *word);
/* Steps over the mark or word if it is next. */
bool parser_accept_mark(struct parser *p, const char *mark);
bool parser_accept_word(struct parser *p, const char *word);
/* The same, reporting "expected 'mark' `context`, found …" if it is not next. */
bool parser_expect_mark(struct parser *p, const char *mark, const char *context);
bool parser_expect_word(struct parser *p, const char *word, const char *context);
/* NAME: a copy of it, or NULL after reporting "expected `what`, found …". `place` may be NULL. */
const char *parser_name(struct parser *p, const char *what, source_place *place);
/* STRING, without its quotes. */
const char *parser_string(struct parser *p, const char *what, source_place *place);
/* NUMBER without point, exponent and sign, from `least` to `most`. */
bool parser_integer(struct parser *p, const char *what, uint64_t least, uint64_t most, uint64_t *number,
                    source_place *place);

enum { PARSER_MOST_INTEGER = 0x7fffffff };

/* ---- Errors and memory --------------------------------------------------------------------------------- */

/* Reports at `place`; all errors of the parser go through here. */
void parser_error(struct parser *p, source_place place, const char *format, ...) TEXT_FORMAT(3, 4);
/* Reports "expected `format`, found …" at the next token. */
void parser_expected(struct parser *p, const char *format, ...) TEXT_FORMAT(2, 3);
/* The same for keywords: "expected `lead` one of …, found …; did you mean …?". `lead` may be "". */
void parser_expected_word(struct parser *p, const char *lead, const struct word_list *list);
/* The same for the parts of the block whose brace is token `open`, or its closing brace. */
void parser_expected_part(struct parser *p, uint32_t open, const struct word_list *list);
/* Reports that the brace at token `open` is not closed, where the file ends. */
void parser_expected_closing(struct parser *p, uint32_t open);
/* Whether parsing should end: no memory, or enough errors. */
bool parser_stopped(const struct parser *p);
/* From the arena; NULL, remembered in out_of_memory, when there is none. */
void *parser_new(struct parser *p, size_t count, size_t size);
/* Counts one more level of nesting; false after reporting that there are too many. */
bool parser_enter(struct parser *p);
void parser_leave(struct parser *p);

/* PARSER_RESERVE(p, array, count, capacity): room for one more element, or false. */
#define PARSER_RESERVE(p, array, count, capacity)                                                            \
    (ARENA_RESERVE((p)->arena, array, count, capacity) || ((p)->out_of_memory = true, false))

/* ---- Recovery ------------------------------------------------------------------------------------------ */

/* Whether a construct can begin at token `index`. */
typedef bool parser_starts(const struct parser *p, uint32_t index);

/* Whether an item begins there at the left margin, which it does inside of braces only when one is missing.
 */
bool parser_item_at_margin(const struct parser *p, uint32_t index);
/* Gives up what began at token `first`: goes to where the next part of the block begins, or to its `}`. */
void parser_recover_part(struct parser *p, uint32_t first, parser_starts *starts);

/* ---- Productions, each documented where it is parsed --------------------------------------------------- */

struct expression *parse_expression(struct parser *p);
/* A number literal, for places where only that may stand. */
struct expression *parse_number(struct parser *p);
/* "(" expr { "," expr } ")" */
bool parse_arguments(struct parser *p, struct expression ***arguments, size_t *count);
struct expression *parse_entry(struct parser *p);
struct syntax_matrix *parse_matrix(struct parser *p, const char *context);
struct syntax_rules *parse_rules(struct parser *p);
struct syntax_reference *parse_reference(struct parser *p, const char *what);
/* "(" NAME { "," NAME } ")", no name twice. */
bool parse_argument_names(struct parser *p, const char ***names, source_place **places, size_t *count);
struct syntax_cell *parse_cell(struct parser *p);
struct syntax_wavelet *parse_wavelet(struct parser *p);
struct syntax_figure *parse_figure(struct parser *p);

#endif
