/* coarse.h - obstacles that are far finer than a mesh, in contact by force. */
#ifndef CS_COARSE_H
#define CS_COARSE_H

#include "model/system/system.h"

/* Adds one line about the first collider that can come in between the points of an edge
 * (model/cover/cover.h), since it would take more of them than there may be, and how many more
 * such there are; nothing where there is none, or contact is no force. */
void cs_coarse_print(const struct cs_system *system, struct cs_text *out);

#endif
