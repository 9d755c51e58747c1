/* Takes a scene to a running method: the only path, for every command and study. */
#include "session/session.h"

#include "base/arena.h"
#include "base/install_paths.h"
#include "base/options.h"
#include "base/pool.h"
#include "model/contact/collider_params.h"
#include "scene/body_keys.h"
#include "scene/body_particles.h"
#include "scene/picture_keys.h"
#include "session/perturb.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Fails with a message about the scene, at the place in its file that the message names. */
static enum cs_status fail_at(const struct cs_session *session, enum cs_status status,
                              const char *message, struct cs_error *error) {
    return cs_scene_refuse(session->scene, session->settings.overrides,
                           session->settings.n_overrides, status, message, error);
}

/* Reads the scene with its overrides, from the text or from a path that may name an installed
 * one. */
static enum cs_status read_scene(struct cs_session *session, struct cs_error *error) {
    const struct cs_session_settings *settings = &session->settings;
    char found[CS_DATA_PATH_MAX];
    if (settings->text)
        return cs_scene_read_text(session->scene, settings->scene, settings->text,
                                  strlen(settings->text), settings->overrides,
                                  settings->n_overrides, error);
    const char *path = cs_scene_find(settings->scene, found, sizeof found);
    cs_scene_read(session->scene, path, settings->overrides, settings->n_overrides, error);
    if (error->status != CS_ERR_FILE || access(path, F_OK) == 0 || !strcmp(path, "-"))
        return error->status;
    // a name that is nearly right
    cs_scene_nearest(path, found, sizeof found);
    const size_t said = strlen(error->message);
    if (*found)
        snprintf(error->message + said, sizeof error->message - said,
                 "; did you mean \"%.200s\"?", found);
    return error->status;
}

/* Refuses a number or a switch in quotes. */
static enum cs_status check_quotes(const struct cs_method *method,
                                   const struct cs_setting *option, struct cs_error *error) {
    const struct cs_option *row = cs_option_find(&method->table, option->name);
    if (!option->is_text || !row || row->type == CS_CHOICE ||
        (row->choices && !strcmp(option->value, row->choices[0])))
        return CS_OK;
    return cs_fail(error, CS_ERR_SCENE, "%s%s: found the text \"%.60s\", expected %s",
                   option->place, option->name, option->value,
                   row->type == CS_BOOL ? "true or false" : "a number");
}

/* Sets the method's options from the scene. Conflicts are only checked if all options are the
 * scene's: an option that the command line makes idle is no mistake. */
static enum cs_status set_options_of_scene(struct cs_session *session, const char *pairs,
                                           struct cs_error *error) {
    const struct cs_setting *options = session->scene->integrator_settings.items;
    struct cs_error said = {0};
    for (uint32_t k = 0; k < session->scene->integrator_settings.n; k++)
        if (check_quotes(&session->method, options + k, error) ||
            cs_method_set(&session->method, options[k].name, options[k].value, options[k].place,
                          CS_ERR_SCENE, error))
            return error->status;
    // what the command line gives may make an option of the scene idle: that is no mistake
    if (pairs || session->settings.has_all_values)
        session->method.given = 0;
    return cs_method_check(&session->method, "integrator.", CS_ERR_SCENE, &said)
               ? fail_at(session, said.status, said.message, error)
               : CS_OK;
}

/* The methods of "automatic", by error control of a hundredth of the scene's size or less, and
 * the rates in 1/s from which the implicit one is cheaper: with contact its steps are as short
 * as those of the explicit one. From table "default method" of docs/guide.md. */
#define EXPLICIT_METHOD "dopri5:rtol=1e-4"
#define IMPLICIT_METHOD "esdirk:rtol=0.01"
#define RATE_FREE       6e3
#define RATE_IN_CONTACT 1e5
#define SHAPES_METHOD   "shape-matching"

/* Finds a method by a name of the program itself. */
static enum cs_status take_method(struct cs_session *session, const char *name,
                                  struct cs_error *error) {
    const char *pairs = NULL;
    cs_method_finish(&session->method);
    return cs_method_find(&session->method, &session->registry, name, &pairs, error)
               ? error->status
               : cs_method_set_pairs(&session->method, pairs, error);
}

/* Finds the requested method, or the scene's own. The scene's options apply if the scene names
 * the same method. */
static enum cs_status read_method(struct cs_session *session, struct cs_error *error) {
    const struct cs_scene *scene = session->scene;
    const char *asked = session->settings.integrator, *pairs = NULL;
    struct cs_method *method = &session->method;
    struct cs_error missing = {0};
    const struct cs_setting *idle = scene->integrator_settings.items;
    session->is_automatic = !strcmp(asked ? asked : scene->integrator, CS_INTEGRATOR_DEFAULT);
    if (session->is_automatic && !asked && idle)
        return cs_fail(error, CS_ERR_SCENE,
                       "%s%s: the default method takes no options, expected a \"name\" (see: "
                       "clothsim integrators)",
                       idle->place, idle->name);
    if (session->is_automatic)
        return take_method(session,
                           cs_scene_first_matched(scene) < scene->bodies.n ? SHAPES_METHOD
                                                                           : EXPLICIT_METHOD,
                           error);
    if (cs_method_find(method, &session->registry, asked ? asked : scene->integrator, &pairs,
                       &missing)) {
        char message[sizeof missing.message + 16];
        if (asked || missing.status != CS_ERR_USAGE)
            return cs_fail(error, missing.status, "%s", missing.message);
        // with the key, by which its place is found
        snprintf(message, sizeof message, "integrator: %s", missing.message);
        return fail_at(session, CS_ERR_SCENE, message, error);
    }
    if (!strcmp(method->integrator->name, scene->integrator) &&
        set_options_of_scene(session, pairs, error))
        return error->status;
    return cs_method_set_pairs(method, pairs, error);
}

/* The scene is printed and hashed with the method that runs it. */
static void name_method(struct cs_session *session) {
    snprintf(session->scene->integrator, sizeof session->scene->integrator, "%s",
             session->method.integrator->name);
    session->scene->integrator_settings.n = 0;
}

/* Method, options and dt of the session, in this order of precedence: given integrator, command
 * line, scene. The scene then carries the method that runs it, for hashes and prints. */
static enum cs_status choose_method(struct cs_session *session, struct cs_error *error) {
    const struct cs_session_settings *settings = &session->settings;
    if (cs_registry_add_files(&session->registry, settings->plugins, settings->n_plugins,
                              error))
        return error->status;
    if (settings->method)
        cs_method_init(&session->method, settings->method, settings->options, error);
    else
        read_method(session, error);
    if (error->status)
        return error->status;
    name_method(session);
    if (settings->dt > 0 && !cs_method_set_dt(&session->method, settings->dt))
        cs_fail(error, CS_ERR_USAGE, "integrator \"%s\" takes no dt of %g s",
                session->method.integrator->name, settings->dt);
    return error->status;
}

/* Chooses the law of contact by the method, and checks what only some methods can follow. */
static enum cs_status check_method(struct cs_session *session, struct cs_error *error) {
    const struct cs_integrator *method = session->method.integrator;
    const bool render = session->settings.render;
    struct cs_error said = {0};
    cs_plan_choose_contact_law(session->scene, method);
    if (!session->settings.method && cs_plan_check(session->scene, method, &said))
        return fail_at(session, said.status, said.message, error);
    if (render && session->scene->render->look == CS_LOOK_GOALS && !cs_run_has_goals(method))
        return cs_fail(error, CS_ERR_SCENE,
                       "%s: render.look: integrator \"%s\" has no goals to draw",
                       session->scene->path, method->name);
    return CS_OK;
}

/* Number of threads for CS_THREADS_AUTO. With body contact the threshold is lower, because
 * pairs of surfaces then are most of the work. */
static uint32_t threads_of(const struct cs_scene *scene) {
    const size_t least = cs_scene_has_body_contact(scene)
                             ? CS_THREADS_AUTO_CONTACT_PARTICLES_MIN
                             : CS_THREADS_AUTO_PARTICLES_MIN;
    size_t n = 0;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        n += (size_t)cs_body_count(cs_scene_bodies(scene) + b);
    return n < least ? 1 : cs_pool_processors(CS_THREADS_AUTO_MAX);
}

/* Starts the threads before the plan, which reports them. */
static enum cs_status start_threads(struct cs_session *session, struct cs_error *error) {
    uint32_t threads = session->settings.threads;
    if (!threads)
        return CS_OK;
    const bool chosen = threads == CS_THREADS_AUTO;
    struct cs_error refused = {0};
    if (chosen)
        threads = threads_of(session->scene);
    session->started_pool = !cs_pool_start(threads, &refused);
    /* one thread gives the same bits: a failure only where more were asked for */
    return session->started_pool || chosen
               ? CS_OK
               : cs_fail(error, refused.status, "%s", refused.message);
}

/* Applies the changes that the session asks for to the checked scene; the caller's edit comes
 * last. */
static void change_scene(struct cs_session *session) {
    const struct cs_session_settings *settings = &session->settings;
    if (settings->switch_off_corrections)
        cs_scene_remove_corrections(session->scene);
    if (settings->count_crossings_only && cs_scene_crossings_by_pairs(session->scene))
        session->scene->crossings = CS_CROSSINGS_COUNT;
    if (settings->fps > 0)
        session->scene->time.fps = settings->fps;
    if (settings->edit_scene)
        settings->edit_scene(session->scene, settings->ctx);
}

static void make_plan(struct cs_session *session) {
    cs_plan_make(&session->plan, session->scene,
                 session->method.integrator->needs | session->settings.needs,
                 session->settings.render);
}

/* Takes the implicit method for "automatic" where the fastest motion of the springs makes it
 * the cheaper one. The rates are known of a built system only. */
static enum cs_status choose_by_cost(struct cs_session *session, struct cs_error *error) {
    struct cs_system system = {0};
    struct cs_error said = {0};
    const bool contact =
        session->scene->colliders.n > 0 || cs_scene_has_body_contact(session->scene);
    const double most = contact ? RATE_IN_CONTACT : RATE_FREE;
    if (!session->is_automatic || session->method.integrator->needs & CS_NEED_CLUSTERS)
        return CS_OK;
    // a scene that cannot be built is refused where it is built for the run
    const bool built = !cs_system_build(&system, session->scene, &session->plan, &said);
    session->rate = built ? fmax(system.view.omega, 2 * system.view.delta) : 0;
    cs_system_finish(&system);
    session->rate_limit = most;
    if (!(session->rate > most))
        return CS_OK;
    if (!take_method(session, IMPLICIT_METHOD, error)) {
        name_method(session);
        make_plan(session);
    }
    return error->status;
}

/* Opens up to the plan; on failure the caller closes. */
static enum cs_status open_plan(struct cs_session *session,
                                const struct cs_session_settings *settings,
                                struct cs_error *error) {
    *session =
        (struct cs_session){.settings = *settings, .scene = calloc(1, sizeof *session->scene)};
    if (!session->scene)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a scene");
    if (read_scene(session, error) || choose_method(session, error) ||
        check_method(session, error) || start_threads(session, error))
        return error->status;
    change_scene(session);
    make_plan(session);
    return choose_by_cost(session, error);
}

/* Systems of at least BUILD_PARTICLES are checked against the memory of the machine; TWIN_SIDE
 * particles along a row keep the effects of edges below 5 % of the bytes. */
enum { BUILD_PARTICLES = 65536, TWIN_SIDE = 96 };

/* Reads the scene with its grids cut to TWIN_SIDE particles a side. */
static enum cs_status open_twin(const struct cs_session *session, struct cs_session *twin,
                                struct cs_arena *arena, struct cs_error *error) {
    const struct cs_body *bodies = cs_scene_bodies(session->scene);
    struct cs_session_settings settings = session->settings;
    const uint32_t n = settings.n_overrides + session->scene->bodies.n;
    struct cs_override *overrides = cs_arena_alloc_array(arena, n, sizeof *overrides, error);
    for (uint32_t k = 0; overrides && k < settings.n_overrides; k++)
        overrides[k] = settings.overrides[k];
    for (uint32_t b = 0; overrides && b < session->scene->bodies.n; b++) {
        const int64_t *grid = bodies[b].cloth.grid;
        char path[64], value[64];
        if (bodies[b].mesh)
            continue;
        snprintf(path, sizeof path, "bodies[%u].cloth.grid", b);
        snprintf(value, sizeof value, "[%d,%d]", (int)fmin((double)grid[0], TWIN_SIDE),
                 (int)fmin((double)grid[1], TWIN_SIDE));
        overrides[settings.n_overrides++] = (struct cs_override){
            cs_arena_copy_text(arena, path, error), cs_arena_copy_text(arena, value, error)};
    }
    settings.overrides = overrides;
    settings.threads = 0;
    settings.run = (struct cs_run_settings){0};
    return error->status ? error->status : open_plan(twin, &settings, error);
}

/* Predicts the bytes of the built system and its method: those of its twin per particle, or of
 * the state alone where the scene does not allow for a twin. */
static double predict_bytes(const struct cs_session *session) {
    enum { STATE_DOUBLES = 11 }; /* state, start, mass and its inverse */
    struct cs_session twin = {0};
    struct cs_arena arena = {0};
    struct cs_error unseen = {0};
    double each = STATE_DOUBLES * sizeof(double);
    if (!open_twin(session, &twin, &arena, &unseen) &&
        !cs_system_build(&twin.system, twin.scene, &twin.plan, &unseen) &&
        !cs_session_begin(&twin, NULL, &unseen))
        each = (double)cs_run_bytes(&twin.run) / twin.plan.n;
    cs_session_close(&twin);
    cs_arena_finish(&arena);
    return each * session->plan.n;
}

/* Refuses a large system that the machine has no memory for, before it is built. The prediction
 * is taken with a tenth off: what might just fit is built. */
static enum cs_status check_memory(const struct cs_session *session, struct cs_error *error) {
    const char *limit = NULL;
    if (session->plan.n < BUILD_PARTICLES)
        return CS_OK;
    const double left = cs_memory_left("", &limit), bytes = predict_bytes(session);
    return 0.9 * bytes <= left
               ? CS_OK
               : cs_fail(
                     error, CS_ERR_MEMORY,
                     "out of memory: %u particles with integrator \"%s\" take about %.0f MB, "
                     "and %s leaves %.0f MB",
                     session->plan.n, session->method.integrator->name, 1e-6 * bytes, limit,
                     1e-6 * left);
}

enum cs_status cs_session_build(struct cs_session *session, struct cs_error *error) {
    cs_run_finish(&session->run);
    cs_system_finish(&session->system);
    struct cs_error said = {0};
    if (check_memory(session, error))
        return error->status;
    // what only the built system tells is a fault of the scene too
    if (cs_system_build(&session->system, session->scene, &session->plan, &said))
        return said.status == CS_ERR_SCENE ? fail_at(session, said.status, said.message, error)
                                           : cs_fail(error, said.status, "%s", said.message);
    cs_contact_keys_complete(session->scene->contact, &session->system);
    if (cs_initial_penetration_resolve(&session->system, &session->initial_penetration, error))
        return error->status;
    if (session->settings.perturbation > 0)
        cs_perturb_random(&session->system, session->settings.perturbation, 0);
    return CS_OK;
}

enum cs_status cs_session_begin(struct cs_session *session, const double *start,
                                struct cs_error *error) {
    struct cs_system *system = &session->system;
    cs_run_finish(&session->run);
    if (start)
        memcpy(system->state, start, 6 * (size_t)system->view.n * sizeof *start);
    struct cs_text moved = {0};
    cs_initial_penetration_print(&session->initial_penetration, &moved);
    if (!cs_run_begin(&session->run, system, session->method.integrator,
                      session->method.options, &session->settings.run, error) &&
        moved.length && !start)
        cs_run_note(&session->run, "%s", cs_text_get(&moved));
    cs_text_finish(&moved);
    return error->status;
}

enum cs_status cs_session_open_plan(struct cs_session *session,
                                    const struct cs_session_settings *settings,
                                    struct cs_error *error) {
    if (open_plan(session, settings, error))
        cs_session_close(session);
    return error->status;
}

enum cs_status cs_session_open_system(struct cs_session *session,
                                      const struct cs_session_settings *settings,
                                      struct cs_error *error) {
    if (open_plan(session, settings, error) || cs_session_build(session, error))
        cs_session_close(session);
    return error->status;
}

enum cs_status cs_session_open(struct cs_session *session,
                               const struct cs_session_settings *settings,
                               struct cs_error *error) {
    if (!cs_session_open_system(session, settings, error) &&
        cs_session_begin(session, NULL, error))
        cs_session_close(session);
    return error->status;
}

void cs_session_close(struct cs_session *session) {
    cs_run_finish(&session->run);
    cs_system_finish(&session->system);
    cs_registry_finish(&session->registry);
    if (session->scene)
        cs_scene_finish(session->scene);
    free(session->scene);
    cs_method_finish(&session->method);
    if (session->started_pool)
        cs_pool_stop();
    *session = (struct cs_session){0};
}
