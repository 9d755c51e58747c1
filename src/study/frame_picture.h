/* frame_picture.h - the pictures of one run: renderer, textures, and the values that colours
 * show.
 *
 * A picture is begun from the state of a run and ended when it is wanted. In between it is
 * drawn beside the caller, who may step the run on. */
#ifndef CS_FRAME_PICTURE_H
#define CS_FRAME_PICTURE_H

#include "base/worker_thread.h"
#include "draw/look.h"
#include "draw/render.h"
#include "sim/install_paths.h"
#include "sim/run.h"

/* Zeroed: closed. Must stay where it is while open. */
struct cs_picture {
    const struct cs_scene *scene;   /* borrowed */
    const struct cs_system *system; /* borrowed */
    const struct cs_renderer *renderer;
    struct cs_canvas *canvas;  /* owned */
    struct cs_image *textures; /* (scene->bodies.n), owned */
    double *x, *inv_mass;      /* (3,n), (n), owned: the run as it was at begin */
    double *scalar, *work;     /* (n), (3,n), owned; NULL unless the look colours by a value */
    double *goals;             /* (3,n), owned; NULL unless the look shows them */
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
 * on a thread of its own, unless the scene draws what viewpoint forces see; else begin draws at
 * once, and the same. On failure the picture is closed; CS_ERR_MODULE, CS_ERR_FILE (a texture)
 * or CS_ERR_MEMORY. */
enum cs_status cs_picture_open(struct cs_picture *picture, const struct cs_system *system,
                               enum cs_renderer_kind kind, bool fast, bool beside,
                               struct cs_error *error);

/* Begins to draw the state of a run into an image of the scene's size, which must not be
 * touched before the end. The picture before must have ended. */
void cs_picture_begin(struct cs_picture *picture, const struct cs_run *run,
                      struct cs_image *image);
/* Waits for it; CS_ERR_MODULE or CS_ERR_MEMORY where it failed, and from then on: the first
 * failure is told again. CS_OK where none is under way and none failed. */
enum cs_status cs_picture_end(struct cs_picture *picture, struct cs_error *error);

/* The value by which the scene's look colours each particle of a run: scalar (n), work (3,n).
 */
void cs_picture_values(const struct cs_system *system, const struct cs_run *run, double *scalar,
                       double *work);
/* Its range, up to a magnitude: about 0 where the value has a sign, else from 0. */
void cs_picture_range(const struct cs_scene *scene, double most, double range[2]);

/* true if the colours show a value, so that picture->range has a meaning. */
bool cs_picture_is_coloured(const struct cs_scene *scene);

/* What drew the pictures. */
const char *cs_picture_renderer(const struct cs_picture *picture);

void cs_picture_close(struct cs_picture *picture);

/* Draws the state of a run once, at the size that its scene says. The caller frees image->rgb,
 * also on failure; image->alpha is the caller's. Adds the renderer's description. */
enum cs_status cs_snapshot_draw(const struct cs_run *run, enum cs_renderer_kind kind,
                                struct cs_image *image, struct cs_text *renderer,
                                struct cs_error *error);

#endif
