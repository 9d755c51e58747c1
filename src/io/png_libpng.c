/* Writes images as PNG files through libpng: the same pixels, filter and chunks as
 * png_deflate.c. libpng reports errors by longjmp, so all memory hangs on a struct outside the
 * left frame. */
#include "io/png.h"
#include "base/file.h"

#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

/* State of one file, outside the frame that longjmp leaves. */
struct writer {
    struct cs_file_out out;
    png_structp png;
    png_infop info;
    uint8_t *row; /* owned: of an image with alpha; else NULL */
    int reason;   /* errno of a write that failed */
    char message[128];
};

/* Stores the message, and errno if the file failed, then leaves to setjmp in encode. */
static void on_error(png_structp png, png_const_charp message) {
    struct writer *writer = png_get_error_ptr(png);
    writer->reason = writer->out.file && ferror(writer->out.file) ? errno : 0;
    snprintf(writer->message, sizeof writer->message, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) {
    (void)png;
    (void)message;
}

static void add_texts(const struct writer *writer, const struct cs_png_text *texts,
                      uint32_t n_texts) {
    for (uint32_t i = 0; i < n_texts; i++) {
        char key[80];
        snprintf(key, sizeof key, "%s", texts[i].key);
        /* libpng copies both, and takes them unchanged although they are not const */
        png_text text = {.compression = PNG_TEXT_COMPRESSION_NONE,
                         .key = key,
                         .text = (png_charp)(uintptr_t)texts[i].value,
                         .text_length = strlen(texts[i].value)};
        png_set_text(writer->png, writer->info, &text, 1);
    }
}

/* Hands the rows to libpng; those with alpha are interleaved first. */
static void encode_rows(const struct writer *writer, const struct cs_image *image) {
    for (size_t y = 0; y < image->height; y++) {
        if (image->alpha)
            cs_png_join(image, y, writer->row);
        png_write_row(writer->png,
                      image->alpha ? writer->row : image->rgb + 3 * y * image->width);
    }
}

/* Encodes the picture: the part that libpng may leave by longjmp. Returns false if it did. */
static bool encode(struct writer *writer, const struct cs_image *image, int level,
                   const struct cs_png_text *texts, uint32_t n_texts) {
    if (setjmp(png_jmpbuf(writer->png)))
        return false;
    png_init_io(writer->png, writer->out.file);
    png_set_user_limits(writer->png, 16384, 16384);
    png_set_IHDR(writer->png, writer->info, image->width, image->height, 8,
                 image->alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(writer->png, level);
    png_set_filter(writer->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    add_texts(writer, texts, n_texts);
    png_write_info(writer->png, writer->info);
    encode_rows(writer, image);
    png_write_end(writer->png, NULL);
    return true;
}

void cs_png_encoder_finish(struct cs_png_encoder *work) {
    *work = (struct cs_png_encoder){0}; // libpng has its own memory
}

enum cs_status cs_png_write_next(struct cs_png_encoder *work, const char *path,
                                 const struct cs_image *image, const struct cs_png_text *texts,
                                 uint32_t n_texts, struct cs_error *error) {
    CS_ASSERT(image->width && image->height && image->rgb);
    struct writer writer = {0};
    enum cs_status status = cs_file_create(&writer.out, path, error);
    if (status)
        return status;
    writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &writer, on_error, on_warning);
    writer.info = writer.png ? png_create_info_struct(writer.png) : NULL;
    writer.row = image->alpha ? malloc(4 * (size_t)image->width) : NULL;
    if (!writer.info || (image->alpha && !writer.row))
        status = cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", path);
    else if (!encode(&writer, image, work->level, texts, n_texts))
        status = cs_fail(error, CS_ERR_FILE, "cannot write \"%s\": %s", path,
                         writer.reason ? strerror(writer.reason) : writer.message);
    png_destroy_write_struct(&writer.png, &writer.info);
    free(writer.row);
    if (!status)
        return cs_file_finish(&writer.out, error);
    cs_file_abandon(&writer.out);
    return status;
}
