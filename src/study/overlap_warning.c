/* Bounding boxes of bodies, and of the positions they can reach. */
#include "study/overlap_warning.h"

#include "scene/body_pairs.h"
#include "scene/shape.h"

#include <math.h>
#include <stdlib.h>

/* Fraction of a free body's diagonal by which its box is enlarged: it turns and spreads. */
#define SPREAD 0.1

/* An axis-aligned box in m. */
struct box {
    double low[3], high[3];
};

struct body {
    struct box start, reach; /* at the start; at any time */
};

static const struct box nowhere = {{HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                   {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};

/* Extends a box by a point with a margin. */
static void extend_box(struct box *box, const double p[3], double by) {
    for (int c = 0; c < 3; c++) {
        box->low[c] = fmin(box->low[c], p[c] - by);
        box->high[c] = fmax(box->high[c], p[c] + by);
    }
}

static bool overlap(const struct box *a, const struct box *b) {
    bool apart = false;
    for (int c = 0; c < 3; c++)
        apart |= a->low[c] > b->high[c] || b->low[c] > a->high[c];
    return !apart;
}

static void take(const double *x, size_t n, size_t i, double p[3]) {
    for (size_t c = 0; c < 3; c++)
        p[c] = x[c * n + i];
}

/* Box of a pinned body. Inextensible springs keep each particle within its initial distance of
 * the pin. */
static void reach_from_pin(const double *x, size_t n, size_t pin, struct box *reach) {
    double from[3], squared = 0;
    take(x, n, pin, from);
    for (size_t i = 0; i < n; i++) {
        double p[3], sum = 0;
        take(x, n, i, p);
        for (int c = 0; c < 3; c++)
            sum += (p[c] - from[c]) * (p[c] - from[c]);
        squared = fmax(squared, sum);
    }
    extend_box(reach, from, sqrt(squared));
}

/* Box of all times in free fall: end of the fall, and the turning point v + g t = 0 if it is on
 * the way. */
static void free_fall_box(const struct cs_scene *scene, const struct cs_body *body,
                          double seconds, const struct box *start, struct box *reach) {
    const double *v = cs_shape_velocity(body), *g = scene->forces.gravity;
    double diagonal = 0;
    for (int c = 0; c < 3; c++)
        diagonal += (start->high[c] - start->low[c]) * (start->high[c] - start->low[c]);
    const double by = SPREAD * sqrt(diagonal);
    for (int c = 0; c < 3; c++) {
        const double end = v[c] * seconds + g[c] * seconds * seconds / 2;
        // where it turns on the way
        const double turn = v[c] * g[c] < 0 ? fmin(-v[c] / g[c], seconds) : 0;
        const double peak = v[c] * turn + g[c] * turn * turn / 2;
        reach->low[c] = start->low[c] + fmin(fmin(end, peak), 0) - by;
        reach->high[c] = start->high[c] + fmax(fmax(end, peak), 0) + by;
    }
}

/* Boxes of a body, from a copy of its start positions. */
static enum cs_status measure(const struct cs_scene *scene, const struct cs_body *body,
                              double seconds, struct body *out, struct cs_error *error) {
    const size_t n = (size_t)cs_shape_count(body);
    double *x = calloc(n, 3 * sizeof *x);
    bool *pinned = calloc(n, sizeof *pinned);
    size_t pin = n; // the last
    out->start = out->reach = nowhere;
    if (!x || !pinned) {
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %zu particles", n);
        goto done;
    }
    cs_shape_position(body, (uint32_t)n, 0, x);
    cs_shape_pin(body, (uint32_t)n, 0, x, pinned);
    for (size_t i = 0; i < n; i++) {
        double p[3];
        take(x, n, i, p);
        extend_box(&out->start, p, 0);
        pin = pinned[i] ? i : pin;
    }
    if (pin < n)
        reach_from_pin(x, n, pin, &out->reach);
    else
        free_fall_box(scene, body, seconds, &out->start, &out->reach);
done:
    free(x);
    free(pinned);
    return error->status;
}

/* Counts the pairs without contact whose boxes overlap, at the start or at any time; *first and
 * *second belong to the first pair. */
static uint32_t count_pairs(const struct cs_scene *scene, const struct body *bodies, bool start,
                            uint32_t *first, uint32_t *second) {
    uint32_t pairs = 0;
    double friction;
    for (uint32_t a = 0; a < scene->bodies.n; a++)
        for (uint32_t b = a + 1; b < scene->bodies.n; b++) {
            if (cs_scene_bodies_collide(scene, a, b, &friction))
                continue;
            if (start ? !overlap(&bodies[a].start, &bodies[b].start)
                      : !overlap(&bodies[a].reach, &bodies[b].reach))
                continue;
            if (!pairs++) {
                *first = a;
                *second = b;
            }
        }
    return pairs;
}

enum cs_status cs_overlap_warning_print(const struct cs_scene *scene, double seconds,
                                        struct cs_text *out, struct cs_error *error) {
    const uint32_t n = scene->bodies.n;
    uint32_t first = 0, second = 0;
    if (n < 2)
        return CS_OK;
    struct body *bodies = calloc(n, sizeof *bodies);
    if (!bodies)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for %u bodies", n);
    for (uint32_t b = 0; b < n && !error->status; b++)
        measure(scene, cs_scene_bodies(scene) + b, seconds, bodies + b, error);
    bool now = true;
    uint32_t pairs = error->status ? 0 : count_pairs(scene, bodies, true, &first, &second);
    if (!pairs && !error->status) {
        now = false;
        pairs = count_pairs(scene, bodies, false, &first, &second);
    }
    if (pairs)
        cs_text_add(out, "bodies[%u] and bodies[%u] ", first, second);
    if (pairs > 1)
        cs_text_add(out, "(and %u more pair%s) ", pairs - 1, pairs > 2 ? "s" : "");
    if (pairs)
        cs_text_add(
            out,
            "%s, but no contact is defined between them: they will pass through each other",
            now ? "overlap at the start" : "could collide");
    free(bodies);
    return error->status;
}
