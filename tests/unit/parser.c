/* The parser: the tree it makes of each construct, every diagnostic with its place, recovery, limits, and
 * inputs that are cut, damaged or hostile. */
#include "language/syntax.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/text.h"
#include "numeric/field.h"
#include "tap.h"

/* All findings, a line each: "line:column message". */
static void see(void *context, const bcifs_diagnostic *diagnostic)
{
    text_format(context, "%u:%u %s\n", diagnostic->line, diagnostic->column, diagnostic->message);
}

/* A parse and what belongs to it. */
struct parse {
    struct arena arena;
    struct text findings;
    struct syntax_file *file;
    bcifs_status status;
};

static void parse_bytes(struct parse *parse, const char *text, size_t length)
{
    *parse = (struct parse){0};
    bcifs_load_options options = {.report = see, .context = &parse->findings};
    struct report report = report_new(&options);
    struct source *source;
    text_append(&parse->findings, "");
    parse->status = source_from_text(&parse->arena, "test", text, length, &report, &source);
    if (parse->status == BCIFS_OK)
        parse->status = syntax_parse(&parse->arena, source, &report, &parse->file);
}

static void parse_free(struct parse *parse)
{
    arena_free(&parse->arena);
    text_free(&parse->findings);
}

/* ---- Diagnostics --------------------------------------------------------------------------------------- */

/* What stands around the text of a case. */
enum frame { FILE_, ITEM, VALUE, CELL, FIGURE };

static const char *const BEFORE[] = {[FILE_] = "",
                                     [ITEM] = "automaton t\n",
                                     [VALUE] = "automaton t\nparam a = ",
                                     [CELL] = "automaton t\nedge arc 3 {\n",
                                     [FIGURE] = "automaton t\nfigure f {\n"};
static const char *const AFTER[] = {
    [FILE_] = "", [ITEM] = "", [VALUE] = "\n", [CELL] = "\n}\n", [FIGURE] = "\n}\n"};

static const struct {
    enum frame frame;
    const char *text;
    unsigned line, column;
    const char *message;
} DIAGNOSTICS[] = {
    /* header */
    {FILE_, "", 1, 1, "expected 'automaton' and a name at the start of the file, found the end of the file"},
    {FILE_, "automaton", 1, 10, "expected the automaton's name, found the end of the file"},
    /* items */
    {ITEM, "edgee arc 3 { }", 2, 1,
     "expected one of use, param, let, vertex, edge, face, cell, wavelet, figure, found 'edgee'; did you "
     "mean 'edge'?"},
    {ITEM, "use", 2, 4, "expected a file's path in quotes after 'use', found the end of the file"},
    {ITEM, "use \"x\" as", 2, 11, "expected a name after 'as', found the end of the file"},
    {ITEM, "param", 2, 6, "expected a name after 'param', found the end of the file"},
    {ITEM, "param a 3", 2, 9, "expected '=' and a value after the param's name, found '3'"},
    {ITEM, "param a =", 2, 10, "expected an expression, found the end of the file"},
    {ITEM, "param a = 1 in 0", 2, 17,
     "expected '..' between the bounds of the param, found the end of the file"},
    {ITEM, "let", 2, 4, "expected a name after 'let', found the end of the file"},
    {ITEM, "let f(", 2, 7, "expected an argument's name, found the end of the file"},
    {ITEM, "let f(u", 2, 8, "expected ')' or ',' after an argument's name, found the end of the file"},
    {ITEM, "let f(u,v,u) = 1", 2, 11, "the argument 'u' is named twice"},
    {ITEM, "let f(a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p,q) = 1", 2, 39,
     "there are more than 16 arguments, the limit"},
    {ITEM, "let f(u)", 2, 9, "expected '=' and a value after the name of the let, found the end of the file"},
    {ITEM, "wavelet", 2, 8, "expected the state that the filters are for, found the end of the file"},
    {ITEM, "figure", 2, 7, "expected the figure's name, found the end of the file"},
    {ITEM, "figure f", 2, 9, "expected '{' before the figure's parts, found the end of the file"},
    {ITEM, "edge", 2, 5, "expected the cell's name, found the end of the file"},
    {ITEM, "edge arc", 2, 9, "expected the number of control points or '{', found the end of the file"},
    {ITEM, "edge arc 3", 2, 11, "expected '{' before the cell's parts, found the end of the file"},
    {ITEM, "edge arc = a*b", 2, 10, "expected '{' (only a face is a product of two edges), found '='"},
    {ITEM, "face f = ", 2, 10, "expected the first edge of the product, found the end of the file"},
    {ITEM, "face f = a", 2, 11, "expected '*' between the edges of the product, found the end of the file"},
    {ITEM, "face f = a*", 2, 12, "expected the second edge of the product, found the end of the file"},
    {ITEM, "edge arc affine x { }", 2, 17,
     "expected the dimension after 'affine', an integer from 1 to 16, found 'x'"},
    {ITEM, "edge arc 3 {", 2, 13,
     "expected the '}' that closes the '{' of line 2, found the end of the file"},
    /* expressions */
    {VALUE, "*2", 2, 11, "expected an expression, found '*'"},
    {VALUE, "(1", 3, 1, "expected ')' or an operator, found the end of the file"},
    {VALUE, "f(1", 3, 1, "expected ')' or ',' after an argument, found the end of the file"},
    {VALUE, "1e999", 2, 11, "this number is too large: the largest is about 1.8e308"},
    {VALUE, "2 3", 2, 13,
     "expected one of use, param, let, vertex, edge, face, cell, wavelet, figure, found '3'"},
    /* parts */
    {CELL, "strat joint at 0 1", 3, 1,
     "expected '}' or one of sub, start, end, boundary, join, refine, mask, found 'strat'; did you mean "
     "'start'?"},
    {CELL, "sub", 4, 1, "expected the child's state after 'sub', found '}'"},
    {CELL, "sub a", 4, 1, "expected a matrix in '[ ]' or rules in '{ }', found '}'"},
    {CELL, "sub a.", 4, 1, "expected a name after the '.', found '}'"},
    {CELL, "sub a(", 4, 1, "expected an expression, found '}'"},
    {CELL, "start", 4, 1, "expected the boundary's state, found '}'"},
    {CELL, "start a", 4, 1, "expected 'at' and control points' indices, or a matrix in '[ ]', found '}'"},
    {CELL, "start a at", 4, 1, "expected control points' indices, as in at 0 1 or at [ n n+1 ], found '}'"},
    {CELL, "start a at 1.5", 3, 12,
     "expected a control point's index, an integer below 2147483648, found '1.5'"},
    {CELL, "start a at []", 3, 13, "expected an entry: a row may not be empty, found ']'"},
    {CELL, "start a at [0;1]", 3, 15, "the indices after 'at' stand in one row, found 2 rows"},
    {CELL, "start a at [0 ?]", 3, 15, "expected an index, found '?': only a matrix has open entries"},
    {CELL, "start a [", 4, 1, "expected an entry or the ']' that closes the '[' of line 3, found '}'"},
    {CELL, "boundary", 4, 1, "expected the boundary's name, found '}'"},
    {CELL, "boundary a", 4, 1, "expected '=' after the boundary's name, found '}'"},
    {CELL, "join", 4, 1, "expected a child's number, an integer below 2147483648, found '}'"},
    {CELL, "join 0", 4, 1, "expected '.' between the child's number and its boundary, found '}'"},
    {CELL, "join 0.", 4, 1, "expected the name of a boundary, found '}'"},
    {CELL, "join 0.end", 4, 1, "expected '=' between the sides of the join, found '}'"},
    {CELL, "refine", 4, 1, "expected the number of subdivisions, an integer below 2147483648, found '}'"},
    {CELL, "mask 2", 4, 1, "expected '[' and the mask's row of coefficients, found '}'"},
    /* matrices */
    {CELL, "sub a [ ]", 3, 9, "expected an entry: a row may not be empty, found ']'"},
    {CELL, "sub a []", 3, 8, "expected an entry: a row may not be empty, found ']'"},
    {CELL, "sub a [\n\n]", 5, 1, "expected an entry: a row may not be empty, found ']'"},
    {CELL, "sub a [ ; 1 ]", 3, 9, "expected an entry: a row may not be empty, found ';'"},
    {CELL, "sub a [ 1 ;; 2 ]", 3, 12, "expected an entry: a row may not be empty, found ';'"},
    {CELL, "sub a [ 1;\n; 2 ]", 4, 1, "expected an entry: a row may not be empty, found ';'"},
    {CELL, "sub a [ 1 2; 3 ]", 3, 14, "row 2 has 1 entry, expected 2 as in row 1"},
    {CELL, "sub a [ 1 2\n 3 4 5\n 6 ]", 4, 2, "row 2 has 3 entries, expected 2 as in row 1"},
    {CELL, "sub a [ 1 2\n 3 4", 5, 1,
     "expected an entry or the ']' that closes the '[' of line 3, found '}'"},
    {CELL, "sub a [ 1 2\n sub b [ 1 ]", 4, 8,
     "expected an entry or the ']' that closes the '[' of line 3, found '['"},
    {CELL, "sub a [ 1 2 }", 3, 13, "expected an entry or the ']' that closes the '[' of line 3, found '}'"},
    {CELL, "sub a [ 1 - 2 ]", 3, 11,
     "expected an entry, found '-' with a space beside it: inside [ ] an operator with spaces around it must "
     "go in parentheses, as in (1 - a)"},
    {CELL, "sub a [ 1- 2 ]", 3, 10,
     "expected an entry, found '-' with a space beside it: inside [ ] an operator with spaces around it must "
     "go in parentheses, as in (1 - a)"},
    {CELL, "sub a [ 1 * 2 ]", 3, 11,
     "expected an entry, found '*' with a space beside it: inside [ ] an operator with spaces around it must "
     "go in parentheses, as in (1 - a)"},
    {CELL, "sub a [ 1 *2 ]", 3, 11,
     "expected an entry, found '*' with a space beside it: inside [ ] an operator with spaces around it must "
     "go in parentheses, as in (1 - a)"},
    {CELL, "sub a [ 1* 2 ]", 3, 10,
     "expected an entry, found '*' with a space beside it: inside [ ] an operator with spaces around it must "
     "go in parentheses, as in (1 - a)"},
    {CELL, "sub a [ 1 ^2 ]", 3, 11,
     "expected an entry, found '^' with a space beside it: inside [ ] an operator with spaces around it must "
     "go in parentheses, as in (1 - a)"},
    {CELL, "sub a [ - ]", 3, 9,
     "expected an entry, found '-' with a space beside it: inside [ ] an operator with spaces around it must "
     "go in parentheses, as in (1 - a)"},
    {CELL, "sub a [ - 1 ]", 3, 9,
     "expected an entry, found '-' with a space beside it: inside [ ] an operator with spaces around it must "
     "go in parentheses, as in (1 - a)"},
    {CELL, "sub a [ 1 - ]", 3, 11,
     "expected an entry, found '-' with a space beside it: inside [ ] an operator with spaces around it must "
     "go in parentheses, as in (1 - a)"},
    {CELL, "sub a [ 1 -]", 3, 12, "expected an expression, found ']'"},
    {CELL, "sub a [ 1-]", 3, 11, "expected an expression, found ']'"},
    {CELL, "sub a [ 1 /\n2 ]", 3, 11,
     "expected an entry, found '/' with a space beside it: inside [ ] an operator with spaces around it must "
     "go in parentheses, as in (1 - a)"},
    {CELL, "sub a [ 1-? ]", 3, 11,
     "expected an expression, found '?': it may stand only as a whole entry of a matrix"},
    {CELL, "sub a [ ?-1 ]", 3, 9, "'?' may stand only as a whole entry of a matrix"},
    {CELL, "sub a [ ?? ]", 3, 10,
     "expected white space, ';' or the ']' that closes the '[' of line 3, found '?'"},
    {CELL, "sub a [ (?) ]", 3, 10,
     "expected an expression, found '?': it may stand only as a whole entry of a matrix"},
    {CELL, "sub a [ 2(a) ]", 3, 10,
     "expected white space, ';' or the ']' that closes the '[' of line 3, found '('"},
    {CELL, "sub a [ f(1)(2) ]", 3, 13,
     "expected white space, ';' or the ']' that closes the '[' of line 3, found '('"},
    {CELL, "sub a [ 1,2 ]", 3, 10,
     "expected white space, ';' or the ']' that closes the '[' of line 3, found ','"},
    {CELL, "sub a [ 1=2 ]", 3, 10,
     "expected white space, ';' or the ']' that closes the '[' of line 3, found '='"},
    {CELL, "sub a [ 0..1 ]", 3, 10,
     "expected white space, ';' or the ']' that closes the '[' of line 3, found '..'"},
    {CELL, "sub a [ p[0] 1 ]", 3, 9,
     "expected an expression, found a control point 'p[': it may stand only in rules, as in sub arc { q[0] = "
     "p[0] }"},
    {CELL, "sub a [ (1 ]", 3, 12, "expected ')' or an operator, found ']'"},
    {CELL, "sub a [ f(1 ]", 3, 13, "expected ')' or ',' after an argument, found ']'"},
    {CELL, "sub a [ sum(i in 0..1, i) ]", 3, 9,
     "expected an expression, found a sum over an index: it may stand only in rules, as in sub arc { q[0] = "
     "sum(i in 0..3, p[i]/4) }"},
    {CELL, "sub a [ \"s\" ]", 3, 9, "expected an expression, found \"s\""},
    {CELL, "sub a [ 1 { ]", 3, 11, "expected an entry or the ']' that closes the '[' of line 3, found '{'"},
    {CELL, "sub a [ & ]", 3, 9, "'&' is not a character of the language"},
    /* rules */
    {CELL, "sub a {", 5, 1, "expected the '}' that closes the '{' of line 2, found the end of the file"},
    {CELL, "sub a { x", 3, 9, "expected '}' or a rule, q[…] = … or for … in …, found 'x'"},
    {CELL, "sub a { q[ ] = 1 }", 3, 12, "expected an expression, found ']'"},
    {CELL, "sub a { q[0 = 1 }", 3, 13, "expected ']' or an operator after the new point's index, found '='"},
    {CELL, "sub a { q[0] 1 }", 3, 14, "expected '=' after the new point, found '1'"},
    {CELL, "sub a { q[0] = p[0 }", 3, 20, "expected ']' or an operator after the point's index, found '}'"},
    {CELL, "sub a { for }", 3, 13, "expected the loop's index after 'for', found '}'"},
    {CELL, "sub a { for i }", 3, 15, "expected 'in' after the loop's index, found '}'"},
    {CELL, "sub a { for i in 0 }", 3, 20, "expected '..' between the bounds of the loop, found '}'"},
    {CELL, "sub a { for i in 0..1 }", 3, 23, "expected '{' and rules, found '}'"},
    {CELL, "sub a { q[0] = sum(i in 0, 1) }", 3, 26,
     "expected '..' between the bounds of the sum, found ','"},
    {CELL, "sub a { q[0] = sum(i in 0..1) }", 3, 29, "expected ',' after the bounds of the sum, found ')'"},
    {CELL, "sub a { q[0] = sum(i in 0..1, i }", 3, 33, "expected ')' after the sum, found '}'"},
    /* figures */
    {FIGURE, "clsed arc", 3, 1,
     "expected '}' or one of open, closed, piece, size, intervals, points, displace, found 'clsed'; did you "
     "mean 'closed'?"},
    {FIGURE, "open", 4, 1, "expected the state of the pieces, found '}'"},
    {FIGURE, "piece", 4, 1, "expected the state of the piece, found '}'"},
    {FIGURE, "piece a", 4, 1, "expected 'at' and the piece's control points, found '}'"},
    {FIGURE, "piece a at", 4, 1, "expected a control point's index, an integer below 2147483648, found '}'"},
    {FIGURE, "size", 4, 1, "expected a number of rows or columns, an integer below 2147483648, found '}'"},
    {FIGURE, "intervals", 4, 1, "expected '[' and the intervals, found '}'"},
    {FIGURE, "points", 4, 1, "expected '[' and the control points, one a row, found '}'"},
    {FIGURE, "displace", 4, 1,
     "expected a level or the index of a point, an integer below 2147483648, found '}'"},
    {FIGURE, "displace 1 2", 4, 1, "expected '[' and the displacement, found '}'"},
    /* wavelets */
    {ITEM, "wavelet a", 2, 10, "expected '{' before the filters, found the end of the file"},
    {ITEM, "wavelet a {", 2, 12, "expected 'smooth' and a filter, found the end of the file"},
    {ITEM, "wavelet a { smooth [1] }", 2, 20,
     "expected the index of the filter's first coefficient, an integer below 2147483648, found '['"},
    {ITEM, "wavelet a { smooth -2 }", 2, 23, "expected '[' and the filter's row of coefficients, found '}'"},
    {ITEM, "wavelet a { smooth 1 [1] }", 2, 26, "expected 'detail' and a filter, found '}'"},
    {ITEM, "wavelet a { smooth 1 [1] detail 1 [1] x }", 2, 39, "expected '}' after the filters, found 'x'"},
};

static void check_findings(const char *name, const char *text, const char *expected)
{
    struct parse parse;
    parse_bytes(&parse, text, strlen(text));
    bool refused = parse.status == BCIFS_INPUT && !parse.file;
    if (!ok((expected[0] ? refused : parse.status == BCIFS_OK) && strcmp(parse.findings.data, expected) == 0,
            "%s", name))
        note("got %s", parse.findings.data);
    parse_free(&parse);
}

static void test_diagnostics(void)
{
    for (size_t i = 0; i < sizeof DIAGNOSTICS / sizeof DIAGNOSTICS[0]; i++) {
        struct text text = {0}, expected = {0};
        enum frame frame = DIAGNOSTICS[i].frame;
        text_format(&text, "%s%s%s", BEFORE[frame], DIAGNOSTICS[i].text, AFTER[frame]);
        text_format(&expected, "%u:%u %s\n", DIAGNOSTICS[i].line, DIAGNOSTICS[i].column,
                    DIAGNOSTICS[i].message);
        check_findings(DIAGNOSTICS[i].message, text.data, expected.data);
        text_free(&text);
        text_free(&expected);
    }
}

/* ---- Recovery ------------------------------------------------------------------------------------------ */

static void test_recovery(void)
{
    check_findings(
        "three independent errors are all reported",
        "automaton t\n"
        "vertex joint 2 {\n"
        "  sub joint [ 1 0\n"
        "              0 1 2 ]\n"
        "}\n"
        "edge arc 3 {\n"
        "  strat joint at 0 1\n"
        "  end joint at 1 2\n"
        "  sub arc [ 1 0; 0 1 ]\n"
        "}\n"
        "param a = (1 + 2\n"
        "figure f {\n"
        "  closed arc\n"
        "}\n",
        "4:15 row 2 has 3 entries, expected 2 as in row 1\n"
        "7:3 expected '}' or one of sub, start, end, boundary, join, refine, mask, found 'strat'; did you "
        "mean 'start'?\n"
        "12:1 expected ')' or an operator, found 'figure'\n");
    check_findings("several in one cell",
                   "automaton t\n"
                   "edge arc 3 {\n"
                   "  start joint\n"
                   "  end joint at x\n"
                   "  sub arc { q[0] = p[0 q[1] = p[1] }\n"
                   "  join 0.end == 1.start sub arc 3 mask [ 1 ]\n"
                   "}\n"
                   "param b = 1\n",
                   "4:3 expected 'at' and control points' indices, or a matrix in '[ ]', found 'end'\n"
                   "4:16 expected control points' indices, as in at 0 1 or at [ n n+1 ], found 'x'\n"
                   "5:24 expected ']' or an operator after the point's index, found 'q'\n"
                   "6:15 expected a child's number, an integer below 2147483648, found '='\n"
                   "6:33 expected a matrix in '[ ]' or rules in '{ }', found '3'\n");
    check_findings(
        "a missing brace costs one error",
        "automaton t\n"
        "edge arc 3 {\n"
        "  sub arc [ 1 ]\n"
        "edge brc 3 {\n"
        "  sub brc [ 1 ]\n"
        "}\n",
        "4:1 expected '}' or one of sub, start, end, boundary, join, refine, mask, found 'edge'\n");
    check_findings("one inside rules too",
                   "automaton t\n"
                   "edge arc 3 {\n"
                   "  sub arc { for i in 0..2 { q[i] = p[i]\n"
                   "}\n"
                   "edge brc 3 { }\n"
                   "edge crc 3 {\n"
                   "  x\n"
                   "}\n",
                   "5:1 expected '}' or a rule, q[…] = … or for … in …, found 'edge'\n"
                   "7:3 expected '}' or one of sub, start, end, boundary, join, refine, mask, found 'x'\n");
    check_findings("a brace too many is an echo",
                   "automaton t\n"
                   "edge arc 3 {\n"
                   "  sub arc [ 1 2 }\n"
                   "}\n"
                   "param a = 1\n",
                   "3:17 expected an entry or the ']' that closes the '[' of line 3, found '}'\n");
    check_findings(
        "an item whose head is wrong is skipped whole",
        "automaton t\n"
        "edge 3 {\n"
        "  start joint at 0\n"
        "  x y z\n"
        "}\n"
        "edgy arc 3 { sub arc { q[0] = p[0] } }\n"
        "param a = 1 let\n",
        "2:6 expected the cell's name, found '3'\n"
        "6:1 expected one of use, param, let, vertex, edge, face, cell, wavelet, figure, found 'edgy'; did "
        "you mean 'edge'?\n"
        "8:1 expected a name after 'let', found the end of the file\n");
    check_findings("a missing value is noticed at the next item",
                   "automaton t\n"
                   "param a =\n"
                   "param b = 2\n"
                   "let c =\n"
                   "edge arc 3 {\n"
                   "  x\n"
                   "}\n",
                   "3:1 expected an expression, found 'param'\n"
                   "5:1 expected an expression, found 'edge'\n"
                   "6:3 expected '}' or one of sub, start, end, boundary, join, refine, mask, found 'x'\n");
    check_findings("what is no token is reported once, and parsing goes on",
                   "automaton t\n"
                   "param a = 1 & 2\n"
                   "param b = § + 1\n"
                   "param c = )\n",
                   "2:13 '&' is not a character of the language\n"
                   "3:11 '§' may stand in comments and strings only\n"
                   "4:11 expected an expression, found ')'\n");
    check_findings(
        "a header that is missing does not hide the rest",
        "vertex joint 2 {\n"
        "  sup joint [ 1 ]\n"
        "}\n",
        "1:1 expected 'automaton' and a name at the start of the file, found 'vertex'\n"
        "2:3 expected '}' or one of sub, start, end, boundary, join, refine, mask, found 'sup'; did you mean "
        "'sub'?\n");

    struct text many = {0};
    text_append(&many, "automaton t\n");
    for (int i = 0; i < 100; i++)
        text_append(&many, "param = 1\n");
    struct parse parse;
    parse_bytes(&parse, many.data, many.length);
    size_t lines = 0;
    for (const char *at = parse.findings.data; (at = strchr(at, '\n')) != NULL; at++)
        lines++;
    ok(lines == REPORT_MOST, "no more than %d errors are reported", REPORT_MOST);
    parse_free(&parse);
    text_free(&many);
}

/* ---- Expressions --------------------------------------------------------------------------------------- */

/* Writes the tree with all its parentheses. */
static void write_tree(struct text *text, const struct expression *node)
{
    static const char *const operators[] = {
        [EXPRESSION_ADD] = "+",    [EXPRESSION_SUBTRACT] = "-",  [EXPRESSION_MULTIPLY] = "*",
        [EXPRESSION_DIVIDE] = "/", [EXPRESSION_REMAINDER] = "%", [EXPRESSION_POWER] = "^"};
    switch (node->kind) {
    case EXPRESSION_NUMBER:
        text_append_number(text, node->number);
        return;
    case EXPRESSION_NAME:
        text_append(text, node->name);
        return;
    case EXPRESSION_UNKNOWN:
        text_append(text, "?");
        return;
    case EXPRESSION_NEGATE:
        text_append(text, "(-");
        write_tree(text, node->operands[0]);
        text_append(text, ")");
        return;
    case EXPRESSION_CALL:
    case EXPRESSION_SUM:
    case EXPRESSION_POINT:
        text_format(text, "%s%s", node->kind == EXPRESSION_SUM ? "Σ" : "",
                    node->kind == EXPRESSION_POINT ? "p" : node->name);
        for (size_t i = 0; i < node->count; i++) {
            text_append(text, i ? "," : "(");
            write_tree(text, node->operands[i]);
        }
        text_append(text, ")");
        return;
    default:
        text_append(text, "(");
        write_tree(text, node->operands[0]);
        text_append(text, operators[node->kind]);
        write_tree(text, node->operands[1]);
        text_append(text, ")");
    }
}

static struct expression *parse_value(struct arena *arena, const char *text)
{
    struct report report = report_new(NULL);
    struct source *source;
    struct expression *value = NULL;
    if (source_from_text(arena, "test", text, strlen(text), &report, &source) == BCIFS_OK)
        syntax_parse_expression(arena, source, &report, &value);
    return value;
}

static void check_tree(const char *text, const char *expected)
{
    struct arena arena = {0};
    struct text got = {0};
    struct expression *value = parse_value(&arena, text);
    if (value)
        write_tree(&got, value);
    if (!ok(value && strcmp(got.data, expected) == 0, "%s is %s", text, expected))
        note("got %s", value ? got.data : "an error");
    text_free(&got);
    arena_free(&arena);
}

static void test_expressions(void)
{
    check_tree("1+2*3", "(1+(2*3))");
    check_tree("1-2-3", "((1-2)-3)");
    check_tree("1/2/3*4%5", "((((1/2)/3)*4)%5)");
    check_tree("2^3^4", "(2^(3^4))");
    check_tree("-a^2", "(-(a^2))");
    check_tree("a^-b^2", "(a^(-(b^2)))");
    check_tree("-2*-3", "((-2)*(-3))");
    check_tree("--a", "(-(-a))");
    check_tree("+a - +b", "(a-b)");
    check_tree("(1 + 2)*3", "((1+2)*3)");
    check_tree("f(u, v)/min(1,2,3)", "(f(u,v)/min(1,2,3))");
    check_tree("u\t/ (2* ( u+v))", "(u/(2*(u+v)))");
    check_tree("p + q*sum", "(p+(q*sum))");
    check_tree("sum(i, in)", "sum(i,in)");
    check_tree(".5 + 1e-3", "(0.5+0.001)");

    struct arena arena = {0};
    ok(!parse_value(&arena, "") && !parse_value(&arena, "1 2") && !parse_value(&arena, "a)"),
       "a value is one expression and nothing else");
    const struct expression *node = parse_value(&arena, " ((a + b)) * c");
    ok(node && node->place == 11 && node->first == 0 && node->operands[0]->first == 0 &&
           node->operands[0]->last == 6 && node->operands[0]->place == 5 && node->last == 8 &&
           node->height == 3,
       "nodes know their tokens, parentheses included, and their places");
    arena_free(&arena);
}

static void check_number(const char *text, double number, uint64_t numerator, uint64_t denominator,
                         bool exact)
{
    struct arena arena = {0};
    const struct expression *node = parse_value(&arena, text);
    uint64_t residue = field_multiply(numerator, field_invert(denominator));
    bool is_same = node && !(node->number < number) && !(node->number > number);
    ok(is_same && node->residue == residue && node->exact == exact, "%s is %llu/%llu, %s", text,
       (unsigned long long)numerator, (unsigned long long)denominator, exact ? "exact" : "rounded");
    arena_free(&arena);
}

static void test_numbers(void)
{
    check_number("0", 0, 0, 1, true);
    check_number("12", 12, 12, 1, true);
    check_number("0.5", 0.5, 1, 2, true);
    check_number(".25", 0.25, 1, 4, true);
    check_number("2.50", 2.5, 5, 2, true);
    check_number("1e3", 1000, 1000, 1, true);
    check_number("125e-3", 0.125, 1, 8, true);
    check_number("1.5E+1", 15, 15, 1, true);
    check_number("0.00000000000000000001", 1e-20, 1, field_power(10, 20), true);
    check_number("0.12345678901234", 0.12345678901234, 12345678901234, 100000000000000, true);
    check_number("0.123456789012345", 0.123456789012345, 123456789012345, 1000000000000000, false);
    check_number("123456789012345", 123456789012345, 123456789012345, 1, true);
    check_number("2305843009213693951", 2305843009213693951.0, 0, 1, true);
    check_number("2305843009213693952", 2305843009213693952.0, 1, 1, true);
    check_number("1e300", 1e300, field_power(10, 300), 1, true);
    check_number("1e-400", 0, 1, field_power(10, 400), true);
    check_number("0e99", 0, 0, 1, true);
    check_number("1e-99999999999999999999", 0, 1, 1, false);
}

/* ---- Constructs ---------------------------------------------------------------------------------------- */

static void check_matrix(const char *text, size_t rows, size_t columns, const char *entries)
{
    struct text file = {0}, got = {0};
    struct parse parse;
    text_format(&file, "automaton t\nedge e { sub e %s }", text);
    parse_bytes(&parse, file.data, file.length);
    const struct syntax_matrix *matrix = NULL;
    if (parse.status == BCIFS_OK)
        matrix = parse.file->items[0].cell->parts[0]->matrix;
    text_append(&got, "");
    for (size_t i = 0; matrix && i < matrix->rows * matrix->columns; i++) {
        text_append(&got, i ? " " : "");
        write_tree(&got, matrix->entries[i]);
    }
    if (!ok(matrix && matrix->rows == rows && matrix->columns == columns && strcmp(got.data, entries) == 0,
            "a matrix of %zu rows and %zu columns: %s", rows, columns, entries))
        note("got %s%s", got.data, parse.findings.data);
    text_free(&file);
    text_free(&got);
    parse_free(&parse);
}

static void test_matrices(void)
{
    check_matrix("[1]", 1, 1, "1");
    check_matrix("[ 1 2; 3 4 ]", 2, 2, "1 2 3 4");
    check_matrix("[ 1 2\n 3 4 ]", 2, 2, "1 2 3 4");
    check_matrix("[\n\n 1 2;\n\n 3 4;\n]", 2, 2, "1 2 3 4");
    check_matrix("[ 1;2; ]", 2, 1, "1 2");
    check_matrix("[ 1\n; 2 # c ]\n# d\n\n ]", 2, 1, "1 2");
    check_matrix("[ 1-a 1 -a ]", 1, 3, "(1-a) 1 (-a)");
    check_matrix("[ -a^2 +b*-c ]", 1, 2, "(-(a^2)) (b*(-c))");
    check_matrix("[ (1 - a) f(u, v) f (u) ]", 1, 4, "(1-a) f(u,v) f u");
    check_matrix("[ (1\n -\n a) f(u,\n# c\n v) ]", 1, 2, "(1-a) f(u,v)");
    check_matrix("[ ? a; ? ? ]", 2, 2, "? a ? ?");
    check_matrix("[ sub end; q p ]", 2, 2, "sub end q p");
    check_matrix("[ 2^-1 1e-3 .5 ]", 1, 3, "(2^(-1)) 0.001 0.5");
}

static const char SAMPLE[] = "# Every construct once.\n"
                             "automaton sample \"Title with # and é\"\n"
                             "\n"
                             "use \"other.bcifs\" as other\n"
                             "use \"plain.bcifs\"\n"
                             "param a = 1/4 in 0..1/2 # range\n"
                             "param b = 2\n"
                             "let f(u,v) = u/(2*(u + v))\n"
                             "let c = -a^2\n"
                             "\n"
                             "vertex joint(u,v) 2 { sub joint(u,v) [ 1-f(u,v) f(v,u); f(u,v) 1-f(v,u) ] }\n"
                             "edge arc(n) 2*n+1 {\n"
                             "  start joint(n,1) at 0 1\n"
                             "  end other.joint at [ n n+1 ]\n"
                             "  boundary side = joint(1,1) [ 1 0; 0 1; 0 0 ]\n"
                             "  sub arc(n+1) [ 3/4 1/4 ? # row\n"
                             "                 # between\n"
                             "                 1/4 3/4 (1 - a) ]\n"
                             "  sub arc(n) {\n"
                             "    q[0] = 3/4*p[0] + 1/4*p[1] q[1] = -p[0]\n"
                             "    for i in 0..n-1 { q[i+1] = sum(j in 0..i, p[j]/(i+1)) for k in 0..1 { } }\n"
                             "  }\n"
                             "  join 0.end = 1.start reversed\n"
                             "  join 1.end = 2.start\n"
                             "  refine 2 [ 1 0; 0 1 ]\n"
                             "  refine 3 { q[0] = p[0] }\n"
                             "  mask 2 [ 1/8 1/2 3/4 1/2 1/8 ]\n"
                             "}\n"
                             "face sheet = arc(1) * other.arc\n"
                             "cell fern affine 2 { }\n"
                             "wavelet arc(1) { smooth -2 [ -1/4 3/4 ] detail 3 [ 1/4 ] }\n"
                             "figure one {\n"
                             "  open arc(1) closed arc piece arc at 0 1 2\n"
                             "  size 3 4\n"
                             "  intervals [ 1 2 3 ]\n"
                             "  points [ 0 0\n"
                             "           1 1 ]\n"
                             "  displace 1 2 [ 0 1 ] displace 1 2 3 [ 1 0 ]\n"
                             "}\n";

static bool same(const char *a, const char *b)
{
    return a && strcmp(a, b) == 0;
}

static void test_cell(const struct syntax_cell *arc)
{
    struct syntax_part **parts = arc->parts;
    ok(arc->kind == CELL_EDGE && same(arc->name, "arc") && arc->argument_count == 1 &&
           same(arc->arguments[0], "n") && arc->points && arc->points->kind == EXPRESSION_ADD &&
           arc->part_count == 10,
       "a cell has a kind, a name, arguments, points and parts");
    ok(parts[0]->kind == PART_START && same(parts[0]->name, "start") &&
           same(parts[0]->reference->name, "joint") && parts[0]->reference->count == 2 &&
           parts[0]->location.count == 2 && !parts[0]->location.bracketed &&
           parts[0]->location.indices[1]->residue == 1,
       "start … at 0 1");
    ok(parts[1]->kind == PART_END && same(parts[1]->reference->module, "other") &&
           parts[1]->location.bracketed && parts[1]->location.count == 2 && parts[1]->location.row &&
           !parts[1]->location.matrix,
       "end … at [ n n+1 ]");
    ok(parts[2]->kind == PART_BOUNDARY && same(parts[2]->name, "side") && parts[2]->location.matrix &&
           parts[2]->location.matrix->rows == 3 && !parts[2]->location.indices,
       "boundary … matrix");
    ok(parts[3]->kind == PART_SUB && parts[3]->matrix && !parts[3]->rules && parts[3]->matrix->columns == 3,
       "sub … matrix");
    const struct syntax_rules *rules = parts[4]->rules;
    ok(rules && rules->count == 3 && !rules->rules[0]->is_loop && rules->rules[2]->is_loop &&
           same(rules->rules[2]->variable, "i") && rules->rules[2]->body->count == 2 &&
           rules->rules[2]->body->rules[1]->body->count == 0,
       "sub … rules");
    ok(parts[5]->kind == PART_JOIN && parts[5]->child[0] == 0 && parts[5]->child[1] == 1 &&
           same(parts[5]->boundary[0], "end") && same(parts[5]->boundary[1], "start") && parts[5]->reversed &&
           !parts[6]->reversed,
       "join");
    ok(parts[7]->kind == PART_REFINE && parts[7]->number == 2 && parts[7]->matrix && parts[8]->rules &&
           parts[9]->kind == PART_MASK && parts[9]->matrix->columns == 5,
       "refine and mask");
}

static void test_figure(const struct syntax_figure *figure)
{
    struct syntax_figure_part **parts = figure->parts;
    ok(figure->part_count == 8 && parts[0]->kind == FIGURE_OPEN && parts[1]->kind == FIGURE_CLOSED &&
           parts[2]->kind == FIGURE_PIECE && parts[2]->number_count == 3 && parts[2]->numbers[2] == 2 &&
           parts[3]->kind == FIGURE_SIZE && parts[3]->numbers[1] == 4 && parts[4]->kind == FIGURE_INTERVALS &&
           parts[5]->kind == FIGURE_POINTS && parts[5]->matrix->rows == 2 && parts[6]->number_count == 2 &&
           parts[7]->kind == FIGURE_DISPLACE && parts[7]->number_count == 3,
       "a figure's parts, in any order");
}

static void test_constructs(void)
{
    struct parse parse;
    parse_bytes(&parse, SAMPLE, sizeof SAMPLE - 1);
    if (!ok(parse.status == BCIFS_OK && parse.file->count == 12, "a file with every construct")) {
        note("%s", parse.findings.data);
        parse_free(&parse);
        return;
    }
    const struct syntax_item *items = parse.file->items;
    ok(same(parse.file->name, "sample") && same(parse.file->title, "Title with # and é") &&
           parse.file->comment_count == 4,
       "its name, title and comments");
    ok(items[0].kind == ITEM_USE && same(items[0].use->path, "other.bcifs") &&
           same(items[0].use->name, "other") && !items[1].use->name,
       "use");
    ok(items[2].kind == ITEM_PARAMETER && same(items[2].parameter->name, "a") && items[2].parameter->high &&
           !items[3].parameter->low,
       "param");
    ok(items[4].kind == ITEM_LET && items[4].let->argument_count == 2 &&
           same(items[4].let->arguments[1], "v") && items[4].let->has_arguments &&
           !items[5].let->has_arguments,
       "let");
    test_cell(items[7].cell);
    ok(items[8].kind == ITEM_CELL && items[8].cell->kind == CELL_FACE &&
           same(items[8].cell->factors[0]->name, "arc") && same(items[8].cell->factors[1]->module, "other"),
       "a product");
    ok(items[9].cell->affine && items[9].cell->dimension == 2 && items[9].cell->part_count == 0,
       "an affine cell");
    ok(items[10].kind == ITEM_WAVELET && items[10].wavelet->smooth_offset == -2 &&
           items[10].wavelet->detail_offset == 3 && items[10].wavelet->smooth->columns == 2,
       "wavelet");
    ok(items[11].kind == ITEM_FIGURE, "figure");
    test_figure(items[11].figure);
    parse_free(&parse);

    check_findings(
        "keywords are not reserved",
        "automaton automaton\n"
        "param param = 1 let let = param param in = let in in..sub\n"
        "vertex vertex affine { sub vertex [ end ] }\n"
        "edge edge(start,end) at { start start at 0 end end at 1 sub sub(sub) [ sub ] join 0.end=1.sub }\n"
        "face face = face * face\n"
        "edge q { sub p { q[q] = q*p[p] + p q[1] = for for for in for..for { q[for] = sum(sum in 0..1,sum) } "
        "} }\n"
        "figure figure { open open points [ points ] piece piece at 0 }\n",
        "");
}

/* ---- Limits -------------------------------------------------------------------------------------------- */

/* `count` times `opening`, then `middle`, then `count` times `closing`. */
static void write_nested(struct text *text, const char *before, const char *opening, const char *middle,
                         const char *closing, size_t count, const char *after)
{
    text_append(text, before);
    for (size_t i = 0; i < count; i++)
        text_append(text, opening);
    text_append(text, middle);
    for (size_t i = 0; i < count; i++)
        text_append(text, closing);
    text_append(text, after);
}

static const struct {
    const char *before, *opening, *middle, *closing, *after;
    size_t most;
    const char *message;
} NESTED[] = {
    {"param a = ", "(", "1", ")", "", SYNTAX_DEEPEST, "this is nested more than 200 levels deep, the limit"},
    {"param a = ", "f(", "1", ")", "", SYNTAX_DEEPEST, "this is nested more than 200 levels deep, the limit"},
    {"param a = ", "-", "1", "", "", SYNTAX_DEEPEST, "this is nested more than 200 levels deep, the limit"},
    {"param a = ", "+", "1", "", "", SYNTAX_DEEPEST, "this is nested more than 200 levels deep, the limit"},
    {"param a = ", "2^", "1", "", "", SYNTAX_DEEPEST, "this is nested more than 200 levels deep, the limit"},
    {"edge e { sub e [ ", "(", "1", ")", " ] }", SYNTAX_DEEPEST,
     "this is nested more than 200 levels deep, the limit"},
    {"edge e { sub e { q[0] = ", "p[", "1", "]", " } }", SYNTAX_DEEPEST,
     "this is nested more than 200 levels deep, the limit"},
    {"edge e { sub e { q[0] = ", "sum(i in 0..1, ", "1", ")", " } }", SYNTAX_DEEPEST,
     "this is nested more than 200 levels deep, the limit"},
    {"edge e { sub e { ", "for i in 0..1 { ", "q[0] = p[0]", "}", " } }", SYNTAX_DEEPEST - 1,
     "this is nested more than 200 levels deep, the limit"},
    {"param a = ", "1+", "1", "", "", SYNTAX_TALLEST - 1,
     "this expression has more than 1000 operations on top of each other, the limit"},
    {"param a = ", "1/", "1", "", "", SYNTAX_TALLEST - 1,
     "this expression has more than 1000 operations on top of each other, the limit"},
};

static void test_limits(void)
{
    for (size_t i = 0; i < sizeof NESTED / sizeof NESTED[0]; i++) {
        for (size_t extra = 0; extra < 2; extra++) {
            struct text text = {0};
            text_append(&text, "automaton t\n");
            write_nested(&text, NESTED[i].before, NESTED[i].opening, NESTED[i].middle, NESTED[i].closing,
                         NESTED[i].most + extra, NESTED[i].after);
            struct parse parse;
            parse_bytes(&parse, text.data, text.length);
            bool good =
                extra ? parse.status == BCIFS_INPUT && strstr(parse.findings.data, NESTED[i].message) != NULL
                      : parse.status == BCIFS_OK;
            if (!ok(good, "%zu times '%s' %s", NESTED[i].most + extra, NESTED[i].opening,
                    extra ? "are too many" : ""))
                note("got %s", parse.findings.data);
            parse_free(&parse);
            text_free(&text);
        }
    }
}

static void test_entries(void)
{
    if (test_effort(1) <= 2)
        return; /* it takes half a gigabyte */
    struct text text = {0};
    text_append(&text, "automaton t\nfigure f { points [");
    for (size_t i = 0; i < SYNTAX_MOST_ENTRIES; i++)
        text_append(&text, " 1");
    size_t length = text.length;
    text_append(&text, "] }");
    struct parse parse;
    parse_bytes(&parse, text.data, text.length);
    ok(parse.status == BCIFS_OK, "a matrix may have 1048576 entries");
    parse_free(&parse);
    text.length = length;
    text_append(&text, " 1 ] }");
    parse_bytes(&parse, text.data, text.length);
    ok(strstr(parse.findings.data, "a matrix may have 1048576 entries") != NULL, "but no more");
    parse_free(&parse);
    text_free(&text);
}

/* ---- Damage -------------------------------------------------------------------------------------------- */

/* A parse either succeeds without findings or fails with some. */
static bool is_sound(const char *bytes, size_t length)
{
    struct parse parse;
    parse_bytes(&parse, bytes, length);
    bool has_findings = parse.findings.length > 0;
    bool sound =
        parse.status == BCIFS_OK ? parse.file && !has_findings : parse.status == BCIFS_INPUT && has_findings;
    parse_free(&parse);
    return sound;
}

static void test_truncation(void)
{
    bool sound = true;
    for (size_t length = 0; length < sizeof SAMPLE; length++)
        if (!is_sound(SAMPLE, length)) {
            sound = false;
            note("cut at %zu", length);
        }
    ok(sound, "a file may be cut anywhere");
}

static void test_mutation(void)
{
    static const char alphabet[] = "{}[](),;=+-*/%^?.. 019ae\"#\n\tpq\x80\xC3";
    uint64_t state = 7;
    bool sound = true;
    for (long i = 0; i < test_effort(3000) && sound; i++) {
        char text[sizeof SAMPLE];
        uint64_t seed = state;
        size_t length = sizeof SAMPLE - 1;
        memcpy(text, SAMPLE, sizeof SAMPLE);
        for (uint64_t changes = random_bits(&state) % 4 + 1; changes > 0; changes--) {
            uint64_t bits = random_bits(&state);
            size_t place = (size_t)(bits >> 8) % length;
            size_t other = (size_t)(bits >> 32) % length, count = (size_t)(bits >> 4) % 12;
            if (bits % 4 == 0 && place + count <= length && other + count <= length)
                memmove(text + place, text + other, count);
            else
                text[place] = alphabet[(size_t)(bits >> 40) % (sizeof alphabet - 1)];
        }
        sound = is_sound(text, length);
        if (!sound)
            note("seed %llu", (unsigned long long)seed);
    }
    ok(sound, "bytes may be damaged");
}

/* Long repetitions, on which something quadratic or recursive would show. */
static void test_hostile(void)
{
    static const char *const pieces[] = {"(",
                                         ")",
                                         "[",
                                         "]",
                                         "{",
                                         "}",
                                         "-",
                                         "^",
                                         "1^",
                                         "1+",
                                         "f(",
                                         "p[",
                                         "sum(i in ",
                                         "for i in 0..1 {",
                                         "\"",
                                         "\"\n",
                                         "#\n",
                                         "1 ",
                                         "1",
                                         "x",
                                         "é",
                                         "edge a {",
                                         "edge a { sub a [",
                                         "edge a { sub a {",
                                         "\nedge a {",
                                         "\nedge a 3 { x ",
                                         "sub a [ 1 - ",
                                         "\n}\nedge a {\nsub a [ 1 2\n",
                                         "q[0] = p[0]\n",
                                         "?",
                                         ";",
                                         ".5",
                                         "..",
                                         "&",
                                         "\nparam a = "};
    static const char *const starts[] = {"",
                                         "automaton t\n",
                                         "automaton t\nparam a = ",
                                         "automaton t\nedge a 3 { ",
                                         "automaton t\nedge a 3 { sub a [ ",
                                         "automaton t\nedge a 3 { sub a { q[0] = ",
                                         "automaton t\nfigure f { "};
    const size_t size = 100 * 1000;
    double slowest = 0;
    bool sound = true;
    for (size_t i = 0; i < sizeof pieces / sizeof pieces[0]; i++) {
        for (size_t j = 0; j < sizeof starts / sizeof starts[0]; j++) {
            struct text text = {0};
            text_append(&text, starts[j]);
            while (text.length < size)
                text_append(&text, pieces[i]);
            clock_t begin = clock();
            sound &= is_sound(text.data, text.length);
            double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
            slowest = seconds > slowest ? seconds : slowest;
            text_free(&text);
        }
    }
    ok(sound, "repetitions of anything are sound");
    if (!ok(slowest < 2, "and none is slow"))
        note("%d ms", (int)(1000 * slowest));
}

int main(void)
{
    test_diagnostics();
    test_recovery();
    test_expressions();
    test_numbers();
    test_matrices();
    test_constructs();
    test_limits();
    test_entries();
    test_truncation();
    test_mutation();
    test_hostile();
    return done_testing();
}
