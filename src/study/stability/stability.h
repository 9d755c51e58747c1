/* stability.h - which steps a method survives: cells of dt against an axis of the scene, each
 * with a verdict; the border between, bisected; and linear theory's curves beside it. */
#ifndef CS_STABILITY_H
#define CS_STABILITY_H

#include "study/stability/stability_state.h"

/* Makes the map. CS_ERR_USAGE where the integrator has no fixed dt or the axis no meaning in
 * the scene. settings outlive the map; cs_stability_finish is to be called either way. */
enum cs_status cs_stability_run(struct cs_stability *map,
                                const struct cs_stability_settings *settings,
                                struct cs_error *error);
void cs_stability_finish(struct cs_stability *map);

#endif
