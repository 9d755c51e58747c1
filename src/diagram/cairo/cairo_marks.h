/* cairo_marks.h - ink, text and marks on a cairo surface, in points. */
#ifndef CS_CAIRO_MARKS_H
#define CS_CAIRO_MARKS_H

#include "diagram/diagram.h"

#include <cairo.h>
#include <math.h>

/* Sizes in pt at print size: of text, and from one line of it to the next. */
#define CS_FONT_SIZE   8.0
#define CS_SMALL_SIZE  6.0
#define CS_LINE_HEIGHT 10.0
enum { CS_MARGIN = 3, CS_SAMPLE = 12 };

void cs_cairo_ink(cairo_t *cairo, uint32_t colour, double alpha);

/* Strokes the path in the dashes of a style; without a width it is dropped. */
void cs_cairo_dash(cairo_t *cairo, const struct cs_style *style);

void cs_cairo_line(cairo_t *cairo, double x0, double y0, double x1, double y1);

/* y of a text that is only measured */
#define CS_NO_Y ((double)NAN)

/* Writes a text with its base line at y; CS_NO_Y: writes nothing. align: 0 from x on, 0.5
 * around it, 1 up to it. Returns its width. Characters that could confuse a reader or cairo are
 * replaced. */
double cs_cairo_text(cairo_t *cairo, const char *text, double x, double y, double align,
                     double size);

static inline double cs_cairo_width(cairo_t *cairo, const char *text, double size) {
    return cs_cairo_text(cairo, text, 0, CS_NO_Y, 0, size);
}

/* The same, smaller where it would be wider than `room`. */
void cs_cairo_fitted(cairo_t *cairo, const char *text, double x, double y, double align,
                     double room);

/* The label of a tick, with a raised power of 10; returns its width. */
double cs_cairo_tick(cairo_t *cairo, const struct cs_tick *tick, double x, double y,
                     double align);

void cs_cairo_mark(cairo_t *cairo, enum cs_mark mark, const struct cs_style *style, double x,
                   double y);

/* A short line in a style with a mark on it, from x on. */
void cs_cairo_sample(cairo_t *cairo, const struct cs_style *style, enum cs_mark mark, double x,
                     double y);

/* The keys of a diagram in lines that end before `width`; *y: the base line of the first, then
 * of one below the last. */
void cs_cairo_keys(cairo_t *cairo, const struct cs_diagram *diagram, double width, double *y);

/* Adds the title of a mark, which browsers show under the pointer: of a circle that is not
 * seen, with the series, the note and the values. titles: of an SVG; NULL: adds nothing. */
void cs_cairo_title(struct cs_text *titles, const struct cs_panel *panel,
                    const struct cs_series *series, const struct cs_point *p,
                    const double at[2]);

#define CS_PNG_SCALE (300 / 72.0) /* pixels a pt */
/* Adds bytes as they come from cairo to a text. */
cairo_status_t cs_cairo_store(void *closure, const unsigned char *bytes, unsigned n);
/* Makes a surface of so many pt, whose bytes go to `out`, but for those of a PNG. */
cairo_surface_t *cs_cairo_make_surface(enum cs_format format, double width, double height,
                                       struct cs_text *out);

/* Adds the PNG of a surface of CAIRO_FORMAT_RGB24, whose pixels it spoils. Cairo's own writer
 * tries every filter on every row, which took more than half of a diagram's time. This one
 * uses none and packs quickly: files of half as many bytes again. */
cairo_status_t cs_cairo_png(cairo_surface_t *surface, struct cs_text *out);

/* Mends the bytes of an SVG: drops the surface's number, which counts those of the process, and
 * puts the titles at the end. Frees the titles. */
void cs_cairo_finish_svg(struct cs_text *out, struct cs_text *titles);

#endif
