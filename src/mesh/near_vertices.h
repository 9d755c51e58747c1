/* near_vertices.h - finds vertices in one place. */
#ifndef CS_NEAR_VERTICES_H
#define CS_NEAR_VERTICES_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Sets places[i] of each vertex that `among` marks to the first marked vertex within the given
 * fraction of the diagonal of the box of all n positions, of those that are the first in their
 * own place; other entries stay. Returns the number of vertices that are not the first.
 * CS_ERR_MEMORY in *error. */
uint32_t cs_near_vertices_find(const double (*positions)[3], uint32_t n, const bool *among,
                               double fraction, uint32_t *places, struct cs_error *error);

#endif
