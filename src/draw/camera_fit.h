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

#include "model/contact/posed_collider.h"
#include "scene/picture_keys.h"

#include <math.h>

enum { CS_CAMERA_FIT_CORNERS = 8 };

/* View direction and field of view, prepared; zeroed: not begun. */
struct cs_camera_fit {
    struct cs_camera camera; /* the one given: direction, field of view, up */
    double axes[3][3];       /* right, up, back: unit vectors */
    double slope, aspect;    /* tangent of half the field of view; width over height */
    /* (3, CS_CAMERA_FIT_CORNERS) points in m that each picture shows beside those given */
    double corners[3 * CS_CAMERA_FIT_CORNERS];
    bool has_corners;
    /* collider + 1 with which the corners move, and its centre at the start; 0: they do not */
    uint32_t follows;
    double follows_from[3];
};

/* Prepares fits of cameras with the direction of `camera`, for the pictures of `render`: for
 * what the colour bar leaves of their width. */
void cs_camera_fit_begin(struct cs_camera_fit *fit, const struct cs_camera *camera,
                         const struct cs_render *render);

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

/* Extends the box from low to high by a collider, if it is visible and no plane. */
void cs_box_grow_by_collider(double low[3], double high[3],
                             const struct cs_posed_collider *collider);

/* The fit of CS_FRAME_START. Its corners are those of the box from low to high of all that
 * there is at the start, extended by visible colliders at each point of their paths. Where that
 * more than doubles the box's width or height, the camera goes with the collider that goes
 * farthest instead, so that who walks through a scene stays large. The box is then extended
 * downwards to a near floor, else by half its width; as what falls or hangs down comes inwards,
 * its lower side is narrower, by a quarter at most on each side. All of this follows from the
 * scene alone: neither the number of frames nor where a run is resumed changes a picture.
 * Where the scene leaves eye and target at their defaults, five more directions are tried in
 * turn: one is taken if fewer of the start's particles, by 2 % at least, are hidden by
 * colliders (scene->colliders.n, at the start), there or moved to any point of their paths. A
 * body counts once more where the middle of it, fallen onto colliders, is hidden: in a bowl. */
void cs_camera_fit_start(struct cs_camera_fit *fit, const struct cs_system *system,
                         const struct cs_posed_collider *colliders, const double low[3],
                         const double high[3]);

/* The camera of a picture that shows the corners and the points x (3,n), each side with a
 * margin of a twentieth at least: it stands still, or goes with the collider that it follows,
 * as long as the points are in the picture. colliders (scene->colliders.n): at its time. */
void cs_camera_fit_picture(const struct cs_camera_fit *fit,
                           const struct cs_posed_collider *colliders, size_t n, const double *x,
                           struct cs_camera *camera);

#endif
