/* cover_force.h - what the points of cover.h do to the corners of their edges and triangles. */
#ifndef CS_COVER_FORCE_H
#define CS_COVER_FORCE_H

#include "model/cover/cover.h"

/* Sets covers->now to the forces at a state, or with at->dx or at->dv to their change. With all
 * threads, as all here. */
void cs_covers_set(struct cs_covers *covers, const struct cs_eval *at);

/* J, of the elastic part. */
double cs_covers_energy(struct cs_covers *covers, const struct cs_eval *at);

/* Sets covers->blocks to the shares of a matrix. kept: in covers->matrix, for products; else in
 * covers->now, and with matrix->bound for their blocks alone. */
void cs_covers_set_matrix(struct cs_covers *covers, const struct cs_matrix *matrix, bool kept);

/* Adds the sums of norms in the rows of df/dx and df/dv at a state. */
void cs_covers_add_bound(struct cs_covers *covers, const struct cs_eval *at, double *stiffness,
                         double *damping);

#endif
