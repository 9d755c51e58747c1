/* One cell of a sweep: reads the scene with its values, derives its key, runs it. */
#include "study/parameter_sweep_cell.h"

#include "base/table.h"
#include "model/force/diagnostics.h"
#include "scene/file/scene_hash.h"
#include "sim/module.h"
#include "study/follow.h"
#include "study/machine.h"

/* True for errors that concern this cell only, which become a row. */
static bool is_own_fault(const struct cs_error *failure) {
    return failure->status == CS_ERR_SCENE || failure->status == CS_ERR_MODULE;
}

/* Splits the number of the cell into the indices of its values. */
static void choose_values(struct cs_parameter_sweep_cell *cell,
                          const struct cs_parameter_sweep *product) {
    uint32_t rest = cell->number;
    for (uint32_t k = product->n_keys; k-- > 0;) {
        const struct cs_parameter_axis *key = product->keys + k;
        cell->overrides[k] = (struct cs_override){key->path, key->values[rest % key->n]};
        rest /= key->n;
    }
    cell->method = product->n_methods ? product->methods[rest] : NULL;
}

/* Adds hashes of scene and module, which identify equal cells whatever their text. */
static void add_meaning(struct cs_parameter_sweep_cell *cell, struct cs_text *all,
                        struct cs_error *error) {
    struct cs_session *session = &cell->session;
    const struct cs_registry_entry *found;
    char scene[CS_HASH_DIGITS] = "", module[CS_HASH_DIGITS] = "";
    if (cs_scene_hash(&session->scene, &session->method.table, session->method.options, scene,
                      error) ||
        cs_registry_find(&session->registry, session->method.integrator->name, &found, error))
        return;
    cs_module_hash(found->file, module);
    cs_text_add(all, "|%s|%s", scene, module);
}

static void add_refusal(const struct cs_parameter_sweep_cell *cell, uint32_t n_keys,
                        struct cs_text *all) {
    cs_text_add(all, "|%s|%s", cell->method ? cell->method : "", cell->refusal.message);
    for (uint32_t k = 0; k < n_keys; k++)
        cs_text_add(all, "|%s=%s", cell->overrides[k].path, cell->overrides[k].value);
}

static enum cs_status make_key(struct cs_parameter_sweep_cell *cell,
                               const struct cs_parameter_sweep *product,
                               struct cs_error *error) {
    struct cs_text all = {0};
    cs_text_add(&all, "%s|%u", CS_VERSION, product->frames);
    if (cell->refusal.status)
        add_refusal(cell, product->n_keys, &all);
    else
        add_meaning(cell, &all, error);
    if (all.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the key of a cell");
    else
        cs_hash_bytes(cs_text_get(&all), all.length, cell->key);
    cs_text_finish(&all);
    return error->status;
}

enum cs_status cs_parameter_sweep_cell_open(struct cs_parameter_sweep_cell *cell,
                                            const struct cs_parameter_sweep *product,
                                            uint32_t number, struct cs_error *error) {
    struct cs_session_settings asked = product->session;
    *cell = (struct cs_parameter_sweep_cell){.number = number};
    choose_values(cell, product);
    asked.overrides = cell->overrides;
    asked.n_overrides = product->n_keys;
    asked.integrator = cell->method;
    if (cs_session_open_plan(&cell->session, &asked, &cell->refusal) &&
        !is_own_fault(&cell->refusal))
        return cs_fail(error, cell->refusal.status, "%s", cell->refusal.message);
    return make_key(cell, product, error);
}

void cs_parameter_sweep_cell_close(struct cs_parameter_sweep_cell *cell) {
    cs_session_close(&cell->session);
}

void cs_parameter_sweep_add_head(const struct cs_parameter_sweep *product,
                                 struct cs_text *out) {
    cs_text_add(out, "cell");
    for (uint32_t k = 0; k < product->n_keys; k++)
        cs_csv_add_text(out, product->keys[k].path);
    cs_text_add(out, ",integrator,outcome,frames,time,steps,evals,iterations,kinetic,elastic,"
                     "energy,strain,hash,cpu,machine,version,note,key");
}

/* Adds outcome, counts and figures of the run. */
static void add_result(const struct cs_session *session, const char *outcome, double cpu,
                       struct cs_text *out) {
    const struct cs_run *run = &session->run;
    const struct cs_energy energy = cs_diagnostics_energy(run->system, run->t, run->x, run->v);
    char hash[CS_HASH_DIGITS];
    cs_hash_doubles(run->x, 6 * (size_t)session->system.view.n, hash);
    cs_csv_add_text(out, outcome);
    cs_text_add(out, ",%u", run->frame);
    cs_csv_add_number(out, run->t);
    cs_text_add(out, ",%llu,%llu,%llu", (unsigned long long)run->counts.steps,
                (unsigned long long)run->counts.forces,
                (unsigned long long)run->counts.solve_iterations);
    cs_csv_add_number(out, energy.kinetic);
    cs_csv_add_number(out, energy.elastic);
    cs_csv_add_number(out, cs_energy_total(&energy));
    cs_csv_add_number(out, cs_diagnostics_strain(run->system, run->x));
    cs_csv_add_text(out, hash);
    cs_csv_add_number(out, cpu);
}

/* Adds a refusal by scene or method as a row. Errors of the command line are passed on. */
static enum cs_status add_failure(struct cs_parameter_sweep *product,
                                  const struct cs_error *failure, struct cs_text *out,
                                  struct cs_error *error) {
    if (!is_own_fault(failure))
        return cs_fail(error, failure->status, "%s", failure->message);
    if (!product->n_refused++)
        product->first_refusal = *failure;
    cs_csv_add_text(out, failure->status == CS_ERR_SCENE ? "refused" : "failed");
    cs_text_add(out, ",,,,,,,,,,,");
    return CS_OK;
}

/* Runs from the plan to the last frame. Returns the processor time in s of the frames. */
static double run_frames(struct cs_parameter_sweep_cell *cell, uint32_t frames) {
    struct cs_session *session = &cell->session;
    struct cs_error *failure = &cell->refusal;
    struct cs_follow follow = {.run = &session->run, .last = frames};
    if (!failure->status && !cs_session_build(session, failure) &&
        !cs_session_begin(session, NULL, failure))
        cs_follow_next(&follow, failure);
    return follow.cpu;
}

enum cs_status cs_parameter_sweep_cell_run(struct cs_parameter_sweep_cell *cell,
                                           struct cs_parameter_sweep *product,
                                           struct cs_text *out, struct cs_error *error) {
    const struct cs_session *session = &cell->session;
    const struct cs_integrator *integrator = session->method.integrator;
    char machine[CS_MACHINE_NAME];
    cs_text_add(out, "%u", cell->number);
    for (uint32_t k = 0; k < product->n_keys; k++)
        cs_csv_add_text(out, cell->overrides[k].value);
    const double cpu = run_frames(cell, product->frames);
    cs_csv_add_text(out, cell->method ? cell->method : integrator ? integrator->name : "");
    cs_follow_check(&session->run, "; finished rows are saved", error);
    if (!error->status && cell->refusal.status)
        add_failure(product, &cell->refusal, out, error);
    else if (!error->status)
        add_result(session, cs_outcome_text(session->run.outcome), cpu, out);
    cs_machine_name(machine);
    cs_csv_add_text(out, machine);
    cs_csv_add_text(out, CS_VERSION);
    cs_csv_add_text(out, cell->refusal.message);
    cs_csv_add_text(out, cell->key);
    cs_text_add(out, "\n");
    if (out->failed && !error->status)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a row");
    return error->status;
}
