/* overlap_warning.h - bodies that overlap or could meet, and that no contact keeps apart. */
#ifndef CS_OVERLAP_WARNING_H
#define CS_OVERLAP_WARNING_H

#include "base/text.h"
#include "scene/scene.h"

/* Adds one line about the first pair, and how many more there are; nothing where no two bodies
 * come near each other. Boxes about the bodies at the start are compared, and about where each
 * can come to in that many seconds: a body that is free, along its fall; one that is pinned, no
 * further from its last pin than its particles are. A hint, which may be raised in vain: boxes
 * are larger than bodies. CS_ERR_MEMORY. */
enum cs_status cs_overlap_warning_print(const struct cs_scene *scene, double seconds,
                                        struct cs_text *out, struct cs_error *error);

#endif
