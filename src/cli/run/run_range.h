/* run_range.h - one range of colours for all pictures of a run. */
#ifndef CS_RUN_RANGE_H
#define CS_RUN_RANGE_H

#include "cli/run/run_settings.h"

/* Zeroed: nothing found. */
struct cs_run_range {
    char value[80];
    struct cs_override *overrides; /* owned: those of the settings, and render.range */
};

/* Adds an override of render.range to the settings, which then borrow it: text is "LEAST,MOST",
 * or "auto" for the range of a run without pictures, as a frame's is found from its particles.
 * CS_ERR_USAGE where the text is neither, or the look has no values. */
enum cs_status cs_run_range_set(struct cs_run_range *range, const char *text,
                                struct cs_job_settings *settings, struct cs_error *error);

void cs_run_range_finish(struct cs_run_range *range);

#endif
