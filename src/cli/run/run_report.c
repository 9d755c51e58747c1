/* Prints the result of a run as a table: outcome, counts, energy, memory and times. */
#include "cli/run/job_state.h"

#include "base/pool.h"
#include "cli/line/print.h"
#include "session/scene_view.h"

#include <stdio.h>
#include <sys/resource.h>

enum { VALUE_COLUMN = 16, STAGE_COLUMN = 24 };

__attribute__((format(printf, 3, 4))) static void
add_report_row(struct cs_text *out, const char *name, const char *format, ...) {
    char value[512];
    CS_FORMAT(value, format);
    cs_print_row(name, value, VALUE_COLUMN, out);
}

void cs_report_print_shortfalls(const struct cs_job *job) {
    const struct cs_run *run = &job->session.run;
    const struct cs_cloth_peak *depth = job->monitor.cloth + CS_CLOTH_DEPTH;
    struct cs_text text = {0}, lines = {0};
    if (run->strain_limit.missed > 0)
        cs_text_add(
            &text,
            "strain_limit was missed by up to %.3g %%: stiffer springs or shorter steps "
            "need it less\n",
            100 * run->strain_limit.missed);
    if (job->monitor.worst_verdict == CS_STABILITY_BEYOND) {
        cs_energy_monitor_print_beyond(&job->monitor, &text);
        if (depth->value > depth->bound && run->system->plan.rows[CS_FEATURE_CONTACT].built)
            cs_text_add(&text, "; contact.law force or shorter steps keep particles out");
    }
    cs_print_lines("clothsim: warning: ", cs_text_get(&text), &lines);
    cs_print_out(stderr, &lines, &(struct cs_error){0});
    cs_text_finish(&text);
}

void cs_report_print_outcome(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    cs_text_add(out, "%s", cs_outcome_text(run->outcome));
    if (run->outcome == CS_RUNNING)
        return;
    const bool blown = cs_outcome_is_blow_up(run->outcome);
    if (run->reason)
        cs_text_add(out, ": %s", run->reason);
    else
        cs_text_add(out, " at t = %.6g s", blown ? run->blow_up.time : run->t);
    if (blown) {
        cs_text_add(out, ", ");
        cs_system_print_particle(&job->session.system, run->blow_up.particle, out);
    }
    if (run->outcome == CS_UNBOUNDED)
        cs_text_add(out, ", kinetic energy %.3g J exceeds %.3g J", run->blow_up.energy,
                    run->blow_up.bound);
    cs_text_add(out, "%s%s", *job->cause.text ? "; " : "", job->cause.text);
}

/* Progress and outcome. */
static void add_frames(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    struct cs_text outcome = {0};
    cs_report_print_outcome(job, &outcome);
    add_report_row(out, "frames", "%u of %u, t = %.6g s", run->frame, job->frames, run->t);
    cs_print_hanging("outcome", cs_text_get(&outcome), VALUE_COLUMN, out);
    cs_text_finish(&outcome);
}

/* Only if the energy monitor found something. */
static void add_watch(const struct cs_job *job, struct cs_text *out) {
    struct cs_text found = {0};
    cs_energy_monitor_print(&job->monitor, &job->session.system, &found);
    if (job->monitor.worst_verdict == CS_STABILITY_BEYOND)
        cs_energy_monitor_print_beyond(&job->monitor, &found);
    if (found.length)
        cs_print_hanging("monitor", cs_text_get(&found), VALUE_COLUMN, out);
    cs_text_finish(&found);
}

/* Only if crossings were counted. */
static void add_crossings(const struct cs_job *job, struct cs_text *out) {
    struct cs_text found = {0};
    if (!job->crossings.is_counted)
        return;
    cs_crossing_stats_print(&job->crossings, &job->session.system, &found);
    cs_print_hanging("crossings", cs_text_get(&found), VALUE_COLUMN, out);
    cs_text_finish(&found);
}

/* Only with contact by force: what it holds, and what may come. */
static void add_contact(const struct cs_job *job, struct cs_text *out) {
    struct cs_contact_capacity capacity;
    struct cs_text found = {0};
    if (!cs_contact_capacity_find(&job->session.system, &capacity))
        return;
    cs_contact_capacity_print(&job->session.system, &capacity, &found);
    cs_print_hanging("contact", cs_text_get(&found), VALUE_COLUMN, out);
    cs_text_finish(&found);
}

/* Only parts that were active have a row. */
static void add_counts(const struct cs_job *job, struct cs_text *out) {
    const struct cs_counts *c = &job->session.run.counts;
    add_report_row(out, "steps", "%llu, %llu rejected", (unsigned long long)c->steps,
                   (unsigned long long)c->method.rejected);
    add_report_row(out, "evaluations", "%llu of the force, %llu of its derivatives",
                   (unsigned long long)c->forces, (unsigned long long)(c->jvps + c->diagonals));
    add_report_row(out, "iterations", "%llu linear (%llu solves), %llu Newton",
                   (unsigned long long)c->solve_iterations, (unsigned long long)c->solves,
                   (unsigned long long)c->method.newton);
    if (c->clamped_setups)
        add_report_row(out, "clamped", "%llu indefinite matrices made definite",
                       (unsigned long long)c->clamped_setups);
    if (c->contact_tests)
        add_report_row(out, "contacts", "%llu in %llu tests, %llu steps cut",
                       (unsigned long long)c->projected_particles,
                       (unsigned long long)c->contact_tests,
                       (unsigned long long)c->subdivided_steps);
    if (c->strain_limit_moves)
        add_report_row(out, "strain limit", "%llu springs shortened",
                       (unsigned long long)c->strain_limit_moves);
}

/* The error of the end as it was measured. Local errors, added up, are no measure of it:
 * contact enlarges and damping shrinks them, by factors of 0.04 to 2000 on random scenes. */
void cs_report_print_error(const struct cs_job *job, uint32_t frame, double sum,
                           struct cs_text *out) {
    const double size = cs_run_calls(&job->session.run)->length_scale;
    if (job->measured_error > 0 && frame == job->session.run.frame)
        cs_text_add(out, "about %.2g m, %.2g %% of the size (distance to a run of finer steps)",
                    job->measured_error, 100 * job->measured_error / size);
    else if (sum > 0)
        cs_text_add(
            out,
            "not known: local errors add up to %.2g m, %.2g %% of the size, which motion "
            "enlarges and damping shrinks (--error measures it)",
            sum, 100 * sum / size);
    else
        cs_text_add(out, "not known: no local errors are estimated (--error measures it)");
}

static void add_error(const struct cs_job *job, struct cs_text *out) {
    struct cs_text line = {0};
    const struct cs_run *run = &job->session.run;
    cs_report_print_error(job, run->frame, run->counts.method.local_error, &line);
    cs_print_hanging("error", cs_text_get(&line), VALUE_COLUMN, out);
    cs_text_finish(&line);
}

/* Energies, strain and memory at the end. */
static void add_measures(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    const struct cs_energy energy = cs_diagnostics_energy(run->system, run->t, run->x, run->v);
    add_report_row(out, "energy", "%.6g J kinetic, %.6g J elastic, %.6g J gravity",
                   energy.kinetic, energy.elastic, energy.gravity);
    if (energy.other != 0)
        add_report_row(out, "other energy", "%.6g J", energy.other);
    add_report_row(out, "largest strain", "%.4g %%",
                   100 * cs_diagnostics_strain(run->system, run->x));
    if (run->system->scene->colliders.n)
        add_report_row(out, "largest depth", "%.3g m in a collider after a frame",
                       job->monitor.cloth[CS_CLOTH_DEPTH].value);
    if (cs_system_untangles(run->system))
        add_report_row(out, "untangle", "gave %.6g J to %u particles",
                       run->energy_input.given[CS_SOURCE_UNTANGLE],
                       job->session.initial_penetration.n);
    add_report_row(out, "memory", "%zu bytes in arrays, %.1f per particle", cs_run_bytes(run),
                   (double)cs_run_bytes(run) / run->system->view.n);
    add_report_row(out, "wall time", "%.3g s, %.3g s of it in the integrator",
                   job->wall_seconds, run->advance_seconds);
}

/* cpu: NAN where it is not measured. */
static void add_stage(const struct cs_job *job, const char *name, double wall, double cpu,
                      struct cs_text *out) {
    const uint32_t frames = job->session.run.frame;
    cs_text_add(out, "  %-*s%10.4f%14.4f", STAGE_COLUMN - 2, name, wall,
                1e3 * wall / (frames ? frames : 1));
    if (isnan(cpu))
        cs_text_add(out, "\n");
    else
        cs_text_add(out, "%15.4f\n", cpu);
}

/* Peak of the resident set in bytes, libraries included; 0 if unknown. ru_maxrss is in KiB. */
static size_t peak_memory(void) {
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) ? 0 : 1024 * (size_t)usage.ru_maxrss;
}

/* s, a method's own part, linear systems included: all but the other stages of a step. The
 * column "Integracija" of the cloth thesis, table 6.1. */
static double integration(double all, const double stages[CS_STAGES]) {
    for (int s = 0; s < CS_STAGES; s++)
        all -= s == CS_STAGE_SETUP || s == CS_STAGE_SOLVE ? 0 : stages[s];
    return all;
}

/* Times of the stages in total and per frame; stages of the model are a part of "simulate", and
 * setup and solve a part of "integration". */
static void add_stages(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    cs_text_add(out, "%-*s%10s%14s%15s\n", STAGE_COLUMN, "stage", "total [s]", "frame [ms]",
                "processor [s]");
    add_stage(job, "simulate", run->advance_seconds, run->advance_cpu, out);
    add_stage(job, "integration", integration(run->advance_seconds, run->stage_seconds),
              integration(run->advance_cpu, run->stage_cpu), out);
    for (uint32_t s = 0; s < CS_STAGES; s++)
        add_stage(job, cs_stage_names[s], run->stage_seconds[s], run->stage_cpu[s], out);
    add_stage(job, "draw", job->picture.seconds, (double)NAN, out);
    add_stage(job, "encode", job->encode_seconds, (double)NAN, out);
    add_stage(job, "waiting for pictures", job->wait_seconds, (double)NAN, out);
    add_report_row(out, "peak memory", "%.1f MiB of the whole process",
                   (double)peak_memory() / (1 << 20));
}

/* A triangle that outgrew its contact samples, and the key that gives it more: cloth that is
 * held off stretches further, by a tenth in a trial. */
static void add_gap(const struct cs_energy_monitor *monitor, struct cs_text *out) {
    struct cs_text line = {0};
    if (!(monitor->gap_depth > 0))
        return;
    cs_text_add(&line,
                "a triangle came %.3g m into colliders[%u] between contact samples: edges were "
                "%.3g times as long as at the start, expected contact.sample_stretch %.2g",
                monitor->gap_depth, monitor->gap_collider, monitor->gap_stretch,
                1.1 * monitor->gap_stretch);
    cs_print_hanging("note", cs_text_get(&line), VALUE_COLUMN, out);
    cs_text_finish(&line);
}

/* Where the outputs are. */
static void add_files(const struct cs_job *job, struct cs_text *out) {
    const struct cs_job_settings *settings = job->settings;
    if (job->n_drawn)
        add_report_row(out, "pictures", "%u in %s", job->n_drawn, settings->folder);
    if (settings->export.formats)
        add_report_row(out, "exports", "%u samples in %s", job->export.n_samples,
                       settings->folder);
    if (settings->states)
        add_report_row(out, "states", "%u in %s", job->session.run.frame + 1, settings->states);
}

static void add_rows(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    add_report_row(out, "scene", "%s", job->session.scene->path);
    cs_print_hanging("method", cs_text_get(&job->method), VALUE_COLUMN, out);
    struct cs_text choice = {0};
    cs_session_print_choice(&job->session, &choice);
    if (choice.length)
        cs_print_hanging("", cs_text_get(&choice), VALUE_COLUMN, out);
    cs_text_finish(&choice);
    add_frames(job, out);
    add_watch(job, out);
    add_crossings(job, out);
    add_contact(job, out);
    add_counts(job, out);
    add_error(job, out);
    add_measures(job, out);
    if (job->settings->session.run.timed) {
        add_report_row(out, "threads", "%u", cs_pool_threads());
        add_stages(job, out);
    }
    for (uint32_t i = 0; i < run->n_notes; i++)
        cs_print_hanging("note", run->notes[i], VALUE_COLUMN, out);
    add_gap(&job->monitor, out);
    add_files(job, out);
    add_report_row(out, "state hash", "%s", job->hash);
}

enum cs_status cs_report_print(const struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    const bool taken = settings->hash || cs_print_is_stdout(settings->json) ||
                       cs_print_is_stdout(settings->monitor_file) ||
                       cs_print_is_stdout(settings->ledger) || settings->trace.is_requested;
    struct cs_text table = {0};
    if (settings->quiet)
        return CS_OK;
    add_rows(job, &table);
    return cs_print_out(taken ? stderr : stdout, &table, error);
}
