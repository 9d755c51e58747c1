/* compare_curves.h - the content of every diagram of a comparison: curves with their styles,
 * ranges, ticks, and the Pareto front.
 *
 * Diagrams are log-log: error against cost. A method of order p with cost proportional to 1/h
 * has the slope -p. Both printers (gnuplot and SVG) draw from this model, so they show the
 * same. */
#ifndef CS_COMPARE_CURVES_H
#define CS_COMPARE_CURVES_H

#include "io/subprocess.h"
#include "study/compare/compare_cell.h"

enum {
    CS_CURVES_DRAWN = 12,
    CS_CURVES_MAX = 256,
    CS_TICKS_MAX = 512,
    CS_CURVE_COLOURS = 7,
    CS_CURVE_SHAPES = 5
};

/* Request for a diagram; pointers are borrowed. */
struct cs_plot_settings {
    const struct cs_cell *cells; /* (n) */
    uint32_t n;
    const struct cs_column *x, *y;
    const char *family; /* one of cs_family_names: its series alone, all of them; NULL: all */
    const char *title;
    const char *name; /* of the pictures, NAME.png, NAME.svg and NAME.pdf */
};

/* The cells of one series, which are adjacent. */
struct cs_curve {
    uint32_t first, n, is_drawn, on_front;
    uint32_t bars, failed_marks; /* cells with quartiles; cells that did not finish */
    double log_cost_excess; /* least cost over that of the front at its error, as a logarithm */
    uint32_t
        crossing_marks; /* cells that are drawn and in which edges went through triangles */
    int family;         /* number in cs_family_names */
    int style; /* colour and marker, in the order of the legend; below 0: it is not drawn */
};

/* Model of a diagram. Ranges are decimal logarithms, a little wider than the data. */
struct cs_curves {
    const struct cs_plot_settings *settings;
    double x[2], y[2];
    double error_bar; /* m, the reference's own error where y is one of position; 0: none */
    struct cs_curve list[CS_CURVES_MAX];
    uint32_t n;
};

/* The colours of Okabe, Ito 2008, which colour-blind readers tell apart; that of the front
 * is the eighth. */
extern const char *const cs_curve_colours[CS_CURVE_COLOURS];

#define CS_FRONT_COLOUR "#f0e442"

/* Colour of the ring around a cell in which edges went through triangles. */
#define CS_RING_COLOUR "#b00020"

/* Crosses stand at the upper edge, for which there is room where there are any. Of more than
 * CS_CURVES_DRAWN series those with the most cells on the front are drawn, then those that come
 * nearest to it; in the order of their families. */
void cs_curves_make(struct cs_curves *curves, const struct cs_plot_settings *settings);

/* Number of curves with points for which there is no room. */
uint32_t cs_curves_left_out(const struct cs_curves *curves);

/* True if the reference's own error is within the range. */
bool cs_curves_show_bar(const struct cs_curves *curves);

/* y coordinate of crosses. */
double cs_curves_edge(const struct cs_curves *curves);

/* Position of a cell in data coordinates. Returns false if it is not drawn, for example below
 * the reference's own error. */
bool cs_curves_point(const struct cs_plot_settings *settings, const struct cs_cell *cell,
                     double *x, double *y);

/* True if the cell has quartiles of the processor time on the x axis. */
bool cs_curves_quartiles(const struct cs_plot_settings *settings, const struct cs_cell *cell);

/* Position of the cross of a cell that did not finish. Returns false if it has none. */
bool cs_curves_cross(const struct cs_curves *curves, const struct cs_cell *cell, double *x);

/* Next cell of the front after *k, from the cheapest to the most accurate; *k is UINT32_MAX at
 * first. Returns false at the end, or if x is no cost. */
bool cs_curves_front(const struct cs_curves *curves, uint32_t *k);

/* A tick at digit times 10^decade. */
struct cs_tick {
    double position; /* decimal logarithm */
    int digit, decade;
    bool label;
};

/* Fills the ticks of a range; returns their number. Decades have a label, within two of them 2
 * and 5 as well, within one all digits; above ten decades only every second or third has one.
 */
uint32_t cs_curves_ticks(const double range[2], struct cs_tick ticks[CS_TICKS_MAX]);

/* Prints cells as a log-log diagram: a gnuplot script with its data. */

/* Adds the script: curves, the front behind them, quartiles of processor time as bars. If y is
 * an error of position, nothing below the reference's bar is drawn. A run that did not finish
 * is a cross at the upper edge; a ring marks a cell in which edges went through triangles. */
void cs_plot_print(const struct cs_plot_settings *settings, struct cs_text *out);

/* Writes FOLDER/NAME.gp, and the pictures if gnuplot is found and does not fail. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_plot_write(const struct cs_plot_settings *settings, const char *folder,
                             struct cs_gnuplot *gnuplot, struct cs_error *error);

/* Prints cells as a log-log diagram in SVG, without another program. */

/* Adds an <svg> element: the front as a staircase behind the curves, quartiles of processor
 * time as bars, crosses for runs that did not finish. A line below names series without room.
 */
void cs_svg_print(const struct cs_plot_settings *settings, struct cs_text *out);

/* Adds a text with &, <, > and quotes escaped, for HTML and SVG. */
void cs_svg_add_text(struct cs_text *out, const char *text);

#endif
