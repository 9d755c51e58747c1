/* picture_fixture.h - one picture of a scene, for tests of what is drawn. */
#ifndef PICTURE_FIXTURE_H
#define PICTURE_FIXTURE_H

#include "fixture.h"

#include "session/frame_picture.h"

/* Draws the last of that many frames of an open scene, and closes it. */
static inline void fixture_draw(struct fixture *cloth, uint32_t frames,
                                struct cs_image *image) {
    struct cs_picture picture;
    struct cs_error error = {0};
    fixture_start(cloth);
    cs_picture_open(&picture, cloth->system, CS_RENDERER_AUTO, false, false, &error);
    fixture_frames(cloth, frames);
    cs_picture_begin(&picture, &cloth->session.run, image);
    cs_picture_end(&picture, &error);
    ck_assert_msg(!error.status, "%s", error.message);
    cs_picture_close(&picture);
    fixture_close(cloth);
}

#endif
