/* snapshot.h - one picture of a run. */
#ifndef CS_SNAPSHOT_H
#define CS_SNAPSHOT_H

#include "draw/render.h"
#include "study/session.h"

/* Draws the state of an open session's run, at the size that its scene says; the caller frees
 * image->rgb, also on failure. image->alpha is the caller's. Adds what drew it to renderer. */
enum cs_status cs_snapshot_draw(struct cs_session *session, enum cs_renderer_kind kind,
                                struct cs_image *image, struct cs_text *renderer,
                                struct cs_error *error);

#endif
