/* context.h - an OpenGL context without a window; each renderer module has one maker of it. */
#ifndef CS_DRAW_CONTEXT_H
#define CS_DRAW_CONTEXT_H

#include "base/status.h"

struct cs_context;

extern const char cs_context_name[]; /* "osmesa" or "egl" */

/* Makes a core context of at least 3.3 and makes it current. On failure CS_ERR_MODULE and
 * *context NULL. The driver must have been chosen before (cs_driver_pin). */
enum cs_status cs_context_create(struct cs_context **context, struct cs_error *error);
enum cs_status cs_context_use(struct cs_context *context, struct cs_error *error);

/* Address of a GL call; never NULL, even for a name that does not exist. */
void (*cs_context_proc(const char *name))(void);

/* Frees the context with everything that was made in it. NULL is fine. */
void cs_context_destroy(struct cs_context *context);

#endif
