/* png.h - RGB and RGBA PNG files: read through libpng, written through libdeflate if the build
 * has it. */
#ifndef CS_PNG_H
#define CS_PNG_H

#include "base/file.h"
#include "base/image.h"
#include "base/status.h"

#include <stddef.h>

/* One text chunk: the provenance of a picture. */
struct cs_png_text {
    const char *key, *value; /* Latin-1, key at most 79 characters */
};

/* Buffers that consecutive pictures share: allocating them per picture costs up to a third of
 * the time of compression. */
struct cs_png_encoder {
    int level;     /* of compression, 0..9 (2: fast, 6: archive); the rest starts zeroed */
    size_t length; /* of rows, in bytes */
    uint8_t *rows, *packed; /* filtered rows; compressed rows; owned */
    void *packer;           /* compressor of libdeflate; owned */
};

/* As cs_png_write, at the level of the encoder, whose buffers grow if needed. */
enum cs_status cs_png_write_next(struct cs_png_encoder *work, const char *path,
                                 const struct cs_image *image, const struct cs_png_text *texts,
                                 uint32_t n_texts, struct cs_error *error);

/* Frees the buffers; the encoder may be used again. */
void cs_png_encoder_finish(struct cs_png_encoder *work);

/* Bytes per pixel in the file: 3, or 4 with alpha. */
static inline size_t cs_png_channels(const struct cs_image *image) {
    return image->alpha ? 4 : 3;
}

/* Interleaves row y of an image with alpha as the file has it: out (width, 4). */
static inline void cs_png_join(const struct cs_image *image, size_t y, uint8_t *out) {
    for (size_t i = y * image->width; i < (y + 1) * image->width; i++, out += 4) {
        for (size_t k = 0; k < 3; k++)
            out[k] = image->rgb[3 * i + k];
        out[3] = image->alpha[i];
    }
}

/* Writes a temporary file, after sweeping the path, and renames it: RGB, or RGBA if the image
 * has alpha, compressed at `level` of 0..9 (2: fast, 6: archive), filter Sub, no time stamp.
 * Equal pictures thus give equal files with one build of the compressor. On failure CS_ERR_FILE
 * and no file is left. */
static inline enum cs_status cs_png_write(const char *path, const struct cs_image *image,
                                          int level, const struct cs_png_text *texts,
                                          uint32_t n_texts, struct cs_error *error) {
    struct cs_png_encoder work = {.level = level};
    cs_file_sweep(path, NULL);
    const enum cs_status status = cs_png_write_next(&work, path, image, texts, n_texts, error);
    cs_png_encoder_finish(&work);
    return status;
}

/* Reads any PNG of at most 2^26 pixels, with sides of at most 16384, as 8-bit RGB (alpha
 * dropped, grey and palette widened). The caller frees image->rgb. On failure CS_ERR_FILE and
 * *image is empty. */
enum cs_status cs_png_read(const char *path, struct cs_image *image, struct cs_error *error);

/* The same for any number of pixels, with the values of text chunks: values (n), malloc'd; NULL
 * if the file has no such key. On failure all of them are NULL. */
enum cs_status cs_png_read_texts(const char *path, const char *const *keys, uint32_t n,
                                 char **values, struct cs_image *image, struct cs_error *error);

/* cs_png_read, blended over white in linear light if the file has alpha. */
enum cs_status cs_png_read_on_white(const char *path, struct cs_image *image,
                                    struct cs_error *error);

/* cs_png_read from memory; name is for messages. */
enum cs_status cs_png_read_bytes(const char *name, const void *bytes, size_t length,
                                 struct cs_image *image, struct cs_error *error);

#endif
