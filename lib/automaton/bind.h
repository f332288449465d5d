/* Bind: from parsed files to an automaton: definitions, references, products and what each may depend on. */
#ifndef AUTOMATON_BIND_H
#define AUTOMATON_BIND_H

#include "automaton/automaton.h"

/* Makes the definitions and figures of all modules, resolves every name, makes the products and joints that they
 * imply, and validates what can be said without numbers. Reports every independent error. */
bcifs_status automaton_bind(bcifs_automaton *automaton, struct report *report);

#endif
