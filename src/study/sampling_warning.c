/* Compares the longest edge of the meshes with the length that its contact samples cover. */
#include "study/sampling_warning.h"

#include "model/contact/contact_samples.h"

#include <math.h>

/* Range in m with which an edge of that length is covered by the largest number of samples. */
static double needed(double length, double radius) {
    const double part = length / CS_CONTACT_SAMPLE_PARTS_MAX;
    return (sqrt(radius * radius + 0.75 * part * part) - radius) / 0.75;
}

void cs_sampling_warning_print(const struct cs_system *system, struct cs_text *out) {
    uint32_t fine = 0;
    if (!system->contact_samples)
        return;
    const double edge = cs_contact_sample_longest(system);
    for (uint32_t c = 0; c < system->scene->colliders.n; c++) {
        struct cs_posed_collider at;
        cs_posed_collider_at(system, c, 0, &at);
        const double range = system->collider_params[c].range;
        if (edge <= CS_CONTACT_SAMPLE_PARTS_MAX * cs_contact_sample_spacing(&at, range) ||
            fine++ > 0)
            continue;
        cs_text_add(
            out,
            "colliders[%u]: an edge of %.3g m has at most %d contact samples, too few for this "
            "collider: use a finer mesh, or a thickness of at least %.2g m (now %.2g m)",
            c, edge, CS_CONTACT_SAMPLE_PARTS_MAX + 1, needed(edge, at.radius), range);
    }
    if (fine > 1)
        cs_text_add(out, "; the same holds for %u more", fine - 1);
}
