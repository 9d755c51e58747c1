/* Writes one picture with work memory of its own. */
#include "io/png.h"

enum cs_status cs_png_write(const char *path, const struct cs_image *image, int level,
                            const struct cs_png_text *texts, uint32_t n_texts,
                            struct cs_error *error) {
    struct cs_png_work work = {.level = level};
    const enum cs_status status = cs_png_write_next(&work, path, image, texts, n_texts, error);
    cs_png_work_finish(&work);
    return status;
}
