/* The module png-libpng.so: PNG files by libpng, read as 8-bit RGB and written.
 *
 * libpng reports errors by longjmp. All memory therefore hangs on a struct outside the frame
 * that longjmp leaves, and no error leaves this file except as a status with one sentence.
 *
 * A file that is read is untrusted. Its sides and the memory of its chunks are limited before
 * libpng allocates; stated sides must fit to the length of the file; and the size of converted
 * rows is checked before the first is written. */
#include "base/png.h"

#include <errno.h>
#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* limits: side in pixels, memory of a chunk in bytes */
enum { SIDE_MAX = 16384, CHUNK_BYTES_MAX = 8 * 1024 * 1024 };

/* deflate compresses by a factor of about 1032 at most */
enum { PACKING_MAX = 1100 };

/* State of one picture, outside the frame that longjmp leaves. */
struct job {
    png_structp png;
    png_infop info;
    char message[128];
    struct cs_image image; /* being read */
    const struct cs_png_request *request;
    const unsigned char *bytes; /* borrowed */
    size_t length, at;
    uint8_t *row; /* owned: being written, with alpha; else NULL */
};

/* Stores libpng's message and leaves to setjmp. */
static void on_error(png_structp png, png_const_charp message) {
    struct job *job = png_get_error_ptr(png);
    snprintf(job->message, sizeof job->message, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message) {
    (void)png;
    (void)message;
}

/* --- reading --- */

/* Copies from the bytes in memory. */
static void on_read(png_structp png, png_bytep out, size_t length) {
    struct job *job = png_get_io_ptr(png);
    if (length > job->length - job->at)
        png_error(png, "the file ends too early");
    memcpy(out, job->bytes + job->at, length);
    job->at += length;
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
static void take_image(struct job *job) {
    struct cs_image *image = &job->image;
    const uint32_t width = png_get_image_width(job->png, job->info);
    const uint32_t height = png_get_image_height(job->png, job->info);
    const size_t pixels_max = job->request->pixels_max;
    /* a small file that claims to be huge is not worth its memory */
    if (png_get_rowbytes(job->png, job->info) * height / PACKING_MAX > job->length)
        png_error(job->png, "the file is too short for the size that it states");
    if (pixels_max && (size_t)width * height > pixels_max) {
        char found[sizeof job->message];
        snprintf(found, sizeof found, "it has %u x %u pixels, expected at most %zu in all",
                 width, height, pixels_max);
        png_error(job->png, found);
    }
    image->rgb = calloc((size_t)width * height, 3);
    if (!image->rgb)
        png_error(job->png, "out of memory");
    image->width = width;
    image->height = height;
}

/* Copies the wanted texts, from before and after the pixels; the first of equal keys wins. */
static void copy_texts(const struct job *job) {
    const struct cs_png_request *request = job->request;
    png_textp texts;
    int n_texts = 0;
    png_get_text(job->png, job->info, &texts, &n_texts);
    for (uint32_t k = 0; k < request->n; k++)
        for (int i = 0; i < n_texts && !request->values[k]; i++)
            if (!strcmp(texts[i].key, request->keys[k]) &&
                !(request->values[k] = strdup(texts[i].text ? texts[i].text : "")))
                png_error(job->png, "out of memory");
}

/* The part of reading that libpng may leave by longjmp. Returns false if it did. */
static bool decode_rows(struct job *job) {
    const png_structp png = job->png;
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_set_read_fn(png, job, on_read);
    /* limits first: a hostile header must not make libpng take memory */
    png_set_user_limits(png, SIDE_MAX, SIDE_MAX);
    png_set_chunk_malloc_max(png, CHUNK_BYTES_MAX);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    if (job->request->n)
        png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_AS_DEFAULT, (png_const_bytep) "tEXt",
                                    1);
    png_read_info(png, job->info);
    /* before any conversion, since it judges the size of the rows as they are stored */
    take_image(job);
    ask_for_rgb(png, job->request->on_white);
    const int passes = png_set_interlace_handling(png);
    png_read_update_info(png, job->info);
    /* rows of another size would be written past the image */
    const size_t row_bytes = 3 * (size_t)job->image.width;
    if (png_get_rowbytes(png, job->info) != row_bytes)
        png_error(png, "its pixel format cannot be converted to RGB");
    for (int pass = 0; pass < passes; pass++)
        for (size_t y = 0; y < job->image.height; y++)
            png_read_row(png, job->image.rgb + y * row_bytes, NULL);
    png_read_end(png, job->info);
    copy_texts(job);
    return true;
}

static enum cs_status decode(const struct cs_png_request *request, const char *name,
                             const void *bytes, size_t length, struct cs_image *image,
                             struct cs_error *error) {
    struct job job = {.request = request, .bytes = bytes, .length = length};
    errno = 0; // what libpng says of memory is in words alone
    if (length < 8 || png_sig_cmp(bytes, 0, 8))
        return cs_fail(error, CS_ERR_FILE, "cannot read \"%s\": it is not a PNG file", name);
    job.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
    job.info = job.png ? png_create_info_struct(job.png) : NULL;
    if (!job.info)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", name);
    else if (!decode_rows(&job))
        cs_fail(error, cs_file_status(errno), "cannot read \"%s\" as PNG: %s", name,
                job.message);
    png_destroy_read_struct(&job.png, &job.info, NULL);
    /* *image is filled only if every row was decoded */
    if (!error->status) {
        *image = job.image;
        return CS_OK;
    }
    free(job.image.rgb);
    for (uint32_t k = 0; k < request->n; k++) {
        free(request->values[k]);
        request->values[k] = NULL;
    }
    return error->status;
}

/* --- writing --- */

/* Never fails: whoever opened the file looks at ferror when it is finished. */
static void on_write(png_structp png, png_bytep bytes, size_t length) {
    fwrite(bytes, 1, length, png_get_io_ptr(png));
}

static void on_flush(png_structp png) {
    (void)png;
}

/* Sets filter, level and strategy, which were chosen by measurement (docs/notes). Of all rows
 * and their mixtures Sub gives small files in the least time. Up to level 2 only runs of equal
 * bytes are looked for: 4 % to 12 % smaller and no slower than zlib's search at level 1. */
static void set_compression(png_structp png, int level) {
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_compression_level(png, level);
    png_set_compression_strategy(png, level <= 2 ? Z_RLE : Z_DEFAULT_STRATEGY);
    png_set_compression_mem_level(png, level <= 2 ? 7 : 8); // runs need no table of matches
    png_set_compression_buffer_size(png, 1 << 18);          // bytes of an IDAT chunk
}

static void add_texts(const struct job *job, const struct cs_png_text *texts,
                      uint32_t n_texts) {
    for (uint32_t i = 0; i < n_texts; i++) {
        /* libpng copies both, and takes them unchanged although they are not const */
        png_text text = {.compression = PNG_TEXT_COMPRESSION_NONE,
                         .key = (png_charp)(uintptr_t)texts[i].key,
                         .text = (png_charp)(uintptr_t)texts[i].value,
                         .text_length = strlen(texts[i].value)};
        png_set_text(job->png, job->info, &text, 1);
    }
}

/* Interleaves row y of an image with alpha as the file has it: out (width, 4). */
static void join_row(const struct cs_image *image, size_t y, uint8_t *out) {
    for (size_t i = y * image->width; i < (y + 1) * image->width; i++, out += 4) {
        memcpy(out, image->rgb + 3 * i, 3);
        out[3] = image->alpha[i];
    }
}

/* The part of writing that libpng may leave by longjmp. Returns false if it did. */
static bool encode_rows(struct job *job, FILE *file, const struct cs_image *image, int level,
                        const struct cs_png_text *texts, uint32_t n_texts) {
    const png_structp png = job->png;
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_set_write_fn(png, file, on_write, on_flush);
    png_set_user_limits(png, SIDE_MAX, SIDE_MAX);
    png_set_IHDR(png, job->info, image->width, image->height, 8,
                 image->alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    set_compression(png, level);
    add_texts(job, texts, n_texts);
    png_write_info(png, job->info);
    for (size_t y = 0; y < image->height; y++) {
        if (image->alpha)
            join_row(image, y, job->row);
        png_write_row(png, image->alpha ? job->row : image->rgb + 3 * y * image->width);
    }
    png_write_end(png, NULL);
    return true;
}

static enum cs_status encode(const struct cs_file_out *out, const struct cs_image *image,
                             int level, const struct cs_png_text *texts, uint32_t n_texts,
                             struct cs_error *error) {
    struct job job = {.row = image->alpha ? malloc(4 * (size_t)image->width) : NULL};
    errno = 0;
    job.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
    job.info = job.png ? png_create_info_struct(job.png) : NULL;
    if (!job.info || (image->alpha && !job.row))
        cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", out->path);
    else if (!encode_rows(&job, out->file, image, level, texts, n_texts))
        cs_fail(error, cs_file_status(errno), "cannot write \"%s\": %s", out->path,
                job.message);
    png_destroy_write_struct(&job.png, &job.info);
    free(job.row);
    return error->status;
}

static const char *version(void) {
    return png_get_libpng_ver(NULL);
}

extern const struct cs_png_module clothsim_png;
__attribute__((visibility("default"))) const struct cs_png_module clothsim_png = {
    .abi = CS_PNG_ABI, .version = version, .encode = encode, .decode = decode};
