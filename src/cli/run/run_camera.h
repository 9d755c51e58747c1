/* run_camera.h - the way of a camera that frames a whole run. */
#ifndef CS_RUN_CAMERA_H
#define CS_RUN_CAMERA_H

#include "cli/run/run_settings.h"

struct cs_run_camera {
    const struct cs_job_settings *settings;
    struct cs_error error; /* of the run before */
};

/* For change and ctx of a session's settings: runs a scene whose camera.frame is auto once
 * without pictures and gives the scene the camera that shows its bodies in all frames that will
 * be drawn: one place, if they are large enough from there in each of them, else a path. */
void cs_run_camera_find(struct cs_scene *scene, void *camera);

#endif
