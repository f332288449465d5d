/* Provenance: what an SVG picture keeps so that it can be made again: the program, the command line, the texts. */
#ifndef OUTPUT_PROVENANCE_H
#define OUTPUT_PROVENANCE_H

#include "output/file.h"
#include "output/job.h"

/* Elements of <metadata>: the program and, unless it is NULL, the command line. */
void provenance_command_write(struct file *file, const char *command);
/* Elements of <metadata>: the text of each of the automaton's files. */
void provenance_sources_write(struct file *file, const struct job *job);

#endif
