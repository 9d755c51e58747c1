/* compare_html.h - a comparison as one HTML file that needs no other. */
#ifndef CS_COMPARE_HTML_H
#define CS_COMPARE_HTML_H

#include "study/compare/ranking.h"

/* Adds the page: command, reference, verdict, warnings, diagrams as SVG, tables, machine. */
void cs_html_print(const struct cs_compare *compare, const struct cs_ranking *ranking,
                   struct cs_text *out);

#endif
