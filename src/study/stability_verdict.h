/* stability_verdict.h - the verdict on a run that ended, and forces that no step can pass. */
#ifndef CS_STABILITY_VERDICT_H
#define CS_STABILITY_VERDICT_H

#include "session/energy_monitor.h"
#include "session/session.h"

/* Tells a singular force from a step that is too long, for a run that ended or was unstable
 * within so many seconds. dop853 runs the scene from its start with steps by their error. Where
 * another method's step is too long it goes on. Where a force has no bound its steps shrink
 * without end, or it blows up too, whatever step the other method takes. Sets *found, whose
 * text is empty if there is none, if dop853 refuses the scene, and after so many evaluations of
 * the forces and CS_SINGULAR_SECONDS nominal seconds. CS_ERR_MEMORY. */
#define CS_SINGULAR_SECONDS 0.01
struct cs_singular_force {
    char text[200];    /* "a force is singular at t = ... s, particle ...: no step passes" */
    double time;       /* s */
    uint32_t particle; /* of the greatest acceleration */
};
enum cs_status cs_singular_force_find(const struct cs_session_settings *settings,
                                      double seconds, double evaluations,
                                      struct cs_singular_force *found, struct cs_error *error);

/* Verdict on a run that ended so, and of which samples showed `seen`. */
enum cs_stability_verdict cs_stability_at_end(enum cs_outcome outcome,
                                              enum cs_stability_verdict seen);

#endif
