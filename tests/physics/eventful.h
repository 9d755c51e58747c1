/* eventful.h - the scenes to which tests add events, and states held against each other. */
#ifndef CS_TEST_EVENTFUL_H
#define CS_TEST_EVENTFUL_H

#include "fixture.h"

#include <string.h>

/* a hanging cloth; %s: its events */
#define CLOTH                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 5]}, \"mass\": {\"particle\": 0.01},"            \
    " \"springs\": {\"stretch\": 40, \"damping\": 0.01}, \"pins\": [\"top\"]}],"               \
    " \"forces\": {\"drag\": 0.002}, \"events\": [%s]}"

/* free particles; %s: gravity, and the events */
#define DUST                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4]}, \"mass\": {\"areal_density\": 0.3},"        \
    " \"springs\": {\"stretch\": %s, \"shear\": 0, \"bend\": 0}}],"                            \
    " \"forces\": {\"gravity\": [0, 0, 0]}, \"events\": [%s]}"

static inline void ck_bits(const double *a, const double *b, size_t n, const char *what) {
    for (size_t i = 0; i < n; i++)
        ck_assert_msg(!memcmp(a + i, b + i, sizeof *a), "%s: value %zu is %.17g and %.17g",
                      what, i, a[i], b[i]);
}

#endif
