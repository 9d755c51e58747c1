/* body_particles.h - particles of bodies at the start: positions, areas, pins. */
#ifndef CS_BODY_PARTICLES_H
#define CS_BODY_PARTICLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cs_body;
struct cs_holder;
struct cs_pin;
struct cs_pose;
struct cs_scene;

/* Body b of a scene. */
const struct cs_body *cs_scene_body(const struct cs_scene *scene, uint32_t b);

/* Number of particles of a body, its placement, and its velocity in m/s at time 0. */
int64_t cs_body_count(const struct cs_body *body);
const struct cs_pose *cs_body_placement(const struct cs_body *body);
const double *cs_body_velocity(const struct cs_body *body);

/* Sets r to the rows of the rotation by a unit quaternion x, y, z, w. */
void cs_quaternion_matrix(const double q[4], double r[9]);

/* Sets r to the rows of the rotation of a placement: its matrix, or that of its quaternion. */
void cs_pose_rotation(const struct cs_pose *place, double r[9]);

/* Writes the positions of a body's particles in m, placed, to x[first..] of x (3,n). */
void cs_body_position(const struct cs_body *body, uint32_t n, uint32_t first, double *x);

/* Returns the area of the body's particle i in m2 at rest: a quarter of each cell at it, a
 * third of each triangle. */
double cs_body_area(const struct cs_body *body, uint32_t i);

/* Returns true if a pin selects particle i of the body; x as from cs_body_position. */
bool cs_body_pin_selects(const struct cs_body *body, const struct cs_pin *pin, uint32_t n,
                         uint32_t first, uint32_t i, const double *x);

/* Returns true if a body is a closed mesh whose faces look outwards. */
bool cs_body_is_closed(const struct cs_body *body);

/* Returns true if a holder names no collider of the scene. text (size bytes) then says so. */
bool cs_holder_fault(const struct cs_scene *scene, const struct cs_holder *holder, char *text,
                     size_t size);

/* Marks the body's pinned particles: pinned[0..count) = true, others unchanged. x as from
 * cs_body_position. The pins have passed cs_body_pin_fault. */
void cs_body_pin(const struct cs_body *body, uint32_t n, uint32_t first, const double *x,
                 bool *pinned);

/* Returns true if no face of the body, whose mesh is made, has this name. text (size bytes)
 * then says so, and names a near one. */
bool cs_body_set_fault(const struct cs_body *body, const char *set, char *text, size_t size);

/* Returns true if the body, whose mesh is made, cannot have this pin: an index beyond its
 * particles, a named edge of a mesh, a box inside out. text (size bytes) then says so. */
bool cs_body_pin_fault(const struct cs_body *body, const struct cs_pin *pin, char *text,
                       size_t size);

#endif
