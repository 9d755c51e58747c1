/* Cloth that is sewn to a collider: led to its points in a closing time, exactly on them from
 * then on with every method, with the work told; an event lets it go. */
#include "key_frame_file.h"
#include "methods.h"

#include "model/contact/posed_collider.h"
#include "sim/run_state.h"

#include <math.h>
#include <string.h>

#define SHEET(where)                                                                           \
    "\"bodies\": [{\"cloth\": {\"grid\": [4, 4], \"size\": [0.6, 0.6], \"start\": \"flat\", "  \
    "\"place\": {\"translate\": [" where "]}}, \"mass\": {\"particle\": 0.1}, \"springs\": "   \
    "{\"stretch\": 40, \"shear\": 15, \"bend\": 5, \"damping\": 0.01}}]"
#define LOOSE "\"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}"
/* s; a frame is 1/60 s */
enum { CLOSED = 6 };

/* Part of the way at frame k: from rest to rest. */
static double part_at(int k) {
    const double u = fmin(k / (double)CLOSED, 1);
    return u * u * (3 - 2 * u);
}

/* Turns an arm about y by 3 rad/s until t. */
static void turned(const double arm[3], double t, double out[3]) {
    const double c = cos(3 * t), s = sin(3 * t);
    out[0] = c * arm[0] + s * arm[2];
    out[1] = arm[1];
    out[2] = -s * arm[0] + c * arm[2];
}

/* The upper edge goes to the nearest points of a sphere that rises and turns. */
TEST(nearest_points_of_a_turning_sphere) {
    const struct methods methods = methods_find(&(struct methods_query){
        .test = "moves", .without = CS_EXPLICIT_OUTER | CS_NOT_GALILEAN});
    const double centre[3] = {0.1, 0.9, 0.05}, radius = 0.2;
    for (size_t m = 0; m < methods.n; m++) {
        struct fixture sheet;
        fixture_open(
            &sheet, methods.list[m].text,
            "{" SHEET(
                "0, 0.5, 0") ", \"colliders\": [{\"sphere\": {\"centre\": [0.1, "
                             "0.9, 0.05], \"radius\": 0.2}}], \"contact\": {\"law\": "
                             "\"force\", "
                             "\"stiffness\": 20}, \"seams\": [{\"body\": 0, \"particles\": "
                             "[\"top\"], "
                             "\"to\": {\"collider\": 0}, \"closing_time\": 0.1}], \"events\": "
                             "[{\"from\": 0, \"to\": 9, \"move\": {\"collider\": 0, \"spin\": "
                             "[0, 3, "
                             "0], \"path\": [{\"at\": 9, \"point\": [0, 4.5, 0]}]}}]}");
        const double *start = sheet.system->start;
        const size_t n = sheet.n;
        fixture_start(&sheet);
        for (int k = 1; k < 3 * CLOSED; k++) {
            fixture_frames(&sheet, 1);
            for (size_t i = 0; i < 4; i++) {
                double arm[3], to[3], squared = 0;
                for (size_t c = 0; c < 3; c++) {
                    arm[c] = start[c * n + i] - centre[c];
                    squared += arm[c] * arm[c];
                }
                for (int c = 0; c < 3; c++)
                    arm[c] *= 1 + part_at(k) * (radius / sqrt(squared) - 1);
                turned(arm, k / 60.0, to);
                to[1] += 0.5 * k / 60;
                for (size_t c = 0; c < 3; c++)
                    ck_assert_msg(fabs(sheet.x[c * n + i] - centre[c] - to[c]) < 1e-12,
                                  "%s: frame %d", methods.list[m].text, k);
            }
        }
        fixture_close(&sheet);
    }
}

static void shear_and_swell(double t, const double p[3], double x[3]) {
    x[0] = (1 + 0.3 * sin(5 * t)) * p[0] + 0.2 * sin(9 * t) * p[1] + t * t;
    x[1] = p[1] * (1 + 0.2 * cos(7 * t)) - 0.1 * t * p[2];
    x[2] = p[2] * (1.1 - 0.3 * t) + 0.25 * sin(4 * t) * p[0] - 0.2 * t;
}

/* Particles of an edge go to vertices of a box with key frames, one to a point of a triangle of
 * it: they are there at all times after the closing. */
TEST(vertices_and_points_of_key_frames) {
    static const char *const by[] = {"rk4", "implicit-midpoint", "bdf2", "automatic"};
    static const uint32_t to[4] = {0, 49, 50, 51}, face[3] = {44, 45, 48};
    static const double weights[3] = {0.25, 0.25, 0.5};
    write_keys("sewn.npz", CS_MESH_BOX, 3, shear_and_swell, 9, 24);
    for (size_t m = 0; m < LENGTH(by); m++) {
        struct fixture sheet;
        fixture_open(
            &sheet, by[m],
            "{" SHEET("0, 0.1, 0.95") ", \"colliders\": [{\"mesh\": {\"shape\": \"box\", "
                                      "\"detail\": 3, \"key_frames\": {\"file\": \"sewn.npz\", "
                                      "\"rate\": 24, "
                                      "\"end\": \"continue\"}}}], \"contact\": {\"law\": "
                                      "\"force\", \"stiffness\": 20}, "
                                      "\"crossings\": \"ignore\", \"seams\": [{\"body\": 0, "
                                      "\"particles\": [1, 2, 3], "
                                      "\"to\": {\"collider\": 0, \"particles\": [49, 50, 51]}, "
                                      "\"closing_time\": 0.1}, "
                                      "{\"body\": 0, \"particles\": [0], \"to\": "
                                      "{\"collider\": 0, \"particles\": [44, "
                                      "45, 48], \"weights\": [0.25, 0.25, 0.5]}}]}");
        fixture_start(&sheet);
        for (int k = 0; k < 3 * CLOSED; k++, fixture_frames(&sheet, 1)) {
            struct cs_posed_collider now;
            double p[3], v[3], x[3] = {0};
            cs_posed_collider_at(sheet.system, 0, k / 60.0, &now);
            for (uint32_t i = 1; i < 4 && k >= CLOSED; i++) {
                cs_posed_collider_vertex(&now, to[i], p, v);
                for (size_t c = 0; c < 3; c++) {
                    ck_assert_double_eq_tol(sheet.x[c * sheet.n + i], p[c], 1e-12);
                    ck_assert_double_eq_tol(sheet.v[c * sheet.n + i], v[c], 1e-11);
                }
            }
            for (int j = 0; j < 3; j++) {
                cs_posed_collider_vertex(&now, face[j], p, NULL);
                for (int c = 0; c < 3; c++)
                    x[c] += weights[j] * p[c];
            }
            for (size_t c = 0; c < 3; c++)
                ck_assert_double_eq_tol(sheet.x[c * sheet.n], x[c], 1e-12);
        }
        fixture_close(&sheet);
    }
}

/* Nearest points of a box that is a mesh, as of one that is a shape: on faces, edges and
 * corners. */
TEST(nearest_points_of_a_mesh) {
    static const char *const boxes[] = {
        "{\"mesh\": {\"shape\": \"box\", \"scale\": [0.4, 0.2, 0.3]}}",
        "{\"box\": {\"centre\": [0, 0, 0], \"size\": [0.4, 0.2, 0.3], \"radius\": 1e-9}}"};
    struct fixture sheet[2];
    for (int k = 0; k < 2; k++) {
        fixture_open(&sheet[k], "rk4",
                     "{" SHEET("0, 0.3, 0.05") ", \"colliders\": [%s], \"crossings\": "
                                               "\"ignore\", \"seams\": [{\"body\": 0, "
                                               "\"particles\": [{\"box\": {\"min\": "
                                               "[-9, -9, -9], \"max\": [9, 9, 9]}}], \"to\": "
                                               "{\"collider\": 0}}]}",
                     boxes[k]);
        fixture_start(&sheet[k]);
        fixture_frames(&sheet[k], 2);
    }
    const size_t n = sheet[0].n;
    static const double half[3] = {0.2, 0.1, 0.15};
    for (size_t i = 0; i < 3 * n; i++) {
        const double from = sheet[0].system->start[i], most = half[i / n];
        const double nearest = fmin(fmax(from, -most), most);
        ck_assert_double_eq_tol(sheet[0].x[i], nearest, 1e-14);
        ck_assert_double_eq_tol(sheet[1].x[i], nearest, 1e-9);
    }
    fixture_close(&sheet[0]);
    fixture_close(&sheet[1]);
}

/* A sheet sinks by 0.3 m to a floor in 0.5 s, from rest to rest, and is lifted by 0.4 m with it
 * between 1 s and 2 s: what is given is the work against gravity, mass times g times height. */
TEST(work_is_that_of_lifting) {
    static const char *const by[] = {"rk4:dt=0.002", "implicit-midpoint:dt=0.002"};
    for (size_t m = 0; m < LENGTH(by); m++) {
        struct fixture sheet;
        fixture_open(
            &sheet, by[m],
            "{" SHEET(
                "0, 0.3, 0") ", \"colliders\": [{\"floor\": {\"height\": 0}}], "
                             "\"contact\": {\"law\": \"force\"}, \"seams\": [{\"body\": 0, "
                             "\"particles\": [{\"box\": {\"min\": [-9, -9, -9], \"max\": [9, "
                             "9, 9]}}], "
                             "\"to\": {\"collider\": 0}, \"closing_time\": 0.5}], \"events\": "
                             "[{\"from\": 1, \"to\": 2, \"move\": {\"collider\": 0, \"path\": "
                             "[{\"at\": "
                             "2, \"point\": [0, 0.4, 0]}]}}]}");
        const double *given = sheet.session.run.energy_input.given;
        const double weight = 16 * 0.1 * 9.81;
        fixture_start(&sheet);
        fixture_frames(&sheet, 50);
        ck_assert_double_eq_tol(sheet.x[16], 0, 1e-15);
        double sum = 0;
        for (int k = 0; k < CS_ENERGY_SOURCES; k++)
            sum += given[k];
        ck_assert_double_eq_tol(sum, -0.3 * weight, 1e-3 * weight);
        ck_assert(given[CS_SOURCE_UNTANGLE] == 0);
        fixture_frames(&sheet, 100);
        sum = 0;
        for (int k = 0; k < CS_ENERGY_SOURCES; k++)
            sum += given[k];
        ck_assert_double_eq_tol(sheet.x[16], 0.4, 1e-15);
        ck_assert_double_eq_tol(sum, 0.1 * weight, 2e-3 * weight);
        fixture_close(&sheet);
    }
}

/* An event opens the seam: loose particles fly on as the point of the collider went. */
TEST(opened_particles_fly) {
    struct fixture dust;
    fixture_open(
        &dust, "rk4",
        "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"place\": {\"translate\": [0, "
        "3, 0]}}, \"mass\": {\"particle\": 0.1}, " LOOSE "}], \"colliders\": "
        "[{\"sphere\": {\"centre\": [0, 0, 0], \"radius\": 0.5}}], \"contact\": {\"law\": "
        "\"project\"}, "
        "\"seams\": [{\"body\": 0, \"particles\": [0], \"to\": {\"collider\": 0}, "
        "\"closing_time\": 0.1}, {\"body\": 0, \"particles\": [1], \"to\": "
        "{\"collider\": 0}}], \"events\": [{\"from\": 0, \"to\": 0.5, \"move\": "
        "{\"collider\": 0, \"path\": [{\"at\": 0.5, \"point\": [0, 0, 2]}]}}, {\"at\": "
        "0.25, \"unsew\": {\"seam\": 0}}]}");
    fixture_start(&dust);
    fixture_frames(&dust, 15);
    double from[3];
    for (size_t c = 0; c < 3; c++)
        from[c] = dust.x[c * dust.n];
    ck_assert_uint_eq(dust.system->n_pinned, 2);
    fixture_frames(&dust, 6);
    ck_assert_uint_eq(dust.system->n_pinned, 1);
    ck_assert_double_eq_tol(dust.x[2 * dust.n], from[2] + 4 * 0.1, 1e-12);
    fixture_close(&dust);
}
