/* Makes the mesh of each body and collider of a scene, and bodies' spring networks and clusters
 * of shape matching. */

#include "mesh/spring_network.h"
#include "mesh/vertex_paths.h"
#include "model/system/shape_clusters.h"
#include "scene/body_keys.h"
#include "scene/body_particles.h"
#include "scene/collider_keys.h"
#include "scene/file/json_context.h"
#include "scene/file/key_frames_read.h"
#include "scene/file/mesh_read.h"
#include "scene/mesh_keys.h"

#include <stdio.h>

enum {
    LIMBS_DETAIL_MIN = 8,  /* fewer parts lose a limb */
    NETWORK_MAX = 1 << 26, /* springs of a body: about 5 GB with the solver */
};

/* One element of `bodies` or `colliders`, for messages. */
struct item {
    struct cs_json_context *reader;
    const struct cs_json *root;
    const char *list;
    uint32_t number;
};

/* Fails with a message at the position of a key of the item, with the status of the cause. */
static enum cs_status refuse_mesh(const struct item *item, const char *key,
                                  enum cs_status status, const char *message) {
    struct cs_json_context *context = item->reader;
    const bool first = !context->error->status;
    context->path_length = (size_t)snprintf(context->path, sizeof context->path, "%s[%u].%s",
                                            item->list, item->number, key);
    cs_json_context_fail(context, cs_json_nearest(item->root, context->path), false, "%s",
                         message);
    if (first)
        context->error->status = status;
    return status;
}

/* Reads a mesh file, which must lie in the scene's folder or below. */
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
        cs_mesh_read(cs_text_get(&path), source->file, source, mesh, arena, error);
    cs_text_finish(&path);
    return error->status;
}

/* Makes and scales a generated shape. */
static enum cs_status make_shape(const struct cs_mesh_source *source, struct cs_trimesh *mesh,
                                 struct cs_arena *arena, struct cs_error *error) {
    if (cs_trimesh_make(mesh, (enum cs_mesh_shape)source->shape, (uint32_t)source->detail,
                        arena, error))
        return error->status;
    for (size_t i = 0; i < mesh->n; i++) {
        double *x = mesh->positions + i, p[3] = {x[0], x[mesh->n], x[2 * (size_t)mesh->n]};
        cs_mesh_to_scene(source, p, p);
        for (size_t c = 0; c < 3; c++)
            x[c * mesh->n] = p[c];
    }
    /* there is no file: what makes a triangle of a shape vanish is its scale */
    if (cs_trimesh_finish(mesh, cs_mesh_shape_names[source->shape], NULL, arena, error) ==
        CS_ERR_FILE)
        error->status = CS_ERR_SCENE;
    return error->status;
}

/* Makes the mesh of an item from its file or shape. */
static enum cs_status make_mesh(const struct item *item, const struct cs_scene *scene,
                                const struct cs_mesh_source *source, struct cs_trimesh *mesh) {
    struct cs_arena *arena = item->reader->arena;
    struct cs_error said = {0};
    if (source->shape == CS_MESH_LIMBS && source->detail < LIMBS_DETAIL_MIN)
        return refuse_mesh(item, "mesh.detail", CS_ERR_SCENE,
                           "limbs need at least 8, or some are lost");
    /* a bad file is blamed on its name; a degenerate shape can only come from its scale */
    if (*source->file ? read_file(scene, source, mesh, arena, &said)
                      : make_shape(source, mesh, arena, &said))
        return refuse_mesh(item,
                           *source->file                 ? "mesh.file"
                           : said.status == CS_ERR_SCENE ? "mesh.scale"
                                                         : "mesh.shape",
                           said.status, said.message);
    return CS_OK;
}

/* Makes the inner springs; an open mesh has no inside. */
static enum cs_status make_network(const struct item *item,
                                   const struct cs_spring_network *network,
                                   struct cs_trimesh *mesh) {
    if (mesh->n_open) {
        char message[160];
        snprintf(
            message, sizeof message,
            "the mesh is open: %u of its %u edges have one triangle, expected a closed one",
            mesh->n_open, mesh->n_edges);
        return refuse_mesh(item, "network", CS_ERR_SCENE, message);
    }
    if (mesh->n * network->springs > NETWORK_MAX)
        return refuse_mesh(item, "network.springs", CS_ERR_SCENE,
                           "more than 67108864 springs in total");
    return cs_spring_network_make(network, mesh, item->reader->arena, item->reader->error);
}

/* Divides a body into the clusters of shape matching. */
static enum cs_status split_body(const struct item *item, struct cs_body *body) {
    struct cs_json_context *context = item->reader;
    struct cs_shape_matching *matching = &body->shape_matching;
    const int64_t most = cs_body_count(body) / CS_SHAPE_CLUSTER_SIZE_MIN;
    /* a cloth beyond the memory is refused by the check */
    if (!matching->present || (double)cs_body_count(body) > CS_PARTICLES_MAX)
        return CS_OK;
    if (matching->clusters > 1 && matching->clusters > most) {
        char message[160];
        snprintf(message, sizeof message,
                 "found %lld, expected at most %lld: a cluster has %d particles or more",
                 (long long)matching->clusters, (long long)(most > 1 ? most : 1),
                 CS_SHAPE_CLUSTER_SIZE_MIN);
        return refuse_mesh(item, "shape_matching.clusters", CS_ERR_SCENE, message);
    }
    struct cs_shape_clusters *parts =
        cs_arena_alloc(context->arena, sizeof *parts, context->error);
    if (!parts)
        return context->error->status;
    matching->parts = parts;
    return cs_shape_clusters_make(body, parts, context->arena, context->error);
}

/* Reads the key frames of a mesh that is there, if it has any. */
static enum cs_status read_key_frames(const struct item *item, const struct cs_scene *scene,
                                      struct cs_collider *collider) {
    struct cs_arena *arena = item->reader->arena;
    const size_t before = arena->used;
    struct cs_error said = {0};
    if (!collider->mesh->key_frames.present)
        return CS_OK;
    struct cs_vertex_paths *paths = cs_arena_alloc(arena, sizeof *paths, item->reader->error);
    if (!paths)
        return item->reader->error->status;
    if (cs_key_frames_read(scene->folder, collider, paths, arena, &said))
        return refuse_mesh(item, "mesh.key_frames.file", said.status, said.message);
    paths->bytes = arena->used - before;
    collider->paths = paths;
    return CS_OK;
}

/* Makes the mesh of an item in *geometry, and its spring network unless that is NULL or absent;
 * records the memory of both. */
static enum cs_status read_mesh(const struct item *item, const struct cs_scene *scene,
                                const struct cs_mesh_source *source,
                                const struct cs_spring_network *network,
                                const struct cs_trimesh **geometry) {
    struct cs_arena *arena = item->reader->arena;
    const size_t before = arena->used;
    struct cs_trimesh *mesh = cs_arena_alloc(arena, sizeof *mesh, item->reader->error);
    if (!mesh)
        return item->reader->error->status;
    *geometry = mesh;
    enum cs_status status = make_mesh(item, scene, source, mesh);
    if (!status && network && network->present)
        status = make_network(item, network, mesh);
    mesh->bytes = arena->used - before;
    return status;
}

/* Makes mesh and clusters of a body; *particles: of the meshes so far, to refuse too many
 * before memory runs out. */
static enum cs_status read_body(const struct item *item, const struct cs_scene *scene,
                                struct cs_body *body, double *particles) {
    /* a body of two shapes or none is refused by the check */
    if ((body->mesh != NULL) == body->cloth.present)
        return CS_OK;
    if (body->mesh && read_mesh(item, scene, body->mesh, &body->network, &body->geometry))
        return item->reader->error->status;
    *particles += body->mesh ? body->geometry->n : 0;
    if (*particles > CS_PARTICLES_MAX)
        return refuse_mesh(item, "mesh", CS_ERR_SCENE,
                           "more particles in the meshes so far than a scene may have");
    return split_body(item, body);
}

enum cs_status cs_scene_read_meshes(struct cs_json_context *context, const struct cs_json *root,
                                    struct cs_scene *scene) {
    double particles = 0;
    for (uint32_t b = 0; b < scene->bodies.n; b++) {
        const struct item item = {context, root, "bodies", b};
        if (read_body(&item, scene, cs_scene_bodies(scene) + b, &particles))
            return context->error->status;
    }
    for (uint32_t c = 0; c < scene->colliders.n; c++) {
        const struct item item = {context, root, "colliders", c};
        struct cs_collider *of = cs_scene_colliders(scene) + c;
        if (of->mesh && (read_mesh(&item, scene, of->mesh, NULL, &of->geometry) ||
                         read_key_frames(&item, scene, of)))
            return context->error->status;
    }
    return CS_OK;
}
