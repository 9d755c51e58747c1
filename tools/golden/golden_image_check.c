/* Checks rows of pictures: by the hash of their pixels, or by the gate between renderers. */
#include "golden/golden_row.h"

#include "base/file.h"
#include "base/png.h"
#include "session/frame_picture.h"
#include "shared/image_diff.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void cs_golden_image_path(const char *folder, const struct cs_golden_row *row,
                          const char *ending, char path[1024]) {
    snprintf(path, 1024, "%.500s/image/%.400s%s", folder, row->image, ending);
}

static enum cs_status write_image(const struct cs_golden *golden,
                                  const struct cs_golden_row *row, const char *ending,
                                  const struct cs_image *image, struct cs_error *error) {
    char path[1024];
    cs_golden_image_path(golden->folder, row, ending, path);
    return cs_png_write(path, image, 6, NULL, 0, error);
}

/* Writes the picture and 16 times the difference beside the golden image. */
static enum cs_status write_evidence(const struct cs_golden *golden,
                                     const struct cs_golden_row *row,
                                     const struct cs_image *found,
                                     const struct cs_image *expected, struct cs_error *error) {
    struct cs_image amplified = {found->width, found->height, malloc(cs_image_bytes(found)),
                                 NULL};
    if (!amplified.rgb)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory");
    cs_image_amplify(found, expected, &amplified);
    if (!write_image(golden, row, ".actual.png", found, error))
        write_image(golden, row, ".difference.png", &amplified, error);
    free(amplified.rgb);
    return error->status;
}

/* Removes the evidence of an earlier check. */
static void remove_evidence(const struct cs_golden *golden, const struct cs_golden_row *row) {
    char path[1024];
    struct cs_error unseen = {0};
    cs_golden_image_path(golden->folder, row, ".actual.png", path);
    cs_file_remove(path, &unseen);
    cs_golden_image_path(golden->folder, row, ".difference.png", path);
    cs_file_remove(path, &unseen);
}

/* Fills row->message if the picture does not pass. */
static enum cs_status judge(const struct cs_golden *golden, struct cs_golden_row *row,
                            const struct cs_image *found, const char *renderer,
                            struct cs_error *error) {
    const bool same_renderer = !strcmp(renderer, row->note);
    /* equal hashes of pixels decide: the golden picture need not be read */
    if (same_renderer && !strcmp(row->finding.found, row->hash))
        return CS_OK;
    char path[1024];
    struct cs_image expected;
    cs_golden_image_path(golden->folder, row, ".png", path);
    if (cs_png_read(path, &expected, error))
        return error->status;
    if (expected.width != found->width || expected.height != found->height) {
        cs_text_add(&row->message, "%u x %u pixels, expected %u x %u", found->width,
                    found->height, expected.width, expected.height);
    } else {
        const struct cs_image_difference d = cs_image_compare(found, &expected);
        if (same_renderer || !cs_image_difference_passes(&d)) {
            cs_text_add(
                &row->message,
                "%llu pixels differ, RMSE %.3f, %.3f %% off by more than 2, largest %d%s",
                (unsigned long long)d.pixels, d.rmse, 100 * d.share, d.largest,
                same_renderer ? " (same renderer: every pixel counts)" : "");
            write_evidence(golden, row, found, &expected, error);
        }
    }
    free(expected.rgb);
    return error->status;
}

/* Accepts the picture. Only the CPU renderer may, because its pixels are equal on all machines.
 */
static enum cs_status accept_image(const struct cs_golden *golden, struct cs_golden_row *row,
                                   const struct cs_image *found, struct cs_text *renderer,
                                   struct cs_error *error) {
    if (strncmp(cs_text_get(renderer), "cpu", 3))
        return cs_fail(error, CS_ERR_CHECK,
                       "%s: only --renderer cpu may accept images, found %s", row->image,
                       cs_text_get(renderer));
    if (!strcmp(row->finding.found, row->hash) && !strcmp(row->note, cs_text_get(renderer)))
        return CS_OK;
    cs_text_add(&row->message, "accepted");
    snprintf(row->finding.renderer, sizeof row->finding.renderer, "%s", cs_text_get(renderer));
    row->note = row->finding.renderer;
    return write_image(golden, row, ".png", found, error);
}

static enum cs_status check_with(const struct cs_golden *golden, enum cs_renderer_kind kind,
                                 struct cs_session *session, struct cs_golden_row *row,
                                 struct cs_error *error) {
    struct cs_image found = {0};
    struct cs_text renderer = {0};
    if (!cs_snapshot_draw(&session->run, NULL, kind, &found, &renderer, error)) {
        cs_hash_bytes(found.rgb, cs_image_bytes(&found), row->finding.found);
        if (golden->accept_all)
            accept_image(golden, row, &found, &renderer, error);
        else
            judge(golden, row, &found, cs_text_get(&renderer), error);
    }
    free(found.rgb);
    cs_text_finish(&renderer);
    return error->status;
}

enum cs_status cs_golden_check_image(struct cs_golden *golden, struct cs_golden_row *row,
                                     struct cs_error *error) {
    struct cs_session session;
    if (cs_golden_step(golden, &row->run, true, NULL, &session, error))
        return error->status;
    remove_evidence(golden, row);
    for (int kind = 0; cs_renderer_names[kind] && !error->status; kind++)
        if (golden->renderers >> kind & 1)
            check_with(golden, (enum cs_renderer_kind)kind, &session, row, error);
    cs_session_close(&session);
    return error->status;
}
