/* Functions of a built system: sets masses, names a particle, frees the memory. */
#include "model/system/particle_system.h"

#include "scene/body_keys.h"
#include "scene/body_particles.h"

#include <math.h>
#include <string.h>

/* Adds to degree (n) the number of springs at each particle. */
static void count_degrees(const struct cs_system *system, double *degree) {
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *run = system->springs.runs + r;
        for (uint32_t i = 0; i < run->count; i++) {
            degree[cs_spring_a(run, i)]++;
            degree[cs_spring_b(run, i)]++;
        }
    }
}

/* A body's mass is given per particle, in total, per spring at a particle, or per area.
 * cs_scene_check has refused particles of mass 0. */
void cs_system_set_masses(struct cs_system *system) {
    const struct cs_body *bodies = cs_scene_bodies(system->scene);
    memset(system->mass, 0, system->view.n * sizeof *system->mass);
    /* the masses hold degrees until each body has set its own */
    count_degrees(system, system->mass);
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_mass *mass = &bodies[b].mass;
        const struct cs_body_range *range = system->bodies + b;
        for (uint32_t i = 0; i < range->count; i++) {
            double *m = system->mass + range->first + i;
            if (!isnan(mass->particle))
                *m = mass->particle;
            else if (!isnan(mass->total))
                *m = mass->total / range->count;
            else if (!isnan(mass->degree))
                *m *= mass->degree;
            else
                *m = mass->areal_density * cs_body_area(bodies + b, i);
        }
    }
    for (uint32_t i = 0; i < system->view.n; i++)
        if (system->inv_mass[i] > 0)
            system->inv_mass[i] = 1 / system->mass[i];
}

void cs_system_finish(struct cs_system *system) {
    cs_arena_finish(&system->arena);
    *system = (struct cs_system){0};
}

void cs_system_print_particle(const struct cs_system *system, uint32_t particle,
                              struct cs_text *out) {
    cs_text_add(out, "particle %u", particle);
    for (uint32_t b = 0; b < system->scene->bodies.n; b++) {
        const struct cs_body_range *range = system->bodies + b;
        const uint32_t local = particle - range->first;
        if (particle < range->first || local >= range->count)
            continue;
        if (range->mesh)
            cs_text_add(out, " (body %u, vertex %u)", b, local);
        else
            cs_text_add(out, " (body %u, column %u, row %u)", b, local % range->columns,
                        local / range->columns);
    }
}
