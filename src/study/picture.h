/* picture.h - the pictures of one run: renderer, textures, and the values that colours show. */
#ifndef CS_PICTURE_H
#define CS_PICTURE_H

#include "draw/render.h"
#include "sim/folders.h"
#include "sim/run.h"

/* Zeroed: closed. */
struct cs_picture {
    const struct cs_scene *scene;   /* borrowed */
    const struct cs_system *system; /* borrowed */
    const struct cs_renderer *renderer;
    struct cs_canvas *canvas;  /* owned */
    struct cs_image *textures; /* (scene->bodies.n), owned */
    double *scalar, *work;     /* (n), (3,n), owned; NULL unless the look colours by a value */
    double *goals;             /* (3,n), owned; NULL unless the look shows them */
    double range[2];           /* of the colours of the last picture */
    double seconds;            /* spent in drawing */
};

/* Loads the renderer and the textures. Scene and system must outlive the picture. On failure
 * the picture is closed; CS_ERR_MODULE, CS_ERR_FILE (a texture) or CS_ERR_MEMORY. */
enum cs_status cs_picture_open(struct cs_picture *picture, const struct cs_system *system,
                               enum cs_gl gl, bool fast, struct cs_error *error);

/* Draws the state of a run into an image of the scene's size. */
enum cs_status cs_picture_paint(struct cs_picture *picture, const struct cs_run *run,
                                struct cs_image *image, struct cs_error *error);

/* true if the colours show a value, so that picture->range has a meaning; its unit. */
bool cs_picture_is_coloured(const struct cs_scene *scene);
const char *cs_picture_unit(const struct cs_scene *scene);

/* What drew the pictures. */
const char *cs_picture_renderer(const struct cs_picture *picture);

void cs_picture_close(struct cs_picture *picture);

#endif
