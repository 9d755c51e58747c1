/* Reads the report of a run for its pictures. */
#include "film/film_sheet.h"

#include "base/file.h"
#include "scene/file/json.h"
#include "session/frame_picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH_BYTES = 4096, MOST_PICTURES = 10000000 };
/* Frames a second, as scenes have them; a report may come from anywhere. */
#define FPS_MIN 1e-3
#define FPS_MAX 1e6

static double number_of(const struct cs_json *object, const char *key) {
    const struct cs_json *value = cs_json_find_kind(object, key, CS_JSON_NUMBER);
    return value ? cs_json_number(value) : 0;
}

static int32_t look_of(const struct cs_json *render) {
    const struct cs_json *look = cs_json_find_kind(render, "look", CS_JSON_TEXT);
    for (int32_t k = 0; look && cs_look_names[k]; k++)
        if (!strcmp(cs_look_names[k], cs_json_text(look)))
            return k;
    return CS_LOOK_LIT;
}

static bool is_clear(const struct cs_json *render) {
    const struct cs_json *kind =
        cs_json_find_kind(cs_json_find(render, "background"), "kind", CS_JSON_TEXT);
    return kind && !strcmp(cs_json_text(kind), "none");
}

/* false: it was not drawn. Runs of older versions gave a picture the number of its frame. */
static bool read_picture(const struct cs_json *frame, struct cs_film_picture *picture) {
    const struct cs_json *drawn = cs_json_find_kind(frame, "drawn", CS_JSON_BOOL);
    const struct cs_json *range = cs_json_find_kind(frame, "range", CS_JSON_LIST);
    if (!drawn || !cs_json_is_true(drawn))
        return false;
    *picture = (struct cs_film_picture){.frame = number_of(frame, "number")};
    const double given = number_of(frame, "picture");
    const double number = given > 0 ? given : picture->frame;
    if (!(number >= 0 && number <= MOST_PICTURES && fabs(picture->frame) <= UINT32_MAX))
        return false;
    picture->number = (uint32_t)number;
    for (uint32_t k = 0; range && k < 2 && cs_json_count(range) == 2; k++) {
        const struct cs_json *end = cs_json_at(range, k);
        picture->range[k] = cs_json_kind_of(end) == CS_JSON_NUMBER ? cs_json_number(end) : 0;
    }
    return true;
}

/* Reads the method up to its second option, a number of it with at most six digits, and its
 * cost. */
static void read_cost(const struct cs_json *root, struct cs_film_report *report) {
    const struct cs_json *method = cs_json_find_kind(root, "method", CS_JSON_TEXT);
    const char *text = method ? cs_json_text(method) : "";
    const size_t head = strcspn(text, "="), length = strcspn(text, ",");
    char *end = NULL;
    const double value = head < length ? strtod(text + head + 1, &end) : 0;
    if (end && end == text + length)
        snprintf(report->method, sizeof report->method, "%.*s=%.6g", (int)head, text, value);
    else
        snprintf(report->method, sizeof report->method, "%.*s", (int)length, text);
    report->seconds = number_of(cs_json_find(root, "seconds"), "method");
}

static enum cs_status read_pictures(const struct cs_json *root, struct cs_film_report *report,
                                    struct cs_error *error) {
    const struct cs_json *scene = cs_json_find(root, "scene"),
                         *frames = cs_json_find_kind(root, "frames", CS_JSON_LIST);
    report->fps = number_of(cs_json_find(scene, "time"), "fps");
    const struct cs_json *render = cs_json_find(scene, "render");
    report->look = look_of(render);
    report->clear = is_clear(render);
    read_cost(root, report);
    if (!frames || !(report->fps >= FPS_MIN && report->fps <= FPS_MAX))
        return CS_OK;
    report->pictures = calloc((size_t)cs_json_count(frames) + 1, sizeof *report->pictures);
    if (!report->pictures)
        return cs_fail(error, CS_ERR_MEMORY, "out of memory for the list of pictures");
    for (const struct cs_json *f = cs_json_first(frames); f; f = cs_json_next(f))
        report->n += read_picture(f, report->pictures + report->n);
    return CS_OK;
}

enum cs_status cs_film_report_read(const char *folder, struct cs_film_report *report,
                                   struct cs_error *error) {
    char path[PATH_BYTES], *text;
    size_t length;
    struct cs_json *root;
    struct cs_json_fault fault;
    *report = (struct cs_film_report){0};
    snprintf(path, sizeof path, "%.4000s/run.json", folder);
    if (cs_file_read(path, CS_JSON_BYTES_MAX, &text, &length, error))
        return error->status;
    if (cs_json_parse(text, length, &root, &fault) == CS_ERR_MEMORY)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for \"%s\"", path);
    free(text);
    if (root)
        read_pictures(root, report, error);
    cs_json_destroy(root);
    if (!error->status && report->n == 0)
        cs_fail(error, CS_ERR_FILE, "%s: expected the report of a run that drew pictures",
                path);
    if (error->status)
        cs_film_report_finish(report);
    return error->status;
}

void cs_film_report_finish(struct cs_film_report *report) {
    free(report->pictures);
    *report = (struct cs_film_report){0};
}

double cs_film_rate(const struct cs_film_report *report) {
    const struct cs_film_picture *first = report->pictures;
    const double between = report->n > 1 ? first[1].frame - first[0].frame : 1;
    return report->fps / (between > 0 ? between : 1);
}
