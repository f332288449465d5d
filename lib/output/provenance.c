#include "provenance.h"

#include "output/xml.h"

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
