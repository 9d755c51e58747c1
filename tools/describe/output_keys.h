/* output_keys.h - the keys and columns of the files that the program writes, for manual and
 * schema. */
#ifndef CS_OUTPUT_KEYS_H
#define CS_OUTPUT_KEYS_H

#include "session/table.h"

/* A key of a JSON file. */
struct cs_output_key {
    /* place in the file, "frames[].hash"; a '?' at the end: absent where it has no meaning */
    const char *path;
    /* "text", "whole", "number", "flag", "object" or "list" (the keys follow), "list of TYPE";
     * " or null" behind it. A number that is not finite is null. */
    const char *type;
    const char *unit; /* as of a column */
    const char *help; /* lower case, no full stop */
};

/* A file: a table of columns, or a JSON object of keys (with the columns inside, where it has
 * both). */
struct cs_output_file {
    const char *name;  /* as in headings: "run.json" */
    const char *about; /* who writes it, and how a table begins; sentences */
    const struct cs_output_key *keys;
    uint32_t n_keys;
    const struct cs_column *columns;
    const uint32_t *n_columns;
    const char *columns_in; /* list of objects that have the columns as keys; NULL: a table */
};

extern const struct cs_output_file cs_output_files[];
extern const uint32_t cs_n_output_files;

/* Adds the section FILES of clothsim-files(5), in scdoc. */
void cs_output_print_manual(struct cs_text *out);
/* Adds the JSON schema (draft 2020-12) of a file: "run", "compare", ...; CS_ERR_USAGE with the
 * names if there is none. */
enum cs_status cs_output_print_schema(const char *name, struct cs_text *out,
                                      struct cs_error *error);

#endif
