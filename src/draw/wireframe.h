/* wireframe.h - cloth as lines: edges, springs by kind, pins, goals. */
#ifndef CS_DRAW_WIREFRAME_H
#define CS_DRAW_WIREFRAME_H

#include "draw/line.h"
#include "model/system/system.h"

/* Sizes of lines on a picture. */
struct cs_wireframe {
    const struct cs_system *system;
    double line_unit;    /* pixels of a line of width 1: a 480th of the height */
    double cell;         /* pixels between neighbours where the camera looks */
    double depth_offset; /* m */
};

/* Half a line's width in pixels: a share of the cell, so that fine grids keep gaps, but within
 * these bounds in units. */
double cs_wireframe_width(const struct cs_wireframe *net, double share, double least,
                          double most);

/* Lines that the largest of these calls adds before it draws. */
uint32_t cs_wireframe_capacity(const struct cs_system *system);

void cs_wireframe_draw_edges(const struct cs_wireframe *net, struct cs_lines *lines,
                             const double *x);
void cs_wireframe_draw_springs(const struct cs_wireframe *net, struct cs_lines *lines,
                               const double *x);
void cs_wireframe_draw_pins(const struct cs_wireframe *net, struct cs_lines *lines,
                            const double *x, const double *inv_mass);
/* A line from each particle to its goal, and a dot there; goals (3,n). A particle at its goal
 * has the dot alone. */
void cs_wireframe_draw_goals(const struct cs_wireframe *net, struct cs_lines *lines,
                             const double *x, const double *goals);
/* Bodies that are one row or column of particles and have no surface: a thread with knots. */
void cs_wireframe_draw_threads(const struct cs_wireframe *net, struct cs_lines *lines,
                               const double *x);

#endif
