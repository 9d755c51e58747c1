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

/* Adds a displacement and a velocity (m, m/s) times numbers of -1..1 to each free component. */
static void perturb(struct cs_system *system, double displacement, double velocity,
                    bool smooth) {
    const size_t n = system->view.n;
    double *x = system->state, *v = x + 3 * n;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < n; i++) {
            const double phase = 1.7 * (double)i + 2.3 * (double)c;
            if (system->inv_mass[i] <= 0)
                continue;
            x[c * n + i] += displacement * (smooth ? sin(phase) : noise_of(3 * i + c));
            v[c * n + i] += velocity * (smooth ? cos(2.1 * phase) : noise_of(3 * (n + i) + c));
        }
}

void cs_perturb_random(struct cs_system *system, double displacement, double velocity) {
    perturb(system, displacement, velocity, false);
}

void cs_perturb_smooth(struct cs_system *system, double displacement, double velocity) {
    perturb(system, displacement, velocity, true);
}
