/* clothsim scene: checks a scene file and prints its plan, its values or the schema.
 *
 * The scene is built, not only planned, because bodies that start inside colliders or through
 * each other only show in a system, as do the findings of scene_doctor.h. */
#include "cli/commands.h"
#include "cli/line/print.h"
#include "model/plan.h"
#include "scene/file/scene_read.h"
#include "study/contact_capacity.h"
#include "study/scene_doctor.h"
#include "study/session.h"

struct options {
    struct cs_session_settings session;
    bool plan, resolved, schema, manual;
};
static const struct options defaults = {.session = {.render = true}};

static const struct cs_arg rows[] = {
    CS_ARG_SET(struct options, session),
    {"integrator", 'i', "NAME[:KEY=VALUE,...]",
     "method and its options, instead of the scene's",
     CS_ARG_INTO(struct options, session.integrator)},
    CS_ARG_PLUGIN(struct options, session),
    {"plan", 0, NULL, "print what is built, with its size, and what is not built and why",
     CS_ARG_INTO(struct options, plan)},
    {"no-render", 0, NULL, "plan a run that draws nothing",
     CS_ARG_INTO(struct options, session.render)},
    {"resolved", 0, NULL, "print the scene with every value",
     CS_ARG_INTO(struct options, resolved)},
    {"schema", 0, NULL, "print the JSON schema of scene files (takes no FILE)",
     CS_ARG_INTO(struct options, schema)},
    {"manual", 0, NULL, NULL, CS_ARG_INTO(struct options, manual)},
};

static void add_count(struct cs_text *out, const char *before, uint32_t n, const char *what) {
    cs_text_add(out, "%s%u %s%s", before, n, what, n == 1 ? "" : "s");
}

/* Adds what the start was changed to, and what contact by force holds. */
static void add_contact(const struct cs_session *session, struct cs_text *out) {
    struct cs_text line = {0};
    struct cs_contact_capacity capacity;
    cs_initial_penetration_print(&session->initial_penetration, &line);
    if (line.length)
        cs_text_add(out, "start: %s\n", cs_text_get(&line));
    cs_text_finish(&line);
    if (!cs_contact_capacity_find(&session->system, &capacity))
        return;
    cs_text_add(out, "contact: ");
    cs_contact_capacity_print(&session->system, &capacity, out);
    cs_text_add(out, "\n");
}

/* "FILE: ok, 4096 particles, ..." */
static enum cs_status add_verdict(const struct cs_session *session, struct cs_text *out,
                                  struct cs_error *error) {
    const struct cs_scene *scene = &session->scene;
    const struct cs_plan *plan = &session->plan;
    cs_text_add_plain(out, scene->path);
    cs_text_add(out, ": ok, ");
    if (plan->n_bodies != 1)
        cs_text_add(out, "%u bodies, ", plan->n_bodies);
    add_count(out, "", plan->n, "particle");
    add_count(out, ", ", plan->n_springs, "spring");
    add_count(out, ", ", scene->colliders.n, "collider");
    cs_text_add(out, ", %s\n", session->method.integrator->name);
    add_contact(session, out);
    struct cs_scene_findings findings;
    if (!cs_scene_doctor_check(session, 1, &findings, error)) {
        cs_print_lines("warning: ", cs_text_get(&findings.warnings), out);
        cs_print_lines("hint: ", cs_text_get(&findings.hints), out);
    }
    cs_scene_findings_finish(&findings);
    return error->status;
}

/* Prints the plan, and its final form after the method took its memory. */
static void add_plan(const struct cs_session *session, struct cs_text *out) {
    const size_t bytes = cs_run_bytes(&session->run);
    struct cs_text choice = {0};
    cs_session_print_choice(session, &choice);
    if (choice.length)
        cs_text_add(out, "integrator         %s\n", cs_text_get(&choice));
    cs_text_finish(&choice);
    cs_plan_print(&session->run.plan, out);
    cs_text_add(out, "%-18s %-9s %10zu bytes   %s\n", "method", "built",
                session->run.method_bytes, session->method.integrator->name);
    cs_text_add(out, "%-18s %-9s %10zu bytes   %.1f per particle\n", "total", "", bytes,
                (double)bytes / session->plan.n);
}

static enum cs_status print_scene(const struct options *options,
                                  const struct cs_session *session, struct cs_error *error) {
    struct cs_text out = {0};
    if (options->plan)
        add_plan(session, &out);
    else if (options->resolved) {
        cs_scene_print(&session->scene, &session->method.table, session->method.options, 0,
                       &out);
        cs_text_add(&out, "\n");
    } else if (add_verdict(session, &out, error)) {
        cs_text_finish(&out);
        return error->status;
    }
    return cs_print_out(stdout, &out, error);
}

static enum cs_status open_scene(struct options *options, struct cs_error *error) {
    struct cs_session session = {0};
    /* a run has as many, and what they share the work by is in its plan */
    options->session.threads = options->plan ? CS_THREADS_AUTO : 0;
    enum cs_status (*const open)(struct cs_session *, const struct cs_session_settings *,
                                 struct cs_error *) =
        options->plan ? cs_session_open : cs_session_open_plan;
    /* what starts inside a collider, or through or inside a body, shows in a system alone */
    if (!open(&session, &options->session, error) &&
        (session.system.arena.used || !cs_session_build(&session, error)))
        print_scene(options, &session, error);
    cs_session_close(&session);
    return error->status;
}

/* Prints the schema or the manual of scene files; neither needs a scene. */
static enum cs_status print_format(const struct cs_args *args, bool schema,
                                   struct cs_error *error) {
    struct cs_text out = {0};
    if (args->n_operands)
        return cs_fail(error, CS_ERR_USAGE, "--%s takes no scene, found \"%.60s\"",
                       schema ? "schema" : "manual", args->operands[0]);
    if (schema)
        cs_scene_print_schema(&out);
    else
        cs_scene_print_manual(&out);
    return cs_print_out(stdout, &out, error);
}

static enum cs_status scene(struct cs_args *args, struct cs_error *error) {
    struct options *options = args->options;
    if (options->schema || options->manual)
        return print_format(args, options->schema, error);
    if (!args->n_operands)
        return cs_fail(error, CS_ERR_USAGE, "expected FILE (see: clothsim scene --help)");
    if (options->plan && options->resolved)
        return cs_fail(error, CS_ERR_USAGE, "--plan and --resolved cannot both be printed");
    options->session.scene = args->operands[0];
    return open_scene(options, error);
}

const struct cs_command cs_command_scene = {
    .name = "scene",
    .operands = "FILE",
    .summary = "check a scene, or print its plan, every value, or the schema",
    .notes = "Without an option: one line that confirms the scene and counts its parts.\n\n"
             "Example: clothsim scene scenes/flag_wind.json --plan\n",
    CS_COMMAND_OPTIONS(rows, defaults),
    .operands_min = 0,
    .operands_max = 1,
    .main = scene,
};
