/* glyph.h - figures, and the letters of the bar: strokes, the only lettering of pictures. */
#ifndef CS_DRAW_GLYPH_H
#define CS_DRAW_GLYPH_H

#include "draw/line.h"

enum { CS_GLYPH_LINES = 16 }; /* no glyph has more strokes' lines */

/* Adds the lines of a text of 0123456789.-+ N%acefinorst, right-aligned: x, y are the pixels of
 * the right end of the base line, height that of a figure. Other letters leave a gap. */
void cs_glyph_add(struct cs_lines *lines, const char *text, double x, double y, double height);

#endif
