/* Draws the colour bar beside a picture, with its range in figures. */
#include "draw/bar.h"

#include "draw/colour.h"
#include "draw/glyph.h"

#include <math.h>
#include <stdio.h>

void cs_bar_init(struct cs_bar *bar, const struct cs_render *render) {
    bar->width = (double)render->size[0];
    bar->height = (double)render->size[1];
    bar->percent = render->look == CS_LOOK_STRAIN;
    cs_colour_ink(render->background, bar->ink);
}

static void add_frame(struct cs_lines *lines, const double box[4]) {
    const double corners[4][3] = {{box[0], box[1], 0},
                                  {box[0] + box[2], box[1], 0},
                                  {box[0] + box[2], box[1] + box[3], 0},
                                  {box[0], box[1] + box[3], 0}};
    for (int i = 0; i < 4; i++)
        cs_lines_add(lines, corners[i], corners[(i + 1) % 4]);
}

static void add_label(const struct cs_bar *bar, struct cs_lines *lines, double value, double x,
                      double y, double size) {
    char text[40];
    snprintf(text, sizeof text, "%.3g %s", bar->percent ? 100 * value : value,
             bar->percent ? "%" : "N");
    cs_glyph_add(lines, text, x, y + size / 2, size);
}

void cs_bar_draw(const struct cs_bar *bar, struct cs_lines *lines, const double range[2]) {
    // figures stay legible on small pictures, which then have fewer
    const double unit = fmax(bar->height / 480, 0.75), length = 0.39 * bar->height;
    const int steps = length > 100 * unit ? 4 : 1;
    const double box[4] = {bar->width - 32 * unit, bar->height - 18 * unit - length, 14 * unit,
                           length};
    struct cs_line_style style = {
        .colour = {bar->ink[0], bar->ink[1], bar->ink[2]}, .alpha = 0.85, .flat = true};

    lines->ramp(lines, box);
    add_frame(lines, box);
    for (int i = 0; i <= steps; i++) {
        const double y = box[1] + box[3] * (1 - (double)i / steps);
        const double from[3] = {box[0] - 4 * unit, y, 0}, to[3] = {box[0], y, 0};
        cs_lines_add(lines, from, to);
    }
    style.half_width = 0.5 * unit;
    cs_lines_draw(lines, &style);

    for (int i = 0; i <= steps; i++) {
        const double share = (double)i / steps;
        add_label(bar, lines, range[0] + share * (range[1] - range[0]), box[0] - 9 * unit,
                  box[1] + box[3] * (1 - share), 9 * unit);
    }
    style.half_width = 0.62 * unit;
    cs_lines_draw(lines, &style);
}
