/* The printer: the canonical layout by examples, and on random files, with comments sprinkled over every gap
 * between tokens, that formatting keeps all tokens and comments and that formatting again changes nothing. */
#include "language/syntax.h"

#include <string.h>

#include "base/text.h"
#include "tap.h"

struct parse {
    struct arena arena;
    struct syntax_file *file;
    bcifs_error error;
};

static bool parse_text(struct parse *parse, const char *text, size_t length)
{
    *parse = (struct parse){0};
    struct report report = report_new(NULL);
    struct source *source;
    bool good = source_from_text(&parse->arena, "test", text, length, &report, &source) == BCIFS_OK &&
                syntax_parse(&parse->arena, source, &report, &parse->file) == BCIFS_OK;
    report_close(&report, &parse->error);
    return good;
}

/* ---- Examples ------------------------------------------------------------------------------------------ */

static void check(const char *name, const char *text, const char *expected)
{
    struct parse parse;
    struct text got = {0};
    bool good = parse_text(&parse, text, strlen(text));
    if (good)
        syntax_print(parse.file, &got);
    else
        note("%u:%u: %s", parse.error.line, parse.error.column, parse.error.message);
    if (!ok(good && strcmp(got.data, expected) == 0, "%s", name))
        printf("%s", good ? got.data : "");
    arena_free(&parse.arena);
    text_free(&got);
}

/* The same for text that is canonical. */
static void check_kept(const char *name, const char *text)
{
    check(name, text, text);
}

static void test_items(void)
{
    check("the header", "automaton   t", "automaton t\n");
    check("comments around it", "\n\n# a\n\n\n# b\nautomaton t  \"x\" # c\n# d\n\n\n",
          "# a\n\n# b\nautomaton t \"x\"  # c\n# d\n");
    check("one-line items stand in groups",
          "automaton t param a=1 param b = 2 in 0 .. 1\n\n\nparam c=3 use \"x\" as y use \"z\" let f(u ,v)= "
          "u\nlet g=1\n"
          "face f=a * b face g = a.b(1) *c",
          "automaton t\n"
          "\n"
          "param a = 1\n"
          "param b = 2 in 0..1\n"
          "\n"
          "param c = 3\n"
          "\n"
          "use \"x\" as y\n"
          "use \"z\"\n"
          "\n"
          "let f(u,v) = u\n"
          "let g = 1\n"
          "\n"
          "face f = a * b\n"
          "face g = a.b(1) * c\n");
    check("a comment line parts a group, a trailing comment does not",
          "automaton t\nparam a = 1 # one\nparam b = 2\n# three\nparam c = 3\n",
          "automaton t\n\nparam a = 1  # one\nparam b = 2\n\n# three\nparam c = 3\n");
    check("windows line ends", "automaton t\r\n\r\n\r\nparam a = 1 # x\r\n",
          "automaton t\n\nparam a = 1  # x\n");
    check_kept("a comment below an item stays with it",
               "automaton t\n\nparam a = 1\n# about a\n\n# about b\nparam b = 1\n");
}

static void test_expressions(void)
{
    check("spaces around + and - outside of parentheses",
          "automaton t let a = u / ( 2*(u + v) )+1-b^2%3 let b=-1 - -2--3^-4 let c=min( 1 , (2) )",
          "automaton t\n"
          "\n"
          "let a = u/(2*(u+v)) + 1 - b^2%3\n"
          "let b = -1 - -2 - -3^-4\n"
          "let c = min(1,(2))\n");
    check("numbers as written", "automaton t param a = .50 in 1e-3 .. .5",
          "automaton t\n\nparam a = .50 in 1e-3.. .5\n");
    check("none in a matrix", "automaton t edge e { mask 2 [ 1-a -a^2 (1 - a) f(u, v) ] }",
          "automaton t\n\nedge e { mask 2 [ 1-a -a^2 (1-a) f(u,v) ] }\n");
}

static void test_cells(void)
{
    check(
        "parts, a line each",
        "automaton t edge arc( n ) 2*n+1 { start k(n , 1) at 0 1 end a . k at [n n+1] boundary w=k [1 0;0 1]"
        " join 0 . end=1 . start reversed refine 2 [1 0] mask 2 [1] }",
        "automaton t\n"
        "\n"
        "edge arc(n) 2*n + 1 {\n"
        "  start k(n,1) at 0 1\n"
        "  end a.k at [ n n+1 ]\n"
        "  boundary w = k [ 1 0; 0 1 ]\n"
        "  join 0.end = 1.start reversed\n"
        "  refine 2 [ 1 0 ]\n"
        "  mask 2 [ 1 ]\n"
        "}\n");
    check("a cell with at most one part stays on its line",
          "automaton t\nvertex end 1{}\nvertex other 1 {\n}\nedge arc {mask 2 [1/8 1/2 3/4 1/2 1/8]}\n"
          "edge brc {\nmask 2 [1 2]}\ncell c affine 2 { }",
          "automaton t\n"
          "\n"
          "vertex end 1 { }\n"
          "\n"
          "vertex other 1 {\n"
          "}\n"
          "\n"
          "edge arc { mask 2 [ 1/8 1/2 3/4 1/2 1/8 ] }\n"
          "\n"
          "edge brc {\n"
          "  mask 2 [ 1 2 ]\n"
          "}\n"
          "\n"
          "cell c affine 2 { }\n");
    check("if it fits in 100 columns",
          "automaton t\n"
          "edge e { mask 2 [ 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1000 "
          "] }\n"
          "edge e { mask 2 [ 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 10000 "
          "] }\n",
          "automaton t\n"
          "\n"
          "edge e { mask 2 [ 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1000 "
          "] }\n"
          "\n"
          "edge e {\n"
          "  mask 2 [ 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 10000 ]\n"
          "}\n");
    check("blank lines between parts are kept, but one only",
          "automaton t\nedge e 2 {\n\n  start a at 0\n\n\n\n  end a at 1\n  sub e [ 1 ]\n\n}\n",
          "automaton t\n\nedge e 2 {\n  start a at 0\n\n  end a at 1\n  sub e [ 1 ]\n}\n");
    check(
        "figures and wavelets",
        "automaton t\nwavelet a(1) { smooth -2 [1 2] detail 3 [1] }\n"
        "figure f { closed a } figure g { open a(1) intervals [1 2] piece a at 0 1 size 2 3 points [0 0;1 1] "
        "displace 1 2 [0 1] }",
        "automaton t\n"
        "\n"
        "wavelet a(1) {\n"
        "  smooth -2 [ 1 2 ]\n"
        "  detail 3 [ 1 ]\n"
        "}\n"
        "\n"
        "figure f { closed a }\n"
        "\n"
        "figure g {\n"
        "  open a(1)\n"
        "  intervals [ 1 2 ]\n"
        "  piece a at 0 1\n"
        "  size 2 3\n"
        "  points [ 0 0; 1 1 ]\n"
        "  displace 1 2 [ 0 1 ]\n"
        "}\n");
}

static void test_matrices(void)
{
    check("rows that stood on lines stay on lines, aligned",
          "automaton t\nedge e 2 {\n  sub long(u,v) [ 1-a b\n\n-c (1 - d);\n 0 0 ]\n sub e\n[\n1 2;\n]\n}\n",
          "automaton t\n"
          "\n"
          "edge e 2 {\n"
          "  sub long(u,v) [  1-a b\n"
          "\n"
          "                  -c   (1-d)\n"
          "                   0   0 ]\n"
          "  sub e [ 1 2 ]\n"
          "}\n");
    check("rows that do not fit on one line are broken",
          "automaton t\nfigure f { open a\n"
          "points [ 11111111111111111111 222222222222222222222; 3333333333333333333333333 "
          "4444444444444444444444 ]}",
          "automaton t\n"
          "\n"
          "figure f {\n"
          "  open a\n"
          "  points [ 11111111111111111111      222222222222222222222\n"
          "           3333333333333333333333333 4444444444444444444444 ]\n"
          "}\n");
    check("comments stay with their row",
          "automaton t\nedge e 2 { sub e [ # open\n# first\n1 2 # one\n# between\n33 4 # two\n# last\n] # "
          "after\n"
          "mask 2 [ 1 2 # row\n] }",
          "automaton t\n"
          "\n"
          "edge e 2 {\n"
          "  sub e [  # open\n"
          "          # first\n"
          "          1  2  # one\n"
          "          # between\n"
          "          33 4  # two\n"
          "          # last\n"
          "        ]  # after\n"
          "  mask 2 [ 1 2  # row\n"
          "         ]\n"
          "}\n");
    check("a comment inside an entry", "automaton t\nedge e 2 { sub e [ 1 (2 # two\n +3)\n 444 5 ] }",
          "automaton t\n\nedge e 2 {\n  sub e [ 1 (2  # two\n          +3)\n          444 5 ]\n}\n");
    check("entries that are very wide are not lined up with",
          "automaton t\nedge e 2 {\n  sub e [ (1+2+3+4+5+6+7+8+9+10+11+12+13+14+15+16+17+18) 1\n  22 1\n 3 1 "
          "]\n}\n",
          "automaton t\n\nedge e 2 {\n  sub e [ (1+2+3+4+5+6+7+8+9+10+11+12+13+14+15+16+17+18) 1\n          "
          "22 1\n"
          "          3  1 ]\n}\n");
}

static void test_rules(void)
{
    check(
        "short rules stay on their line, two spaces apart",
        "automaton t\nedge e 2 {\nsub e{q[ 0 ]=3/4*p[0]+1/4*p[1] q[1]=sum(i in 0 .. 3,p[i+1]/(4 + 1))}\n}\n",
        "automaton t\n\nedge e 2 {\n"
        "  sub e { q[0] = 3/4*p[0] + 1/4*p[1]  q[1] = sum(i in 0..3, p[i+1]/(4+1)) }\n}\n");
    check("others are broken, and loops are rules",
          "automaton t\nedge e 2 {\nsub e { q[0] = p[0]\nfor i in 0..n-1 { q[i] = p[i] q[1] = 0 } for j in "
          "0.. .5 {\n}\n\n"
          "q[2]=0 }\nrefine 2 { }\n}\n",
          "automaton t\n\nedge e 2 {\n"
          "  sub e {\n"
          "    q[0] = p[0]\n"
          "    for i in 0..n-1 { q[i] = p[i]  q[1] = 0 }\n"
          "    for j in 0.. .5 {\n"
          "    }\n"
          "\n"
          "    q[2] = 0\n"
          "  }\n"
          "  refine 2 { }\n"
          "}\n");
    check("nested sums",
          "automaton t\nedge e 2 { sub e { q[0]=sum(i in 0..sum(j in 0..1,j),sum(k in -1..1,f(k,i))) } }",
          "automaton t\n\nedge e 2 { sub e { q[0] = sum(i in 0..sum(j in 0..1, j), sum(k in -1..1, f(k,i))) "
          "} }\n");
}

static void test_comments(void)
{
    check("comments in a block",
          "automaton t\nedge e 2 { # open\n\n# first\n\n  start a at 0 # zero\n  # end\n\n  end a at 1\n\n  "
          "# last\n\n}# after\n#eof",
          "automaton t\n"
          "\n"
          "edge e 2 {  # open\n"
          "  # first\n"
          "\n"
          "  start a at 0  # zero\n"
          "  # end\n"
          "\n"
          "  end a at 1\n"
          "\n"
          "  # last\n"
          "}  # after\n"
          "#eof\n");
    check("a comment inside a line cuts it",
          "automaton # name\nt\nparam a = # value\n1 + # two\n# three\n2\nedge e # head\n { sub e # map\n [ "
          "1 2 ]\n"
          "sub e { q[0] = p[0] # one\n - p[1] } }",
          "automaton  # name\n"
          "    t\n"
          "\n"
          "param a =  # value\n"
          "    1 +  # two\n"
          "    # three\n"
          "    2\n"
          "\n"
          "edge e  # head\n"
          "    {\n"
          "  sub e  # map\n"
          "      [ 1 2 ]\n"
          "  sub e {\n"
          "    q[0] = p[0]  # one\n"
          "        - p[1]\n"
          "  }\n"
          "}\n");
}

/* ---- Random files -------------------------------------------------------------------------------------- */

/* A generator of valid files: writes tokens, and between them any gap that may stand there. */
struct generator {
    struct text text;
    uint64_t state;
    unsigned comments; /* written so far: each is numbered, so that none can be mistaken for another */
    unsigned sprinkle; /* one gap in so many has comments; 0: none */
    bool in_row;       /* white space matters */
};

static unsigned choose(struct generator *g, unsigned count)
{
    return (unsigned)(random_bits(&g->state) >> 33) % count;
}

static void write_comments(struct generator *g)
{
    for (unsigned count = choose(g, 3) + 1; count > 0; count--) {
        text_append_character(&g->text, ' ', choose(g, 3));
        text_format(&g->text, "#%s%u%s\n", choose(g, 2) ? " c" : "}]", g->comments++,
                    choose(g, 4) ? "" : "  ");
        text_append_character(&g->text, '\n', choose(g, 4) ? 0 : choose(g, 3));
    }
}

/* White space of any kind; at least something if `needed`. */
static void gap(struct generator *g, bool needed)
{
    static const char *const spaces[] = {" ", " ", " ", " ", "  ", "\t", "\n", "\n\n", "\n \n\n", " \r\n"};
    if (g->in_row) {
        text_append(&g->text, needed ? " " : "");
        return;
    }
    if (g->sprinkle && choose(g, g->sprinkle) == 0)
        write_comments(g);
    else if (needed || choose(g, 3) == 0)
        text_append(&g->text, spaces[choose(g, sizeof spaces / sizeof spaces[0])]);
}

static bool is_word(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/* Writes a token behind a gap, with a space where two tokens would run together. */
static void token(struct generator *g, const char *text)
{
    char last = g->text.length ? g->text.data[g->text.length - 1] : ' ';
    gap(g, (is_word(last) && is_word(text[0])) || (last == '.' && text[0] == '.'));
    text_append(&g->text, text);
}

static void tokens(struct generator *g, const char *a, const char *b, const char *c)
{
    token(g, a);
    token(g, b);
    if (c)
        token(g, c);
}

static const char *any_name(struct generator *g)
{
    static const char *const names[] = {"a",  "b", "arc", "joint", "sub",  "in",
                                        "at", "p", "q",   "_x1",   "edge", "sum"};
    return names[choose(g, sizeof names / sizeof names[0])];
}

static const char *any_integer(struct generator *g)
{
    static const char *const integers[] = {"0", "1", "2", "10", "123"};
    return integers[choose(g, sizeof integers / sizeof integers[0])];
}

static void write_expression(struct generator *g, unsigned depth, bool rules);

/* Arguments in parentheses, where white space is free again. */
static void write_arguments(struct generator *g, unsigned depth, bool rules)
{
    bool in_row = g->in_row;
    if (!in_row)
        token(g, "(");
    else
        text_append(&g->text, "(");
    g->in_row = false;
    for (unsigned count = choose(g, 3) + 1; count > 0; count--) {
        write_expression(g, depth, rules);
        token(g, count > 1 ? "," : ")");
    }
    g->in_row = in_row;
}

static void write_sum(struct generator *g, unsigned depth)
{
    tokens(g, "sum", "(", any_name(g));
    token(g, "in");
    write_expression(g, depth, true);
    token(g, "..");
    write_expression(g, depth, true);
    token(g, ",");
    write_expression(g, depth, true);
    token(g, ")");
}

static void write_primary(struct generator *g, unsigned depth, bool rules)
{
    static const char *const numbers[] = {"1", "2", ".5", "0.25", "1e-3", "12"};
    unsigned kind = choose(g, depth > 0 ? 8 : 3);
    bool in_row = g->in_row;
    if (kind < 2) {
        token(g, kind ? numbers[choose(g, 6)] : "a");
    } else if (kind == 2 || (kind > 5 && !rules)) {
        token(g, any_name(g));
    } else if (kind == 3) {
        token(g, "f");
        write_arguments(g, depth - 1, rules);
    } else if (kind < 6) {
        token(g, "(");
        g->in_row = false;
        write_expression(g, depth - 1, rules);
        token(g, ")");
        g->in_row = in_row;
    } else if (kind == 6) {
        tokens(g, "p", "[", NULL);
        write_expression(g, depth - 1, rules);
        token(g, "]");
    } else {
        write_sum(g, depth - 1);
    }
}

static void write_expression(struct generator *g, unsigned depth, bool rules)
{
    static const char *const operators[] = {"+", "-", "*", "/", "%", "^"};
    for (;;) {
        if (choose(g, 5) == 0)
            token(g, choose(g, 2) ? "-" : "+");
        write_primary(g, depth, rules);
        if (choose(g, 2))
            return;
        token(g, operators[choose(g, 6)]);
    }
}

/* Rows of equal length, with every way to separate them. */
static void write_matrix(struct generator *g, unsigned most_rows)
{
    unsigned rows = choose(g, most_rows) + 1, columns = choose(g, 4) + 1;
    bool one_line = choose(g, 2);
    token(g, "[");
    for (unsigned i = 0; i < rows; i++) {
        if (!one_line)
            gap(g, false);
        g->in_row = true;
        for (unsigned j = 0; j < columns; j++) {
            text_append(&g->text, j ? choose(g, 2) ? "  " : "\t" : " ");
            if (most_rows > 1 && choose(g, 8) == 0)
                text_append(&g->text, "?");
            else
                write_expression(g, 1, false);
        }
        g->in_row = false;
        bool semicolon = one_line ? i + 1 < rows : choose(g, 3) == 0;
        if (semicolon && !one_line && choose(g, 2))
            gap(g, false);
        if (semicolon)
            text_append(&g->text, choose(g, 2) ? ";" : " ;");
        if (!one_line && i + 1 < rows && !semicolon)
            text_append(&g->text, "\n");
    }
    if (one_line)
        text_append(&g->text, " ]");
    else
        token(g, "]");
}

static void write_reference(struct generator *g)
{
    token(g, any_name(g));
    if (choose(g, 4) == 0)
        tokens(g, ".", any_name(g), NULL);
    if (choose(g, 3) == 0)
        write_arguments(g, 1, false);
}

static void write_rules(struct generator *g, unsigned depth)
{
    token(g, "{");
    for (unsigned count = choose(g, 3); count > 0; count--) {
        if (depth > 0 && choose(g, 3) == 0) {
            tokens(g, "for", any_name(g), "in");
            write_expression(g, 1, true);
            token(g, "..");
            write_expression(g, 1, true);
            write_rules(g, depth - 1);
            continue;
        }
        tokens(g, "q", "[", NULL);
        write_expression(g, 1, true);
        tokens(g, "]", "=", NULL);
        write_expression(g, 2, true);
    }
    token(g, "}");
}

static void write_map(struct generator *g)
{
    if (choose(g, 2))
        write_matrix(g, 4);
    else
        write_rules(g, 2);
}

static void write_location(struct generator *g)
{
    unsigned kind = choose(g, 3);
    if (kind == 0) {
        write_matrix(g, 4);
        return;
    }
    token(g, "at");
    if (kind == 1) {
        token(g, "[");
        gap(g, false);
        text_append(&g->text, " 0 n+1 ");
        token(g, "]");
    }
    for (unsigned count = kind == 2 ? choose(g, 3) + 1 : 0; count > 0; count--)
        token(g, any_integer(g));
}

static void write_part(struct generator *g)
{
    switch (choose(g, 6)) {
    case 0:
        token(g, choose(g, 2) ? "start" : "end");
        write_reference(g);
        write_location(g);
        break;
    case 1:
        tokens(g, "boundary", any_name(g), "=");
        write_reference(g);
        write_location(g);
        break;
    case 2:
        tokens(g, "join", any_integer(g), ".");
        tokens(g, any_name(g), "=", any_integer(g));
        tokens(g, ".", any_name(g), choose(g, 2) ? "reversed" : NULL);
        break;
    case 3:
        tokens(g, "refine", any_integer(g), NULL);
        write_map(g);
        break;
    case 4:
        tokens(g, "mask", any_integer(g), NULL);
        write_matrix(g, 1);
        break;
    default:
        token(g, "sub");
        write_reference(g);
        write_map(g);
    }
}

static void write_names(struct generator *g)
{
    if (choose(g, 2))
        return;
    tokens(g, "(", "u", NULL);
    if (choose(g, 2))
        tokens(g, ",", "v", NULL);
    token(g, ")");
}

static void write_cell(struct generator *g)
{
    static const char *const kinds[] = {"vertex", "edge", "face", "cell"};
    tokens(g, kinds[choose(g, 4)], any_name(g), NULL);
    write_names(g);
    unsigned points = choose(g, 4);
    if (points == 0)
        tokens(g, "affine", "2", NULL);
    else if (points == 1)
        tokens(g, "2*n", "+", "1");
    else if (points == 2)
        token(g, "3");
    token(g, "{");
    for (unsigned count = choose(g, 4); count > 0; count--)
        write_part(g);
    token(g, "}");
}

static void write_figure(struct generator *g)
{
    tokens(g, "figure", any_name(g), "{");
    for (unsigned count = choose(g, 4); count > 0; count--) {
        switch (choose(g, 5)) {
        case 0:
            token(g, choose(g, 2) ? "open" : "closed");
            write_reference(g);
            break;
        case 1:
            token(g, "piece");
            write_reference(g);
            tokens(g, "at", any_integer(g), any_integer(g));
            break;
        case 2:
            tokens(g, "size", any_integer(g), any_integer(g));
            break;
        case 3:
            token(g, choose(g, 2) ? "points" : "intervals");
            write_matrix(g, 5);
            break;
        default:
            tokens(g, "displace", any_integer(g), any_integer(g));
            write_matrix(g, 1);
        }
    }
    token(g, "}");
}

static void write_item(struct generator *g)
{
    switch (choose(g, 8)) {
    case 0:
        tokens(g, "use", "\"x # y.bcifs\"", NULL);
        if (choose(g, 2))
            tokens(g, "as", any_name(g), NULL);
        break;
    case 1:
        tokens(g, "param", any_name(g), "=");
        write_expression(g, 3, false);
        if (choose(g, 2)) {
            token(g, "in");
            write_expression(g, 1, false);
            token(g, "..");
            write_expression(g, 1, false);
        }
        break;
    case 2:
        tokens(g, "let", any_name(g), NULL);
        write_names(g);
        token(g, "=");
        write_expression(g, 3, false);
        break;
    case 3:
        tokens(g, "wavelet", any_name(g), "{");
        tokens(g, "smooth", choose(g, 2) ? "-" : "", any_integer(g));
        write_matrix(g, 1);
        tokens(g, "detail", choose(g, 2) ? "-" : "", any_integer(g));
        write_matrix(g, 1);
        token(g, "}");
        break;
    case 4:
        tokens(g, "face", any_name(g), "=");
        write_reference(g);
        token(g, "*");
        write_reference(g);
        break;
    case 5:
        write_figure(g);
        break;
    default:
        write_cell(g);
    }
}

static void write_file(struct generator *g)
{
    tokens(g, "automaton", any_name(g), choose(g, 2) ? "\"a # title\"" : NULL);
    for (unsigned count = choose(g, 8); count > 0; count--)
        write_item(g);
    gap(g, false);
}

/* ---- What must not change ------------------------------------------------------------------------------ */

static bool same_token(const struct syntax_file *a, size_t i, const struct syntax_file *b, size_t j)
{
    const struct token *s = &a->tokens[i], *t = &b->tokens[j];
    return s->kind == t->kind && s->length == t->length &&
           memcmp(a->source->text + s->place, b->source->text + t->place, s->length) == 0;
}

static size_t skip_separators(const struct syntax_file *file, size_t i)
{
    while (file->tokens[i].kind == TOKEN_MARK && file->source->text[file->tokens[i].place] == ';')
        i++;
    return i;
}

/* The tokens agree, but for the semicolons of matrices, which a newline may stand for. */
static bool same_tokens(const struct syntax_file *a, const struct syntax_file *b)
{
    size_t i = skip_separators(a, 0), j = skip_separators(b, 0);
    while (same_token(a, i, b, j)) {
        if (a->tokens[i].kind == TOKEN_END)
            return true;
        i = skip_separators(a, i + 1);
        j = skip_separators(b, j + 1);
    }
    return false;
}

static bool same_comments(const struct syntax_file *a, const struct syntax_file *b)
{
    if (a->comment_count != b->comment_count)
        return false;
    for (size_t i = 0; i < a->comment_count; i++)
        if (a->comments[i].length != b->comments[i].length ||
            memcmp(a->source->text + a->comments[i].place, b->source->text + b->comments[i].place,
                   a->comments[i].length) != 0)
            return false;
    return true;
}

static bool same_matrix(const struct syntax_matrix *a, const struct syntax_matrix *b)
{
    return (!a && !b) || (a && b && a->rows == b->rows && a->columns == b->columns);
}

/* Matrices keep their shapes, for which the separators are not compared. */
static bool same_shapes(const struct syntax_file *a, const struct syntax_file *b)
{
    bool same = a->count == b->count;
    for (size_t i = 0; same && i < a->count; i++) {
        const struct syntax_item *s = &a->items[i], *t = &b->items[i];
        same = s->kind == t->kind;
        for (size_t j = 0; same && s->kind == ITEM_CELL && j < s->cell->part_count; j++) {
            const struct syntax_part *x = s->cell->parts[j], *y = t->cell->parts[j];
            same = same_matrix(x->matrix, y->matrix) && same_matrix(x->location.matrix, y->location.matrix) &&
                   same_matrix(x->location.row, y->location.row);
        }
        for (size_t j = 0; same && s->kind == ITEM_FIGURE && j < s->figure->part_count; j++)
            same = same_matrix(s->figure->parts[j]->matrix, t->figure->parts[j]->matrix);
    }
    return same;
}

/* No white space at the end of a line, no two blank lines, one newline at the end. */
static bool is_tidy(const struct text *text)
{
    const char *data = text->data;
    return !strstr(data, " \n") && !strstr(data, "\n\n\n") && data[0] != '\n' && text->length > 1 &&
           data[text->length - 1] == '\n' && data[text->length - 2] != '\n';
}

static const char *find_fault(const struct syntax_file *file, struct text *first, struct text *second,
                              struct parse *again)
{
    syntax_print(file, first);
    if (!is_tidy(first))
        return "the layout is not tidy";
    if (!parse_text(again, first->data, first->length))
        return again->error.message;
    syntax_print(again->file, second);
    if (strcmp(first->data, second->data) != 0)
        return "formatting again changes it";
    if (!same_tokens(file, again->file))
        return "the tokens differ";
    if (!same_comments(file, again->file))
        return "the comments differ";
    return same_shapes(file, again->file) ? NULL : "the matrices differ";
}

/* Whether a valid file survives; an invalid one does if it may be invalid. */
static bool survives(const char *bytes, size_t length, bool may_be_invalid)
{
    struct parse parse, again = {0};
    struct text first = {0}, second = {0};
    const char *fault = NULL;
    if (parse_text(&parse, bytes, length))
        fault = find_fault(parse.file, &first, &second, &again);
    else if (!may_be_invalid)
        fault = parse.error.message;
    if (fault) {
        note("%s", fault);
        printf("--- source\n%.*s\n--- once\n%s\n--- twice\n%s\n", (int)length, bytes,
               first.data ? first.data : "", second.data ? second.data : "");
    }
    arena_free(&parse.arena);
    arena_free(&again.arena);
    text_free(&first);
    text_free(&second);
    return !fault;
}

static void test_random(unsigned sprinkle, uint64_t seed)
{
    bool good = true;
    struct generator g = {.state = seed, .sprinkle = sprinkle};
    for (long i = 0; i < test_effort(1500) && good; i++) {
        g.text.length = 0;
        g.comments = 0;
        write_file(&g);
        good = survives(g.text.data, g.text.length, false);
    }
    text_free(&g.text);
    ok(good, "random files, one gap in %u with comments", sprinkle);
}

/* Damaged files that happen to be valid have layouts that no generator thinks of. */
static void test_damaged(void)
{
    static const char alphabet[] = " \n\n;#[](){},.-+a1?";
    bool good = true;
    struct generator g = {.state = 99, .sprinkle = 20};
    for (long i = 0; i < test_effort(3000) && good; i++) {
        g.text.length = 0;
        write_file(&g);
        for (unsigned changes = choose(&g, 3) + 1; changes > 0; changes--)
            g.text.data[choose(&g, (unsigned)g.text.length)] = alphabet[choose(&g, sizeof alphabet - 1)];
        good = survives(g.text.data, g.text.length, true);
    }
    text_free(&g.text);
    ok(good, "damaged files");
}

/* Neither wide entries, long heads, deep loops nor many columns make the text explode. */
static void test_size(void)
{
    struct text text = {0}, printed = {0};
    struct parse parse;
    text_append(&text, "automaton t\nedge e 2 {\n  sub e(");
    for (int i = 0; i < 900; i++)
        text_append(&text, "1111111111+");
    text_append(&text, "1) [ 1 1\n");
    for (int i = 0; i < 20000; i++)
        text_append(&text, "1 1\n");
    for (int i = 0; i < 900; i++)
        text_append(&text, "1111111111+");
    text_append(&text, "1 1 ]\n}\n");
    bool good = parse_text(&parse, text.data, text.length);
    if (good)
        syntax_print(parse.file, &printed);
    ok(good && !printed.failed && printed.length < 60 * text.length, "the text stays in proportion");
    arena_free(&parse.arena);
    text_free(&text);
    text_free(&printed);
}

int main(void)
{
    test_items();
    test_expressions();
    test_cells();
    test_matrices();
    test_rules();
    test_comments();
    for (unsigned seed = 1; seed <= 3; seed++) {
        test_random(0, seed);
        test_random(40, 10 + seed);
        test_random(8, 20 + seed);
        test_random(2, 30 + seed);
    }
    test_damaged();
    test_size();
    return done_testing();
}
