/* Checks rows of state hashes: by bits, or by stored positions and a tolerance. */
#include "golden/golden_row.h"

#include "base/file.h"
#include "session/session.h"

#include <stdio.h>
#include <string.h>

/* Splits "path=value;path=value" in place. Returns the number of overrides. */
static uint32_t split_overrides(char *text, struct cs_override *overrides) {
    uint32_t n = 0;
    char *pair;
    while (n < CS_GOLDEN_SETS_MAX && (pair = strsep(&text, ";"))) {
        char *equals = strchr(pair, '=');
        if (!equals)
            continue;
        *equals = 0;
        overrides[n++] = (struct cs_override){pair, equals + 1};
    }
    return n;
}

/* Steps to the last frame; frame by frame where states are recorded. */
static enum cs_status follow(struct cs_run *run, uint32_t frames,
                             struct cs_golden_states *record, struct cs_error *error) {
    struct cs_follow follow = {.run = run, .last = frames, .every = record ? 1 : 0};
    while (cs_follow_next(&follow, error))
        cs_golden_states_add(record, run);
    return cs_follow_check(run, "", error);
}

enum cs_status cs_golden_step(const struct cs_golden *golden, const struct cs_golden_run *run,
                              bool render, struct cs_golden_recording *recording,
                              struct cs_session *session, struct cs_error *error) {
    char scene[1280], text[CS_GOLDEN_SETS_BYTES];
    struct cs_override overrides[CS_GOLDEN_SETS_MAX];
    /* scenes are named from the folder above the golden one, which is often this one */
    const bool here = *golden->folder != '.' && !strchr(golden->folder, '/');
    snprintf(scene, sizeof scene, "%s%s%s", here ? "" : golden->folder, here ? "" : "/../",
             run->scene);
    /* a copy, which split_overrides cuts up */
    snprintf(text, sizeof text, "%s", run->overrides);
    const struct cs_session_settings settings = {
        .scene = scene,
        .overrides = overrides,
        .n_overrides = split_overrides(text, overrides),
        .integrator = strcmp(run->integrator, "-") ? run->integrator : NULL,
        .plugins = golden->plugins,
        .n_plugins = golden->n_plugins,
        .render = render,
        .threads = golden->threads,
        .run = {.stop = golden->stop},
    };
    if (cs_session_open(session, &settings, error))
        return error->status;
    struct cs_golden_states *states = recording ? &recording->states : NULL;
    if (states)
        cs_golden_states_init(states, session->plan.n, run->frames, recording->kept,
                              recording->like, error);
    if (error->status || follow(&session->run, run->frames, states, error))
        cs_session_close(session);
    return error->status;
}

/* True if the row holds for this build. A method whose bits depend on a library has one row per
 * version. */
static bool is_for_this_build(struct cs_golden_row *row, const struct cs_integrator *method) {
    if (CS_HAS(method, library) && method->library)
        snprintf(row->finding.library, sizeof row->finding.library, "%s", method->library);
    row->finding.skipped =
        strcmp(row->note, "any") != 0 && strcmp(row->note, row->finding.library) != 0;
    if (row->finding.skipped)
        cs_text_add(&row->message, "golden for %s, but this build has %s", row->note,
                    *row->finding.library ? row->finding.library : "no such library");
    return !row->finding.skipped;
}

/* Says how a state differs to the last bit. */
static void judge_bits(const struct cs_golden *golden, struct cs_golden_row *row,
                       const struct cs_run *run, bool has_states) {
    const struct cs_golden_where *where = &row->finding.where;
    const bool same = !strcmp(row->finding.found, row->hash);
    if (!same) {
        cs_text_add(&row->message, "hash %s", row->finding.found);
        if (!golden->add.scene)
            cs_text_add(&row->message, ", expected %s (%s after frame %u)", row->hash,
                        cs_outcome_text(run->outcome), run->frame);
    } else if (has_states && (where->first_hash || where->first.frame || !where->n))
        cs_text_add(&row->message, "the hash agrees, and the stored states are of another run");
    if (has_states && row->message.length && !golden->add.scene) {
        cs_text_add(&row->message, ": ");
        cs_golden_where_print(where, true, &row->message);
    }
}

/* Says where positions are beyond the tolerance of the row, or the run ends elsewhere. */
static void judge_distance(struct cs_golden_row *row, const struct cs_run *run,
                           const struct cs_golden_states *stored) {
    const struct cs_golden_where *where = &row->finding.where;
    if (run->frame != stored->n_frames)
        cs_text_add(&row->message, "%s after frame %u, expected frame %u; ",
                    cs_outcome_text(run->outcome), run->frame, stored->n_frames);
    if (where->first.frame || !where->n || row->message.length) {
        cs_text_add(&row->message, "beyond %s m: ", row->tolerance);
        cs_golden_where_print(where, false, &row->message);
    }
}

/* Writes the states of a row that has none yet, or of one that came out otherwise. */
static enum cs_status keep_states(const struct cs_golden *golden, struct cs_golden_row *row,
                                  const struct cs_golden_states *states, bool has_states,
                                  struct cs_error *error) {
    char path[1024];
    if (!golden->accept_all || (has_states && !row->message.length))
        return CS_OK;
    snprintf(path, sizeof path, "%.900s/state", golden->folder);
    if (cs_folder_create(path, error))
        return error->status;
    cs_golden_states_path(golden->folder, row->state, path);
    if (!cs_golden_states_write(states, path, error)) {
        row->finding.has_new_states = true;
        cs_text_add(&row->message, "%s%u states kept", row->message.length ? ", " : "",
                    states->n_kept);
    }
    return error->status;
}

/* Reads the stored states of a row; with accept_all damaged ones are replaced. */
static enum cs_status read_stored(const struct cs_golden *golden,
                                  const struct cs_golden_row *row,
                                  struct cs_golden_states *stored, struct cs_error *error) {
    char path[1024];
    struct cs_error own = {0};
    if (row->is_state_new || !strcmp(row->state, "-"))
        return CS_OK;
    cs_golden_states_path(golden->folder, row->state, path);
    cs_golden_states_read(stored, path, row->run.frames, &own);
    return own.status && !golden->accept_all ? cs_fail(error, own.status, "%s", own.message)
                                             : CS_OK;
}

/* Judges a run that reached its end, and keeps its states where that is asked. */
static enum cs_status judge(const struct cs_golden *golden, struct cs_golden_row *row,
                            const struct cs_run *run,
                            const struct cs_golden_recording *recording,
                            struct cs_error *error) {
    const bool has_states = recording && recording->like;
    if (has_states)
        row->finding.where = cs_golden_states_compare(&recording->states, recording->like,
                                                      cs_golden_tolerance(row));
    if (has_states && cs_golden_tolerance(row) > 0)
        judge_distance(row, run, recording->like);
    else
        judge_bits(golden, row, run, has_states);
    return recording ? keep_states(golden, row, &recording->states, has_states, error) : CS_OK;
}

/* Runs a row and judges it. recording: NULL, if the row has no states and gets none. */
static enum cs_status check_run(struct cs_golden *golden, struct cs_golden_row *row,
                                struct cs_golden_recording *recording, struct cs_error *error) {
    struct cs_session session;
    struct cs_error failed = {0};
    if (cs_golden_step(golden, &row->run, false, recording, &session, &failed)) {
        /* only a build without a library may lack an integrator, and only where the row names
         * the library */
        row->finding.skipped = failed.status == CS_ERR_USAGE && strcmp(row->note, "any") != 0;
        if (!row->finding.skipped)
            return cs_fail(error, failed.status, "%s", failed.message);
        cs_text_add(&row->message, "this build is without %s", row->note);
        return CS_OK;
    }
    cs_run_hash(&session.run, row->finding.found);
    if (cs_golden_tolerance(row) > 0 || is_for_this_build(row, session.method.integrator))
        judge(golden, row, &session.run, recording, error);
    cs_session_close(&session);
    return error->status;
}

enum cs_status cs_golden_check_state(struct cs_golden *golden, struct cs_golden_row *row,
                                     struct cs_error *error) {
    struct cs_golden_states stored = {0};
    struct cs_golden_recording recording = {.kept = golden->states};
    if (read_stored(golden, row, &stored, error))
        return error->status;
    if (stored.hashes)
        recording.like = &stored;
    else if (!recording.kept)
        recording.kept = CS_GOLDEN_STATES;
    check_run(golden, row, strcmp(row->state, "-") ? &recording : NULL, error);
    cs_golden_states_finish(&recording.states);
    cs_golden_states_finish(&stored);
    return error->status;
}
