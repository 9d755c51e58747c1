/* Range test, distance and relative velocity of a point against a collider. */
#include "model/contact/collider_query.h"

#include "base/vec3.h"

void cs_posed_collider_law_at(const struct cs_system *system, uint32_t collider, double t,
                              struct cs_posed_collider_law *near) {
    const struct cs_scene *scene = system->scene;
    *near =
        (struct cs_posed_collider_law){.params = system->collider_params[collider],
                                       .friction = cs_scene_colliders(scene)[collider].friction,
                                       .friction_speed = scene->contact.friction_speed,
                                       .damping = scene->contact.damping};
    cs_posed_collider_at(system, collider, t, &near->collider);
}

/* A bounding test precedes the smooth distance, which costs far more. */
bool cs_posed_collider_law_in_range(const struct cs_posed_collider_law *near, const double p[3],
                                    const double v[3], struct cs_point_contact *touch) {
    double surface[3];
    if (!cs_posed_collider_is_near(&near->collider, near->params.range, p))
        return false;
    touch->d = cs_posed_collider_smooth_distance(&near->collider, p, touch->g, touch->h);
    if (!(touch->d < near->params.range))
        return false;
    cs_posed_collider_velocity(&near->collider, p, surface);
    for (int c = 0; c < 3; c++)
        touch->v[c] = v[c] - surface[c];
    touch->range = near->params.range;
    touch->k = near->params.k;
    touch->friction = near->friction;
    touch->friction_speed = near->friction_speed;
    touch->damping = near->damping;
    return true;
}

struct cs_point_contact_motion
cs_posed_collider_law_motion(const struct cs_posed_collider_law *near, const double dp[3],
                             const double dv[3]) {
    struct cs_point_contact_motion move;
    double turned[3];
    cs_vec3_cross(near->collider.spin, dp, turned);
    for (int c = 0; c < 3; c++) {
        move.dp[c] = dp[c];
        move.dv[c] = dv[c] - turned[c];
    }
    move.extra_dd = 0;
    return move;
}
