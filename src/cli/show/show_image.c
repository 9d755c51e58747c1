/* Shows images: as such where the terminal can, else as half blocks, two pixels per character.
 */
#include "cli/show/screen.h"

#include "cli/line/print.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

/* Rows of the window that stay free: the caption, and the line of the cursor. */
enum { FREE_ROWS = 2 };

/* The largest size in characters with the proportions of the image. */
static void find_size(const struct cs_screen *screen, const struct cs_image *image,
                      uint32_t size[2]) {
    /* half blocks make square pixels where a character is twice as high as wide */
    const bool blocks = screen->graphics == CS_SCREEN_CHARACTERS;
    const double shape = blocks ? 2 : screen->cell[1] / screen->cell[0];
    const double rows_max = screen->rows > FREE_ROWS ? screen->rows - FREE_ROWS : 1;
    const double wide = shape * rows_max * image->width / image->height;
    size[0] = (uint32_t)fmax(1, fmin(screen->columns, floor(wide)));
    size[1] = (uint32_t)fmax(
        1, fmin(rows_max, floor(size[0] * (double)image->height / image->width / shape + 0.5)));
}

/* Packs a pixel as 0xRRGGBB. */
static uint32_t colour_of(const struct cs_image *image, uint32_t x, uint32_t y) {
    const uint8_t *rgb = image->rgb + 3 * ((size_t)y * image->width + x);
    return (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
}

/* A character with as much ink as the two pixels have light. */
static char shade_of(const struct cs_screen *screen, uint32_t above, uint32_t below) {
    static const char shades[] = " .:-=+*#%@";
    static const double weights[3] = {0.0722, 0.7152, 0.2126}; /* of blue, green, red: BT.709 */
    double light = 0;
    for (int k = 0; k < 3; k++)
        light += weights[k] / 2 *
                 (double)(screen->srgb.linear[above >> 8 * k & 255] +
                          screen->srgb.linear[below >> 8 * k & 255]);
    const uint32_t byte = cs_srgb_encode(&screen->srgb, (float)fmin(light, 1));
    return shades[byte * (sizeof shades - 1) / 256];
}

/* image: of a pixel per column and two per row. */
static void add_blocks(const struct cs_screen *screen, const struct cs_image *image,
                       struct cs_text *out) {
    struct cs_screen_cell row[CS_SCREEN_COLUMNS_MAX];
    for (uint32_t y = 0; y < image->height; y += 2) {
        for (uint32_t x = 0; x < image->width; x++) {
            const uint32_t above = colour_of(image, x, y), below = colour_of(image, x, y + 1);
            row[x] =
                (struct cs_screen_cell){"\u2580", shade_of(screen, above, below), above, below};
        }
        cs_screen_add_row(screen, row, image->width, out);
    }
}

/* Base64 of 3 n bytes. */
static void encode_base64(const uint8_t *bytes, size_t n, char *out) {
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t k = 0; k < n; k++, bytes += 3) {
        const uint32_t word = (uint32_t)bytes[0] << 16 | (uint32_t)bytes[1] << 8 | bytes[2];
        for (int shift = 18; shift >= 0; shift -= 6)
            *out++ = digits[word >> shift & 63];
    }
    *out = 0;
}

/* In pieces of at most 4096 bytes. The number of the image replaces the last one. */
static void add_kitty(const struct cs_image *image, const uint32_t size[2],
                      struct cs_text *out) {
    enum { PIXELS = 1024 };
    const size_t n = (size_t)image->width * image->height;
    char piece[4 * PIXELS + 1];
    cs_text_add(out, "\033_Ga=T,f=24,s=%u,v=%u,c=%u,r=%u,i=%ld,p=1,q=2,C=1,", image->width,
                image->height, size[0], size[1], (long)getpid());
    for (size_t k = 0; k < n; k += PIXELS) {
        const size_t some = n - k < PIXELS ? n - k : PIXELS;
        encode_base64(image->rgb + 3 * k, some, piece);
        cs_text_add(out, "%sm=%d;%s\033\\", k ? "\033_G" : "", k + some < n, piece);
    }
}

/* Makes room, draws without regard to where that leaves the cursor, and goes below. */
static bool add_graphics(const struct cs_screen *screen, const struct cs_image *image,
                         const uint32_t size[2], struct cs_text *out) {
    bool drawn = true;
    for (uint32_t k = 0; k < size[1]; k++)
        cs_text_add(out, "\n");
    cs_text_add(out, "\033[%uA\0337", size[1]);
    if (screen->graphics == CS_SCREEN_KITTY)
        add_kitty(image, size, out);
    else
        drawn = cs_sixel_add(image, out);
    cs_text_add(out, "\0338\033[%uB", size[1]);
    return drawn;
}

/* Pixels of the image on the screen. Images are not enlarged here: kitty does that itself. */
static void find_pixels(const struct cs_screen *screen, const struct cs_image *image,
                        const uint32_t size[2], uint32_t pixels[2]) {
    const bool blocks = screen->graphics == CS_SCREEN_CHARACTERS;
    const uint32_t whole[2] = {image->width, image->height};
    for (int k = 0; k < 2; k++) {
        const uint32_t shown = (uint32_t)fmax(1, floor(size[k] * screen->cell[k]));
        pixels[k] = blocks ? size[k] << k : shown < whole[k] ? shown : whole[k];
    }
}

enum cs_status cs_screen_show_image(struct cs_screen *screen, const struct cs_image *image,
                                    const char *caption, struct cs_error *error) {
    uint32_t size[2], pixels[2];
    struct cs_text out = {0};
    find_size(screen, image, size);
    find_pixels(screen, image, size, pixels);
    struct cs_image shown = {pixels[0], pixels[1], malloc(3 * (size_t)pixels[0] * pixels[1]),
                             NULL};
    if (!shown.rgb)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for --show");
    cs_srgb_shrink(&screen->srgb, image, pixels, 0, &shown);
    /* back to the upper left corner of the last image */
    if (screen->image_rows)
        cs_text_add(&out, "\033[%uA\r", screen->image_rows);
    screen->image_rows = size[1] + 1;
    if (screen->graphics == CS_SCREEN_CHARACTERS)
        add_blocks(screen, &shown, &out);
    else if (!add_graphics(screen, &shown, size, &out))
        cs_fail(error, CS_ERR_FILE, "--show: libsixel failed");
    free(shown.rgb);
    cs_text_add(&out, "%s\033[K\n", caption);
    if (!error->status)
        return cs_print_raw(stdout, &out, error);
    cs_text_finish(&out);
    return error->status;
}
