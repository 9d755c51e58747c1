/* solids.h - colliders and the ground's rectangle as triangles. */
#ifndef CS_DRAW_SOLIDS_H
#define CS_DRAW_SOLIDS_H

#include "draw/cpu/shade.h"
#include "draw/ground.h"
#include "draw/solid.h"

/* Fills the coats of all colliders, and adds the squares and then all others as the camera sees
 * them, whose number is that of the coat. *n_squares: triangles of squares. */
void cs_solids_add(const struct cs_solids *solids, const struct cs_lens *lens,
                   const float eye[4], struct cs_coat *coats, struct cs_triangles *triangles,
                   size_t *n_squares);

/* Adds those that cast shadow as the light sees them, from its place or direction. */
void cs_solids_add_shadow(const struct cs_solids *solids, const struct cs_lens *lens,
                          const float light[4], struct cs_triangles *triangles);

/* Adds the ground's rectangle, where it has one. */
void cs_ground_add(const struct cs_ground *ground, const struct cs_lens *lens,
                   struct cs_triangles *triangles);

#endif
