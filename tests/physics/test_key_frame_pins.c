/* Particles that are pinned or grabbed to colliders with key frames go with their surface. */
#include "key_frame_file.h"
#include "methods.h"

#include "base/vec3.h"
#include "model/contact/posed_collider.h"

#include <math.h>

/* Linear in p at each key, hence at all times by the splines: what lies on a face goes with the
 * four corners of any tetrahedron of vertices, whatever carries it. */
static void shear_and_swell(double t, const double p[3], double x[3]) {
    x[0] = (1 + 0.3 * sin(5 * t)) * p[0] + 0.2 * sin(9 * t) * p[1] + t * t;
    x[1] = p[1] * (1 + 0.2 * cos(7 * t)) - 0.1 * t * p[2];
    x[2] = p[2] * (1.1 - 0.3 * t) + 0.25 * sin(4 * t) * p[0] - 0.2 * t;
}

/* a sheet on the front of a box that key frames deform and an event turns about a hinge */
#define ON_A_BOX                                                                               \
    "{\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"size\": [0.7, 0.6], \"start\": \"flat\","  \
    " \"place\": {\"translate\": [0.02, 0.1, 0.85]}}, \"mass\": {\"particle\": 0.1},"          \
    " \"springs\": {\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": 0.01},"          \
    " \"pins\": [{\"at\": \"top\", \"to\": {\"collider\": 0}}]}], \"colliders\": [{\"mesh\":"  \
    " {\"shape\": \"box\", \"detail\": 3, \"key_frames\": {\"file\": \"swelling.npz\","        \
    " \"rate\": 24, \"end\": \"continue\"}}}], \"contact\": {\"law\": \"force\", "             \
    "\"stiffness\": 20}, \"crossings\": \"ignore\", \"events\": [%s]%s}"
#define BY_A_HINGE                                                                             \
    "{\"from\": 0.05, \"to\": 2, \"move\": {\"collider\": 0, \"spin\": [1, 2, 0.5],"           \
    " \"centre\": [0.4, 0.1, -0.7], \"path\": [{\"at\": 2, \"point\": [1, 0, 0.5]}]}}"

/* Position and velocity of a particle on the box by those of four vertices: its weights are
 * found at the start, by Cramer's rule. */
static void by_corners(const struct cs_posed_collider *start,
                       const struct cs_posed_collider *now, const double p[3], double x[3],
                       double v[3]) {
    static const uint32_t corners[4] = {0, 7, 12, 21};
    double at[4][3], edges[3][3], d[3], normals[3][3], weight[4] = {1};
    for (int k = 0; k < 4; k++)
        cs_posed_collider_vertex(start, corners[k], at[k], NULL);
    for (int c = 0; c < 3; c++) {
        d[c] = p[c] - at[0][c];
        for (int k = 0; k < 3; k++)
            edges[k][c] = at[k + 1][c] - at[0][c];
        x[c] = v[c] = 0;
    }
    for (int k = 0; k < 3; k++) {
        cs_vec3_cross(edges[(k + 1) % 3], edges[(k + 2) % 3], normals[k]);
        const double volume = cs_vec3_dot(edges[k], normals[k]);
        ck_assert_double_gt(fabs(volume), 0.01);
        weight[k + 1] = cs_vec3_dot(d, normals[k]) / volume;
        weight[0] -= weight[k + 1];
    }
    for (int k = 0; k < 4; k++) {
        double place[3], rate[3];
        cs_posed_collider_vertex(now, corners[k], place, rate);
        for (int c = 0; c < 3; c++) {
            x[c] += weight[k] * place[c];
            v[c] += weight[k] * rate[c];
        }
    }
}

static void check_on_box(const struct fixture *sheet, const struct cs_posed_collider *start,
                         const char *method, double t) {
    const size_t n = sheet->n;
    const double *from = sheet->system->start;
    struct cs_posed_collider now;
    cs_posed_collider_at(sheet->system, 0, t, &now);
    for (size_t i = 0; i < 4; i++) {
        double x[3], v[3];
        by_corners(start, &now, (const double[3]){from[i], from[n + i], from[2 * n + i]}, x, v);
        for (size_t c = 0; c < 3; c++)
            ck_assert_msg(fabs(sheet->x[c * n + i] - x[c]) < 1e-14 &&
                              fabs(sheet->v[c * n + i] - v[c]) < 2e-13,
                          "%s: %.17g at %.17g m/s at %g s, not %.17g at %.17g", method,
                          sheet->x[c * n + i], sheet->v[c * n + i], t, x[c], v[c]);
    }
}

/* At frames and between, with every method; alone and with an event that turns the box. */
TEST(pins_hold_to_key_frames) {
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "moves", .without = CS_EXPLICIT_OUTER | CS_NOT_GALILEAN});
    write_keys("swelling.npz", CS_MESH_BOX, 3, shear_and_swell, 9, 24);
    for (size_t m = 0; m < 2 * methods.n; m++) {
        const char *method = methods.list[m / 2].text;
        struct cs_posed_collider start;
        struct fixture sheet;
        fixture_open(&sheet, method, ON_A_BOX, m % 2 ? BY_A_HINGE : "",
                     ", \"time\": {\"fps\": 77}");
        cs_posed_collider_at(sheet.system, 0, 0, &start);
        fixture_start(&sheet);
        for (int frame = 0; frame < 12; frame++, fixture_frames(&sheet, 1))
            check_on_box(&sheet, &start, method, frame / 77.0);
        fixture_close(&sheet);
    }
}
