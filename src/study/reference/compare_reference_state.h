/* compare_reference_state.h - settings of a reference, and its result. */
#ifndef CS_COMPARE_REFERENCE_STATE_H
#define CS_COMPARE_REFERENCE_STATE_H

#include "session/recorded_run.h"

/* Measures how long a trajectory can be compared point by point.
 *
 * Two runs of one method start 1e-13 m apart in one particle. Their later distance shows how
 * the scene amplifies any error; it is a property of the scene, not of the method. The horizon
 * is the time at which the distance reaches the accuracy wanted: from there on pointwise errors
 * measure the amplification, not the method. */

#define CS_HORIZON_START 1e-13 /* m */

/* Growth of a small displacement. */
struct cs_horizon {
    double growth;     /* RMS distance at the last frame / at the start */
    double separation; /* m, RMS at the last frame */
    double time; /* s of the first frame with an RMS distance of the accuracy; HUGE_VAL: none */
};

/* Measures with `first` ("NAME:options"), or with `fallback` if that does not finish; NULL:
 * none. If neither finishes, growth is NAN and time 0. accuracy in m. CS_ERR_INTERRUPT,
 * CS_ERR_MEMORY, CS_ERR_MODULE. */
enum cs_status cs_horizon_measure(struct cs_horizon *horizon,
                                  const struct cs_recorded_run_settings *settings,
                                  double accuracy, const char *first, const char *fallback,
                                  struct cs_error *error);

enum { CS_COMPARE_REFERENCE_RUNS = 4 };

/* Usual explicit_seconds. */
#define CS_COMPARE_REFERENCE_SECONDS 20

/* Request for a reference; all pointers are borrowed. */
struct cs_compare_reference_settings {
    const struct cs_recorded_run_settings *run;
    const char *methods[2]; /* "NAME:options" of the two families; NULL: the best there are */
    double accuracy;        /* m to which pointwise errors are wanted: bounds the horizon */
    /* nominal s (cs_pass_seconds) of work that chosen explicit methods may take in all; beyond
     * it implicit ones stand for them */
    double explicit_seconds;
    const char *cache; /* folder, or NULL */
    /* called before each run with its method, after each of its steps with NULL, and at the
     * end with ""; may be NULL */
    void (*progress)(void *ctx, uint32_t done, uint32_t total, const char *what);
    void *ctx;
};

/* A reference; zeroed: none. Owns its trajectory. */
struct cs_compare_reference {
    struct cs_trajectory trajectory;
    char methods[CS_COMPARE_REFERENCE_RUNS][256]; /* family 1, its twin, family 2, its twin */
    char replacement[256]; /* for family 2 where the scene is too rough for it; "": none */
    double differences[3]; /* m: 1 against its twin, 2 against its twin, 1 against 2 */
    double error_bar;      /* m, RMS of particles at any frame: see compare_reference.h */
    double error_bar_max;  /* m, largest distance of a particle */
    double motion_scale;   /* m, largest RMS displacement from the start */
    double kinetic;        /* J, largest */
    double strain;         /* largest */
    double accuracy;       /* m, as asked for */
    struct cs_horizon horizon;
    double passes;          /* of the four runs by estimate (cs_counts_work); 0: not known */
    double explicit_passes; /* evaluations of the forces that four explicit runs would take,
                               where they are too dear and implicit ones stand for them; 0: they
                               do not */
    bool has_one_family;    /* the second did not finish: the bar is the distance of twins */
    bool families_agree;
    bool pointwise;   /* errors at the end of the time mean something */
    bool cached;      /* read from the cache */
    char reason[320]; /* why they do not agree, or why there are no pointwise errors */
};

/* The file of a reference, DIR/reference-KEY.state. */

/* Writes the hash of everything that a reference depends on, CS_HASH_DIGITS characters.
 * CS_ERR_MEMORY. */
enum cs_status cs_compare_reference_key(const struct cs_compare_reference *reference,
                                        const struct cs_recorded_run *recording,
                                        const struct cs_compare_reference_settings *settings,
                                        char *key, struct cs_error *error);

/* Reads the reference of the key from the folder. Returns false, with *reference unchanged, if
 * there is none, or one that does not fit the scene, the machine or its own hash. */
bool cs_compare_reference_read(struct cs_compare_reference *reference, const char *folder,
                               const char *key, const struct cs_recorded_run *recording);

/* Writes the file. It appears under its name only when it is complete, hence parallel
 * comparisons can share a folder. CS_ERR_FILE, CS_ERR_MEMORY. */
enum cs_status cs_compare_reference_write(const struct cs_compare_reference *reference,
                                          const char *folder, const char *key,
                                          struct cs_error *error);

/* Chooses the two families of methods of a reference. */

/* Writes the tighter settings of "NAME:key=value,...": rtol and atol divided by 10, dt by 2.
 * CS_ERR_USAGE if they cannot be read or do not fit. */
enum cs_status cs_compare_reference_tighten(const char *integrator, char *out, size_t size,
                                            struct cs_error *error);

/* Chooses the best available method of each family, with its settings. reference->replacement:
 * the next candidate for the second family; "" if there is none or both families are given.
 * Estimates reference->passes. Sets reference->explicit_passes where two explicit families
 * would exceed their budget, and chooses two implicit ones with steps of a quarter of a frame.
 */
enum cs_status cs_compare_reference_choose(const struct cs_compare_reference_settings *settings,
                                           char chosen[2][256],
                                           struct cs_compare_reference *reference,
                                           struct cs_error *error);

/* Measures the horizon and decides whether there are pointwise errors: these need families that
 * agree, a horizon beyond the end, and an error bar below the accuracy. The bar of implicit
 * families is the accuracy if it is larger, up to a tenth of the motion; their own method
 * measures the horizon. A bar above that leaves statistics, and a growth of NAN. Errors as of
 * cs_horizon_measure. */
enum cs_status
cs_compare_reference_judge_horizon(struct cs_compare_reference *reference,
                                   const struct cs_recorded_run_settings *settings,
                                   struct cs_error *error);

/* Computes the verified reference that runs are measured against.
 *
 * Two families of methods solve the scene, each twice: at settings a and at tighter ones, its
 * twin. The runs a1, b1 belong to family 1 and a2, b2 to family 2; |.| is the largest RMS
 * distance of particles at any frame.
 *   |a1 - b1|, |a2 - b2|   self-convergence: estimates of each family's own error at a
 *   |b1 - b2|              distance of the two best runs: the error of the reference
 * If the families differ by far more than their own errors explain, one of them solves another
 * problem, and there is no reference. The run b1 is the reference; its error bar is the larger
 * of |a1 - b1| and |b1 - b2|. |a2 - b2| is no part of it, because a2 is not used. */

/* Computes the reference, or reads it from the cache. Disagreement of the families is a result:
 * families_agree is false and reason says why. CS_ERR_MODULE if a requested method is missing;
 * CS_ERR_INTERRUPT; CS_ERR_MEMORY; CS_ERR_FILE if the cache cannot be written. On failure
 * *reference is empty. */
enum cs_status cs_compare_reference_get(struct cs_compare_reference *reference,
                                        const struct cs_compare_reference_settings *settings,
                                        struct cs_error *error);
/* Frees the states; a zeroed reference is allowed. */
void cs_compare_reference_finish(struct cs_compare_reference *reference);

/* Chooses the methods of the four runs without running them. key (CS_HASH_DIGITS characters):
 * hash of everything the reference depends on, which identifies a comparison. */
enum cs_status cs_compare_reference_plan(struct cs_compare_reference *reference,
                                         const struct cs_compare_reference_settings *settings,
                                         char *key, struct cs_error *error);

/* Number of frames with pointwise errors: all or none. */
uint32_t cs_compare_reference_pointwise_frames(const struct cs_compare_reference *reference);

#endif
