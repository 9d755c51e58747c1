/* collider_query.h - a posed collider with its contact parameters, ready to be evaluated at
 * points. */
#ifndef CS_CONTACT_COLLIDER_QUERY_H
#define CS_CONTACT_COLLIDER_QUERY_H

#include "model/contact/collider_params.h"
#include "model/contact/point_contact.h"
#include "model/contact/posed_collider.h"

/* A collider at one time with its parameters. */
struct cs_posed_collider_law {
    struct cs_posed_collider collider;
    struct cs_collider_params params;
    double friction, friction_speed, damping; /* mu (1), ev (m/s), tau (s) */
};

/* Sets *near to a collider at t. The scene must have contact by force. */
void cs_posed_collider_law_at(const struct cs_system *system, uint32_t collider, double t,
                              struct cs_posed_collider_law *near);

/* Sets *contact for a point at p (m) with velocity v (m/s); returns false if it is out of
 * range, and *contact is then unspecified. */
bool cs_posed_collider_law_in_range(const struct cs_posed_collider_law *near, const double p[3],
                                    const double v[3], struct cs_point_contact *contact);

/* Converts a motion of a point into one relative to the collider. If the collider rotates, the
 * velocity of its matter differs at the moved point, by spin x dp. */
struct cs_point_contact_motion
cs_posed_collider_law_motion(const struct cs_posed_collider_law *near, const double dp[3],
                             const double dv[3]);

/* Parts of a force (enum cs_part) as factors 0 and 1. */
static inline struct cs_contact_force_parts cs_force_parts_of(uint32_t parts) {
    return (struct cs_contact_force_parts){.elastic = parts & CS_PART_POTENTIAL ? 1 : 0,
                                           .friction = parts & CS_PART_DISSIPATIVE ? 1 : 0};
}

#endif
