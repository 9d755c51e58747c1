/* body_pair_fixture.h - scenes of the folder in which surfaces meet, run by one method and
 * watched. */
#ifndef CS_PHYSICS_BODY_PAIR_FIXTURE_H
#define CS_PHYSICS_BODY_PAIR_FIXTURE_H

#include "session/session.h"

enum { MEETING_OVERRIDES = 10 };

/* A scene of the folder with some keys changed, and a method; NULL: the scene's own. */
struct meeting {
    const char *scene, *method;
    struct cs_override overrides[MEETING_OVERRIDES];
    uint32_t frames;
};

#define MEETING_GRID_OF(body, columns, rows)                                                   \
    { .path = "bodies[" #body "].cloth.grid", .value = "[" #columns "," #rows "]" }
#define MEETING_GRID(columns, rows) MEETING_GRID_OF(0, columns, rows)
#define MEETING_LIMIT                                                                          \
    { .path = "crossings", .value = "limit" }

/* The curtain of that scene, which pushes points out of a ball, against a ball of triangles, by
 * force. */
#define MEETING_BALL                                                                           \
    "[{\"mesh\": {\"shape\": \"sphere\", \"detail\": 6, \"scale\": [0.4, 0.4, 0.4], "          \
    "\"place\": {\"translate\": [0.05, -0.15, -0.45]}}, \"friction\": 0.3, \"thickness\": "    \
    "0.008}]"
#define MEETING_LAW "{\"law\": \"force\", \"damping\": 0.001, \"friction_speed\": 0.05}"
#define MEETING_CURTAIN                                                                        \
    {.path = "contact", .value = MEETING_LAW}, {.path = "colliders", .value = MEETING_BALL},   \
        {.path = "bodies[0].self_contact", .value = "true"}, MEETING_LIMIT

/* Opens it as far as its system, or up to its start; what fails there fails the test. */
void meeting_open_system(struct cs_session *session, const struct meeting *params);
void meeting_open(struct cs_session *session, const struct meeting *params);

/* One frame; an error or a blow-up fails the test. */
void meeting_frame(struct cs_session *session, const struct meeting *params);

/* Edges through triangles, as the run stands. */
uint64_t meeting_crossings(const struct cs_session *session);

#endif
