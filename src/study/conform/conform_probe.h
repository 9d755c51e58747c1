/* conform_probe.h - a small scene in memory and a method, for one check. */
#ifndef CS_CONFORM_PROBE_H
#define CS_CONFORM_PROBE_H

#include "study/conform/conform_card.h"
#include "study/perturb.h"
#include "study/session.h"
#include "study/trajectory_error.h"

/* Must stay where it is while open. */
struct cs_probe {
    struct cs_session session; /* opened up to the system, the run begun by cs_probe_run */
    size_t n;                  /* particles */
    double *x, *v;             /* (3,n): the state; to be moved before the first frame only */
    double frame;              /* s */
    bool has_ended;            /* blew up or failed: error says how */
    struct cs_error error;
    struct cs_error *memory_error; /* of the card */

    /* called within every commit once it has been done; may be NULL. Moves the state or only
     * looks; returns whether it moved. */
    bool (*on_commit)(struct cs_probe *probe, double t, double dt, double *x, double *v);
    void *on_commit_ctx;
};

/* Reads the scene and builds it for the card's method (or another one), options as the card has
 * them; the first body is matched (scene.h) where the method asks for clusters. On failure
 * the probe has ended, and error says why. close is to be called. */
bool cs_probe_open(struct cs_probe *probe, const struct cs_conform *card,
                   const struct cs_integrator *method, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
void cs_probe_close(struct cs_probe *probe);

/* Whether the method has such an option of a number. */
bool cs_method_has(const struct cs_integrator *method, const char *name);

/* Sets an option to the value, or to the nearest that its range allows; false: not there. */
bool cs_probe_set(struct cs_probe *probe, const char *name, double value);

/* Sets what decides the accuracy: `dt`, or `rtol` where the method is adaptive; inner
 * tolerances (`rtol` of a fixed step, `linear_rtol`, `newton_rtol`) as tight as is of use,
 * and `iterations` high where the fidelity is CS_FIDELITY_IMPLICIT_EULER. */
void cs_probe_set_step(struct cs_probe *probe, double dt);
void cs_probe_set_tolerance(struct cs_probe *probe, double rtol);

/* The order that the card's method claims: that of its descriptor, or of its option `order`
 * where it has one. */
uint32_t cs_probe_order(const struct cs_conform *card, bool damped);

/* Whether the accuracy can be set at all; else the row is skipped. */
bool cs_probe_can_be_set(const struct cs_conform *card, struct cs_conform_row *row);

/* Two accuracies, level 0 and 1: h and h/8, or a relative tolerance of 1e-5 and 1e-7. Returns
 * the share of a motion of frequency w that the error of a method of that order is near:
 * (h w)^order, or TOLERANCE_FACTOR times the tolerance. */
double cs_probe_set_level(struct cs_probe *probe, double h, double w, uint32_t order,
                          int level);
/* Errors of adaptive methods may be that many tolerances: they control the error of a step. */
#define CS_TOLERANCE_FACTOR 1000

/* Runs that many frames; false where it ended before. */
bool cs_probe_run(struct cs_probe *probe, uint32_t frames);

/* Kinetic and potential energy in J. */
double cs_probe_energy(const struct cs_probe *probe);

#endif
