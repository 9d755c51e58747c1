/* The scene's rows: the one place that says which keys a scene has. Parsing, --set, --resolved,
 * the schema and the man page all come from here. A default outside its range (NAN, -1) means:
 * absent unless given. */
#include "scene/body_keys.h"
#include "scene/collider.h"
#include "scene/collider_keys.h"
#include "scene/contact_keys.h"
#include "scene/force_keys.h"
#include "scene/picture_keys.h"
#include "scene/table_rows.h"

static const double zero3[3] = {0, 0, 0};
static const double one2[2] = {1, 1};
static const double no_turn[4] = {0, 0, 0, 1};
static const double absent9[9] = {ABSENT, ABSENT, ABSENT, ABSENT, ABSENT,
                                  ABSENT, ABSENT, ABSENT, ABSENT};

static const char *const start_names[] = {"hanging", "flat", NULL};
static const struct cs_option place_rows[] = {
    VECTOR(struct cs_pose, translate, 3, "m", zero3, -BIG, BIG,
           "translation, after the rotation"),
    VECTOR(struct cs_pose, rotate, 4, "", no_turn, -BIG, BIG,
           "rotation as a quaternion x, y, z, w of any length"),
    VECTOR(struct cs_pose, matrix, 9, "", absent9, -1, 1,
           "rotation as the rows of a matrix, instead of rotate"),
};
static const struct cs_table place_table = {ROWS(place_rows), .size = sizeof(struct cs_pose)};

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
    TABLE(struct cs_cloth, place, place_table, "rigid placement, about the cloth's centre"),
    VECTOR(struct cs_cloth, velocity, 3, "m/s", zero3, -BIG, BIG,
           "of every particle that is not pinned, at time 0"),
    VECTOR(
        struct cs_cloth, spin, 3, "rad/s", zero3, -BIG, BIG,
        "angular velocity about the point that place moves the centre to, added to velocity"),
};
static const struct cs_table cloth_table = {ROWS(cloth_rows), .size = sizeof(struct cs_cloth),
                                            .optional = true};

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
    TABLE(struct cs_mesh_source, place, place_table, "rigid placement, about the origin"),
    VECTOR(struct cs_mesh_source, velocity, 3, "m/s", zero3, -BIG, BIG,
           "of every particle that is not pinned, at time 0"),
    VECTOR(struct cs_mesh_source, spin, 3, "rad/s", zero3, -BIG, BIG,
           "about place.translate, added to the velocity"),
};
enum { N_MESH_ROWS = sizeof mesh_rows / sizeof *mesh_rows };
static const struct cs_table mesh_table = {.rows = mesh_rows + 1,
                                           .n = N_MESH_ROWS - 1,
                                           .size = sizeof(struct cs_mesh_source),
                                           .optional = true,
                                           .one_of = true,
                                           .n_always_optional = 1};
/* events and key frames move a collider */
const struct cs_table cs_mesh_keys = {.rows = mesh_rows,
                                      .n = N_MESH_ROWS - 2,
                                      .size = sizeof(struct cs_mesh_source),
                                      .optional = true,
                                      .one_of = true,
                                      .n_always_optional = 2};

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
    VECTOR(struct cs_material, back_colour, 3, "", absent9, 0, 1, "of the back; as the front"),
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
    TABLE(struct cs_body, mesh, mesh_table, "triangles, instead of cloth"),
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
static const struct cs_table body_table = {ROWS(body_rows), .size = sizeof(struct cs_body)};

static const double grey[3] = {0.32, 0.36, 0.42};
static const struct cs_option collider_rows[] = {
#define X(name, keys, text) TABLE(struct cs_collider, name, cs_##name##_keys, text),
    CS_SHAPE_LIST(X)
#undef X
        REAL(struct cs_collider, friction, "", 0, 0, 1000, "Coulomb coefficient"),
    REAL(struct cs_collider, absorption, "", 1, -1, 1,
         "fraction of the inward normal velocity that is removed; -e: reversed and multiplied "
         "by e (restitution)"),
    REAL(struct cs_collider, thickness, "m", 0, 0, BIG,
         "offset from the surface; for contact by force its range, 0: 0.4 of the shortest "
         "spring, less where a particle starts closer, or for a mesh collider the thickness of "
         "the body"),
    VECTOR(struct cs_collider, colour, 3, "", grey, 0, 1, "linear RGB"),
    BOOL(struct cs_collider, visible, 1, "draw it"),
};
static const struct cs_table collider_table = {
    ROWS(collider_rows), .size = sizeof(struct cs_collider), .one_of = true};

static const char *const contact_names[] = {"project", "force", NULL};
static const char *const inside_names[] = {"refuse", "move-out", "allow", NULL};
static const char *const friction_names[] = {"smooth", "stick", NULL};
static const struct cs_option contact_rows[] = {
    CHOICE(struct cs_contact_keys, law, contact_names, CS_CONTACT_FORCE,
           "force: a force between surfaces in contact range, part of the equation of motion; "
           "project: after each step particles inside a collider are moved to its surface, the "
           "default of methods that cannot follow the force"),
    CHOICE(
        struct cs_contact_keys, start, inside_names, CS_CONTACT_START_REFUSE,
        "a particle that starts inside a collider, or, for force, bodies that start with more "
        "contact energy than at rest: refuse the scene, move them out first, as the report "
        "then states, or allow it"),
    REAL(struct cs_contact_keys, untangle, "s", ABSENT, 1e-6, BIG,
         "particles that start inside a collider are moved out along the shortest way, from "
         "rest to rest in this time, and feel colliders from its end on; absent: see start"),
    REAL(struct cs_contact_keys, stiffness, "N/m", ABSENT, 1e-9, 1e12,
         "for force, per particle; absent: 40 m v^2/D^2 for the speed v at which surfaces may "
         "meet, at least springs.stretch of the softest body that has such springs"),
    REAL(struct cs_contact_keys, damping, "s", 0, 0, BIG,
         "for force: normal damping over contact stiffness; where law is not given either: "
         "sqrt(m/k) of the heaviest particle m and the stiffest collider k"),
    REAL(
        struct cs_contact_keys, restitution, "", ABSENT, 0, 1,
        "for force: speed after an impact over that before, at any speed and stiffness, with "
        "all "
        "methods, whose steps then resolve impacts; absent: damping alone, and what the method "
        "loses itself"),
    REAL(struct cs_contact_keys, friction_speed, "m/s", 1e-3, 1e-9, BIG,
         "for force, smooth: sliding speed at which friction reaches 0.7 of its limit"),
    CHOICE(struct cs_contact_keys, friction_law, friction_names, CS_FRICTION_SMOOTH,
           "for force: smooth: friction depends on the velocity alone, and what rests creeps; "
           "stick: particles hang on anchors in colliders and rest below the limit"),
    REAL(struct cs_contact_keys, sample_stretch, "", 1, 1, 16,
         "for force: length of an edge over that at the start, up to which contact samples "
         "leave "
         "no gap"),
};
static const struct cs_table contact_table = {ROWS(contact_rows),
                                              .size = sizeof(struct cs_contact_keys),
                                              .apart = true, .shorthand_text = "law"};

static const char *const crossings_names[] = {"ignore", "count", "limit", "stop", NULL};
static const struct cs_option pair_rows[] = {
    COUNTS(struct cs_body_pair_keys, bodies, 2, "", NULL, 0, 65535, "numbers of two bodies"),
    REAL(struct cs_body_pair_keys, friction, "", 0, 0, 1000,
         "Coulomb coefficient between them"),
};
static const struct cs_table pair_table = {ROWS(pair_rows),
                                           .size = sizeof(struct cs_body_pair_keys)};
static const char *const among_names[] = {"listed", "all", NULL};
static const struct cs_option pairs_rows[] = {
    CHOICE(struct cs_body_pairs_keys, among, among_names, CS_PAIRS_NAMED,
           "listed: the pairs of list; all: every two bodies"),
    REAL(struct cs_body_pairs_keys, friction, "", 0, 0, 1000,
         "for all: Coulomb coefficient between two bodies that are not in the list"),
    LIST(struct cs_body_pairs_keys, list, pair_table,
         "pairs of bodies, each with its own friction"),
};
static const struct cs_table pairs_table = {ROWS(pairs_rows),
                                            .size = sizeof(struct cs_body_pairs_keys),
                                            .apart = true, .shorthand_text = "among"};

static const double absent3[3] = {ABSENT, ABSENT, ABSENT};
static const char *const wind_units[] = {"Pa", "N", NULL};
static const struct cs_option wind_rows[] = {
    VECTOR(struct cs_wind, direction, 3, "", absent3, -BIG, BIG,
           "direction of strength, of any non-zero length; required without velocity"),
    REAL(struct cs_wind, strength, "Pa or N", 0, 0, BIG,
         "pressure or force where the cloth faces it; times |direction . normal| elsewhere"),
    CHOICE(struct cs_wind, strength_unit, wind_units, CS_WIND_PA,
           "Pa: times the area of the particle, independent of the grid; N: on each particle"),
    VECTOR(struct cs_wind, velocity, 3, "m/s", absent3, -BIG, BIG,
           "of the air, which the cloth feels by its own velocity against it; 0, 0, 0: still "
           "air; absent: none"),
    REAL(struct cs_wind, density, "kg/m3", 1.2, 0, BIG, "of the air, with velocity"),
    REAL(struct cs_wind, drag, "", 1.2, 0, 1000,
         "with velocity: coefficient of the pressure density/2 u^2 by the velocity u across "
         "the surface; drag and lift are its parts along the wind and across"),
};
static const struct cs_table wind_table = {ROWS(wind_rows), .size = sizeof(struct cs_wind),
                                           .optional = true};
static const double earth[3] = {0, -9.81, 0};
static const char *const drag_units[] = {"N s/m", "Pa s/m", NULL};
static const struct cs_option force_rows[] = {
    VECTOR(struct cs_forces, gravity, 3, "m/s2", earth, -BIG, BIG, "acceleration of free fall"),
#define X(key, unit_, help_) REAL(struct cs_forces, key, unit_, 0, 0, BIG, help_),
    CS_FORCE_NUMBERS(X)
#undef X
        CHOICE(struct cs_forces, drag_unit, drag_units, CS_DRAG_PARTICLE,
               "N s/m: on each particle; Pa s/m: times the area of the particle"),
    REAL(struct cs_forces, velocity_loss, "", 0, 0, 1,
         "fraction of the velocity removed after every internal step: it depends on the step "
         "and is not a force"),
    TABLE(struct cs_forces, wind, wind_table, "steady wind, by the particle normals"),
};
static const struct cs_table force_table = {ROWS(force_rows), .size = sizeof(struct cs_forces),
                                            .apart = true};

static const struct cs_option time_rows[] = {
    REAL(struct cs_time, fps, "1/s", 60, 1e-3, 1e6,
         "frames per second; frame k shows t = k / fps"),
};
static const struct cs_table time_table = {ROWS(time_rows), .size = sizeof(struct cs_time)};

static const struct cs_option scene_rows[] = {
    TEXT(struct cs_scene, about, "description of the scene"),
    TEXT(struct cs_scene, source, "source of the scene"),
    LIST(struct cs_scene, bodies, body_table, "moving bodies; at least one"),
    LIST(struct cs_scene, colliders, collider_table,
         "shapes that bodies rest on and slide off"),
    TABLE(struct cs_scene, contact, contact_table, "contact of bodies with colliders"),
    CHOICE(
        struct cs_scene, crossings, crossings_names, -1,
        "edges of bodies that cross triangles: ignore: the same as absent; count: after each "
        "frame; limit: also shorten steps that would make a crossing; stop: the first one "
        "ends the run"),
    TABLE(struct cs_scene, pairs, pairs_table,
          "bodies that do not pass through each other; for contact.law force"),
    LIST(struct cs_scene, seams, cs_seam_table,
         "stitches between particles and bodies, or within one body"),
    TABLE(struct cs_scene, forces, force_table, "from outside, on every particle"),
    LIST(struct cs_scene, events, cs_event_table, "changes at a time or over an interval"),
    TABLE(struct cs_scene, time, time_table, "frames"),
    TABLE(struct cs_scene, camera, cs_camera_table, "look-at camera"),
    TABLE(struct cs_scene, light, cs_light_table,
          "the first light, at a point or from a direction"),
    LIST(struct cs_scene, lights, cs_lights_table, "up to 3 further lights"),
    TABLE(struct cs_scene, render, cs_render_table, "picture"),
};
const struct cs_table cs_scene_table = {ROWS(scene_rows), .size = sizeof(struct cs_scene)};
