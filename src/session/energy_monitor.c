/* Judges by the balance of energy whether a run is sound; the header derives the bounds. */
#include "session/energy_monitor.h"

#include "base/vec3.h"
#include "model/contact/contact_samples.h"
#include "model/contact/posed_collider.h"
#include "model/event/event_state.h"
#include "model/event/events.h"
#include "model/force/terms.h"
#include "scene/body_keys.h"
#include "scene/body_pairs.h"
#include "scene/force_keys.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Limit of a particle's speed over what it may reach. */
#define SPEED_FACTOR 5
/* Ratio of the fastest particle to the root mean square speed of all in sound motions. */
#define SPEED_SPREAD 4
#define LEAST_ENERGY 1e-12
#define LEAST_SPEED  1e-6
/* Energy that was made counts from so many samples on, else only beyond so many times the
 * bound. */
enum { SAMPLES_MIN = 8, FAR_BEYOND = 100 };
/* Fraction of m c^2/2 with the scene's scale of speed c that nothing but errors of steps makes.
 */
#define LEAST_FRACTION 0.1

/* Bounds of "beyond cloth": strain, depth over the scene's size, and speed in m/s (of sound in
 * air at 15 degrees Celsius). Woven cloth tears at strains of 0.1 to 0.5. */
#define EXTENSION_MAX 0.5
#define DEPTH_MAX     1e-3
#define SPEED_MAX     340

static const struct {
    const char *word, *help;
    char letter;
    uint32_t colour;
} verdicts[] = {
#define X(name, word, letter, colour, help) [name] = {word, help, letter, colour},
    CS_STABILITY_LIST(X)
#undef X
};

const char *cs_stability_word(enum cs_stability_verdict verdict) {
    return verdicts[verdict].word;
}

const char *cs_stability_help(enum cs_stability_verdict verdict) {
    return verdicts[verdict].help;
}

char cs_stability_letter(enum cs_stability_verdict verdict) {
    return verdicts[verdict].letter;
}

uint32_t cs_stability_colour(enum cs_stability_verdict verdict) {
    return verdicts[verdict].colour;
}

/* Largest speed in m/s that the springs at one particle could give it: sqrt(2 E / m) with the
 * elastic energy E of all its springs. CS_ERR_MEMORY. */
static enum cs_status spring_speed(const struct cs_run *run, double *speed,
                                   struct cs_error *error) {
    const struct cs_system *system = run->system;
    const size_t n = system->view.n;
    double *stored = calloc(n, sizeof *stored);
    if (!stored)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for %zu particles", n);
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *s = system->springs.runs + r;
        for (uint32_t i = 0; i < s->count; i++) {
            const uint32_t a = cs_spring_a(s, i), b = cs_spring_b(s, i);
            const double stretch =
                cs_vec3_distance_at(run->x, n, a, b) - cs_spring_length(s, i);
            const double energy = 0.5 * cs_spring_stiffness(s, i) * stretch * stretch;
            /* the whole energy at both ends: either particle may get all of it */
            stored[a] += energy;
            stored[b] += energy;
        }
    }
    double squared = 0;
    for (size_t i = 0; i < n; i++)
        squared = fmax(squared, 2 * stored[i] * system->inv_mass[i]);
    *speed = sqrt(squared);
    free(stored);
    return CS_OK;
}

/* Largest acceleration in m/s2 of particle i by forces that have an energy (gravity), or by the
 * others (wind). */
static double force_acceleration(const struct cs_system *system, size_t i, bool with_energy) {
    double push = 0;
    for (uint32_t k = 0; k < system->n_terms; k++) {
        const struct cs_term *term = system->terms[k];
        if (term->max_acceleration && !!term->energy == with_energy)
            push += term->max_acceleration(system, i) * system->inv_mass[i];
    }
    return push;
}

/* Largest acceleration in m/s2 by viewpoint forces, as if the particle were visible to all. */
static double visible_force(const struct cs_system *system, size_t i) {
    const struct cs_events *events = system->events;
    return events && events->viewpoint_forces
               ? cs_viewpoint_forces_force(events->viewpoint_forces, system->scene) *
                     system->inv_mass[i]
               : 0;
}

/* Restarts the limit of speed from the present state. wind_mass is sum m a^2 in kg m2/s4. */
static void start_speeds(struct cs_energy_monitor *monitor, const struct cs_run *run) {
    const struct cs_system *system = run->system;
    uint32_t particle, count;
    double falls = 0, pushes = 0;
    monitor->t_begin = run->t;
    monitor->start_speed = fmax(monitor->start_speed,
                                cs_measure_speed(system, run->v, HUGE_VAL, &particle, &count));
    monitor->mass = monitor->wind_mass = 0;
    for (size_t i = 0; i < system->view.n; i++) {
        /* pinned particles do not move, whatever pushes them */
        if (system->inv_mass[i] <= 0)
            continue;
        const double push = force_acceleration(system, i, false) + visible_force(system, i);
        falls = fmax(falls, force_acceleration(system, i, true));
        pushes = fmax(pushes, push);
        monitor->mass += system->mass[i];
        monitor->wind_mass += system->mass[i] * push * push;
    }
    monitor->acceleration = falls + pushes;
}

enum cs_status cs_energy_monitor_begin(struct cs_energy_monitor *monitor,
                                       const struct cs_run *run, struct cs_error *error) {
    const struct cs_energy energy = cs_diagnostics_energy(run->system, run->t, run->x, run->v);
    double speed = 0;
    *monitor = (struct cs_energy_monitor){
        .stride = 1,
        .may_swing = (run->integrator->traits & (CS_SYMPLECTIC | CS_IMPLICIT)) == CS_SYMPLECTIC,
        .cloth = {{.bound = EXTENSION_MAX},
                  {.bound = DEPTH_MAX * cs_run_calls(run)->length_scale},
                  {.bound = SPEED_MAX}}};
    double *const extension = &monitor->cloth[CS_CLOTH_EXTENSION].bound;
    for (uint32_t b = 0; b < run->system->scene->bodies.n; b++) // no limit is NAN
        *extension = fmax(*extension, cs_scene_bodies(run->system->scene)[b].strain_limit - 1);
    if (spring_speed(run, &speed, error))
        return error->status;
    start_speeds(monitor, run);
    const struct cs_host *host = cs_run_calls(run);
    const bool rests =
        cs_vec3_is_zero(run->system->scene->forces->gravity) && energy.kinetic <= 0;
    const double c = rests ? host->length_scale : host->speed_scale;
    monitor->start_speed += speed;
    monitor->least = 0.5 * LEAST_FRACTION * c * c;
    monitor->last_sample = run->t;
    monitor->last_total = cs_energy_total(&energy);
    memcpy(monitor->last_given, run->energy_input.given, sizeof monitor->last_given);
    monitor->start_energy = cs_energy_without_gravity(&energy);
    monitor->gravity = energy.gravity;
    return CS_OK;
}

/* True if an event since the last sample may have added energy. */
static bool has_event_since(const struct cs_energy_monitor *monitor, const struct cs_run *run) {
    const struct cs_events *events = run->system->events;
    if (cs_scene_has_key_frames(run->system->scene))
        return true;
    return events && (events->begin >= monitor->last_sample || events->has_ramps ||
                      cs_events_speed(run->system) > 0);
}

/* S of the head, in J. */
static double bound_of(const struct cs_energy_monitor *monitor) {
    return fmax(monitor->start_energy + monitor->released + monitor->input,
                fmax(monitor->mass * monitor->least, LEAST_ENERGY));
}

/* W in J since the last sample: what each kind gave. One that took energy gave nothing. */
static double find_input(struct cs_energy_monitor *monitor, const struct cs_run *run) {
    double input = 0;
    for (int k = 0; k < CS_ENERGY_SOURCES; k++) {
        input += fmax(run->energy_input.given[k] - monitor->last_given[k], 0);
        monitor->last_given[k] = run->energy_input.given[k];
    }
    return input;
}

/* Adds the interval since the last sample to the balance. */
static void balance(struct cs_energy_monitor *monitor, const struct cs_run *run,
                    struct cs_energy_monitor_row *row) {
    const double total = cs_energy_total(&row->energy), input = find_input(monitor, run);
    monitor->released = fmax(monitor->released, monitor->gravity - row->energy.gravity);
    monitor->input += input;
    monitor->balance += total - monitor->last_total - input;
    monitor->lowest = fmin(monitor->lowest, monitor->balance);
    row->made = monitor->balance - monitor->lowest;
    row->bound = bound_of(monitor);
    monitor->last_sample = run->t;
    monitor->last_total = total;
}

/* Stores what was made; halves the resolution if the array is full. Returns whether there are
 * enough samples and, where energy may swing, it is half more than ever in the first half. */
static bool has_lasted(struct cs_energy_monitor *monitor, double made) {
    double *peaks = monitor->peaks, before = 0;
    if (monitor->n_samples / monitor->stride == CS_MONITOR_PEAKS) {
        for (uint32_t k = 0; k < CS_MONITOR_PEAKS / 2; k++) {
            peaks[k] = fmax(peaks[2 * k], peaks[2 * k + 1]);
            peaks[CS_MONITOR_PEAKS / 2 + k] = 0;
        }
        monitor->stride *= 2;
    }
    const uint32_t now = monitor->n_samples++ / monitor->stride;
    peaks[now] = fmax(peaks[now], made);
    for (uint32_t k = 0; k < now / 2; k++)
        before = fmax(before, peaks[k]);
    return monitor->n_samples >= SAMPLES_MIN && (!monitor->may_swing || made > 1.5 * before);
}

/* Largest speed in m/s that counts as sound: what gravity and outer forces can have added is at
 * most a few times the mean that the energy allows. */
static double limit_of_speed(const struct cs_energy_monitor *monitor,
                             const struct cs_run *run) {
    const double mean = monitor->mass > 0 ? sqrt(2 * bound_of(monitor) / monitor->mass) : 0;
    const double fall =
        fmin(monitor->acceleration * (run->t - monitor->t_begin), SPEED_SPREAD * mean);
    /* nothing pulls: only the least energy tells a speed */
    const double least = monitor->acceleration > 0 ? LEAST_SPEED : sqrt(2 * monitor->least);
    return SPEED_FACTOR * fmax(monitor->start_speed + fall, least);
}

/* Stores the sample's largest extension, depth and speed, if they are larger than before;
 * returns whether one is beyond its bound. Compression makes an extension superfluous. */
static bool is_beyond_cloth(struct cs_energy_monitor *monitor, const struct cs_run *run,
                            const struct cs_energy_monitor_row *row) {
    struct cs_cloth_peak *cloth = monitor->cloth;
    const double extension = row->strain > cloth[CS_CLOTH_EXTENSION].bound
                                 ? cs_diagnostics_extension(run->system, run->x)
                                 : 0;
    const double values[CS_CLOTH_BOUNDS] = {extension, row->depth, row->speed};
    bool beyond = false;
    for (int k = 0; k < CS_CLOTH_BOUNDS; k++) {
        if (values[k] > cloth[k].value)
            cloth[k] = (struct cs_cloth_peak){values[k], row->t, cloth[k].bound};
        beyond |= values[k] > cloth[k].bound;
    }
    return beyond;
}

/* A fast particle is no instability unless the integrator has made half of its energy. */
static void judge(struct cs_energy_monitor *monitor, double mass, bool beyond,
                  struct cs_energy_monitor_row *row) {
    const bool counts = has_lasted(monitor, row->made) || row->made > FAR_BEYOND * row->bound;
    /* first, because no comparison with NAN is true */
    if (!isfinite(cs_energy_total(&row->energy) + row->speed + row->strain))
        row->verdict = CS_STABILITY_NOT_FINITE;
    else if (row->made > row->bound && counts)
        row->verdict = CS_STABILITY_GLOBAL;
    else if (row->particles && row->made > 0.25 * mass * row->speed * row->speed)
        row->verdict = CS_STABILITY_LOCAL;
    else if (beyond)
        row->verdict = CS_STABILITY_BEYOND;
    if (row->verdict > monitor->worst_verdict) {
        monitor->worst_verdict = row->verdict;
        if (!cs_stability_is_stable(row->verdict) &&
            monitor->first.verdict == CS_STABILITY_BOUNDED)
            monitor->first = *row;
    }
}

void cs_energy_monitor_sample(struct cs_energy_monitor *monitor, const struct cs_run *run,
                              struct cs_energy_monitor_row *row) {
    const struct cs_system *system = run->system;
    const bool with_event = has_event_since(monitor, run);
    *row = (struct cs_energy_monitor_row){.t = run->t};
    row->energy = cs_diagnostics_energy(system, run->t, run->x, run->v);
    row->strain = cs_diagnostics_strain(system, run->x);
    const struct cs_outgrown_samples gap =
        cs_contact_samples_find_outgrown(system, run->t, run->x);
    row->depth = fmax(cs_posed_colliders_depth(system, run->t, run->x), gap.depth);
    if (gap.depth > monitor->gap_depth)
        monitor->gap_depth = gap.depth, monitor->gap_collider = gap.collider;
    monitor->gap_stretch = fmax(monitor->gap_stretch, gap.stretch);
    balance(monitor, run, row);
    /* no bound of speed holds after an event has added energy */
    if (with_event)
        start_speeds(monitor, run);
    row->speed_limit = limit_of_speed(monitor, run);
    row->speed =
        cs_measure_speed(system, run->v, row->speed_limit, &row->particle, &row->particles);
    judge(monitor, system->mass[row->particle], is_beyond_cloth(monitor, run, row), row);
}

void cs_energy_monitor_print_beyond(const struct cs_energy_monitor *monitor,
                                    struct cs_text *out) {
    static const char *const words[CS_CLOTH_BOUNDS][2] = {
        {"stretched by ", " of the rest length"},
        {"", " m deep in a collider"},
        {"moving at ", " m/s"}};
    int printed = 0;
    for (int k = 0; k < CS_CLOTH_BOUNDS; k++) {
        const struct cs_cloth_peak *peak = monitor->cloth + k;
        if (peak->value > peak->bound)
            cs_text_add(out, "%s%s%.3g%s at t = %.6g s, bound %.3g",
                        printed++ ? "; " : "beyond cloth: ", words[k][0], peak->value,
                        words[k][1], peak->t, peak->bound);
    }
}

void cs_energy_monitor_print(const struct cs_energy_monitor *monitor,
                             const struct cs_system *system, struct cs_text *out) {
    const struct cs_energy_monitor_row *first = &monitor->first;
    if (first->verdict == CS_STABILITY_BOUNDED)
        return;
    cs_text_add(out, "%s from t = %.6g s on: ", cs_stability_word(first->verdict), first->t);
    if (first->verdict == CS_STABILITY_GLOBAL)
        cs_text_add(out, "the integrator made %.3g J, the scene held and gave %.3g J; fastest ",
                    first->made, first->bound);
    else
        cs_text_add(out, "%u particle%s, the fastest ", first->particles,
                    first->particles == 1 ? "" : "s");
    cs_system_print_particle(system, first->particle, out);
    cs_text_add(out, " at %.3g m/s", first->speed);
    if (first->verdict == CS_STABILITY_LOCAL)
        cs_text_add(out, ", above the limit of %.3g m/s; the integrator made %.3g J",
                    first->speed_limit, first->made);
    if (monitor->worst_verdict > first->verdict)
        cs_text_add(out, "; later %s", cs_stability_word(monitor->worst_verdict));
}

const struct cs_column cs_energy_monitor_columns[] = {
    CS_NUMBER_COLUMN("frame", "1", "number of the frame; 0: the start"),
    CS_NUMBER_COLUMN("t", "s", "simulated time"),
    CS_NUMBER_COLUMN("kinetic", "J", "kinetic energy"),
    CS_NUMBER_COLUMN("elastic", "J", "elastic energy"),
    CS_NUMBER_COLUMN("gravity", "J", "potential energy of gravity"),
    CS_NUMBER_COLUMN("energy", "J", "energy: all kinds"),
    CS_NUMBER_COLUMN("largest_strain", "1", "largest strain of a spring"),
    CS_NUMBER_COLUMN("largest_velocity", "m/s", "largest speed of a particle"),
    CS_NUMBER_COLUMN("particle", "1", "index of the fastest particle"),
    CS_NUMBER_COLUMN("fast_particles", "1", "particles above the limit of local instability"),
    CS_TEXT_COLUMN("verdict", "verdict of this time, as of clothsim-stability(1)"),
    CS_NUMBER_COLUMN("made", "J", "energy made by the integrator"),
    CS_NUMBER_COLUMN("bound", "J", "energy above which it is a global instability"),
    CS_NUMBER_COLUMN(
        "largest_depth", "m",
        "largest depth in a collider: of particles, and of triangles that outgrew their "
        "contact samples"),
};
const uint32_t cs_energy_monitor_n_columns =
    sizeof cs_energy_monitor_columns / sizeof *cs_energy_monitor_columns;

void cs_energy_monitor_print_head(struct cs_text *out) {
    cs_columns_add_names(cs_energy_monitor_columns, cs_energy_monitor_n_columns, out);
    cs_text_add(out, "\n");
}

void cs_energy_monitor_print_row(const struct cs_energy_monitor_row *row, uint32_t frame,
                                 struct cs_text *out) {
    const struct cs_energy *energy = &row->energy;
    const double values[] = {row->t,          energy->kinetic,         energy->elastic,
                             energy->gravity, cs_energy_total(energy), row->strain,
                             row->speed};
    cs_text_add(out, "%u", frame);
    for (size_t k = 0; k < sizeof values / sizeof *values; k++)
        cs_csv_add_number(out, values[k]);
    cs_text_add(out, ",%u,%u,%s", row->particle, row->particles,
                cs_stability_word(row->verdict));
    cs_csv_add_number(out, row->made);
    cs_csv_add_number(out, row->bound);
    cs_csv_add_number(out, row->depth);
    cs_text_add(out, "\n");
}
