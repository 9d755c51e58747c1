/* Reads standard input to its end, once. */
#include "scene/file/stdin_input.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* the contents, read once per process */
static struct {
    char *text;
    size_t bytes;
    bool read;
} input;

/* Reads pieces to the end, and only then marks the input as read. */
static enum cs_status read_all(size_t max, struct cs_error *error) {
    enum { PIECE = 1 << 16 };
    while (!feof(stdin)) {
        char *longer = realloc(input.text, input.bytes + PIECE);
        if (!longer)
            return cs_fail(error, CS_ERR_MEMORY, "out of memory for " CS_STDIN_INPUT_TITLE);
        input.text = longer;
        errno = 0;
        input.bytes += fread(input.text + input.bytes, 1, PIECE, stdin);
        if (ferror(stdin))
            return cs_fail(error, CS_ERR_FILE, "cannot read " CS_STDIN_INPUT_TITLE ": %s",
                           strerror(errno));
        if (input.bytes > max)
            return cs_fail(error, CS_ERR_FILE,
                           "cannot read " CS_STDIN_INPUT_TITLE ": expected at most %zu bytes",
                           max);
    }
    input.read = true;
    return CS_OK;
}

enum cs_status cs_stdin_input_read(size_t max, const char **text, size_t *bytes,
                                   struct cs_error *error) {
    if (!input.read && read_all(max, error))
        return error->status;
    *text = input.text;
    *bytes = input.bytes;
    return CS_OK;
}
