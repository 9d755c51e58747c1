/* near.h - a collider as a point in its range feels it. */
#ifndef CS_CONTACT_NEAR_H
#define CS_CONTACT_NEAR_H

#include "model/contact/obstacle.h"
#include "model/contact/pairing.h"
#include "model/contact/touch.h"

/* An obstacle as it is at one time, and how it rubs. */
struct cs_near {
    struct cs_obstacle pose;
    struct cs_pairing pairing;
    double mu, ev, tau; /* as in touch.h */
};

/* With contact by force. */
void cs_near_at(const struct cs_system *system, uint32_t collider, double t,
                struct cs_near *near);

/* How a point at p with velocity v (m, m/s) touches; false: it is out of range. */
bool cs_near_touches(const struct cs_near *near, const double p[3], const double v[3],
                     struct cs_touch *touch);

/* A move of a point and of its velocity as one against the obstacle, whose surface below the
 * point has another velocity after it where the obstacle turns. */
struct cs_touch_move cs_near_move(const struct cs_near *near, const double dp[3],
                                  const double dv[3]);

/* The parts of a force (enum cs_part) as factors. */
static inline struct cs_touch_parts cs_near_parts(uint32_t parts) {
    return (struct cs_touch_parts){.elastic = parts & CS_PART_POTENTIAL ? 1 : 0,
                                   .rubbing = parts & CS_PART_DISSIPATIVE ? 1 : 0};
}

#endif
