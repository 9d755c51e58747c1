/* kick_drift.h - a kick, a drift, and the velocity predicted for the next kick, of all
 * particles in one pass. */
#ifndef KICK_DRIFT_H
#define KICK_DRIFT_H

#include "parallel.h"

#include <clothsim/clones.h>

/* v += kick f/m, x += drift v, predicted = v + ahead f/m; arrays are (3,n), lengths in s. */
struct kick_drift {
    const struct cs_host *host;
    const double *f; /* N */
    double *x, *v, *predicted;
    double kick, drift, ahead;
};

CS_CLONES static void kick_drift_row(const struct kick_drift *of, size_t at, size_t count,
                                     const double *restrict inv_mass) {
    const double kick = of->kick, drift = of->drift, ahead = of->ahead;
    const double *restrict f = of->f + at;
    double *restrict x = of->x + at, *restrict v = of->v + at;
    double *restrict predicted = of->predicted + at;
    for (size_t i = 0; i < count; i++) {
        const double a = f[i] * inv_mass[i];
        v[i] += kick * a;
        x[i] += drift * v[i];
        predicted[i] = v[i] + ahead * a;
    }
}

static inline void kick_drift_part(void *arg, size_t begin, size_t end) {
    const struct kick_drift *of = arg;
    const struct cs_view *view = of->host->view;
    for (size_t c = 0; c < 3; c++)
        kick_drift_row(of, c * view->n + begin, end - begin, view->inv_mass + begin);
}

static inline void kick_drift(struct kick_drift move) {
    parallel_for(move.host, move.host->view->n, kick_drift_part, &move);
}

#endif
