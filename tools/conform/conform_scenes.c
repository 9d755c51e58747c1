/* Holds small scenes as text, in a table at the end. A new force adds its own. */
#include "conform/conform_checks.h"

#define FREE_OF_SPRINGS "\"springs\": {\"stretch\": 0, \"shear\": 0, \"bend\": 0}"
#define FIVE_FRAMES     "\"time\": {\"fps\": 10}"
#define NO_GRAVITY      "\"gravity\": [0, 0, 0]"

/* Two sheets of four particles without springs, the second one rotated and further back. All
 * particles of a sheet have equal mass, area fraction and normal: each sheet moves as a rigid
 * body under any external force, in any model. */
#define SHEETS_OF(first, second)                                                               \
    "\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"velocity\": [1, 2, -1]},"                   \
    " \"mass\": {\"particle\": " first "}, " FREE_OF_SPRINGS "},"                              \
    " {\"cloth\": {\"grid\": [2, 2], \"velocity\": [-1, 0.5, 2], \"place\": {\"translate\":"   \
    " [2, 0, 0], \"rotate\": [0.2, 0.3, 0.1, 0.9]}}, \"mass\": {\"particle\": " second         \
    "}, " FREE_OF_SPRINGS "}]"
#define SHEETS(forces)                                                                         \
    "{" SHEETS_OF("0.1", "0.1") ", \"forces\": {" forces "}, " FIVE_FRAMES "}"
#define SHEETS_WITH(forces, event)                                                             \
    "{" SHEETS_OF("0.1", "0.1") ", \"forces\": {" forces "}, \"events\": [{" event             \
                                "}], " FIVE_FRAMES "}"

/* One sheet, stretched and spinning: springs pull and normals change. */
#define CLOTH                                                                                  \
    "\"cloth\": {\"grid\": [3, 3], \"stretch\": [1.1, 0.95], \"bump\": 0.1,"                   \
    " \"spin\": [0.5, 1, 0.3]}, \"mass\": {\"particle\": 0.1}"
#define SPRINGS(values)                                                                        \
    "{\"bodies\": [{" CLOTH ", \"springs\": {" values "}}], \"forces\": {" NO_GRAVITY          \
    "}, " FIVE_FRAMES "}"

/* The same sheet, elastic. */
#define ELASTIC(values, events)                                                                \
    "{\"bodies\": [{" CLOTH ", \"elastic\": {" values "}}], \"forces\": {" NO_GRAVITY          \
    "}, \"events\": [" events "], " FIVE_FRAMES "}"

/* Springs so soft that dampers determine the motion; a pinned edge causes relative velocities.
 */
#define DAMPERS(model)                                                                         \
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3], \"velocity\": [0.4, -0.5, 0.6]},"            \
    " \"mass\": {\"particle\": 0.1}, \"pins\": [\"top\"], \"springs\": {\"stretch\": 0.001,"   \
    " \"shear\": 0, \"bend\": 0, \"damping\": 0.1, \"damping_model\": \"" model "\"}}],"       \
    " \"forces\": {" NO_GRAVITY "}, " FIVE_FRAMES "}"

#define WIND(strength, unit)                                                                   \
    "\"wind\": {\"direction\": [1, 2, 3], \"strength\": " strength                             \
    ", \"strength_unit\": \"" unit "\"}"
#define AIR "\"wind\": {\"velocity\": [1, 2, 3]}"
/* A ring of 21 particles. */
#define BLOWN(pressure, events)                                                                \
    "{\"bodies\": [{\"mesh\": {\"shape\": \"torus\", \"detail\": 3}, \"mass\": "               \
    "{\"particle\": "                                                                          \
    "0.1}, " FREE_OF_SPRINGS ", \"pressure\": " pressure "}], \"forces\": {" NO_GRAVITY        \
    "}, \"events\": [" events "], " FIVE_FRAMES "}"
#define VIEWPOINT_FORCE(times, more)                                                           \
    times ", \"viewpoint_force\": {\"viewpoint\": {\"eye\": [1, 0, 6], \"target\": [1, 0, "    \
          "0], \"fov\":"                                                                       \
          " 60, \"aspect\": 1.5}, \"force\": 0.8, " more "}"

/* A sheet that approaches a parallel plane and slides: all particles get the same force. It
 * stays in range, where the force is smooth. */
#define CONTACT(friction, events)                                                              \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"velocity\": [0.3, 0.2, -0.3]},"            \
    " \"mass\": {\"particle\": 0.1}, " FREE_OF_SPRINGS "}], \"forces\": {" NO_GRAVITY          \
    "}, \"colliders\": [{\"plane\": {\"point\": [0, 0, -0.2], \"normal\": [0, 0, 1]},"         \
    " \"thickness\": 0.4, \"friction\": " friction                                             \
    "}], \"contact\": {\"law\": \"force\", \"start\": \"allow\", \"stiffness\": 1, "           \
    "\"damping\": 0.02,"                                                                       \
    " \"friction_speed\": 0.2}, \"events\": [" events "], " FIVE_FRAMES "}"

/* A sheet whose edges and diagonal slide over a thin pole out of reach of its particles: tests
 * contact samples between particles. */
#define POLE                                                                                   \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"velocity\": [0.3, 0, -0.3]},"              \
    " \"mass\": {\"particle\": 0.1}, " FREE_OF_SPRINGS "}], \"forces\": {" NO_GRAVITY          \
    "}, \"colliders\": [{\"capsule\": {\"from\": [-2, 0, -0.25], \"to\": [2, 0, -0.25],"       \
    " \"radius\": 0.02}, \"thickness\": 0.4, \"friction\": 0.5}], \"contact\": {\"start\": "   \
    "\"allow\", \"law\":"                                                                      \
    " \"force\", \"stiffness\": 1, \"damping\": 0.02, \"friction_speed\": 0.2}, " FIVE_FRAMES  \
    "}"

/* Two sheets that approach each other and slide; they stay in range. */
#define PAIRS(friction)                                                                        \
    "{\"bodies\": [{\"cloth\": {\"grid\": [2, 2], \"velocity\": [0.15, 0.1, 0.1]},"            \
    " \"mass\": {\"particle\": 0.1}, \"thickness\": 0.4, " FREE_OF_SPRINGS "},"                \
    " {\"cloth\": {\"grid\": [2, 2], \"velocity\": [-0.15, -0.1, -0.1], \"place\":"            \
    " {\"translate\": [0.2, 0.1, 0.3]}}, \"mass\": {\"particle\": 0.1}, \"thickness\": 0.4,"   \
    " " FREE_OF_SPRINGS "}], \"forces\": {" NO_GRAVITY "}, \"pairs\": {\"among\": \"all\","    \
    " \"friction\": " friction                                                                 \
    "}, \"contact\": {\"law\": \"force\", \"start\": \"allow\", \"stiffness\": 1,"             \
    " \"damping\": 0.02, \"friction_speed\": 0.2}, " FIVE_FRAMES "}"

/* Two sheets that fly apart, sewn at an edge and to a point of a triangle. */
#define SEAMS(length)                                                                          \
    "{\"bodies\": [{" CLOTH ", " FREE_OF_SPRINGS "}, {\"cloth\": {\"grid\": [3, 3],"           \
    " \"velocity\": [0.3, 0.1, 0.4], \"place\": {\"translate\": [1.2, 0, 0.1]}}, \"mass\":"    \
    " {\"particle\": 0.1}, " FREE_OF_SPRINGS "}], \"seams\": [{\"body\": 0,"                   \
    " \"particles\": [2, 5], \"to\": {\"body\": 1, \"particles\": [0, 3]}, \"stiffness\": 1,"  \
    " \"damping\": 0.05, \"length\": " length "}, {\"body\": 0, \"particles\": [8], \"to\":"   \
    " {\"body\": 1, \"particles\": [3, 4, 6], \"weights\": [0.2, 0.3, 0.5]}, \"stiffness\": "  \
    "1}],"                                                                                     \
    " \"forces\": {" NO_GRAVITY "}, " FIVE_FRAMES "}"

/* A sheet that hangs from a sphere which moves and turns. */
#define CARRIED                                                                                \
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3]}, \"mass\": {\"particle\": 0.1}, "            \
    "\"springs\":"                                                                             \
    " {\"stretch\": 1, \"damping\": 0.05}, \"pins\": [{\"at\": \"top\", \"to\": "              \
    "{\"collider\":"                                                                           \
    " 0}}]}], \"colliders\": [{\"sphere\": {\"centre\": [0.1, 2, 0], \"radius\": 0.1}}],"      \
    " \"forces\": {" NO_GRAVITY "}, \"events\": [{\"from\": 0.05, \"to\": 0.45, \"move\": {"   \
    "\"collider\": 0, \"spin\": [0, 2, 0], \"path\": [{\"at\": 0.45, \"point\": [0.2, 0, "     \
    "0]}]}}"                                                                                   \
    "], " FIVE_FRAMES "}"

/* A sheet between a pinned edge and one that an event moves, or lets go. */
#define HELD(pins, event)                                                                      \
    "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3], \"stretch\": [1.1, 0.95], \"bump\": 0.1},"   \
    " \"mass\": {\"degree\": 0.02}, \"springs\": {\"stretch\": 1, \"shear\": 0.5, \"bend\": "  \
    "0.3, \"damping\": 0.05}, \"pins\": [" pins "]}], \"forces\": {" NO_GRAVITY "}, "          \
    "\"events\": [{" event "}], " FIVE_FRAMES "}"

/* A membrane and a sheet of springs, sewn together, over a plane in range. */
#define MIXED                                                                                  \
    "{\"bodies\": [{" CLOTH ", \"elastic\": {\"membrane\": {\"young\": 1, \"poisson\": 0.3}, " \
    "\"damping\": 0.1, \"bending\": {\"stiffness\": 0.05, \"damping\": 0.05}}}, {\"cloth\": "  \
    "{\"grid\": [3, 3], \"velocity\": [0.3, 0.1, 0.4], \"place\": {\"translate\": [1.2, 0, "   \
    "0.1]}}, \"mass\": {\"degree\": 0.02}, \"springs\": {\"stretch\": 1, \"shear\": 0.5, "     \
    "\"bend\": 0.3, \"damping\": 0.02}}], \"seams\": [{\"body\": 0, \"particles\": [2, 5], "   \
    "\"to\": {\"body\": 1, \"particles\": [0, 3]}, \"stiffness\": 1, \"damping\": 0.05}], "    \
    "\"forces\": {\"gravity\": [0, -2, -1], \"drag\": 0.1, " WIND(                             \
        "0.2",                                                                                 \
        "Pa") "}, "                                                                            \
              "\"colliders\": [{\"plane\": {\"point\": [0, 0, -1.5], \"normal\": [0, 0, 1]}, " \
              "\"thickness\": 4, \"friction\": 0.3}], \"contact\": {\"law\": \"force\", "      \
              "\"start\": "                                                                    \
              "\"allow\", \"stiffness\": 0.5, \"damping\": 0.02, \"friction_speed\": 0.5}, "   \
              "\"events\": [{" RAMP("bodies[1].springs.stretch", "2") "}], " FIVE_FRAMES "}"

// ends of ramps lie between frames
#define RAMP(key, value)                                                                       \
    "\"from\": 0.05, \"to\": 0.45, \"ramp\": {\"key\": \"" key "\", \"value\": " value "}"

// clang-format off
const struct cs_force_scene cs_force_scenes[] = {
    {"force-gravity", "gravity", SHEETS("\"gravity\": [1, -9, 4]"), 2, false, false},

    {"force-springs", "stretch springs",
     SPRINGS("\"stretch\": 1, \"shear\": 0, \"bend\": 0"), 9, false, true},
    {"force-springs", "shear springs",
     SPRINGS("\"stretch\": 0, \"shear\": 1, \"bend\": 0"), 9, false, true},
    {"force-springs", "bend springs",
     SPRINGS("\"stretch\": 0, \"shear\": 0, \"bend\": 1"), 9, false, true},

    {"force-membrane", "a membrane",
     ELASTIC("\"membrane\": {\"young\": 1, \"poisson\": 0.3}", ""), 9, false, true},
    {"force-membrane", "a membrane with damping",
     ELASTIC("\"membrane\": {\"young\": 1, \"poisson\": 0.3}, \"damping\": 0.1", ""), 9, true, true},
    {"force-bending", "bending",
     ELASTIC("\"membrane\": {\"young\": 0.01, \"poisson\": 0}, \"bending\": {\"stiffness\": 0.1}", ""), 9, false, true},
    {"force-bending", "bending with damping",
     ELASTIC("\"membrane\": {\"young\": 0.01, \"poisson\": 0}, \"bending\": {\"stiffness\": 0.1, \"damping\": 0.1}", ""), 9, true, true},

    {"force-damping", "axial dampers", DAMPERS("axial"), 8, true, true},
    {"force-damping", "relative dampers", DAMPERS("relative"), 8, true, true},

    {"force-drag", "drag of each particle", SHEETS(NO_GRAVITY ", \"drag\": 0.4"),
     4, true, false},
    {"force-drag", "drag by area",
     SHEETS(NO_GRAVITY ", \"drag\": 1.6, \"drag_unit\": \"Pa s/m\""), 4, true, false},

    {"force-wind", "wind on each particle", SHEETS(NO_GRAVITY ", " WIND("0.5", "N")),
     2, false, false},
    {"force-wind", "wind by area", SHEETS(NO_GRAVITY ", " WIND("2", "Pa")), 2, false, false},
    {"force-wind", "wind on a turning sheet",
     "{\"bodies\": [{" CLOTH ", " FREE_OF_SPRINGS "}], \"forces\": {" NO_GRAVITY ", "
     WIND("2", "Pa") "}, " FIVE_FRAMES "}", 4, false, true},

    {"force-wind", "air that flows past a turning sheet",
     "{\"bodies\": [{" CLOTH ", " FREE_OF_SPRINGS "}], \"forces\": {" NO_GRAVITY ", "
     AIR "}, " FIVE_FRAMES "}", 9, true, true},
    {"force-wind", "a pressure in a ring", BLOWN("3", ""), 9, false, true},

    {"force-push", "a steady impact",
     SHEETS_WITH(NO_GRAVITY, "\"from\": 0, \"to\": 0.35, \"impact\": {\"body\": 1,"
                 " \"direction\": [1, -2, 1], \"impulse\": 1}"), 4, false, false},
    {"force-push", "an instantaneous impact",
     SHEETS_WITH(NO_GRAVITY, "\"at\": 0.25, \"impact\": {\"body\": 0,"
                 " \"direction\": [1, -2, 1], \"impulse\": 1}"), 4, false, false},
    {"force-push", "a steady viewpoint force",
     SHEETS_WITH(NO_GRAVITY, VIEWPOINT_FORCE("\"from\": 0, \"to\": 0.35", "\"refresh\": 0")),
     4, false, false},
    {"force-push", "an instantaneous viewpoint force",
     SHEETS_WITH(NO_GRAVITY, VIEWPOINT_FORCE("\"at\": 0.25", "\"duration\": 0.2")), 4, false, false},

    {"force-contact", "contact by force, without friction", CONTACT("0", ""), 9, true, false},
    {"force-contact", "contact by force, with friction", CONTACT("0.5", ""), 9, true, false},
    {"force-contact", "edges on a pole", POLE, 9, true, true},
    {"force-contact", "two sheets in contact by force", PAIRS("0.3"), 12, true, true},

    {"force-contact", "stitches without length", SEAMS("0"), 12, true, true},
    {"force-contact", "gas that is shut in a ring", BLOWN("1, \"outer_pressure\": 1", ""),
     9, true, true},
    {"force-contact", "stitches with a length", SEAMS("0.15"), 12, true, true},

    {"unequal-masses", "two sheets in gravity, wind and drag",
     "{" SHEETS_OF("0.1", "0.3") ", \"forces\": {\"gravity\": [1, -3, 2], \"drag\": 0.4, "
     WIND("0.5", "N") "}, " FIVE_FRAMES "}", 4, true, false},
    {"unequal-masses", "a sheet with springs and dampers",
     "{\"bodies\": [{\"cloth\": {\"grid\": [3, 3], \"stretch\": [1.1, 0.95], \"bump\": 0.1,"
     " \"spin\": [0.5, 1, 0.3]}, \"mass\": {\"degree\": 0.02}, \"springs\": {\"stretch\": 1,"
     " \"shear\": 0.5, \"bend\": 0.3, \"damping\": 0.02}}], \"forces\": {" NO_GRAVITY "}, "
     FIVE_FRAMES "}", 9, true, true},

    {"mixed-laws", "a membrane sewn to springs, in air and in contact", MIXED, 9, true, true},

    {"time-dependence", "an edge that is moved along a line",
     HELD("\"left\"", "\"from\": 0.05, \"to\": 0.45, \"grab\": {\"particles\": [\"right\"],"
          " \"relative\": true, \"path\": [{\"at\": 0.45, \"point\": [-0.2, 0.1, 0.3]}]}"),
     9, true, true},
    {"time-dependence", "a pinned edge that is let go",
     HELD("\"left\", \"right\"", "\"at\": 0.25, \"release\": {\"particles\": [\"right\"]}"),
     9, true, true},
    {"time-dependence", "a ramp of gravity",
     SHEETS_WITH("\"gravity\": [0, -2, 0]", RAMP("forces.gravity[1]", "-9")),
     4, false, false},
    {"time-dependence", "a ramp of drag",
     SHEETS_WITH(NO_GRAVITY ", \"drag\": 0.1", RAMP("forces.drag", "0.5")), 5, true, false},
    {"time-dependence", "a ramp of the wind's strength",
     SHEETS_WITH(NO_GRAVITY ", " WIND("0.1", "N"), RAMP("forces.wind.strength", "1")),
     4, false, false},
    {"time-dependence", "a gust",
     SHEETS_WITH(NO_GRAVITY ", " WIND("0.3", "N"), "\"from\": 0.05, \"to\": 0.45, \"wind\":"
                 " {\"direction\": [3, -1, 1], \"strength\": 1}"), 4, false, false},
    {"time-dependence", "ramps of air that flows",
     SHEETS_WITH(NO_GRAVITY ", " AIR, RAMP("forces.wind.velocity[2]", "5") "}, {"
                 RAMP("forces.wind.density", "2") "}, {" RAMP("forces.wind.drag", "0.5")),
     9, true, false},
    {"time-dependence", "a ramp of a pressure",
     BLOWN("3", "{" RAMP("bodies[0].pressure", "4") "}"), 9, false, true},
    {"time-dependence", "a ramp of a collider's friction",
     CONTACT("0.1", "{" RAMP("colliders[0].friction", "0.9") "}"), 9, true, false},
    {"time-dependence", "ramps of springs and dampers",
     "{\"bodies\": [{" CLOTH ", \"springs\": {\"stretch\": 0.2, \"shear\": 0.5, \"bend\": 0.1,"
     " \"damping\": 0.03}}], \"forces\": {" NO_GRAVITY "}, \"events\": ["
     "{" RAMP("bodies[0].springs.stretch", "1") "}, {" RAMP("bodies[0].springs.shear", "0.1") "},"
     " {" RAMP("bodies[0].springs.bend", "0.4") "}, {" RAMP("bodies[0].springs.damping", "0") "}], "
     FIVE_FRAMES "}", 9, true, true},
    {"time-dependence", "ramps of a membrane and of its damping",
     ELASTIC("\"membrane\": {\"young\": 1, \"poisson\": 0.3}, \"damping\": 0.05",
             "{" RAMP("bodies[0].elastic.membrane.young", "0.5") "}, {"
             RAMP("bodies[0].elastic.damping", "0.1") "}"), 9, true, true},
    {"time-dependence", "a ramp of bending",
     ELASTIC("\"membrane\": {\"young\": 0.01, \"poisson\": 0}, \"bending\": {\"stiffness\": 0.1}",
             "{" RAMP("bodies[0].elastic.bending.stiffness", "0.05") "}"), 9, false, true},
    {"time-dependence", "a ramp of the damping of bending",
     ELASTIC("\"membrane\": {\"young\": 0.01, \"poisson\": 0}, \"bending\": {\"stiffness\": 0.1}",
             "{" RAMP("bodies[0].elastic.bending.damping", "0.3") "}"), 9, true, true},
    {"time-dependence", "ramps of shear and twist",
     ELASTIC("\"membrane\": {\"warp\": 1, \"weft\": 0.8, \"shear\": 0.3},"
             " \"bending\": {\"warp\": 0.1, \"weft\": 0.05, \"twist\": 0.04}",
             "{" RAMP("bodies[0].elastic.membrane.shear", "0.1") "}, {"
             RAMP("bodies[0].elastic.bending.twist", "0.02") "}"), 9, false, true},
    {"time-dependence", "a sheet held to a collider that turns", CARRIED, 12, true, true},
};
// clang-format on

const uint32_t cs_n_force_scenes = sizeof cs_force_scenes / sizeof *cs_force_scenes;
