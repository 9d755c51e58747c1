/* study_scenes.h - the struct of a scene, for studies and commands that look into it; and
 * scenes of studies of stability: one value of a scene varied over the columns of a map. */
#ifndef CS_STUDY_SCENES_H
#define CS_STUDY_SCENES_H

#include "session/scene_view.h"
#include "session/session.h"

/* Values that a map can vary. */
enum cs_axis {
    CS_AXIS_STIFFNESS,
    CS_AXIS_DAMPING,
    CS_AXIS_MASS,
    CS_AXIS_RESOLUTION,
    CS_AXIS_YOUNG,
    CS_AXES
};

extern const char *const cs_axis_names[]; /* closed by NULL */

/* Unit of the axis, as text. */
const char *cs_axis_unit(enum cs_axis axis);

/* Values from..to; 0, 0: chosen by the scene. */
struct cs_range {
    double from, to;
};

/* Appends to the session's overrides those that give every body of the scene the value on the
 * axis, in proportion to what the scene has; cells of the grid for the resolution. The longer
 * list is the arena's. */
enum cs_status cs_axis_overrides(const struct cs_system *system, enum cs_axis axis,
                                 double value, struct cs_arena *arena,
                                 struct cs_session_settings *session, struct cs_error *error);

/* The scene's own value: that of the first body (stretch stiffness, damping, mass of a
 * particle, columns of the grid, Young's modulus or that of the warp); 0 where it has none. */
double cs_axis_scene_value(const struct cs_system *system, enum cs_axis axis);

/* Values that the axis covers where none are asked for. */
struct cs_range cs_axis_range(const struct cs_system *system, enum cs_axis axis);

#endif
