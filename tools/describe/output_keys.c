/* Lists the keys of JSON files, and gathers the columns of tables from where they are written.
 * tests/cli/files.py holds the lists to what the program writes. */
#include "describe/output_keys.h"

#include "cli/table_plot.h"
#include "study/compare/compare_cell.h"
#include "study/energy_monitor.h"
#include "study/parameter_sweep.h"
#include "study/stability/stability.h"

#define SCENE "path of the scene file; - for standard input"
#define HASH  "XXH3, 128 bits, in hexadecimal digits"

static const struct cs_output_key advise_keys[] = {
    {"scene", "text", "", SCENE},
    {"seconds", "number", "s", "simulated time that each step must survive"},
    {"rows", "list", "", "methods"},
    {"rows[].method", "text", "", "integrator"},
    {"rows[].kind", "text", "", "theory, bisected, no limit, adaptive, none or refused"},
    {"rows[].limit", "number or null", "s", "largest stable step"},
    {"rows[].advised", "number or null", "s", "advised step"},
    {"rows[].found", "number or null", "s", "limit by bisection, with --check"},
    {"rows[].steps_per_frame", "number or null", "1", "steps of a frame"},
    {"rows[].seconds_per_frame", "number or null", "s", "run time of a frame"},
    {"rows[].verdict", "text", "", "on stability: see clothsim-stability(1)"},
    {"rows[].message", "text", "", "remark, or why there is no advice"},
};

static const struct cs_output_key origin_keys[] = {
    {"versions", "object", "", "of the program"},
    {"versions.clothsim", "text", "", "version of clothsim"},
    {"frames", "whole", "1", "frames of each run"},
    {"reference?", "list of text", "", "the two methods of --reference, where it was given"},
    {"accuracy", "number", "m", "smallest error that the comparison must resolve"},
    {"reference_budget?", "number", "s", "nominal s of --reference-budget; 0: the default"},
    {"scene_file", "text", "", SCENE},
    {"files", "list", "", "files that the results depend on"},
    {"files[].path", "text", "", "path of a file"},
    {"files[].hash", "text", "", HASH ", of the file's bytes"},
    {"scene", "object", "", "scene with every value: see clothsim-scene(5)"},
};

static const struct cs_output_key run_keys[] = {
    {"schema", "whole", "", "version of this form: 2"},
    {"versions", "object", "", "of the program and its libraries"},
    {"versions.clothsim", "text", "", "version of clothsim"},
    {"versions.cjson", "text", "", "version of cJSON"},
    {"versions.libpng?", "text", "", "version of libpng, where pictures were drawn"},
    {"renderer", "text or null", "", "renderer of the pictures, and its own description"},
    {"threads", "whole", "1", "threads of the run; no number below depends on them"},
    {"restarted_every?", "whole", "1",
     "frames after which the method restarts, of checkpoints"},
    {"scene_file", "text", "", SCENE},
    {"files", "list", "", "files that the result depends on"},
    {"files[].path", "text", "", "path of a file"},
    {"files[].hash", "text", "", HASH ", of the file's bytes"},
    {"scene_hash", "text", "", HASH ", of the scene with every value and of its meshes"},
    {"method", "text", "", "integrator with all of its options"},
    {"module", "object", "", "where the method comes from"},
    {"module.file", "text", "", "its module: a name, or the path of one that was loaded"},
    {"module.hash", "text", "", HASH ", of the module's bytes"},
    {"module.library", "text", "", "library that it uses, with version"},
    {"particles", "whole", "1", "particles"},
    {"springs", "whole", "1", "springs"},
    {"outcome", "text", "", "finished, interrupted, blew up, gave up or failed"},
    {"outcome_detail", "text", "", "the same as a sentence"},
    {"blow_up?", "object", "", "of a run that blew up"},
    {"blow_up.time", "number", "s", "when"},
    {"blow_up.particle", "whole", "1",
     "index of the first particle that is not finite, or the fastest"},
    {"blow_up.kinetic_energy", "number or null", "J", "kinetic energy"},
    {"blow_up.bound", "number or null", "J", "bound that it crossed"},
    {"singular_force?", "object", "", "why it ended, if no shorter step passes"},
    {"singular_force.time", "number", "s", "when"},
    {"singular_force.particle", "whole", "1", "index of that of the greatest acceleration"},
    {"verdict", "text", "", "on stability: see clothsim-stability(1)"},
    {"unstable_from?", "object", "", "first sign of an instability"},
    {"unstable_from.time", "number", "s", "when"},
    {"unstable_from.particle", "whole", "1", "index of the fastest particle"},
    {"unstable_from.particles", "whole", "1", "particles above the limit"},
    {"frames_asked", "whole", "1", "frames that --frames asked for"},
    {"frames_done", "whole", "1", "frames that were finished"},
    {"time", "number", "s", "simulated time"},
    {"error", "object", "", "error of position at the end, as a root of the mean square"},
    {"error.size", "number", "m", "longest side of the box of all particles at the start"},
    {"error.local", "number or null", "m",
     "local errors of the method's steps, added up; null: it has no estimate"},
    {"error.measured?", "number", "m", "distance to a run of finer steps (--error)"},
    {"counts", "object", "", "work of the method"},
    {"counts.steps", "whole", "1", "steps"},
    {"counts.rejected", "whole", "1", "rejected steps"},
    {"counts.forces", "whole", "1", "force evaluations"},
    {"counts.energies", "whole", "1", "evaluations of the energy"},
    {"counts.jvps", "whole", "1", "products of the Jacobian with a vector"},
    {"counts.diagonals", "whole", "1", "diagonal blocks of the Jacobian computed"},
    {"counts.newton", "whole", "1", "nonlinear iterations"},
    {"counts.sweeps", "whole", "1", "passes of the method itself over the springs"},
    {"counts.setups", "whole", "1", "matrices that the method set up"},
    {"counts.solve_setups", "whole", "1", "set-ups of the linear solver"},
    {"counts.solves", "whole", "1", "linear solves; one may take more systems for friction"},
    {"counts.solve_iterations", "whole", "1", "iterations of the linear solver"},
    {"counts.clamped", "whole", "1", "set-ups of the solver that left out negative stiffness"},
    {"counts.contacts", "whole", "1", "particles that contact by projection moved"},
    {"counts.contact_tests", "whole", "1", "pairs of particle and collider that were tested"},
    {"counts.contact_subdivided_steps", "whole", "1", "steps that contact cut"},
    {"counts.limit_moves", "whole", "1", "springs that the strain limit shortened"},
    {"counts.normals", "whole", "1", "times that normals were computed"},
    {"crossings?", "object", "", "edges through triangles, where the scene counts them"},
    {"crossings.start", "whole", "1", "at the start"},
    {"crossings.most", "whole", "1", "maximum over all frames"},
    {"crossings.end", "whole", "1", "after the last frame"},
    {"crossings.most_at?", "number", "s", "when there were most"},
    {"crossings.first?", "object", "", "the first crossing"},
    {"crossings.first.time", "number", "s", "when"},
    {"crossings.first.edge", "list of whole", "1", "indices of the two particles of its edge"},
    {"contact?", "object", "", "the two surfaces whose contact by force holds the least"},
    {"contact.body", "whole", "1", "index of a body"},
    {"contact.other_body?", "whole", "1", "index of the other body; itself for self-contact"},
    {"contact.collider?", "whole", "1", "index of the collider, instead of another body"},
    {"contact.range", "number", "m", "distance at which the force begins"},
    {"contact.stiffness", "number", "N/m", "stiffness of the contact"},
    {"contact.holds", "number or null", "J", "energy that one contact takes up"},
    {"contact.comes", "number or null", "J", "energy of one particle that comes"},
    {"contact.stiffness_needed", "number or null", "N/m", "stiffness that holds it"},
    {"energy", "object", "", "energies at the end"},
    {"energy.kinetic", "number or null", "J", "kinetic energy"},
    {"energy.elastic", "number or null", "J", "of springs, membranes and bending"},
    {"energy.gravity", "number or null", "J", "potential energy of gravity"},
    {"energy.other?", "number or null", "J", "of other forces, such as contact"},
    {"largest_strain", "number or null", "1", "largest strain of a spring at the end"},
    {"strain_limit_missed?", "number", "1", "largest length over the strain limit, less 1"},
    {"beyond_cloth?", "text", "", "what no cloth does: where, and the bound"},
    {"largest_depth", "number", "m", "of a particle in a collider after a frame"},
    {"memory", "object", "", "arrays of the run"},
    {"memory.bytes", "whole", "B", "all"},
    {"memory.method", "whole", "B", "those of the method"},
    {"memory.a_particle", "number", "B", "all, by particle"},
    {"notes", "list of text", "", "remarks of the method"},
    {"state_hash", "text", "", HASH ", of the state at the end, as of --hash"},
    {"seconds", "object", "", "what the run took; no other number depends on the machine"},
    {"seconds.wall", "number", "s", "wall time of all"},
    {"seconds.method", "number", "s", "wall time of the method"},
    {"seconds.force?", "number", "s", "forces, with --timing as all below"},
    {"seconds.setup?", "number", "s", "set-ups of the linear solver"},
    {"seconds.solve?", "number", "s", "linear solves"},
    {"seconds.contact?", "number", "s", "contact"},
    {"seconds.limit?", "number", "s", "strain limit"},
    {"seconds.normals?", "number", "s", "normals"},
    {"seconds.draw?", "number", "s", "drawing, where pictures were drawn"},
    {"seconds.encode?", "number", "s", "writing of PNG files"},
    {"seconds.wait?", "number", "s", "waiting for those"},
    {"scene", "object", "", "the scene with every value, as of clothsim-scene(5)"},
    {"frames", "list", "", "frames that were simulated; the start where none was asked for"},
    {"frames[].number", "whole", "1", "number of the frame; 0: the start"},
    {"frames[].hash", "text", "", HASH ", of its state"},
    {"frames[].drawn", "flag", "", "it has a picture"},
    {"frames[].picture?", "whole", "1", "number of its picture"},
    {"frames[].crossings?", "whole", "1", "edges through triangles"},
    {"frames[].range?", "list of number or null", "", "ends of the colour bar"},
};

/* Members of an entry of "verdict", and of "stable_at_frame_step". */
#define RANK(at)                                                                               \
    {at ".best", "whole", "1", "index in cells of the cheapest row"},                          \
        {at ".least_work", "whole", "1", "index in cells of the row of least work"},           \
        {at ".next?", "whole", "1", "index in cells of the runner-up, of another series"},     \
        {at ".factor?", "number or null", "1", "its time over the cheapest one"},              \
        {at ".interval?", "list of number or null", "1", "95 % interval of the factor"},       \
        {at ".pairs?", "whole", "1",                                                           \
         "pairs of rounds behind the factor; 0: not timed in pairs"},                          \
        {at ".told_apart?", "flag", "", "the interval leaves out 1"},                          \
        {at ".work_factor?", "number or null", "1", "the same of work"},                       \
        {at ".work_interval?", "list of number or null", "1", "its interval"},                 \
        {at ".by_error?", "whole", "1", "row that is cheaper and no worse by this error"},     \
        {at ".by_path?", "whole", "1", "the same over all frames"},                            \
        {at ".by_largest?", "whole", "1", "the same of the worst particle"},                   \
        {at ".by_velocity?", "whole", "1", "the same of velocity"}, {                          \
        at ".by_energy?", "whole", "1", "the same of energy"                                   \
    }

static const struct cs_output_key compare_keys[] = {
    {"schema", "whole", "", "version of this form: 1"},
    {"scene", "text", "", SCENE},
    {"particles", "whole", "1", "particles"},
    {"springs", "whole", "1", "springs"},
    {"time", "number", "s", "simulated time"},
    {"fps", "number", "1/s", "frames a second of the scene"},
    {"contact", "text", "", "force, or empty without contact by force"},
    {"switched_off", "text", "", "what the scene asks for and the comparison leaves out"},
    {"machine", "object", "", "machine and build that wrote the file"},
    {"machine.processor", "text", "", "model of the processor"},
    {"machine.processors", "whole", "1", "processors"},
    {"machine.load", "number", "1", "load over the last minute"},
    {"machine.version", "text", "", "version of clothsim"},
    {"machine.compiler", "text", "", "compiler of this build"},
    {"machine.flags", "text", "", "flags of this build"},
    {"reference", "object", "", "the reference"},
    {"reference.methods", "list of text", "",
     "a method, a tighter one, another family, a tighter one"},
    {"reference.agree", "flag", "", "the two families agree"},
    {"reference.pointwise", "flag", "", "errors at the end have a meaning"},
    {"reference.reason", "text", "", "why not"},
    {"reference.bar", "number or null", "m", "its own error (RMS)"},
    {"reference.bar_max", "number or null", "m", "its own error, of the worst particle"},
    {"reference.motion", "number or null", "m", "largest RMS distance from the start"},
    {"reference.kinetic_energy", "number or null", "J", "largest kinetic energy"},
    {"reference.strain", "number or null", "1", "largest strain"},
    {"reference.accuracy", "number", "m", "of --accuracy"},
    {"reference.amplification", "number or null", "1", "growth of a displacement at the start"},
    {"reference.horizon", "number or null", "s",
     "until when the accuracy has a meaning; null: beyond the end"},
    {"rank", "text", "", "error norm of the verdict: see --error-norm"},
    {"verdict", "list", "", "best rows, by powers of ten of the error"},
    RANK("verdict[]"),
    {"verdict[].error", "number", "", "power of ten, in the unit of the norm"},
    {"stable_at_frame_step", "object or null", "", "best rows at one step a frame"},
    RANK("stable_at_frame_step"),
    {"cells", "list", "", "the rows of compare.csv"},
    {"cells[].front", "flag", "", "nothing is both cheaper and more accurate"},
};

static const struct cs_output_key stability_keys[] = {
    {"scene", "text", "", SCENE},
    {"series", "text", "", "method with the options that are not at their defaults"},
    {"integrator", "text", "", "method"},
    {"axis", "text", "", "stiffness, damping, mass, resolution or young"},
    {"seconds", "number", "s", "simulated by a cell, at least"},
    {"columns", "list", "", "values on the axis"},
    {"columns[].value", "number", "", "value: N/m, N s/m, kg, or columns of the grid"},
    {"columns[].seconds", "number or null", "s", "simulated by the cells of this column"},
    {"columns[].border", "number or null", "s",
     "largest stable step; null: not known, or no limit"},
    {"columns[].worst_on_way", "number or null", "s",
     "smallest limit of theory along the reference"},
    {"columns[].at_start", "number or null", "s",
     "limit of theory for small motions at the start"},
    {"columns[].gershgorin", "number or null", "s", "bound of theory by Gershgorin's theorem"},
    {"columns[].reference_step", "number or null", "s", "mean step of the reference"},
    {"columns[].cells", "list", "", "steps, from the smallest on"},
    {"columns[].cells[].dt", "number", "s", "step"},
    {"columns[].cells[].verdict", "text", "", "how the cell ended"},
    {"columns[].cells[].energy_drift", "number or null", "1",
     "drift of the energy of a run that ended"},
    {"columns[].cells[].time", "number or null", "s", "when the verdict showed"},
    {"columns[].cells[].particles", "whole", "1",
     "most particles at a time of a local instability"},
    {"columns[].cells[].crossings", "number or null", "1",
     "edges through triangles, maximum over the run"},
};

static const struct cs_output_key extreme_keys[] = {
    {"met", "whole", "1", "runs that ended as expected"},
    {"missed", "whole", "1", "runs that did not"},
    {"rows", "list", "", "runs"},
    {"rows[].scene", "text", "", "scene of the catalogue"},
    {"rows[].method", "text", "", "method"},
    {"rows[].expected", "text", "", "verdicts that the scene expects of it"},
    {"rows[].verdict", "text", "", "verdict"},
    {"rows[].message", "text", "", "why"},
    {"rows[].met", "flag", "", "as expected"},
    {"rows[].seconds", "number", "s", "wall time"},
};

static const struct cs_output_key golden_keys[] = {
    {"agree", "whole", "1", "rows that agree"},
    {"differ", "whole", "1", "rows that differ or could not be run"},
    {"accepted", "whole", "1", "rows written by --accept"},
    {"skipped", "whole", "1", "rows left out, for lack of a library"},
    {"rows", "list", "", "rows"},
    {"rows[].verdict", "text", "", "agrees, differs, accepted or skipped"},
    {"rows[].image", "text", "", "picture; empty: a row of hashes"},
    {"rows[].scene", "text", "", SCENE},
    {"rows[].integrator", "text", "", "method with its options; empty: the scene's own"},
    {"rows[].overrides", "text", "", "values of --set"},
    {"rows[].message", "text", "", "what was found"},
    {"rows[].frame", "whole", "1", "frame"},
    {"rows[].seconds", "number", "s", "wall time"},
    {"rows[].where?", "object", "", "distances from the stored states"},
    {"rows[].where.first_hash", "whole", "1", "first frame of another hash; 0: none"},
    {"rows[].where.frame", "whole", "1", "first stored frame that is off; 0: none"},
    {"rows[].where.particle", "whole", "1", "the particle that is farthest off there"},
    {"rows[].where.distance", "number or null", "m", "its distance; null: not finite"},
    {"rows[].where.last_frame", "whole", "1", "last stored frame that is off"},
    {"rows[].where.last_particle", "whole", "1", "the particle that is farthest off there"},
    {"rows[].where.last_distance", "number or null", "m", "its distance; null: not finite"},
    {"rows[].where.off", "whole", "1", "particles that are off there"},
};

static const struct cs_output_key conform_keys[] = {
    {"[].integrator", "text", "", "method"},
    {"[].settings", "text", "", "options that are not at their defaults"},
    {"[].checks", "list", "", "lines of its card"},
    {"[].checks[].check", "text", "", "name of the check, as of --only"},
    {"[].checks[].verdict", "text", "", "how it ended: see clothsim-conform(1)"},
    {"[].checks[].figure", "number or null", "", "what was measured, in the unit of the note"},
    {"[].checks[].bound", "number or null", "", "what it must keep"},
    {"[].checks[].note", "text", "", "what was measured, in words"},
};

#define KEYS(rows) .keys = rows, .n_keys = sizeof rows / sizeof *rows
#define CHECKED    " The last column, *check*, is a hash of names and row."

const struct cs_output_file cs_output_files[] = {
    {.name = "run.json",
     .about = "Of *clothsim run*: in the folder of the pictures, and where *--json* says.",
     KEYS(run_keys)},
    {.name = "monitor.csv",
     .about = "Of *clothsim run --monitor*, under the name given there.",
     .columns = cs_energy_monitor_columns,
     .n_columns = &cs_energy_monitor_n_columns},
    {.name = "ledger.csv",
     .about =
         "Of *clothsim run --ledger*, under the name given there; *The ledger*, above, says "
         "what is booked where. A force with a column of its own stands behind _other_ or "
         "_events_.",
     .columns = cs_ledger_columns,
     .n_columns = &cs_n_ledger_columns},
    {.name = "compare.csv",
     .about = "Of *clothsim compare*: a row for each method and step or tolerance." CHECKED,
     .columns = cs_columns,
     .n_columns = &cs_n_columns},
    {.name = "compare.json",
     .about = "Of *clothsim compare*. An entry of _cells_ has the columns of compare.csv too.",
     KEYS(compare_keys),
     .columns = cs_columns,
     .n_columns = &cs_n_columns,
     .columns_in = "cells[]"},
    {.name = "origin.json",
     .about = "Of *clothsim compare*: what a row depends on besides its method. *clothsim "
              "reproduce* "
              "repeats rows by it.",
     KEYS(origin_keys)},
    {.name = "sweep.csv",
     .about =
         "Of *clothsim sweep*: a row for each combination. It begins with _cell_, the number "
         "of the row from 0, and a column for each key of *--set*, under its path." CHECKED,
     .columns = cs_parameter_sweep_columns,
     .n_columns = &cs_parameter_sweep_n_columns},
    {.name = "stability.csv",
     .about =
         "Of *clothsim stability*, as _NAME_.csv: a row for each cell. The first column is "
         "the value on the axis, and called like it.",
     .columns = cs_stability_columns,
     .n_columns = &cs_stability_n_columns},
    {.name = "stability_border.csv",
     .about =
         "Of *clothsim stability*, as _NAME_\\_border.csv: a row for each value on the axis, "
         "which is the first column, and called like the axis. Empty: no limit, or none known.",
     .columns = cs_stability_border_columns,
     .n_columns = &cs_stability_n_border_columns},
    {.name = "stability.json",
     .about = "Of *clothsim stability*, as _NAME_.json.",
     KEYS(stability_keys)},
    {.name = "extreme.json",
     .about = "Of *clothsim stability --extreme --json*.",
     KEYS(extreme_keys)},
    {.name = "advise.json", .about = "Of *clothsim advise --json*.", KEYS(advise_keys)},
    {.name = "conform.json",
     .about = "Of *clothsim conform --json*: a list, with an entry for each method.",
     KEYS(conform_keys)},
    {.name = "golden.json", .about = "Of *clothsim golden --json*.", KEYS(golden_keys)},
};
const uint32_t cs_n_output_files = sizeof cs_output_files / sizeof *cs_output_files;
