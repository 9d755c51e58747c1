/* Times the kernels one by one, each beside the hardware limit that it cannot pass.
 *
 * The limit of a kernel is the larger of two times: that of the divider, a root and a quotient
 * (or a root alone) a spring, and that of the memory, each array that the kernel must read or
 * write moved once at the triad's rate for arrays of about the same size. */
#include "limits.h"
#include "sheet.h"

#include "base/vector.h"
#include "model/force/diagnostics.h"
#include "model/force/terms.h"
#include "model/post_step/contact_projection.h"
#include "model/solver/linear.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define INTERNAL (CS_PART_SPRINGS | CS_PART_DAMPING | CS_PART_GRAVITY)

/* which of the models of a size a kernel is run on */
enum variant { FULL, UNDAMPED, RELATIVE, SLIM, VARIANTS };

/* A system with all that a kernel may want. */
struct bed {
    struct cs_session session;
    struct cs_linear linear;              /* only of FULL */
    struct cs_contact_projection contact; /* likewise */
    struct cs_arena arena;
    double *x, *v;         /* of the system */
    double *dx, *dv, *out; /* (3,n) */
    double *kxx, *dvv;     /* (6,n) */
    double sum;            /* of what is only added up, so that it is not left out */
};

static void force(void *object) {
    struct bed *bed = object;
    cs_terms_force(&bed->session.system,
                   &(struct cs_eval){.x = bed->x, .v = bed->v, .parts = INTERNAL}, bed->out);
}

static void jvp(void *object) {
    struct bed *bed = object;
    cs_terms_jvp(&bed->session.system,
                 &(struct cs_eval){
                     .x = bed->x, .v = bed->v, .parts = INTERNAL, .dx = bed->dx, .dv = bed->dv},
                 bed->out);
}

static void energy(void *object) {
    struct bed *bed = object;
    bed->sum += cs_springs_energy(&bed->session.system.springs, bed->session.system.view.n,
                                  bed->x, CS_PART_SPRINGS);
}

static void factor(void *object) {
    struct bed *bed = object;
    const struct cs_linear *linear = &bed->linear;
    cs_springs_factor(
        &bed->session.system.springs, bed->session.system.view.n,
        &(struct cs_matrix){
            .x = bed->x, .cd = linear->matrix.cd, .ck = linear->matrix.ck, .psd = true},
        linear->factors);
}

static void setup(void *object) {
    struct bed *bed = object;
    const double h = 1 / 60.0;
    cs_linear_setup(
        &bed->linear,
        &(struct cs_matrix){.x = bed->x, .cm = 1, .cd = -h, .ck = -h * h, .psd = true});
}

static void matvec(void *object) {
    struct bed *bed = object;
    cs_linear_mul(&bed->linear, bed->dx, bed->out);
}

static void diagonal(void *object) {
    struct bed *bed = object;
    cs_terms_diagonal(&bed->session.system,
                      &(struct cs_eval){.x = bed->x, .parts = CS_PART_LINEARISED}, bed->kxx,
                      bed->dvv);
}

static void normals(void *object) {
    struct bed *bed = object;
    cs_normals_update(&bed->session.system, bed->x);
}

/* both have moved what there was to move when they are first called */
static void contact(void *object) {
    struct bed *bed = object;
    cs_contact_projection_resolve(&bed->contact, 0, 1 / 60.0, bed->x, bed->v);
}

static void limit(void *object) {
    struct bed *bed = object;
    cs_strain_limit_apply(&bed->session.run.strain_limit, &bed->session.system, 1 / 60.0,
                          bed->x, bed->v);
}

static void dot(void *object) {
    struct bed *bed = object;
    bed->sum += cs_vector_kernels.dot(3 * (size_t)bed->session.system.view.n, bed->dx, bed->dv);
}

static const struct kernel {
    const char *name;
    void (*run)(void *bed);
    enum variant variant;
    bool by_spring;          /* else by particle */
    double quotients, roots; /* roots with a quotient, and without, a spring or particle */
    double bytes;            /* read and written, a particle */
    double spring_bytes;     /* beside that, a spring */
} kernels[] = {
    {"force undamped", force, UNDAMPED, true, 1, 0, 48, 0},
    {"force axial", force, FULL, true, 1, 0, 72, 0},
    {"force relative", force, RELATIVE, true, 1, 0, 72, 0},
    {"force axial; no bend", force, SLIM, true, 1, 0, 72, 0},
    {"jvp axial", jvp, FULL, true, 1, 0, 120, 0},
    {"energy", energy, FULL, true, 0, 1, 24, 0},
    {"factor", factor, FULL, true, 1, 1, 24, 32},
    {"set-up", setup, FULL, true, 1, 1, 88, 32},
    {"matvec", matvec, FULL, true, 0, 0, 56, 32},
    {"diagonal", diagonal, FULL, true, 1, 0, 120, 0},
    {"normals", normals, FULL, false, 1, 0, 48, 0},
    {"contact", contact, FULL, false, 0, 1, 32, 0},
    {"strain limit; idle", limit, FULL, false, 0, 0, 24, 0},
    {"dot", dot, FULL, false, 0, 0, 48, 0},
};

/* The tasks of one size: the limits, then the kernels. The triad is done on as many bytes a
 * particle as a force moves, and as a matrix does: whatever cache these find room in. */
enum { DIVIDE, ROOT, TRIAD, WIDE_TRIAD, LOOPS, KERNELS = sizeof kernels / sizeof *kernels };
enum { TRIAD_BYTES = 96, WIDE_TRIAD_BYTES = 240 };

/* ends, and length and stiffness, of a spring of a mesh */
enum { LIST_BYTES = 8 + 16 };

struct group {
    struct bench_model model;
    struct bed beds[VARIANTS];
    struct bench_loop loops[LOOPS];
    struct bench_task tasks[LOOPS + KERNELS];
};

static double *take(struct bed *bed, size_t n, struct cs_error *error) {
    return cs_arena_alloc_array(&bed->arena, n, sizeof(double), error);
}

static enum cs_status open_bed(struct bed *bed, const struct bench_settings *settings,
                               struct bench_model model, enum variant variant,
                               struct cs_error *error) {
    const uint32_t needs = variant == FULL ? CS_NEED_JVP | CS_NEED_DIAGONAL | CS_NEED_ENERGY |
                                                 CS_NEED_SOLVE | CS_NEED_SPRINGS
                                           : 0;
    model.damping = variant == UNDAMPED   ? BENCH_UNDAMPED
                    : variant == RELATIVE ? BENCH_RELATIVE
                                          : BENCH_AXIAL;
    model.slim = variant == SLIM;
    model.company = variant == FULL;
    if (bench_sheet_open(&bed->session, settings, &model, "velocity-verlet", needs, error))
        return error->status;
    struct cs_system *system = &bed->session.system;
    const size_t n = system->view.n;
    bench_sheet_perturb(system);
    bed->x = system->state;
    bed->v = bed->x + 3 * n;
    bed->out = take(bed, 3 * n, error);
    /* the other variants are timed with the force alone */
    if (variant != FULL)
        return error->status;
    bed->dx = take(bed, 3 * n, error);
    bed->dv = take(bed, 3 * n, error);
    bed->kxx = take(bed, 6 * n, error);
    bed->dvv = take(bed, 6 * n, error);
    if (error->status || cs_linear_init(&bed->linear, system, &bed->arena, error) ||
        cs_contact_projection_init(&bed->contact, system, &bed->arena, error))
        return error->status;
    memcpy(bed->dx, bed->v, 3 * n * sizeof *bed->dx);
    memcpy(bed->dv, bed->x, 3 * n * sizeof *bed->dv);
    setup(bed);
    cs_contact_projection_store(&bed->contact, bed->x, bed->v, false);
    return CS_OK;
}

static void close_group(struct group *group) {
    for (int k = 0; k < VARIANTS; k++) {
        cs_arena_finish(&group->beds[k].arena);
        cs_session_close(&group->beds[k].session);
    }
    for (int k = 0; k < LOOPS; k++)
        bench_loop_finish(group->loops + k);
}

static enum cs_status open_group(struct group *group, const struct bench_settings *settings,
                                 struct cs_error *error) {
    static void (*const loops[LOOPS])(void *) = {bench_sqrt_divide, bench_sqrt, bench_triad,
                                                 bench_triad};
    for (int k = 0; k < VARIANTS && !error->status; k++)
        open_bed(group->beds + k, settings, group->model, (enum variant)k, error);
    const size_t n = group->beds[FULL].session.system.view.n;
    const size_t bytes[LOOPS] = {BENCH_LOOP_BYTES, BENCH_LOOP_BYTES, TRIAD_BYTES * n,
                                 WIDE_TRIAD_BYTES * n};
    for (int k = 0; k < LOOPS && !error->status; k++) {
        group->tasks[k] = (struct bench_task){.run = loops[k], .object = group->loops + k};
        bench_loop_init(group->loops + k, bytes[k], error);
    }
    for (int k = 0; k < KERNELS; k++)
        group->tasks[LOOPS + k] = (struct bench_task){
            .run = kernels[k].run, .object = group->beds + kernels[k].variant};
    return error->status;
}

/* ns a particle that divider and memory need for a kernel at least */
static void find_limits(const struct group *group, const struct kernel *kernel, double springs,
                        double *divider, double *memory) {
    const double listed = kernel->by_spring && !group->model.r ? LIST_BYTES : 0;
    const double bytes = kernel->bytes + springs * (kernel->spring_bytes + listed);
    const int triad = bytes < (TRIAD_BYTES + WIDE_TRIAD_BYTES) / 2 ? TRIAD : WIDE_TRIAD;
    *divider = (kernel->by_spring ? springs : 1) *
               (kernel->quotients * bench_loop_ns(group->tasks + DIVIDE) +
                kernel->roots * bench_loop_ns(group->tasks + ROOT));
    *memory = bytes * bench_loop_ns(group->tasks + triad) / BENCH_TRIAD_BYTES;
}

static void add_row(const struct group *group, int k, struct bench_table *table) {
    const struct kernel *kernel = kernels + k;
    const struct bench_spread time = group->tasks[LOOPS + k].time;
    const struct cs_system *system = &group->beds[kernel->variant].session.system;
    const double n = system->view.n, springs = system->springs.n / n, ns = 1e9 / n;
    double divider, memory;
    char name[16], by_spring[32] = "";
    find_limits(group, kernel, springs, &divider, &memory);
    const double least = divider > memory ? divider : memory;
    bench_model_name(&group->model, name);
    if (kernel->by_spring)
        snprintf(by_spring, sizeof by_spring, "%.3f", ns * time.median / springs);
    bench_table_add(table, "%s,%s,%.3f,%.3f,%.3f,%s,%.3f,%s,%.2f", name, kernel->name,
                    ns * time.median, ns * time.min, ns * time.max, by_spring, least,
                    divider > memory ? "divider" : "memory", ns * time.median / least);
}

static enum cs_status measure(const struct bench_settings *settings, uint32_t r,
                              struct bench_table *table, struct cs_error *error) {
    struct group *group = calloc(1, sizeof *group);
    if (!group)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory");
    group->model = (struct bench_model){.r = r, .stiffness = 1e4, .fps = 60};
    if (!open_group(group, settings, error)) {
        bench_measure(settings, group->tasks, LOOPS + KERNELS);
        for (int k = 0; k < KERNELS; k++)
            add_row(group, k, table);
    }
    close_group(group);
    free(group);
    return error->status;
}

static enum cs_status run(const struct bench_settings *settings, struct bench_table *table,
                          struct cs_error *error) {
    static const uint32_t sizes[] = {16, 64, 0, 256, 1000};
    const uint32_t n = settings->quick ? 3 : sizeof sizes / sizeof *sizes;
    for (uint32_t k = 0; k < n && !error->status; k++) {
        bench_report(sizes[k] ? "sheet of %u x %u" : "body of springs", sizes[k], sizes[k]);
        measure(settings, sizes[k], table, error);
    }
    return error->status;
}

static const char *const columns[] = {"sheet",    "kernel",    "median_ns", "min_ns",
                                      "max_ns",   "spring_ns", "limit_ns",  "bound_by",
                                      "to_limit", NULL};
const struct bench_section bench_kernels = {
    .name = "kernels",
    .summary = "ns a particle (and a spring), beside the limit of the machine",
    .columns = columns,
    .n_keys = 2,
    .measured = "median_ns",
    .run = run,
};
