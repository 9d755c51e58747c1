/* Keys of Blender, Houdini (Vellum), ARCSim, MuJoCo and Marvelous Designer, and everyday words.
 */
#include "scene/file/json_context.h"

#include <stdio.h>
#include <string.h>

/* place: keys that must be in the path; "": anywhere. Of the rows of a key the first whose end
 * is a key of the table at hand, else the first of a matching place. */
static const struct {
    const char *place, *key, *ours;
} rows[] = {
    // clang-format off
    {"contact", "friction", "friction"},
    {"colliders", "velocity", "events.move"}, {"colliders", "speed", "events.move"},
    {"colliders", "motion", "events.move"}, {"colliders", "spin", "move.spin"}, {"colliders", "path", "events.move"},
    {"colliders", "ground", "colliders.floor"}, {"colliders", "geom", "colliders.box"},
    {"colliders", "cube", "colliders.box"}, {"colliders", "cylinder", "colliders.capsule"},
    {"colliders", "obj", "mesh.file"}, {"colliders", "damping", "contact.damping"},
    {"colliders", "thickness_outer", "colliders.thickness"}, {"colliders", "color", "colliders.colour"},
    {"colliders", "cloth_friction", "colliders.friction"}, {"capsule", "height", "capsule.to"},
    {"colliders", "pos", "centre"}, {"colliders", "at", "centre"}, {"box", "extents", "box.size"}, {"box", "half_extents", "box.size"},
    {"wind", "speed", "wind.velocity"}, {"wind", "air_velocity", "wind.velocity"}, {"wind", "lift", "wind.drag"},
    {"wind", "coefficient", "wind.drag"}, {"wind", "drag_coefficient", "wind.drag"}, {"wind", "cd", "wind.drag"},
    {"wind", "air_density", "wind.density"},
    {"wind", "pressure", "wind.strength"}, {"wind", "intensity", "wind.strength"},
    {"wind", "force", "wind.strength"},
    {"material", "color", "material.colour"}, {"material", "albedo", "material.colour"},
    {"material", "roughness", "material.shininess"}, {"material", "map_Kd", "material.texture"},
    {"background", "color", "background.colour"},
    {"bodies.pins", "sphere", "pins.box"}, {"particles", "sphere", "particles.box"},
    {"bodies.pins", "group", "pins.set"}, {"bodies.pins", "vertex_group", "pins.set"},
    {"bodies.pins", "vertices", "pins.index"}, {"bodies.pins", "nodes", "pins.index"},
    {"bodies.pins", "name", "pins.set"}, {"particles", "group", "particles.set"},
    {"mesh", "group", "mesh.set"}, {"mesh", "unit", "mesh.units"}, {"mesh", "up_axis", "mesh.up"},
    {"mesh", "merge", "mesh.weld"}, {"mesh", "path", "mesh.file"}, {"mesh", "filename", "mesh.file"},
    {"mesh", "subdivisions", "mesh.detail"}, {"mesh", "animation", "mesh.key_frames"},
    {"cloth", "resolution", "cloth.grid"}, {"cloth", "count", "cloth.grid"},
    {"cloth", "subdivisions", "cloth.grid"}, {"cloth", "spacing", "cloth.size"},
    {"cloth", "rest_length_scale", "cloth.stretch"}, {"cloth", "shrink_min", "cloth.stretch"},
    {"time", "frame_time", "time.fps"}, {"time", "frame_rate", "time.fps"},
    {"time", "substeps", "integrator.dt"}, {"time", "duration", "clothsim run --time"},
    {"light", "color", "diffuse"}, {"light", "colour", "diffuse"}, {"light", "energy", "light.strength"},
    {"camera", "field_of_view", "camera.fov"}, {"camera", "angle", "camera.fov"},
    {"camera", "from", "camera.eye"}, {"camera", "to", "camera.target"},
    {"elastic", "youngs_modulus", "membrane.young"}, {"elastic", "young", "membrane.young"},
    {"elastic", "poisson", "membrane.poisson"}, {"elastic", "poissons_ratio", "membrane.poisson"},
    {"elastic", "material", "elastic.cloth"}, {"elastic", "fabric", "elastic.cloth"},
    {"elastic", "bending_stiffness", "bending.stiffness"}, {"elastic", "stretch_warp", "membrane.warp"},
    {"elastic", "stretch_weft", "membrane.weft"}, {"elastic", "bending_warp", "bending.warp"},
    {"elastic", "bending_weft", "bending.weft"}, {"elastic", "shear", "membrane.shear"},
    {"seams", "k", "seams.stiffness"}, {"seams", "rest_length", "seams.length"},
    {"seams", "max_length", "seams.breaking_length"}, {"seams", "break_threshold", "seams.breaking_force"},
    {"seams", "strength", "seams.breaking_force"}, {"seams", "max_force", "seams.breaking_force"},
    {"events", "open", "events.unsew"}, {"events", "rip", "events.unsew"}, {"events", "unzip", "events.unsew"},
    {"events", "time", "events.at"}, {"events", "start", "events.from"}, {"events", "end", "events.to"},
    {"move", "pivot", "centre"}, {"grab", "pivot", "centre"}, {"move", "axis", "spin"}, {"grab", "axis", "spin"},
    {"move", "hinge", "centre"}, {"move", "angle", "spin"}, {"move", "rotation", "spin"},
    {"events", "drag", "events.grab"}, {"events", "unpin", "events.release"},
    {"events", "detach", "events.release"}, {"events", "attach", "events.pin"},
    {"", "tension_stiffness", "springs.stretch"}, {"", "compression_stiffness", "springs.stretch"},
    {"", "stretch_stiffness", "springs.stretch"}, {"", "stretchstiffness", "springs.stretch"},
    {"", "stretching_mult", "springs.stretch"}, {"", "structural", "springs.stretch"},
    {"", "k", "springs.stretch"}, {"", "stiffness", "springs.stretch"},
    {"", "shear_stiffness", "springs.shear"}, {"", "diagonal", "springs.shear"},
    {"", "bending_stiffness", "springs.bend"}, {"", "bendstiffness", "springs.bend"},
    {"", "bending_mult", "springs.bend"}, {"", "bending", "springs.bend"}, {"", "flexion", "springs.bend"},
    {"", "tension_damping", "springs.damping"}, {"", "damping_mult", "springs.damping"},
    {"", "compression_damping", "springs.damping"}, {"", "shear_damping", "springs.damping"},
    {"elastic", "bending_damping", "bending.damping"}, {"", "bending_damping", "springs.damping"},
    {"", "stretchdampingratio", "springs.damping"}, {"", "benddampingratio", "springs.damping"},
    {"cloth", "stretchrestscale", "cloth.stretch"}, {"cloth", "particle_distance", "cloth.grid"},
    {"", "shrinkage_weft", "cloth.stretch"}, {"", "shrinkage_warp", "cloth.stretch"},
    {"", "frame_steps", "integrator.dt"}, {"", "constraintiterations", "integrator"},
    {"", "viscosity", "forces.drag"}, {"", "velocitydamping", "forces.drag"}, {"bodies", "radius", "bodies.thickness"},
    {"", "dynamicfriction", "friction"}, {"", "solref", "contact.stiffness"}, {"", "avatar", "colliders"},
    {"", "use_sewing_springs", "seams"}, {"seams", "breakingthreshold", "seams.breaking_force"},
    {"", "use_pressure", "bodies.pressure"}, {"", "pin_stiffness", "bodies.pins"},
    {"", "internal_damping", "springs.damping"}, {"", "elastic2d", "bodies.elastic"},
    {"", "young", "membrane.young"}, {"", "youngs_modulus", "membrane.young"},
    {"", "air_damping", "forces.drag"}, {"", "air_viscosity", "forces.drag"}, {"", "normaldrag", "forces.drag"},
    {"", "strain_limits", "bodies.strain_limit"}, {"", "max_strain", "bodies.strain_limit"},
    {"", "density", "mass.areal_density"}, {"", "surface_density", "mass.areal_density"},
    {"", "vertex_mass", "mass.particle"}, {"", "handles", "bodies.pins"}, {"", "pinned", "bodies.pins"},
    {"", "fixed", "bodies.pins"}, {"", "vertex_group_mass", "bodies.pins"},
    {"", "use_self_collision", "bodies.self_contact"}, {"", "self_collision", "bodies.self_contact"},
    {"", "self_collisions", "bodies.self_contact"}, {"", "selfcollide", "bodies.self_contact"},
    {"", "self_friction", "bodies.friction"}, {"", "self_distance_min", "bodies.thickness"},
    {"", "repulsion_thickness", "bodies.thickness"}, {"", "distance_min", "bodies.thickness"},
    {"", "margin", "bodies.thickness"}, {"", "skin_offset", "colliders.thickness"},
    {"", "obs_friction", "colliders.friction"}, {"", "friction_coefficient", "friction"},
    {"", "collision_stiffness", "contact.stiffness"}, {"", "restitution", "contact.restitution"},
    {"", "bounce", "colliders.absorption"}, {"", "collision", "contact"}, {"", "collisions", "contact"},
    {"", "obstacles", "colliders"}, {"", "objects", "bodies"}, {"", "cloths", "bodies"},
    {"", "garments", "bodies"}, {"", "motions", "events"}, {"forces", "pressure", "wind.strength"},
    {"bodies", "uniform_pressure_force", "bodies.pressure"}, {"bodies", "inflation", "bodies.pressure"},
    {"bodies", "inflate", "bodies.pressure"}, {"bodies", "ambient_pressure", "bodies.outer_pressure"}, {"", "gas_pressure", "bodies.pressure"}, {"", "sewing", "seams"}, {"", "stitches", "seams"},
    {"", "name", "about"}, {"", "title", "about"}, {"", "description", "about"},
    {"", "dt", "integrator.dt"}, {"", "step", "integrator.dt"}, {"", "timestep", "integrator.dt"},
    {"", "time_step", "integrator.dt"}, {"", "substeps", "integrator.dt"}, {"", "quality", "integrator.dt"},
    {"", "method", "integrator"}, {"", "solver", "integrator"},
    {"", "frame_time", "time.fps"}, {"", "frame_rate", "time.fps"},
    {"", "end_time", "clothsim run --time"}, {"", "duration", "clothsim run --time"},
    {"", "end_frame", "clothsim run --frames"}, {"", "frames", "clothsim run --frames"},
    {"", "output", "clothsim run --out"}, {"bodies", "position", "place.translate"}, {"", "position", "eye"}, {"", "position", "centre"},
    {"", "position", "place.translate"}, {"", "pos", "place.translate"}, {"", "translation", "translate"},
    {"", "rotation", "rotate"}, {"", "orientation", "rotate"}, {"", "quat", "place.rotate"},
    {"", "transform", "place"}, {"", "euler", "place.rotate"}, {"", "look_at", "target"},
    {"", "width", "size"}, {"", "height", "size"}, {"", "resolution", "size"}, {"", "color", "colour"},
    {"", "intensity", "strength"}, {"", "obj", "mesh.file"}, {"", "velocity", "velocity"},
    // clang-format on
};
enum { N_ROWS = sizeof rows / sizeof *rows };

/* Copies a path without its numbers, between two dots: ".bodies.pins.". */
static void copy_plain(const char *path, char out[2 * CS_TEXT_MAX]) {
    size_t n = 0;
    out[n++] = '.';
    for (bool inside = false; *path && n < 2 * CS_TEXT_MAX - 2; path++) {
        inside = inside ? *path != ']' : *path == '[';
        if (!inside && *path != ']')
            out[n++] = *path;
    }
    out[n++] = '.';
    out[n] = 0;
}

bool cs_path_ends_with(const char *path, const char *keys) {
    char plain[2 * CS_TEXT_MAX], end[CS_TEXT_MAX];
    copy_plain(path, plain);
    const int length = snprintf(end, sizeof end, ".%s.", keys);
    const size_t whole = strlen(plain);
    return (size_t)length <= whole && !strcmp(plain + whole - (size_t)length, end);
}

const char *cs_foreign_key(const char *place, const char *key, const struct cs_table *table) {
    char plain[2 * CS_TEXT_MAX], within[CS_TEXT_MAX], path[2 * CS_TEXT_MAX];
    const char *first = NULL;
    copy_plain(place, plain);
    for (size_t r = 0; r < N_ROWS; r++) {
        snprintf(within, sizeof within, ".%s.", rows[r].place);
        if (strcmp(key, rows[r].key) || (*rows[r].place && !strstr(plain, within)))
            continue;
        /* a key of the table at hand, if the row's path leads to it from here */
        const char *dot = strrchr(rows[r].ours, '.'), *last = dot ? dot + 1 : rows[r].ours;
        snprintf(path, sizeof path, "%s%s%s", place, *place ? "." : "", last);
        if (cs_option_find(table, last) && cs_path_ends_with(path, rows[r].ours))
            return last;
        first = first ? first : rows[r].ours;
    }
    return first;
}
