/* yardstick_choice.c - which two families of methods make the reference. */
#include "study/compare/yardstick.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Best first. %g stands for 2/omega, the longest stable step of the leap-frog. */
static const char *const one_step[] = {"ark-erk:order=8,rtol=1e-12,atol=1e-12",
                                       "ark-erk:rtol=1e-12,atol=1e-12",
                                       "dopri5:rtol=1e-12,atol=1e-12",
                                       "rk4:dt=@0.04",
                                       "velocity-verlet:dt=@0.01",
                                       NULL};
static const char *const other[] = {
    "cvode-adams:rtol=1e-12,atol=1e-12", "cvode-bdf:rtol=1e-11,atol=1e-11,max_order=5",
    "implicit-midpoint:dt=@0.02",        "tr-bdf2:dt=@0.02",
    "velocity-verlet:dt=@0.005",         NULL};
static const char *const *const families[2] = {one_step, other};

/* "dt=@0.04": that share of 2/omega */
static void fill_step(const char *pattern, double omega, char *out, size_t size) {
    const char *at = strchr(pattern, '@');
    struct cs_text number = {0};
    cs_text_add_real(&number, at ? 2 / omega * strtod(at + 1, NULL) : 0);
    snprintf(out, size, "%.*s%s", at ? (int)(at - pattern) : (int)strlen(pattern), pattern,
             at ? cs_text_get(&number) : "");
    cs_text_finish(&number);
}

static bool is_there(const struct cs_yardstick_settings *settings, const char *integrator) {
    struct cs_session session;
    struct cs_session_settings asked = settings->course->session;
    struct cs_error ignored = {0};
    asked.integrator = integrator;
    const bool there = !cs_session_open_plan(&session, &asked, &ignored);
    cs_session_close(&session);
    return there;
}

/* omega of the smooth scene, by a method that asks for nothing */
static enum cs_status measure_omega(const struct cs_yardstick_settings *settings, double *omega,
                                    struct cs_error *error) {
    struct cs_course course;
    if (!cs_course_open(&course, settings->course, "velocity-verlet", error))
        *omega = fmax(course.session.system.view.omega, 1);
    cs_course_close(&course);
    return error->status;
}

enum cs_status cs_yardstick_choose(const struct cs_yardstick_settings *settings,
                                   char chosen[2][256], struct cs_error *error) {
    double omega = 1;
    if (settings->methods[0] && settings->methods[1]) {
        for (int k = 0; k < 2; k++)
            snprintf(chosen[k], sizeof chosen[k], "%s", settings->methods[k]);
        return CS_OK;
    }
    if (measure_omega(settings, &omega, error))
        return error->status;
    for (int family = 0; family < 2; family++) {
        bool found = false;
        for (int k = 0; families[family][k] && !found; k++) {
            fill_step(families[family][k], omega, chosen[family], sizeof chosen[family]);
            const size_t name = strcspn(chosen[family], ":");
            // one method cannot stand for both families
            found = is_there(settings, chosen[family]) &&
                    (family == 0 || strncmp(chosen[0], chosen[1], name + 1) != 0);
        }
        if (!found)
            return cs_fail(error, CS_ERR_MODULE,
                           "no two families of methods are there for a reference");
    }
    return CS_OK;
}

static bool is_tightened(const char *option) {
    return !strncmp(option, "rtol=", 5) || !strncmp(option, "atol=", 5) ||
           !strncmp(option, "dt=", 3);
}

/* one "key=value" */
static void tighten(const char *option, struct cs_text *out) {
    const char *equals = strchr(option, '=');
    double value;
    if (!equals || !is_tightened(option) || !cs_parse_real(equals + 1, &value)) {
        cs_text_add(out, "%s", option);
        return;
    }
    cs_text_add(out, "%.*s", (int)(equals + 1 - option), option);
    if (*option == 'd')
        cs_text_add_real(out, value / 2);
    else // 1e-12 / 10 is to read 1e-13
        cs_text_add(out, "%.6g", value / 10);
}

void cs_yardstick_tighten(const char *integrator, char *out, size_t size) {
    char copy[256], *rest = copy, *token;
    struct cs_text text = {0};
    snprintf(copy, sizeof copy, "%s", integrator);
    cs_text_add(&text, "%s", strsep(&rest, ":"));
    for (int k = 0; (token = strsep(&rest, ",")); k++) {
        cs_text_add(&text, k ? "," : ":");
        tighten(token, &text);
    }
    snprintf(out, size, "%s", cs_text_get(&text));
    cs_text_finish(&text);
}
