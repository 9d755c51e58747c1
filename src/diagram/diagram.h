/* diagram.h - diagrams as data: panels with axes, and what is drawn in them.
 *
 *   a study describes a diagram
 *   -> cs_diagram_write: PNG, SVG and PDF by the module diagram-cairo.so, loaded here
 *   -> cs_screen_print_diagram: characters
 * Texts are data: no character of them has a meaning. */
#ifndef CS_DIAGRAM_H
#define CS_DIAGRAM_H

#include "base/arena.h"
#include "base/text.h"

#include <stdint.h>

/* Widths in mm: of one and of two columns of a journal. */
#define CS_WIDTH_COLUMN 88.0
#define CS_WIDTH_PAGE   180.0

enum { CS_PANELS_MAX = 8, CS_TICKS_MAX = 512, CS_LABEL_BYTES = 160, CS_KEYS_MAX = 16 };
enum { CS_STYLES = 12, CS_TICK_BYTES = 32, CS_TITLE_BYTES = 640 };

/* The terminal's letter of a series is that of its style. */
struct cs_style {
    uint32_t colour;      /* 0xRRGGBB */
    uint8_t dash, marker; /* of 4 and of 6 */
    double width;         /* of the line in pt; 0: no line */
};

#define CS_FRONT_COLOUR 0xf0e442u
#define CS_RING_COLOUR  0xb00020u
#define CS_BAR_COLOUR   0xdcdcdcu

/* Style of the n-th series. Twelve differ by dash and marker alone, for readers of grey prints;
 * the colours are those of Okabe, Ito 2008, which colour-blind readers tell apart. */
struct cs_style cs_style_of(uint32_t n);

struct cs_plot_axis {
    char label[CS_LABEL_BYTES]; /* quantity and unit */
    bool logarithmic;
    double range[2]; /* of a logarithmic axis decimal logarithms */
};

/* Fraction of the axis at a value; not finite where the axis has no such value. */
double cs_plot_axis_at(const struct cs_plot_axis *axis, double value);
/* Extends the range to a value. */
void cs_plot_axis_include(struct cs_plot_axis *axis, double value);
/* Widens the range by a margin, and to at least a factor of four, or by a tenth. */
void cs_plot_axis_widen(struct cs_plot_axis *axis);

/* A tick at digit times 10^decade of a logarithmic axis; digit 0: of another, on which every
 * n-th, for n = 2, 5 or 10, is where n divides decade. */
struct cs_tick {
    double at, value; /* fraction of the axis */
    int digit, decade;
    bool label, plain; /* it has a label; written without a power of 10 */
};

/* Fills the ticks of an axis; returns their number. Decades have a label, within two of them 2
 * and 5 as well, within one 3; above ten decades only every second or third has one.
 */
uint32_t cs_plot_axis_ticks(const struct cs_plot_axis *axis,
                            struct cs_tick ticks[CS_TICKS_MAX]);
/* Prints the label for print, and its power of 10, which may be "". */
void cs_tick_print(const struct cs_tick *tick, char label[CS_TICK_BYTES],
                   char power[CS_TICK_BYTES]);

/* Later ones lie below earlier ones, but for the ring. */
enum cs_mark { CS_MARK_NONE, CS_MARK_FULL, CS_MARK_HOLLOW, CS_MARK_CROSS, CS_MARK_RING };

struct cs_point {
    double x, y;
    double low, high; /* ends of a bar along x; NAN: none */
    double band[2];   /* of its series, if that has a band, along y; NAN: not here */
    enum cs_mark mark;
    bool joined, ring; /* on the line of its series; with a ring around it */
    bool front;        /* in capitals in a terminal */
    const char *note;  /* borrowed; what an SVG tells of its mark with the values; NULL: none */
};

/* One without a name is a border: below all lines, and filled in a terminal. */
struct cs_series {
    const char *name; /* borrowed; stands where its line ends; NULL: none */
    struct cs_style style;
    bool has_band;
    uint32_t n;
    struct cs_point *points; /* (n) of the diagram's memory */
};

/* A filled rectangle; in a terminal its letter. */
struct cs_diagram_rect {
    double left, right, bottom, top;
    uint32_t colour;
    char letter;
};

struct cs_panel {
    struct cs_plot_axis x, y;
    double aspect;  /* height of the box of the axes over its width */
    bool is_single; /* the y axis says what its one series is: it is not named beside it */
    uint32_t n_boxes, n_series;
    struct cs_diagram_rect *boxes; /* (n_boxes) below the series; both of its memory */
    struct cs_series *series;      /* (n_series) later ones over earlier ones */
};

enum cs_key_kind { CS_KEY_TEXT, CS_KEY_PATCH, CS_KEY_SAMPLE };

/* The meaning of a colour or mark, below the panels. */
struct cs_key {
    enum cs_key_kind kind;
    enum cs_mark mark;
    struct cs_style style;
    char letter; /* in a terminal; 0: not there */
    char text[CS_LABEL_BYTES];
    const char *help; /* borrowed; follows the text in a terminal; NULL: nothing */
};

/* A diagram with its memory, in which series, points and boxes are. */
struct cs_diagram {
    char title[CS_TITLE_BYTES]; /* "": none */
    double width;               /* mm */
    uint32_t columns;           /* panels side by side, with one y axis */
    uint32_t n_panels, n_keys;
    struct cs_panel panels[CS_PANELS_MAX];
    struct cs_key keys[CS_KEYS_MAX];
    struct cs_arena arena;
};

/* Begins a diagram without panels; cs_plot_finish must be called in any case. title: copied;
 * NULL: none. */
void cs_plot_begin(struct cs_diagram *plot, const char *title, double width);
void cs_plot_finish(struct cs_diagram *plot);
/* Adds a key unless there is no room; returns it for further settings. */
struct cs_key *cs_diagram_add_key(struct cs_diagram *diagram, enum cs_key_kind kind,
                                  uint32_t colour, char letter, const char *text);
/* Adds a panel of empty ranges, with room for so many series. NULL: no room for it, or
 * CS_ERR_MEMORY. */
struct cs_panel *cs_plot_add_panel(struct cs_diagram *plot, double aspect, uint32_t n_series,
                                   struct cs_error *error);
/* Adds a series, with room for so many points. NULL: CS_ERR_MEMORY. */
struct cs_series *cs_plot_add_series(struct cs_diagram *plot, struct cs_panel *panel,
                                     struct cs_series series, uint32_t n_points,
                                     struct cs_error *error);

/* Extends the ranges of both axes to all points and bars of its series with names, but for
 * crosses. */
void cs_panel_fit(struct cs_panel *panel);

enum cs_format { CS_FORMAT_PNG, CS_FORMAT_SVG, CS_FORMAT_PDF, CS_FORMATS };
extern const char *const cs_format_names[]; /* closed by NULL */
enum { CS_FORMATS_ALL = (1 << CS_FORMATS) - 1 };

#define CS_DIAGRAM_ABI 4u /* raised with every change of the structs above or below */
/* The module exports this table as clothsim_diagram. */
struct cs_diagram_module {
    unsigned abi;
    /* Draws into *bytes (length), malloc'ed, the caller's. CS_ERR_MEMORY, CS_ERR_MODULE. */
    enum cs_status (*draw)(const struct cs_diagram *diagram, enum cs_format format,
                           char **bytes, size_t *length, struct cs_error *error);
};

/* Writes PATH.png, PATH.svg and PATH.pdf, as far as `formats` has their bits. Equal diagrams
 * give equal files. folder: of the module. CS_ERR_MODULE: it is missing; CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_diagram_write(const char *folder, const struct cs_diagram *diagram,
                                const char *path, unsigned formats, struct cs_error *error);

/* Adds the diagram as an <svg> element for a page. CS_ERR_MODULE, CS_ERR_MEMORY. */
enum cs_status cs_diagram_add_svg(const char *folder, const struct cs_diagram *diagram,
                                  struct cs_text *out, struct cs_error *error);

#endif
