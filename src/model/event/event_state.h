/* event_state.h - the state of the events of a run: times, holders, values in transition.
 *
 * All of it goes into a checkpoint (events.h), but for the pointers. */
#ifndef CS_EVENT_STATE_H
#define CS_EVENT_STATE_H

#include "base/serialise.h"
#include "model/system/particle_system.h"
#include "scene/event_key.h"
#include "scene/scene.h"

struct cs_event;
struct cs_event_target;
struct cs_path_point;
struct cs_viewpoint_force;

/* Visibility: the particles that are seen through a rectangle from a
 * viewpoint.
 *
 * A particle is visible if it lies in front of the eye, its perspective image lies in the
 * rectangle, and nothing lies on the straight line to it: no triangle of any body except
 * those it is a corner of, and no visible collider. (Flag thesis, ch. 5: the points that
 * OpenGL's selection finds; here by geometry in doubles, so that all machines see the same.) */

/* A viewpoint in the form that tests need. */
struct cs_visibility_query {
    double eye[3];          /* m */
    double axes[3][3];      /* unit vectors: to the right, up, and in the direction of view */
    double low[2], high[2]; /* the rectangle as slopes: right / forward, up / forward */
};

/* Scratch arrays for n particles, owned by the caller's arena. */
struct cs_visibility_scratch {
    /* (3,n) m, positions relative to the eye, along its axes */
    double *projected;
    /* (n) cell of each candidate; (n) candidates by cell; (n + 1) position in `order` where the
     * candidates of each cell start */
    uint32_t *cells, *order, *cell_starts;
};

/* Prepares a viewpoint from an event of the scene that was checked: eye and target differ, up
 * is not along the view, the rectangle is not empty. */
void cs_visibility_query_make(struct cs_visibility_query *visibility,
                              const struct cs_viewpoint_force *viewpoint_force);

/* Takes the scratch arrays from an arena. CS_ERR_MEMORY. */
enum cs_status cs_visibility_scratch_init(struct cs_visibility_scratch *work, uint32_t n,
                                          struct cs_arena *arena, struct cs_error *error);

/* Sets seen (n): true for the particles of a body (-1: of all bodies) that are visible at
 * time t and positions x (3,n). The rectangle includes its sides. The line ends a billionth
 * of its length before the particle: a particle that touches a surface is not hidden by it.
 * Planes are infinite, and the space behind them is solid, as are the other colliders. A
 * particle with a position that is not finite is not visible. */
void cs_visibility_query_run(const struct cs_visibility_query *visibility,
                             const struct cs_system *system, double t, const double *x,
                             int64_t body, const struct cs_visibility_scratch *work,
                             bool *seen);

/* One event. A grab or a move follows a path of legs, from point to point; a leg has one chord,
 * or CS_EVENT_CHORDS of constant velocity if it is smooth. */
struct cs_event_state {
    /* s, out of events->times; equal for an event that happens at once */
    double begin, end;
    /* between begin and end */
    bool active;
    /* Ramp: the number that it changes, in events->scene, and its values at begin and at end.
     * Gust: value is NULL, first and last are the strengths. */
    double *value, first, last;
    /* Gust: unit directions at begin and at end. */
    double wind_ends[2][3];
    /* Path: numbers of the running leg, and of the chord in it. */
    uint32_t leg, chord;
    /* s, of that chord; the end is HUGE_VAL after the last point */
    double chord_begin, chord_end;
    /* m, m and m/s: both ends of the chord, and its velocity */
    double chord_from[3], chord_to[3], rate[3];
    /* m, the point where the leg began */
    double leg_start[3];
    /* Move: m, the shift of the collider at its begin; the path is relative to it. */
    double origin[3];
    /* Grab: m, from the point of the path to the centre of its spin. */
    double pivot[3];
};

struct cs_viewpoint_forces;

/* The events of a run. All arrays are the system's arena's. */
struct cs_events {
    /* The scene with the values of now, a copy; system->scene points to it. */
    struct cs_scene scene;
    /* (n_times) s, ascending and distinct; `next` is the number of the segment's end. */
    double *times;
    uint32_t n_times, next;
    /* s, of the segment; end is HUGE_VAL after the last time */
    double begin, end;
    /* (scene.events.n) in the scene's order */
    struct cs_event_state *states;
    /* (n) number of the event that holds the particle, plus 1; 0: none. Behind the events come
     * colliders that hold pins. */
    uint32_t *held_by;
    /* (n) scratch: the particles that an event selects */
    bool *work;
    /* (3,n) m, of each particle that is grabbed or carried in its holder's frame
     * (held_particles.c); NULL: none ever is */
    double *offsets;
    /* (n) triangle that carries it, of a holder with key frames; NULL without key frames */
    uint32_t *triangles;
    /* Ways that particles go in their collider's frame, from rest to rest: (3,n) m, to the
     * place in offsets, and (n) s, the time that they arrive; NULL: none. tangled (n): whether
     * they are led out, and free from the time `untangled` on, or sewn; system->tangled points
     * to it while some are. */
    double *ways, *arrivals;
    uint8_t *tangled;
    double untangled, way_speed; /* s, 0: none is led out; m/s, the largest on a way */
    /* (n) number of the seam that sews the particle to a collider, plus 1; NULL: none */
    uint32_t *seam_of;
    double gap;      /* m, longest way of a sewn particle */
    uint32_t gap_of; /* that particle */
    /* NULL without viewpoint forces */
    struct cs_viewpoint_forces *viewpoint_forces;
    double next_test;          /* s, of the next visibility test; HUGE_VAL: none */
    double values_time;        /* s, of the ramps' values */
    bool has_ramps, has_grabs; /* some are active in the segment; gusts count as ramps, and
                                  particles that colliders carry as grabs */
    bool has_turns;            /* some of these particles turn with their holder */
    double held_speed;         /* m/s, largest speed of theirs by turning */
};

/* Starts and ends single events; for events.c. */

/* Starts an event at events->begin. One that happens at once acts fully here: a change of
 * velocity, a new value, a pin, a release. One over an interval becomes active. */
void cs_event_start(struct cs_system *system, uint32_t event);

/* Ends an event over an interval: values get their last number exactly, particles that it
 * holds become free, a moved collider stops. */
void cs_event_finish(struct cs_system *system, uint32_t event);

/* Stores the place of the marked particles (events->work) in the frame of a grab that begins,
 * and starts its path. */
void cs_event_begin_grab(struct cs_system *system, uint32_t event);

/* Stores where the marked particles are at t in the frame of their holder. */
void cs_event_store_offsets(struct cs_system *system, uint32_t holder, const bool *marks,
                            double t);

/* True if a scene may turn particles that it holds. They then move on arcs, and at a stage of a
 * method, whose x + h v is off the arc, cs_events_apply_paths gives their state. */
bool cs_events_turn_particles(const struct cs_scene *scene);

/* Sets position and velocity of the particles that are grabbed or that a collider carries in
 * (x, v), both (3,n), to those of their path at t. */
void cs_events_apply_paths(const struct cs_system *system, double t, double *x, double *v);

/* The same in a segment where held particles turn; else nothing. */
void cs_events_apply_arcs(const struct cs_system *system, double t, double *x, double *v);

/* Change in J of the kinetic energy of pinned particles from v0 to v1, both (3,n), where held
 * ones turn, whose holder may change it within a segment; else 0. */
double cs_events_turning_work(const struct cs_system *system, const double *v0,
                              const double *v1);

/* Lets colliders carry the particles of such pins, at time 0. Fails with CS_ERR_SCENE if two
 * pins hold a particle to different things. */
enum cs_status cs_event_attach_pins(struct cs_system *system, struct cs_error *error);

/* Moves each particle i with colliders[i] > 0 from where it starts to targets (3,n) in m, in
 * the frame of collider colliders[i] - 1, until the time `end`: on the part u^2 (3 - 2 u) of
 * the way at the part u of the time; end 0: it is there from the start. Nothing pushes it
 * meanwhile. From then on it is free if `why` is CS_TANGLED_LED_OUT, or else stays.
 * CS_ERR_MEMORY.
 */
enum cs_status cs_event_lead(struct cs_system *system, const uint32_t *colliders,
                             const double *targets, double end, enum cs_tangled why,
                             struct cs_error *error);
/* Leads particles to the colliders that they are sewn to. CS_ERR_SCENE if a seam fits not. */
enum cs_status cs_event_attach_seams(struct cs_system *system, struct cs_error *error);
/* Frees those led out that have arrived at t. They and those that are sewn no more have contact
 * again. */
void cs_event_release_tangled(struct cs_system *system, double t);
/* Lists the particles without inverse mass, ascending. */
static inline void cs_event_list_pinned(struct cs_system *system) {
    system->n_pinned = 0;
    for (uint32_t i = 0; i < system->view.n; i++)
        if (system->inv_mass[i] == 0)
            system->pinned[system->n_pinned++] = i;
}

/* Sets has_grabs, has_turns and held_speed for the segment that begins at t. */
void cs_event_find_held(struct cs_system *system, double t);

/* Sets the value of an active ramp or gust to the one at t. The caller refreshes the springs.
 */
void cs_event_set_value(struct cs_system *system, uint32_t event, double t);

/* Sums system->event_force (3,n): the accelerations in m/s2 of all active impacts and
 * viewpoint forces on free particles. NULL without such events: then it does nothing. */
void cs_event_sum_pushes(struct cs_system *system);

/* Recomputes stiffness and damping of the springs from the scene's values: those of the runs
 * that forces use, and those of the list in the view; and alpha and beta of clusters. */
void cs_event_refresh_springs(struct cs_system *system);

/* Events that move colliders; for events.c and event_apply.c. */

/* True if an event of the scene or key frames move a collider. */
bool cs_event_moves_any(const struct cs_scene *scene);

/* Takes system->motions, with every collider at rest, and the arrays of the view that show
 * them. CS_ERR_MEMORY. */
enum cs_status cs_event_moves_build(struct cs_system *system, struct cs_error *error);

/* begin: the event takes control of the collider, also from another event. end: the collider
 * stops where it is, if this event still controls it. */
void cs_event_begin_move(struct cs_system *system, uint32_t event, double t);
void cs_event_end_move(struct cs_system *system, uint32_t event, double t);

/* Makes the collider follow the chord of the event that begins at t; call it after
 * cs_event_next_leg. Its rotation up to t is stored first. */
void cs_event_follow_move(struct cs_system *system, uint32_t event, double t);

/* Makes colliders follow the ramps of their radius and thickness that are active. */
void cs_event_follow_growth(struct cs_system *system);

/* Writes the motion of all colliders to the view: velocity, spin, and the origin that makes
 * origin + t velocity the centre at time t. */
void cs_event_show_moves(struct cs_system *system);

/* Largest speed in m/s of a point of a turning collider; of a plane, at the particle farthest
 * from its centre. */
double cs_event_angular_speed(const struct cs_system *system);

/* The position of a grab or a move on its path. */

/* Starts the path of a grab or a move at t, at the point state->chord_to. */
void cs_event_begin_path(struct cs_event_state *state, double t);

/* Moves to the next chord of the path if one begins at t: its two ends, times and velocity.
 * After the last point the velocity is 0 and the end HUGE_VAL. */
void cs_event_next_leg(struct cs_events *events, uint32_t event, double t);

/* The times at which something begins, ends or turns in a scene with events. */

/* Chords of a smooth leg of a path, from point to point; chosen by trial. */
enum { CS_EVENT_CHORDS = 16 };

/* s: times that are nearer to each other count as one. A step between them would consist of
 * rounding errors. */
#define CS_EVENT_SAME 1e-9

/* t, or the time of the frame that lies within CS_EVENT_SAME of it. */
double cs_event_time_snap(const struct cs_scene *scene, double t);

/* The path of a grab or a move: n points, borrowed from the scene, and the chords of each
 * leg. n 0: none. */
struct cs_event_path {
    const struct cs_path_point *points;
    uint32_t n, n_chords;
};

struct cs_event_path cs_event_path_of(const struct cs_event *event);

/* An upper bound of the number of times: two per event, and one per chord. */
size_t cs_event_times_count(const struct cs_scene *scene);

/* Fills events->times (capacity cs_event_times_count) and begin and end of each state. A time
 * within CS_EVENT_SAME of a frame becomes the frame's, and times as near to each other become
 * one, the earlier. */
void cs_event_times_fill(struct cs_events *events);

/* Adds a time after 0, and returns it as it stands in events->times. */
double cs_event_times_add(struct cs_events *events, double t);

/* Time in s of the end of a chord of a leg, as it stands in events->times. */
double cs_event_chord_end(const struct cs_events *events, uint32_t event, uint32_t leg,
                          uint32_t chord);

/* The state of a scene's events, for a checkpoint. */

/* Writes or reads everything that events have changed in a system since it was built, except
 * x and v: their own state, pins, masses, values, pushes, and colliders on paths. Springs
 * follow from the values. Does nothing for a system without events. A record that would lead
 * outside an array sets record->failed. */
void cs_events_serialise(struct cs_system *system, struct cs_serialiser *serialiser);

/* Viewpoint forces: the particles that the events `viewpoint_force` act
 * on, and the times at which visibility is tested.
 *
 * A viewpoint force over an interval acts on the particles that its last visibility test
 * selected. Between two tests the selection stays the same, and the force is smooth. A test
 * with another result restarts the method, like every event. The times of tests are computed
 * one by one and not listed in events->times, because an interval may be long. A scene
 * without viewpoint forces has none of this. */

/* One viewpoint force. */
struct cs_viewpoint_force_state {
    /* number of its event in the scene */
    uint32_t event;
    struct cs_visibility_query query;
    /* (n) the particles that the last test selected */
    bool *is_visible;
    /* between begin and end of its interval */
    bool active;
    /* tests since the begin, without the one there; test k is at begin + k / refresh */
    double n_tests;
    /* s, of the next test; HUGE_VAL: none */
    double next;
};

/* All viewpoint forces of a scene, in the system's arena. */
struct cs_viewpoint_forces {
    uint32_t n;
    struct cs_viewpoint_force_state *states; /* (n) in the scene's order */
    struct cs_visibility_scratch work;
    bool *work_marks; /* (n particles) work, the events' */
};

/* True if the scene has a viewpoint force. */
bool cs_viewpoint_forces_any(const struct cs_scene *scene);

/* Builds the viewpoint forces of a system whose events exist already. CS_ERR_MEMORY. */
enum cs_status cs_viewpoint_forces_build(struct cs_system *system, struct cs_error *error);

/* start: tests visibility at the begin of an event. One over an interval becomes active; one
 * at once adds force times duration to the momentum of each selected free particle. finish:
 * the force ends. */
void cs_viewpoint_force_start(struct cs_system *system, uint32_t event);
void cs_viewpoint_force_finish(struct cs_system *system, uint32_t event);

/* Repeats the visibility tests that are due at t. Returns true if one selects other particles
 * than before. */
bool cs_viewpoint_forces_retest(struct cs_system *system, double t);

/* Time in s of the next test of all; HUGE_VAL: none. */
double cs_viewpoint_forces_next(const struct cs_viewpoint_forces *viewpoint_forces);

/* push (3,n) += the acceleration in m/s2 of the selected free particles, by all active
 * forces. */
void cs_viewpoint_forces_add_push(const struct cs_system *system, double *push);

/* The greatest force in N on one particle: the sum of |force| of all active ones. */
double cs_viewpoint_forces_force(const struct cs_viewpoint_forces *viewpoint_forces,
                                 const struct cs_scene *scene);

/* The number of tests of a scene until t that lie between frames, where a method has to stop.
 */
uint32_t cs_viewpoint_forces_cuts(const struct cs_scene *scene, double t);

/* Marks in events->work (n) the particles that an event selects: of a body or of all, those
 * that a pin of the same description would hold. */
void cs_event_mark(const struct cs_system *system, const struct cs_event_target *target);

#endif
