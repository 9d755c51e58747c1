/* Files of pictures: opens and finishes them, and loads the module that knows PNG. */
#include "base/png.h"
#include "base/install_paths.h"

#include <stdlib.h>

/* length of a file */
enum { FILE_BYTES_MAX = 512 * 1024 * 1024 };

/* limit of a texture: 8192 x 8192 in all, which with its smaller copies takes 740 MB */
enum { TEXTURE_PIXELS_MAX = 1 << 26 };

/* NULL: not loaded. Threads that load it at once find the same table. */
static const struct cs_png_module *_Atomic module;

enum cs_status cs_png_load(struct cs_error *error) {
    if (!module)
        module = cs_table_open(cs_renderer_folder(), "png-libpng", "clothsim_png", CS_PNG_ABI,
                               NULL, error);
    return error->status;
}

const char *cs_png_version(void) {
    const struct cs_png_module *loaded = module;
    return loaded ? loaded->version() : NULL;
}

enum cs_status cs_png_write_next(const char *path, const struct cs_image *image, int level,
                                 const struct cs_png_text *texts, uint32_t n_texts,
                                 struct cs_error *error) {
    CS_ASSERT(image->width && image->height && image->rgb);
    const struct cs_png_module *png;
    struct cs_file_out out;
    if (cs_png_load(error) || cs_file_create(&out, path, error))
        return error->status;
    png = module;
    if (!png->encode(&out, image, level, texts, n_texts, error))
        return cs_file_finish(&out, error);
    cs_file_abandon(&out);
    return error->status;
}

enum cs_status cs_png_write(const char *path, const struct cs_image *image, int level,
                            const struct cs_png_text *texts, uint32_t n_texts,
                            struct cs_error *error) {
    cs_file_sweep(path, NULL);
    return cs_png_write_next(path, image, level, texts, n_texts, error);
}

static enum cs_status read_bytes(const struct cs_png_request *request, const char *name,
                                 const void *bytes, size_t length, struct cs_image *image,
                                 struct cs_error *error) {
    const struct cs_png_module *png;
    *image = (struct cs_image){0};
    if (cs_png_load(error))
        return error->status;
    png = module;
    return png->decode(request, name, bytes, length, image, error);
}

enum cs_status cs_png_read_bytes(const char *name, const void *bytes, size_t length,
                                 struct cs_image *image, struct cs_error *error) {
    return read_bytes(&(struct cs_png_request){0}, name, bytes, length, image, error);
}

static enum cs_status read_file(const struct cs_png_request *request, const char *path,
                                struct cs_image *image, struct cs_error *error) {
    char *bytes;
    size_t length;
    *image = (struct cs_image){0};
    if (cs_file_read(path, FILE_BYTES_MAX, &bytes, &length, error))
        return error->status;
    read_bytes(request, path, bytes, length, image, error);
    free(bytes);
    return error->status;
}

enum cs_status cs_png_read_texts(const char *path, const char *const *keys, uint32_t n,
                                 char **values, struct cs_image *image,
                                 struct cs_error *error) {
    for (uint32_t k = 0; k < n; k++)
        values[k] = NULL;
    return read_file(
        &(struct cs_png_request){
            .keys = keys, .values = values, .n = n, .pixels_max = TEXTURE_PIXELS_MAX},
        path, image, error);
}

enum cs_status cs_png_read(const char *path, struct cs_image *image, struct cs_error *error) {
    return read_file(&(struct cs_png_request){.pixels_max = TEXTURE_PIXELS_MAX}, path, image,
                     error);
}

enum cs_status cs_png_read_on_white(const char *path, struct cs_image *image,
                                    struct cs_error *error) {
    return read_file(&(struct cs_png_request){.on_white = true}, path, image, error);
}
