/* compare_plot.h - cells as a log-log diagram: a gnuplot script that holds its data. */
#ifndef CS_COMPARE_PLOT_H
#define CS_COMPARE_PLOT_H

#include "study/compare/compare_cell.h"

struct cs_plot_settings {
    const struct cs_cell *cells; /* (n) */
    uint32_t n;
    const struct cs_column *x, *y;
    const char *title;
    const char *name; /* of the pictures, NAME.png, NAME.svg and NAME.pdf */
};

/* Where a cell stands; false: it is not drawn. */
bool cs_plot_point(const struct cs_plot_settings *settings, const struct cs_cell *cell,
                   double *x, double *y);
/* The reference's own error where y is one of position; 0: none is known. */
double cs_plot_bar(const struct cs_plot_settings *settings);

/* Adds the script. Where y is an error of position, nothing below the reference's bar is drawn.
 * What did not get through stands as a cross at the upper edge. */
void cs_plot_print(const struct cs_plot_settings *settings, struct cs_text *out);

/* Writes FOLDER/NAME.gp, and the pictures where gnuplot is found. *drawn: they are there. */
enum cs_status cs_plot_write(const struct cs_plot_settings *settings, const char *folder,
                             bool *drawn, struct cs_error *error);

#endif
