/* Hands every sample of a run to the writers of all formats that are asked for. */
#include "io/export/export.h"

#include "io/export/export_colliders.h"
#include "model/force/diagnostics.h"

const char *const cs_export_format_names[] = {"obj", "pc2", "vtp", "npz", NULL};
const char *const cs_export_value_names[] = {"force", "strain", NULL};

/* Only VTP and NPZ have room for more than positions. */
static enum cs_status add_fields(struct cs_export *export, struct cs_error *error) {
    static const char *const names[][2] = {
        {"velocity", "velocities"}, {"force", "forces"}, {"strain", "strains"}};
    const uint32_t values = export->settings.values;
    struct cs_export_mesh *bodies = &export->bodies;
    struct cs_arena *arena = &export->arena;
    if (!(export->settings.formats & (CS_EXPORT_VTP | CS_EXPORT_NPZ)))
        return CS_OK;
    cs_export_mesh_add_field(bodies, names[0], 3, arena, error);
    if (values & CS_EXPORT_FORCE)
        cs_export_mesh_add_field(bodies, names[1], 3, arena, error);
    if (values & CS_EXPORT_STRAIN)
        cs_export_mesh_add_field(bodies, names[2], 1, arena, error);
    if (values) {
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

/* of the bodies, or of the colliders where there are some */
static enum cs_status open_skin(struct cs_export *export, int k, struct cs_error *error) {
    const struct cs_export_mesh *skin = k ? &export->colliders : &export->bodies;
    const struct cs_export_settings *settings = &export->settings;
    struct cs_arena *arena = &export->arena;
    if (skin->n == 0)
        return CS_OK;
    if (settings->formats & CS_EXPORT_OBJ && cs_obj_print_tail(skin, export->obj + k, error))
        return error->status;
    if (settings->formats & CS_EXPORT_VTP && cs_vtp_make(export->vtp + k, skin, arena, error))
        return error->status;
    /* what never moves needs no cache */
    if (settings->formats & CS_EXPORT_PC2 && skin->is_moving)
        return cs_pc2_open(export->pc2 + k, skin, settings, arena, error);
    return CS_OK;
}

/* The list of samples is written anew. */
static enum cs_status open_pvd(struct cs_export *export, struct cs_error *error) {
    const struct cs_export_mesh *const skins[2] = {&export->bodies, &export->colliders};
    const double fps = export->system->scene->time.fps;
    if (cs_pvd_open(&export->pvd, export->settings.folder, error))
        return error->status;
    for (uint32_t k = 0; k < export->settings.n_samples_before && !error->status; k++)
        cs_pvd_add(&export->pvd, skins, k, k * export->settings.frame_interval / fps, error);
    return error->status;
}

enum cs_status cs_export_open(struct cs_export *export,
                              const struct cs_export_settings *settings,
                              const struct cs_system *system, struct cs_error *error) {
    *export = (struct cs_export){
        .settings = *settings, .system = system, .n_samples = settings->n_samples_before};
    const struct cs_export_mesh *const skins[2] = {&export->bodies, &export->colliders};
    if (!settings->formats)
        return CS_OK;
    if (make_skins(export, error) || open_skin(export, 0, error) || open_skin(export, 1, error))
        return error->status;
    if (settings->formats & CS_EXPORT_VTP && open_pvd(export, error))
        return error->status;
    if (settings->formats & CS_EXPORT_NPZ)
        cs_npz_open(&export->npz, skins, settings, error);
    /* those at rest stay where they are put now */
    if (!error->status && export->colliders.n > 0)
        cs_export_mesh_pose_colliders(&export->colliders, system, 0);
    return error->status;
}

static void measure(struct cs_export *export, double t, const double *x, const double *v) {
    const struct cs_export_mesh *bodies = &export->bodies;
    const struct cs_export_field *field = bodies->fields + 1;
    cs_export_mesh_set(bodies, bodies->fields, x);
    if (bodies->n_fields > 1)
        cs_export_mesh_set(bodies, field++, v);
    if (export->settings.values & CS_EXPORT_FORCE && export->scratch) {
        cs_diagnostics_particle_force(export->system, t, x, v, export->values, export->scratch);
        cs_export_mesh_set(bodies, field++, export->scratch);
    }
    if (export->settings.values & CS_EXPORT_STRAIN && export->values) {
        cs_diagnostics_particle_strain(export->system, x, export->values);
        cs_export_mesh_set(bodies, field, export->values);
    }
    if (export->colliders.is_moving && export->colliders.n > 0)
        cs_export_mesh_pose_colliders(&export->colliders, export->system, t);
}

static enum cs_status write_skin(struct cs_export *export, int k,
                                 const struct cs_export_sample *sample,
                                 struct cs_error *error) {
    const struct cs_export_mesh *skin = k ? &export->colliders : &export->bodies;
    const struct cs_export_settings *settings = &export->settings;
    const bool writes = skin->n > 0 && (skin->is_moving || sample->number == 0);
    if (writes && settings->formats & CS_EXPORT_OBJ &&
        cs_obj_write(skin, export->obj + k, settings->folder, sample, error))
        return error->status;
    if (writes && settings->formats & CS_EXPORT_VTP &&
        cs_vtp_write(export->vtp + k, skin, settings->folder, sample, error))
        return error->status;
    return export->pc2[k].file.file ? cs_pc2_add(export->pc2 + k, skin, error) : CS_OK;
}

enum cs_status cs_export_write_sample(struct cs_export *export, uint32_t frame, double t,
                                      const double *x, const double *v,
                                      struct cs_error *error) {
    const struct cs_export_mesh *const skins[2] = {&export->bodies, &export->colliders};
    const struct cs_export_sample sample = {export->n_samples, frame, t};
    if (!export->settings.formats || frame % export->settings.frame_interval)
        return CS_OK;
    measure(export, t, x, v);
    if (write_skin(export, 0, &sample, error) || write_skin(export, 1, &sample, error))
        return error->status;
    if (export->pvd.file.file && cs_pvd_add(&export->pvd, skins, sample.number, t, error))
        return error->status;
    if (export->npz.part_file.file && cs_npz_add(&export->npz, skins, t, error))
        return error->status;
    export->n_samples++;
    return CS_OK;
}

/* Numbered files and the list of samples can be missed, or are written anew. */
enum cs_status cs_export_sync(const struct cs_export *export, struct cs_error *error) {
    for (int k = 0; k < 2; k++)
        if (cs_append_file_sync(&export->pc2[k].file, error))
            return error->status;
    return cs_append_file_sync(&export->npz.part_file, error);
}

enum cs_status cs_export_finish(struct cs_export *export, bool goes_on,
                                struct cs_error *error) {
    const struct cs_export_mesh *const skins[2] = {&export->bodies, &export->colliders};
    return export->npz.part_file.file ? cs_npz_finish(&export->npz, skins, goes_on, error)
                                      : CS_OK;
}

void cs_export_close(struct cs_export *export) {
    for (int k = 0; k < 2; k++) {
        cs_text_finish(export->obj + k);
        cs_text_finish(&export->vtp[k].header);
        cs_append_file_close(&export->pc2[k].file);
    }
    cs_append_file_close(&export->pvd.file);
    cs_append_file_close(&export->npz.part_file);
    cs_arena_finish(&export->arena);
    *export = (struct cs_export){0};
}
