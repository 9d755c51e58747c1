/* compare_curves.h - the diagram of a comparison: which series it has, how they are told apart,
 * and the Pareto front.
 *
 * Diagrams are log-log: error against cost. A method of order p with cost proportional to 1/h
 * has the slope -p. The line of a series is its sweep; cells of the search for equal errors are
 * hollow marks beside it, because they were timed in other rounds. Errors of methods with error
 * control scatter from one tolerance to the next: a band has them, and the line is their median
 * (cs_cell_typical). */
#ifndef CS_COMPARE_CURVES_H
#define CS_COMPARE_CURVES_H

#include "base/arena.h"
#include "draw/diagram.h"
#include "study/compare/compare_cell.h"

enum { CS_CURVES_DRAWN = CS_STYLES, CS_CURVES_MAX = 256, CS_CURVE_PANELS = 2 };

/* Request for a diagram; pointers are borrowed. */
struct cs_plot_settings {
    const struct cs_cell *cells; /* (n) */
    uint32_t n;
    const struct cs_column *x, *y;
    const struct cs_column *second; /* of a second panel with the same y; NULL: one panel */
    bool all;                       /* all series are drawn, however many */
    const char *title;
    double width; /* mm; below CS_WIDTH_PAGE the panels stand above each other */
};

/* The cells of one series, which are adjacent. */
struct cs_curve {
    uint32_t first, n, is_drawn, on_front;
    double least; /* product of cost and error of its cells */
    int style;    /* number of its style, in the order of families; below 0: it is not drawn */
};

/* The series of a diagram. */
struct cs_curves {
    const struct cs_plot_settings *settings;
    struct cs_curve list[CS_CURVES_MAX];
    uint32_t n;
};

/* Chooses the series: of more than CS_CURVES_DRAWN those with the most cells on the front are
 * drawn, then those with the least product of cost and error; all of a family, or of `methods`.
 */
void cs_curves_make(struct cs_curves *curves, const struct cs_plot_settings *settings);

/* Number of curves with points for which there is no room. */
uint32_t cs_curves_left_out(const struct cs_curves *curves);

/* Position of a cell in data coordinates. Returns false if it is not drawn, for example below
 * the reference's own error. */
bool cs_curves_point(const struct cs_plot_settings *settings, const struct cs_cell *cell,
                     double *x, double *y);

/* Next cell of the front after *k, from the cheapest to the most accurate; *k is UINT32_MAX at
 * first. Returns false at the end, or if x is no cost. */
bool cs_curves_front(const struct cs_plot_settings *settings, uint32_t *k);

/* A diagram with its memory; zeroed: none. */
struct cs_plot {
    struct cs_diagram diagram;
    struct cs_panel panels[CS_CURVE_PANELS];
    struct cs_diagram_rect bars[CS_CURVE_PANELS]; /* below the reference's own error */
    struct cs_arena arena;
};

/* Makes the diagram; settings and cells must outlive it. Crosses at the upper edge are runs
 * that did not finish; a ring marks a cell in which edges went through triangles.
 * CS_ERR_MEMORY. */
enum cs_status cs_plot_make(struct cs_plot *plot, const struct cs_plot_settings *settings,
                            struct cs_error *error);
void cs_plot_finish(struct cs_plot *plot);

#endif
