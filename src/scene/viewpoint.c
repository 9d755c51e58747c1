/* Finds views without a direction, or without a way up. */
#include "scene/viewpoint.h"

#include <math.h>
#include <stddef.h>

static double length_of(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

const char *cs_viewpoint_fault(const double eye[3], const double target[3], const double up[3],
                               const char **key) {
    const double view[3] = {target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]};
    const double side[3] = {view[1] * up[2] - view[2] * up[1],
                            view[2] * up[0] - view[0] * up[2],
                            view[0] * up[1] - view[1] * up[0]};
    *key = "target";
    if (length_of(view) < 1e-9)
        return "is the same point as the eye";
    // parallel to the view up to rounding: no picture plane can be built
    *key = "up";
    if (length_of(side) < 1e-9 * length_of(view))
        return "is along the view or zero, expected another direction";
    return NULL;
}
