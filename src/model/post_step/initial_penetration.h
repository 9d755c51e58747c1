/* initial_penetration.h - particles that start inside a collider, and bodies that start
 * crossed. */
#ifndef CS_INITIAL_PENETRATION_H
#define CS_INITIAL_PENETRATION_H

#include "model/system/system.h"

/* Particles that were moved out, for the report. */
struct cs_initial_penetration {
    /* number of particles that were moved out */
    uint32_t n;
    /* m, largest distance that one was moved */
    double depth;
};

/* Checks every free particle of the state that a system starts from. Contact would push a
 * particle out of a collider with energy that comes from nothing. By the law `project`, inside
 * means behind the surface offset by the thickness. With contact.start "move-out" it is moved
 * out along normals, and *inside reports it.
 *
 * CS_ERR_SCENE, with particle, collider and depth, if contact.start refuses; if colliders leave
 * no way out; if a contact sample (model/contact/contact_samples.h) is then still inside; or if
 * edges of bodies with contact pierce triangles, unless crossings are ignored. The state may
 * then have been changed in part. */
enum cs_status cs_initial_penetration_resolve(struct cs_system *system,
                                              struct cs_initial_penetration *inside,
                                              struct cs_error *error);

#endif
