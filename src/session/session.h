/* session.h - the only path from a scene to a running method; every command and study takes it.
 *
 * The face of the rooms below: exports, studies and commands include this header, and those
 * beside it, in place of theirs. What it includes is a part of it.
 *
 *   scene file -> cs_scene_read -> registry -> method -> threads -> plan -> system -> run
 * Each arrow is one function that leaves its result in struct cs_session. Studies stop at the
 * plan (to change options) or at the system (to change the state), and call the remaining steps
 * themselves. */
#ifndef CS_SESSION_H
#define CS_SESSION_H

#include "base/text.h"
#include "model/plan.h"
#include "model/post_step/contact_projection.h"
#include "model/system/particle_system.h"
#include "scene/body_keys.h"
#include "scene/body_pairs.h"
#include "scene/file/scene_read.h"
#include "session/method.h"
#include "sim/energy_ledger.h"
#include "sim/module.h"
#include "sim/process_state.h"
#include "sim/run_state.h"

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
    struct cs_scene *scene;              /* owned; NULL before it is read */
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

/* --- the loop over the frames of a run, and the result of the run ---
 *
 *   struct cs_follow follow = {.run = &session.run, .last = frames, .every = 1};
 *   while (cs_follow_next(&follow, error))
 *     ...                          here follow.run is at the end of a frame
 *   cs_follow_result(follow.run, "", &result, error);
 * Only the steps are timed, not the work between two calls. */

/* A begun run on its way to a frame. */
struct cs_follow {
    struct cs_run *run; /* borrowed */
    double last;        /* the frame to stop at */
    uint32_t every;     /* stops at multiples of it on the way; 0: at none */
    bool at_start;      /* stops first where the run is */
    double cpu, wall;   /* s, out: of all steps, without what is done between them */
};

/* Steps to the next multiple of `every`, or to the last frame. Returns false if no such
 * multiple was reached: at the last frame, after the end of the run, and after a failure. */
bool cs_follow_next(struct cs_follow *follow, struct cs_error *error);

/* Result of a run. */
struct cs_run_result {
    enum cs_outcome
        outcome;        /* CS_RUNNING: at its last frame; CS_FAILED: an error of the method */
    double reached;     /* s, of the last frame; of the last step where the budget ended it */
    double time;        /* s, of the blow-up if there was one, else as reached */
    char message[1024]; /* why the method gave up, else the outcome as text */
};

/* Fills the result. A method that gave up is a result, and *error is cleared. An interrupted
 * run is CS_ERR_INTERRUPT: "interrupted" followed by the text. Other errors stay. */
enum cs_status cs_follow_result(const struct cs_run *run, const char *interrupted,
                                struct cs_run_result *result, struct cs_error *error);
/* The same of a run whose method must not give up: its failure stays an error. */
enum cs_status cs_follow_check(const struct cs_run *run, const char *interrupted,
                               struct cs_error *error);

/* Returns the smallest whole number of frames that cover a time in s. A product that is whole
 * up to rounding (a relative 1e-9) gets no extra frame. */
double cs_follow_frames(const struct cs_scene *scene, double seconds);

/* --- what else studies ask of a system --- */

/* True if particles are led out of colliders, which gives energy (contact.untangle). */
bool cs_system_untangles(const struct cs_system *system);
/* True if contact is damped (contact.damping). */
bool cs_system_damps_contact(const struct cs_system *system);
/* True if a body bends by its mesh (elastic.bending). */
bool cs_system_bends(const struct cs_system *system);
/* The body of a particle of the system. */
static inline uint32_t cs_system_body_of(const struct cs_system *system, uint32_t particle) {
    uint32_t b = 0;
    while (particle - system->bodies[b].first >= system->bodies[b].count)
        b++;
    return b;
}

/* m, rest length of the longest spring; 0 without any. */
double cs_system_longest_spring(const struct cs_system *system);
/* Sets f (3,n) in N to the forces of springs and elastic bodies at (x, v), without damping. */
void cs_system_elastic_force(const struct cs_system *system, const double *x, const double *v,
                             double *f);
/* Name of force k, as in a plan's row k; NULL after the last. *keys: those that ramps may
 * change, closed by NULL; NULL: none. */
const char *cs_system_force(uint32_t k, const char *const **keys);
/* Adds how stiff elastic bodies are for a step of one frame, and the length over which they
 * bend by their own weight: a line per body. */
void cs_system_print_elastic(const struct cs_system *system, struct cs_text *out);
/* Adds the particle, then its neighbours by stretch and shear springs, as numbers within its
 * body: a value of render.marks. */
void cs_system_print_marks(const struct cs_system *system, uint32_t particle,
                           struct cs_text *out);

/* --- where a scene will go wrong, told before the first step, with the value that would do ---
 */

/* Findings about a scene, one per line. A warning is about a result that cannot be right, a
 * hint about one that may surprise. Zeroed: none. */
struct cs_scene_findings {
    struct cs_text warnings, hints;
};

/* Checks a session whose system is built, over the given time in s. Changes nothing, and reads
 * the state of the start only. CS_ERR_MEMORY. */
enum cs_status cs_scene_doctor_check(const struct cs_session *session, double seconds,
                                     struct cs_scene_findings *out, struct cs_error *error);
void cs_scene_findings_finish(struct cs_scene_findings *findings);

/* Appends why "automatic" chose the method, without an end of line; nothing if it was named. */
void cs_session_print_choice(const struct cs_session *session, struct cs_text *out);

/* The energy that contact by force can hold beside the energy that may
 * come, for reports and warnings. */

/* Capacity of the contact of two surfaces, beside the energy that comes. */
struct cs_contact_capacity {
    uint32_t a, b;   /* a body; itself, another body, or n_bodies + a collider */
    double range, k; /* m, N/m */
    double holds;    /* J that one contact takes up: cs_barrier_capacity */
    double comes;    /* J of one particle */
    double k_needed; /* N/m with which it holds CS_APPROACH_MARGIN times what comes */
};

/* Sets *out to the two surfaces that hold the least in terms of what comes; where nothing
 * comes, that hold the least. Returns false without contact by force, or if the system is not
 * built. */
bool cs_contact_capacity_find(const struct cs_system *system, struct cs_contact_capacity *out);

/* Adds "a contact of bodies[0] with colliders[0] takes up 3.3 J ...": one line without an end.
 */
void cs_contact_capacity_print(const struct cs_system *system,
                               const struct cs_contact_capacity *capacity, struct cs_text *out);

/* Adds a warning about the scene's contact.stiffness if it holds too little. */
void cs_contact_capacity_warn(const struct cs_system *system, struct cs_text *out);

/* Adds a line about the two surfaces that approach by most ranges of contact per step of dt in
 * s, if that is many; dt 0: nothing. */
void cs_contact_ranges_print(const struct cs_system *system, double dt, struct cs_text *out);

/* Adds `before` and whether contact is a part of linear theory and of runs. Adds nothing for
 * scenes without contact. */
void cs_contact_note_add(const struct cs_scene *scene, const char *before, struct cs_text *out);

/* Adds the energy in J that contact holds beside the one that comes, next
 * to the kinetic energy of the heaviest particle at `speed` (m/s; 0: unknown). Adds the damping
 * by friction, and what longer explicit steps do. Adds nothing for scenes without contact by
 * force. */
void cs_contact_note_add_crossing(const struct cs_system *system, double speed,
                                  struct cs_text *out);

#endif
