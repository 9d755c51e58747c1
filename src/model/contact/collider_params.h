/* collider_params.h - range and stiffness between the particles and each collider, made once.
 */
#ifndef CS_CONTACT_COLLIDER_PARAMS_H
#define CS_CONTACT_COLLIDER_PARAMS_H

#include "model/system/system.h"

/* Share of the shortest spring that the range is where a collider gives no thickness: springs
 * at rest do not reach from one side of a thin obstacle to the other. */
#define CS_RANGE_SHARE 0.4

struct cs_collider_params {
    double k;     /* N/m a particle */
    double range; /* m in front of the surface */
};

/* *k = contact.stiffness, or that of the softest stretch spring. CS_ERR_SCENE: neither. */
enum cs_status cs_collider_params_stiffness(const struct cs_system *system, double *k,
                                            struct cs_error *error);

/* Fills system->pairings (one a collider), the springs there. k: contact.stiffness, or the
 * softest stretch spring; range: the collider's thickness, or CS_RANGE_SHARE of the shortest
 * spring. CS_ERR_SCENE where a value is neither given nor to be had from springs;
 * CS_ERR_MEMORY. */
enum cs_status cs_collider_params_table_build(struct cs_system *system, struct cs_error *error);

#endif
