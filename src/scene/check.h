/* check.h - what a check of a scene says: which value is at fault, and why. */
#ifndef CS_SCENE_CHECK_H
#define CS_SCENE_CHECK_H

#include "scene/scene.h"

/* Where the check stands, for messages. */
struct cs_check {
    char *path; /* CS_TEXT_MAX bytes of the caller */
    struct cs_error *error;
};

/* CS_ERR_SCENE, with the path of the value at fault and what is wrong with it. */
enum cs_status cs_check_refuse(const struct cs_check *at, const char *path, const char *format,
                               ...) __attribute__((format(printf, 3, 4)));

double cs_check_length(const double *v, int n);

/* Makes v (n) a unit vector, or refuses the zero vector. One that is unit already keeps its
 * bits, so that the resolved scene runs to the same hash as the scene it came from. */
enum cs_status cs_check_unit(const struct cs_check *at, const char *path, double *v, int n);

/* The rotation of the place of BODY.SHAPE: a matrix is checked, a quaternion made unit. */
enum cs_status cs_check_pose(const struct cs_check *at, const char *body, const char *shape,
                             struct cs_pose *place);

#endif
