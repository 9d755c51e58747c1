/* Collects the rows of a check as JSON, JUnit and HTML. */
#include "golden/golden_report.h"

#include "base/file.h"
#include "base/json_writer.h"

#include <string.h>

static bool is_different(const struct cs_golden_row *row) {
    return row->message.length > 0 && (row->added || !row->finding.skipped);
}

bool cs_golden_is_failure(const struct cs_golden *golden, const struct cs_golden_row *row) {
    return is_different(row) && (row->failed || !golden->accept_all);
}

const char *cs_golden_verdict(const struct cs_golden *golden, const struct cs_golden_row *row) {
    if (row->failed)
        return "FAILED";
    if (is_different(row) && golden->accept_all)
        return golden->add.scene ? "added" : "accepted";
    return row->finding.skipped ? "skip" : is_different(row) ? "DIFFERS" : "ok";
}

void cs_golden_add_name(const struct cs_golden_row *row, struct cs_text *out) {
    const struct cs_golden_run *run = &row->run;
    if (row->image)
        cs_text_add(out, "image %s ", row->image);
    cs_text_add(out, "%s", run->scene);
    if (strcmp(run->integrator, "-"))
        cs_text_add(out, "  %s", run->integrator);
    if (strcmp(run->overrides, "-"))
        cs_text_add(out, "  %s", run->overrides);
    cs_text_add(out, "  frame %u", run->frames);
}

/* Where the positions are off, as members of the row's object. */
static void add_where(const struct cs_golden_where *where, struct cs_text *out) {
    const struct cs_golden_offset *first = &where->first, *last = &where->last;
    cs_json_write(out,
                  ", 'where': {'first_hash': %u, 'frame': %u, 'particle': %u, 'distance': %g, "
                  "'last_frame': %u, 'last_particle': %u, 'last_distance': %g, 'off': %u}",
                  where->first_hash, first->frame, first->particle, first->distance,
                  last->frame, last->particle, last->distance, last->count);
}

static void add_json(const struct cs_golden_row *row, const char *verdict,
                     struct cs_text *out) {
    cs_json_write(out,
                  ",\n    {'verdict': %s, 'image': %s, 'scene': %s, 'integrator': %s, "
                  "'overrides': %s, 'message': %s, 'frame': %u, 'seconds': %g",
                  verdict, row->image ? row->image : "", row->run.scene, row->run.integrator,
                  row->run.overrides, cs_text_get(&row->message), row->run.frames,
                  row->finding.seconds);
    if (row->finding.where.n)
        add_where(&row->finding.where, out);
    cs_text_add(out, "}");
}

/* Adds a test case of a JUnit report, with the message of a failure or a skip. */
static void add_junit(const struct cs_golden_row *row, const char *name, const char *element,
                      struct cs_text *out) {
    cs_text_add(out, "<testcase classname=\"clothsim golden\" name=\"");
    cs_text_add_html(out, name);
    cs_text_add(out, "\" file=\"");
    cs_text_add_html(out, row->run.scene);
    cs_text_add(out, "\" time=\"%.3f\">", row->finding.seconds);
    if (element) {
        cs_text_add(out, "<%s message=\"", element);
        cs_text_add_html(out, cs_text_get(&row->message));
        cs_text_add(out, "\"/>");
    }
    cs_text_add(out, "</testcase>\n");
}

/* Adds a picture as part of the page. */
static void add_picture(const struct cs_golden *golden, const struct cs_golden_row *row,
                        const char *ending, const char *caption, struct cs_text *out) {
    char path[1024];
    cs_golden_image_path(golden->folder, row, ending, path);
    if (cs_file_add_figure(path, caption, out))
        cs_text_add(out, "%s</figcaption></figure>\n", caption);
}

/* A line of the table of a row that differs. */
static void add_offset(const char *name, const struct cs_golden_offset *offset, uint32_t n,
                       struct cs_text *out) {
    cs_text_add(out, "<tr><td>%s<td>%u<td>%u<td>%.3g m<td>%u of %u</tr>\n", name, offset->frame,
                offset->particle, offset->distance, offset->count, n);
}

/* Adds a section for a row that is not equal, and a line for any other. */
static void add_html(const struct cs_golden *golden, const struct cs_golden_row *row,
                     const char *name, struct cs_text *out) {
    const struct cs_golden_where *where = &row->finding.where;
    const bool is_bad = is_different(row);
    cs_text_add(out, is_bad ? "<section class=bad><h2>" : "<p>");
    cs_text_add(out, "%s: ", cs_golden_verdict(golden, row));
    cs_text_add_html(out, name);
    cs_text_add(out, is_bad ? "</h2>\n<p>" : " ");
    cs_text_add_html(out, cs_text_get(&row->message));
    cs_text_add(out, "</p>\n");
    // side by side, as far as a window is wide
    if (is_bad && row->image) {
        add_picture(golden, row, ".png", "expected", out);
        add_picture(golden, row, ".actual.png", "actual", out);
        add_picture(golden, row, ".difference.png", "where: 16 times the difference", out);
    }
    if (is_bad && where->first.frame) {
        cs_text_add(out, "<table><tr><th><th>frame<th>particle<th>off by<th>particles</tr>\n");
        add_offset("first", &where->first, where->n, out);
        add_offset("last", &where->last, where->n, out);
        cs_text_add(out, "</table>\n");
    }
    if (is_bad)
        cs_text_add(out, "</section>\n");
}

void cs_golden_report_add(struct cs_golden_report *report, const struct cs_golden *golden,
                          const struct cs_golden_row *row) {
    struct cs_text name = {0};
    cs_golden_add_name(row, &name);
    report->seconds += row->finding.seconds;
    add_json(row, cs_golden_verdict(golden, row), &report->json);
    add_junit(row, cs_text_get(&name),
              cs_golden_is_failure(golden, row) ? "failure"
              : row->finding.skipped            ? "skipped"
                                                : NULL,
              &report->junit);
    add_html(golden, row, cs_text_get(&name), &report->html);
    report->json.failed |= name.failed;
    cs_text_finish(&name);
}

void cs_golden_report_print_json(const struct cs_golden_report *report,
                                 const struct cs_golden *golden, struct cs_text *out) {
    cs_json_write(out,
                  "{\n  'agree': %u, 'differ': %u, 'accepted': %u, 'skipped': %u,\n"
                  "  'rows': [",
                  golden->passed, golden->failed, golden->accepted, golden->skipped);
    cs_text_add(out, "%s\n  ]\n}\n", cs_text_get(&report->json));
    out->failed |= report->json.failed;
}

void cs_golden_report_print_junit(const struct cs_golden_report *report,
                                  const struct cs_golden *golden, struct cs_text *out) {
    cs_text_add(
        out,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"clothsim golden\" "
        "tests=\"%u\" failures=\"%u\" skipped=\"%u\" time=\"%.3f\">\n%s</testsuite>\n",
        golden->passed + golden->failed + golden->accepted + golden->skipped, golden->failed,
        golden->skipped, report->seconds, cs_text_get(&report->junit));
    out->failed |= report->junit.failed;
}

void cs_golden_report_print_html(const struct cs_golden_report *report,
                                 const struct cs_golden *golden, struct cs_text *out) {
    cs_text_add(out,
                "<!DOCTYPE html>\n<html lang=\"en\"><meta charset=\"utf-8\">"
                "<title>clothsim golden</title>\n<style>body{font-family:sans-serif;margin:2em}"
                "p{margin:.2em 0}h2{font-size:1em}.bad{border-left:.3em solid #b00;"
                "padding-left:1em;margin:1em 0}figure{display:inline-block;margin:.5em}"
                "img{min-width:320px;image-rendering:pixelated}td,th{padding:0 1em;"
                "text-align:right}</style>\n"
                "<h1>%u agree, %u differ, %u accepted, %u skipped</h1>\n%s</html>\n",
                golden->passed, golden->failed, golden->accepted, golden->skipped,
                cs_text_get(&report->html));
    out->failed |= report->html.failed;
}

void cs_golden_report_finish(struct cs_golden_report *report) {
    cs_text_finish(&report->json);
    cs_text_finish(&report->junit);
    cs_text_finish(&report->html);
}
