/* Files that grow in place, by pwrite at known offsets; interrupted calls go on. */
#include "io/export/writer.h"

#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static enum cs_status fail(const struct cs_append_file *grown, const char *verb,
                           struct cs_error *error) {
    return cs_fail(error, cs_file_status(errno), "cannot %s \"%s\": %s", verb, grown->path,
                   strerror(errno));
}

/* Drops what a resumed run had written after its checkpoint. */
static enum cs_status truncate_to(struct cs_append_file *grown, uint64_t kept,
                                  struct cs_error *error) {
    struct stat info;
    if (fstat(grown->file - 1, &info))
        return fail(grown, "read", error);
    if ((uint64_t)info.st_size < kept)
        return cs_fail(error, CS_ERR_FILE,
                       "cannot continue \"%s\": it has %lld bytes, expected at least %llu",
                       grown->path, (long long)info.st_size, (unsigned long long)kept);
    grown->length = kept;
    return ftruncate(grown->file - 1, (off_t)kept) ? fail(grown, "write", error) : CS_OK;
}

enum cs_status cs_append_file_open(struct cs_append_file *grown, const char *path,
                                   uint64_t kept, struct cs_error *error) {
    *grown = (struct cs_append_file){0};
    if (cs_export_check(snprintf(grown->path, sizeof grown->path, "%s", path), path, error))
        return error->status;
    grown->file = cs_file_open_own(path, kept ? 0 : O_CREAT, error) + 1;
    return grown->file ? truncate_to(grown, kept, error) : error->status;
}

enum cs_status cs_append_file_write(struct cs_append_file *grown, uint64_t at,
                                    const void *bytes, size_t n, struct cs_error *error) {
    const char *from = bytes;
    CS_ASSERT(at <= grown->length);
    for (size_t done = 0; done < n;) {
        const ssize_t wrote =
            pwrite(grown->file - 1, from + done, n - done, (off_t)(at + done));
        if (wrote >= 0) {
            done += (size_t)wrote;
            continue;
        }
        if (errno == EINTR)
            continue;
        fail(grown, "write", error);
        /* half a sample is of no use; where this fails too, nobody reads it */
        if (ftruncate(grown->file - 1, (off_t)grown->length))
            errno = 0;
        return error->status;
    }
    grown->length = at + n > grown->length ? at + n : grown->length;
    return CS_OK;
}

enum cs_status cs_append_file_read(const struct cs_append_file *grown, uint64_t at, void *bytes,
                                   size_t n, struct cs_error *error) {
    char *to = bytes;
    for (size_t done = 0; done < n;) {
        const ssize_t got = pread(grown->file - 1, to + done, n - done, (off_t)(at + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got == 0)
            errno = EIO;
        if (got <= 0)
            return fail(grown, "read", error);
        done += (size_t)got;
    }
    return CS_OK;
}

enum cs_status cs_append_file_sync(const struct cs_append_file *grown, struct cs_error *error) {
    return grown->file && fsync(grown->file - 1) ? fail(grown, "write", error) : CS_OK;
}

void cs_append_file_close(struct cs_append_file *grown) {
    if (grown->file)
        close(grown->file - 1);
    *grown = (struct cs_append_file){0};
}
