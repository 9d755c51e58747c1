/* compare_reference.h - computes the verified reference that runs are measured against.
 *
 * Two families of methods solve the scene, each twice: at settings a and at tighter ones, its
 * twin. The runs a1, b1 belong to family 1 and a2, b2 to family 2; |.| is the largest RMS
 * distance of particles at any frame.
 *   |a1 - b1|, |a2 - b2|   self-convergence: estimates of each family's own error at a
 *   |b1 - b2|              distance of the two best runs: the error of the reference
 * If the families differ by far more than their own errors explain, one of them solves another
 * problem, and there is no reference. The run b1 is the reference; its error bar is the larger
 * of |a1 - b1| and |b1 - b2|. |a2 - b2| is no part of it, because a2 is not used. */
#ifndef CS_COMPARE_REFERENCE_H
#define CS_COMPARE_REFERENCE_H

#include "study/reference/compare_reference_state.h"

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
