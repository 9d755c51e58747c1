/* Range, distance and velocity of a point against a collider. */
#include "model/contact/near.h"

#include "base/vec3.h"

void cs_near_at(const struct cs_system *system, uint32_t collider, double t,
                struct cs_near *near) {
    const struct cs_scene *scene = system->scene;
    *near = (struct cs_near){.pairing = system->pairings[collider],
                             .mu = cs_scene_colliders(scene)[collider].friction,
                             .ev = scene->contact.friction_speed,
                             .tau = scene->contact.damping};
    cs_obstacle_at(system, collider, t, &near->pose);
}

bool cs_near_touches(const struct cs_near *near, const double p[3], const double v[3],
                     struct cs_touch *touch) {
    double surface[3];
    if (!cs_obstacle_is_near(&near->pose, near->pairing.range, p))
        return false;
    touch->d = cs_obstacle_smooth(&near->pose, p, touch->g, touch->h);
    if (!(touch->d < near->pairing.range))
        return false;
    cs_obstacle_velocity(&near->pose, p, surface);
    for (int c = 0; c < 3; c++)
        touch->v[c] = v[c] - surface[c];
    touch->range = near->pairing.range;
    touch->k = near->pairing.k;
    touch->mu = near->mu;
    touch->ev = near->ev;
    touch->tau = near->tau;
    return true;
}

struct cs_touch_move cs_near_move(const struct cs_near *near, const double dp[3],
                                  const double dv[3]) {
    struct cs_touch_move move;
    double turned[3];
    cs_vec3_cross(near->pose.spin, dp, turned);
    for (int c = 0; c < 3; c++) {
        move.dp[c] = dp[c];
        move.dv[c] = dv[c] - turned[c];
    }
    move.more = 0;
    return move;
}
