/* Finds steps without commit, numbers that are not finite, and pinned
 * particles that moved. */
#include "sim/run_host.h"

#include "base/vector.h"
#include "model/elastic/membrane_forces.h"
#include "model/event/event_state.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/system/shape_clusters.h"
#include "scene/body_pairs.h"
#include "scene/force_keys.h"

#include <clothsim/clones.h>
#include <math.h>

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

/* The first particle with a number in `rows` rows of n that is not finite, or n. 0 * x is 0 for
 * finite x, else NaN: the sum tests all numbers without a branch, and the loop below runs after
 * a failure only. */
static uint32_t find_not_finite(const struct cs_system *system, const double *numbers,
                                size_t rows) {
    const size_t n = system->view.n;
    double sum = 0;
    for (size_t k = 0; k < rows * n; k++)
        sum += 0 * numbers[k];
    uint32_t i = sum == 0 ? system->view.n : 0;
    for (; i < n; i++)
        for (size_t c = 0; c < rows; c++)
            if (!isfinite(numbers[c * n + i]))
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
    const uint32_t particle = find_not_finite(system, system->state, 6);
    if (particle < system->view.n) {
        cs_text_add(why, "after its last commit it left non-finite values in ");
        cs_system_print_particle(system, particle, why);
    } else if (sum_pins(system) != left->pins_hash)
        cs_text_add(why, "it moved a pinned particle");
    return !why->length;
}

/* Adds the cause: the first particle with such a right-hand side b (3,n), else what overflows
 * where all numbers of b are finite. */
static void print_not_finite(const struct cs_system *system, const double *b,
                             struct cs_text *why) {
    const uint32_t particle = find_not_finite(system, b, 3);
    if (particle < system->view.n) {
        cs_text_add(why, "a force is infinite or not a number at ");
        cs_system_print_particle(system, particle, why);
    } else
        cs_text_add(why, "a stiffness is infinite or not a number, or a sum overflows");
}

enum cs_step cs_run_host_fail_solve(struct cs_run_host *host, enum cs_linear_end end,
                                    const double *b, uint64_t iterations, double residual) {
    struct cs_text why = {0};
    if (end == CS_LINEAR_LIMIT)
        cs_text_add(&why,
                    "the linear solver stopped after %llu iterations at a residual of %.3g",
                    (unsigned long long)iterations, residual);
    else if (end == CS_LINEAR_INDEFINITE)
        cs_text_add(&why, "conjugate gradients broke down: p.Ap is not positive");
    else {
        cs_text_add(&why, "in the step from t = %.9g s the linear system has no solution: ",
                    host->advance_check.last_commit);
        print_not_finite(host->run->system, b, &why);
    }
    const enum cs_step step = host->table.fail(host, "%s", cs_text_get(&why));
    cs_text_finish(&why);
    return step;
}

/* Nominal s of a call, and of a spring in it. Tuned on ten shipped scenes with 48 to 3584
 * particles and seven methods, of one thread of a busy server of 2026: measured times lie
 * within a factor of 3. Other forces count as so many springs. */
#define CALL_SECONDS     1e-6
#define SPRING_SECONDS   2e-8
#define MEMBRANE_SPRINGS 10 /* a particle of elastic bodies, with its triangles and hinges */
#define PAIR_SPRINGS     24 /* a particle of bodies in contact with each other */
#define COLLIDER_SPRINGS 2
#define MATRIX_SPRINGS   25 /* a particle that bends, where the matrix of a solver is made */

double cs_pass_seconds(const struct cs_system *system) {
    double springs = 0, particle = 1 + COLLIDER_SPRINGS * (double)system->scene->colliders.n;
    for (uint32_t r = 0; r < system->springs.n_runs; r++)
        springs += system->springs.runs[r].count;
    particle += (system->membranes ? MEMBRANE_SPRINGS : 0) + (system->pairs ? PAIR_SPRINGS : 0);
    return CALL_SECONDS + SPRING_SECONDS * (springs + particle * system->view.n);
}

void cs_run_host_count(struct cs_run_host *host) {
    const struct cs_stats *before = &host->stats_before;
    const struct cs_integrator *integrator = host->run->integrator;
    struct cs_stats *found = &host->run->counts.method;
    if (!integrator->stats)
        return;
    *found = (struct cs_stats){.size = sizeof *found};
    integrator->stats(host->self, found);
    found->rejected += before->rejected;
    found->newton += before->newton;
    found->setups += before->setups;
    found->sweeps += before->sweeps;
    found->local_error += before->local_error;
}

double cs_run_host_work_seconds(const struct cs_run_host *host) {
    const struct cs_counts *counts = &host->run->counts;
    const struct cs_system *system = host->run->system;
    const double bent = system->bendings ? SPRING_SECONDS * MATRIX_SPRINGS * system->view.n : 0;
    return fmax((double)counts->steps, cs_counts_work(counts)) * host->pass_seconds +
           (double)counts->solve_setups * bent;
}

bool cs_run_host_end_over_budget(struct cs_run_host *host) {
    const struct cs_run_settings *settings = &host->settings;
    if (!(settings->budget > 0) && !settings->pot)
        return false;
    cs_run_host_count(host);
    const double work = cs_run_host_work_seconds(host);
    if (!(settings->budget > 0 && work > settings->budget) &&
        !(settings->pot && work > *settings->pot))
        return false;
    host->run->outcome = CS_OVER_BUDGET;
    return true;
}

/* Detects a blow-up; the bound is derived in run_host.h. */

/* The bound on kinetic energy at t, in J. */
static double energy_at(const struct cs_blow_up_check *check, double t) {
    const double pushed = check->force_gain + sqrt(check->force_rate) * (t - check->t_forces);
    return 100 * (check->start_energy + check->speed + pushed * pushed);
}

/* Sum of F^2 / m in J/s2, F the sum of the greatest forces that the terms can exert on a
 * particle. Forces that give none only convert energy that is there, or take it away. */
static double force_power_bound(const struct cs_system *system) {
    double sum = 0;
    for (size_t i = 0; i < system->view.n; i++) {
        double push = 0;
        for (uint32_t k = 0; k < system->n_terms; k++)
            if (system->terms[k]->max_acceleration)
                push += system->terms[k]->max_acceleration(system, i);
        sum += push * push / system->mass[i];
    }
    return sum;
}

void cs_blow_up_check_set(struct cs_blow_up_check *check, const struct cs_system *system,
                          double t) {
    const double *x = system->state, *v = x + 3 * (size_t)system->view.n;
    const struct cs_energy energy = cs_diagnostics_energy(system, t, x, v);
    const double speed = cs_scene_key_frame_speed(system->scene);
    *check = (struct cs_blow_up_check){
        .start_energy = energy.elastic + energy.other +
                        cs_springs_energy_at_twice(&system->springs) +
                        cs_membranes_energy(system, NULL) + cs_shape_clusters_energy(system),
        .speed = 2 * energy.kinetic,
        .force_rate = force_power_bound(system),
        .t_forces = t,
    };
    for (size_t i = 0; speed > 0 && i < system->view.n; i++)
        check->speed += 2 * system->mass[i] * speed * speed;
}

/* Continues the bound from t on with other forces: closes the piece before t, and takes the
 * larger rate of those now and at the end of the ramps. Leaves the values at t. */
static void continue_bound(struct cs_blow_up_check *check, struct cs_system *system, double t) {
    check->force_gain += sqrt(check->force_rate) * (t - check->t_forces);
    check->t_forces = t;
    check->force_rate = force_power_bound(system);
    cs_events_move_values(system, system->events->end);
    check->force_rate = fmax(check->force_rate, force_power_bound(system));
    cs_events_move_values(system, t);
}

/* Two bounds are made, with the values at the begin and at the end of the segment that begins,
 * and the larger energies and forces count: ramps are linear, and each force grows with its
 * value. The speed w of paths adds 2 m w^2 for every particle, since a grab may pull all along.
 */
void cs_blow_up_check_after_events(struct cs_blow_up_check *check, struct cs_system *system,
                                   double t) {
    struct cs_blow_up_check now;
    if (system->events->begin < t) {
        continue_bound(check, system, t);
        return;
    }
    cs_blow_up_check_set(&now, system, t);
    cs_events_move_values(system, system->events->end);
    cs_blow_up_check_set(check, system, t);
    cs_events_move_values(system, t);
    check->start_energy = fmax(check->start_energy, now.start_energy);
    check->force_rate = fmax(check->force_rate, now.force_rate);
    const double speed = cs_events_speed(system);
    for (size_t i = 0; i < system->view.n; i++)
        check->speed += 2 * system->mass[i] * speed * speed;
}

/* Four lanes of a sum, at any address. */
enum { LANES = 4 };
typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));
typedef double loaded
    __attribute__((vector_size(LANES * sizeof(double)), aligned(sizeof(double)), may_alias));
#define load(from) (*(const loaded *)(from))

/* The state to check, component-major. */
struct watched {
    size_t n;
    const double *mass, *x, *v;
};

/* Kinetic energy in J of the particles [begin, end); not finite if a position or velocity
 * there is not: s - s is 0 for a finite s = x + y + z, else NaN. In lanes, because it runs
 * after every step. */
CS_CLONES static double watch_part(const void *arg, size_t begin, size_t end) {
    const struct watched *watched = arg;
    const size_t n = watched->n;
    const double *mass = watched->mass, *x = watched->x, *v = watched->v;
    lanes e = {0}, p = {0};
    size_t i = begin;
    for (; i + LANES <= end; i += LANES) {
        const lanes a = load(v + i), b = load(v + n + i), c = load(v + 2 * n + i);
        const lanes sum = load(x + i) + load(x + n + i) + load(x + 2 * n + i);
        e += load(mass + i) * (a * a + b * b + c * c);
        p += sum - sum;
    }
    double energy = e[0] + e[1] + e[2] + e[3], places = p[0] + p[1] + p[2] + p[3];
    for (; i < end; i++) {
        const double sum = x[i] + x[n + i] + x[2 * n + i];
        energy += mass[i] * (v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i]);
        places += sum - sum;
    }
    return 0.5 * energy + places;
}

/* Kinetic energy decides: a number that is not finite anywhere makes it so. */
bool cs_blow_up_check_step(const struct cs_blow_up_check *check, struct cs_run *run, double t,
                           const double *x, const double *v) {
    const size_t n = run->system->view.n;
    const struct watched watched = {n, run->system->mass, x, v};
    const double energy = cs_vector_sum(n, watch_part, &watched), most = energy_at(check, t);
    // NaN is not <= most
    if (energy <= most)
        return false;

    /* report the first particle that is not finite, else the fastest */
    uint32_t worst = 0;
    double fastest = -1;
    run->outcome = CS_UNBOUNDED;
    for (size_t i = 0; i < n && run->outcome == CS_UNBOUNDED; i++) {
        const double speed = v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i];
        const double place = x[i] + x[n + i] + x[2 * n + i];
        if (speed > fastest || !isfinite(speed + place)) {
            fastest = speed;
            worst = (uint32_t)i;
        }
        if (!isfinite(speed + place))
            run->outcome = CS_NOT_FINITE;
    }
    run->blow_up = (struct cs_blow_up){t, worst, energy, most};
    return true;
}

/* m/s, without gravity and motion: l per second. Where nothing can move the scene either,
 * errors of that tolerance would: a sheet of 1 m was stretched by 8 % within 10 s. Then, with
 * strains below 1e-6, l per 1000 s. */
static double scale_at_rest(const struct cs_run_host *host, double length) {
    const struct cs_system *system = host->run->system;
    const struct cs_energy energy =
        cs_diagnostics_energy(system, 0, system->state, host->run->v);
    const double least = 1e-12 * host->blow_up.start_energy;
    const bool moves = host->table.forces_depend_on_time || system->scene->forces->wind.present;
    return moves || fabs(energy.elastic) + fabs(energy.other) >= least ? length : 1e-3 * length;
}

/* Half a swing of a pendulum of that length tells the time, pi sqrt(l/g); without gravity the
 * fastest particle does. */
void cs_run_host_set_scales(struct cs_run_host *host) {
    const struct cs_view *view = &host->run->system->view;
    const double *g = host->run->system->scene->forces->gravity, *v = host->run->v;
    double length = 0, squared = 0;
    for (size_t c = 0; c < 3; c++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (size_t i = c * view->n; i < (c + 1) * view->n; i++) {
            low = fmin(low, view->start[i]);
            high = fmax(high, view->start[i]);
        }
        length = fmax(length, high - low);
    }
    length = length > 0 ? length : 1;
    for (size_t i = 0, n = view->n; i < n; i++)
        squared =
            fmax(squared, v[i] * v[i] + v[n + i] * v[n + i] + v[2 * n + i] * v[2 * n + i]);
    const double gravity = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    const double pi = 3.141592653589793, fall = sqrt(gravity * length) / pi;
    host->table.length_scale = length;
    host->table.speed_scale = gravity > 0   ? fall
                              : squared > 0 ? sqrt(squared)
                                            : scale_at_rest(host, length);
}

/* Frames a second up to which steps end at frames where contact by force or events act. That
 * costs 6 % at most, and a frame is then the end of a step that was judged, not within one. */
#define PASSED_FPS 60

void cs_run_host_set_overstep(struct cs_run_host *host) {
    const struct cs_system *system = host->run->system;
    const struct cs_plan_row *rows = system->plan.rows;
    const bool corrects =
        rows[CS_FEATURE_VELOCITY_LOSS].built || rows[CS_FEATURE_CONTACT].built ||
        rows[CS_FEATURE_STRAIN_LIMIT].built || rows[CS_FEATURE_FRICTION_ANCHORS].built ||
        cs_scene_crossings(system->scene) == CS_CROSSINGS_STOP;
    const bool acts = cs_step_limit_applies(system) || rows[CS_FEATURE_EVENTS].built;
    host->table.may_overstep = !corrects && !acts;
    if (!corrects && (!acts || system->scene->time.fps > PASSED_FPS))
        host->table.overstep_until = HUGE_VAL;
}

/* --- trace points --- */

void cs_trace_emit(const struct cs_run_host *host, const struct cs_trace_record *named,
                   double t, const double *values, size_t n) {
    const struct cs_trace *trace = host->settings.trace;
    struct cs_trace_record record = *named;
    record.frame = host->run->frame + 1;
    record.step = host->run->counts.steps;
    record.t = t;
    record.values = values;
    record.n = n;
    trace->emit(trace->ctx, &record);
}
