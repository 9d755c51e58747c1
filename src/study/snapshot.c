/* Draws a run as it stands, once. */
#include "study/snapshot.h"

#include "study/frame_picture.h"

#include <stdlib.h>

enum cs_status cs_snapshot_draw(struct cs_session *session, enum cs_renderer_kind kind,
                                struct cs_image *image, struct cs_text *renderer,
                                struct cs_error *error) {
    struct cs_picture picture;
    image->width = (uint32_t)session->scene.render.size[0];
    image->height = (uint32_t)session->scene.render.size[1];
    image->rgb = malloc(cs_image_bytes(image));
    if (!image->rgb)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a picture");
    if (cs_picture_open(&picture, &session->system, kind, false, false, error))
        return error->status;
    cs_picture_begin(&picture, &session->run, image);
    cs_picture_end(&picture, error);
    cs_text_add(renderer, "%s", cs_picture_renderer(&picture));
    cs_picture_close(&picture);
    return error->status;
}
