/* Follows the path of a camera. */
#include "draw/camera.h"

#include <string.h>

struct cs_camera cs_camera_at(const struct cs_camera *camera, double t) {
    const struct cs_camera_key *keys = camera->path.items;
    const uint32_t n = camera->path.n;
    struct cs_camera now = *camera;
    uint32_t next = 0;
    while (next < n && keys[next].at <= t)
        next++;
    if (n == 0)
        return now;
    const struct cs_camera_key *a = keys + (next ? next - 1 : 0),
                               *b = keys + (next < n ? next : n - 1);
    const double width = b->at - a->at;
    double share = width > 0 ? (t - a->at) / width : 0;
    if (camera->motion == CS_MOTION_SMOOTH)
        share = share * share * (3 - 2 * share);
    for (int i = 0; i < 3; i++) {
        now.eye[i] = a->eye[i] + share * (b->eye[i] - a->eye[i]);
        now.target[i] = a->target[i] + share * (b->target[i] - a->target[i]);
    }
    return now;
}
