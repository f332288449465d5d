/* Module: one file of an automaton, with the params and lets that its expressions can name.
 *
 * The main file is module 0; every `use` brings in another, with a name that prefixes its states. */
#ifndef AUTOMATON_MODULE_H
#define AUTOMATON_MODULE_H

#include "automaton/automaton.h"

/* Parses `source` and, recursively, the files it uses; registers their params. `use` of the module `owner` asked for
 * it; both are NULL for the main file. */
bcifs_status module_load(bcifs_automaton *automaton, const struct source *source, const struct syntax_use *use,
                         struct module *owner, struct report *report, struct module **module);
/* The module that `name` (after `use … as`) stands for in `owner`, or NULL. */
struct module *module_named(const bcifs_automaton *automaton, const struct module *owner, const char *name);
/* "owner.name", or just the name in the main file. */
char *module_qualify(bcifs_automaton *automaton, const struct module *module, const char *name);

/* Resolves every let and evaluates the params in order, those in options->settings from there. */
bcifs_status parameters_bind(bcifs_automaton *automaton, const bcifs_load_options *options,
                             struct report *report);

#endif
