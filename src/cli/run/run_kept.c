/* Keeps the frames of a run for its report, and its rows for a checkpoint. */
#include "cli/run/run_kept.h"

#include <stdlib.h>

static bool has_room(struct cs_job *job, size_t frames) {
    if (frames <= job->kept_capacity)
        return true;
    const size_t capacity = 2 * frames + 64;
    void *larger = realloc(job->kept, capacity * sizeof *job->kept);
    if (!larger)
        return false;
    job->kept = larger;
    job->kept_capacity = capacity;
    return true;
}

enum cs_status cs_job_keep(struct cs_job *job, const struct cs_job_frame *frame,
                           struct cs_error *error) {
    const size_t number = job->session.run.frame;
    if (!has_room(job, number))
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the hashes of %zu frames",
                       number);
    job->kept[number - 1] = *frame;
    return CS_OK;
}

void cs_job_record(void *ctx, struct cs_record *record) {
    struct cs_job *job = ctx;
    uint64_t n = cs_job_wants_json(job->settings) ? job->session.run.frame : 0;
    CS_RECORD(record, job->watch);
    CS_RECORD(record, job->tally);
    CS_RECORD(record, job->hash);
    CS_RECORD(record, job->drawn);
    cs_record_text(record, &job->watch_rows);
    cs_record_text(record, &job->ledger_rows);
    CS_RECORD(record, job->account.work);
    CS_RECORD(record, n);
    if (record->loading && (record->failed || n > record->length || !has_room(job, (size_t)n)))
        record->failed = true;
    else
        cs_record_bytes(record, job->kept, (size_t)n * sizeof *job->kept);
}
