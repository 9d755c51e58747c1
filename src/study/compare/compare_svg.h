/* compare_svg.h - prints cells as a log-log diagram in SVG, without another program. */
#ifndef CS_COMPARE_SVG_H
#define CS_COMPARE_SVG_H

#include "study/compare/compare_curves.h"

/* Adds an <svg> element: the front as a staircase behind the curves, quartiles of processor
 * time as bars, crosses for runs that did not finish. A line below names series without room.
 */
void cs_svg_print(const struct cs_plot_settings *settings, struct cs_text *out);

/* Adds a text with &, <, > and quotes escaped, for HTML and SVG. */
void cs_svg_add_text(struct cs_text *out, const char *text);

#endif
