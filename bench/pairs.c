/* Times contact of a sheet with itself stage by stage, beside the force of its springs.
 *
 * Flat, the sheet meets nothing. Folded, it lies in layers of 16 columns one upon the other,
 * at 0.6 to 5.4 ranges from each other, so that larger sheets have more layers; or in four
 * layers whatever its size, so that particles have about as many pairs. In motion it goes to
 * and fro along a velocity field of up to 1 m/s, by a step a force, so that lists are made as
 * often as in an explicit run; a step of an implicit method is FRAME / 4 of it. What is asked
 * of a step is asked of one that moves by half a range against itself, as steps of a run do in
 * contact, halved until it is seen. */
#include "sheet.h"
#include "timing.h"

#include "model/contact/ccd/crossings.h"
#include "model/contact/narrow_phase/active_contacts.h"
#include "model/contact/narrow_phase/contact_pairs.h"
#include "model/force/terms.h"
#include "session/perturb.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WAY = 32 };
#define FRAME (1 / 60.0)

struct bed {
    struct cs_session session;
    struct cs_arena arena;
    double *x, *v, *out; /* (3,n) the middle of the motion, the field, and what is asked for */
    double *at;          /* (3,n) where the motion is */
    double h;            /* s a force */
    double taken;        /* s a step of an implicit method that is taken */
    const char *state;
    uint32_t r, columns; /* along a side; in a layer, 0: it is flat */
};

static void move(struct bed *bed, double t) {
    const size_t n = 3 * (size_t)bed->session.system.view.n;
    for (size_t i = 0; i < n; i++)
        bed->at[i] = bed->x[i] + t * bed->v[i];
}

static struct cs_eval here(const struct bed *bed, uint32_t parts) {
    return (struct cs_eval){.x = bed->at, .v = bed->v, .parts = parts};
}

static void springs(void *object) {
    struct bed *bed = object;
    const struct cs_eval at = here(bed, CS_PART_DAMPED_SPRINGS);
    cs_terms_force(&bed->session.system, &at, bed->out);
}

static void keep(void *object) {
    struct bed *bed = object;
    cs_candidates_update(&bed->session.system.pairs->candidates, bed->at);
}

static void build(void *object) {
    struct bed *bed = object;
    bed->session.system.pairs->candidates.is_built = false;
    keep(bed);
}

static void candidates(void *object) {
    struct bed *bed = object;
    bed->session.system.pairs->candidates.has_close_pairs = false;
    bed->session.system.pairs->candidates.has_nearby = false;
    cs_candidates_find_in_range(&bed->session.system.pairs->candidates, bed->at);
}

static void pairs(void *object) {
    struct bed *bed = object;
    bed->session.system.pairs->candidates.has_close_pairs = false;
    const struct cs_eval at = here(bed, CS_PART_POTENTIAL | CS_PART_DISSIPATIVE);
    cs_terms_force(&bed->session.system, &at, bed->out);
}

/* there and back, in 2 WAY forces */
static void in_motion(void *object) {
    struct bed *bed = object;
    for (int turn = 0; turn < 2 * WAY; turn++) {
        move(bed, bed->h * ((turn < WAY ? turn : 2 * WAY - turn) - WAY / 2));
        pairs(bed);
    }
}

static void matrix(void *object) {
    struct bed *bed = object;
    const double h = FRAME / 4;
    cs_term_pairs.prepare_matrix(
        &bed->session.system,
        &(struct cs_matrix){
            .x = bed->x, .v = bed->v, .cm = 1, .cd = -h, .ck = -h * h, .psd = true},
        true);
}

static void product(void *object) {
    struct bed *bed = object;
    cs_term_pairs.add_matrix_product(&bed->session.system, bed->v, bed->out);
}

static bool ask(struct bed *bed, double h) {
    move(bed, h);
    const bool is =
        cs_contact_pairs_resolve_step(bed->session.system.pairs, 0, bed->x, h, bed->at);
    move(bed, 0);
    return is;
}

static void seen(void *object) {
    struct bed *bed = object;
    ask(bed, bed->taken);
}

static void share(void *object) {
    struct bed *bed = object;
    move(bed, bed->taken);
    bed->out[0] =
        cs_crossings_safe_fraction(&bed->session.system, 0, bed->x, bed->taken, bed->at);
    move(bed, 0);
}

static void crossings(void *object) {
    struct bed *bed = object;
    bed->out[0] = (double)cs_crossings_count(&bed->session.system, 0, bed->x).n;
}

/* The list as it stands comes before what makes others. kept: it is found to be good; list: it
 * is made from nothing; seen and limited: what is asked of a step, by a list that covers it;
 * counted: asked of a frame. */
static const struct stage {
    const char *name;
    void (*run)(void *bed);
    enum { BY_NONE, BY_CANDIDATE, BY_PAIR } by;
} stages[] = {
    {"springs", springs, BY_NONE},
    {"kept", keep, BY_NONE},
    {"candidates", candidates, BY_CANDIDATE},
    {"force", pairs, BY_PAIR},
    {"list", build, BY_CANDIDATE},
    {"matrix", matrix, BY_PAIR},
    {"product", product, BY_PAIR},
    {"motion", in_motion, BY_NONE},
    {"seen", seen, BY_NONE},
    {"limited", share, BY_NONE},
    {"counted", crossings, BY_NONE},
};
enum { STAGES = sizeof stages / sizeof *stages };

/* layers of so many columns one upon the other, each bent back at its end */
static void fold(struct bed *bed) {
    const size_t n = bed->session.system.view.n, r = bed->r, columns = bed->columns;
    const double edge = 1.0 / (double)(r - 1);
    const double range = bed->session.system.pairs->body_pairs.range_max;
    for (size_t i = 0; i < n; i++) {
        const size_t column = i % r, layer = column / columns, along = column % columns;
        const double wave = sin(0.4 * (double)(i / r) + 2.1 * (double)layer);
        bed->x[i] = edge * (double)(layer % 2 ? columns - 1 - along : along);
        bed->x[n + i] = range * (3 * (double)layer + 1.4 * wave);
    }
}

/* velocities of a few waves across the sheet, and between layers */
static void stir(struct bed *bed) {
    const size_t n = bed->session.system.view.n;
    for (size_t i = 0; i < n; i++) {
        const double z = bed->x[2 * n + i];
        bed->v[i] = 0.3 * sin(9 * z);
        bed->v[n + i] = sin(25 * z + 40 * bed->x[i]);
        bed->v[2 * n + i] = 0.3 * sin(11 * bed->x[i]);
    }
}

static enum cs_status open_bed(struct bed *bed, const struct bench_settings *settings,
                               struct cs_error *error) {
    const struct bench_model model = {.r = bed->r, .stiffness = 100, .fps = 60, .meets = true};
    if (bench_sheet_open(&bed->session, settings, &model, "velocity-verlet", CS_NEED_SOLVE,
                         error))
        return error->status;
    struct cs_system *system = &bed->session.system;
    const size_t n = 3 * (size_t)system->view.n;
    bed->h = bench_model_step(&model);
    bed->x = system->state;
    bed->v = bed->x + n;
    bed->out = cs_arena_alloc_array(&bed->arena, n, sizeof(double), error);
    bed->at = cs_arena_alloc_array(&bed->arena, n, sizeof(double), error);
    if (error->status)
        return error->status;
    if (bed->columns)
        fold(bed);
    cs_perturb_random(system, 0.02 / bed->r, 0);
    stir(bed);
    // at 1 m/s, to either side
    const double range = system->pairs->body_pairs.range_min;
    for (bed->taken = fmin(FRAME / 4, 0.25 * range); !ask(bed, bed->taken); bed->taken *= 0.5)
        ;
    matrix(bed);
    return CS_OK;
}

static uint64_t count(const struct bed *bed, int by) {
    const struct cs_pairs *pairs = bed->session.system.pairs;
    uint64_t n = by == BY_PAIR ? pairs->solver_matrix.contacts->n : 0;
    for (uint32_t l = 0; by == BY_CANDIDATE && l < pairs->candidates.n_chunks; l++)
        n += pairs->candidates.chunks[l].n;
    return n;
}

static void add_row(const struct bed *bed, const struct bench_task *tasks, int k,
                    uint64_t items, struct bench_table *table) {
    const struct bench_spread time = tasks[k].time;
    const double n = bed->session.system.view.n,
                 times = stages[k].run == in_motion ? 2 * WAY : 1;
    const double ns = 1e9 / n / times;
    char each[64] = ",";
    if (items)
        snprintf(each, sizeof each, "%.3f,%.2f", (double)items / n,
                 1e9 * time.median / (double)items);
    bench_table_add(table, "%u,%s,%s,%.4g,%.4g,%.4g,%s,%.4g", bed->r, bed->state,
                    stages[k].name, ns * time.median, ns * time.min, ns * time.max, each,
                    time.median / times / tasks[0].time.median);
}

static enum cs_status measure(const struct bench_settings *settings, struct bed bed,
                              struct bench_table *table, struct cs_error *error) {
    struct bench_task tasks[STAGES];
    for (int k = 0; k < STAGES; k++)
        tasks[k] = (struct bench_task){.run = stages[k].run, .object = &bed};
    bench_report("sheet of %u x %u, %s", bed.r, bed.r, bed.state);
    if (!open_bed(&bed, settings, error)) {
        build(&bed);
        const uint64_t items[] = {0, count(&bed, BY_CANDIDATE), count(&bed, BY_PAIR)};
        // one after the other: a stage is to find the list that it is about
        for (int k = 0; k < STAGES; k++)
            bench_measure(settings, tasks + k, 1);
        for (int k = 0; k < STAGES; k++)
            add_row(&bed, tasks, k, items[stages[k].by], table);
    }
    cs_arena_finish(&bed.arena);
    cs_session_close(&bed.session);
    return error->status;
}

static enum cs_status run(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error) {
    static const uint32_t sizes[] = {32, 64, 256};
    const uint32_t n = settings->quick ? 1 : sizeof sizes / sizeof *sizes;
    for (uint32_t k = 0; k < n && !error->status; k++) {
        const uint32_t r = sizes[k];
        const struct bed beds[] = {{.r = r, .state = "flat"},
                                   {.r = r, .state = "folded", .columns = 16},
                                   {.r = r, .state = "four layers", .columns = r / 4}};
        for (size_t b = 0; b < sizeof beds / sizeof *beds && !error->status; b++)
            measure(settings, beds[b], table, error);
    }
    return error->status;
}

static const char *const columns[] = {"sheet",  "state",  "stage",   "median_ns",  "min_ns",
                                      "max_ns", "number", "each_ns", "to_springs", NULL};
const struct bench_section bench_pairs = {
    .name = "pairs",
    .summary = "contact of a sheet with itself, stage by stage, ns a particle",
    .columns = columns,
    .n_keys = 3,
    .measured = "median_ns",
    .run = run,
};
