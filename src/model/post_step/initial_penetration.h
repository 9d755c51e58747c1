/* initial_penetration.h - particles that start inside an obstacle. */
#ifndef CS_INITIAL_PENETRATION_H
#define CS_INITIAL_PENETRATION_H

#include "model/system/system.h"

struct cs_initial_penetration {
    uint32_t n;   /* particles that were moved out */
    double depth; /* m, the furthest of them */
};

/* Looks at every free particle of the state that a system starts from. One that is inside an
 * obstacle - by the law project: behind its surface moved out by the thickness - would get the
 * energy of its way out from nowhere. By contact.start it is moved out along the normals,
 * and *inside says so; or CS_ERR_SCENE with the first particle, the obstacle and the depth, as
 * also where a particle lies between obstacles that leave no room, where a point between
 * particles that feels an obstacle (model/contact/contact_samples.h) is then still inside, or
 * where edges of bodies that keep off each other, themselves or a mesh go through triangles
 * (unless crossings are ignored). */
enum cs_status cs_initial_penetration_resolve(struct cs_system *system,
                                              struct cs_initial_penetration *inside,
                                              struct cs_error *error);

#endif
