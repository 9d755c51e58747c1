/* Levels of meshes, and their distances to the finest. */
#include "study/compare/compare.h"

#include "base/file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Particles of a direction with so many cells instead of `cells` of the scene; 0 where they do
 * not divide. */
static uint32_t scaled(int64_t particles, uint32_t cells, int64_t first) {
    const int64_t product = (particles - 1) * cells;
    return product % first ? 0 : (uint32_t)(product / first + 1);
}

/* Columns and rows of a body's grid; NULL: it is a mesh. */
static const int64_t *grid_of(const struct cs_scene *scene, uint32_t body) {
    const struct cs_cloth *cloth = &cs_scene_bodies(scene)[body].cloth;
    return cloth->present ? cloth->grid : NULL;
}

static const char *copy_text(struct cs_mesh_study *study, const char *text,
                             struct cs_error *error) {
    char *copy = cs_arena_alloc(&study->arena, strlen(text) + 1, error);
    return copy ? strcpy(copy, text) : NULL;
}

/* Adds the grid of body b on a level, and its override. */
static enum cs_status set_grid(struct cs_mesh_study *study, struct cs_mesh_level *level,
                               uint32_t b, const int64_t *own, int64_t first,
                               struct cs_error *error) {
    struct cs_override *to = level->overrides + level->n_overrides++;
    char path[64], value[64];
    for (int k = 0; k < 2; k++)
        level->grids[2 * b + k] = scaled(own[k], level->cells, first);
    const uint32_t *grid = level->grids + 2 * b;
    if (grid[0] < 2 || grid[1] < 2)
        return cs_fail(
            error, CS_ERR_USAGE,
            "--mesh: %u cells do not divide among bodies[%u] of %lld x %lld, expected "
            "multiples that give whole cells",
            level->cells, b, (long long)own[0] - 1, (long long)own[1] - 1);
    // an override, so that origin.json has it and a row can be reproduced
    snprintf(path, sizeof path, "bodies[%u].cloth.grid", b);
    snprintf(value, sizeof value, "[%u,%u]", grid[0], grid[1]);
    to->path = copy_text(study, path, error);
    to->value = copy_text(study, value, error);
    return error->status;
}

static enum cs_status make_level(struct cs_mesh_study *study, struct cs_mesh_level *level,
                                 const struct cs_session_settings *session,
                                 const struct cs_scene *scene, struct cs_error *error) {
    const size_t n = study->n_bodies;
    level->error = level->bar = (double)NAN;
    level->n_overrides = session->n_overrides;
    CS_ARENA_ARRAY(&study->arena, level->overrides, n + session->n_overrides, error);
    level->grids = cs_arena_alloc_array(&study->arena, 2 * n, sizeof *level->grids, error);
    if (error->status)
        return error->status;
    if (session->n_overrides)
        memcpy(level->overrides, session->overrides,
               session->n_overrides * sizeof *level->overrides);
    for (uint32_t b = 0; b < n; b++)
        if (set_grid(study, level, b, grid_of(scene, b), grid_of(scene, 0)[0] - 1, error))
            break;
    return error->status;
}

static enum cs_status make_levels(struct cs_mesh_study *study, uint32_t low,
                                  const struct cs_session_settings *session,
                                  const struct cs_scene *scene, struct cs_error *error) {
    study->n_bodies = scene->bodies.n;
    for (uint32_t b = 0; b < scene->bodies.n; b++)
        if (!grid_of(scene, b))
            return cs_fail(error, CS_ERR_SCENE,
                           "%s: bodies[%u] is a mesh, expected grids for --mesh",
                           session->scene, b);
    if (grid_of(scene, 0)[0] < 2)
        return cs_fail(error, CS_ERR_SCENE, "%s: bodies[0] has no cells", session->scene);
    study->levels = cs_arena_alloc_array(&study->arena, study->n, sizeof *study->levels, error);
    for (uint32_t k = 0; k < study->n && !error->status; k++) {
        study->levels[k].cells = low << k;
        make_level(study, study->levels + k, session, scene, error);
    }
    return error->status;
}

enum cs_status cs_mesh_study_begin(struct cs_mesh_study *study, const char *range,
                                   const struct cs_session_settings *session,
                                   struct cs_error *error) {
    struct cs_session_settings asked = *session;
    struct cs_session opened;
    unsigned low, high;
    int length = 0;
    *study = (struct cs_mesh_study){.scene = session->scene};
    if (sscanf(range, "%5u..%5u%n", &low, &high, &length) != 2 || range[length] || low < 1 ||
        high < 2 * low || high > 4096)
        return cs_fail(error, CS_ERR_USAGE,
                       "--mesh: found \"%s\", expected LOW..HIGH cells, 8..64 for example",
                       range);
    for (unsigned cells = low; cells <= high; cells *= 2)
        study->n++;
    // any method: only the scene is read
    asked.integrator = "velocity-verlet";
    if (cs_session_open_plan(&opened, &asked, error))
        return error->status;
    make_levels(study, low, session, opened.scene, error);
    cs_session_close(&opened);
    return error->status;
}

enum cs_status cs_mesh_level_store(struct cs_mesh_study *study, struct cs_mesh_level *level,
                                   const struct cs_compare *compare, struct cs_error *error) {
    const struct cs_compare_reference *reference = &compare->reference;
    const struct cs_trajectory *trajectory = &reference->trajectory;
    CS_ARENA_ARRAY(&study->arena, level->rows, compare->cells.n, error);
    for (uint32_t k = 0; k < compare->cells.n && !error->status; k++)
        if (cs_cell_is_finished(compare->cells.cells + k))
            level->rows[level->n_rows++] = compare->cells.cells[k];
    // without a verified reference the mesh has no error
    if (error->status || !reference->families_agree || !reference->pointwise)
        return error->status;
    level->bar = reference->error_bar;
    CS_ARENA_ARRAY(&study->arena, level->x, 3 * (size_t)trajectory->n, error);
    if (level->x)
        memcpy(level->x, cs_trajectory_state(trajectory, trajectory->frames),
               3 * (size_t)trajectory->n * sizeof *level->x);
    return error->status;
}

/* Sums of weights, and of weights times squared distances. */
struct sums {
    double weight, square;
};

/* Particles of a mesh, all bodies together. */
static size_t particles_of(const struct cs_mesh_study *study,
                           const struct cs_mesh_level *level) {
    size_t n = 0;
    for (uint32_t b = 0; b < study->n_bodies; b++)
        n += (size_t)level->grids[2 * b] * level->grids[2 * b + 1];
    return n;
}

/* Adds body b, whose first particles are given; half a cell belongs to a particle of a rim. */
static void add_body(const struct cs_mesh_study *study, const struct cs_mesh_level *level,
                     uint32_t b, const size_t first[2], struct sums *sums) {
    const struct cs_mesh_level *finest = study->levels + study->n - 1;
    const uint32_t *grid = level->grids + 2 * b, *fine = finest->grids + 2 * b;
    const size_t by = finest->cells / level->cells;
    const size_t n = particles_of(study, level), n_fine = particles_of(study, finest);
    for (size_t r = 0; r < grid[1]; r++)
        for (size_t c = 0; c < grid[0]; c++) {
            const bool side = c == 0 || c + 1 == grid[0], end = r == 0 || r + 1 == grid[1];
            const double weight = (side ? 0.5 : 1) * (end ? 0.5 : 1);
            // the particle of the finest mesh in the same place
            const size_t i = first[0] + r * grid[0] + c;
            const size_t j = first[1] + by * (r * fine[0] + c);
            for (size_t k = 0; k < 3; k++) {
                const double d = level->x[k * n + i] - finest->x[k * n_fine + j];
                sums->square += weight * d * d;
            }
            sums->weight += weight;
        }
}

void cs_mesh_study_measure(struct cs_mesh_study *study) {
    const struct cs_mesh_level *finest = study->levels + study->n - 1;
    for (struct cs_mesh_level *level = study->levels; level < finest; level++) {
        size_t first[2] = {0, 0};
        struct sums sums = {0, 0};
        for (uint32_t b = 0; level->x && finest->x && b < study->n_bodies; b++) {
            add_body(study, level, b, first, &sums);
            first[0] += (size_t)level->grids[2 * b] * level->grids[2 * b + 1];
            first[1] += (size_t)finest->grids[2 * b] * finest->grids[2 * b + 1];
        }
        if (sums.weight > 0)
            level->error = sqrt(sums.square / sums.weight);
    }
}

/* Which of two rows of a series shows better what the mesh needs. */
static bool is_better(const struct cs_cell *a, const struct cs_cell *b, double mesh) {
    const bool suits = a->error <= mesh, other_suits = b->error <= mesh;
    return suits != other_suits ? suits : suits ? a->work < b->work : a->error < b->error;
}

static void print_line(const struct cs_mesh_study *study, const struct cs_mesh_level *level,
                       const struct cs_cell *row, struct cs_text *out) {
    const char *name = strrchr(study->scene, '/');
    char mesh[24] = "-", value[40] = "";
    if (!isnan(level->error))
        snprintf(mesh, sizeof mesh, "%.3g", level->error);
    if (*row->control)
        snprintf(value, sizeof value, "%s=%.3g", row->control, row->value);
    cs_text_add(out, "%-24.60s %5u  %9s  %-20s %-14s %9.3g  %9.3g  %s\n",
                name ? name + 1 : study->scene, level->cells, mesh, row->series, value,
                row->error, row->work,
                isnan(level->error)          ? "-"
                : row->error <= level->error ? "mesh"
                                             : "step");
}

static void print_study(const struct cs_mesh_study *study, bool head, struct cs_text *out) {
    if (head)
        cs_text_add(out, "%-24s %5s  %9s  %-20s %-14s %9s  %9s  %s\n", "scene", "cells",
                    "mesh, m", "series", "options", "step, m", "work", "larger");
    for (uint32_t k = 0; k < study->n; k++) {
        const struct cs_mesh_level *level = study->levels + k;
        for (uint32_t first = 0, r = 0; first < level->n_rows; first = r) {
            // rows of a series follow each other
            const struct cs_cell *best = level->rows + first;
            for (r = first;
                 r < level->n_rows && cs_cell_same_series(level->rows + r, level->rows + first);
                 r++)
                if (is_better(level->rows + r, best, level->error))
                    best = level->rows + r;
            print_line(study, level, best, out);
        }
    }
}

static void print_csv(const struct cs_mesh_study *study, bool head, struct cs_text *out) {
    static const char *const names[] = {"scene",   "cells",      "mesh_error", "bar", "series",
                                        "options", "step_error", "work",       "cpu"};
    for (size_t k = 0; head && k < sizeof names / sizeof *names; k++)
        cs_csv_add_text(out, names[k]);
    if (head)
        cs_text_add(out, "\n");
    for (uint32_t k = 0; k < study->n; k++)
        for (uint32_t r = 0; r < study->levels[k].n_rows; r++) {
            const struct cs_mesh_level *level = study->levels + k;
            const struct cs_cell *row = level->rows + r;
            // in the order of the names
            cs_csv_add_text(out, study->scene);
            cs_csv_add_number(out, level->cells);
            cs_csv_add_number(out, level->error);
            cs_csv_add_number(out, level->bar);
            cs_csv_add_text(out, row->series);
            cs_csv_add_text(out, row->options);
            cs_csv_add_number(out, row->error);
            cs_csv_add_number(out, row->work);
            cs_csv_add_number(out, row->cpu);
            cs_text_add(out, "\n");
        }
}

enum cs_status cs_mesh_studies_report(const struct cs_mesh_study *studies, uint32_t n,
                                      const char *folder, struct cs_text *out,
                                      struct cs_error *error) {
    struct cs_text csv = {0}, path = {0};
    cs_text_add(out, "\nthe error of each mesh against the finest, and of the step that is the "
                     "cheapest below it\n");
    for (uint32_t k = 0; k < n; k++) {
        print_study(studies + k, k == 0, out);
        print_csv(studies + k, k == 0, &csv);
    }
    cs_text_add(&path, "%s/mesh.csv", folder);
    cs_file_write_text(cs_text_get(&path), &csv, error);
    cs_text_finish(&path);
    return error->status;
}

void cs_mesh_study_finish(struct cs_mesh_study *study) {
    cs_arena_finish(&study->arena);
    *study = (struct cs_mesh_study){0};
}
