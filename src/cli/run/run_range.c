/* Finds the range of colours, or where an instability began, in a run before the one that is
 * drawn. */
#include "cli/run/job_state.h"

#include "cli/line/print.h"
#include "draw/camera_fit.h"
#include "session/energy_monitor.h"
#include "session/frame_picture.h"
#include "session/scene_view.h"
#include "session/session.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint32_t cs_job_frames(const struct cs_job_settings *settings, const struct cs_scene *scene) {
    const double second = floor(scene->time.fps + 0.5);
    if (settings->seconds > 0)
        return (uint32_t)fmin(cs_follow_frames(scene, settings->seconds), CS_FRAMES_MAX);
    return settings->frames != CS_FRAMES_DEFAULT ? settings->frames
           : second < 1                          ? 1
                                                 : (uint32_t)second;
}

/* The preliminary run and its figures. */
struct search {
    struct cs_session session;
    double *scalar, *work; /* (n), (3,n) */
    double *most;          /* of each frame that will be drawn */
    uint32_t n;
};

static enum cs_status allocate_bounds(struct search *search, uint32_t frames,
                                      struct cs_error *error) {
    const size_t n = search->session.system.view.n;
    search->scalar = calloc(n + 1, sizeof *search->scalar);
    search->work = calloc(n + 1, 3 * sizeof *search->work);
    search->most = calloc((size_t)frames + 1, sizeof *search->most);
    if (!search->scalar || !search->work || !search->most)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the range of colours");
    return CS_OK;
}

/* Records the magnitude of each frame that will be drawn. */
static enum cs_status sample_frame(struct search *search, uint32_t frames, uint32_t every,
                                   struct cs_error *error) {
    struct cs_run *run = &search->session.run;
    struct cs_follow follow = {.run = run, .last = frames, .every = every, .at_start = !frames};
    while (cs_follow_next(&follow, error)) {
        cs_picture_values(&search->session.system, run, search->scalar, search->work);
        search->most[search->n++] =
            cs_diagnostics_magnitude(search->scalar, search->session.system.view.n);
    }
    return cs_follow_check(run, " in the run that finds the range of colours", error);
}

/* Refuses --range for a look whose colours show no value. */
static enum cs_status check(const struct cs_session *session, struct cs_error *error) {
    const struct cs_scene *scene = session->scene;
    if (!cs_picture_is_coloured(scene))
        return cs_fail(error, CS_ERR_USAGE,
                       "--range: the look \"%s\" shows no values; \"force\" and \"strain\" do",
                       cs_look_names[scene->render->look]);
    return CS_OK;
}

/* Finds a value for render.range; empty if nothing moves. */
static enum cs_status search_range(const struct cs_job_settings *settings, char value[80],
                                   struct cs_error *error) {
    struct search search = {0};
    double range[2];
    struct cs_session *session = &search.session;
    if (!strcmp(settings->session.scene, "-"))
        return cs_fail(error, CS_ERR_USAGE,
                       "--range auto runs the scene twice: SCENE must be a file, not -");
    if (cs_session_open(session, &settings->session, error))
        return error->status;
    const uint32_t frames = cs_job_frames(settings, session->scene);
    if (!check(session, error) &&
        !allocate_bounds(&search, frames / settings->frame_interval, error) &&
        !sample_frame(&search, frames, settings->frame_interval, error)) {
        cs_picture_range(session->scene, cs_diagnostics_magnitude(search.most, search.n),
                         range);
        if (range[0] < range[1])
            snprintf(value, 80, "[%.9g,%.9g]", range[0], range[1]);
    }
    free(search.scalar);
    free(search.work);
    free(search.most);
    cs_session_close(session);
    return error->status;
}

/* Reads "MIN,MAX" with MIN < MAX, and prints it with all digits. */
static enum cs_status read_range(const char *text, char value[80], struct cs_error *error) {
    const char *comma = strchr(text, ',');
    double least, most;
    char first[40];
    if (comma && comma - text < (long)sizeof first) {
        snprintf(first, sizeof first, "%.*s", (int)(comma - text), text);
        if (cs_parse_real(first, &least) && cs_parse_real(comma + 1, &most) && least < most) {
            snprintf(value, 80, "[%.17g,%.17g]", least, most);
            return CS_OK;
        }
    }
    return cs_fail(error, CS_ERR_USAGE, "--range: found \"%s\", expected \"auto\", or MIN,MAX",
                   text);
}

/* Appends an override after the user's own: the last one for a key wins. */
static enum cs_status add_override(struct cs_run_range *range, const char *key,
                                   const char *value, struct cs_session_settings *session,
                                   struct cs_error *error) {
    struct cs_override *overrides = calloc(session->n_overrides + 1, sizeof *overrides);
    if (!overrides)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the override of %s", key);
    if (session->n_overrides)
        memcpy(overrides, session->overrides, session->n_overrides * sizeof *overrides);
    overrides[session->n_overrides++] = (struct cs_override){key, value};
    free(range->overrides);
    session->overrides = range->overrides = overrides;
    return CS_OK;
}

enum cs_status cs_run_range_set(struct cs_run_range *range, const char *text,
                                struct cs_job_settings *settings, struct cs_error *error) {
    struct cs_session_settings *session = &settings->session;
    if (strcmp(text, "auto") ? read_range(text, range->value, error)
                             : search_range(settings, range->value, error))
        return error->status;
    return *range->value ? add_override(range, "render.range", range->value, session, error)
                         : CS_OK;
}

/* Runs the scene to its first instability, or to its end. */
static enum cs_status search_instability(const struct cs_job_settings *settings,
                                         struct cs_text *marks, struct cs_error *error) {
    struct cs_session session;
    struct cs_energy_monitor monitor = {0};
    struct cs_energy_monitor_row row;
    if (!strcmp(settings->session.scene, "-"))
        return cs_fail(error, CS_ERR_USAGE,
                       "--mark-instability runs the scene twice: SCENE must be a file, not -");
    if (cs_session_open(&session, &settings->session, error))
        return error->status;
    struct cs_run *run = &session.run;
    struct cs_follow follow = {
        .run = run, .last = cs_job_frames(settings, session.scene), .every = 1};
    const struct cs_energy_monitor_row *first = &monitor.first;
    if (!cs_energy_monitor_begin(&monitor, run, error))
        while (first->verdict == CS_STABILITY_BOUNDED && cs_follow_next(&follow, error))
            cs_energy_monitor_sample(&monitor, run, &row);
    if (first->verdict != CS_STABILITY_BOUNDED)
        cs_system_print_marks(&session.system, first->particle, marks);
    else if (cs_outcome_is_blow_up(run->outcome))
        cs_system_print_marks(&session.system, run->blow_up.particle, marks);
    cs_follow_check(run, " in the run that finds the instability", error);
    cs_session_close(&session);
    return error->status;
}

enum cs_status cs_run_marks_set(struct cs_run_range *range, struct cs_job_settings *settings,
                                struct cs_error *error) {
    if (search_instability(settings, &range->marks, error))
        return error->status;
    if (range->marks.failed)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for marks");
    if (!range->marks.length) {
        cs_print_message("no instability was found: no particle is marked");
        return CS_OK;
    }
    return add_override(range, "render.marks", cs_text_get(&range->marks), &settings->session,
                        error);
}

void cs_run_range_finish(struct cs_run_range *range) {
    free(range->overrides);
    cs_text_finish(&range->marks);
    *range = (struct cs_run_range){0};
}

/* Frames the motion of a run: a fixed camera if the bodies stay large enough in its picture,
 * else one that follows them as slowly as possible.
 *
 * A fixed camera is fitted to the extremes of all frames at once. A path begins with a camera
 * per frame; eye and target are then averaged over 2 reach + 1 frames. The largest reach that
 * keeps the bodies in every picture wins: it is halved until it does. */

/* Fractions of the picture's height: minimum and maximum that bodies may fill, and the target
 * of a following camera. */
static const double least = 0.46, most = 0.79, wanted = 0.62;

/* Extremes of the bodies in the frames that will be drawn. */
struct motion {
    struct cs_camera_fit fit;
    double *places;             /* (n, 3, CS_CAMERA_FIT_EXTREMES) */
    struct cs_camera_key *keys; /* (n) */
    uint32_t n;
};

static const double *positions_of(const struct motion *motion, uint32_t k) {
    return motion->places + (size_t)3 * CS_CAMERA_FIT_EXTREMES * k;
}

static enum cs_status record(struct cs_session *session, uint32_t frames, uint32_t every,
                             struct motion *motion, struct cs_error *error) {
    struct cs_run *run = &session->run;
    struct cs_follow follow = {.run = run, .last = frames, .every = every, .at_start = !frames};
    while (cs_follow_next(&follow, error)) {
        motion->keys[motion->n].at = run->t;
        cs_camera_fit_extremes(&motion->fit, session->system.view.n, run->x,
                               motion->places +
                                   (size_t)3 * CS_CAMERA_FIT_EXTREMES * motion->n++);
    }
    return cs_follow_check(run, " in the run that finds the camera", error);
}

static bool frames_all(const struct motion *motion, const struct cs_camera *camera,
                       uint32_t k) {
    double rows[2];
    cs_camera_fit_rows(&motion->fit, camera, CS_CAMERA_FIT_EXTREMES, positions_of(motion, k),
                       rows);
    const double height = (rows[1] - rows[0]) / 2;
    return height >= least && height <= most && rows[0] > -0.96 && rows[1] < 0.96;
}

static void set_key(struct motion *motion, uint32_t k, const struct cs_camera *camera) {
    memcpy(motion->keys[k].eye, camera->eye, sizeof camera->eye);
    memcpy(motion->keys[k].target, camera->target, sizeof camera->target);
}

/* Returns true if one camera suits all frames; it is then the only key. */
static bool find_fixed_camera(struct motion *motion, double *all) {
    const size_t of_all = (size_t)motion->n * CS_CAMERA_FIT_EXTREMES;
    struct cs_camera camera;
    for (size_t i = 0; i < of_all; i++)
        for (size_t c = 0; c < 3; c++)
            all[c * of_all + i] =
                motion->places[(i / CS_CAMERA_FIT_EXTREMES * 3 + c) * CS_CAMERA_FIT_EXTREMES +
                               i % CS_CAMERA_FIT_EXTREMES];
    cs_camera_fit_solve(&motion->fit, of_all, all, most - 0.01, &camera);
    for (uint32_t k = 0; k < motion->n; k++)
        if (!frames_all(motion, &camera, k))
            return false;
    set_key(motion, 0, &camera);
    motion->n = 1;
    return true;
}

/* Mean of the cameras of the frames k - reach .. k + reach, cut at the ends. */
static void average(const struct motion *motion, const struct cs_camera *each, uint32_t k,
                    uint32_t reach, struct cs_camera *camera) {
    const uint32_t first = k > reach ? k - reach : 0;
    const uint32_t last = motion->n - 1 - k > reach ? k + reach : motion->n - 1;
    *camera = each[k];
    for (int c = 0; c < 3; c++) {
        camera->eye[c] = camera->target[c] = 0;
        for (uint32_t i = first; i <= last; i++) {
            camera->eye[c] += each[i].eye[c] / (last - first + 1);
            camera->target[c] += each[i].target[c] / (last - first + 1);
        }
    }
}

/* Finds the slowest path that suits every frame. */
static void smooth_path(struct motion *motion, struct cs_camera *each) {
    struct cs_camera camera;
    for (uint32_t k = 0; k < motion->n; k++)
        cs_camera_fit_solve(&motion->fit, CS_CAMERA_FIT_EXTREMES, positions_of(motion, k),
                            wanted, each + k);
    for (uint32_t reach = motion->n / 4 + 1;; reach /= 2) {
        bool all = true;
        for (uint32_t k = 0; k < motion->n; k++) {
            average(motion, each, k, reach, &camera);
            set_key(motion, k, &camera);
            all = all && frames_all(motion, &camera, k);
        }
        if (all || reach == 0)
            break;
    }
}

static enum cs_status find_camera_path(struct motion *motion, struct cs_scene *scene,
                                       struct cs_error *error) {
    double *all = calloc((size_t)motion->n * CS_CAMERA_FIT_EXTREMES + 1, 3 * sizeof *all);
    struct cs_camera *each = calloc(motion->n + 1, sizeof *each);
    if (all && each && motion->n) {
        if (!find_fixed_camera(motion, all))
            smooth_path(motion, each);
        struct cs_camera_key *keys =
            cs_arena_alloc_array(&scene->arena, motion->n, sizeof *keys, error);
        if (keys) {
            memcpy(keys, motion->keys, motion->n * sizeof *keys);
            scene->camera->path = (struct cs_list){keys, motion->n};
        }
    } else if (!all || !each) {
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the camera path");
    }
    // where nothing was drawn there is nothing to frame
    scene->camera->frame = CS_FRAME_GIVEN;
    free(all);
    free(each);
    return error->status;
}

static enum cs_status allocate_path(struct motion *motion, uint32_t frames,
                                    struct cs_error *error) {
    motion->places =
        calloc((size_t)frames + 1, 3 * CS_CAMERA_FIT_EXTREMES * sizeof *motion->places);
    motion->keys = calloc((size_t)frames + 1, sizeof *motion->keys);
    return motion->places && motion->keys
               ? CS_OK
               : cs_fail(error, CS_ERR_MEMORY, "out of memory for the camera path");
}

void cs_run_camera_find(struct cs_scene *scene, void *camera) {
    struct cs_run_camera *of = camera;
    struct cs_session_settings once = of->settings->session;
    struct cs_session session = {0};
    struct motion motion = {.n = 0};
    const uint32_t frames = cs_job_frames(of->settings, scene),
                   every = of->settings->frame_interval;
    if (scene->camera->frame != CS_FRAME_AUTO)
        return;
    if (!strcmp(once.scene, "-")) {
        cs_fail(&of->error, CS_ERR_USAGE,
                "camera.frame auto runs the scene twice: SCENE must be a file, not -");
        return;
    }
    // those of the session that asks
    once.threads = 0;
    cs_camera_fit_begin(&motion.fit, scene->camera, scene->render);
    if (!cs_session_open(&session, &once, &of->error) &&
        !allocate_path(&motion, frames / every, &of->error) &&
        !record(&session, frames, every, &motion, &of->error))
        find_camera_path(&motion, scene, &of->error);
    cs_session_close(&session);
    free(motion.places);
    free(motion.keys);
}
