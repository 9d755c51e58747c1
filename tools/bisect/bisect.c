/* Runs two programs side by side and finds the first number that differs. */
#include "bisect/bisect.h"

#include "bisect/trace_reader.h"

#include "shared/subprocess.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One running program and its trace. */
struct side {
    const struct cs_bisect_side *asked;
    struct cs_subprocess process;
    struct cs_trace_stream trail;
    bool there; /* the trail has a point */
};

/* Starts a program with --trace appended to its command. trace: the frame, or the level of
 * detail. */
static enum cs_status start(struct side *side, const struct cs_bisect_side *asked,
                            const char *trace, struct cs_error *error) {
    const char **arguments = calloc(asked->n_arguments + 3u, sizeof *arguments);
    *side = (struct side){.asked = asked};
    if (!arguments)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for a command");
    memcpy(arguments, asked->arguments, asked->n_arguments * sizeof *arguments);
    arguments[asked->n_arguments] = "--trace";
    arguments[asked->n_arguments + 1] = trace;
    if (!cs_subprocess_open(&side->process, ".", arguments, 1, error))
        side->trail.file = side->process.output;
    free(arguments);
    return error->status;
}

/* True if two numbers have equal bits or differ by at most the tolerance. With a tolerance two
 * NAN are equal too. */
static bool is_same(double a, double b, double tolerance) {
    return !memcmp(&a, &b, sizeof a) || fabs(a - b) <= tolerance ||
           (tolerance > 0 && isnan(a) && isnan(b));
}

/* Compares two records of n numbers. The loop runs backwards: `first` ends at the lowest index.
 */
static void compare_values(struct cs_bisect_difference *found, const double *a, const double *b,
                           double tolerance) {
    /* most are equal: asked once */
    if (!memcmp(a, b, found->n * sizeof *a))
        return;
    for (size_t k = found->n; k-- > 0;)
        if (!is_same(a[k], b[k], tolerance)) {
            found->first = k;
            found->count++;
            found->largest = fmax(found->largest, fabs(a[k] - b[k]));
        }
    found->exists = found->values_differ = found->count > 0;
    if (found->exists) {
        found->values[0] = a[found->first];
        found->values[1] = b[found->first];
    }
}

/* Describes a trace record. */
static void print_point(const struct side *side, char out[120]) {
    const struct cs_trace_record *record = &side->trail.record;
    if (!side->there)
        snprintf(out, 120, "nothing more");
    else if (!strcmp(record->phase, "start") || !strcmp(record->phase, "frame"))
        snprintf(out, 120, "%s %" PRIu32 " at t = %.17g s, %zu numbers of %s", record->phase,
                 record->frame, record->t, record->n, record->name);
    else
        snprintf(
            out, 120, "frame %" PRIu32 ", step %" PRIu64 ", %s %s at t = %.17g s, %zu numbers",
            record->frame, record->step, record->phase, record->name, record->t, record->n);
}

/* True if two records describe the same number of the same phase. */
static bool is_same_point(const struct side sides[2], double tolerance) {
    const struct cs_trace_record *a = &sides[0].trail.record, *b = &sides[1].trail.record;
    return sides[0].there == sides[1].there && a->frame == b->frame && a->step == b->step &&
           is_same(a->t, b->t, tolerance) && a->n == b->n && !strcmp(a->phase, b->phase) &&
           !strcmp(a->name, b->name);
}

/* Compares the two current records and describes a difference. */
static void compare(const struct side sides[2], double tolerance,
                    struct cs_bisect_difference *found) {
    const struct side *side = sides + !sides[0].there;
    const struct cs_trace_record *record = &side->trail.record;
    *found = (struct cs_bisect_difference){
        .frame = record->frame, .step = record->step, .t = record->t, .n = record->n};
    snprintf(found->phase, sizeof found->phase, "%s", record->phase);
    snprintf(found->name, sizeof found->name, "%.15s", record->name);
    if (is_same_point(sides, tolerance)) {
        compare_values(found, sides[0].trail.values, sides[1].trail.values, tolerance);
        return;
    }
    found->exists = true;
    for (int k = 0; k < 2; k++)
        print_point(sides + k, found->value_b[k]);
}

/* Reads the next record of a side. The number of steps belongs to the method: states of frames
 * are compared without it. */
static void take_point(struct side *side, bool states, struct cs_error *error) {
    struct cs_error said = {0};
    side->there = !error->status && cs_trace_stream_next(&side->trail, &said);
    if (said.status)
        cs_fail(error, said.status, "%s: %s", side->asked->name, said.message);
    if (states && side->there)
        side->trail.record.step = 0;
}

/* The status of an exit code of clothsim's failures, which it has told; else CS_OK. */
static enum cs_status status_of(int code) {
    const enum cs_status status = code < CS_ERR_USAGE ? CS_OK : (enum cs_status)code;
    return cs_status_exit_code(status) == code ? status : CS_OK;
}

/* Closes a program. One that ended by itself has reported why: without a trace there is nothing
 * to add, unless it is no clothsim. */
static void end(struct side *side, struct cs_bisect_difference *found, int k,
                struct cs_error *error) {
    const bool wrote = side->trail.values;
    const bool ended = !side->there;
    if (!side->process.pid)
        return;
    const int code = cs_subprocess_close(&side->process);
    if (!wrote && !error->status && status_of(code))
        cs_fail(error, status_of(code), "%s", "");
    else if (!wrote && !error->status)
        cs_fail(error, CS_ERR_FILE, "%s: %s wrote no trace, exit code %d", side->asked->name,
                side->asked->arguments[0], code);
    else if (ended && code != 0 && !found->exists)
        cs_fail(error, status_of(code) ? status_of(code) : CS_ERR_MODULE,
                "%s ended with exit code %d after frame %" PRIu32
                ": both are equal up to there",
                side->asked->name, code, side->trail.record.frame);
    else if (found->exists && !found->values_differ && ended)
        snprintf(found->value_b[k], sizeof found->value_b[k], "its end, with exit code %d",
                 code);
    cs_trace_stream_finish(&side->trail);
}

/* Runs both programs once, up to the first difference. */
static enum cs_status run_both(const struct cs_bisect_settings *settings, const char *trace,
                               struct cs_bisect *bisect, struct cs_bisect_difference *found,
                               struct cs_error *error) {
    struct side sides[2] = {{0}};
    const bool states = found == &bisect->state_difference;
    // B starts once A has begun: what both would refuse is said once
    for (int k = 0; k < 2 && !error->status && (k == 0 || sides[0].there); k++)
        if (!start(sides + k, settings->sides + k, trace, error))
            take_point(sides + k, states, error);
    while (!error->status && (sides[0].there || sides[1].there)) {
        compare(sides, settings->tolerance, found);
        if (found->exists)
            break;
        if (states)
            bisect->n_equal_frames = found->frame;
        if (settings->stop && *settings->stop)
            cs_fail(error, CS_ERR_INTERRUPT, "interrupted; equal up to frame %" PRIu32,
                    bisect->n_equal_frames);
        take_point(&sides[0], states, error);
        take_point(&sides[1], states, error);
    }
    end(&sides[0], found, 0, error);
    end(&sides[1], found, 1, error);
    return error->status;
}

enum cs_status cs_bisect_run(struct cs_bisect *bisect,
                             const struct cs_bisect_settings *settings,
                             struct cs_error *error) {
    char frame[16];
    *bisect = (struct cs_bisect){0};
    if (run_both(settings, "frames", bisect, &bisect->state_difference, error) ||
        !bisect->state_difference.exists)
        return error->status;
    /* the start is not computed; an early end is in the next frame */
    if (!bisect->state_difference.frame)
        return CS_OK;
    snprintf(frame, sizeof frame, "%" PRIu32, bisect->state_difference.frame);
    return run_both(settings, frame, bisect, &bisect->first_difference, error);
}

/* "0.1 and 0.2: 3 units in the last place apart". Doubles of one sign are ordered as their bits
 * are as integers, so the difference of the integers counts the doubles in between. */
static void print_values(const double values[2], struct cs_text *out) {
    int64_t bits[2];
    memcpy(bits, values, sizeof bits);
    const uint64_t apart = bits[0] > bits[1] ? (uint64_t)bits[0] - (uint64_t)bits[1]
                                             : (uint64_t)bits[1] - (uint64_t)bits[0];
    cs_text_add(out, "A has %.17g, B has %.17g", values[0], values[1]);
    if (signbit(values[0]) == signbit(values[1]) && apart < 1000000)
        cs_text_add(out, ", %" PRIu64 " unit%s in the last place apart", apart,
                    apart == 1 ? "" : "s");
}

/* Particle and direction of a number, from its index in (3,n). */
static void print_position(const struct cs_bisect_difference *d, struct cs_text *out) {
    const size_t particles = d->n / 3;
    /* a single number, or weights, belong to no particle */
    if (d->n % 3 || d->n <= 3) {
        cs_text_add(out, "%s[%zu]: ", d->name, d->first);
        return;
    }
    cs_text_add(out, "particle %zu, %s along %c: ", d->first % particles, d->name,
                "xyz"[d->first / particles]);
}

void cs_bisect_print(const struct cs_bisect_difference *d, struct cs_text *out) {
    if (!d->values_differ) {
        cs_text_add(out, "A reaches %s\nB reaches %s\n", d->value_b[0], d->value_b[1]);
        return;
    }
    print_position(d, out);
    print_values(d->values, out);
    cs_text_add(out, "\n%zu of %zu numbers differ there, by at most %.3g\n", d->count, d->n,
                d->largest);
}
