/* Chooses position, spacing and colour of the grid on the ground. */
#include "draw/ground.h"

#include "draw/colour.h"

// the power of ten at or below length
static double power_of_ten(double length) {
    double power = 1;
    while (power > length)
        power /= 10;
    while (power * 10 <= length)
        power *= 10;
    return power;
}

static bool has_floor(const struct cs_scene *scene) {
    for (uint32_t i = 0; i < scene->colliders.n; i++)
        if (cs_scene_colliders(scene)[i].visible && cs_scene_colliders(scene)[i].floor.present)
            return true;
    return false;
}

void cs_ground_make(struct cs_ground *ground, const struct cs_scene *scene,
                    const struct cs_ball *extent) {
    ground->span[0] = (float)extent->centre[0];
    ground->span[1] = (float)scene->render.ground_height;
    ground->span[2] = (float)extent->centre[2];
    ground->span[3] = (float)(6 * extent->radius);
    ground->pitch = (float)power_of_ten(0.3 * extent->radius);
    cs_colour_ink(scene->render.background.colour, ground->ink);
    // a floor shows the shadow itself
    ground->shadow = has_floor(scene) ? 0.0f : 0.4f;
}
