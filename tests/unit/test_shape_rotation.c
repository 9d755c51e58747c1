/* The rotation of shape matching against closed forms, its own optimality and its symmetries.
 */
#include "../../plugins/shape_rotation.h"
#include "unit.h"

#include <math.h>

static double draw(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-52 - 1;
}

static void random_rotation(uint64_t *state, double r[9]) {
    double q[4], squared = 0;
    do {
        squared = 0;
        for (int i = 0; i < 4; i++) {
            q[i] = draw(state);
            squared += q[i] * q[i];
        }
    } while (squared < 0.1 || squared > 1);
    for (int i = 0; i < 4; i++)
        q[i] /= sqrt(squared);
    shape_rotation_of(q, r);
}

/* u diag(s) u^T */
static void stretch_along(const double u[9], const double s[3], double out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            out[3 * i + j] = 0;
            for (int k = 0; k < 3; k++)
                out[3 * i + j] += u[3 * i + k] * s[k] * u[3 * j + k];
        }
}

static double difference(const double a[9], const double b[9]) {
    double most = 0;
    for (int i = 0; i < 9; i++)
        most = fmax(most, fabs(a[i] - b[i]));
    return most;
}

static double inner(const double a[9], const double b[9]) {
    double sum = 0;
    for (int i = 0; i < 9; i++)
        sum += a[i] * b[i];
    return sum;
}

static void assert_rotation(const double r[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            ck_assert_double_eq_tol(r[3 * i] * r[3 * j] + r[3 * i + 1] * r[3 * j + 1] +
                                        r[3 * i + 2] * r[3 * j + 2],
                                    i == j, 1e-14);
    ck_assert_double_eq_tol(shape_determinant(r), 1, 1e-14);
}

static void rotation_of(const double a[9], double r[9]) {
    double last[4] = {0, 0, 0, 1};
    shape_rotation(a, 0, last, r);
}

/* a = r s with a known rotation and a known positive stretch: r comes back, however much it is
 * stretched and however small all is */
TEST(known_rotations_come_back) {
    static const double stretches[][3] = {{1, 1, 1},   {3, 1, 0.2},        {1, 1, 1e-3},
                                          {1e6, 1, 1}, {2e-9, 1e-9, 3e-9}, {5, 5, 0}};
    uint64_t state = 7;
    for (int k = 0; k < 200; k++)
        for (size_t s = 0; s < sizeof stretches / sizeof *stretches; s++) {
            double r[9], u[9], stretched[9], a[9], found[9];
            random_rotation(&state, r);
            random_rotation(&state, u);
            stretch_along(u, stretches[s], stretched);
            shape_product(r, stretched, a);
            rotation_of(a, found);
            assert_rotation(found);
            // what rounding of a makes of the weakest pair of axes
            const double *most = stretches[s];
            const double gap =
                fmin(fmin(most[0] + most[1], most[1] + most[2]), most[0] + most[2]);
            const double size = fmax(fmax(most[0], most[1]), most[2]);
            ck_assert_double_le(difference(found, r), 1e-14 * size / gap);
        }
}

/* u diag(s) w^T with proper u and w: a mirror image where the product of s is negative. The
 * rotation that makes the trace largest is u w^T all the same, as long as the negative one is
 * the smallest (Kabsch 1976). */
TEST(mirror_images_turn_their_least_axis_back) {
    static const double s[3] = {2, 1, -0.4};
    uint64_t state = 11;
    for (int k = 0; k < 200; k++) {
        double u[9], w[9], us[9], wt[9], a[9], expected[9], found[9];
        random_rotation(&state, u);
        random_rotation(&state, w);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                us[3 * i + j] = u[3 * i + j] * s[j];
                wt[3 * i + j] = w[3 * j + i];
            }
        shape_product(us, wt, a);
        shape_product(u, wt, expected);
        rotation_of(a, found);
        ck_assert_double_lt(shape_determinant(a), 0);
        assert_rotation(found);
        ck_assert_double_le(difference(found, expected), 1e-13);
    }
}

/* of any matrix, also of rank 1: no other rotation has a larger trace of r^T a */
TEST(no_other_rotation_is_nearer) {
    uint64_t state = 3;
    for (int k = 0; k < 200; k++) {
        double a[9], r[9];
        for (int i = 0; i < 9; i++)
            a[i] = draw(&state);
        if (k % 4 == 1)
            for (int i = 3; i < 9; i++)
                a[i] = a[i % 3] * (i < 6 ? 0.5 : -2);
        rotation_of(a, r);
        assert_rotation(r);
        for (int j = 0; j < 500; j++) {
            double other[9];
            random_rotation(&state, other);
            ck_assert_double_le(inner(other, a), inner(r, a) + 1e-12);
        }
    }
}

/* p a, with a rotation p, has the rotation p r */
TEST(turned_matrices_have_turned_rotations) {
    uint64_t state = 5;
    for (int k = 0; k < 200; k++) {
        double a[9], p[9], pa[9], r[9], pr[9], found[9];
        for (int i = 0; i < 9; i++)
            a[i] = draw(&state) + (i % 4 == 0 ? 2 : 0);
        random_rotation(&state, p);
        shape_product(p, a, pa);
        rotation_of(a, r);
        rotation_of(pa, found);
        shape_product(p, r, pr);
        ck_assert_double_le(difference(found, pr), 1e-12);
    }
}

/* A line leaves a turn about itself open, a point leaves all open: what is free stays as it
 * was. */
TEST(what_is_free_stays_as_it_was) {
    const double half = sqrt(0.5);
    const double quarter_z[4] = {0, 0, half, half};
    double last[4], r[9], before[9];
    // all at one point, or nearer to it than can be told
    static const double points[][9] = {{0}, {1e-16, 0, 0, 0, -1e-16}};
    shape_rotation_of(quarter_z, before);
    for (int k = 0; k < 2; k++) {
        memcpy(last, quarter_z, sizeof last);
        shape_rotation(points[k], 1, last, r);
        ck_assert_double_le(difference(r, before), 1e-15);
    }
    // a line along x that lies along x: a quarter turn about x stays
    const double along_x[9] = {1}, quarter_x[4] = {half, 0, 0, half};
    memcpy(last, quarter_x, sizeof last);
    shape_rotation_of(quarter_x, before);
    shape_rotation(along_x, 1, last, r);
    ck_assert_double_le(difference(r, before), 1e-15);
    // along y: x goes to y, and of such turns the nearest is about z alone
    const double along_y[9] = {0, 0, 0, 1};
    last[0] = last[1] = last[2] = 0, last[3] = 1;
    shape_rotation_of(quarter_z, before);
    shape_rotation(along_y, 1, last, r);
    ck_assert_double_le(difference(r, before), 1e-15);
}

TEST(pseudo_inverse_leaves_flat_directions_out) {
    static const double sizes[][3] = {{2, 3, 5}, {4, 1e-30, 9}, {0, 7, 0}, {0, 0, 0}};
    uint64_t state = 9;
    for (int k = 0; k < 4; k++) {
        double u[9], a[9], inverse[9], null[9], product[9], expected[3], projector[9];
        random_rotation(&state, u);
        stretch_along(u, sizes[k], a);
        shape_pseudo_inverse(a, inverse, null);
        shape_product(inverse, a, product);
        for (int i = 0; i < 3; i++)
            expected[i] = sizes[k][i] > 1e-20;
        stretch_along(u, expected, projector);
        ck_assert_double_le(difference(product, projector), 1e-13);
        for (int i = 0; i < 9; i++)
            product[i] += null[i] - (i % 4 == 0);
        ck_assert_double_le(difference(product, (double[9]){0}), 1e-13);
    }
}

/* b (b^T b)^-1 */
TEST(inverse_transposed_is_that) {
    uint64_t state = 13;
    double b[9], out[9], transposed[9], product[9];
    for (int i = 0; i < 9; i++)
        b[i] = draw(&state) + (i % 4 == 0 ? 2 : 0);
    ck_assert(shape_inverse_transposed(b, out));
    for (int i = 0; i < 9; i++)
        transposed[i] = out[3 * (i % 3) + i / 3];
    shape_product(transposed, b, product);
    for (int i = 0; i < 9; i++)
        ck_assert_double_eq_tol(product[i], i % 4 == 0, 1e-14);
    ck_assert(!shape_inverse_transposed((double[9]){1, 0, 0, 0, 1}, out));
}

TEST(cube_roots) {
    for (double root = 1e-5; root < 1e5; root *= 1.37)
        ck_assert_double_eq_tol(shape_cube_root(root * root * root) / root, 1, 1e-15);
    ck_assert_double_eq(shape_cube_root(1), 1);
    ck_assert_double_eq(shape_cube_root(0.125), 0.5);
}

/* what is none ends, and is none still */
TEST(no_numbers_stay_none) {
    double last[4] = {0, 0, 0, 1}, r[9];
    const double a[9] = {(double)NAN, 1, 2, 3, 4, 5, 6, 7, 8};
    shape_rotation(a, 1, last, r);
    ck_assert(!isfinite(r[0]));
}
