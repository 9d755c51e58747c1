/* advance_check.c - finds steps without commit, numbers that are not finite, and pinned
 * particles that moved. */
#include "sim/advance_check.h"

#include "model/event/event_state.h"

#include <math.h>
#include <string.h>

/* Relative to 1 + |t|: the rounding that a sum of steps may leave at the end. */
#define ROUNDING 1e-9

/* One step of the FNV-1a hash over 64-bit words instead of bytes. Both operations are
 * invertible, so a change of a single word always changes the hash. */
static uint64_t add_word(uint64_t sum, double value) {
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    return (sum ^ word) * 0x100000001b3u;
}

/* Hash of x and v of the pinned particles, without those that commit places on their path. */
static uint64_t sum_pins(const struct cs_system *system) {
    const struct cs_events *events = system->events;
    const size_t n = system->view.n;
    uint64_t sum = 0xcbf29ce484222325u;
    for (uint32_t p = 0; p < system->n_pinned; p++) {
        const size_t i = system->pinned[p];
        const bool on_path = events && events->has_grabs && events->held_by[i];
        for (size_t c = 0; c < 6 && !on_path; c++)
            sum = add_word(sum, system->state[c * n + i]);
    }
    return sum;
}

void cs_advance_check_begin(struct cs_advance_check *left, const struct cs_system *system,
                            double t) {
    *left = (struct cs_advance_check){
        .system = system, .pins_hash = sum_pins(system), .last_commit = t};
}

/* The first particle with a number that is not finite, or n. 0 * x is 0 for finite x, else
 * NaN: the sum tests all numbers without a branch, and the loop below runs after a failure
 * only. */
static uint32_t find_not_finite(const struct cs_system *system) {
    const size_t n = system->view.n;
    double sum = 0;
    for (size_t k = 0; k < 6 * n; k++)
        sum += 0 * system->state[k];
    uint32_t i = sum == 0 ? system->view.n : 0;
    for (; i < n; i++)
        for (size_t c = 0; c < 6; c++)
            if (!isfinite(system->state[c * n + i]))
                return i;
    return i;
}

bool cs_advance_check_passes(const struct cs_advance_check *left, double t,
                             struct cs_text *why) {
    const struct cs_system *system = left->system;
    if (!(fabs(left->last_commit - t) <= ROUNDING * (1 + fabs(t)))) {
        cs_text_add(
            why, "advance should have ended at t = %.9g s, but the last commit was at %.9g s",
            t, left->last_commit);
        return false;
    }
    const uint32_t particle = find_not_finite(system);
    if (particle < system->view.n) {
        cs_text_add(why, "after its last commit it left non-finite values in ");
        cs_system_print_particle(system, particle, why);
    } else if (sum_pins(system) != left->pins_hash)
        cs_text_add(why, "it moved a pinned particle");
    return !why->length;
}
