/* bisect.h - finds the first number that two runs of a scene compute differently: its frame,
 * step, phase and particle.
 *
 * Both run as separate programs in parallel and stream their states. The first frame that
 * differs is then run once more with a full trace (base/trace_stream.h), of which the first
 * difference is reported: the bisection is in two levels of detail, not in time. */
#ifndef CS_BISECT_H
#define CS_BISECT_H

#include "base/status.h"
#include "base/text.h"

#include <signal.h>
#include <stdbool.h>
#include <stdint.h>

/* One of the two programs: its command "PROGRAM run SCENE ...", closed by NULL. */
struct cs_bisect_side {
    const char *name;             /* "A" */
    const char *const *arguments; /* (n_arguments), then NULL */
    uint32_t n_arguments;
};

/* Request for a bisection; pointers are borrowed. */
struct cs_bisect_settings {
    struct cs_bisect_side sides[2];
    double tolerance; /* allowed difference of numbers; 0: equal bits */
    const volatile sig_atomic_t *stop;
};

/* Difference of two trace records that should be equal. */
struct cs_bisect_difference {
    bool exists,
        values_differ; /* numbers: the values differ, and not only what is computed when */
    uint32_t frame;
    uint64_t step;
    double t;
    char phase[80], name[16];
    size_t first, count, n; /* the first number that differs, of how many, of all */
    double values[2];
    double largest; /* difference */
    char value_b[2]
                [120]; /* unless numbers: what each computed there instead, or how it ended */
};

/* Result of a bisection. */
struct cs_bisect {
    uint32_t n_equal_frames; /* frames */
    struct cs_bisect_difference
        state_difference; /* the first at the end of a frame, or at the start */
    struct cs_bisect_difference first_difference; /* the first of all, in that frame */
};

/* Runs both sides and finds the first difference; equal runs are a result. CS_ERR_FILE if a
 * program cannot be run or writes no trace; CS_ERR_INTERRUPT, CS_ERR_MEMORY. */
enum cs_status cs_bisect_run(struct cs_bisect *bisect,
                             const struct cs_bisect_settings *settings, struct cs_error *error);

/* Adds the difference as sentences, one per line. */
void cs_bisect_print(const struct cs_bisect_difference *difference, struct cs_text *out);

#endif
