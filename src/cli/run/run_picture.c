/* Tells in the text chunks of a picture what it shows and how it came about. */
#include "cli/run/run_picture.h"

#include "base/text.h"
#include "study/picture.h"

#include <stdio.h>

static void print_range(const struct cs_job_picture *picture, const struct cs_scene *scene,
                        struct cs_text *range) {
    if (!cs_picture_is_coloured(scene))
        return;
    cs_text_add_real(range, picture->range[0]);
    cs_text_add(range, "..");
    cs_text_add_real(range, picture->range[1]);
    cs_text_add(range, " %s", cs_look_kind(scene->render.look)->unit);
}

enum cs_status cs_job_picture_give(const struct cs_job_picture *picture,
                                   const struct cs_picture_origin *origin,
                                   struct cs_frames *frames, struct cs_error *error) {
    char frame[16], pixels[CS_HASH_DIGITS];
    struct cs_text time = {0}, range = {0};
    snprintf(frame, sizeof frame, "%u", picture->frame);
    cs_hash_bytes(picture->image->rgb, cs_image_bytes(picture->image), pixels);
    cs_text_add_real(&time, picture->time);
    print_range(picture, origin->scene, &range);
    const struct cs_png_text texts[] = {
        {"Software", "clothsim " CS_VERSION},
        {"Source", origin->scene_hash},
        {"clothsim:frame", frame},
        {"clothsim:time", cs_text_get(&time)},
        {"clothsim:integrator", origin->method},
        {"clothsim:state-hash", picture->hash},
        {"clothsim:renderer", origin->renderer},
        {"clothsim:pixel-hash", pixels},
        {"clothsim:run", origin->recipe},
        {"clothsim:range", cs_text_get(&range)},
    };
    /* the range comes last, so that it can be left out where nothing is coloured */
    const uint32_t n_texts = sizeof texts / sizeof *texts - !range.length;
    if (time.failed || range.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the texts of a picture");
    else
        cs_frames_give(frames, picture->number, texts, n_texts, error);
    cs_text_finish(&time);
    cs_text_finish(&range);
    return error->status;
}
