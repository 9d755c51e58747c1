/* Aims a cone or a box of light at everything that casts a shadow. */
#include "draw/light_frustum.h"

#include "draw/matrix.h"

/* A ball around `solid` whose size and place change by steps: edges of the shadow keep still
 * from frame to frame, and yet a frame does not depend on those before it. */
static struct cs_bounding_sphere coarse(const struct cs_bounding_sphere *solid) {
    struct cs_bounding_sphere ball = {.radius = 1};
    while (ball.radius > 1.1 * solid->radius)
        ball.radius /= 1.25;
    while (ball.radius < 1.1 * solid->radius)
        ball.radius *= 1.25;
    // at most 0.087 of the radius away from the middle: inside the margin of 1.1
    const double step = 0.1 * ball.radius;
    for (int i = 0; i < 3; i++)
        ball.centre[i] = step * floor(solid->centre[i] / step + 0.5);
    return ball;
}

bool cs_light_frustum_fit(const struct cs_bounding_sphere *solid, struct cs_view_block *block) {
    static const double up[3] = {0, 1, 0};
    double eye[3], from[3], look[16], lens[16], both[16];
    const struct cs_bounding_sphere ball = coarse(solid), *lit = &ball;
    const bool is_lamp = block->light[3] > 0;
    for (int i = 0; i < 3; i++) {
        const double light = (double)block->light[i];
        eye[i] = is_lamp ? light : lit->centre[i] + 2 * lit->radius * light;
    }
    cs_subtract(eye, lit->centre, from);
    const double distance = cs_length(from), r = lit->radius;
    block->shadow_params[2] = distance > 1.05 * r;
    if (block->shadow_params[2] == 0)
        return false;

    // the cone from a lamp that touches the ball
    const double slope = r / sqrt(distance * distance - r * r);
    cs_matrix_look(eye, lit->centre, up, look);
    if (is_lamp)
        cs_matrix_perspective(slope, 1, distance - r, distance + r, lens);
    else
        cs_matrix_parallel(r, 1, distance - r, distance + r, lens);
    cs_matrix_multiply(lens, look, both);
    cs_matrix_to_float(both, block->world_to_light);
    block->shadow_params[0] = 1.0f / CS_SHADOW_SIDE;
    block->shadow_params[1] = (float)(2 * (is_lamp ? slope * distance : r) / CS_SHADOW_SIDE);
    return true;
}
