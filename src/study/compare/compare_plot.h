/* compare_plot.h - cells as a log-log diagram: a gnuplot script that holds its data. */
#ifndef CS_COMPARE_PLOT_H
#define CS_COMPARE_PLOT_H

#include "study/compare/compare_curves.h"

/* Adds the script: curves, the front behind them, quartiles of processor time as bars. Where y
 * is an error of position, nothing below the reference's bar is drawn. What did not finish
 * stands as a cross at the upper edge, and a ring is about a cell in which edges went through
 * triangles. */
void cs_plot_print(const struct cs_plot_settings *settings, struct cs_text *out);

/* Writes FOLDER/NAME.gp, and the pictures where gnuplot is found. *drawn: they are there. */
enum cs_status cs_plot_write(const struct cs_plot_settings *settings, const char *folder,
                             bool *drawn, struct cs_error *error);

#endif
