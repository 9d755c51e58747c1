/* force_keys.h - keys of the external forces, and of events. */
#ifndef CS_FORCE_KEYS_H
#define CS_FORCE_KEYS_H

#include "scene/scene.h"

#include <math.h>

enum cs_wind_unit { CS_WIND_PA, CS_WIND_N };
/* Uniform wind; strength in Pa (times each particle's area) or in N per particle. */
struct cs_wind {
    bool present;
    double direction[3]; /* made a unit vector by cs_scene_check; along velocity if absent */
    double strength;
    int32_t strength_unit; /* enum cs_wind_unit */
    double velocity[3];    /* m/s, of air past the cloth; first component NAN: none */
    double density;        /* kg/m3 */
    double drag;           /* coefficient of the pressure across the surface */
};
enum cs_drag_unit { CS_DRAG_PARTICLE, CS_DRAG_AREA };

/* X(key, unit, help): numbers of `forces` that each belong to one force of
 * model/force/term_NAME.c; 0 if absent. Such a key needs nothing but its row. */
#define CS_FORCE_NUMBERS(X) X(drag, "N s/m or Pa s/m", "force of still air: -drag * v")

/* External forces of the whole scene. */
struct cs_forces {
    double gravity[3]; /* m/s2 */
#define X(key, unit, help) double key;
    CS_FORCE_NUMBERS(X)
#undef X
    int32_t drag_unit;    /* enum cs_drag_unit */
    double velocity_loss; /* fraction of the velocity removed after every internal step */
    struct cs_wind wind;
};

/* Particles that an event acts on. */
struct cs_event_target {
    int64_t body;             /* -1: every body */
    struct cs_list particles; /* struct cs_pin; none: all of them */
};

/* An impulse at one moment. */
struct cs_impact {
    bool present;
    struct cs_event_target target;
    double direction[3]; /* made a unit vector by cs_scene_check */
    double impulse;      /* N s, on all of them together */
};
/* A change of the wind, at once or linearly over the event's interval. */
struct cs_wind_change {
    bool present;
    double direction[3]; /* first component NAN: as it was */
    double strength;     /* NAN: as it was */
};
/* A change of one number of the scene (event_key.h), at once or linearly. */
struct cs_ramp {
    bool present;
    char key[CS_TEXT_MAX]; /* forces.gravity[1] */
    double value;          /* NAN: not given, refused */
};
/* Viewpoint of a picture that may differ from the camera's. cs_scene_check fills absent values
 * with those of the camera and of the picture. */
struct cs_viewpoint {
    double eye[3], target[3], up[3]; /* m; first component NAN: absent */
    double fov;                      /* degrees, vertical; NAN: absent */
    double aspect;                   /* width over height; NAN: absent */
};
/* A force on the particles that are visible from a viewpoint in a rectangle of its picture. */
struct cs_viewpoint_force {
    bool present;
    struct cs_viewpoint viewpoint;
    double rectangle[4]; /* left, top, right, bottom: fractions of the picture, from its top
                            left */
    double force;        /* N on each visible particle; NAN: not given, refused */
    double duration;     /* s, of a force at one moment; NAN: absent */
    double refresh;      /* 1/s, rate of visibility tests; 0: at the start only; NAN: absent */
    int64_t body;        /* -1: every body */
};
/* A point of a path and its time. */
struct cs_path_point {
    double at;       /* s; NAN: not given, refused */
    double point[3]; /* m */
};
/* Returns 1 if the first point of a path is that of its beginning at t: it lies where the event
 * finds what it moves, and no leg leads to it; else 0. */
static inline uint32_t cs_path_starts_at(const struct cs_list *path, double t) {
    const struct cs_path_point *first = path->items;
    return path->n && first->at > t - 1e-6 && first->at < t + 1e-6;
}
enum cs_motion { CS_MOTION_LINEAR, CS_MOTION_SMOOTH };
struct cs_holder;
/* Holds particles and moves them along a path. */
struct cs_grab {
    bool present;
    struct cs_event_target target;
    struct cs_list path;  /* struct cs_path_point, at least one */
    int32_t motion;       /* enum cs_motion */
    bool relative;        /* points are shifts from where it was grabbed */
    struct cs_holder *to; /* instead of a path; NULL: none */
    double spin[3];       /* rad/s, about the centre, which follows the path */
    double centre[3];     /* m, at the beginning; first component NAN: the particles' mean */
};
/* Pins particles, or releases them. */
struct cs_pin_change {
    bool present;
    struct cs_event_target target;
};

/* Moves a collider along a path, or turns it. */
struct cs_move {
    bool present, relative; /* relative: points are shifts from where it was at the beginning */
    int64_t collider;       /* -1: not given, refused */
    struct cs_list path;    /* struct cs_path_point */
    int32_t motion;         /* enum cs_motion */
    double spin[3];         /* rad/s, about the centre */
    double centre[3];       /* m, at the beginning; first component NAN: the collider's */
};

/* Opens a seam. */
struct cs_unsew {
    bool present;
    int64_t seam; /* -1: not given, refused */
};

/* An event: exactly one of impact ... unsew; with `at`, or with `from` and `to`. */
struct cs_event {
    double at, from, to; /* s; NAN: absent */
    struct cs_impact impact;
    struct cs_wind_change wind;
    struct cs_viewpoint_force viewpoint_force;
    struct cs_ramp ramp;
    struct cs_grab grab;
    struct cs_pin_change pin, release;
    struct cs_move move;
    struct cs_unsew unsew;
};

/* First and last time of an event in s, as the scene gives them: the same with `at`. */
static inline double cs_event_begin(const struct cs_event *event) {
    return isnan(event->at) ? event->from : event->at;
}

static inline double cs_event_end(const struct cs_event *event) {
    return isnan(event->at) ? event->to : event->at;
}

#endif
