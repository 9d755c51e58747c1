/* meeting.h - scenes of the folder in which surfaces meet, run by one method and watched. */
#ifndef MEETING_H
#define MEETING_H

#include "study/session.h"

enum { MEETING_OVERRIDES = 6 };

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

/* Opens it as far as its system, or up to its start; what fails there fails the test. */
void meeting_open_system(struct cs_session *session, const struct meeting *meeting);
void meeting_open(struct cs_session *session, const struct meeting *meeting);

/* One frame; an error or a blow-up fails the test. */
void meeting_frame(struct cs_session *session, const struct meeting *meeting);

/* Edges through triangles, as the run stands. */
uint64_t meeting_crossings(const struct cs_session *session);

#endif
