/* scene.h - the small scenes that comparisons are tested on, in files of their own. */
#ifndef COMPARE_SCENE_H
#define COMPARE_SCENE_H

#include "../suite.h"
#include "study/compare/compare.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* A 6 x 6 sheet hung at two corners, moving smoothly; %s stands behind the damping. */
#define SMALL_SCENE                                                                            \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"velocity\": [0, 0, 0.5]},"                 \
    " \"mass\": {\"total\": 0.2}, \"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": 5,"  \
    " \"damping\": %s}, \"pins\": [\"top-left\", \"top-right\"]}],"                            \
    " \"time\": {\"fps\": 20}}"

static inline void scene_write(char path[64], const char *format, const char *value) {
    snprintf(path, 64, "scene-XXXXXX");
    const int descriptor = mkstemp(path);
    ck_assert_int_ge(descriptor, 0);
    FILE *file = fdopen(descriptor, "w");
    ck_assert_ptr_nonnull(file);
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    fprintf(file, format, value);
#pragma GCC diagnostic pop
    ck_assert_int_eq(fclose(file), 0);
}

#endif
