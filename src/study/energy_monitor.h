/* energy_monitor.h - is a run still sound, judged by nothing but energy: no second run to
 * compare with.
 *
 * What moves and is stretched cannot hold more than the start held, gravity released and the
 * wind can have given; a particle can hardly be faster than a few times what a fall, the
 * springs let go at it, or its share of that energy make of it. What events give has no such
 * bound: at the end of a frame in which one began or ended, a value moved or a path was
 * followed, the watch starts anew from what there is.
 */
#ifndef CS_ENERGY_MONITOR_H
#define CS_ENERGY_MONITOR_H

#include "sim/run.h"
#include "study/stability_verdict.h"

/* What a run has at one time. */
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

struct cs_energy_monitor {
    double t_begin, last_sample;  /* s: the start, and the last look */
    double start_energy, gravity; /* J at the start: kinetic + elastic, of gravity */
    double gravity_released;      /* J, most that gravity gave until now */
    double start_speed; /* m/s: largest, and what the springs at one particle could give it */
    double gravity_acceleration,
        force_acceleration;     /* m/s2, of gravity, and of wind and viewpoint forces at most */
    double mass, wind_mass;     /* kg that can move; of it times (wind/gravity) for its work */
    bool has_local_instability; /* a local instability was seen */
    struct cs_energy_monitor_row first; /* when it began */
    enum cs_stability_verdict worst_verdict;
};

/* At the start of a run (before its first frame), and after each frame. */
enum cs_status cs_energy_monitor_begin(struct cs_energy_monitor *monitor,
                                       const struct cs_run *run, struct cs_error *error);
void cs_energy_monitor_sample(struct cs_energy_monitor *monitor, const struct cs_run *run,
                              struct cs_energy_monitor_row *row);

/* "local instability from t = 0.35 s on: ..." where there is something to say. */
void cs_energy_monitor_print(const struct cs_energy_monitor *monitor,
                             const struct cs_system *system, struct cs_text *out);

/* CSV: energy, largest strain and largest velocity of a frame. */
void cs_energy_monitor_print_head(struct cs_text *out);
void cs_energy_monitor_print_row(const struct cs_energy_monitor_row *row, uint32_t frame,
                                 struct cs_text *out);

#endif
