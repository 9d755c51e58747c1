/* Gives each body of a scene its mesh, its network of springs and its shape-matching
 * clusters. */
#include "io/scene_mesh.h"

#include "io/json_path.h"
#include "io/mesh_read.h"
#include "mesh/network.h"
#include "model/system/clusters.h"
#include "scene/shape.h"

#include <stdio.h>

enum {
    LIMBS_DETAIL_MIN = 8,  /* fewer parts lose a limb */
    NETWORK_MAX = 1 << 26, /* springs of a body: about 5 GB with the solver */
};

/* what went wrong, behind the place of a key of body b */
static enum cs_status refuse(struct cs_reader *reader, const struct cs_json *root, uint32_t b,
                             const char *key, enum cs_status status, const char *message) {
    const bool first = !reader->error->status;
    reader->path_length =
        (size_t)snprintf(reader->path, sizeof reader->path, "bodies[%u].%s", b, key);
    cs_reader_fail(reader, cs_json_nearest(root, reader->path), false, "%s", message);
    if (first)
        reader->error->status = status;
    return status;
}

static enum cs_status read_file(const struct cs_scene *scene,
                                const struct cs_mesh_source *source, struct cs_trimesh *mesh,
                                struct cs_arena *arena, struct cs_error *error) {
    struct cs_text path = {0};
    if (!cs_scene_is_below(source->file))
        return cs_fail(error, CS_ERR_SCENE,
                       "found \"%.60s\", expected a file in the scene's folder or below",
                       source->file);
    cs_text_add(&path, "%s/%s", scene->folder, source->file);
    if (path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the mesh \"%s\"", source->file);
    else
        cs_mesh_read(cs_text_get(&path), source->file, source->scale, mesh, arena, error);
    cs_text_finish(&path);
    return error->status;
}

static enum cs_status make_shape(const struct cs_mesh_source *source, struct cs_trimesh *mesh,
                                 struct cs_arena *arena, struct cs_error *error) {
    if (cs_trimesh_make(mesh, (enum cs_mesh_shape)source->shape, (uint32_t)source->detail,
                        arena, error))
        return error->status;
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < mesh->n; i++)
            mesh->places[c * mesh->n + i] *= source->scale[c];
    /* there is no file: what makes a triangle of a shape vanish is its scale */
    if (cs_trimesh_finish(mesh, cs_mesh_shape_names[source->shape], NULL, arena, error) ==
        CS_ERR_FILE)
        error->status = CS_ERR_SCENE;
    return error->status;
}

static enum cs_status make_mesh(struct cs_reader *reader, const struct cs_json *root,
                                struct cs_scene *scene, uint32_t b, struct cs_trimesh *mesh) {
    const struct cs_body *body = cs_scene_bodies(scene) + b;
    const struct cs_mesh_source *source = &body->mesh;
    struct cs_error said = {0};
    if (source->shape == CS_MESH_LIMBS && source->detail < LIMBS_DETAIL_MIN)
        return refuse(reader, root, b, "mesh.detail", CS_ERR_SCENE,
                      "limbs need at least 8, or some are lost");
    /* a bad file is blamed on its name; a degenerate shape can only come from its scale */
    if (*source->file ? read_file(scene, source, mesh, reader->arena, &said)
                      : make_shape(source, mesh, reader->arena, &said))
        return refuse(reader, root, b,
                      *source->file                 ? "mesh.file"
                      : said.status == CS_ERR_SCENE ? "mesh.scale"
                                                    : "mesh.shape",
                      said.status, said.message);
    if (!body->network.present)
        return CS_OK;
    /* network springs run through the inside, which an open mesh does not have */
    if (mesh->n_open) {
        char message[160];
        snprintf(
            message, sizeof message,
            "the mesh is open: %u of its %u edges have one triangle, expected a closed one",
            mesh->n_open, mesh->n_edges);
        return refuse(reader, root, b, "network", CS_ERR_SCENE, message);
    }
    if (mesh->n * body->network.springs > NETWORK_MAX)
        return refuse(reader, root, b, "network.springs", CS_ERR_SCENE,
                      "more than 67108864 springs in all");
    return cs_network_make(&body->network, mesh, reader->arena, reader->error);
}

/* the parts of a body that shape matching keeps */
static enum cs_status cut_body(struct cs_reader *reader, const struct cs_json *root,
                               struct cs_scene *scene, uint32_t b) {
    struct cs_body *body = cs_scene_bodies(scene) + b;
    struct cs_shape_matching *matching = &body->shape_matching;
    const int64_t most = cs_shape_count(body) / CS_CLUSTER_LEAST;
    /* a cloth beyond the memory is refused by the check */
    if (!matching->present || (double)cs_shape_count(body) > CS_PARTICLES_MAX)
        return CS_OK;
    if (matching->clusters > 1 && matching->clusters > most) {
        char message[160];
        snprintf(message, sizeof message,
                 "found %lld, expected at most %lld: a part has %d particles or more",
                 (long long)matching->clusters, (long long)(most > 1 ? most : 1),
                 CS_CLUSTER_LEAST);
        return refuse(reader, root, b, "shape_matching.clusters", CS_ERR_SCENE, message);
    }
    struct cs_clusters *parts = cs_arena_take(reader->arena, sizeof *parts, reader->error);
    if (!parts)
        return reader->error->status;
    matching->parts = parts;
    return cs_clusters_make(body, parts, reader->arena, reader->error);
}

static enum cs_status read_mesh(struct cs_reader *reader, const struct cs_json *root,
                                struct cs_scene *scene, uint32_t b) {
    const size_t before = reader->arena->used;
    struct cs_trimesh *mesh = cs_arena_take(reader->arena, sizeof *mesh, reader->error);
    if (!mesh)
        return reader->error->status;
    cs_scene_bodies(scene)[b].mesh.geometry = mesh;
    const enum cs_status status = make_mesh(reader, root, scene, b, mesh);
    mesh->bytes = reader->arena->used - before;
    return status;
}

enum cs_status cs_scene_read_meshes(struct cs_reader *reader, const struct cs_json *root,
                                    struct cs_scene *scene) {
    double particles = 0;
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        const struct cs_body *body = cs_scene_bodies(scene) + b;
        /* a body of two shapes or none is refused by the check */
        if (body->mesh.present == body->cloth.present)
            continue;
        if (body->mesh.present && read_mesh(reader, root, scene, b))
            return reader->error->status;
        particles += body->mesh.present ? body->mesh.geometry->n : 0;
        if (particles > CS_PARTICLES_MAX)
            return refuse(reader, root, b, "mesh", CS_ERR_SCENE,
                          "more particles in the meshes so far than a scene may have");
        if (cut_body(reader, root, scene, b))
            return reader->error->status;
    }
    return CS_OK;
}
