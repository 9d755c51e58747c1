/* eventful.h - the scenes to which tests add events. */
#ifndef CS_TEST_EVENTFUL_H
#define CS_TEST_EVENTFUL_H

#include "fixture.h"

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

#endif
