/* Files that grow in place, by pwrite at known offsets; interrupted calls go on. */
#include "export/writer.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static enum cs_status fail(const struct cs_append_file *append, const char *verb,
                           struct cs_error *error) {
    return cs_fail(error, cs_file_status(errno), "cannot %s \"%s\": %s", verb, append->path,
                   strerror(errno));
}

/* Drops what a resumed run had written after its checkpoint. */
static enum cs_status truncate_to(struct cs_append_file *append, uint64_t kept,
                                  struct cs_error *error) {
    struct stat info;
    if (fstat(append->file - 1, &info))
        return fail(append, "read", error);
    if ((uint64_t)info.st_size < kept)
        return cs_fail(error, CS_ERR_FILE,
                       "cannot continue \"%s\": it has %lld bytes, expected at least %llu",
                       append->path, (long long)info.st_size, (unsigned long long)kept);
    append->length = kept;
    return ftruncate(append->file - 1, (off_t)kept) ? fail(append, "write", error) : CS_OK;
}

enum cs_status cs_append_file_open(struct cs_append_file *append, const char *path,
                                   uint64_t kept, struct cs_error *error) {
    *append = (struct cs_append_file){0};
    if (cs_export_check(snprintf(append->path, sizeof append->path, "%s", path), path, error))
        return error->status;
    append->file = cs_file_open_own(path, kept ? 0 : O_CREAT, error) + 1;
    return append->file ? truncate_to(append, kept, error) : error->status;
}

enum cs_status cs_append_file_write(struct cs_append_file *append, uint64_t at,
                                    const void *bytes, size_t n, struct cs_error *error) {
    const char *from = bytes;
    CS_ASSERT(at <= append->length);
    for (size_t done = 0; done < n;) {
        const ssize_t wrote =
            pwrite(append->file - 1, from + done, n - done, (off_t)(at + done));
        if (wrote >= 0) {
            done += (size_t)wrote;
            continue;
        }
        if (errno == EINTR)
            continue;
        fail(append, "write", error);
        /* half a sample is of no use; where this fails too, nobody reads it */
        if (ftruncate(append->file - 1, (off_t)append->length))
            errno = 0;
        return error->status;
    }
    append->length = at + n > append->length ? at + n : append->length;
    return CS_OK;
}

enum cs_status cs_append_file_read(const struct cs_append_file *append, uint64_t at,
                                   void *bytes, size_t n, struct cs_error *error) {
    char *to = bytes;
    for (size_t done = 0; done < n;) {
        const ssize_t got = pread(append->file - 1, to + done, n - done, (off_t)(at + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got == 0)
            errno = EIO;
        if (got <= 0)
            return fail(append, "read", error);
        done += (size_t)got;
    }
    return CS_OK;
}

enum cs_status cs_append_file_sync(const struct cs_append_file *append,
                                   struct cs_error *error) {
    return append->file && fsync(append->file - 1) ? fail(append, "write", error) : CS_OK;
}

void cs_append_file_close(struct cs_append_file *append) {
    if (append->file)
        close(append->file - 1);
    *append = (struct cs_append_file){0};
}
