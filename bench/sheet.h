/* sheet.h - the models that are measured, as scenes in JSON, and made into systems. */
#ifndef BENCH_SHEET_H
#define BENCH_SHEET_H

#include "bench.h"
#include "session/session.h"

enum bench_damping { BENCH_AXIAL, BENCH_RELATIVE, BENCH_UNDAMPED };

/* A sheet of 1 m x 1 m and 0.2 kg with 12 neighbours, shear springs of 22/75 and bend springs
 * of 8/75 of the stretch springs' stiffness, dampers of 2 zeta sqrt(k m); or the body with
 * limbs and springs through its inside, of the same mass. */
struct bench_model {
    uint32_t r;       /* particles along an edge; 0: the body with limbs */
    double stiffness; /* N/m */
    enum bench_damping damping;
    bool slim;    /* no bend springs */
    bool company; /* wind, sphere, plane and strain limit are there too */
    bool meets;   /* it meets itself, and its crossings are limited; nothing is pinned */
    double fps;
};

/* "64" or "mesh" */
void bench_model_name(const struct bench_model *model, char name[16]);

/* Largest step in s that an explicit method surely takes: 0.2 sqrt(m/k), a third of the limit
 * of the sheet. */
double bench_model_step(const struct bench_model *model);

/* Writes the scene into the scratch folder and opens it with an integrator up to the system;
 * needs: enum cs_need beside those of the integrator. The session is closed on failure. */
enum cs_status bench_sheet_open(struct cs_session *session,
                                const struct bench_settings *settings,
                                const struct bench_model *model, const char *integrator,
                                uint32_t needs, struct cs_error *error);

/* Displaces the free particles, the same for every call: three waves of 2 cm
 * across the sheet, a shear of 5 %, and 2 % of the shortest spring at random; velocities up to
 * 0.1 m/s. No spring is then at its rest length, and some are compressed. */
void bench_sheet_perturb(struct cs_system *system);

/* Sets the state of a run back to start (6n), which the method is told of as the contract asks,
 * and advances by that many seconds. */
void bench_sheet_advance(struct cs_run *run, const double *start, double time,
                         struct cs_error *error);

#endif
