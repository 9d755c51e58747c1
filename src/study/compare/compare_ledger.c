/* Takes over, appends and rewrites the rows of compare.csv. */
#include "study/compare/compare_ledger.h"

#include "base/file.h"
#include "study/compare/compare_csv.h"

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

/* A file that is none of ours, or of another comparison, is not written over. */
static enum cs_status read_old(struct cs_ledger *ledger, const struct cs_compare *compare,
                               struct cs_error *error) {
    if (access(ledger->path, F_OK))
        return CS_OK;
    if (cs_csv_read(ledger->path, &ledger->old, &ledger->n_old, error))
        return error->status;
    if (compare->settings->fresh)
        ledger->n_old = 0;
    for (uint32_t i = 0; i < ledger->n_old && compare->sweep.n > 0; i++)
        if (strncmp(ledger->old[i].key, compare->sweep.cells[0].key, CS_COMPARE_DIGITS) != 0)
            return cs_fail(error, CS_ERR_USAGE,
                           "%s is of another scene, time or reference: give another folder "
                           "with --out, or --fresh to write over it",
                           ledger->path);
    return CS_OK;
}

static bool is_over_budget(const struct cs_cell *cell) {
    return !strcmp(cell->outcome, cs_outcome_text(CS_OVER_BUDGET));
}

/* What was stopped is run again where there is more time now. */
static bool is_valid(const struct cs_cell *old, const struct cs_compare *compare) {
    return *old->outcome && (!is_over_budget(old) || old->cpu > 0.9 * compare->budget);
}

static struct cs_cell *find(const struct cs_sweep *sweep, const struct cs_cell *cell) {
    for (uint32_t k = 0; k < sweep->n; k++)
        if (cs_cell_same_series(sweep->cells + k, cell) &&
            !strcmp(sweep->cells[k].options, cell->options))
            return sweep->cells + k;
    return NULL;
}

static enum cs_status take_over(struct cs_ledger *ledger, struct cs_compare *compare,
                                struct cs_error *error) {
    struct cs_sweep *sweep = &compare->sweep;
    for (uint32_t i = 0; i < ledger->n_old && !error->status; i++) {
        const struct cs_cell *old = ledger->old + i;
        struct cs_cell *found = find(sweep, old);
        if (!found)
            cs_sweep_add(sweep, old, error);
        else if (!strcmp(found->key, old->key) && is_valid(old, compare))
            *found = *old;
        else
            continue;
        compare->taken++;
    }
    return error->status;
}

enum cs_status cs_ledger_open(struct cs_ledger *ledger, struct cs_compare *compare,
                              struct cs_error *error) {
    *ledger = (struct cs_ledger){0};
    snprintf(ledger->path, sizeof ledger->path, "%s/compare.csv", compare->settings->folder);
    if (cs_folder_make(compare->settings->folder, error) || read_old(ledger, compare, error) ||
        take_over(ledger, compare, error) || write_rows(ledger, compare, error))
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
