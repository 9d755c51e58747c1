/* clothsim run: simulates a scene and writes pictures, states, hashes and a report.
 *
 *   options -> cs_job_settings -> --range auto: one run without pictures -> cs_job_run
 *   -> run.json and --json -> manifest -> table -> messages on the outcome
 * With --isolate, or a module from outside, everything happens in a child process, and a crash
 * of a module or a hung call becomes an error message. A blow-up is a result: it is reported
 * and exits with 0, unless
 * --strict asks for an error. */
#include "base/pool.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/run/job_state.h"
#include "session/scene_view.h"
#include "session/session.h"
#include "study/stability_verdict.h"

#include <string.h>
#include <strings.h>

/* s that a call of a module from outside may go on after the first signal to stop: a step of a
 * large scene, after which the run saves itself. */
enum { STOP_SECONDS = 10 };

/* The options as given; read_settings derives the rest of the job's settings. */
struct options {
    struct cs_job_settings job;
    const char *checkpoint, *resume, *trace, *export, *values, *range;
    double isolate; /* s; 0: not */
    bool strict, mark_instability;
    bool is_repeated; /* they are those of a checkpoint */
};
static const struct options defaults = {
    .job = {.session = {.render = true, .threads = CS_THREADS_AUTO},
            .frames = CS_FRAMES_DEFAULT,
            .frame_interval = 1,
            .folder = "out",
            .level = 2}};

static const struct cs_arg rows[] = {
    {"frames", 'n', "N",
     "simulate frames 1 to N; 0: the start alone (default: one second of frames)",
     CS_ARG_INTO(struct options, job.frames), .min = 0, .max = CS_FRAMES_MAX},
    {"time", 't', "SECONDS", "simulate that time, in whole frames",
     CS_ARG_INTO(struct options, job.seconds)},
    {"integrator", 'i', "NAME[:KEY=VALUE,...]",
     "method and its options, instead of the scene's (see: clothsim integrators)",
     CS_ARG_INTO(struct options, job.session.integrator)},
    {"set", 's', "PATH=VALUE",
     "override a scene value, such as bodies[0].springs.stretch=200; may be repeated",
     CS_ARG_LIST(struct options, job.session.overrides, job.session.n_overrides)},
    CS_ARG_PLUGIN(struct options, job.session),
    {"out", 'o', "DIR", "folder for frame_00001.png ... and run.json (default: out)",
     CS_ARG_INTO(struct options, job.folder)},
    {"overwrite", 'y', NULL, "replace the files of an earlier run",
     CS_ARG_INTO(struct options, job.overwrite)},
    {"no-render", 0, NULL, "draw nothing", CS_ARG_INTO(struct options, job.session.render)},
    {"show", 0, NULL, "show each picture in the terminal",
     CS_ARG_INTO(struct options, job.show)},
    {"every", 0, "K",
     "draw and export frames K, 2K, 3K ... only, numbered 1, 2, 3 ... (default: 1)",
     CS_ARG_INTO(struct options, job.frame_interval), .min = 1, .max = CS_FRAMES_MAX},
    {"checkpoint", 0, "EVERY",
     "write DIR/run.checkpoint every so many frames, or seconds as in 30s",
     CS_ARG_INTO(struct options, checkpoint)},
    {"resume", 0, "DIR",
     "continue from the checkpoint in DIR; without SCENE, with the options of its run, except "
     "those of length and report",
     CS_ARG_INTO(struct options, resume)},
    {"isolate", 0, "SECONDS",
     "run in a separate process, and end it if one call of the method or the renderer takes "
     "longer",
     CS_ARG_INTO(struct options, isolate)},
    {"states", 0, "DIR",
     "write x_00000.npy, v_00000.npy ...: positions and velocities of the start (0) and of "
     "each frame",
     CS_ARG_INTO(struct options, job.states)},
    {"export", 0, "FORMAT[,...]",
     "write the run into DIR for other programs: obj and pc2 (Blender), vtp (ParaView), npz "
     "(NumPy)",
     CS_ARG_INTO(struct options, export)},
    {"export-values", 0, "VALUE[,...]",
     "force, strain: of each particle, in files of vtp and npz",
     CS_ARG_INTO(struct options, values)},
    {"hash", 0, NULL, "print number and state hash of each frame, one per line",
     CS_ARG_INTO(struct options, job.hash)},
    {"json", 0, "FILE", "write the report as JSON too; -: to standard output",
     CS_ARG_INTO(struct options, job.json)},
    {"monitor", 0, "FILE",
     "write energy, largest strain and largest velocity of each frame as CSV; -: to standard "
     "output",
     CS_ARG_INTO(struct options, job.monitor_file)},
    {"ledger", 0, "FILE",
     "write the energy balance of each frame as CSV; -: to standard output",
     CS_ARG_INTO(struct options, job.ledger)},
    {"trace", 0, "FRAME",
     "write every array that this frame computes to standard output, or with \"frames\" the "
     "state of each frame: for clothsim bisect",
     CS_ARG_INTO(struct options, trace)},
    {"error", 0, NULL,
     "measure the error of the end by a second run, with a tenth of rtol or half the steps",
     CS_ARG_INTO(struct options, job.error)},
    {"timing", 0, NULL, "print the time of each stage of a run and its peak memory",
     CS_ARG_INTO(struct options, job.session.run.timed)},
    {"threads", 0, "N",
     "threads that step the scene, 1 to 64 (default: one per processor, up to 16; 1 below "
     "16384 particles, or below 1024 with contact by force)",
     CS_ARG_INTO(struct options, job.session.threads), .min = 1, .max = CS_POOL_THREADS_MAX},
    {"renderer", 0, "NAME", "cpu, osmesa or auto (default: auto)",
     CS_ARG_INTO(struct options, job.renderer), .names = cs_renderer_names},
    {"range", 0, "RANGE",
     "range of the colours of looks force and strain in all pictures: MIN,MAX, or auto, which "
     "runs the scene twice (default: the range of each frame)",
     CS_ARG_INTO(struct options, range)},
    {"mark-instability", 0, NULL,
     "mark the particle where an instability begins, and its neighbours, in all pictures; runs "
     "the scene twice",
     CS_ARG_INTO(struct options, mark_instability)},
    {"fast-render", 0, NULL,
     "use all instructions of the processor; pixels then depend on the machine",
     CS_ARG_INTO(struct options, job.fast_render)},
    {"png-level", 0, "LEVEL", "compression, 0 to 9 (default: 2)",
     CS_ARG_INTO(struct options, job.level), .min = 0, .max = 9},
    {"strict", 0, NULL, "exit with 8 if the run blew up or gave up",
     CS_ARG_INTO(struct options, strict)},
    CS_ARG_QUIET(struct options, job.quiet),
};

/* Reads --checkpoint and --resume. A resumed run continues in its folder with its interval,
 * hence options that would change them are refused. */
static enum cs_status read_checkpoints(const struct cs_args *args, struct options *options,
                                       struct cs_error *error) {
    static const char *const others[] = {"checkpoint", "out", "overwrite"};
    for (size_t k = 0;
         !options->is_repeated && options->resume && k < sizeof others / sizeof *others; k++)
        if (cs_args_is_given(args, others[k]))
            return cs_fail(error, CS_ERR_USAGE,
                           "--resume continues with the options of the run: remove --%s",
                           others[k]);
    options->job.resume = options->resume;
    options->job.folder = options->resume ? options->resume : options->job.folder;
    return options->checkpoint ? cs_checkpointer_read_interval(options->checkpoint,
                                                               &options->job.checkpoint, error)
                               : CS_OK;
}

/* Refuses two outputs on standard output: a program could not separate them in one stream. */
static enum cs_status check_stream(const struct cs_job_settings *settings,
                                   struct cs_error *error) {
    const struct {
        const char *name;
        bool asks;
    } outputs[] = {{"--hash", settings->hash},
                   {"--json -", cs_print_is_stdout(settings->json)},
                   {"--monitor -", cs_print_is_stdout(settings->monitor_file)},
                   {"--ledger -", cs_print_is_stdout(settings->ledger)},
                   {"--trace", settings->trace.is_requested},
                   {"--show", settings->show}};
    const char *first = NULL;
    for (size_t k = 0; k < sizeof outputs / sizeof *outputs; k++) {
        if (outputs[k].asks && first)
            return cs_fail(error, CS_ERR_USAGE,
                           "%s and %s cannot both write to standard output", first,
                           outputs[k].name);
        first = outputs[k].asks ? outputs[k].name : first;
    }
    return CS_OK;
}

static enum cs_status check_show(const struct cs_job_settings *settings,
                                 struct cs_error *error) {
    return settings->show && !settings->session.render
               ? cs_fail(error, CS_ERR_USAGE, "--show needs pictures: remove --no-render")
               : CS_OK;
}

/* Refuses the name of a film or a picture, where a folder is meant. */
static enum cs_status check_folder(const char *folder, struct cs_error *error) {
    static const char *const endings[] = {".mp4", ".webm", ".mkv", ".avi",  ".mov",
                                          ".gif", ".png",  ".jpg", ".jpeg", NULL};
    const char *ending = folder ? strrchr(folder, '.') : NULL;
    for (int k = 0; ending && endings[k]; k++)
        if (!strcasecmp(ending, endings[k]))
            return cs_fail(error, CS_ERR_USAGE,
                           "--out: found \"%s\", expected a folder, which is filled with "
                           "pictures; clothsim film makes a film of them",
                           folder);
    return CS_OK;
}

/* Stores the words of the command line for checkpoints; none if a word has a line of its own.
 */
static enum cs_status store_command(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    struct cs_text words = {0};
    bool is_plain = true;
    for (uint32_t k = 0; k < args->n_words; k++) {
        is_plain = is_plain && !strchr(args->words[k], '\n');
        cs_text_add(&words, "%s\n", args->words[k]);
    }
    options->job.command = cs_arena_copy_text(
        &args->arena, is_plain && !words.failed ? cs_text_get(&words) : "", error);
    cs_text_finish(&words);
    return error->status;
}

/* Derives the job's settings from the options, and checks their combinations. */
static enum cs_status read_settings(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    struct cs_job_settings *settings = &options->job;
    settings->session.scene = args->operands[0];
    settings->session.run.stop = cs_interrupt_catch();
    if (read_checkpoints(args, options, error) || store_command(args, error) ||
        (options->trace && cs_run_trace_read(options->trace, &settings->trace, error)) ||
        check_stream(settings, error) || check_show(settings, error) ||
        check_folder(settings->folder, error) ||
        cs_run_export_read(options->export, options->values, &settings->export, error))
        return error->status;
    settings->out = settings->folder;
    if (!settings->session.render && !cs_job_makes_checkpoints(settings) &&
        !settings->export.formats)
        settings->folder = NULL;
    return CS_OK;
}

/* Finds a singular force, if that is why the run ended or made energy, at a twentieth of its
 * work. */
static void find_cause(struct cs_job *job) {
    const struct cs_run *run = &job->session.run;
    const bool blown = cs_outcome_is_blow_up(run->outcome);
    const double end = blown ? run->blow_up.time : run->t;
    struct cs_error ignored = {0};
    if (run->system && (blown || run->outcome == CS_GAVE_UP || job->failure ||
                        job->monitor.first.verdict != CS_STABILITY_BOUNDED))
        cs_singular_force_find(&job->settings->session, end + 1 / run->system->scene->time.fps,
                               cs_counts_work(&run->counts) / 20, &job->cause, &ignored);
}

/* Warns of limits that were missed and of a physically impossible final state, whatever else is
 * printed. */
static void print_watch(const struct cs_job *job) {
    const struct cs_run *run = &job->session.run;
    struct cs_text found = {0};
    cs_report_print_shortfalls(job);
    cs_energy_monitor_print(&job->monitor, run->system, &found);
    if (found.length) {
        const struct cs_energy energy =
            cs_diagnostics_energy(run->system, run->t, run->x, run->v);
        cs_text_add(&found, "; %.3g J at the end", cs_energy_without_gravity(&energy));
        cs_text_add(&found, *job->cause.text ? "; %s" : " (clothsim advise finds stable steps)",
                    job->cause.text);
        cs_print_message(cs_text_get(&found));
    }
    cs_text_finish(&found);
}

/* Reports a run that stopped early; with strict, a blow-up and giving up are errors. */
static enum cs_status print_outcome(const struct cs_job *job, bool strict,
                                    struct cs_error *error) {
    const struct cs_run *run = &job->session.run;
    struct cs_text outcome = {0};
    if (run->outcome == CS_RUNNING) {
        print_watch(job);
        return CS_OK;
    }
    cs_report_print_outcome(job, &outcome);
    cs_text_add(&outcome, "; %u of %u frames were finished", run->frame, job->frames);
    if (run->outcome == CS_INTERRUPTED)
        cs_fail(error, CS_ERR_INTERRUPT, "%s", cs_text_get(&outcome));
    else if (strict && (cs_outcome_is_blow_up(run->outcome) || run->outcome == CS_GAVE_UP))
        cs_fail(error, CS_ERR_UNSTABLE, "%s", cs_text_get(&outcome));
    else
        cs_print_message(cs_text_get(&outcome));
    cs_text_finish(&outcome);
    return error->status;
}

/* The run in this process. A failed step leaves the report and the manifest of the frames
 * before it; the message of the step stands. */
static enum cs_status run_here(void *ctx, struct cs_error *error) {
    struct cs_args *args = ctx;
    struct options *options = args->options;
    struct cs_job job = {0};
    struct cs_run_range range = {0};
    if (read_settings(args, error) ||
        (options->range && cs_run_range_set(&range, options->range, &options->job, error)) ||
        (options->mark_instability && cs_run_marks_set(&range, &options->job, error)))
        return error->status;
    cs_job_run(&job, &options->job, error);
    find_cause(&job);
    /* a failed step leaves the report of the frames before; its own message stands */
    struct cs_error later = {0};
    if (job.failure && *job.cause.text)
        cs_print_message(job.cause.text);
    if (job.failure && !cs_report_write_json(&job, &later))
        cs_run_outputs_sign(&job, &later);
    if (!error->status && !cs_report_write_json(&job, error) &&
        !cs_run_outputs_sign(&job, error) && !cs_report_print(&job, error))
        print_outcome(&job, options->strict, error);
    cs_job_finish(&job);
    cs_run_range_finish(&range);
    return error->status;
}

/* Puts the options that were typed over those of the run that goes on. */
static enum cs_status change_options(const struct cs_args *args, struct options *options,
                                     struct cs_error *error) {
    static const char *const taken[] = {"resume", "frames", "time", "quiet",
                                        "strict", "timing", NULL};
    const struct options *typed = args->options;
    for (uint32_t k = 0; k < args->n_given; k++) {
        uint32_t t = 0;
        while (taken[t] && strcmp(taken[t], args->given[k].row->name))
            t++;
        if (!taken[t])
            return cs_fail(error, CS_ERR_USAGE,
                           "--resume without SCENE repeats the options of the run: remove --%s",
                           args->given[k].row->name);
    }
    /* the folder and the interval are those of the checkpoint */
    options->is_repeated = true;
    options->resume = typed->resume;
    options->checkpoint = NULL;
    options->job.overwrite = false;
    options->job.quiet = options->job.quiet || typed->job.quiet;
    options->strict = options->strict || typed->strict;
    options->job.session.run.timed =
        options->job.session.run.timed || typed->job.session.run.timed;
    if (cs_args_is_given(args, "frames") || cs_args_is_given(args, "time")) {
        options->job.frames = typed->job.frames;
        options->job.seconds = typed->job.seconds;
    }
    return CS_OK;
}

/* Parses the command line of the checkpoint to resume from, with the options typed now. */
static enum cs_status repeat_command(struct cs_args *args, struct cs_args *repeated,
                                     struct cs_error *error) {
    const struct options *typed = args->options;
    char path[4096];
    struct cs_text text = {0};
    int n = 0;
    snprintf(path, sizeof path, "%s/run.checkpoint", typed->resume);
    if (cs_checkpoint_read_command(path, &text, error)) {
        cs_text_finish(&text);
        return error->status;
    }
    char *words = cs_arena_copy_text(&args->arena, cs_text_get(&text), error);
    char **list = cs_arena_alloc_array(&args->arena, text.length + 1, sizeof *list, error);
    cs_text_finish(&text);
    /* strsep leaves NULL or the end behind the last word */
    while (words && list && *words)
        list[n++] = strsep(&words, "\n");
    return error->status || cs_args_parse(repeated, args->command, n, list, error)
               ? error->status
           : cs_args_is_given(repeated, "program")
               ? cs_fail(error, CS_ERR_USAGE,
                         "--resume without SCENE starts no program: give SCENE and the options "
                         "of the run again")
               : change_options(args, repeated->options, error);
}

/* The run of the arguments, in a process of its own if it may not end. */
static enum cs_status run_guarded(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    const char *method = options->job.session.integrator;
    return options->isolate > 0 || cs_external_modules_requested(args, &method, 1)
               ? cs_external_modules_isolate(args, options->isolate, STOP_SECONDS, run_here,
                                             error)
               : run_here(args, error);
}

static enum cs_status run(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    struct cs_args repeated = {0};
    if (cs_args_refuse_both(args, "frames", "time", error))
        return error->status;
    if (args->n_operands)
        return run_guarded(args, error);
    if (!options->resume)
        return cs_fail(error, CS_ERR_USAGE, "expected SCENE (see: clothsim run --help)");
    if (!repeat_command(args, &repeated, error))
        run_guarded(&repeated, error);
    cs_args_finish(&repeated);
    return error->status;
}

const struct cs_command cs_command_run = {
    .name = "run",
    .operands = "SCENE",
    .summary = "simulate a scene and write its frames as PNG pictures",
    .notes = "Frame k shows the time k / fps. A run that blows up is a result: it reports\n"
             "the time and the particle, keeps earlier frames, and exits with 0.\n"
             "\n"
             "Example: clothsim run scenes/hang.json --frames 60 -i velocity-verlet:dt=0.001\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 0,
    .operands_max = 1,
    .main = run,
};
