/* Any bytes as run.json of a folder whose pictures become a film: pictures with numbers that
 * names of files have, a finite rate, or a refusal. */
#include "film/film_sheet.h"
#include "folder.h"

#include <math.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    struct cs_film_report report;
    struct cs_error error = {0};
    fuzz_write("run.json", bytes, length);
    const enum cs_status status = cs_film_report_read(fuzz_folder, &report, &error);
    CS_ASSERT(status == error.status && !status == !!report.n);
    if (status)
        CS_ASSERT(status == CS_ERR_FILE && strstr(error.message, "run.json") &&
                  !report.pictures);
    else {
        const double rate = cs_film_rate(&report);
        CS_ASSERT(rate > 0 && isfinite(rate) && report.look >= 0);
    }
    for (uint32_t k = 0; k < report.n; k++) {
        const struct cs_film_picture *picture = report.pictures + k;
        CS_ASSERT(picture->number <= 10000000 && isfinite(picture->frame));
        CS_ASSERT(isfinite(picture->range[0]) && isfinite(picture->range[1]));
    }
    cs_film_report_finish(&report);
    return 0;
}
