/* Prints run.json: everything needed to repeat a run and to verify its result. */
#include "base/file.h"
#include "base/json_writer.h"
#include "base/pool.h"
#include "cli/line/print.h"
#include "cli/run/job_state.h"
#include "session/provenance_write.h"
#include "session/scene_view.h"
#include "session/session.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

enum { SCHEMA_VERSION = 2 };

static void add_versions(const struct cs_job *job, struct cs_text *out) {
    cs_json_write(out, "  'versions': {'clothsim': %s, 'cjson': %s", CS_VERSION,
                  cJSON_Version());
    if (job->settings->session.render)
        cs_json_write(out, ", 'libpng': %s", cs_png_version());
    cs_json_write(out, "},\n  'renderer': %s,\n  'threads': %u,\n",
                  job->renderer.length ? cs_text_get(&job->renderer) : NULL, cs_pool_threads());
}

static void add_outcome(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    struct cs_text sentence = {0};
    if (job->failure)
        cs_text_add(&sentence, *job->cause.text ? "%s; %s" : "%s", job->failure,
                    job->cause.text);
    else
        cs_report_print_outcome(job, &sentence);
    cs_json_write(out, "  'outcome': %s,\n  'outcome_detail': %s",
                  job->failure ? "failed" : cs_outcome_text(run->outcome),
                  cs_text_get(&sentence));
    cs_text_finish(&sentence);
    /* only a blow-up has a particle to name and a bound that it crossed */
    if (cs_outcome_is_blow_up(run->outcome))
        cs_json_write(out,
                      ",\n  'blow_up': {'time': %g, 'particle': %u, 'kinetic_energy': %g, "
                      "'bound': %g}",
                      run->blow_up.time, run->blow_up.particle, run->blow_up.energy,
                      run->blow_up.bound);
    if (*job->cause.text)
        cs_json_write(out, ",\n  'singular_force': {'time': %g, 'particle': %u}",
                      job->cause.time, job->cause.particle);
    cs_json_write(out, ",\n  'verdict': %s",
                  cs_stability_word(cs_stability_at_end(job->failure ? CS_FAILED : run->outcome,
                                                        job->monitor.worst_verdict)));
    sentence = (struct cs_text){0};
    cs_energy_monitor_print_beyond(&job->monitor, &sentence);
    if (sentence.length)
        cs_json_write(out, ",\n  'beyond_cloth': %s", cs_text_get(&sentence));
    cs_text_finish(&sentence);
    if (job->monitor.first.verdict != CS_STABILITY_BOUNDED)
        cs_json_write(
            out, ",\n  'unstable_from': {'time': %g, 'particle': %u, 'particles': %u}",
            job->monitor.first.t, job->monitor.first.particle, job->monitor.first.particles);
    cs_json_write(out, ",\n  'frames_asked': %u,\n  'frames_done': %u,\n  'time': %g,\n",
                  job->frames, run->frame, run->t);
}

static void add_error(const struct cs_job *job, struct cs_text *out) {
    const double sum = job->session.run.counts.method.local_error;
    cs_json_write(out, "  'error': {'size': %g, 'local': %g",
                  cs_run_calls(&job->session.run)->length_scale, sum > 0 ? sum : (double)NAN);
    if (job->measured_error > 0)
        cs_json_write(out, ", 'measured': %g", job->measured_error);
    cs_text_add(out, "},\n");
}

static void add_counts(const struct cs_counts *c, struct cs_text *out) {
    /* scripts read these names: they are part of the schema version */
    const struct {
        const char *name;
        uint64_t value;
    } rows[] = {
        {"steps", c->steps},
        {"rejected", c->method.rejected},
        {"forces", c->forces},
        {"energies", c->energies},
        {"jvps", c->jvps},
        {"diagonals", c->diagonals},
        {"newton", c->method.newton},
        {"sweeps", c->method.sweeps},
        {"setups", c->method.setups},
        {"solve_setups", c->solve_setups},
        {"solves", c->solves},
        {"solve_iterations", c->solve_iterations},
        {"clamped", c->clamped_setups},
        {"contacts", c->projected_particles},
        {"contact_tests", c->contact_tests},
        {"contact_subdivided_steps", c->subdivided_steps},
        {"limit_moves", c->strain_limit_moves},
        {"normals", c->normals},
    };
    cs_json_write(out, "  'counts': {");
    for (uint32_t i = 0; i < sizeof rows / sizeof *rows; i++)
        cs_json_write(out, ", %s: %llu", rows[i].name, (unsigned long long)rows[i].value);
    cs_text_add(out, "},\n");
}

/* Only where they were counted. */
static void add_crossings(const struct cs_job *job, struct cs_text *out) {
    const struct cs_crossing_stats *stats = &job->crossings;
    if (!stats->is_counted)
        return;
    cs_json_write(out, "  'crossings': {'start': %llu, 'most': %llu, 'end': %llu",
                  (unsigned long long)stats->start_count, (unsigned long long)stats->max_count,
                  (unsigned long long)stats->last_count);
    if (stats->max_count) {
        const uint32_t *ends = cs_crossing_stats_edge(stats, &job->session.system);
        cs_json_write(out, ", 'most_at': %g, 'first': {'time': %g, 'edge': [%u, %u]}",
                      stats->max_time, stats->first_time, ends[0], ends[1]);
    }
    cs_text_add(out, "},\n");
}

/* Only with contact by force. */
static void add_contact(const struct cs_system *system, struct cs_text *out) {
    struct cs_contact_capacity capacity;
    const uint32_t n_bodies = system->scene->bodies.n;
    if (!cs_contact_capacity_find(system, &capacity))
        return;
    cs_json_write(out, "  'contact': {'body': %u", capacity.a);
    cs_json_write(out, capacity.b < n_bodies ? ", 'other_body': %u" : ", 'collider': %u",
                  capacity.b < n_bodies ? capacity.b : capacity.b - n_bodies);
    cs_json_write(out, ", 'range': %g, 'stiffness': %g", capacity.range, capacity.k);
    cs_json_write(out, ", 'holds': %g, 'comes': %g, 'stiffness_needed': %g},\n", capacity.holds,
                  capacity.comes, capacity.k_needed);
}

static void add_measures(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    const struct cs_energy energy = cs_diagnostics_energy(run->system, run->t, run->x, run->v);
    cs_json_write(out, "  'energy': {'kinetic': %g, 'elastic': %g, 'gravity': %g",
                  energy.kinetic, energy.elastic, energy.gravity);
    if (energy.other != 0)
        cs_json_write(out, ", 'other': %g", energy.other);
    cs_json_write(out, "},\n  'largest_strain': %g,\n",
                  cs_diagnostics_strain(run->system, run->x));
    if (cs_system_untangles(run->system))
        cs_json_write(out, "  'untangle': %g,\n", run->energy_input.given[CS_SOURCE_UNTANGLE]);
    if (run->strain_limit.missed > 0)
        cs_json_write(out, "  'strain_limit_missed': %g,\n", run->strain_limit.missed);
    cs_json_write(out, "  'largest_depth': %g,\n", job->monitor.cloth[CS_CLOTH_DEPTH].value);
    cs_json_write(out, "  'memory': {'bytes': %zu, 'method': %zu, 'a_particle': %g},\n",
                  cs_run_bytes(run), run->method_bytes,
                  (double)cs_run_bytes(run) / run->system->view.n);
    cs_json_write(out, "  'notes': [");
    for (uint32_t i = 0; i < run->n_notes; i++)
        cs_json_write(out, ", %s", run->notes[i]);
    cs_text_add(out, "],\n");
}

/* The only values that differ between runs of the same scene. */
static void add_seconds(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    cs_json_write(out, "  'seconds': {'wall': %g, 'method': %g", job->wall_seconds,
                  run->advance_seconds);
    for (uint32_t s = 0; job->settings->session.run.timed && s < CS_STAGES; s++)
        cs_json_write(out, ", %s: %g", cs_stage_names[s], run->stage_seconds[s]);
    if (job->settings->session.run.timed && job->settings->session.render)
        cs_json_write(out, ", 'draw': %g, 'encode': %g, 'wait': %g", job->picture.seconds,
                      job->encode_seconds, job->wait_seconds);
    cs_text_add(out, "},\n");
}

/* All of it up to the rows of frames. */
static void print_report(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    cs_json_write(out, "{\n  'schema': %u,\n", SCHEMA_VERSION);
    add_versions(job, out);
    cs_provenance_out_add_restarts(cs_job_restarts(job), out);
    cs_text_add(out, "%s", cs_text_get(&job->provenance));
    cs_json_write(out, ",\n  'particles': %u,\n  'springs': %u,\n", run->system->view.n,
                  run->system->plan.n_springs);
    add_outcome(job, out);
    add_error(job, out);
    add_counts(&run->counts, out);
    add_crossings(job, out);
    add_contact(run->system, out);
    add_measures(job, out);
    cs_json_write(out, "  'state_hash': %s,\n", job->hash);
    add_seconds(job, out);
    cs_text_add(out, "  \"scene\": %s,\n", cs_text_get(&job->scene));
    cs_json_write(out, "  'frames': [\n");
}

/* The rows of frames stand between the report and the end of its list. */
static enum cs_status write_parts(const struct cs_job *job, const struct cs_text *report,
                                  FILE *file, struct cs_error *error) {
    static const char between[] = ",\n";
    const uint64_t length = job->frame_log.length;
    fwrite(report->bytes, 1, report->length, file);
    if (length && cs_row_log_copy(&job->frame_log, length - strlen(between), file, error))
        return error->status;
    fputs(length ? "\n  ]\n}\n" : "  ]\n}\n", file);
    return CS_OK;
}

static enum cs_status write_file(const struct cs_job *job, const struct cs_text *report,
                                 const char *path, struct cs_error *error) {
    struct cs_file_out out = {0};
    if (!cs_print_is_stdout(path))
        cs_file_sweep(path, NULL);
    if (cs_print_is_stdout(path)) {
        if (!write_parts(job, report, stdout, error) && (fflush(stdout) || ferror(stdout)))
            cs_fail(error, CS_ERR_FILE, "cannot write to standard output");
    } else if (!cs_file_create(&out, path, error)) {
        if (write_parts(job, report, out.file, error))
            cs_file_abandon(&out);
        else
            cs_file_finish(&out, error);
    }
    return error->status;
}

enum cs_status cs_report_write_json(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    struct cs_text report = {0}, path = {0};
    if (!cs_job_wants_json(settings))
        return CS_OK;
    print_report(job, &report);
    cs_text_add(&path, "%s/run.json", settings->folder);
    if (report.failed || path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the report");
    if (!error->status && settings->session.render)
        write_file(job, &report, cs_text_get(&path), error);
    if (!error->status && settings->json)
        write_file(job, &report, settings->json, error);
    cs_text_finish(&report);
    cs_text_finish(&path);
    if (!error->status)
        cs_run_json_close(job, error);
    return error->status;
}

enum cs_status cs_run_json_close(struct cs_job *job, struct cs_error *error) {
    if (cs_job_makes_checkpoints(job->settings))
        return cs_row_log_finish(&job->frame_log, error);
    return cs_row_log_remove(&job->frame_log, error);
}

/* Opens the rows: beside the pictures or checkpoints, or without a name. */
static enum cs_status begin_json(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_settings *settings = job->settings;
    struct cs_text path = {0};
    if (!cs_job_wants_json(settings))
        return CS_OK;
    cs_text_add(&path, "%s/run.frames", settings->folder);
    if (path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a path");
    else if (settings->resume)
        cs_row_log_resume(&job->frame_log, cs_text_get(&path), error);
    else
        cs_row_log_create(&job->frame_log, settings->folder ? cs_text_get(&path) : NULL, error);
    cs_text_finish(&path);
    return error->status;
}

/* The row of a frame, after its picture was begun. */
static enum cs_status frame(struct cs_job *job, struct cs_error *error) {
    const struct cs_job_picture *picture = &job->has_begun;
    const uint32_t number = job->session.run.frame;
    const bool drawn = picture->image && picture->frame == number;
    struct cs_text row = {0};
    if (!cs_job_wants_json(job->settings))
        return CS_OK;
    cs_json_write(&row, "    {'number': %u, 'hash': %s, 'drawn': %d", number, job->hash, drawn);
    if (drawn)
        cs_json_write(&row, ", 'picture': %u", picture->number);
    if (job->crossings.is_counted)
        cs_json_write(&row, ", 'crossings': %llu",
                      (unsigned long long)job->crossings.last_count);
    if (drawn && cs_picture_is_coloured(job->session.scene))
        cs_json_write(&row, ", 'range': [%g, %g]", picture->range[0], picture->range[1]);
    cs_text_add(&row, "},\n");
    return cs_row_log_add(&job->frame_log, &row, error);
}

static enum cs_status settle(struct cs_job *job, struct cs_error *error) {
    return cs_job_makes_checkpoints(job->settings) ? cs_row_log_sync(&job->frame_log, error)
                                                   : CS_OK;
}

static void record_rows(struct cs_job *job, struct cs_serialiser *serialiser) {
    cs_row_log_record(&job->frame_log, serialiser);
}

const struct cs_run_output cs_run_output_json = {.option = "--json",
                                                 .path = offsetof(struct cs_job_settings, json),
                                                 .at = {[CS_RUN_BEGIN] = begin_json,
                                                        [CS_RUN_START] = frame,
                                                        [CS_RUN_FRAME] = frame,
                                                        [CS_RUN_SETTLE] = settle},
                                                 .record = record_rows};
