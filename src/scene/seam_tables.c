/* The rows of the scene's seams (scene_tables.c), and their checks. */
#include "scene/check.h"
#include "scene/scene.h"
#include "scene/shape.h"
#include "scene/table_rows.h"

#include <stdio.h>

static const double absent3[3] = {ABSENT, ABSENT, ABSENT};

/* the rows of a side in each struct that holds one */
#define SIDE_ROWS(s, body_help, list_help)                                                     \
    {.name = "body",                                                                           \
     .unit = "",                                                                               \
     .help = body_help,                                                                        \
     .type = CS_INT,                                                                           \
     .count = 1,                                                                               \
     .offset = offsetof(s, side.body),                                                         \
     .def = -1,                                                                                \
     .min = 0,                                                                                 \
     .max = 4294967295.0},                                                                     \
    {                                                                                          \
        .name = "particles", .unit = "", .help = list_help, .type = CS_LIST, .count = 1,       \
        .offset = offsetof(s, side.particles), .table = &cs_pin_table                          \
    }

static const struct cs_option to_rows[] = {
    SIDE_ROWS(
        struct cs_seam_to, "number of the other body, or of the same; must be given",
        "as many as on this side, stitched in order; with weights three, the corners of a "
        "triangle"),
    VECTOR(struct cs_seam_to, weights, 3, "", absent3, 0, 1,
           "barycentric coordinates of the point of the triangle to which all are stitched"),
};
static const struct cs_table to_table = {ROWS(to_rows), .size = sizeof(struct cs_seam_to)};

static const struct cs_option seam_rows[] = {
    SIDE_ROWS(struct cs_seam, "number of the body from 0; must be given",
              "of the body, named as in its pins; at least one, stitched in order"),
    TABLE(struct cs_seam, to, to_table, "other side"),
    REAL(struct cs_seam, stiffness, "N/m", 100, 1e-9, 1e12, "of each stitch, a spring"),
    REAL(struct cs_seam, damping, "N s/m", 0, 0, 1e12,
         "of each stitch: along it, or with length 0 of the whole relative velocity"),
    REAL(struct cs_seam, length, "m", 0, 0, BIG, "rest length of a stitch"),
    REAL(struct cs_seam, breaking_length, "m", ABSENT, 1e-12, BIG,
         "a stitch that is longer after a step is gone; absent: none breaks"),
    REAL(struct cs_seam, breaking_force, "N", ABSENT, 1e-12, BIG,
         "likewise one whose spring pulls more: length + breaking_force/stiffness"),
};
const struct cs_table cs_seam_table = {ROWS(seam_rows), .size = sizeof(struct cs_seam)};

/* A seam under check, for messages. */
struct look {
    const struct cs_check *check;
    const struct cs_scene *scene;
    uint32_t number;
};

/* Checks the body and the particles of a side; part: "" or ".to". */
static enum cs_status check_side(const struct look *look, const char *part,
                                 const struct cs_seam_side *side) {
    const struct cs_pin *pins = side->particles.items;
    const uint32_t n = look->scene->bodies.n;
    char path[96], fault[160];
    snprintf(path, sizeof path, "seams[%u]%s", look->number, part);
    if (side->body < 0)
        return cs_check_refuse(look->check, path, "missing key \"body\", expected its number");
    if (!side->particles.n)
        return cs_check_refuse(look->check, path, "missing key \"particles\", expected some");
    snprintf(path, sizeof path, "seams[%u]%s.body", look->number, part);
    if (side->body >= n)
        return cs_check_refuse(look->check, path, "body %lld does not exist (0..%u)",
                               (long long)side->body, n - 1);
    for (uint32_t p = 0; p < side->particles.n; p++) {
        snprintf(path, sizeof path, "seams[%u]%s.particles[%u]", look->number, part, p);
        if (cs_shape_pin_fault(cs_scene_bodies(look->scene) + side->body, pins + p, fault,
                               sizeof fault))
            return cs_check_refuse(look->check, path, "body %lld: %s", (long long)side->body,
                                   fault);
        if (pins[p].to.present)
            return cs_check_refuse(look->check, path,
                                   "found to, which only pins of a body have");
    }
    return CS_OK;
}

/* Checks one seam: sides, weights, lengths. */
static enum cs_status check_seam(const struct look *look, const struct cs_seam *seam) {
    const double *w = seam->to.weights;
    const double sum = w[0] + w[1] + w[2];
    char path[64];
    if (check_side(look, "", &seam->side) || check_side(look, ".to", &seam->to.side))
        return look->check->error->status;
    snprintf(path, sizeof path, "seams[%u].to.weights", look->number);
    // false for absent weights
    if (!isnan(w[0]) && !(fabs(sum - 1) <= 1e-9))
        return cs_check_refuse(look->check, path, "their sum is %.12g, expected 1", sum);
    snprintf(path, sizeof path, "seams[%u].breaking_length", look->number);
    if (seam->breaking_length <= seam->length)
        return cs_check_refuse(look->check, path,
                               "%.9g m is not above length, %.9g m: every stitch would break",
                               seam->breaking_length, seam->length);
    return CS_OK;
}

enum cs_status cs_seams_check(const struct cs_check *check, const struct cs_scene *scene) {
    struct look look = {check, scene, 0};
    const struct cs_seam *seams = scene->seams.items;
    for (; look.number < scene->seams.n; look.number++)
        if (check_seam(&look, seams + look.number))
            return check->error->status;
    return CS_OK;
}
