/* Appends rows to a file, cuts it back, and renames it at the end. */
#include "cli/run/row_log.h"

#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static enum cs_status fail(const struct cs_row_log *log, struct cs_error *error) {
    return cs_fail(error, cs_file_status(errno), "cannot write \"%s\": %s",
                   *log->path ? log->path : "the rows of frames", strerror(errno));
}

/* Sets the names, "" for a file without one, and whether it is a stream. */
static enum cs_status set_path(struct cs_row_log *log, const char *path,
                               struct cs_error *error) {
    const int length = snprintf(log->path, sizeof log->path, "%s", path ? path : "");
    snprintf(log->part, sizeof log->part, "%s.part", log->path);
    log->streams = !strcmp(log->path, "-");
    if (length >= (int)sizeof log->path)
        return cs_fail(error, CS_ERR_FILE, "the path \"%.60s...\" is too long", path);
    return length == 0 || log->streams ? CS_OK
                                       : cs_file_target(log->path, &log->streams, error);
}

/* Opens the file that rows are added to, empty. */
static enum cs_status open_part(struct cs_row_log *log, struct cs_error *error) {
    int file = -1;
    if (!*log->path || !strcmp(log->path, "-"))
        log->file = log->streams ? stdout : tmpfile();
    else
        file = log->streams ? cs_file_open_stream(log->path, error)
                            : cs_file_open_own(log->part, O_CREAT, error);
    if (file >= 0 && (log->streams || !ftruncate(file, 0)))
        log->file = fdopen(file, log->streams ? "w" : "w+");
    if (file >= 0 && !log->file)
        close(file);
    return log->file ? CS_OK : fail(log, error);
}

enum cs_status cs_row_log_create(struct cs_row_log *log, const char *path,
                                 struct cs_error *error) {
    *log = (struct cs_row_log){0};
    return set_path(log, path, error) ? error->status : open_part(log, error);
}

/* The hash of the rows up to this one, from that of the rows before. */
static void add_hash(char hash[CS_HASH_DIGITS], const char *row, size_t length) {
    char both[2 * CS_HASH_DIGITS] = "";
    memcpy(both, hash, CS_HASH_DIGITS);
    cs_hash_bytes(row, length, both + CS_HASH_DIGITS);
    cs_hash_bytes(both, sizeof both, hash);
}

enum cs_status cs_row_log_add(struct cs_row_log *log, struct cs_text *row,
                              struct cs_error *error) {
    if (row->failed)
        cs_fail(error, CS_ERR_MEMORY, "out of memory for the rows of frames");
    else if (log->file && (fwrite(row->bytes, 1, row->length, log->file) != row->length ||
                           fflush(log->file)))
        fail(log, error);
    else {
        add_hash(log->hash, row->bytes, row->length);
        log->length += row->length;
    }
    cs_text_finish(row);
    return error->status;
}

void cs_row_log_record(struct cs_row_log *log, struct cs_serialiser *serialiser) {
    CS_SERIALISER(serialiser, log->length);
    CS_SERIALISER(serialiser, log->hash);
}

enum cs_status cs_row_log_sync(const struct cs_row_log *log, struct cs_error *error) {
    return log->file && !log->streams && fdatasync(fileno(log->file)) ? fail(log, error)
                                                                      : CS_OK;
}

/* Reads rows up to the length of the record, and adds them to `copy` if there is one. Returns
 * true if they are those of the record. */
static bool read_rows(const struct cs_row_log *log, FILE *from, FILE *copy) {
    char hash[CS_HASH_DIGITS] = "", *row = NULL;
    size_t capacity = 0;
    uint64_t at = 0;
    ssize_t length;
    while (at < log->length && (length = getline(&row, &capacity, from)) > 0) {
        add_hash(hash, row, (size_t)length);
        at += (uint64_t)length;
        if (copy)
            fwrite(row, 1, (size_t)length, copy);
    }
    free(row);
    return at == log->length && !memcmp(hash, log->hash, sizeof hash);
}

/* Takes over PATH.part, and cuts off what was added after the record. */
static bool resume_part(struct cs_row_log *log, struct cs_error *error) {
    const int file = access(log->part, F_OK) ? -1 : cs_file_open_own(log->part, 0, error);
    log->file = file >= 0 ? fdopen(file, "r+") : NULL;
    if (log->file && read_rows(log, log->file, NULL) &&
        !ftruncate(fileno(log->file), (off_t)log->length) &&
        !fseeko(log->file, (off_t)log->length, SEEK_SET))
        return true;
    if (log->file)
        fclose(log->file);
    log->file = NULL;
    return false;
}

/* Copies the rows of PATH, which stays until the end. */
static enum cs_status resume_whole(struct cs_row_log *log, struct cs_error *error) {
    FILE *whole = fopen(log->path, "re");
    const bool good = whole && read_rows(log, whole, NULL);
    if (!good)
        cs_fail(error, CS_ERR_FILE,
                "\"%s\": it does not begin with the rows that the checkpoint goes on with",
                log->path);
    else if (!open_part(log, error)) {
        if (fseeko(whole, 0, SEEK_SET) || !read_rows(log, whole, log->file) ||
            fflush(log->file))
            fail(log, error);
    }
    if (whole)
        fclose(whole);
    return error->status;
}

enum cs_status cs_row_log_resume(struct cs_row_log *log, const char *path,
                                 struct cs_error *error) {
    if (set_path(log, path, error))
        return error->status;
    if (log->streams)
        return open_part(log, error);
    return resume_part(log, error) || error->status ? error->status : resume_whole(log, error);
}

enum cs_status cs_row_log_copy(const struct cs_row_log *log, uint64_t bytes, FILE *out,
                               struct cs_error *error) {
    char block[1 << 14];
    if (fseeko(log->file, 0, SEEK_SET))
        return cs_fail(error, cs_file_status(errno), "cannot read \"%s\": %s", log->part,
                       strerror(errno));
    while (bytes > 0) {
        const size_t n = bytes < sizeof block ? (size_t)bytes : sizeof block;
        if (fread(block, 1, n, log->file) != n)
            return cs_fail(error, CS_ERR_FILE, "cannot read \"%s\": %s", log->part,
                           ferror(log->file) ? strerror(errno) : "it was cut");
        fwrite(block, 1, n, out);
        bytes -= n;
    }
    return CS_OK;
}

enum cs_status cs_row_log_finish(struct cs_row_log *log, struct cs_error *error) {
    FILE *file = log->file;
    log->file = NULL;
    if (!file || file == stdout)
        return error->status;
    const bool cut = log->streams || !ftruncate(fileno(file), (off_t)log->length);
    // renamed under the lock, which the end of the file releases
    const bool named = cut && (log->streams || !cs_file_rename(log->part, log->path, error));
    if ((fclose(file) != 0 || !named) && !error->status)
        fail(log, error);
    return error->status;
}

enum cs_status cs_row_log_remove(struct cs_row_log *log, struct cs_error *error) {
    if (log->file && log->file != stdout) {
        if (*log->path && !log->streams)
            cs_file_remove(log->part, error);
        fclose(log->file);
    }
    log->file = NULL;
    return error->status;
}
