/* collider_params.h - contact range and stiffness between particles and each collider; built
 * once per scene. */
#ifndef CS_CONTACT_COLLIDER_PARAMS_H
#define CS_CONTACT_COLLIDER_PARAMS_H

#include "model/contact/point_contact.h"
#include "model/contact/posed_collider.h"
#include "model/system/particle_system.h"

struct cs_contact_keys;

/* Default range in units of the shortest spring: a spring at rest does not reach through a thin
 * collider from one range to the other. */
#define CS_RANGE_FRACTION 0.4

/* Least fraction to which a range that nobody set shrinks to fit the start; chosen by trial. */
#define CS_RANGE_SHRINK_MIN 0.02
/* m, depth up to which a particle counts as on the surface: scenes give positions in decimals.
 */
#define CS_PENETRATION_MIN 1e-9

/* Parameters of one collider. */
struct cs_collider_params {
    double k;     /* N/m a particle */
    double range; /* m in front of the surface */
};

/* Sets *k in N/m to the stiffness of the softest stretch spring, from which the default is
 * derived, and builds system->approach. CS_ERR_SCENE if there is no such spring and the scene
 * gives no contact.stiffness; CS_ERR_MEMORY. */
enum cs_status cs_collider_params_softest(struct cs_system *system, double *k,
                                          struct cs_error *error);

/* Sets system->collider_params, one per collider, after the springs were built. k:
 * cs_approach_stiffness; range: the collider's thickness, or CS_RANGE_FRACTION of the shortest
 * spring, or less where a particle starts closer. The system's arena owns it. Also sets
 * system->default_damping, sqrt(m/k) of the heaviest free particle m and the stiffest k.
 * CS_ERR_SCENE if a value is neither given nor to be derived; CS_ERR_MEMORY. */
enum cs_status cs_collider_params_table_build(struct cs_system *system, struct cs_error *error);

/* Sets what the built system decides: damping where the scene gives none, and loss and mass of
 * contact.restitution (point_contact.h): alpha, 0 without it to 2.6 of 0, and the mean mass in
 * kg of free particles. */
void cs_contact_keys_complete(struct cs_contact_keys *keys, const struct cs_system *system);

/* A posed collider with its contact parameters, ready to be evaluated at
 * points. */

/* A collider at one time with its parameters. */
struct cs_posed_collider_law {
    struct cs_posed_collider collider;
    struct cs_collider_params params;
    double friction, friction_speed, damping; /* mu (1), ev (m/s), tau (s) */
    double loss, rate;                        /* alpha (1), k/M (1/s2) */
    /* mu of contact.friction_law "stick"; friction is then 0, and the other way round */
    double sticking_friction;
};

/* Sets *near to a collider at t. The scene must have contact by force. */
void cs_posed_collider_law_at(const struct cs_system *system, uint32_t collider, double t,
                              struct cs_posed_collider_law *law);

/* Returns whether a collider is a plane or sphere without rotation, whose matter moves at one
 * velocity, and friction on it is smooth. */
bool cs_posed_collider_law_is_plain(const struct cs_posed_collider_law *law);

/* Sets the parameters of *contact, not its state. */
CS_INLINE void cs_posed_collider_law_set(const struct cs_posed_collider_law *law,
                                         struct cs_point_contact *contact) {
    contact->range = law->params.range;
    contact->k = law->params.k;
    contact->friction = law->friction;
    contact->friction_speed = law->friction_speed;
    contact->damping = law->damping;
    contact->loss = law->loss;
    contact->rate = law->rate;
}

/* Sets *contact for a point at p (m) with velocity v (m/s); returns false if it is out of
 * range, and *contact is then unspecified. */
bool cs_posed_collider_law_in_range(const struct cs_posed_collider_law *law, const double p[3],
                                    const double v[3], struct cs_point_contact *contact);

/* Converts a motion of a point into one relative to the collider. If the collider rotates, the
 * velocity of its matter differs at the moved point, by spin x dp. */
struct cs_point_contact_motion
cs_posed_collider_law_motion(const struct cs_posed_collider_law *law, const double dp[3],
                             const double dv[3]);

/* Parts of a force (enum cs_part) as factors 0 and 1. */
static inline struct cs_contact_force_parts cs_force_parts_of(uint32_t parts) {
    return (struct cs_contact_force_parts){.elastic = parts & CS_PART_POTENTIAL ? 1 : 0,
                                           .friction = parts & CS_PART_DISSIPATIVE ? 1 : 0};
}

#endif
