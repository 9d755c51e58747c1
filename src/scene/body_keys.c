/* The rows of `bodies`: cloth, network, masses, springs, pins, holders, material; and the check
 * of a body's elastic keys. The rows of these are in elastic_keys.c, those of meshes and
 * placements in mesh_keys.c. */
#include "scene/body_keys.h"
#include "scene/table_rows.h"

#include <stdio.h>

static const double zero3[3] = {0, 0, 0}, one3[3] = {1, 1, 1};
static const double one2[2] = {1, 1};
static const double absent3[3] = {ABSENT, ABSENT, ABSENT};

static const struct cs_option holder_rows[] = {
    INT(struct cs_holder, collider, "", -1, 0, 4294967295.0,
        "number of the collider from 0; must be given"),
};

const struct cs_table cs_holder_table = {ROWS(holder_rows), .size = sizeof(struct cs_holder),
                                         .optional = true, .apart = true};

static const char *const start_names[] = {"hanging", "flat", NULL};
static const struct cs_option cloth_rows[] = {
    COUNTS(struct cs_cloth, grid, 2, "particles", NULL, 1, 65535, "columns and rows"),
    VECTOR(struct cs_cloth, size, 2, "m", one2, 1e-6, 1e6,
           "width of a row, height of a column"),
    CHOICE(struct cs_cloth, start, start_names, CS_START_HANGING,
           "hanging: in the xy plane, row 0 on top; flat: turned back into the xz plane, row 0 "
           "at -z"),
    VECTOR(struct cs_cloth, stretch, 2, "", one2, 1e-3, 1e3,
           "width and height at time 0 relative to size, which stays the rest size"),
    REAL(struct cs_cloth, bump, "m", 0, -BIG, BIG,
         "height at time 0 of a bump sin(pi a) sin(pi b) along the normal, a and b from 0 to 1 "
         "over the cloth"),
    TABLE(struct cs_cloth, place, cs_pose_table, "rigid placement, about the cloth's centre"),
    VECTOR(struct cs_cloth, velocity, 3, "m/s", zero3, -BIG, BIG,
           "of every particle that is not pinned, at time 0"),
    VECTOR(
        struct cs_cloth, spin, 3, "rad/s", zero3, -BIG, BIG,
        "angular velocity about the point that place moves the centre to, added to velocity"),
};
static const struct cs_table cloth_table = {ROWS(cloth_rows), .size = sizeof(struct cs_cloth),
                                            .optional = true};

const char *const cs_pin_names[] = {"top-left", "top-right", "bottom-left", "bottom-right",
                                    "top",      "bottom",    "left",        "right",
                                    "edges",    NULL};

static const struct cs_option box_rows[] = {
    VECTOR(struct cs_box, min, 3, "m", NULL, -BIG, BIG, "corner with the smallest coordinates"),
    VECTOR(struct cs_box, max, 3, "m", NULL, -BIG, BIG, "corner with the largest coordinates"),
};

static const struct cs_table box_table = {ROWS(box_rows), .size = sizeof(struct cs_box),
                                          .optional = true};

static const struct cs_option pin_rows[] = {
    TABLE(struct cs_pin, to, cs_holder_table,
          "of a body's pins: what carries the particles, wherever it moves and turns"),
    CHOICE(struct cs_pin, at, cs_pin_names, -1,
           "a corner or an edge of the grid; a plain string means this"),
    INT(struct cs_pin, index, "", -1, 0, 4294967295.0,
        "a particle of the body, row * columns + column, or a vertex from 0; a plain number "
        "means "
        "this"),
    TABLE(struct cs_pin, box, box_table, "every particle that starts inside"),
    TEXT(struct cs_pin, set,
         "every vertex of the faces of a group, an object or a material of the mesh's file"),
};

const struct cs_table cs_pin_table = {ROWS(pin_rows),         .size = sizeof(struct cs_pin),
                                      .one_of = true,         .n_always_optional = 1,
                                      .shorthand_text = "at", .shorthand_number = "index"};

static const char *const placement_names[] = {"random", "opposed-normals", "nearest", NULL};
static const struct cs_option network_rows[] = {
    CHOICE(struct cs_spring_network, placement, placement_names, CS_PLACEMENT_NEAREST,
           "random: any two particles; opposed-normals: only where their normals point away "
           "from each other; nearest: the nearest of some such candidates"),
    INT(struct cs_spring_network, springs, "", 6, 0, 1000,
        "inner springs tried for each particle; 0: springs on the surface only"),
    INT(struct cs_spring_network, candidates, "", 4, 1, 1000,
        "of placement nearest, from which the nearest is taken"),
    INT(struct cs_spring_network, tries, "", 64, 1, 100000,
        "random draws for one spring; if none is suitable, the spring is left out"),
    INT(struct cs_spring_network, seed, "", 1, 0, 4294967295.0, "of the draws"),
    REAL(struct cs_spring_network, surface, "", 4, 1e-6, 1e6,
         "stiffness of the springs on the surface over that of the inner ones, which is "
         "springs.stretch"),
};
static const struct cs_table network_table = {
    ROWS(network_rows), .size = sizeof(struct cs_spring_network), .optional = true};

static const struct cs_option matching_rows[] = {
    REAL(struct cs_shape_matching, alpha, "", 0.5, 0, 1,
         "fraction of the distance to its goal that a particle moves in a step: 0 leaves it "
         "free, 1 makes the body rigid"),
    REAL(struct cs_shape_matching, beta, "", 0, 0, 1,
         "fraction of the best linear transformation, scaled to the original volume, in the "
         "goals; the rest is the rotation"),
    REAL(struct cs_shape_matching, alpha_step, "s", 1.0 / 60, 0, 10,
         "step that alpha is meant for; other steps get the fraction of the same stiffness. 0: "
         "alpha holds for a step of any length, so shorter steps are stiffer"),
    INT(struct cs_shape_matching, clusters, "", 1, 1, 1024,
        "clusters, each of which keeps its own shape"),
    REAL(struct cs_shape_matching, overlap, "", 0.25, 0, 10,
         "of clusters: each contains the particles in its box, enlarged by this fraction of "
         "the longest side; more overlap makes the body harder to bend"),
    BOOL(struct cs_shape_matching, springs, 0, "the body's springs act too"),
};
static const struct cs_table matching_table = {
    ROWS(matching_rows), .size = sizeof(struct cs_shape_matching), .optional = true};

static const struct cs_option mass_rows[] = {
    REAL(struct cs_mass, particle, "kg", ABSENT, 1e-12, BIG, "of each particle"),
    REAL(struct cs_mass, areal_density, "kg/m2", ABSENT, 1e-12, BIG,
         "each particle gets a quarter of every cell, or a third of every triangle, that it "
         "belongs to"),
    REAL(struct cs_mass, total, "kg", ABSENT, 1e-12, BIG, "of the body, divided equally"),
    REAL(struct cs_mass, degree, "kg", ABSENT, 1e-12, BIG, "for each spring at the particle"),
};
static const struct cs_table mass_table = {ROWS(mass_rows), .size = sizeof(struct cs_mass),
                                           .one_of = true};

static const char *const damping_names[] = {"relative", "axial", NULL};
static const char *const stiffness_names[] = {"N/m", "N", NULL};
static const struct cs_option spring_rows[] = {
    REAL(struct cs_spring_law, stretch, "N/m", 50, 0, 1e12,
         "stiffness between direct neighbours, or along the edges of a mesh; 0: no such "
         "springs"),
    REAL(struct cs_spring_law, shear, "N/m", 20, 0, 1e12,
         "stiffness between diagonal neighbours of a grid"),
    REAL(struct cs_spring_law, bend, "N/m", 8, 0, 1e12,
         "stiffness between second neighbours, or across the edges of a mesh"),
    REAL(struct cs_spring_law, damping, "N s/m", 0, 0, 1e12, "damper parallel to every spring"),
    CHOICE(struct cs_spring_law, damping_model, damping_names, CS_DAMPING_AXIAL,
           "relative: on the whole relative velocity; axial: on its part along the spring"),
    CHOICE(struct cs_spring_law, stiffness_unit, stiffness_names, CS_STIFFNESS_N_PER_M,
           "N: the stiffness is divided by each spring's rest length"),
};
const struct cs_table cs_spring_table = {ROWS(spring_rows),
                                         .size = sizeof(struct cs_spring_law)};

static const struct cs_option face_rows[] = {
    TEXT(struct cs_face_colour, set, "group, object or material of the mesh's file"),
    VECTOR(struct cs_face_colour, colour, 3, "", one3, 0, 1, "linear RGB"),
};
static const struct cs_table face_table = {ROWS(face_rows),
                                           .size = sizeof(struct cs_face_colour)};

static const char *const shading_names[] = {"smooth", "flat", NULL};
static const double red_cloth[3] = CS_CLOTH_RED;
static const struct cs_option material_rows[] = {
    VECTOR(struct cs_material, colour, 3, "", red_cloth, 0, 1,
           "of the front, linear RGB; it multiplies a texture, whose default is white"),
    VECTOR(struct cs_material, back_colour, 3, "", absent3, 0, 1, "of the back; as the front"),
    REAL(struct cs_material, ambient, "", 1, 0, 10, "coefficient ka of the ambient light"),
    REAL(struct cs_material, diffuse, "", 1, 0, 10, "coefficient kd of the diffuse light"),
    REAL(struct cs_material, specular, "", 0.2, 0, 10, "coefficient ks of the highlight"),
    REAL(struct cs_material, shininess, "", 24, 1, 1000, "exponent of the highlight"),
    CHOICE(
        struct cs_material, shading, shading_names, CS_SHADING_SMOOTH,
        "normals: interpolated, but not over the edges of the shape box; or one per triangle"),
    TEXT(struct cs_material, texture, "PNG file, relative to the scene file; times the colour"),
    VECTOR(struct cs_material, texture_repeat, 2, "", one2, 1e-3, 1e4,
           "repetitions of the texture along a row and a column, or a mesh's width and height"),
    LIST(struct cs_material, faces, face_table,
         "of a mesh's file, instead of a texture: colours of faces by their names, times the "
         "colour; the first counts"),
};
static const struct cs_table material_table = {ROWS(material_rows),
                                               .size = sizeof(struct cs_material)};

static const struct cs_option body_rows[] = {
    TABLE(struct cs_body, cloth, cloth_table, "a rectangular grid of particles"),
    TABLE(struct cs_body, mesh, cs_mesh_table, "triangles, instead of cloth"),
    TABLE(struct cs_body, network, network_table,
          "springs through the inside of a closed mesh"),
    TABLE(struct cs_body, shape_matching, matching_table,
          "pulled back to its shape at time 0, for integrator shape-matching"),
    TABLE(struct cs_body, mass, mass_table, "exactly one of its keys"),
    TABLE(struct cs_body, springs, cs_spring_table, "spring law"),
    TABLE(struct cs_body, elastic, cs_elastic_table,
          "membrane and bending instead of springs, with constants that do not depend on the "
          "mesh"),
    LIST(struct cs_body, pins, cs_pin_table, "particles that keep their position"),
    BOOL(struct cs_body, self_contact, 0,
         "it does not pass through itself; for contact.law force"),
    REAL(struct cs_body, thickness, "m", 0, 0, BIG,
         "of its surface: distance at which two layers begin to repel each other; for two "
         "bodies the mean. 0: 0.4 of its shortest edge at the start"),
    REAL(struct cs_body, friction, "", 0, 0, 1000, "Coulomb coefficient on itself"),
    REAL(struct cs_body, strain_limit, "", ABSENT, 1, 1000,
         "largest length of a stretch spring over its rest length; absent: no limit"),
    INT(struct cs_body, strain_limit_sweeps, "", 10, 1, 10000,
        "passes of the strain limit over the springs after each step, before rounds that meet "
        "it"),
    REAL(struct cs_body, pressure, "Pa", 0, 0, BIG, "inside a closed mesh over that outside"),
    REAL(struct cs_body, outer_pressure, "Pa", ABSENT, 0, 1e9,
         "outside, 101325 of air: the gas inside is shut in, and its pressure over 0 times the "
         "volume stays as at the start; absent: pressure stays, as from a pump"),
    TABLE(struct cs_body, material, material_table, "Blinn-Phong look"),
};
const struct cs_table cs_body_table = {ROWS(body_rows), .size = sizeof(struct cs_body)};

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

const struct cs_elastic *cs_scene_elastic(const struct cs_scene *scene, uint32_t b) {
    return &cs_scene_bodies(scene)[b].elastic;
}
