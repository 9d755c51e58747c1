/* Makes checkpoints of a run, and goes on from one. */
#include "cli/run/run_resume.h"

#include "base/clock.h"
#include "sim/module.h"
#include "sim/run_record.h"

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

enum cs_status cs_resume_read_pace(const char *value, struct cs_resume_pace *pace,
                                   struct cs_error *error) {
    const size_t length = strlen(value);
    const bool seconds = length > 1 && value[length - 1] == 's';
    char number[32];
    double found;
    snprintf(number, sizeof number, "%.*s", (int)(length - seconds), value);
    *pace = (struct cs_resume_pace){0};
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

/* of the file that the method came from; empty where it is none */
static void hash_module(struct cs_resume *resume) {
    const struct cs_registered *found;
    struct cs_error unread = {0};
    struct cs_session *session = resume->session;
    if (!cs_registry_find(&session->registry, session->method.integrator->name, &found,
                          &unread))
        cs_module_hash(found->file, resume->module);
}

static void list_facts(const struct cs_resume *resume, struct cs_fact facts[FACTS]) {
    const struct cs_fact list[FACTS] = {
        {"version of clothsim", CS_VERSION},
        {"kind of machine", BYTE_ORDER_NAME},
        {"scene", resume->of.scene},
        {"scene by its files", resume->of.hash},
        {"method", resume->of.method},
        {"build of the method's module", resume->module},
        {"set of outputs", resume->of.outputs},
    };
    memcpy(facts, list, sizeof list);
}

enum cs_status cs_resume_check_pace(const struct cs_session *session,
                                    const struct cs_resume_pace *pace, struct cs_error *error) {
    const struct cs_integrator *integrator = session->method.integrator;
    if (pace->seconds > 0 && !cs_run_remembers(integrator))
        return cs_fail(error, CS_ERR_USAGE,
                       "--checkpoint: integrator \"%s\" starts anew at each checkpoint, so its "
                       "result would hang on the clock; give a number of frames",
                       integrator->name);
    return CS_OK;
}

enum cs_status cs_resume_begin(struct cs_resume *resume, struct cs_session *session,
                               const struct cs_resume_of *of, const char *folder,
                               const struct cs_resume_pace *pace, struct cs_error *error) {
    *resume = (struct cs_resume){
        .session = session, .of = *of, .pace = *pace, .last = cs_clock_wall()};
    if (snprintf(resume->path, sizeof resume->path, "%s/run.checkpoint", folder) >=
        (int)sizeof resume->path)
        return cs_fail(error, CS_ERR_FILE,
                       "cannot use the folder \"%.60s...\": the path is too long", folder);
    hash_module(resume);
    return CS_OK;
}

static void record_pace(struct cs_resume *resume) {
    CS_RECORD(&resume->record, resume->pace.frames);
    CS_RECORD(&resume->record, resume->pace.seconds);
}

enum cs_status cs_resume_load(struct cs_resume *resume, uint32_t frames,
                              struct cs_error *error) {
    struct cs_fact facts[FACTS];
    struct cs_error said = {0};
    struct cs_record *record = &resume->record;
    struct cs_run *run = &resume->session->run;
    list_facts(resume, facts);
    if (cs_checkpoint_read(resume->path, facts, FACTS, record, error))
        return error->status;
    record_pace(resume);
    resume->of.record(resume->of.ctx, record);
    if (cs_run_load(run, record, &said))
        return cs_fail(error, said.status, "\"%s\": %s", resume->path, said.message);
    if (!cs_record_is_done(record))
        return cs_fail(error, CS_ERR_FILE, "\"%s\": it holds more or less than a run",
                       resume->path);
    if (run->frame > frames)
        return cs_fail(error, CS_ERR_USAGE, "--frames: found %u, but \"%s\" is of frame %u",
                       frames, resume->path, run->frame);
    resume->kept = resume->written = run->frame;
    return CS_OK;
}

static bool is_due(const struct cs_resume *resume) {
    const struct cs_resume_pace *pace = &resume->pace;
    return pace->frames ? resume->session->run.frame % pace->frames == 0
                        : cs_clock_wall() - resume->last >= pace->seconds;
}

enum cs_status cs_resume_keep(struct cs_resume *resume, bool *due, struct cs_error *error) {
    struct cs_run *run = resume->session ? &resume->session->run : NULL;
    *due = run && is_due(resume);
    /* a method that saves is kept at every frame, for the case that the run is interrupted */
    if (!run || (!*due && !cs_run_remembers(run->integrator)))
        return CS_OK;
    cs_record_begin(&resume->record);
    record_pace(resume);
    resume->of.record(resume->of.ctx, &resume->record);
    resume->kept = run->frame;
    return cs_run_save(run, &resume->record, error);
}

enum cs_status cs_resume_write(struct cs_resume *resume, struct cs_error *error) {
    struct cs_fact facts[FACTS];
    if (!resume->session || resume->kept == resume->written)
        return CS_OK;
    list_facts(resume, facts);
    if (cs_checkpoint_write(resume->path, facts, FACTS, &resume->record, error))
        return error->status;
    resume->written = resume->kept;
    resume->last = cs_clock_wall();
    return CS_OK;
}

void cs_resume_finish(struct cs_resume *resume) {
    cs_record_finish(&resume->record);
    *resume = (struct cs_resume){0};
}
