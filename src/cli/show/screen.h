/* screen.h - pictures and diagrams in the window of a terminal, for the options --show.
 *
 *   cs_screen_open: size, colours and graphics of the terminal
 *   -> cs_screen_show_image: kitty's protocol, sixel, or two pixels per character
 *   -> cs_screen_print_diagram: characters
 * Nothing of it runs without --show. */
#ifndef CS_SCREEN_H
#define CS_SCREEN_H

#include "base/image.h"
#include "base/status.h"
#include "base/text.h"
#include "diagram/diagram.h"
#include "draw/srgb.h"

enum cs_screen_colours { CS_SCREEN_PLAIN, CS_SCREEN_256, CS_SCREEN_24_BIT };
enum cs_screen_graphics { CS_SCREEN_CHARACTERS, CS_SCREEN_KITTY, CS_SCREEN_SIXEL };

enum { CS_SCREEN_COLUMNS_MIN = 40, CS_SCREEN_COLUMNS_MAX = 200 };

/* The terminal on standard output; zeroed: closed. */
struct cs_screen {
    uint32_t columns, rows; /* characters; columns at most CS_SCREEN_COLUMNS_MAX */
    double cell[2];         /* width and height of a character in pixels */
    enum cs_screen_colours colours;
    enum cs_screen_graphics graphics;
    uint32_t image_rows; /* of the image shown last, with its caption; 0: none */
    struct cs_srgb srgb;
};

/* Reads size and colours of the terminal: NO_COLOR, COLORTERM, TERM. images: asks the terminal
 * whether it shows images, and waits up to a second for the answer. Without colour there are no
 * images either. Where standard output is a file or a pipe, diagrams are plain text of 80 x 24
 * characters; for images it is CS_ERR_USAGE, as is a window too narrow or without control
 * sequences. */
enum cs_status cs_screen_open(struct cs_screen *screen, bool images, struct cs_error *error);

/* Shows an image above a caption of one line, in place of the last one. CS_ERR_FILE,
 * CS_ERR_MEMORY. */
enum cs_status cs_screen_show_image(struct cs_screen *screen, const struct cs_image *image,
                                    const char *caption, struct cs_error *error);

/* Adds an image as a sixel sequence, in a terminal that shows them. Returns false if the
 * library fails. */
bool cs_sixel_add(const struct cs_image *image, struct cs_text *out);

/* Adds a diagram that fits the window's height: letters and colours, and their meaning. */
void cs_screen_print_diagram(const struct cs_screen *screen, const struct cs_diagram *diagram,
                             struct cs_text *out);

/* Rows of characters, from which all views are made. */

/* The terminal's own colour. */
#define CS_SCREEN_DEFAULT UINT32_MAX

/* One character. */
struct cs_screen_cell {
    const char *text;    /* in UTF-8, with colours; NULL: as plain */
    char plain;          /* without; 0: a blank */
    uint32_t ink, paper; /* 0xRRGGBB, or CS_SCREEN_DEFAULT */
};

/* Adds n characters as one line, without blanks (plain 0) at its end. */
void cs_screen_add_row(const struct cs_screen *screen, const struct cs_screen_cell *row,
                       uint32_t n, struct cs_text *out);

/* Adds a character and its meaning: after the last one where the line has room for it, else on
 * a line of its own, wrapped. *column: characters in the line so far. */
void cs_screen_add_key(const struct cs_screen *screen, const struct cs_screen_cell *cell,
                       const char *text, uint32_t *column, struct cs_text *out);

#endif
