/* collider_query.h - a collider as a point in its range feels it. */
#ifndef CS_CONTACT_COLLIDER_QUERY_H
#define CS_CONTACT_COLLIDER_QUERY_H

#include "model/contact/collider_params.h"
#include "model/contact/point_contact.h"
#include "model/contact/posed_collider.h"

/* An obstacle as it is at one time, and how it rubs. */
struct cs_posed_collider_law {
    struct cs_posed_collider collider;
    struct cs_collider_params params;
    double friction, friction_speed, damping; /* as in touch.h */
};

/* With contact by force. */
void cs_posed_collider_law_at(const struct cs_system *system, uint32_t collider, double t,
                              struct cs_posed_collider_law *near);

/* How a point at p with velocity v (m, m/s) touches; false: it is out of range. */
bool cs_posed_collider_law_in_range(const struct cs_posed_collider_law *near, const double p[3],
                                    const double v[3], struct cs_point_contact *contact);

/* A move of a point and of its velocity as one against the obstacle, whose surface below the
 * point has another velocity after it where the obstacle turns. */
struct cs_point_contact_motion
cs_posed_collider_law_motion(const struct cs_posed_collider_law *near, const double dp[3],
                             const double dv[3]);

/* The parts of a force (enum cs_part) as factors. */
static inline struct cs_contact_force_parts cs_force_parts_of(uint32_t parts) {
    return (struct cs_contact_force_parts){.elastic = parts & CS_PART_POTENTIAL ? 1 : 0,
                                           .friction = parts & CS_PART_DISSIPATIVE ? 1 : 0};
}

#endif
