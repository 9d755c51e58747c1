/* viewpoint_forces.h - viewpoint forces: the particles that the events `viewpoint_force` act
 * on, and the times at which visibility is tested.
 *
 * A viewpoint force over an interval acts on the particles that its last visibility test
 * selected. Between two tests the selection stays the same, and the force is smooth. A test
 * with another result restarts the method, like every event. The times of tests are computed
 * one by one and not listed in events->times, because an interval may be long. A scene
 * without viewpoint forces has none of this. */
#ifndef CS_VIEWPOINT_FORCES_H
#define CS_VIEWPOINT_FORCES_H

#include "model/event/visibility.h"

/* One viewpoint force. */
struct cs_viewpoint_force_state {
    /* number of its event in the scene */
    uint32_t event;
    struct cs_visibility_query query;
    /* (n) the particles that the last test selected */
    bool *is_visible;
    /* between begin and end of its interval */
    bool active;
    /* tests since the begin, without the one there; test k is at begin + k / refresh */
    double n_tests;
    /* s, of the next test; HUGE_VAL: none */
    double next;
};

/* All viewpoint forces of a scene, in the system's arena. */
struct cs_viewpoint_forces {
    uint32_t n;
    struct cs_viewpoint_force_state *states; /* (n) in the scene's order */
    struct cs_visibility_scratch work;
    bool *work_marks; /* (n particles) work, the events' */
};

/* True if the scene has a viewpoint force. */
bool cs_viewpoint_forces_any(const struct cs_scene *scene);

/* Builds the viewpoint forces of a system whose events exist already. CS_ERR_MEMORY. */
enum cs_status cs_viewpoint_forces_build(struct cs_system *system, struct cs_error *error);

/* start: tests visibility at the begin of an event. One over an interval becomes active; one
 * at once adds force times duration to the momentum of each selected free particle. finish:
 * the force ends. */
void cs_viewpoint_force_start(struct cs_system *system, uint32_t event);
void cs_viewpoint_force_finish(struct cs_system *system, uint32_t event);

/* Repeats the visibility tests that are due at t. Returns true if one selects other particles
 * than before. */
bool cs_viewpoint_forces_retest(struct cs_system *system, double t);

/* Time in s of the next test of all; HUGE_VAL: none. */
double cs_viewpoint_forces_next(const struct cs_viewpoint_forces *viewpoint_forces);

/* push (3,n) += the acceleration in m/s2 of the selected free particles, by all active
 * forces. */
void cs_viewpoint_forces_add_push(const struct cs_system *system, double *push);

/* The greatest force in N on one particle: the sum of |force| of all active ones. */
double cs_viewpoint_forces_force(const struct cs_viewpoint_forces *viewpoint_forces,
                                 const struct cs_scene *scene);

/* The number of tests of a scene until t that lie between frames, where a method has to stop.
 */
uint32_t cs_viewpoint_forces_cuts(const struct cs_scene *scene, double t);

#endif
