#include "output/xml.h"

#include "output/unicode.h"

void xml_write(struct file *file, const char *text)
{
    for (struct unicode next = unicode_first(text); next.length > 0; next = unicode_next(&next)) {
        uint32_t code = next.code;
        if (code == '<')
            file_text(file, "&lt;");
        else if (code == '>')
            file_text(file, "&gt;");
        else if (code == '&')
            file_text(file, "&amp;");
        else if (code == '"')
            file_text(file, "&quot;");
        else if (code == '\r')
            file_text(file, "&#13;");
        else if ((code < 0x20 && code != '\t' && code != '\n') || code == 0xfffe || code == 0xffff)
            file_text(file, "\xef\xbf\xbd");
        else
            file_write(file, next.bytes, next.length);
    }
}

void xml_size_write(struct file *file, const char *before, unsigned width, const char *between,
                    unsigned height)
{
    file_text(file, before);
    file_integer(file, width);
    file_text(file, between);
    file_integer(file, height);
}
