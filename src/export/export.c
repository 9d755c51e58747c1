/* Hands every sample of a run to the writers of all requested formats. */
#include "export/export.h"

#include "session/scene_view.h"

#include <string.h>

#define X(BIT, name) &cs_export_##name,
const struct cs_export_writer *const cs_export_writers[] = {CS_EXPORT_LIST(X)};
#undef X
#define X(BIT, name) #name,
const char *const cs_export_format_names[] = {CS_EXPORT_LIST(X) NULL};
#undef X
const char *const cs_export_value_names[] = {"force", "strain", NULL};

uint32_t cs_export_with_values(void) {
    uint32_t formats = 0;
    for (uint32_t k = 0; k < CS_N_EXPORT_FORMATS; k++)
        formats |= (uint32_t)cs_export_writers[k]->holds_values << k;
    return formats;
}

/* Adds the fields besides positions, if a format can hold them: their order is that of
 * measure. */
static enum cs_status add_fields(struct cs_export *export, struct cs_error *error) {
    static const char *const names[][2] = {{"velocity", "velocities"},
                                           {"force", "forces"},
                                           {"strain", "strains"},
                                           {"stitches", "stitch_counts"}};
    const uint32_t values = export->source.settings.values;
    struct cs_export_mesh *bodies = &export->bodies;
    struct cs_arena *arena = &export->arena;
    if (!(export->source.settings.formats & cs_export_with_values()))
        return CS_OK;
    cs_export_mesh_add_field(bodies, names[0], 3, arena, error);
    if (values & CS_EXPORT_FORCE)
        cs_export_mesh_add_field(bodies, names[1], 3, arena, error);
    if (values & CS_EXPORT_STRAIN)
        cs_export_mesh_add_field(bodies, names[2], 1, arena, error);
    if (export->bodies.seams)
        cs_export_mesh_add_field(bodies, names[3], 1, arena, error);
    if (values || export->bodies.seams) {
        export->values = cs_arena_alloc_array(arena, bodies->n, sizeof *export->values, error);
        export->scratch =
            cs_arena_alloc_array(arena, bodies->n, 3 * sizeof *export->scratch, error);
    }
    return error->status;
}

static enum cs_status make_skins(struct cs_export *export, struct cs_error *error) {
    if (cs_export_mesh_of_bodies(&export->bodies, export->system, &export->arena, error) ||
        cs_export_mesh_of_colliders(&export->colliders, export->system, &export->arena, error))
        return error->status;
    return add_fields(export, error);
}

enum cs_status cs_export_open(struct cs_export *export,
                              const struct cs_export_settings *settings,
                              const struct cs_system *system, struct cs_error *error) {
    *export = (struct cs_export){.source = {.meshes = {&export->bodies, &export->colliders},
                                            .settings = *settings,
                                            .fps = system->scene->time.fps},
                                 .system = system,
                                 .n_samples = settings->n_samples_before};
    if (!settings->formats || make_skins(export, error))
        return error->status;
    for (uint32_t k = 0; k < CS_N_EXPORT_FORMATS && !error->status; k++) {
        const struct cs_export_writer *writer = cs_export_writers[k];
        if (settings->formats & 1u << k)
            export->states[k] = cs_arena_alloc(&export->arena, writer->size, error);
        CS_ASSERT(writer->add);
        if (export->states[k] && writer->open)
            writer->open(export->states[k], &export->source, &export->arena, error);
    }
    /* colliders at rest keep the positions that they get now */
    if (!error->status && export->colliders.n > 0)
        cs_export_mesh_pose_colliders(&export->colliders, system, 0);
    return error->status;
}

/* Counts the stitches of each particle that are not broken. */
static void count_stitches(const struct cs_seams *seams, uint32_t n, double *count) {
    memset(count, 0, n * sizeof *count);
    for (uint32_t s = 0; s < seams->n; s++)
        for (uint32_t k = 0; k < seams->stitches[s].n && !seams->broken[s]; k++)
            count[seams->stitches[s].at[k]]++;
}

/* Sets all fields from the state at time t, in the order of add_fields. */
static void measure_fields(struct cs_export *export, double t, const double *x,
                           const double *v) {
    const struct cs_export_mesh *bodies = &export->bodies;
    const struct cs_export_field *field = bodies->fields + 1;
    cs_export_mesh_set(bodies, bodies->fields, x);
    if (bodies->n_fields > 1)
        cs_export_mesh_set(bodies, field++, v);
    if (export->source.settings.values & CS_EXPORT_FORCE && export->scratch) {
        cs_diagnostics_particle_force(export->system, t, x, v, export->values, export->scratch);
        cs_export_mesh_set(bodies, field++, export->scratch);
    }
    if (export->source.settings.values & CS_EXPORT_STRAIN && export->values) {
        cs_diagnostics_particle_strain(export->system, x, export->values);
        cs_export_mesh_set(bodies, field++, export->values);
    }
    if (export->bodies.seams && export->values) {
        count_stitches(export->bodies.seams, bodies->n, export->values);
        cs_export_mesh_set(bodies, field, export->values);
    }
    if (export->colliders.is_moving && export->colliders.n > 0)
        cs_export_mesh_pose_colliders(&export->colliders, export->system, t);
}

enum cs_status cs_export_write_sample(struct cs_export *export, uint32_t frame, double t,
                                      const double *x, const double *v,
                                      struct cs_error *error) {
    const struct cs_export_sample sample = {export->n_samples, frame, t};
    if (!export->source.settings.formats || frame % export->source.settings.frame_interval)
        return CS_OK;
    measure_fields(export, t, x, v);
    for (uint32_t k = 0; k < CS_N_EXPORT_FORMATS; k++)
        if (export->states[k] &&
            cs_export_writers[k]->add(export->states[k], &export->source, &sample, error))
            return error->status;
    export->n_samples++;
    return CS_OK;
}

enum cs_status cs_export_sync(const struct cs_export *export, struct cs_error *error) {
    for (uint32_t k = 0; k < CS_N_EXPORT_FORMATS; k++)
        if (export->states[k] && cs_export_writers[k]->sync &&
            cs_export_writers[k]->sync(export->states[k], error))
            return error->status;
    return CS_OK;
}

enum cs_status cs_export_finish(struct cs_export *export, bool goes_on,
                                struct cs_error *error) {
    for (uint32_t k = 0; k < CS_N_EXPORT_FORMATS; k++)
        if (export->states[k] && cs_export_writers[k]->finish &&
            cs_export_writers[k]->finish(export->states[k], &export->source, goes_on, error))
            return error->status;
    return CS_OK;
}

void cs_export_close(struct cs_export *export) {
    for (uint32_t k = 0; k < CS_N_EXPORT_FORMATS; k++)
        if (export->states[k] && cs_export_writers[k]->close)
            cs_export_writers[k]->close(export->states[k]);
    cs_arena_finish(&export->arena);
    *export = (struct cs_export){0};
}
