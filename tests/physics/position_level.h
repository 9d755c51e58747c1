/* position_level.h - the position-level methods on CHOLMOD, which a build may lack. */
#ifndef POSITION_LEVEL_H
#define POSITION_LEVEL_H

#include "fixture.h"

#define LOCAL_GLOBAL "fast-mass-spring"
#define QUASI_NEWTON "projective-dynamics"

/* The method on CHOLMOD may be missing from a build. */
static inline bool is_built(const char *name) {
    struct cs_registry registry = {0};
    struct cs_error error = {0};
    const struct cs_registry_entry *found;
    const bool built = !cs_registry_find(&registry, name, &found, &error);
    ck_assert_msg(built || error.status == CS_ERR_USAGE, "%s", error.message);
    cs_registry_finish(&registry);
    return built;
}

#endif
