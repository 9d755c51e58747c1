#include "study/compare/compare_report.h"

#include "base/file.h"
#include "study/compare/compare_plot.h"

#include <stdio.h>
#include <string.h>

static enum cs_status draw(const struct cs_compare *compare, const char *name, const char *x,
                           bool *drawn, struct cs_error *error) {
    char title[400];
    snprintf(title, sizeof title, "%.255s, %.4g s, %u particles", compare->scene, compare->time,
             compare->particles);
    const struct cs_plot_settings settings = {
        .cells = compare->sweep.cells,
        .n = compare->sweep.n,
        .x = cs_column_find(x),
        // beyond the horizon there is energy to compare
        .y = cs_column_find(compare->yardstick.pointwise ? "error" : "energy_error"),
        .title = title,
        .name = name};
    return cs_plot_write(&settings, compare->settings->folder, drawn, error);
}

static enum cs_status write_text(const struct cs_compare *compare, const char *name,
                                 const struct cs_text *text, struct cs_error *error) {
    struct cs_text path = {0};
    cs_text_add(&path, "%s/%s", compare->settings->folder, name);
    if (text->failed || path.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %s", name);
    else
        cs_file_write(cs_text_get(&path), cs_text_get(text), text->length, error);
    cs_text_finish(&path);
    return error->status;
}

enum cs_status cs_compare_write_report(const struct cs_compare *compare,
                                       struct cs_error *error) {
    struct cs_ranking ranking;
    struct cs_text json = {0}, markdown = {0};
    bool drawn = false;
    if (cs_ranking_make(&ranking, compare, error))
        return error->status;
    // two families that disagree leave nothing to draw errors against
    if (compare->yardstick.agree && !draw(compare, "error_time", "cpu", &drawn, error))
        draw(compare, "error_work", "work", &drawn, error);
    cs_compare_print_json(compare, &ranking, &json);
    cs_compare_print_markdown(compare, &ranking, drawn, &markdown);
    if (!error->status && !write_text(compare, "compare.json", &json, error))
        write_text(compare, "compare.md", &markdown, error);
    cs_text_finish(&json);
    cs_text_finish(&markdown);
    cs_ranking_finish(&ranking);
    return error->status;
}
