/* clothsim scene: checks a scene file and prints its plan, its values or the schema. */
#include "cli/commands.h"
#include "cli/line/print.h"
#include "io/scene_write.h"
#include "model/plan.h"
#include "scene/pairs.h"
#include "study/coarse.h"
#include "study/company.h"
#include "study/session.h"
#include "study/within.h"

#include <string.h>

enum {
    SCENE_SET,
    SCENE_INTEGRATOR,
    SCENE_PLUGIN,
    SCENE_PLAN,
    SCENE_NO_RENDER,
    SCENE_RESOLVED,
    SCENE_SCHEMA,
    SCENE_MANUAL,
    SCENE_ROWS
};

static const struct cs_arg rows[SCENE_ROWS] = {
    [SCENE_SET] = {"set", 's', "PATH=VALUE",
                   "another value for a key of the scene; may be repeated", true},
    [SCENE_INTEGRATOR] = {"integrator", 'i', "NAME[:KEY=VALUE,...]",
                          "method and its options, instead of the scene's", false},
    [SCENE_PLUGIN] = {"plugin", 'p', "FILE", "load an integrator module; may be repeated",
                      true},
    [SCENE_PLAN] = {"plan", 0, NULL,
                    "print what is built, with bytes, and what is left out and why", false},
    [SCENE_NO_RENDER] = {"no-render", 0, NULL, "plan a run that draws nothing", false},
    [SCENE_RESOLVED] = {"resolved", 0, NULL, "print the scene with every value", false},
    [SCENE_SCHEMA] = {"schema", 0, NULL, "print the JSON schema of scene files (takes no FILE)",
                      false},
    [SCENE_MANUAL] = {"manual", 0, NULL, NULL, false},
};

static void add_count(struct cs_text *out, const char *before, uint32_t n, const char *what) {
    cs_text_add(out, "%s%u %s%s", before, n, what, n == 1 ? "" : "s");
}

/* FILE: ok, 4096 particles, ... */
static enum cs_status add_verdict(const struct cs_session *session, struct cs_text *out,
                                  struct cs_error *error) {
    const struct cs_scene *scene = &session->scene;
    const struct cs_plan *plan = &session->plan;
    cs_text_add(out, "%s: ok, ", scene->path);
    if (plan->n_bodies != 1)
        cs_text_add(out, "%u bodies, ", plan->n_bodies);
    add_count(out, "", plan->n, "particle");
    add_count(out, ", ", plan->n_springs, "spring");
    add_count(out, ", ", scene->colliders.n, "collider");
    cs_text_add(out, ", %s\n", session->method.integrator->name);
    struct cs_text warning = {0};
    if (!cs_company_print(scene, 1, &warning, error) && !warning.length)
        cs_coarse_print(&session->system, &warning);
    if (!error->status && !warning.length)
        cs_within_print(&session->system, &warning);
    if (!error->status && warning.length)
        cs_text_add(out, "warning: %s\n", cs_text_get(&warning));
    cs_text_finish(&warning);
    return error->status;
}

/* What was decided, and what it came to once the method had taken its own. */
static void add_plan(const struct cs_session *session, struct cs_text *out) {
    const size_t bytes = cs_run_bytes(&session->run);
    cs_plan_print(&session->run.plan, out);
    cs_text_add(out, "%-14s %-9s %10zu bytes   %s\n", "method", "built",
                session->run.method_bytes, session->method.integrator->name);
    cs_text_add(out, "%-14s %-9s %10zu bytes   %.1f a particle\n", "in all", "", bytes,
                (double)bytes / session->plan.n);
}

static enum cs_status print_scene(struct cs_args *args, const struct cs_session *session,
                                  struct cs_error *error) {
    struct cs_text out = {0};
    if (cs_args_get(args, SCENE_PLAN))
        add_plan(session, &out);
    else if (cs_args_get(args, SCENE_RESOLVED)) {
        cs_scene_print(&session->scene, &session->method.table, session->method.options, 0,
                       &out);
        cs_text_add(&out, "\n");
    } else if (add_verdict(session, &out, error)) {
        cs_text_finish(&out);
        return error->status;
    }
    return cs_print_out(stdout, &out, error);
}

static enum cs_status open_scene(struct cs_args *args, struct cs_error *error) {
    struct cs_session session = {0};
    struct cs_session_settings settings = {
        .scene = args->operands[0],
        .integrator = cs_args_get(args, SCENE_INTEGRATOR),
        .render = !cs_args_get(args, SCENE_NO_RENDER),
        /* a run has as many, and what they share the work by is in its plan */
        .threads = cs_args_get(args, SCENE_PLAN) ? CS_THREADS_AUTO : 0,
    };
    if (cs_args_overrides(args, SCENE_SET, &settings.overrides, &settings.n_overrides, error) ||
        cs_args_all(args, SCENE_PLUGIN, &settings.plugins, &settings.n_plugins, error))
        return error->status;
    enum cs_status (*const open)(struct cs_session *, const struct cs_session_settings *,
                                 struct cs_error *) =
        cs_args_get(args, SCENE_PLAN) ? cs_session_open : cs_session_open_plan;
    /* what starts inside a collider, or through or inside a body, shows in a system alone */
    if (!open(&session, &settings, error) &&
        ((session.scene.colliders.n == 0 && !cs_scene_any_meet(&session.scene)) ||
         session.system.arena.used || !cs_session_build(&session, error)))
        print_scene(args, &session, error);
    cs_session_close(&session);
    return error->status;
}

static enum cs_status print_format(struct cs_args *args, struct cs_error *error) {
    struct cs_text out = {0};
    if (args->n_operands)
        return cs_fail(error, CS_ERR_USAGE, "--%s takes no scene, found \"%.60s\"",
                       cs_args_get(args, SCENE_SCHEMA) ? "schema" : "manual",
                       args->operands[0]);
    if (cs_args_get(args, SCENE_SCHEMA))
        cs_scene_print_schema(&out);
    else
        cs_scene_print_manual(&out);
    return cs_print_out(stdout, &out, error);
}

static enum cs_status scene(struct cs_args *args, struct cs_error *error) {
    if (cs_args_get(args, SCENE_SCHEMA) || cs_args_get(args, SCENE_MANUAL))
        return print_format(args, error);
    if (!args->n_operands)
        return cs_fail(error, CS_ERR_USAGE, "expected FILE (see: clothsim scene --help)");
    if (cs_args_get(args, SCENE_PLAN) && cs_args_get(args, SCENE_RESOLVED))
        return cs_fail(error, CS_ERR_USAGE, "--plan and --resolved cannot both be printed");
    return open_scene(args, error);
}

const struct cs_command cs_command_scene = {
    .name = "scene",
    .operands = "FILE",
    .summary = "check a scene, or print its plan, every value, or the schema",
    .notes =
        "Without an option: one line that says that the scene is fine and what is in it.\n",
    .rows = rows,
    .n_rows = SCENE_ROWS,
    .least = 0,
    .most = 1,
    .main = scene,
};
