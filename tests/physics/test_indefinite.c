/* The exact Hessian of a pressed cloth is indefinite: the host falls back to the clamped one,
 * and counts it. */
#include "fixture.h"

/* two particles of 0.5 kg and k = 1 N/m; one frame of a second */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 1]}, \"mass\": {\"particle\": 0.5},"             \
    " \"springs\": {\"stretch\": 1}}], \"forces\": {\"gravity\": [0, 0, 0]},"                  \
    " \"time\": {\"fps\": 1}}"

/* The pair at `length`, moving apart across the spring at 0.1 m/s each, for one step. Returns
 * how often the set-up was clamped; *across is the speed that is left. */
static uint64_t step(const char *integrator, double length, double *across) {
    struct fixture pair;
    fixture_open(&pair, integrator, SCENE);
    pair.x[0] = -length / 2, pair.x[1] = length / 2;
    pair.v[2] = 0.1, pair.v[3] = -0.1;
    fixture_start(&pair);
    fixture_frames(&pair, 1);
    ck_assert_double_eq_tol(pair.v[2], -pair.v[3], 1e-12);
    const uint64_t clamped = pair.session.run.counts.clamped_setups;
    *across = pair.v[2];
    fixture_close(&pair);
    return clamped;
}

/* Across the spring the own block is m + h^2 k (1 - L/l), its eigenvalue apart m + 2 h^2 k (1 -
 * L/l): at l = 2 the matrix is definite, at l = 0.74 the iteration finds out, at 0.5 the
 * set-up. Clamped from the start there is no stiffness across, and the speed stays. */
TEST(indefinite_matrix_is_clamped_and_counted) {
    double across;
    ck_assert_uint_eq(step("implicit-linearised:hessian=exact,rtol=1e-12", 2, &across), 0);
    ck_assert_double_eq_tol(across, 0.1 * 0.5 / (0.5 + 2 * 0.5), 1e-12);
    ck_assert_uint_eq(step("implicit-linearised:hessian=exact,rtol=1e-12", 0.74, &across), 1);
    ck_assert_uint_eq(step("implicit-linearised:hessian=exact,rtol=1e-12", 0.5, &across), 1);
    ck_assert_double_eq_tol(across, 0.1, 1e-12);
    ck_assert_uint_eq(step("implicit-linearised:rtol=1e-12", 0.5, &across), 0);
    ck_assert_double_eq_tol(across, 0.1, 1e-12);
}
