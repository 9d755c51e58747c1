/* camera_fit.h - a camera that shows some places as large as a picture allows.
 *
 * In axes along the picture, a place (X, Y, Z) is seen by a camera at (cx, cy, cz) at the
 * height (Y - cy) / (slope (cz - Z)) of -1 to 1. That all lie within -h to h means that no Y +
 * h slope Z exceeds cy + h slope cz, and no -Y + h slope Z exceeds -cy + h slope cz: the
 * greatest of both give cy and cz. */
#ifndef CS_DRAW_CAMERA_FIT_H
#define CS_DRAW_CAMERA_FIT_H

#include "scene/scene.h"

/* Zeroed: not begun. */
struct cs_camera_fit {
    struct cs_camera camera; /* from where it looks, how wide, which way is up */
    double axes[3][3];       /* right, up, back: unit vectors */
    double slope, aspect;    /* tangent of half the field of view; width over height */
};

void cs_camera_fit_begin(struct cs_camera_fit *fit, const struct cs_camera *camera,
                         const int64_t size[2]);

/* Moves a camera, which looks as that of the fit, so that the places x (3,n) reach over `share`
 * of the picture's height, or over its width where that is full first. */
void cs_camera_fit_solve(const struct cs_camera_fit *fit, size_t n, const double *x,
                         double share, struct cs_camera *camera);

/* Heights of the lowest and the highest place in a camera's picture: -1 its lower, 1 its upper
 * edge. */
void cs_camera_fit_rows(const struct cs_camera_fit *fit, const struct cs_camera *camera,
                        size_t n, const double *x, double rows[2]);

/* Of the places x (3,n) those that bound what cameras of this fit see: out (3,
 * CS_CAMERA_FIT_EXTREMES). What is not finite is passed over. */
enum { CS_CAMERA_FIT_STEPS = 8, CS_CAMERA_FIT_EXTREMES = 4 * (CS_CAMERA_FIT_STEPS + 1) + 2 };
void cs_camera_fit_extremes(const struct cs_camera_fit *fit, size_t n, const double *x,
                            double *out);

#endif
