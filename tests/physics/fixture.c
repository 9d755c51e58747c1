#include "fixture.h"

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
