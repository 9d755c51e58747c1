/* Checks that a run resumed from a checkpoint has the bits of the unbroken run. */
#include "sim/run.h"
#include "study/conform/conform_checks.h"
#include "study/conform/conform_probe.h"

#include <string.h>

/* Many things change between frames: ramped values, released pins, gusts and contact. */
#define EVENTFUL                                                                               \
    "{\"bodies\": [{\"cloth\": {\"grid\": [6, 6], \"bump\": 0.02}, \"mass\": {\"particle\": "  \
    "0.05}, \"springs\": {\"stretch\": 60, \"shear\": 20, \"bend\": 5, \"damping\": 0.1},"     \
    " \"pins\": [\"top-left\", \"top-right\"]}, {\"cloth\": {\"grid\": [4, 3], \"bump\": "     \
    "0.01}, \"mass\": {\"particle\": 0.05}, \"springs\": {\"stretch\": 60}, \"pins\": [1]}],"  \
    " \"colliders\": [{\"floor\": {\"height\": -0.52}}], \"forces\": {\"drag\": 0.01},"        \
    " \"time\": {\"fps\": 60}, \"events\": [{\"from\": 0.02, \"to\": 0.12, \"ramp\": {"        \
    "\"key\": \"bodies[1].springs.stretch\", \"value\": 90}}, {\"from\": 0.01, \"to\": 0.14,"  \
    " \"wind\": {\"strength\": 3, \"direction\": [0, 0, 1]}}, {\"at\": 0.06, \"release\": {"   \
    "\"particles\": [\"top-left\"]}}]}"
/* Frames of the run, and the frame after which the checkpoint is written. */
enum { FRAMES = 10, BROKEN = 5 };

/* Writes a record after BROKEN frames, or restores the run from one. */
static bool pass_break(struct cs_probe *probe, struct cs_serialiser *record) {
    struct cs_run *run = &probe->session.run;
    if (!probe->has_ended && record->is_reading)
        probe->has_ended = cs_run_load(run, record, &probe->error);
    else if (!probe->has_ended)
        probe->has_ended = cs_run_save(run, record, &probe->error);
    return !probe->has_ended;
}

/* True if state and counts agree exactly. */
static bool is_same(const struct cs_probe *one, const struct cs_probe *two) {
    const struct cs_counts *a = &one->session.run.counts, *b = &two->session.run.counts;
    return !memcmp(one->x, two->x, 6 * one->n * sizeof *one->x) && a->steps == b->steps &&
           a->forces == b->forces && a->solve_iterations == b->solve_iterations &&
           a->method.rejected == b->method.rejected && a->method.newton == b->method.newton;
}

void cs_check_resume(const struct cs_conform *card, struct cs_conform_row *row) {
    struct cs_probe whole, resumed;
    struct cs_serialiser record = {0};
    uint32_t differ = 0;
    cs_probe_open(&whole, card, card->method, EVENTFUL);
    cs_probe_open(&resumed, card, card->method, EVENTFUL);
    if (cs_probe_run(&whole, BROKEN) && pass_break(&whole, &record) &&
        cs_probe_run(&resumed, 0)) {
        record.is_reading = true;
        pass_break(&resumed, &record);
        if (!resumed.has_ended && !cs_serialiser_is_done(&record))
            cs_row_fail(row, "load reads less than save wrote");
    }
    for (int k = BROKEN; k < FRAMES && cs_probe_run(&whole, 1) && cs_probe_run(&resumed, 1);
         k++)
        differ += !is_same(&whole, &resumed);
    if (whole.has_ended || resumed.has_ended)
        cs_row_fail(row, "%s", whole.has_ended ? whole.error.message : resumed.error.message);
    else
        cs_row_state(row, differ, 0, "of %d frames with other bits (%s)", FRAMES - BROKEN,
                     cs_run_method_has_history(card->method)
                         ? "it saves its memory"
                         : "it is restarted at checkpoints");
    cs_serialiser_finish(&record);
    cs_probe_close(&whole);
    cs_probe_close(&resumed);
}
