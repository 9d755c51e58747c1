/* sampling_warning.h - warns of colliders that are too small for the contact samples of a mesh.
 */
#ifndef CS_SAMPLING_WARNING_H
#define CS_SAMPLING_WARNING_H

#include "model/system/system.h"

/* Adds one line about the first collider that can enter between the samples of the longest edge
 * (model/contact/contact_samples.h), and how many more there are. Nothing if there is none, or
 * without contact by force. */
void cs_sampling_warning_print(const struct cs_system *system, struct cs_text *out);

#endif
