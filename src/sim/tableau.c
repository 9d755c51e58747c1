/* tableau.c - reads the coefficients of a Runge-Kutta method from a JSON file: name, order,
 * source, A (a row for each stage), b, and perhaps embedded and c. */
#include "base/file.h"
#include "scene/file/json_context.h"
#include "scene/table_rows.h"
#include "sim/module.h"

#include <stdlib.h>
#include <string.h>

/* A file of 35 stages has 20 kB. */
enum { FILE_BYTES_MAX = 1 << 20, ORDER_MAX = 20 };

/* Sums of coefficients that were rounded to doubles are off by less. */
#define ROUNDING 1e-12

/* A coefficient as the file has it: a number, or a fraction as text. */
struct entry {
    double value;
    char fraction[CS_TEXT_MAX];
};
struct row {
    struct cs_list entries;
};
struct file {
    char name[CS_TEXT_MAX], source[CS_TEXT_MAX];
    int64_t order;
    struct cs_list A, b, c, embedded;
};

static const struct cs_option entry_rows[] = {
    REAL(struct entry, value, "", ABSENT, -BIG, BIG, "a number"),
    TEXT(struct entry, fraction, "such as 5/9")};
static const struct cs_table entry_table = {ROWS(entry_rows), .size = sizeof(struct entry),
                                            .shorthand_text = "fraction",
                                            .shorthand_number = "value"};
static const struct cs_option row_rows[] = {
    LIST(struct row, entries, entry_table, "numbers or fractions")};
static const struct cs_table row_table = {ROWS(row_rows), .size = sizeof(struct row),
                                          .shorthand_list = "entries"};
static const struct cs_option file_rows[] = {
    TEXT(struct file, name, "of the method"),
    INT(struct file, order, "", 0, 1, ORDER_MAX, "of the method"),
    TEXT(struct file, source, "of the coefficients"),
    LIST(struct file, A, row_table, "a row for each stage"),
    LIST(struct file, b, entry_table, "weights of the stages"),
    LIST(struct file, c, entry_table, "times of the stages, the sums of A"),
    LIST(struct file, embedded, entry_table, "weights of the method of lower order")};
static const struct cs_table file_table = {ROWS(file_rows), .size = sizeof(struct file)};

/* A file that is read. */
struct reading {
    struct cs_json_context context;
    struct cs_json *root;
    struct cs_tableau *out;
};

/* The value at a path, which messages then name. */
static const struct cs_json *at(struct reading *reading, const char *path) {
    snprintf(reading->context.path, sizeof reading->context.path, "%s", path);
    reading->context.path_length = strlen(reading->context.path);
    return cs_json_nearest(reading->root, path);
}

/* Sets p and q, both exact where their quotient is not. */
static bool parse(const struct entry *entry, double *p, double *q) {
    char text[CS_TEXT_MAX];
    memcpy(text, entry->fraction, sizeof text);
    char *slash = strchr(text, '/');
    if (slash)
        *slash++ = 0;
    *p = entry->value, *q = 1;
    return (!*entry->fraction || cs_parse_real(text, p)) &&
           (!slash || cs_parse_real(slash, q)) && fabs(*p / *q) <= BIG;
}

/* Takes a list of which the first n numbers may differ from 0. Their sum is *sum, unless that
 * is NAN, which is then replaced. */
static enum cs_status take(struct reading *reading, const char *path, int n,
                           const struct cs_list *list, double *sum, double *out) {
    double p, q, found = 0;
    for (int k = 0; k < (int)list->n; k++) {
        const bool good = parse((const struct entry *)list->items + k, &p, &q);
        if (!good || (k >= n && p != 0)) {
            char place[32];
            snprintf(place, sizeof place, "%s[%d]", path, k);
            return cs_json_context_fail_type(
                &reading->context, at(reading, place),
                good ? "0: there is no such stage, or it follows"
                     : "a number or a fraction as text, at most 10^9");
        }
        if (k < n)
            found += out[k] = p / q;
    }
    if (fabs(found - *sum) > ROUNDING)
        return cs_json_context_fail(&reading->context, at(reading, path), false,
                                    "found numbers whose sum is %.12g, expected %.12g", found,
                                    *sum);
    *sum = isnan(*sum) ? found : *sum;
    return CS_OK;
}

/* Takes A, whose rows have the sums c. */
static enum cs_status take_stages(struct reading *reading, const struct row *rows,
                                  uint64_t *traits) {
    struct cs_tableau *out = reading->out;
    for (int i = 0; i < out->stages; i++) {
        char path[16];
        snprintf(path, sizeof path, "A[%d]", i);
        if (take(reading, path, i + 1, &rows[i].entries, out->c + i, out->a[i]))
            return reading->context.error->status;
        if (out->a[i][i] < 0)
            return cs_json_context_fail_type(&reading->context, at(reading, path),
                                             "no number below 0 on the diagonal");
        *traits |= out->a[i][i] > 0 ? CS_IMPLICIT : 0;
    }
    return CS_OK;
}

static enum cs_status take_all(struct reading *reading, const struct file *file,
                               uint64_t *traits) {
    struct cs_tableau *out = reading->out;
    double lower[CS_TABLEAU_STAGES], p, q, one = 1, any = ABSENT;
    const int n = out->stages = (int)file->b.n;
    out->order = (int)file->order;
    if (!*file->name || !*file->source || !out->order)
        return cs_json_context_fail(&reading->context, at(reading, ""), false,
                                    "missing key \"%s\"",
                                    !*file->name  ? "name"
                                    : !out->order ? "order"
                                                  : "source");
    if (n < 1 || n > CS_TABLEAU_STAGES || (int)file->A.n != n)
        return cs_json_context_fail(
            &reading->context, at(reading, ""), false,
            "found %u rows of A and %d numbers of b, expected as many, 1 to %d", file->A.n, n,
            CS_TABLEAU_STAGES);
    for (int k = 0; k < n && !file->c.n; k++)
        out->c[k] = ABSENT;
    if (take(reading, "b", n, &file->b, &one, out->b) ||
        take(reading, "c", n, &file->c, &any, out->c) ||
        (file->embedded.n && take(reading, "embedded", n, &file->embedded, &one, lower)))
        return reading->context.error->status;
    for (int k = 0; k < n && file->embedded.n; k++) {
        out->difference[k] = out->b[k];
        if (k >= (int)file->embedded.n ||
            !parse((const struct entry *)file->b.items + k, &p, &q))
            continue;
        // p/q - r/s, rounded once where the products are exact
        double r, s;
        if (parse((const struct entry *)file->embedded.items + k, &r, &s))
            out->difference[k] = (p * s - r * q) / (q * s);
    }
    bool differs = !file->embedded.n;
    for (int k = 0; k < n; k++)
        differs |= out->difference[k] != 0;
    if (!differs)
        return cs_json_context_fail(&reading->context, at(reading, "embedded"), false,
                                    "found b again, expected a method of lower order");
    *traits = file->embedded.n ? CS_ADAPTIVE : 0;
    return take_stages(reading, file->A.items, traits);
}

enum cs_status cs_tableau_read(const char *path, struct cs_program_description *texts,
                               struct cs_tableau *out, struct cs_error *error) {
    struct cs_arena arena = {0};
    struct reading reading = {{.name = path, .arena = &arena, .error = error}, NULL, out};
    struct file file = {0};
    char *text;
    size_t length;
    if (cs_file_read(path, FILE_BYTES_MAX, &text, &length, error))
        return error->status;
    reading.context.text = text;
    if (!cs_json_parse_named(path, text, length, &reading.root, error) &&
        !cs_table_read(&reading.context, reading.root, &file_table, &file) &&
        !take_all(&reading, &file, &texts->traits)) {
        snprintf(texts->name, sizeof texts->name, "%.63s", file.name);
        snprintf(texts->source, sizeof texts->source, "%s", file.source);
        snprintf(texts->summary, sizeof texts->summary,
                 "Runge-Kutta method of %d stages by a tableau", out->stages);
        texts->order = texts->order_damped = (uint64_t)out->order;
    }
    cs_json_destroy(reading.root);
    cs_arena_finish(&arena);
    free(text);
    // a fault of a method, not of the scene
    if (error->status == CS_ERR_SCENE)
        error->status = CS_ERR_MODULE;
    return error->status;
}
