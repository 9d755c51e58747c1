/* solids.c - colliders and the ground's rectangle become triangles. */
#include "draw/cpu/solids.h"

#include <math.h>
#include <string.h>

/* `sink` moves only the depth away from the eye: between its particles a cloth is a chord that
 * cuts into the ball it lies on, and would show specks of it */
static void sink(const struct cs_lens *lens, const float place[3], const float eye[4], float by,
                 struct cs_corner *corner) {
    float d[3], square = 0, moved[3];
    for (int i = 0; i < 3; i++) {
        d[i] = eye[3] * place[i] - eye[i];
        square += d[i] * d[i];
    }
    const float share = square > 0 ? by / sqrtf(square) : 0;
    for (int i = 0; i < 3; i++)
        moved[i] = place[i] + share * d[i];
    cs_lens_move_depth(lens, moved, corner);
}

// who sees the triangles, and where they go
struct projection {
    const struct cs_lens *lens;
    const float *eye; // a place and 1, or a direction and 0
    bool sinks;       // not for a light
    struct cs_triangles *triangles;
};

// triangles of three vertices each
static void add_vertices(const struct cs_vertex *vertices, uint32_t n,
                         const struct cs_surface_style *style,
                         const struct cs_triangle_kind *kind,
                         const struct projection *projection) {
    for (uint32_t v = 0; v < n; v += 3) {
        struct cs_corner corners[3];
        const struct cs_corner *three[3] = {corners, corners + 1, corners + 2};
        for (uint32_t i = 0; i < 3; i++) {
            const struct cs_vertex *vertex = vertices + v + i;
            cs_lens_corner(projection->lens, vertex->place, corners + i);
            memcpy(corners[i].attributes, vertex->normal, sizeof vertex->normal);
            if (projection->sinks && style->sink > 0)
                sink(projection->lens, vertex->place, projection->eye, (float)style->sink,
                     corners + i);
        }
        cs_triangles_add(projection->triangles, projection->lens, three, kind);
    }
}

static void add_obstacle(const struct cs_solids *solids, uint32_t i,
                         const struct cs_surface_style *style,
                         const struct cs_triangle_kind *kind,
                         const struct projection *projection) {
    cs_solids_fill(solids, i, projection->eye);
    add_vertices(solids->vertices, solids->of[i].n, style, kind, projection);
}

void cs_solids_add(const struct cs_solids *solids, const struct cs_lens *lens,
                   const float eye[4], struct cs_coat *coats, struct cs_triangles *triangles,
                   size_t *n_squares) {
    const struct projection projection = {lens, eye, true, triangles};
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < solids->n; i++) {
            const struct cs_obstacle *obstacle = &solids->of[i].at;
            const struct cs_triangle_kind kind = {.surface = (uint16_t)i, .attributes = 3};
            const bool square = cs_shape_is_endless(obstacle->shape);
            struct cs_surface_style style;
            cs_style_solid(&style, obstacle, solids->cell);
            cs_coat_make(coats + i, &style);
            if (obstacle->collider->visible && square == (pass == 0))
                add_obstacle(solids, i, &style, &kind, &projection);
        }
        if (pass == 0)
            *n_squares = triangles->n;
    }
}

void cs_solids_add_shadow(const struct cs_solids *solids, const struct cs_lens *lens,
                          const float light[4], struct cs_triangles *triangles) {
    const struct cs_triangle_kind kind = {.attributes = 0};
    const struct projection projection = {lens, light, false, triangles};
    for (uint32_t i = 0; i < solids->n; i++) {
        const struct cs_obstacle *obstacle = &solids->of[i].at;
        struct cs_surface_style style;
        if (!obstacle->collider->visible || cs_shape_is_endless(obstacle->shape))
            continue;
        cs_style_solid(&style, obstacle, solids->cell);
        add_obstacle(solids, i, &style, &kind, &projection);
    }
}

void cs_ground_add(const struct cs_ground *ground, const struct cs_lens *lens,
                   struct cs_triangles *triangles) {
    static const unsigned char sides[6][2] = {{0, 0}, {2, 0}, {0, 2}, {2, 0}, {2, 2}, {0, 2}};
    const struct cs_triangle_kind kind = {.attributes = 0};
    const struct projection projection = {lens, NULL, false, triangles};
    const float *box = ground->box;
    const struct cs_surface_style style = {.sink = 0};
    struct cs_vertex square[6] = {{.value = 0}};
    if (!(box[0] < box[2] && box[1] < box[3]))
        return;
    for (int i = 0; i < 6; i++) {
        square[i].place[0] = box[sides[i][0]];
        square[i].place[1] = ground->span[1];
        square[i].place[2] = box[sides[i][1] + 1];
    }
    add_vertices(square, 6, &style, &kind, &projection);
}
