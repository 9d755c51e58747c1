/* Reads PNG files of any kind as 8-bit RGB through libpng, with limits on size and memory.
 *
 * A file is untrusted. Its size, its sides and the memory of its chunks are limited before
 * libpng allocates; stated sides must fit to the length of the file; and the size of converted
 * rows is checked before the first is written. */
#include "io/png.h"
#include "base/file.h"

#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

/* limits: side in pixels, memory of a chunk, length of the file */
enum {
    SIDE_MAX = 16384,
    CHUNK_BYTES_MAX = 8 * 1024 * 1024,
    FILE_BYTES_MAX = 512 * 1024 * 1024
};

/* limit of a texture: 8192 x 8192 in all, which with its smaller copies takes 740 MB */
enum { TEXTURE_PIXELS_MAX = 1 << 26 };

/* deflate compresses by a factor of about 1032 at most */
enum { PACKING_MAX = 1100 };

/* State of one picture, outside the frame that longjmp leaves. */
struct reader {
    const unsigned char *bytes; /* borrowed */
    size_t length, at;
    png_structp png;
    png_infop info;
    struct cs_image image;
    bool on_white;     /* blend alpha over white; else drop it */
    size_t pixels_max; /* 0: any number */
    char message[128];
    const char *const *keys; /* (n) of the texts that are wanted */
    char **values;           /* (n) of the caller */
    uint32_t n;
};

/* Stores libpng's message and leaves to setjmp in decode. */
static void on_error(png_structp png, png_const_charp message) {
    struct reader *reader = png_get_error_ptr(png);
    snprintf(reader->message, sizeof reader->message, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) {
    (void)png;
    (void)message;
}

/* Copies from the bytes in memory. */
static void on_read(png_structp png, png_bytep out, size_t length) {
    struct reader *reader = png_get_io_ptr(png);
    if (length > reader->length - reader->at)
        png_error(png, "the file ends too early");
    memcpy(out, reader->bytes + reader->at, length);
    reader->at += length;
}

/* Sets the conversions that make 8-bit RGB of any kind of file. */
static void ask_for_rgb(png_structp png, bool on_white) {
    const png_color_16 white = {.red = 255, .green = 255, .blue = 255, .gray = 255};
    png_set_palette_to_rgb(png);
    png_set_expand_gray_1_2_4_to_8(png);
    png_set_scale_16(png);
    png_set_gray_to_rgb(png);
    if (on_white) {
        // by light, which needs to know the curve of the bytes
        png_set_gamma(png, PNG_DEFAULT_sRGB, PNG_DEFAULT_sRGB);
        png_set_background(png, &white, PNG_BACKGROUND_GAMMA_SCREEN, 0, 1);
    } else {
        png_set_strip_alpha(png);
    }
}

/* Allocates zeroed pixels. */
static void take_image(struct reader *reader) {
    struct cs_image *image = &reader->image;
    const uint32_t width = png_get_image_width(reader->png, reader->info);
    const uint32_t height = png_get_image_height(reader->png, reader->info);
    /* a small file that claims to be huge is not worth its memory */
    if (png_get_rowbytes(reader->png, reader->info) * height / PACKING_MAX > reader->length)
        png_error(reader->png, "the file is too short for the size that it states");
    if (reader->pixels_max && (size_t)width * height > reader->pixels_max) {
        char found[sizeof reader->message];
        snprintf(found, sizeof found, "it has %u x %u pixels, expected at most %zu in all",
                 width, height, reader->pixels_max);
        png_error(reader->png, found);
    }
    image->rgb = calloc((size_t)width * height, 3);
    if (!image->rgb)
        png_error(reader->png, "out of memory");
    image->width = width;
    image->height = height;
}

/* Copies the wanted texts, from before and after the pixels; the first of equal keys wins. */
static void copy_texts(struct reader *reader) {
    png_textp texts;
    int n_texts = 0;
    png_get_text(reader->png, reader->info, &texts, &n_texts);
    for (uint32_t k = 0; k < reader->n; k++)
        for (int i = 0; i < n_texts && !reader->values[k]; i++)
            if (!strcmp(texts[i].key, reader->keys[k]) &&
                !(reader->values[k] = strdup(texts[i].text ? texts[i].text : "")))
                png_error(reader->png, "out of memory");
}

/* Decodes the picture: the part that libpng may leave by longjmp. Returns false if it did. */
static bool decode(struct reader *reader) {
    const png_structp png = reader->png;
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_set_read_fn(png, reader, on_read);
    /* limits first: a hostile header must not make libpng take memory */
    png_set_user_limits(png, SIDE_MAX, SIDE_MAX);
    png_set_chunk_malloc_max(png, CHUNK_BYTES_MAX);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    if (reader->n)
        png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_AS_DEFAULT, (png_const_bytep) "tEXt",
                                    1);
    png_read_info(png, reader->info);
    /* before any conversion, since it judges the size of the rows as they are stored */
    take_image(reader);
    ask_for_rgb(png, reader->on_white);
    const int passes = png_set_interlace_handling(png);
    png_read_update_info(png, reader->info);
    /* rows of another size would be written past the image */
    const size_t row_bytes = 3 * (size_t)reader->image.width;
    if (png_get_rowbytes(png, reader->info) != row_bytes)
        png_error(png, "its pixel format cannot be converted to RGB");
    for (int pass = 0; pass < passes; pass++)
        for (size_t y = 0; y < reader->image.height; y++)
            png_read_row(png, reader->image.rgb + y * row_bytes, NULL);
    png_read_end(png, reader->info);
    copy_texts(reader);
    return true;
}

/* Frees all copied texts, after a failure. */
static void forget_texts(const struct reader *reader) {
    for (uint32_t k = 0; k < reader->n; k++) {
        free(reader->values[k]);
        reader->values[k] = NULL;
    }
}

static enum cs_status read_bytes(struct reader *reader, const char *name,
                                 struct cs_image *image, struct cs_error *error) {
    enum cs_status status = CS_OK;
    *image = (struct cs_image){0};
    errno = 0; // what libpng says of memory is in words alone
    if (reader->length < 8 || png_sig_cmp(reader->bytes, 0, 8))
        return cs_fail(error, CS_ERR_FILE, "cannot read \"%s\": it is not a PNG file", name);
    reader->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, reader, on_error, on_warning);
    reader->info = reader->png ? png_create_info_struct(reader->png) : NULL;
    if (!reader->info)
        status = cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", name);
    else if (!decode(reader))
        status = cs_fail(error, cs_file_status(errno), "cannot read \"%s\" as PNG: %s", name,
                         reader->message);
    png_destroy_read_struct(&reader->png, &reader->info, NULL);
    if (!status) {
        *image = reader->image;
        return CS_OK;
    }
    /* *image is filled only if every row was decoded */
    free(reader->image.rgb);
    forget_texts(reader);
    return status;
}

enum cs_status cs_png_read_bytes(const char *name, const void *bytes, size_t length,
                                 struct cs_image *image, struct cs_error *error) {
    struct reader reader = {.bytes = bytes, .length = length};
    return read_bytes(&reader, name, image, error);
}

static enum cs_status read_file(struct reader *reader, const char *path, struct cs_image *image,
                                struct cs_error *error) {
    char *bytes;
    *image = (struct cs_image){0};
    if (cs_file_read(path, FILE_BYTES_MAX, &bytes, &reader->length, error))
        return error->status;
    reader->bytes = (const unsigned char *)bytes;
    read_bytes(reader, path, image, error);
    free(bytes);
    return error->status;
}

enum cs_status cs_png_read_texts(const char *path, const char *const *keys, uint32_t n,
                                 char **values, struct cs_image *image,
                                 struct cs_error *error) {
    struct reader reader = {.keys = keys, .values = values, .n = n};
    for (uint32_t k = 0; k < n; k++)
        values[k] = NULL;
    return read_file(&reader, path, image, error);
}

enum cs_status cs_png_read(const char *path, struct cs_image *image, struct cs_error *error) {
    struct reader reader = {.pixels_max = TEXTURE_PIXELS_MAX};
    return read_file(&reader, path, image, error);
}

enum cs_status cs_png_read_on_white(const char *path, struct cs_image *image,
                                    struct cs_error *error) {
    struct reader reader = {.on_white = true};
    return read_file(&reader, path, image, error);
}
