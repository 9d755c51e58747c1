/* light_frustum.c - fits a cone (lamp) or a box (sun) of light to everything that casts a
 * shadow.
 */
#include "draw/light_frustum.h"

#include "draw/matrix.h"

/* A sphere around `solid` whose radius is a power of 1.25 and whose centre lies on a grid.
 * Edges of the shadow keep still from frame to frame, and no frame depends on those before it.
 *
 * Containment: R >= 1.1 r, so r <= 0.909 R. Rounding to a grid of 0.1 R moves the centre by at
 * most 0.05 sqrt(3) R = 0.087 R. The sum 0.996 R is within R. */
static struct cs_bounding_sphere coarse(const struct cs_bounding_sphere *solid) {
    struct cs_bounding_sphere ball = {.radius = 1};
    while (ball.radius > 1.1 * solid->radius)
        ball.radius /= 1.25;
    while (ball.radius < 1.1 * solid->radius)
        ball.radius *= 1.25;
    // moves the centre by at most 0.087 of the radius: inside the margin of 1.1
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

    // tangent cone of the sphere: sin a = r / d, so tan a = r / sqrt(d^2 - r^2)
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
