/* Draws a stability map in characters: rows of dt, columns of the axis. */
#include "cli/show/screen.h"

#include "cli/line/print.h"

#include <stdio.h>

enum { LEFT = 10, CELL_MAX = 6 };

/* Which columns of the map are shown, and how wide. */
struct layout {
    const struct cs_screen *screen;
    const struct cs_stability *map;
    uint32_t stride, width, n; /* every stride-th column, characters of it, number of them */
};

static struct cs_screen_cell mark_of(enum cs_stability_verdict verdict) {
    return (struct cs_screen_cell){
        .plain = cs_stability_letter(verdict), .ink = 0, .paper = cs_stability_colour(verdict)};
}

/* One row: its dt, and the letter in the middle of each cell. */
static void add_row(const struct layout *layout, uint32_t r, struct cs_text *out) {
    struct cs_screen_cell row[CS_SCREEN_COLUMNS_MAX];
    for (uint32_t k = 0; k < layout->n * layout->width; k++) {
        const uint32_t c = k / layout->width * layout->stride;
        row[k] = mark_of(layout->map->columns[c].cells[r].verdict);
        row[k].plain = k % layout->width == layout->width / 2 ? row[k].plain : ' ';
    }
    cs_text_add(out, "%*.3g ", LEFT - 1, layout->map->dt[r]);
    cs_screen_add_row(layout->screen, row, layout->n * layout->width, out);
}

/* Values of columns below their middle where there is room. */
static void add_values(const struct layout *layout, struct cs_text *out) {
    size_t length = 0;
    for (uint32_t k = 0; k < layout->n; k++) {
        char label[24];
        const size_t width = (size_t)snprintf(label, sizeof label, "%.3g",
                                              layout->map->columns[k * layout->stride].value);
        const size_t middle = LEFT + k * layout->width + layout->width / 2;
        const size_t start = middle - width / 2;
        if (start < length + 1 || start + width > layout->screen->columns)
            continue;
        cs_text_add(out, "%*s%s", (int)(start - length), "", label);
        length = start + width;
    }
    cs_text_add(out, "\n");
}

/* The verdicts that occur. */
static void add_key(const struct layout *layout, struct cs_text *out) {
    const struct cs_stability *map = layout->map;
    bool there[CS_STABILITY_VERDICTS] = {false};
    for (uint32_t c = 0; c < map->n_columns; c++)
        for (uint32_t r = 0; r < map->n_rows; r++)
            there[map->columns[c].cells[r].verdict] = true;
    for (int v = 0; v < CS_STABILITY_VERDICTS; v++) {
        const struct cs_screen_cell mark = mark_of((enum cs_stability_verdict)v);
        char text[256];
        snprintf(text, sizeof text, "%s: %s", cs_stability_word((enum cs_stability_verdict)v),
                 cs_stability_help((enum cs_stability_verdict)v));
        if (there[v])
            cs_screen_add_key(layout->screen, &mark, text, out);
    }
}

void cs_screen_print_map(const struct cs_screen *screen, const struct cs_stability *map,
                         struct cs_text *out) {
    const uint32_t room = screen->columns - LEFT - 1;
    struct layout layout = {screen, map, (map->n_columns + room - 1) / room, 0, 0};
    char title[512];
    layout.n = (map->n_columns + layout.stride - 1) / layout.stride;
    layout.width = room / layout.n < CELL_MAX ? room / layout.n : CELL_MAX;
    snprintf(title, sizeof title, "%s on %s", map->series, map->session.scene.path);
    cs_print_wrapped("", title, 0, screen->columns, out);
    cs_print_wrapped("up:", "dt [s]", 4, screen->columns, out);
    snprintf(title, sizeof title, "%s [%s]", cs_axis_names[map->settings->axis],
             cs_axis_unit(map->settings->axis));
    cs_print_wrapped("right:", title, 7, screen->columns, out);
    for (uint32_t r = map->n_rows; r-- > 0;)
        add_row(&layout, r, out);
    add_values(&layout, out);
    add_key(&layout, out);
}
