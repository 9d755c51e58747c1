/* Measures the elastic force of a body at given lengths. */
#include "files/force_length.h"

#include "session/session.h"

#include <math.h>
#include <string.h>

enum { ROWS = 101 };

/* Sum along x of the forces on the half of the body that lies below the middle. arrays: x
 * (3,n), then velocities of 0, then the forces. */
static double pull(const struct cs_system *system, const double *start, double middle,
                   double *arrays, double stretch) {
    const struct cs_body_range *body = system->bodies;
    const size_t n = 3 * (size_t)system->view.n;
    double *x = arrays, *f = arrays + 2 * n;
    double sum = 0;
    for (uint32_t i = body->first; i < body->first + body->count; i++)
        x[i] = middle + stretch * (start[i] - middle);
    cs_system_elastic_force(system, x, arrays + n, f);
    for (uint32_t i = body->first; i < body->first + body->count; i++)
        sum += start[i] < middle ? f[i] : 0;
    return sum;
}

/* Middle of the body along x, in m. */
static double middle_of(const struct cs_body_range *body, const double *x) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (uint32_t i = body->first; i < body->first + body->count; i++) {
        low = fmin(low, x[i]);
        high = fmax(high, x[i]);
    }
    return (low + high) / 2;
}

/* Fills the rows. */
static enum cs_status measure_force(const struct cs_system *system, double low, double high,
                                    struct cs_arena *arena, struct cs_number_table *table,
                                    struct cs_error *error) {
    const size_t n = 3 * (size_t)system->view.n;
    const double *start = system->state;
    const double middle = middle_of(system->bodies, start);
    double *arrays = cs_arena_alloc_array(arena, 3 * n, sizeof *arrays, error);
    table->values = cs_arena_alloc_array(arena, 2 * (size_t)ROWS, sizeof(double), error);
    if (error->status)
        return error->status;
    /* other bodies stay where they are */
    memcpy(arrays, start, n * sizeof *arrays);
    for (uint32_t r = 0; r < ROWS; r++) {
        double *row = table->values + (size_t)2 * r;
        row[0] = low + (high - low) * r / (ROWS - 1);
        row[1] = pull(system, start, middle, arrays, row[0]);
    }
    return CS_OK;
}

enum cs_status cs_force_length_measure(const char *scene, double low, double high,
                                       struct cs_arena *arena, struct cs_number_table *table,
                                       struct cs_error *error) {
    /* the forces of pinned particles count too */
    const struct cs_override free = {.path = "bodies[0].pins", .value = "[]"};
    const struct cs_session_settings settings = {
        .scene = scene, .overrides = &free, .n_overrides = 1};
    struct cs_session session;
    *table = (struct cs_number_table){
        .columns = 2,
        .rows = ROWS,
        .names = {cs_arena_copy_text(arena, "length over start", error),
                  cs_arena_copy_text(arena, "force in N", error)}};
    if (!error->status && !cs_session_open_system(&session, &settings, error)) {
        measure_force(&session.system, low, high, arena, table, error);
        cs_session_close(&session);
    }
    return error->status;
}
