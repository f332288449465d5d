#include "provenance.h"

#include "output/xml.h"

void provenance_sources_take(struct job *job, const bcifs_automaton *automaton,
                             const struct source *sources[AUTOMATON_MOST_MODULES])
{
    job->sources = sources;
    for (job->source_count = 0; job->source_count < automaton->module_count; job->source_count++)
        sources[job->source_count] = automaton->modules[job->source_count]->source;
}

void provenance_command_write(struct file *file, const char *command)
{
    file_text(file, "<bcifs:software>bcifs " BCIFS_VERSION "</bcifs:software>\n");
    if (!command)
        return;
    file_text(file, "<bcifs:command>");
    xml_write(file, command);
    file_text(file, "</bcifs:command>\n");
}

void provenance_sources_write(struct file *file, const struct job *job)
{
    for (size_t i = 0; i < job->source_count; i++) {
        file_text(file, "<bcifs:automaton file=\"");
        xml_write(file, job->sources[i]->name);
        file_text(file, "\">");
        xml_write(file, job->sources[i]->text);
        file_text(file, "</bcifs:automaton>\n");
    }
}
