/* Writes the models to be measured as scenes in JSON, and opens them. */
#include "sheet.h"

#include "base/file.h"
#include "session/perturb.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* of limbs at this detail: about 6300 vertices */
enum { MESH_DETAIL = 61, MESH_DETAIL_QUICK = 31 };

void bench_model_name(const struct bench_model *model, char name[16]) {
    if (model->r)
        snprintf(name, 16, "%u", model->r);
    else
        snprintf(name, 16, "mesh");
}

/* of the mesh nearly so: it counts for dampers and steps only */
static double particle_mass(const struct bench_model *model) {
    return model->r ? 0.2 / ((double)model->r * model->r) : 0.2 / 6300;
}

double bench_model_step(const struct bench_model *model) {
    return 0.2 * sqrt(particle_mass(model) / model->stiffness);
}

static void add_body(const struct bench_settings *settings, const struct bench_model *model,
                     struct cs_text *json) {
    if (model->r)
        cs_text_add(json, "\"cloth\": {\"grid\": [%u, %u], \"start\": \"flat\"}", model->r,
                    model->r);
    else
        cs_text_add(json,
                    "\"mesh\": {\"shape\": \"limbs\", \"detail\": %d, "
                    "\"place\": {\"translate\": [0, 1, 0]}},\n"
                    "\"network\": {\"placement\": \"nearest\", \"springs\": 1, "
                    "\"candidates\": 4, \"tries\": 400}",
                    settings->quick ? MESH_DETAIL_QUICK : MESH_DETAIL);
}

static void add_springs(const struct bench_model *model, struct cs_text *json) {
    const double k = model->stiffness;
    const double damping =
        model->damping == BENCH_UNDAMPED ? 0 : 2 * 0.02 * sqrt(k * particle_mass(model));
    const double bend = model->slim || !model->r ? 0 : 8 * k / 75;
    cs_text_add(json, "\"springs\": {\"stretch\": %.17g, \"shear\": %.17g, \"bend\": %.17g", k,
                22 * k / 75, bend);
    cs_text_add(json, ", \"damping\": %.17g, \"damping_model\": \"%s\"}", damping,
                model->damping == BENCH_RELATIVE ? "relative" : "axial");
}

static void print(const struct bench_settings *settings, const struct bench_model *model,
                  struct cs_text *json) {
    cs_text_add(json, "{\"bodies\": [{");
    add_body(settings, model, json);
    cs_text_add(json, ",\n\"mass\": {\"total\": 0.2},\n");
    add_springs(model, json);
    if (model->r && !model->meets)
        cs_text_add(json, ",\n\"pins\": [\"top-left\", \"top-right\"]");
    if (model->meets)
        cs_text_add(json, ",\n\"self_contact\": true, \"friction\": 0.3");
    if (model->company)
        cs_text_add(json, ",\n\"strain_limit\": 9");
    cs_text_add(json, "}],\n\"time\": {\"fps\": %.17g},\n", model->fps);
    // the sheet starts a little way into the sphere, so that some particles are pushed
    if (model->company)
        cs_text_add(json, "\"contact\": {\"law\": \"project\", \"start\": \"move-out\"},\n"
                          "\"colliders\": [{\"sphere\": {\"centre\": [0, -0.3, 0], "
                          "\"radius\": 0.31}}, {\"plane\": {\"point\": [0, -0.5, 0], "
                          "\"normal\": [0.4, 1, 0.1]}}],\n"
                          "\"forces\": {\"wind\": {\"direction\": [0, 0, 1], "
                          "\"strength\": 4}},\n");
    if (model->meets)
        cs_text_add(json, "\"contact\": {\"law\": \"force\", \"damping\": 0.0005},\n"
                          "\"crossings\": \"limit\",\n");
    cs_text_add(json, "\"integrator\": \"velocity-verlet\"}\n");
}

enum cs_status bench_sheet_open(struct cs_session *session,
                                const struct bench_settings *settings,
                                const struct bench_model *model, const char *integrator,
                                uint32_t needs, struct cs_error *error) {
    struct cs_text json = {0}, path = {0};
    print(settings, model, &json);
    cs_text_add(&path, "%s/scene.json", settings->scratch);
    const struct cs_session_settings asked = {
        .scene = cs_text_get(&path), .integrator = integrator, .needs = needs};
    *session = (struct cs_session){0};
    if (json.failed || path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a scene");
    else if (!cs_file_write(path.bytes, json.bytes, json.length, error))
        cs_session_open_system(session, &asked, error);
    cs_text_finish(&json);
    cs_text_finish(&path);
    return error->status;
}

void bench_sheet_perturb(struct cs_system *system) {
    const size_t n = system->view.n;
    double *x = system->state;
    /* nothing moves in the first row, where the pins are: no spring is torn there */
    const double first = x[2 * n];
    for (size_t i = 0; i < n; i++)
        if (system->inv_mass[i] > 0) {
            const double z = x[2 * n + i];
            x[n + i] += 0.02 * sin(18.85 * x[i]);
            x[i] += 0.05 * (z - first);
        }
    cs_perturb_random(system, 0.02 * cs_springs_shortest(&system->springs), 0.1);
}

void bench_sheet_advance(struct cs_run *run, const double *start, double time,
                         struct cs_error *error) {
    memcpy(run->x, start, 6 * sizeof *start * run->system->view.n);
    if (!cs_run_restart(run, 0, error))
        cs_run_advance(run, 0, time, error);
}
