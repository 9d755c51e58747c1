/* The loop over the frames of a session, and what studies ask of its system. */
#include "session/session.h"

#include "base/clock.h"
#include "model/elastic/membranes.h"
#include "model/force/terms.h"
#include "scene/body_particles.h"
#include "scene/contact_keys.h"
#include "scene/elastic_keys.h"
#include "scene/force_keys.h"

#include <math.h>
#include <stdio.h>

bool cs_follow_next(struct cs_follow *follow, struct cs_error *error) {
    struct cs_run *run = follow->run;
    const uint32_t from = run->frame, every = follow->every;
    const uint64_t stop = every ? ((uint64_t)(from / every) + 1) * every : UINT64_MAX;
    const double cpu = cs_clock_cpu(), wall = cs_clock_wall();
    if (follow->at_start) {
        follow->at_start = false;
        return true;
    }
    while (run->frame < stop && run->frame < follow->last && run->outcome == CS_RUNNING &&
           !error->status)
        cs_run_frame(run, error);
    follow->cpu += cs_clock_cpu() - cpu;
    follow->wall += cs_clock_wall() - wall;
    return run->frame == stop && run->outcome == CS_RUNNING && !error->status;
}

/* Only an interruption adds an error here; every other error stays as it is. */
enum cs_status cs_follow_check(const struct cs_run *run, const char *interrupted,
                               struct cs_error *error) {
    if (run->outcome == CS_INTERRUPTED)
        cs_fail(error, CS_ERR_INTERRUPT, "interrupted%s", interrupted);
    return error->status;
}

enum cs_status cs_follow_result(const struct cs_run *run, const char *interrupted,
                                struct cs_run_result *result, struct cs_error *error) {
    // a process that was changed must not go on with other runs
    const bool failed = error->status == CS_ERR_MODULE && !run->is_process_changed;
    const char *text = run->reason ? run->reason : cs_outcome_text(run->outcome);
    *result = (struct cs_run_result){
        .outcome = failed ? CS_FAILED : run->outcome,
        .reached = run->t,
        .time = cs_outcome_is_blow_up(run->outcome) ? run->blow_up.time : run->t};
    if (run->outcome == CS_OVER_BUDGET)
        snprintf(result->message, sizeof result->message,
                 "%s after %.4g passes over the forces, at t = %.4g s", text,
                 cs_counts_work(&run->counts), run->t);
    else
        snprintf(result->message, sizeof result->message, "%s", failed ? error->message : text);
    if (failed)
        *error = (struct cs_error){0};
    return cs_follow_check(run, interrupted, error);
}

double cs_follow_frames(const struct cs_scene *scene, double seconds) {
    // a product that is whole but for rounding takes no frame more
    return ceil(seconds * scene->time.fps * (1 - 1e-9));
}

bool cs_system_untangles(const struct cs_system *system) {
    return system->scene->contact->untangle > 0;
}

bool cs_system_damps_contact(const struct cs_system *system) {
    return system->scene->contact->damping > 0;
}

bool cs_system_bends(const struct cs_system *system) {
    return system->bendings;
}

double cs_system_longest_spring(const struct cs_system *system) {
    double length = 0;
    for (uint32_t r = 0; r < system->springs.n_runs; r++)
        for (uint32_t i = 0; i < system->springs.runs[r].count; i++)
            length = fmax(length, cs_spring_length(system->springs.runs + r, i));
    return length;
}

void cs_system_print_marks(const struct cs_system *system, uint32_t particle,
                           struct cs_text *out) {
    const uint32_t b = cs_system_body_of(system, particle), first = system->bodies[b].first;
    cs_text_add(out, "{\"body\": %u, \"particles\": [%u", b, particle - first);
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; run->kind != CS_SPRING_BEND && i < run->count; i++) {
            const uint32_t from = cs_spring_a(run, i), to = cs_spring_b(run, i);
            if (from == particle || to == particle)
                cs_text_add(out, ", %u", (from == particle ? to : from) - first);
        }
    }
    cs_text_add(out, "]}");
}

void cs_system_elastic_force(const struct cs_system *system, const double *x, const double *v,
                             double *f) {
    const struct cs_eval at = {.x = x, .v = v, .parts = CS_PART_SPRINGS | CS_PART_ELASTIC};
    cs_terms_force(system, &at, f);
}

const char *cs_system_force(uint32_t k, const char *const **keys) {
    *keys = k < cs_n_terms ? cs_terms[k]->rampable_keys : NULL;
    return k < cs_n_terms ? cs_terms[k]->name : NULL;
}

/* Mass of a body over its area, in kg/m2. */
static double density_of(const struct cs_system *system, uint32_t body) {
    const struct cs_body_range *range = system->bodies + body;
    double mass = 0, area = 0;
    for (uint32_t i = 0; i < range->count; i++) {
        mass += system->mass[range->first + i];
        area += cs_body_area(cs_scene_body(system->scene, body), i);
    }
    return mass / area;
}

void cs_system_print_elastic(const struct cs_system *system, struct cs_text *out) {
    const double *g = system->scene->forces->gravity, dt = 1 / system->scene->time.fps;
    const double weight = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    for (uint32_t k = 0; system->membranes && k < system->membranes->n; k++) {
        const struct cs_membrane *membrane = system->membranes->bodies + k;
        const struct cs_elastic *elastic = cs_scene_elastic(system->scene, membrane->body);
        const struct cs_moduli Y = cs_membrane_moduli(elastic), D = cs_bending_moduli(elastic);
        const double density = density_of(system, membrane->body), h = membrane->shortest;
        const double bends = fmax(D.warp, D.weft);
        cs_text_add(out,
                    "bodies[%u]: Y dt^2/(rho h^2) = %.3g for a frame and the shortest edge",
                    membrane->body, fmax(Y.warp, Y.weft) * dt * dt / (density * h * h));
        if (bends > 0)
            cs_text_add(out, ", D dt^2/(rho h^4) = %.3g",
                        bends * dt * dt / (density * h * h * h * h));
        if (bends > 0 && weight > 0)
            cs_text_add(out, "; bending length (D/(rho g))^(1/3) = %.3g m",
                        cbrt(bends / (density * weight)));
        cs_text_add(out, "\n");
    }
}
