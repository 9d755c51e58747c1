/* Contact samples of edges that stretch: triangles that outgrow the samples of the start are
 * found, and contact.sample_stretch keeps them out, with every family of methods. */
#include "base/vec3.h"
#include "methods.h"
#include "model/contact/contact_samples.h"

#include <math.h>

/* A ball of 6 cm that goes through a sheet of weak springs. Its edges of 50 mm become 2.8 times
 * as long; without samples they may have 52 mm, and diagonals of 71 mm with one twice that. */
#define STRETCHED                                                                              \
    "{\"bodies\": [{\"cloth\": {\"grid\": [9, 9], \"size\": [0.4, 0.4], \"start\": \"flat\", " \
    "\"place\": {\"translate\": [0.013, 0.13, 0.017]}}, \"mass\": {\"areal_density\": 0.3}, "  \
    "\"pins\": [\"top\", \"bottom\"], \"springs\": {\"stretch\": 3, \"shear\": 1, \"bend\": "  \
    "0.01, \"damping\": 0.01}}], \"colliders\": [{\"sphere\": {\"centre\": [0, 0, 0], "        \
    "\"radius\": 0.06}}], \"contact\": {\"law\": \"force\", \"sample_stretch\": %g}, "         \
    "\"events\": [{\"at\": 0, \"move\": {\"collider\": 0, \"path\": [{\"at\": 0.5, "           \
    "\"point\": [0, 0.5, 0]}]}}]}"

/* m from the origin to the segment from a to b */
static double to_segment(const double a[3], const double b[3]) {
    double ab[3], p[3];
    for (int c = 0; c < 3; c++)
        ab[c] = b[c] - a[c];
    const double s = fmin(fmax(-cs_vec3_dot(a, ab) / cs_vec3_dot(ab, ab), 0), 1);
    for (int c = 0; c < 3; c++)
        p[c] = a[c] + s * ab[c];
    return sqrt(cs_vec3_dot(p, p));
}

/* m from the origin to a triangle: to its plane where the foot is inside, else to an edge */
static double to_triangle(double v[3][3]) {
    double ab[3], ac[3], n[3], least = HUGE_VAL;
    for (int c = 0; c < 3; c++)
        ab[c] = v[1][c] - v[0][c], ac[c] = v[2][c] - v[0][c];
    cs_vec3_cross(ab, ac, n);
    bool inside = true;
    for (int k = 0; k < 3; k++) {
        double m[3];
        cs_vec3_cross(v[k], v[(k + 1) % 3], m);
        inside = inside && cs_vec3_dot(m, n) >= 0;
        least = fmin(least, to_segment(v[k], v[(k + 1) % 3]));
    }
    return inside ? fabs(cs_vec3_dot(v[0], n)) / sqrt(cs_vec3_dot(n, n)) : least;
}

/* m, largest depth of the sheet's triangles in the ball, which is at t in s */
static double depth_in_ball(const struct fixture *sheet, double t) {
    double least = HUGE_VAL;
    for (uint32_t k = 0; k < cs_faces_count(sheet->system->bodies); k++) {
        uint32_t corners[3];
        double v[3][3];
        cs_face_corners(sheet->system->bodies, k, corners);
        for (size_t c = 0; c < 9; c++)
            v[c / 3][c % 3] = sheet->x[c % 3 * sheet->n + corners[c / 3]];
        for (int i = 0; i < 3; i++)
            v[i][1] -= fmin(t, 0.5);
        least = fmin(least, to_triangle(v));
    }
    return 0.06 - least;
}

/* Triangles that outgrow their samples are found, and samples for their stretch keep them out.
 */
TEST(stretched_edges_have_samples) {
    const struct methods methods =
        methods_find(&(struct methods_query){.test = "curtain",
                                             .without = CS_EXPLICIT_OUTER | CS_NOT_GALILEAN,
                                             .dt = 0.004,
                                             .dt_for = CS_IMPLICIT,
                                             .rtol = 1e-3});
    for (size_t m = 0; m < 2 * methods.n; m++) {
        const char *method = methods.list[m / 2].text;
        struct fixture sheet;
        double deepest = 0;
        fixture_open(&sheet, method, STRETCHED, m % 2 ? 3.1 : 1.0);
        fixture_start(&sheet);
        for (int frame = 1; frame <= 24; frame++) {
            fixture_frames(&sheet, 1);
            const double depth = depth_in_ball(&sheet, frame / 60.0);
            const struct cs_outgrown_samples gap =
                cs_contact_samples_find_outgrown(sheet.system, frame / 60.0, sheet.x);
            deepest = fmax(deepest, depth);
            ck_assert_msg(fabs(gap.depth - fmax(depth, 0)) < 0.5e-3 + 0.05 * fmax(depth, 0),
                          "%s: found %g of %g m", method, gap.depth, depth);
            ck_assert_msg(gap.depth == 0 || (gap.stretch > 1.04 && gap.stretch < 4),
                          "%s: stretched to %g", method, gap.stretch);
        }
        ck_assert_msg(m % 2 ? deepest <= 0 : deepest > 0.002, "%s, %s: %g m deep", method,
                      m % 2 ? "samples for 3.1" : "samples of the start", deepest);
        fixture_close(&sheet);
    }
}
