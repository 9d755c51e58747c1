/* viewpoint_forces.h - viewpoint forces: what the events `viewpoint_force` act on, and when
 * visibility is tested.
 *
 * A viewpoint force over an interval acts on the particles that its last visibility test has
 * selected. Between two tests they stay the same, so that forces are smooth there; a test that
 * selects other particles than the one before restarts the method, like every event. The times
 * of tests are not listed, as an interval may be long. A scene without viewpoint forces has
 * none of this.
 */
#ifndef CS_VIEWPOINT_FORCES_H
#define CS_VIEWPOINT_FORCES_H

#include "model/event/visibility.h"

struct cs_viewpoint_force_state {
    uint32_t event; /* number in the scene */
    struct cs_visibility_query query;
    bool *is_visible; /* (n) particles at the last test */
    bool active;      /* between its two ends */
    double n_tests;   /* tests so far in this interval */
    double next;      /* s, of the next test; HUGE_VAL: none */
};

struct cs_viewpoint_forces {
    uint32_t n;
    struct cs_viewpoint_force_state *states; /* (n) in the scene's order */
    struct cs_visibility_scratch work;
    bool *work_marks; /* (n particles) work, the events' */
};

bool cs_viewpoint_forces_any(const struct cs_scene *scene);

/* Makes the viewpoint forces of events that are built. CS_ERR_MEMORY. */
enum cs_status cs_viewpoint_forces_build(struct cs_system *system, struct cs_error *error);

/* An event begins now: visibility is tested; over an interval it goes on to act, else the
 * momentum of each particle changes by force times duration. The other: it ends. */
void cs_viewpoint_force_start(struct cs_system *system, uint32_t event);
void cs_viewpoint_force_finish(struct cs_system *system, uint32_t event);

/* Tests visibility where it is time at t. true if any now sees others than before. */
bool cs_viewpoint_forces_retest(struct cs_system *system, double t);

/* Time of the next test in s; HUGE_VAL: none. */
double cs_viewpoint_forces_next(const struct cs_viewpoint_forces *viewpoint_forces);

/* push (3,n) += acceleration in m/s2 of those that are seen and free. */
void cs_viewpoint_forces_add_push(const struct cs_system *system, double *push);

/* Force in N on a particle that is seen by all that are active, at most. */
double cs_viewpoint_forces_force(const struct cs_viewpoint_forces *viewpoint_forces,
                                 const struct cs_scene *scene);

/* Tests of a scene until t that are at no frame. */
uint32_t cs_viewpoint_forces_cuts(const struct cs_scene *scene, double t);

#endif
