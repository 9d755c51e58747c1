/* extreme.h - the catalogue of extreme scenes: what each method class must make of them.
 *
 * A scene of the catalogue is a scene file with a key of its own at the root:
 *   "x-extreme": {"seconds": 0.5, "dt": 0.1, "explicit": "theory", "implicit": "bounded",
 *                 "adaptive": "bounded|refused"}
 * dt (0 or absent: the method's own) is that of methods with a fixed step. What is expected:
 *   bounded   the run ends, and its energy is physically possible (energy_monitor.h)
 *   finite    the run ends, and its state is finite
 *   blows up  the energy leaves all bound, and that is said
 *   refused   the method gives up and says why
 *   over budget  the time allowed may run out
 *   theory    blows up where linear theory at the start says so (by 10 %), else bounded
 * A method that is not like its class has a line in "methods": {"xpbd": "blows up"}.
 * Several are joined by "|". Whatever is expected: no state that is not finite may pass unsaid.
 */
#ifndef CS_EXTREME_H
#define CS_EXTREME_H

#include "study/energy_monitor.h"
#include "study/stability/stability_reference.h"

struct cs_extreme_row {
    const char *scene; /* file name without folder and ending */
    const char *method;
    const char *expected;
    bool as_expected, is_done;
    enum cs_stability_verdict verdict;
    char message[320]; /* more about it, or "" */
    double seconds;    /* wall time */
};

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

/* Runs every scene with every method. CS_ERR_CHECK where an expectation was not met. */
enum cs_status cs_extreme_run(struct cs_extreme *extreme, struct cs_error *error);

#endif
