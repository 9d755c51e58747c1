/* Writes Wavefront OBJ: one text file per sample, with the same faces in each, positions to
 * nine significant digits. Only the lines of positions change; all that follows them is printed
 * once.
 */
#include "base/file.h"
#include "base/serialise.h"
#include "base/text.h"
#include "export/writer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Texture coordinates being numbered: the last of each point, since most points have one
 * alone. */
struct uv_list {
    uint32_t n;         /* coordinates written */
    uint32_t *last;     /* (skin->n) number of the point's last one, from 1; 0: none */
    float (*values)[2]; /* (skin->n) its value */
};

/* Prints a texture coordinate and makes it the last of its point. */
static void add_uv(struct uv_list *list, uint32_t point, const float uv[2],
                   struct cs_text *out) {
    cs_text_add(out, "vt %.9g %.9g\n", (double)uv[0], (double)uv[1]);
    memmove(list->values[point], uv, sizeof *list->values);
    list->last[point] = ++list->n;
}

/* Prints one coordinate per point, in their order, even if a body has none. If no point has
 * two, position and coordinate of a corner then have the same number. Some readers require
 * this, and others would split the corners without it. */
static void list_points(const struct cs_export_mesh *mesh, struct uv_list *list,
                        struct cs_text *out) {
    cs_export_mesh_point_uv(mesh, list->values);
    for (uint32_t i = 0; i < mesh->n; i++)
        add_uv(list, i, list->values[i], out);
}

/* Returns the number of a corner's coordinate; adds it if the point's last one differs. */
static uint32_t number_uv(struct uv_list *list, uint32_t point, const float uv[2],
                          struct cs_text *out) {
    if (memcmp(list->values[point], uv, sizeof *list->values) != 0)
        add_uv(list, point, uv, out);
    return list->last[point];
}

/* Prints a face with numbers from 1; corners without a coordinate have the position alone. */
static void add_face(const struct cs_export_mesh *mesh, uint32_t t, struct uv_list *list,
                     struct cs_text *uvs, struct cs_text *faces) {
    const float *uv = mesh->uv ? mesh->uv + 6 * (size_t)t : NULL;
    cs_text_add(faces, "f");
    for (size_t k = 0; k < 3; k++) {
        const uint32_t point = mesh->triangles[3 * (size_t)t + k];
        if (uv && !isnan(uv[2 * k]))
            cs_text_add(faces, " %u/%u", point + 1, number_uv(list, point, uv + 2 * k, uvs));
        else
            cs_text_add(faces, " %u", point + 1);
    }
    cs_text_add(faces, "\n");
}

/* Prints groups and no objects: readers then make one object of the file and keep the order of
 * its points, which a point cache needs. */
static void add_items(const struct cs_export_mesh *mesh, struct uv_list *list,
                      struct cs_text *uvs, struct cs_text *faces) {
    for (uint32_t b = 0; b < mesh->n_items; b++) {
        cs_text_add(faces, "g %s_%u\n", mesh->item, mesh->items[b]);
        for (uint32_t t = mesh->first_triangle[b]; t < mesh->first_triangle[b + 1]; t++)
            add_face(mesh, t, list, uvs, faces);
        for (uint32_t i = mesh->first_line[b]; i < mesh->first_line[b + 1]; i++)
            cs_text_add(faces, "l %u %u\n", mesh->lines[2 * (size_t)i] + 1,
                        mesh->lines[2 * (size_t)i + 1] + 1);
    }
}

/* Prints all that follows the positions: texture coordinates, a group per body, faces, lines.
 */
static enum cs_status print_tail(const struct cs_export_mesh *mesh, struct cs_text *tail,
                                 struct cs_error *error) {
    struct cs_text faces = {0};
    struct uv_list list = {.last = calloc(mesh->n + 1, sizeof *list.last),
                           .values = calloc(mesh->n + 1, sizeof *list.values)};
    const bool capacity = list.last && list.values;
    if (capacity && mesh->uv)
        list_points(mesh, &list, tail);
    if (capacity) {
        add_items(mesh, &list, tail, &faces);
        cs_text_add(tail, "%s", cs_text_get(&faces));
    }
    if (!capacity || tail->failed || faces.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the faces of OBJ files");
    cs_text_finish(&faces);
    free(list.last);
    free(list.values);
    return error->status;
}

static enum cs_status write_sample(const struct cs_export_mesh *mesh,
                                   const struct cs_text *tail, const char *folder,
                                   const struct cs_export_sample *sample,
                                   struct cs_error *error) {
    char path[CS_EXPORT_PATH];
    struct cs_file_out out;
    const uint64_t *at = mesh->fields[0].words;
    if (cs_export_number(path, folder, mesh->name, sample->number, cs_export_obj.ending,
                         error) ||
        cs_file_create(&out, path, error))
        return error->status;
    /* failures to write are seen by finish */
    fprintf(out.file, "# clothsim: frame %u, t = %.9g s\n", sample->frame, sample->t);
    for (uint32_t i = 0; i < mesh->n; i++, at += 3)
        fprintf(out.file, "v %.9g %.9g %.9g\n", cs_double_from_le64(at[0]),
                cs_double_from_le64(at[1]), cs_double_from_le64(at[2]));
    fwrite(tail->bytes, 1, tail->length, out.file);
    return cs_file_finish(&out, error);
}

static enum cs_status open_files(void *state, const struct cs_export_source *source,
                                 struct cs_arena *arena, struct cs_error *error) {
    struct cs_text *tails = state;
    (void)arena;
    for (int k = 0; k < 2; k++)
        if (source->meshes[k]->n > 0 && print_tail(source->meshes[k], tails + k, error))
            return error->status;
    return CS_OK;
}

static enum cs_status add_obj(void *state, const struct cs_export_source *source,
                              const struct cs_export_sample *sample, struct cs_error *error) {
    const struct cs_text *tails = state;
    for (int k = 0; k < 2; k++)
        if (cs_export_mesh_has_sample(source->meshes[k], sample) &&
            write_sample(source->meshes[k], tails + k, source->settings.folder, sample, error))
            return error->status;
    return CS_OK;
}

static void close_files(void *state) {
    struct cs_text *tails = state;
    for (int k = 0; k < 2; k++)
        cs_text_finish(tails + k);
}

const struct cs_export_writer cs_export_obj = {
    .ending = "obj",
    .size = 2 * sizeof(struct cs_text), /* what follows the points of bodies, of colliders */
    .open = open_files,
    .add = add_obj,
    .close = close_files,
};
