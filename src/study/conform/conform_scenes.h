/* conform_scenes.h - scenes in which one force acts alone, and scenes whose forces change with
 * time. */
#ifndef CS_CONFORM_SCENES_H
#define CS_CONFORM_SCENES_H

#include <stdbool.h>
#include <stdint.h>

/* One scene of a force check. */
struct cs_force_scene {
    const char *check;       /* of the card, that runs it */
    const char *description; /* for the note: the force and how it acts */
    const char *json;
    double rate; /* 1/s, of the fastest change: that of an oscillation or a decay, or the
                    inverse of the time over which a force builds up motion */
    bool depends_on_velocity; /* some force depends on the velocity: the order with damping
                                 holds */
    bool deforms; /* bodies change their shape: no scene for a method of another model */
};

/* Every scene runs CS_FORCE_FRAMES frames of CS_FORCE_FRAME, and has at most
 * CS_FORCE_PARTICLES particles. */
enum { CS_FORCE_FRAMES = 5, CS_FORCE_PARTICLES = 18, CS_FORCE_VALUES = 3 * CS_FORCE_PARTICLES };
#define CS_FORCE_FRAME 0.1 /* s */

/* The table of scenes (cs_n_force_scenes); several scenes can belong to one check. */
extern const struct cs_force_scene cs_force_scenes[];
extern const uint32_t cs_n_force_scenes;

#endif
