/* Makes particles of bodies: positions, areas, pins. */
#include "scene/body_particles.h"

#include "base/portable_sine.h"
#include "base/text.h"
#include "base/vec3.h"
#include "mesh/trimesh.h"
#include "scene/body_keys.h"
#include "scene/mesh_keys.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

int64_t cs_body_count(const struct cs_body *body) {
    return body->mesh ? body->geometry->n : body->cloth.grid[0] * body->cloth.grid[1];
}

const struct cs_pose *cs_body_placement(const struct cs_body *body) {
    return body->mesh ? &body->mesh->place : &body->cloth.place;
}

const double *cs_body_velocity(const struct cs_body *body) {
    return body->mesh ? body->mesh->velocity : body->cloth.velocity;
}

/* R = I + 2 w [v]x + 2 [v]x^2 for the quaternion (v, w), multiplied out. */
void cs_quaternion_matrix(const double q[4], double r[9]) {
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double turned[9] = {
        1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
        2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
        2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(r, turned, sizeof turned);
}

void cs_pose_rotation(const struct cs_pose *place, double r[9]) {
    if (isnan(place->matrix[0]))
        cs_quaternion_matrix(place->rotate, r);
    else
        memcpy(r, place->matrix, 9 * sizeof *r);
}

/* Position of row or column i between the edges as a fraction 0..1; 0.5 for a single one. */
static double fraction_of(uint32_t i, uint32_t count) {
    return count > 1 ? (double)i / (count - 1) : 0.5;
}

/* sin(pi a) for a in 0..1: 0 at both ends, 1 in the middle. */
static double half_sine(double a) {
    return cs_quarter_sine(2 * (a > 0.5 ? 1 - a : a));
}

/* Places the vertices of a mesh: x = R p + translate. */
static void place_mesh(const struct cs_body *body, uint32_t n, uint32_t first, double *x) {
    const struct cs_trimesh *mesh = body->geometry;
    const double *p = mesh->positions, *shift = body->mesh->place.translate;
    double r[9];
    cs_pose_rotation(&body->mesh->place, r);
    for (size_t i = 0; i < mesh->n; i++)
        for (size_t c = 0; c < 3; c++)
            x[c * n + first + i] = r[3 * c] * p[i] + r[3 * c + 1] * p[mesh->n + i] +
                                   r[3 * c + 2] * p[2 * (size_t)mesh->n + i] + shift[c];
}

/* Places a grid: row 0 on top, with the bump out of its plane, lying or hanging. */
static void place_grid(const struct cs_body *body, uint32_t n, uint32_t first, double *x) {
    const struct cs_cloth *cloth = &body->cloth;
    const uint32_t columns = (uint32_t)cloth->grid[0], rows = (uint32_t)cloth->grid[1];
    double r[9];
    cs_pose_rotation(&cloth->place, r);
    for (uint32_t i = 0; i < rows; i++)
        for (uint32_t j = 0; j < columns; j++) {
            const double a = fraction_of(j, columns), b = fraction_of(i, rows);
            // from -size/2 to size/2 in equal steps (cloth thesis, eq. 4.1)
            const double across = (a - 0.5) * (cloth->size[0] * cloth->stretch[0]);
            const double up = -((b - 0.5) * (cloth->size[1] * cloth->stretch[1]));
            const double out = cloth->bump * half_sine(a) * half_sine(b);
            const bool flat = cloth->start == CS_START_FLAT;
            const double p[3] = {across, flat ? out : up, flat ? -up : out};
            const size_t at = first + (size_t)i * columns + j;
            for (size_t c = 0; c < 3; c++)
                x[c * n + at] = r[3 * c] * p[0] + r[3 * c + 1] * p[1] + r[3 * c + 2] * p[2] +
                                cloth->place.translate[c];
        }
}

void cs_body_position(const struct cs_body *body, uint32_t n, uint32_t first, double *x) {
    if (body->mesh)
        place_mesh(body, n, first, x);
    else
        place_grid(body, n, first, x);
}

double cs_body_area(const struct cs_body *body, uint32_t i) {
    if (body->mesh)
        return body->geometry->area[i];
    const uint32_t columns = (uint32_t)body->cloth.grid[0],
                   rows = (uint32_t)body->cloth.grid[1];
    const uint32_t row = i / columns, column = i % columns;
    /* half a cell to each side that has one; a single row or column keeps the whole size */
    const double width = columns > 1 ? body->cloth.size[0] / (columns - 1) *
                                           (0.5 * (column > 0) + 0.5 * (column + 1 < columns))
                                     : body->cloth.size[0];
    const double height =
        rows > 1 ? body->cloth.size[1] / (rows - 1) * (0.5 * (row > 0) + 0.5 * (row + 1 < rows))
                 : body->cloth.size[1];
    return width * height;
}

/* Returns true if the particle in row i, column j belongs to a named corner or edge. */
static bool is_named(enum cs_pin_name name, uint32_t i, uint32_t j, uint32_t rows,
                     uint32_t columns) {
    /* row 0 is on top, column 0 at the left */
    const bool top = i == 0, bottom = i + 1 == rows, left = j == 0, right = j + 1 == columns;
    switch (name) {
    case CS_PIN_TOP_LEFT:
        return top && left;
    case CS_PIN_TOP_RIGHT:
        return top && right;
    case CS_PIN_BOTTOM_LEFT:
        return bottom && left;
    case CS_PIN_BOTTOM_RIGHT:
        return bottom && right;
    case CS_PIN_TOP:
        return top;
    case CS_PIN_BOTTOM:
        return bottom;
    case CS_PIN_LEFT:
        return left;
    case CS_PIN_RIGHT:
        return right;
    case CS_PIN_EDGES:
        return top || bottom || left || right;
    }
    return false;
}

/* Returns true if a face at vertex i of a mesh has this name. */
static bool is_in_set(const struct cs_trimesh *mesh, const char *set, uint32_t i) {
    bool found = false;
    for (uint32_t k = cs_trimesh_around_begin(mesh, i); k < mesh->vertex_triangles_end[i]; k++)
        found =
            found || cs_mesh_has_label(mesh->labels,
                                       mesh->triangle_labels[mesh->vertex_triangles[k]], set);
    return found;
}

/* Returns true if a particle lies in a box, borders included. */
static bool is_inside(const struct cs_box *box, uint32_t n, size_t at, const double *x) {
    for (size_t c = 0; c < 3; c++)
        if (x[c * n + at] < box->min[c] || x[c * n + at] > box->max[c])
            return false;
    return true;
}

bool cs_body_pin_selects(const struct cs_body *body, const struct cs_pin *pin, uint32_t n,
                         uint32_t first, uint32_t i, const double *x) {
    const uint32_t columns = (uint32_t)body->cloth.grid[0],
                   rows = (uint32_t)body->cloth.grid[1];
    return (pin->at >= 0 &&
            is_named((enum cs_pin_name)pin->at, i / columns, i % columns, rows, columns)) ||
           pin->index == (int64_t)i ||
           (pin->box.present && is_inside(&pin->box, n, (size_t)first + i, x)) ||
           (*pin->set && is_in_set(body->geometry, pin->set, i));
}

void cs_body_pin(const struct cs_body *body, uint32_t n, uint32_t first, const double *x,
                 bool *pinned) {
    const uint32_t count = (uint32_t)cs_body_count(body);
    const struct cs_pin *pins = body->pins.items;
    for (uint32_t p = 0; p < body->pins.n; p++)
        for (uint32_t at = 0; at < count; at++)
            if (cs_body_pin_selects(body, pins + p, n, first, at, x))
                pinned[at] = true;
}

bool cs_body_is_closed(const struct cs_body *body) {
    const struct cs_trimesh *mesh = body->geometry;
    double volume = 0;
    for (uint32_t t = 0; body->mesh && t < mesh->n_triangles; t++) {
        double at[3][3], normal[3];
        for (size_t k = 0; k < 9; k++)
            at[k / 3][k % 3] =
                mesh->positions[k % 3 * mesh->n + mesh->triangles[3 * (size_t)t + k / 3]];
        cs_vec3_cross(at[1], at[2], normal);
        volume += cs_vec3_dot(at[0], normal);
    }
    return body->mesh && !mesh->n_open && volume > 0;
}

bool cs_holder_fault(const struct cs_scene *scene, const struct cs_holder *holder, char *text,
                     size_t size) {
    const uint32_t n = scene->colliders.n;
    if (holder->collider < 0)
        return snprintf(text, size, "missing key \"collider\", expected its number");
    if (n == 0)
        return snprintf(text, size, "the scene has no colliders");
    if (holder->collider >= n)
        return snprintf(text, size, "collider %lld does not exist (0..%u)",
                        (long long)holder->collider, n - 1);
    return false;
}

/* Copies the first name of a label that is near to a word, or "". */
static void find_near(const struct cs_mesh_label *label, const char *word,
                      char near[CS_TEXT_MAX]) {
    for (const char *at = label->names; *at; at += strspn(at, " ")) {
        const size_t length = label->kind == CS_LABEL_GROUP ? strcspn(at, " ") : strlen(at);
        const char *names[] = {near, NULL};
        snprintf(near, CS_TEXT_MAX, "%.*s", (int)length, at);
        if (cs_nearest_word(word, names))
            return;
        at += length;
    }
    *near = 0;
}

bool cs_body_set_fault(const struct cs_body *body, const char *set, char *text, size_t size) {
    const struct cs_trimesh *mesh = body->geometry;
    char near[CS_TEXT_MAX] = "";
    if (!mesh || !mesh->triangle_labels)
        return snprintf(text, size, "found the set \"%.60s\", but %s", set,
                        mesh ? "no face of the mesh has a name" : "a cloth has no sets");
    for (uint32_t t = 0; t < mesh->n_triangles; t++)
        if (cs_mesh_has_label(mesh->labels, mesh->triangle_labels[t], set))
            return false;
    for (size_t k = 0; k < CS_LABEL_KINDS * (size_t)mesh->n_triangles && !*near; k++) {
        const uint32_t label = mesh->triangle_labels[k / CS_LABEL_KINDS][k % CS_LABEL_KINDS];
        if (label)
            find_near(mesh->labels + label - 1, set, near);
    }
    return snprintf(text, size, "the mesh has no group, object or material \"%.60s\"%s%.60s%s",
                    set, *near ? "; did you mean \"" : "", near, *near ? "\"?" : "");
}

bool cs_body_pin_fault(const struct cs_body *body, const struct cs_pin *pin, char *text,
                       size_t size) {
    const long long count = (long long)cs_body_count(body), index = (long long)pin->index;
    if (index >= count)
        return snprintf(text, size, "particle %lld does not exist (0..%lld)", index, count - 1);
    if (body->mesh && pin->at >= 0)
        return snprintf(
            text, size,
            "found \"%s\", expected an index, a box or a set: a mesh has no named corners "
            "or edges",
            cs_pin_names[pin->at]);
    if (*pin->set)
        return cs_body_set_fault(body, pin->set, text, size);
    for (int c = 0; c < 3 && pin->box.present; c++)
        if (pin->box.min[c] > pin->box.max[c])
            return snprintf(text, size, "box.min[%d] = %.9g lies above box.max[%d] = %.9g", c,
                            pin->box.min[c], c, pin->box.max[c]);
    return false;
}

const struct cs_body *cs_scene_body(const struct cs_scene *scene, uint32_t b) {
    return cs_scene_bodies(scene) + b;
}
