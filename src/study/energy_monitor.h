/* energy_monitor.h - instability monitor based on energy alone, without a reference run.
 *
 * Kinetic and elastic energy cannot exceed the available energy: that of the start E0, the
 * potential energy G that gravity has released, and the work of the wind. That work is largest
 * if every particle flies freely along the force. A particle of mass m under a force of at most
 * m a then gains the velocity a t. With B = sum m (a t)^2 / 2 and the Cauchy-Schwarz inequality
 *   E(t) <= sum m (v + a t)^2 / 2 <= E0 + G + B + 2 sqrt((E0 + G) B).
 * The speed of a particle is limited by its speed at the start, the energy of the springs at
 * it, and a fall over the time passed, which is a heuristic. Both limits have a safety factor,
 * because an instability exceeds any factor soon.
 *
 * Events (releases, ramps, paths) add energy without such a bound. After a frame with one, the
 * monitor restarts from the present state. */
#ifndef CS_ENERGY_MONITOR_H
#define CS_ENERGY_MONITOR_H

#include "sim/run.h"
#include "study/stability_verdict.h"

/* Figures and verdict of one sample. */
struct cs_energy_monitor_row {
    double t;
    struct cs_energy energy; /* J */
    double strain, speed;    /* largest */
    uint32_t particle;       /* the fastest */
    uint32_t particles;      /* faster than the limit */
    double speed_limit;      /* m/s */
    double energy_limit;     /* J, of kinetic + elastic */
    /* BOUNDED, LOCAL, GLOBAL or NOT_FINITE, of this time alone */
    enum cs_stability_verdict verdict;
};

/* State of the monitor since its last restart. */
struct cs_energy_monitor {
    double t_begin, last_sample;  /* s: the start, and the last look */
    double start_energy, gravity; /* J at the start: kinetic + elastic, of gravity */
    double gravity_released;      /* J, most that gravity gave until now */
    double start_speed; /* m/s: largest, and what the springs at one particle could give it */
    double gravity_acceleration,
        force_acceleration; /* m/s2, of gravity, and of wind and viewpoint forces at most */
    double mass,
        wind_mass; /* kg that can move; sum of m a^2 in kg m2/s4, for the wind's work */
    bool has_local_instability;         /* a local instability was seen */
    struct cs_energy_monitor_row first; /* when it began */
    enum cs_stability_verdict worst_verdict;
};

/* Begins at the start of a run, before its first frame. CS_ERR_MEMORY. */
enum cs_status cs_energy_monitor_begin(struct cs_energy_monitor *monitor,
                                       const struct cs_run *run, struct cs_error *error);
/* Samples the run after a frame and fills *row. Updates the worst verdict and the first
 * instability. */
void cs_energy_monitor_sample(struct cs_energy_monitor *monitor, const struct cs_run *run,
                              struct cs_energy_monitor_row *row);

/* Adds "local instability from t = 0.35 s on: ..."; nothing if the run was sound. */
void cs_energy_monitor_print(const struct cs_energy_monitor *monitor,
                             const struct cs_system *system, struct cs_text *out);

/* Add the column names, and the CSV row of a sample. */
void cs_energy_monitor_print_head(struct cs_text *out);
void cs_energy_monitor_print_row(const struct cs_energy_monitor_row *row, uint32_t frame,
                                 struct cs_text *out);

#endif
