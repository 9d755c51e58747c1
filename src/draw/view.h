/* view.h - inputs that all shaders share: camera, light, background, colour map. */
#ifndef CS_DRAW_VIEW_H
#define CS_DRAW_VIEW_H

#include "draw/camera_fit.h"
#include "draw/render.h"
#include "model/contact/posed_collider.h"
#include "model/system/particle_system.h"
#include "scene/picture_keys.h"

enum { CS_VIEW_BINDING = 0, CS_VIEW_STOPS = 6 };

/* A light in the uniform block View. */
struct cs_view_light {
    float world_to_light[16];      /* by columns, to the clip space of its shadow map */
    float place[4];                /* w 1: position of a lamp; w 0: direction to the sun */
    float diffuse[4], specular[4]; /* linear RGB, times its strength */
    float shadow_params[4]; /* size of a shadow texel in 0..1 and in m; 1 where there is a
                               shadow; fraction of the diffuse light of all */
};

/* The uniform block View of the shaders in std140 layout: mat4 and vec4 only. */
struct cs_view_block {
    float world_to_clip[16]; /* by columns */
    float eye[4];            /* w 1: position; w 0: direction to an orthographic eye */
    float ambient[4];        /* linear RGB of the light from everywhere */
    float size[4];           /* width, height in pixels; near plane in m; number of lights */
    float sky[4];            /* what surfaces of some looks are tinted by */
    float top_colour[4],
        bottom_colour[4]; /* background at the upper and the lower edge; 1: it covers */
    float colour_stops[CS_VIEW_STOPS][4]; /* the colour map, linear RGB, lowest first */
    float jitter[4]; /* of OpenGL: pixels by which this pass moves the picture, x and y up */
    struct cs_view_light lights[CS_LIGHTS];
};

/* View of the current frame. */
struct cs_view_state {
    struct cs_view_block block;
    uint32_t n_lights;        /* of the block */
    bool casts[CS_LIGHTS];    /* those that shall cast shadows */
    unsigned buffer;          /* of OpenGL, made by the first upload */
    double pixels_per_m;      /* at the camera's target */
    struct cs_camera camera;  /* of this frame */
    double depth[2];          /* m along the view of the near and the far plane */
    double haze;              /* m: cs_view_haze at the start */
    struct cs_camera_fit fit; /* of CS_FRAME_START */
    double shift;             /* of the picture to the left, in halves of its width */
};

/* A sphere around everything that is drawn. */
struct cs_bounding_sphere {
    double centre[3], radius;
    double low[3], high[3]; /* m: the box that it encloses */
};

/* Fills the state from the scene at time 0, with its colliders (scene->colliders.n) there;
 * `extent` lies between near and far plane. */
void cs_view_init(struct cs_view_state *view, const struct cs_system *system,
                  const struct cs_posed_collider *colliders,
                  const struct cs_bounding_sphere *sphere);

/* Fills lights and background from a scene. */
void cs_view_set_colours(struct cs_view_state *view, const struct cs_scene *scene);

/* Returns true if the camera may change from frame to frame: it follows a path, or fits itself
 * to the bodies. */
bool cs_view_varies(const struct cs_scene *scene);

/* Moves a camera that varies to the time of a frame of n particles: along its path, or fitted
 * to the bodies. */
void cs_view_move(struct cs_view_state *view, const struct cs_scene *scene,
                  const struct cs_bounding_sphere *sphere, size_t n,
                  const struct cs_frame *frame);

/* Uploads the block as a uniform buffer; OpenGL only. */
void cs_view_upload(struct cs_view_state *view);

/* The frusta of the shadow maps: a cone or box of light around all casters.
 */

enum { CS_SHADOW_SIDE = 512 }; /* texels: coarse enough to blur the edges */

/* Fits those of all lights of the view that cast shadows. */
void cs_light_frusta_fit(const struct cs_bounding_sphere *sphere, struct cs_view_state *view);

/* Returns a sphere around the particles at x (3,n) and the visible colliders
 * (scene->colliders.n) but planes: around their bounding box, with a radius of 1 mm at least.
 */
struct cs_bounding_sphere cs_scene_extent_solid(const struct cs_system *system, const double *x,
                                                const struct cs_posed_collider *colliders);

/* Distance in m from the centre of a scene at which haze hides the ground. */
static inline double cs_view_haze(const struct cs_bounding_sphere *sphere) {
    return 12 * sphere->radius;
}

/* The largest distance of neighbours in the bodies at rest, in m; 0 for lone particles. */
double cs_scene_extent_cell(const struct cs_system *system);

#endif
