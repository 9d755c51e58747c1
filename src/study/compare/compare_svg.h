/* compare_svg.h - cells as a log-log diagram in SVG, without another program. */
#ifndef CS_COMPARE_SVG_H
#define CS_COMPARE_SVG_H

#include "study/compare/compare_curves.h"

/* Adds an <svg> element: the front as a staircase behind the curves, quartiles of processor
 * time as bars, crosses for what did not finish. A line below names the series that there
 * was no room for. */
void cs_svg_print(const struct cs_plot_settings *settings, struct cs_text *out);

/* Adds a text with its marks escaped, for HTML and SVG. */
void cs_svg_add_text(struct cs_text *out, const char *text);

#endif
