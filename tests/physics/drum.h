/* drum.h - the clean test scene: a prestretched sheet in a frame, with a bump; as
 * scenes/drum.json, of any grid. Nothing in it is slack, so that the motion is smooth. */
#ifndef DRUM_H
#define DRUM_H

/* %d, %d: grid; %g: damping in N s/m; %d: frames a second */
#define DRUM                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [%d, %d], \"start\": \"flat\","                      \
    " \"stretch\": [1.05, 1.05], \"bump\": 0.08}, \"mass\": {\"total\": 0.2},"                 \
    " \"springs\": {\"stretch\": 100, \"shear\": 29.333333333333332,"                          \
    " \"bend\": 10.666666666666666, \"damping\": %g}, \"pins\": [\"edges\"]}],"                \
    " \"time\": {\"fps\": %d}}"

#endif
