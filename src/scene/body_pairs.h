/* body_pairs.h - pairs of surfaces of a scene that are in contact.
 *
 * Surfaces are numbered: first the bodies, then, if any collider is a mesh, all colliders.
 * Those of other shapes have no triangles and no pairs. */
#ifndef CS_SCENE_BODY_PAIRS_H
#define CS_SCENE_BODY_PAIRS_H

#include <stdbool.h>
#include <stdint.h>

struct cs_collider;
struct cs_scene;

/* Returns the number of surfaces. */
uint32_t cs_scene_surfaces(const struct cs_scene *scene);

/* Returns the collider of a surface; NULL if it is a body. */
const struct cs_collider *cs_scene_collider_at(const struct cs_scene *scene, uint32_t surface);

/* Returns true if a collider has key frames, and the largest speed in m/s of a vertex on any of
 * them; 0 if none has. */
bool cs_scene_has_key_frames(const struct cs_scene *scene);

/* Returns true if a pin or a seam of a checked scene holds to a collider; by_key_frames: to one
 * that has some. */
bool cs_scene_carries_pins(const struct cs_scene *scene, bool by_key_frames);

/* Returns true if a seam of the scene joins bodies, or one to a collider. */
bool cs_scene_sews(const struct cs_scene *scene, bool to_collider);
double cs_scene_key_frame_speed(const struct cs_scene *scene);

/* Returns true if two surfaces, or one with itself, may be in contact; *friction is then the
 * coefficient of the pair. */
bool cs_scene_bodies_collide(const struct cs_scene *scene, uint32_t a, uint32_t b,
                             double *friction);

/* Returns true if the contact of a scene is a force. */
bool cs_scene_contact_is_force(const struct cs_scene *scene);

/* Returns true if any two may. */
bool cs_scene_has_body_contact(const struct cs_scene *scene);

/* Returns true if a coefficient of friction of the scene is above 0, as ramps have it now. */
bool cs_scene_has_friction(const struct cs_scene *scene);

/* Returns true if friction on a collider has anchors (contact.friction_law stick): it is no
 * mesh, and its friction is above 0, now or after a ramp. */
bool cs_scene_sticks_to(const struct cs_scene *scene, uint32_t collider);

/* Returns true if friction on any collider has. */
bool cs_scene_friction_sticks(const struct cs_scene *scene);

/* Removes the corrections that act after steps: contact by projection, strain limit and
 * velocity loss. They are no part of the equation of motion; contact by force is. */
void cs_scene_remove_corrections(struct cs_scene *scene);

/* Treatment of edges that go through triangles, as the scene wants it. */

/* Treatment of crossings; each includes the count but the first. */
enum cs_crossings_policy {
    CS_CROSSINGS_IGNORE, /* nothing: they are not looked for */
    CS_CROSSINGS_COUNT,  /* counted after each frame */
    CS_CROSSINGS_LIMIT,  /* counted, and steps that would make one are cut */
    CS_CROSSINGS_STOP    /* counted after each step: the first ends the run */
};

/* Returns true if the scene leaves it open and has bodies in contact: they get `limit`. */
bool cs_scene_crossings_by_pairs(const struct cs_scene *scene);

/* Returns the policy of a scene. */
enum cs_crossings_policy cs_scene_crossings(const struct cs_scene *scene);

#endif
