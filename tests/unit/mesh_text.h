/* mesh_text.h - reads OBJ texts for tests. */
#ifndef MESH_TEXT_H
#define MESH_TEXT_H

#include "scene/file/mesh_read.h"
#include "scene/mesh_keys.h"
#include "unit.h"

static const struct cs_mesh_source plain = {.scale = {1, 1, 1}, .weld = true};

static inline enum cs_status read_obj(const char *text, const struct cs_mesh_source *source,
                                      struct cs_trimesh *mesh, struct cs_arena *arena,
                                      struct cs_error *error) {
    *mesh = (struct cs_trimesh){0};
    return cs_mesh_read_text("m.obj", text, strlen(text), source, mesh, arena, error);
}

/* Reads a text that must be sound; the caller finishes the arena. */
static inline void read_sound(const char *text, const struct cs_mesh_source *source,
                              struct cs_trimesh *mesh, struct cs_arena *arena) {
    struct cs_error error = {0};
    *arena = (struct cs_arena){0};
    read_obj(text, source, mesh, arena, &error);
    UNIT_ASSERT_OK(&error);
}

static inline double area_of(const struct cs_trimesh *mesh) {
    double sum = 0;
    for (uint32_t i = 0; i < mesh->n; i++)
        sum += mesh->area[i];
    return sum;
}

#define TETRAHEDRON                                                                            \
    "# four corners\r\no thing\ns off\nmtllib x y\n\n"                                         \
    "v 0 0 0\nv\t1 0 0 # behind\nv 0 1 0\r\nv 0 0 1e0\n"
#define SQUARE "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n"
#define FACES  "f 1 2 3\nf 1 3 4\n"

#endif
