/* golden_table.h - the two tables of golden files.
 *
 * golden/hash.tsv has one run per line; golden/image.tsv one picture, with
 * golden/image/NAME.png. A run is a scene, an integrator with options ("-": the scene's own),
 * overrides ("path=value;path=value", "-": none) and a number of frames. Paths are relative to
 * the folder above the golden folder. */
#ifndef CS_GOLDEN_TABLE_H
#define CS_GOLDEN_TABLE_H

#include "base/hash.h"
#include "base/table.h"
#include "base/text.h"

/* Limits of a row: overrides, and bytes of their text with its end. */
enum { CS_GOLDEN_SETS_MAX = 16, CS_GOLDEN_SETS_BYTES = 1024 };

/* The run of a row; texts are the table's. */
struct cs_golden_run {
    const char *scene, *integrator, *overrides; /* "-": none */
    uint32_t frames;
};

/* Results of a run. */
struct cs_golden_finding {
    char found[CS_HASH_DIGITS], renderer[256];
    char library[64]; /* as note of a row, of this build; "": the bits are the program's own */
    bool skipped;     /* the library is not in this build, or of another version */
};

/* A line of a table: a run and its expected result. Fields are the table's. */
struct cs_golden_row {
    struct cs_golden_run run;
    const char *hash; /* of the state (hash.tsv) or of the pixels (image.tsv) */
    /* "any", or the library and version that the bits are of ("SUNDIALS 6.4.1"), or the image's
     * renderer */
    const char *note;
    const char *image; /* name of the picture; NULL in hash.tsv */
    char name[256];    /* of a picture that is added */
    struct cs_golden_finding finding;
    struct cs_text message; /* the difference, or why the row was skipped; empty: equal */
    bool added;             /* accepted for that version, in a row of its own */
    bool failed;            /* the run or the picture failed; message has the reason */
};

enum { CS_GOLDEN_HASH_FIELDS = 6, CS_GOLDEN_IMAGE_FIELDS = 7 };

/* A table, read into memory; rows point into its lines. */
struct cs_golden_table {
    char path[1024];
    const char *head; /* first line, without its end */
    uint32_t n_fields;
    struct cs_rows lines;
    struct cs_golden_row *rows; /* (n), and room for one more */
    uint32_t n;
};

/* Reads FOLDER/NAME; head and n_fields are set. With may_lack a missing file has no rows.
 * CS_ERR_FILE, CS_ERR_MEMORY. The caller closes the table in any case. */
enum cs_status cs_golden_table_read(struct cs_golden_table *table, const char *folder,
                                    const char *name, bool may_lack, struct cs_error *error);

/* Returns the row of that run, or a new last one without a hash; at most one is added. The name
 * of its picture is the scene's, with a number if another row has it. */
struct cs_golden_row *cs_golden_table_add(struct cs_golden_table *table,
                                          const struct cs_golden_run *run);

/* True if a row has the same run, and is for the library of this build. */
bool cs_golden_table_has(const struct cs_golden_table *table, const struct cs_golden_row *row);

/* Writes all rows, and those with `added` once more, after it, with what was found. */
enum cs_status cs_golden_table_write(const struct cs_golden_table *table,
                                     struct cs_error *error);

void cs_golden_table_close(struct cs_golden_table *table);

#endif
