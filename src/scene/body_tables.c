/* The rows of a body's membrane and bending (scene_tables.c), their moduli, and their checks.
 */
#include "scene/body_keys.h"
#include "scene/body_particles.h"
#include "scene/check.h"
#include "scene/collider_keys.h"
#include "scene/table_rows.h"

#include <stdio.h>
#include <string.h>

static const struct cs_option membrane_rows[] = {
    REAL(struct cs_membrane_keys, young, "N/m", ABSENT, 1e-6, BIG,
         "Young's modulus times thickness: tension over strain of a strip that is free to "
         "narrow; the same in every direction"),
    REAL(struct cs_membrane_keys, poisson, "", 0.3, -0.99, 0.99,
         "with young: sideways contraction over strain"),
    REAL(struct cs_membrane_keys, warp, "N/m", ABSENT, 1e-6, BIG,
         "instead of young: tension over strain along the warp, at a constant width. The warp "
         "runs along a row, or along the x axis of a mesh"),
    REAL(struct cs_membrane_keys, weft, "N/m", ABSENT, 1e-6, BIG,
         "with warp: likewise across the warp"),
    REAL(struct cs_membrane_keys, shear, "N/m", ABSENT, 1e-6, BIG,
         "with warp: shear force over the change of the angle in rad"),
    REAL(struct cs_membrane_keys, coupling, "N/m", 0, -BIG, BIG,
         "with warp: tension along the warp over strain across it; its square is below warp "
         "times weft"),
};
static const struct cs_table membrane_table = {
    ROWS(membrane_rows), .size = sizeof(struct cs_membrane_keys), .optional = true};

static const struct cs_option bending_rows[] = {
    REAL(struct cs_bending_keys, stiffness, "N m", ABSENT, 1e-15, BIG,
         "moment per width over curvature; the same in every direction"),
    REAL(struct cs_bending_keys, poisson, "", 0.3, -0.99, 0.99,
         "with stiffness: sideways curvature, of the other sign, over curvature"),
    REAL(struct cs_bending_keys, warp, "N m", ABSENT, 1e-15, BIG,
         "instead of stiffness: moment over curvature along the warp, flat across it"),
    REAL(struct cs_bending_keys, weft, "N m", ABSENT, 1e-15, BIG,
         "with warp: likewise across the warp"),
    REAL(struct cs_bending_keys, twist, "N m", ABSENT, 1e-15, BIG,
         "with warp: twisting moment over twice the twist"),
    REAL(struct cs_bending_keys, coupling, "N m", 0, -BIG, BIG,
         "with warp: moment along the warp over curvature across it; its square is below warp "
         "times weft"),
    REAL(struct cs_bending_keys, damping, "s", 0, 0, BIG,
         "of the rate of curvature: moment as from a curvature of damping times that rate"),
};
static const struct cs_table bending_table = {
    ROWS(bending_rows), .size = sizeof(struct cs_bending_keys), .optional = true,
    .shorthand_number = "stiffness"};

/* Names of the cloths below. */
static const char *const cloth_names[] = {"denim",      "pants",   "interlock", "ponte-roma",
                                          "tablecloth", "blanket", "jacket",    NULL};

static const struct cs_option elastic_rows[] = {
    CHOICE(struct cs_elastic, cloth, cloth_names, -1,
           "a measured cloth instead of membrane and bending (Wang et al. 2011)"),
    TABLE(struct cs_elastic, membrane, membrane_table,
          "resistance to strain; young, or warp, weft and shear"),
    TABLE(struct cs_elastic, bending, bending_table,
          "resistance to curvature; stiffness, or warp, weft and twist. A number is the "
          "stiffness"),
    REAL(struct cs_elastic, damping, "s", 0, 0, BIG,
         "of the rate of strain: tension as from a strain of damping times that rate"),
};
const struct cs_table cs_elastic_table = {ROWS(elastic_rows), .size = sizeof(struct cs_elastic),
                                          .optional = true, .shorthand_text = "cloth"};

/* Measurements of Wang, O'Brien, Ramamoorthi 2011, in the order of cloth_names: for small
 * strains the tensions C_11, C_22, C_12, C_33 in N/m over Green's strains E_XX, E_YY, E_XY; and
 * the factors k in N m of their hinges, at small curvature, for folds across the warp, at 45
 * degrees, and across the weft. */
static const struct measured {
    double tension[4], hinge[3];
} measured[] = {
    {{205.352005, 1013.88629, 10.234077, 53.387184},
     {64.196457e-6, 73.384567e-6, 96.951576e-6}},
    {{2016.55456, 2034.97644, 9.170511, 104.759674},
     {125.409805e-6, 107.997696e-6, 125.409805e-6}},
    {{16.593832, 34.477123, -14.695990, 36.860302}, {23.191698e-6, 24.749964e-6, 14.267624e-6}},
    {{31.146198, 44.028667, -12.802702, 31.896357}, {36.348366e-6, 33.013252e-6, 37.157593e-6}},
    {{2002.08618, 2027.48559, 0.345588, 19.189022}, {51.713814e-6, 40.659470e-6, 31.282822e-6}},
    {{151.503906, 244.830673, 106.028160, 30.250183},
     {117.070122e-6, 87.509773e-6, 59.774277e-6}},
    {{43.067627, 171.424835, 54.373299, 14.314700}, {14.293814e-6, 21.951700e-6, 20.345654e-6}},
};

/* E_XY is half the change of the angle. */
static struct cs_moduli measured_membrane(const struct measured *of) {
    return (struct cs_moduli){of->tension[0], of->tension[1], of->tension[2],
                              of->tension[3] / 2};
}

/* A hinge of edge length l between triangles of area a each has the energy k l^2 theta^2/(16
 * a). On a sheet of squares that is folded along its lines theta is curvature times width, and
 * the energy k/8 of the squared curvature per area: the modulus is k/4. At 45 degrees a sheet
 * has (D_11 + D_22)/4 + D_33; the coupling was not measured. */
static struct cs_moduli measured_bending(const struct measured *of) {
    const double warp = of->hinge[0] / 4, diagonal = of->hinge[1] / 4, weft = of->hinge[2] / 4;
    return (struct cs_moduli){warp, weft, 0, diagonal - (warp + weft) / 4};
}

static struct cs_moduli isotropic(double modulus, double poisson) {
    return (struct cs_moduli){modulus, modulus, poisson * modulus, (1 - poisson) / 2 * modulus};
}

struct cs_moduli cs_membrane_moduli(const struct cs_elastic *elastic) {
    const struct cs_membrane_keys *keys = &elastic->membrane;
    if (elastic->present && elastic->cloth >= 0)
        return measured_membrane(measured + elastic->cloth);
    if (!elastic->present || !keys->present)
        return (struct cs_moduli){0};
    if (!isnan(keys->young))
        return isotropic(keys->young / (1 - keys->poisson * keys->poisson), keys->poisson);
    return (struct cs_moduli){keys->warp, keys->weft, keys->coupling, keys->shear};
}

struct cs_moduli cs_bending_moduli(const struct cs_elastic *elastic) {
    const struct cs_bending_keys *keys = &elastic->bending;
    if (elastic->present && elastic->cloth >= 0)
        return measured_bending(measured + elastic->cloth);
    if (!elastic->present || !keys->present)
        return (struct cs_moduli){0};
    if (!isnan(keys->stiffness))
        return isotropic(keys->stiffness, keys->poisson);
    return (struct cs_moduli){keys->warp, keys->weft, keys->coupling, keys->twist};
}

bool cs_elastic_bends(const struct cs_elastic *elastic) {
    return elastic->present && (elastic->cloth >= 0 || elastic->bending.present);
}

/* The constants of one kind, as given: the isotropic one, and the three others. */
struct given {
    const char *isotropic, *orthotropic; /* their names */
    double one, three[3], coupling;
};

/* Checks that one set of constants is whole, and that energies are positive. */
static enum cs_status check_given(const struct cs_check *check, const char *path,
                                  const struct given *given) {
    int n = 0;
    for (int k = 0; k < 3; k++)
        n += !isnan(given->three[k]);
    if (n + !isnan(given->one) == 0)
        return cs_check_refuse(check, path, "found no constants, expected %s, or %s",
                               given->isotropic, given->orthotropic);
    if (!isnan(given->one) && n > 0)
        return cs_check_refuse(check, path, "found %s and others, expected %s, or %s",
                               given->isotropic, given->isotropic, given->orthotropic);
    if (isnan(given->one) && n < 3)
        return cs_check_refuse(check, path, "found %d of %s, expected all three", n,
                               given->orthotropic);
    if (n == 3 && !(given->coupling * given->coupling < given->three[0] * given->three[1]))
        return cs_check_refuse(check, path,
                               "coupling = %.9g, expected less than sqrt(warp weft) = %.9g in "
                               "magnitude",
                               given->coupling, sqrt(given->three[0] * given->three[1]));
    return CS_OK;
}

enum cs_status cs_elastic_check(const struct cs_check *check, const char *body,
                                const struct cs_body *of) {
    const struct cs_membrane_keys *membrane = &of->elastic.membrane;
    const struct cs_bending_keys *bending = &of->elastic.bending;
    char path[128];
    if (!of->elastic.present)
        return CS_OK;
    snprintf(path, sizeof path, "%s.elastic", body);
    // a measured cloth has all constants
    if (of->elastic.cloth >= 0 && (membrane->present || bending->present))
        return cs_check_refuse(check, path, "found cloth and %s, expected one of the two",
                               membrane->present ? "membrane" : "bending");
    if (of->elastic.cloth < 0 && !membrane->present)
        return cs_check_refuse(check, path, "missing key \"membrane\" or \"cloth\"");
    if (of->cloth.present && (of->cloth.grid[0] < 2 || of->cloth.grid[1] < 2))
        return cs_check_refuse(check, path,
                               "a cloth of one row or column has no area, expected at "
                               "least 2 rows and columns");
    snprintf(path, sizeof path, "%s.elastic.membrane", body);
    if (membrane->present &&
        check_given(check, path,
                    &(struct given){"young",
                                    "warp, weft and shear",
                                    membrane->young,
                                    {membrane->warp, membrane->weft, membrane->shear},
                                    membrane->coupling}))
        return check->error->status;
    snprintf(path, sizeof path, "%s.elastic.bending", body);
    if (bending->present &&
        check_given(check, path,
                    &(struct given){"stiffness",
                                    "warp, weft and twist",
                                    bending->stiffness,
                                    {bending->warp, bending->weft, bending->twist},
                                    bending->coupling}))
        return check->error->status;
    return CS_OK;
}

/* Seams. */

#define STIFFNESS 100 /* N/m, of a stitch that gives none */

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
        struct cs_seam_to, "number of the other body, or of the same; or else collider",
        "as many as on this side, stitched in order; with weights three, the corners of a "
        "triangle. Of a collider vertices of its mesh; absent: its nearest points"),
    INT(struct cs_seam_to, collider, "", -1, 0, 4294967295.0,
        "number of a collider, which carries what is sewn to it, exactly in every method"),
    VECTOR(struct cs_seam_to, weights, 3, "", absent3, 0, 1,
           "barycentric coordinates of the point of the triangle to which all are stitched"),
};
static const struct cs_table to_table = {ROWS(to_rows), .size = sizeof(struct cs_seam_to)};

static const struct cs_option seam_rows[] = {
    SIDE_ROWS(struct cs_seam, "number of the body from 0; must be given",
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
        if (pins[p].to.present)
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
    const struct cs_body mesh = {.mesh = cs_scene_colliders(look->scene)[holder.collider].mesh};
    snprintf(path, sizeof path, "seams[%u].to.particles", look->number);
    if (!mesh.mesh.present && particles->n)
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

const struct cs_elastic *cs_scene_elastic(const struct cs_scene *scene, uint32_t b) {
    return &cs_scene_bodies(scene)[b].elastic;
}
