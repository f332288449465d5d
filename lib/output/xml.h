/* XML: text that comes from anywhere, fit to stand in an XML file. */
#ifndef OUTPUT_XML_H
#define OUTPUT_XML_H

#include "output/file.h"

/* Text, or the value of an attribute in double quotes. XML has no way to hold a few characters at all; they
 * become U+FFFD. */
void xml_write(struct file *file, const char *text);
/* Two numbers of pixels between pieces of markup: before, width, between, height. */
void xml_size_write(struct file *file, const char *before, unsigned width, const char *between, unsigned height);

#endif
