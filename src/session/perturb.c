/* Perturbs the start of a scene reproducibly: by a hash of each index, or by smooth waves. */
#include "session/perturb.h"

#include <math.h>

/* Maps an index to -1..1 by multiplications and xor-shifts: no generator state, hence no order.
 */
static double noise_of(uint64_t index) {
    uint64_t bits = (index + 1) * 0x9e3779b97f4a7c15u;
    bits = (bits ^ bits >> 31) * 0xbf58476d1ce4e5b9u;
    bits ^= bits >> 29;
    return (double)(bits >> 11) * 0x1p-52 - 1;
}

void cs_perturb_random(struct cs_system *system, double displacement, double velocity) {
    const size_t n = system->view.n;
    double *x = system->state, *v = x + 3 * n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            if (system->inv_mass[i] > 0) {
                x[c * n + i] += displacement * noise_of(3 * i + c);
                v[c * n + i] += velocity * noise_of(3 * (n + i) + c);
            }
}

void cs_perturb_smooth(struct cs_system *system, double displacement, double velocity) {
    const size_t n = system->view.n;
    double *x = system->state, *v = x + 3 * n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++)
            if (system->inv_mass[i] > 0) {
                const double phase = 1.7 * (double)i + 2.3 * (double)c;
                x[c * n + i] += displacement * sin(phase);
                v[c * n + i] += velocity * cos(2.1 * phase);
            }
}
