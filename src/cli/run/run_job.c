/* Runs a scene frame by frame and passes each frame to its outputs. */
#include "cli/run/job_state.h"

#include "base/clock.h"
#include "base/options.h"
#include "cli/line/print.h"
#include "session/provenance_write.h"
#include "session/scene_view.h"
#include "session/session.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Prints the scene with every value, its hash, the method, and the provenance. */
static enum cs_status describe(struct cs_job *job, struct cs_error *error) {
    struct cs_session *session = &job->session;
    cs_scene_print(session->scene, &session->method.table, session->method.options, 2,
                   &job->scene);
    cs_method_describe(&session->method, &job->method);
    if (job->scene.failed || job->method.failed)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the resolved scene");
    if (cs_scene_hash(session->scene, &session->method.table, session->method.options,
                      job->scene_hash, error) ||
        !cs_job_wants_json(job->settings))
        return error->status;
    return cs_provenance_out_print(session, job->scene_hash, cs_text_get(&job->method),
                                   &job->provenance, error);
}

/* Hashes and judges the state of the frame. */
static void look(struct cs_job *job) {
    const struct cs_run *run = &job->session.run;
    cs_run_hash(run, job->hash);
    cs_energy_monitor_sample(&job->monitor, run, &job->sound);
    cs_crossing_stats_add(&job->crossings, run);
}

/* Writes the last captured checkpoint. The outputs finish their files first: a checkpoint on
 * disk implies the files of all frames before it. */
static enum cs_status write_checkpoint(struct cs_job *job, struct cs_error *error) {
    return cs_run_outputs_at(job, CS_RUN_SETTLE, error)
               ? error->status
               : cs_checkpointer_write(&job->checkpoints, error);
}

/* Captures the state after a frame, and writes it if one is due. */
static enum cs_status make_checkpoint(struct cs_job *job, struct cs_error *error) {
    bool due;
    return cs_checkpointer_capture(&job->checkpoints, &due, error) || !due
               ? error->status
               : write_checkpoint(job, error);
}

/* Serialises what the job accumulates over frames; one function for both directions. */
static void record_job(void *ctx, struct cs_serialiser *serialiser) {
    struct cs_job *job = ctx;
    CS_SERIALISER(serialiser, job->monitor);
    CS_SERIALISER(serialiser, job->crossings);
    CS_SERIALISER(serialiser, job->hash);
    CS_SERIALISER(serialiser, job->n_drawn);
    cs_run_outputs_record(job, serialiser);
}

/* "yes" or "no". */
static const char *yes(bool fact) {
    return fact ? "yes" : "no";
}

/* Lists the outputs, one per line. A run may only resume with the same set: its files would
 * otherwise be incomplete. */
static void print_outputs(const struct cs_job_settings *settings, const char *renderer,
                          struct cs_text *out) {
    cs_text_add(out,
                "pictures by: %s\ndrawn every: %u\nPNG level: %u\nfast-render: %s\nstates: "
                "%s\nwatch: %s\nledger: %s\nJSON: %s\nexport:",
                settings->session.render ? renderer : "none", settings->frame_interval,
                settings->level, yes(settings->fast_render), yes(settings->states),
                yes(settings->monitor_file), yes(settings->ledger),
                yes(cs_job_wants_json(settings)));
    cs_run_export_print(&settings->export, out);
    cs_text_add(out, "\n");
}

/* Prepares checkpoints with everything that a resumed run must have in common. */
static enum cs_status begin_checkpoints(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    print_outputs(settings, cs_text_get(&job->renderer), &job->outputs);
    if (job->outputs.failed)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for checkpoints");
    const struct cs_checkpoint_source of = {.scene = cs_text_get(&job->scene),
                                            .hash = job->scene_hash,
                                            .method = cs_text_get(&job->method),
                                            .output_settings = cs_text_get(&job->outputs),
                                            .command = settings->command,
                                            .serialise = record_job,
                                            .ctx = job};
    return cs_checkpointer_begin(&job->checkpoints, &job->session, &of, settings->folder,
                                 &settings->checkpoint, error);
}

/* The loop over frames. */
static enum cs_status run_frames(struct cs_job *job, struct cs_error *error) {
    struct cs_run *run = &job->session.run;
    struct cs_follow follow = {.run = run, .last = job->frames, .every = 1};
    struct cs_progress progress;
    cs_progress_begin(&progress, "frame", job->settings->quiet || job->settings->show);
    while (cs_follow_next(&follow, error)) {
        look(job);
        if (!cs_run_outputs_at(job, CS_RUN_FRAME, error))
            make_checkpoint(job, error);
        cs_progress_show(&progress, run->frame, job->frames);
    }
    cs_progress_end(&progress);
    return error->status;
}

/* Makes steps finer: a tenth of rtol for a method with error control, else half the mean step.
 * options: a copy of the job's. */
static void refine(const struct cs_job *job, void *options) {
    const struct cs_method *method = &job->session.method;
    const struct cs_run *run = &job->session.run;
    const bool adapts = method->integrator->traits & CS_ADAPTIVE;
    const struct cs_option *row = cs_option_find(&method->table, adapts ? "rtol" : "dt");
    double value;
    if (!row || row->type != CS_REAL)
        return;
    memcpy(&value, (const char *)options + row->offset, sizeof value);
    value = adapts ? fmax(value / 10, row->min) : run->t / (double)run->counts.steps / 2;
    memcpy((char *)options + row->offset, &value, sizeof value);
}

/* m, root of the mean square distance of the free particles of two runs, weighted by mass. */
static double distance_between(const struct cs_run *a, const struct cs_run *b) {
    const size_t n = a->system->view.n;
    double sum = 0, mass = 0;
    for (size_t i = 0; i < n; i++) {
        const double m = a->system->inv_mass[i] > 0 ? a->system->mass[i] : 0;
        for (size_t c = 0; c < 3 * n; c += n)
            sum += m * (a->x[c + i] - b->x[c + i]) * (a->x[c + i] - b->x[c + i]);
        mass += m;
    }
    return mass > 0 ? sqrt(sum / mass) : 0;
}

/* The error over that distance, 1/(1 - f) for a finer run with f times the error: half the
 * steps have 2^-order of it, a tenth of rtol hardly any. */
static double extrapolation(const struct cs_method *method) {
    const double order = cs_method_order(method->integrator, method->options, true);
    return method->integrator->traits & CS_ADAPTIVE ? 1 : 1 / (1 - exp2(-order));
}

/* Runs the scene again with finer steps, and measures the distance of both ends. */
static enum cs_status measure_error(struct cs_job *job, struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    const struct cs_integrator *integrator = job->session.method.integrator;
    struct cs_session_settings settings = job->settings->session;
    struct cs_session twin;
    void *options = malloc(integrator->options_size);
    if (!options)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the options of %s",
                       integrator->name);
    memcpy(options, job->session.method.options, integrator->options_size);
    refine(job, options);
    settings.method = integrator;
    settings.options = options;
    settings.render = false;
    settings.threads = 0;
    settings.run = (struct cs_run_settings){.stop = settings.run.stop};
    if (!cs_session_open(&twin, &settings, error)) {
        struct cs_follow follow = {.run = &twin.run, .last = run->frame, .every = 1};
        struct cs_progress progress;
        cs_progress_begin(&progress, "finer frame", job->settings->quiet);
        while (cs_follow_next(&follow, error))
            cs_progress_show(&progress, twin.run.frame, run->frame);
        cs_progress_end(&progress);
        if (twin.run.frame == run->frame)
            job->measured_error =
                extrapolation(&job->session.method) * distance_between(run, &twin.run);
        cs_session_close(&twin);
    }
    free(options);
    return error->status;
}

/* Ends the outputs, also of a run that failed: its last picture and checkpoint are valid. The
 * first failure wins. */
static void finish_files(struct cs_job *job, struct cs_error *error) {
    struct cs_error later = {0};
    write_checkpoint(job, &later);
    cs_run_outputs_at(job, CS_RUN_END, &later);
    if (!error->status)
        *error = later;
}

/* Begins or resumes. A refused checkpoint leaves the rows of its own run untouched. */
static enum cs_status begin_job(struct cs_job *job, struct cs_error *error) {
    if (cs_job_makes_checkpoints(job->settings) && begin_checkpoints(job, error))
        return error->status;
    if (job->settings->resume
            ? cs_checkpointer_load(&job->checkpoints, job->frames, error) ||
                  cs_run_outputs_consume(job, error)
            : cs_energy_monitor_begin(&job->monitor, &job->session.run, error))
        return error->status;
    if (!job->settings->resume)
        look(job);
    return cs_run_outputs_at(job, CS_RUN_BEGIN, error) || job->frames
               ? error->status
               : cs_run_outputs_at(job, CS_RUN_START, error);
}

/* Warns of options that this run never comes to. */
static void warn_of_options(const struct cs_job *job, struct cs_text *out) {
    const uint32_t last = job->frames, interval = job->settings->frame_interval;
    if (job->trace.frame > last)
        cs_text_add(out, "clothsim: warning: --trace: the last frame is %u\n", last);
    if (job->settings->session.render && last && interval > last)
        cs_text_add(out, "clothsim: warning: --every: no picture in %u frames\n", last);
}

/* Prints what the scene's start and the options say about the run; quiet: warnings only. */
static enum cs_status warn(struct cs_job *job, struct cs_error *error) {
    const struct cs_session *session = &job->session;
    struct cs_scene_findings findings;
    struct cs_text out = {0};
    warn_of_options(job, &out);
    if (!cs_scene_doctor_check(session, job->frames / session->scene->time.fps, &findings,
                               error)) {
        cs_print_lines("clothsim: warning: ", cs_text_get(&findings.warnings), &out);
        if (!job->settings->quiet)
            cs_print_lines("clothsim: hint: ", cs_text_get(&findings.hints), &out);
        cs_print_out(stderr, &out, error);
    }
    cs_scene_findings_finish(&findings);
    return error->status;
}

/* Opens the session with ledger, trace and automatic camera. */
static enum cs_status open_session(struct cs_job *job, struct cs_error *error) {
    struct cs_session_settings settings = job->settings->session;
    const bool kept = job->settings->ledger != NULL;
    settings.run.ledger = kept ? &job->ledger : NULL;
    job->trace = job->settings->trace;
    settings.run.trace = job->trace.frame ? &job->trace.trace : NULL;
    job->camera.settings = job->settings;
    settings.edit_scene = settings.render ? cs_run_camera_find : NULL;
    settings.ctx = &job->camera;
    if (cs_session_open(&job->session, &settings, error) || job->camera.error.status)
        return cs_fail(error, job->camera.error.status, "%s", job->camera.error.message);
    return !kept ? CS_OK : cs_energy_ledger_open(&job->ledger, &job->session.system, 0, error);
}

enum cs_status cs_job_run(struct cs_job *job, const struct cs_job_settings *settings,
                          struct cs_error *error) {
    const double start = cs_clock_wall();
    job->settings = settings;
    if (open_session(job, error) || describe(job, error) ||
        cs_checkpointer_check_interval(&job->session, &settings->checkpoint, error) ||
        cs_run_outputs_check(job, error) || cs_run_outputs_open(job, error))
        return error->status;
    const double covering = cs_follow_frames(job->session.scene, settings->seconds);
    if (covering > CS_FRAMES_MAX)
        return cs_fail(error, CS_ERR_USAGE, "--time: %g s are more than %d frames",
                       settings->seconds, (int)CS_FRAMES_MAX);
    job->frames = cs_job_frames(settings, job->session.scene);
    if (warn(job, error) || begin_job(job, error))
        return error->status;
    job->failure = run_frames(job, error) == CS_ERR_MODULE ? error->message : NULL;
    // before the last picture is written, which says the error too
    if (settings->error && !error->status && job->session.run.outcome == CS_RUNNING)
        measure_error(job, error);
    finish_files(job, error);
    job->wall_seconds = cs_clock_wall() - start;
    return error->status;
}

void cs_job_finish(struct cs_job *job) {
    /* a picture under way is drawn into an image of the writer's */
    cs_picture_close(&job->picture);
    cs_frame_writer_destroy(job->writer);
    cs_export_close(&job->export);
    for (int k = 0; k < CS_RUN_OUTPUTS_MAX; k++)
        cs_output_unlock_folders(&job->folders[k]);
    cs_session_close(&job->session);
    cs_text_finish(&job->scene);
    cs_text_finish(&job->method);
    cs_text_finish(&job->provenance);
    cs_text_finish(&job->picture_provenance);
    cs_text_finish(&job->renderer);
    cs_run_json_close(job, &(struct cs_error){0});
    cs_energy_ledger_close(&job->ledger);
    cs_text_finish(&job->outputs);
    cs_checkpointer_finish(&job->checkpoints);
    *job = (struct cs_job){0};
}
