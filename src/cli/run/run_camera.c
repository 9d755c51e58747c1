/* Frames the motion of a run: a fixed camera if the bodies stay large enough in its picture,
 * else one that follows them as slowly as possible.
 *
 * A fixed camera is fitted to the extremes of all frames at once. A path begins with a camera
 * per frame; eye and target are then averaged over 2 reach + 1 frames. The largest reach that
 * keeps the bodies in every picture wins: it is halved until it does. */
#include "cli/run/job_state.h"

#include "draw/camera_fit.h"
#include "session/session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
