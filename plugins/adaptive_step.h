/* adaptive_step.h - the loop over steps of one-step methods with error control.
 *
 * Error norm: the root of the mean, over the numbers that move, of (error / (atol + rtol
 * |y|))^2, |y| the larger of both ends of the step. A step is accepted at 1 or below;
 * step_control.h chooses the next one. The last steps before the end of an advance are cut so
 * that one ends there; but where the host lets it (host->overstep_until) a step passes that end
 * up to the next event, hermite.h gives the state there, and steps do not depend on frames.
 *
 * Contact shortens steps in two ways. host->longest_step bounds a step before it is tried. A
 * step that host->max_step_fraction refuses is tried again, shorter; that length bounds the
 * following steps too, and grows slowly (CONTACT_GROWTH), because the cause mostly lasts. */
#ifndef ADAPTIVE_STEP_H
#define ADAPTIVE_STEP_H

#include "hermite.h"
#include "step_control.h"

/* Options of such a method, and their rows for a struct that has the same fields. */
struct adaptive_options {
    double rtol, atol, dt_max;
    int64_t max_steps;
    bool fixed; /* no option: steps of dt_max, whose errors are taken for 0 */
};
#define ADAPTIVE_ROWS(struct_, rtol_)                                                          \
    CS_OPTION(struct_, rtol, "", rtol_, 1e-14, 0.1,                                            \
              "local error of a step, relative to the value"),                                 \
        CS_OPTION(struct_, atol, "", 0, 0, 1,                                                  \
                  "absolute local error in m and m/s; 0: rtol of the scene's own"),            \
        CS_OPTION(struct_, dt_max, "s", 0, 0, 10,                                              \
                  "maximum step; 0: one frame, at most 0.1 s if steps pass frames"),           \
        CS_OPTION(struct_, max_steps, "", 1000000, 1, 1e9,                                     \
                  "maximum steps per frame, rejected ones included, before the run fails")

struct adaptive_step;

/* Tries a step of h from y (6n) at t, where self->slope holds: leaves the new state in
 * self->next, and its error in units of the tolerance in *error; NaN or infinite: it failed. */
typedef enum cs_step adaptive_try(struct adaptive_step *self, double t, double h,
                                  const double *y, double *error);

/* A method's own struct starts with this. */
struct adaptive_step {
    const struct cs_host *host; /* borrowed */
    struct adaptive_options asked;
    struct step_control control;
    struct tolerance tolerance;
    size_t length;  /* 6n */
    double free;    /* values that move, at least 1 */
    double *slope;  /* (3,n) in m/s2: acceleration at the state */
    double *next;   /* (6n): the state after a step */
    double *error;  /* (6n) */
    double *weight; /* (6n): 1 / tolerance */
    double contact; /* s, the longest step that contact lets pass; HUGE_VAL: any */
    double bound;   /* s, the longest step of the last try by all limits but the error */
    bool fresh;     /* slope is not that of the state */
    bool changed;   /* the last commit changed the state */
    bool started;   /* control.h was chosen */
    uint64_t rejected;
    double local_error; /* m, of all accepted steps, added up */
    double begin, end;  /* s, of the advance */
    /* Where steps pass frames, the number of ends that the state there is taken from, else 0.
     * Then next and slope are not touched between two steps. */
    int ends;
    double *start[HERMITE_ENDS - 1]; /* (9n): the state and its acceleration at the begin of the
                                      * last step, and of the one before */
    double reached;                  /* s, the end of the last step */
    double length_of[HERMITE_ENDS - 1]; /* s, of these steps; 0: there is none */
    int64_t tries;                      /* steps in it, rejected ones included */
    adaptive_try *attempt;
    /* [after an accepted step] Makes slope that of the new state, if the method has it, and
     * returns whether it did. */
    bool (*accept)(struct adaptive_step *self);
    /* s, the longest step that the method can take at the state; NULL: any */
    double (*limit)(struct adaptive_step *self, double t, const double *y);
};

/* Allocates the arrays and takes options; power: that of the local error in h. Where the host
 * lets steps pass frames they do, unless they are of a fixed length. [create] */
enum cs_step adaptive_step_init(struct adaptive_step *self, const struct cs_host *host,
                                const struct adaptive_options *options, int power);

/* a (3,n) in m/s2 at (t, x, v). */
void adaptive_step_evaluate(const struct adaptive_step *self, double t, const double *x,
                            const double *v, double *a);

/* Sets self->weight for a step from y to z (6n). */
void adaptive_step_weigh(struct adaptive_step *self, const double *y, const double *z);

/* The weighted root mean square of values (6n); pinned particles do not count in the mean. */
double adaptive_step_norm(const struct adaptive_step *self, const double *values);

/* Calls of the descriptor. */
enum cs_step adaptive_step_restart(void *self, double t, const double *x, const double *v);
enum cs_step adaptive_step_advance(void *self, double t0, double t1, double *x, double *v);
void adaptive_step_stats(const void *self, struct cs_stats *out);
/* save and load: the slope at the state, what the control of the step knows, and the ends of a
 * step that passed the frame. */
enum cs_step adaptive_step_archive(void *self, const struct cs_archive *archive);

/* The common part of the descriptors of these methods. */
#define ADAPTIVE_METHOD(struct_, rows_)                                                        \
    ADAPTIVE_METHOD_OF(struct_, rows_, adaptive_step_restart, adaptive_step_archive)
#define ADAPTIVE_METHOD_OF(struct_, rows_, restart_, archive_)                                 \
    .size = sizeof(struct cs_integrator), .fidelity = CS_FIDELITY_ODE, .options = rows_,       \
    .n_options = sizeof rows_ / sizeof rows_[0], .options_size = sizeof(struct_),              \
    .restart = restart_, .advance = adaptive_step_advance, .stats = adaptive_step_stats,       \
    .save = archive_, .load = archive_

#endif
