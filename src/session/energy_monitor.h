/* energy_monitor.h - the judge of stability, the same in run, stability, advise and compare:
 * has the integrator made energy?
 *
 * Balance. At each sample, with the total energy E = T + U and the energy W that the scene has
 * put in since the start,
 *   R(t) = E(t) - W(t),  made(t) = R(t) - min of R until t.
 * Dampers, friction, drag and corrections that lose energy only lower R. For the exact solution
 * R therefore never rises: a rise is energy of the integrator, and at least as much as the
 * ledger's column (energy_ledger.h) has less what was lost meanwhile. A run whose energy falls
 * is never called unstable.
 *
 * Bound. S(t) = energy but gravity's at the start + most that gravity has released + W(t): all
 * that the scene held and gave. A run is globally unstable if made > S, from the eighth sample
 * on: S begins at nothing where all is at rest. With an explicit symplectic method it must also
 * grow: made is half more than ever in the first half of the run until then. made > 100 S is
 * enough by itself. Near their limit symplectic methods conserve
 *   w^2 + square (1 - h^2 square / 4) s^2
 * (velocity-verlet on s'' = -square s, w = s'), so energy swings by (h w)^2/4 / (1 - (h w)^2/4)
 * of itself, without bound as h approaches its limit, and comes back.
 *
 * S is at least m c^2/20 with the mass m that can move and the scale of speed c, of half a
 * swing under gravity, c^2 = g L/pi^2 over the size L: what lifts all by L/200. What rests has
 * no energy to compare with, but errors of steps that are allowed: dopri5 at a tolerance of
 * 1e-3 makes 0.0002 of m c^2/2 in a second on a sheet that rests on a floor, and a step of h
 * that meets the floor at its end m (g h)^2/2. An unstable step passes any such bound within
 * frames. Without gravity c is the largest speed at the start; where that is 0 too, L per
 * second.
 *
 * W is the account of the run (run_host.h): what forces, ramps, corrections after steps and
 * events gave, each as far as it is positive between two samples.
 *
 * Local instability: a particle is faster than five times its speed at the start, what the
 * energy of its springs could give it, and a fall over the time passed (without gravity and
 * wind: five times c sqrt(0.1)), and the integrator has made half of its energy: a whip is as
 * fast, but takes its energy from the rest.
 *
 * Beyond cloth: a run may be stable and yet show what no cloth does. Springs or membranes, but
 * no network, are more than half longer than at rest, where woven cloth tears, unless
 * strain_limit allows more; a free particle is deeper in a collider than a thousandth of the
 * size; or one is faster than sound in air. */
#ifndef CS_ENERGY_MONITOR_H
#define CS_ENERGY_MONITOR_H

#include "session/table.h"
#include "sim/run_state.h"

#include "model/force/diagnostics.h"

/* X(name, word, letter of maps, colour of maps, what it means) from best to worst: green to red
 * for eyes of every kind, then violet and greys */
#define CS_STABILITY_LIST(X)                                                                   \
    X(CS_STABILITY_BOUNDED, "bounded", '.', 0x9fd3b5, "no sign of instability")                \
    X(CS_STABILITY_DAMPED, "over-damped", 'd', 0xa9c9e8,                                       \
      "stable, but the mean kinetic energy is below half of the reference's")                  \
    X(CS_STABILITY_BEYOND, "beyond cloth", 'c', 0xd5dc8a,                                      \
      "stable, but strained, deep in a collider or fast as no cloth is")                       \
    X(CS_STABILITY_SHORT, "not run to the end", '>', 0xe3f1e8,                                 \
      "no sign of instability in the steps that a cell may take, fewer than its time needs")   \
    X(CS_STABILITY_LOCAL, "local instability", 'l', 0xf6d365,                                  \
      "particles too fast, by energy of the integrator")                                       \
    X(CS_STABILITY_GLOBAL, "global instability", 'G', 0xe8825a,                                \
      "the integrator made more energy than the scene held and gave")                          \
    X(CS_STABILITY_NOT_FINITE, "not finite", 'X', 0x8e5c86,                                    \
      "a number of the state is not finite")                                                   \
    X(CS_STABILITY_FAILED, "solver failed", 'F', 0x7f858d,                                     \
      "the method failed and reported a reason")                                               \
    X(CS_STABILITY_OVER_BUDGET, "over budget", 'b', 0xdfe1e4,                                  \
      "the time allowed for a cell ran out")                                                   \
    X(CS_STABILITY_UNJUDGED, "not judged", '?', 0xf4f4f4,                                      \
      "there is no reference run to compare with")

enum cs_stability_verdict {
#define X(name, word, letter, colour, help) name,
    CS_STABILITY_LIST(X)
#undef X
        CS_STABILITY_VERDICTS
};

/* Word, explanation, letter and colour 0xRRGGBB of a verdict. */
const char *cs_stability_word(enum cs_stability_verdict verdict);
const char *cs_stability_help(enum cs_stability_verdict verdict);
char cs_stability_letter(enum cs_stability_verdict verdict);
uint32_t cs_stability_colour(enum cs_stability_verdict verdict);

/* True if the run shows no sign of instability. */
static inline bool cs_stability_is_stable(enum cs_stability_verdict verdict) {
    return verdict <= CS_STABILITY_BEYOND;
}

/* True for a stable run, and for one that was too short to be called stable. */
static inline bool cs_stability_is_sound(enum cs_stability_verdict verdict) {
    return cs_stability_is_stable(verdict) || verdict == CS_STABILITY_SHORT;
}

/* Figures and verdict of one sample. */
struct cs_energy_monitor_row {
    double t;
    struct cs_energy energy; /* J */
    double strain, speed;    /* largest */
    uint32_t particle;       /* the fastest */
    uint32_t particles;      /* faster than the limit */
    double speed_limit;      /* m/s */
    double made, bound;      /* J: by the integrator, and S of the head */
    double depth;            /* m, largest in a collider */
    /* BOUNDED, BEYOND, LOCAL, GLOBAL or NOT_FINITE, of this time alone */
    enum cs_stability_verdict verdict;
};

enum { CS_MONITOR_PEAKS = 64 };

/* Bounds of cloth: quantities of "beyond cloth" in the order of their text. */
enum cs_cloth_bound { CS_CLOTH_EXTENSION, CS_CLOTH_DEPTH, CS_CLOTH_SPEED, CS_CLOTH_BOUNDS };

/* The largest value of the samples, its time in s, and the bound. */
struct cs_cloth_peak {
    double value, t, bound;
};

/* State of the monitor. */
struct cs_energy_monitor {
    /* the balance, in J */
    double last_sample, last_total, last_given[CS_ENERGY_SOURCES];
    double balance, lowest;                 /* R, and its least value */
    double start_energy, gravity, released; /* at the start; most that gravity gave since */
    double input;                           /* W */
    double least;                           /* J/kg: least of S */
    /* largest `made` in each of the CS_MONITOR_PEAKS or fewer spans of `stride` samples */
    double peaks[CS_MONITOR_PEAKS];
    uint32_t n_samples, stride;
    bool may_swing; /* an explicit symplectic method: energy that it made may go again */
    /* the speeds; they restart after a frame with an event */
    double t_begin;      /* s */
    double start_speed;  /* m/s: largest, and what the springs at one particle could give it */
    double acceleration; /* m/s2, the largest by gravity, wind and viewpoint forces */
    double mass, wind_mass; /* kg that can move; sum of m a^2 in kg m2/s4, of outer forces */
    struct cs_cloth_peak cloth[CS_CLOTH_BOUNDS];
    /* the deepest gap between samples, its collider, and the largest stretch
     * (contact_samples.h) */
    double gap_depth, gap_stretch;
    uint32_t gap_collider;
    struct cs_energy_monitor_row first; /* when an instability began; verdict BOUNDED: none */
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

/* Adds "beyond cloth: ..." with each bound that was passed; nothing if none was. */
void cs_energy_monitor_print_beyond(const struct cs_energy_monitor *monitor,
                                    struct cs_text *out);

/* The columns of its CSV. */
extern const struct cs_column cs_energy_monitor_columns[];
extern const uint32_t cs_energy_monitor_n_columns;

/* Add the column names, and the CSV row of a sample. */
void cs_energy_monitor_print_head(struct cs_text *out);
void cs_energy_monitor_print_row(const struct cs_energy_monitor_row *row, uint32_t frame,
                                 struct cs_text *out);

#endif
