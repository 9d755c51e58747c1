/* check.h - failures of a scene's checks, and checks of directions and placements; the keys of
 * a placement, which bodies and meshes share, and of a holder, which pins and grabs share. */
#ifndef CS_SCENE_CHECK_H
#define CS_SCENE_CHECK_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct cs_body;
struct cs_list;
struct cs_scene;

/* A rigid placement x = R p + translate; R from the matrix, or from the quaternion. */
struct cs_pose {
    double translate[3]; /* m */
    double rotate[4];    /* quaternion x, y, z, w; normalised by cs_scene_check */
    double matrix[9];    /* rows of a rotation matrix; first element NAN: absent */
};

/* A collider that carries particles along. */
struct cs_holder {
    bool present;
    int64_t collider; /* -1: not given, refused */
};

/* Destination of a failure: the JSON path of the faulty value, and the message. */
struct cs_check {
    char *path; /* CS_TEXT_MAX bytes of the caller */
    struct cs_error *error;
};

/* Fails with CS_ERR_SCENE: stores the path of the faulty value and the message. */
enum cs_status cs_check_refuse(const struct cs_check *check, const char *path,
                               const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Euclidean length of v (n). */
double cs_check_length(const double *v, int n);

/* Makes v (n) a unit vector; refuses the zero vector. A vector that is unit to 1e-14 keeps its
 * bits, so that a resolved scene runs to the same hash as the scene that it came from. */
enum cs_status cs_check_unit(const struct cs_check *check, const char *path, double *v, int n);

/* Checks the rotation of BODY.SHAPE.place: a matrix must be a rotation, a quaternion is made
 * unit. */
enum cs_status cs_check_pose(const struct cs_check *check, const char *body, const char *shape,
                             struct cs_pose *place);

/* Checks that the faces that a material colours exist, and that it has no texture beside. */
enum cs_status cs_check_faces(const struct cs_check *check, const char *body,
                              const struct cs_body *of);

/* Checks the constants of an elastic body. */
enum cs_status cs_elastic_check(const struct cs_check *check, const char *body,
                                const struct cs_body *of);

/* Checks that a body, or the mesh of a collider, has the particles of a list at `path`; name:
 * "body 0". */
enum cs_status cs_particles_check(const struct cs_check *check, const char *path,
                                  const struct cs_list *particles, const struct cs_body *owner,
                                  const char *name);

/* Checks that bodies, particles, weights and lengths of the scene's seams are possible. */
enum cs_status cs_seams_check(const struct cs_check *check, const struct cs_scene *scene);

/* Checks of a scene's events that ranges cannot express. */

/* Checks that times are in order, particles exist and keys can change; normalises directions
 * and fills absent values of viewpoints. cs_scene_check calls it, and its failures are alike:
 * path_out (CS_TEXT_MAX bytes) gets the JSON path. */
enum cs_status cs_events_check(struct cs_scene *scene, char *path_out, struct cs_error *error);

#endif
