/* Turns the particles of a body into vertices, normals and texture coordinates. */
#include "draw/mesh.h"

#include "draw/look.h"
#include "draw/matrix.h"
#include "mesh/trimesh.h"
#include "model/system/surfaces.h"
#include "scene/body_keys.h"
#include "scene/mesh_keys.h"
#include "scene/picture_keys.h"

// m: positions farther away are drawn at this bound, because they would upset the rasteriser
static const double bound = 1e5;

void cs_mesh_position(uint32_t n, const double *x, uint32_t i, double place[3]) {
    for (uint32_t axis = 0; axis < 3; axis++) {
        const double c = x[(size_t)axis * n + i];
        // a comparison with NAN is false, which leaves 0
        place[axis] = c > bound ? bound : c < -bound ? -bound : c == c ? c : 0;
    }
}

/* A tenth of the body's diagonal at the start. It does not depend on the grid, so folds look
 * equally deep on a finer one. */
static double reach_of(const struct cs_system *system, const struct cs_body_range *range) {
    double square = 0;
    for (size_t c = 0; c < 3; c++) {
        const double *x = system->view.start + c * system->view.n + range->first;
        double low = x[0], high = x[0];
        for (uint32_t i = 1; i < range->count; i++) {
            low = fmin(low, x[i]);
            high = fmax(high, x[i]);
        }
        square += (high - low) * (high - low);
    }
    return 0.1 * sqrt(square);
}

// side 0..5 of a box that a triangle lies on: the axis of its normal, and its sign
static uint8_t side_of(const struct cs_trimesh *box, uint32_t triangle) {
    double normal[3];
    int axis = 0;
    cs_trimesh_normal(box, triangle, box->positions, box->n, 0, normal);
    for (int i = 1; i < 3; i++)
        if (fabs(normal[i]) > fabs(normal[axis]))
            axis = i;
    return (uint8_t)(2 * axis + (normal[axis] < 0));
}

static enum cs_status init_creases(struct cs_mesh *mesh, struct cs_arena *arena,
                                   struct cs_error *error) {
    const uint32_t n = mesh->n_indices / 3;
    mesh->face_normals = cs_arena_alloc_array(arena, n, 3 * sizeof *mesh->face_normals, error);
    mesh->box_faces = cs_arena_alloc_array(arena, n, sizeof *mesh->box_faces, error);
    for (uint32_t t = 0; error->status == CS_OK && t < n; t++)
        mesh->box_faces[t] = side_of(mesh->range.mesh, t);
    return error->status;
}

enum cs_status cs_mesh_init(struct cs_mesh *mesh, const struct cs_system *system, uint32_t body,
                            bool textured, struct cs_arena *arena, struct cs_error *error) {
    const struct cs_body_range *range = system->bodies + body;
    const enum cs_look_colours colours = cs_look_of(system->scene->render->look)->colours;
    const bool marked = colours == CS_COLOURS_CROSSINGS;
    const struct cs_material *material = &cs_scene_bodies(system->scene)[body].material;
    mesh->range = *range;
    mesh->faces = textured && colours == CS_COLOURS_MATERIAL && material->faces.n
                      ? &material->faces
                      : NULL;
    mesh->flat_shading = material->shading == CS_SHADING_FLAT;
    // only boxes have creases: other shapes are smooth
    const struct cs_mesh_source *source = cs_scene_bodies(system->scene)[body].mesh;
    mesh->has_creases = !mesh->flat_shading && source && source->shape == CS_MESH_BOX;
    mesh->split_vertices = mesh->flat_shading || mesh->has_creases || marked ||
                           (textured && range->mesh && (range->mesh->uv || mesh->faces));
    mesh->has_curvature =
        colours == CS_COLOURS_MATERIAL && !mesh->flat_shading && !mesh->has_creases;
    mesh->curvature_radius = reach_of(system, range);
    if (mesh->has_curvature)
        mesh->neighbour_sums =
            cs_arena_alloc_array(arena, range->count, 4 * sizeof *mesh->neighbour_sums, error);
    mesh->first_triangle = marked ? system->surfaces->first_triangle[body] : 0;
    mesh->n_indices = 3 * cs_faces_count(range);
    mesh->n_vertices = mesh->split_vertices ? mesh->n_indices : range->count;
    CS_ARENA_ARRAY(arena, mesh->vertices, mesh->n_vertices, error);
    mesh->indices = cs_arena_alloc_array(arena, mesh->n_indices, sizeof *mesh->indices, error);
    mesh->normals =
        cs_arena_alloc_array(arena, mesh->has_creases ? mesh->n_indices : range->count,
                             3 * sizeof *mesh->normals, error);
    for (uint32_t t = 0; error->status == CS_OK && 3 * t < mesh->n_indices; t++)
        cs_face_corners(range, t, mesh->indices + 3 * (size_t)t);
    return error->status || !mesh->has_creases ? error->status
                                               : init_creases(mesh, arena, error);
}

/* Corners and normal of a triangle of particles, as long as twice its area. */
static void triangle_normal(const struct cs_mesh *mesh, uint32_t n, const double *x,
                            const uint32_t *corner, double p[3][3], double normal[3]) {
    double along[3], across[3];
    for (int i = 0; i < 3; i++)
        cs_mesh_position(n, x, mesh->range.first + corner[i], p[i]);
    cs_subtract(p[1], p[0], along);
    cs_subtract(p[2], p[0], across);
    cs_vec3_cross(along, across, normal);
}

/* Fills a vertex; the normal is made a unit vector. */
static void set_vertex(struct cs_vertex *vertex, const double place[3], const double normal[3],
                       double value) {
    double unit[3] = {normal[0], normal[1], normal[2]};
    cs_normalise(unit);
    // a collapsed triangle has no normal: any will do, but not zero
    if (cs_vec3_dot(unit, unit) == 0)
        unit[2] = 1;
    for (int i = 0; i < 3; i++) {
        vertex->position[i] = (float)place[i];
        vertex->normal[i] = (float)unit[i];
    }
    vertex->value = (float)value;
}

/* Sums the vectors from each particle to its neighbours, and their squares, over the sides of a
 * triangle: an inner edge counts twice, which cancels in groove_slope. */
static void add_sides(const struct cs_mesh *mesh, const uint32_t *corner, double p[3][3]) {
    // each side of the triangle is a way for both of its ends
    for (uint32_t c = 0; c < 3; c++) {
        double *from = mesh->neighbour_sums + 4 * (size_t)corner[c];
        double *to = mesh->neighbour_sums + 4 * (size_t)corner[(c + 1) % 3];
        for (int i = 0; i < 3; i++) {
            const double way = p[(c + 1) % 3][i] - p[c][i];
            from[i] += way;
            to[i] -= way;
            from[3] += way * way;
            to[3] += way * way;
        }
    }
}

/* Slope of the groove that fits the neighbours of particle i. In a groove z = k s^2 / 2 a
 * neighbour at distance L in a random direction lies k L^2 / 4 above the bottom on average. The
 * sum of the vectors to neighbours along the normal over the sum of L^2 is thus k / 4. The
 * chord of the groove out to the radius R rises by k R^2 / 2, a slope of k R / 2. */
static double groove_slope(const struct cs_mesh *mesh, uint32_t i) {
    const double *normal = mesh->normals + 3 * (size_t)i,
                 *ways = mesh->neighbour_sums + 4 * (size_t)i;
    const double length = cs_vec3_length(normal) * ways[3];
    return length > 0 ? 2 * mesh->curvature_radius * cs_vec3_dot(normal, ways) / length : 0;
}

/* A value as a fraction 0..1 of its range; 0 if there is none. */
static double scaled(const double *values, uint32_t i, const double range[2]) {
    if (!values || !(range[1] > range[0]))
        return 0;
    const double t = (values[i] - range[0]) / (range[1] - range[0]);
    return t > 1 ? 1 : t > 0 ? t : 0;
}

/* Sums the normals of the triangles at each particle, and the sides for its curvature. */
static void sum_normals(struct cs_mesh *mesh, uint32_t n, const double *x) {
    memset(mesh->normals, 0, 3 * sizeof *mesh->normals * mesh->range.count);
    if (mesh->has_curvature)
        memset(mesh->neighbour_sums, 0, 4 * sizeof *mesh->neighbour_sums * mesh->range.count);
    for (uint32_t k = 0; k < mesh->n_indices; k += 3) {
        double p[3][3], normal[3];
        triangle_normal(mesh, n, x, mesh->indices + k, p, normal);
        if (mesh->has_curvature)
            add_sides(mesh, mesh->indices + k, p);
        for (uint32_t corner = 0; corner < 3; corner++)
            for (uint32_t i = 0; i < 3; i++)
                mesh->normals[3 * mesh->indices[k + corner] + i] += normal[i];
    }
}

/* Sums, for each corner, the normals of its particle's triangles on the same side of the box.
 */
static void sum_creased(struct cs_mesh *mesh, uint32_t n, const double *x) {
    const struct cs_trimesh *box = mesh->range.mesh;
    double p[3][3];
    memset(mesh->normals, 0, 3 * sizeof *mesh->normals * mesh->n_indices);
    for (uint32_t k = 0; k < mesh->n_indices; k += 3)
        triangle_normal(mesh, n, x, mesh->indices + k, p, mesh->face_normals + k);
    for (uint32_t k = 0; k < mesh->n_indices; k++) {
        const uint32_t vertex = mesh->indices[k];
        for (uint32_t a = vertex ? box->vertex_triangles_end[vertex - 1] : 0;
             a < box->vertex_triangles_end[vertex]; a++) {
            const uint32_t t = box->vertex_triangles[a];
            for (size_t i = 0; i < 3 && mesh->box_faces[t] == mesh->box_faces[k / 3]; i++)
                mesh->normals[3 * (size_t)k + i] += mesh->face_normals[3 * (size_t)t + i];
        }
    }
}

void cs_mesh_update(struct cs_mesh *mesh, uint32_t n, const struct cs_frame *frame) {
    const double *x = frame->x;
    double p[3][3], normal[3];
    if (mesh->has_creases)
        sum_creased(mesh, n, x);
    else if (!mesh->flat_shading)
        sum_normals(mesh, n, x);
    for (uint32_t k = 0; k < mesh->n_vertices; k++) {
        const uint32_t i = mesh->split_vertices ? mesh->indices[k] : k,
                       particle = mesh->range.first + i;
        double place[3];
        cs_mesh_position(n, x, particle, place);
        if (mesh->flat_shading && k % 3 == 0)
            triangle_normal(mesh, n, x, mesh->indices + k, p, normal);
        set_vertex(mesh->vertices + k, place,
                   mesh->flat_shading ? normal
                                      : mesh->normals + 3 * (size_t)(mesh->has_creases ? k : i),
                   mesh->has_curvature     ? groove_slope(mesh, i)
                   : frame->triangle_marks ? frame->triangle_marks[mesh->first_triangle + k / 3]
                                           : scaled(frame->scalar, particle, frame->range));
    }
}

/* Texture coordinates of a grid: 0..1 along rows and columns. */
static void grid_uv(const struct cs_mesh *mesh, uint32_t i, double uv[2]) {
    const uint32_t columns = mesh->range.columns, rows = mesh->range.rows;
    uv[0] = columns > 1 ? (double)(i % columns) / (columns - 1) : 0;
    uv[1] = rows > 1 ? (double)(i / columns) / (rows - 1) : 0;
}

// texture coordinates 0..1 across and down the mesh's bounding box, seen from +z
static void front_uv(const struct cs_trimesh *mesh, uint32_t i, const double low[2],
                     const double high[2], double uv[2]) {
    for (int c = 0; c < 2; c++) {
        const double width = high[c] - low[c], at = mesh->positions[(size_t)c * mesh->n + i];
        uv[c] = width > 0 ? (c ? high[c] - at : at - low[c]) / width : 0;
    }
}

/* The texel of a triangle in a row of one for each colour of faces, and the last for the rest
 * (make_palette in session/frame_picture.c). */
static double face_texel(const struct cs_mesh *mesh, uint32_t triangle) {
    const struct cs_trimesh *from = mesh->range.mesh;
    const struct cs_face_colour *faces = mesh->faces->items;
    uint32_t k = 0;
    while (k < mesh->faces->n &&
           !cs_mesh_has_label(from->labels, from->triangle_labels[triangle], faces[k].set))
        k++;
    return (k + 0.5) / (mesh->faces->n + 1.0);
}

void cs_mesh_uv(const struct cs_mesh *mesh, const double repeat[2], float *uv) {
    const struct cs_trimesh *from = mesh->range.mesh;
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
    /* the box that a mesh without coordinates of its own is projected onto */
    for (size_t c = 0; from && c < 2; c++)
        for (uint32_t i = 0; i < from->n; i++) {
            low[c] = fmin(low[c], from->positions[c * from->n + i]);
            high[c] = fmax(high[c], from->positions[c * from->n + i]);
        }
    for (uint32_t k = 0; k < mesh->n_vertices; k++) {
        const uint32_t i = mesh->split_vertices ? mesh->indices[k] : k;
        double at[2];
        if (mesh->faces) {
            uv[2 * (size_t)k] = (float)face_texel(mesh, k / 3);
            uv[2 * (size_t)k + 1] = 0.5f;
            continue;
        }
        if (!from)
            grid_uv(mesh, i, at);
        else if (from->uv)
            /* one pair a corner: a textured mesh is split, so that k counts corners */
            at[0] = (double)from->uv[2 * (size_t)k],
            at[1] = (double)from->uv[2 * (size_t)k + 1];
        else
            front_uv(from, i, low, high, at);
        uv[2 * (size_t)k] = (float)(at[0] * repeat[0]);
        uv[2 * (size_t)k + 1] = (float)(at[1] * repeat[1]);
    }
}
