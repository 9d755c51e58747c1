/* Looks at the start of a scene for what will go wrong. Each check adds lines to the text of
 * its weight, or none; all of them are run. */
#include "session/session.h"

#include "base/options.h"
#include "base/vec3.h"
#include "model/contact/posed_collider.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "scene/body_keys.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"
#include "scene/mesh_keys.h"
#include "session/scene_findings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Energy at the start over all that can come later, from which on it is reported: a factor of 3
 * in speed. */
#define STORED_MAX 10.0
/* Static strain of the springs at pins that is reported, and that the proposed cure has.
 */
#define STRAIN_MAX    0.2
#define STRAIN_WANTED 0.1
/* Mean static strain beside colliders that is reported: sheets of 7 m that fall on a sphere
 * pass "beyond cloth" with 0.08, of 5 m with 0.056 not. */
#define CARRIED_MAX 0.07
/* Distance from a plane over the size, below which a body is flat. */
#define FLAT 1e-12
/* kg/m2 below which a mesh of edges over 0.1 m is taken for one in other units. The lightest
 * silk has 0.01 kg/m2. */
#define DENSITY_MIN 1e-3
/* Shortest edge over the mean edge of a mesh that is reported: the range of contact follows the
 * first, and its strain is the largest. */
#define SHORT_EDGE 0.01

/* --- stored energy --- */

/* m, diagonal of the box of all particles and bounded colliders at the start. */
static double size_of(const struct cs_system *system) {
    double low[3], high[3];
    cs_findings_box_of(system->state, system->view.n, system->view.n, low, high);
    for (uint32_t k = 0; k < system->scene->colliders.n; k++) {
        struct cs_posed_collider collider;
        cs_posed_collider_at(system, k, 0, &collider);
        cs_vec3_extend_box(low, high, collider.centre, 0);
    }
    return cs_vec3_distance(high, low);
}

/* J that impacts give the whole scene if it is at rest; HUGE_VAL where work has no bound. */
static double event_energy(const struct cs_system *system, double mass) {
    const struct cs_scene *scene = system->scene;
    double energy = scene->forces->wind.present ? HUGE_VAL : 0;
    for (uint32_t e = 0; e < scene->events.n; e++) {
        const struct cs_event *event = cs_scene_events(scene) + e;
        if (event->impact.present)
            energy += event->impact.impulse * event->impact.impulse / (2 * mass);
        else if (!event->pin.present && !event->release.present)
            energy = HUGE_VAL;
    }
    return energy;
}

/* J that motion, gravity and events can give within the scene's size. */
static double energy_to_come(const struct cs_system *system, const struct cs_energy *start) {
    double mass = 0;
    for (uint32_t i = 0; i < system->view.n; i++)
        mass += system->inv_mass[i] > 0 ? system->mass[i] : 0;
    return start->kinetic +
           mass * cs_vec3_length(system->scene->forces->gravity) * size_of(system) +
           event_energy(system, mass);
}

/* J that springs release at once: where forces balance, as in a stretched drum, nothing. Each
 * particle by itself yields |f|^2/(2 k) with k the sum of its springs. */
static double released_energy(const struct cs_system *system) {
    const size_t n = system->view.n;
    const double *x = system->state;
    double energy = 0;
    double *f = calloc(4 * n + 1, sizeof *f); // (3,n) forces, (n) stiffnesses
    for (uint32_t r = 0; f && r < system->springs.n_runs; r++) {
        const struct cs_spring_run *s = system->springs.runs + r;
        for (uint32_t i = 0; i < s->count; i++) {
            const uint32_t a = cs_spring_a(s, i), b = cs_spring_b(s, i);
            const double d[3] = {x[b] - x[a], x[n + b] - x[n + a], x[2 * n + b] - x[2 * n + a]};
            const double l = cs_vec3_length(d), k = cs_spring_stiffness(s, i);
            for (size_t c = 0; c < 3 && l > 0; c++) {
                const double push = k * (l - cs_spring_length(s, i)) * d[c] / l;
                f[c * n + a] += push;
                f[c * n + b] -= push;
            }
            f[3 * n + a] += k;
            f[3 * n + b] += k;
        }
    }
    for (size_t i = 0; f && i < n; i++)
        if (system->inv_mass[i] > 0 && f[3 * n + i] > 0)
            energy += (f[i] * f[i] + f[n + i] * f[n + i] + f[2 * n + i] * f[2 * n + i]) /
                      (2 * f[3 * n + i]);
    free(f);
    return energy;
}

/* Springs that are far from their rest length, and contact that is far inside its range. */
static void check_energy(const struct cs_system *system, struct cs_text *out) {
    const struct cs_energy start =
        cs_diagnostics_energy(system, 0, system->state, system->state + 3 * system->view.n);
    const double most = STORED_MAX * energy_to_come(system, &start);
    // without gravity and motion the stored energy is all that there is, and meant
    if (!(most > 0))
        return;
    if (start.elastic > most && released_energy(system) > most)
        cs_text_add(out,
                    "springs store %.3g J at the start, gravity and events give %.3g J: check "
                    "cloth.size and cloth.stretch; springs %.2g times as soft, of all kinds, "
                    "store as little\n",
                    start.elastic, most / STORED_MAX, STORED_MAX * start.elastic / most);
    if (start.other > most)
        cs_text_add(out,
                    "contact stores %.3g J at the start, gravity and events give %.3g J: "
                    "bodies are thrown apart; contact.start \"move-out\" moves them to "
                    "balance\n",
                    start.other, most / STORED_MAX);
}

/* --- springs at pins --- */

/* N, sum of k L of the springs between a body's pins and its free particles; or, where it hangs
 * on obstacles, of the springs that a cut through its middle meets. */
static double strength_of(const struct cs_system *system, uint32_t b, bool at_pins) {
    const struct cs_body_range *range = system->bodies + b;
    double strength = 0, low[3], high[3];
    const double size = cs_findings_box(system, b, low, high);
    for (uint32_t r = 0; r < system->springs.n_runs; r++) {
        const struct cs_spring_run *s = system->springs.runs + r;
        for (uint32_t i = 0; i < s->count; i++) {
            const uint32_t one = cs_spring_a(s, i), other = cs_spring_b(s, i);
            const double kl = cs_spring_stiffness(s, i) * cs_spring_length(s, i);
            if (one - range->first < range->count &&
                (!at_pins || (system->inv_mass[one] > 0) != (system->inv_mass[other] > 0)))
                strength += at_pins ? kl : kl * cs_spring_length(s, i) / size;
        }
    }
    return strength;
}

/* N, sum over a body's free particles of the forces of some parts at the start. */
static double load_of(const struct cs_system *system, const struct cs_body_range *range,
                      uint32_t parts) {
    const size_t n = system->view.n, last = (size_t)range->first + range->count;
    double *f = calloc(3 * n, sizeof *f), sum[3] = {0};
    if (f && cs_terms_need_normals(system, parts))
        cs_normals_update(system, system->state);
    if (f)
        cs_terms_force(
            system,
            &(struct cs_eval){.x = system->state, .v = system->state + 3 * n, .parts = parts},
            f);
    for (size_t i = range->first; f && i < last; i++)
        for (size_t c = 0; c < 3; c++)
            sum[c] += f[c * n + i];
    free(f);
    return cs_vec3_length(sum);
}

/* The least strain of the springs at pins under a load F: |F| <= strain * sum of k L. Where
 * obstacles may carry it, the mean strain below them under the weight. */
static void check_load(const struct cs_system *system, struct cs_text *out) {
    const struct cs_scene *scene = system->scene;
    const bool at_pins = !scene->colliders.n && !cs_scene_has_body_contact(scene);
    const double rest = at_pins ? 1 : 0.2; // part of the strain; impacts take the other
    for (uint32_t k = 0; k < (at_pins ? 2 : 1) * scene->bodies.n; k++) {
        const uint32_t b = k % scene->bodies.n, part = k == b ? CS_PART_GRAVITY : CS_PART_WIND;
        const struct cs_body *body = cs_scene_bodies(scene) + b;
        const struct cs_spring_law *law = &body->springs;
        const double strength = strength_of(system, b, at_pins);
        const double load = strength > 0 ? load_of(system, system->bodies + b, part) : 0;
        const double times = load / strength / (rest * STRAIN_WANTED);
        if (!isnan(body->strain_limit) || body->network.present ||
            !(load > (at_pins ? STRAIN_MAX : CARRIED_MAX) * strength))
            continue;
        cs_text_add(out, "bodies[%u]: %s stretches %s %.3g %%; for %.3g %%: ", b,
                    k == b ? "its weight" : "the wind at the start",
                    at_pins ? "the springs at its pins by at least" : "hanging cloth by about",
                    100 * load / strength, 100 * rest * STRAIN_WANTED);
        if (k != b)
            cs_text_add(out, "a wind %.2g times weaker in force\n", times);
        else if (body->mesh)
            cs_text_add(out, "springs.stretch %.3g and bend %.3g\n", times * law->stretch,
                        times * law->bend);
        else
            cs_text_add(out, "springs.stretch %.3g, shear %.3g and bend %.3g\n",
                        times * law->stretch, times * law->shear, times * law->bend);
    }
}

/* --- symmetry --- */

/* Sets the unit normal of the plane that a grid lies in; returns false if there is none. */
static bool find_plane(const struct cs_system *system, const struct cs_body_range *range,
                       double normal[3]) {
    const size_t n = system->view.n, first = range->first,
                 ends[3] = {0, range->columns - 1, (size_t)range->columns * (range->rows - 1)};
    double side[2][3], most = 0;
    if (range->columns < 2 || range->rows < 2)
        return false;
    for (size_t c = 0; c < 3; c++)
        for (size_t k = 0; k < 2; k++)
            side[k][c] =
                system->state[c * n + first + ends[k + 1]] - system->state[c * n + first];
    cs_vec3_cross(side[0], side[1], normal);
    if (cs_vec3_is_zero(normal))
        return false;
    cs_vec3_normalise(normal);
    for (size_t i = first; i < first + range->count; i++) {
        double d[3], v[3];
        for (size_t c = 0; c < 3; c++) {
            d[c] = system->state[c * n + i] - system->state[c * n + first];
            v[c] = system->state[(3 + c) * n + i];
        }
        most = fmax(most, fmax(fabs(cs_vec3_dot(d, normal)), fabs(cs_vec3_dot(v, normal))));
    }
    return most <= FLAT * (cs_vec3_length(side[0]) + cs_vec3_length(side[1]));
}

/* True if only pins, releases and ramps happen, and no obstacle or wind is there. */
static bool is_undisturbed(const struct cs_scene *scene) {
    bool calm = !scene->colliders.n && !scene->forces->wind.present &&
                !cs_scene_has_body_contact(scene);
    for (uint32_t e = 0; e < scene->events.n; e++) {
        const struct cs_event *event = cs_scene_events(scene) + e;
        calm = calm && (event->pin.present || event->release.present || event->ramp.present);
    }
    return calm;
}

/* A flat sheet in whose plane all forces act stays flat, although cloth would fold: held at
 * single points, or shorter than at rest. */
static void check_symmetry(const struct cs_system *system, struct cs_text *out) {
    const struct cs_scene *scene = system->scene;
    const double *g = scene->forces->gravity;
    for (uint32_t b = 0; b < scene->bodies.n && is_undisturbed(scene); b++) {
        const struct cs_body_range *range = system->bodies + b;
        const struct cs_body *body = cs_scene_bodies(scene) + b;
        double normal[3];
        uint32_t pinned = 0;
        for (uint32_t p = 0; p < system->n_pinned; p++)
            pinned += system->pinned[p] - range->first < range->count;
        const bool hangs =
            pinned && pinned < range->columns && pinned < range->rows && !cs_vec3_is_zero(g);
        const bool is_short = body->cloth.stretch[0] < 1 || body->cloth.stretch[1] < 1;
        if ((hangs || is_short) && pinned < range->count && find_plane(system, range, normal) &&
            fabs(cs_vec3_dot(g, normal)) <= FLAT * cs_vec3_length(g))
            cs_text_add(
                out,
                "bodies[%u] lies in a plane that no force leaves: it cannot buckle out of "
                "it; cloth.bump %.1g breaks the symmetry\n",
                b, 1e-3 * fmin(body->cloth.size[0], body->cloth.size[1]));
    }
}

/* --- steps and obstacles --- */

/* s, the step of the method, if it is known beforehand; else 0. */
static double step_of(const struct cs_session *session) {
    const struct cs_integrator *integrator = session->method.integrator;
    const struct cs_option *row = cs_option_find(&session->method.table, "dt");
    const double frame = 1 / session->scene->time.fps;
    double dt = 0;
    if (!row || row->type != CS_REAL || integrator->traits & CS_ADAPTIVE)
        return 0;
    memcpy(&dt, (const char *)session->method.options + row->offset, sizeof dt);
    return fmin(dt, frame);
}

/* Changes by the reading of meshes; several pieces of a mesh that nothing joins. */
static void check_meshes(const struct cs_scene *scene, struct cs_scene_findings *out) {
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        const struct cs_mesh_source *source = cs_scene_bodies(scene)[b].mesh;
        const struct cs_trimesh *mesh = cs_scene_bodies(scene)[b].geometry;
        if (!source || !mesh->mends)
            continue;
        if (*mesh->mends)
            cs_text_add(&out->warnings, "bodies[%u].mesh.file: %s: %s\n", b, source->file,
                        mesh->mends);
        double shortest = HUGE_VAL;
        for (uint32_t *e = mesh->edges; e < mesh->edges + 2 * (size_t)mesh->n_edges; e += 2)
            shortest = fmin(shortest, sqrt(cs_trimesh_squared_distance(mesh, e[0], e[1])));
        if (!(mesh->edge > 1e-6 && mesh->edge < 1e4 && shortest >= SHORT_EDGE * mesh->edge))
            cs_text_add(&out->hints,
                        "bodies[%u].mesh: edges of %.3g m, the shortest of %.2g m: see units, "
                        "or merge close vertices\n",
                        b, mesh->edge, shortest);
        if (mesh->pieces > 1 && !scene->seams.n)
            cs_text_add(&out->hints,
                        "bodies[%u].mesh: %u pieces that nothing joins; see self_contact\n", b,
                        mesh->pieces);
    }
}

/* Lengths in centimetres: gravity tells, or a body that is lighter than any cloth. Returns
 * whether gravity does. */
static bool check_units(const struct cs_system *system, struct cs_text *out) {
    const struct cs_scene *scene = system->scene;
    const bool by_gravity = fabs(cs_vec3_length(scene->forces->gravity) / 981 - 1) < 0.05;
    if (by_gravity)
        cs_text_add(out,
                    "forces.gravity: 981 is in cm/s2: multiply lengths and gravity by 0.01\n");
    for (uint32_t b = 0; b < scene->bodies.n && !by_gravity; b++) {
        const struct cs_body *body = cs_scene_bodies(scene) + b;
        const struct cs_trimesh *mesh = body->geometry;
        const double edge = mesh ? mesh->edge : cs_findings_spacing(body);
        // sqrt(3)/4 edge^2 is the mean triangle's area, about
        const double area = mesh ? 0.433 * mesh->n_triangles * edge * edge
                                 : body->cloth.size[0] * body->cloth.size[1];
        const double density = body->mass.total / area;
        if (density > 0 && density < DENSITY_MIN && edge > 0.1)
            cs_text_add(out,
                        "bodies[%u].%s: edges of %.3g m at %.2g kg/m2, lighter than any cloth: "
                        "is it in centimetres? Then %s\n",
                        b, mesh ? "mesh" : "cloth", edge, density,
                        mesh ? "set mesh.units \"cm\"" : "multiply cloth.size by 0.01");
    }
    return by_gravity;
}

/* --- all checks --- */

/* Adds a line, if the text of a single one is there. */
static void add_line(struct cs_text *line, struct cs_text *out) {
    if (line->length)
        cs_text_add(out, "%s\n", cs_text_get(line));
    out->failed |= line->failed;
    cs_text_finish(line);
}

/* Surfaces that contact does not keep apart. */
static enum cs_status check_surfaces(const struct cs_system *system, double seconds,
                                     struct cs_text *out, struct cs_error *error) {
    struct cs_text line = {0};
    cs_overlap_warning_print(system->scene, seconds, &line, error);
    add_line(&line, out);
    cs_sampling_warning_print(system, &line);
    add_line(&line, out);
    cs_containment_warning_print(system, &line);
    add_line(&line, out);
    cs_contact_capacity_warn(system, &line);
    add_line(&line, out);
    return error->status;
}

enum cs_status cs_scene_doctor_check(const struct cs_session *session, double seconds,
                                     struct cs_scene_findings *out, struct cs_error *error) {
    const struct cs_system *system = &session->system;
    *out = (struct cs_scene_findings){0};
    if (check_surfaces(system, seconds, &out->warnings, error))
        return error->status;
    check_meshes(system->scene, out);
    check_energy(system, &out->warnings);
    if (!check_units(system, &out->hints))
        check_load(system, &out->hints);
    cs_contact_spacing_print(system, &out->hints);
    cs_contact_ranges_print(system, step_of(session), &out->hints);
    check_symmetry(system, &out->hints);
    cs_path_findings_print(system, &out->hints);
    cs_trajectory_findings_print(session, seconds, out);
    cs_idle_keys_print(system->scene, &out->hints);
    return out->warnings.failed || out->hints.failed
               ? cs_fail(error, CS_ERR_MEMORY, "out of memory for the checks of the scene")
               : CS_OK;
}

void cs_scene_findings_finish(struct cs_scene_findings *findings) {
    cs_text_finish(&findings->warnings);
    cs_text_finish(&findings->hints);
}

void cs_session_print_choice(const struct cs_session *session, struct cs_text *out) {
    const bool is_explicit = !(session->method.integrator->traits & CS_IMPLICIT);
    if (session->is_automatic && session->rate_limit > 0)
        cs_text_add(
            out, "automatic, %s: the fastest motion of the springs has %.3g 1/s, %s %.3g 1/s",
            is_explicit ? "explicit" : "implicit", session->rate,
            is_explicit ? "at most" : "above", session->rate_limit);
    else if (session->is_automatic)
        cs_text_add(out, "automatic: bodies have shape_matching");
}
