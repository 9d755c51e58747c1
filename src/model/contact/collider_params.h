/* collider_params.h - contact range and stiffness between particles and each collider; built
 * once per scene. */
#ifndef CS_CONTACT_COLLIDER_PARAMS_H
#define CS_CONTACT_COLLIDER_PARAMS_H

#include "model/system/system.h"

/* Default range in units of the shortest spring: a spring at rest does not reach through a thin
 * collider from one range to the other. */
#define CS_RANGE_SHARE 0.4

/* Parameters of one collider. */
struct cs_collider_params {
    double k;     /* N/m a particle */
    double range; /* m in front of the surface */
};

/* Sets *k in N/m to contact.stiffness, or to that of the softest stretch spring. CS_ERR_SCENE
 * if neither exists. */
enum cs_status cs_collider_params_stiffness(const struct cs_system *system, double *k,
                                            struct cs_error *error);

/* Sets system->collider_params, one per collider, after the springs were built. k: see above;
 * range: the collider's thickness, or CS_RANGE_SHARE of the shortest spring. The system's arena
 * owns it. CS_ERR_SCENE if a value is neither given nor to be derived; CS_ERR_MEMORY. */
enum cs_status cs_collider_params_table_build(struct cs_system *system, struct cs_error *error);

#endif
