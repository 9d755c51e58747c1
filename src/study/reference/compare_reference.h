/* compare_reference.h - the verified reference that runs are measured against: computed by two
 * families of methods, each with a tighter twin, so that it comes with its own error.
 *
 * The error bar is the largest difference between the four runs. Where each family agrees with
 * its own twin but not with the other family, one of them solves another problem: then there
 * is no reference.
 */
#ifndef CS_COMPARE_REFERENCE_H
#define CS_COMPARE_REFERENCE_H

#include "study/reference/compare_reference_state.h"

/* Computes, or reads from the cache. That the families disagree is a result. CS_ERR_MODULE
 * where a method that was asked for is not there; CS_ERR_INTERRUPT; CS_ERR_MEMORY; CS_ERR_FILE
 * where the cache cannot be written. */
enum cs_status cs_compare_reference_get(struct cs_compare_reference *reference,
                                        const struct cs_compare_reference_settings *settings,
                                        struct cs_error *error);
void cs_compare_reference_finish(struct cs_compare_reference *reference);

/* Chooses the four runs without running them; key (CS_HASH_DIGITS characters) says of which
 * scene, time and reference a comparison is. */
enum cs_status cs_compare_reference_plan(struct cs_compare_reference *reference,
                                         const struct cs_compare_reference_settings *settings,
                                         char *key, struct cs_error *error);

/* Frames of pointwise errors: all or none. */
uint32_t cs_compare_reference_pointwise_frames(const struct cs_compare_reference *reference);

#endif
