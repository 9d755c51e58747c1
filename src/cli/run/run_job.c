/* Runs a scene frame by frame and hands out its pictures, states, hashes and report. */
#include "cli/run/run_job.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/pool.h"
#include "cli/line/print.h"
#include "cli/line/progress.h"
#include "cli/run/run_claims.h"
#include "io/scene_hash.h"
#include "io/scene_write.h"
#include "study/coarse.h"
#include "study/company.h"
#include "study/origin.h"
#include "study/within.h"

#include <string.h>

/* The scene with every value, its hash, and the method. */
static enum cs_status describe(struct cs_job *job, struct cs_error *error) {
    struct cs_session *session = &job->session;
    cs_scene_print(&session->scene, &session->method.table, session->method.options, 2,
                   &job->scene);
    cs_method_describe(&session->method, &job->method);
    if (job->scene.failed || job->method.failed)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the resolved scene");
    if (cs_scene_hash(&session->scene, &session->method.table, session->method.options,
                      job->scene_hash, error) ||
        !cs_job_wants_json(job->settings))
        return error->status;
    return cs_origin_print(session, job->scene_hash, cs_text_get(&job->method), &job->origin,
                           error);
}

static enum cs_status check_outputs(const struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    const struct cs_run_outputs outputs = {
        .json = settings->json,
        .watch = settings->watch,
        .ledger = settings->ledger,
        .states = settings->states,
        .folder = cs_job_uses_folder(settings) ? settings->folder : NULL};
    return cs_run_check_claims(&job->session, &outputs, error) || settings->overwrite ||
                   settings->resume
               ? error->status
               : cs_run_check_fresh(&outputs, error);
}

/* more than one, so that drawing and encoding can overlap the run */
static bool has_processors(void) {
    return cs_pool_processors(2) > 1;
}

static enum cs_status open_pictures(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    if (cs_picture_open(&job->picture, &job->session.system, settings->renderer, settings->fast,
                        has_processors(), error))
        return error->status;
    cs_text_add(&job->renderer, "%s", cs_picture_renderer(&job->picture));
    if (job->renderer.failed)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the renderer's name");
    return CS_OK;
}

/* Opens the renderer, which may be missing, before it touches any file on disk. */
static enum cs_status open_outputs(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    const struct cs_render *render = &job->session.scene.render;
    if (settings->session.render && open_pictures(job, error))
        return error->status;
    const enum cs_output_earlier earlier = settings->resume      ? CS_OUTPUT_KEEP
                                           : settings->overwrite ? CS_OUTPUT_REMOVE
                                                                 : CS_OUTPUT_REFUSE;
    if (settings->states &&
        cs_output_own(&job->states, NULL, settings->states, cs_output_is_state, earlier, error))
        return error->status;
    if (cs_job_uses_folder(settings) &&
        cs_output_own(&job->folder, &job->states, settings->folder, cs_output_is_result,
                      earlier, error))
        return error->status;
    if (!settings->session.render)
        return CS_OK;
    const struct cs_frames_settings frames = {
        (uint32_t)render->size[0], (uint32_t)render->size[1],
        render->background.kind == CS_BACKGROUND_NONE, (int)settings->level, has_processors()};
    return cs_frames_create(settings->folder, &frames, &job->writer, error);
}

/* Waits for the picture under way and hands it over. */
static enum cs_status end_picture(struct cs_job *job, struct cs_error *error) {
    const double start = cs_clock_wall();
    if (!job->begun.number)
        return CS_OK;
    const struct cs_picture_origin origin = {
        &job->session.scene, job->scene_hash, cs_text_get(&job->method),
        cs_text_get(&job->renderer), cs_text_get(&job->recipe)};
    const enum cs_status status = cs_picture_end(&job->picture, error);
    job->wait_seconds += cs_clock_wall() - start;
    if (!status && !cs_job_picture_give(&job->begun, &origin, job->writer, error))
        job->drawn++;
    job->begun.number = 0;
    return error->status;
}

/* The picture of this frame; that of the one before has been drawn in the meantime. */
static enum cs_status begin_picture(struct cs_job *job, struct cs_job_frame *frame,
                                    struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    if (end_picture(job, error))
        return error->status;
    const double start = cs_clock_wall();
    struct cs_image *image = cs_frames_take(job->writer);
    job->wait_seconds += cs_clock_wall() - start;
    cs_picture_begin(&job->picture, run, image);
    job->begun = (struct cs_job_picture){.number = run->frame / job->settings->every,
                                         .frame = run->frame,
                                         .time = run->t,
                                         .image = image};
    memcpy(job->begun.hash, job->hash, sizeof job->hash);
    memcpy(job->begun.range, job->picture.range, sizeof job->begun.range);
    memcpy(frame->range, job->picture.range, sizeof frame->range);
    frame->drawn = true;
    return CS_OK;
}

static enum cs_status print_hash(uint32_t number, const char *hash, struct cs_error *error) {
    struct cs_text line = {0};
    cs_text_add(&line, "%u %s\n", number, hash);
    return cs_print_out(stdout, &line, error);
}

/* Looks whether the run is still sound, and keeps the rows for --watch and --ledger. */
static enum cs_status watch_frame(struct cs_job *job, struct cs_error *error) {
    struct cs_watch_row row;
    cs_watch_look(&job->watch, &job->session.run, &row);
    if (job->settings->watch)
        cs_watch_print_row(&row, job->session.run.frame, &job->watch_rows);
    if (job->settings->ledger)
        cs_account_print_row(&job->account, job->session.run.frame, &job->ledger_rows);
    if (job->watch_rows.failed || job->ledger_rows.failed)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the rows of frames");
    return CS_OK;
}

static enum cs_status begin_watch(struct cs_job *job, struct cs_error *error) {
    if (cs_watch_begin(&job->watch, &job->session.run, error))
        return error->status;
    if (job->settings->watch)
        cs_watch_print_head(&job->watch_rows);
    if (job->settings->ledger)
        cs_account_print_head(&job->ledger_rows);
    return watch_frame(job, error);
}

/* Everything that one finished frame leaves behind. */
static enum cs_status take_frame(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    const struct cs_run *run = &job->session.run;
    const uint32_t n = job->session.system.view.n;
    struct cs_job_frame frame = {0};
    cs_hash_doubles(run->x, 6 * (size_t)n, job->hash);
    memcpy(frame.hash, job->hash, sizeof frame.hash);
    if (watch_frame(job, error))
        return error->status;
    cs_tally_take(&job->tally, run);
    frame.crossings = job->tally.last;
    if (settings->states &&
        cs_output_state(settings->states, run->frame, run->x, run->v, n, error))
        return error->status;
    if (job->writer && run->frame % settings->every == 0 && begin_picture(job, &frame, error))
        return error->status;
    if (cs_export_take(&job->export, run->frame, run->t, run->x, run->v, error))
        return error->status;
    if (cs_job_wants_json(settings) && cs_kept_add(&job->kept, run->frame, &frame, error))
        return error->status;
    return settings->hash ? print_hash(run->frame, job->hash, error) : CS_OK;
}

/* Waits until every picture that was begun is a file. */
static enum cs_status settle_pictures(struct cs_job *job, struct cs_error *error) {
    if (end_picture(job, error) || !job->writer)
        return error->status;
    const double start = cs_clock_wall();
    cs_frames_finish(job->writer, &job->encode_seconds, error);
    job->wait_seconds += cs_clock_wall() - start;
    return error->status;
}

/* The last checkpoint kept, once the files that it goes on with are there. */
static enum cs_status write_checkpoint(struct cs_job *job, struct cs_error *error) {
    if (!cs_job_makes_checkpoints(job->settings) || cs_export_sync(&job->export, error))
        return error->status;
    return cs_resume_write(&job->checkpoints, error);
}

static enum cs_status make_checkpoint(struct cs_job *job, struct cs_error *error) {
    bool due;
    if (cs_resume_keep(&job->checkpoints, &due, error) || !due || settle_pictures(job, error))
        return error->status;
    return write_checkpoint(job, error);
}

/* What the job keeps of the frames so far, for a checkpoint. */
static void record_job(void *ctx, struct cs_record *record) {
    struct cs_job *job = ctx;
    uint64_t n = cs_job_wants_json(job->settings) ? job->session.run.frame : 0;
    CS_RECORD(record, job->watch);
    CS_RECORD(record, job->tally);
    CS_RECORD(record, job->hash);
    CS_RECORD(record, job->drawn);
    cs_record_text(record, &job->watch_rows);
    cs_record_text(record, &job->ledger_rows);
    CS_RECORD(record, job->account.work);
    CS_RECORD(record, n);
    cs_kept_record(&job->kept, n, record);
}

static enum cs_status begin_checkpoints(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    cs_job_print_outputs(settings, cs_text_get(&job->renderer), &job->outputs);
    if (job->outputs.failed)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for checkpoints");
    const struct cs_resume_of of = {.scene = cs_text_get(&job->scene),
                                    .hash = job->scene_hash,
                                    .method = cs_text_get(&job->method),
                                    .outputs = cs_text_get(&job->outputs),
                                    .record = record_job,
                                    .ctx = job};
    return cs_resume_begin(&job->checkpoints, &job->session, &of, settings->folder,
                           &settings->checkpoint, error);
}

/* Known once a run has begun, or goes on at its pace of checkpoints. */
static enum cs_status make_recipe(struct cs_job *job, struct cs_error *error) {
    if (!job->writer)
        return CS_OK;
    const struct cs_recipe recipe = {.origin = cs_text_get(&job->origin),
                                     .scene = cs_text_get(&job->scene),
                                     .renderer = job->picture.renderer->name,
                                     .drawn_by = cs_text_get(&job->renderer),
                                     .fast = job->settings->fast,
                                     .restarts = cs_job_restarts(job)};
    cs_origin_print_recipe(&recipe, &job->recipe);
    return job->recipe.failed
               ? cs_fail(error, CS_ERR_MEMORY, "out of memory for the texts of pictures")
               : CS_OK;
}

static enum cs_status run_frames(struct cs_job *job, struct cs_error *error) {
    struct cs_run *run = &job->session.run;
    struct cs_progress progress;
    cs_progress_begin(&progress, job->settings->quiet);
    cs_run_trail_begin(&job->trail, run);
    while (run->frame < job->frames && !error->status) {
        cs_run_trail_step(&job->trail, run);
        if (cs_run_frame(run, error) || run->outcome != CS_RUNNING)
            break;
        if (!cs_run_trail_frame(&job->trail, run, error) && !take_frame(job, error))
            make_checkpoint(job, error);
        cs_progress_show(&progress, run->frame, job->frames);
    }
    cs_progress_end(&progress);
    cs_run_trail_end(&job->trail, run);
    return error->status;
}

/* of the job's run, as it stands; not open where nothing is exported */
static enum cs_status begin_exports(struct cs_job *job, struct cs_error *error) {
    struct cs_export_settings settings = job->settings->export;
    settings.folder = job->settings->folder;
    settings.every = job->settings->every;
    return settings.formats ? cs_run_export_begin(&job->export, &settings, &job->session.run,
                                                  job->settings->resume, error)
                            : CS_OK;
}

/* Also of a run that failed: its last picture is of a frame that was fine, and so is the last
 * checkpoint. The first failure wins: a later one of drawing or writing changes nothing. */
static void finish_files(struct cs_job *job, struct cs_error *error) {
    struct cs_error later = {0};
    if (settle_pictures(job, &later) == CS_OK)
        write_checkpoint(job, &later);
    cs_export_finish(&job->export, cs_job_makes_checkpoints(job->settings), &later);
    if (!error->status)
        *error = later;
}

/* The start has a state, a hash and a row but no picture. */
static enum cs_status begin(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    const uint32_t n = job->session.system.view.n;
    const char *states = job->settings->states;
    cs_hash_doubles(run->x, 6 * (size_t)n, job->hash);
    if (states && cs_output_state(states, 0, run->x, run->v, n, error))
        return error->status;
    cs_tally_take(&job->tally, run);
    return begin_watch(job, error);
}

/* Its account goes on from the state that was loaded. */
static enum cs_status go_on(struct cs_job *job, struct cs_error *error) {
    if (!cs_resume_load(&job->checkpoints, job->frames, error) && job->settings->ledger)
        cs_account_go_on(&job->account, job->session.run.t);
    return error->status;
}

/* The run, and the account that it keeps. */
static enum cs_status open_session(struct cs_job *job, struct cs_error *error) {
    struct cs_session_settings settings = job->settings->session;
    const bool kept = job->settings->ledger != NULL;
    settings.run.account = kept ? &job->account : NULL;
    job->trail = job->settings->trail;
    settings.run.trace = job->trail.only ? &job->trail.trace : NULL;
    job->camera.settings = job->settings;
    settings.change = settings.render ? cs_run_camera_find : NULL;
    settings.ctx = &job->camera;
    if (cs_session_open(&job->session, &settings, error) || job->camera.error.status)
        return cs_fail(error, job->camera.error.status, "%s", job->camera.error.message);
    return !kept ? CS_OK : cs_account_open(&job->account, &job->session.system, 0, error);
}

enum cs_status cs_job_run(struct cs_job *job, const struct cs_job_settings *settings,
                          struct cs_error *error) {
    const double start = cs_clock_wall();
    job->settings = settings;
    if (open_session(job, error) || describe(job, error) ||
        cs_resume_check_pace(&job->session, &settings->checkpoint, error) ||
        check_outputs(job, error) || open_outputs(job, error))
        return error->status;
    const struct cs_scene *scene = &job->session.scene;
    job->frames = cs_job_frames(settings, scene);
    if (cs_company_print(scene, job->frames / scene->time.fps, &job->warning, error))
        return error->status;
    if (!job->warning.length)
        cs_coarse_print(&job->session.system, &job->warning);
    if (!job->warning.length)
        cs_within_print(&job->session.system, &job->warning);

    if (cs_job_makes_checkpoints(settings) && begin_checkpoints(job, error))
        return error->status;
    /* a checkpoint that is refused leaves the rows of the run that it is of */
    if ((settings->resume ? go_on(job, error) : begin(job, error)) ||
        begin_exports(job, error) || make_recipe(job, error))
        return error->status;
    job->failure = run_frames(job, error) == CS_ERR_MODULE ? error->message : NULL;
    /* also after a failure: rows and frames that were finished are kept */
    cs_output_rows(settings->watch, &job->watch_rows, error);
    cs_output_rows(settings->ledger, &job->ledger_rows, error);
    finish_files(job, error);
    job->wall_seconds = cs_clock_wall() - start;
    return error->status;
}

void cs_job_finish(struct cs_job *job) {
    /* a picture under way is drawn into an image of the writer's */
    cs_picture_close(&job->picture);
    cs_frames_destroy(job->writer);
    cs_export_close(&job->export);
    cs_output_release(&job->folder);
    cs_output_release(&job->states);
    cs_session_close(&job->session);
    cs_text_finish(&job->scene);
    cs_text_finish(&job->warning);
    cs_text_finish(&job->method);
    cs_text_finish(&job->origin);
    cs_text_finish(&job->recipe);
    cs_text_finish(&job->renderer);
    cs_text_finish(&job->watch_rows);
    cs_text_finish(&job->ledger_rows);
    cs_account_close(&job->account);
    cs_text_finish(&job->outputs);
    cs_resume_finish(&job->checkpoints);
    cs_kept_finish(&job->kept);
    *job = (struct cs_job){0};
}
