/* sampling_warning.h - obstacles that are far finer than a mesh, in contact by force. */
#ifndef CS_SAMPLING_WARNING_H
#define CS_SAMPLING_WARNING_H

#include "model/system/system.h"

/* Adds one line about the first collider that can come in between the points of an edge
 * (model/contact/contact_samples.h), since it would take more of them than there may be, and
 * how many more such there are; nothing where there is none, or contact is no force. */
void cs_sampling_warning_print(const struct cs_system *system, struct cs_text *out);

#endif
