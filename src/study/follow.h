/* follow.h - the loop over the frames of a run, and the result of the run.
 *
 *   struct cs_follow follow = {.run = &session.run, .last = frames, .every = 1};
 *   while (cs_follow_next(&follow, error))
 *     ...                          here follow.run is at the end of a frame
 *   cs_follow_result(follow.run, "", &result, error);
 * Only the steps are timed, not the work between two calls. */
#ifndef CS_FOLLOW_H
#define CS_FOLLOW_H

#include "sim/run.h"

/* A begun run on its way to a frame. */
struct cs_follow {
    struct cs_run *run; /* borrowed */
    double last;        /* the frame to stop at */
    uint32_t every;     /* stops at multiples of it on the way; 0: at none */
    bool at_start;      /* stops first where the run is */
    double cpu, wall;   /* s, out: of all steps, without what is done between them */
};

/* Steps to the next multiple of `every`, or to the last frame. Returns false if no such
 * multiple was reached: at the last frame, after the end of the run, and after a failure. */
bool cs_follow_next(struct cs_follow *follow, struct cs_error *error);

/* Result of a run. */
struct cs_run_result {
    enum cs_outcome
        outcome;        /* CS_RUNNING: at its last frame; CS_FAILED: an error of the method */
    double reached;     /* s, of the last frame; of the last step where the budget ended it */
    double time;        /* s, of the blow-up if there was one, else as reached */
    char message[1024]; /* why the method gave up, else the outcome as text */
};

/* Fills the result. A method that gave up is a result, and *error is cleared. An interrupted
 * run is CS_ERR_INTERRUPT: "interrupted" followed by the text. Other errors stay. */
enum cs_status cs_follow_result(const struct cs_run *run, const char *interrupted,
                                struct cs_run_result *result, struct cs_error *error);
/* The same of a run whose method must not give up: its failure stays an error. */
enum cs_status cs_follow_check(const struct cs_run *run, const char *interrupted,
                               struct cs_error *error);

/* Returns the smallest whole number of frames that cover a time in s. A product that is whole
 * up to rounding (a relative 1e-9) gets no extra frame. */
double cs_follow_frames(const struct cs_scene *scene, double seconds);

#endif
