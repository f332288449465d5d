/* Points: what a writer tabulates or draws: the points of one layer, wherever they come from, read tile by
 * tile.
 *
 * The memory that reading takes does not depend on the number of points. Every point passes here, so here
 * they are checked to be finite, counted for the progress, and told apart into groups. */
#ifndef OUTPUT_POINTS_H
#define OUTPUT_POINTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "bcifs.h"

struct job;

struct point_source {
    uint64_t count;
    unsigned dimension;
    size_t path_count; /* 0: the points are loose, or form polygons */
    unsigned polygon;  /* points of each polygon; 0: paths or loose points */
    const void *origin;
    bcifs_path (*path)(const void *origin, size_t index);
    bcifs_status (*open)(const void *origin, void **walk, bcifs_error *error);
    size_t (*next)(void *walk, double *points, size_t capacity); /* as bcifs_walker_next */
    void (*close)(void *walk);
};

struct point_source points_of_plan(const bcifs_plan *plan);
/* Pairs of points, each a path of its own. */
struct segments {
    const double *points;
    size_t count; /* of pairs */
    unsigned dimension;
};
struct point_source points_of_segments(const struct segments *segments);
/* A drawn curve, its cubic pieces as polylines. */
struct point_source points_of_curve(const bcifs_curve *curve);
/* Whether the points form neither paths nor polygons. */
bool points_are_loose(const struct point_source *source);

/* Consecutive points that belong together: a path, a polygon, or all loose points. */
struct group {
    size_t number; /* from 0 */
    uint64_t first, count;
    bool closed;
};

/* The first group; the group after `group`. Their count is 0 past the last; empty paths are passed over. */
struct group group_first(const struct point_source *source);
struct group group_next(const struct point_source *source, const struct group *group);

enum {
    TILE_POINTS = 4096 /* points of a tile: in two dimensions 64 KiB, which stays in a cache */
};

struct reader {
    struct job *job;
    const struct point_source *source;
    void *walk;
    double *tile;   /* count × dimension: the points first … first + count − 1 */
    uint64_t first; /* number of the tile's first point, from 0 */
    size_t count;
};

/* Reads the points of one layer of a job from the start. On failure nothing is left to close. */
bcifs_status reader_open(struct reader *reader, struct job *job, size_t layer);
/* Reads the next tile; its count is 0 past the last point. */
bcifs_status reader_next(struct reader *reader);
void reader_close(struct reader *reader);

#endif
