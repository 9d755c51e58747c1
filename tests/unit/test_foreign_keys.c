/* An unknown key that another program uses leads to the key of a scene for the same thing: the
 * suggestion is a key that the scene then reads, or an option of the command line. */
#include "scene/file/scene_read.h"
#include "scene/scene.h"
#include "unit.h"

#include <stdio.h>

/* A scene with a place for each key of its kind; %s is where the unknown key stands. */
static const struct {
    const char *place, *text;
} scenes[] = {
    {"", "{%s, \"bodies\": []}"},
    {"bodies[0]", "{\"bodies\": [{%s}]}"},
    {"bodies[0].cloth", "{\"bodies\": [{\"cloth\": {%s}}]}"},
    {"bodies[0].mesh", "{\"bodies\": [{\"mesh\": {%s}}]}"},
    {"bodies[0].mass", "{\"bodies\": [{\"mass\": {%s}}]}"},
    {"bodies[0].springs", "{\"bodies\": [{\"springs\": {%s}}]}"},
    {"bodies[0].elastic", "{\"bodies\": [{\"elastic\": {%s}}]}"},
    {"bodies[0].material", "{\"bodies\": [{\"material\": {%s}}]}"},
    {"bodies[0].pins[0]", "{\"bodies\": [{\"pins\": [{%s}]}]}"},
    {"colliders[0]", "{\"colliders\": [{%s}]}"},
    {"colliders[0].box", "{\"colliders\": [{\"box\": {%s}}]}"},
    {"colliders[0].sphere", "{\"colliders\": [{\"sphere\": {%s}}]}"},
    {"colliders[0].capsule", "{\"colliders\": [{\"capsule\": {%s}}]}"},
    {"contact", "{\"contact\": {%s}}"},
    {"forces", "{\"forces\": {%s}}"},
    {"forces.wind", "{\"forces\": {\"wind\": {%s}}}"},
    {"seams[0]", "{\"seams\": [{%s}]}"},
    {"events[0]", "{\"events\": [{%s}]}"},
    {"events[0].move", "{\"events\": [{\"move\": {%s}}]}"},
    {"time", "{\"time\": {%s}}"},
    {"camera", "{\"camera\": {%s}}"},
    {"light", "{\"light\": {%s}}"},
    {"render", "{\"render\": {%s}}"},
};

/* Keys of B: Blender, A: ARCSim, M: MuJoCo, H: Houdini, D: Marvelous Designer, W: everyday
 * words. */
static const struct {
    char program;
    const char *place, *key, *suggested;
} keys[] = {
    {'B', "bodies[0].springs", "tension_stiffness", "\"stretch\""},
    {'B', "bodies[0].springs", "compression_stiffness", "\"stretch\""},
    {'B', "bodies[0].springs", "shear_stiffness", "\"shear\""},
    {'B', "bodies[0].springs", "bending_stiffness", "\"bend\""},
    {'B', "bodies[0].springs", "tension_damping", "\"damping\""},
    {'B', "bodies[0]", "tension_stiffness", "\"springs.stretch\""},
    {'B', "bodies[0]", "bending_stiffness", "\"springs.bend\""},
    {'B', "bodies[0]", "air_damping", "\"forces.drag\""},
    {'B', "bodies[0]", "vertex_group_mass", "\"pins\""},
    {'B', "bodies[0]", "use_self_collision", "\"self_contact\""},
    {'B', "bodies[0]", "self_friction", "\"friction\""},
    {'B', "bodies[0]", "self_distance_min", "\"thickness\""},
    {'B', "bodies[0]", "distance_min", "\"thickness\""},
    {'B', "bodies[0]", "uniform_pressure_force", "\"pressure\""},
    {'B', "bodies[0]", "vertex_mass", "\"mass.particle\""},
    {'B', "bodies[0].cloth", "shrink_min", "\"stretch\""},
    {'B', "bodies[0].cloth", "subdivisions", "\"grid\""},
    {'B', "bodies[0].pins[0]", "vertex_group", "\"set\""},
    {'B', "colliders[0]", "thickness_outer", "\"thickness\""},
    {'B', "colliders[0]", "cloth_friction", "\"friction\""},
    {'B', "", "quality", "\"integrator.dt\""},
    {'B', "time", "frame_rate", "\"fps\""},
    {'B', "light", "energy", "\"strength\""},
    {'B', "camera", "angle", "\"fov\""},
    {'B', "bodies[0].material", "roughness", "\"shininess\""},
    {'B', "bodies[0].springs", "compression_damping", "\"damping\""},
    {'B', "bodies[0].springs", "shear_damping", "\"damping\""},
    {'B', "bodies[0].springs", "bending_damping", "\"damping\""},
    {'B', "bodies[0].elastic", "bending_damping", "\"bending.damping\""},
    {'B', "", "use_sewing_springs", "\"seams\""},
    {'B', "bodies[0]", "use_pressure", "\"pressure\""},
    {'B', "bodies[0]", "pin_stiffness", "\"pins\""},
    {'A', "", "frame_time", "\"time.fps\""},
    {'A', "", "end_time", "\"clothsim run --time\""},
    {'A', "", "end_frame", "\"clothsim run --frames\""},
    {'A', "", "cloths", "\"bodies\""},
    {'A', "", "handles", "\"bodies[0].pins\""},
    {'A', "", "motions", "\"events\""},
    {'A', "", "obstacles", "\"colliders\""},
    {'A', "bodies[0]", "transform", "\"cloth.place or mesh.place\""},
    {'A', "bodies[0]", "position", "\"cloth.place.translate or mesh.place.translate\""},
    {'A', "bodies[0]", "strain_limits", "\"strain_limit\""},
    {'A', "bodies[0]", "stretching_mult", "\"springs.stretch\""},
    {'A', "bodies[0]", "bending_mult", "\"springs.bend\""},
    {'A', "bodies[0]", "damping_mult", "\"springs.damping\""},
    {'A', "bodies[0]", "obs_friction", "\"colliders[0].friction\""},
    {'A', "bodies[0]", "repulsion_thickness", "\"thickness\""},
    {'A', "contact", "repulsion_thickness", "\"bodies[0].thickness\""},
    {'A', "contact", "collision_stiffness", "\"stiffness\""},
    {'A', "", "collision_stiffness", "\"contact.stiffness\""},
    {'A', "bodies[0].pins[0]", "nodes", "\"index\""},
    {'A', "", "frame_steps", "\"integrator.dt\""},
    {'M', "", "timestep", "\"integrator.dt\""},
    {'M', "bodies[0]", "young", "\"elastic.membrane.young\""},
    {'M', "bodies[0].elastic", "young", "\"membrane.young\""},
    {'M', "bodies[0].elastic", "poisson", "\"membrane.poisson"},
    {'M', "bodies[0]", "elastic2d", "\"elastic\""},
    {'M', "bodies[0]", "margin", "\"thickness\""},
    {'M', "bodies[0]", "selfcollide", "\"self_contact\""},
    {'M', "bodies[0].cloth", "count", "\"grid\""},
    {'M', "bodies[0].cloth", "spacing", "\"size\""},
    {'M', "bodies[0].cloth", "pos", "\"place.translate\""},
    {'M', "bodies[0].cloth", "quat", "\"place.rotate\""},
    {'M', "bodies[0].cloth", "euler", "\"place.rotate\""},
    {'M', "bodies[0].mass", "density", "\"areal_density\""},
    {'M', "colliders[0]", "geom", "\"box\""},
    {'M', "colliders[0]", "cylinder", "\"capsule\""},
    {'M', "colliders[0].sphere", "pos", "\"centre\""},
    {'M', "colliders[0].box", "pos", "\"centre\""},
    {'M', "colliders[0]", "velocity", "\"events[0].move\""},
    {'M', "forces", "viscosity", "\"drag\""},
    {'M', "bodies[0]", "radius", "\"thickness\""},
    {'M', "contact", "solref", "\"stiffness\""},
    {'H', "bodies[0]", "stretchstiffness", "\"springs.stretch\""},
    {'H', "bodies[0]", "bendstiffness", "\"springs.bend\""},
    {'H', "bodies[0]", "normaldrag", "\"forces.drag\""},
    {'H', "bodies[0].cloth", "rest_length_scale", "\"stretch\""},
    {'H', "", "substeps", "\"integrator.dt\""},
    {'H', "time", "substeps", "\"integrator.dt\""},
    {'H', "seams[0]", "break_threshold", "\"breaking_force\""},
    {'H', "seams[0]", "rest_length", "\"length\""},
    {'H', "bodies[0].pins[0]", "group", "\"set\""},
    {'H', "bodies[0].mesh", "group", "\"set\""},
    {'H', "bodies[0].mesh", "up_axis", "\"up\""},
    {'H', "bodies[0].springs", "stretchdampingratio", "\"damping\""},
    {'H', "bodies[0].springs", "benddampingratio", "\"damping\""},
    {'H', "bodies[0].cloth", "stretchrestscale", "\"stretch\""},
    {'H', "", "constraintiterations", "\"integrator\""},
    {'H', "", "velocitydamping", "\"forces.drag\""},
    {'H', "bodies[0]", "dynamicfriction", "\"friction\""},
    {'H', "seams[0]", "breakingthreshold", "\"breaking_force\""},
    {'D', "bodies[0].elastic", "stretch_warp", "\"membrane.warp\""},
    {'D', "bodies[0].elastic", "stretch_weft", "\"membrane.weft\""},
    {'D', "bodies[0].elastic", "bending_warp", "\"bending.warp\""},
    {'D', "bodies[0].elastic", "bending_weft", "\"bending.weft\""},
    {'D', "bodies[0].elastic", "shear", "\"membrane.shear\""},
    {'D', "bodies[0].elastic", "fabric", "\"cloth\""},
    {'D', "bodies[0]", "internal_damping", "\"springs.damping\""},
    {'D', "bodies[0]", "density", "\"mass.areal_density\""},
    {'D', "bodies[0]", "friction_coefficient", "\"friction\""},
    {'D', "colliders[0]", "skin_offset", "\"thickness\""},
    {'D', "", "garments", "\"bodies\""},
    {'D', "", "sewing", "\"seams\""},
    {'D', "bodies[0].cloth", "particle_distance", "\"grid\""},
    {'D', "bodies[0].cloth", "shrinkage_weft", "\"stretch\""},
    {'D', "bodies[0].cloth", "shrinkage_warp", "\"stretch\""},
    {'D', "", "avatar", "\"colliders\""},
    {'W', "bodies[0]", "inflation", "\"pressure\""},
    {'W', "bodies[0]", "ambient_pressure", "\"outer_pressure\""},
    {'W', "forces.wind", "speed", "\"velocity\""},
    {'W', "forces.wind", "air_density", "\"density\""},
    {'W', "forces.wind", "lift", "\"drag\""},
    {'W', "events[0]", "unzip", "\"unsew\""},
    {'W', "forces", "pressure", "\"wind.strength\""},
    {'W', "bodies[0].material", "color", "\"colour\""},
    {'W', "bodies[0].material", "albedo", "\"colour\""},
    {'W', "colliders[0]", "color", "\"colour\""},
    {'W', "colliders[0]", "ground", "\"floor\""},
    {'W', "colliders[0]", "cube", "\"box\""},
    {'W', "colliders[0]", "obj", "\"mesh.file\""},
    {'W', "colliders[0]", "restitution", "\"contact.restitution\""},
    {'W', "colliders[0]", "motion", "\"events[0].move\""},
    {'W', "colliders[0].box", "extents", "\"size\""},
    {'W', "colliders[0].capsule", "height", "\"to\""},
    {'W', "bodies[0].pins[0]", "sphere", "\"box\""},
    {'W', "bodies[0].mesh", "unit", "\"units\""},
    {'W', "bodies[0].mesh", "path", "\"file\""},
    {'W', "", "units", "\"bodies[0].mesh.units or colliders[0].mesh.units\""},
    {'W', "", "gravity", "\"forces.gravity\""},
    {'W', "", "fps", "\"time.fps\""},
    {'W', "", "name", "\"about\""},
    {'W', "bodies[0].springs", "k", "\"stretch\""},
    {'W', "seams[0]", "k", "\"stiffness\""},
    {'W', "events[0].move", "pivot", "\"centre\""},
    {'W', "events[0].move", "axis", "\"spin\""},
    {'W', "events[0]", "time", "\"at\""},
    {'W', "events[0]", "detach", "\"release\""},
    {'W', "events[0]", "attach", "\"pin\""},
    {'W', "camera", "position", "\"eye\""},
    {'W', "light", "color", "\"diffuse\""},
    {'W', "render", "width", "\"size\""},
};

static const char *text_of(const char *place) {
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++)
        if (!strcmp(scenes[k].place, place))
            return scenes[k].text;
    ck_abort_msg("no scene for %s", place);
    return NULL;
}

TEST(keys_of_other_programs_lead_to_ours) {
    size_t of_programs = 0;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        of_programs += keys[k].program != 'W';
        char text[256], member[64], expected[160];
        const char *form = text_of(keys[k].place), *at = strstr(form, "%s");
        struct cs_scene scene;
        struct cs_error error = {0};
        snprintf(member, sizeof member, "\"%s\": 1", keys[k].key);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - form), form, member, at + 2);
        snprintf(expected, sizeof expected, "unknown key; did you mean %s", keys[k].suggested);
        ck_assert_int_eq(
            cs_scene_read_text(&scene, "s.json", text, strlen(text), NULL, 0, &error),
            CS_ERR_SCENE);
        ck_assert_msg(strstr(error.message, expected) != NULL,
                      "%c %s.%s: found %s, expected %s", keys[k].program, keys[k].place,
                      keys[k].key, error.message, expected);
    }
    ck_assert_uint_ge(of_programs, 100);
}
