/* The scenes in which conform lets forces act: each force of the program's list has one to
 * itself, each value that a ramp may change has a ramp, and the reference that methods are held
 * against is the closed form where there is one. */
#include "../suite.h"
#include "conform/conform_checks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct cs_conform conform = {.method = &cs_conform_reference};

static void open_scene(struct cs_probe *probe, const struct cs_force_scene *scene) {
    ck_assert_msg(cs_probe_open(probe, &conform, &cs_conform_reference, "%s", scene->json),
                  "%s: %s", scene->description, probe->error.message);
}

/* A new force needs a line in conform_scenes.c, of a check force-NAME, in which no other force
 * acts. */
TEST(every_force_has_a_scene_to_itself) {
    const char *const *keys;
    const char *name;
    for (uint32_t t = 0; (name = cs_system_force(t, &keys)); t++) {
        bool found = false;
        for (uint32_t k = 0; k < cs_n_force_scenes && !found; k++) {
            struct cs_probe probe;
            if (strncmp(cs_force_scenes[k].check, "force-", 6) != 0)
                continue;
            open_scene(&probe, cs_force_scenes + k);
            // what lies between particles has their contact beside it, out of its range, and
            // bending has a membrane
            const uint32_t beside =
                !strcmp(name, "contact samples") || !strcmp(name, "bending");
            const struct cs_plan_row *forces = probe.session.system.plan.forces;
            uint32_t acting = 0;
            for (uint32_t f = 0; f < CS_TERMS_MAX; f++)
                acting += forces[f].built;
            found = forces[t].built && acting == 1 + beside;
            cs_probe_close(&probe);
        }
        ck_assert_msg(found, "no scene of conform has the force \"%s\" and no other", name);
    }
}

/* whether a scene's text has a ramp of the key: "bodies.springs.bend" for
 * bodies[0].springs.bend, or with an element behind it, [1] */
static bool has_ramp(const char *json, const char *key) {
    static const char before[] = "\"ramp\": {\"key\": \"";
    while ((json = strstr(json, before))) {
        const char *rest = key;
        for (json += sizeof before - 1; *json != '"'; json++)
            if (*json == '[')
                json = strchr(json, ']');
            else if (*rest != *json)
                break;
            else
                rest++;
        if (*json == '"' && !*rest)
            return true;
    }
    return false;
}

TEST(every_ramp_has_a_scene) {
    const char *const *keys;
    for (uint32_t t = 0; cs_system_force(t, &keys); t++)
        for (; keys && *keys; keys++) {
            bool found = false;
            for (uint32_t k = 0; k < cs_n_force_scenes; k++)
                found |= !strcmp(cs_force_scenes[k].check, "time-dependence") &&
                         has_ramp(cs_force_scenes[k].json, *keys);
            ck_assert_msg(found, "no scene of time-dependence has a ramp of %s", *keys);
        }
}

/* The scene of that name, run by the reference, and where it began. */
static void run_scene(struct cs_probe *probe, const char *what, double *start) {
    uint32_t k = 0;
    while (k < cs_n_force_scenes && strcmp(cs_force_scenes[k].description, what) != 0)
        k++;
    ck_assert_msg(k < cs_n_force_scenes, "there is no scene \"%s\"", what);
    open_scene(probe, cs_force_scenes + k);
    ck_assert_uint_le(probe->n, CS_FORCE_PARTICLES);
    memcpy(start, probe->x, 6 * probe->n * sizeof *start);
    cs_probe_set_step(probe, CS_FORCE_FRAME / 1024);
    ck_assert_msg(cs_probe_run(probe, CS_FORCE_FRAMES), "%s", probe->error.message);
}

static const double T = CS_FORCE_FRAMES * CS_FORCE_FRAME;

/* v0 T + g T^2 / 2 */
TEST(gravity_is_the_closed_form) {
    static const double g[3] = {1, -9, 4};
    double start[2 * CS_FORCE_VALUES];
    struct cs_probe probe;
    run_scene(&probe, "gravity", start);
    for (size_t i = 0; i < 3 * probe.n; i++) {
        const double v0 = start[3 * probe.n + i], a = g[i / probe.n];
        ck_assert_double_eq_tol(probe.x[i], start[i] + v0 * T + a * T * T / 2, 1e-11);
        ck_assert_double_eq_tol(probe.v[i], v0 + a * T, 1e-11);
    }
    cs_probe_close(&probe);
}

/* v0 exp(-w T), by 0.4 N s/m on 0.1 kg; by area a quarter of a square metre has 1.6 Pa s/m */
TEST(drag_is_the_closed_form) {
    static const char *const scenes[] = {"drag of each particle", "drag by area"};
    const double w = 0.4 / 0.1;
    for (size_t k = 0; k < 2; k++) {
        double start[2 * CS_FORCE_VALUES];
        struct cs_probe probe;
        run_scene(&probe, scenes[k], start);
        for (size_t i = 0; i < 3 * probe.n; i++) {
            const double v0 = start[3 * probe.n + i];
            ck_assert_double_eq_tol(probe.v[i], v0 * exp(-w * T), 1e-11);
            ck_assert_double_eq_tol(probe.x[i], start[i] + v0 * (1 - exp(-w * T)) / w, 1e-11);
        }
        cs_probe_close(&probe);
    }
}

/* The first sheet lies in the xy plane: f = s w |w_z| with w = (1, 2, 3) / |(1, 2, 3)|; 2 Pa on
 * a quarter of a square metre are 0.5 N. */
TEST(wind_is_the_closed_form) {
    static const char *const scenes[] = {"wind on each particle", "wind by area"};
    static const double w[3] = {1, 2, 3};
    for (size_t k = 0; k < 2; k++) {
        double start[2 * CS_FORCE_VALUES];
        struct cs_probe probe;
        run_scene(&probe, scenes[k], start);
        for (size_t c = 0; c < 3; c++)
            for (size_t i = c * probe.n; i < c * probe.n + 4; i++) {
                const double v0 = start[3 * probe.n + i], a = 0.5 * w[c] * w[2] / 14 / 0.1;
                ck_assert_double_eq_tol(probe.x[i], start[i] + v0 * T + a * T * T / 2, 1e-11);
                ck_assert_double_eq_tol(probe.v[i], v0 + a * T, 1e-11);
            }
        cs_probe_close(&probe);
    }
}

/* An impulse of 1 kg m/s on one of two sheets of 0.4 kg: 2.5 m/s along its direction in the
 * end, at a constant acceleration over the time s, or at once at the time s. */
TEST(impacts_are_the_closed_form) {
    static const double d[3] = {1, -2, 1};
    for (size_t k = 0; k < 2; k++) {
        const bool steady = k == 0;
        const double s = steady ? 0.35 : 0.25;
        double start[2 * CS_FORCE_VALUES];
        struct cs_probe probe;
        run_scene(&probe, steady ? "a steady impact" : "an instantaneous impact", start);
        for (size_t i = 0; i < 3 * probe.n; i++) {
            const bool hit = (i % probe.n >= 4) == steady;
            const double v0 = start[3 * probe.n + i];
            const double gain = hit ? 2.5 * d[i / probe.n] / sqrt(6) : 0;
            const double moved = gain * (steady ? T - s / 2 : T - s);
            ck_assert_double_eq_tol(probe.v[i], v0 + gain, 1e-11);
            ck_assert_double_eq_tol(probe.x[i], start[i] + v0 * T + moved, 1e-11);
        }
        cs_probe_close(&probe);
    }
}

/* Both sheets are seen whole: 0.8 N on 0.1 kg along -z, for 0.35 s, or for 0.2 s at once. */
TEST(viewpoint_forces_are_the_closed_form) {
    for (size_t k = 0; k < 2; k++) {
        const bool steady = k == 0;
        const double gain = -8 * (steady ? 0.35 : 0.2);
        const double moved = gain * (steady ? T - 0.35 / 2 : T - 0.25);
        double start[2 * CS_FORCE_VALUES];
        struct cs_probe probe;
        run_scene(&probe,
                  steady ? "a steady viewpoint force" : "an instantaneous viewpoint force",
                  start);
        for (size_t i = 0; i < 3 * probe.n; i++) {
            const double v0 = start[3 * probe.n + i];
            const bool along = i / probe.n == 2;
            ck_assert_double_eq_tol(probe.v[i], v0 + (along ? gain : 0), 1e-11);
            ck_assert_double_eq_tol(probe.x[i], start[i] + v0 * T + (along ? moved : 0), 1e-11);
        }
        cs_probe_close(&probe);
    }
}

/* From -2 to -9 m/s2 between 0.05 and 0.45 s: three parts, one after the other. */
TEST(ramp_of_gravity_is_the_closed_form) {
    const double g0 = -2, g1 = -9, s = 0.05, length = 0.4, rest = T - s - length;
    double start[2 * CS_FORCE_VALUES];
    struct cs_probe probe;
    run_scene(&probe, "a ramp of gravity", start);
    for (size_t i = probe.n; i < 2 * probe.n; i++) {
        double v = start[3 * probe.n + i], x = start[i];
        x += v * s + g0 * s * s / 2;
        v += g0 * s;
        x += v * length + g0 * length * length / 2 + (g1 - g0) * length * length / 6;
        v += (g0 + g1) / 2 * length;
        x += v * rest + g1 * rest * rest / 2;
        v += g1 * rest;
        ck_assert_double_eq_tol(probe.x[i], x, 1e-11);
        ck_assert_double_eq_tol(probe.v[i], v, 1e-11);
    }
    cs_probe_close(&probe);
}
