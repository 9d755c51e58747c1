/* Any bytes as hash.tsv and as image.tsv: rows or a refusal; a run is added once, and what is
 * written reads as the same rows. */
#include "folder.h"
#include "golden/golden_table.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

static const struct cs_golden_table kinds[] = {
    {.head = "scene\tintegrator\toverrides\tframes\thash\tbuilds\ttolerance\tstate",
     .former_head = "scene\tintegrator\toverrides\tframes\thash\tbuilds",
     .n_fields = CS_GOLDEN_HASH_FIELDS},
    {.head = "scene\tintegrator\toverrides\tframe\timage\tpixels\trenderer",
     .n_fields = CS_GOLDEN_IMAGE_FIELDS},
};

static void read_table(const struct cs_golden_table *kind, const void *bytes, size_t length) {
    const struct cs_golden_run run = {"a.json", "rk4", "-", 2};
    struct cs_golden_table table = *kind, again = *kind;
    struct cs_error error = {0};
    fuzz_write("table.tsv", bytes, length);
    const enum cs_status status =
        cs_golden_table_read(&table, fuzz_folder, "table.tsv", false, &error);
    CS_ASSERT(status == error.status);
    if (status)
        CS_ASSERT(status == CS_ERR_FILE && strstr(error.message, "table.tsv"));
    else {
        struct cs_golden_row *row = cs_golden_table_add(&table, &run);
        CS_ASSERT(row == cs_golden_table_add(&table, &run) && row->run.frames == 2);
        if (!row->image)
            cs_golden_table_name_states(&table, row);
        row->hash = row->hash ? row->hash : "0";
        row->note = row->note ? row->note : "any";
        CS_ASSERT(!cs_golden_table_write(&table, &error));
        CS_ASSERT(!cs_golden_table_read(&again, fuzz_folder, "table.tsv", false, &error));
        CS_ASSERT(again.n == table.n);
        for (uint32_t k = 0; k < table.n; k++)
            CS_ASSERT(!strcmp(again.rows[k].run.scene, table.rows[k].run.scene) &&
                      again.rows[k].run.frames == table.rows[k].run.frames &&
                      !strcmp(again.rows[k].hash, table.rows[k].hash));
        cs_golden_table_close(&again);
    }
    cs_golden_table_close(&table);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    for (int k = 0; k < 2; k++)
        read_table(kinds + k, bytes, length);
    return 0;
}
