/* clothsim scene: checks a scene file and prints its plan, its values or the schema.
 *
 * The scene is built, not only planned, because bodies that start inside colliders or through
 * each other only show in a system, as do the findings of session.h. */
#include "base/json_writer.h"
#include "cli/commands.h"
#include "cli/file_conflicts.h"
#include "cli/line/print.h"
#include "session/scene_view.h"
#include "session/session.h"

#include <stdio.h>
#include <string.h>

struct options {
    struct cs_session_settings session;
    const char *json;
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
    {"json", 0, "FILE", "write the answer as JSON too; -: instead of the text",
     CS_ARG_INTO(struct options, json)},
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
static void add_verdict(const struct cs_session *session,
                        const struct cs_scene_findings *findings, struct cs_text *out) {
    const struct cs_scene *scene = session->scene;
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
    cs_print_lines("warning: ", cs_text_get(&findings->warnings), out);
    cs_print_lines("hint: ", cs_text_get(&findings->hints), out);
}

/* Adds a member: the lines of a text as a list. */
static void add_lines(const char *name, const struct cs_text *lines, struct cs_text *out) {
    cs_json_write(out, ",\n  %s: [", name);
    for (const char *line = cs_text_get(lines); *line; line += strcspn(line, "\n") + 1) {
        char one[2048];
        snprintf(one, sizeof one, "%.*s", (int)strcspn(line, "\n"), line);
        cs_json_write(out, ", %s", one);
    }
    cs_text_add(out, "]");
}

/* The same for programs. */
static void add_json(const struct cs_session *session, const struct cs_scene_findings *findings,
                     struct cs_text *out) {
    const struct cs_plan *plan = &session->plan;
    struct cs_text contact = {0};
    add_contact(session, &contact);
    cs_json_write(out,
                  "{\n  'file': %s, 'bodies': %u, 'particles': %u, 'springs': %u, "
                  "'colliders': %u,\n  'integrator': %s",
                  session->scene->path, plan->n_bodies, plan->n, plan->n_springs,
                  session->scene->colliders.n, session->method.integrator->name);
    add_lines("contact", &contact, out);
    add_lines("warnings", &findings->warnings, out);
    add_lines("hints", &findings->hints, out);
    cs_text_add(out, "\n}\n");
    out->failed |= contact.failed;
    cs_text_finish(&contact);
}

/* Says what the scene holds and what will go wrong in it. */
static enum cs_status print_answer(const struct options *options,
                                   const struct cs_session *session, struct cs_error *error) {
    struct cs_scene_findings findings;
    struct cs_text out = {0}, json = {0};
    if (!cs_scene_doctor_check(session, 1, &findings, error)) {
        add_verdict(session, &findings, &out);
        add_json(session, &findings, &json);
        if (!cs_print_is_stdout(options->json))
            cs_print_out(stdout, &out, error);
        if (options->json && !error->status)
            cs_print_file(options->json, &json, error);
    }
    cs_scene_findings_finish(&findings);
    cs_text_finish(&out);
    cs_text_finish(&json);
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
    if (!options->plan && !options->resolved)
        return print_answer(options, session, error);
    if (options->plan)
        add_plan(session, &out);
    else {
        cs_scene_print(session->scene, &session->method.table, session->method.options, 0,
                       &out);
        cs_text_add(&out, "\n");
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
        (session.system.view.n || !cs_session_build(&session, error)))
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
    if (options->json && (options->plan || options->resolved))
        return cs_fail(error, CS_ERR_USAGE,
                       "--json is of the check, without --plan, --resolved");
    options->session.scene = args->operands[0];
    return cs_file_conflicts_pair(cs_print_is_stdout(options->json) ? NULL : options->json,
                                  "--json", args->operands[0], "the scene", error)
               ? error->status
               : open_scene(options, error);
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
