/* Writes checkpoints of a run, and resumes from one. */
#include "cli/run/run_checkpoint.h"

#include "base/clock.h"
#include "sim/module.h"
#include "sim/run.h"

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
                                             struct cs_checkpoint_interval *pace,
                                             struct cs_error *error) {
    const size_t length = strlen(value);
    const bool seconds = length > 1 && value[length - 1] == 's';
    char number[32];
    double found;
    snprintf(number, sizeof number, "%.*s", (int)(length - seconds), value);
    *pace = (struct cs_checkpoint_interval){0};
    if (length < sizeof number && cs_parse_real(number, &found) && found > 0 &&
        (seconds ? found <= MOST_SECONDS
                 : found <= MOST_FRAMES && found == (double)(uint32_t)found)) {
        pace->seconds = seconds ? found : 0;
        pace->frames = seconds ? 0 : (uint32_t)found;
        return CS_OK;
    }
    return cs_fail(error, CS_ERR_USAGE,
                   "--checkpoint: found \"%.60s\", expected a number of frames, or of seconds "
                   "as in 30s",
                   value);
}

/* Hash of the method's module file. */
static enum cs_status hash_module(struct cs_checkpointer *resume, struct cs_error *error) {
    const struct cs_registry_entry *found;
    struct cs_session *session = resume->session;
    return cs_registry_find(&session->registry, session->method.integrator->name, &found, error)
               ? error->status
               : cs_module_hash(found->file, resume->module, error);
}

/* Facts that must agree before a run resumes, each with its name for the message. */
static void list_facts(const struct cs_checkpointer *resume,
                       struct cs_checkpoint_key facts[FACTS]) {
    const struct cs_checkpoint_key list[FACTS] = {
        {"version of clothsim", CS_VERSION},
        {"kind of machine", BYTE_ORDER_NAME},
        {"scene", resume->source.scene},
        {"scene by its files", resume->source.hash},
        {"method", resume->source.method},
        {"build of the method's module", resume->module},
        {"set of outputs", resume->source.output_settings},
    };
    memcpy(facts, list, sizeof list);
}

enum cs_status cs_checkpointer_check_interval(const struct cs_session *session,
                                              const struct cs_checkpoint_interval *pace,
                                              struct cs_error *error) {
    const struct cs_integrator *integrator = session->method.integrator;
    if (pace->seconds > 0 && !cs_run_method_has_history(integrator))
        return cs_fail(
            error, CS_ERR_USAGE,
            "--checkpoint: integrator \"%s\" restarts at each checkpoint, so the result would "
            "depend on the speed of the machine; give a number of frames",
            integrator->name);
    return CS_OK;
}

enum cs_status cs_checkpointer_begin(struct cs_checkpointer *resume, struct cs_session *session,
                                     const struct cs_checkpoint_source *of, const char *folder,
                                     const struct cs_checkpoint_interval *pace,
                                     struct cs_error *error) {
    *resume = (struct cs_checkpointer){
        .session = session, .source = *of, .interval = *pace, .last_time = cs_clock_wall()};
    if (snprintf(resume->path, sizeof resume->path, "%s/run.checkpoint", folder) >=
        (int)sizeof resume->path)
        return cs_fail(error, CS_ERR_FILE,
                       "cannot use the folder \"%.60s...\": the path is too long", folder);
    return hash_module(resume, error);
}

/* The interval is a part of the record: a resumed run keeps it. */
static void record_pace(struct cs_checkpointer *resume) {
    CS_SERIALISER(&resume->serialiser, resume->interval.frames);
    CS_SERIALISER(&resume->serialiser, resume->interval.seconds);
}

/* Reads in the order of cs_checkpointer_capture: interval, the caller's state, the run. A
 * record with bytes left over, or too few, is refused. */
enum cs_status cs_checkpointer_load(struct cs_checkpointer *resume, uint32_t frames,
                                    struct cs_error *error) {
    struct cs_checkpoint_key facts[FACTS];
    struct cs_error said = {0};
    struct cs_serialiser *record = &resume->serialiser;
    struct cs_run *run = &resume->session->run;
    list_facts(resume, facts);
    if (cs_checkpoint_read(resume->path, facts, FACTS, record, error))
        return error->status;
    record_pace(resume);
    resume->source.serialise(resume->source.ctx, record);
    if (cs_run_load(run, record, &said))
        return cs_fail(error, said.status, "\"%s\": %s", resume->path, said.message);
    if (!cs_serialiser_is_done(record))
        return cs_fail(error, CS_ERR_FILE, "\"%s\": it has the wrong size for this run",
                       resume->path);
    if (run->frame > frames)
        return cs_fail(error, CS_ERR_USAGE,
                       "--frames: found %u, but \"%s\" is already at frame %u", frames,
                       resume->path, run->frame);
    resume->captured_frame = resume->written_frame = run->frame;
    return CS_OK;
}

/* True at multiples of frames, or when the seconds are over. */
static bool is_due(const struct cs_checkpointer *resume) {
    const struct cs_checkpoint_interval *pace = &resume->interval;
    return pace->frames ? resume->session->run.frame % pace->frames == 0
                        : cs_clock_wall() - resume->last_time >= pace->seconds;
}

enum cs_status cs_checkpointer_capture(struct cs_checkpointer *resume, bool *due,
                                       struct cs_error *error) {
    struct cs_run *run = resume->session ? &resume->session->run : NULL;
    *due = run && is_due(resume);
    /* a method that saves is kept at every frame, for the case that the run is interrupted */
    if (!run || (!*due && !cs_run_method_has_history(run->integrator)))
        return CS_OK;
    cs_serialiser_begin(&resume->serialiser);
    record_pace(resume);
    resume->source.serialise(resume->source.ctx, &resume->serialiser);
    resume->captured_frame = run->frame;
    return cs_run_save(run, &resume->serialiser, error);
}

/* Writes at most one file per captured frame; cs_checkpoint_write replaces the last one. */
enum cs_status cs_checkpointer_write(struct cs_checkpointer *resume, struct cs_error *error) {
    struct cs_checkpoint_key facts[FACTS];
    if (!resume->session || resume->captured_frame == resume->written_frame)
        return CS_OK;
    list_facts(resume, facts);
    if (cs_checkpoint_write(resume->path, facts, FACTS, &resume->serialiser,
                            resume->source.command, error))
        return error->status;
    resume->written_frame = resume->captured_frame;
    resume->last_time = cs_clock_wall();
    return CS_OK;
}

void cs_checkpointer_finish(struct cs_checkpointer *resume) {
    cs_serialiser_finish(&resume->serialiser);
    *resume = (struct cs_checkpointer){0};
}
