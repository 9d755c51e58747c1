/* run_range.h - finds one range of colours for all pictures of a run. */
#ifndef CS_RUN_RANGE_H
#define CS_RUN_RANGE_H

#include "cli/run/run_settings.h"

/* An override of render.range; zeroed: nothing found. */
struct cs_run_range {
    char value[80];
    struct cs_override *overrides; /* owned: those of the settings, and render.range */
};

/* Adds an override of render.range to the settings, which then borrow it. text is "MIN,MAX", or
 * "auto": the scene is then run once without pictures, and the range covers all its frames.
 * CS_ERR_USAGE if the text is neither, or if the look shows no values. */
enum cs_status cs_run_range_set(struct cs_run_range *range, const char *text,
                                struct cs_job_settings *settings, struct cs_error *error);

/* Frees the override; the settings must not be used after it. */
void cs_run_range_finish(struct cs_run_range *range);

#endif
