/* Finds out what the terminal can show, and prints rows of characters in its colours. */
#include "cli/show/screen.h"

#include "cli/line/print.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

/* --- sixel images by libsixel ---
 * Its header is not needed to build: the calls below are those of version 1 of its interface
 * (libsixel.so.1). */

/* 24-bit RGB, and the choice of everything else left to the library. */
enum { RGB888 = 3, AUTO = 0, COLOURS = 256, DEPTH = 8 };

typedef int write_function(char *data, int size, void *ctx);

static struct {
    int (*output_new)(void **output, write_function *write, void *ctx, void *allocator);
    void (*output_destroy)(void *output);
    int (*dither_new)(void **dither, int colours, void *allocator);
    int (*dither_initialize)(void *dither, unsigned char *rgb, int width, int height,
                             int format, int largest, int representative, int quality);
    void (*dither_destroy)(void *dither);
    int (*encode)(unsigned char *rgb, int width, int height, int depth, void *dither,
                  void *output);
} sixel;

static bool is_ok(int status) {
    return !(status & 0x1000);
}

static bool load_sixel(void) {
    const struct {
        const char *name;
        void *call;
    } calls[] = {{"sixel_output_new", &sixel.output_new},
                 {"sixel_output_destroy", &sixel.output_destroy},
                 {"sixel_dither_new", &sixel.dither_new},
                 {"sixel_dither_initialize", &sixel.dither_initialize},
                 {"sixel_dither_destroy", &sixel.dither_destroy},
                 {"sixel_encode", &sixel.encode}};
    void *library = dlopen("libsixel.so.1", RTLD_NOW | RTLD_LOCAL);
    for (size_t k = 0; library && k < sizeof calls / sizeof *calls; k++)
        if (!(*(void **)calls[k].call = dlsym(library, calls[k].name)))
            return false;
    return library;
}

static int add_sixel_data(char *data, int size, void *ctx) {
    cs_text_add(ctx, "%.*s", size, data);
    return 0;
}

bool cs_sixel_add(const struct cs_image *image, struct cs_text *out) {
    const int width = (int)image->width, height = (int)image->height;
    void *output = NULL, *dither = NULL;
    const bool done = is_ok(sixel.output_new(&output, add_sixel_data, out, NULL)) &&
                      is_ok(sixel.dither_new(&dither, COLOURS, NULL)) &&
                      is_ok(sixel.dither_initialize(dither, image->rgb, width, height, RGB888,
                                                    AUTO, AUTO, AUTO)) &&
                      is_ok(sixel.encode(image->rgb, width, height, DEPTH, dither, output));
    if (dither)
        sixel.dither_destroy(dither);
    if (output)
        sixel.output_destroy(output);
    return done;
}

/* --- the terminal --- */

enum { PATIENCE_MS = 1000, ANSWER_BYTES = 256 };

/* Without an answer about their size, characters are taken for those of the VT340. */
static const double usual_cell[2] = {10, 20};

static enum cs_screen_colours find_colours(void) {
    const char *depth = getenv("COLORTERM"), *none = getenv("NO_COLOR");
    if (none && *none)
        return CS_SCREEN_PLAIN;
    return depth && (!strcmp(depth, "truecolor") || !strcmp(depth, "24bit")) ? CS_SCREEN_24_BIT
                                                                             : CS_SCREEN_256;
}

/* Reads up to the end of the primary device attributes, ESC [ ? ... c, which all terminals
 * send, after what they may say of kitty's protocol. */
static void read_answer(int terminal, char answer[ANSWER_BYTES]) {
    struct pollfd input = {.fd = terminal, .events = POLLIN};
    size_t length = 0;
    const char *attributes = NULL;
    while (length + 1 < ANSWER_BYTES && poll(&input, 1, PATIENCE_MS) > 0) {
        const ssize_t got = read(terminal, answer + length, ANSWER_BYTES - 1 - length);
        if (got <= 0)
            return;
        length += (size_t)got;
        answer[length] = 0;
        attributes = strstr(answer, "\033[?");
        if (attributes && strchr(attributes, 'c'))
            return;
    }
}

/* Asks on the terminal itself, since standard input may be a scene. A process in the background
 * must not touch its settings. */
static void ask(char answer[ANSWER_BYTES]) {
    /* kitty: would it take a picture of one pixel; then the device attributes */
    static const char question[] = "\033_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\033\\\033[c";
    struct termios before, raw;
    const int terminal = open("/dev/tty", O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (terminal >= 0 && tcgetpgrp(terminal) == getpgrp() && !tcgetattr(terminal, &before)) {
        raw = before;
        raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
        tcsetattr(terminal, TCSANOW, &raw);
        if (write(terminal, question, sizeof question - 1) == sizeof question - 1)
            read_answer(terminal, answer);
        tcsetattr(terminal, TCSANOW, &before);
    }
    if (terminal >= 0)
        close(terminal);
}

/* True if the attributes ESC [ ? a ; b ; ... c have 4: sixel. */
static bool has_sixel(const char *answer) {
    const char *attribute = strstr(answer, "\033[?");
    for (; attribute && (attribute = strpbrk(attribute + 1, ";c")) && *attribute == ';';)
        if (attribute[1] == '4' && strspn(attribute + 1, "0123456789") == 1)
            return true;
    return false;
}

static enum cs_screen_graphics find_graphics(void) {
    char answer[ANSWER_BYTES] = "";
    ask(answer);
    if (strstr(answer, "\033_Gi=31;OK"))
        return CS_SCREEN_KITTY;
    if (!has_sixel(answer))
        return CS_SCREEN_CHARACTERS;
    if (load_sixel())
        return CS_SCREEN_SIXEL;
    cs_print_message("this terminal shows sixel images: install the Debian package libsixel1");
    return CS_SCREEN_CHARACTERS;
}

enum cs_status cs_screen_open(struct cs_screen *screen, bool images, struct cs_error *error) {
    struct winsize size = {0};
    const char *kind = getenv("TERM");
    *screen = (struct cs_screen){.colours = find_colours()};
    if (!isatty(STDOUT_FILENO) && !images) {
        *screen = (struct cs_screen){.columns = 80, .rows = 24};
        return CS_OK;
    }
    if (!isatty(STDOUT_FILENO))
        return cs_fail(
            error, CS_ERR_USAGE,
            "--show draws in the window of a terminal, but standard output is a file "
            "or a pipe: remove --show");
    if (kind && !strcmp(kind, "dumb"))
        return cs_fail(error, CS_ERR_USAGE,
                       "--show: this terminal (TERM=dumb) cannot show pictures");
    /* a terminal that does not know its size */
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) || !size.ws_col || !size.ws_row)
        size = (struct winsize){.ws_col = 80, .ws_row = 24};
    if (size.ws_col < CS_SCREEN_COLUMNS_MIN)
        return cs_fail(error, CS_ERR_USAGE,
                       "--show: found a window of %u columns, expected at least %d",
                       size.ws_col, CS_SCREEN_COLUMNS_MIN);
    screen->columns = size.ws_col < CS_SCREEN_COLUMNS_MAX ? size.ws_col : CS_SCREEN_COLUMNS_MAX;
    screen->rows = size.ws_row;
    const bool measured = size.ws_xpixel && size.ws_ypixel;
    screen->cell[0] = measured ? (double)size.ws_xpixel / size.ws_col : usual_cell[0];
    screen->cell[1] = measured ? (double)size.ws_ypixel / size.ws_row : usual_cell[1];
    if (images && screen->colours != CS_SCREEN_PLAIN)
        screen->graphics = find_graphics();
    if (images)
        cs_srgb_make(&screen->srgb);
    return CS_OK;
}

/* Squared distance of two colours 0xRRGGBB. */
static uint32_t colour_distance(uint32_t a, uint32_t b) {
    uint32_t sum = 0;
    for (int k = 0; k < 24; k += 8) {
        const int d = (int)(a >> k & 255) - (int)(b >> k & 255);
        sum += (uint32_t)(d * d);
    }
    return sum;
}

/* The nearest of the 256 colours of xterm: a cube of 6 x 6 x 6 from 16 on, greys from 232 on.
 */
static uint32_t number_of(uint32_t colour) {
    uint32_t cube = 0, number = 16, sum = 0;
    for (int k = 16; k >= 0; k -= 8) {
        const uint32_t c = colour >> k & 255;
        const uint32_t level = c < 48 ? 0 : c < 115 ? 1 : (c - 35) / 40;
        cube |= (level ? 55 + 40 * level : 0) << k;
        number += level * (k == 16 ? 36 : k == 8 ? 6 : 1);
        sum += c;
    }
    const uint32_t grey = sum < 24 ? 0 : sum > 714 ? 23 : (sum / 3 - 3) / 10;
    return colour_distance(colour, (8 + 10 * grey) * 0x010101) < colour_distance(colour, cube)
               ? 232 + grey
               : number;
}

/* layer: 3 for ink, 4 for paper. */
static void add_colour(const struct cs_screen *screen, int layer, uint32_t colour,
                       struct cs_text *out) {
    if (colour == CS_SCREEN_DEFAULT)
        cs_text_add(out, "\033[%d9m", layer);
    else if (screen->colours == CS_SCREEN_256)
        cs_text_add(out, "\033[%d8;5;%um", layer, number_of(colour));
    else
        cs_text_add(out, "\033[%d8;2;%u;%u;%um", layer, colour >> 16, colour >> 8 & 255,
                    colour & 255);
}

static void add_cells(const struct cs_screen *screen, const struct cs_screen_cell *cells,
                      uint32_t n, struct cs_text *out) {
    const bool plain = screen->colours == CS_SCREEN_PLAIN;
    uint32_t ink = CS_SCREEN_DEFAULT, paper = CS_SCREEN_DEFAULT;
    for (const struct cs_screen_cell *cell = cells; cell < cells + n; cell++) {
        if (!plain && cell->ink != ink)
            add_colour(screen, 3, ink = cell->ink, out);
        if (!plain && cell->paper != paper)
            add_colour(screen, 4, paper = cell->paper, out);
        if (cell->text && !plain)
            cs_text_add(out, "%s", cell->text);
        else
            cs_text_add(out, "%c", cell->plain ? cell->plain : ' ');
    }
    if (ink != CS_SCREEN_DEFAULT || paper != CS_SCREEN_DEFAULT)
        cs_text_add(out, "\033[0m");
}

void cs_screen_add_row(const struct cs_screen *screen, const struct cs_screen_cell *row,
                       uint32_t n, struct cs_text *out) {
    while (n > 0 && !row[n - 1].plain)
        n--;
    add_cells(screen, row, n, out);
    cs_text_add(out, "\n");
}

void cs_screen_add_key(const struct cs_screen *screen, const struct cs_screen_cell *cell,
                       const char *text, uint32_t *column, struct cs_text *out) {
    struct cs_text wrapped = {0}, plain = {0};
    cs_text_add_plain(&plain, text);
    if (*column && *column + plain.length + 4 > screen->columns) {
        cs_text_add(out, "\n");
        *column = 0;
    }
    cs_print_wrapped("", cs_text_get(&plain), 2, screen->columns, &wrapped);
    cs_text_add(out, "%s", *column ? "  " : "");
    add_cells(screen, cell, 1, out);
    /* without the first blank, which the character replaces, and the end of the line */
    cs_text_add(out, "%.*s", wrapped.length ? (int)wrapped.length - 2 : 0,
                cs_text_get(&wrapped) + 1);
    *column += (*column ? 4 : 2) + (uint32_t)plain.length;
    out->failed |= wrapped.failed || plain.failed;
    cs_text_finish(&wrapped);
    cs_text_finish(&plain);
}
