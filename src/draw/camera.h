/* camera.h - where a scene's camera stands at a time. */
#ifndef CS_DRAW_CAMERA_H
#define CS_DRAW_CAMERA_H

#include "scene/scene.h"

/* The camera moves, or frames what a picture shows: it may be another one in each frame. */
static inline bool cs_camera_varies(const struct cs_camera *camera) {
    return camera->path.n > 0 || camera->frame == CS_FRAME_AUTO;
}

/* The camera at time t in s: that of its path, if there is one. */
struct cs_camera cs_camera_at(const struct cs_camera *camera, double t);

#endif
