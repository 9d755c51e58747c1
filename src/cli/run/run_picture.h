/* run_picture.h - a picture of a run on its way into a file, with what says where it came from.
 */
#ifndef CS_RUN_PICTURE_H
#define CS_RUN_PICTURE_H

#include "base/hash.h"
#include "io/frame_writer.h"
#include "scene/scene.h"

/* What all pictures of a run have in common; borrowed texts. */
struct cs_picture_origin {
    const struct cs_scene *scene;
    const char *scene_hash, *method, *renderer;
    const char *provenance; /* see study/provenance_write.h */
};

/* The frame whose picture is being drawn while the run goes on. */
struct cs_job_picture {
    uint32_t number; /* of the picture, from 1; 0: none */
    uint32_t frame;
    double time; /* s */
    char hash[CS_HASH_DIGITS];
    double range[2];
    const struct cs_image *image; /* of the writer */
};

/* Hands the image taken last over, as frame_NUMBER.png. CS_ERR_MEMORY, and as
 * cs_frame_writer_submit.
 */
enum cs_status cs_job_picture_submit(const struct cs_job_picture *picture,
                                     const struct cs_picture_origin *origin,
                                     struct cs_frame_writer *frames, struct cs_error *error);

#endif
