/* conform_drum.h - the drum: a stretched sheet in a fixed frame, the scene that orders are
 * measured on.
 *
 * A method shows its order only where the force is smooth along the motion: here springs stay
 * stretched by about 5 % and contact, if any, stays in range. */
#ifndef CS_CONFORM_DRUM_H
#define CS_CONFORM_DRUM_H

#include "study/conform/conform_probe.h"

/* Size of the scene: 7 by 7 particles, with pinned edges. */
enum { CS_DRUM_FRAMES = 3, CS_DRUM_PARTICLES = 49, CS_DRUM_VALUES = 3 * CS_DRUM_PARTICLES };
#define CS_DRUM_FRAME 0.1 /* s */
#define CS_DRUM_OMEGA 70  /* 1/s, near the bound on its frequencies */

/* Variant of the drum. Zeroed: undamped, free, by the method's own choice of steps. */
struct cs_drum {
    double damping;         /* N s/m, axial */
    bool fixed_steps;       /* steps of a given length, also of a method that can choose its
                               own: by dt, or by frames of one step at its loosest tolerance */
    bool has_velocity_jump; /* all velocities are turned and halved at the end of the first
                               frame */
    bool has_contact;       /* a plane behind it is always in range, with friction */
};

/* Returns the longest step in s that orders are measured from: the largest whole part of a
 * frame with h CS_DRUM_OMEGA <= 1/4. */
double cs_drum_step(void);

/* Opens the scene; the accuracy must still be set. Returns false if it cannot be opened:
 * probe->error says why. cs_probe_close must be called in any case. */
bool cs_drum_open(struct cs_probe *probe, const struct cs_conform *card,
                  const struct cs_integrator *method, const struct cs_drum *drum);

/* Runs the given method, of the card or another one, over CS_DRUM_FRAMES. step_or_rtol: the
 * step in s, a whole part of a frame, or the tolerance of an adaptive method unless
 * drum->fixed_steps. state: (2, CS_DRUM_VALUES), positions then velocities at the end. Returns
 * false if the run ended early, or took more steps than the given length asks for: the row says
 * why. */
bool cs_drum_state(const struct cs_conform *card, const struct cs_integrator *method,
                   const struct cs_drum *drum, double step_or_rtol, double *state,
                   struct cs_conform_row *row);

/* Reference state at the end, from the cache or by a run. scale: root mean square of its
 * displacement (m) and of its change of velocity (m/s) since the start, which make errors
 * relative. Returns false if there is none: the row says why. */
bool cs_drum_reference(const struct cs_conform *card, const struct cs_drum *drum, double *state,
                       double scale[2], struct cs_conform_row *row);

#endif
