/* Parameter maps as files: the table of their formats. */
#include <string.h>

#include "automaton/automaton.h"
#include "output/map_draw.h"
#include "output/picture.h"
#include "output/provenance.h"

/* One grid point a line, the second param changing fastest. */
static bcifs_status map_csv_write(const bcifs_map *map, const struct job *job, struct file *file)
{
    (void)job;
    for (size_t axis = 0; axis < map->axis_count; axis++) {
        file_text(file, map->axes[axis].name);
        file_text(file, ",");
    }
    file_text(file, "class\n");
    for (size_t i = 0; i < map->columns && !file_failed(file); i++)
        for (size_t j = 0; j < map->rows; j++) {
            file_number(file, map->axes[0].nodes[i].real);
            file_text(file, ",");
            if (map->axis_count > 1) {
                file_number(file, map->axes[1].nodes[j].real);
                file_text(file, ",");
            }
            file_text(file, bcifs_map_class_name(bcifs_map_at(map, i, j)));
            file_text(file, "\n");
        }
    return BCIFS_OK;
}

static const struct {
    const char *name;
    bcifs_status (*write)(const bcifs_map *map, const struct job *job, struct file *file);
} FORMATS[] = {{"csv", map_csv_write}, {"svg", map_svg_write}, {"png", map_png_write}};

/* The index of the format asked for, by name or by the ending of the path; "-" without a name is csv. */
static bcifs_status format_choose(const char *path, const char *name, struct report *report, size_t *index)
{
    const char *slash = strrchr(path, '/'), *ending = strrchr(slash ? slash + 1 : path, '.');
    if (!name)
        name = strcmp(path, "-") == 0 ? "csv" : ending ? ending + 1 : "";
    for (*index = 0; *index < sizeof FORMATS / sizeof FORMATS[0]; ++*index)
        if (strcmp(FORMATS[*index].name, name) == 0)
            return BCIFS_OK;
    return report_failure(report, BCIFS_INPUT, NULL, "a map is written as csv, svg or png, not '%s'", name);
}

bcifs_status bcifs_map_write(const bcifs_map *map, const char *path, const bcifs_write_options *options,
                             bcifs_error *error)
{
    static const bcifs_write_options defaults = {0};
    struct report report = report_new(NULL);
    const struct source *sources[AUTOMATON_MOST_MODULES];
    const bcifs_automaton *automaton = map->automaton;
    struct file file;
    size_t index;
    options = options ? options : &defaults;
    struct job job = {.automaton = bcifs_automaton_name(automaton),
                      .title = bcifs_automaton_title(automaton),
                      .figure = "",
                      .command = options->command,
                      .width = options->width ? options->width : PICTURE_DEFAULT_WIDTH,
                      .report = &report};
    provenance_sources_take(&job, automaton, sources);
    bcifs_status status = format_choose(path, options->format, &report, &index);
    if (status == BCIFS_OK)
        status = file_open(&file, path, &report);
    if (status == BCIFS_OK)
        file_close(&file, FORMATS[index].write(map, &job, &file));
    return report_close(&report, error);
}
