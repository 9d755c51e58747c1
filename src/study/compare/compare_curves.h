/* compare_curves.h - what every diagram of a comparison shows: which curves, in which style,
 * over which ranges, with which ticks, and the front.
 */
#ifndef CS_COMPARE_CURVES_H
#define CS_COMPARE_CURVES_H

#include "study/compare/compare_cell.h"

enum {
    CS_CURVES_DRAWN = 12,
    CS_CURVES_MAX = 256,
    CS_TICKS_MAX = 512,
    CS_CURVE_COLOURS = 7,
    CS_CURVE_SHAPES = 5
};

struct cs_plot_settings {
    const struct cs_cell *cells; /* (n) */
    uint32_t n;
    const struct cs_column *x, *y;
    const char *family; /* one of cs_family_names: its series alone, all of them; NULL: all */
    const char *title;
    const char *name; /* of the pictures, NAME.png, NAME.svg and NAME.pdf */
};

/* The cells of one series, which stand together. */
struct cs_curve {
    uint32_t first, n, is_drawn, on_front;
    uint32_t bars, failed_marks; /* cells with quartiles; that did not finish */
    double log_cost_excess; /* least cost over that of the front at its error, as a logarithm */
    uint32_t
        crossing_marks; /* cells that are drawn and in which edges went through triangles */
    int family;         /* number in cs_family_names */
    int style; /* colour and marker, in the order of the legend; below 0: it is not drawn */
};

/* Ranges are decimal logarithms, a little wider than the data. */
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
/* of the ring about a cell in which edges went through triangles */
#define CS_RING_COLOUR "#b00020"

/* Crosses stand at the upper edge, for which there is room where there are any. Of more than
 * CS_CURVES_DRAWN series those with the most cells on the front are drawn, then those that come
 * nearest to it; in the order of their families. */
void cs_curves_make(struct cs_curves *curves, const struct cs_plot_settings *settings);

/* Curves that have points and no room. */
uint32_t cs_curves_left_out(const struct cs_curves *curves);
/* Whether the reference's own error is within the range. */
bool cs_curves_show_bar(const struct cs_curves *curves);
/* Where crosses stand. */
double cs_curves_edge(const struct cs_curves *curves);

/* Where a cell stands; false: it is not drawn, such as below the reference's own error. */
bool cs_curves_point(const struct cs_plot_settings *settings, const struct cs_cell *cell,
                     double *x, double *y);
/* Whether it has quartiles of the processor time on the x axis. */
bool cs_curves_quartiles(const struct cs_plot_settings *settings, const struct cs_cell *cell);
/* Where the cross of a cell that did not finish stands; false: it has none. */
bool cs_curves_cross(const struct cs_curves *curves, const struct cs_cell *cell, double *x);

/* The next cell of the front after *k, from the cheapest to the most accurate; *k is UINT32_MAX
 * at first. false: there is none, or x is no cost. */
bool cs_curves_front(const struct cs_curves *curves, uint32_t *k);

/* A tick at digit times 10^decade; label: it is written beside it. */
struct cs_tick {
    double position; /* decimal logarithm */
    int digit, decade;
    bool label;
};
/* Decades have a label, within two of them 2 and 5 as well, and within one all digits; over ten
 * of them every second or third has. How many there are. */
uint32_t cs_curves_ticks(const double range[2], struct cs_tick ticks[CS_TICKS_MAX]);

#endif
