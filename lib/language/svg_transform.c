#include "svg_transform.h"

#include <math.h>
#include <string.h>

/* first · second: `second` is applied to points before `first`. */
static struct svg_transform product(struct svg_transform first, struct svg_transform second)
{
    return (struct svg_transform){.a = first.a * second.a + first.c * second.b,
                                  .b = first.b * second.a + first.d * second.b,
                                  .c = first.a * second.c + first.c * second.d,
                                  .d = first.b * second.c + first.d * second.d,
                                  .e = first.a * second.e + first.c * second.f + first.e,
                                  .f = first.b * second.e + first.d * second.f + first.f};
}

/* Cosine and sine of an angle in degrees, exact at right angles. */
static void turn(double degrees, double *cosine, double *sine)
{
    static const double cosines[] = {1, 0, -1, 0};
    double angle = fmod(degrees, 360), quarters = angle / 90;
    if (quarters == floor(quarters)) {
        int quarter = ((int)quarters + 4) % 4;
        *cosine = cosines[quarter];
        *sine = cosines[(quarter + 3) % 4];
        return;
    }
    const double radian = 0.017453292519943295769; /* π/180 */
    *cosine = cos(angle * radian);
    *sine = sin(angle * radian);
}

static struct svg_transform matrix(const double *n, size_t count)
{
    (void)count;
    return (struct svg_transform){n[0], n[1], n[2], n[3], n[4], n[5]};
}

static struct svg_transform translate(const double *n, size_t count)
{
    return (struct svg_transform){.a = 1, .d = 1, .e = n[0], .f = count > 1 ? n[1] : 0};
}

static struct svg_transform scale(const double *n, size_t count)
{
    return (struct svg_transform){.a = n[0], .d = count > 1 ? n[1] : n[0]};
}

/* About the origin, or about the point (n1, n2). */
static struct svg_transform rotate(const double *n, size_t count)
{
    double x = count > 1 ? n[1] : 0, y = count > 1 ? n[2] : 0, cosine, sine;
    turn(n[0], &cosine, &sine);
    return (struct svg_transform){.a = cosine,
                                  .b = sine,
                                  .c = -sine,
                                  .d = cosine,
                                  .e = x - cosine * x + sine * y,
                                  .f = y - sine * x - cosine * y};
}

static struct svg_transform skew_x(const double *n, size_t count)
{
    double cosine, sine;
    (void)count;
    turn(n[0], &cosine, &sine);
    return (struct svg_transform){.a = 1, .c = sine / cosine, .d = 1};
}

static struct svg_transform skew_y(const double *n, size_t count)
{
    double cosine, sine;
    (void)count;
    turn(n[0], &cosine, &sine);
    return (struct svg_transform){.a = 1, .b = sine / cosine, .d = 1};
}

static const struct function {
    const char *name;
    size_t least, most; /* numbers; nothing between for rotate */
    struct svg_transform (*make)(const double *numbers, size_t count);
} functions[] = {
    {"matrix", 6, 6, matrix}, {"translate", 1, 2, translate}, {"scale", 1, 2, scale},
    {"rotate", 1, 3, rotate}, {"skewX", 1, 1, skew_x},        {"skewY", 1, 1, skew_y},
};

static const struct function *function_find(struct svg_cursor *cursor)
{
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        size_t length = strlen(functions[i].name);
        if ((size_t)(cursor->end - cursor->at) >= length &&
            memcmp(cursor->at, functions[i].name, length) == 0) {
            cursor->at += length;
            return &functions[i];
        }
    }
    return NULL;
}

/* name "(" number { number } ")" */
static bcifs_status function_read(struct svg_cursor *cursor, struct svg_transform *transform)
{
    double numbers[6];
    size_t count = 0;
    const char *place = cursor->at;
    const struct function *function = function_find(cursor);
    if (!function)
        return svg_expected(cursor, "matrix, translate, scale, rotate, skewX or skewY in the transform");
    svg_skip_space(cursor);
    if (cursor->at == cursor->end || *cursor->at != '(')
        return svg_expected(cursor, "'(' in the transform");
    cursor->at++;
    cursor->after_number = false;
    while (count < function->most && (count == 0 || svg_number_follows(cursor))) {
        bcifs_status status = svg_number(cursor, "a number in the transform", &numbers[count++]);
        if (status)
            return status;
    }
    svg_skip_space(cursor);
    if (cursor->at == cursor->end || *cursor->at != ')')
        return svg_expected(cursor, "')' in the transform");
    cursor->at++;
    if (count < function->least || (function->make == rotate && count == 2))
        return svg_error(cursor, place, "%s in the transform has too few numbers: %zu", function->name,
                         count);
    *transform = product(*transform, function->make(numbers, count));
    return BCIFS_OK;
}

bcifs_status svg_transform_read(struct svg_cursor *cursor, struct svg_transform *transform)
{
    bcifs_status status = BCIFS_OK;
    svg_skip_space(cursor);
    if (cursor->end - cursor->at == 4 && memcmp(cursor->at, "none", 4) == 0)
        return BCIFS_OK;
    while (cursor->at < cursor->end && status == BCIFS_OK) {
        status = function_read(cursor, transform);
        svg_skip_space(cursor);
        if (status == BCIFS_OK && cursor->at < cursor->end && *cursor->at == ',') {
            cursor->at++;
            svg_skip_space(cursor);
        }
    }
    return status;
}

void svg_transform_apply(const struct svg_transform *t, const double point[2], double image[2])
{
    double x = point[0], y = point[1];
    image[0] = t->a * x + t->c * y + t->e;
    image[1] = t->b * x + t->d * y + t->f;
}
