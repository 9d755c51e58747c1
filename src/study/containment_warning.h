/* containment_warning.h - what starts wholly inside a closed surface that it keeps off. */
#ifndef CS_CONTAINMENT_WARNING_H
#define CS_CONTAINMENT_WARNING_H

#include "model/system/system.h"

/* Adds one line about the first body that starts inside a body or a mesh collider without a
 * border that it meets, and how many more such there are: contact holds apart what does not
 * cross, so that it keeps it there. Nothing where there is none. */
void cs_containment_warning_print(const struct cs_system *system, struct cs_text *out);

#endif
