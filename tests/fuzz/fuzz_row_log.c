/* Any rows, a byte 0, and any bytes as the log of a killed run: it goes on after the rows of
 * its record where the file begins with them, and is refused elsewhere. */
#include "base/file.h"
#include "cli/run/row_log.h"
#include "folder.h"

#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length);

static void add(struct cs_row_log *log, const char *line, size_t length) {
    struct cs_text row = {0};
    struct cs_error error = {0};
    cs_text_add(&row, "%.*s\n", (int)length, line);
    CS_ASSERT(!cs_row_log_add(log, &row, &error));
}

/* adds the rows, and leaves their record: the log is broken off */
static void leave(const char *rows, size_t length, struct cs_serialiser *serialiser) {
    struct cs_row_log log = {0};
    struct cs_error error = {0};
    CS_ASSERT(!cs_row_log_create(&log, fuzz_path("log"), &error));
    for (const char *at = rows, *end; (end = memchr(at, '\n', (size_t)(rows + length - at)));
         at = end + 1)
        add(&log, at, (size_t)(end - at));
    cs_row_log_record(&log, serialiser);
    CS_ASSERT(log.length <= length);
    fclose(log.file);
}

/* goes on and adds a row; the file is then the rows and this one */
static void go_on(const char *rows, const char *bytes, size_t length,
                  struct cs_serialiser *serialiser) {
    struct cs_row_log log = {0};
    struct cs_error error = {0};
    char *found;
    size_t n;
    serialiser->is_reading = true;
    serialiser->position = 0;
    cs_row_log_record(&log, serialiser);
    CS_ASSERT(!serialiser->failed);
    const size_t whole = log.length;
    const bool same = length >= whole && !memcmp(bytes, rows, whole);
    const enum cs_status status = cs_row_log_resume(&log, fuzz_path("log"), &error);
    CS_ASSERT(status == error.status && status == (same ? CS_OK : CS_ERR_FILE));
    if (status)
        return;
    add(&log, "new", 3);
    CS_ASSERT(!cs_row_log_finish(&log, &error));
    CS_ASSERT(!cs_file_read(fuzz_path("log"), 1 << 20, &found, &n, &error));
    CS_ASSERT(n == whole + 4 && !memcmp(found, rows, whole) &&
              !memcmp(found + whole, "new\n", 4));
    free(found);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length) {
    struct cs_serialiser serialiser = {0};
    const char *rows = (const char *)bytes;
    const char *end = length ? memchr(rows, 0, length) : NULL;
    if (!end)
        return 0;
    const size_t after = (size_t)(end + 1 - rows);
    leave(rows, after - 1, &serialiser);
    fuzz_write("log.part", end + 1, length - after);
    go_on(rows, end + 1, length - after, &serialiser);
    cs_serialiser_finish(&serialiser);
    unlink(fuzz_path("log"));
    unlink(fuzz_path("log.part"));
    return 0;
}
