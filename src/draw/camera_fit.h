/* camera_fit.h - the nearest camera that shows given points as large as a picture allows.
 *
 * In axes along the picture, a camera at (cx, cy, cz) shows a point (X, Y, Z) at height
 *   (Y - cy) / (slope (cz - Z)), from -1 to 1.
 * All points lie within -h to h if, with s = h slope,
 *   Y + s Z <= cy + s cz   and   -Y + s Z <= -cy + s cz   for each of them.
 * Let U and L be the maxima of the left sides. The nearest camera has equality in both:
 *   cy = (U - L) / 2,   cz = (U + L) / (2 s).
 * Width works likewise. The larger cz of the two is taken; cx and cy stay. */
#ifndef CS_DRAW_CAMERA_FIT_H
#define CS_DRAW_CAMERA_FIT_H

#include "scene/scene.h"

/* View direction and field of view, prepared; zeroed: not begun. */
struct cs_camera_fit {
    struct cs_camera camera; /* the one given: direction, field of view, up */
    double axes[3][3];       /* right, up, back: unit vectors */
    double slope, aspect;    /* tangent of half the field of view; width over height */
};

/* Prepares fits of cameras with the direction of `camera`, for a picture of size[0] x
 * size[1]. */
void cs_camera_fit_begin(struct cs_camera_fit *fit, const struct cs_camera *camera,
                         const int64_t size[2]);

/* Writes a camera whose direction is the fit's and whose picture holds the n points x (3,n) in
 * m: they fill the fraction `share` of its height, or 0.96 of its width if that comes first. */
void cs_camera_fit_solve(const struct cs_camera_fit *fit, size_t n, const double *x,
                         double share, struct cs_camera *camera);

/* Picture heights of the lowest and the highest point: -1 is the lower edge, 1 the upper. */
void cs_camera_fit_rows(const struct cs_camera_fit *fit, const struct cs_camera *camera,
                        size_t n, const double *x, double rows[2]);

/* Selects from the points x (3,n) those that bound the view of any camera of this fit: out (3,
 * CS_CAMERA_FIT_EXTREMES). They are the extremes along 9 slopes from 0 to the full one, for
 * four sides, and along the view. Points that are not finite are skipped. A whole run can thus
 * be fitted from a few points per frame. */
enum { CS_CAMERA_FIT_STEPS = 8, CS_CAMERA_FIT_EXTREMES = 4 * (CS_CAMERA_FIT_STEPS + 1) + 2 };
void cs_camera_fit_extremes(const struct cs_camera_fit *fit, size_t n, const double *x,
                            double *out);

/* The camera of CS_FRAME_START: it shows the box from low to high of all that there is at the
 * start, and what is below it as far as a near floor, else by half the box's width. */
struct cs_camera cs_camera_fit_start(const struct cs_scene *scene, const double low[3],
                                     const double high[3]);

#endif
