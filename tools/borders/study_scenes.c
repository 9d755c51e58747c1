/* Varies one value of a scene over the columns of a stability map. */
#include "borders/study_scenes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const cs_axis_names[] = {"stiffness",  "damping", "mass",
                                     "resolution", "young",   NULL};

const char *cs_axis_unit(enum cs_axis axis) {
    static const char *const units[CS_AXES] = {"N/m", "N s/m", "kg", "columns", "N/m"};
    return units[axis];
}

/* The stiffest of the three kinds of springs stands for all: they are scaled together. */
double cs_axis_scene_value(const struct cs_system *system, enum cs_axis axis) {
    const struct cs_body *body = cs_scene_bodies(system->scene);
    const double young = body->elastic.membrane.young;
    switch (axis) {
    case CS_AXIS_YOUNG: // or that of the warp; 0 without elastic
        return isnan(young) ? cs_membrane_moduli(&body->elastic).warp : young;
    case CS_AXIS_STIFFNESS:
        if (body->elastic.present)
            return 0;
        return fmax(body->springs.stretch, fmax(body->springs.shear, body->springs.bend));
    case CS_AXIS_DAMPING:
        return body->springs.damping;
    case CS_AXIS_MASS:
        return system->mass[0];
    default:
        return (double)body->cloth.grid[0];
    }
}

/* Two decades to either side of the scene's value. Exceptions: the resolution, a whole number,
 * and damping in a scene without any, which ends at 2 sqrt(k m), critical for one spring. */
struct cs_range cs_axis_range(const struct cs_system *system, enum cs_axis axis) {
    const double own = cs_axis_scene_value(system, axis);
    if (axis == CS_AXIS_RESOLUTION)
        return (struct cs_range){fmin(8, own), fmin(48, fmax(1.5 * own, 24))};
    if (axis == CS_AXIS_DAMPING && own <= 0) {
        /* up to what damps a lone spring at its critical rate */
        const double k = cs_axis_scene_value(system, CS_AXIS_STIFFNESS);
        const double critical = 2 * sqrt(k * system->mass[0]);
        return (struct cs_range){1e-4 * critical, critical};
    }
    return (struct cs_range){own / 100, own * 100};
}

/* Override list of a session while entries are appended. */
struct growing {
    struct cs_override *list; /* owned by the arena */
    uint32_t n;
    struct cs_arena *arena;
    uint32_t body; /* whose keys are added now */
    struct cs_error *error;
};

/* Appends the override "bodies[body].key" = value; both texts are copied to the arena. */
static void add_value(struct growing *to, const char *key, const char *value) {
    char path[64];
    snprintf(path, sizeof path, "bodies[%u].%s", to->body, key);
    to->list[to->n].path = cs_arena_copy_text(to->arena, path, to->error);
    to->list[to->n].value = cs_arena_copy_text(to->arena, value, to->error);
    to->n++;
}

/* Appends a number with as many digits as it needs to be read back unchanged. */
static void add_real(struct growing *to, const char *key, double value) {
    struct cs_text text = {0};
    cs_text_add_real(&text, value);
    if (text.failed)
        cs_fail(to->error, CS_ERR_MEMORY, "out of memory");
    else
        add_value(to, key, cs_text_get(&text));
    cs_text_finish(&text);
}

/* Scales both counts of a grid, rounded, so bodies keep their proportions; at least 1. */
static void add_grid(struct growing *to, const int64_t *grid, double factor) {
    char value[64];
    snprintf(value, sizeof value, "[%.0f, %.0f]",
             fmax(1, floor((double)grid[0] * factor + 0.5)),
             fmax(1, floor((double)grid[1] * factor + 0.5)));
    add_value(to, "cloth.grid", value);
}

/* Appends the constants of a measured cloth instead of its name, those of its membrane times
 * factor. */
static void add_measured(struct growing *to, const struct cs_elastic *elastic, double factor) {
    const struct cs_moduli C = cs_membrane_moduli(elastic), D = cs_bending_moduli(elastic);
    char value[512];
    snprintf(value, sizeof value,
             "{\"membrane\": {\"warp\": %.17g, \"weft\": %.17g, \"shear\": %.17g, "
             "\"coupling\": %.17g}, \"bending\": {\"warp\": %.17g, \"weft\": %.17g, "
             "\"twist\": %.17g}, \"damping\": %.17g}",
             C.warp * factor, C.weft * factor, C.shear * factor, C.coupling * factor, D.warp,
             D.weft, D.shear, elastic->damping);
    add_value(to, "elastic", value);
}

/* Appends the overrides of one body: its values on the axis times factor. Values that the scene
 * does not set (NAN) stay unset, so the key that the scene uses for mass decides. */
static void add_scaled(struct growing *to, const struct cs_body *body, enum cs_axis axis,
                       double value, double factor) {
    const struct cs_spring_law *law = &body->springs;
    const struct cs_membrane_keys *membrane = &body->elastic.membrane;
    const struct cs_mass *mass = &body->mass;
    const struct {
        enum cs_axis axis;
        const char *key;
        double value;
    } rows[] = {
        {CS_AXIS_STIFFNESS, "springs.stretch", law->stretch * factor},
        {CS_AXIS_STIFFNESS, "springs.shear", law->shear * factor},
        {CS_AXIS_STIFFNESS, "springs.bend", law->bend * factor},
        /* a body without damping gets that of the axis */
        {CS_AXIS_DAMPING, "springs.damping", law->damping > 0 ? law->damping * factor : value},
        {CS_AXIS_YOUNG, "elastic.membrane.young", membrane->young * factor},
        {CS_AXIS_YOUNG, "elastic.membrane.warp", membrane->warp * factor},
        {CS_AXIS_YOUNG, "elastic.membrane.weft", membrane->weft * factor},
        {CS_AXIS_YOUNG, "elastic.membrane.shear", membrane->shear * factor},
        {CS_AXIS_YOUNG, "elastic.membrane.coupling",
         isnan(membrane->warp) ? (double)NAN : membrane->coupling * factor},
        {CS_AXIS_MASS, "mass.particle", mass->particle * factor},
        {CS_AXIS_MASS, "mass.areal_density", mass->areal_density * factor},
        {CS_AXIS_MASS, "mass.total", mass->total * factor},
        {CS_AXIS_MASS, "mass.degree", mass->degree * factor},
    };
    for (uint32_t k = 0; k < sizeof rows / sizeof *rows; k++)
        if (rows[k].axis == axis && !isnan(rows[k].value) &&
            !(body->elastic.present && !strncmp(rows[k].key, "springs.", 8)))
            add_real(to, rows[k].key, rows[k].value);
    if (axis == CS_AXIS_YOUNG && body->elastic.present && body->elastic.cloth >= 0)
        add_measured(to, &body->elastic, factor);
    if (axis == CS_AXIS_RESOLUTION)
        add_grid(to, body->cloth.grid, factor);
}

enum cs_status cs_axis_overrides(const struct cs_system *system, enum cs_axis axis,
                                 double value, struct cs_arena *arena,
                                 struct cs_session_settings *session, struct cs_error *error) {
    enum { MOST_A_BODY = 4 };
    const struct cs_scene *scene = system->scene;
    const double own = cs_axis_scene_value(system, axis);
    const size_t most = session->n_overrides + (size_t)MOST_A_BODY * scene->bodies.n;
    struct growing to = {.n = session->n_overrides, .arena = arena, .error = error};
    to.list = cs_arena_alloc_array(arena, most, sizeof *to.list, error);
    if (!to.list)
        return error->status;
    if (to.n)
        memcpy(to.list, session->overrides, to.n * sizeof *to.list);
    for (; to.body < scene->bodies.n && !error->status; to.body++)
        add_scaled(&to, cs_scene_bodies(scene) + to.body, axis, value,
                   own > 0 ? value / own : 1);
    session->overrides = to.list;
    session->n_overrides = to.n;
    return error->status;
}
