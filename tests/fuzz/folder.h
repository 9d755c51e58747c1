/* folder.h - gives the bytes of a fuzz target to functions that read files: a folder of the
 * process, removed at its end, and tables whose checks are put right, since else hardly any
 * damage gets behind them. */
#ifndef CS_FUZZ_FOLDER_H
#define CS_FUZZ_FOLDER_H

#include "session/table.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char fuzz_folder[4096];

static void fuzz_remove(void) {
    char command[4200];
    snprintf(command, sizeof command, "rm -rf '%s'", fuzz_folder);
    if (system(command))
        abort();
}

/* The path of a file in the folder, in a buffer that the next call uses again. */
static inline const char *fuzz_path(const char *name) {
    static char path[4200];
    if (!*fuzz_folder) {
        const char *parent = getenv("TMPDIR");
        snprintf(fuzz_folder, sizeof fuzz_folder, "%.4000s/clothsim-fuzz-XXXXXX",
                 parent ? parent : "/tmp");
        if (!mkdtemp(fuzz_folder) || atexit(fuzz_remove))
            abort();
    }
    snprintf(path, sizeof path, "%s/%s", fuzz_folder, name);
    return path;
}

static inline const char *fuzz_write(const char *name, const void *bytes, size_t length) {
    const char *path = fuzz_path(name);
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0 || write(file, bytes, length) != (ssize_t)length || close(file))
        abort();
    return path;
}

/* Adds the lines of a table with their checks, which are made from the lines without their last
 * fields if the first line has such a column. */
static inline void fuzz_sign_rows(const char *bytes, size_t length, struct cs_text *out) {
    char *copy = strndup(bytes, length), *rest = copy, *names = NULL;
    if (!copy)
        abort();
    for (char *line; (line = strsep(&rest, "\n")) && rest;) {
        const size_t from = out->length;
        char *comma = strrchr(line, ',');
        if (comma && (names || !strcmp(comma, ",check")))
            *comma = 0;
        cs_text_add(out, "%s", line);
        if (names)
            cs_csv_end_row(out, from, names);
        else {
            names = line;
            cs_csv_end_names(out);
        }
    }
    free(copy);
}

#endif
