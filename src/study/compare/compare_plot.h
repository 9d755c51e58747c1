/* compare_plot.h - prints cells as a log-log diagram: a gnuplot script with its data. */
#ifndef CS_COMPARE_PLOT_H
#define CS_COMPARE_PLOT_H

#include "study/compare/compare_curves.h"

/* Adds the script: curves, the front behind them, quartiles of processor time as bars. If y is
 * an error of position, nothing below the reference's bar is drawn. A run that did not finish
 * is a cross at the upper edge; a ring marks a cell in which edges went through triangles. */
void cs_plot_print(const struct cs_plot_settings *settings, struct cs_text *out);

/* Writes FOLDER/NAME.gp, and the pictures if gnuplot is found. *drawn: they were made.
 * CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_plot_write(const struct cs_plot_settings *settings, const char *folder,
                             bool *drawn, struct cs_error *error);

#endif
