/* yardstick.h - the verified reference that runs are measured against: computed by two
 * families of methods, each with a tighter twin, so that it comes with its own error.
 *
 * The error bar is the largest difference between the four runs. Where each family agrees with
 * its own twin but not with the other family, one of them solves another problem: then there
 * is no reference.
 */
#ifndef CS_YARDSTICK_H
#define CS_YARDSTICK_H

#include "study/compare/horizon.h"
#include "study/deviation.h"

enum { CS_YARDSTICK_RUNS = 4 };

struct cs_yardstick_settings {
    const struct cs_course_settings *course;
    const char *methods[2]; /* "NAME:options" of the two families; NULL: the best there are */
    double accuracy;        /* m to which pointwise errors are wanted: bounds the horizon */
    const char *cache;      /* folder, or NULL */
    /* called before each run and at the end; may be NULL */
    void (*progress)(void *ctx, uint32_t done, uint32_t total, const char *what);
    void *ctx;
};

/* Zeroed: none. */
struct cs_yardstick {
    struct cs_track track;
    char methods[CS_YARDSTICK_RUNS][256]; /* family 1, its twin, family 2, its twin */
    double differences[3]; /* m: 1 against its twin, 2 against its twin, 1 against 2 */
    double bar;            /* m, largest of them at any frame (RMS of particles) */
    double bar_max;        /* m, largest distance of a particle */
    double scale;          /* m, largest RMS displacement from the start */
    double kinetic;        /* J, largest */
    double strain;         /* largest */
    double accuracy;       /* m, as asked for */
    struct cs_horizon horizon;
    bool agree;
    bool pointwise;   /* errors at the end of the time mean something */
    bool cached;      /* read from the cache */
    char reason[320]; /* why they do not agree, or why there are no pointwise errors */
};

/* Computes, or reads from the cache. That the families disagree is a result. CS_ERR_MODULE
 * where a method that was asked for is not there; CS_ERR_INTERRUPT; CS_ERR_MEMORY; CS_ERR_FILE
 * where the cache cannot be written. */
enum cs_status cs_yardstick_get(struct cs_yardstick *yardstick,
                                const struct cs_yardstick_settings *settings,
                                struct cs_error *error);
void cs_yardstick_finish(struct cs_yardstick *yardstick);

/* Chooses the four runs without running them; key (CS_HASH_DIGITS characters) says of which
 * scene, time and reference a comparison is. */
enum cs_status cs_yardstick_plan(struct cs_yardstick *yardstick,
                                 const struct cs_yardstick_settings *settings, char *key,
                                 struct cs_error *error);

/* Frames of pointwise errors: all or none. */
uint32_t cs_yardstick_pointwise_frames(const struct cs_yardstick *yardstick);

/* Below: parts of yardstick.c. */

/* Writes the next tighter settings of "NAME:key=value,...": rtol and atol divided by 10, dt by
 * 2. CS_ERR_USAGE where they cannot be read or do not fit. */
enum cs_status cs_yardstick_tighten(const char *integrator, char *out, size_t size,
                                    struct cs_error *error);

/* Chooses two families of the methods that are there, best first, with their settings. */
enum cs_status cs_yardstick_choose(const struct cs_yardstick_settings *settings,
                                   char chosen[2][256], struct cs_error *error);

/* Hash of all that it depends on: CS_HASH_DIGITS characters. */
void cs_yardstick_key(const struct cs_yardstick *yardstick, const struct cs_course *course,
                      const struct cs_yardstick_settings *settings, char *key);

/* Reads or writes DIR/reference-KEY.state; a file that does not fit counts as none. */
bool cs_yardstick_read(struct cs_yardstick *yardstick, const char *folder, const char *key,
                       const struct cs_course *course);
enum cs_status cs_yardstick_write(const struct cs_yardstick *yardstick, const char *folder,
                                  const char *key, struct cs_error *error);

#endif
