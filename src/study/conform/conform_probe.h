/* conform_probe.h - runs a small scene in memory with one method, for one check. */
#ifndef CS_CONFORM_PROBE_H
#define CS_CONFORM_PROBE_H

#include "study/conform/conform_card.h"
#include "study/perturb.h"
#include "study/session.h"
#include "study/trajectory_error.h"

/* A scene with a method, and how its run ended. Must not move in memory while open. */
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

/* Reads the scene from printf text and builds it for the given method, of the card or another
 * one. The card's own method gets the card's options. The first body gets shape matching if the
 * method needs clusters. Returns false on failure: the probe has ended and error says why; all
 * further calls then do nothing. cs_probe_close must be called in any case. */
bool cs_probe_open(struct cs_probe *probe, const struct cs_conform *card,
                   const struct cs_integrator *method, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* Closes the session. Lack of memory is passed on to the card, because it is no fault of the
 * method. */
void cs_probe_close(struct cs_probe *probe);

/* True if the method has an option of that name that is a number. */
bool cs_method_has(const struct cs_integrator *method, const char *name);

/* Sets an option to the value, or to the nearest one in its range. Returns false if the method
 * has no such option. */
bool cs_probe_set(struct cs_probe *probe, const char *name, double value);

/* Set the accuracy: `dt` in s, or `rtol` of an adaptive method. Inner tolerances (`rtol` of a
 * fixed step, `linear_rtol`, `newton_rtol`) are set to 1e-12, so the measured error is that of
 * the time integration. `iterations` is set high if the fidelity is CS_FIDELITY_IMPLICIT_EULER.
 * Options that a method lacks are skipped. */
void cs_probe_set_step(struct cs_probe *probe, double dt);
void cs_probe_set_tolerance(struct cs_probe *probe, double rtol);

/* Returns the claimed order of the card's method: that of its descriptor, or of its option
 * `order` if it has one. */
uint32_t cs_probe_order(const struct cs_conform *card, bool damped);

/* True if the accuracy can be set; else the row is skipped. */
bool cs_probe_can_be_set(const struct cs_conform *card, struct cs_conform_row *row);

/* Sets level 0 or 1 of accuracy: h and h/8, or relative tolerances of 1e-5 and 1e-7. Returns
 * the expected error as a fraction of a motion of rate w (1/s) for a method of that order: (h
 * w)^order, or CS_TOLERANCE_FACTOR times the tolerance. */
double cs_probe_set_level(struct cs_probe *probe, double h, double w, uint32_t order,
                          int level);
/* Allowed ratio of the global error of an adaptive method to its tolerance, which controls the
 * local error of each step only. */
#define CS_TOLERANCE_FACTOR 1000

/* Runs that many frames; begins the run at the first call. Returns false if the run ended
 * early: error says how. */
bool cs_probe_run(struct cs_probe *probe, uint32_t frames);

/* Returns the kinetic and potential energy in J. */
double cs_probe_energy(const struct cs_probe *probe);

#endif
