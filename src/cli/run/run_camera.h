/* run_camera.h - finds a camera, or a camera path, that frames a whole run. */
#ifndef CS_RUN_CAMERA_H
#define CS_RUN_CAMERA_H

#include "cli/run/run_settings.h"

struct cs_run_camera {
    const struct cs_job_settings *settings;
    struct cs_error error; /* of the run before */
};

/* Callback for edit_scene of a session. If camera.frame is auto, runs the scene once without
 * pictures and gives it the camera that shows its bodies in all frames to be drawn: a fixed one
 * if they are large enough in each frame, else a path. Errors are in camera->error. */
void cs_run_camera_find(struct cs_scene *scene, void *camera);

#endif
