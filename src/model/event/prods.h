/* prods.h - forces from a viewpoint: what the events `prod` act on, and when they look anew.
 *
 * A prod over an interval acts on the particles that it saw at its last look. Between two looks
 * they stay the same, so that forces are smooth there; a look that sees other particles than
 * the one before makes the method start anew, like every event. Looks come one after the other
 * and are not listed: an interval may be long. A scene without prods has none of this.
 */
#ifndef CS_PRODS_H
#define CS_PRODS_H

#include "model/event/sight.h"

struct cs_prod_state {
    uint32_t event; /* number in the scene */
    struct cs_sight sight;
    bool *seen;   /* (n) particles at the last look */
    bool active;  /* between its two ends */
    double looks; /* how many there were in this interval */
    double next;  /* s, of the next one; HUGE_VAL: none */
};

struct cs_prods {
    uint32_t n;
    struct cs_prod_state *states; /* (n) in the scene's order */
    struct cs_sight_work work;
    bool *marks; /* (n particles) work, the events' */
};

bool cs_prods_any(const struct cs_scene *scene);

/* Bytes that the prods of a scene with n particles take. */
size_t cs_prods_bytes(const struct cs_scene *scene, uint32_t n);

/* Makes the prods of events that are there. CS_ERR_MEMORY. */
enum cs_status cs_prods_build(struct cs_system *system, struct cs_error *error);

/* An event begins now: it looks; over an interval it goes on to act, else each particle's
 * momentum changes by force times duration. The other: it ends. */
void cs_prod_start(struct cs_system *system, uint32_t event);
void cs_prod_finish(struct cs_system *system, uint32_t event);

/* Looks anew where it is time at t. true if any now sees others than before. */
bool cs_prods_look(struct cs_system *system, double t);

/* Time of the next look in s; HUGE_VAL: none. */
double cs_prods_next(const struct cs_prods *prods);

/* push (3,n) += acceleration in m/s2 of those that are seen and free. */
void cs_prods_add_push(const struct cs_system *system, double *push);

/* Force in N on a particle that is seen by all that are active, at most. */
double cs_prods_force(const struct cs_prods *prods, const struct cs_scene *scene);

/* Looks of a scene until t that are at no frame. */
uint32_t cs_prods_cuts(const struct cs_scene *scene, double t);

#endif
