/* Draws figures and small letters as strokes, the only lettering of a picture. */
#include "draw/glyph.h"

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
    {'m', 4, "0400|03142320|23344340"},
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
