/* progress.h - one line on the terminal with the progress of a run. */
#ifndef CS_PROGRESS_H
#define CS_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

/* State of the line. */
struct cs_progress {
    bool shown;         /* not quiet */
    bool terminal;      /* stderr is one */
    const char *label;  /* the counted noun: "frame" */
    double start, last; /* s */
    int width;          /* of the present line */
};

/* Starts the clock. what: the noun that is counted, "frame". */
void cs_progress_begin(struct cs_progress *progress, const char *what, bool quiet);

/* Rewrites the line, at most ten times per second; without a terminal it adds a line every half
 * minute. progress is a struct cs_progress, so studies can pass this function as their
 * callback. The time left assumes equal items. */
void cs_progress_show(void *progress, uint32_t done, uint32_t total);

/* Removes the line. */
void cs_progress_end(struct cs_progress *progress);

#endif
