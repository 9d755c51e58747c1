/* Draws ink, text and marks, and gathers their titles. */
#include "diagram/cairo/cairo_marks.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

/* pt, from the middle of a mark to its corners; strokes */
#define MARK_RADIUS 1.7
#define MARK_LINE   0.7

void cs_cairo_ink(cairo_t *cairo, uint32_t colour, double alpha) {
    cairo_set_source_rgba(cairo, (colour >> 16) / 255.0, (colour >> 8 & 255) / 255.0,
                          (colour & 255) / 255.0, alpha);
}

void cs_cairo_dash(cairo_t *cairo, const struct cs_style *style) {
    static const struct {
        int n;
        double lengths[4];
    } dashes[] = {{0, {0}}, {2, {4, 1.6}}, {2, {1.2, 1.2}}, {4, {5, 1.4, 1.2, 1.4}}};
    if (!(style->width > 0)) {
        cairo_new_path(cairo);
        return;
    }
    cs_cairo_ink(cairo, style->colour, 1);
    cairo_set_line_width(cairo, style->width);
    cairo_set_dash(cairo, dashes[style->dash].lengths, dashes[style->dash].n, 0);
    cairo_stroke(cairo);
    cairo_set_dash(cairo, NULL, 0, 0);
}

void cs_cairo_line(cairo_t *cairo, double x0, double y0, double x1, double y1) {
    cairo_move_to(cairo, x0, y0);
    cairo_line_to(cairo, x1, y1);
    cairo_stroke(cairo);
}

double cs_cairo_text(cairo_t *cairo, const char *text, double x, double y, double align,
                     double size) {
    struct cs_text plain = {0};
    cairo_text_extents_t extents;
    cs_text_add_plain(&plain, text);
    cairo_set_font_size(cairo, size);
    cairo_text_extents(cairo, cs_text_get(&plain), &extents);
    if (isfinite(y)) {
        cairo_move_to(cairo, x - align * extents.x_advance, y);
        cairo_show_text(cairo, cs_text_get(&plain));
    }
    cs_text_finish(&plain);
    return extents.x_advance;
}

void cs_cairo_fitted(cairo_t *cairo, const char *text, double x, double y, double align,
                     double room) {
    const double wide = cs_cairo_width(cairo, text, CS_FONT_SIZE);
    cs_cairo_text(cairo, text, x, y, align,
                  wide > room ? CS_FONT_SIZE * room / wide : CS_FONT_SIZE);
}

double cs_cairo_tick(cairo_t *cairo, const struct cs_tick *tick, double x, double y,
                     double align) {
    char label[CS_TICK_BYTES], power[CS_TICK_BYTES];
    cs_tick_print(tick, label, power);
    const double width = cs_cairo_width(cairo, label, CS_FONT_SIZE),
                 all = width + cs_cairo_width(cairo, power, CS_SMALL_SIZE);
    cs_cairo_text(cairo, label, x - align * all, y, 0, CS_FONT_SIZE);
    cs_cairo_text(cairo, power, x - align * all + width, y - 0.38 * CS_FONT_SIZE, 0,
                  CS_SMALL_SIZE);
    return all;
}

/* A marker: n corners, every second one at `inner` of the radius. */
static const struct shape {
    int n;
    double turn, radius, inner;
} shapes[] = {
    /* circle, square, triangle, diamond, inverted triangle, star */
    {24, 0, 0.95, 1},       {4, M_PI / 4, 1.2, 1},  {3, -M_PI / 2, 1.35, 1},
    {4, M_PI / 2, 1.35, 1}, {3, M_PI / 2, 1.35, 1}, {10, M_PI / 2, 1.5, 0.42}};

static void add_shape(cairo_t *cairo, const struct shape *shape, double size, double x,
                      double y) {
    for (int k = 0; k < shape->n; k++) {
        const double angle = shape->turn + 2 * M_PI * k / shape->n;
        const double r = size * shape->radius * (k % 2 ? shape->inner : 1);
        cairo_line_to(cairo, x + r * cos(angle), y + r * sin(angle));
    }
    cairo_close_path(cairo);
}

void cs_cairo_mark(cairo_t *cairo, enum cs_mark mark, const struct cs_style *style, double x,
                   double y) {
    const bool hollow = mark == CS_MARK_HOLLOW;
    cairo_new_path(cairo); /* a text leaves its end as the current point */
    cairo_set_line_width(cairo, MARK_LINE);
    cs_cairo_ink(cairo, style->colour, 1);
    if (mark == CS_MARK_CROSS)
        for (int side = -1; side <= 1; side += 2)
            cs_cairo_line(cairo, x - MARK_RADIUS, y - side * MARK_RADIUS, x + MARK_RADIUS,
                          y + side * MARK_RADIUS);
    if (mark == CS_MARK_RING) {
        cs_cairo_ink(cairo, CS_RING_COLOUR, 1);
        cairo_arc(cairo, x, y, 2.2 * MARK_RADIUS, 0, 2 * M_PI);
        cairo_stroke(cairo);
    }
    if (mark != CS_MARK_FULL && !hollow)
        return;
    add_shape(cairo, shapes + style->marker, hollow ? 0.6 * MARK_RADIUS : MARK_RADIUS, x, y);
    cs_cairo_ink(cairo, hollow ? 0xffffff : style->colour, 1);
    cairo_fill_preserve(cairo);
    cs_cairo_ink(cairo, hollow ? style->colour : 0xffffff, 1);
    cairo_set_line_width(cairo, hollow ? 0.4 : 0.2);
    cairo_stroke(cairo);
}

void cs_cairo_sample(cairo_t *cairo, const struct cs_style *style, enum cs_mark mark, double x,
                     double y) {
    cairo_move_to(cairo, x, y);
    cairo_line_to(cairo, x + CS_SAMPLE, y);
    cs_cairo_dash(cairo, style);
    cs_cairo_mark(cairo, mark, style, x + CS_SAMPLE / 2.0, y);
}

void cs_cairo_keys(cairo_t *cairo, const struct cs_diagram *diagram, double width, double *y) {
    double x = CS_MARGIN;
    for (const struct cs_key *key = diagram->keys; key < diagram->keys + diagram->n_keys;
         key++) {
        const double sample = key->kind == CS_KEY_TEXT ? 0 : CS_SAMPLE + 4;
        const double wide = sample + cs_cairo_width(cairo, key->text, CS_FONT_SIZE);
        if (x > CS_MARGIN && x + wide > width) {
            x = CS_MARGIN;
            *y += CS_LINE_HEIGHT + 1;
        }
        const double middle = *y - 0.35 * CS_FONT_SIZE;
        if (key->kind == CS_KEY_PATCH) {
            cs_cairo_ink(cairo, key->style.colour, 1);
            cairo_rectangle(cairo, x, middle - 3, CS_SAMPLE, 6);
            cairo_fill(cairo);
        } else if (key->kind == CS_KEY_SAMPLE)
            cs_cairo_sample(cairo, &key->style, key->mark, x, middle);
        cs_cairo_ink(cairo, 0, 1);
        cs_cairo_fitted(cairo, key->text, x + sample, *y, 0, width - x - sample);
        x += wide + 10;
    }
    *y += diagram->n_keys ? CS_LINE_HEIGHT : 0;
}

/* --- titles --- */

void cs_cairo_title(struct cs_text *titles, const struct cs_panel *panel,
                    const struct cs_series *series, const struct cs_point *p,
                    const double at[2]) {
    if (!titles)
        return;
    cs_text_add(titles, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"transparent\"><title>",
                at[0], at[1]);
    cs_text_add_html(titles, series->name ? series->name : "");
    cs_text_add(titles, " ");
    cs_text_add_html(titles, p->note ? p->note : "");
    if (p->mark == CS_MARK_CROSS)
        cs_text_add(titles, "\ndid not finish");
    else {
        cs_text_add(titles, "\n%.3g ", p->x);
        cs_text_add_html(titles, panel->x.label);
        cs_text_add(titles, "\n%.3g ", p->y);
        cs_text_add_html(titles, panel->y.label);
    }
    cs_text_add(titles, "</title></circle>\n");
}

void cs_cairo_finish_svg(struct cs_text *out, struct cs_text *titles) {
    static const char end[] = "</svg>";
    char *number = out->bytes ? strstr(out->bytes, "surface") : NULL;
    if (number) {
        const size_t digits = strspn(number + 7, "0123456789");
        memmove(number + 7, number + 7 + digits, strlen(number + 7 + digits) + 1);
        out->length -= digits;
    }
    for (char *at = out->bytes; at && (at = strstr(at, end)); at += strlen(end))
        out->length = (size_t)(at - out->bytes);
    cs_text_add(out, "%s%s\n", cs_text_get(titles), end);
    out->failed |= titles->failed;
    cs_text_finish(titles);
}

/* --- surfaces --- */

cairo_status_t cs_cairo_store(void *closure, const unsigned char *bytes, unsigned n) {
    cs_text_add_bytes(closure, bytes, n);
    if (((struct cs_text *)closure)->failed)
        return CAIRO_STATUS_NO_MEMORY;
    return CAIRO_STATUS_SUCCESS;
}

cairo_surface_t *cs_cairo_make_surface(enum cs_format format, double width, double height,
                                       struct cs_text *out) {
    if (format == CS_FORMAT_SVG)
        return cairo_svg_surface_create_for_stream(cs_cairo_store, out, width, height);
    if (format == CS_FORMAT_PNG)
        return cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(width * CS_PNG_SCALE),
                                          (int)ceil(height * CS_PNG_SCALE));
    cairo_surface_t *pdf =
        cairo_pdf_surface_create_for_stream(cs_cairo_store, out, width, height);
    /* equal diagrams give equal files, whenever they were drawn */
    cairo_pdf_surface_set_metadata(pdf, CAIRO_PDF_METADATA_CREATE_DATE, "");
    return pdf;
}

cairo_status_t cs_cairo_png(cairo_surface_t *surface, struct cs_text *out) {
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .format = PNG_FORMAT_RGB,
                       .flags = PNG_IMAGE_FLAG_FAST,
                       .width = (png_uint_32)cairo_image_surface_get_width(surface),
                       .height = (png_uint_32)cairo_image_surface_get_height(surface)};
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    const int stride = cairo_image_surface_get_stride(surface);
    uint8_t *rows = cairo_image_surface_get_data(surface);
    char *bytes = malloc(size);
    // in place: 4 bytes of a pixel, in the order of the machine, become 3
    for (size_t y = 0; y < image.height; y++)
        for (size_t x = 0; x < image.width; x++) {
            uint8_t *row = rows + y * (size_t)stride;
            uint32_t pixel;
            memcpy(&pixel, row + 4 * x, sizeof pixel);
            for (size_t c = 0; c < 3; c++)
                row[3 * x + c] = (uint8_t)(pixel >> (16 - 8 * c));
        }
    const bool written =
        bytes && png_image_write_to_memory(&image, bytes, &size, 0, rows, stride, NULL);
    if (written)
        cs_text_add_bytes(out, bytes, size);
    free(bytes);
    return written ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_NO_MEMORY;
}
