#include "study/session.h"

#include "base/options.h"
#include "base/pool.h"
#include "model/plan.h"
#include "model/system_build.h"
#include "scene/shape.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* one "key=value"; where names the place for messages */
static enum cs_status set_option(struct cs_session *session, const char *name,
                                 const char *value, const char *prefix, enum cs_status status,
                                 struct cs_error *error) {
    const struct cs_option *row = cs_option_find(&session->option_table, name);
    char where[160];
    snprintf(where, sizeof where, "%s%.60s", prefix, name);
    if (row)
        return cs_option_set(row, session->options, value, where, status, error);
    const char *nearest = cs_option_nearest(&session->option_table, name);
    return cs_fail(
        error, status,
        "%s: integrator \"%s\" has no such option%s%s%s (see: clothsim integrators %s)", where,
        session->integrator->name, nearest ? "; did you mean \"" : "", nearest ? nearest : "",
        nearest ? "\"?" : "", session->integrator->name);
}

/* "key=value,key=value" of --integrator */
static enum cs_status set_options_text(struct cs_session *session, const char *text,
                                       struct cs_error *error) {
    while (*text) {
        char pair[256];
        const size_t length = strcspn(text, ",");
        if (length >= sizeof pair)
            return cs_fail(error, CS_ERR_USAGE, "--integrator: \"%.60s...\" is too long", text);
        memcpy(pair, text, length);
        pair[length] = 0;
        char *equals = strchr(pair, '=');
        if (!equals)
            return cs_fail(error, CS_ERR_USAGE,
                           "--integrator: found \"%s\", expected key=value", pair);
        *equals = 0;
        if (set_option(session, pair, equals + 1, "--integrator ", CS_ERR_USAGE, error))
            return error->status;
        text += length + (text[length] == ',');
    }
    return CS_OK;
}

static enum cs_status set_options_scene(struct cs_session *session, struct cs_error *error) {
    const struct cs_setting *settings = session->scene.integrator_settings.items;
    for (uint32_t k = 0; k < session->scene.integrator_settings.n; k++) {
        char prefix[512];
        snprintf(prefix, sizeof prefix, "%s: integrator.", session->scene.path);
        if (set_option(session, settings[k].name, settings[k].value, prefix, CS_ERR_SCENE,
                       error))
            return error->status;
    }
    return CS_OK;
}

/* finds the method and fills its options: the scene's own only where the scene names it */
static enum cs_status choose_integrator(struct cs_session *session, const char *asked,
                                        struct cs_error *error) {
    char name[64];
    const size_t length = asked ? strcspn(asked, ":") : strlen(session->scene.integrator);
    if (length == 0 || length >= sizeof name)
        return cs_fail(error, CS_ERR_USAGE,
                       "--integrator: found \"%.60s\", expected NAME or NAME:key=value,...",
                       asked ? asked : "");
    memcpy(name, asked ? asked : session->scene.integrator, length);
    name[length] = 0;

    const struct cs_registered *found;
    struct cs_error missing = {0};
    if (cs_registry_find(&session->registry, name, &found, &missing)) {
        const bool by_scene = !asked && missing.status == CS_ERR_USAGE;
        return cs_fail(error, by_scene ? CS_ERR_SCENE : missing.status, "%s%s%s",
                       by_scene ? session->scene.path : "", by_scene ? ": integrator: " : "",
                       missing.message);
    }
    session->integrator = found->integrator;
    session->option_table = (struct cs_table){.rows = found->integrator->options,
                                              .n = found->integrator->n_options,
                                              .size = found->integrator->options_size};
    session->options = calloc(1, session->option_table.size + 1);
    if (!session->options)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory");
    cs_options_default(&session->option_table, session->options);
    if (!strcmp(name, session->scene.integrator) && set_options_scene(session, error))
        return error->status;
    if (asked && asked[length] == ':')
        return set_options_text(session, asked + length + 1, error);
    return CS_OK;
}

/* what the scene asks of a method, and only some can do */
static enum cs_status check_method(const struct cs_session *session, bool render,
                                   struct cs_error *error) {
    const struct cs_integrator *method = session->integrator;
    struct cs_error said = {0};
    if (cs_plan_check(&session->scene, method->name, method->needs, &said))
        return cs_fail(error, said.status, "%s: %s", session->scene.path, said.message);
    if (render && session->scene.render.look == CS_LOOK_GOALS && !cs_run_has_goals(method))
        return cs_fail(error, CS_ERR_SCENE,
                       "%s: render.look: integrator \"%s\" has no goals that could be drawn",
                       session->scene.path, method->name);
    return CS_OK;
}

/* before the plan, which says what they take */
static enum cs_status start_threads(struct cs_session *session, uint32_t threads,
                                    struct cs_error *error) {
    size_t n = 0;
    if (!threads)
        return CS_OK;
    for (uint32_t b = 0; b < session->scene.bodies.n; b++)
        n += (size_t)cs_shape_count(cs_scene_bodies(&session->scene) + b);
    const bool chosen = threads == CS_THREADS_AUTO;
    struct cs_error refused = {0};
    if (chosen)
        threads = n < CS_THREADS_AUTO_LEAST ? 1 : cs_pool_processors(CS_THREADS_AUTO_MOST);
    session->pooled = !cs_pool_start(threads, &refused);
    /* one thread gives the same bits: a failure only where more were asked for */
    return session->pooled || chosen ? CS_OK
                                     : cs_fail(error, refused.status, "%s", refused.message);
}

static enum cs_status open_plan(struct cs_session *session,
                                const struct cs_session_settings *settings,
                                struct cs_error *error) {
    *session = (struct cs_session){0};
    if (cs_scene_read(&session->scene, settings->scene, settings->overrides,
                      settings->n_overrides, error))
        return error->status;
    for (uint32_t k = 0; k < settings->n_plugins; k++)
        if (cs_registry_add_file(&session->registry, settings->plugins[k], error))
            return error->status;
    if (choose_integrator(session, settings->integrator, error) ||
        check_method(session, settings->render, error) ||
        start_threads(session, settings->threads, error))
        return error->status;
    cs_plan_make(&session->plan, &session->scene, session->integrator->needs, settings->render);
    return CS_OK;
}

enum cs_status cs_session_open_plan(struct cs_session *session,
                                    const struct cs_session_settings *settings,
                                    struct cs_error *error) {
    if (open_plan(session, settings, error))
        cs_session_close(session);
    return error->status;
}

enum cs_status cs_session_open(struct cs_session *session,
                               const struct cs_session_settings *settings,
                               struct cs_error *error) {
    if (open_plan(session, settings, error) ||
        cs_system_build(&session->system, &session->scene, &session->plan, error) ||
        cs_run_begin(&session->run, &session->system, session->integrator, session->options,
                     settings->timed, settings->stop, error))
        cs_session_close(session);
    return error->status;
}

void cs_session_close(struct cs_session *session) {
    cs_run_finish(&session->run);
    cs_system_finish(&session->system);
    cs_registry_finish(&session->registry);
    cs_scene_finish(&session->scene);
    free(session->options);
    if (session->pooled)
        cs_pool_stop();
    *session = (struct cs_session){0};
}
