/* Prints run.json: everything needed to repeat a run and to verify its result. */
#include "base/ieee_check.h"
#include "base/json_writer.h"
#include "base/pool.h"
#include "cli/run/job_state.h"
#include "study/contact_capacity.h"
#include "study/provenance_write.h"

#include <cjson/cJSON.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

enum { SCHEMA_VERSION = 2 };

static void add_versions(const struct cs_job *job, struct cs_text *out) {
    cs_json_write(out, "  'versions': {'clothsim': %s, 'cjson': %s", CS_VERSION,
                  cJSON_Version());
    if (job->settings->session.render)
        cs_json_write(out, ", 'libpng': %s", png_get_libpng_ver(NULL));
    cs_json_write(out, "},\n  'renderer': %s,\n  'threads': %u,\n",
                  job->renderer.length ? cs_text_get(&job->renderer) : NULL, cs_pool_threads());
}

/* Present only if the hashes are not comparable with those of other builds. */
static void add_arithmetic(struct cs_text *out) {
    const char *fault = cs_ieee_check();
    if (fault)
        cs_json_write(out, "  'arithmetic': %s,\n", fault);
}

static void add_outcome(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    struct cs_text sentence = {0};
    if (job->failure)
        cs_text_add(&sentence, "%s", job->failure);
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
    const enum cs_stability_verdict seen = job->monitor.worst_verdict;
    const enum cs_stability_verdict verdict =
        cs_stability_at_end(job->failure ? CS_FAILED : run->outcome, seen);
    cs_json_write(out, ",\n  'verdict': %s",
                  job->monitor.in_doubt && verdict == seen &&
                          !cs_outcome_is_blow_up(run->outcome)
                      ? "in doubt"
                      : cs_stability_word(verdict));
    if (job->monitor.first.verdict != CS_STABILITY_BOUNDED)
        cs_json_write(
            out, ",\n  'unstable_from': {'time': %g, 'particle': %u, 'particles': %u}",
            job->monitor.first.t, job->monitor.first.particle, job->monitor.first.particles);
    cs_json_write(out, ",\n  'frames_asked': %u,\n  'frames_done': %u,\n  'time': %g,\n",
                  job->frames, run->frame, run->t);
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
        const uint32_t *ends =
            job->session.system.surfaces->edges + 2 * (size_t)stats->first.edge;
        cs_json_write(out, ", 'most_at': %g, 'first': {'time': %g, 'edge': [%u, %u]}",
                      stats->max_time, stats->first_time, ends[0], ends[1]);
    }
    cs_text_add(out, "},\n");
}

/* Only with contact by force. */
static void add_contact(const struct cs_system *system, struct cs_text *out) {
    struct cs_contact_capacity at;
    const uint32_t n_bodies = system->scene->bodies.n;
    if (!cs_contact_capacity_find(system, &at))
        return;
    cs_json_write(out, "  'contact': {'body': %u", at.a);
    cs_json_write(out, at.b < n_bodies ? ", 'other_body': %u" : ", 'collider': %u",
                  at.b < n_bodies ? at.b : at.b - n_bodies);
    cs_json_write(out, ", 'range': %g, 'stiffness': %g", at.range, at.k);
    cs_json_write(out, ", 'holds': %g, 'comes': %g, 'stiffness_needed': %g},\n", at.holds,
                  at.comes, at.k_needed);
}

static void add_measures(const struct cs_run *run, struct cs_text *out) {
    const struct cs_energy energy = cs_diagnostics_energy(run->system, run->t, run->x, run->v);
    cs_json_write(out, "  'energy': {'kinetic': %g, 'elastic': %g, 'gravity': %g",
                  energy.kinetic, energy.elastic, energy.gravity);
    if (energy.other != 0)
        cs_json_write(out, ", 'other': %g", energy.other);
    cs_json_write(out, "},\n  'largest_strain': %g,\n",
                  cs_diagnostics_strain(run->system, run->x));
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

static void add_frames(const struct cs_job *job, struct cs_text *out) {
    const bool coloured = cs_picture_is_coloured(&job->session.scene);
    cs_json_write(out, "  'frames': [");
    for (uint32_t i = 0; i < cs_job_rows(job); i++) {
        const struct cs_job_frame *frame = job->frame_log.frames + i;
        const uint32_t number = job->frames ? i + 1 : 0;
        cs_json_write(out, ",\n    {'number': %u, 'hash': %s, 'drawn': %d", number, frame->hash,
                      frame->drawn);
        if (frame->drawn)
            cs_json_write(out, ", 'picture': %u", number / job->settings->frame_interval);
        if (job->crossings.is_counted)
            cs_json_write(out, ", 'crossings': %llu", (unsigned long long)frame->crossings);
        if (coloured && frame->drawn)
            cs_json_write(out, ", 'range': [%g, %g]", frame->range[0], frame->range[1]);
        cs_text_add(out, "}");
    }
    cs_text_add(out, "\n  ]\n");
}

void cs_report_print_json(const struct cs_job *job, struct cs_text *out) {
    const struct cs_run *run = &job->session.run;
    cs_json_write(out, "{\n  'schema': %u,\n", SCHEMA_VERSION);
    add_versions(job, out);
    add_arithmetic(out);
    cs_provenance_out_add_restarts(cs_job_restarts(job), out);
    cs_text_add(out, "%s", cs_text_get(&job->provenance));
    cs_json_write(out, ",\n  'particles': %u,\n  'springs': %u,\n", run->system->view.n,
                  run->system->springs.n);
    add_outcome(job, out);
    add_counts(&run->counts, out);
    add_crossings(job, out);
    add_contact(run->system, out);
    add_measures(run, out);
    cs_json_write(out, "  'state_hash': %s,\n", job->hash);
    add_seconds(job, out);
    cs_text_add(out, "  \"scene\": %s,\n", cs_text_get(&job->scene));
    add_frames(job, out);
    cs_text_add(out, "}\n");
}

/* Doubles the log until it has so many frames. Returns false if out of memory. */
static bool has_room(struct cs_frame_log *kept, size_t frames) {
    if (frames <= kept->capacity)
        return true;
    void *larger =
        cs_arena_realloc(kept->frames, &kept->capacity, frames, sizeof *kept->frames);
    kept->frames = larger ? larger : kept->frames;
    return larger;
}

/* The row of a frame; its picture is noted there once it is begun. */
static enum cs_status frame(struct cs_job *job, struct cs_error *error) {
    const uint32_t n = cs_job_rows(job);
    if (!cs_job_wants_json(job->settings))
        return CS_OK;
    if (!has_room(&job->frame_log, n))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the hashes of %u frames", n);
    struct cs_job_frame *kept = job->frame_log.frames + n - 1;
    *kept = (struct cs_job_frame){.crossings = job->crossings.last_count};
    memcpy(kept->hash, job->hash, sizeof kept->hash);
    return CS_OK;
}

static void record_rows(struct cs_job *job, struct cs_serialiser *record) {
    struct cs_frame_log *kept = &job->frame_log;
    uint64_t n = cs_job_wants_json(job->settings) ? job->session.run.frame : 0;
    CS_SERIALISER(record, n);
    if (record->is_reading &&
        (record->failed || n > record->length || !has_room(kept, (size_t)n)))
        record->failed = true;
    else
        cs_serialiser_bytes(record, kept->frames, (size_t)n * sizeof *kept->frames);
}

const struct cs_run_output cs_run_output_json = {
    .option = "--json",
    .path = offsetof(struct cs_job_settings, json),
    .at = {[CS_RUN_START] = frame, [CS_RUN_FRAME] = frame},
    .record = record_rows};
