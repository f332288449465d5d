/* Write: the public side of this floor. */
#include "automaton/automaton.h"
#include "base/memory.h"
#include "automaton/figure.h"
#include "output/format.h"
#include "output/picture.h"
#include "output/provenance.h"

bcifs_status bcifs_write(const bcifs_figure *figure, const bcifs_layer *layers, size_t layer_count,
                         const char *path, const bcifs_write_options *options, bcifs_error *error)
{
    static const bcifs_write_options defaults = {0};
    struct report report = report_new(NULL);
    const bcifs_automaton *automaton = figure_automaton(figure);
    const struct source *sources[AUTOMATON_MOST_MODULES];
    options = options ? options : &defaults;
    struct job job = {.layer_count = layer_count,
                      .automaton = bcifs_automaton_name(automaton),
                      .title = bcifs_automaton_title(automaton),
                      .figure = bcifs_figure_name(figure),
                      .command = options->command,
                      .width = options->width ? options->width : PICTURE_DEFAULT_WIDTH,
                      .progress = options->progress,
                      .context = options->context,
                      .report = &report};
    provenance_sources_take(&job, automaton, sources);
    struct layer *drawn = memory_new(layer_count, sizeof *drawn);
    struct segments *segments = memory_new(layer_count, sizeof *segments);
    job.layers = drawn;
    for (size_t i = 0; drawn && segments && i < layer_count; i++) {
        segments[i] = (struct segments){layers[i].segments, layers[i].segment_count, bcifs_figure_dimension(figure)};
        struct point_source points = layers[i].plan    ? points_of_plan(layers[i].plan)
                                     : layers[i].curve ? points_of_curve(layers[i].curve)
                                                       : points_of_segments(&segments[i]);
        drawn[i] = (struct layer){points, layers[i].role, layers[i].ink};
    }
    const struct format *format = drawn && segments ? format_find(options->format, path, &report) : NULL;
    if (!drawn || !segments)
        report_memory(&report);
    else if (layer_count == 0)
        report_failure(&report, BCIFS_INPUT, NULL, "there is nothing to write");
    else if (format)
        format_write(format, &job, path);
    memory_free(segments);
    memory_free(drawn);
    return report_close(&report, error);
}

bcifs_status bcifs_write_text(const char *path, const char *text, size_t length, bcifs_error *error)
{
    struct report report = report_new(NULL);
    struct file file;
    if (file_open(&file, path, &report) == BCIFS_OK) {
        file_write(&file, text, length);
        file_close(&file, BCIFS_OK);
    }
    return report_close(&report, error);
}
