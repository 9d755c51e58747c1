/* compare_ledger.c - compare.csv while it grows, so that an interrupted comparison goes on. */
#include "base/file.h"
#include "study/compare.h"
#include "study/compare_csv.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static enum cs_status write_rows(const struct cs_ledger *ledger,
                                 const struct cs_compare *compare, struct cs_error *error) {
    struct cs_text text = {0};
    cs_csv_add_head(&text);
    for (uint32_t k = 0; k < compare->sweep.n; k++)
        if (*compare->sweep.cells[k].outcome)
            cs_csv_add_cell(&text, compare->sweep.cells + k);
    if (text.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for %s", ledger->path);
    else
        cs_file_write(ledger->path, cs_text_get(&text), text.length, error);
    cs_text_finish(&text);
    return error->status;
}

/* A file that is none of ours is not written over. */
static enum cs_status read_old(struct cs_ledger *ledger, bool fresh, struct cs_error *error) {
    if (access(ledger->path, F_OK))
        return CS_OK;
    if (cs_csv_read(ledger->path, &ledger->old, &ledger->n_old, error))
        return error->status;
    if (fresh)
        ledger->n_old = 0;
    return CS_OK;
}

static void take_over(struct cs_ledger *ledger, struct cs_compare *compare) {
    for (uint32_t k = 0; k < compare->sweep.n; k++) {
        struct cs_cell *cell = compare->sweep.cells + k;
        for (uint32_t i = 0; i < ledger->n_old && !*cell->outcome; i++)
            if (*cell->key && !strcmp(cell->key, ledger->old[i].key)) {
                *cell = ledger->old[i];
                compare->taken++;
            }
    }
}

enum cs_status cs_ledger_open(struct cs_ledger *ledger, struct cs_compare *compare,
                              struct cs_error *error) {
    *ledger = (struct cs_ledger){0};
    snprintf(ledger->path, sizeof ledger->path, "%s/compare.csv", compare->settings->folder);
    if (cs_folder_make(compare->settings->folder, error) ||
        read_old(ledger, compare->settings->fresh, error))
        return error->status;
    take_over(ledger, compare);
    if (write_rows(ledger, compare, error))
        return error->status;
    ledger->file = fopen(ledger->path, "ae");
    if (!ledger->file)
        return cs_fail(error, CS_ERR_FILE, "cannot open %s: %s", ledger->path, strerror(errno));
    return CS_OK;
}

enum cs_status cs_ledger_append(struct cs_ledger *ledger, const struct cs_cell *cell,
                                struct cs_error *error) {
    struct cs_text line = {0};
    cs_csv_add_cell(&line, cell);
    if (line.failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for a row");
    else if (fwrite(line.bytes, 1, line.length, ledger->file) != line.length ||
             fflush(ledger->file))
        cs_fail(error, CS_ERR_FILE, "cannot write %s: %s", ledger->path, strerror(errno));
    cs_text_finish(&line);
    return error->status;
}

enum cs_status cs_ledger_rewrite(struct cs_ledger *ledger, const struct cs_compare *compare,
                                 struct cs_error *error) {
    return write_rows(ledger, compare, error);
}

void cs_ledger_close(struct cs_ledger *ledger) {
    if (ledger->file)
        fclose(ledger->file);
    free(ledger->old);
    *ledger = (struct cs_ledger){0};
}
