/* The rows of meshes, of key frames and of a placement, which bodies and colliders share. */
#include "scene/mesh_keys.h"
#include "scene/scene.h"
#include "scene/table_rows.h"

#include "mesh/trimesh.h"
#include "mesh/vertex_paths.h"

static const double zero3[3] = {0, 0, 0};
static const double no_turn[4] = {0, 0, 0, 1};
static const double absent9[9] = {ABSENT, ABSENT, ABSENT, ABSENT, ABSENT,
                                  ABSENT, ABSENT, ABSENT, ABSENT};

static const struct cs_option place_rows[] = {
    VECTOR(struct cs_pose, translate, 3, "m", zero3, -BIG, BIG,
           "translation, after the rotation"),
    VECTOR(struct cs_pose, rotate, 4, "", no_turn, -BIG, BIG,
           "rotation as a quaternion x, y, z, w of any length"),
    VECTOR(struct cs_pose, matrix, 9, "", absent9, -1, 1,
           "rotation as the rows of a matrix, instead of rotate"),
};
const struct cs_table cs_pose_table = {ROWS(place_rows), .size = sizeof(struct cs_pose)};

const char *const cs_mesh_shape_names[] = {"box", "sphere", "torus", "limbs", NULL};
static const double one3[3] = {1, 1, 1};
static const char *const paths_end_names[] = {"hold", "loop", "continue", NULL};
static const struct cs_option key_frames_rows[] = {
    TEXT(struct cs_key_frames, file,
         "relative to the scene file, with the vertices of the mesh in its order: a PC2 file, "
         "an NPZ file of numpy.savez, or OBJ files with the faces of the mesh, named with one "
         "# for each digit of their number (walk_###.obj)"),
    TEXT(struct cs_key_frames, array,
         "name of the array (key frames, vertices, 3) in an NPZ file; positions if absent"),
    INT(struct cs_key_frames, first, "", 0, 0, 1e9, "number of the first OBJ file"),
    INT(struct cs_key_frames, count, "", 0, 0, 1e6, "of OBJ files: how many there are"),
    REAL(struct cs_key_frames, rate, "1/s", 24, 1e-3, 1e6, "key frames per second"),
    REAL(struct cs_key_frames, start, "s", 0, -BIG, BIG, "time of the first key frame"),
    CHOICE(struct cs_key_frames, end, paths_end_names, CS_PATHS_HOLD,
           "before the first and after the last key frame. hold: at rest; loop: the first "
           "follows the last; continue: on with the velocities of the end"),
};
static const struct cs_table key_frames_table = {
    ROWS(key_frames_rows), .size = sizeof(struct cs_key_frames), .optional = true};

static const char *const unit_names[] = {"m", "cm", "mm", "in", "ft", NULL};
static const char *const up_names[] = {"y", "z", NULL};
/* the first row is of colliders alone, the last two are of bodies alone */
static const struct cs_option mesh_rows[] = {
    TABLE(struct cs_mesh_source, key_frames, key_frames_table,
          "positions of the vertices at equal intervals of time, instead of those of file or "
          "shape; between them, a cubic spline"),
    TEXT(struct cs_mesh_source, set,
         "of a file: the group, object or material whose faces are read; all if absent"),
    TEXT(struct cs_mesh_source, file, "OBJ file, relative to the scene file"),
    CHOICE(
        struct cs_mesh_source, shape, cs_mesh_shape_names, -1,
        "generated: fits a cube of side 1 about the origin; limbs: a rounded body with head, "
        "ears, arms and legs"),
    INT(struct cs_mesh_source, detail, "", 12, 3, CS_MESH_DETAIL_MAX,
        "subdivisions of a shape: of an edge of the box, of an edge of the icosahedron that "
        "becomes the sphere, round the torus's tube, or of the height of limbs"),
    VECTOR(struct cs_mesh_source, scale, 3, "", one3, 1e-6, 1e6,
           "factor on the coordinates of file or shape, before the placement"),
    CHOICE(struct cs_mesh_source, units, unit_names, CS_MESH_M,
           "unit of the scaled coordinates; the scene's is the metre"),
    CHOICE(struct cs_mesh_source, up, up_names, CS_MESH_UP_Y,
           "axis of the file that becomes the scene's y; z: x, y, z become x, z, -y"),
    BOOL(struct cs_mesh_source, weld, 1,
         "join doubled vertices of a file where open edges lie in one place"),
    TABLE(struct cs_mesh_source, place, cs_pose_table, "rigid placement, about the origin"),
    VECTOR(struct cs_mesh_source, velocity, 3, "m/s", zero3, -BIG, BIG,
           "of every particle that is not pinned, at time 0"),
    VECTOR(struct cs_mesh_source, spin, 3, "rad/s", zero3, -BIG, BIG,
           "about place.translate, added to the velocity"),
};
enum { N_MESH_ROWS = sizeof mesh_rows / sizeof *mesh_rows };
const struct cs_table cs_mesh_table = {.rows = mesh_rows + 1,
                                       .n = N_MESH_ROWS - 1,
                                       .size = sizeof(struct cs_mesh_source),
                                       .optional = true,
                                       .apart = true,
                                       .one_of = true,
                                       .n_always_optional = 1};
/* events and key frames move a collider */
const struct cs_table cs_mesh_keys = {.rows = mesh_rows,
                                      .n = N_MESH_ROWS - 2,
                                      .size = sizeof(struct cs_mesh_source),
                                      .optional = true,
                                      .apart = true,
                                      .one_of = true,
                                      .n_always_optional = 2};
