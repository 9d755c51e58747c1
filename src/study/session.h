/* session.h - the only path from a scene to a running method; every command and study takes it.
 *
 *   scene file -> cs_scene_read -> registry -> method -> threads -> plan -> system -> run
 * Each arrow is one function that leaves its result in struct cs_session. Studies stop at the
 * plan (to change options) or at the system (to change the state), and call the remaining steps
 * themselves. */
#ifndef CS_SESSION_H
#define CS_SESSION_H

#include "model/post_step/contact_projection.h"
#include "scene/file/scene_read.h"
#include "sim/method.h"
#include "sim/run.h"

/* Request for a session. Zeroed except for the scene: the scene as it is, by its own method. */
struct cs_session_settings {
    const char *scene; /* path; with a text: its name in messages */
    const char *text;  /* the scene itself, in memory; NULL: read from the path */
    const struct cs_override *overrides; /* (n_overrides) */
    uint32_t n_overrides;
    /* changes the scene once it was checked; may be NULL */
    void (*edit_scene)(struct cs_scene *scene, void *ctx);
    void *ctx;                   /* of edit_scene */
    bool switch_off_corrections; /* leaves out what acts after steps: contact by projection,
                    strain limit, velocity loss */
    bool count_crossings_only;   /* crossings that the scene says nothing about: no step is cut
                                    for them */
    bool has_all_values; /* the scene was printed with every value: those without effect too */
    double fps;          /* frames a second; 0: the scene's */

    const char *integrator;     /* "NAME:key=value,key=value", NULL: the scene's own */
    const char *const *plugins; /* (n_plugins) module files */
    uint32_t n_plugins;
    /* instead of these: a given integrator with a copy of options (NULL: its defaults); it
     * is not asked whether it suits the scene */
    const struct cs_integrator *method;
    const void *options;
    double dt;      /* s, of the method's option; 0: as it stands */
    uint32_t needs; /* enum cs_need, beside those of the method */

    double perturbation; /* m, of the start: see cs_perturb_random */
    bool render;
    /* 0: those of the pool, left as they are; else the session starts them and ends them, with
     * CS_THREADS_AUTO as many as suit the scene, or one where there are no more to be had */
    uint32_t threads;
    struct cs_run_settings run;
};

/* One thread for a scene that is done before others have woken up, of fewer particles than the
 * least, which is another where surfaces keep off each other; else one a processor, up to that
 * many. */
enum {
    CS_THREADS_AUTO = UINT16_MAX,
    CS_THREADS_AUTO_MAX = 16,
    CS_THREADS_AUTO_PARTICLES_MIN = 16384,
    CS_THREADS_AUTO_CONTACT_PARTICLES_MIN = 1024
};

/* Zeroed: closed. Must stay where it is while open. */
struct cs_session {
    struct cs_session_settings settings; /* their texts are used while opening only */
    struct cs_scene scene;
    struct cs_registry registry;
    struct cs_method method;
    struct cs_plan plan;
    struct cs_system system;
    struct cs_initial_penetration
        initial_penetration; /* particles moved out of colliders when the system was built */
    struct cs_run run;
    bool started_pool; /* started threads */
    /* the method was chosen by "automatic"; 1/s of its springs, and up to which an explicit
     * method is the cheaper one; 0: it was not chosen by cost */
    bool is_automatic;
    double rate, rate_limit;
};

/* Opens the session up to a begun run. On failure everything is closed, and *error names the
 * place and the reason: CS_ERR_FILE, CS_ERR_SCENE, CS_ERR_USAGE, CS_ERR_MODULE, CS_ERR_MEMORY.
 */
enum cs_status cs_session_open(struct cs_session *session,
                               const struct cs_session_settings *settings,
                               struct cs_error *error);
/* Opens up to the plan: no system, no run. The method's options may then be changed. On failure
 * everything is closed. */
enum cs_status cs_session_open_plan(struct cs_session *session,
                                    const struct cs_session_settings *settings,
                                    struct cs_error *error);
/* Opens up to the system: no run. The state may then be changed. On failure everything is
 * closed. */
enum cs_status cs_session_open_system(struct cs_session *session,
                                      const struct cs_session_settings *settings,
                                      struct cs_error *error);

/* Single steps of the path. */

/* Builds the system of an open plan at its start; an earlier one is replaced. Moves particles
 * out of colliders and applies the perturbation. On failure the session must still be closed.
 */
enum cs_status cs_session_build(struct cs_session *session, struct cs_error *error);
/* Begins a run of a built system by settings.run, which may be changed until then; an earlier
 * run is ended. start: (6n) x and v to run from, copied; NULL: the present state. On failure
 * the session must still be closed. */
enum cs_status cs_session_begin(struct cs_session *session, const double *start,
                                struct cs_error *error);

/* Frees everything and ends the threads that the session started; a zeroed session is allowed.
 */
void cs_session_close(struct cs_session *session);

#endif
