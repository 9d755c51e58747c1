/* The rows of `seams`, and the checks of their sides: bodies, particles, weights, lengths. */
#include "scene/body_keys.h"
#include "scene/body_particles.h"
#include "scene/collider_keys.h"
#include "scene/table_rows.h"

#include <stdio.h>
#include <string.h>

#define STIFFNESS 100 /* N/m, of a stitch that gives none */

static const double absent3[3] = {ABSENT, ABSENT, ABSENT};

static const struct cs_option to_rows[] = {
    SIDE_ROWS(
        struct cs_seam_to, side, "number of the other body, or of the same; or else collider",
        "as many as on this side, stitched in order; with weights three, the corners of a "
        "triangle. Of a collider vertices of its mesh; absent: its nearest points"),
    INT(struct cs_seam_to, collider, "", -1, 0, 4294967295.0,
        "number of a collider, which carries what is sewn to it, exactly in every method"),
    VECTOR(struct cs_seam_to, weights, 3, "", absent3, 0, 1,
           "barycentric coordinates of the point of the triangle to which all are stitched"),
};
static const struct cs_table to_table = {ROWS(to_rows), .size = sizeof(struct cs_seam_to)};

static const struct cs_option seam_rows[] = {
    SIDE_ROWS(struct cs_seam, side, "number of the body from 0; must be given",
              "of the body, named as in its pins; at least one, stitched in order"),
    TABLE(struct cs_seam, to, to_table, "other side"),
    REAL(struct cs_seam, stiffness, "N/m", STIFFNESS, 1e-9, 1e12, "of each stitch, a spring"),
    REAL(struct cs_seam, damping, "N s/m", 0, 0, 1e12,
         "of each stitch: along it, or with length 0 of the whole relative velocity"),
    REAL(struct cs_seam, length, "m", 0, 0, BIG, "rest length of a stitch"),
    REAL(struct cs_seam, breaking_length, "m", ABSENT, 1e-12, BIG,
         "a stitch that is longer after a step is gone; absent: none breaks"),
    REAL(struct cs_seam, breaking_force, "N", ABSENT, 1e-12, BIG,
         "likewise one whose spring pulls more: length + breaking_force/stiffness"),
    REAL(struct cs_seam, closing_time, "s", 0, 0, BIG,
         "to a collider, in place of the above: the particles are led to it until then"),
};
const struct cs_table cs_seam_table = {ROWS(seam_rows), .size = sizeof(struct cs_seam)};

/* A seam under check, for messages. */
struct look {
    const struct cs_check *check;
    const struct cs_scene *scene;
    uint32_t number;
};

enum cs_status cs_particles_check(const struct cs_check *check, const char *path,
                                  const struct cs_list *particles, const struct cs_body *owner,
                                  const char *name) {
    const struct cs_pin *pins = particles->items;
    char place[128], fault[160];
    for (uint32_t p = 0; p < particles->n; p++) {
        snprintf(place, sizeof place, "%s.particles[%u]", path, p);
        if (cs_body_pin_fault(owner, pins + p, fault, sizeof fault))
            return cs_check_refuse(check, place, "%s: %s", name, fault);
        if (pins[p].to)
            return cs_check_refuse(check, place,
                                   "found to, which only pins of a body and a grab have");
        // in a seam each counts once: no order would be left
        for (uint32_t q = 0; q < p && !strncmp(path, "seams", 5); q++)
            if (pins[p].index >= 0 && pins[q].index == pins[p].index)
                return cs_check_refuse(check, place, "%s: found particle %lld twice", name,
                                       (long long)pins[p].index);
    }
    return CS_OK;
}

/* Checks the body and the particles of a side; part: "" or ".to". */
static enum cs_status check_side(const struct look *look, const char *part,
                                 const struct cs_seam_side *side) {
    const uint32_t n = look->scene->bodies.n;
    char path[96], name[32];
    snprintf(path, sizeof path, "seams[%u]%s", look->number, part);
    if (side->body < 0)
        return cs_check_refuse(look->check, path, "missing key \"body\"%s, expected its number",
                               *part ? " or \"collider\"" : "");
    if (!side->particles.n)
        return cs_check_refuse(look->check, path, "missing key \"particles\", expected some");
    snprintf(path, sizeof path, "seams[%u]%s.body", look->number, part);
    if (side->body >= n)
        return cs_check_refuse(look->check, path, "body %lld does not exist (0..%u)",
                               (long long)side->body, n - 1);
    snprintf(name, sizeof name, "body %u", (uint32_t)side->body);
    snprintf(path, sizeof path, "seams[%u]%s", look->number, part);
    return cs_particles_check(look->check, path, &side->particles,
                              cs_scene_bodies(look->scene) + side->body, name);
}

/* Checks the side of a seam that is a collider, which takes no spring. */
static enum cs_status check_collider(const struct look *look, const struct cs_seam *seam) {
    const struct cs_holder holder = {true, seam->to.collider};
    const struct cs_list *particles = &seam->to.side.particles;
    char path[64], fault[160], name[32];
    snprintf(path, sizeof path, "seams[%u].to.collider", look->number);
    if (seam->to.side.body >= 0)
        return cs_check_refuse(look->check, path, "found body too, expected either");
    if (cs_holder_fault(look->scene, &holder, fault, sizeof fault))
        return cs_check_refuse(look->check, path, "%s", fault);
    const struct cs_collider *collider = cs_scene_colliders(look->scene) + holder.collider;
    const struct cs_body mesh = {.mesh = collider->mesh, .geometry = collider->geometry};
    snprintf(path, sizeof path, "seams[%u].to.particles", look->number);
    if (!mesh.mesh && particles->n)
        return cs_check_refuse(look->check, path,
                               "collider %u is no mesh and has no vertices, expected none: its "
                               "nearest points",
                               (uint32_t)holder.collider);
    if (!isnan(seam->to.weights[0]) && !particles->n)
        return cs_check_refuse(look->check, path, "found none, expected 3 for the weights");
    snprintf(path, sizeof path, "seams[%u]", look->number);
    if (seam->stiffness != STIFFNESS || seam->damping > 0 || seam->length > 0 ||
        !isnan(seam->breaking_length) || !isnan(seam->breaking_force))
        return cs_check_refuse(look->check, path,
                               "a collider carries what is sewn to it: no spring has "
                               "stiffness, damping, length, breaking_length or breaking_force; "
                               "expected closing_time alone, and an event unsew to open it");
    snprintf(name, sizeof name, "collider %u", (uint32_t)holder.collider);
    snprintf(path, sizeof path, "seams[%u].to", look->number);
    return cs_particles_check(look->check, path, particles, &mesh, name);
}

/* Checks one seam: sides, weights, lengths. */
static enum cs_status check_seam(const struct look *look, const struct cs_seam *seam) {
    const double *w = seam->to.weights;
    const double sum = w[0] + w[1] + w[2];
    char path[64];
    if (check_side(look, "", &seam->side) ||
        (seam->to.collider >= 0 ? check_collider(look, seam)
                                : check_side(look, ".to", &seam->to.side)))
        return look->check->error->status;
    snprintf(path, sizeof path, "seams[%u].closing_time", look->number);
    if (seam->to.collider < 0 && seam->closing_time > 0)
        return cs_check_refuse(look->check, path,
                               "found %.9g s, expected it in a seam to a collider alone: "
                               "stitches between bodies pull from the start",
                               seam->closing_time);
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
