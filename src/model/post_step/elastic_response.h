/* elastic_response.h - how the springs give way to particles that contact has pushed. */
#ifndef CS_ELASTIC_RESPONSE_H
#define CS_ELASTIC_RESPONSE_H

#include "model/post_step/temporary_pins.h"
#include "model/solver/linear.h"

struct cs_elastic_response {
    struct cs_linear linear;       /* its own: a method may keep the matrix of another */
    struct cs_temporary_pins pins; /* pushed particles, for the solver's preconditioner */
    uint64_t solves, iterations;
};

/* Takes the arrays from arena; nothing where the system has no springs. CS_ERR_MEMORY. */
enum cs_status cs_elastic_response_init(struct cs_elastic_response *response,
                                        struct cs_system *system, struct cs_arena *arena,
                                        struct cs_error *error);

/* Whether springs are so stiff against a step of dt that the push of a particle without its
 * neighbours can hold more energy than the step brought: dt omega > 1. */
bool cs_elastic_response_is_needed(const struct cs_elastic_response *response, double dt);

/* u (3,n) in m holds the pushes of the particles marked in pushed (n) and anything at others.
 * Those are set to where the rest of the body would be had the pushes been forces on it in an
 * implicit Euler step of dt: the u that makes u A u / 2 smallest, A = M + dt D + dt^2 K of the
 * state (x, v), by conjugate gradients. A direction without stiffness, or 300 iterations, end
 * it early: u is then between the two. Pinned particles stay. */
void cs_elastic_response_solve(struct cs_elastic_response *response,
                               const struct cs_matrix *matrix, const bool *pushed, double *u);

#endif
