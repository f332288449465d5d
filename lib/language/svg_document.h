/* SVG document: the way through the elements of an SVG file to its first <path> that is drawn.
 *
 * XML is read as far as that takes: elements with quoted attributes, comments, CDATA, processing instructions
 * and a DOCTYPE are told apart; entities are not replaced. What stands in <defs>, <clipPath>, <mask>,
 * <marker>, <pattern> or <symbol> is not drawn where it stands and is passed over. The transforms of the path
 * and of the elements around it are applied; viewBox, which scales a whole drawing to its paper, is not. */
#ifndef LANGUAGE_SVG_DOCUMENT_H
#define LANGUAGE_SVG_DOCUMENT_H

#include "language/outline.h"
#include "language/source.h"

/* Reads the outline. `outline` is zeroed; on failure its points may have been allocated. */
bcifs_status svg_document_read(const struct source *source, struct report *report,
                               struct bcifs_curve *outline);
/* Whether a text is XML and not numbers: its first character that is not white space is '<'. */
bool svg_document_likely(const struct source *source);

#endif
