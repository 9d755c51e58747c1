/* step_halving.h - the loop over steps that may be refused: a refused step is halved.
 *
 * As fixed_step.h, the span of an advance is cut into equal steps of at most dt. A step that
 * its method refuses (Newton does not converge, springs turn too far), or that passes over
 * contact by force (host->max_step_fraction), is halved, at most STEP_HALVINGS_MAX times, in
 * scenes with contact by force STEP_HALVINGS_IN_CONTACT times; then the run fails.
 */
#ifndef CS_STEP_HALVING_H
#define CS_STEP_HALVING_H

#include "fixed_step.h"
#include "newton.h"

#define STEP_HALVINGS_MAX        8
#define STEP_HALVINGS_IN_CONTACT 12 /* in scenes with contact by force */

/* A method's own struct starts with this. */
struct step_halving {
    struct fixed_step fixed;  /* its step is not used */
    struct newton *newton;    /* NULL: the method has none */
    double last_h;            /* length of the last accepted step in s */
    bool refused_by_contact;  /* the last step was taken back, for it passed over contact */
    bool refused_by_rotation; /* the last step was refused by springs_turned */
    /* From (x, v) at t to t + h, without the commit; where *accepted stays false, x and v are
     * left as they were. */
    enum cs_step (*step)(struct step_halving *self, double t, double h, double *x, double *v,
                         bool *accepted);
};

/* Start of the struct of a method with a Newton iteration. */
struct newton_method {
    struct step_halving base;
    struct newton newton;
};

typedef enum cs_step step_halving_callback(struct step_halving *, double, double, double *,
                                           double *, bool *);

/* Memory of a method: a struct of `bytes` that starts with struct halving, or with struct
 * newton_method; NULL: already reported; [create]. */
struct step_halving *step_halving_create(const struct cs_host *host, size_t bytes, double dt,
                                         step_halving_callback *step);
struct newton_method *newton_method_create(const struct cs_host *host, size_t bytes, double dt,
                                           double rtol, int64_t iterations,
                                           step_halving_callback *step);

/* Takes `n` arrays (3,n) of doubles; [create]. */
enum cs_step step_halving_alloc(const struct cs_host *host, double **const arrays[], size_t n);

void step_halving_stats(const void *self, struct cs_stats *out);
/* What the loop remembers, for save and load. */
enum cs_step step_halving_archive(void *self, const struct cs_archive *archive);

/* What the last step remembers cannot be used for one of length h. */
bool step_halving_is_fresh(const struct step_halving *self, double h);

/* A spring's ends have moved against each other by more than half its length from x0 to x1, the
 * larger of those at rest and at x0, or to what is not a number: beyond that a linearised step
 * knows nothing of the true motion. Needs CS_NEED_SPRINGS. */
bool springs_rotated_far(const struct cs_view *view, const double *x0, const double *x1);

/* The common part of the descriptors. */
#define STEP_HALVING_METHOD(struct_, rows_, archive_)                                          \
    .size = sizeof(struct cs_integrator), .fidelity = CS_FIDELITY_ODE, .options = rows_,       \
    .n_options = sizeof rows_ / sizeof rows_[0], .options_size = sizeof(struct_),              \
    .restart = fixed_step_restart, .advance = fixed_step_advance, .stats = step_halving_stats, \
    .save = archive_, .load = archive_

#endif
