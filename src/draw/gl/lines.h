/* lines.h - lines and the colour bar's rectangle through OpenGL. */
#ifndef CS_DRAW_LINES_H
#define CS_DRAW_LINES_H

#include "draw/line.h"

/* OpenGL names and uniform locations; a renderer's cs_lines. */
struct cs_gl_lines {
    struct cs_lines lines; /* first: its calls cast a pointer to it back to this struct */
    unsigned program, object, buffer;
    int colour_location, half_width, depth_offset, flat;
    unsigned ramp, ramp_object;
    int box;
};

/* Builds the programs and sets the calls of `lines`. CS_ERR_MODULE. */
enum cs_status cs_gl_lines_init(struct cs_gl_lines *lines, struct cs_error *error);

#endif
