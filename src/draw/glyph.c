/* Draws figures and small letters as strokes, the only lettering of a picture. */
#include "draw/glyph.h"
#include "draw/look.h"
#include "draw/srgb.h"
#include "scene/picture_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Strokes as pairs of digits, x 0..4 to the right and y 0..6 up, '|' between strokes. */
struct glyph {
    char letter;
    unsigned char width;
    const char *strokes;
};

static const struct glyph glyphs[] = {
    {'0', 4, "103041453616050110"},
    {'1', 3, "042620|1030"},
    {'2', 4, "05163645440040"},
    {'3', 4, "0516364544332313|334241301001"},
    {'4', 4, "30360242"},
    {'5', 4, "460604344341301001"},
    {'6', 4, "453616050110304142331302"},
    {'7', 4, "064610"},
    {'8', 4, "13040516364544331302011030414233"},
    {'9', 4, "011030414536160504133344"},
    {'.', 0, "0000"},
    {'-', 3, "0333"},
    {'+', 4, "0343|2125"},
    {'e', 4, "02424334140301103041"},
    {'N', 4, "00064046"},
    {'a', 4, "103041433414030110|4440"},
    {'c', 4, "4334140301103041"},
    {'f', 3, "36261510|0434"},
    {'i', 0, "0400|0606"},
    {'n', 4, "0400|0314344340"},
    {'o', 4, "103041433414030110"},
    {'r', 3, "0400|031434"},
    {'s', 4, "43341403123241301001"},
    {'t', 3, "16112030|0434"},
    {'m', 4, "0400|03142320|23344340"},
    {'/', 4, "0046"},
    {'%', 4, "0046|0506161505|3031414030"},
    {'b', 4, "0600|0314344341301001"},
    {'d', 4, "4640|4334140301103041"},
    {'g', 4, "441403021141|44413000"},
    {'h', 4, "0600|0314344340"},
    {'j', 2, "24211000|2626"},
    {'k', 3, "0600|3402|1330"},
    {'l', 1, "0600"},
    {'p', 4, "0400|043443423101"},
    {'q', 4, "4440|441403021141"},
    {'u', 4, "0401103041|4440"},
    {'v', 4, "042044"},
    {'w', 4, "0410223044"},
    {'x', 4, "0440|0044"},
    {'y', 4, "0422|4400"},
    {'z', 4, "04440040"},
    {':', 0, "0101|0404"},
    {'=', 3, "0232|0434"},
    {'_', 4, "0040"},
    {',', 1, "1100"},
    {' ', 1, ""},
};

static const double gap = 1.7; // between letters, in units of the strokes

static const struct glyph *find_glyph(char letter) {
    for (size_t i = 0; i < sizeof glyphs / sizeof *glyphs; i++)
        if (glyphs[i].letter == letter)
            return glyphs + i;
    return find_glyph(' ');
}

static void add_text(struct cs_lines *lines, const char *s, double x, double y, double unit) {
    // a pair of points a line; a stroke ends before '|'
    for (; s[0] && s[1]; s += 2) {
        if (s[2] == '|') {
            s++;
            continue;
        }
        if (!s[2])
            return;
        const double from[3] = {x + unit * (s[0] - '0'), y - unit * (s[1] - '0'), 0};
        const double to[3] = {x + unit * (s[2] - '0'), y - unit * (s[3] - '0'), 0};
        cs_lines_add(lines, from, to);
    }
}

void cs_glyph_add(struct cs_lines *lines, const char *text, double x, double y, double height) {
    const double unit = height / 6;
    for (size_t i = strlen(text); i-- > 0;) {
        const struct glyph *glyph = find_glyph(text[i]);
        x -= unit * glyph->width;
        add_text(lines, glyph->strokes, x, y, unit);
        x -= unit * gap;
    }
}

double cs_glyph_width(const char *text, double height) {
    double width = 0;
    for (; *text; text++)
        width += find_glyph(*text)->width + gap;
    return width * height / 6;
}

/* Collects lines until a renderer draws them. */

enum cs_status cs_lines_init(struct cs_lines *lines, uint32_t capacity, struct cs_arena *arena,
                             struct cs_error *error) {
    lines->capacity = capacity;
    lines->ends = cs_arena_alloc_array(arena, capacity, sizeof *lines->ends, error);
    return error->status;
}

void cs_lines_add(struct cs_lines *lines, const double from[3], const double to[3]) {
    CS_ASSERT(lines->n < lines->capacity);
    float *ends = lines->ends[lines->n++];
    for (int i = 0; i < 3; i++) {
        ends[i] = (float)from[i];
        ends[3 + i] = (float)to[i];
    }
}

void cs_lines_draw(struct cs_lines *lines, const struct cs_line_style *style) {
    if (lines->n)
        lines->draw(lines, style);
    lines->n = 0;
}

/* Draws the colour bar beside a picture, with labels at round values. */

/* Rectangle of the colours, and a unit that keeps labels legible on small pictures: 1/480 of
 * the height, at least 0.75 pixel. */
struct place {
    double box[4], unit;
};

// pixels of a unit: labels of small pictures stay legible
static double unit_of(double height) {
    return fmax(height / 480, 0.75);
}

double cs_colour_bar_width(const struct cs_render *render) {
    return cs_look_of(render->look)->title ? 98 * unit_of((double)render->size[1]) : 0;
}

void cs_colour_bar_init(struct cs_colour_bar *bar, const struct cs_render *render) {
    bar->width = (double)render->size[0];
    bar->height = (double)render->size[1];
    cs_colour_ink(render->background.colour, bar->ink);
    for (int i = 0; i < 3; i++)
        bar->paper[i] = (float)render->background.colour[i];
}

// the smallest of 1, 2 and 5 times a power of ten of which `steps` span the width
static double round_step(double width, int steps) {
    double ten = 1;
    while (ten * steps < width)
        ten *= 10;
    while (ten / 10 * steps >= width)
        ten /= 10;
    return ten / 5 * steps >= width ? ten / 5 : ten / 2 * steps >= width ? ten / 2 : ten;
}

uint32_t cs_colour_bar_ticks(const double range[2], int steps,
                             double ticks[CS_COLOUR_BAR_TICKS]) {
    const double width = range[1] - range[0];
    uint32_t n = 0;
    ticks[0] = range[0];
    // no width, or less than the labels' digits can show: a single value
    if (!(width > 1e-9 * fmax(fabs(range[0]), fabs(range[1])) && width < 1e300 &&
          width > 1e-300))
        return 1;
    const double step = round_step(width, steps);
    // a bound that is round itself may lie a rounding beyond its multiple
    for (double k = ceil(range[0] / step - 1e-6); k * step <= range[1] + 1e-6 * step; k++)
        if (n < CS_COLOUR_BAR_TICKS)
            ticks[n++] = k == 0 ? 0 : k * step;
    return n;
}

/* Adds a line between two points in pixels. */
static void add_line(struct cs_lines *lines, double x, double y, double to_x, double to_y) {
    const double from[3] = {x, y, 0}, to[3] = {to_x, to_y, 0};
    cs_lines_add(lines, from, to);
}

static void add_frame(struct cs_lines *lines, const double box[4]) {
    const double right = box[0] + box[2], bottom = box[1] + box[3];
    add_line(lines, box[0], box[1], right, box[1]);
    add_line(lines, right, box[1], right, bottom);
    add_line(lines, right, bottom, box[0], bottom);
    add_line(lines, box[0], bottom, box[0], box[1]);
}

/* Draws the panel, with round corners of radius r: lines so thick and close that they fill it.
 */
static void draw_panel(const struct cs_colour_bar *bar, const struct place *place,
                       struct cs_lines *lines) {
    const double u = place->unit, r = 6 * u, *box = place->box;
    const double left = box[0] - 58 * u + r, right = box[0] + box[2] + 10 * u - r;
    const double top = box[1] - 28 * u + r, bottom = box[1] + box[3] + 10 * u - r;
    const struct cs_line_style style = {.colour = {bar->paper[0], bar->paper[1], bar->paper[2]},
                                        .alpha = 1,
                                        .half_width = r,
                                        .flat = true};
    for (double y = top; y < bottom; y += r)
        add_line(lines, left, y, right, y);
    add_line(lines, left, bottom, right, bottom);
    cs_lines_draw(lines, &style);
}

/* Height of a value in the bar, in pixels from the top: the highest value is on top. */
static double height_of(const struct place *place, const double range[2], double value) {
    const double width = range[1] - range[0];
    return place->box[1] + place->box[3] * (width > 0 ? 1 - (value - range[0]) / width : 1);
}

/* Adds ticks on the left; the one at 0 crosses the bar if values have both signs. */
static void add_ticks(const struct place *place, struct cs_lines *lines, const double range[2],
                      const double *ticks, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        const double y = height_of(place, range, ticks[i]), left = place->box[0];
        const bool is_zero = ticks[i] == 0 && range[0] < 0 && range[1] > 0;
        add_line(lines, left - 4 * place->unit, y, is_zero ? left + place->box[2] : left, y);
    }
}

/* Adds the labels of the ticks, right-aligned. */
static void add_figures(const struct place *place, struct cs_lines *lines,
                        const double range[2], const double *ticks, uint32_t n) {
    const double size = 9 * place->unit;
    for (uint32_t i = 0; i < n; i++) {
        char text[40];
        snprintf(text, sizeof text, "%.6g", ticks[i]);
        cs_glyph_add(lines, text, place->box[0] - size,
                     height_of(place, range, ticks[i]) + size / 2, size);
    }
}

void cs_colour_bar_draw(const struct cs_colour_bar *bar, struct cs_lines *lines,
                        const struct cs_frame *frame) {
    // small pictures have fewer labels
    const double unit = unit_of(bar->height), length = 0.39 * bar->height;
    const struct place place = {
        .box = {bar->width - 32 * unit, bar->height - 18 * unit - length, 14 * unit, length},
        .unit = unit};
    const double range[2] = {frame->factor * frame->range[0], frame->factor * frame->range[1]};
    double ticks[CS_COLOUR_BAR_TICKS];
    const uint32_t n = cs_colour_bar_ticks(range, length > 100 * unit ? 5 : 3, ticks);
    struct cs_line_style style = {.colour = {bar->ink[0], bar->ink[1], bar->ink[2]},
                                  .alpha = 0.85,
                                  .half_width = 0.5 * unit,
                                  .flat = true};
    draw_panel(bar, &place, lines);
    lines->ramp(lines, place.box);
    add_frame(lines, place.box);
    add_ticks(&place, lines, range, ticks, n);
    cs_lines_draw(lines, &style);

    add_figures(&place, lines, range, ticks, n);
    cs_glyph_add(lines, frame->title, place.box[0] + place.box[2], place.box[1] - 11 * unit,
                 9 * unit);
    style.half_width = 0.62 * unit;
    cs_lines_draw(lines, &style);
}
