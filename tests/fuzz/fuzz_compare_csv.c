/* Any bytes as compare.csv: rows or a refusal; what merge writes of them reads as the same
 * rows, and they can be drawn, ranked and told of. Once as they are, and once with the checks
 * of the rows put right. */
#include "base/file.h"
#include "folder.h"
#include "study/compare/compare.h"

#include <math.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

static void draw(const struct cs_cell *cells, uint32_t n) {
    const struct cs_plot_settings settings = {.cells = cells,
                                              .n = n,
                                              .x = cs_column_find("work"),
                                              .second = cs_column_find("cpu"),
                                              .y = cs_column_find("error"),
                                              .width = CS_WIDTH_PAGE};
    struct cs_diagram plot;
    struct cs_tick ticks[CS_TICKS_MAX];
    struct cs_error error = {0};
    CS_ASSERT(!cs_plot_make(&plot, &settings, &error));
    for (uint32_t k = 0; k < plot.n_panels; k++) {
        const struct cs_panel *panel = plot.panels + k;
        const struct cs_plot_axis *axes[] = {&panel->x, &panel->y};
        for (int a = 0; a < 2; a++) {
            CS_ASSERT(axes[a]->range[0] < axes[a]->range[1]);
            CS_ASSERT(cs_plot_axis_ticks(axes[a], ticks) <= CS_TICKS_MAX);
        }
        for (uint32_t s = 0; s < panel->n_series; s++)
            for (uint32_t p = 0; p < panel->series[s].n; p++)
                CS_ASSERT(isfinite(cs_plot_axis_at(&panel->x, panel->series[s].points[p].x)));
    }
    cs_plot_finish(&plot);
}

/* All rows are of this machine, which alone is ranked. */
static void rank(struct cs_cell *cells, uint32_t n) {
    const struct cs_compare_settings settings = {.run = {.frames = 1}};
    struct cs_compare compare = {.settings = &settings,
                                 .reference = {.families_agree = true, .pointwise = true},
                                 .cells = {.cells = cells, .n = n},
                                 .fps = 60};
    struct cs_ranking ranking;
    struct cs_text text = {0};
    struct cs_error error = {0};
    for (uint32_t k = 0; k < n; k++)
        *cells[k].machine = 0;
    CS_ASSERT(!cs_ranking_make(&ranking, &compare, &error));
    CS_ASSERT(ranking.n <= CS_RANKS_MAX);
    cs_verdict_print(&ranking, "- ", &compare, &text);
    cs_compare_warn(&compare, "- ", &text);
    for (uint32_t k = 0; k < n; k++)
        cs_table_add_row(&compare, cells + k, &text);
    cs_table_add_series(&compare, true, &text);
    cs_text_finish(&text);
    cs_ranking_finish(&ranking);
}

/* Merges a folder into another one; false: it is refused. */
static bool merge(const char *from, const char *to, uint32_t n) {
    char part[4200], out[4200];
    const char *const parts[] = {part};
    uint32_t n_merged;
    struct cs_error error = {0};
    snprintf(part, sizeof part, "%s", fuzz_path(from));
    snprintf(out, sizeof out, "%s", fuzz_path(to));
    if (cs_compare_results_merge(parts, 1, out, true, &n_merged, &error))
        CS_ASSERT(error.status == CS_ERR_USAGE);
    CS_ASSERT(n_merged <= n);
    return !error.status && n_merged;
}

/* What merge writes is read and written again as it is. */
static void merge_twice(uint32_t n) {
    char *bytes[2];
    size_t length[2];
    struct cs_error error = {0};
    unlink(fuzz_path("one/compare.csv"));
    unlink(fuzz_path("two/compare.csv"));
    if (!merge(".", "one", n) || !merge("one", "two", n))
        return;
    CS_ASSERT(!cs_file_read(fuzz_path("one/compare.csv"), 1 << 24, bytes, length, &error));
    CS_ASSERT(
        !cs_file_read(fuzz_path("two/compare.csv"), 1 << 24, bytes + 1, length + 1, &error));
    CS_ASSERT(length[0] == length[1] && !memcmp(bytes[0], bytes[1], length[0]));
    free(bytes[0]);
    free(bytes[1]);
}

static void read_table(const char *bytes, size_t length, bool unchecked) {
    struct cs_cell *cells;
    uint32_t n;
    struct cs_error error = {0};
    const char *path = fuzz_write("compare.csv", bytes, length);
    if (cs_csv_read(path, unchecked, &cells, &n, &error))
        CS_ASSERT(error.status == CS_ERR_FILE && strstr(error.message, "compare.csv") && !n);
    else {
        merge_twice(n);
        draw(cells, n);
        rank(cells, n);
    }
    free(cells);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    struct cs_text signed_ = {0};
    read_table((const char *)bytes, length, true);
    fuzz_sign_rows((const char *)bytes, length, &signed_);
    read_table(cs_text_get(&signed_), signed_.length, false);
    cs_text_finish(&signed_);
    return 0;
}
