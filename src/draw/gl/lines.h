/* lines.h - lines and the colour bar's rectangle through OpenGL. */
#ifndef CS_DRAW_LINES_H
#define CS_DRAW_LINES_H

#include "draw/line.h"

struct cs_gl_lines {
    struct cs_lines lines; /* first: its calls are given this one */
    unsigned program, object, buffer;
    int colour_location, half_width, depth_offset, flat;
    unsigned ramp, ramp_object;
    int box;
};

enum cs_status cs_gl_lines_init(struct cs_gl_lines *lines, struct cs_error *error);

#endif
