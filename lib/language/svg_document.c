#include "svg_document.h"

#include <string.h>

#include "language/svg_path.h"

enum { MOST_DEPTH = 256 /* elements around the path; drawings have a dozen */ };

/* A part of the source. */
struct span {
    const char *at, *end;
};

/* What a tag says that matters here; of an element whose end has not come, it matters to those within. */
struct tag {
    struct span name, d, transform, style; /* values; NULL where there are none */
    bool is_empty;                         /* <…/> */
    bool hidden;                           /* not drawn where it stands */
};

struct document {
    struct svg_cursor cursor;
    struct tag open[MOST_DEPTH];
    size_t depth;
    struct span root, shape, hidden; /* names of the first element, the first other shape, a hidden path */
    struct bcifs_curve *outline;
    bool found;
};

/* ---- Words --------------------------------------------------------------------------------------------- */

static bool span_equal(struct span span, const char *word)
{
    return (size_t)(span.end - span.at) == strlen(word) && memcmp(span.at, word, strlen(word)) == 0;
}

/* The name without a prefix "svg:". */
static bool name_equal(struct span name, const char *word)
{
    if (name.end - name.at > 4 && memcmp(name.at, "svg:", 4) == 0)
        name.at += 4;
    return span_equal(name, word);
}

static bool name_listed(struct span name, const char *const *words)
{
    for (; *words; words++)
        if (name_equal(name, *words))
            return true;
    return false;
}

static int span_shown(struct span span)
{
    ptrdiff_t length = span.end - span.at;
    return (int)(length > 40 ? 40 : length);
}

/* The first occurrence of `word` in what is left, or NULL. */
static const char *find(const struct document *document, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = document->cursor.at; (size_t)(document->cursor.end - at) >= length; at++) {
        at = memchr(at, word[0], (size_t)(document->cursor.end - at) - length + 1);
        if (!at)
            return NULL;
        if (memcmp(at, word, length) == 0)
            return at;
    }
    return NULL;
}

static bool starts_with(const struct document *document, const char *word)
{
    size_t length = strlen(word);
    return (size_t)(document->cursor.end - document->cursor.at) >= length &&
           memcmp(document->cursor.at, word, length) == 0;
}

/* NAME of an element or attribute. */
static struct span name_read(struct document *document)
{
    struct svg_cursor *cursor = &document->cursor;
    struct span name = {cursor->at, cursor->at};
    while (cursor->at < cursor->end && !strchr(" \t\r\n/>=<\"'", *cursor->at))
        cursor->at++;
    name.end = cursor->at;
    return name;
}

/* ---- What is passed over ------------------------------------------------------------------------------- */

static bcifs_status skip_past(struct document *document, const char *closing, const char *what)
{
    const char *stop = find(document, closing);
    if (!stop)
        return svg_error(&document->cursor, document->cursor.at, "%s is not closed with '%s'", what, closing);
    document->cursor.at = stop + strlen(closing);
    return BCIFS_OK;
}

/* <!DOCTYPE …>, which may have brackets with declarations, quotes and comments in it. */
static bcifs_status declaration_skip(struct document *document)
{
    struct svg_cursor *cursor = &document->cursor;
    const char *place = cursor->at;
    int brackets = 0;
    cursor->at += 2;
    while (cursor->at < cursor->end) {
        char byte = *cursor->at;
        if (starts_with(document, "<!--")) {
            bcifs_status status = skip_past(document, "-->", "the comment");
            if (status)
                return status;
            continue;
        }
        cursor->at++;
        if (byte == '"' || byte == '\'') {
            const char *stop = memchr(cursor->at, byte, (size_t)(cursor->end - cursor->at));
            cursor->at = stop ? stop + 1 : cursor->end;
        }
        brackets += (byte == '[') - (byte == ']');
        if (byte == '>' && brackets <= 0)
            return BCIFS_OK;
    }
    return svg_error(cursor, place, "the declaration is not closed with '>'");
}

/* ---- Tags ---------------------------------------------------------------------------------------------- */

/* NAME = "…" or '…' */
static bcifs_status attribute_read(struct document *document, struct tag *tag)
{
    struct svg_cursor *cursor = &document->cursor;
    struct span name = name_read(document), value;
    svg_skip_space(cursor);
    if (name.at == name.end || cursor->at == cursor->end || *cursor->at != '=')
        return svg_error(cursor, name.at, "expected an attribute NAME=\"…\" or the end of <%.*s>",
                         span_shown(tag->name), tag->name.at);
    cursor->at++;
    svg_skip_space(cursor);
    if (cursor->at == cursor->end || (*cursor->at != '"' && *cursor->at != '\''))
        return svg_error(cursor, cursor->at, "the value of '%.*s' must be in quotes", span_shown(name),
                         name.at);
    value.at = cursor->at + 1;
    value.end = memchr(value.at, *cursor->at, (size_t)(cursor->end - value.at));
    if (!value.end || memchr(value.at, '<', (size_t)(value.end - value.at)))
        return svg_error(cursor, cursor->at, "the value of '%.*s' is not closed", span_shown(name), name.at);
    cursor->at = value.end + 1;
    if (span_equal(name, "d"))
        tag->d = value;
    else if (span_equal(name, "transform"))
        tag->transform = value;
    else if (span_equal(name, "style"))
        tag->style = value;
    return BCIFS_OK;
}

/* NAME { attribute } ( ">" | "/>" ), behind "<". */
static bcifs_status tag_read(struct document *document, struct tag *tag)
{
    struct svg_cursor *cursor = &document->cursor;
    const char *place = cursor->at;
    *tag = (struct tag){.name = name_read(document)};
    if (tag->name.at == tag->name.end)
        return svg_error(cursor, place, "expected the name of an element behind '<'");
    for (;;) {
        svg_skip_space(cursor);
        if (cursor->at == cursor->end)
            return svg_error(cursor, place, "<%.*s> is not closed with '>'", span_shown(tag->name),
                             tag->name.at);
        tag->is_empty = starts_with(document, "/>");
        if (tag->is_empty || *cursor->at == '>') {
            cursor->at += 1 + tag->is_empty;
            return BCIFS_OK;
        }
        bcifs_status status = attribute_read(document, tag);
        if (status)
            return status;
    }
}

/* A cursor for an attribute's value. */
static struct svg_cursor cursor_of(const struct document *document, struct span value)
{
    struct svg_cursor cursor = document->cursor;
    cursor.at = value.at;
    cursor.end = value.end;
    cursor.after_number = false;
    return cursor;
}

/* ---- Elements ------------------------------------------------------------------------------------------ */

/* transform <- transform · (that of the element). */
static bcifs_status transform_add(const struct document *document, const struct tag *tag,
                                  struct svg_transform *transform)
{
    const char *word = "transform";
    size_t length = strlen(word);
    for (const char *at = tag->style.at; at && (size_t)(tag->style.end - at) >= length; at++)
        if (memcmp(at, word, length) == 0)
            return svg_error(&document->cursor, at,
                             "a transform in a style is not applied; write it as an attribute");
    if (!tag->transform.at)
        return BCIFS_OK;
    struct svg_cursor cursor = cursor_of(document, tag->transform);
    return svg_transform_read(&cursor, transform);
}

static bcifs_status path_found(struct document *document, const struct tag *tag)
{
    struct svg_transform transform = SVG_IDENTITY;
    bcifs_status status = BCIFS_OK;
    document->found = true;
    if (!tag->d.at)
        return svg_error(&document->cursor, tag->name.at, "this <path> has no attribute d");
    for (size_t i = 0; i < document->depth && status == BCIFS_OK; i++)
        status = transform_add(document, &document->open[i], &transform);
    if (status == BCIFS_OK)
        status = transform_add(document, tag, &transform);
    if (status)
        return status;
    struct svg_cursor cursor = cursor_of(document, tag->d);
    return svg_path_read(&cursor, &transform, document->outline);
}

static bcifs_status element_enter(struct document *document)
{
    static const char *const hiding[] = {"defs", "clipPath", "mask", "marker", "pattern", "symbol", NULL};
    static const char *const shapes[] = {"rect",    "circle", "ellipse", "line", "polyline",
                                         "polygon", "text",   "image",   "use",  NULL};
    struct tag tag;
    document->cursor.at++;
    bcifs_status status = tag_read(document, &tag);
    if (status)
        return status;
    bool path = name_equal(tag.name, "path");
    tag.hidden =
        (document->depth && document->open[document->depth - 1].hidden) || name_listed(tag.name, hiding);
    if (path && !tag.hidden)
        return path_found(document, &tag);
    if (path)
        document->hidden = tag.name;
    if (!document->root.at)
        document->root = tag.name;
    if (!document->shape.at && name_listed(tag.name, shapes))
        document->shape = tag.name;
    if (tag.is_empty)
        return BCIFS_OK;
    if (document->depth == MOST_DEPTH)
        return svg_error(&document->cursor, tag.name.at, "more than %d elements within each other",
                         MOST_DEPTH);
    document->open[document->depth++] = tag;
    return BCIFS_OK;
}

/* </NAME> */
static bcifs_status element_leave(struct document *document)
{
    struct svg_cursor *cursor = &document->cursor;
    cursor->at += 2;
    struct span name = name_read(document);
    const struct tag *open = document->depth ? &document->open[document->depth - 1] : NULL;
    if (!open || open->name.end - open->name.at != name.end - name.at ||
        memcmp(open->name.at, name.at, (size_t)(name.end - name.at)) != 0)
        return svg_error(cursor, name.at, "</%.*s> closes nothing: %s%.*s%s", span_shown(name), name.at,
                         open ? "<" : "no element is open", open ? span_shown(open->name) : 0,
                         open ? open->name.at : "", open ? "> is open" : "");
    svg_skip_space(cursor);
    if (cursor->at == cursor->end || *cursor->at != '>')
        return svg_error(cursor, cursor->at, "expected '>' behind </%.*s", span_shown(name), name.at);
    cursor->at++;
    document->depth--;
    return BCIFS_OK;
}

static bcifs_status markup_read(struct document *document)
{
    if (starts_with(document, "<!--"))
        return skip_past(document, "-->", "the comment");
    if (starts_with(document, "<![CDATA["))
        return skip_past(document, "]]>", "CDATA");
    if (starts_with(document, "<?"))
        return skip_past(document, "?>", "the processing instruction");
    if (starts_with(document, "<!"))
        return declaration_skip(document);
    if (starts_with(document, "</"))
        return element_leave(document);
    return element_enter(document);
}

/* The file ended without a path that is drawn. */
static bcifs_status nothing_found(const struct document *document)
{
    const struct svg_cursor *cursor = &document->cursor;
    if (document->depth > 0) {
        struct span name = document->open[document->depth - 1].name;
        return svg_error(cursor, name.at, "<%.*s> is not closed", span_shown(name), name.at);
    }
    if (document->shape.at)
        return svg_error(cursor, document->shape.at,
                         "there is no <path> to read; convert this <%.*s> to a path",
                         span_shown(document->shape), document->shape.at);
    if (document->hidden.at)
        return svg_error(cursor, document->hidden.at,
                         "there is no <path> but this one, which is not drawn here");
    if (document->root.at)
        return svg_error(cursor, document->root.at, "there is no <path> in this <%.*s>",
                         span_shown(document->root), document->root.at);
    return svg_error(cursor, cursor->source->text, "this is no SVG file: it has no elements");
}

bcifs_status svg_document_read(const struct source *source, struct report *report,
                               struct bcifs_curve *outline)
{
    struct document *document = memory_new(1, sizeof *document);
    bcifs_status status = document ? BCIFS_OK : report_memory(report);
    outline->dimension = 2;
    if (document) {
        document->cursor = (struct svg_cursor){
            .source = source, .report = report, .at = source->text, .end = source->text + source->length};
        document->outline = outline;
    }
    while (status == BCIFS_OK && !document->found) {
        struct svg_cursor *cursor = &document->cursor;
        cursor->at = memchr(cursor->at, '<', (size_t)(cursor->end - cursor->at));
        if (!cursor->at) {
            cursor->at = cursor->end;
            status = nothing_found(document);
        } else {
            status = markup_read(document);
        }
    }
    memory_free(document);
    return status;
}

bool svg_document_likely(const struct source *source)
{
    const char *at = source->text;
    at += source->length >= 3 && memcmp(at, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0;
    return at[strspn(at, " \t\r\n")] == '<';
}
