/* frame_picture.h - draws the pictures of one run: renderer, textures, and the values that
 * colours show.
 *
 * begin copies the state of a run; end waits for the picture. In between a worker thread draws,
 * and the caller may step the run. */
#ifndef CS_FRAME_PICTURE_H
#define CS_FRAME_PICTURE_H

#include "base/install_paths.h"
#include "base/png.h"
#include "base/worker_thread.h"
#include "draw/look.h"
#include "draw/render.h"
#include "scene/picture_keys.h"
#include "sim/run_state.h"

/* A ramp of a number that only pictures show (is_picture_key). */
struct cs_picture_ramp {
    double *value;          /* in `drawn` */
    double from, to, start; /* s, s, the number before all ramps */
    double last;            /* the number from `to` on */
};

/* Pictures of one run; zeroed: closed. Must not move in memory while open. */
struct cs_picture {
    const struct cs_scene *scene;  /* borrowed, or `drawn` */
    struct cs_scene *drawn;        /* owned, with the numbers of its ramps at t; or NULL */
    struct cs_picture_ramp *ramps; /* (n_ramps), owned, by their begin */
    uint32_t n_ramps;
    const struct cs_system *system; /* borrowed */
    const struct cs_renderer *renderer;
    struct cs_canvas *canvas;  /* owned */
    struct cs_image *textures; /* (scene->bodies.n), owned */
    double *x, *inv_mass;      /* (3,n), (n), owned: the run as it was at begin */
    double *scalar, *work;     /* (n), (3,n), owned; NULL unless the look colours by a value */
    const double *values;      /* (n), borrowed: see cs_snapshot_draw; or NULL */
    double *goals;             /* (3,n), owned; NULL unless the look shows them */
    uint8_t *marks;            /* (n) of particles, owned; NULL unless the scene marks some */
    uint8_t *triangle_marks;   /* of triangles, owned; NULL unless the look shows them */
    struct cs_posed_collider
        *colliders;  /* (scene->colliders.n), owned: as they were at begin */
    double t;        /* s, of the picture begun last */
    double range[2]; /* of its colours */
    double seconds;  /* spent in drawing, until the picture ended last */
    bool fast_render;
    struct cs_worker_thread *worker; /* owned: has the canvas; NULL: the caller has it */
    struct cs_image *image;          /* borrowed, of the picture under way */
    struct cs_error error;           /* of the drawing */
};

/* Loads the renderer and the textures. Scene and system must outlive the picture. beside: draw
 * on a separate thread, unless the scene draws the visibility of viewpoint forces; otherwise
 * begin draws at once, with the same result. On failure the picture is closed; CS_ERR_MODULE,
 * CS_ERR_FILE (a texture) or CS_ERR_MEMORY. */
enum cs_status cs_picture_open(struct cs_picture *picture, const struct cs_system *system,
                               enum cs_renderer_kind kind, bool fast, bool beside,
                               struct cs_error *error);

/* Begins to draw the state of a run into an image of the scene's size, which must not be
 * touched before the end. The last picture must have ended. */
void cs_picture_begin(struct cs_picture *picture, const struct cs_run *run,
                      struct cs_image *image);
/* Waits for the picture. CS_ERR_MODULE or CS_ERR_MEMORY if it failed; the first failure is
 * repeated at each further call. CS_OK if none is in progress and none failed. */
enum cs_status cs_picture_end(struct cs_picture *picture, struct cs_error *error);

/* Fills the value by which the scene's look colours each particle: scalar (n); work (3,n) is
 * scratch. */
void cs_picture_values(const struct cs_system *system, const struct cs_run *run, double *scalar,
                       double *work);
/* Range of a value up to a magnitude: symmetric about 0 if it has a sign, else from 0. */
void cs_picture_range(const struct cs_scene *scene, double most, double range[2]);

/* true if the colours show a value, so that picture->range has a meaning. */
bool cs_picture_is_coloured(const struct cs_scene *scene);

/* Description of the renderer; it belongs to the open picture. */
const char *cs_picture_renderer(const struct cs_picture *picture);

/* Waits for the picture in progress and frees everything. */
void cs_picture_close(struct cs_picture *picture);

/* Draws the state of a run once, at the size of its scene. values (n): colours of a look that
 * has some, in place of its own and without its bar; NULL: its own. The caller frees
 * image->rgb, also on failure; image->alpha is the caller's. Adds the renderer's description.
 */
enum cs_status cs_snapshot_draw(const struct cs_run *run, const double *values,
                                enum cs_renderer_kind kind, struct cs_image *image,
                                struct cs_text *renderer, struct cs_error *error);

#endif
