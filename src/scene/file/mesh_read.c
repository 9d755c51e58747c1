/* Makes the mesh of a scene from an OBJ file. */
#include "scene/file/mesh_read.h"

#include "base/file.h"
#include "scene/collider_keys.h"
#include "scene/mesh_keys.h"

#include <stdlib.h>
#include <string.h>

enum { MESH_BYTES_MAX = 1 << 30 };

void cs_mesh_to_scene(const struct cs_mesh_source *source, const double p[3], double out[3]) {
    static const double metres[] = {1, 0.01, 0.001, 0.0254, 0.3048};
    double q[3];
    for (int c = 0; c < 3; c++)
        q[c] = p[c] * source->scale[c] * metres[source->units];
    const bool turned = source->up == CS_MESH_UP_Z;
    out[0] = q[0];
    out[1] = turned ? q[2] : q[1];
    out[2] = turned ? -q[1] : q[2];
}

/* Keeps the triangles of one name; returns false if there are none. */
static bool keep_set(struct cs_obj *obj, const char *set) {
    struct cs_raw_mesh *raw = &obj->mesh;
    uint32_t n = 0;
    for (uint32_t t = 0; t < raw->n_triangles; t++)
        if (cs_mesh_has_label(obj->labels, raw->triangles[t].labels, set))
            raw->triangles[n++] = raw->triangles[t];
    raw->n_triangles = n;
    return n > 0;
}

/* Copies what was read and mended into the mesh. */
static enum cs_status copy_mesh(const struct cs_obj *obj, const struct cs_mesh_source *source,
                                struct cs_trimesh *mesh, struct cs_arena *arena,
                                struct cs_error *error) {
    const struct cs_raw_mesh *raw = &obj->mesh;
    if (cs_trimesh_init(mesh, raw->n_vertices, raw->n_triangles, obj->is_textured, arena,
                        error))
        return error->status;
    CS_ARENA_ARRAY(arena, mesh->file_vertex, raw->n_vertices, error);
    if (!mesh->file_vertex)
        return error->status;
    for (size_t i = 0; i < raw->n_vertices; i++) {
        double p[3];
        cs_mesh_to_scene(source, raw->positions[i], p);
        for (size_t c = 0; c < 3; c++)
            mesh->positions[c * raw->n_vertices + i] = p[c];
        mesh->file_vertex[i] = raw->sources[i];
    }
    for (size_t t = 0; t < raw->n_triangles; t++)
        for (size_t k = 0; k < 3; k++) {
            const struct cs_raw_corner *corner = raw->triangles[t].corners + k;
            mesh->triangles[3 * t + k] = corner->vertex;
            if (!corner->uv)
                continue;
            /* an OBJ's rows are counted from the bottom, a picture's from the top */
            mesh->uv[6 * t + 2 * k] = (float)raw->uv[corner->uv - 1][0];
            mesh->uv[6 * t + 2 * k + 1] = (float)(1 - raw->uv[corner->uv - 1][1]);
        }
    return CS_OK;
}

/* Copies the labels, if there are any. */
static enum cs_status copy_labels(const struct cs_obj *obj, struct cs_trimesh *mesh,
                                  struct cs_arena *arena, struct cs_error *error) {
    if (!obj->n_labels)
        return CS_OK;
    struct cs_mesh_label *labels =
        cs_arena_alloc_array(arena, obj->n_labels, sizeof *labels, error);
    CS_ARENA_ARRAY(arena, mesh->triangle_labels, mesh->n_triangles, error);
    if (!labels || !mesh->triangle_labels)
        return error->status;
    memcpy(labels, obj->labels, obj->n_labels * sizeof *labels);
    for (size_t t = 0; t < mesh->n_triangles; t++)
        memcpy(mesh->triangle_labels[t], obj->mesh.triangles[t].labels,
               sizeof *mesh->triangle_labels);
    mesh->labels = labels;
    mesh->n_labels = obj->n_labels;
    return CS_OK;
}

/* Stores in words what was mended and passed over. */
static enum cs_status copy_mends(const struct cs_obj *obj, struct cs_trimesh *mesh,
                                 struct cs_arena *arena, struct cs_error *error) {
    struct cs_text words = {0};
    cs_mesh_mends_print(&obj->mends, &words);
    if (obj->n_skipped)
        cs_text_add(&words, "%s%u line%s of other programs passed over",
                    words.length ? ", " : "", obj->n_skipped, obj->n_skipped == 1 ? "" : "s");
    if (obj->skipped.length)
        cs_text_add(&words, " (%.*s)", (int)obj->skipped.length - 3,
                    cs_text_get(&obj->skipped) + 2);
    mesh->pieces = obj->mends.pieces;
    mesh->mends = words.failed ? NULL : cs_arena_copy_text(arena, cs_text_get(&words), error);
    if (words.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a mesh");
    cs_text_finish(&words);
    return error->status;
}

static void hash_faces(const struct cs_obj *obj, char digits[CS_HASH_DIGITS]) {
    cs_hash_bytes(obj->face_list, obj->n_face_list * sizeof *obj->face_list, digits);
}

/* Finishes the mesh, whose messages name the lines of faces. */
static enum cs_status finish_mesh(const struct cs_obj *obj, const char *name,
                                  struct cs_trimesh *mesh, struct cs_arena *arena,
                                  struct cs_error *error) {
    uint32_t *lines = calloc((size_t)mesh->n_triangles + 1, sizeof *lines);
    if (!lines)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", name);
    for (uint32_t t = 0; t < mesh->n_triangles; t++)
        lines[t] = obj->mesh.triangles[t].line;
    cs_trimesh_finish(mesh, name, lines, arena, error);
    free(lines);
    return error->status;
}

/* All of cs_mesh_read_text but the release of temporary memory. */
static enum cs_status make_mesh(struct cs_obj *obj, const char *name,
                                const struct cs_mesh_source *source, struct cs_trimesh *mesh,
                                struct cs_arena *arena, struct cs_error *error) {
    const uint32_t n_file = obj->mesh.n_vertices;
    if (*source->set && !keep_set(obj, source->set))
        return cs_fail(error, CS_ERR_FILE,
                       "%s: found no group, object or material \"%.60s\" with faces", name,
                       source->set);
    if (cs_mesh_mend(&obj->mesh, source->weld, &obj->mends, error))
        return error->status;
    /* the vertices of other sets are no fault */
    obj->mends.loose = *source->set ? 0 : obj->mends.loose;
    if (copy_mesh(obj, source, mesh, arena, error) || copy_labels(obj, mesh, arena, error) ||
        copy_mends(obj, mesh, arena, error))
        return error->status;
    if (!mesh->n_triangles)
        return cs_fail(error, CS_ERR_FILE, "%s: found no faces%s%s", name,
                       *mesh->mends ? ": " : "", mesh->mends);
    mesh->n_file = n_file;
    hash_faces(obj, mesh->faces_hash);
    return finish_mesh(obj, name, mesh, arena, error);
}

enum cs_status cs_mesh_read_text(const char *name, const char *text, size_t length,
                                 const struct cs_mesh_source *source, struct cs_trimesh *mesh,
                                 struct cs_arena *arena, struct cs_error *error) {
    struct cs_obj obj = {0};
    if (!cs_obj_read(name, text, length, &obj, arena, error))
        make_mesh(&obj, name, source, mesh, arena, error);
    cs_obj_finish(&obj);
    return error->status;
}

enum cs_status cs_mesh_read(const char *path, const char *name,
                            const struct cs_mesh_source *source, struct cs_trimesh *mesh,
                            struct cs_arena *arena, struct cs_error *error) {
    char *text;
    size_t length;
    if (!cs_file_read(path, MESH_BYTES_MAX, &text, &length, error) &&
        !cs_mesh_read_text(name, text, length, source, mesh, arena, error))
        cs_hash_bytes(text, length, mesh->file_hash);
    free(text);
    return error->status;
}

/* The hash of the faces of a mesh of no file. */
static enum cs_status hash_triangles(const struct cs_trimesh *mesh, char digits[CS_HASH_DIGITS],
                                     struct cs_error *error) {
    uint32_t *list = calloc(4 * (size_t)mesh->n_triangles + 1, sizeof *list);
    if (!list)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a mesh");
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        memcpy(list + 4 * t, mesh->triangles + 3 * t, 3 * sizeof *list);
        list[4 * t + 3] = UINT32_MAX;
    }
    cs_hash_bytes(list, 4 * (size_t)mesh->n_triangles * sizeof *list, digits);
    free(list);
    return CS_OK;
}

/* Sets positions from a file that was read, if it has the faces of the mesh. */
static enum cs_status copy_positions(const struct cs_obj *obj, const char *name,
                                     const struct cs_collider *collider, double *positions,
                                     struct cs_error *error) {
    const struct cs_trimesh *mesh = collider->geometry;
    const uint32_t expected = mesh->n_file ? mesh->n_file : mesh->n;
    char hash[CS_HASH_DIGITS], found[CS_HASH_DIGITS];
    if (obj->mesh.n_vertices != expected)
        return cs_fail(error, CS_ERR_FILE, "%s: found %u vertices, expected the %u of the mesh",
                       name, obj->mesh.n_vertices, expected);
    memcpy(hash, mesh->faces_hash, sizeof hash);
    if (!*hash && hash_triangles(mesh, hash, error))
        return error->status;
    /* cut or mended differently, the same faces would move the vertices to other places */
    hash_faces(obj, found);
    if (strcmp(found, hash))
        return cs_fail(error, CS_ERR_FILE, "%s: found other faces than those of the mesh",
                       name);
    for (size_t i = 0; i < mesh->n; i++) {
        double p[3];
        cs_mesh_to_scene(collider->mesh,
                         obj->mesh.positions[mesh->file_vertex ? mesh->file_vertex[i] : i], p);
        for (size_t c = 0; c < 3; c++)
            positions[c * mesh->n + i] = p[c];
    }
    return CS_OK;
}

enum cs_status cs_mesh_read_positions(const char *path, const char *name,
                                      const struct cs_collider *collider, double *positions,
                                      char file_hash[CS_HASH_DIGITS], struct cs_error *error) {
    char *text;
    size_t length;
    struct cs_obj obj = {0};
    struct cs_arena names = {0};
    if (!cs_file_read(path, MESH_BYTES_MAX, &text, &length, error) &&
        !cs_obj_read(name, text, length, &obj, &names, error) &&
        !copy_positions(&obj, name, collider, positions, error))
        cs_hash_bytes(text, length, file_hash);
    free(text);
    cs_obj_finish(&obj);
    cs_arena_finish(&names);
    return error->status;
}
