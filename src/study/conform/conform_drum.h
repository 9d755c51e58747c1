/* conform_drum.h - the drum: a stretched sheet in a frame, the scene on which orders show. */
#ifndef CS_CONFORM_DRUM_H
#define CS_CONFORM_DRUM_H

#include "study/conform/conform_probe.h"

enum { CS_DRUM_FRAMES = 3, CS_DRUM_PARTICLES = 49, CS_DRUM_VALUES = 3 * CS_DRUM_PARTICLES };
#define CS_DRUM_FRAME 0.1 /* s */
#define CS_DRUM_OMEGA 70  /* 1/s, near the bound on its frequencies */

struct cs_drum {
    double damping;         /* N s/m, axial */
    bool fixed_steps;       /* steps of dt, also of a method that can choose its own */
    bool has_velocity_jump; /* all velocities are turned and halved at the end of the first
                               frame */
    bool has_contact;       /* a plane behind it is in range all the time, with friction */
};

/* The longest step that orders are measured from: h w is a quarter. A whole part of a frame. */
double cs_drum_step(void);

/* Opens it; the accuracy is still to be set. */
bool cs_drum_open(struct cs_probe *probe, const struct cs_conform *card,
                  const struct cs_integrator *method, const struct cs_drum *drum);

/* Runs the card's method, or another one, to the end; level as in cs_drum_step / 2^level, or
 * the tolerance of an adaptive method. state: x then v. false: the row says why. */
bool cs_drum_state(const struct cs_conform *card, const struct cs_integrator *method,
                   const struct cs_drum *drum, double step_or_rtol, double *state,
                   struct cs_conform_row *row);

/* The reference at the end; scale: the root mean square of its move and of its speed. */
bool cs_drum_reference(const struct cs_conform *card, const struct cs_drum *drum, double *state,
                       double scale[2], struct cs_conform_row *row);

#endif
