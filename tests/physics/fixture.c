#include "fixture.h"

#include "model/contact/barrier_law.h"
#include "model/force/diagnostics.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void fixture_open(struct fixture *fixture, const char *integrator, const char *format, ...) {
    char *text;
    va_list args;
    va_start(args, format);
    ck_assert_int_ge(vasprintf(&text, format, args), 0);
    va_end(args);

    struct cs_error error = {0};
    struct cs_session *session = &fixture->session;
    const struct cs_session_settings settings = {
        .scene = "fixture", .text = text, .integrator = integrator};
    cs_session_open_system(session, &settings, &error);
    free(text);
    ck_assert_msg(!error.status, "%s", error.message);
    cs_method_step_by_frames(&session->method);
    fixture->system = &session->system;
    fixture->n = session->system.view.n;
    fixture->x = session->system.state;
    fixture->v = fixture->x + 3 * fixture->n;
}

void fixture_start(struct fixture *fixture) {
    struct cs_error error = {0};
    cs_session_begin(&fixture->session, NULL, &error);
    ck_assert_msg(!error.status, "%s", error.message);
}

static bool log_energies(void *ctx, double t, double dt, double *x, double *v) {
    struct fixture_log *log = ctx;
    const struct cs_energy energy = cs_diagnostics_energy(log->fixture->system, t, x, v);
    (void)dt;
    log->largest = fmax(log->largest, cs_energy_total(&energy));
    log->lowest_gravity = fmin(log->lowest_gravity, energy.gravity);
    return false;
}

void fixture_start_logged(struct fixture *fixture, struct fixture_log *log) {
    *log = (struct fixture_log){.fixture = fixture, .lowest_gravity = HUGE_VAL};
    fixture->session.settings.run.after_commit = log_energies;
    fixture->session.settings.run.ctx = log;
    fixture_start(fixture);
    log->first = log->largest = fixture_energy(fixture);
}

void fixture_frames(struct fixture *fixture, uint32_t frames) {
    struct cs_error error = {0};
    struct cs_run *run = &fixture->session.run;
    const char *method = fixture->session.method.integrator->name;
    for (uint32_t k = 0; k < frames; k++) {
        cs_run_frame(run, &error);
        ck_assert_msg(!error.status, "%s: %s", method, error.message);
        ck_assert_msg(run->outcome == CS_RUNNING, "%s: %s", method,
                      cs_outcome_text(run->outcome));
    }
}

const char *fixture_reason(struct fixture *fixture) {
    struct cs_run *run = &fixture->session.run;
    struct cs_error error = {0};
    const uint32_t frame = run->frame;
    ck_assert_msg(!cs_run_frame(run, &error), "%s", error.message);
    ck_assert_int_eq(run->outcome, CS_GAVE_UP);
    ck_assert_uint_eq(run->frame, frame);
    return run->reason;
}

void fixture_close(struct fixture *fixture) {
    cs_session_close(&fixture->session);
}

void fixture_momentum(const struct fixture *fixture, double p[3], double l[3]) {
    const size_t n = fixture->n;
    for (size_t c = 0; c < 3; c++) {
        const size_t d = (c + 1) % 3, e = (c + 2) % 3;
        p[c] = l[c] = 0;
        for (size_t i = 0; i < n; i++) {
            const double m = fixture->system->mass[i];
            p[c] += m * fixture->v[c * n + i];
            l[c] += m * (fixture->x[d * n + i] * fixture->v[e * n + i] -
                         fixture->x[e * n + i] * fixture->v[d * n + i]);
        }
    }
}

double fixture_energy(const struct fixture *fixture) {
    const struct cs_energy energy =
        cs_diagnostics_energy(fixture->system, fixture->session.run.t, fixture->x, fixture->v);
    return cs_energy_total(&energy);
}

void ck_bits(const double *a, const double *b, size_t n, const char *what) {
    for (size_t i = 0; i < n; i++)
        ck_assert_msg(!memcmp(a + i, b + i, sizeof *a), "%s: value %zu is %.17g and %.17g",
                      what, i, a[i], b[i]);
}

#define SLOPE                                                                                  \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"size\": [0.1, 0.1], \"start\": \"flat\","  \
    " \"place\": {\"translate\": [%.17g, %.17g, 0], \"rotate\": [0, 0, %.17g, %.17g]}},"       \
    " \"mass\": {\"total\": 0.1}, \"springs\": {\"stretch\": 1000, \"shear\": 500, \"bend\": " \
    "0, \"damping\": 1}}], \"colliders\": [{\"plane\": {\"point\": [0, 0, 0], \"normal\": "    \
    "[%.17g, %.17g, 0]}, \"thickness\": 0.02, \"friction\": 0.3}], \"contact\": {\"law\": "    \
    "\"force\", \"start\": \"allow\", %s, \"stiffness\": 1000, "                               \
    "\"damping\": 0.001}, \"events\": [%s]}"

void fixture_open_slope(struct fixture *block, const char *method, const char *friction,
                        double tangent, const char *events) {
    const double a = atan(tangent), n[2] = {sin(a), cos(a)};
    const double d = cs_barrier_loaded_distance(0.02, 1000, 0.025 * 9.81 * cos(a));
    fixture_open(block, method, SLOPE, n[0] * d, n[1] * d, -sin(a / 2), cos(a / 2), n[0], n[1],
                 friction, events);
    fixture_start(block);
}

double fixture_sliding(const struct fixture *block, double tangent) {
    const double a = atan(tangent);
    double sum = 0;
    for (size_t i = 0; i < block->n; i++)
        sum += cos(a) * block->v[i] - sin(a) * block->v[block->n + i];
    return sum / (double)block->n;
}
