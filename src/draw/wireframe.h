/* wireframe.h - cloth as lines: edges, springs by kind, pins, goals. */
#ifndef CS_DRAW_WIREFRAME_H
#define CS_DRAW_WIREFRAME_H

#include "draw/line.h"
#include "model/system/system.h"

/* Sizes of lines on a picture; system is borrowed. */
struct cs_wireframe {
    const struct cs_system *system;
    double line_unit;    /* pixels of a line of width 1: 1/480 of the height */
    double cell;         /* pixels between neighbours at the camera's target */
    double depth_offset; /* m by which lines are moved towards the eye */
};

/* Half a line's width in pixels: the fraction `share` of the cell, so that fine grids keep
 * gaps, limited to least..most units. */
double cs_wireframe_width(const struct cs_wireframe *net, double share, double least,
                          double most);

/* Lines that the largest of these calls adds between two draws. */
uint32_t cs_wireframe_capacity(const struct cs_system *system);

/* Each adds and draws the lines of one kind from positions x (3,n). */
void cs_wireframe_draw_edges(const struct cs_wireframe *net, struct cs_lines *lines,
                             const double *x);
void cs_wireframe_draw_springs(const struct cs_wireframe *net, struct cs_lines *lines,
                               const double *x);
void cs_wireframe_draw_pins(const struct cs_wireframe *net, struct cs_lines *lines,
                            const double *x, const double *inv_mass);
/* Draws a line from each particle to its goal, and a dot there; goals (3,n). A particle at its
 * goal has the dot alone. */
void cs_wireframe_draw_goals(const struct cs_wireframe *net, struct cs_lines *lines,
                             const double *x, const double *goals);
/* Draws bodies of one row or column of particles, which have no surface, as a thread with
 * knots. */
void cs_wireframe_draw_threads(const struct cs_wireframe *net, struct cs_lines *lines,
                               const double *x);

#endif
