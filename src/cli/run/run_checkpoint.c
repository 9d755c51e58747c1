/* Writes checkpoints of a run, and resumes from one. */
#include "cli/run/run_checkpoint.h"

#include "base/clock.h"

#include <stdio.h>
#include <string.h>

enum { MOST_FRAMES = 10000000, FACTS = 7 };
#define MOST_SECONDS 1e9

/* numbers are stored as this machine has them */
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
#define BYTE_ORDER_NAME "big-endian"
#else
#define BYTE_ORDER_NAME "little-endian"
#endif

enum cs_status cs_checkpointer_read_interval(const char *value,
                                             struct cs_checkpoint_interval *interval,
                                             struct cs_error *error) {
    const size_t length = strlen(value);
    const bool seconds = length > 1 && value[length - 1] == 's';
    char number[32];
    double found;
    snprintf(number, sizeof number, "%.*s", (int)(length - seconds), value);
    *interval = (struct cs_checkpoint_interval){0};
    if (length < sizeof number && cs_parse_real(number, &found) && found > 0 &&
        (seconds ? found <= MOST_SECONDS
                 : found <= MOST_FRAMES && found == (double)(uint32_t)found)) {
        interval->seconds = seconds ? found : 0;
        interval->frames = seconds ? 0 : (uint32_t)found;
        return CS_OK;
    }
    return cs_fail(error, CS_ERR_USAGE,
                   "--checkpoint: found \"%.60s\", expected a number of frames, or of seconds "
                   "as in 30s",
                   value);
}

/* Hash of the method's module file. */
static enum cs_status hash_module(struct cs_checkpointer *checkpointer,
                                  struct cs_error *error) {
    const struct cs_registry_entry *found;
    struct cs_session *session = checkpointer->session;
    return cs_registry_find(&session->registry, session->method.integrator->name, &found, error)
               ? error->status
               : cs_hash_file(found->file, NULL, checkpointer->module, error);
}

/* Facts that must agree before a run resumes, each with its name for the message. */
static void list_facts(const struct cs_checkpointer *checkpointer,
                       struct cs_checkpoint_key keys[FACTS]) {
    const struct cs_checkpoint_key list[FACTS] = {
        {"version of clothsim", CS_VERSION},
        {"kind of machine", BYTE_ORDER_NAME},
        {"scene", checkpointer->source.scene},
        {"scene by its files", checkpointer->source.hash},
        {"method", checkpointer->source.method},
        {"build of the method's module", checkpointer->module},
        {"set of outputs", checkpointer->source.output_settings},
    };
    memcpy(keys, list, sizeof list);
}

enum cs_status cs_checkpointer_check_interval(const struct cs_session *session,
                                              const struct cs_checkpoint_interval *interval,
                                              struct cs_error *error) {
    const struct cs_integrator *integrator = session->method.integrator;
    if (interval->seconds > 0 && !cs_run_method_has_history(integrator))
        return cs_fail(
            error, CS_ERR_USAGE,
            "--checkpoint: integrator \"%s\" restarts at each checkpoint, so the result would "
            "depend on the speed of the machine; give a number of frames",
            integrator->name);
    return CS_OK;
}

enum cs_status cs_checkpointer_begin(struct cs_checkpointer *checkpointer,
                                     struct cs_session *session,
                                     const struct cs_checkpoint_source *of, const char *folder,
                                     const struct cs_checkpoint_interval *interval,
                                     struct cs_error *error) {
    *checkpointer = (struct cs_checkpointer){
        .session = session, .source = *of, .interval = *interval, .last_time = cs_clock_wall()};
    if (snprintf(checkpointer->path, sizeof checkpointer->path, "%s/run.checkpoint", folder) >=
        (int)sizeof checkpointer->path)
        return cs_fail(error, CS_ERR_FILE,
                       "cannot use the folder \"%.60s...\": the path is too long", folder);
    return hash_module(checkpointer, error);
}

/* The interval is a part of the record: a resumed run keeps it. */
static void record_pace(struct cs_checkpointer *checkpointer) {
    CS_SERIALISER(&checkpointer->serialiser, checkpointer->interval.frames);
    CS_SERIALISER(&checkpointer->serialiser, checkpointer->interval.seconds);
}

/* Reads in the order of cs_checkpointer_capture: interval, the caller's state, the run. A
 * record with bytes left over, or too few, is refused. */
enum cs_status cs_checkpointer_load(struct cs_checkpointer *checkpointer, uint32_t frames,
                                    struct cs_error *error) {
    struct cs_checkpoint_key keys[FACTS];
    struct cs_error said = {0};
    struct cs_serialiser *serialiser = &checkpointer->serialiser;
    struct cs_run *run = &checkpointer->session->run;
    list_facts(checkpointer, keys);
    if (cs_checkpoint_read(checkpointer->path, keys, FACTS, serialiser, error))
        return error->status;
    record_pace(checkpointer);
    checkpointer->source.serialise(checkpointer->source.ctx, serialiser);
    if (cs_run_load(run, serialiser, &said))
        return cs_fail(error, said.status, "\"%s\": %s", checkpointer->path, said.message);
    if (!cs_serialiser_is_done(serialiser))
        return cs_fail(error, CS_ERR_FILE, "\"%s\": it has the wrong size for this run",
                       checkpointer->path);
    if (run->frame > frames)
        return cs_fail(error, CS_ERR_USAGE,
                       "--frames: found %u, but \"%s\" is already at frame %u", frames,
                       checkpointer->path, run->frame);
    checkpointer->captured_frame = checkpointer->written_frame = run->frame;
    return CS_OK;
}

/* True at multiples of frames, or when the seconds are over. */
static bool is_due(const struct cs_checkpointer *checkpointer) {
    const struct cs_checkpoint_interval *interval = &checkpointer->interval;
    return interval->frames ? checkpointer->session->run.frame % interval->frames == 0
                            : cs_clock_wall() - checkpointer->last_time >= interval->seconds;
}

enum cs_status cs_checkpointer_capture(struct cs_checkpointer *checkpointer, bool *due,
                                       struct cs_error *error) {
    struct cs_run *run = checkpointer->session ? &checkpointer->session->run : NULL;
    *due = run && is_due(checkpointer);
    /* a method that saves is kept at every frame, for the case that the run is interrupted */
    if (!run || (!*due && !cs_run_method_has_history(run->integrator)))
        return CS_OK;
    cs_serialiser_begin(&checkpointer->serialiser);
    record_pace(checkpointer);
    checkpointer->source.serialise(checkpointer->source.ctx, &checkpointer->serialiser);
    checkpointer->captured_frame = run->frame;
    return cs_run_save(run, &checkpointer->serialiser, error);
}

/* Writes at most one file per captured frame; cs_checkpoint_write replaces the last one. */
enum cs_status cs_checkpointer_write(struct cs_checkpointer *checkpointer,
                                     struct cs_error *error) {
    struct cs_checkpoint_key keys[FACTS];
    if (!checkpointer->session || checkpointer->captured_frame == checkpointer->written_frame)
        return CS_OK;
    list_facts(checkpointer, keys);
    if (cs_checkpoint_write(checkpointer->path, keys, FACTS, &checkpointer->serialiser,
                            checkpointer->source.command, error))
        return error->status;
    checkpointer->written_frame = checkpointer->captured_frame;
    checkpointer->last_time = cs_clock_wall();
    return CS_OK;
}

void cs_checkpointer_finish(struct cs_checkpointer *checkpointer) {
    cs_serialiser_finish(&checkpointer->serialiser);
    *checkpointer = (struct cs_checkpointer){0};
}
