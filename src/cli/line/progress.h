/* progress.h - one line on the terminal that says how far a run is. */
#ifndef CS_PROGRESS_H
#define CS_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct cs_progress {
    bool shown;         /* nobody asked for quiet */
    bool terminal;      /* stderr is one */
    const char *label;  /* is counted: "frame" */
    double start, last; /* s */
    int width;          /* of the line that is there */
};

void cs_progress_begin(struct cs_progress *progress, const char *what, bool quiet);

/* Rewrites the line, at most ten times a second; off a terminal, adds one every half minute.
 * progress is a struct cs_progress: studies call this with their ctx. */
void cs_progress_show(void *progress, uint32_t done, uint32_t total);

/* Takes the line away. */
void cs_progress_end(struct cs_progress *progress);

#endif
