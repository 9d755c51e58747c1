/* compare_svg.h - cells as a log-log diagram in SVG, without another program. */
#ifndef CS_COMPARE_SVG_H
#define CS_COMPARE_SVG_H

#include "study/compare/compare_plot.h"

enum { CS_SVG_CURVES = 12 };

/* Adds an <svg> element. front (n): the cells that nothing beats, drawn as a staircase behind
 * the curves; NULL: none. Of more than CS_SVG_CURVES series those with the most cells on the
 * front are drawn, then the first; a line below names the others. Quartiles of processor time
 * are bars. Colours are those of Okabe and Ito (2008), which colour-blind readers tell apart;
 * markers and dashes differ as well. */
void cs_svg_print(const struct cs_plot_settings *settings, const bool *front,
                  struct cs_text *out);

/* Adds a text with its marks escaped, for HTML and SVG. */
void cs_svg_add_text(struct cs_text *out, const char *text);

#endif
