/* scene_mesh.h - makes the meshes of a scene (files, shapes, spring networks) and the clusters
 * of shape matching. */
#ifndef CS_SCENE_MESH_H
#define CS_SCENE_MESH_H

#include "scene/file/json_context.h"
#include "scene/scene.h"

/* Fills the geometry of every mesh of bodies and colliders, and the clusters of every matched
 * body, of a scene whose tables were read; root gives positions for messages. CS_ERR_SCENE,
 * CS_ERR_FILE (a mesh file) or CS_ERR_MEMORY. */
enum cs_status cs_scene_read_meshes(struct cs_json_context *context, const struct cs_json *root,
                                    struct cs_scene *scene);

#endif
