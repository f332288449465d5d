/* Area report: what the reports of an area and of its matrices have in common. */
#ifndef OUTPUT_AREA_REPORT_H
#define OUTPUT_AREA_REPORT_H

#include "base/text.h"
#include "multires/area.h"

/* The members of the JSON object of an area, without its braces. */
void area_json_members(struct text *text, const bcifs_area *area);
/* The names and the area, a line each. */
void area_text_head(struct text *text, const bcifs_area *area);

#endif
