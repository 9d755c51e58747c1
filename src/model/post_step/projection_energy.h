/* projection_energy.h - keeps contact projection from adding energy.
 *
 * A push of depth d on a particle with stiffness K adds K d^2 / 2 to the springs. The velocity
 * that it removes had m (d / dt)^2 / 2, which is dt^2 K / m times less if the step is stiff.
 * The energy after a commit is therefore limited to the larger of two: that before the push,
 * and that of the last commit plus a hundredth of what was lost since first contact. In this
 * order:
 *
 * 1. the pushes alone are accepted if they respect the limit;
 * 2. otherwise the body follows them as in an implicit step (projection_energy.h), and its
 *    velocity by as much as belongs to the displacement in a step of the method;
 * 3. otherwise a fraction of the correction is applied, by bisection, and the rest in later
 *    commits. Velocities never point inwards.
 *
 * At first contact the reference is the energy before the step, plus that of a fall through one
 * step, because a body at rest has nothing to lose. Colliders that move do work in addition. */
#ifndef CS_PROJECTION_ENERGY_H
#define CS_PROJECTION_ENERGY_H

#include "model/post_step/static_friction.h"
#include "model/solver/linear.h"

/* Implicit elastic response of the body to the displacements that
 * projection imposed. */

/* Linear solver of the response. */
struct cs_elastic_response {
    /* its own solver: a method may keep the matrix of another */
    struct cs_linear linear;
    /* pushed particles, so that the preconditioner knows them as pinned */
    struct cs_temporary_pins pins;
    double *load; /* (3,n) N, what the pushes exert */
};

/* J: total energy, and the sum of the sizes of its parts, which scales rounding errors. */
struct cs_energy_with_scale {
    double total, scale;
};

/* Memory of a commit for the next. */
struct cs_projection_memory {
    /* energy that the last commit with a push left */
    struct cs_energy_with_scale energy;
    /* J, energy before first contact, and what was added since */
    double energy_limit;
    bool has_last_energy,
        in_contact; /* energy is that of the state before; most is of this contact */
};

/* State of the limit between commits. */
struct cs_projection_energy {
    const struct cs_system *system; /* borrowed */
    struct cs_elastic_response elastic_response;
    /* (3,n) work array */
    double *work;
    /* J, size of the terms of gravity's energy, which may cancel */
    double energy_scale;
    /* 1/s, velocity per displacement of an elastic response */
    double velocity_per_push;
    /* J, kinetic energy that the pushes of this commit removed */
    double absorbed;
    struct cs_projection_memory memory;
};

/* One commit with a push; all is borrowed. */
struct cs_projection_step {
    double t, dt;
    const struct cs_posed_collider *colliders, *colliders_before;
    const double *before_step; /* (6,n) the state before the step */
    const double *x, *v;       /* (3,n) as the step has left them */
    double *corrected;         /* (6,n) as the pushes leave them */
    /* (n) particles whose position is imposed: pushed or held */
    const bool *is_pushed;
};

/* Allocates the arrays in the arena. CS_ERR_MEMORY. */
enum cs_status cs_projection_energy_init(struct cs_projection_energy *energy,
                                         struct cs_system *system, struct cs_arena *arena,
                                         struct cs_error *error);

/* Corrects blow->corrected as described above. Returns false if particles are left behind a
 * surface. */
bool cs_projection_energy_limit(struct cs_projection_energy *energy,
                                const struct cs_projection_step *step);

#endif
