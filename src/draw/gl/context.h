/* context.h - an OpenGL context without a window. */
#ifndef CS_DRAW_CONTEXT_H
#define CS_DRAW_CONTEXT_H

#include "base/status.h"

struct cs_context;

/* Makes a core context of version 3.3 or later, and makes it current. On failure CS_ERR_MODULE
 * or CS_ERR_MEMORY, and *context is NULL. Call cs_driver_pin before. */
enum cs_status cs_context_create(struct cs_context **context, struct cs_error *error);
/* Makes the context current in the calling thread. CS_ERR_MODULE. */
enum cs_status cs_context_use(struct cs_context *context, struct cs_error *error);

/* Address of an OpenGL call; not NULL even for a name that does not exist, so it proves
 * nothing. */
void (*cs_context_proc(const char *name))(void);

/* Frees the context with all objects that were made in it. NULL is fine. */
void cs_context_destroy(struct cs_context *context);

#endif
