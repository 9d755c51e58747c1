/* Contact by force knows relative motion alone: a sheet thrown at an obstacle moves as the
 * sheet at rest whose obstacle comes, in as many steps, by every method that claims so. */
#include "methods.h"

#include <math.h>
#include <stdio.h>

/* A sheet above an obstacle; %s: its velocity, the obstacle, the stiffness of contact, the
 * events */
#define SCENE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [5, 4], \"size\": [0.24, 0.18], \"start\": "         \
    "\"flat\", \"place\": {\"translate\": [0.01, 0.02, 0.004], \"rotate\": [0.02, 0.1, 0.01, " \
    "1]}, \"velocity\": [%s]}, \"mass\": {\"particle\": 0.002}, \"thickness\": 0.02,"          \
    " \"springs\": {\"stretch\": 50, \"shear\": 20, \"bend\": 1, \"damping\": 0.01}}],"        \
    " \"colliders\": [{%s, \"friction\": 0.3, \"thickness\": 0.02}],"                          \
    " \"contact\": {\"law\": \"force\", \"stiffness\": %g, \"damping\": 1e-4,"                 \
    " \"friction_speed\": 0.05}, \"events\": [%s]}"

#define MESH_BOX                                                                               \
    "\"mesh\": {\"shape\": \"box\", \"detail\": 3, \"scale\": [0.3, 0.1, 0.3], \"place\": "    \
    "{\"translate\": [0.01, -0.1, 0.02]}}"
#define MESH_BALL                                                                              \
    "\"mesh\": {\"shape\": \"sphere\", \"detail\": 3, \"scale\": [0.05, 0.05, 0.05], "         \
    "\"place\": "                                                                              \
    "{\"translate\": [0.02, -0.13, 0.01]}}"
static const char *const obstacles[] = {
    "\"floor\": {\"height\": -0.03}",
    "\"sphere\": {\"centre\": [0, -0.11, 0], \"radius\": 0.1}",
    "\"box\": {\"centre\": [0.02, -0.08, 0], \"size\": [0.2, 0.1, 0.2], \"radius\": 0.02}",
    "\"capsule\": {\"from\": [-0.06, -0.06, 0], \"to\": [0.08, -0.06, 0.02], \"radius\": 0.05}",
    MESH_BOX,
    MESH_BALL,
};

/* The sheet goes at sheet_velocity, the obstacle by way in a second; NULL: it stands still. */
static void start(struct fixture *sheet, const char *method, size_t obstacle, double stiffness,
                  const double sheet_velocity[3], const double way[3]) {
    char velocity[80], event[160] = "";
    snprintf(velocity, sizeof velocity, "%g, %g, %g", sheet_velocity[0], sheet_velocity[1],
             sheet_velocity[2]);
    if (way)
        snprintf(event, sizeof event,
                 "{\"at\": 0, \"move\": {\"collider\": 0, \"path\": [{\"at\": 1, \"point\": "
                 "[%g, %g, %g]}]}}",
                 way[0], way[1], way[2]);
    fixture_open(sheet, method, SCENE, velocity, obstacles[obstacle], stiffness, event);
    fixture_start(sheet);
}

enum { FRAMES = 5, FLOOR = 0, BALL = 5 };

/* The same sheet, thrown at -u and come to at u: they stay within 1e-7 m of each other, in as
 * many steps. */
static void compare(const char *method, size_t obstacle, double stiffness, const double u[3]) {
    struct fixture thrown, at_rest;
    const double back[3] = {-u[0], -u[1], -u[2]}, none[3] = {0};
    double most = 0;
    start(&thrown, method, obstacle, stiffness, back, NULL);
    start(&at_rest, method, obstacle, stiffness, none, u);
    for (uint32_t frame = 0; frame < FRAMES; frame++) {
        fixture_frames(&thrown, 1);
        fixture_frames(&at_rest, 1);
        const double t = at_rest.session.run.t;
        for (size_t c = 0; c < 3; c++)
            for (size_t i = 0; i < thrown.n; i++)
                most = fmax(most, fabs(at_rest.x[c * thrown.n + i] -
                                       (thrown.x[c * thrown.n + i] + u[c] * t)));
    }
    ck_assert_msg(most < 1e-7, "%s, obstacle %zu at %g m/s: %.3g m apart", method, obstacle,
                  u[1], most);
    ck_assert_uint_eq(thrown.session.run.counts.steps, at_rest.session.run.counts.steps);
    fixture_close(&thrown);
    fixture_close(&at_rest);
}

TEST(only_relative_motion_counts) {
    for (size_t o = 0; o < LENGTH(obstacles); o++) {
        // error control looks at velocities as they are
        const struct methods methods = methods_find(&(struct methods_query){
            .test = "relative",
            .without = CS_NOT_GALILEAN | CS_ADAPTIVE | CS_EXPLICIT_OUTER,
            .residual = 1e-12,
            .more =
                (const char *const[]){"implicit-linearised:rtol=1e-12,hessian=exact", NULL}});
        for (size_t m = 0; m < methods.n; m++) {
            compare(methods.list[m].text, o, 2e3, (double[3]){0.3, 1, -0.1});
            if (o == BALL)
                compare(methods.list[m].text, o, 1e4, (double[3]){-0.3, 4.3, 0.4});
            compare(methods.list[m].text, o, 4e4, (double[3]){0.5, 10, 0.2});
        }
    }
}

/* A floor that comes up from below at 1, 3 and 10 m/s: the sheet is above it in the end, and
 * moves no faster against it than it did. */
TEST(floor_that_rises_lifts) {
    static const double speeds[] = {1, 3, 10};
    static const char *const methods[] = {"implicit-linearised", "implicit-linearised:dt=0.004",
                                          "implicit-linearised:hessian=exact", "ros2"};
    for (size_t m = 0; m < LENGTH(methods); m++)
        for (size_t s = 0; s < LENGTH(speeds); s++) {
            const double u = speeds[s];
            struct fixture sheet;
            double kinetic = 0, mass = 0;
            start(&sheet, methods[m], FLOOR, 400 * u * u, (double[3]){0}, (double[3]){0, u, 0});
            fixture_frames(&sheet, FRAMES);
            const double floor = -0.03 + u * sheet.session.run.t;
            for (size_t i = 0; i < sheet.n; i++) {
                const double *v = sheet.v + i, up = v[sheet.n] - u;
                ck_assert_msg(sheet.x[sheet.n + i] > floor, "%s, %g m/s: %.3g m behind",
                              methods[m], u, floor - sheet.x[sheet.n + i]);
                kinetic += sheet.system->mass[i] / 2 *
                           (v[0] * v[0] + up * up + v[2 * sheet.n] * v[2 * sheet.n]);
                mass += sheet.system->mass[i];
            }
            // and what it fell
            const double before = mass * (u * u / 2 + 9.81 * 0.1);
            ck_assert_msg(kinetic < 1.05 * before, "%s, %g m/s: %.3g J, %.3g J before",
                          methods[m], u, kinetic, before);
            fixture_close(&sheet);
        }
}
