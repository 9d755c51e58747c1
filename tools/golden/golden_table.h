/* golden_table.h - the two tables of golden files.
 *
 * golden/hash.tsv has one run per line, with its states in golden/state/NAME.npy.gz, if it has
 * any; golden/image.tsv one picture, with golden/image/NAME.png. A run is a scene, an
 * integrator with options ("-": the scene's own), overrides ("path=value;path=value", "-":
 * none) and a number of frames. Paths are relative to the folder above the golden folder. */
#ifndef CS_GOLDEN_TABLE_H
#define CS_GOLDEN_TABLE_H

#include "base/hash.h"
#include "base/text.h"
#include "golden/golden_states.h"
#include "session/table.h"

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
    bool has_new_states;          /* written for this row */
    struct cs_golden_where where; /* against stored states; zeroed: there are none */
    double seconds;               /* s of wall time that the row took */
};

/* A line of a table: a run and its expected result. Fields are the table's. */
struct cs_golden_row {
    struct cs_golden_run run;
    const char *hash; /* of the state (hash.tsv) or of the pixels (image.tsv) */
    /* "any", or the library and version that the bits are of ("SUNDIALS 6.4.1"), or the image's
     * renderer */
    const char *note;
    const char *image; /* name of the picture; NULL in hash.tsv */
    /* of hash.tsv: "bits", or how many m a position may be off; the name of its states, "-":
     * none */
    const char *tolerance, *state;
    bool is_state_new; /* the name was given for states that are to be written */
    char name[256];    /* of a picture or states that are added */
    struct cs_golden_finding finding;
    struct cs_text message; /* the difference, or why the row was skipped; empty: equal */
    bool added;             /* accepted for that version, in a row of its own */
    bool failed;            /* the run or the picture failed; message has the reason */
};

enum { CS_GOLDEN_HASH_FIELDS = 8, CS_GOLDEN_IMAGE_FIELDS = 7 };

/* m that a position of the row may be off; 0: its bits count. */
double cs_golden_tolerance(const struct cs_golden_row *row);

/* A table, read into memory; rows point into its lines. */
struct cs_golden_table {
    char path[1024];
    const char *head;        /* first line, without its end */
    const char *former_head; /* of a table without the last two columns, read too; or NULL */
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

/* Gives a row of hash.tsv that has no states a name for them, in the same way. */
void cs_golden_table_name_states(const struct cs_golden_table *table,
                                 struct cs_golden_row *row);

/* True if a row has the same run, and is for the library of this build. */
bool cs_golden_table_has(const struct cs_golden_table *table, const struct cs_golden_row *row);

/* Writes all rows, and those with `added` once more, after it, with what was found. */
enum cs_status cs_golden_table_write(const struct cs_golden_table *table,
                                     struct cs_error *error);

void cs_golden_table_close(struct cs_golden_table *table);

#endif
