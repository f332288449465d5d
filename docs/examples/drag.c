/* Drags a control point of a curve whose scheme is in an automaton file, as an editor does while the pointer moves; the
 * area stays what it was. Usage: drag FILE */
#include <bcifs.h>
#include <stdio.h>

static int complain(const bcifs_error *error)
{
    fprintf(stderr, "drag: %s\n", error->message);
    return 1;
}

int main(int count, char **words)
{
    bcifs_automaton *automaton = NULL;
    bcifs_figure *figure = NULL;
    bcifs_editor *editor = NULL;
    bcifs_error error;
    bcifs_edit_report report;
    const bcifs_editor_options options = {.refine = 2, .coarsen = 2};
    const size_t point = 0;
    if (count != 2 || bcifs_load(words[1], NULL, &automaton, &error) ||
        bcifs_figure_create(automaton, NULL, &figure, &error) ||
        bcifs_editor_create(figure, &options, &editor, &error) || bcifs_editor_grab(editor, &point, 1, &error))
        return complain(&error);
    printf("%zu control points, dragged by %zu\n", bcifs_editor_points(editor), bcifs_editor_scale_points(editor));
    for (int step = 1; step <= 3; step++) {
        if (bcifs_editor_drag(editor, 0.5 * step, 1.0 * step, &error))
            return complain(&error);
        bcifs_editor_report(editor, &report);
        printf("dragged by (%.1f, %.1f): area %.6f, without the answer %.6f\n", 0.5 * step, 1.0 * step, report.after,
               report.deformed);
    }
    if (bcifs_editor_release(editor, &error))
        return complain(&error);
    bcifs_editor_undo(editor);
    bcifs_editor_report(editor, &report);
    printf("undone: area %.6f\n", report.after);
    bcifs_editor_free(editor);
    bcifs_figure_free(figure);
    bcifs_automaton_free(automaton);
    return 0;
}
