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

#include "diagram/diagram.h"
#include "study/compare/compare_cell.h"

enum { CS_CURVES_DRAWN = CS_STYLES, CS_CURVES_MAX = 256 };

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

/* The place of a cell in a panel. y is typical of the cells around (cs_cell_typical), whose
 * values are within low and high. */
struct cs_spot {
    double x, y, own, low, high;
    bool is_drawn; /* false below the reference's own error, or without both values */
    bool on_front;
};

/* Finds the spots (n) of the cells over the column x, and the front among them: nothing is both
 * cheaper and more accurate. A column that is no cost has no front. */
void cs_spots_find(const struct cs_plot_settings *settings, const struct cs_column *x,
                   struct cs_spot *spots);

/* The cells of one series, which are adjacent. */
struct cs_curve {
    uint32_t first, n, on_front;
    double least;   /* product of cost and error of its cells; HUGE_VAL: none is drawn */
    bool is_chosen; /* to be drawn */
    uint32_t style; /* number of its style, in the order of families */
};

/* The series of a diagram. */
struct cs_curves {
    struct cs_curve list[CS_CURVES_MAX];
    uint32_t n, n_left_out; /* all; those with points for which there is no room */
};

/* Chooses the series: of more than CS_CURVES_DRAWN those with the most cells on the front are
 * drawn, then those with the least product of cost and error; all of a family, or of `methods`.
 */
void cs_curves_make(struct cs_curves *curves, const struct cs_plot_settings *settings,
                    const struct cs_spot *spots);

/* Makes the diagram; settings and cells must outlive it. Crosses at the upper edge are runs
 * that did not finish; a ring marks a cell in which edges went through triangles.
 * CS_ERR_MEMORY. */
enum cs_status cs_plot_make(struct cs_diagram *plot, const struct cs_plot_settings *settings,
                            struct cs_error *error);

#endif
