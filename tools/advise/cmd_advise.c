/* clothsim advise: finds the largest safe time step of each method, its limit and its cost.
 *
 *   options -> cs_advise_run: theory, probe runs, bisection -> table
 *   options with --error -> cs_compare_run -> the cheapest method and step for that error */
#include "advise/advise.h"
#include "advise/cheapest.h"
#include "base/json_writer.h"
#include "base/pool.h"
#include "borders/stability_state.h"
#include "cli/commands.h"
#include "cli/line/print.h"
#include "cli/manifest.h"
#include "cli/run_folder.h"
#include "session/process_pool.h"
#include "session/scene_view.h"
#include "session/session.h"
#include "study/compare/cell_list_parse.h"
#include "study/compare/compare.h"
#include "study/compare/equal_error.h"

#include <math.h>
#include <string.h>

/* The stiffest spring at a particle. */
struct spring {
    double stiffness; /* N/m; 0: none */
    uint32_t kind;
};

/* Finds the spring that most likely causes a mode which is localised at the particle. */
static struct spring stiffest_at(const struct cs_system *system, uint32_t particle) {
    struct spring found = {0};
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; i < run->count; i++) {
            const double stiffness = cs_spring_stiffness(run, i);
            if ((cs_spring_a(run, i) == particle || cs_spring_b(run, i) == particle) &&
                stiffness > found.stiffness)
                found = (struct spring){stiffness, run->kind};
        }
    }
    return found;
}

/* "particle 12 (body 0, column 4, row 1) swings at 4158 /s on stretch springs of 1000 N/m".
 *
 * s'' + r s' + q s = 0 is over-damped if r^2 > 4 q: then only the rate is printed. A mode
 * beyond the bounds of the springs must be due to contact. */
static void add_binding(const struct cs_system *system, const struct cs_mode *mode,
                        struct cs_text *out) {
    static const char *const kinds[CS_SPRING_KINDS] = {"stretch", "shear", "bend"};
    const struct spring spring = stiffest_at(system, mode->particle);
    const bool damped = mode->damping_rate * mode->damping_rate > 4 * mode->omega_squared;
    cs_system_print_particle(system, mode->particle, out);
    if (damped)
        cs_text_add(out, " is damped at %.4g /s", mode->damping_rate);
    else
        cs_text_add(out, " oscillates at %.4g /s, damped at %.3g /s",
                    sqrt(fmax(mode->omega_squared, 0)), mode->damping_rate);
    if (mode->damping_rate > 2 * system->view.delta ||
        mode->omega_squared > system->view.omega * system->view.omega)
        cs_text_add(out, " by contact");
    if (spring.stiffness > 0)
        cs_text_add(out, ": %.3g kg on %s springs of %.4g N/m", system->mass[mode->particle],
                    kinds[spring.kind], spring.stiffness);
}

/* When something hit, or a membrane was stretched, and the limit at the end, if that is clearly
 * longer. */
static void add_times(const struct cs_advise *advise, const struct cs_advice *row,
                      struct cs_text *out) {
    const struct cs_scene *scene = advise->was_opened.system.scene;
    const bool meets = scene->colliders.n || cs_scene_has_body_contact(scene);
    if (row->end_limit < 1e100 && row->theory < 0.95 * row->end_limit)
        cs_text_add(out, "; %s, at t = %.4g s: at rest, at %.4g s, %.4g s",
                    meets ? "while something hits" : "where it is stretched", row->time,
                    row->seconds, row->end_limit);
}

/* The reason of an advised step, and remarks on its probe run. */
static void add_why(const struct cs_advise *advise, const struct cs_advice *row,
                    struct cs_text *out) {
    switch (row->kind) {
    case CS_ADVICE_THEORY:
        add_binding(&advise->was_opened.system, &row->mode, out);
        add_times(advise, row, out);
        break;
    case CS_ADVICE_LOWERED:
        add_binding(&advise->was_opened.system, &row->mode, out);
        cs_text_add(out, "; bisected, linear theory allows %.4g s", row->theory);
        add_times(advise, row, out);
        break;
    case CS_ADVICE_MEASURED:
        cs_text_add(out, "no limit in linear theory; bisected, large motions set it");
        break;
    case CS_ADVICE_FRAME:
        cs_text_add(out, "no limit found: one step per frame");
        break;
    case CS_ADVICE_NONE:
        if (!*row->message)
            cs_text_add(
                out, "no stable step for a run of %.4g s: damping is too weak for this method",
                advise->seconds);
        break;
    case CS_ADVICE_ADAPTIVE:
        cs_text_add(out, cs_advice_is_unstable(row) ? "not advised" : "chooses its own steps");
        break;
    case CS_ADVICE_REFUSED:
        break;
    }
    if (row->cut > 0 && cs_advice_has_step(row))
        cs_text_add(out, "; its reference was over budget at %.3g s", row->cut);
    if (row->steps_ahead > 0 && cs_advice_has_step(row))
        cs_text_add(out, "; without a reference, because %.3g explicit steps exceed the budget",
                    row->steps_ahead);
    if (row->mode_growth > 0)
        cs_text_add(out, "; its worst mode grows at %.2g /s", row->mode_growth);
    /* a message says more than the verdict; a sound run needs neither */
    if (*row->message)
        cs_text_add(out, "%s%s",
                    row->kind == CS_ADVICE_REFUSED || row->kind == CS_ADVICE_NONE ? "" : "; ",
                    row->message);
    else if (row->verdict != CS_STABILITY_BOUNDED && row->kind != CS_ADVICE_NONE)
        cs_text_add(out, "; %s", cs_stability_word(row->verdict));
    if (row->verdict == CS_STABILITY_OVER_BUDGET && row->kind != CS_ADVICE_REFUSED)
        cs_text_add(out, " after %.3g s: not tested longer", row->checked_seconds);
}

/* A number, or "-" for none: 0, NAN or no limit. */
static void add_number(struct cs_text *out, double value, int width) {
    if (value > 0 && value < 1e100)
        cs_text_add(out, "%*.4g", width, value);
    else
        cs_text_add(out, "%*s", width, "-");
}

/* Notes on contact, with the fastest speed of all reference runs. */
static void add_contact(const struct cs_advise *advise, struct cs_text *out) {
    const struct cs_system *system = &advise->was_opened.system;
    double speed = 0;
    for (uint32_t k = 0; k < advise->n; k++)
        speed = fmax(speed, advise->rows[k].speed);
    if (!system->scene->colliders.n && !cs_scene_has_body_contact(system->scene))
        return;
    cs_contact_note_add(system->scene, "", out);
    cs_text_add(out, "\n");
    cs_contact_note_add_crossing(system, speed, out);
}

/* Names the method for dampers that limit explicit steps more than springs do: at delta = 6.3
 * omega it takes a tenth of the evaluations of dopri5 (reef_knot, rtol 1e-4). */
static void add_damping(const struct cs_view *view, struct cs_text *out) {
    if (view->delta > 2 * view->omega)
        cs_text_add(out,
                    "damping (delta %.4g 1/s) limits explicit steps, not the springs (omega "
                    "%.4g 1/s): try rkc2 or rock4\n",
                    view->delta, view->omega);
}

/* Adds a line per method and below it what limits the step; notes on contact and damping come
 * first. */
static void advise_print(const struct cs_advise *advise, struct cs_text *out) {
    add_contact(advise, out);
    cs_system_print_elastic(&advise->was_opened.system, out);
    add_damping(&advise->was_opened.system.view, out);
    cs_text_add(out, "advice for runs of %.4g s; each step was tested for that long\n",
                advise->seconds);
    cs_text_add(out, "%-22s%12s%12s%s%12s%14s\n", "method", "limit [s]", "advised [s]",
                advise->bisect_too ? "   found [s]" : "", "steps/frame", "ms/frame");
    for (uint32_t k = 0; k < advise->n; k++) {
        const struct cs_advice *row = advise->rows + k;
        cs_text_add(out, "%-22s", row->method);
        add_number(out, row->limit, 12);
        add_number(out, cs_advice_has_step(row) ? row->safe : 0, 12);
        if (advise->bisect_too)
            add_number(out, row->measured, 12);
        add_number(out, row->steps, 12);
        add_number(out, 1e3 * row->frame_cost, 14);
        cs_text_add(out, "\n    ");
        add_why(advise, row, out);
        cs_text_add(out, "\n");
    }
}

/* A number or null: no limit, or none known. */
static void add_json_number(const char *name, double value, struct cs_text *out) {
    cs_text_add(out, value > 0 && value < 1e100 ? ", \"%s\": %.9g" : ", \"%s\": null", name,
                value);
}

static enum cs_status write_json(const struct cs_advise *advise, const char *path,
                                 struct cs_error *error) {
    static const char *const kinds[] = {
        [CS_ADVICE_THEORY] = "theory",     [CS_ADVICE_LOWERED] = "bisected",
        [CS_ADVICE_MEASURED] = "bisected", [CS_ADVICE_FRAME] = "no limit",
        [CS_ADVICE_ADAPTIVE] = "adaptive", [CS_ADVICE_NONE] = "none",
        [CS_ADVICE_REFUSED] = "refused"};
    struct cs_text out = {0};
    cs_json_write(&out, "{\n  'scene': %s,\n  'seconds': %g,\n  'rows': [",
                  advise->session.scene, advise->seconds);
    for (uint32_t k = 0; k < advise->n; k++) {
        const struct cs_advice *row = advise->rows + k;
        cs_json_write(&out, ",\n    {'method': %s, 'kind': %s", row->method, kinds[row->kind]);
        add_json_number("limit", row->limit, &out);
        add_json_number("advised", cs_advice_has_step(row) ? row->safe : 0, &out);
        add_json_number("found", row->measured, &out);
        add_json_number("steps_per_frame", row->steps, &out);
        add_json_number("seconds_per_frame", row->frame_cost, &out);
        cs_json_write(&out, ", 'verdict': %s, 'message': %s}", cs_stability_word(row->verdict),
                      row->message);
    }
    cs_text_add(&out, "\n  ]\n}\n");
    return cs_print_file(path, &out, error);
}

struct options {
    struct cs_advise study;
    double error;    /* m; 0: not asked for */
    uint32_t frames; /* 0: by the time */
    const char *folder, *json;
    bool quiet;
};

static const struct options defaults = {.study = {.seconds = 10}, .folder = "advise"};

static const struct cs_arg rows[] = {
    {"integrators", 'i', "LIST",
     "methods, NAME:KEY=VALUE,...,NAME...; may be repeated (default: all)",
     CS_ARG_LIST(struct options, study.methods, study.n_methods), .methods = true},
    {"check", 0, NULL, "bisect the limits too, and print both",
     CS_ARG_INTO(struct options, study.bisect_too)},
    {"error", 0, "METRES",
     "find the cheapest method and step for this position error by a comparison over --time "
     "(then 0.5 s by default)",
     CS_ARG_INTO(struct options, error)},
    {"out", 'o', "DIR",
     "folder of that comparison, which continues where it stopped (default: advise)",
     CS_ARG_INTO(struct options, folder)},
    {"time", 't', "SECONDS",
     "simulated time that the steps must survive, the minimum for every run (default: 10)",
     CS_ARG_INTO(struct options, study.seconds)},
    {"frames", 'n', "N", "the same time in frames", CS_ARG_INTO(struct options, frames),
     .min = 1, .max = 1000000},
    {"budget", 0, "SECONDS",
     "work of all runs, or with --error of one, in nominal seconds (default: 20)",
     CS_ARG_INTO(struct options, study.budget)},
    {"jobs", 'j', "N", "methods run in parallel (default: one per processor)",
     CS_ARG_INTO(struct options, study.workers), .min = 1, .max = CS_PROCESS_POOL_MAX},
    {"json", 0, "FILE", "write the advice as JSON too; -: to standard output",
     CS_ARG_INTO(struct options, json)},
    CS_ARG_SET(struct options, study.session),
    CS_ARG_PLUGIN(struct options, study.session),
    CS_ARG_QUIET(struct options, quiet),
};

/* "NAME:options,NAME:options" of the requested methods; "" for all. */
static void join(const struct cs_advise *study, struct cs_text *list) {
    for (uint32_t k = 0; k < study->n_methods; k++)
        cs_text_add(list, "%s%s", k ? "," : "", study->methods[k]);
}

/* files that stand in the place of methods */
static enum cs_status add_modules(struct cs_args *args, struct cs_compare_settings *settings,
                                  struct cs_error *error) {
    struct cs_session_settings *session = &settings->run.session;
    return settings->methods
               ? cs_cell_list_add_modules(settings->methods, &args->arena, &session->plugins,
                                          &session->n_plugins, error)
               : CS_OK;
}

/* Answers "cheapest way to an error" by a comparison of the cells that a search chooses. */
static enum cs_status advise_for_error(struct cs_args *args, struct cs_error *error) {
    const struct options *options = args->options;
    const struct cs_advise *study = &options->study;
    const double bound = options->error;
    struct cs_cheapest search = {0};
    struct cs_compare compare = {0};
    struct cs_text list = {0}, out = {0};
    join(study, &list);
    struct cs_compare_settings settings = {.run = {.session = study->session},
                                           .methods =
                                               study->n_methods ? cs_text_get(&list) : NULL,
                                           .accuracy = bound < 1e-6 ? bound : 1e-6,
                                           .bound = bound,
                                           .budget = study->budget > 0 ? study->budget : 20,
                                           .next = cs_cheapest_choose,
                                           .ctx = &search,
                                           .runs = 15,
                                           .folder = options->folder,
                                           .cache = options->folder};
    double seconds = cs_args_is_given(args, "time") ? study->seconds : 0.5;
    settings.run.frames = options->frames;
    if (list.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of methods");
    else if (!add_modules(args, &settings, error) &&
             !cs_session_fit_frames(&study->session, &settings.run.frames, &seconds, error))
        cs_compare_run(&compare, &settings, error);
    if (!cs_manifest_write_study(options->folder, error)) {
        cs_cheapest_print(&compare, bound, &out);
        cs_compare_warn(&compare, "warning: ", &out);
        cs_print_out(stdout, &out, error);
    }
    cs_compare_finish(&compare);
    cs_cheapest_finish(&search);
    cs_text_finish(&list);
    return error->status;
}

/* The same flag stops the present run and prevents further ones. */
static enum cs_status advise(struct cs_args *args, struct cs_error *error) {
    struct cs_progress progress;
    struct cs_text out = {0};
    struct options *options = args->options;
    struct cs_advise *study = &options->study;
    study->session.scene = args->operands[0];
    if (study->n_methods == 1 && !strcmp(study->methods[0], "all"))
        study->n_methods = 0;
    if (!study->workers)
        study->workers = cs_pool_processors(CS_PROCESS_POOL_MAX);
    study->session.run.stop = study->stop = cs_interrupt_catch();
    if (cs_args_refuse_both(args, "frames", "time", error) ||
        cs_study_output_check(&study->session, options->json, "--json", error))
        return error->status;
    if (options->error > 0 && options->json)
        return cs_fail(
            error, CS_ERR_USAGE,
            "--json: with --error the report is compare.json's; use clothsim compare");
    if (options->error > 0)
        return advise_for_error(args, error);
    if (options->frames &&
        cs_session_fit_frames(&study->session, &options->frames, &study->seconds, error))
        return error->status;
    study->progress = cs_progress_show;
    study->ctx = &progress;
    cs_progress_begin(&progress, "work", options->quiet);
    cs_advise_run(study, error);
    /* the line goes before anything is printed below it */
    cs_progress_end(&progress);
    if (!error->status && options->json)
        write_json(study, options->json, error);
    if (!error->status && !cs_print_is_stdout(options->json)) {
        advise_print(study, &out);
        cs_print_out(stdout, &out, error);
    }
    if (!error->status)
        cs_advise_check(study, error);
    cs_advise_finish(study);
    return error->status;
}

const struct cs_command cs_command_advise = {
    .name = "advise",
    .operands = "SCENE",
    .summary = "find the largest safe step of each method and what limits it",
    .notes = "Example: clothsim advise scenes/hang.json -i velocity-verlet\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 1,
    .operands_max = 1,
    .main = advise,
};
