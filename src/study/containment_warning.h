/* containment_warning.h - warns of bodies that start inside a closed surface they collide with.
 */
#ifndef CS_CONTAINMENT_WARNING_H
#define CS_CONTAINMENT_WARNING_H

#include "model/system/system.h"

/* Adds one line about the first body inside a closed body or mesh collider that it collides
 * with, and how many more there are; nothing if there is none. Contact prevents crossing, hence
 * such a body cannot get out. */
void cs_containment_warning_print(const struct cs_system *system, struct cs_text *out);

#endif
