/* elastic_response.h - implicit elastic response of the body to the displacements that
 * projection imposed. */
#ifndef CS_ELASTIC_RESPONSE_H
#define CS_ELASTIC_RESPONSE_H

#include "model/post_step/temporary_pins.h"
#include "model/solver/linear.h"

/* Linear solver of the response, and its counters. */
struct cs_elastic_response {
    /* its own solver: a method may keep the matrix of another */
    struct cs_linear linear;
    /* pushed particles, so that the preconditioner knows them as pinned */
    struct cs_temporary_pins pins;
    /* systems solved, and iterations of conjugate gradients, over the whole run */
    uint64_t solves, iterations;
};

/* Prepares the solver; nothing for a system without springs. The arena owns its memory.
 * CS_ERR_MEMORY. */
enum cs_status cs_elastic_response_init(struct cs_elastic_response *response,
                                        struct cs_system *system, struct cs_arena *arena,
                                        struct cs_error *error);

/* Returns whether springs are so stiff for a step of dt s that pushing a particle without its
 * neighbours may store more energy than the step brought: dt omega > 1. */
bool cs_elastic_response_is_needed(const struct cs_elastic_response *response, double dt);

/* u (3,n) in m holds the pushes of the particles marked in pushed (n), and anything elsewhere.
 * Sets the other free particles to where they would be, had the pushes been forces in an
 * implicit Euler step of dt: the u with the smallest u^T A u / 2 for given pushes,
 *
 *   A = M + dt D + dt^2 K   at the state (x, v) of *matrix
 *
 * by conjugate gradients. A direction without stiffness, or 300 iterations, end it early; u is
 * then between start and solution. Pinned particles do not move. */
void cs_elastic_response_solve(struct cs_elastic_response *response,
                               const struct cs_matrix *matrix, const bool *pushed, double *u);

#endif
