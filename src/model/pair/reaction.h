/* reaction.h - what one pair in range does to its four particles. */
#ifndef CS_PAIR_REACTION_H
#define CS_PAIR_REACTION_H

#include "model/contact/touch.h"
#include "model/pair/meeting.h"
#include "model/pair/pair_set.h"
#include "model/pair/stencil.h"

/* One pair at one state, found in range. */
struct cs_reaction {
    struct cs_stencil stencil;
    struct cs_touch touch; /* of the contact points: g = n, v = V */
    double g[4][3], weight[4];
};

/* Sets everything of a reaction whose stencil is set. v (4) velocities of its particles. */
void cs_reaction_set(struct cs_reaction *reaction, const struct cs_meeting *meeting,
                     const struct cs_contact_keys *keys, double v[4][3]);

/* f = the forces on the four particles; the parts as in touch.h. */
void cs_reaction_force(const struct cs_reaction *reaction, struct cs_touch_parts parts,
                       double f[4][3]);

/* df = their change, exact, when the particles move from p by dp and their velocities v change
 * by dv. */
struct cs_reaction_move {
    double p[4][3], v[4][3], dp[4][3], dv[4][3];
};
void cs_reaction_jvp(const struct cs_reaction *reaction, struct cs_touch_parts parts,
                     struct cs_reaction_move *move, double df[4][3]);

/* The share of a matrix, as struct cs_pair says: the law along the gradient, and friction and
 * damping with the weights as they are. How the gradient turns is not in it, */
void cs_reaction_matrix(const struct cs_reaction *reaction, const struct cs_matrix *matrix,
                        struct cs_pair *pair);
/* but here: ck F times the second derivative of the distance, which has both signs. */
void cs_reaction_turn(const struct cs_reaction *reaction, const struct cs_matrix *matrix,
                      struct cs_pair_turn *turn);

/* Sums of the norms of the blocks in the row of each particle: N/m and N s/m. */
void cs_reaction_bound(const struct cs_reaction *reaction, double stiffness[4],
                       double damping[4]);

#endif
