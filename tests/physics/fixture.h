/* fixture.h - a scene in JSON and a method, made into a run, for one physics test. */
#ifndef FIXTURE_H
#define FIXTURE_H

#include "../suite.h"
#include "session/perturb.h"
#include "session/recorded_run.h"
#include "session/session.h"

struct fixture {
    struct cs_session session;
    struct cs_system *system; /* of the session */
    size_t n;                 /* particles */
    double *x, *v;            /* (3,n) each: the state */
};

/* Reads a scene and builds its system for an integrator ("NAME:key=value,..."), which steps by
 * frames; the state may then be moved before the run starts. Anything that fails fails the
 * test.
 */
void fixture_open(struct fixture *fixture, const char *integrator, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void fixture_start(struct fixture *fixture);

/* Energies in J at the ends of commits: kinetic and potential, and of gravity alone. */
struct fixture_log {
    const struct fixture *fixture;
    double first, largest, lowest_gravity;
};

/* fixture_start with a log, which must stay where it is while the run lasts. */
void fixture_start_logged(struct fixture *fixture, struct fixture_log *log);

/* Runs that many frames; a blow-up fails the test. */
void fixture_frames(struct fixture *fixture, uint32_t frames);
/* Steps a frame in which the method must give up, which is no error; returns its reason. */
const char *fixture_reason(struct fixture *fixture);
void fixture_close(struct fixture *fixture);

/* A block at its height of balance on a slope of mu = 0.3, whose tangent is given, or on a
 * belt: four particles of 25 g, contact of 1000 N/m. friction: more keys of contact; events:
 * JSON or "". The run is started. */
void fixture_open_slope(struct fixture *block, const char *method, const char *friction,
                        double tangent, const char *events);
/* Its mean velocity down the slope in m/s. */
double fixture_sliding(const struct fixture *block, double tangent);

/* Adds (p, l): momentum and angular momentum about the origin. */
void fixture_momentum(const struct fixture *fixture, double p[3], double l[3]);

/* Kinetic and potential energy in J. */
double fixture_energy(const struct fixture *fixture);

/* Fails unless n values are the same to the bit; what: named in the message. */
void ck_bits(const double *a, const double *b, size_t n, const char *what);

#endif
