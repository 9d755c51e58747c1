/* png.h - RGB and RGBA PNG files. libpng and zlib are loaded with the first picture, with the
 * module png-libpng.so: whatever uses no picture runs without them. */
#ifndef CS_PNG_H
#define CS_PNG_H

#include "base/file.h"
#include "base/image.h"
#include "base/status.h"

/* One text chunk: the provenance of a picture. */
struct cs_png_text {
    const char *key, *value; /* Latin-1, key at most 79 characters */
};

/* How a picture is read; zeroed: any number of pixels, alpha dropped, no texts. */
struct cs_png_request {
    bool on_white;           /* blend alpha over white, in linear light */
    size_t pixels_max;       /* 0: any number */
    const char *const *keys; /* (n) of the text chunks that are wanted */
    char **values;           /* (n) of the caller, NULL each */
    uint32_t n;
};

#define CS_PNG_ABI 1u /* raised with every change of the structs above or below */
/* The module's table, exported as clothsim_png. All errors of libpng end in these calls. */
struct cs_png_module {
    unsigned abi;
    const char *(*version)(void); /* of libpng; static */
    /* Writes a picture to an open file. Failures to write are left to ferror; all others are
     * CS_ERR_FILE or CS_ERR_MEMORY. */
    enum cs_status (*encode)(const struct cs_file_out *out, const struct cs_image *image,
                             int level, const struct cs_png_text *texts, uint32_t n_texts,
                             struct cs_error *error);
    /* Reads a picture from bytes, as cs_png_read. On failure *image is empty, all values are
     * NULL. */
    enum cs_status (*decode)(const struct cs_png_request *request, const char *name,
                             const void *bytes, size_t length, struct cs_image *image,
                             struct cs_error *error);
};

/* Loads the module unless it is there. Called by all below; called first where a missing module
 * must be known before a long run. CS_ERR_MODULE. */
enum cs_status cs_png_load(struct cs_error *error);

/* Version of libpng; NULL: not loaded. Static. */
const char *cs_png_version(void);

/* Writes a temporary file and renames it: RGB, or RGBA if the image has alpha, compressed at
 * `level` of 0..9 (2: fast, 6: archive), filter Sub, no time stamp. Equal pictures thus give
 * equal files with one build of zlib. On failure CS_ERR_FILE, CS_ERR_MEMORY or CS_ERR_MODULE,
 * and no file is left. */
enum cs_status cs_png_write_next(const char *path, const struct cs_image *image, int level,
                                 const struct cs_png_text *texts, uint32_t n_texts,
                                 struct cs_error *error);

/* The same after sweeping the path. */
enum cs_status cs_png_write(const char *path, const struct cs_image *image, int level,
                            const struct cs_png_text *texts, uint32_t n_texts,
                            struct cs_error *error);

/* Reads any PNG of at most 2^26 pixels, with sides of at most 16384, as 8-bit RGB (alpha
 * dropped, grey and palette widened). The caller frees image->rgb. On failure CS_ERR_FILE,
 * CS_ERR_MEMORY or CS_ERR_MODULE, and *image is empty. */
enum cs_status cs_png_read(const char *path, struct cs_image *image, struct cs_error *error);

/* The same, with the values of text chunks: values (n), malloc'd; NULL if the file has no such
 * key. On failure all of them are NULL. */
enum cs_status cs_png_read_texts(const char *path, const char *const *keys, uint32_t n,
                                 char **values, struct cs_image *image, struct cs_error *error);

/* cs_png_read of any number of pixels, blended over white in linear light if the file has
 * alpha. */
enum cs_status cs_png_read_on_white(const char *path, struct cs_image *image,
                                    struct cs_error *error);

/* cs_png_read of any number of pixels from memory; name is for messages. */
enum cs_status cs_png_read_bytes(const char *name, const void *bytes, size_t length,
                                 struct cs_image *image, struct cs_error *error);

#endif
