/* The rows of `forces` and of `events`: keys, units, defaults, ranges, help. */
#include "scene/force_keys.h"
#include "scene/table_rows.h"

static const double absent3[3] = {ABSENT, ABSENT, ABSENT}, zero3[3] = {0, 0, 0};
static const char *const wind_units[] = {"Pa", "N", NULL};
static const struct cs_option wind_rows[] = {
    VECTOR(struct cs_wind, direction, 3, "", absent3, -BIG, BIG,
           "direction of strength, of any non-zero length; required without velocity"),
    REAL(struct cs_wind, strength, "Pa or N", 0, 0, BIG,
         "pressure or force where the cloth faces it; times |direction . normal| elsewhere"),
    CHOICE(struct cs_wind, strength_unit, wind_units, CS_WIND_PA,
           "Pa: times the area of the particle, independent of the grid; N: on each particle"),
    VECTOR(struct cs_wind, velocity, 3, "m/s", absent3, -BIG, BIG,
           "of the air, which the cloth feels by its own velocity against it; 0, 0, 0: still "
           "air; absent: none"),
    REAL(struct cs_wind, density, "kg/m3", 1.2, 0, BIG, "of the air, with velocity"),
    REAL(struct cs_wind, drag, "", 1.2, 0, 1000,
         "with velocity: coefficient of the pressure density/2 u^2 by the velocity u across "
         "the surface; drag and lift are its parts along the wind and across"),
};
static const struct cs_table wind_table = {ROWS(wind_rows), .size = sizeof(struct cs_wind),
                                           .optional = true};
static const double earth[3] = {0, -9.81, 0};
static const char *const drag_units[] = {"N s/m", "Pa s/m", NULL};
static const struct cs_option force_rows[] = {
    VECTOR(struct cs_forces, gravity, 3, "m/s2", earth, -BIG, BIG, "acceleration of free fall"),
#define X(key, unit_, help_) REAL(struct cs_forces, key, unit_, 0, 0, BIG, help_),
    CS_FORCE_NUMBERS(X)
#undef X
        CHOICE(struct cs_forces, drag_unit, drag_units, CS_DRAG_PARTICLE,
               "N s/m: on each particle; Pa s/m: times the area of the particle"),
    REAL(struct cs_forces, velocity_loss, "", 0, 0, 1,
         "fraction of the velocity removed after every internal step: it depends on the step "
         "and is not a force"),
    TABLE(struct cs_forces, wind, wind_table, "steady wind, by the particle normals"),
};
const struct cs_table cs_force_table = {ROWS(force_rows), .size = sizeof(struct cs_forces),
                                        .apart = true};

/* The two keys of every event that acts on particles. */
#define AIM_ROWS(s)                                                                            \
    SIDE_ROWS(s, target, "number of the body from 0; absent: every body",                      \
              "of the body, named as in its pins; absent: all of them")

static const struct cs_option impact_rows[] = {
    AIM_ROWS(struct cs_impact),
    VECTOR(struct cs_impact, direction, 3, "", NULL, -BIG, BIG, "of any non-zero length"),
    REAL(struct cs_impact, impulse, "N s", 0, 0, BIG,
         "total change of momentum of the free particles, distributed by mass: each gets the "
         "same change of velocity; over an interval a steady force"),
};

static const struct cs_table impact_table = {
    ROWS(impact_rows), .size = sizeof(struct cs_impact), .optional = true};

static const struct cs_option gust_rows[] = {
    VECTOR(struct cs_wind_change, direction, 3, "", absent3, -BIG, BIG,
           "direction in which the wind then blows; absent: unchanged"),
    REAL(struct cs_wind_change, strength, "Pa or N", ABSENT, 0, BIG,
         "in the unit of forces.wind; 0 turns it off; absent: unchanged"),
};

static const struct cs_table gust_table = {
    ROWS(gust_rows), .size = sizeof(struct cs_wind_change), .optional = true};

static const struct cs_option viewpoint_rows[] = {
    VECTOR(struct cs_viewpoint, eye, 3, "m", absent3, -BIG, BIG,
           "position of the viewpoint; absent here and below: the camera's value"),
    VECTOR(struct cs_viewpoint, target, 3, "m", absent3, -BIG, BIG,
           "point in the middle of the view"),
    VECTOR(struct cs_viewpoint, up, 3, "", absent3, -BIG, BIG, "direction that is up"),
    REAL(struct cs_viewpoint, fov, "degrees", ABSENT, 1, 170, "vertical field of view"),
    REAL(struct cs_viewpoint, aspect, "", ABSENT, 0.01, 100,
         "width over height; absent: the picture's value"),
};

static const struct cs_table viewpoint_table = {ROWS(viewpoint_rows),
                                                .size = sizeof(struct cs_viewpoint)};

static const double whole[4] = {0, 0, 1, 1};

static const struct cs_option viewpoint_force_rows[] = {
    TABLE(struct cs_viewpoint_force, viewpoint, viewpoint_table,
          "position and view; the force acts along the view"),
    VECTOR(struct cs_viewpoint_force, rectangle, 4, "", whole, 0, 1,
           "left, top, right, bottom: fractions of the view, from its top left corner"),
    REAL(struct cs_viewpoint_force, force, "N", ABSENT, -BIG, BIG,
         "on each particle visible in the rectangle, along the view; below 0 towards the eye; "
         "must be given"),
    REAL(struct cs_viewpoint_force, duration, "s", ABSENT, 1e-9, BIG,
         "with at: the impulse on each particle is force times this; absent: 1/60"),
    REAL(struct cs_viewpoint_force, refresh, "1/s", ABSENT, 0, 1e5,
         "with from and to: rate of visibility tests; 0: only at from; absent: 60"),
    INT(struct cs_viewpoint_force, body, "", -1, 0, 4294967295.0,
        "number of the body from 0 that it acts on; absent: every body"),
};

static const struct cs_table viewpoint_force_table = {
    ROWS(viewpoint_force_rows), .size = sizeof(struct cs_viewpoint_force), .optional = true};

static const struct cs_option ramp_rows[] = {
    TEXT(struct cs_ramp, key,
         "path of a number of forces, springs, strain limit, friction or absorption, such as "
         "bodies[0].springs.stretch or forces.gravity[1]; must be given"),
    REAL(struct cs_ramp, value, "", ABSENT, -1e12, 1e12,
         "new value, within the key's range; must be given"),
};

static const struct cs_table ramp_table = {ROWS(ramp_rows), .size = sizeof(struct cs_ramp),
                                           .optional = true};

static const char *const motion_names[] = {"linear", "smooth", NULL};

static const struct cs_option path_rows[] = {
    REAL(struct cs_path_point, at, "s", ABSENT, 0, BIG,
         "when the point is reached; must be given"),
    VECTOR(struct cs_path_point, point, 3, "m", NULL, -BIG, BIG,
           "position of the first particle then; the others keep their offsets from it"),
};

static const struct cs_table path_table = {ROWS(path_rows),
                                           .size = sizeof(struct cs_path_point)};

static const struct cs_option grab_rows[] = {
    AIM_ROWS(struct cs_grab),
    LIST(struct cs_grab, path, path_table,
         "points after the position where it is grabbed, in order of time; it stays at the "
         "last"),
    CHOICE(struct cs_grab, motion, motion_names, CS_MOTION_LINEAR,
           "from point to point at constant velocity, or by a cubic that rests at each point, "
           "followed in 16 chords"),
    BOOL(struct cs_grab, relative, 0,
         "points are displacements from the position where each particle was grabbed"),
    TABLE(struct cs_grab, to, cs_holder_table,
          "instead of a path: what carries the particles from where it is then"),
    VECTOR(struct cs_grab, spin, 3, "rad/s", zero3, -BIG, BIG,
           "angular velocity of the particles about the centre, which follows the path"),
    VECTOR(struct cs_grab, centre, 3, "m", absent3, -BIG, BIG,
           "of the spin, when the grab begins; absent: the mean of the particles"),
};

static const struct cs_table grab_table = {ROWS(grab_rows), .size = sizeof(struct cs_grab),
                                           .optional = true};

static const struct cs_option hold_rows[] = {AIM_ROWS(struct cs_pin_change)};

static const struct cs_table hold_table = {
    ROWS(hold_rows), .size = sizeof(struct cs_pin_change), .optional = true};

static const struct cs_option shift_rows[] = {
    REAL(struct cs_path_point, at, "s", ABSENT, 0, BIG,
         "when the point is reached; must be given"),
    VECTOR(struct cs_path_point, point, 3, "m", NULL, -BIG, BIG,
           "displacement then, from the position at the start of the event; a position without "
           "relative"),
};

static const struct cs_table shift_table = {ROWS(shift_rows),
                                            .size = sizeof(struct cs_path_point)};

static const struct cs_option move_rows[] = {
    INT(struct cs_move, collider, "", -1, 0, 4294967295.0,
        "number of the collider from 0; must be given"),
    LIST(struct cs_move, path, shift_table,
         "displacements in order of time; it stays at the last"),
    CHOICE(struct cs_move, motion, motion_names, CS_MOTION_LINEAR, "as in grab"),
    BOOL(struct cs_move, relative, 1,
         "points are displacements; false: positions of the centre"),
    VECTOR(struct cs_move, spin, 3, "rad/s", zero3, -BIG, BIG,
           "angular velocity about the centre, which follows the path"),
    VECTOR(struct cs_move, centre, 3, "m", absent3, -BIG, BIG,
           "of the spin, such as a hinge, when the move begins; absent: the collider's centre, "
           "a plane's point or a floor's x = z = 0"),
};

static const struct cs_table move_table = {ROWS(move_rows), .size = sizeof(struct cs_move),
                                           .optional = true};

static const struct cs_option unsew_rows[] = {
    INT(struct cs_unsew, seam, "", -1, 0, 4294967295.0,
        "number of the seam from 0; must be given"),
};

static const struct cs_table unsew_table = {ROWS(unsew_rows), .size = sizeof(struct cs_unsew),
                                            .optional = true};

static const struct cs_option event_rows[] = {
    REAL(struct cs_event, at, "s", ABSENT, 0, BIG, "time of an instantaneous event"),
    REAL(struct cs_event, from, "s", ABSENT, 0, BIG, "start time, instead of at"),
    REAL(struct cs_event, to, "s", ABSENT, 0, BIG, "end time, with from"),
    TABLE(struct cs_event, impact, impact_table, "an impulse on particles or bodies"),
    TABLE(struct cs_event, wind, gust_table,
          "another wind; over an interval its vector changes linearly"),
    TABLE(struct cs_event, viewpoint_force, viewpoint_force_table,
          "an impulse, or over an interval a wind, on the particles visible in a rectangle "
          "from a viewpoint"),
    TABLE(struct cs_event, ramp, ramp_table,
          "another value for a key; over an interval it changes linearly"),
    TABLE(struct cs_event, grab, grab_table, "particles follow a path, until to or a release"),
    TABLE(struct cs_event, pin, hold_table,
          "particles keep their position, until to or a release"),
    TABLE(struct cs_event, release, hold_table,
          "particles become free and keep their velocity"),
    TABLE(struct cs_event, move, move_table,
          "a collider moves along a path and turns, until to or another move"),
    TABLE(struct cs_event, unsew, unsew_table, "the stitches of a seam are gone"),
};

const struct cs_table cs_event_table = {ROWS(event_rows), .size = sizeof(struct cs_event),
                                        .one_of = true, .n_always_optional = 3};
