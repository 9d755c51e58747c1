/* render.h - the interface of renderers: a table of four calls that a module exports.
 *
 * The module render-cpu.so needs nothing but the processor; render-osmesa.so holds
 * everything that touches OpenGL. They are loaded only when a frame is requested
 * (cs_renderer_open).
 *
 * A canvas belongs to the thread that made it. Another thread may step scene and system while
 * it paints: of everything that steps and events change, a canvas reads the frame alone.
 */
#ifndef CS_RENDER_H
#define CS_RENDER_H

#include "base/image.h"
#include "base/status.h"
#include "model/contact/posed_collider.h"
#include "model/system/particle_system.h"

struct cs_canvas;

/* Inputs of a canvas that stay the same for all its pictures. */
struct cs_canvas_settings {
    const struct cs_scene *scene; /* checked; borrowed while the canvas lives */
    bool scene_varies; /* lights, materials, colours or field of view change from picture to
                          picture; else the scene stays as it is */
    const struct cs_system *system; /* borrowed while the canvas lives */
    const struct cs_image
        *textures; /* (scene->bodies.n), width 0: none; needed by create only */
    const struct cs_posed_collider
        *colliders; /* (scene->colliders.n), at the start; needed by create only */
    /* (n) particles to mark by discs: 2 by a large one, 1 by a small one; borrowed while the
     * canvas lives; NULL: none */
    const uint8_t *marks;
    bool fast_render; /* of OpenGL: do not pin the CPU capabilities: 1.4 times faster, pixels
                  depend on the machine */
    uint32_t threads; /* that may draw at the same time; the picture does not depend on them */
    /* runs the blocks of a loop on them, as cs_pool_run does; NULL: in order */
    void (*parallel_for)(uint32_t blocks, void (*task)(void *arg, uint32_t block), void *arg);
};

/* Inputs of one picture; all pointers are borrowed for the call of paint. */
struct cs_frame {
    double t;        /* s */
    const double *x; /* (3,n) positions in m */
    const double
        *scalar;     /* (n) force in N or strain, for the looks that colour by it; else NULL */
    double range[2]; /* values at the ends of the colour map, lower first */
    const char *title;   /* of the colour bar: quantity and unit; NULL: no bar */
    double factor;       /* from values to its labels, such as 100 for % */
    const double *goals; /* (3,n) m, of look goals; else NULL */
    const uint8_t
        *triangle_marks;    /* (n_triangles of the surfaces), of look crossings; else NULL */
    const double *inv_mass; /* (n) in 1/kg; 0: pinned, which some looks mark */
    const struct cs_posed_collider *colliders; /* (scene->colliders.n) at t */
};

#define CS_RENDERER_ABI 9u /* raised with every change of the structs above or below */
/* A renderer; the module exports it as clothsim_renderer. */
struct cs_renderer {
    unsigned abi;
    const char *name; /* as in the names of enum cs_renderer_kind */
    /* Makes a context, shaders and buffers for this scene. On failure CS_ERR_MODULE, *canvas
     * NULL. */
    enum cs_status (*create)(const struct cs_canvas_settings *settings,
                             struct cs_canvas **canvas, struct cs_error *error);
    /* Draws a frame into an image with room for scene->render->size. If the image has no alpha,
     * a transparent background becomes white. */
    enum cs_status (*paint)(struct cs_canvas *canvas, const struct cs_frame *frame,
                            struct cs_image *image, struct cs_error *error);
    /* Renderer, version and capabilities: pixels are equal if this text is. */
    const char *(*description)(const struct cs_canvas *canvas);
    void (*destroy)(struct cs_canvas *canvas); /* NULL is fine */
};

enum cs_renderer_kind { CS_RENDERER_AUTO, CS_RENDERER_CPU, CS_RENDERER_OSMESA };
extern const char *const cs_renderer_names[];

/* Loads the module of a renderer from folder, once per process. auto takes the one without
 * OpenGL, else OSMesa. On failure CS_ERR_MODULE, and the message says which package to install.
 */
enum cs_status cs_renderer_open(const char *folder, enum cs_renderer_kind kind,
                                const struct cs_renderer **renderer, struct cs_error *error);

#endif
