/* run_record.c - writes or reads a run between two frames.
 *
 * One function serves both directions: the serialiser copies out or in. Order of a record:
 * system, counts, history of the method. On reading, the method is restarted on the restored
 * system first, and then loads its history. Counts are restored last, because these calls
 * count too. */
#include "sim/run_state.h"

#include "model/contact/bristle_law.h"
#include "model/event/event_state.h"
#include "model/system/seams.h"
#include "sim/run_host.h"

#include <string.h>

bool cs_run_method_has_history(const struct cs_integrator *integrator) {
    // a module that was built before the calls were there has a shorter struct
    return CS_HAS(integrator, load) && integrator->save && integrator->load;
}

/* The calls of struct cs_archive for a method; ctx is the serialiser. */
static void record_reals(void *ctx, double *values, size_t n) {
    cs_serialiser_bytes(ctx, values, n * sizeof *values);
}

static void record_wholes(void *ctx, uint64_t *values, size_t n) {
    cs_serialiser_bytes(ctx, values, n * sizeof *values);
}

/* The archive that a method's save or load gets. */
static struct cs_archive archive_of(struct cs_serialiser *serialiser) {
    return (struct cs_archive){.size = sizeof(struct cs_archive),
                               .ctx = serialiser,
                               .reals = record_reals,
                               .integers = record_wholes};
}

/* Everything that the model has changed since the run began: state, time, blow-up bound,
 * events, contact, anchors of friction, broken stitches. */
static void record_system(struct cs_run *run, struct cs_serialiser *serialiser) {
    struct cs_run_host *host = run->host;
    struct cs_system *system = run->system;
    cs_serialiser_bytes(serialiser, run->x, 6 * (size_t)system->view.n * sizeof *run->x);
    CS_SERIALISER(serialiser, run->t);
    CS_SERIALISER(serialiser, run->frame);
    CS_SERIALISER(serialiser, host->blow_up);
    CS_SERIALISER(serialiser, run->energy_input);
    cs_events_serialise(system, serialiser);
    if (system->plan.rows[CS_FEATURE_CONTACT].built)
        cs_contact_projection_serialise(&host->contact, serialiser);
    if (system->friction_anchors)
        cs_serialiser_bytes(serialiser, system->friction_anchors->values,
                            system->friction_anchors->n_values * sizeof(double));
    if (system->seams) {
        cs_serialiser_bytes(serialiser, system->seams->broken,
                            system->seams->n * sizeof *system->seams->broken);
        CS_SERIALISER(serialiser, system->seams->n_broken);
    }
}

/* Counts and remarks, which only reports show. A damaged number of remarks fails the record. */
static void record_counts(struct cs_run *run, struct cs_serialiser *serialiser) {
    CS_SERIALISER(serialiser, run->counts);
    CS_SERIALISER(serialiser, run->notes);
    CS_SERIALISER(serialiser, run->n_notes);
    if (run->n_notes > CS_NOTES_MAX)
        serialiser->failed = true;
}

/* Restarts a method that cannot save its history, and remarks it. */
static enum cs_status restart_silent(struct cs_run *run, struct cs_error *error) {
    cs_run_note(run, "the method restarts at each checkpoint");
    return cs_run_restart(run, run->t, error);
}

enum cs_status cs_run_save(struct cs_run *run, struct cs_serialiser *serialiser,
                           struct cs_error *error) {
    const struct cs_archive archive = archive_of(serialiser);
    const bool remembers = cs_run_method_has_history(run->integrator);
    record_system(run, serialiser);
    record_counts(run, serialiser);
    if (remembers && cs_run_archive(run, run->integrator->save, &archive, error))
        return error->status;
    if (serialiser->failed)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a checkpoint");
    return remembers ? CS_OK : restart_silent(run, error);
}

enum cs_status cs_run_load(struct cs_run *run, struct cs_serialiser *serialiser,
                           struct cs_error *error) {
    const struct cs_archive archive = archive_of(serialiser);
    const bool remembers = cs_run_method_has_history(run->integrator);
    struct cs_run counted = {0};
    CS_ASSERT(run->frame == 0 && serialiser->is_reading);
    record_system(run, serialiser);
    record_counts(&counted, serialiser);
    if (serialiser->failed)
        return cs_fail(error, CS_ERR_FILE, "it is too short");
    if (remembers && (cs_run_restart(run, run->t, error) ||
                      cs_run_archive(run, run->integrator->load, &archive, error)))
        return error->status;
    if (serialiser->failed)
        return cs_fail(error, CS_ERR_FILE, "it is too short for the method");
    run->counts = counted.counts;
    memcpy(run->notes, counted.notes, sizeof run->notes);
    run->n_notes = counted.n_notes;
    if (remembers)
        return CS_OK;
    // a method that does not save its own counts from 0 again
    run->host->stats_before = run->counts.method;
    return restart_silent(run, error);
}
