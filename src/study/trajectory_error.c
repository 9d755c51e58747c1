/* Measures the distance of one recorded run from another. */
#include "study/trajectory_error.h"

#include "session/session.h"

#include <math.h>

/* Squared distance of particle i in a and b. */
static double squared(size_t n, const double *a, const double *b, size_t i) {
    double sum = 0;
    for (size_t c = 0; c < 3; c++) {
        const double d = a[c * n + i] - b[c * n + i];
        sum += d * d;
    }
    return sum;
}

double cs_rms_difference(const double *a, const double *b, size_t n) {
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sqrt(sum / (double)n);
}

double cs_distance_rms(const struct cs_system *system, const struct cs_trajectory *run,
                       uint32_t frame, const double *a, const double *b) {
    const size_t n = system->view.n;
    double sum = 0, mass = 0;
    for (size_t i = 0; i < n; i++)
        if (run->free_from[i] <= frame / run->fps) {
            sum += system->mass[i] * squared(n, a, b, i);
            mass += system->mass[i];
        }
    return mass > 0 ? sqrt(sum / mass) : 0;
}

double cs_distance_max(const struct cs_system *system, const double *a, const double *b) {
    const size_t n = system->view.n;
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, squared(n, a, b, i));
    return sqrt(largest);
}

void cs_distance_each(uint32_t n, const double *a, const double *b, double *out) {
    for (uint32_t i = 0; i < n; i++)
        out[i] = sqrt(squared(n, a, b, i));
}

/* Total energy in J of a state (6n). */
static double energy_of(const struct cs_system *system, double t, const double *x) {
    const struct cs_energy energy =
        cs_diagnostics_energy(system, t, x, x + 3 * (size_t)system->view.n);
    return cs_energy_total(&energy);
}

/* Distance in m of the centres of mass. */
static double centre_distance(const struct cs_system *system, const double *a,
                              const double *b) {
    const size_t n = system->view.n;
    double squares = 0;
    for (size_t c = 0; c < 3; c++) {
        double sum = 0, mass = 0;
        for (size_t i = 0; i < n; i++) {
            sum += system->mass[i] * (a[c * n + i] - b[c * n + i]);
            mass += system->mass[i];
        }
        squares += sum / mass * (sum / mass);
    }
    return sqrt(squares);
}

/* largest difference of the six sides of the bounding boxes */
static double box_distance(size_t n, const double *a, const double *b) {
    double largest = 0;
    for (size_t c = 0; c < 3; c++) {
        double of_a[2], of_b[2];
        cs_diagnostics_range(a + c * n, (uint32_t)n, of_a);
        cs_diagnostics_range(b + c * n, (uint32_t)n, of_b);
        largest = fmax(largest, fmax(fabs(of_a[0] - of_b[0]), fabs(of_a[1] - of_b[1])));
    }
    return largest;
}

/* Updates the largest differences of energy, centre, box and strain with one frame. */
static void take_statistics(struct cs_trajectory_error *error, const struct cs_system *system,
                            double t, const double *a, const double *b) {
    const size_t n = system->view.n;
    error->energy =
        fmax(error->energy, fabs(energy_of(system, t, a) - energy_of(system, t, b)));
    error->centre = fmax(error->centre, centre_distance(system, a, b));
    error->box = fmax(error->box, box_distance(n, a, b));
    error->strain = fmax(error->strain, cs_diagnostics_strain(system, a));
}

/* path is the root mean square over frames of the RMS distance; end and velocity are those of
 * the last compared frame. */
void cs_trajectory_error_compute(struct cs_trajectory_error *error,
                                 const struct cs_system *system,
                                 const struct cs_trajectory *trajectory,
                                 const struct cs_trajectory *reference, uint32_t frames,
                                 uint32_t pointwise_frames) {
    const size_t v = 3 * (size_t)system->view.n;
    *error = (struct cs_trajectory_error){0};
    for (uint32_t k = 1; k <= frames; k++) {
        const double *a = cs_trajectory_state(trajectory, k),
                     *b = cs_trajectory_state(reference, k);
        take_statistics(error, system, k / system->scene->time.fps, a, b);
        if (k > pointwise_frames)
            continue;
        error->end = cs_distance_rms(system, trajectory, k, a, b);
        error->end_max = cs_distance_max(system, a, b);
        error->velocity = cs_distance_rms(system, trajectory, k, a + v, b + v);
        error->path += error->end * error->end;
        error->path_max = fmax(error->path_max, error->end_max);
    }
    error->path = sqrt(error->path / frames);
    if (pointwise_frames < frames)
        error->end = error->end_max = error->path = error->path_max = error->velocity =
            (double)NAN;
}
