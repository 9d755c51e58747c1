/* Trails come back bit by bit; one that breaks off or is something else gives no point. */
#include "bisect/trace_reader.h"
#include "unit.h"

#include <math.h>

enum { N = 700 };

static char *bytes;
static size_t length;

/* two points, of which one is longer than a block, with numbers that no text would bring back
 */
static void write_trail(double values[N]) {
    for (int k = 0; k < N; k++)
        values[k] = k * 0.1;
    values[1] = -0.0;
    values[2] = (double)NAN;
    values[3] = 5e-324;
    FILE *file = open_memstream(&bytes, &length);
    const struct cs_trace_record points[] = {{3, 21, 1.0 / 3, "strain limit", "x", values, N},
                                             {4, 0, 0, "energy", "E", values + 1, 1}};
    ck_assert_ptr_nonnull(file);
    cs_trace_stream_begin(file);
    cs_trace_stream_write(file, points);
    cs_trace_stream_write(file, points + 1);
    ck_assert_int_eq(fclose(file), 0);
}

TEST(points_come_back) {
    double values[N];
    struct cs_error error = {0};
    write_trail(values);
    struct cs_trace_stream trace = {.file = fmemopen(bytes, length, "r")};
    const struct cs_trace_record *record = &trace.record;
    ck_assert(cs_trace_stream_next(&trace, &error));
    ck_assert_uint_eq(record->frame, 3);
    ck_assert_uint_eq(record->step, 21);
    ck_assert_double_eq(record->t, 1.0 / 3);
    ck_assert_str_eq(record->phase, "strain limit");
    ck_assert_str_eq(record->name, "x");
    ck_assert_uint_eq(record->n, N);
    ck_assert_mem_eq(record->values, values, sizeof values);
    ck_assert(cs_trace_stream_next(&trace, &error));
    ck_assert_str_eq(record->phase, "energy");
    ck_assert_uint_eq(record->n, 1);
    ck_assert_mem_eq(record->values, values + 1, sizeof *values);
    ck_assert(!cs_trace_stream_next(&trace, &error));
    ck_assert_int_eq(error.status, CS_OK);
    fclose(trace.file);
    cs_trace_stream_finish(&trace);
    free(bytes);
}

/* points that a text of so many bytes begins with, and what is said of its end */
static int count_points(const char *text, size_t n, enum cs_status *status) {
    struct cs_error error = {0};
    struct cs_trace_stream trace = {.file = fmemopen((void *)(uintptr_t)text, n, "r")};
    int count = 0;
    while (cs_trace_stream_next(&trace, &error))
        count++;
    fclose(trace.file);
    cs_trace_stream_finish(&trace);
    *status = error.status;
    return count;
}

TEST(what_breaks_off_gives_whole_points_only) {
    double values[N];
    enum cs_status status;
    write_trail(values);
    const size_t first = length - (size_t)(N + 1) * 8;
    for (size_t n = 1; n < length; n++) {
        const int found = count_points(bytes, n, &status);
        UNIT_ASSERT_OFTEN(found <= 1 && (found == 0 || n > first));
    }
    free(bytes);
}

TEST(what_is_none_is_refused) {
    static const char *const texts[] = {
        "clothsim trail 2\n",
        "out\n",
        "clothsim trail 1\n1 2 3\n",
        "clothsim trail 1\n1 2 nan 3 a:x\n",
        "clothsim trail 1\n1 2 0.5 3 phase\n",
        "clothsim trail 1\n1 2 0.5 99999999999 a:x\n",
    };
    enum cs_status status;
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        ck_assert_int_eq(count_points(texts[k], strlen(texts[k]), &status), 0);
        ck_assert_int_eq(status, CS_ERR_FILE);
    }
}
