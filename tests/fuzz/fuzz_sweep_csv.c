/* Any bytes as sweep.csv: rows or a refusal, and what is written again reads as the same rows.
 * Once as they are, and once with the checks of the rows put right. */
#include "folder.h"
#include "sweep/sweep_cell.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

static enum cs_status read_rows(struct cs_sweep_rows *rows, struct cs_error *error) {
    if (cs_sweep_rows_open(rows, fuzz_folder, error) ||
        cs_sweep_rows_read(rows, fuzz_folder, error))
        CS_ASSERT((error->status == CS_ERR_FILE || error->status == CS_ERR_USAGE) &&
                  strstr(error->message, "sweep.csv"));
    return error->status;
}

static void read_table(const char *bytes, size_t length, bool unchecked) {
    struct cs_sweep_rows rows = {.unchecked = unchecked}, again = {0};
    struct cs_error error = {0};
    fuzz_write("sweep.csv", bytes, length);
    if (!read_rows(&rows, &error) && rows.names.length) {
        const uint32_t n = cs_sweep_rows_count(&rows);
        CS_ASSERT(!cs_sweep_rows_write(&rows, &error) && !read_rows(&again, &error));
        CS_ASSERT(cs_sweep_rows_count(&again) == n);
        for (uint32_t k = 0; k < rows.n; k++)
            if (rows.lines[k]) {
                CS_ASSERT(k < again.n && again.lines[k]);
                CS_ASSERT(!strcmp(rows.lines[k], again.lines[k]));
                CS_ASSERT(cs_sweep_row_key(rows.lines[k]));
            }
        cs_sweep_rows_drop_failed(&rows, 1);
        CS_ASSERT(cs_sweep_rows_count(&rows) <= n);
    }
    cs_sweep_rows_finish(&rows);
    cs_sweep_rows_finish(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    struct cs_text signed_ = {0};
    read_table((const char *)bytes, length, true);
    fuzz_sign_rows((const char *)bytes, length, &signed_);
    read_table(cs_text_get(&signed_), signed_.length, false);
    cs_text_finish(&signed_);
    return 0;
}
