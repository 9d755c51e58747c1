/* Messages of checks, and the checks of directions and rotations. */
#include "scene/check.h"

#include <clothsim/option.h>
#include <math.h>
#include <stdio.h>

enum cs_status cs_check_refuse(const struct cs_check *check, const char *path,
                               const char *format, ...) {
    char message[512];
    CS_FORMAT(message, format);
    snprintf(check->path, CS_TEXT_MAX, "%s", path);
    return cs_fail(check->error, CS_ERR_SCENE, "%s", message);
}

double cs_check_length(const double *v, int n) {
    double squared = 0;
    for (int i = 0; i < n; i++)
        squared += v[i] * v[i];
    return sqrt(squared);
}

enum cs_status cs_check_unit(const struct cs_check *check, const char *path, double *v, int n) {
    const double length = cs_check_length(v, n);
    if (length < 1e-12)
        return cs_check_refuse(check, path, "the zero vector has no direction");
    if (fabs(length - 1) > 1e-14)
        for (int i = 0; i < n; i++)
            v[i] /= length;
    return CS_OK;
}

/* Checks that M M^T = I to 1e-6 per element, and that the determinant is above 0. */
static enum cs_status check_matrix(const struct cs_check *check, const char *path,
                                   const double *m) {
    const double determinant = m[0] * (m[4] * m[8] - m[5] * m[7]) -
                               m[1] * (m[3] * m[8] - m[5] * m[6]) +
                               m[2] * (m[3] * m[7] - m[4] * m[6]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++) {
            const double product =
                m[3 * i] * m[3 * j] + m[3 * i + 1] * m[3 * j + 1] + m[3 * i + 2] * m[3 * j + 2];
            if (!(fabs(product - (i == j)) <= 1e-6))
                return cs_check_refuse(
                    check, path,
                    "rows %d and %d have the dot product %.9g: not a rotation matrix", j, i,
                    product);
        }
    if (!(determinant > 0))
        return cs_check_refuse(check, path,
                               "a mirror image (determinant %.3g): not a rotation matrix",
                               determinant);
    return CS_OK;
}

enum cs_status cs_check_pose(const struct cs_check *check, const char *body, const char *shape,
                             struct cs_pose *place) {
    char path[128];
    if (!isnan(place->matrix[0])) {
        snprintf(path, sizeof path, "%s.%s.place.matrix", body, shape);
        return check_matrix(check, path, place->matrix);
    }
    snprintf(path, sizeof path, "%s.%s.place.rotate", body, shape);
    return cs_check_unit(check, path, place->rotate, 4);
}
