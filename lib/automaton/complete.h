/* Complete: an automaton with open entries `?`, completed from its equations ([SI] "Résolution des
 * contraintes", "Structure des matrices"; design, section 5).
 *
 * The equations (equations.h) are solved exactly. Which unknowns stay free is chosen so that the text of the
 * answer is short; they become params of it. When the equations contradict each other, a smallest set that
 * does is kept. */
#ifndef AUTOMATON_COMPLETE_H
#define AUTOMATON_COMPLETE_H

#include "automaton/equations.h"

struct bcifs_complete {
    struct arena arena;
    const bcifs_automaton *automaton;
    struct equations equations;
    struct linear_system system; /* solved; lives until the text is made */
    size_t rank;
    bool consistent;
    /* Of an inconsistent one: equations that contradict each other, none of which can be left out, and what
     * they come to, "0 = 1/4" ("" when an equation fails for a reason in words). */
    bcifs_conflict *conflicts;
    size_t conflict_count;
    const char *contradiction;
    /* Of a consistent one: names and values of the degrees of freedom, in order of appearance, and the
     * answer. */
    const char **names;
    size_t freedom;
    const char **name_of; /* per unknown: its name when it is free and named already, otherwise NULL */
    const char *text;
};

/* Exchanges free unknowns and others until no exchange shortens the text of the answer: complete_choice.c. */
bcifs_status complete_choose(bcifs_complete *complete, struct report *report);
/* Names the degrees of freedom, gives them values and makes the text: complete_text.c. */
bcifs_status complete_write(bcifs_complete *complete, struct report *report);
/* Appends what `leading` is by a row that holds it with the factor 1 ("1-a"), or its name when row is NULL.
 * Without a `leading` unknown (SIZE_MAX), the sum that the row is. */
void complete_expression(const bcifs_complete *complete, const struct linear_row *row, size_t leading,
                         struct text *text);
/* The equations that fail in an automaton without unknowns become the conflicts: complete.c. */
bcifs_status complete_check(bcifs_complete *complete, const bcifs_automaton *automaton,
                            const bcifs_load_options *options, struct report *report);

#endif
