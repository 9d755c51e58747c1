/* Draws the pictures of a run while it goes on, and writes the provenance into each.
 *
 * Three stages overlap on a machine with several processors: the run steps frame k + 1, the
 * renderer draws frame k from a copy of the state, and the writer encodes frame k - 1. */
#include "base/clock.h"
#include "base/pool.h"
#include "cli/run/job_state.h"
#include "session/provenance_write.h"
#include "session/scene_view.h"

#include <stdio.h>
#include <string.h>

/* True if drawing and encoding can overlap the run. */
static bool has_processors(void) {
    return cs_pool_processors(2) > 1;
}

static enum cs_status open_renderer(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    if (!settings->session.render)
        return CS_OK;
    if (settings->show && cs_screen_open(&job->screen, true, error))
        return error->status;
    if (cs_picture_open(&job->picture, &job->session.system, settings->renderer,
                        settings->fast_render, has_processors(), error))
        return error->status;
    cs_text_add(&job->renderer, "%s", cs_picture_renderer(&job->picture));
    return job->renderer.failed
               ? cs_fail(error, CS_ERR_MEMORY, "out of memory for the renderer's name")
               : CS_OK;
}

/* The provenance of pictures is known once the run has begun, because a resumed run has the
 * interval of its checkpoint. */
static enum cs_status begin_picture(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    const struct cs_render *render = job->session.scene->render;
    if (!settings->session.render)
        return CS_OK;
    const struct cs_frame_writer_settings frames = {
        (uint32_t)render->size[0], (uint32_t)render->size[1],
        render->background.kind == CS_BACKGROUND_NONE, (int)settings->level, has_processors()};
    const struct cs_picture_provenance provenance = {
        .provenance = cs_text_get(&job->provenance),
        .scene = cs_text_get(&job->scene),
        .renderer = job->picture.renderer->name,
        .renderer_description = cs_text_get(&job->renderer),
        .fast_render = settings->fast_render,
        .restarts = cs_job_restarts(job)};
    cs_provenance_out_print_recipe(&provenance, &job->picture_provenance);
    return job->picture_provenance.failed
               ? cs_fail(error, CS_ERR_MEMORY, "out of memory for the texts of pictures")
               : cs_frame_writer_create(settings->folder, &frames, &job->writer, error);
}

static void print_range(const struct cs_job_picture *picture, const struct cs_scene *scene,
                        struct cs_text *range) {
    if (!cs_picture_is_coloured(scene))
        return;
    cs_text_add_real(range, picture->range[0]);
    cs_text_add(range, "..");
    cs_text_add_real(range, picture->range[1]);
    cs_text_add(range, " %s", cs_look_of(scene->render->look)->unit);
}

/* Shows the last image in the terminal. */
static enum cs_status show(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_picture *picture = &job->has_begun;
    char caption[80];
    snprintf(caption, sizeof caption, "frame %u of %u, %.4g s", picture->frame, job->frames,
             picture->time);
    return cs_screen_show_image(&job->screen, picture->image, caption, error);
}

/* Submits the last image as frame_NUMBER.png, with its texts. */
static enum cs_status give(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_picture *picture = &job->has_begun;
    char frame[16], pixels[CS_HASH_DIGITS];
    struct cs_text time = {0}, range = {0}, error_line = {0};
    snprintf(frame, sizeof frame, "%u", picture->frame);
    cs_hash_bytes(picture->image->rgb, cs_image_bytes(picture->image), pixels);
    cs_text_add_real(&time, picture->time);
    print_range(picture, job->session.scene, &range);
    cs_report_print_error(job, picture->frame, picture->local_error, &error_line);
    const struct cs_png_text texts[] = {
        {"Software", "clothsim " CS_VERSION},
        {"Source", job->scene_hash},
        {"clothsim:frame", frame},
        {"clothsim:time", cs_text_get(&time)},
        {"clothsim:integrator", cs_text_get(&job->method)},
        {"clothsim:state-hash", picture->hash},
        {"clothsim:renderer", cs_text_get(&job->renderer)},
        {"clothsim:pixel-hash", pixels},
        {"clothsim:run", cs_text_get(&job->picture_provenance)},
        {"clothsim:error", cs_text_get(&error_line)},
        {"clothsim:range", cs_text_get(&range)},
    };
    /* the range comes last, so that it can be left out where nothing is coloured */
    const uint32_t n_texts = sizeof texts / sizeof *texts - !range.length;
    if (time.failed || range.failed || error_line.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the texts of a picture");
    else
        cs_frame_writer_submit(job->writer, picture->number, texts, n_texts, error);
    cs_text_finish(&time);
    cs_text_finish(&range);
    cs_text_finish(&error_line);
    return error->status;
}

/* Waits for the picture in progress and submits it. */
static enum cs_status end_picture(struct cs_job *job, struct cs_error *error) {
    const double start = cs_clock_wall();
    if (!job->has_begun.image)
        return CS_OK;
    const enum cs_status status = cs_picture_end(&job->picture, error);
    job->wait_seconds += cs_clock_wall() - start;
    if (!status && !(job->settings->show && show(job, error)) && !give(job, error))
        job->n_drawn++;
    job->has_begun.image = NULL;
    return error->status;
}

/* Begins the picture of this frame. The last one was drawn during the step. */
static enum cs_status frame(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    if (!job->writer || run->frame % job->settings->frame_interval || end_picture(job, error))
        return error->status;
    const double start = cs_clock_wall();
    struct cs_image *image = cs_frame_writer_acquire(job->writer);
    job->wait_seconds += cs_clock_wall() - start;
    cs_picture_begin(&job->picture, run, image);
    job->has_begun =
        (struct cs_job_picture){.number = run->frame / job->settings->frame_interval,
                                .frame = run->frame,
                                .time = run->t,
                                .local_error = run->counts.method.local_error,
                                .image = image};
    memcpy(job->has_begun.hash, job->hash, sizeof job->hash);
    memcpy(job->has_begun.range, job->picture.range, sizeof job->has_begun.range);
    return CS_OK;
}

/* Waits until every picture is a file. */
static enum cs_status settle(struct cs_job *job, struct cs_error *error) {
    if (end_picture(job, error) || !job->writer)
        return error->status;
    const double start = cs_clock_wall();
    cs_frame_writer_finish(job->writer, &job->encode_seconds, error);
    job->wait_seconds += cs_clock_wall() - start;
    return error->status;
}

/* The folder is that of checkpoints and exports as well. */
const struct cs_run_output cs_run_output_pictures = {
    .option = "--out",
    .path = offsetof(struct cs_job_settings, folder),
    .is_ours = cs_output_is_result,
    .at = {[CS_RUN_OPEN] = open_renderer,
           [CS_RUN_BEGIN] = begin_picture,
           [CS_RUN_START] = frame,
           [CS_RUN_FRAME] = frame,
           [CS_RUN_SETTLE] = settle}};
