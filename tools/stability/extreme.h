/* extreme.h - runs the catalogue of extreme scenes against the outcome expected of each method
 * class.
 *
 * A scene of the catalogue is a scene file with an additional key at the root:
 *   "x-extreme": {"seconds": 0.5, "dt": 0.1, "explicit": "theory", "implicit": "bounded",
 *               "adaptive": "bounded|refused"}
 * dt (0 or absent: the method's default) is used by methods with a fixed step. Outcomes:
 *   bounded      the run ends, and its energy is physically possible (energy_monitor.h)
 *   finite       the run ends, and its state is finite
 *   blows up     the energy exceeds its limit, and the run reports it
 *   refused      the method gives up with a reason
 *   over budget  the allowed time may run out
 *   theory       blows up if linear theory at the start predicts it (within 10 %), else bounded
 * Several outcomes are joined by "|". A method that differs from its class has an entry in
 * "methods": {"xpbd": "blows up"}. In any case a non-finite state must be reported, never
 * passed over. */
#ifndef CS_EXTREME_H
#define CS_EXTREME_H

#include "borders/stability_state.h"

/* Result of one scene with one method. Lives in memory shared with the workers; texts are those
 * of the catalogue and the registry. */
struct cs_extreme_row {
    const char *scene; /* file name without folder and ending */
    const char *method;
    const char *expected;
    bool as_expected, is_done;
    enum cs_stability_verdict verdict;
    char message[320]; /* more about it, or "" */
    double seconds;    /* wall time */
};

/* Request and counts. All pointers are borrowed. */
struct cs_extreme {
    const char *folder;
    const char *only_scene;     /* part of a name, NULL: all */
    const char *const *methods; /* (n_methods) names; 0: all that can be used */
    uint32_t n_methods;
    const char *const *plugins; /* (n_plugins) */
    uint32_t n_plugins;
    double budget; /* s of processor time for a run */
    uint32_t n_workers;
    const volatile sig_atomic_t *stop;
    void (*report)(void *ctx, const struct cs_extreme_row *row);
    void *ctx;
    uint32_t n_met, n_missed; /* out */
};

/* Runs every scene with every method and reports the rows in order. Returns CS_ERR_CHECK if an
 * expectation was not met, CS_ERR_USAGE if no scene matches only_scene; further CS_ERR_FILE,
 * CS_ERR_SCENE, CS_ERR_MEMORY, CS_ERR_INTERRUPT. */
enum cs_status cs_extreme_run(struct cs_extreme *extreme, struct cs_error *error);

#endif
