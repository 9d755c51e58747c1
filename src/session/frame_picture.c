/* Draws the pictures of a run: copies its state, colours it, and paints it while the run goes
 * on. */
#include "session/frame_picture.h"

#include "base/clock.h"
#include "base/pool.h"
#include "draw/srgb.h"
#include "model/contact/ccd/crossings.h"
#include "model/elastic/membrane_forces.h"
#include "model/event/event_state.h"
#include "scene/body_keys.h"
#include "scene/body_particles.h"
#include "scene/collider_keys.h"
#include "scene/force_keys.h"
#include "sim/crash.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool cs_picture_is_coloured(const struct cs_scene *scene) {
    return cs_look_of(scene->render->look)->title;
}

static enum cs_status read_texture(const struct cs_scene *scene, const char *name,
                                   struct cs_image *image, struct cs_error *error) {
    struct cs_text path = {0};
    cs_text_add(&path, "%s/%s", scene->folder, name);
    if (path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the texture \"%s\"", name);
    else
        cs_png_read(cs_text_get(&path), image, error);
    cs_text_finish(&path);
    return error->status;
}

/* Makes a row of texels: the colours of faces, and white for the rest. */
static enum cs_status make_palette(const struct cs_list *list, struct cs_image *image,
                                   struct cs_error *error) {
    const struct cs_face_colour *faces = list->items;
    const size_t n = 3 * ((size_t)list->n + 1);
    struct cs_srgb srgb;
    *image = (struct cs_image){.width = list->n + 1, .height = 1, .rgb = malloc(n)};
    if (!image->rgb)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the colours of faces");
    cs_srgb_make(&srgb);
    memset(image->rgb, 255, n);
    for (size_t k = 0; k < n - 3; k++)
        image->rgb[k] = (uint8_t)cs_srgb_encode(&srgb, (float)faces[k / 3].colour[k % 3]);
    return CS_OK;
}

static enum cs_status read_textures(struct cs_picture *picture, struct cs_error *error) {
    const struct cs_scene *scene = picture->scene;
    picture->textures = calloc(scene->bodies.n, sizeof *picture->textures);
    if (!picture->textures)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for %u textures", scene->bodies.n);
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        const struct cs_material *material = &cs_scene_bodies(scene)[b].material;
        struct cs_image *image = picture->textures + b;
        if ((*material->texture && read_texture(scene, material->texture, image, error)) ||
            (material->faces.n && make_palette(&material->faces, image, error)))
            return error->status;
    }
    return CS_OK;
}

/* Adds a ramp behind those that begin no later. */
static void add_ramp(struct cs_picture *picture, const struct cs_event *event,
                     struct cs_error *error) {
    struct cs_event_key key;
    const bool at_once = !isnan(event->at);
    uint32_t k = picture->n_ramps;
    if (cs_event_key_find(picture->drawn, event->ramp.key, &key, error))
        return;
    const struct cs_picture_ramp ramp = {.value = key.value,
                                         .from = at_once ? event->at : event->from,
                                         .to = at_once ? event->at : event->to,
                                         .start = *key.value,
                                         .last = event->ramp.value};
    for (; k > 0 && picture->ramps[k - 1].from > ramp.from; k--)
        picture->ramps[k] = picture->ramps[k - 1];
    picture->ramps[k] = ramp;
    picture->n_ramps++;
}

/* Gives the pictures a scene of their own if ramps change its looks. */
static enum cs_status make_ramps(struct cs_picture *picture, struct cs_error *error) {
    const struct cs_event *events = cs_scene_events(picture->scene);
    uint32_t n = 0;
    for (uint32_t e = 0; e < picture->scene->events.n; e++)
        n += cs_event_is_picture(events + e);
    if (n == 0)
        return CS_OK;
    picture->drawn = calloc(1, sizeof *picture->drawn);
    picture->ramps = calloc(n, sizeof *picture->ramps);
    if (!picture->drawn || !picture->ramps)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the colours of pictures");
    cs_scene_copy(picture->drawn, picture->scene, &picture->drawn->arena, error);
    for (uint32_t e = 0; e < picture->scene->events.n && !error->status; e++)
        if (cs_event_is_picture(events + e))
            add_ramp(picture, events + e, error);
    picture->scene = picture->drawn;
    return error->status;
}

/* Sets all ramped numbers to those at t: each ramp goes on from what the one before left. */
static void set_ramps(struct cs_picture *picture, double t) {
    for (uint32_t k = 0; k < picture->n_ramps; k++)
        *picture->ramps[k].value = picture->ramps[k].start;
    for (uint32_t k = 0; k < picture->n_ramps; k++) {
        const struct cs_picture_ramp *ramp = picture->ramps + k;
        if (t >= ramp->to)
            *ramp->value = ramp->last;
        else if (t > ramp->from)
            *ramp->value +=
                (ramp->last - *ramp->value) * (t - ramp->from) / (ramp->to - ramp->from);
    }
    for (uint32_t k = 0; picture->n_ramps && k < picture->scene->colliders.n; k++)
        picture->colliders[k].collider = cs_scene_colliders(picture->scene) + k;
}

static void free_ramps(struct cs_picture *picture) {
    if (picture->drawn)
        cs_scene_finish(picture->drawn);
    free(picture->drawn);
    free(picture->ramps);
}

/* Allocates marks of triangles if the look shows crossings. Returns false if out of memory. */
static bool take_marks(struct cs_picture *picture) {
    if (cs_look_of(picture->scene->render->look)->colours != CS_COLOURS_CROSSINGS)
        return true;
    picture->triangle_marks = calloc((size_t)picture->system->surfaces->n_triangles + 1, 1);
    return picture->triangle_marks;
}

/* Marks the particles of render.marks, the first of them by 2. */
static enum cs_status make_marks(struct cs_picture *picture, struct cs_error *error) {
    const struct cs_marks *marks = &picture->scene->render->marks;
    const struct cs_body_range *range = picture->system->bodies + marks->body;
    const uint32_t n = picture->system->view.n;
    struct cs_body body = cs_scene_bodies(picture->scene)[marks->body];
    if (marks->particles.n == 0)
        return CS_OK;
    bool *named = calloc(n, sizeof *named);
    picture->marks = calloc(n, 1);
    body.pins = marks->particles;
    for (int pass = 0; pass < 2 && named && picture->marks; pass++) {
        cs_body_pin(&body, n, range->first, picture->system->start, named + range->first);
        for (uint32_t i = 0; i < n; i++)
            picture->marks[i] = (uint8_t)(picture->marks[i] + named[i]);
        memset(named, 0, n * sizeof *named);
        body.pins.n = 1;
    }
    free(named);
    return named && picture->marks ? CS_OK
                                   : cs_fail(error, CS_ERR_MEMORY, "out of memory for marks");
}

/* Allocates the copies of the state that the scene's look needs. */
static enum cs_status alloc_arrays(struct cs_picture *picture, struct cs_error *error) {
    const size_t n = picture->system->view.n;
    const bool coloured = cs_picture_is_coloured(picture->scene);
    const bool drawn_to = cs_look_of(picture->scene->render->look)->goals;
    picture->x = calloc(n, 3 * sizeof(double));
    picture->colliders = calloc(picture->scene->colliders.n + 1, sizeof *picture->colliders);
    picture->inv_mass = calloc(n, sizeof(double));
    if (coloured) {
        picture->scalar = calloc(n, sizeof(double));
        picture->work = calloc(n, 3 * sizeof(double));
    }
    if (drawn_to)
        picture->goals = calloc(n, 3 * sizeof(double));
    if (!picture->x || !picture->inv_mass || !picture->colliders ||
        (drawn_to && !picture->goals) || !take_marks(picture) ||
        (coloured && (!picture->scalar || !picture->work)))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the pictures of %zu particles",
                       n);
    return CS_OK;
}

static void free_textures(struct cs_picture *picture) {
    for (uint32_t b = 0; picture->textures && b < picture->scene->bodies.n; b++)
        free(picture->textures[b].rgb);
    free(picture->textures);
    picture->textures = NULL;
}

/* Notes the call for crash reports: OpenGL is foreign code, and its libraries may end the
 * program when memory runs out. */
static void watch(const char *renderer, const char *place) {
    cs_crash_watch(CS_CRASH_DRAWING, "renderer", renderer, place);
}

/* Ends the note. A renderer that failed for lack of memory gets CS_ERR_MEMORY. */
static void forget(struct cs_error *error) {
    cs_crash_forget(CS_CRASH_DRAWING);
    if (error->status != CS_ERR_MODULE || !cs_crash_was_starved(CS_CRASH_DRAWING))
        return;
    const struct cs_error said = *error;
    *error = (struct cs_error){0};
    cs_fail(error, CS_ERR_MEMORY, "out of memory: %.900s", said.message);
}

/* Creates the canvas on the worker thread, because all calls on a canvas must come from one
 * thread. */
static void make_canvas(void *object) {
    struct cs_picture *picture = object;
    const struct cs_canvas_settings settings = {.scene = picture->scene,
                                                .scene_varies = picture->n_ramps > 0,
                                                .marks = picture->marks,
                                                .system = picture->system,
                                                .textures = picture->textures,
                                                .colliders = picture->colliders,
                                                .fast_render = picture->fast_render,
                                                .threads = cs_pool_threads(),
                                                .parallel_for = cs_pool_run};
    cs_posed_colliders_at_start(picture->system, picture->colliders);
    watch(picture->renderer->name, "while it was opened");
    picture->renderer->create(&settings, &picture->canvas, &picture->error);
    forget(&picture->error);
}

static enum cs_status open_renderer(enum cs_renderer_kind kind,
                                    const struct cs_renderer **renderer,
                                    struct cs_error *error) {
    cs_crash_begin(CS_CRASH_DRAWING);
    watch(cs_renderer_names[kind], "while it was loaded");
    cs_renderer_open(cs_renderer_folder(), kind, renderer, error);
    forget(error);
    return error->status;
}

enum cs_status cs_picture_open(struct cs_picture *picture, const struct cs_system *system,
                               enum cs_renderer_kind kind, bool fast, bool beside,
                               struct cs_error *error) {
    *picture =
        (struct cs_picture){.scene = system->scene, .system = system, .fast_render = fast};
    if (!read_textures(picture, error) && !make_marks(picture, error) &&
        !make_ramps(picture, error) && !alloc_arrays(picture, error) &&
        !open_renderer(kind, &picture->renderer, error)) {
        /* what viewpoint forces see is drawn from the events, which move on with the run */
        const bool apart = beside && !picture->scene->render->viewpoint_forces;
        picture->worker = apart ? cs_worker_thread_create() : NULL;
        cs_worker_thread_submit(picture->worker, make_canvas, picture);
        cs_picture_end(picture, error);
    }
    /* the canvas has its own copy */
    free_textures(picture);
    if (error->status)
        cs_picture_close(picture);
    return error->status;
}

void cs_picture_values(const struct cs_system *system, const struct cs_run *run, double *scalar,
                       double *work) {
    const enum cs_look_colours colours = cs_look_of(system->scene->render->look)->colours;
    if (colours == CS_COLOURS_FORCE)
        cs_diagnostics_particle_force(system, run->t, run->x, run->v, scalar, work);
    else if (colours == CS_COLOURS_STRESS)
        cs_membranes_particle_stress(system, run->x, scalar);
    else
        cs_diagnostics_particle_strain(system, run->x, scalar);
}

void cs_picture_range(const struct cs_scene *scene, double most, double range[2]) {
    range[0] = cs_look_of(scene->render->look)->has_sign ? -most : 0;
    range[1] = most;
}

/* Values and range of the colours. The magnitude is robust: one pinched corner must not leave
 * the rest without colours. */
static void measure_colours(struct cs_picture *picture, const struct cs_run *run) {
    const double *given = picture->scene->render->range;
    const uint32_t n = picture->system->view.n;
    if (picture->values)
        memcpy(picture->scalar, picture->values, n * sizeof *picture->scalar);
    else
        cs_picture_values(picture->system, run, picture->scalar, picture->work);
    memcpy(picture->range, given, sizeof picture->range);
    if (isnan(given[0]))
        cs_picture_range(picture->scene, cs_diagnostics_magnitude(picture->scalar, n),
                         picture->range);
}

/* Draws the picture; runs on the worker thread if there is one. */
static void paint(void *object) {
    struct cs_picture *picture = object;
    const struct cs_look_kind *look = cs_look_of(picture->scene->render->look);
    const double start = cs_clock_wall();
    const struct cs_frame frame = {.t = picture->t,
                                   .x = picture->x,
                                   .scalar = picture->scalar,
                                   .range = {picture->range[0], picture->range[1]},
                                   .title = picture->values ? NULL : look->title,
                                   .factor = look->factor,
                                   .inv_mass = picture->inv_mass,
                                   .goals = picture->goals,
                                   .triangle_marks = picture->triangle_marks,
                                   .colliders = picture->colliders};
    watch(picture->renderer->name, "while it drew");
    picture->renderer->paint(picture->canvas, &frame, picture->image, &picture->error);
    forget(&picture->error);
    picture->seconds += cs_clock_wall() - start;
}

void cs_picture_begin(struct cs_picture *picture, const struct cs_run *run,
                      struct cs_image *image) {
    const size_t n = picture->system->view.n;
    const double start = cs_clock_wall();
    memcpy(picture->x, run->x, 3 * n * sizeof *picture->x);
    memcpy(picture->inv_mass, picture->system->inv_mass, n * sizeof *picture->inv_mass);
    cs_posed_colliders_at(picture->system, run->t, picture->colliders);
    set_ramps(picture, run->t);
    if (picture->scalar)
        measure_colours(picture, run);
    if (picture->triangle_marks)
        cs_crossings_mark(picture->system, run->t, run->x, picture->triangle_marks);
    if (picture->goals)
        cs_run_goals(run, picture->goals);
    picture->t = run->t;
    picture->image = image;
    picture->seconds += cs_clock_wall() - start;
    cs_worker_thread_submit(picture->worker, paint, picture);
}

enum cs_status cs_picture_end(struct cs_picture *picture, struct cs_error *error) {
    cs_worker_thread_wait(picture->worker);
    return picture->error.status
               ? cs_fail(error, picture->error.status, "%s", picture->error.message)
               : CS_OK;
}

const char *cs_picture_renderer(const struct cs_picture *picture) {
    return picture->renderer->description(picture->canvas);
}

static void destroy_canvas(void *object) {
    struct cs_picture *picture = object;
    watch(picture->renderer->name, "while it was closed");
    picture->renderer->destroy(picture->canvas);
    forget(&picture->error);
}

void cs_picture_close(struct cs_picture *picture) {
    if (picture->renderer)
        cs_worker_thread_submit(picture->worker, destroy_canvas, picture);
    cs_worker_thread_destroy(picture->worker);
    free(picture->x);
    free(picture->inv_mass);
    free(picture->scalar);
    free(picture->work);
    free(picture->goals);
    free(picture->marks);
    free(picture->triangle_marks);
    free(picture->colliders);
    free_ramps(picture);
    *picture = (struct cs_picture){0};
}

enum cs_status cs_snapshot_draw(const struct cs_run *run, const double *values,
                                enum cs_renderer_kind kind, struct cs_image *image,
                                struct cs_text *renderer, struct cs_error *error) {
    const struct cs_render *render = run->system->scene->render;
    struct cs_picture picture;
    image->width = (uint32_t)render->size[0];
    image->height = (uint32_t)render->size[1];
    image->rgb = malloc(cs_image_bytes(image));
    if (!image->rgb)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a picture");
    if (cs_picture_open(&picture, run->system, kind, false, false, error))
        return error->status;
    picture.values = values;
    cs_picture_begin(&picture, run, image);
    cs_picture_end(&picture, error);
    cs_text_add(renderer, "%s", cs_picture_renderer(&picture));
    cs_picture_close(&picture);
    return error->status;
}
