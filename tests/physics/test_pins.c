/* Pinned particles keep their place to the bit and have no velocity, with every method. */
#include "methods.h"

#include <string.h>

#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [8, 7], \"velocity\": [1, 0.5, -2],"                 \
    " \"place\": {\"translate\": [0.1, 0.7, 0.3]}},"                                           \
    " \"mass\": {\"particle\": 0.1}, \"springs\": {\"stretch\": 40, \"damping\": 0.05},"       \
    " \"strain_limit\": 1.2, \"pins\": [\"top-left\", \"right\", 25]}],"                       \
    " \"colliders\": [{\"sphere\": {\"centre\": [0.1, 0.7, 0.1], "                             \
    "\"radius\": 0.25},"                                                                       \
    " \"friction\": 0.3}], \"contact\": {\"law\": \"project\", \"start\": \"move-out\"},"      \
    " \"forces\": {\"drag\": 0.02, \"velocity_loss\": 0.001,"                                  \
    " \"wind\": {\"direction\": [1, 0, 1], \"strength\": 0.5, \"strength_unit\": \"N\"}}}"

enum { PINS = 9 };

TEST(pins_are_exact) {
    static const char *const more[] = {"position-verlet:loss=0.01",
                                       "implicit-linearised:hessian=exact", NULL};
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "pins", .more = more});
    for (size_t k = 0; k < methods.n; k++) {
        const char *method = methods.list[k].text;
        struct fixture cloth;
        fixture_open(&cloth, method, SCENE);
        double start[3 * 56];
        memcpy(start, cloth.x, sizeof start);
        fixture_start(&cloth);
        fixture_frames(&cloth, 30);
        size_t pinned = 0, moved = 0;
        for (size_t i = 0; i < 3 * cloth.n; i++)
            if (cloth.system->inv_mass[i % cloth.n] <= 0) {
                pinned++;
                ck_assert_msg(cloth.x[i] == start[i] && cloth.v[i] == 0,
                              "%s: pinned value %zu is %.17g (started at %.17g), speed %g",
                              method, i, cloth.x[i], start[i], cloth.v[i]);
            } else
                moved += cloth.x[i] != start[i];
        ck_assert_uint_eq(pinned, 3 * PINS);
        ck_assert_uint_eq(moved, 3 * (cloth.n - PINS));
        ck_assert_uint_gt(cloth.session.run.counts.projected_particles, 0);
        fixture_close(&cloth);
    }
}
