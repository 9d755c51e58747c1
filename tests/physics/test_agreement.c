/* Two methods that share nothing but the force come to the same end state.
 *
 * A cloth of 16 x 16 hangs by two corners for half a second. velocity-verlet at a step of 10 us
 * and cvode-bdf at a tolerance of 1e-11 err by less than 1e-8 m each, so that a wrong force
 * derivative, start, restart or frame time in either would show.
 */
#include "fixture.h"

#include <string.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [16, 16], \"start\": \"flat\"},"                     \
    " \"mass\": {\"total\": 0.2}, \"springs\": {\"stretch\": 50, \"shear\": 20, \"bend\": 8,"  \
    " \"damping\": 0.01, \"damping_model\": \"relative\"},"                                    \
    " \"pins\": [\"top-left\", \"top-right\"]}],"                                              \
    " \"forces\": {\"drag\": 1e-4}, \"time\": {\"fps\": 20}}"

enum { VALUES = 6 * 256 };

static void end_state(const char *integrator, double state[VALUES]) {
    struct fixture cloth;
    fixture_open(&cloth, integrator, SCENE);
    fixture_start(&cloth);
    fixture_frames(&cloth, 10);
    memcpy(state, cloth.x, VALUES * sizeof *state);
    fixture_close(&cloth);
}

TEST(verlet_and_cvode_agree) {
    static double verlet[VALUES], cvode[VALUES];
    end_state("velocity-verlet:dt=1e-5", verlet);
    end_state("cvode-bdf:rtol=1e-11,max_order=5,linear_rtol=1e-4", cvode);
    ck_assert_double_lt(cs_rms_difference(verlet, cvode, VALUES / 2), 1e-8);
    ck_assert_double_lt(cs_rms_difference(verlet + VALUES / 2, cvode + VALUES / 2, VALUES / 2),
                        1e-6);
}
