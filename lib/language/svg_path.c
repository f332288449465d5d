#include "svg_path.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "numeric/tolerance.h"

struct path {
    struct svg_cursor *cursor;
    const struct svg_transform *transform;
    struct bcifs_curve *outline;
    double start[2],
        at[2];        /* the first point, and the current one: in SVG's coordinates, before the transform */
    double handle[2]; /* what S reflects: the last control point of the command before, or `at` */
    double largest;   /* modulus of a coordinate */
};

/* ---- Points -------------------------------------------------------------------------------------------- */

/* Adds points in SVG's coordinates: transformed, y up. `place` is to blame for them. */
static bcifs_status points_add(struct path *path, const char *place, const double (*points)[2], size_t count)
{
    double images[3][2];
    for (size_t i = 0; i < count; i++) {
        svg_transform_apply(path->transform, points[i], images[i]);
        images[i][1] = 0 - images[i][1]; /* no -0 */
        if (!isfinite(images[i][0]) || !isfinite(images[i][1]))
            return svg_error(path->cursor, place, "the coordinates become too large");
        path->largest = fmax(path->largest, fmax(fabs(points[i][0]), fabs(points[i][1])));
    }
    bcifs_status status = outline_add(path->outline, images[0], count);
    if (status == BCIFS_MEMORY)
        return report_memory(path->cursor->report);
    return status ? svg_error(path->cursor, place, "more than %d points", OUTLINE_MOST_POINTS) : BCIFS_OK;
}

/* All straight pieces so far become cubics, with inner points at the thirds. */
static bcifs_status pieces_raise(struct path *path, const char *place)
{
    struct bcifs_curve *outline = path->outline, raised = {.dimension = 2, .cubic = true};
    bcifs_status status = outline_add(&raised, outline->points, 1);
    for (size_t i = 1; i < outline->count && status == BCIFS_OK; i++) {
        const double *p = outline->points + 2 * (i - 1), *q = p + 2;
        const double points[6] = {p[0] + (q[0] - p[0]) / 3,
                                  p[1] + (q[1] - p[1]) / 3,
                                  q[0] - (q[0] - p[0]) / 3,
                                  q[1] - (q[1] - p[1]) / 3,
                                  q[0],
                                  q[1]};
        status = outline_add(&raised, points, 3);
    }
    memory_free(outline->points);
    *outline = raised;
    if (status == BCIFS_MEMORY)
        return report_memory(path->cursor->report);
    return status ? svg_error(path->cursor, place, "more than %d points", OUTLINE_MOST_POINTS) : BCIFS_OK;
}

static void move_to(struct path *path, const double to[2])
{
    memcpy(path->at, to, sizeof path->at);
    memcpy(path->handle, to, sizeof path->handle);
}

static bcifs_status line_to(struct path *path, const char *place, const double to[2])
{
    double points[3][2];
    for (int k = 0; k < 2; k++) {
        points[0][k] = path->at[k] + (to[k] - path->at[k]) / 3;
        points[1][k] = to[k] - (to[k] - path->at[k]) / 3;
        points[2][k] = to[k];
    }
    bool cubic = path->outline->cubic;
    move_to(path, to);
    return points_add(path, place, (const double(*)[2])points + (cubic ? 0 : 2), cubic ? 3 : 1);
}

static bcifs_status cubic_to(struct path *path, const char *place, const double points[3][2])
{
    bcifs_status status = path->outline->cubic ? BCIFS_OK : pieces_raise(path, place);
    if (status)
        return status;
    move_to(path, points[2]);
    memcpy(path->handle, points[1], sizeof path->handle);
    return points_add(path, place, points, 3);
}

/* ---- Commands ------------------------------------------------------------------------------------------ */

/* One set of the arguments of command `name` (a capital letter), relative to `origin`. */
static bcifs_status segment_read(struct path *path, char name, const double origin[2], const char *place)
{
    double numbers[6], points[3][2] = {{0}};
    size_t count = name == 'C' ? 6 : name == 'S' ? 4 : name == 'H' || name == 'V' ? 1 : 2;
    bcifs_status status = svg_numbers(path->cursor, "a number", numbers, count);
    if (status)
        return status;
    if (name == 'H' || name == 'V') {
        const double to[2] = {name == 'H' ? origin[0] + numbers[0] : path->at[0],
                              name == 'V' ? origin[1] + numbers[0] : path->at[1]};
        return line_to(path, place, to);
    }
    for (size_t i = 0; i < count; i++)
        points[3 - count / 2 + i / 2][i % 2] = origin[i % 2] + numbers[i];
    if (name == 'L' || name == 'M')
        return line_to(path, place, points[2]);
    for (int k = 0; k < 2 && name == 'S'; k++)
        points[0][k] = 2 * path->at[k] - path->handle[k];
    return cubic_to(path, place, (const double(*)[2])points);
}

/* A command with all sets of arguments that follow it. */
static bcifs_status segments_read(struct path *path, char name)
{
    static const double zero[2];
    bool relative = islower((unsigned char)name);
    do {
        double origin[2];
        svg_skip_space(path->cursor);
        memcpy(origin, relative ? path->at : zero, sizeof origin);
        bcifs_status status =
            segment_read(path, (char)toupper((unsigned char)name), origin, path->cursor->at);
        if (status)
            return status;
    } while (svg_number_follows(path->cursor));
    return BCIFS_OK;
}

/* M x y, and lines to the points that follow. */
static bcifs_status start_read(struct path *path)
{
    struct svg_cursor *cursor = path->cursor;
    svg_skip_space(cursor);
    if (cursor->at == cursor->end)
        return svg_error(cursor, cursor->at, "the path is empty");
    char name = *cursor->at;
    if (name != 'M' && name != 'm')
        return svg_expected(cursor, "the command M that a path begins with");
    const char *place = cursor->at++;
    bcifs_status status = svg_numbers(cursor, "a number", path->start, 2);
    if (status == BCIFS_OK)
        status = points_add(path, place, (const double(*)[2]) & path->start, 1);
    move_to(path, path->start);
    if (status == BCIFS_OK && svg_number_follows(cursor))
        status = segments_read(path, name);
    return status;
}

/* Z: the last point falls together with the first, which relative commands may have missed by rounding, or a
 * line leads there. */
static bcifs_status close_path(struct path *path, const char *place)
{
    struct bcifs_curve *outline = path->outline;
    double gap = fmax(fabs(path->at[0] - path->start[0]), fabs(path->at[1] - path->start[1]));
    bcifs_status status = BCIFS_OK;
    if (gap > TOLERANCE_MEETING * path->largest)
        status = line_to(path, place, path->start);
    outline->closed = true;
    outline->count -= outline->count > 1;
    return status;
}

static bcifs_status command_read(struct path *path)
{
    struct svg_cursor *cursor = path->cursor;
    const char *place = cursor->at++;
    char name = *place;
    cursor->after_number = false;
    if (path->outline->closed || name == 'M' || name == 'm')
        return svg_error(cursor, place, "the path has a second outline here; only one is read");
    if (name == 'Z' || name == 'z')
        return close_path(path, place);
    if (strchr("LlHhVvCcSs", name))
        return segments_read(path, name);
    if (strchr("Aa", name))
        return svg_error(cursor, place, "elliptical arcs (command %c) are not read; convert them to cubics",
                         name);
    if (strchr("QqTt", name))
        return svg_error(cursor, place, "quadratic curves (command %c) are not read; convert them to cubics",
                         name);
    cursor->at = place;
    return svg_expected(cursor, "a path command");
}

bcifs_status svg_path_read(struct svg_cursor *cursor, const struct svg_transform *transform,
                           struct bcifs_curve *outline)
{
    struct path path = {.cursor = cursor, .transform = transform, .outline = outline};
    const char *place = cursor->at;
    bcifs_status status = start_read(&path);
    svg_skip_space(cursor);
    while (status == BCIFS_OK && cursor->at < cursor->end) {
        status = command_read(&path);
        svg_skip_space(cursor);
    }
    if (status == BCIFS_OK && outline->count < 2)
        return svg_error(cursor, place, "the path has nothing but its first point");
    return status;
}
