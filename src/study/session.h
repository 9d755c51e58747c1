/* session.h - the way from a scene file to a running method; every command and study takes it.
 *
 *   scene file -> cs_scene_read -> registry -> integrator options -> plan -> system -> run
 */
#ifndef CS_SESSION_H
#define CS_SESSION_H

#include "io/scene_read.h"
#include "sim/registry.h"
#include "sim/run.h"

struct cs_session_settings {
    const char *scene;                   /* path */
    const struct cs_override *overrides; /* (n_overrides) */
    uint32_t n_overrides;
    const char *integrator;     /* "NAME:key=value,key=value", NULL: the scene's own */
    const char *const *plugins; /* (n_plugins) module files */
    uint32_t n_plugins;
    bool render, timed;
    /* 0: those of the pool, left as they are; else the session starts them and ends them, with
     * CS_THREADS_AUTO as many as suit the scene, or one where there are no more to be had */
    uint32_t threads;
    const volatile sig_atomic_t *stop; /* may be NULL */
};

/* One thread for a scene that is done before others have woken up; else one a processor, up to
 * that many. */
enum { CS_THREADS_AUTO = UINT16_MAX, CS_THREADS_AUTO_MOST = 16, CS_THREADS_AUTO_LEAST = 16384 };

/* Zeroed: closed. Must stay where it is while open. */
struct cs_session {
    struct cs_scene scene;
    struct cs_registry registry;
    const struct cs_integrator *integrator;
    struct cs_table option_table; /* of the integrator's rows */
    void *options;                /* filled, owned */
    struct cs_plan plan;
    struct cs_system system;
    struct cs_run run;
    bool pooled; /* started threads */
};

/* The whole way. On failure everything is closed and *error says where and why. */
enum cs_status cs_session_open(struct cs_session *session,
                               const struct cs_session_settings *settings,
                               struct cs_error *error);
/* The way up to the plan only: no system, no run. */
enum cs_status cs_session_open_plan(struct cs_session *session,
                                    const struct cs_session_settings *settings,
                                    struct cs_error *error);
void cs_session_close(struct cs_session *session);

#endif
