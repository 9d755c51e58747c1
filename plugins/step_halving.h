/* step_halving.h - the loop over steps that may be refused: a refused step is halved.
 *
 * As in fixed_step.h, the span of an advance is cut into equal steps of at most dt. A step is
 * refused for one of three reasons:
 * 1. Newton's iteration does not converge.
 * 2. A linearised step moves the ends of a spring against each other by more than half its
 *    length.
 * 3. It passes over contact by force, or through a surface (host->max_step_fraction < 1).
 *
 * It is then halved, at most STEP_HALVINGS_MAX times; then the run fails and says for which
 * reason. step_subdivision.h decides how long the steps stay short. */
#ifndef CS_STEP_HALVING_H
#define CS_STEP_HALVING_H

#include "fixed_step.h"
#include "newton.h"

/* Halvings of a step before the run fails: to 1/4096. Chosen by trial: contact by force needs
 * that, and newmark for particles of 1e-9 kg, whose period is below 1e-5 s. */
#define STEP_HALVINGS_MAX 16

/* A method's own struct starts with this. */
struct step_halving {
    struct fixed_step fixed;  /* its step is not used */
    struct newton *newton;    /* NULL: the method has none */
    double last_h;            /* length of the last accepted step in s */
    bool refused_by_rotation; /* the last step was refused by springs_rotated_far */
    /* Steps from (x, v) at t to t + h, without the commit. If *accepted stays false, x and v
     * are unchanged. */
    enum cs_step (*step)(struct step_halving *self, double t, double h, double *x, double *v,
                         bool *accepted);
};

/* Start of the struct of a method with a Newton iteration. */
struct newton_method {
    struct step_halving base;
    struct newton newton;
};

/* The type of `step` above. */
typedef enum cs_step step_halving_callback(struct step_halving *, double, double, double *,
                                           double *, bool *);

/* Allocates a method: a struct of `bytes` that starts with struct step_halving, or with
 * struct newton_method. Returns NULL if out of memory, which the host has reported; [create].
 */
struct step_halving *step_halving_create(const struct cs_host *host, size_t bytes, double dt,
                                         step_halving_callback *step);
struct newton_method *newton_method_create(const struct cs_host *host, size_t bytes, double dt,
                                           double rtol, int64_t iterations,
                                           step_halving_callback *step);

/* Allocates n arrays (3, particles) of doubles and stores them where arrays[k] points;
 * [create]. */
enum cs_step step_halving_alloc(const struct cs_host *host, double **const arrays[], size_t n);

/* stats of the descriptor: rejected steps and Newton iterations. */
void step_halving_stats(const void *self, struct cs_stats *out);
/* save and load of the loop: last step length, iterations, and the state of fixed_step.h. */
enum cs_step step_halving_archive(void *self, const struct cs_archive *archive);

/* True if the method's history cannot serve a step of length h: the state was changed from
 * outside, or the last step had another length. */
bool step_halving_is_fresh(const struct step_halving *self, double h);

/* True if the ends of a spring moved against each other by more than half its length from x0
 * to x1, or to NaN. The length is the larger of those at rest and at x0. Beyond that a
 * linearised step has no relation to the true motion: a spring that turns by 29 degrees moves
 * its ends by that much. Needs CS_NEED_SPRINGS. */
bool springs_rotated_far(const struct cs_view *view, const double *x0, const double *x1);

/* The common part of the descriptors of these methods. */
#define STEP_HALVING_METHOD(struct_, rows_, archive_)                                          \
    .size = sizeof(struct cs_integrator), .fidelity = CS_FIDELITY_ODE, .options = rows_,       \
    .n_options = sizeof rows_ / sizeof rows_[0], .options_size = sizeof(struct_),              \
    .restart = fixed_step_restart, .advance = fixed_step_advance, .stats = step_halving_stats, \
    .save = archive_, .load = archive_

#endif
