/* Sixel images by libsixel. Its header is not needed to build: the calls below are those of
 * version 1 of its interface (libsixel.so.1). */
#include "cli/show/sixel.h"

#include <dlfcn.h>

/* sixel.h: 24-bit RGB, and the choice of everything else left to the library. */
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

bool cs_sixel_load(void) {
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

static int add(char *data, int size, void *ctx) {
    cs_text_add(ctx, "%.*s", size, data);
    return 0;
}

bool cs_sixel_add(const struct cs_image *image, struct cs_text *out) {
    const int width = (int)image->width, height = (int)image->height;
    void *output = NULL, *dither = NULL;
    const bool done = is_ok(sixel.output_new(&output, add, out, NULL)) &&
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
