/* Provenance: what an SVG picture keeps so that it can be made again: the program, the command line, the texts. */
#ifndef OUTPUT_PROVENANCE_H
#define OUTPUT_PROVENANCE_H

#include "automaton/automaton.h"
#include "output/file.h"
#include "output/job.h"

/* Lists the automaton's files in `sources`, which must outlive the job, and gives the list to the job. */
void provenance_sources_take(struct job *job, const bcifs_automaton *automaton,
                             const struct source *sources[AUTOMATON_MOST_MODULES]);
/* Elements of <metadata>: the program and, unless it is NULL, the command line. */
void provenance_command_write(struct file *file, const char *command);
/* Elements of <metadata>: the text of each of the automaton's files. */
void provenance_sources_write(struct file *file, const struct job *job);

#endif
